//! What is measured of a run while it goes on.

use granule_drivers::View;
use granule_observers::Energy;
use granule_plan::Plan;

use crate::observable::{Kind, Observable, kind};

/// Share of the run at its end over which means are taken.
const LAST: f64 = 0.2;
/// Moments in that share, and before it.
const MOMENTS: u64 = 20;

/// Looks at a run at some moments: at its end where paths count, else over its last fifth.
pub struct Meter {
    observables: Vec<Observable>,
    /// Steps at which to look, in order.
    moments: Vec<u64>,
    /// Looks so far.
    looks: usize,
    /// Earlier moments only tell how large the observables are.
    begin_of_mean: u64,
    start: Option<Energy>,
    scales: Vec<f64>,
    sums: Vec<Vec<f64>>,
    summed: f64,
}

impl Meter {
    pub(crate) fn new(plan: &Plan, observables: &[Observable]) -> Self {
        let steps = plan.driver.steps;
        let begin_of_mean = match kind(plan) {
            Kind::Paths => steps,
            Kind::Means => steps - (LAST * steps as f64).round() as u64 + 1,
        };
        let mut moments: Vec<u64> = match kind(plan) {
            Kind::Paths => vec![steps],
            Kind::Means => (1..=MOMENTS)
                .map(|moment| begin_of_mean * moment / MOMENTS)
                .chain((0..MOMENTS).map(|moment| steps - (steps - begin_of_mean) * moment / MOMENTS))
                .collect(),
        };
        moments.sort_unstable();
        moments.dedup();
        Self {
            observables: observables.to_vec(),
            moments,
            looks: 0,
            begin_of_mean,
            start: None,
            scales: Vec::new(),
            sums: Vec::new(),
            summed: 0.0,
        }
    }

    /// Looks at the initial state.
    pub fn begin(&mut self, view: &View<'_>) {
        self.start = Some(Energy::of(view));
        self.scales = sizes(&self.measure(view));
    }

    /// The step at which to look next; none after the last.
    pub fn next_due(&self) -> Option<u64> {
        self.moments.get(self.looks).copied()
    }

    /// Looks at a run, if it is time to.
    pub fn look(&mut self, view: &View<'_>) {
        if self.next_due() != Some(view.step()) {
            return;
        }
        self.looks += 1;
        let values = self.measure(view);
        for (scale, size) in self.scales.iter_mut().zip(sizes(&values)) {
            *scale = scale.max(size);
        }
        if view.step() < self.begin_of_mean {
            return;
        }
        self.summed += 1.0;
        if self.sums.is_empty() {
            self.sums = values;
        } else {
            for (sum, value) in self.sums.iter_mut().flatten().zip(values.iter().flatten()) {
                *sum += value;
            }
        }
    }

    /// Components of each observable and its size; none if the run has not come to its end under these eyes.
    pub(crate) fn result(mut self) -> Option<(Vec<Vec<f64>>, Vec<f64>)> {
        if self.next_due().is_some() || self.start.is_none() {
            return None;
        }
        for sum in self.sums.iter_mut().flatten() {
            *sum /= self.summed;
        }
        Some((self.sums, self.scales))
    }

    fn measure(&self, view: &View<'_>) -> Vec<Vec<f64>> {
        let now = Energy::of(view);
        let start = self.start.unwrap_or(now);
        self.observables.iter().map(|observable| observable.measure(view, &now, &start)).collect()
    }
}

/// Largest component of each observable.
fn sizes(values: &[Vec<f64>]) -> Vec<f64> {
    values
        .iter()
        .map(|components| components.iter().fold(0.0, |most: f64, value| most.max(value.abs())))
        .collect()
}
