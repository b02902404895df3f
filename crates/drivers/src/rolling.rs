//! The hard driver of bodies that slide and roll on a substrate.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use granule_engine::{EngineError, SubstrateTally, Tally};
use granule_events::{Between, Counts, RollingEngine, RollingSetup, RollingState};
use granule_plan::{Plan, Slides};

use crate::event::{bodies, failed, refused, setup, work};
use crate::view::Snapshot;
use crate::{Advance, Driver, DriverState, Moment, Timings, View};

/// Events between two looks at the stop flag: some milliseconds.
const STRIDE: u64 = 10_000;

/// Advances a [`RollingEngine`]. Its steps are the times at which the run can be looked at.
pub struct RollingDriver {
    engine: RollingEngine,
    plan: Arc<Plan>,
    step: u64,
    time: f64,
    spent: Duration,
}

impl RollingDriver {
    /// Sets up the bodies of a plan.
    ///
    /// # Errors
    /// [`EngineError::Events`]: bodies overlap, or the plan is for another driver.
    pub fn new(plan: Arc<Plan>) -> Result<Self, EngineError> {
        let engine = RollingEngine::new(&rolling_setup(&plan)?).map_err(refused)?;
        Ok(Self { engine, plan, step: 0, time: 0.0, spent: Duration::ZERO })
    }

    /// Goes on from a saved state.
    ///
    /// # Errors
    /// The state does not fit the plan.
    pub fn restore(plan: Arc<Plan>, at: Moment, state: RollingState<'_>) -> Result<Self, EngineError> {
        at.check(&plan)?;
        let engine = RollingEngine::restore(&rolling_setup(&plan)?, state).map_err(refused)?;
        Ok(Self { engine, plan, step: at.step, time: at.time, spent: Duration::ZERO })
    }

    /// The engine, for tests and benchmarks.
    pub fn engine(&self) -> &RollingEngine {
        &self.engine
    }

    /// Collisions since the start.
    pub fn counts(&self) -> &Counts {
        self.engine.counts()
    }

    fn snapshot(&self) -> Snapshot {
        let plan = &self.plan;
        let bodies = bodies(plan, &self.engine.states(self.time));
        let counts = *self.engine.counts();
        let done = self.engine.tally(self.time);
        let mut substrate = SubstrateTally::default();
        (substrate.sliding, substrate.rolling, substrate.resting) =
            (done.sliding, done.rolling, done.resting);
        substrate.work.sliding = done.work.sliding;
        substrate.work.rolling = done.work.rolling;
        substrate.work.drilling = done.work.drilling;
        substrate.work.plate = done.work.plate;
        let tally = Tally { wall_force: vec![[0.0; 3]; plan.walls.len()], ..Tally::default() };
        Snapshot { bodies, tally, work: work(plan, &counts), substrate, counts }
    }
}

impl Driver for RollingDriver {
    fn step(&self) -> u64 {
        self.step
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn advance(&mut self, until: u64, stop: &AtomicBool) -> Result<Advance, EngineError> {
        let begin = Instant::now();
        let result = loop {
            if self.step >= until {
                break Ok(Advance::Reached);
            }
            if stop.load(Ordering::Relaxed) {
                break Ok(Advance::Stopped);
            }
            let target = (self.step + 1) as f64 * self.plan.driver.step;
            match self.engine.advance(target, STRIDE) {
                Ok(true) => (self.step, self.time) = (self.step + 1, target),
                Ok(false) => self.time = self.engine.time(),
                Err(error) => {
                    self.time = self.engine.time();
                    break Err(failed(&self.plan, self.step, error));
                }
            }
        };
        self.spent += begin.elapsed();
        result
    }

    fn view(&self) -> View<'_> {
        View::of_events(&self.plan, self.step, self.time, self.snapshot())
    }

    fn save(&self) -> DriverState<'_> {
        DriverState::Rolling(Moment { step: self.step, time: self.time }, self.engine.save())
    }

    fn timings(&self) -> Timings {
        Timings { forces: self.spent, ..Timings::default() }
    }

    fn threads(&self) -> usize {
        1
    }
}

/// What the engine needs of a plan.
fn rolling_setup(plan: &Plan) -> Result<RollingSetup, EngineError> {
    let base = setup(plan)?;
    let (Some(substrate), Some(slides)) =
        (&plan.substrate, plan.event.as_ref().and_then(|event| event.slides))
    else {
        return Err(EngineError::Events("this plan has no substrate".to_string()));
    };
    let friction = substrate
        .materials
        .iter()
        .map(|material| material.as_ref().and_then(|material| material.stage.friction().cloned()))
        .collect();
    let between = match slides {
        Slides::Arcs { error } => Between::Arcs { error },
        Slides::EffectiveRestitution => Between::EffectiveRestitution,
    };
    let (height, motion, ledger) = (substrate.height, substrate.motion.clone(), plan.ledger);
    Ok(RollingSetup { base, height, motion, friction, between, ledger })
}
