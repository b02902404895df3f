//! The soft driver: fixed time steps.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use granule_engine::{Alarm, Engine, EngineError, EngineState, Phase};
use granule_plan::Plan;

use crate::{Advance, Driver, DriverState, Timings, View};

/// Advances an [`Engine`] in fixed time steps.
pub struct TimeStepDriver {
    engine: Engine,
    timings: Timings,
    /// Steps between two looks at the stop flag, so that a run ends within a tenth of a second.
    stride: u64,
}

impl TimeStepDriver {
    /// Sets up the bodies of a plan. `threads` overrides the plan; by default as many threads as the machine has.
    ///
    /// # Errors
    /// See [`EngineError`].
    pub fn new(plan: Arc<Plan>, threads: Option<usize>) -> Result<Self, EngineError> {
        let threads = workers(&plan, threads);
        Ok(Self::of(Engine::new(plan, threads)?))
    }

    /// Goes on from a saved state.
    ///
    /// # Errors
    /// [`EngineError::Saved`]: the state does not fit the plan.
    pub fn restore(
        plan: Arc<Plan>,
        threads: Option<usize>,
        state: EngineState<'_>,
    ) -> Result<Self, EngineError> {
        let threads = workers(&plan, threads);
        Ok(Self::of(Engine::restore(plan, threads, state)?))
    }

    fn of(engine: Engine) -> Self {
        Self { engine, timings: Timings::default(), stride: 1 }
    }

    /// The engine, for tests and benchmarks.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }
}

/// Worker threads: those asked for, else those of the plan, else as many as the machine has.
fn workers(plan: &Plan, threads: Option<usize>) -> usize {
    let available = std::thread::available_parallelism().map_or(1, usize::from);
    threads.or(plan.driver.threads).unwrap_or(available)
}

impl Driver for TimeStepDriver {
    fn step(&self) -> u64 {
        self.engine.step()
    }

    fn time(&self) -> f64 {
        self.engine.time()
    }

    fn advance(&mut self, until: u64, stop: &AtomicBool) -> Result<Advance, EngineError> {
        while self.engine.step() < until {
            if stop.load(Ordering::Relaxed) {
                return Ok(Advance::Stopped);
            }
            let steps = self.stride.min(until - self.engine.step());
            let begin = Instant::now();
            let mut phase_begin = begin;
            let mut phase = None;
            let mut totals = self.timings;
            let mut enter = |next: Option<Phase>| {
                let now = Instant::now();
                let spent = now - phase_begin;
                match phase {
                    Some(Phase::Lists) => totals.lists += spent,
                    Some(Phase::Forces) => totals.forces += spent,
                    Some(Phase::Integration) => totals.integration += spent,
                    None => {}
                }
                phase_begin = now;
                phase = next;
            };
            let result = self.engine.advance(steps, &mut |phase| enter(Some(phase)));
            enter(None);
            self.timings = totals;
            result?;
            let spent = begin.elapsed();
            if spent < Duration::from_millis(20) {
                self.stride = self.stride.saturating_mul(2);
            } else if spent > Duration::from_millis(100) {
                self.stride = (self.stride / 2).max(1);
            }
        }
        Ok(Advance::Reached)
    }

    fn view(&self) -> View<'_> {
        View::new(&self.engine)
    }

    fn save(&self) -> DriverState<'_> {
        DriverState::Steps(Box::new(self.engine.save()))
    }

    fn alarms(&mut self) -> Vec<Alarm> {
        self.engine.alarms()
    }

    fn timings(&self) -> Timings {
        self.timings
    }

    fn threads(&self) -> usize {
        self.engine.threads()
    }
}
