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
    let omega = PI / impact.duration;
    let at = |time: f64| {
        let overlap = impact.impact.normal_speed / omega * (omega * time).sin();
        model.at(&Contact {
            overlap: overlap.max(0.0),
            reduced_mass: impact.impact.reduced_mass,
            reduced_radius: impact.impact.reduced_radius,
            normal_stiffness: impact.normal_stiffness,
            normal_damping: 0.0,
        })
    };
    if model.friction < f64::INFINITY {
        return stick_slip(impact, model.friction, !constant, at);
    }
    if constant {
        let (stiffness, damping) = at(0.0);
        let remaining = damped_cosine(impact.tangential_mass, damping, stiffness, impact.duration);
        return Some(impact.tangential_speed * remaining);
    }
    let start = [0.0, impact.tangential_speed];
    let end = reference::integrate(start, impact.duration, |time, [x, v]| {
        let (stiffness, damping) = at(time);
        [v, -(stiffness * x + damping * v) / impact.tangential_mass]
    });
    Some(end[1])
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

/// Phases of sticking (the spring follows the slip) and sliding (the spring stays at the limit), each integrated up to the
/// moment at which it ends. The force of spring and damper together is held to the limit throughout. `None` if the phases do
/// not come to an end.
fn stick_slip(
    impact: &ObliqueImpact,
    friction: f64,
    stiffens: bool,
    at: impl Fn(f64) -> (f64, f64),
) -> Option<f64> {
    let omega = PI / impact.duration;
    let peak = friction * impact.normal_stiffness * impact.impact.normal_speed / omega;
    let limit = |time: f64| (peak * (omega * time).sin()).max(0.0);
    let limit_growth = |time: f64| peak * omega * (omega * time).cos();
    let deceleration = |time: f64, spring_force: f64, damping: f64, velocity: f64| {
        let limit = limit(time);
        (spring_force + damping * velocity).min(limit).max(-limit) / impact.tangential_mass
    };
    // Growth of the spring force at the limit if it did not slide; k_t goes with sqrt(sin(ωt)) or is constant.
    let spring_growth = |time: f64, velocity: f64, side: f64| {
        let stiffening =
            if stiffens && time > 0.0 { 0.5 * omega / (omega * time).tan() * limit(time) } else { 0.0 };
        side * at(time).0 * velocity + stiffening
    };
    let (mut time, mut spring, mut velocity) = (0.0, 0.0, impact.tangential_speed);
    let mut sliding = spring_growth(0.0, velocity, 1.0) > limit_growth(0.0);
    let mut side = 1.0;
    for _ in 0..1000 {
        if time >= impact.duration {
            return Some(velocity);
        }
        let happened;
        if sliding {
            let (end, [v], released) = reference::integrate_until(
                time,
                [velocity],
                impact.duration,
                |time, [v]| [-deceleration(time, side * limit(time), at(time).1, v)],
                |time, [v]| spring_growth(time, v, side) < limit_growth(time),
            );
            let stiffness = at(end).0;
            spring = if stiffness > 0.0 { side * limit(end) / stiffness } else { 0.0 };
            (time, velocity, happened) = (end, v, released);
        } else {
            let (end, [x, v], reached) = reference::integrate_until(
                time,
                [spring, velocity],
                impact.duration,
                |time, [x, v]| {
                    let (stiffness, damping) = at(time);
                    [v, -deceleration(time, stiffness * x, damping, v)]
                },
                // A spring that has just been released is at the limit to round-off.
                |time, [x, _]| (at(time).0 * x).abs() > limit(time) * (1.0 + 1e-11),
            );
            (time, spring, velocity, happened) = (end, x, v, reached);
            side = spring.signum();
        }
        sliding = happened && !sliding;
    }
    None
}
