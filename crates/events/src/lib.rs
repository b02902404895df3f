//! The event-driven engine: hard bodies fly freely and collide in an instant.
//!
//! Or they slide and roll on a plate between collisions ([`RollingEngine`]). Straight or parabolic flight is exact; collisions follow a [`CollisionRule`](granule_law_api::CollisionRule). This crate
//! knows nothing about scenes, plans or files.

mod body;
mod cells;
mod engine;
mod fault;
mod flight;
mod impact;
mod look_ahead;
mod neighbours;
mod predict;
mod prefetch;
mod queue;
mod renumber;
mod report;
mod rolling;
mod saved;
mod setup;
mod two;
mod wall;

pub use engine::{BodyState, EventEngine, Tuning};
pub use fault::RuleFault;
pub use report::{Counts, HARD_LIMIT};
pub use rolling::{Between, RollingEngine, RollingSetup, RollingState, RollingTally, RollingWork};
pub use saved::EventState;
pub use setup::{BodyInput, EventError, Setup, WallInput};
