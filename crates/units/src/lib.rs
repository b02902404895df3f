//! Physical dimensions and quantities with units: text to SI numbers.
//!
//! A user writes `"1e5 N/m"` or `"30 deg"`; the rest of the program sees an `f64` in SI units, checked
//! against the [`Dimension`] that the reader of the value expects.
//!
//! ```
//! use granule_units::{Dimension, parse_as};
//!
//! assert_eq!(parse_as("1 mm", Dimension::LENGTH), Ok(1e-3));
//! assert_eq!(parse_as("1e5 N/m", Dimension::STIFFNESS), Ok(1e5));
//! assert!(parse_as("1e5 N", Dimension::STIFFNESS).is_err());
//! ```
//!
//! # Grammar
//! `number [unit]`, where the unit is a product of factors joined by a space, `*`, `.`, `·` or `/`, each with an
//! optional integer power (`^2`, `^-1`, `²`). Parentheses group: `kg/(m s^2)`. A product that follows a `/` without
//! parentheses (`N/m s`) is refused, because people read it in both ways.
//!
//! Units are `m g s N Pa J Hz rad W` with the prefixes `f p n u µ m c d k M G T`, and `min`, `h`, `deg` and `°`
//! without prefixes. Angles are dimensionless, in radians.
//!
//! Decimal prefixes are exact: `"3 mm"` is the same floating-point number as `3e-3`.

mod dimension;
mod error;
mod parse;
mod table;

pub use dimension::Dimension;
pub use error::UnitError;
pub use parse::{Quantity, parse, parse_as};
