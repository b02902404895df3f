//! Single contacts, integrated to tight tolerance: the reference where no closed form exists.
//!
//! Any composition of registered laws can be integrated, by the interface that the engine uses: normal, cohesive,
//! tangential, rolling and torsion stages with their histories, all conventions, two spheres or a sphere and a plane, any
//! masses, radii and inertia factors. [`Collision`] is the exact problem, whose normal turns during the contact;
//! [`HardLimit`] is that of Luding 1998, Eqs. (24)-(25), whose normal does not (erratum L-E20).
//!
//! A law is a black box here: its history is advanced by the law itself, in steps, and what a step does to it may be an
//! integration (a spring), a projection (the Coulomb limit) or a memory (the largest overlap). So the method is
//! extrapolation: each step is repeated with 6, 8, 10, ... substeps of the simplest scheme, and the results are extrapolated
//! to substeps of length zero (Aitken-Neville; Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I,
//! Sec. II.9). Steps that hold a kink converge badly and are made shorter; one that holds a jump of a force ends up at a part in
//! 10⁹ of the contact and is not extrapolated. So are those in which sliding begins and ends, the force vanishes, the bodies
//! turn around and the contact ends, as long as there are few of them: a spring at its limit, or a force about zero, changes
//! its state by rounding alone. What rounding does to histories, magnified by extrapolation, does not count as an error.
//!
//! Every result says its own error: the difference to a second integration of lower order and looser tolerance.

mod collision;
mod contact;
mod hard_limit;
mod path;

pub use collision::{Body, Collision, Outcome};
pub use hard_limit::{HardLimit, HardLimitOutcome};
pub use path::{Event, EventKind};

/// Why a contact has no result.
#[derive(Clone, Debug, PartialEq)]
pub enum ReferenceError {
    /// The scene is not a single collision, or a number is not allowed; what is wrong, in words.
    Problem(String),
    /// The contact has not ended after this time \[s\].
    NoEnd(f64),
    /// A law gave a force that is not finite at this time \[s\].
    NotFinite(f64),
}

impl std::fmt::Display for ReferenceError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Problem(what) => f.write_str(what),
            Self::NoEnd(time) => write!(f, "the contact has not ended after {time:e} s"),
            Self::NotFinite(time) => write!(f, "a law gives a force that is not finite at {time:e} s"),
        }
    }
}

impl std::error::Error for ReferenceError {}

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn add(a: Vector, factor: f64, b: Vector) -> Vector {
    [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]]
}

fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// Three components of a slice.
fn three(values: &[f64]) -> Vector {
    [values[0], values[1], values[2]]
}
