//! One impact, run by the engine.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use granule_drivers::{Driver, TimeStepDriver};
use granule_law_api::{Impact, PairContext, Span};
use granule_plan::{Plan, SingleImpact};

/// Velocities, and spins times radius, of both bodies \[m/s\].
pub(crate) type Motion = [f64; 12];

/// The motion of both bodies after `steps` steps.
pub(crate) fn run(plan: &Plan, impact: &SingleImpact, steps: u64) -> Result<Motion, String> {
    let (mut driver, rotation) = start(plan, impact, steps)?;
    advance(&mut driver, steps)?;
    Ok(motion(&driver, 2.0 * impact.impact.reduced_radius, rotation))
}

fn start(plan: &Plan, impact: &SingleImpact, steps: u64) -> Result<(TimeStepDriver, bool), String> {
    let single = Arc::new(impact.plan(plan, steps));
    let rotation = single.rotation;
    TimeStepDriver::new(single, Some(1)).map(|driver| (driver, rotation)).map_err(|error| error.to_string())
}

fn advance(driver: &mut TimeStepDriver, steps: u64) -> Result<(), String> {
    driver.advance(steps, &AtomicBool::new(false)).map(|_| ()).map_err(|error| error.to_string())
}

fn motion(driver: &TimeStepDriver, radius: f64, rotation: bool) -> Motion {
    let view = driver.view();
    let mut motion = [0.0; 12];
    for (at, place) in view.order().iter().enumerate() {
        let velocity = view.bodies().velocity_of(*place as usize);
        let spin = if rotation { view.bodies().spin_of(*place as usize) } else { [0.0; 3] };
        for axis in 0..3 {
            motion[6 * at + axis] = velocity[axis];
            motion[6 * at + 3 + axis] = radius * spin[axis];
        }
    }
    motion
}

/// Lightest and heaviest pair of a composition.
pub(crate) fn sizes(context: &PairContext) -> Vec<(f64, f64)> {
    let (mass, radius) = (context.reduced_mass, context.reduced_radius);
    if mass.is_single() && radius.is_single() {
        vec![(mass.max, radius.max)]
    } else {
        vec![(mass.min, radius.min), (mass.max, radius.max)]
    }
}

pub(crate) fn ends(span: Span) -> Vec<f64> {
    if span.is_single() { vec![span.max] } else { vec![span.min, span.max] }
}

/// Restitutions of an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Restitutions {
    /// e_n.
    pub normal: f64,
    /// e_t0, of a slip so small that the contact sticks; -1 where nothing acts along the surface.
    pub tangential: f64,
}

/// Slip of the impact that measures the tangential restitution, over the normal speed.
const SLIP: f64 = 1e-4;
/// Steps after which a contact that has not ended counts as endless.
const ENDLESS: u64 = 1 << 20;

/// Restitutions of the pair of a composition with this reduced mass, reduced radius and inertia factor, at the impact speed
/// of the plan, with a step \[s\].
pub(crate) fn restitutions(
    plan: &Plan,
    composition: usize,
    (reduced_mass, reduced_radius): (f64, f64),
    inertia_factor: f64,
    step: f64,
) -> Result<Restitutions, String> {
    let normal_speed = plan.compositions[composition].context.impact_speed;
    let impact = SingleImpact {
        composition,
        impact: Impact { reduced_mass, reduced_radius, normal_speed },
        inertia_factor,
        tangential: if plan.rotation { SLIP } else { 0.0 },
        gap: 0.5 * step * normal_speed,
        step,
    };
    let (mut driver, rotation) = start(plan, &impact, ENDLESS)?;
    let radius = 2.0 * reduced_radius;
    let mut steps = 64;
    loop {
        advance(&mut driver, steps)?;
        let now = motion(&driver, radius, rotation);
        let receding = now[6] - now[0];
        let position = driver.view().position(1)[0] - driver.view().position(0)[0];
        let apart = position > 2.0 * radius + plan.compositions[composition].reach;
        if receding >= 0.0 && apart {
            // Slip of body 1 against body 2, whose surfaces meet at +R and -R on x.
            let slip = now[1] - now[7] + now[5] + now[11];
            let tangential = if plan.rotation { -slip / (SLIP * normal_speed) } else { -1.0 };
            return Ok(Restitutions { normal: receding / normal_speed, tangential });
        }
        if steps >= ENDLESS {
            return Err("a contact does not end".into());
        }
        steps *= 2;
    }
}
