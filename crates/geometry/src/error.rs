//! What can be wrong with a geometric description.

use std::fmt;

/// Why a geometric object cannot be built. `Display` is the sentence that a user sees.
#[derive(Clone, Debug, PartialEq)]
pub enum GeometryError {
    /// A number that must be finite is not.
    NotFinite {
        /// What the number is, such as `plane point`.
        what: &'static str,
    },
    /// A direction has no length.
    ZeroVector {
        /// What the direction is, such as `plane normal`.
        what: &'static str,
    },
    /// A number that must be positive is not.
    NotPositive {
        /// What the number is, such as `cylinder radius`.
        what: &'static str,
        /// The number, SI units.
        value: f64,
    },
    /// An inertia factor outside (0, 1].
    InertiaFactor {
        /// The factor.
        value: f64,
    },
    /// The upper bound of a box is not above its lower bound.
    EmptyExtent {
        /// The direction: 0, 1, 2 for x, y, z.
        axis: usize,
        /// Lower bound, m.
        lo: f64,
        /// Upper bound, m.
        hi: f64,
    },
    /// A periodic direction needs finite bounds.
    UnboundedPeriod {
        /// The direction: 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// A periodic direction is so short that a pair of bodies could touch through two images at once.
    PeriodTooShort {
        /// The direction: 0, 1, 2 for x, y, z.
        axis: usize,
        /// Its length, m.
        length: f64,
        /// The least length that is accepted, m.
        minimum: f64,
    },
    /// A table of displacements without rows.
    EmptyTable,
    /// The times of a table do not increase.
    TableOrder {
        /// The first row whose time is not after the time of the row before, counted from 0.
        row: usize,
    },
}

impl fmt::Display for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |axis: usize| ["x", "y", "z"].get(axis).copied().unwrap_or("?");
        match *self {
            Self::NotFinite { what } => write!(f, "the {what} must be finite"),
            Self::ZeroVector { what } => write!(f, "the {what} must not be the zero vector"),
            Self::NotPositive { what, value } => write!(f, "the {what} must be positive, not {value:?}"),
            Self::InertiaFactor { value } => {
                write!(f, "the inertia factor I/(m R^2) must be above 0 and at most 1, not {value:?}")
            }
            Self::EmptyExtent { axis, lo, hi } => {
                write!(f, "the upper bound {hi:?} m in {} must be above the lower bound {lo:?} m", name(axis))
            }
            Self::UnboundedPeriod { axis } => {
                write!(f, "the periodic direction {} needs finite bounds", name(axis))
            }
            Self::PeriodTooShort { axis, length, minimum } => write!(
                f,
                "the periodic length {length:?} m in {} is below {minimum:?} m: twice the largest distance at \
                 which two bodies are neighbours",
                name(axis)
            ),
            Self::EmptyTable => f.write_str("a table of displacements needs at least one row"),
            Self::TableOrder { row } => {
                write!(f, "the times of a table must increase, but row {row} (counted from 0) does not")
            }
        }
    }
}

impl std::error::Error for GeometryError {}
