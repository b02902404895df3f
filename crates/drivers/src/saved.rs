//! The state of a driver, to be written down and taken up again.

use std::sync::Arc;

use granule_engine::{EngineError, EngineState};
use granule_events::{EventState, RollingState};
use granule_plan::Plan;
use serde::{Deserialize, Serialize};

use crate::{Driver, EventDriver, RollingDriver, TimeStepDriver};

/// Where a hard driver is between two of its steps.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Moment {
    pub(crate) step: u64,
    pub(crate) time: f64,
}

impl Moment {
    /// Compares it with the plan.
    pub(crate) fn check(&self, plan: &Plan) -> Result<(), EngineError> {
        if self.step <= plan.driver.steps && self.time.is_finite() {
            Ok(())
        } else {
            Err(EngineError::Saved("step or time"))
        }
    }
}

/// Everything that decides how a run goes on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum DriverState<'a> {
    /// Of the soft driver.
    Steps(Box<EngineState<'a>>),
    /// Of the hard driver.
    Events(Moment, EventState<'a>),
    /// Of the hard driver on a substrate.
    Rolling(Moment, RollingState<'a>),
}

impl DriverState<'_> {
    /// Steps done.
    pub fn step(&self) -> u64 {
        match self {
            Self::Steps(state) => state.step(),
            Self::Events(moment, _) | Self::Rolling(moment, _) => moment.step,
        }
    }
}

/// The driver of a plan, going on from a saved state with the bits of a run that was never interrupted. `threads` overrides
/// the plan.
///
/// # Errors
/// [`EngineError::Saved`]: the state does not fit the plan.
pub fn restore(
    plan: Arc<Plan>,
    threads: Option<usize>,
    state: DriverState<'_>,
) -> Result<Box<dyn Driver>, EngineError> {
    match (state, plan.event.is_some(), plan.substrate.is_some()) {
        (DriverState::Steps(state), false, _) => {
            Ok(Box::new(TimeStepDriver::restore(plan, threads, *state)?))
        }
        (DriverState::Events(at, state), true, false) => Ok(Box::new(EventDriver::restore(plan, at, state)?)),
        (DriverState::Rolling(at, state), true, true) => {
            Ok(Box::new(RollingDriver::restore(plan, at, state)?))
        }
        _ => Err(EngineError::Saved("the driver")),
    }
}
