//! Maps of single impacts.

use std::sync::Arc;

use granule_law_api::oscillator;
use granule_law_api::{ContactEnd, Impact, Oracle, Slot};
use granule_plan::{Plan, limits, map_name};

use super::{Class, Map, NormalLaw, planned};
use crate::Error;
use crate::simulate::{Body, Run};

/// Damping ratios of the rows.
pub(super) const DAMPING: [f64; 9] = [0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0];
/// Steps per contact of the columns.
pub(super) const STEPS: [f64; 15] =
    [1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.3, 8.0, 12.5, 20.0, 32.0, 50.0, 100.0];
/// Parts of a step at which a contact begins: what the result depends on at few steps.
const PHASES: [f64; 4] = [0.05, 0.3, 0.55, 0.8];
/// Relative errors that make a class.
const WRONG: f64 = 0.05;
const GAINED: f64 = 0.01;

/// Two spheres of 10 mm and 10 g that meet head on.
#[derive(Clone, Copy)]
struct Pair {
    masses: [f64; 2],
    radii: [f64; 2],
    speed: f64,
}

const EQUAL: Pair = Pair { masses: [0.01; 2], radii: [0.01; 2], speed: 1.0 };

/// Restitution of a linear contact of this damping ratio, with which laws of the atlas are made.
pub(super) fn restitution(damping: f64) -> f64 {
    oscillator::restitution(damping, ContactEnd::Force)
}

impl Pair {
    fn scene(&self, block: &str, scheme: &str, gap: f64) -> String {
        let ([a, b], [r, s], v) = (self.masses, self.radii, self.speed);
        format!(
            r#"(version: 1, materials: {{ "a": (), "b": () }}, impact_speed: {v:?}, bodies: [
            Sphere(material: "a", radius: {r:?}, mass: {a:?}, position: ({:?}, 0, 0), velocity: ({v:?}, 0, 0)),
            Sphere(material: "b", radius: {s:?}, mass: {b:?}, position: ({s:?}, 0, 0))],
            contacts: [(between: ("a", "b"), {block})],
            driver: TimeStep(integrator: {scheme}), run: (steps: 1))"#,
            -(r + gap)
        )
    }

    /// Largest kinetic energy of the relative motion \[J\].
    fn relative_energy(&self, bodies: &[Body]) -> f64 {
        let [a, b] = self.masses;
        let apart: f64 = (0..3).map(|k| (bodies[0].velocity[k] - bodies[1].velocity[k]).powi(2)).sum();
        0.5 * apart / (1.0 / a + 1.0 / b)
    }
}

/// Restitution that the law promises at the impact of a plan.
fn promised(plan: &Plan) -> f64 {
    let composition = &plan.compositions[0];
    let context = &composition.context;
    let impact = Impact {
        reduced_mass: context.reduced_mass.min,
        reduced_radius: context.reduced_radius.min,
        normal_speed: context.impact_speed,
    };
    let normal = composition.stages.iter().find(|stage| stage.slot == Slot::Normal);
    match normal.map(|stage| (stage.law.oracle)(&stage.params, context)) {
        Some(Oracle::Normal(outcome)) => outcome(&impact).restitution,
        _ => f64::NAN,
    }
}

/// Duration of the contact of a plan \[s\].
pub(super) fn duration(plan: &Plan) -> Result<f64, Error> {
    limits(plan).shortest_contact.ok_or_else(|| "the law gives no duration of a contact".into())
}

/// Restitution of a run, or what went wrong in it.
fn outcome(
    pair: &Pair,
    block: &str,
    scheme: &str,
    steps: Option<f64>,
    phase: f64,
) -> Result<(Class, f64), Error> {
    let contact = duration(&planned(&pair.scene(block, scheme, 0.0), |plan| plan.driver.step)?)?;
    // Without a number of steps, the step that the plan chooses.
    let automatic = planned(&pair.scene(block, scheme, 0.0), |plan| plan.driver.step)?.driver.step;
    let step = steps.map_or(automatic, |steps| contact / steps);
    let plan = planned(&pair.scene(block, scheme, phase * step * pair.speed), |_| step)?;
    let expected = promised(&plan);
    let mut run = Run::of(Arc::new(plan))?;
    let before = pair.relative_energy(&run.bodies());
    // Overdamped contacts creep apart; they have lost their speed long before.
    let longest = 4 + (4.0 * contact / step) as u64;
    let mut touched = false;
    for at in 1..=longest {
        if run.advance(at).is_err() {
            return Ok((Class::NotFinite, f64::NAN));
        }
        touched |= run.contacts() > 0;
        if touched && run.contacts() == 0 {
            break;
        }
    }
    let bodies = run.bodies();
    let after = pair.relative_energy(&bodies);
    if !after.is_finite() || after > 1e12 * before {
        return Ok((Class::NotFinite, f64::NAN));
    }
    let parting = (bodies[1].velocity[0] - bodies[0].velocity[0]) / pair.speed;
    let class = if after > (1.0 + GAINED) * before {
        Class::EnergyGained
    } else if bodies[0].position[0] > bodies[1].position[0] || !touched {
        Class::Tunnelled
    } else if (parting - expected).abs() > WRONG {
        Class::WrongRestitution
    } else {
        Class::Stable
    };
    Ok((class, parting))
}

/// The worst class over the parts of a step at which the contact may begin.
fn worst(pair: &Pair, block: &str, scheme: &str, steps: Option<f64>) -> Result<Class, Error> {
    let mut worst = Class::Stable;
    for phase in PHASES {
        worst = worst.max(outcome(pair, block, scheme, steps, phase)?.0);
    }
    Ok(worst)
}

/// Rows of a map, every second one for a quick atlas.
pub(super) fn rows(values: &[f64], quick: bool) -> Vec<f64> {
    values.iter().copied().step_by(if quick { 2 } else { 1 }).collect()
}

/// Single contact: steps in it and damping ratio.
///
/// # Errors
/// A scene cannot be planned.
pub fn steps_and_damping(law: &NormalLaw, scheme: &str, quick: bool) -> Result<Map, Error> {
    let damping = rows(&DAMPING, quick);
    let (mut cells, mut limit) = (Vec::new(), Vec::new());
    for ratio in &damping {
        let block = (law.block)(1.0, restitution(*ratio));
        let row: Result<Vec<Class>, Error> =
            STEPS.iter().map(|steps| worst(&EQUAL, &block, scheme, Some(*steps))).collect();
        cells.push(row?);
        let plan = planned(&EQUAL.scene(&block, scheme, 0.0), |plan| plan.driver.step)?;
        limit.push(Some(duration(&plan)? / limits(&plan).pair));
    }
    Ok(Map {
        name: map_name(law.name, scheme, false),
        title: format!("{}, a single contact, {scheme}", law.name),
        x: ("steps per contact", STEPS.to_vec()),
        y: ("damping ratio", damping),
        cells,
        lines: vec![("limit of a pair", limit)],
    })
}

/// Fewest steps in a contact from which on the restitution is right to 5 % of the impact speed, at every damping ratio.
///
/// # Errors
/// A scene cannot be planned.
pub fn needed_steps(law: &NormalLaw) -> Result<f64, Error> {
    let mut needed: f64 = 1.0;
    for ratio in DAMPING {
        let block = (law.block)(1.0, restitution(ratio));
        for steps in (1..=60).rev().map(f64::from) {
            if steps <= needed {
                break;
            }
            if worst(&EQUAL, &block, super::SCHEMES[0], Some(steps))? != Class::Stable {
                needed = steps + 1.0;
                break;
            }
        }
    }
    Ok(needed)
}

/// Mass ratio and stiffness, at the step that the plan chooses: only what is softer than the bodies are large goes wrong.
///
/// # Errors
/// A scene cannot be planned.
pub fn mass_and_stiffness(law: &NormalLaw, quick: bool) -> Result<Map, Error> {
    let masses: Vec<f64> = (0..=6).map(|k| 10f64.powi(2 * k)).collect();
    let stiffness = rows(&[1e-4, 1e-3, 1e-2, 1e-1, 1.0, 1e2, 1e4, 1e6, 1e9], quick);
    let mut cells = Vec::new();
    for k in &stiffness {
        let block = (law.block)(*k, 0.7);
        let row: Result<Vec<Class>, Error> = masses
            .iter()
            .map(|ratio| {
                let pair = Pair { masses: [0.01, 0.01 * ratio], ..EQUAL };
                worst(&pair, &block, super::SCHEMES[0], None)
            })
            .collect();
        cells.push(row?);
    }
    Ok(Map {
        name: format!("mass-stiffness-{}", law.name),
        title: format!("{}, the step of the plan", law.name),
        x: ("mass ratio", masses),
        y: ("stiffness over the usual one", stiffness),
        cells,
        lines: Vec::new(),
    })
}

/// Size ratio of the bodies and steps in a contact; masses go with the third power.
///
/// # Errors
/// A scene cannot be planned.
pub fn size_and_steps(law: &NormalLaw, quick: bool) -> Result<Map, Error> {
    let sizes = rows(&[1.0, 2.0, 5.0, 10.0, 30.0, 100.0, 300.0, 1000.0], quick);
    let mut cells = Vec::new();
    for size in &sizes {
        // The small one keeps its size, so that the same impact has a larger partner.
        let pair = Pair { masses: [0.01, 0.01 * size.powi(3)], radii: [0.01, 0.01 * size], ..EQUAL };
        let block = (law.block)(1.0, 0.7);
        let row: Result<Vec<Class>, Error> =
            STEPS.iter().map(|steps| worst(&pair, &block, super::SCHEMES[0], Some(*steps))).collect();
        cells.push(row?);
    }
    Ok(Map {
        name: format!("size-{}", law.name),
        title: format!("{}, sizes, {}", law.name, super::SCHEMES[0]),
        x: ("steps per contact", STEPS.to_vec()),
        y: ("size ratio", sizes),
        cells,
        lines: Vec::new(),
    })
}
