//! What a law is told about the pair of materials that it is compiled for.

use crate::{Columns, Conventions, TimeScale};

/// When a contact ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactEnd {
    /// When the normal force has fallen to zero: no attraction at the end of a damped contact (Luding 1998, Eq. (36)).
    Force,
    /// When the overlap has vanished; a damped contact attracts shortly before.
    Overlap,
}

/// Smallest and largest value that occurs in a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
}

impl Span {
    /// A span of one value.
    pub const fn of(value: f64) -> Self {
        Self { min: value, max: value }
    }

    /// True if all values are equal to round-off.
    pub fn is_single(&self) -> bool {
        (self.max - self.min).abs() <= 1e-12 * self.max.abs()
    }
}

/// How the time t_c for which the normal force of a head-on contact acts depends on the pair. Tangential laws that promise a
/// restitution need it: without a normal force nothing holds a tangential one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DurationRule {
    /// The same t_c \[s\] for every pair.
    Constant(f64),
    /// t_c = factor · sqrt(m12 / k_n), at any reduced mass.
    Oscillator(f64),
    /// No closed form at all masses and speeds of the scene.
    Unknown,
}

/// What the normal stage tells the later ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalSummary {
    /// How long the normal force of a contact acts under the chosen contact-end rule.
    pub duration: DurationRule,
    /// Time scale of an impact at the largest speed expected, where the law knows it.
    pub scale: Option<TimeScale>,
}

/// The pair of materials that a law is compiled for, and what the run expects of it.
#[derive(Clone, Copy, Debug)]
pub struct PairContext {
    /// When contacts end.
    pub contact_end: ContactEnd,
    /// Conventions of the run.
    pub conventions: Conventions,
    /// Columns that someone reads after this stage; optional outputs (stiffness, damping) are empty if not in here.
    pub wanted: Columns,
    /// Reduced masses m12 that occur \[kg\].
    pub reduced_mass: Span,
    /// Reduced radii R* that occur \[m\].
    pub reduced_radius: Span,
    /// Inertia factors q = I/(m R²) that occur.
    pub inertia_factor: Span,
    /// Largest impact speed expected \[m/s\].
    pub impact_speed: f64,
    /// What the normal stage says; `None` while the normal stage itself is compiled.
    pub normal: Option<NormalSummary>,
}

impl PairContext {
    /// A context for one mass, radius and speed: for tests, manuals and single contacts.
    pub fn single(reduced_mass: f64, reduced_radius: f64, inertia_factor: f64, impact_speed: f64) -> Self {
        Self {
            contact_end: ContactEnd::Force,
            conventions: Conventions::PHYSICAL,
            wanted: Columns::NONE,
            reduced_mass: Span::of(reduced_mass),
            reduced_radius: Span::of(reduced_radius),
            inertia_factor: Span::of(inertia_factor),
            impact_speed,
            normal: None,
        }
    }
}
