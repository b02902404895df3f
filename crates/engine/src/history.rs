//! History of contacts in a list of pairs, and its transfer from list to list.
#![expect(
    unsafe_code,
    reason = "rows are read and written without comparing each index with the number of rows"
)]

use granule_law_api::Parity;
use granule_plan::Composition;
use granule_state::{Lanes, Row};

use crate::chunk::Batch;
use crate::level::Arithmetic;

/// History of the pairs of one list. A pair has `width` numbers, and behind them that of the evaluation in which it last
/// touched, so that one row holds a spring and its age. A pair that did not touch in the evaluation before has no
/// history: a new contact begins with zeros.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairHistory {
    pub width: usize,
    /// `rows_each` rows a pair; the last number of the last one is the evaluation.
    rows: Vec<Row>,
    rows_each: usize,
}

impl PairHistory {
    /// Empty history for `pairs` pairs. No arrays exist if no law remembers anything.
    pub fn resize(&mut self, pairs: usize) {
        if self.width > 0 {
            self.rows_each = (self.width + 1).div_ceil(4);
            self.rows.clear();
            self.rows.resize(pairs * self.rows_each, Row([0.0, 0.0, 0.0, NEVER]));
        }
    }

    /// Makes room for `pairs` pairs.
    pub fn reserve(&mut self, pairs: usize) {
        if self.width > 0 {
            let rows = pairs * (self.width + 1).div_ceil(4);
            self.rows.reserve(rows.saturating_sub(self.rows.len()));
        }
    }

    /// History of a pair that touched in evaluation `last`.
    pub fn get(&self, pair: usize, last: u32) -> Option<&[f64]> {
        if self.width == 0 {
            return None;
        }
        let values: &[f64] =
            Row::as_arrays(&self.rows[pair * self.rows_each..][..self.rows_each]).as_flattened();
        (values[values.len() - 1] == f64::from(last)).then(|| &values[..self.width])
    }

    /// Sets the history of a pair that touched in evaluation `last`.
    pub fn set(&mut self, pair: usize, last: u32, values: &[f64]) {
        let to = self.numbers_mut(pair);
        to[..values.len()].copy_from_slice(values);
        to[to.len() - 1] = f64::from(last);
    }

    fn numbers_mut(&mut self, pair: usize) -> &mut [f64] {
        let rows = &mut self.rows[pair * self.rows_each..][..self.rows_each];
        Row::as_arrays_mut(rows).as_flattened_mut()
    }

    /// Fills the history columns of a batch; `now` is the number of this evaluation.
    #[inline(always)]
    pub fn load<T: Arithmetic, L: Lanes>(&self, batch: &mut Batch<T>, now: u32) {
        let before = now.wrapping_sub(1);
        if self.width != 3 {
            for k in 0..batch.len() {
                let values = self.get(batch.pair[k] as usize, before);
                for (at, column) in batch.history.iter_mut().enumerate() {
                    column[k] = values.map_or(T::ZERO, |values| T::of(values[at]));
                }
            }
            return;
        }
        // A spring in the tangent plane: one row a pair.
        assert!((batch.largest(&batch.pair) as usize) < self.rows.len(), "a batch has pairs of the list");
        let (rows_of_pairs, groups) = (&self.rows[..], batch.groups());
        let Some([hx, hy, hz]) = batch.history.first_chunk_mut::<3>() else { return };
        let (before, zero) = (L::splat(f64::from(before)), L::splat(0.0));
        for g in 0..groups {
            let [a, b, c, d] = batch.pair.four(g).map(|pair| pair as usize);
            // SAFETY: all pairs of the batch were compared above with the number of rows.
            let row = |pair: usize| L::load(unsafe { &rows_of_pairs.get_unchecked(pair).0 });
            let rows = [row(a), row(b), row(c), row(d)];
            let [x, y, z, touched] = L::transpose(rows);
            T::store(touched.if_equal(before, x, zero), hx.four_mut(g));
            T::store(touched.if_equal(before, y, zero), hy.four_mut(g));
            T::store(touched.if_equal(before, z, zero), hz.four_mut(g));
        }
    }

    /// Stores the history columns of a batch.
    #[inline(always)]
    pub fn store<T: Arithmetic, L: Lanes>(&mut self, batch: &Batch<T>, now: u32) {
        if self.width != 3 {
            for k in 0..batch.len() {
                let numbers = self.numbers_mut(batch.pair[k] as usize);
                for (to, column) in numbers.iter_mut().zip(&batch.history) {
                    *to = column[k].wide();
                }
                let last = numbers.len() - 1;
                numbers[last] = f64::from(now);
            }
            return;
        }
        let Some([hx, hy, hz]) = batch.history.first_chunk::<3>() else { return };
        let rows_of_pairs = &mut self.rows[..];
        assert!((batch.largest(&batch.pair) as usize) < rows_of_pairs.len(), "a batch has pairs of the list");
        let now = L::splat(f64::from(now));
        let count = batch.len();
        for g in 0..batch.groups() {
            let [a, b, c, d] = *batch.pair.four(g);
            let rows = L::transpose([T::load(hx.four(g)), T::load(hy.four(g)), T::load(hz.four(g)), now]);
            // What fills the last group up is not stored.
            let rest = count - 4 * g;
            macro_rules! keep {
                ($row:expr, $pair:expr) => {
                    // SAFETY: all pairs of the batch were compared above with the number of rows.
                    $row.store(unsafe { &mut rows_of_pairs.get_unchecked_mut($pair as usize).0 })
                };
            }
            keep!(rows[0], a);
            if rest > 1 {
                keep!(rows[1], b);
            }
            if rest > 2 {
                keep!(rows[2], c);
            }
            if rest > 3 {
                keep!(rows[3], d);
            }
        }
    }

    /// Heap bytes.
    pub fn bytes(&self) -> usize {
        self.rows.capacity() * size_of::<Row>()
    }
}

/// Evaluation of a pair that has never touched. They are counted from 2, so that it never equals the one before.
const NEVER: f64 = 0.0;

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

/// Histories of the touching pairs of a tile, looked up by the places that their bodies had.
#[derive(Debug, Default)]
pub(crate) struct Carried {
    start: Vec<u32>,
    partner: Vec<u32>,
    values: Vec<f64>,
    width: usize,
}

impl Carried {
    /// Collects `(place of i within the tile, place of j or wall, history)` items; `bodies` is the number of bodies.
    pub fn collect<'a>(
        &mut self,
        bodies: usize,
        width: usize,
        items: impl Iterator<Item = (u32, u32, &'a [f64])> + Clone,
    ) {
        let Self { start, partner, values, .. } = self;
        start.clear();
        start.resize(bodies + 1, 0);
        items.clone().for_each(|(i, _, _)| start[i as usize] += 1);
        let mut total = 0;
        for entry in start.iter_mut() {
            total += *entry;
            *entry = total;
        }
        partner.resize(total as usize, 0);
        values.resize(total as usize * width, 0.0);
        // Counted down, each entry comes to the first item of its body.
        for (i, j, history) in items {
            start[i as usize] -= 1;
            let at = start[i as usize] as usize;
            partner[at] = j;
            values[at * width..(at + 1) * width].copy_from_slice(history);
        }
        self.width = width;
    }

    /// Heap bytes.
    pub fn bytes(&self) -> usize {
        4 * (self.start.capacity() + self.partner.capacity()) + 8 * self.values.capacity()
    }

    /// History stored under `(i, j)`.
    pub fn get(&self, i: u32, j: u32) -> Option<&[f64]> {
        let range = self.start[i as usize] as usize..self.start[i as usize + 1] as usize;
        let at = range.start + self.partner[range.clone()].iter().position(|&partner| partner == j)?;
        Some(&self.values[at * self.width..(at + 1) * self.width])
    }
}
