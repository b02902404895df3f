//! Pair search and the order along the curve: `cargo bench -p granule-geometry`.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use granule_geometry::{BodyOrder, Cell, NeighbourGrid, PairScratch};

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

/// A layer of small spheres, ten deep, under one that is `ratio` times as large.
fn boulder(ratio: u32) -> (Vec<[f64; 4]>, Cell) {
    let (mut rows, _) = packing(100 * 100 * 100);
    rows.retain(|row| row[2] < 10.0);
    let radius = 0.5 * f64::from(ratio);
    rows.push([50.0, 50.0, 10.0 + radius, radius]);
    (rows, Cell::unbounded())
}

fn find(bencher: Bencher, (rows, cell): (Vec<[f64; 4]>, Cell)) {
    let (mut grid, mut scratch) = (NeighbourGrid::new(), PairScratch::default());
    bencher.counter(ItemsCount::new(rows.len())).bench_local(|| {
        grid.build(black_box(&rows), &cell, 0.1, false);
        let mut number = 0;
        grid.pairs_of(0..rows.len(), &mut scratch, |_, _, _| number += 1);
        number
    });
}

#[divan::bench(args = [10_000, 100_000])]
fn pairs(bencher: Bencher, count: usize) {
    find(bencher, packing(count));
}

#[divan::bench(args = [10, 100, 1000])]
fn pairs_with_a_boulder(bencher: Bencher, ratio: u32) {
    find(bencher, boulder(ratio));
}

#[divan::bench(args = [10_000, 100_000])]
fn curve_order(bencher: Bencher, count: usize) {
    let (rows, cell) = packing(count);
    let mut sorter = BodyOrder::new();
    let mut order = Vec::new();
    bencher.counter(ItemsCount::new(count)).bench_local(|| {
        sorter.sort(black_box(&rows), &cell, 1.1, false, &mut order);
        order.len()
    });
}
