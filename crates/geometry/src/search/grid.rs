//! Counting-sort cell list.

use super::Images;
use super::bins::Bins;
use super::curve::hilbert_index;
use super::pairs::PairScratch;
use crate::Cell;

/// Finds which bodies are near each other with a grid of cells, in a time proportional to their number.
///
/// Bodies are sorted into cells that are as wide as the largest interaction distance, so each body looks at the 27
/// cells around its own (at half of them, as each pair is met once). With radii of one size class that is nearly the best one can do; with a few very large bodies
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
    pub(super) bins: Bins,
    pub(super) images: Images,
    pub(super) margin: f64,
    /// First entry of each cell in `rows` and `body`; one more than there are cells.
    pub(super) first: Vec<u32>,
    /// Cell of each body.
    pub(super) cell_of: Vec<u32>,
    /// Rows of the bodies in the order of their cells, within a cell in the order given.
    pub(super) rows: Vec<[f64; 4]>,
    /// Which body a row is.
    pub(super) body: Vec<u32>,
    /// Pairs sorted by their first body: partner and image in one number.
    pub(super) sorted: Vec<u64>,
    scratch: PairScratch,
    sample: Vec<f64>,
    keys: Vec<(u64, u32)>,
}

impl NeighbourGrid {
    /// An empty grid.
    pub fn new() -> Self {
        Self::default()
    }

    /// The order of the bodies along a Hilbert curve through grid cells of width `size` (m).
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

    /// All pairs nearer than the sum of their radii and `margin` (m), as a half list.
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
        let mut scratch = std::mem::take(&mut self.scratch);
        self.find(0, 1, &mut scratch);
        self.assemble(std::slice::from_ref(&scratch), start, partner, image);
        self.scratch = scratch;
    }

    /// The first of the three steps of [`Self::half_pairs`]: sorts the bodies into cells. The others are
    /// [`Self::find`], whose parts can run on several threads, and [`Self::assemble`].
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
}

#[cfg(test)]
impl NeighbourGrid {
    /// Memory held by the buffers, in entries.
    pub(super) fn capacities(&self) -> [usize; 8] {
        [
            self.first.capacity(),
            self.cell_of.capacity(),
            self.rows.capacity(),
            self.body.capacity(),
            self.sorted.capacity(),
            self.scratch.capacity(),
            self.sample.capacity(),
            self.keys.capacity(),
        ]
    }
}

fn check_number(bodies: usize) {
    assert!(u32::try_from(bodies).is_ok(), "fewer than 2^32 bodies");
}
