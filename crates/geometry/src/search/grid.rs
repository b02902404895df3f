//! Neighbour search with one grid for each size class.

use super::Images;
use super::bins::{Bounds, Limit};
use super::cells::{Cells, Work};
use super::pairs::PairScratch;
use super::sizes::Sizes;
use crate::{Cell, opposite_image};

/// Bodies that share a cell with a body of a single grid, itself included, in the mean, up to which the single grid is
/// kept: a dense packing of equal spheres has 2 to 3, and more grids cost as much as looking at some 20 candidates more.
const FLAT: f64 = 4.0;

/// Finds which bodies are near each other with grids of cells, in a time proportional to their number.
///
/// Bodies are sorted into cells that are as wide as the largest interaction distance, so each body looks at the 27
/// cells around its own (at half of them, as each pair is met once). Where sizes differ so much that such cells hold
/// many small bodies, each size class gets a grid of its own: pairs within a class are found in its grid, and a body
/// looks for larger ones in the grids of the larger classes (Iwai, Hong, Greil, Int. J. Mod. Phys. C 10, 823, 1999;
/// Ogarko, Luding, Comput. Phys. Commun. 183, 931, 2012).
///
/// The result depends on the arguments alone, never on the history of the grid or the number of threads. Buffers are
/// kept between calls: a second call with the same sizes allocates nothing.
///
/// # Conventions
/// A row is `[x, y, z, R]` in m. In periodic directions positions should be wrapped into the cell first
/// ([`Cell::wrap`]); a pair whose separation along a period is below 1.5 periods is still found. Each pair is listed
/// through its nearest image only; [`Cell::check_minimum_length`] says whether that is enough. A position that is not
/// finite has no neighbours.
#[derive(Debug, Default)]
pub struct NeighbourGrid {
    pub(super) images: Images,
    pub(super) margin: f64,
    /// Grids of the size classes in use, from the largest bodies.
    pub(super) levels: Vec<Cells>,
    pub(super) used: usize,
    /// Class of each body; unused with one class.
    pub(super) level_of: Vec<u8>,
    /// Row of each body in the grid of its class.
    pub(super) row_of: Vec<u32>,
    sizes: Sizes,
    sample: Vec<f64>,
}

impl NeighbourGrid {
    /// An empty grid.
    pub fn new() -> Self {
        Self::default()
    }

    /// All pairs nearer than the sum of their radii and `margin` (m), as a half list.
    ///
    /// `start` has one entry more than there are bodies; the partners of body i are `partner[start[i]..start[i + 1]]`,
    /// all above i, ascending, each once, and `image` holds the code of each pair: the separation is
    /// `x_i - x_j - s*L` ([`crate::image_code`], [`Cell::shift_vector`]). [`Self::build`] and [`Self::pairs_of`] give the
    /// same pairs without the sorting.
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
        self.build(position_radius, cell, margin, false);
        let mut pairs: Vec<(u32, u32, u8)> = Vec::new();
        self.pairs_of(0..position_radius.len(), &mut PairScratch::default(), |i, j, code| {
            pairs.push(if i < j { (i, j, code) } else { (j, i, opposite_image(code)) });
        });
        assert!(u32::try_from(pairs.len()).is_ok(), "fewer than 2^32 pairs");
        pairs.sort_unstable();
        start.clear();
        start.extend(
            (0..=position_radius.len()).map(|i| pairs.partition_point(|p| (p.0 as usize) < i) as u32),
        );
        partner.clear();
        partner.extend(pairs.iter().map(|pair| pair.1));
        image.clear();
        image.extend(pairs.iter().map(|pair| pair.2));
    }

    /// Sorts the bodies into cells, on all threads of the current pool if `parallel`; [`Self::pairs_of`] then finds pairs
    /// nearer than the sum of their radii and `margin` (m).
    ///
    /// # Panics
    /// When there are 2^32 bodies or more.
    pub fn build(&mut self, position_radius: &[[f64; 4]], cell: &Cell, margin: f64, parallel: bool) {
        let n = position_radius.len();
        assert!(u32::try_from(n).is_ok(), "fewer than 2^32 bodies");
        (self.images, self.margin) = (Images::new(cell), margin);
        self.row_of.resize(n, 0);
        let all = (2 * n + 64).min(u32::MAX as usize);
        let mut work = Work {
            bounds: Bounds::new(position_radius, cell, parallel),
            dense: Limit { each: all, all },
            sample: &mut self.sample,
            parallel,
        };
        self.sizes.divide(position_radius, margin);
        if self.levels.is_empty() {
            self.levels.push(Cells::default());
        }
        let size = width(position_radius.iter().fold(0.0, |most: f64, row| most.max(row[3])), margin);
        self.used = 1;
        if !self.sizes.alike() {
            let crowding = self.levels[0].crowding(position_radius, cell, size, &mut self.row_of, &mut work);
            if crowding > FLAT {
                self.used = self.sizes.groups;
            }
        }
        if self.used == 1 {
            self.levels[0].build(position_radius, true, cell, size, &mut self.row_of, &mut work);
            return;
        }
        self.levels.resize_with(self.used.max(self.levels.len()), Cells::default);
        self.levels.iter_mut().for_each(|level| {
            level.members.clear();
            level.largest = 0.0;
        });
        self.level_of.clear();
        for (row, k) in position_radius.iter().zip(0..) {
            let group = self.sizes.of(2.0 * row[3] + margin);
            self.level_of.push(group as u8);
            let level = &mut self.levels[group];
            level.members.push(k);
            level.largest = level.largest.max(row[3]);
        }
        for level in &mut self.levels[..self.used] {
            let size = width(level.largest, margin);
            level.build(position_radius, false, cell, size, &mut self.row_of, &mut work);
        }
    }

    /// Number of grids in use: 1 unless the sizes differ much.
    pub fn levels(&self) -> usize {
        self.used
    }

    /// Heap bytes of the grids.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(Cells::bytes).sum::<usize>()
            + 4 * self.row_of.capacity()
            + self.level_of.capacity()
            + 8 * self.sample.capacity()
    }
}

/// Width of the cells for bodies up to a radius: more than their largest distance by far more than the rounding of a
/// cell number, so that a pair within reach never skips a cell.
fn width(largest: f64, margin: f64) -> f64 {
    let reach = 2.0 * largest + margin;
    // A denormal number does not grow by a quarter.
    if reach > 0.0 { (reach * (1.0 + 1e-6)).max(f64::MIN_POSITIVE) } else { f64::INFINITY }
}
