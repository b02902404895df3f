//! The cells next to a cell along one direction.

/// A cell and its neighbours along one direction, each once.
pub(super) struct Near {
    number: usize,
    cells: [Step; 3],
    pieces: usize,
    runs: [Run; 2],
}

/// One cell.
#[derive(Clone, Copy, Default)]
pub(super) struct Step {
    pub(super) cell: usize,
    /// Shift to the image in periods, plus 1: a digit of the image code.
    pub(super) code: u8,
}

impl Step {
    /// The cell after the cell `at` of `count`, around a period of three cells or more.
    #[inline]
    pub(super) fn after(at: usize, count: usize, periodic: bool) -> Option<Self> {
        if at + 1 < count {
            Some(Self { cell: at + 1, code: 1 })
        } else {
            periodic.then_some(Self { cell: 0, code: 2 })
        }
    }
}

/// Consecutive cells of the same image.
#[derive(Clone, Copy)]
pub(super) struct Run {
    pub(super) first: usize,
    pub(super) last: usize,
    pub(super) code: u8,
}

impl Near {
    /// The cells around the cell `at` of `count`.
    #[inline]
    pub(super) fn new(at: usize, count: usize, periodic: bool) -> Self {
        let direct = Run { first: at.saturating_sub(1), last: (at + 1).min(count - 1), code: 1 };
        let mut near = Self { number: 0, cells: [Step::default(); 3], pieces: 1, runs: [direct; 2] };
        // Along a period of one or two cells `direct` already holds all of them.
        if periodic && count >= 3 {
            if at == 0 {
                // x_i is small and x_j large: x_i - x_j is about minus one period.
                near.runs[1] = Run { first: count - 1, last: count - 1, code: 0 };
                near.pieces = 2;
            } else if at == count - 1 {
                near.runs[1] = Run { first: 0, last: 0, code: 2 };
                near.pieces = 2;
            }
        }
        for run in &near.runs[..near.pieces] {
            for cell in run.first..=run.last {
                near.cells[near.number] = Step { cell, code: run.code };
                near.number += 1;
            }
        }
        near
    }

    /// The cells one by one.
    #[inline]
    pub(super) fn cells(&self) -> &[Step] {
        &self.cells[..self.number]
    }

    /// The same cells as one or two runs.
    #[inline]
    pub(super) fn runs(&self) -> &[Run] {
        &self.runs[..self.pieces]
    }
}
