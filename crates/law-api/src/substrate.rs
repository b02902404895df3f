//! Laws between bodies and the surface that they roll and slide on.
//!
//! A contact law answers from the motion of two bodies alone. A surface under a rolling body cannot: the friction that
//! keeps it from slipping is whatever the *sum* of all other forces demands, up to a limit (Kondic 1999, Eqs. (22)-(25)).
//! So a [`SubstrateLaw`] is asked last, once a body and step, with the motion that the body would have at the end of the
//! step if the surface only carried it; it answers with impulses.

use crate::params::Choice;
use crate::{API_VERSION, Form, LawError, ParamSpec, Params, Source};

/// What a body does on its surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Footing {
    /// Nothing is known yet: the law decides from the slip.
    #[default]
    Unknown,
    /// It does not touch the surface.
    Airborne,
    /// It slips.
    Sliding,
    /// It rolls without slip.
    Rolling,
    /// It is at rest relative to the surface.
    Resting,
}

/// One body on the surface over one time step. Vectors are in the plane of the surface.
///
/// With v the velocity of the centre, v_S that of the surface below it, k the normal and Ω the spin, the spin makes the
/// surface of the body move with s = R k × Ω at the contact point, which slips with u = v + s - v_S (Kondic 1999,
/// Eq. (26)). Free motions are those at the end of the step without the answer of the law.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SubstrateContact {
    /// Mass m \[kg\].
    pub mass: f64,
    /// Radius R \[m\].
    pub radius: f64,
    /// Inertia number Q = m R²/I: 5/2 for a homogeneous sphere. The inertia factor of scenes is 1/Q.
    pub inertia_number: f64,
    /// Impulse of the normal force over the step \[N s\], at least 0.
    pub normal_impulse: f64,
    /// Slip u at the beginning of the step \[m/s\].
    pub slip_before: [f64; 2],
    /// Free slip \[m/s\].
    pub slip: [f64; 2],
    /// Rolling velocity v - v_S at the beginning of the step \[m/s\].
    pub rolling_before: [f64; 2],
    /// Free rolling velocity \[m/s\].
    pub rolling: [f64; 2],
    /// Free spin about the normal \[rad/s\].
    pub drilling: f64,
    /// What the body did at the beginning of the step; the law says what it does at the end.
    pub footing: Footing,
    /// Answer: tangential impulse J at the contact point \[N s\]. It changes v by J/m and s by Q J/m.
    pub impulse: [f64; 2],
    /// Answer: resistance to rolling P = (k × T)/R \[N s\] of a torque impulse T about a direction in the plane. It changes
    /// s by Q P/m.
    pub couple: [f64; 2],
    /// Answer: torque impulse about the normal \[N m s\].
    pub drilling_impulse: f64,
}

/// What a law is told about the material that it is compiled for.
#[derive(Clone, Copy, Debug, Default)]
pub struct SubstrateContext<'a> {
    /// Coefficient of rolling friction by rolling speed, (|v - v_S| \[m/s\], μ_r) with increasing speeds; empty if it is
    /// given as a parameter.
    pub rolling_friction: &'a [(f64, f64)],
}

/// Coefficients of a law for which arcs between collisions are known in closed form: it rolls without slip while the
/// friction that this takes is at most `static_friction` times the normal force, else slips under `kinetic_friction`.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceFriction {
    /// μ_s, maybe infinite.
    pub static_friction: f64,
    /// μ_k, at most μ_s.
    pub kinetic_friction: f64,
    /// μ_r by rolling speed \[m/s\], with increasing speeds and at least one row; constant outside.
    pub rolling: Vec<(f64, f64)>,
    /// μ_d: torque about the normal per normal force and radius.
    pub drilling: f64,
}

impl SurfaceFriction {
    /// μ_r at a rolling speed \[m/s\]: straight lines between the rows, constant outside.
    pub fn rolling_at(&self, speed: f64) -> f64 {
        let above = self.rolling.partition_point(|row| row.0 <= speed);
        match (above.checked_sub(1).map(|below| self.rolling[below]), self.rolling.get(above)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (speed - a.0) / (b.0 - a.0),
            (Some(a), None) => a.1,
            (None, Some(b)) => b.1,
            (None, None) => 0.0,
        }
    }
}

/// A compiled law. Entry `k` of the answer depends on entry `k` alone.
pub trait SubstrateStage: Send + Sync {
    /// Fills in answers and footings.
    fn run(&self, contacts: &mut [SubstrateContact]);

    /// The coefficients, if the law is that of [`SurfaceFriction`]; the event-driven driver needs them.
    fn friction(&self) -> Option<&SurfaceFriction> {
        None
    }
}

/// Everything that is known about a substrate law without running it.
#[derive(Clone, Copy, Debug)]
pub struct SubstrateInfo {
    /// Name in scenes: a CamelCase identifier, unique among substrate laws.
    pub name: &'static str,
    /// One line on what it models.
    pub summary: &'static str,
    /// The formula in plain text, with the symbols of the parameters.
    pub formula: &'static str,
    /// Where it comes from.
    pub sources: &'static [Source],
    /// Every parameter of every form.
    pub parameters: &'static [&'static ParamSpec],
    /// The sets of parameters by which a user may choose it.
    pub forms: &'static [Form],
    /// Parameter sets that are typical in use.
    pub examples: &'static [&'static [(&'static str, f64)]],
}

impl SubstrateInfo {
    /// Checks names, ranges and completeness of parameters in SI units. All problems are returned at once.
    ///
    /// # Errors
    /// See [`Params::new`].
    pub fn params(&self, given: &[(&str, f64)]) -> Result<Params, Vec<LawError>> {
        Params::of(&Choice { law: self.name, parameters: self.parameters, forms: self.forms }, given)
    }
}

/// A law of a surface. Implement it for a unit type and call
/// [`register_substrate_law!`](crate::register_substrate_law).
pub trait SubstrateLaw: 'static {
    /// What the law says about itself.
    const INFO: SubstrateInfo;

    /// Folds parameters and context into a stage.
    ///
    /// # Errors
    /// The combination cannot be had; the message says what can.
    fn compile(params: &Params, context: &SubstrateContext<'_>) -> Result<Box<dyn SubstrateStage>, LawError>;
}

type Compile = fn(&Params, &SubstrateContext<'_>) -> Result<Box<dyn SubstrateStage>, LawError>;

/// One registered substrate law.
pub struct SubstrateEntry {
    /// What the law says about itself.
    pub info: &'static SubstrateInfo,
    /// Crate that registered it.
    pub crate_name: &'static str,
    /// Version of that crate.
    pub crate_version: &'static str,
    /// [`API_VERSION`] that it was built against.
    pub api_version: u32,
    /// [`SubstrateLaw::compile`].
    pub compile: Compile,
}

impl SubstrateEntry {
    /// The entry of a law.
    pub const fn of<L: SubstrateLaw>(crate_name: &'static str, crate_version: &'static str) -> Self {
        Self { info: &L::INFO, crate_name, crate_version, api_version: API_VERSION, compile: L::compile }
    }
}

impl std::fmt::Debug for SubstrateEntry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({} {})", self.info.name, self.crate_name, self.crate_version)
    }
}

inventory::collect!(SubstrateEntry);

/// Registers a substrate law: `register_substrate_law!(MyLaw);` at the top level of its module.
#[macro_export]
macro_rules! register_substrate_law {
    ($law:ty) => {
        $crate::reexport::inventory::submit! {
            $crate::SubstrateEntry::of::<$law>(env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"))
        }
    };
}
