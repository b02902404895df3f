//! Stiffness and damping of one contact at its present overlap, per law.

use std::f64::consts::PI;

use crate::peers::{
    ClassicStyle, GranularDamping, GranularLaw, GranularNormal, GranularTangential, LiggghtsLaw,
    LiggghtsNormal, LiggghtsTangential, PeerError, PeerLaw, PeerMaterial,
};

/// What coefficients depend on.
#[derive(Clone, Copy)]
pub struct Pairing {
    /// Overlap (m).
    pub overlap: f64,
    /// Reduced radius; the radius at a wall (m).
    pub radius: f64,
    /// Reduced mass; the mass at a wall or frozen body (kg).
    pub mass: f64,
    /// Materials of both types, where given.
    pub materials: [Option<PeerMaterial>; 2],
}

/// Linear coefficients at this overlap.
pub struct Coefficients {
    /// Elastic normal force over overlap (N/m).
    pub kn: f64,
    /// Normal damping (kg/s).
    pub gn: f64,
    /// Tangential stiffness (N/m).
    pub kt: f64,
    /// Tangential damping (kg/s).
    pub gt: f64,
    /// Friction coefficient.
    pub friction: f64,
    /// Whether there is a tangential spring.
    pub history: bool,
}

/// Coefficients of a law. `memory` is the largest overlap that a hysteretic contact remembers.
pub fn coefficients(law: &PeerLaw, pairing: &Pairing, memory: &mut f64) -> Result<Coefficients, PeerError> {
    match law {
        PeerLaw::Classic(law) => {
            let history = law.style != ClassicStyle::HookeNoHistory;
            let scale = match law.style {
                ClassicStyle::HertzHistory => (pairing.overlap * pairing.radius).sqrt(),
                ClassicStyle::HookeHistory | ClassicStyle::HookeNoHistory => 1.0,
            };
            let gamma_t = if law.tangential_damping { law.gamma_t } else { 0.0 };
            Ok(Coefficients {
                kn: scale * law.kn,
                gn: scale * pairing.mass * law.gamma_n,
                kt: scale * law.kt,
                gt: scale * pairing.mass * gamma_t,
                friction: law.friction,
                history,
            })
        }
        PeerLaw::Granular(law) => Ok(granular(law, pairing)),
        PeerLaw::Liggghts(law) => liggghts(law, pairing, memory),
    }
}

fn granular(law: &GranularLaw, pairing: &Pairing) -> Coefficients {
    let contact_radius = (pairing.overlap * pairing.radius).sqrt();
    let kn = match law.normal {
        GranularNormal::Hooke(k) => k,
        GranularNormal::Hertz(k) => k * contact_radius,
    };
    let (meff, a) = (pairing.mass, contact_radius);
    let gn = match law.damping {
        GranularDamping::Velocity(gamma) => gamma,
        GranularDamping::MassVelocity(gamma) => gamma * meff,
        GranularDamping::Viscoelastic(gamma) => gamma * a * meff,
        GranularDamping::Tsuji(e) => {
            let alpha = 1.2728 - 4.2783 * e + 11.087 * e.powi(2) - 22.348 * e.powi(3) + 27.467 * e.powi(4)
                - 18.022 * e.powi(5)
                + 4.8218 * e.powi(6);
            alpha * (meff * kn).sqrt()
        }
    };
    let (kt, history) = match law.tangential {
        GranularTangential::LinearNoHistory => (0.0, false),
        GranularTangential::LinearHistory(k) => (k, true),
        GranularTangential::Mindlin(k) => (k * a, true),
    };
    Coefficients { kn, gn, kt, gt: law.tangential_damping * gn, friction: law.friction, history }
}

fn liggghts(law: &LiggghtsLaw, pairing: &Pairing, memory: &mut f64) -> Result<Coefficients, PeerError> {
    let (meff, overlap) = (pairing.mass, pairing.overlap);
    let materials = || match pairing.materials {
        [Some(a), Some(b)] => Ok((a, b)),
        _ => Err(PeerError::Scene("this model of LIGGGHTS needs a material for every type".into())),
    };
    let (kn, gn, kt, gt) = match law.normal {
        LiggghtsNormal::HookeStiffness { kn, kt, gamma_n, gamma_t } => {
            (kn, meff * gamma_n, kt, meff * gamma_t)
        }
        LiggghtsNormal::HertzStiffness { kn, kt, gamma_n, gamma_t } => {
            let a = (pairing.radius * overlap).sqrt();
            (a * kn, a * meff * gamma_n, a * kt, a * meff * gamma_t)
        }
        LiggghtsNormal::HookeHysteresis { ratio, depth } => {
            let (a, b) = materials()?;
            let root = pairing.radius.sqrt();
            let youngs = effective_youngs(a, b);
            let k1 = 16.0 / 15.0 * root * youngs * (15.0 * meff / (16.0 * root * youngs)).powf(0.2);
            let force = hysteretic(k1, ratio * k1, depth * 2.0 * pairing.radius, overlap, memory);
            (force / overlap, 0.0, k1, 0.0)
        }
        LiggghtsNormal::Hertz { restitution } => {
            let (a, b) = materials()?;
            let contact_radius = (pairing.radius * overlap).sqrt();
            let sn = 2.0 * effective_youngs(a, b) * contact_radius;
            let st = 8.0 * effective_shear(a, b) * contact_radius;
            let log = restitution.ln();
            let beta = log / (log * log + PI * PI).sqrt();
            let c = -2.0 * (5.0_f64 / 6.0).sqrt() * beta;
            (2.0 / 3.0 * sn, c * (sn * meff).sqrt(), st, c * (st * meff).sqrt())
        }
    };
    Ok(Coefficients {
        kn,
        gn,
        kt,
        gt: if law.tangential_damping { gt } else { 0.0 },
        friction: law.friction,
        history: law.tangential == LiggghtsTangential::History,
    })
}

/// Force without adhesion; k2 grows with the largest overlap.
fn hysteretic(k1: f64, k2_max: f64, depth: f64, overlap: f64, memory: &mut f64) -> f64 {
    *memory = memory.max(overlap);
    let limit = k2_max / (k2_max - k1) * depth;
    let (peak, k2) =
        if *memory >= limit { (limit, k2_max) } else { (*memory, k1 + (k2_max - k1) * *memory / limit) };
    let line = k2 * (overlap - peak) + k1 * peak;
    if line < 0.0 {
        *memory = 0.5 * (overlap + (overlap * overlap + 4.0 * k1 * overlap * limit / (k2_max - k1)).sqrt());
    }
    line.max(0.0)
}

fn effective_youngs(a: PeerMaterial, b: PeerMaterial) -> f64 {
    let compliance = |m: PeerMaterial| (1.0 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus;
    1.0 / (compliance(a) + compliance(b))
}

fn effective_shear(a: PeerMaterial, b: PeerMaterial) -> f64 {
    let compliance =
        |m: PeerMaterial| 2.0 * (2.0 - m.poisson_ratio) * (1.0 + m.poisson_ratio) / m.youngs_modulus;
    1.0 / (compliance(a) + compliance(b))
}
