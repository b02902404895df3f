//! The mechanical state: body rows in memory order, the layout that decides which of them exist, and vectors of four
//! numbers to compute with rows.
//!
//! Knows nothing about laws or time stepping.

mod bodies;
mod lanes;
#[cfg(target_arch = "x86_64")]
mod lanes_avx2;
mod row;

pub use bodies::{Bodies, BodyInput, Layout, SurfaceRow};
#[cfg(target_arch = "x86_64")]
pub use lanes::Avx2;
pub use lanes::{InstructionSet, Lanes, Number, PACKED, Portable};
pub use row::Row;
