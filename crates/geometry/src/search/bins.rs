//! A regular grid over the bodies: where it lies and which cell a position falls into.

use crate::Cell;

/// At most this many positions are sampled to find where most bodies are.
const SAMPLE: usize = 2048;

/// A regular grid of cells.
///
/// In periodic directions it divides the period. In the others it covers the bodies, and bodies beyond its ends count
/// to the cells at the ends: that keeps neighbours in neighbouring cells wherever the ends are.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bins {
    /// Number of cells in each direction, at least 1.
    pub(super) count: [usize; 3],
    pub(super) periodic: [bool; 3],
    /// True when each body is inside the period of each periodic direction, so that nothing needs wrapping.
    pub(super) wrapped: bool,
    lo: [f64; 3],
    period: [f64; 3],
    /// Cells per metre.
    inverse: [f64; 3],
}

impl Bins {
    /// A grid whose cells are at least `size` wide and that has at most `most` cells in each direction and at most
    /// `most_in_all` cells. `size` must be above 0 (infinity gives one cell).
    pub(super) fn new(
        positions: &[[f64; 4]],
        cell: &Cell,
        size: f64,
        most: usize,
        most_in_all: usize,
        sample: &mut Vec<f64>,
    ) -> Self {
        let (lo, hi, periodic) = (cell.lo(), cell.hi(), cell.periodic());
        let (mut low, mut high, wrapped) = bounds(positions, cell);
        let fits = |count: [usize; 3]| {
            count.iter().all(|&n| n <= most) && product(count).is_some_and(|all| all <= most_in_all)
        };
        let mut size = size;
        let mut count = counts(low, high, periodic, size);
        if !fits(count) {
            // A few bodies that have flown away must not make the cells of all others coarse.
            trim(positions, periodic, size, &mut low, &mut high, sample);
            count = counts(low, high, periodic, size);
        }
        while !fits(count) {
            size *= 1.25;
            count = counts(low, high, periodic, size);
        }
        let mut bins = Self { count, periodic, wrapped, ..Self::default() };
        for axis in 0..3 {
            if periodic[axis] {
                bins.lo[axis] = lo[axis];
                bins.period[axis] = hi[axis] - lo[axis];
                bins.inverse[axis] = count[axis] as f64 / bins.period[axis];
            } else {
                bins.lo[axis] = low[axis];
                bins.inverse[axis] = if count[axis] > 1 { 1.0 / size } else { 0.0 };
            }
        }
        bins
    }

    /// The cell of a position; a coordinate that is not a number counts to cell 0.
    #[inline]
    pub(super) fn of(&self, position: &[f64; 4]) -> [usize; 3] {
        let mut at = [0; 3];
        for axis in 0..3 {
            let mut offset = position[axis] - self.lo[axis];
            if self.periodic[axis] && !self.wrapped {
                offset -= (offset / self.period[axis]).floor() * self.period[axis];
            }
            // The cast takes negative numbers and NaN to 0.
            at[axis] = ((offset * self.inverse[axis]) as usize).min(self.count[axis] - 1);
        }
        at
    }

    /// Number of a cell, x fastest.
    #[inline]
    pub(super) fn index(&self, at: [usize; 3]) -> usize {
        at[0] + self.count[0] * (at[1] + self.count[1] * at[2])
    }

    pub(super) fn cells(&self) -> usize {
        self.count[0] * self.count[1] * self.count[2]
    }
}

/// Bounds of the finite positions, or the period; and whether all positions are inside the periods.
fn bounds(positions: &[[f64; 4]], cell: &Cell) -> ([f64; 3], [f64; 3], bool) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for position in positions {
        for axis in 0..3 {
            let x = position[axis];
            low[axis] = low[axis].min(if x == f64::NEG_INFINITY { f64::NAN } else { x });
            high[axis] = high[axis].max(if x == f64::INFINITY { f64::NAN } else { x });
        }
    }
    let mut wrapped = true;
    for axis in 0..3 {
        if cell.periodic()[axis] {
            wrapped &= low[axis] >= cell.lo()[axis] && high[axis] < cell.hi()[axis];
            (low[axis], high[axis]) = (cell.lo()[axis], cell.hi()[axis]);
        } else if !(low[axis].is_finite() && high[axis].is_finite()) {
            (low[axis], high[axis]) = (0.0, 0.0);
        }
    }
    (low, high, wrapped)
}

/// Cells in each direction; saturates far above any limit.
fn counts(low: [f64; 3], high: [f64; 3], periodic: [bool; 3], size: f64) -> [usize; 3] {
    std::array::from_fn(|axis| {
        // Bounds near the largest double are further apart than it.
        let extent = (high[axis] - low[axis]).min(f64::MAX);
        let whole = (extent / size).min(1e18) as usize;
        // A period holds whole cells only; elsewhere the last cell begins inside the bounds and ends beyond them.
        if periodic[axis] { whole.max(1) } else { whole + 1 }
    })
}

fn product(count: [usize; 3]) -> Option<usize> {
    count[0].checked_mul(count[1])?.checked_mul(count[2])
}

/// Narrows the bounds to where all but the outermost few percent of the bodies are, and some room around.
fn trim(
    positions: &[[f64; 4]],
    periodic: [bool; 3],
    size: f64,
    low: &mut [f64; 3],
    high: &mut [f64; 3],
    sample: &mut Vec<f64>,
) {
    let stride = positions.len().div_ceil(SAMPLE).max(1);
    for axis in 0..3 {
        if periodic[axis] {
            continue;
        }
        sample.clear();
        sample.extend(positions.iter().step_by(stride).map(|p| p[axis]).filter(|x| x.is_finite()));
        if sample.is_empty() {
            continue;
        }
        sample.sort_unstable_by(f64::total_cmp);
        let outside = sample.len() / 40;
        let (first, last) = (sample[outside], sample[sample.len() - 1 - outside]);
        let room = 0.25 * (last - first) + size;
        low[axis] = low[axis].max(first - room);
        high[axis] = high[axis].min(last + room);
    }
}
