//! The engines' equations once more: plain, slow, one contact at a time, every convention a switch.
//!
//! With [`ConventionSet::of`] it follows the running engine to round-off, which tells a mistake of ours from one in what is
//! known about the engine.

mod coefficients;
mod contact;
mod conventions;
mod march;
mod vector;

pub use conventions::{Arm, ContactEnd, ConventionSet, CoulombCap, CoulombTest, HistoryOrder, Velocity};
pub use march::{march, march_with};

mod tests;
