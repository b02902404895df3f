//! Files of the field: LAMMPS data and dump, VTK, CSV, written atomically.
//!
//! Plain arrays in, files out, and back. This crate knows nothing about laws, plans or the engine.
//!
//! | module | files | direction |
//! |---|---|---|
//! | [`lammps_data`] | LAMMPS and LIGGGHTS data file, `atom_style sphere` | read, write |
//! | [`lammps_dump`] | LAMMPS text dump (`dump custom`), several frames | read, write |
//! | [`vtk`] | VTK `.vtp` poly data with a `.pvd` collection | write (`.pvd` also read) |
//! | [`csv`] | tables of numbers, and time series that grow | read, write |
//! | [`atomic`] | a file that is either whole or absent, and a file that grows record by record | write |
//! | [`checkpoint`] | bytes with layout and checksum | read, write |
//!
//! Every output carries a [`Provenance`]. Every number survives a round trip bit by bit: text is the shortest decimal
//! that reads back to the same double, which is at most 17 significant digits.
//!
//! A [`FormatError`] names the file, the line, the column where there is one, the offending text and what is allowed.

pub mod atomic;
pub mod checkpoint;
pub mod csv;
mod error;
pub mod lammps_data;
pub mod lammps_dump;
mod number;
pub mod particles;
mod provenance;
mod text;
pub mod vtk;

pub use error::FormatError;
pub use particles::{Cell, Frame, ScalarColumn};
pub use provenance::Provenance;
