//! Maps of oblique impacts.

use std::sync::Arc;

use super::{Class, Map, TangentialLaw, planned};
use crate::Error;
use crate::simulate::{Body, Run};

const FRICTION: [f64; 8] = [0.0, 0.05, 0.1, 0.2, 0.5, 1.0, 5.0, 1e6];
const ANGLES: [f64; 10] = [1.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 89.0];
/// Steps in a contact: the usual ones, and those of the reference.
const STEPS: (f64, f64) = (50.0, 800.0);
const RESTITUTION: f64 = 0.8;

fn scene(law: &TangentialLaw, scheme: &str, friction: f64, angle: f64, steps: f64) -> String {
    let (sine, cosine) = angle.to_radians().sin_cos();
    format!(
        r#"(version: 1, materials: {{ "a": () }}, impact_speed: {cosine:?}, bodies: [
        Sphere(material: "a", radius: 0.01, mass: 0.01, position: (-0.02, 0, 0), velocity: ({cosine:?}, {sine:?}, 0)),
        Sphere(material: "a", radius: 0.01, mass: 0.01, position: (0.000001, 0, 0))],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e5, restitution: {RESTITUTION}), {})],
        driver: TimeStep(integrator: {scheme}, step: Auto(steps_per_contact: {steps:?})), run: (steps: 1))"#,
        (law.fields)(friction)
    )
}

/// Bodies after the impact; `None` if a number was not finite.
fn after(text: &str) -> Result<Option<Vec<Body>>, Error> {
    let plan = planned(text, |plan| plan.driver.step)?;
    let contact = super::impact::duration(&plan)?;
    let longest = (2.5 * contact / plan.driver.step) as u64 + 2;
    let mut run = Run::of(Arc::new(plan))?;
    let mut touched = false;
    for at in 1..=longest {
        if run.advance(at).is_err() {
            return Ok(None);
        }
        touched |= run.contacts() > 0;
        if touched && run.contacts() == 0 {
            break;
        }
    }
    Ok(Some(run.bodies()))
}

/// Kinetic energy of both \[J\].
fn energy(bodies: &[Body]) -> f64 {
    let square = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>();
    bodies.iter().map(|body| 0.005 * (square(body.velocity) + 0.4e-4 * square(body.spin))).sum()
}

/// Friction and angle of incidence at the usual number of steps, held against a run with sixteen times as many.
pub(super) fn friction_and_angle(law: &TangentialLaw, scheme: &str, quick: bool) -> Result<Map, Error> {
    let friction = super::impact::rows(&FRICTION, quick);
    let mut cells = Vec::new();
    for mu in &friction {
        let mut row = Vec::new();
        for angle in ANGLES {
            let (found, fine) = (
                after(&scene(law, scheme, *mu, angle, STEPS.0))?,
                after(&scene(law, scheme, *mu, angle, STEPS.1))?,
            );
            let class = match (found, fine) {
                (Some(found), Some(fine)) => {
                    let off = found.iter().zip(&fine).flat_map(|(a, b)| {
                        (0..3).flat_map(move |k| {
                            [a.velocity[k] - b.velocity[k], 0.01 * (a.spin[k] - b.spin[k])].map(f64::abs)
                        })
                    });
                    // The speed before is 1 m/s.
                    if energy(&found) > 0.005 * 1.01 {
                        Class::EnergyGained
                    } else if off.fold(0.0, f64::max) > 0.05 {
                        Class::WrongRestitution
                    } else {
                        Class::Stable
                    }
                }
                _ => Class::NotFinite,
            };
            row.push(class);
        }
        cells.push(row);
    }
    Ok(Map {
        name: format!("oblique-{}-{scheme}", law.name),
        title: format!("{}, 50 steps a contact, {scheme}", law.name),
        x: ("angle of incidence [degrees]", ANGLES.to_vec()),
        y: ("friction coefficient", friction),
        cells,
        lines: Vec::new(),
    })
}
