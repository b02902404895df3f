//! What an observer is.

use std::path::{Path, PathBuf};

use granule_drivers::View;
use granule_formats::FormatError;

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

    /// Completes what it has written.
    ///
    /// # Errors
    /// A file cannot be written.
    fn finish(&mut self) -> Result<(), ObserveError>;
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
