//! Tangential history is objective: it turns with the contact. (Cells and new lists: `candidates.rs`.)

use granule_tests::{advance, bodies, driver};

/// Two soft elastic spheres that stick while they turn about each other.
fn turning_pair(conventions: &str, step: f64, steps: u64) -> String {
    format!(
        r#"(version: 1, materials: {{ "a": (density: 2500) }}, impact_speed: 2, conventions: {conventions},
        bodies: [
            Sphere(material: "a", radius: 0.01, position: (0.03, 0.05, 0.05), velocity: (0.5, 0.6, 0.1), spin: (20, 10, -30)),
            Sphere(material: "a", radius: 0.01, position: (0.05, 0.052, 0.049), velocity: (-0.5, -0.6, 0), spin: (0, -10, -30)),
        ],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 150, restitution: 1),
            tangential: TangentialSpring(stiffness: 40, friction: inf))],
        driver: TimeStep(step: {step:e}), run: (steps: {steps}),
        outputs: [Series(path: "energy.csv", every: 1000, columns: ["elastic_energy"])])"#,
    )
}

/// Kinetic, rotational and elastic energy, and the cosine between the normals at the beginning and now.
fn energy(text: &str, steps: u64) -> (f64, f64, f64) {
    let mut driver = driver(text);
    let plan = driver.engine().plan().clone();
    let total = |driver: &granule_drivers::TimeStepDriver| {
        let motion: f64 = bodies(driver)
            .iter()
            .zip(&plan.bodies.mass)
            .map(|(body, mass)| {
                let square = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
                0.5 * mass * (square(body.velocity) + 0.4 * 1e-4 * square(body.spin))
            })
            .sum();
        motion + driver.engine().tally().elastic.iter().sum::<f64>()
    };
    let before = total(&driver);
    let (mut worst, mut last, mut normals) = (0.0_f64, 0.0, Vec::new());
    for step in 1..=steps {
        advance(&mut driver, step);
        // A spring that is still stretched when the bodies part takes its energy along.
        let contacts = driver.engine().contacts();
        let Some(contact) = contacts.first() else { if normals.is_empty() { continue } else { break } };
        normals.push(contact.normal);
        last = (total(&driver) / before - 1.0).abs();
        worst = worst.max(last);
    }
    let dot: f64 = (0..3).map(|k| normals[0][k] * normals[normals.len() - 1][k]).sum();
    (worst, last, dot)
}

/// A contact that turns by more than half a right angle, with its spring stretched all the while, keeps the energy to second
/// order in the step: the spring turns with it and keeps its length. Projecting it without restoring the length does not
/// (the convention of LAMMPS and LIGGGHTS).
#[test]
fn springs_turn_with_the_contact() {
    let physical = r#""physical""#;
    let shrinking = r#"(preset: "physical", history_update: IncrementThenProject)"#;
    let drift = |conventions: &str, finer: u64| {
        let steps = 2000 * finer;
        energy(&turning_pair(conventions, 5e-5 / finer as f64, steps), steps)
    };
    let (coarse, fine) = (drift(physical, 1), drift(physical, 2));
    assert!(fine.2 < 0.7, "the contact turns: cosine {}", fine.2);
    // Of second order, and small.
    assert!(fine.0 < 2e-4 && fine.0 < 0.35 * coarse.0, "{coarse:?} {fine:?}");
    let shrunk = drift(shrinking, 2);
    assert!(shrunk.1 > 10.0 * fine.1, "{shrunk:?} {fine:?}");
}
