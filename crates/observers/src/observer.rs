//! What an observer is.

use std::path::{Path, PathBuf};

use granule_drivers::View;
use granule_formats::FormatError;
use granule_formats::csv::AppendLog;
use serde::{Deserialize, Serialize};

use crate::Energy;
use crate::layer::ImpactMeter;

/// Looks at a run from time to time and writes what it sees. It cannot change the run.
///
/// `start` is called once before the first look, `observe` at every step that is due, `finish` once after the last look.
/// What `observe` has written when it returns must survive the end of the process.
pub trait Observer: Send {
    /// The file that a user looks for: the only one, or the index of a series.
    fn path(&self) -> &Path;

    /// Kind of the file, as in the manifest: `csv`, `lammps-dump`, ...
    fn kind(&self) -> &'static str;

    /// Opens what it needs.
    ///
    /// # Errors
    /// A file cannot be written, or the plan lacks what is asked for.
    fn start(&mut self, view: &View<'_>) -> Result<(), ObserveError>;

    /// Writes one entry.
    ///
    /// # Errors
    /// A file cannot be written.
    fn observe(&mut self, view: &View<'_>) -> Result<(), ObserveError>;

    /// Where it is, so that another one can go on from there; what it has written is then on the disk.
    ///
    /// # Errors
    /// A file cannot be written.
    fn mark(&self) -> Result<Mark, ObserveError>;

    /// Goes on from a mark instead of [`start`](Self::start): what was written later is cut off.
    ///
    /// # Errors
    /// The mark is not one of this observer, or a file is not as it was.
    fn resume(&mut self, mark: &Mark, view: &View<'_>) -> Result<(), ObserveError>;

    /// Completes what it has written.
    ///
    /// # Errors
    /// A file cannot be written.
    fn finish(&mut self) -> Result<(), ObserveError>;
}

/// Where an observer is.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Mark {
    /// It keeps nothing from entry to entry.
    Nothing,
    /// Bytes of a file that grows.
    Length(u64),
    /// Bytes of a file that grows, and the energies at the start of the run.
    LengthSince(u64, Energy),
    /// Files of a series.
    Files(u64),
    /// Collisions seen so far.
    Impacts(ImpactMeter),
}

impl Mark {
    /// Length of a log, which is then on the disk; 0 before it begins.
    pub(crate) fn length(log: Option<&AppendLog>) -> Result<u64, ObserveError> {
        let Some(log) = log else { return Ok(0) };
        log.sync()?;
        Ok(log.length())
    }

    /// The error of an observer whose mark this is not.
    pub(crate) fn foreign(path: &Path) -> ObserveError {
        ObserveError::Mark { path: path.to_path_buf() }
    }
}

/// Why an observer cannot go on.
#[derive(Debug)]
pub enum ObserveError {
    /// A file cannot be written.
    Write(FormatError),
    /// There is no such quantity.
    UnknownQuantity {
        /// The name.
        name: String,
    },
    /// A mark is that of another observer.
    Mark {
        /// The file of the observer.
        path: PathBuf,
    },
    /// There is no such body.
    UnknownBody {
        /// Its identity.
        id: u32,
    },
    /// Two outputs would write the same file, or one would leave the output folder.
    Path {
        /// The path as asked for.
        path: PathBuf,
        /// What is wrong with it.
        reason: &'static str,
    },
}

impl From<FormatError> for ObserveError {
    fn from(error: FormatError) -> Self {
        Self::Write(error)
    }
}

impl std::fmt::Display for ObserveError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Write(error) => error.fmt(f),
            Self::UnknownQuantity { name } => {
                let known: Vec<&str> = granule_plan::SERIES.iter().map(|(name, _, _)| *name).collect();
                write!(f, "there is no quantity `{name}`; known are {}", known.join(", "))
            }
            Self::Mark { path } => {
                write!(f, "the checkpoint says nothing about the output {}", path.display())
            }
            Self::UnknownBody { id } => write!(f, "there is no body {id}"),
            Self::Path { path, reason } => write!(f, "output `{}`: {reason}", path.display()),
        }
    }
}

impl std::error::Error for ObserveError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Write(error) => Some(error),
            _ => None,
        }
    }
}
