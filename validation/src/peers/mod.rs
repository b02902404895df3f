//! LAMMPS and LIGGGHTS: what they are told, how they are run, and how their answer is compared.
//!
//! ```text
//! PeerScene ──> InputFiles ──> run ──> Frames ──> compare
//!                               └──> Record (kept in the repository for machines without the engines)
//! ```

pub mod compare;
mod dump;
mod error;
mod frame;
mod inputs;
mod lammps;
mod liggghts;
mod model;
#[cfg(test)]
mod oracle;
mod process;
mod record;
mod run;
#[cfg(test)]
mod tests;
mod vector;

pub use error::PeerError;
pub use frame::{Frame, Quantity};
pub use inputs::{InputFiles, inputs};
pub use model::{
    Axis, ClassicLaw, ClassicStyle, Engine, GranularDamping, GranularLaw, GranularNormal, GranularTangential,
    LiggghtsLaw, LiggghtsNormal, LiggghtsTangential, PeerBody, PeerLaw, PeerMaterial, PeerScene, PeerWall,
    Side, Tuning,
};
pub use process::{RunOptions, find_binary, last_lines, peak_resident, processor_seconds};
pub use record::{Record, today};
pub use run::{Attempt, PeerRun, Timed, attempt, run, time};
