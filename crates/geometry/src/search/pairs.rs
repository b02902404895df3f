//! Pairs from the cells of a grid.

use std::ops::Range;

use super::NeighbourGrid;
use super::near::{Near, Run, Step};
use crate::{NO_IMAGE, opposite_image};

/// Pairs found by one part of a search, and its scratch memory.
#[derive(Debug, Default)]
pub struct PairScratch {
    /// Candidates of one cell: where their rows are, and the image codes that lead to them.
    row: Vec<u32>,
    code: Vec<u8>,
    /// Neighbours of one body: row and image code in one number.
    near: Vec<u64>,
    /// Pairs: lower body and higher body in one number, and the image code.
    pair: Vec<u64>,
    image: Vec<u8>,
}

impl NeighbourGrid {
    /// The second step of [`Self::half_pairs`]: finds the pairs of one part of the grid, `part` of `parts` about equal
    /// ones. The parts are independent and may run on several threads, each with its own scratch memory.
    ///
    /// # Panics
    /// Unless `part < parts`.
    pub fn find(&self, part: usize, parts: usize, scratch: &mut PairScratch) {
        assert!(part < parts, "part {part} of {parts}");
        scratch.pair.clear();
        scratch.image.clear();
        let bins = &self.bins;
        // With three cells or more along a period the cells know the image of a pair, and no two cells are neighbours
        // in two ways.
        if bins.wrapped && (0..3).all(|axis| !bins.periodic[axis] || bins.count[axis] >= 3) {
            self.find_known(self.boundary(part, parts)..self.boundary(part + 1, parts), scratch);
        } else {
            self.find_unknown(self.boundary(part, parts)..self.boundary(part + 1, parts), scratch);
        }
    }

    /// The third step of [`Self::half_pairs`]: sorts the pairs of all parts, in whatever order, into a half list.
    ///
    /// # Panics
    /// When there are 2^32 pairs or more.
    pub fn assemble(
        &mut self,
        parts: &[PairScratch],
        start: &mut Vec<u32>,
        partner: &mut Vec<u32>,
        image: &mut Vec<u8>,
    ) {
        let pairs: usize = parts.iter().map(|part| part.pair.len()).sum();
        let pairs = u32::try_from(pairs).expect("fewer than 2^32 pairs");
        start.clear();
        start.resize(self.body.len() + 1, 0);
        for pair in parts.iter().flat_map(|part| &part.pair) {
            start[(pair >> 32) as usize] += 1;
        }
        let mut sum = 0;
        for entry in start.iter_mut() {
            sum += *entry;
            *entry = sum;
        }
        debug_assert_eq!(sum, pairs);
        // Filled from the end, each counter comes down to the start of its body.
        self.sorted.clear();
        self.sorted.resize(pairs as usize, 0);
        for part in parts {
            for (pair, &code) in part.pair.iter().zip(&part.image) {
                let entry = &mut start[(pair >> 32) as usize];
                *entry -= 1;
                self.sorted[*entry as usize] = (pair & u64::from(u32::MAX)) << 8 | u64::from(code);
            }
        }
        for ends in start.windows(2) {
            self.sorted[ends[0] as usize..ends[1] as usize].sort_unstable();
        }
        partner.clear();
        partner.extend(self.sorted.iter().map(|pair| (pair >> 8) as u32));
        image.clear();
        image.extend(self.sorted.iter().map(|pair| *pair as u8));
    }

    /// First cell of a part; parts have about equal numbers of bodies.
    fn boundary(&self, part: usize, parts: usize) -> usize {
        let bodies = self.body.len() as u128;
        let row = (bodies * part as u128 / parts as u128) as usize;
        match self.body.get(row) {
            _ if part == 0 => 0,
            Some(&body) => self.cell_of[body as usize] as usize,
            None => self.bins.cells(),
        }
    }

    /// Where the cells lie, for those of a range that hold bodies.
    fn occupied(&self, cells: Range<usize>) -> impl Iterator<Item = (usize, [usize; 3])> {
        let [nx, ny, _] = self.bins.count;
        let held = |cell: &usize| self.first[*cell] < self.first[*cell + 1];
        cells.filter(held).map(move |cell| (cell, [cell % nx, cell / nx % ny, cell / nx / ny]))
    }

    /// Each pair of neighbouring cells is looked at from one side: from the lower z, else the lower y, else the lower
    /// x (of the image).
    fn find_known(&self, cells: Range<usize>, scratch: &mut PairScratch) {
        let [nx, ny, nz] = self.bins.count;
        let [px, py, pz] = self.bins.periodic;
        let shifts = self.images.shifts();
        for (cell, [x, y, z]) in self.occupied(cells) {
            let (near_x, near_y) = (Near::new(x, nx, px), Near::new(y, ny, py));
            let mut count = 0;
            let mut line = |step_y: Step, step_z: Step, runs: &[Run]| {
                let line = nx * (step_y.cell + ny * step_z.cell);
                for run in runs {
                    let first = self.first[line + run.first];
                    let length = (self.first[line + run.last + 1] - first) as usize;
                    scratch.append(count, first, length, run.code + 3 * step_y.code + 9 * step_z.code);
                    count += length;
                }
            };
            let (here_y, here_z) = (Step { cell: y, code: 1 }, Step { cell: z, code: 1 });
            // The cell's own bodies come first.
            line(here_y, here_z, &[Run { first: x, last: x, code: 1 }]);
            if let Some(next) = Step::after(x, nx, px) {
                line(here_y, here_z, &[Run { first: next.cell, last: next.cell, code: next.code }]);
            }
            if let Some(next) = Step::after(y, ny, py) {
                line(next, here_z, near_x.runs());
            }
            if let Some(next) = Step::after(z, nz, pz) {
                for &step in near_y.cells() {
                    line(step, next, near_x.runs());
                }
            }
            let rows = self.first[cell] as usize..self.first[cell + 1] as usize;
            for (own, at) in rows.enumerate() {
                let row = self.rows[at];
                self.keep(at, own + 1..count, scratch, |_, other, code| {
                    let shift = &shifts[usize::from(code)];
                    let x = row[0] - other[0] - shift[0];
                    let y = row[1] - other[1] - shift[1];
                    let z = row[2] - other[2] - shift[2];
                    (x * x + y * y + z * z, code)
                });
            }
        }
    }

    /// All neighbouring cells are looked at, and of each pair of rows the lower looks at the higher.
    fn find_unknown(&self, cells: Range<usize>, scratch: &mut PairScratch) {
        let bins = &self.bins;
        for (cell, at) in self.occupied(cells) {
            let near: [Near; 3] =
                std::array::from_fn(|axis| Near::new(at[axis], bins.count[axis], bins.periodic[axis]));
            let mut count = 0;
            for z in near[2].cells() {
                for y in near[1].cells() {
                    let line = bins.count[0] * (y.cell + bins.count[1] * z.cell);
                    for run in near[0].runs() {
                        // Rows below the first of this cell belong to pairs that are found from the other side.
                        let first = self.first[line + run.first].max(self.first[cell]);
                        let length = self.first[line + run.last + 1].saturating_sub(first) as usize;
                        scratch.append(count, first, length, NO_IMAGE);
                        count += length;
                    }
                }
            }
            for at in self.first[cell] as usize..self.first[cell + 1] as usize {
                let row = self.rows[at];
                self.keep(at, 0..count, scratch, |place, other, _| {
                    let (squared, code) = self.images.nearest(&row, other);
                    (if place > at { squared } else { f64::INFINITY }, code)
                });
            }
        }
    }

    /// Notes the pairs of the row `at` with those candidates that are near by the squared distance that `measure`
    /// gives for a candidate's place, row and code.
    #[inline]
    fn keep(
        &self,
        at: usize,
        candidates: Range<usize>,
        scratch: &mut PairScratch,
        measure: impl Fn(usize, &[f64; 4], u8) -> (f64, u8),
    ) {
        if scratch.near.len() < candidates.len() {
            scratch.near.resize(candidates.len(), 0);
        }
        let radius = self.rows[at][3];
        let mut count = 0;
        for (&place, &code) in scratch.row[candidates.clone()].iter().zip(&scratch.code[candidates]) {
            let other = &self.rows[place as usize];
            let (squared, code) = measure(place as usize, other, code);
            let reach = radius + other[3] + self.margin;
            // Always written, counted if near: a branch here would be mispredicted too often.
            scratch.near[count] = u64::from(place) << 8 | u64::from(code);
            count += usize::from((squared < reach * reach) & (reach > 0.0));
        }
        let i = self.body[at];
        for near in &scratch.near[..count] {
            let (j, code) = (self.body[(near >> 8) as usize], *near as u8);
            let (low, high, code) = if i < j { (i, j, code) } else { (j, i, opposite_image(code)) };
            scratch.pair.push(u64::from(low) << 32 | u64::from(high));
            scratch.image.push(code);
        }
    }
}

impl PairScratch {
    /// Writes the rows `first..first + length` at place `at`, in blocks of eight without regard to what they overwrite
    /// beyond the end: most runs then take one block and no branch.
    #[inline]
    fn append(&mut self, at: usize, first: u32, length: usize, code: u8) {
        const BLOCK: usize = 8;
        let room = at + length + BLOCK;
        if self.row.len() < room {
            self.row.resize(room, 0);
            self.code.resize(room, 0);
        }
        let mut done = 0;
        loop {
            let block = &mut self.row[at + done..at + done + BLOCK];
            for (k, row) in block.iter_mut().enumerate() {
                *row = first.wrapping_add((done + k) as u32);
            }
            self.code[at + done..at + done + BLOCK].fill(code);
            done += BLOCK;
            if done >= length {
                return;
            }
        }
    }

    /// Memory held by the buffers, in entries.
    #[cfg(test)]
    pub(super) fn capacity(&self) -> usize {
        self.row.capacity()
            + self.code.capacity()
            + self.near.capacity()
            + self.pair.capacity()
            + self.image.capacity()
    }
}
