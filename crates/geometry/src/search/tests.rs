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
    let mut order = vec![7];
    grid.cell_order(&[], &cell, 0.1, &mut order);
    assert!(order.is_empty());
    grid.cell_order(&one, &cell, 0.1, &mut order);
    assert_eq!(order, [0]);
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
        let mut order = Vec::new();
        grid.cell_order(&bodies, &cell, 0.1, &mut order);
        order.sort_unstable();
        assert!(order.iter().copied().eq(0..3000));
    }
}

#[test]
fn an_outlier_does_not_make_the_cells_coarse() {
    let mut bodies = bodies_in(20_000, [0.0; 3], [1.0; 3], [0.01, 0.01], 9);
    bodies[0] = [1e9, 1e9, -1e9, 0.01];
    let mut sample = Vec::new();
    let most = 2 * bodies.len();
    let bins = bins::Bins::new(&bodies, &Cell::unbounded(), 0.04, most, most, &mut sample);
    // 25 cells across the bodies, and at most a quarter and a cell more at each side.
    assert!(bins.count.iter().all(|&n| (25..=42).contains(&n)), "{:?}", bins.count);
}

#[test]
fn parts_in_any_order_give_the_same_list() {
    let bodies = bodies_in(500, [0.0; 3], [1.0; 3], [0.02, 0.06], 3);
    // A period of one cell, of many cells, and bodies outside the period take different paths.
    for (hi, margin) in [([1.0; 3], 0.01), ([0.8, 1.0, 1.0], 0.01), ([1.0; 3], 0.3)] {
        let cell = Cell::new([0.0; 3], hi, [true, true, false]).unwrap();
        let mut grid = NeighbourGrid::new();
        let whole = by_grid(&mut grid, &bodies, &cell, margin);
        assert!(!whole.partner.is_empty());
        for parts in [2, 7, 600] {
            let mut found: Vec<PairScratch> = (0..parts).map(|_| PairScratch::default()).collect();
            grid.build(&bodies, &cell, margin);
            for (part, scratch) in found.iter_mut().enumerate() {
                grid.find(part, parts, scratch);
            }
            found.reverse();
            let mut lists = Lists::default();
            grid.assemble(&found, &mut lists.start, &mut lists.partner, &mut lists.image);
            assert_eq!(lists, whole);
        }
    }
}

#[test]
fn a_second_call_allocates_nothing() {
    let cell = Cell::new([0.0; 3], [1.0; 3], [true, false, true]).unwrap();
    let bodies = bodies_in(2000, [0.0; 3], [1.0; 3], [0.02, 0.03], 3);
    let mut grid = NeighbourGrid::new();
    let (mut lists, mut order) = (Lists::default(), Vec::new());
    let mut memory = Vec::new();
    for _ in 0..3 {
        grid.half_pairs(&bodies, &cell, 0.01, &mut lists.start, &mut lists.partner, &mut lists.image);
        grid.cell_order(&bodies, &cell, 0.05, &mut order);
        memory.push((grid.capacities(), lists.start.as_ptr(), lists.partner.as_ptr(), order.as_ptr()));
    }
    assert_eq!(memory[1], memory[2]);
    assert_eq!(memory[0], memory[1]);
}

#[test]
fn the_order_follows_a_curve() {
    // One body in each cell of an 8 x 8 x 8 block, given in a scrambled order: consecutive bodies share a face.
    let bodies: Vec<[f64; 4]> = (0..512u32)
        .map(|k| k * 205 % 512)
        .map(|k| [f64::from(k % 8) + 0.5, f64::from(k / 8 % 8) + 0.5, f64::from(k / 64) + 0.5, 0.5])
        .collect();
    let cell = Cell::new([0.0; 3], [8.0; 3], [true; 3]).unwrap();
    let mut order = Vec::new();
    NeighbourGrid::new().cell_order(&bodies, &cell, 1.0, &mut order);
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
    NeighbourGrid::new().cell_order(&layer, &Cell::unbounded(), 1.0, &mut order);
    for pair in order.windows(2) {
        let (a, b) = (layer[pair[0] as usize], layer[pair[1] as usize]);
        assert_eq!((a[0] - b[0]).abs() + (a[2] - b[2]).abs(), 1.0);
    }
}

#[test]
fn order_takes_any_size() {
    let bodies = bodies_in(100, [0.0; 3], [1.0; 3], [0.1, 0.1], 1);
    let mut order = Vec::new();
    for size in [0.0, -1.0, f64::NAN, 1e-300, 1e300, f64::INFINITY] {
        NeighbourGrid::new().cell_order(&bodies, &Cell::unbounded(), size, &mut order);
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
