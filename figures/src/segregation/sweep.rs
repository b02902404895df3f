//! All layers, several at a time.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

use granule_drivers::driver;
use granule_observers::layer::{Layer, clusters, segregation_index};

use super::scene::{Case, RADIUS, scene};
use crate::Error;
use crate::simulate::plan;

/// A layer at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Time \[s\].
    pub time: f64,
    /// Index of segregation of neighbours nearer than a radius.
    pub index: f64,
    /// Granular temperature of each species \[m²/s²\].
    pub temperature: [f64; 2],
    /// Mean number of beads in the cluster of a bead, over all beads.
    pub cluster: f64,
}

/// One run.
pub(super) struct Record {
    pub case: Case,
    pub rows: Vec<Row>,
    /// The layer at the end.
    pub last: Layer,
    /// Time on a processor \[s\].
    pub cost: f64,
}

/// Runs all cases, several at a time, with a record at the start and `records` later ones.
///
/// # Errors
/// A run ends with an error.
pub(super) fn sweep(cases: &[Case], records: usize) -> Result<Vec<Record>, Error> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    let workers = std::thread::available_parallelism().map_or(1, usize::from).min(cases.len());
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                loop {
                    let place = next.fetch_add(1, Ordering::Relaxed);
                    let Some(case) = cases.get(place) else { break };
                    let record = run(case, records);
                    if let Ok(record) = &record {
                        eprintln!("{case:?}: {:.0} s", record.cost);
                    }
                    let mut done = done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                    done.push((place, record));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    done.sort_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, record)| record).collect()
}

fn run(case: &Case, records: usize) -> Result<Record, Error> {
    let mut driver = driver(plan(&scene(case))?, Some(1))?;
    let steps = driver.view().plan().driver.steps;
    let clock = Clock::start();
    let mut rows = Vec::new();
    let mut cost = 0.0;
    let mut last = Layer::of(&driver.view());
    for k in 0..=records {
        let before = clock.seconds();
        driver.advance(steps * k as u64 / records as u64, &AtomicBool::new(false))?;
        cost += clock.seconds() - before;
        last = Layer::of(&driver.view());
        rows.push(Row {
            time: driver.view().time(),
            index: segregation_index(&last, RADIUS),
            temperature: [0, 1].map(|species| last.granular_temperature(Some(species))),
            cluster: clusters(&last, 0.1 * RADIUS).mean_size(),
        });
    }
    Ok(Record { case: *case, rows, last, cost })
}

/// Time of this thread on a processor where the system tells it, else on the clock.
struct Clock {
    start: Instant,
}

impl Clock {
    fn start() -> Self {
        Self { start: Instant::now() }
    }

    fn seconds(&self) -> f64 {
        let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
        let nanoseconds = told.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
        nanoseconds.map_or_else(|| self.start.elapsed().as_secs_f64(), |value| 1e-9 * value)
    }
}

#[cfg(test)]
mod tests {
    use super::super::scene::Model;
    use super::*;

    /// Species that differ part, in both models; beads of equal rolling friction move with the plate as one and lie as they lay.
    #[test]
    fn rolling_friction_parts_the_species() {
        let index = |model, side, duration| {
            let record = run(&Case { model, side, duration, contact: 1e-3, seed: 1 }, 4).unwrap();
            assert_eq!(record.last.rows.len(), 2 * side * side);
            assert!(record.rows[0].index < -0.9, "a chessboard: {:?}", record.rows[0]);
            record.rows[2..].iter().map(|row| row.index).sum::<f64>() / 3.0
        };
        // Of n pairs of neighbours at random, the index strays by 1/sqrt(n): 0.04 with 288 beads, and less in a mean.
        let (parted, equal) = (index(Model::Arcs, 12, 20.0), index(Model::Control, 12, 20.0));
        assert!(parted > 0.15 && equal < -0.2, "{parted} {equal}");
        let (steps, arcs) = (index(Model::TimeSteps, 6, 8.0), index(Model::Arcs, 6, 8.0));
        // With 72 beads 0.08 each.
        assert!((steps - arcs).abs() < 0.3, "{steps} {arcs}");
    }
}
