//! History of contacts in a list of pairs, and its transfer from list to list.

use granule_law_api::{Parity, Real};
use granule_plan::Composition;

use crate::chunk::Batch;

/// History of the pairs of one list: `width` numbers a pair, and the number of the evaluation in which it last touched.
/// A pair that did not touch in the evaluation before has no history: a new contact begins with zeros.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairHistory {
    pub width: usize,
    pub values: Vec<f64>,
    pub stamp: Vec<u32>,
}

impl PairHistory {
    pub fn new(width: usize) -> Self {
        Self { width, ..Self::default() }
    }

    /// Empty history for `pairs` pairs. No arrays exist if no law remembers anything.
    pub fn resize(&mut self, pairs: usize) {
        if self.width > 0 {
            self.values.clear();
            self.values.resize(pairs * self.width, 0.0);
            self.stamp.clear();
            self.stamp.resize(pairs, NEVER);
        }
    }

    /// History of a pair that touched in evaluation `last`.
    pub fn get(&self, pair: usize, last: u32) -> Option<&[f64]> {
        (self.width > 0 && self.stamp[pair] == last)
            .then(|| &self.values[pair * self.width..(pair + 1) * self.width])
    }

    /// Sets the history of a pair that touched in evaluation `last`.
    pub fn set(&mut self, pair: usize, last: u32, values: &[f64]) {
        self.values[pair * self.width..(pair + 1) * self.width].copy_from_slice(values);
        self.stamp[pair] = last;
    }

    /// Fills the history columns of a batch; `now` is the number of this evaluation.
    #[inline(always)]
    pub fn load<T: Real>(&self, batch: &mut Batch<T>, now: u32) {
        match self.width {
            // The widths of a scalar memory and of a spring in the tangent plane, for which the loop is unrolled.
            1 => self.load_width::<T, 1>(batch, now),
            3 => self.load_width::<T, 3>(batch, now),
            width => {
                for k in 0..batch.len() {
                    let pair = batch.pair[k] as usize;
                    let continues = self.stamp[pair] == now.wrapping_sub(1);
                    let values = &self.values[pair * width..(pair + 1) * width];
                    for (column, value) in batch.history.iter_mut().zip(values) {
                        column[k] = T::of(*value).keep_if(continues);
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn load_width<T: Real, const W: usize>(&self, batch: &mut Batch<T>, now: u32) {
        let count = batch.len();
        let Some(columns) = batch.history.first_chunk_mut::<W>() else { return };
        let (rows, _) = self.values.as_chunks::<W>();
        for k in 0..count {
            let pair = batch.pair[k] as usize;
            let continues = self.stamp[pair] == now.wrapping_sub(1);
            let row = &rows[pair];
            for axis in 0..W {
                columns[axis][k] = T::of(row[axis]).keep_if(continues);
            }
        }
    }

    /// Stores the history columns of a batch.
    #[inline(always)]
    pub fn store<T: Real>(&mut self, batch: &Batch<T>, now: u32) {
        match self.width {
            1 => self.store_width::<T, 1>(batch, now),
            3 => self.store_width::<T, 3>(batch, now),
            width => {
                for k in 0..batch.len() {
                    let pair = batch.pair[k] as usize;
                    self.stamp[pair] = now;
                    let values = &mut self.values[pair * width..(pair + 1) * width];
                    for (column, value) in batch.history.iter().zip(values) {
                        *value = column[k].wide();
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn store_width<T: Real, const W: usize>(&mut self, batch: &Batch<T>, now: u32) {
        let Some(columns) = batch.history.first_chunk::<W>() else { return };
        let (rows, _) = self.values.as_chunks_mut::<W>();
        for k in 0..batch.len() {
            let pair = batch.pair[k] as usize;
            self.stamp[pair] = now;
            let row = &mut rows[pair];
            for axis in 0..W {
                row[axis] = columns[axis][k].wide();
            }
        }
    }
}

/// Stamp of a pair that has never touched. Evaluations are counted from 2, so that it never equals the one before.
pub(crate) const NEVER: u32 = 0;

/// Swaps the roles of i and j in the history of a contact.
pub(crate) fn swap(composition: &Composition, values: &mut [f64]) {
    for stage in &composition.stages {
        let mut offset = stage.history_offset;
        for column in stage.law.info.history {
            if column.parity == Parity::Odd {
                for value in &mut values[offset..offset + column.components] {
                    *value = -*value;
                }
            }
            offset += column.components;
        }
    }
}

/// Histories of all touching pairs, looked up by the places that their bodies had when the old lists were made.
#[derive(Debug, Default)]
pub(crate) struct Carried {
    start: Vec<u32>,
    partner: Vec<u32>,
    values: Vec<f64>,
    width: usize,
}

impl Carried {
    /// Collects `(place of i, place of j or wall, history)` items; `bodies` is the number of bodies.
    pub fn collect<'a>(
        bodies: usize,
        width: usize,
        items: impl Iterator<Item = (u32, u32, &'a [f64])> + Clone,
    ) -> Self {
        let mut start = vec![0u32; bodies + 1];
        for (i, _, _) in items.clone() {
            start[i as usize + 1] += 1;
        }
        for place in 0..bodies {
            start[place + 1] += start[place];
        }
        let total = start[bodies] as usize;
        let mut partner = vec![0; total];
        let mut values = vec![0.0; total * width];
        let mut next = start.clone();
        for (i, j, history) in items {
            let at = next[i as usize] as usize;
            next[i as usize] += 1;
            partner[at] = j;
            values[at * width..(at + 1) * width].copy_from_slice(history);
        }
        Self { start, partner, values, width }
    }

    /// History stored under `(i, j)`.
    pub fn get(&self, i: u32, j: u32) -> Option<&[f64]> {
        let range = self.start[i as usize] as usize..self.start[i as usize + 1] as usize;
        let at = range.start + self.partner[range.clone()].iter().position(|&partner| partner == j)?;
        Some(&self.values[at * self.width..(at + 1) * self.width])
    }
}
