//! The mechanical state: body rows in memory order, and the layout that decides which of them exist.
//!
//! Knows nothing about laws or time stepping.

mod bodies;
mod row;

pub use bodies::{Bodies, BodyInput, Layout};
pub use row::Row;
