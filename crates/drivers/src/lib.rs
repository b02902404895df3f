//! Drivers: advance a plan's bodies in time.
//!
//! A driver knows nothing about output. It advances to a step, or stops early when asked to, and shows a read-only
//! [`View`] of what it has reached.

mod event;
mod rolling;
mod saved;
mod time_step;
mod view;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

pub use event::EventDriver;
pub use granule_engine::{
    Alarm, AlarmKind, ContactForce, ContactPartner, ContactRecord, EngineError, Tally, Work,
};
pub use granule_events::Counts;
pub use rolling::RollingDriver;
pub use saved::{DriverState, Moment, restore};
pub use time_step::TimeStepDriver;
pub use view::View;

/// How an advance ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Advance {
    /// At the step that was asked for.
    Reached,
    /// Earlier, because `stop` was set. The state is whole; advancing again continues with the same bits.
    Stopped,
}

/// Wall-clock time spent in each phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timings {
    /// Candidate lists.
    pub lists: Duration,
    /// Contacts, laws and forces.
    pub forces: Duration,
    /// Time integration.
    pub integration: Duration,
}

/// Something that advances bodies in time.
pub trait Driver: Send {
    /// Steps done.
    fn step(&self) -> u64;
    /// Simulated time \[s\].
    fn time(&self) -> f64;
    /// Advances to step `until`, or to an earlier one if `stop` is set.
    ///
    /// # Errors
    /// The run cannot go on; the state is that of the failing step.
    fn advance(&mut self, until: u64, stop: &AtomicBool) -> Result<Advance, EngineError>;
    /// What has been reached.
    fn view(&self) -> View<'_>;
    /// What decides how the run goes on, for [`restore`].
    fn save(&self) -> DriverState<'_>;
    /// Limits that were passed since the last call and end no run.
    fn alarms(&mut self) -> Vec<Alarm> {
        Vec::new()
    }
    /// Where the time went.
    fn timings(&self) -> Timings;
    /// Worker threads in use.
    fn threads(&self) -> usize;
    /// Hash of positions, velocities and spins of all bodies, in the order of their identities. The same scene gives
    /// the same hash on any number of threads.
    fn result_hash(&self) -> u64 {
        self.view().hash()
    }
}

/// The driver that a plan asks for, with its bodies set up. `threads` overrides the plan.
///
/// # Errors
/// See [`EngineError`].
pub fn driver(plan: Arc<granule_plan::Plan>, threads: Option<usize>) -> Result<Box<dyn Driver>, EngineError> {
    if plan.event.is_some() && plan.substrate.is_some() {
        return Ok(Box::new(RollingDriver::new(plan)?));
    }
    if plan.event.is_some() {
        return Ok(Box::new(EventDriver::new(plan)?));
    }
    Ok(Box::new(TimeStepDriver::new(plan, threads)?))
}
