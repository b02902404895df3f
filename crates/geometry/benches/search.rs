//! Pair search and the order along the curve: `cargo bench -p granule-geometry`.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use granule_geometry::{Cell, NeighbourGrid};

fn main() {
    divan::main();
}

/// Spheres of diameter 1 on a shaken cubic lattice between periodic sides: about as dense as a packing.
fn packing(count: usize) -> (Vec<[f64; 4]>, Cell) {
    let side = (count as f64).cbrt().ceil() as usize;
    let mut state = 1_u64;
    let mut shake = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        0.3 * ((state >> 40) as f64 / (1_u64 << 24) as f64 - 0.5)
    };
    let place = |k: usize| [k % side, k / side % side, k / side / side];
    let rows = (0..count).map(|k| {
        let [x, y, z] = place(k).map(|c| c as f64 + 0.5 + shake());
        [x, y, z, 0.5]
    });
    let length = side as f64;
    let cell = Cell::new([0.0; 3], [length; 3], [true; 3]).expect("a finite cube");
    (rows.collect(), cell)
}

#[divan::bench(args = [10_000, 100_000])]
fn pairs(bencher: Bencher, count: usize) {
    let (rows, cell) = packing(count);
    let mut grid = NeighbourGrid::new();
    let (mut start, mut partner, mut image) = (Vec::new(), Vec::new(), Vec::new());
    bencher.counter(ItemsCount::new(count)).bench_local(|| {
        grid.half_pairs(black_box(&rows), &cell, 0.1, &mut start, &mut partner, &mut image);
        partner.len()
    });
}

#[divan::bench(args = [10_000, 100_000])]
fn curve_order(bencher: Bencher, count: usize) {
    let (rows, cell) = packing(count);
    let mut grid = NeighbourGrid::new();
    let mut order = Vec::new();
    bencher.counter(ItemsCount::new(count)).bench_local(|| {
        grid.cell_order(black_box(&rows), &cell, 1.1, &mut order);
        order.len()
    });
}
