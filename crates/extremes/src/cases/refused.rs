//! What cannot be, refused before the first step.

use crate::scene::{ball, head_on, scene};
use crate::{Case, Lab};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "no-bodies",
        extreme: "a scene without bodies",
        expected: "refused with that reason",
        slow: false,
        check: no_bodies,
    },
    Case {
        name: "plastic-soft",
        extreme: "a soft contact with a restitution of exactly 0: it would need infinite damping",
        expected: "refused, with the range that is allowed",
        slow: false,
        check: plastic_soft,
    },
    Case {
        name: "not-finite",
        extreme: "NaN and infinity in position, velocity, radius, mass, spin and stiffness",
        expected: "each refused by the name of the field",
        slow: false,
        check: not_finite,
    },
    Case {
        name: "impossible-values",
        extreme: "zero and negative mass, radius and stiffness, restitution of -0.1 and 1.2, friction of -0.5",
        expected: "each refused by the name of the field with the range that is allowed",
        slow: false,
        check: impossible_values,
    },
    Case {
        name: "energy-overflow",
        extreme: "a mass of 1e300 kg at 1e100 m/s: its energy is no number",
        expected: "refused with that reason",
        slow: false,
        check: energy_overflow,
    },
    Case {
        name: "step-too-large",
        extreme: "a time step at which a pair of bodies gains energy without bound",
        expected: "refused with the largest stable step",
        slow: false,
        check: step_too_large,
    },
    Case {
        name: "step-too-large-for-a-packing",
        extreme: "a time step at which a pair is stable, and a dense packing is not",
        expected: "refused with both limits",
        slow: false,
        check: step_too_large_for_a_packing,
    },
];

const SPRING: &str = "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)";
const RUN: &str = "driver: TimeStep(), run: (steps: 10)";

fn no_bodies(lab: &Lab) -> Result<String, String> {
    Ok(format!("refused: {}", lab.refusal(&scene(&[], SPRING, RUN), "at least one body")?))
}

fn plastic_soft(lab: &Lab) -> Result<String, String> {
    let text =
        scene(&head_on(0.01, 0.01), "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0)", RUN);
    Ok(format!("refused: {}", lab.refusal(&text, "`restitution` must be greater than 0")?))
}

/// Refuses each of the scenes, by the name of a field; the number of scenes.
fn all_refused(lab: &Lab, scenes: &[(String, &str)]) -> Result<String, String> {
    for (text, field) in scenes {
        lab.refusal(text, &format!("`{field}`"))?;
    }
    Ok(format!("{} scenes refused", scenes.len()))
}

/// A scene of one sphere with these fields, and a spring of this stiffness.
fn sphere(fields: &str, stiffness: &str) -> String {
    format!(
        r#"(version: 1, materials: {{ "a": () }}, bodies: [Sphere(material: "a", {fields})],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: {stiffness}, restitution: 0.8))], {RUN})"#
    )
}

fn not_finite(lab: &Lab) -> Result<String, String> {
    let mut scenes = Vec::new();
    for bad in ["NaN", "inf", "-inf"] {
        let whole = "radius: 0.01, mass: 0.01, position: (0, 0, 0)";
        scenes
            .push((sphere(&format!("radius: 0.01, mass: 0.01, position: (0, {bad}, 0)"), "1e4"), "position"));
        scenes.push((sphere(&format!("{whole}, velocity: ({bad}, 0, 0)"), "1e4"), "velocity"));
        scenes.push((sphere(&format!("{whole}, spin: (0, 0, {bad})"), "1e4"), "spin"));
        scenes.push((sphere(&format!("radius: {bad}, mass: 0.01, position: (0, 0, 0)"), "1e4"), "radius"));
        scenes.push((sphere(&format!("radius: 0.01, mass: {bad}, position: (0, 0, 0)"), "1e4"), "mass"));
        scenes.push((sphere(whole, bad), "stiffness"));
    }
    all_refused(lab, &scenes)
}

fn impossible_values(lab: &Lab) -> Result<String, String> {
    let mut scenes = Vec::new();
    for bad in ["0", "-1"] {
        scenes.push((sphere(&format!("radius: {bad}, mass: 0.01, position: (0, 0, 0)"), "1e4"), "radius"));
        scenes.push((sphere(&format!("radius: 0.01, mass: {bad}, position: (0, 0, 0)"), "1e4"), "mass"));
        scenes.push((sphere("radius: 0.01, mass: 0.01, position: (0, 0, 0)", bad), "stiffness"));
    }
    for restitution in ["-0.1", "1.2"] {
        let law = format!("normal: LinearSpringDashpot(stiffness: 1e4, restitution: {restitution})");
        scenes.push((scene(&head_on(0.01, 0.01), &law, RUN), "restitution"));
    }
    let friction = format!("{SPRING}, tangential: Coulomb(friction: -0.5)");
    scenes.push((scene(&head_on(0.01, 0.01), &friction, RUN), "friction"));
    all_refused(lab, &scenes)
}

fn energy_overflow(lab: &Lab) -> Result<String, String> {
    let mut balls = head_on(1e300, 0.01);
    balls[0].velocity[0] = 1e100;
    Ok(format!("refused: {}", lab.refusal(&scene(&balls, SPRING, RUN), "outside the range of numbers")?))
}

fn step_too_large(lab: &Lab) -> Result<String, String> {
    let text = scene(&head_on(0.01, 0.01), SPRING, "driver: TimeStep(step: 2e-3), run: (steps: 10)");
    Ok(format!("refused: {}", lab.refusal(&text, "unstable")?))
}

fn step_too_large_for_a_packing(lab: &Lab) -> Result<String, String> {
    let balls: Vec<_> = (0..27)
        .map(|k| {
            ball([0.021 * f64::from(k % 3), 0.021 * f64::from(k / 3 % 3), 0.021 * f64::from(k / 9)], [0.0; 3])
        })
        .collect();
    let text = scene(&balls, SPRING, "driver: TimeStep(step: 1e-3), run: (steps: 10)");
    let alone = scene(&balls[..2], SPRING, "driver: TimeStep(step: 1e-3), run: (steps: 10)");
    lab.plan(&alone).map_err(|errors| format!("a pair alone is refused: {errors}"))?;
    Ok(format!("refused: {}", lab.refusal(&text, "unstable")?))
}
