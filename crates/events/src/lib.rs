//! The event-driven engine: hard bodies fly freely and collide in an instant.
//!
//! Straight or parabolic flight is exact; collisions follow a [`CollisionRule`](granule_law_api::CollisionRule). This crate
//! knows nothing about scenes, plans or files.

mod body;
mod cells;
mod engine;
mod flight;
mod impact;
mod look_ahead;
mod neighbours;
mod predict;
mod prefetch;
mod queue;
mod renumber;
mod report;
mod setup;
mod two;
mod wall;

pub use engine::{BodyState, EventEngine, Tuning};
pub use report::{Counts, HARD_LIMIT};
pub use setup::{BodyInput, EventError, Setup, WallInput};
