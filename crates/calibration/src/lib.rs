//! The parameters of an impact, e_n, μ and e_t0, from measured impacts (Luding 1998, Sec. 4.2; Foerster, Louge, Chang and
//! Allia 1994).
//!
//! Ψ1 is the tangential velocity of the contact point before an impact and Ψ2 the one after, in the same direction, both
//! over the normal speed before. The three-parameter rule is Ψ2 = max(Ψ1 - s, -e_t0 Ψ1) with s = μ (1 + e_n)(1 + 1/q)
//! (Luding 1998, Eq. (21)): an impact slides or it sticks. [`fit`] finds the parameters with their uncertainty, and says
//! which of them the data cannot determine: e_t0 if every impact slides, μ if every one sticks, μ alone if no normal
//! restitution is known.

mod data;
mod fit;

pub use data::{DataError, Impact, read, table};
pub use fit::{Estimate, Fit, FitError, Options, Value, fit};
