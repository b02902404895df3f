//! Text dumps of LAMMPS (`dump custom`), with any number of frames.
//!
//! ```text
//! ITEM: TIME
//! 0.0004
//! ITEM: TIMESTEP
//! 400
//! ITEM: NUMBER OF ATOMS granule 0.1.0 plan=0f3a created=1764000000 time=0.0004
//! 2
//! ITEM: BOX BOUNDS pp ff ff
//! -0.01 0.01
//! -0.01 0.01
//! -0.01 0.01
//! ITEM: ATOMS id type radius mass x y z vx vy vz omegax omegay omegaz fx fy fz tqx tqy tqz
//! 1 1 0.0005 1.3089969389957472e-6 ...
//! ```
//!
//! # Where the provenance is
//! Behind `ITEM: NUMBER OF ATOMS`, in every frame, because that is the one place of the format that every reader passes
//! over. LAMMPS `read_dump` and LIGGGHTS skip this line unread, OVITO compares its beginning only, ASE looks for the
//! words in it, MDAnalysis skips it by position. Elsewhere it would break one of them: LAMMPS matches the lines
//! `ITEM: TIMESTEP` and `ITEM: TIME` to their end and reads the counts as the only word of a line; an item of its own
//! stops LAMMPS and LIGGGHTS. Tried with LAMMPS 29 Sep 2021, LIGGGHTS 3.8, OVITO 3, ASE and MDAnalysis.
//!
//! # Time
//! `ITEM: TIME` is read by OVITO and, since 2021, by LAMMPS; LIGGGHTS and MDAnalysis expect `ITEM: TIMESTEP` as the
//! first line: [`Dialect`]. The time is always behind the provenance too, where [`Reader`] finds it.

mod frame;
mod read;
mod write;

pub use frame::{DumpColumn, DumpFrame, Values};
pub use read::{Reader, read};
pub use write::{Dialect, DumpWriter};

/// What a line starts with.
const ITEM: &str = "ITEM:";
