use proptest::prelude::*;

use super::*;

#[derive(Debug, Default, PartialEq)]
struct Lists {
    start: Vec<u32>,
    partner: Vec<u32>,
    image: Vec<u8>,
}

fn by_grid(grid: &mut NeighbourGrid, bodies: &[[f64; 4]], cell: &Cell, margin: f64) -> Lists {
    let mut lists = Lists::default();
    grid.half_pairs(bodies, cell, margin, &mut lists.start, &mut lists.partner, &mut lists.image);
    lists
}

fn order_of(bodies: &[[f64; 4]], cell: &Cell, size: f64) -> Vec<u32> {
    let (mut order, mut again) = (vec![7], Vec::new());
    BodyOrder::new().sort(bodies, cell, size, false, &mut order);
    BodyOrder::new().sort(bodies, cell, size, true, &mut again);
    assert_eq!(order, again);
    order
}

fn by_force(bodies: &[[f64; 4]], cell: &Cell, margin: f64) -> Lists {
    let mut lists = Lists::default();
    brute_force_pairs(bodies, cell, margin, &mut lists.start, &mut lists.partner, &mut lists.image);
    lists
}

/// A reproducible stream of numbers in [0, 1) (splitmix64).
fn stream(mut seed: u64) -> impl FnMut() -> f64 {
    move || {
        seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (seed ^ (seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn bodies_in(n: usize, lo: [f64; 3], hi: [f64; 3], radii: [f64; 2], seed: u64) -> Vec<[f64; 4]> {
    let mut next = stream(seed);
    (0..n)
        .map(|_| {
            let mut at = |axis: usize| lo[axis] + next() * (hi[axis] - lo[axis]);
            let position = [at(0), at(1), at(2)];
            [position[0], position[1], position[2], radii[0] + next() * (radii[1] - radii[0])]
        })
        .collect()
}

#[test]
fn none_and_one() {
    let mut grid = NeighbourGrid::new();
    let cell = Cell::new([0.0; 3], [1.0; 3], [true; 3]).unwrap();
    assert_eq!(by_grid(&mut grid, &[], &cell, 0.1), Lists { start: vec![0], ..Lists::default() });
    let one = [[0.5, 0.5, 0.5, 0.1]];
    assert_eq!(by_grid(&mut grid, &one, &cell, 0.1), Lists { start: vec![0, 0], ..Lists::default() });
    assert!(order_of(&[], &cell, 0.1).is_empty());
    assert_eq!(order_of(&one, &cell, 0.1), [0]);
}

#[test]
fn the_image_code_gives_the_separation() {
    let cell = Cell::new([0.0; 3], [1.0, 2.0, 3.0], [true; 3]).unwrap();
    let bodies = [[0.02, 0.05, 1.0, 0.05], [0.97, 1.96, 1.02, 0.05]];
    let lists = by_grid(&mut NeighbourGrid::new(), &bodies, &cell, 0.02);
    assert_eq!(lists.partner, [1]);
    assert_eq!(image_shift(lists.image[0]), [-1, -1, 0]);
    let s = cell.shift_vector(lists.image[0]);
    let separation: [f64; 3] = std::array::from_fn(|k| bodies[0][k] - bodies[1][k] - s[k]);
    for (found, expected) in separation.iter().zip([0.05, 0.09, -0.02]) {
        // Two subtractions of numbers up to 2.
        assert!((found - expected).abs() <= 4.0 * f64::EPSILON, "{separation:?}");
    }
}

#[test]
fn contact_at_exactly_the_reach_is_no_neighbour() {
    let bodies = [[0.0, 0.0, 0.0, 0.5], [1.25, 0.0, 0.0, 0.5], [2.5 - 1e-15, 0.0, 0.0, 0.5]];
    let lists = by_grid(&mut NeighbourGrid::new(), &bodies, &Cell::unbounded(), 0.25);
    assert_eq!((lists.start, lists.partner), (vec![0, 0, 1, 1], vec![2]));
}

#[test]
fn all_bodies_in_one_point() {
    let bodies = vec![[0.3, 0.3, 0.3, 0.01]; 100];
    for periodic in [[false; 3], [true; 3]] {
        let cell = Cell::new([0.0; 3], [1.0; 3], periodic).unwrap();
        let lists = by_grid(&mut NeighbourGrid::new(), &bodies, &cell, 0.0);
        assert_eq!(lists.partner.len(), 100 * 99 / 2);
        assert_eq!(lists, by_force(&bodies, &cell, 0.0));
    }
}

#[test]
fn points_without_reach_have_no_neighbours() {
    let bodies = [[0.0; 4]; 3];
    for margin in [0.0, -1.0, f64::NAN] {
        let lists = by_grid(&mut NeighbourGrid::new(), &bodies, &Cell::unbounded(), margin);
        assert!(lists.partner.is_empty());
        assert_eq!(lists, by_force(&bodies, &Cell::unbounded(), margin));
    }
}

#[test]
fn denormal_reaches_end() {
    let bodies = [[0.115, f64::NAN, 0.0, 0.0], [0.5, 0.5, 0.5, 0.0], [0.5, 0.5, 0.5, 5e-324]];
    for periodic in [[false, false, true], [true; 3], [false; 3]] {
        let cell = Cell::new([0.0; 3], [1.0; 3], periodic).unwrap();
        let lists = by_grid(&mut NeighbourGrid::new(), &bodies, &cell, 5e-324);
        assert_eq!(lists, by_force(&bodies, &cell, 5e-324));
    }
}

#[test]
fn outliers_and_numbers_out_of_range() {
    let mut bodies = bodies_in(3000, [0.0; 3], [1.0; 3], [0.03, 0.05], 5);
    bodies[17] = [1e12, -1e12, 3.0, 0.05];
    bodies[18] = [1e12 + 0.01, -1e12, 3.0, 0.05];
    bodies[90] = [f64::NAN, 0.5, 0.5, 0.05];
    bodies[91] = [f64::INFINITY, 0.5, 0.5, 0.05];
    bodies[92] = [f64::NEG_INFINITY, f64::NAN, 1e308, 0.05];
    bodies[93] = [-1e308, 1e308, -1e308, 0.05];
    for periodic in [[false; 3], [true, false, false]] {
        let cell = Cell::new([0.0; 3], [1.0; 3], periodic).unwrap();
        let mut grid = NeighbourGrid::new();
        assert_eq!(by_grid(&mut grid, &bodies, &cell, 0.01), by_force(&bodies, &cell, 0.01));
        let mut order = order_of(&bodies, &cell, 0.1);
        order.sort_unstable();
        assert!(order.iter().copied().eq(0..3000));
    }
}

#[test]
fn an_outlier_does_not_make_the_cells_coarse() {
    let mut bodies = bodies_in(20_000, [0.0; 3], [1.0; 3], [0.01, 0.01], 9);
    bodies[0] = [1e9, 1e9, -1e9, 0.01];
    let limit = bins::Limit { each: 2 * bodies.len(), all: 2 * bodies.len() };
    let cell = Cell::unbounded();
    let bounds = bins::Bounds::new(&bodies, &cell, false);
    let bins = bins::Bins::new(&bounds, &cell, 0.04, limit, &mut Vec::new());
    // 25 cells across the bodies, and at most a quarter and a cell more at each side.
    assert!(bins.count.iter().all(|&n| (25..=42).contains(&n)), "{:?}", bins.count);
}

#[test]
fn a_second_call_allocates_nothing() {
    let cell = Cell::new([0.0; 3], [1.0; 3], [true, false, true]).unwrap();
    let mut mixed = bodies_in(3000, [0.0; 3], [1.0; 3], [0.004, 0.005], 3);
    mixed[..10].iter_mut().for_each(|body| body[3] = 0.1);
    for (bodies, levels) in [(bodies_in(2000, [0.0; 3], [1.0; 3], [0.02, 0.03], 3), 1), (mixed, 2)] {
        let (mut grid, mut order, mut scratch) =
            (NeighbourGrid::new(), BodyOrder::new(), PairScratch::default());
        let mut places = Vec::new();
        let mut memory = Vec::new();
        for _ in 0..3 {
            grid.build(&bodies, &cell, 0.01, false);
            grid.pairs_of(0..bodies.len(), &mut scratch, |_, _, _| {});
            order.sort(&bodies, &cell, 0.05, false, &mut places);
            memory.push((grid.bytes(), order.bytes(), scratch.bytes(), places.as_ptr()));
        }
        assert_eq!(grid.levels(), levels);
        assert_eq!(memory[1], memory[2]);
        assert_eq!(memory[0], memory[1]);
    }
}

/// Pairs of all bodies, found range by range, with the lower body first.
fn pairs(grid: &NeighbourGrid, bodies: usize, ranges: usize) -> Vec<(u32, u32, u8)> {
    let mut found = Vec::new();
    let ends: Vec<usize> = (0..=ranges).map(|k| bodies * k / ranges).collect();
    for range in ends.windows(2) {
        grid.pairs_of(range[0]..range[1], &mut PairScratch::default(), |i, j, code| {
            assert!(range[0] <= i as usize && (i as usize) < range[1]);
            found.push((i, j, code));
        });
    }
    found
}

#[test]
fn ranges_and_threads_change_nothing() {
    for radii in [[0.02, 0.06], [0.001, 0.06]] {
        let mut bodies = bodies_in(4000, [0.0; 3], [1.0; 3], [radii[0]; 2], 3);
        bodies[..40].iter_mut().for_each(|body| body[3] = radii[1]);
        for (hi, margin) in [([1.0; 3], 0.01), ([0.8, 1.0, 1.0], 0.01), ([1.0; 3], 0.3)] {
            let cell = Cell::new([0.0; 3], hi, [true, true, false]).unwrap();
            let mut grid = NeighbourGrid::new();
            grid.build(&bodies, &cell, margin, false);
            let whole = pairs(&grid, bodies.len(), 1);
            assert!(!whole.is_empty());
            for ranges in [2, 7, 600] {
                assert_eq!(pairs(&grid, bodies.len(), ranges), whole);
            }
            for threads in [1, 3, 8] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| grid.build(&bodies, &cell, margin, true));
                assert_eq!(pairs(&grid, bodies.len(), 5), whole);
            }
        }
    }
}

#[test]
fn heaps_in_a_huge_empty_volume() {
    // Two dense heaps and some bodies between them, in a volume of 10^15 cells.
    let mut bodies = bodies_in(4000, [0.0; 3], [1.0; 3], [0.03, 0.04], 5);
    for (k, body) in bodies.iter_mut().enumerate() {
        let far = [0.0, 1.0, 0.37 + 1e-4 * k as f64][if k % 50 == 0 { 2 } else { k % 2 }];
        (body[0], body[1], body[2]) = (body[0] + 1e4 * far, body[1] - 1e4 * far, body[2] + 1e4 * far);
    }
    for radius in [0.04, 0.5] {
        bodies[7][3] = radius;
        let cell = Cell::unbounded();
        let mut grid = NeighbourGrid::new();
        assert_eq!(by_grid(&mut grid, &bodies, &cell, 0.01), by_force(&bodies, &cell, 0.01));
        assert!(grid.bytes() < 250 * bodies.len(), "{} bytes", grid.bytes());
        // No body looks at a whole heap.
        let looked: f64 = grid.levels[..grid.used]
            .iter()
            .flat_map(|level| level.first.windows(2).map(|ends| f64::from(ends[1] - ends[0]).powi(2)))
            .sum();
        assert!(looked < 6.0 * bodies.len() as f64, "{looked}");
    }
}

#[test]
fn the_order_follows_a_curve() {
    // One body in each cell of an 8 x 8 x 8 block, given in a scrambled order: consecutive bodies share a face.
    let bodies: Vec<[f64; 4]> = (0..512u32)
        .map(|k| k * 205 % 512)
        .map(|k| [f64::from(k % 8) + 0.5, f64::from(k / 8 % 8) + 0.5, f64::from(k / 64) + 0.5, 0.5])
        .collect();
    let cell = Cell::new([0.0; 3], [8.0; 3], [true; 3]).unwrap();
    let order = order_of(&bodies, &cell, 1.0);
    for pair in order.windows(2) {
        let (a, b) = (bodies[pair[0] as usize], bodies[pair[1] as usize]);
        let step: f64 = (0..3).map(|k| (a[k] - b[k]).abs()).sum();
        assert_eq!(step, 1.0);
    }
    // A layer one cell thick follows the curve of the square.
    let layer: Vec<[f64; 4]> = (0..64u32)
        .map(|k| k * 37 % 64)
        .map(|k| [f64::from(k % 8) + 0.5, 2.0, f64::from(k / 8) + 0.5, 0.5])
        .collect();
    let order = order_of(&layer, &Cell::unbounded(), 1.0);
    for pair in order.windows(2) {
        let (a, b) = (layer[pair[0] as usize], layer[pair[1] as usize]);
        assert_eq!((a[0] - b[0]).abs() + (a[2] - b[2]).abs(), 1.0);
    }
}

#[test]
fn order_takes_any_size() {
    let bodies = bodies_in(100, [0.0; 3], [1.0; 3], [0.1, 0.1], 1);
    for size in [0.0, -1.0, f64::NAN, 1e-300, 1e300, f64::INFINITY] {
        let mut order = order_of(&bodies, &Cell::unbounded(), size);
        let ties_by_index = order.iter().copied().eq(0..100);
        assert_eq!(ties_by_index, size >= 1e300, "{size}");
        order.sort_unstable();
        assert!(order.iter().copied().eq(0..100));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn the_grid_finds_what_brute_force_finds(
        n in 0usize..250,
        // Lengths in units of the largest reach: from the least that one image allows to several cells.
        lengths in prop::array::uniform3(2.0f64..9.0),
        periodic: [bool; 3],
        bounded: bool,
        spread in 0.05f64..1.0,
        margin in prop_oneof![Just(0.0), 0.0f64..0.5],
        offset in prop_oneof![Just(0.0), -100.0f64..100.0],
        flat: bool,
        stray: bool,
        snap: bool,
        seed: u64,
    ) {
        let reach = 2.0 + margin;
        let lo = [offset, -offset, 0.5 * offset];
        let mut hi: [f64; 3] = std::array::from_fn(|k| lo[k] + lengths[k] * reach * (1.0 + 1e-12));
        let mut periodic = periodic;
        if flat {
            (periodic[2], hi[2]) = (false, lo[2]);
        }
        let free = |k: usize| !bounded && !periodic[k];
        let cell = Cell::new(
            std::array::from_fn(|k| if free(k) { f64::NEG_INFINITY } else { lo[k] }),
            std::array::from_fn(|k| if free(k) { f64::INFINITY } else { hi[k] }),
            periodic,
        ).unwrap();
        prop_assert!(cell.check_minimum_length(1.0, margin).is_ok());
        let mut bodies = bodies_in(n, lo, hi, [spread, 1.0], seed);
        if snap {
            // Positions on a coarse lattice meet cell faces, half periods and exact reaches.
            for body in &mut bodies {
                for x in &mut body[..3] {
                    *x = (*x * 2.0).round() / 2.0;
                }
                body[3] = 0.5;
            }
        }
        if stray {
            // Not wrapped: up to a quarter of a period outside.
            for (k, body) in bodies.iter_mut().enumerate() {
                let axis = k % 3;
                let x = body[axis];
                body[axis] = lo[axis] + (x - lo[axis]) * 1.4 - 0.2 * (hi[axis] - lo[axis]);
            }
        } else if snap {
            for body in &mut bodies {
                let (x, _) = cell.wrap([body[0], body[1], body[2]]);
                body[..3].copy_from_slice(&x);
            }
        }
        let expected = by_force(&bodies, &cell, margin);
        let mut grid = NeighbourGrid::new();
        let found = by_grid(&mut grid, &bodies, &cell, margin);
        prop_assert_eq!(&found, &expected);
        // Ascending and without repetition.
        for i in 0..n {
            let partners = &found.partner[found.start[i] as usize..found.start[i + 1] as usize];
            prop_assert!(partners.windows(2).all(|w| w[0] < w[1]));
            prop_assert!(partners.first().is_none_or(|&j| j as usize > i));
        }
        // Scratch left by another problem changes nothing.
        let others = bodies_in(300, [0.0; 3], [30.0; 3], [0.5, 1.0], seed ^ 1);
        by_grid(&mut grid, &others, &Cell::unbounded(), 0.1);
        prop_assert_eq!(by_grid(&mut grid, &bodies, &cell, margin), expected);
    }

    #[test]
    fn size_classes_find_what_brute_force_finds(
        n in 20usize..400,
        // Exponent of the number of bodies above a radius, and the largest ratio of radii.
        (slope, ratio) in (0.0f64..3.0, 1.0f64..1000.0),
        lengths in prop::array::uniform3(2.0f64..8.0),
        periodic: [bool; 3],
        flat: bool,
        margin in prop_oneof![Just(0.0), 1e-4f64..0.3],
        offset in prop_oneof![Just(0.0), Just(1e9), -1e3f64..1e3],
        // Where the bodies are: everywhere, in one corner, or on the corners of cells.
        (heap, snap, far) in (any::<bool>(), any::<bool>(), any::<bool>()),
        force_levels: bool,
        seed: u64,
    ) {
        let reach = 2.0 + margin;
        let lo = [offset, -offset, 0.5 * offset];
        let mut hi: [f64; 3] = std::array::from_fn(|k| lo[k] + lengths[k] * reach * (1.0 + 1e-6));
        let mut periodic = periodic;
        if flat {
            (periodic[2], hi[2]) = (false, lo[2]);
        }
        let cell = Cell::new(
            std::array::from_fn(|k| if periodic[k] { lo[k] } else { f64::NEG_INFINITY }),
            std::array::from_fn(|k| if periodic[k] { hi[k] } else { f64::INFINITY }),
            periodic,
        ).unwrap();
        let mut bodies = bodies_in(n, lo, hi, [0.0, 1.0], seed);
        for (k, body) in bodies.iter_mut().enumerate() {
            // A power law between 1/ratio and 1.
            let least = ratio.powf(-slope.max(0.1));
            body[3] = (least + body[3] * (1.0 - least)).powf(1.0 / slope.max(0.1));
            if heap && k % 3 != 0 {
                for axis in 0..3 {
                    body[axis] = lo[axis] + (body[axis] - lo[axis]) * 0.05;
                }
            }
            if snap {
                for axis in 0..3 {
                    body[axis] = lo[axis] + ((body[axis] - lo[axis]) * 4.0).floor() / 4.0;
                }
            }
            if far && k % 40 == 0 && !periodic[0] {
                body[0] += 1e5 * (1.0 + (k % 80) as f64);
            }
            let (x, _) = cell.wrap([body[0], body[1], body[2]]);
            body[..3].copy_from_slice(&x);
        }
        if force_levels {
            // One large body among many small ones.
            bodies.iter_mut().skip(1).for_each(|body| body[3] *= 0.01);
            bodies[0][3] = 1.0;
        }
        let expected = by_force(&bodies, &cell, margin);
        let mut grid = NeighbourGrid::new();
        prop_assert_eq!(by_grid(&mut grid, &bodies, &cell, margin), expected);
    }

    #[test]
    fn no_pair_is_missed_by_brute_force(
        n in 0usize..40, lengths in prop::array::uniform3(2.0f64..6.0), periodic: [bool; 3], seed: u64,
    ) {
        // The oracle itself against all 27 images, written independently.
        let hi: [f64; 3] = lengths.map(|length| 2.2 * length);
        let cell = Cell::new([0.0; 3], hi, periodic).unwrap();
        let bodies = bodies_in(n, [0.0; 3], hi, [0.3, 1.0], seed);
        let lists = by_force(&bodies, &cell, 0.2);
        let mut expected = Lists { start: vec![0], ..Lists::default() };
        for i in 0..n {
            for j in i + 1..n {
                for code in 0..27u8 {
                    let s = image_shift(code);
                    if (0..3).any(|k| s[k] != 0 && !periodic[k]) {
                        continue;
                    }
                    let shift = cell.shift_vector(code);
                    let d: [f64; 3] = std::array::from_fn(|k| bodies[i][k] - bodies[j][k] - shift[k]);
                    let reach = bodies[i][3] + bodies[j][3] + 0.2;
                    if d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach {
                        expected.partner.push(j as u32);
                        expected.image.push(code);
                    }
                }
            }
            expected.start.push(expected.partner.len() as u32);
        }
        prop_assert_eq!(lists, expected);
    }
}
