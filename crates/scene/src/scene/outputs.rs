//! Outputs of a run, as a scene says them.

use std::ops::Range;

use super::Spanned;

/// Interval between two entries of an output.
#[derive(Clone, Debug, PartialEq)]
pub enum EveryChoice {
    /// Steps.
    Steps(u64),
    /// Simulated time \[s\].
    Time(f64),
}

/// What an output holds.
#[derive(Clone, Debug, PartialEq)]
pub enum OutputChoice {
    /// Time series of global quantities.
    Series {
        /// Names of the quantities; the usual ones if absent.
        columns: Option<Vec<Spanned<String>>>,
    },
    /// Time series of single bodies.
    Bodies {
        /// Their ids.
        ids: Vec<Spanned<u32>>,
    },
    /// LAMMPS text dump.
    LammpsDump,
    /// VTK files.
    Vtk {
        /// Compressed blocks.
        compressed: bool,
    },
    /// LAMMPS data file of the last state.
    LammpsData,
    /// Time series of many bodies together.
    Layer {
        /// Gap that connects bodies to clusters \[m\].
        gap: Option<f64>,
        /// Gap of neighbours for the index of segregation \[m\].
        neighbours: Option<f64>,
    },
    /// Pair correlations.
    PairCorrelation {
        /// Largest distance \[m\].
        range: f64,
        /// Number of intervals.
        bins: u32,
    },
    /// What each contact does.
    Contacts,
    /// Restitution by density and speed.
    Impacts {
        /// Radius of the surroundings whose density counts \[m\].
        reach: Option<f64>,
    },
}

/// One output.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputBlock {
    /// Path, relative to the output folder of the run.
    pub path: Spanned<String>,
    /// What it holds.
    pub what: OutputChoice,
    /// Interval.
    pub every: Option<Spanned<EveryChoice>>,
    /// Where the block stands.
    pub span: Range<usize>,
}
