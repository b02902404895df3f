//! The cells next to a cell along one direction.

use super::bins::Span;

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
        near.list();
        near
    }

    /// The cells of a span of `count`; around a period of three cells or more.
    #[inline]
    pub(super) fn within(span: Span, count: usize) -> Self {
        let (at, last) = (span.at, count - 1);
        let direct = Run {
            first: at - usize::from(span.below && at > 0),
            last: at + usize::from(span.above && at < last),
            code: 1,
        };
        let mut near = Self { number: 0, cells: [Step::default(); 3], pieces: 1, runs: [direct; 2] };
        if span.below && at == 0 {
            near.runs[1] = Run { first: last, last, code: 0 };
            near.pieces = 2;
        } else if span.above && at == last {
            near.runs[1] = Run { first: 0, last: 0, code: 2 };
            near.pieces = 2;
        }
        near.list();
        near
    }

    fn list(&mut self) {
        for run in &self.runs[..self.pieces] {
            for cell in run.first..=run.last {
                self.cells[self.number] = Step { cell, code: run.code };
                self.number += 1;
            }
        }
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
