//! The state of a driver, to be written down and taken up again.

use std::sync::Arc;

use granule_engine::{EngineError, EngineState};
use granule_plan::Plan;
use serde::{Deserialize, Serialize};

use crate::{Driver, TimeStepDriver};

/// Everything that decides how a run goes on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum DriverState<'a> {
    /// Of the soft driver.
    Steps(EngineState<'a>),
}

impl DriverState<'_> {
    /// Steps done.
    pub fn step(&self) -> u64 {
        match self {
            Self::Steps(state) => state.step(),
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
    match (state, plan.event.is_some()) {
        (DriverState::Steps(state), false) => Ok(Box::new(TimeStepDriver::restore(plan, threads, state)?)),
        _ => Err(EngineError::Saved("the driver")),
    }
}
