//! What can be wrong with the data handed to a report.

use std::fmt;

/// A report part that cannot be made from the data given.
#[derive(Debug)]
pub enum ReportError {
    /// Two arrays that must have one length do not. The text says which.
    LengthMismatch {
        /// What the arrays belong to, such as the name of a series.
        what: String,
        /// Length of the first array.
        expected: usize,
        /// Length of the second array.
        found: usize,
    },
    /// A size, range or bar that makes no sense; the text says which and why.
    Invalid(String),
    /// A sample without values, or with too few for the quantity asked for.
    TooFewValues {
        /// The quantity asked for.
        what: &'static str,
        /// Values needed.
        needed: usize,
        /// Values given.
        found: usize,
    },
    /// A NaN or an infinity where a number is needed.
    NotFinite {
        /// What holds it.
        what: String,
        /// Its place, from zero.
        index: usize,
    },
    /// Text that is not the JSON expected.
    Json(serde_json::Error),
}

impl fmt::Display for ReportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LengthMismatch { what, expected, found } => {
                write!(f, "{what}: arrays of {expected} and of {found} values must have the same length")
            }
            Self::Invalid(text) => f.write_str(text),
            Self::TooFewValues { what, needed, found } => {
                write!(f, "{what} needs at least {needed} value(s), got {found}")
            }
            Self::NotFinite { what, index } => write!(f, "{what}: value {index} is not a finite number"),
            Self::Json(source) => write!(f, "not the expected JSON: {source}"),
        }
    }
}

impl std::error::Error for ReportError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Json(source) => Some(source),
            _ => None,
        }
    }
}

impl From<serde_json::Error> for ReportError {
    fn from(source: serde_json::Error) -> Self {
        Self::Json(source)
    }
}
