//! What an impact does, in closed form or by an independent integration.

use std::f64::consts::PI;

use granule_law_api::testing::reference;
use granule_law_api::{Impact, ObliqueImpact, PairContext, TimeScale};

use crate::forms::{Damping, Model, Stiffness};
use crate::law::Contact;

/// Half a period of the tangential oscillation at the largest stiffness expected. `None` if that hangs on a normal law which
/// does not say its own.
pub(crate) fn time_scale(model: &Model, pair: &PairContext, impact: &Impact) -> Option<TimeScale> {
    let normal = pair.normal.and_then(|normal| normal.scale);
    let by_normal = matches!(model.stiffness, Stiffness::Normal(_) | Stiffness::ContactRadius(_))
        || matches!(model.damping, Damping::Normal(_) | Damping::MassContactRadius(_));
    if by_normal && normal.is_none() {
        return None;
    }
    let contact = Contact {
        overlap: normal.map_or(0.0, |scale| scale.overlap),
        reduced_mass: impact.reduced_mass,
        reduced_radius: impact.reduced_radius,
        normal_stiffness: normal.map_or(0.0, |scale| scale.stiffness),
        normal_damping: normal.map_or(0.0, |scale| scale.damping),
    };
    let (stiffness, damping) = model.at(&contact);
    if stiffness == 0.0 {
        return None;
    }
    // m12/m_t for bodies of one inertia factor; the smallest one is the most mobile.
    let mobility = 1.0 + 1.0 / pair.inertia_factor.min;
    Some(TimeScale {
        duration: PI * (impact.reduced_mass / (stiffness * mobility)).sqrt(),
        stiffness: stiffness * mobility,
        damping: damping * mobility,
        overlap: 0.0,
    })
}

/// Tangential velocity after an oblique impact under an elastic linear normal force.
pub(crate) fn after(model: &Model, impact: &ObliqueImpact) -> Option<f64> {
    let constant = !matches!(model.stiffness, Stiffness::ContactRadius(_))
        && !matches!(model.damping, Damping::MassContactRadius(_));
    let at = |time: f64| {
        let omega = PI / impact.duration;
        let overlap = impact.impact.normal_speed / omega * (omega * time).sin();
        model.at(&Contact {
            overlap: overlap.max(0.0),
            reduced_mass: impact.impact.reduced_mass,
            reduced_radius: impact.impact.reduced_radius,
            normal_stiffness: impact.normal_stiffness,
            normal_damping: 0.0,
        })
    };
    if model.friction == f64::INFINITY {
        return Some(if constant {
            let (stiffness, damping) = at(0.0);
            impact.tangential_speed
                * damped_cosine(impact.tangential_mass, damping, stiffness, impact.duration)
        } else {
            sticking(impact, at)
        });
    }
    constant.then(|| sliding(model.friction, at(0.0), impact)).flatten()
}

/// v(t)/v(0) of m x'' + γ x' + k x = 0 with x(0) = 0.
fn damped_cosine(mass: f64, damping: f64, stiffness: f64, time: f64) -> f64 {
    let eta = 0.5 * damping / mass;
    let square = stiffness / mass - eta * eta;
    let omega = square.abs().sqrt();
    let decay = (-eta * time).exp();
    if omega * time < 1e-6 {
        // sin(ωt)/ω = t up to a relative (ωt)²/6.
        decay * (1.0 - eta * time)
    } else if square > 0.0 {
        decay * ((omega * time).cos() - eta / omega * (omega * time).sin())
    } else {
        decay * ((omega * time).cosh() - eta / omega * (omega * time).sinh())
    }
}

/// A contact that never slides, with a stiffness and damping that vary in time.
fn sticking(impact: &ObliqueImpact, at: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mass = impact.tangential_mass;
    let end = reference::integrate([0.0, impact.tangential_speed], impact.duration, |time, [x, v]| {
        let (stiffness, damping) = at(time);
        [v, -(stiffness * x + damping * v) / mass]
    });
    end[1]
}

/// A contact that slides from its beginning to its end: the tangential impulse is μ times the normal one (Luding 1998,
/// Eq. (18)). The spring stays at the limit as long as it would outgrow it; both conditions are linear in the cosine of
/// the phase, so that the two ends decide.
fn sliding(friction: f64, (stiffness, damping): (f64, f64), impact: &ObliqueImpact) -> Option<f64> {
    let mass = impact.impact.reduced_mass;
    let before = impact.tangential_speed;
    let after = before - 2.0 * friction * mass * impact.impact.normal_speed / impact.tangential_mass;
    let growth = friction * impact.normal_stiffness * impact.impact.normal_speed;
    let spring_held = stiffness * before >= growth && stiffness * after >= -growth;
    let damper_forward = damping == 0.0 || after >= 0.0;
    (spring_held && damper_forward).then_some(after)
}
