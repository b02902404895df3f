//! Counting-sort cell list.

use std::ops::Range;

use super::Images;
use super::bins::Bins;
use super::curve::hilbert_index;
use crate::{Cell, NO_IMAGE};

/// Finds which bodies are near each other with a grid of cells, in a time proportional to their number.
///
/// Bodies are sorted into cells that are as wide as the largest interaction distance, so each body looks at the 27
/// cells around its own. With radii of one size class that is nearly the best one can do; with a few very large bodies
/// among many small ones the cells hold many small bodies and the search slows down (as the third power of the ratio
/// of radii), while the result stays the same. A grid per size class can replace the single one behind the same two
/// methods, [`Self::half_pairs`] and [`Self::cell_order`]; callers see no cells.
///
/// The result depends on the arguments alone, never on the history of the grid. Buffers are kept between calls: a
/// second call with the same sizes allocates nothing.
///
/// # Conventions
/// A row is `[x, y, z, R]` in m. In periodic directions positions should be wrapped into the cell first
/// ([`Cell::wrap`]); a pair whose separation along a period is below 1.5 periods is still found. Each pair is listed
/// through its nearest image only; [`Cell::check_minimum_length`] says whether that is enough. A position that is not
/// finite has no neighbours.
#[derive(Debug, Default)]
pub struct NeighbourGrid {
    bins: Bins,
    images: Images,
    margin: f64,
    /// First entry of each cell in `rows` and `body`; one more than there are cells.
    first: Vec<u32>,
    /// Cell of each body.
    cell_of: Vec<u32>,
    /// Rows of the bodies in the order of their cells, within a cell in the order given.
    rows: Vec<[f64; 4]>,
    /// Which body a row is.
    body: Vec<u32>,
    /// Pairs found for one body: partner and image in one number.
    found: Vec<u64>,
    sample: Vec<f64>,
    keys: Vec<(u64, u32)>,
}

impl NeighbourGrid {
    /// An empty grid.
    pub fn new() -> Self {
        Self::default()
    }

    /// The order of the bodies along a Hilbert curve through grid cells of width `size` [m].
    ///
    /// `out` becomes a permutation: `out[k]` is the body that comes k-th. Bodies of one cell keep their order. The
    /// cells are made wider where the grid would have more than 2^21 of them in a direction; a `size` that is not
    /// positive stands for the finest grid.
    ///
    /// # Panics
    /// When there are 2^32 bodies or more.
    pub fn cell_order(&mut self, positions: &[[f64; 4]], cell: &Cell, size: f64, out: &mut Vec<u32>) {
        const BITS: u32 = 21;
        check_number(positions.len());
        let size = if size > 0.0 { size } else { f64::MIN_POSITIVE };
        let bins = Bins::new(positions, cell, size, 1 << BITS, usize::MAX, &mut self.sample);
        let widest = bins.count.iter().copied().max().unwrap_or(1);
        let bits = usize::BITS - (widest - 1).leading_zeros();
        // A curve through a cube is torn where the grid is one cell thick; use the curve of the square or the line.
        let thick: [bool; 3] = bins.count.map(|n| n > 1);
        let place = |position: &[f64; 4]| {
            let at = bins.of(position).map(|c| c as u32);
            match thick {
                [true, true, true] => hilbert_index(at, bits),
                [true, true, false] => hilbert_index([at[0], at[1]], bits),
                [true, false, true] => hilbert_index([at[0], at[2]], bits),
                [false, true, true] => hilbert_index([at[1], at[2]], bits),
                // At most one of them is not 0.
                _ => u64::from(at[0] + at[1] + at[2]),
            }
        };
        self.keys.clear();
        self.keys.extend(positions.iter().zip(0..).map(|(position, k)| (place(position), k)));
        self.keys.sort_unstable();
        out.clear();
        out.extend(self.keys.iter().map(|&(_, k)| k));
    }

    /// All pairs nearer than the sum of their radii and `margin` [m], as a half list.
    ///
    /// `start` has one entry more than there are bodies; the partners of body i are `partner[start[i]..start[i + 1]]`,
    /// all above i, ascending, each once, and `image` holds the code of each pair: the separation is
    /// `x_i - x_j - s*L` ([`crate::image_code`], [`Cell::shift_vector`]).
    ///
    /// # Panics
    /// When there are 2^32 bodies or pairs or more.
    pub fn half_pairs(
        &mut self,
        position_radius: &[[f64; 4]],
        cell: &Cell,
        margin: f64,
        start: &mut Vec<u32>,
        partner: &mut Vec<u32>,
        image: &mut Vec<u8>,
    ) {
        self.build(position_radius, cell, margin);
        let mut found = std::mem::take(&mut self.found);
        self.pairs_of(0..position_radius.len(), position_radius, &mut found, start, partner, image);
        self.found = found;
    }

    /// The first half of [`Self::half_pairs`]: sorts the bodies into cells.
    ///
    /// # Panics
    /// When there are 2^32 bodies or more.
    pub fn build(&mut self, position_radius: &[[f64; 4]], cell: &Cell, margin: f64) {
        let n = position_radius.len();
        check_number(n);
        let largest = position_radius.iter().fold(0.0, |most: f64, row| most.max(row[3]));
        let reach = 2.0 * largest + margin;
        // Wider by far more than the rounding of a cell number, so that a pair within reach never skips a cell.
        let size = if reach > 0.0 { reach * (1.0 + 1e-6) } else { f64::INFINITY };
        let most = (2 * n + 64).min(u32::MAX as usize);
        let bins = Bins::new(position_radius, cell, size, most, most, &mut self.sample);
        (self.bins, self.images, self.margin) = (bins, Images::new(cell), margin);

        self.first.clear();
        self.first.resize(bins.cells() + 1, 0);
        self.cell_of.clear();
        for row in position_radius {
            let index = bins.index(bins.of(row));
            self.cell_of.push(index as u32);
            self.first[index] += 1;
        }
        let mut sum = 0;
        for first in &mut self.first {
            sum += *first;
            *first = sum;
        }
        // Filled from the end, each cell's counter comes down to its first entry and the given order is kept.
        self.rows.resize(n, [0.0; 4]);
        self.body.resize(n, 0);
        for k in (0..n).rev() {
            let first = &mut self.first[self.cell_of[k] as usize];
            *first -= 1;
            self.rows[*first as usize] = position_radius[k];
            self.body[*first as usize] = k as u32;
        }
    }

    /// The second half of [`Self::half_pairs`] for some of the bodies, so that several threads can share the work.
    ///
    /// `position_radius` is what [`Self::build`] was given. The three lists are cleared and then describe the bodies
    /// of the range: `start` counts from 0 at the first of them. `found` is scratch memory.
    ///
    /// # Panics
    /// When there are 2^32 pairs or more, or the range leaves the bodies that the grid was built from.
    pub fn pairs_of(
        &self,
        bodies: Range<usize>,
        position_radius: &[[f64; 4]],
        found: &mut Vec<u64>,
        start: &mut Vec<u32>,
        partner: &mut Vec<u32>,
        image: &mut Vec<u8>,
    ) {
        start.clear();
        partner.clear();
        image.clear();
        start.push(0);
        // With three cells or more along a period, two neighbouring cells know the image of their pairs.
        let bins = &self.bins;
        let known = bins.wrapped && (0..3).all(|axis| !bins.periodic[axis] || bins.count[axis] >= 3);
        for i in bodies {
            let row = &position_radius[i];
            let count =
                if known { self.search::<true>(i, row, found) } else { self.search::<false>(i, row, found) };
            let pairs = &mut found[..count];
            pairs.sort_unstable();
            partner.extend(pairs.iter().map(|pair| (pair >> 8) as u32));
            image.extend(pairs.iter().map(|pair| *pair as u8));
            start.push(u32::try_from(partner.len()).expect("fewer than 2^32 pairs"));
        }
    }

    /// Writes the partners of body i above i to `found` and returns their number. `KNOWN`: the image of a pair follows
    /// from the cells.
    #[inline]
    fn search<const KNOWN: bool>(&self, i: usize, row: &[f64; 4], found: &mut Vec<u64>) -> usize {
        let bins = &self.bins;
        let at = bins.of(row);
        let runs: [Runs; 3] =
            std::array::from_fn(|axis| around(at[axis], bins.count[axis], bins.periodic[axis]));
        let period = self.images.period;
        let mut count = 0;
        for (z, sz) in runs[2].cells() {
            for (y, sy) in runs[1].cells() {
                let line = bins.count[0] * (y + bins.count[1] * z);
                for (low, high, sx) in runs[0].pieces() {
                    let first = self.first[line + low] as usize;
                    let last = self.first[line + high + 1] as usize;
                    let shift =
                        [f64::from(sx) * period[0], f64::from(sy) * period[1], f64::from(sz) * period[2]];
                    let code = (i32::from(NO_IMAGE) + sx + 3 * sy + 9 * sz) as u64;
                    if found.len() < count + (last - first) {
                        found.resize(count + (last - first), 0);
                    }
                    for (other, &j) in self.rows[first..last].iter().zip(&self.body[first..last]) {
                        let (squared, code) = if KNOWN {
                            let x = row[0] - other[0] - shift[0];
                            let y = row[1] - other[1] - shift[1];
                            let z = row[2] - other[2] - shift[2];
                            (x * x + y * y + z * z, code)
                        } else {
                            let (squared, code) = self.images.nearest(row, other);
                            (squared, u64::from(code))
                        };
                        let reach = row[3] + other[3] + self.margin;
                        // Always written, counted if near: a branch here would be mispredicted half of the time.
                        found[count] = u64::from(j) << 8 | code;
                        let near = (squared < reach * reach) & (reach > 0.0) & (j as usize > i);
                        count += usize::from(near);
                    }
                }
            }
        }
        count
    }
}

#[cfg(test)]
impl NeighbourGrid {
    /// Memory held by each buffer.
    pub(super) fn capacities(&self) -> [usize; 7] {
        [
            self.first.capacity(),
            self.cell_of.capacity(),
            self.rows.capacity(),
            self.body.capacity(),
            self.found.capacity(),
            self.sample.capacity(),
            self.keys.capacity(),
        ]
    }
}

fn check_number(bodies: usize) {
    assert!(u32::try_from(bodies).is_ok(), "fewer than 2^32 bodies");
}

/// Up to two runs of neighbouring cells along one direction, first and last cell and image shift of each.
type Runs = [(usize, usize, i32); 2];

trait RunsExt {
    fn pieces(&self) -> impl Iterator<Item = (usize, usize, i32)>;
    fn cells(&self) -> impl Iterator<Item = (usize, i32)>;
}

impl RunsExt for Runs {
    /// The runs that are not empty.
    fn pieces(&self) -> impl Iterator<Item = (usize, usize, i32)> {
        self.iter().copied().filter(|(low, high, _)| low <= high)
    }

    fn cells(&self) -> impl Iterator<Item = (usize, i32)> {
        self.pieces().flat_map(|(low, high, shift)| (low..=high).map(move |cell| (cell, shift)))
    }
}

/// The cell `at` and its neighbours among `count` cells, each once.
#[inline]
fn around(at: usize, count: usize, periodic: bool) -> Runs {
    const NONE: (usize, usize, i32) = (1, 0, 0);
    let direct = (at.saturating_sub(1), (at + 1).min(count - 1), 0);
    // Along a period of one or two cells `direct` already holds all of them.
    if !periodic || count < 3 {
        [direct, NONE]
    } else if at == 0 {
        // x_i is small and x_j large: x_i - x_j is about minus one period.
        [direct, (count - 1, count - 1, -1)]
    } else if at == count - 1 {
        [direct, (0, 0, 1)]
    } else {
        [direct, NONE]
    }
}
