//! The same scene gives the same bits: on any number of threads, and whether or not anyone looks.

use granule_drivers::Driver;
use granule_engine::{Engine, InstructionSet};
use granule_tests::{advance, driver_with, plan};

/// A frictional pile: 2000 spheres of different sizes that fall onto a floor, periodic sideways.
fn pile(step: &str, steps: u64) -> String {
    format!(
        r#"(version: 1, seed: 7, gravity: (0, 0, -9.81), materials: {{ "a": (density: 2500) }},
        cell: (lo: (0, 0, 0), hi: ("12 mm", "12 mm", "40 mm"), periodic: (true, true, false)),
        bodies: [Fill(material: "a", radius: Uniform(min: "0.4 mm", max: "0.6 mm"), count: 2000,
            lo: (0, 0, 0), hi: ("12 mm", "12 mm", "40 mm"), velocity: (0, 0, -0.5), velocity_spread: 0.2)],
        walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e3, restitution: 0.7),
            tangential: TangentialSpring(stiffness: 285, friction: 0.5, damping: 1e-3))],
        driver: TimeStep(step: "{step}"), run: (steps: {steps}))"#
    )
}

/// Discs in a heap in the plane.
fn discs(steps: u64) -> String {
    format!(
        r#"(version: 1, seed: 7, dimensions: 2, gravity: (0, -9.81), materials: {{ "a": (density: 2500) }},
        cell: (lo: (0, 0), hi: ("30 mm", "40 mm"), periodic: (true, false)),
        bodies: [Fill(material: "a", radius: Uniform(min: "0.2 mm", max: "0.3 mm"), count: 2000,
            lo: (0, 0), hi: ("30 mm", "30 mm"), velocity: (0, -0.5), velocity_spread: 0.2)],
        walls: {{ "floor": Plane(point: (0, 0), normal: (0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e5, restitution: 0.7),
            tangential: TangentialSpring(stiffness: 2.85e4, friction: 0.5, damping: 1e-3))],
        driver: TimeStep(step: "5 us"), run: (steps: {steps}))"#
    )
}

/// Case F15: 10^4 steps of a frictional pile, bitwise on 1, 2, 4 and 7 threads.
#[test]
fn same_bits_on_any_number_of_threads() {
    for (step, integrator) in
        [("5 us", "VelocityVerlet"), ("2.5 us", "VelocityVerlet"), ("5 us", "ContactResolved")]
    {
        let text = pile(step, 10_000)
            .replace("TimeStep(", &format!("TimeStep(integrator: {integrator}, packing_limit: false, "));
        let hash = |threads| {
            let mut driver = driver_with(&text, threads);
            advance(&mut driver, 10_000);
            assert!(driver.engine().tally().contacts > 200, "the pile has contacts");
            assert_eq!(driver.threads(), threads, "the run uses the threads that it was given");
            driver.result_hash()
        };
        let one = hash(1);
        for threads in [2, 4, 7] {
            assert_eq!(hash(threads), one, "{threads} threads, {step}, {integrator}");
        }
    }
}

/// The loops are written once and compiled for each instruction set: the baseline gives the bits of the widest one, with
/// friction in space and in the plane, without it, and in single precision.
#[test]
fn same_bits_on_every_instruction_set() {
    let tangential =
        ",\n            tangential: TangentialSpring(stiffness: 285, friction: 0.5, damping: 1e-3)";
    let smooth = pile("5 us", 3000).replace(tangential, "");
    let resolved = |text: String| {
        text.replace("TimeStep(", "TimeStep(integrator: ContactResolved, packing_limit: false, ")
    };
    let single = pile("5 us", 3000).replace("seed: 7,", "seed: 7, precision: Single,");
    for (name, text) in [
        ("space", pile("5 us", 3000)),
        ("plane", discs(3000)),
        ("smooth", smooth),
        ("single", single),
        ("resolved in space", resolved(pile("5 us", 3000))),
        ("resolved in the plane", resolved(discs(3000))),
    ] {
        let hash = |instructions| {
            let mut engine = Engine::with_instructions(plan(&text), 2, instructions).unwrap();
            engine.advance(3000, &mut |_| {}).unwrap();
            assert!(engine.tally().contacts > 100, "{name}: there are contacts");
            let bodies = engine.bodies();
            let rows = [&bodies.position, &bodies.velocity, &bodies.spin, &bodies.force, &bodies.torque];
            rows.map(|rows| rows.iter().map(|row| row.0.map(f64::to_bits)).collect::<Vec<_>>())
        };
        assert!(hash(InstructionSet::Baseline) == hash(InstructionSet::detect()), "{name}");
    }
}

/// Looking at the state every few steps changes nothing.
#[test]
fn same_bits_with_and_without_looking() {
    let text = pile("5 us", 2000);
    let mut unseen = driver_with(&text, 2);
    advance(&mut unseen, 2000);
    let mut watched = driver_with(&text, 2);
    for step in (0..2000).step_by(7) {
        advance(&mut watched, step);
        assert!(watched.view().contacts().len() < 20_000);
    }
    advance(&mut watched, 2000);
    assert_eq!(unseen.result_hash(), watched.result_hash());
}
