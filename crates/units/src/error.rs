//! What can be wrong with a quantity that a user wrote.

use std::fmt;

use crate::Dimension;

/// Why a text is not the quantity that was asked for. `Display` is the sentence that a user sees.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum UnitError {
    /// The text does not start with a decimal number.
    BadNumber {
        /// The text as written.
        text: String,
    },
    /// A unit name that nobody knows.
    UnknownUnit {
        /// The name as written.
        unit: String,
        /// The known name that looks most like it.
        nearest: Option<String>,
    },
    /// The unit text does not follow the grammar.
    BadUnit {
        /// The unit part as written.
        unit: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// The quantity is a good one, but of another dimension.
    WrongDimension {
        /// The text as written.
        text: String,
        /// The dimension of the text.
        found: Dimension,
        /// The dimension that was asked for.
        expected: Dimension,
    },
    /// The value is infinite, not a number, or too large for a double-precision number.
    NotFinite {
        /// The text as written.
        text: String,
    },
}

impl fmt::Display for UnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadNumber { text } => {
                write!(
                    f,
                    "`{text}` does not start with a number; write a number and its unit, such as `2.5 mm`"
                )
            }
            Self::UnknownUnit { unit, nearest } => {
                write!(f, "unknown unit `{unit}`")?;
                match nearest {
                    Some(name) => write!(f, "; did you mean `{name}`?"),
                    None => f.write_str("; known units are m, g, s, N, Pa, J, Hz, rad, W, min, h and deg"),
                }
            }
            Self::BadUnit { unit, reason } => write!(f, "cannot read the unit `{unit}`: {reason}"),
            Self::WrongDimension { text, found, expected } => {
                write!(f, "expected ")?;
                describe(f, *expected)?;
                if found.is_dimensionless() {
                    write!(f, ", but `{text}` has no unit")
                } else {
                    write!(f, ", but `{text}` is ")?;
                    describe(f, *found)
                }
            }
            Self::NotFinite { text } => write!(f, "`{text}` is not a finite number"),
        }
    }
}

impl std::error::Error for UnitError {}

/// `a stiffness in N/m`, `a quantity in kg m^-4`, `a plain number`.
fn describe(f: &mut fmt::Formatter<'_>, dimension: Dimension) -> fmt::Result {
    let name = dimension.name().unwrap_or("quantity");
    let article = if name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    if dimension.is_dimensionless() {
        write!(f, "{article} {name}")
    } else {
        write!(f, "{article} {name} in {dimension}")
    }
}
