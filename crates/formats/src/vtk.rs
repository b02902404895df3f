//! VTK XML files for ParaView, VisIt and PyVista: `.vtp` poly data, one file a frame, and a `.pvd` collection of them.
//!
//! Arrays are appended as raw little-endian bytes, so that writing costs what the disk costs; zlib compression is
//! optional. Doubles stay doubles. [`Series`] writes both kinds of file during a run.
//!
//! In a `.vtp` file, points are the centres; the point data are `id`, `type` (material index + 1, as in LAMMPS files),
//! `radius`, `mass`, `velocity`, and where present `angular_velocity`, `force`, `torque` and the further columns of the
//! frame. The field data are `TimeValue`, which ParaView takes for the time, `step`, the box (`cell_lo`, `cell_hi`,
//! `cell_periodic`) and the provenance (`program_version`, `plan_fingerprint`, `created`). All points form one
//! poly-vertex cell, so that they are drawn without a filter.

mod arrays;
mod polydata;
mod pvd;

pub use arrays::Compression;
pub use polydata::write;
pub use pvd::{Entry, Series, read_collection};
