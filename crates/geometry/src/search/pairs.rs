//! Pairs from the cells of the grids.

use std::ops::Range;

use super::NeighbourGrid;
use super::bins::Span;
use super::cells::Cells;
use super::near::{Near, Run, Step};
use crate::IMAGE_CODES;

/// Scratch memory of one thread that looks for pairs.
#[derive(Debug, Default)]
pub struct PairScratch {
    /// Neighbours of one body: row and image code in one number.
    near: Vec<u64>,
    /// Candidates in the grids of larger bodies.
    larger: Vec<Larger>,
}

impl PairScratch {
    /// Heap bytes.
    pub fn bytes(&self) -> usize {
        8 * self.near.capacity()
            + self.larger.iter().map(|larger| larger.rows.capacity() * size_of::<(u32, u8)>()).sum::<usize>()
    }
}

/// Candidates among larger bodies for all bodies in one place.
#[derive(Debug, Default)]
struct Larger {
    /// Which cells the candidates come from.
    around: Option<[Span; 3]>,
    /// Rows and image codes.
    rows: Vec<(u32, u8)>,
}

impl NeighbourGrid {
    /// Tells `found` the pairs that belong to a range of the bodies of [`Self::build`], one body after the other: the
    /// body, its partner, and the image code. Each pair belongs to one of its two bodies, the smaller one where sizes
    /// differ much. Ranges are independent and may run on several threads, each with its own scratch memory.
    ///
    /// # Panics
    /// When the range goes beyond the bodies.
    pub fn pairs_of(
        &self,
        bodies: Range<usize>,
        scratch: &mut PairScratch,
        mut found: impl FnMut(u32, u32, u8),
    ) {
        let shifts = self.images.shifts();
        if scratch.larger.len() < self.used {
            scratch.larger.resize_with(self.used, Larger::default);
        }
        scratch.larger.iter_mut().for_each(|larger| larger.around = None);
        for i in bodies {
            let level = if self.used > 1 { usize::from(self.level_of[i]) } else { 0 };
            let own = &self.levels[level];
            let at = self.row_of[i];
            let row = own.rows[at as usize];
            let count = if own.knows_images() {
                self.alike_known(own, at, &row, &shifts, &mut scratch.near)
            } else {
                self.alike_unknown(own, at, &row, &mut scratch.near)
            };
            for near in &scratch.near[..count] {
                found(i as u32, own.body[(near >> 8) as usize], *near as u8);
            }
            for (larger, candidates) in self.levels[..level].iter().zip(&mut scratch.larger) {
                if larger.rows.is_empty() {
                    continue;
                }
                self.larger(larger, &row, &shifts, candidates, |other, code| found(i as u32, other, code));
            }
        }
    }

    /// Pairs with later rows of the own cell and with all rows of the cells on one side: with higher z, else higher y,
    /// else higher x (of the image).
    #[inline]
    fn alike_known(
        &self,
        cells: &Cells,
        at: u32,
        row: &[f64; 4],
        shifts: &[[f64; 3]; IMAGE_CODES],
        near: &mut Vec<u64>,
    ) -> usize {
        let bins = &cells.bins;
        let ([nx, ny, nz], [px, py, pz]) = (bins.count, bins.periodic);
        let [x, y, z] = bins.of(row);
        let mut count = 0;
        let mut look = |x: &Run, step_y: Step, step_z: Step, least: u32| {
            let code = x.code + 3 * step_y.code + 9 * step_z.code;
            let shift = &shifts[usize::from(code)];
            cells.rows_of(x, step_y.cell, step_z.cell, |first, end| {
                let first = first.max(least);
                let rows = &cells.rows[first.min(end) as usize..end as usize];
                if near.len() < count + rows.len() {
                    near.resize(count + 2 * rows.len() + 64, 0);
                }
                for (other, place) in rows.iter().zip(first..) {
                    let x = row[0] - other[0] - shift[0];
                    let y = row[1] - other[1] - shift[1];
                    let z = row[2] - other[2] - shift[2];
                    let squared = x * x + y * y + z * z;
                    let reach = row[3] + other[3] + self.margin;
                    // Always written, counted if near: a branch here would be mispredicted too often.
                    near[count] = u64::from(place) << 8 | u64::from(code);
                    count += usize::from((squared < reach * reach) & (reach > 0.0));
                }
            });
        };
        let (here_y, here_z) = (Step { cell: y, code: 1 }, Step { cell: z, code: 1 });
        // Rows of the own cell and the next one follow each other where all cells have an entry.
        let joined = x + 1 < nx && cells.all_have_entries();
        look(&Run { first: x, last: x + usize::from(joined), code: 1 }, here_y, here_z, at + 1);
        if !joined && let Some(next) = Step::after(x, nx, px) {
            look(&Run { first: next.cell, last: next.cell, code: next.code }, here_y, here_z, 0);
        }
        let near_x = Near::new(x, nx, px);
        if let Some(next) = Step::after(y, ny, py) {
            near_x.runs().iter().for_each(|run| look(run, next, here_z, 0));
        }
        if let Some(next) = Step::after(z, nz, pz) {
            for &step in Near::new(y, ny, py).cells() {
                near_x.runs().iter().for_each(|run| look(run, step, next, 0));
            }
        }
        count
    }

    /// All neighbouring cells are looked at, and of each pair of rows the lower looks at the higher.
    fn alike_unknown(&self, cells: &Cells, at: u32, row: &[f64; 4], near: &mut Vec<u64>) -> usize {
        let mut count = 0;
        every_cell(cells, row, |first, end| {
            let first = first.max(at + 1);
            for place in first..end.max(first) {
                if let Some(code) = self.near_image(row, &cells.rows[place as usize]) {
                    if near.len() <= count {
                        near.resize(2 * count + 64, 0);
                    }
                    near[count] = u64::from(place) << 8 | u64::from(code);
                    count += 1;
                }
            }
        });
        count
    }

    /// Pairs of a body with those of a grid of larger ones.
    #[inline]
    fn larger(
        &self,
        cells: &Cells,
        row: &[f64; 4],
        shifts: &[[f64; 3]; IMAGE_CODES],
        candidates: &mut Larger,
        mut found: impl FnMut(u32, u8),
    ) {
        if !cells.knows_images() {
            every_cell(cells, row, |first, end| {
                for place in first..end {
                    if let Some(code) = self.near_image(row, &cells.rows[place as usize]) {
                        found(cells.body[place as usize], code);
                    }
                }
            });
            return;
        }
        let reach = (row[3] + cells.largest + self.margin) * (1.0 + 1e-6);
        let around: [Span; 3] = std::array::from_fn(|axis| cells.bins.around(axis, row[axis], reach));
        if candidates.around != Some(around) {
            candidates.around = Some(around);
            candidates.rows.clear();
            let near: [Near; 3] =
                std::array::from_fn(|axis| Near::within(around[axis], cells.bins.count[axis]));
            for z in near[2].cells() {
                for y in near[1].cells() {
                    for x in near[0].runs() {
                        let code = x.code + 3 * y.code + 9 * z.code;
                        cells.rows_of(x, y.cell, z.cell, |first, end| {
                            candidates.rows.extend((first..end).map(|place| (place, code)));
                        });
                    }
                }
            }
        }
        for &(place, code) in &candidates.rows {
            let (other, shift) = (&cells.rows[place as usize], &shifts[usize::from(code)]);
            let x = row[0] - other[0] - shift[0];
            let y = row[1] - other[1] - shift[1];
            let z = row[2] - other[2] - shift[2];
            let reach = row[3] + other[3] + self.margin;
            if x * x + y * y + z * z < reach * reach && reach > 0.0 {
                found(cells.body[place as usize], code);
            }
        }
    }

    /// Image code of a pair that is near through its nearest image.
    #[inline]
    fn near_image(&self, row: &[f64; 4], other: &[f64; 4]) -> Option<u8> {
        let (squared, code) = self.images.nearest(row, other);
        let reach = row[3] + other[3] + self.margin;
        (squared < reach * reach && reach > 0.0).then_some(code)
    }
}

/// Rows of all cells around that of a body.
fn every_cell(cells: &Cells, row: &[f64; 4], mut each: impl FnMut(u32, u32)) {
    let (bins, at) = (&cells.bins, cells.bins.of(row));
    let near: [Near; 3] =
        std::array::from_fn(|axis| Near::new(at[axis], bins.count[axis], bins.periodic[axis]));
    for z in near[2].cells() {
        for y in near[1].cells() {
            for run in near[0].runs() {
                cells.rows_of(run, y.cell, z.cell, &mut each);
            }
        }
    }
}
