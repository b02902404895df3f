//! Bodies sorted into the cells of a grid.

use rayon::prelude::*;

use super::bins::{Bins, Bounds, Limit};
use super::near::Run;
use crate::Cell;

/// Most cells in a direction: three numbers of a cell fit into 63 bits.
const MOST_EACH: usize = 1 << 21;
/// Bodies that share a cell with a body, itself included, in the mean, from which coarse cells are too crowded.
const CROWDED: f64 = 6.0;
/// Rows that one thread copies at a time.
const CHUNK: usize = 1 << 13;
/// An empty slot, and no cell.
const NONE: u32 = u32::MAX;

/// Bodies of one size class in the order of their cells.
///
/// Where bodies fill space, every cell has its entry. Where they form dense heaps in a huge empty volume, only the cells
/// that hold bodies have one, and a hash table finds it: memory goes with the number of bodies, never with the volume.
#[derive(Debug, Default)]
pub(super) struct Cells {
    pub(super) bins: Bins,
    /// Largest radius.
    pub(super) largest: f64,
    /// Which bodies there are, ascending; unused if it is all of them.
    pub(super) members: Vec<u32>,
    /// First row of each cell; one more than there are cells.
    pub(super) first: Vec<u32>,
    /// Rows `[x, y, z, R]`, within a cell in the order given.
    pub(super) rows: Vec<[f64; 4]>,
    /// Which body a row is.
    pub(super) body: Vec<u32>,
    /// Where the cells lie that have an entry; empty if all have.
    place: Vec<[u32; 3]>,
    /// Entries by the hash of their place.
    slots: Vec<u32>,
}

impl Cells {
    /// Sorts bodies into cells. `row_of` gets the row of each.
    pub(super) fn build(
        &mut self,
        positions: &[[f64; 4]],
        all: bool,
        cell: &Cell,
        size: f64,
        row_of: &mut [u32],
        work: &mut Work<'_>,
    ) {
        let count = if all { positions.len() } else { self.members.len() };
        self.place.clear();
        self.slots.clear();
        self.bins = Bins::new(&work.bounds, cell, size, work.dense, work.sample);
        let crowding = self.number(positions, all, row_of, work.parallel);
        if self.bins.grown && crowding > CROWDED * count as f64 {
            let sparse = Limit { each: MOST_EACH, all: usize::MAX };
            self.bins = Bins::new(&work.bounds, cell, size, sparse, work.sample);
            self.number_sparse(positions, all, row_of);
        }
        self.fill(positions, all, row_of, work.parallel);
    }

    /// Mean number of bodies that share a cell with a body of a grid, itself included: what a search would look at.
    pub(super) fn crowding(
        &mut self,
        positions: &[[f64; 4]],
        cell: &Cell,
        size: f64,
        row_of: &mut [u32],
        work: &mut Work<'_>,
    ) -> f64 {
        self.place.clear();
        self.bins = Bins::new(&work.bounds, cell, size, work.dense, work.sample);
        self.number(positions, true, row_of, work.parallel) / positions.len().max(1) as f64
    }

    /// Notes the cell of each body, counts the bodies of each cell in `first`, and returns the sum of the squares of
    /// these numbers.
    fn number(&mut self, positions: &[[f64; 4]], all: bool, cell_of: &mut [u32], parallel: bool) -> f64 {
        let bins = &self.bins;
        let number = |row: &[f64; 4]| bins.index(bins.of(row)) as u32;
        self.first.clear();
        self.first.resize(bins.cells() + 1, 0);
        if all {
            if parallel {
                cell_of.par_iter_mut().zip(positions).for_each(|(cell, row)| *cell = number(row));
            } else {
                cell_of.iter_mut().zip(positions).for_each(|(cell, row)| *cell = number(row));
            }
            cell_of.iter().for_each(|cell| self.first[*cell as usize] += 1);
        } else {
            for &body in &self.members {
                let cell = number(&positions[body as usize]);
                cell_of[body as usize] = cell;
                self.first[cell as usize] += 1;
            }
        }
        self.first.iter().map(|&n| f64::from(n) * f64::from(n)).sum()
    }

    /// The same with entries for those cells only that hold bodies, in the order of their first bodies.
    fn number_sparse(&mut self, positions: &[[f64; 4]], all: bool, cell_of: &mut [u32]) {
        let count = if all { positions.len() } else { self.members.len() };
        self.first.clear();
        self.slots.resize((2 * count + 2).next_power_of_two(), NONE);
        for k in 0..count {
            let body = if all { k } else { self.members[k] as usize };
            let at = self.bins.of(&positions[body]).map(|x| x as u32);
            let slot = self.slot(at);
            if self.slots[slot] == NONE {
                self.slots[slot] = self.place.len() as u32;
                self.place.push(at);
                self.first.push(0);
            }
            cell_of[body] = self.slots[slot];
            self.first[self.slots[slot] as usize] += 1;
        }
        self.first.push(0);
    }

    /// Slot of a place, or the free one where it would be.
    fn slot(&self, at: [u32; 3]) -> usize {
        let key = u64::from(at[0]) | u64::from(at[1]) << 21 | u64::from(at[2]) << 42;
        let mask = self.slots.len() - 1;
        // Fibonacci hashing: the upper bits of the product depend on all bits of the key.
        let mut slot = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & mask;
        while self.slots[slot] != NONE && self.place[self.slots[slot] as usize] != at {
            slot = (slot + 1) & mask;
        }
        slot
    }

    /// Turns counts into first rows and cells into rows.
    fn fill(&mut self, positions: &[[f64; 4]], all: bool, row_of: &mut [u32], parallel: bool) {
        let count = if all { positions.len() } else { self.members.len() };
        let mut sum = 0;
        for first in &mut self.first {
            sum += *first;
            *first = sum;
        }
        self.body.resize(count, 0);
        // Filled from the end, each cell's counter comes down to its first row and the given order is kept.
        for k in (0..count).rev() {
            let body = if all { k } else { self.members[k] as usize };
            let first = &mut self.first[row_of[body] as usize];
            *first -= 1;
            row_of[body] = *first;
            self.body[*first as usize] = body as u32;
        }
        self.rows.resize(count, [0.0; 4]);
        let copy = |(rows, bodies): (&mut [[f64; 4]], &[u32])| {
            for (row, body) in rows.iter_mut().zip(bodies) {
                *row = positions[*body as usize];
            }
        };
        if parallel {
            self.rows.par_chunks_mut(CHUNK).zip(self.body.par_chunks(CHUNK)).for_each(copy);
        } else {
            copy((&mut self.rows, &self.body));
        }
        self.largest = self.rows.iter().fold(0.0, |most: f64, row| most.max(row[3]));
    }

    /// The rows of consecutive cells of a line, as one or more runs of consecutive rows.
    #[inline]
    pub(super) fn rows_of(&self, x: &Run, y: usize, z: usize, mut each: impl FnMut(u32, u32)) {
        if self.all_have_entries() {
            let line = self.bins.count[0] * (y + self.bins.count[1] * z);
            each(self.first[line + x.first], self.first[line + x.last + 1]);
        } else {
            for x in x.first..=x.last {
                let cell = self.slots[self.slot([x as u32, y as u32, z as u32])];
                if cell != NONE {
                    each(self.first[cell as usize], self.first[cell as usize + 1]);
                }
            }
        }
    }

    /// Whether each cell of the grid has an entry, in the order of the cells.
    #[inline]
    pub(super) fn all_have_entries(&self) -> bool {
        self.place.is_empty()
    }

    /// With three cells or more along each period the cells know the image of a pair, and no two cells are neighbours in
    /// two ways.
    pub(super) fn knows_images(&self) -> bool {
        let bins = &self.bins;
        bins.wrapped && (0..3).all(|axis| !bins.periodic[axis] || bins.count[axis] >= 3)
    }

    /// Heap bytes.
    pub(super) fn bytes(&self) -> usize {
        4 * (self.members.capacity() + self.first.capacity() + self.body.capacity() + self.slots.capacity())
            + 32 * self.rows.capacity()
            + 12 * self.place.capacity()
    }
}

/// What the classes of a search have in common while they are built.
pub(super) struct Work<'a> {
    pub(super) bounds: Bounds<'a>,
    pub(super) dense: Limit,
    pub(super) sample: &'a mut Vec<f64>,
    pub(super) parallel: bool,
}
