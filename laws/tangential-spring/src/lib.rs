//! Tangential spring with friction and history.

mod forms;
mod law;
mod prediction;
mod stage;

pub use law::TangentialSpring;
