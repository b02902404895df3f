//! An order of the bodies in which neighbours in memory are neighbours in space.

use rayon::prelude::*;

use super::bins::{Bins, Bounds, Limit};
use super::curve::hilbert_index;
use crate::Cell;

/// Sorts bodies along a space-filling curve. Buffers are kept between calls.
#[derive(Debug, Default)]
pub struct BodyOrder {
    /// Place on the curve above, body below.
    keys: Vec<u64>,
    sample: Vec<f64>,
}

impl BodyOrder {
    /// An order without buffers.
    pub fn new() -> Self {
        Self::default()
    }

    /// The order of the bodies along a Hilbert curve through grid cells of width `size` (m).
    ///
    /// `out` becomes a permutation: `out[k]` is the body that comes k-th. Bodies of one cell keep their order. The
    /// cells are made wider where a number of a cell and one of a body would not fit into 64 bits together; a `size`
    /// that is not positive stands for the finest grid. With `parallel`, all threads of the current pool sort; the
    /// result is the same.
    ///
    /// # Panics
    /// When there are 2^32 bodies or more.
    pub fn sort(
        &mut self,
        positions: &[[f64; 4]],
        cell: &Cell,
        size: f64,
        parallel: bool,
        out: &mut Vec<u32>,
    ) {
        assert!(u32::try_from(positions.len()).is_ok(), "fewer than 2^32 bodies");
        let size = if size > 0.0 { size } else { f64::MIN_POSITIVE };
        let low = u64::BITS - (positions.len() as u64).leading_zeros();
        let limit = Limit { each: 1 << ((63 - low) / 3).min(21), all: usize::MAX };
        let bins = Bins::new(&Bounds::new(positions, cell, parallel), cell, size, limit, &mut self.sample);
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
        let key = |(k, position): (usize, &[f64; 4])| place(position) << low | k as u64;
        let body = |key: &u64| (key & ((1 << low) - 1)) as u32;
        out.resize(positions.len(), 0);
        self.keys.resize(positions.len(), 0);
        if parallel {
            self.keys
                .par_iter_mut()
                .zip(positions.par_iter().enumerate())
                .for_each(|(to, from)| *to = key(from));
            self.keys.par_sort_unstable();
            out.par_iter_mut().zip(&self.keys).for_each(|(to, from)| *to = body(from));
        } else {
            self.keys.iter_mut().zip(positions.iter().enumerate()).for_each(|(to, from)| *to = key(from));
            self.keys.sort_unstable();
            out.iter_mut().zip(&self.keys).for_each(|(to, from)| *to = body(from));
        }
    }

    /// Heap bytes of the buffers.
    pub fn bytes(&self) -> usize {
        8 * (self.keys.capacity() + self.sample.capacity())
    }
}
