//! The laws of a contact in a form that does not depend on how their parameters were given.

use granule_law_api::{ContactEnd, DurationRule, PairContext, Span, oscillator};
use granule_plan::{Composition, StagePlan};

use super::{Untranslatable, refuse};

/// Damping coefficient of a linear contact: γ \[kg/s\], γ/m12 \[1/s\], or both where only one reduced mass occurs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    pub coefficient: Option<f64>,
    pub rate: Option<f64>,
}

impl Linear {
    pub const ZERO: Self = Self { coefficient: Some(0.0), rate: Some(0.0) };

    fn coefficient(value: f64, mass: Span) -> Self {
        let rate = if value == 0.0 { Some(0.0) } else { mass.is_single().then(|| value / mass.max) };
        Self { coefficient: Some(value), rate }
    }

    fn rate(value: f64, mass: Span) -> Self {
        let coefficient = if value == 0.0 { Some(0.0) } else { mass.is_single().then_some(value * mass.max) };
        Self { coefficient, rate: Some(value) }
    }

    fn times(self, factor: f64) -> Self {
        let scale = |value: Option<f64>| value.map(|value| factor * value);
        Self { coefficient: scale(self.coefficient), rate: scale(self.rate) }
    }
}

/// Normal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Normal {
    /// k δ + γ v_n.
    Linear { stiffness: f64, damping: Linear },
    /// (K δ + m12 rate v_n) a with the contact radius a = sqrt(R* δ).
    HertzRate { pressure: f64, rate: f64 },
    /// K a δ + α sqrt(m12 K a) v_n.
    HertzRoot { pressure: f64, alpha: f64 },
    /// k_1 on loading, k_2 on unloading, which grows with the largest overlap up to `largest` at a plastic overlap of
    /// `depth` · 2 R*. The one reduced mass and radius that occur.
    Hysteretic { loading: f64, largest: f64, depth: f64, mass: f64, radius: f64 },
}

/// Tangential stiffness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stiffness {
    /// \[N/m\].
    Constant(f64),
    /// Times the contact radius \[Pa\].
    ContactRadius(f64),
}

/// Tangential damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Damping {
    /// The same at all overlaps.
    Linear(Linear),
    /// m12 times the contact radius \[1/(s m)\].
    ContactRadius(f64),
    /// Times sqrt(k_t m12).
    Root(f64),
    /// Times the normal damping coefficient.
    OfNormal(f64),
}

/// Tangential force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tangential {
    None,
    Viscous { damping: Damping, friction: f64 },
    Spring { stiffness: Stiffness, damping: Damping, friction: f64 },
}

/// All of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    pub normal: Normal,
    pub tangential: Tangential,
    /// The normal force never attracts.
    pub limited: bool,
}

/// Reads the laws of a composition.
pub fn contact(composition: &Composition) -> Result<Contact, Untranslatable> {
    let context = &composition.context;
    let mut contact = None;
    let mut tangential = Tangential::None;
    for stage in &composition.stages {
        match stage.law.info.name {
            "LinearSpringDashpot" => contact = Some(linear(stage, context)?),
            "Hertz" => contact = Some(hertz(stage, context)?),
            "WaltonBraun" => contact = Some(hysteretic(stage, context)?),
            "TangentialSpring" => {
                let Some(normal) = contact else { return refuse("TangentialSpring", "it has no normal law") };
                tangential = spring(stage, context, normal)?;
            }
            "ViscousTangential" => {
                let Some(normal) = contact else {
                    return refuse("ViscousTangential", "it has no normal law");
                };
                tangential = viscous(stage, context, normal)?;
            }
            other => {
                let slot = stage.slot.name();
                return refuse(other, format!("no engine has this {slot} law"));
            }
        }
    }
    let Some(normal) = contact else { return refuse("contact", "it has no normal law") };
    Ok(Contact { normal, tangential, limited: composition.contact_end == ContactEnd::Force })
}

/// A parameter of the form in which a stage was given.
fn get(stage: &StagePlan, name: &str) -> Option<f64> {
    stage.params.values().iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

fn unknown_form<T>(stage: &StagePlan) -> Result<T, Untranslatable> {
    let names: Vec<&str> = stage.params.values().iter().map(|(name, _)| *name).collect();
    refuse(stage.law.info.name, format!("given by {}", names.join(", ")))
}

/// The one reduced mass that occurs.
fn one_mass(stage: &StagePlan, context: &PairContext) -> Result<f64, Untranslatable> {
    let mass = context.reduced_mass;
    if mass.is_single() {
        return Ok(mass.max);
    }
    refuse(
        stage.law.info.name,
        format!(
            "restitution or duration is the same for reduced masses from {:e} to {:e} kg, which needs stiffness or damping \
             per pair",
            mass.min, mass.max
        ),
    )
}

fn linear(stage: &StagePlan, context: &PairContext) -> Result<Normal, Untranslatable> {
    let (mass, end) = (context.reduced_mass, context.contact_end);
    let value = |name| get(stage, name);
    match (value("stiffness"), value("damping"), value("damping_rate"), value("restitution")) {
        (Some(stiffness), Some(damping), ..) => {
            Ok(Normal::Linear { stiffness, damping: Linear::coefficient(damping, mass) })
        }
        (Some(stiffness), _, Some(rate), _) => {
            Ok(Normal::Linear { stiffness, damping: Linear::rate(rate, mass) })
        }
        (Some(stiffness), _, _, Some(restitution)) => {
            let ratio = oscillator::damping_ratio(restitution, end);
            if ratio == 0.0 {
                return Ok(Normal::Linear { stiffness, damping: Linear::ZERO });
            }
            let damping = 2.0 * ratio * (stiffness * one_mass(stage, context)?).sqrt();
            Ok(Normal::Linear { stiffness, damping: Linear::coefficient(damping, mass) })
        }
        (None, _, _, Some(restitution)) => {
            let Some(duration) = value("contact_duration") else { return unknown_form(stage) };
            let ratio = oscillator::damping_ratio(restitution, end);
            let omega = oscillator::duration(ratio, end) / duration;
            let stiffness = omega * omega * one_mass(stage, context)?;
            Ok(Normal::Linear { stiffness, damping: Linear::rate(2.0 * ratio * omega, mass) })
        }
        _ => unknown_form(stage),
    }
}

fn hertz(stage: &StagePlan, context: &PairContext) -> Result<Normal, Untranslatable> {
    let value = |name| get(stage, name);
    if let (Some(pressure), Some(rate)) = (value("stiffness_pressure"), value("damping_rate_per_length")) {
        return Ok(Normal::HertzRate { pressure, rate });
    }
    let modulus = match (value("effective_modulus"), value("youngs_modulus"), value("poisson_ratio")) {
        (Some(modulus), ..) => modulus,
        (_, Some(youngs), Some(poisson)) => youngs / (2.0 * (1.0 - poisson * poisson)),
        _ => return unknown_form(stage),
    };
    let alpha = match (value("damping_coefficient"), value("restitution")) {
        (Some(alpha), _) => alpha,
        (_, Some(restitution)) => {
            5.0_f64.sqrt() * oscillator::damping_ratio(restitution, context.contact_end)
        }
        _ => return unknown_form(stage),
    };
    Ok(Normal::HertzRoot { pressure: 4.0 / 3.0 * modulus, alpha })
}

fn hysteretic(stage: &StagePlan, context: &PairContext) -> Result<Normal, Untranslatable> {
    let value = |name| get(stage, name);
    match (value("loading_stiffness"), value("largest_unloading_stiffness"), value("plasticity_depth")) {
        (Some(loading), Some(largest), Some(depth)) => {
            let (mass, radius) = (one_mass(stage, context)?, context.reduced_radius);
            if !radius.is_single() {
                return refuse(
                    "WaltonBraun",
                    "the stiffness of `hooke/hysteresis` belongs to one reduced radius",
                );
            }
            Ok(Normal::Hysteretic { loading, largest, depth, mass, radius: radius.max })
        }
        _ => refuse(
            "WaltonBraun",
            "the unloading stiffness of `hooke/hysteresis` grows with the largest overlap; here it is constant",
        ),
    }
}

/// Damping of a tangential stage; none of the optional ones given is no damping.
fn damping(stage: &StagePlan, context: &PairContext) -> Damping {
    let value = |name| get(stage, name);
    let mass = context.reduced_mass;
    if let Some(ratio) = value("damping_ratio") {
        Damping::OfNormal(ratio)
    } else if let Some(damping) = value("damping") {
        Damping::Linear(Linear::coefficient(damping, mass))
    } else if let Some(rate) = value("damping_rate") {
        Damping::Linear(Linear::rate(rate, mass))
    } else if let Some(alpha) = value("damping_coefficient") {
        Damping::Root(alpha)
    } else if let Some(rate) = value("damping_rate_per_length") {
        Damping::ContactRadius(rate)
    } else {
        Damping::Linear(Linear::ZERO)
    }
}

fn friction(stage: &StagePlan) -> Result<f64, Untranslatable> {
    match get(stage, "friction") {
        Some(friction) if friction.is_finite() => Ok(friction),
        _ => refuse(stage.law.info.name, "the engines need a finite friction coefficient"),
    }
}

fn viscous(stage: &StagePlan, context: &PairContext, normal: Normal) -> Result<Tangential, Untranslatable> {
    let Some(restitution) = get(stage, "tangential_restitution") else {
        return Ok(Tangential::Viscous { damping: damping(stage, context), friction: friction(stage)? });
    };
    // exp(-γ_t t_c/m_t) = -e_t0 with m_t = m12 q/(1 + q) (Luding 1998, Eqs. (49)-(50)).
    let q = context.inertia_factor.max;
    let decay = -(-restitution).ln() * q / (1.0 + q);
    let duration = match (context.normal.map(|normal| normal.duration), normal) {
        (Some(DurationRule::Constant(duration)), _) => duration,
        (Some(DurationRule::Oscillator(factor)), Normal::Linear { stiffness, .. }) => {
            factor * (one_mass(stage, context)? / stiffness).sqrt()
        }
        _ => return unknown_form(stage),
    };
    let damping = Damping::Linear(Linear::rate(decay / duration, context.reduced_mass));
    Ok(Tangential::Viscous { damping, friction: friction(stage)? })
}

fn spring(stage: &StagePlan, context: &PairContext, normal: Normal) -> Result<Tangential, Untranslatable> {
    let value = |name| get(stage, name);
    let of_normal = |ratio: f64| match normal {
        Normal::Linear { stiffness, .. } => Stiffness::Constant(ratio * stiffness),
        Normal::HertzRate { pressure, .. } | Normal::HertzRoot { pressure, .. } => {
            Stiffness::ContactRadius(ratio * pressure)
        }
        // What later stages see of it.
        Normal::Hysteretic { loading, .. } => Stiffness::Constant(ratio * loading),
    };
    let stiffness = if let Some(stiffness) = value("stiffness") {
        Stiffness::Constant(stiffness)
    } else if let Some(pressure) = value("stiffness_pressure") {
        Stiffness::ContactRadius(pressure)
    } else if let Some(modulus) = value("effective_shear_modulus") {
        Stiffness::ContactRadius(8.0 * modulus)
    } else if let Some(ratio) = value("stiffness_ratio") {
        of_normal(ratio)
    } else if let Some(restitution) = value("tangential_restitution") {
        // ω_t t_c = arccos(-e_t0) with the mass that the slip feels, m12 q/(1 + q) (Luding 1998, Eqs. (55)-(57)).
        let q = context.inertia_factor.max;
        let phase = (-restitution).acos();
        let felt = q / (1.0 + q);
        match context.normal.map(|normal| normal.duration) {
            Some(DurationRule::Constant(duration)) => {
                let omega = phase / duration;
                Stiffness::Constant(felt * omega * omega * one_mass(stage, context)?)
            }
            Some(DurationRule::Oscillator(factor)) => of_normal(felt * (phase / factor) * (phase / factor)),
            Some(DurationRule::Unknown) | None => return unknown_form(stage),
        }
    } else {
        return unknown_form(stage);
    };
    Ok(Tangential::Spring { stiffness, damping: damping(stage, context), friction: friction(stage)? })
}

/// A tangential damper in proportion to a normal one is spelt out.
pub fn resolve(damping: Damping, normal: Normal, stiffness: Option<Stiffness>) -> Option<Damping> {
    let Damping::OfNormal(ratio) = damping else { return Some(damping) };
    if ratio == 0.0 {
        return Some(Damping::Linear(Linear::ZERO));
    }
    match (normal, stiffness) {
        (Normal::Linear { damping, .. }, _) => Some(Damping::Linear(damping.times(ratio))),
        (Normal::HertzRate { rate, .. }, _) => Some(Damping::ContactRadius(ratio * rate)),
        (Normal::HertzRoot { pressure, alpha }, Some(Stiffness::ContactRadius(tangential))) => {
            Some(Damping::Root(ratio * alpha * (pressure / tangential).sqrt()))
        }
        (Normal::HertzRoot { .. }, _) => None,
        (Normal::Hysteretic { .. }, _) => Some(Damping::Linear(Linear::ZERO)),
    }
}
