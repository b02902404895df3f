//! What can be wrong with a file, or with the values that should go into one.

use std::error::Error;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Longest piece of offending text that an error repeats.
const LONGEST_QUOTE: usize = 80;

/// Why a file could not be read or written.
#[derive(Debug)]
pub enum FormatError {
    /// The operating system refused.
    Io {
        /// The file.
        file: PathBuf,
        /// What was tried: `read`, `create`, ...
        action: &'static str,
        /// The answer of the operating system.
        source: io::Error,
    },
    /// The text of a file is not what the format allows.
    Syntax {
        /// The file.
        file: PathBuf,
        /// Line, from 1. For a file that ends too early: its last line.
        line: u64,
        /// Character in the line, from 1, where the problem has one place.
        column: Option<usize>,
        /// The offending text, shortened to 80 characters.
        found: String,
        /// What is allowed in this place.
        expected: String,
    },
    /// A value of a body is not finite, so that no reader of the file could use it.
    NonFinite {
        /// Identity of the body.
        body: u32,
        /// The quantity, as named in the file.
        quantity: String,
        /// The value.
        value: f64,
    },
    /// A file that must be whole is damaged, or not of the expected kind.
    Refused {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// The values do not fit the format.
    Unwritable {
        /// The file.
        file: PathBuf,
        /// What does not fit.
        problem: String,
    },
}

impl FormatError {
    pub(crate) fn io(file: &Path, action: &'static str) -> impl FnOnce(io::Error) -> FormatError {
        let file = file.to_path_buf();
        move |source| FormatError::Io { file, action, source }
    }

    pub(crate) fn refused(file: &Path, problem: impl Into<String>) -> FormatError {
        FormatError::Refused { file: file.to_path_buf(), problem: problem.into() }
    }

    pub(crate) fn unwritable(file: &Path, problem: impl Into<String>) -> FormatError {
        FormatError::Unwritable { file: file.to_path_buf(), problem: problem.into() }
    }

    pub(crate) fn syntax(
        file: &Path,
        line: u64,
        column: Option<usize>,
        found: &str,
        expected: impl Into<String>,
    ) -> FormatError {
        FormatError::Syntax {
            file: file.to_path_buf(),
            line,
            column,
            found: shorten(found),
            expected: expected.into(),
        }
    }
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FormatError::Io { file, action, source } => {
                write!(f, "cannot {action} `{}`: {source}", file.display())
            }
            FormatError::Syntax { file, line, column, found, expected } => {
                write!(f, "{}:{line}", file.display())?;
                if let Some(column) = column {
                    write!(f, ":{column}")?;
                }
                match found.as_str() {
                    "" => write!(f, ": expected {expected}"),
                    found => write!(f, ": found `{found}`, expected {expected}"),
                }
            }
            FormatError::NonFinite { body, quantity, value } => {
                write!(f, "{quantity} of body {body} is {value}: only finite values can be written")
            }
            FormatError::Refused { file, problem } => {
                write!(f, "`{}` cannot be used: {problem}", file.display())
            }
            FormatError::Unwritable { file, problem } => {
                write!(f, "cannot write `{}`: {problem}", file.display())
            }
        }
    }
}

impl Error for FormatError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            FormatError::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}

fn shorten(text: &str) -> String {
    let mut shown: String =
        text.chars().take(LONGEST_QUOTE).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(LONGEST_QUOTE).is_some() {
        shown.push('…');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_where_what_and_what_else() {
        let error = FormatError::syntax(Path::new("pile.data"), 12, Some(5), "1e5x", "a finite number");
        assert_eq!(error.to_string(), "pile.data:12:5: found `1e5x`, expected a finite number");
        let error = FormatError::syntax(Path::new("pile.data"), 9, None, "", "3 more lines of atoms");
        assert_eq!(error.to_string(), "pile.data:9: expected 3 more lines of atoms");
        let error = FormatError::NonFinite { body: 7, quantity: "vx".into(), value: f64::NAN };
        assert_eq!(error.to_string(), "vx of body 7 is NaN: only finite values can be written");
    }

    #[test]
    fn long_or_unprintable_text_is_shortened() {
        let error = FormatError::syntax(Path::new("a"), 1, None, &"x\u{1b}".repeat(100), "less");
        let FormatError::Syntax { found, .. } = error else { panic!("not a syntax error") };
        assert_eq!(found.chars().count(), 81);
        assert!(!found.contains('\u{1b}'));
    }
}
