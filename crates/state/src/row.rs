//! One padded row of a body.

use std::ops::{Index, IndexMut};

use serde::{Deserialize, Serialize};

/// Four doubles, aligned so that a row never straddles two cache lines.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable, Serialize, Deserialize,
)]
#[repr(C, align(32))]
pub struct Row(pub [f64; 4]);

impl Row {
    /// All zero.
    pub const ZERO: Self = Self([0.0; 4]);

    /// A row of a vector and a fourth number.
    #[inline(always)]
    pub const fn new(vector: [f64; 3], last: f64) -> Self {
        Self([vector[0], vector[1], vector[2], last])
    }

    /// The first three numbers.
    #[inline(always)]
    pub const fn vector(&self) -> [f64; 3] {
        [self.0[0], self.0[1], self.0[2]]
    }

    /// The rows as plain arrays.
    pub fn as_arrays(rows: &[Self]) -> &[[f64; 4]] {
        bytemuck::cast_slice(rows)
    }

    /// The rows as plain arrays, to be written.
    pub fn as_arrays_mut(rows: &mut [Self]) -> &mut [[f64; 4]] {
        bytemuck::cast_slice_mut(rows)
    }
}

impl Index<usize> for Row {
    type Output = f64;
    #[inline(always)]
    fn index(&self, index: usize) -> &f64 {
        &self.0[index]
    }
}

impl IndexMut<usize> for Row {
    #[inline(always)]
    fn index_mut(&mut self, index: usize) -> &mut f64 {
        &mut self.0[index]
    }
}
