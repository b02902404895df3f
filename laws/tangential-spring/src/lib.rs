//! Tangential spring with friction and history.

mod forms;
mod law;
mod prediction;
mod stage;
#[cfg(test)]
mod tests;

pub use law::TangentialSpring;
