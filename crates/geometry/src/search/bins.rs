//! A regular grid over the bodies: where it lies and which cell a position falls into.

use rayon::prelude::*;

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
    /// The cells are wider than asked for, because there would have been too many.
    pub(super) grown: bool,
    lo: [f64; 3],
    period: [f64; 3],
    /// Cells per metre.
    inverse: [f64; 3],
}

impl Bins {
    /// A grid whose cells are at least `size` wide. `size` must be above 0 (infinity gives one cell).
    pub(super) fn new(bounds: &Bounds, cell: &Cell, size: f64, limit: Limit, sample: &mut Vec<f64>) -> Self {
        let (lo, hi, periodic) = (cell.lo(), cell.hi(), cell.periodic());
        let (mut low, mut high) = (bounds.low, bounds.high);
        let fits = |count: [usize; 3]| {
            count.iter().all(|&n| n <= limit.each) && product(count).is_some_and(|all| all <= limit.all)
        };
        let (mut size, mut grown) = (size, false);
        let mut count = counts(low, high, periodic, size);
        if !fits(count) {
            // A few bodies that have flown away must not make the cells of all others coarse.
            trim(bounds.positions, periodic, size, &mut low, &mut high, sample);
            count = counts(low, high, periodic, size);
        }
        while !fits(count) {
            (size, grown) = (size * 1.25, true);
            count = counts(low, high, periodic, size);
        }
        let mut bins = Self { count, periodic, wrapped: bounds.wrapped, grown, ..Self::default() };
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

    /// The cells that hold all positions nearer than `reach` to a coordinate, as the first and the last along a
    /// direction: the cell of the coordinate and the next one on each side, if they are near enough. Only for positions
    /// inside the period.
    #[inline]
    pub(super) fn around(&self, axis: usize, x: f64, reach: f64) -> Span {
        let scaled = (x - self.lo[axis]) * self.inverse[axis];
        let (at, last) = ((scaled as usize).min(self.count[axis] - 1), self.count[axis] - 1);
        let reach = reach * self.inverse[axis];
        Span {
            at,
            below: scaled - reach < at as f64 && (at > 0 || self.periodic[axis]),
            above: scaled + reach >= (at + 1) as f64 && (at < last || self.periodic[axis]),
        }
    }
}

/// A cell along a direction, and whether its neighbours matter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) at: usize,
    pub(super) below: bool,
    pub(super) above: bool,
}

/// How many cells a grid may have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limit {
    /// In each direction.
    pub(super) each: usize,
    /// In all.
    pub(super) all: usize,
}

/// Where some bodies are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds<'a> {
    positions: &'a [[f64; 4]],
    /// Bounds of the finite positions, or the period.
    low: [f64; 3],
    high: [f64; 3],
    /// Each body is inside the period of each periodic direction.
    wrapped: bool,
}

/// Bodies whose bounds one thread finds.
const CHUNK: usize = 1 << 14;

impl<'a> Bounds<'a> {
    pub(super) fn new(positions: &'a [[f64; 4]], cell: &Cell, parallel: bool) -> Self {
        let none = || ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let of = |rows: &[[f64; 4]]| {
            let (mut low, mut high) = none();
            for row in rows {
                for axis in 0..3 {
                    let x = row[axis];
                    low[axis] = low[axis].min(if x == f64::NEG_INFINITY { f64::NAN } else { x });
                    high[axis] = high[axis].max(if x == f64::INFINITY { f64::NAN } else { x });
                }
            }
            (low, high)
        };
        // Least and largest are the same in any order.
        let (mut low, mut high) = if parallel {
            let wider = |a: ([f64; 3], [f64; 3]), b: ([f64; 3], [f64; 3])| {
                (
                    std::array::from_fn(|axis| a.0[axis].min(b.0[axis])),
                    std::array::from_fn(|axis| a.1[axis].max(b.1[axis])),
                )
            };
            positions.par_chunks(CHUNK).map(of).reduce(none, wider)
        } else {
            of(positions)
        };
        let mut wrapped = true;
        for axis in 0..3 {
            if cell.periodic()[axis] {
                wrapped &= low[axis] >= cell.lo()[axis] && high[axis] < cell.hi()[axis];
                (low[axis], high[axis]) = (cell.lo()[axis], cell.hi()[axis]);
            } else if !(low[axis].is_finite() && high[axis].is_finite()) {
                (low[axis], high[axis]) = (0.0, 0.0);
            }
        }
        Self { positions, low, high, wrapped }
    }
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
