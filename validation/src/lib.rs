//! Comparison of scenes with LAMMPS and LIGGGHTS.
//!
//! [`cases`] are folders with a scene each; [`translate`] writes a peer's description from the plan of a scene; [`peers`] runs
//! the engines, keeps recorded answers for machines without them, and compares frame by frame; [`validate`] judges all cases
//! and writes the report; [`mod@bench`] compares speed; [`mod@extremes`] shows
//! what each engine does at the extremes.

pub mod bench;
pub mod cases;
pub mod causes;
pub mod extremes;
pub mod figures;
pub mod ours;
pub mod peers;
pub mod pile;
pub mod race;
pub mod soft;
pub mod translate;
pub mod two_bodies;
pub mod validate;
