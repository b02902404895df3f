//! Comparison of scenes with LAMMPS and LIGGGHTS
//!
//! [`cases`] is the table of set-ups, each in the words of every engine that has its law; [`peers`] runs the engines, keeps
//! recorded references for machines without them, compares frame by frame and tells differences apart by cause;
//! [`reference()`] hands out the engine's answer, live where possible.

pub mod cases;
pub mod peers;
mod references;

pub use references::{Reference, bless, reference, reference_path};
