//! What a plan of ours refuses, told to the engines all the same.

use granule_extremes::{Ball, ball, head_on, scene};

use super::Change;
use crate::peers::{InputFiles, PeerScene};

const LINEAR: &str = "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)";
const FRICTION: &str = "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), tangential: \
                        TangentialSpring(stiffness: 3e3, friction: 0.3)";

/// An ordinary impact, changed in the engines' scene.
fn told(text: &str, scene: fn(&mut PeerScene)) -> (String, Change) {
    (text.to_string(), Change { scene: Some(scene), files: None })
}

/// An ordinary impact, changed in the engines' files.
fn written(text: &str, files: fn(&mut InputFiles)) -> (String, Change) {
    (text.to_string(), Change { scene: None, files: Some(files) })
}

fn ordinary(laws: &str) -> String {
    scene(&head_on(0.01, 0.01), laws, "driver: TimeStep(step: 1e-5), run: (duration: 4e-3)")
}

/// Replaces a number of a body, counted in its line of `Atoms`: id, type, diameter, density, x, y, z.
fn set_column(files: &mut InputFiles, column: usize, value: &str) {
    let mut inside = false;
    let mut done = false;
    let lines = files.bodies.lines().map(|line| {
        inside = line.starts_with("Atoms") || (inside && !line.starts_with("Velocities"));
        let mut words: Vec<&str> = line.split_whitespace().collect();
        if inside && !done && words.len() >= 7 {
            done = true;
            words[column] = value;
            return words.join(" ");
        }
        line.to_string()
    });
    files.bodies = lines.collect::<Vec<_>>().join("\n") + "\n";
}

/// Replaces the velocity of the first body along x.
fn set_velocity(files: &mut InputFiles, value: &str) {
    let Some((head, tail)) = files.bodies.split_once("Velocities") else { return };
    let mut done = false;
    let lines = tail.lines().map(|line| {
        let mut words: Vec<&str> = line.split_whitespace().collect();
        if !done && words.len() >= 4 {
            done = true;
            words[1] = value;
            return words.join(" ");
        }
        line.to_string()
    });
    files.bodies = format!("{head}Velocities{}\n", lines.collect::<Vec<_>>().join("\n"));
}

/// Replaces the stiffness 1e4 and the friction 0.3, as both engines write them.
fn set_law(files: &mut InputFiles, old: &str, new: &str) {
    files.script = files.script.replace(&format!(" {old} "), &format!(" {new} "));
    files.script = files.script.replace(&format!(" {old}\n"), &format!(" {new}\n"));
}

pub fn beyond_resolution() -> Vec<(String, Change)> {
    let mut balls = head_on(1.0, 1.0);
    for ball in &mut balls {
        ball.radius = 1.0;
        ball.position[0] = 1e9 + 102.0 * ball.position[0];
    }
    let law = "normal: LinearSpringDashpot(stiffness: 1e12, restitution: 0.8)";
    vec![(scene(&balls, law, "driver: TimeStep(step: 1e-8), run: (steps: 1000)"), Change::default())]
}

pub fn beyond_size() -> Vec<(String, Change)> {
    let balls = head_on(1.0, 1.0).map(|ball| Ball {
        radius: 1.0,
        position: ball.position.map(|x| 102.0 * x),
        ..ball
    });
    let law = "normal: LinearSpringDashpot(stiffness: 50, restitution: 0.8)";
    let text = scene(&balls, law, "driver: TimeStep(step: 1e-3), run: (duration: 1)");
    vec![told(&text, |scene| {
        for body in &mut scene.bodies {
            body.position[0] += 1e14;
        }
        scene.lower[0] += 1e14;
        scene.upper[0] += 1e14;
    })]
}

fn periodic(speed: f64) -> String {
    let balls = [ball([0.01, 0.05, 0.05], [speed, 0.0, 0.0]), ball([0.05, 0.05, 0.02], [0.0; 3])];
    let more = "cell: (lo: (0, 0, 0), hi: (0.1, 0.1, 0.1), periodic: (true, true, true)), driver: TimeStep(step: \
                1e-5), run: (steps: 1000)";
    scene(&balls, LINEAR, more)
}

pub fn countless_boxes() -> Vec<(String, Change)> {
    vec![told(&periodic(1.0), |scene| scene.bodies[0].velocity[0] = 1e16)]
}

pub fn small_cell() -> Vec<(String, Change)> {
    // Neighbours on both sides: overlaps of 1 mm and 0.5 mm.
    vec![told(&periodic(0.0), |scene| {
        scene.upper[0] = 0.0385;
        scene.bodies[1].position = [0.029, 0.05, 0.05];
    })]
}

pub fn infinite_friction() -> Vec<(String, Change)> {
    let mut balls = head_on(0.01, 0.01);
    balls[0].velocity[1] = 0.5;
    // A large friction in the files, so that the number can be found and replaced.
    let laws = "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), tangential: TangentialSpring(stiffness: \
                3e3, friction: 12345.0)";
    let text =
        scene(&balls, laws, "driver: TimeStep(step: Auto(steps_per_contact: 1000)), run: (duration: 5e-3)");
    vec![written(&text, |files| set_law(files, "12345.0", "inf"))]
}

pub fn endless() -> Vec<(String, Change)> {
    vec![written(&ordinary(LINEAR), |files| {
        files.script = files.script.replace("\nrun 400\n", "\nrun 100000000000000000000\n");
    })]
}

pub fn no_bodies() -> Vec<(String, Change)> {
    vec![written(&ordinary(LINEAR), |files| {
        let head = files.bodies.split("\nAtoms").next().unwrap_or_default().replace("2 atoms", "0 atoms");
        files.bodies = head;
    })]
}

pub fn not_finite() -> Vec<(String, Change)> {
    let text = ordinary(LINEAR);
    vec![
        written(&text, |files| set_column(files, 4, "nan")),
        written(&text, |files| set_column(files, 2, "nan")),
        written(&text, |files| set_column(files, 3, "inf")),
        written(&text, |files| set_velocity(files, "nan")),
        written(&text, |files| set_velocity(files, "inf")),
        written(&text, |files| set_law(files, "10000.0", "nan")),
    ]
}

pub fn impossible() -> Vec<(String, Change)> {
    let text = ordinary(FRICTION);
    vec![
        written(&text, |files| set_column(files, 2, "-0.02")),
        written(&text, |files| set_column(files, 3, "-2500")),
        written(&text, |files| set_column(files, 3, "0")),
        written(&text, |files| set_law(files, "10000.0", "-10000.0")),
        written(&text, |files| set_law(files, "10000.0", "0")),
        written(&text, |files| set_law(files, "0.3", "-0.5")),
    ]
}

pub fn energy_overflow() -> Vec<(String, Change)> {
    vec![told(&ordinary(LINEAR), |scene| {
        scene.bodies[0].velocity[0] = 1e200;
    })]
}

pub fn step_too_large() -> Vec<(String, Change)> {
    // Three times the step at which a pair is stable, 2 sqrt(m12/k) = 1.4 ms; the bodies start in contact.
    let balls = [ball([0.0; 3], [0.0; 3]), ball([0.01995, 0.0, 0.0], [0.0; 3])];
    let law = "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 1)";
    let text = scene(&balls, law, "allow_overlap: true, driver: TimeStep(step: 1e-5), run: (steps: 100)");
    vec![told(&text, |scene| scene.time_step = 4.2e-3)]
}

pub fn packing() -> Vec<(String, Change)> {
    let text = r#"(version: 1, seed: 1, materials: { "a": (density: 2500) }, impact_speed: 0.1, allow_overlap: true,
        cell: (lo: (0, 0, 0), hi: (0.008484, 0.008484, 0.008484), periodic: (true, true, true)),
        bodies: [Lattice(material: "a", kind: FaceCentred, radius: 0.001, spacing: 0.0019997, lo: (0, 0, 0), hi: (0.008484,
        0.008484, 0.008484), velocity_spread: 1e-6)],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e4, restitution: 1))],
        driver: TimeStep(step: 1e-6), run: (steps: 200))"#;
    // Between the limit of a packing, 2.29e-5 s, and that of a pair, 4.58e-5 s.
    vec![told(text, |scene| scene.time_step = 4e-5)]
}

/// Whether a change of a file did something; tests hold that none is idle.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::ours::plan_text;
    use crate::peers::{Engine, inputs};
    use crate::translate::{Target, translate};

    #[test]
    fn every_change_changes_the_inputs_of_both_engines() {
        let all = [
            beyond_size(),
            countless_boxes(),
            small_cell(),
            infinite_friction(),
            endless(),
            no_bodies(),
            not_finite(),
            impossible(),
            energy_overflow(),
            step_too_large(),
            packing(),
        ];
        for (index, (text, change)) in all.into_iter().flatten().enumerate() {
            let plan = plan_text(&text).unwrap();
            for engine in [Engine::Lammps, Engine::Liggghts] {
                let targets = Target::ALL.into_iter().filter(|target| target.engine() == engine);
                let mut scene = targets.filter_map(|target| translate(&plan, target).ok()).next().unwrap();
                let before = inputs(&scene).unwrap();
                if let Some(change) = change.scene {
                    change(&mut scene);
                }
                let mut after = inputs(&scene).unwrap();
                if let Some(change) = change.files {
                    change(&mut after);
                }
                assert_ne!(before, after, "{index} {}", engine.name());
            }
        }
    }
}
