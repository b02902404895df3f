//! The extremes that the engines can be told, one row each.

use granule_extremes::{Ball, ball, crowd, head_on, scene, swarm};

use super::{Change, Right, Trial, judge, wild};
use crate::peers::PeerScene;

const LINEAR: &str = "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)";
const ELASTIC: &str = "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 1)";
const FRICTION: &str = "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), tangential: \
                        TangentialSpring(stiffness: 3e3, friction: 0.3)";

const TRIALS: &[Trial] = &[
    Trial { case: "mass-ratio", scenes: mass_ratio, right: Right::Gives(judge::reflected) },
    Trial { case: "infinite-mass", scenes: infinite_mass, right: Right::Gives(judge::reflected) },
    Trial { case: "elastic", scenes: elastic, right: Right::Gives(judge::elastic) },
    Trial { case: "critical-damping", scenes: critical, right: Right::Gives(judge::critical) },
    Trial { case: "overdamped", scenes: overdamped, right: Right::Gives(judge::stopped) },
    Trial { case: "stiffness", scenes: stiffness, right: Right::Gives(judge::restitution) },
    Trial { case: "too-soft", scenes: too_soft, right: Right::Warns },
    Trial { case: "hertz-modulus", scenes: hertz, right: Right::Gives(judge::restitution) },
    Trial { case: "impact-speed", scenes: impact_speed, right: Right::Gives(judge::restitution) },
    Trial { case: "size-ratio", scenes: size_ratio, right: Right::Gives(judge::reflected) },
    Trial { case: "nanometres", scenes: nanometres, right: Right::Gives(judge::restitution) },
    Trial { case: "megametres", scenes: megametres, right: Right::Gives(judge::restitution) },
    Trial { case: "far-from-the-origin", scenes: far, right: Right::Gives(judge::restitution) },
    Trial { case: "beyond-resolution", scenes: wild::beyond_resolution, right: Right::Warns },
    Trial { case: "beyond-size", scenes: wild::beyond_size, right: Right::Refuses },
    Trial { case: "coincident-centres", scenes: coincident, right: Right::Gives(judge::driven_apart) },
    Trial { case: "huge-overlap", scenes: huge_overlap, right: Right::Gives(judge::stored) },
    Trial { case: "grazing", scenes: grazing, right: Right::Gives(judge::undeflected) },
    Trial { case: "many-boxes-in-a-step", scenes: many_boxes, right: Right::Gives(judge::in_place) },
    Trial { case: "countless-boxes", scenes: wild::countless_boxes, right: Right::Refuses },
    Trial { case: "small-cell", scenes: wild::small_cell, right: Right::Gives(judge::both_sides) },
    Trial { case: "tunnelling", scenes: tunnelling, right: Right::Warns },
    Trial { case: "spin", scenes: spin, right: Right::Gives(judge::no_gain) },
    Trial { case: "drilling", scenes: drilling, right: Right::Gives(judge::same_spins) },
    Trial { case: "no-friction", scenes: no_friction, right: Right::Gives(judge::same_spins) },
    Trial { case: "infinite-friction", scenes: wild::infinite_friction, right: Right::Gives(judge::rolls) },
    Trial { case: "denormal-speeds", scenes: denormal, right: Right::Gives(judge::no_gain) },
    Trial { case: "nothing-acts", scenes: nothing, right: Right::Gives(judge::unmoved) },
    Trial { case: "column", scenes: column, right: Right::Gives(judge::column) },
    Trial { case: "sizes-of-a-thousand", scenes: || sizes(5_000), right: Right::Gives(judge::touching) },
    Trial {
        case: "sizes-of-a-thousand-many",
        scenes: || sizes(100_000),
        right: Right::Gives(judge::touching),
    },
    Trial { case: "faster-than-the-skin", scenes: fast, right: Right::Gives(judge::touching) },
    Trial { case: "one-body", scenes: one_body, right: Right::Gives(judge::falls) },
    Trial { case: "more-steps-than-numbers", scenes: wild::endless, right: Right::Refuses },
    Trial { case: "no-bodies", scenes: wild::no_bodies, right: Right::Ends },
    Trial { case: "not-finite", scenes: wild::not_finite, right: Right::Refuses },
    Trial { case: "impossible-values", scenes: wild::impossible, right: Right::Refuses },
    Trial { case: "energy-overflow", scenes: wild::energy_overflow, right: Right::Refuses },
    Trial { case: "step-too-large", scenes: wild::step_too_large, right: Right::Refuses },
    Trial { case: "step-too-large-for-a-packing", scenes: wild::packing, right: Right::Refuses },
];

/// All of them.
pub fn all() -> impl Iterator<Item = &'static Trial> {
    TRIALS.iter()
}

/// Why a case has no trial.
pub fn why_not(case: &str) -> &'static str {
    match case {
        "wedge" => "its walls are perpendicular to an axis",
        "slip-threshold" => "no such surface",
        "plastic-soft" => "damping is given as a coefficient there, infinity as any number",
        "unit-systems" => "formats with decimal digits, so that powers of two are not exact",
        "column-long" => "as `column`, for longer than is waited for",
        "energy-drift" | "energy-drift-long" => "the same scheme: nothing to tell apart",
        "any-number-of-threads" => {
            "another number of ranks is another order of additions there, as their manuals say"
        }
        "taken-up-again" => "restart files leave out the forces of the step, as their manuals say",
        "ten-billion-steps" => "1e10 steps take hours",
        name if name.ends_with("-hard") || name.contains("collapse") || name.starts_with("simultaneous") => {
            "no hard spheres"
        }
        _ => "not compared",
    }
}

/// As the scene is written.
pub(super) fn plain(text: String) -> Vec<(String, Change)> {
    vec![(text, Change::default())]
}

/// A box around the line on which the bodies move: the engines' bins fill it, and a wide one takes all of their time.
fn narrow(scene: &mut PeerScene) {
    for axis in 1..3 {
        (scene.lower[axis], scene.upper[axis]) = (-0.05, 0.05);
    }
    (scene.lower[0], scene.upper[0]) = (-0.1, 1.5);
}

/// A head-on impact with this many steps in it.
fn impact(balls: &[Ball], laws: &str, steps: f64, duration: f64) -> String {
    scene(
        balls,
        laws,
        &format!("driver: TimeStep(step: Auto(steps_per_contact: {steps:?})), run: (duration: {duration:?})"),
    )
}

fn mass_ratio() -> Vec<(String, Change)> {
    plain(impact(&head_on(0.01, 1e10), LINEAR, 2000.0, 4e-3))
}

fn infinite_mass() -> Vec<(String, Change)> {
    let mut balls = head_on(0.01, 1.0);
    balls[1].frozen = true;
    plain(impact(&balls, LINEAR, 2000.0, 8e-3))
}

fn elastic() -> Vec<(String, Change)> {
    plain(impact(&head_on(0.01, 0.01), ELASTIC, 2000.0, 4e-3))
}

fn critical() -> Vec<(String, Change)> {
    let law =
        format!("normal: LinearSpringDashpot(stiffness: 1e4, damping: {:?})", 2.0 * (1e4_f64 * 0.005).sqrt());
    plain(scene(&head_on(0.01, 0.01), &law, "driver: TimeStep(step: 1e-7), run: (duration: 2.2e-3)"))
}

fn overdamped() -> Vec<(String, Change)> {
    let damping = 1e6 * 2.0 * (1e4_f64 * 0.005).sqrt();
    let law = format!("normal: LinearSpringDashpot(stiffness: 1e4, damping: {damping:?})");
    // The gap is crossed in a thousand of the steps that such damping needs.
    let mut balls = head_on(0.01, 0.01);
    balls[1].position[0] = 0.02 + 1e-8;
    plain(scene(&balls, &law, "driver: TimeStep(), run: (duration: 1e-6)"))
}

fn stiffness() -> Vec<(String, Change)> {
    let mut balls = head_on(0.01, 0.01);
    balls[1].position[0] = 0.02 + 1e-9;
    let law = "normal: LinearSpringDashpot(stiffness: 1e14, restitution: 0.8)";
    plain(impact(&balls, law, 2000.0, 4e-8))
}

fn too_soft() -> Vec<(String, Change)> {
    let law = "normal: LinearSpringDashpot(stiffness: 1, restitution: 0.8)";
    let text = scene(&head_on(0.01, 0.01), law, "driver: TimeStep(), run: (duration: 1)");
    vec![(text, Change { scene: Some(narrow), files: None })]
}

fn hertz() -> Vec<(String, Change)> {
    let mut balls = head_on(0.01, 0.01);
    balls[1].position[0] = 0.02 + 1e-7;
    let law = "normal: Hertz(youngs_modulus: 1e14, poisson_ratio: 0.3, restitution: 0.8)";
    plain(impact(&balls, law, 2000.0, 5e-6))
}

fn impact_speed() -> Vec<(String, Change)> {
    let balls = [ball([0.0; 3], [1e-8, 0.0, 0.0]), ball([0.02 + 1e-12, 0.0, 0.0], [0.0; 3])];
    let law = "normal: LinearSpringDashpot(stiffness: 1e9, restitution: 0.8)";
    plain(impact(&balls, law, 500.0, 2e-4))
}

fn size_ratio() -> Vec<(String, Change)> {
    let balls = [
        Ball { radius: 1e-5, mass: 1e-11, ..ball([0.0; 3], [1.0, 0.0, 0.0]) },
        Ball { radius: 1e-2, mass: 1e-2, ..ball([1.001e-2 + 1e-7, 0.0, 0.0], [0.0; 3]) },
    ];
    let law = "normal: LinearSpringDashpot(stiffness: 10, restitution: 0.8)";
    plain(impact(&balls, law, 2000.0, 5e-6))
}

/// Two grains of this size and mass that meet with `speed`.
fn grains(radius: f64, mass: f64, stiffness: f64, speed: f64) -> String {
    let contact = std::f64::consts::PI * (0.5 * mass / stiffness).sqrt();
    let balls = [
        Ball { radius, mass, ..ball([0.0; 3], [speed, 0.0, 0.0]) },
        Ball { radius, mass, ..ball([2.0 * radius + 0.1 * contact * speed, 0.0, 0.0], [0.0; 3]) },
    ];
    let law = format!("normal: LinearSpringDashpot(stiffness: {stiffness:?}, restitution: 0.8)");
    impact(&balls, &law, 2000.0, 1.5 * contact)
}

fn nanometres() -> Vec<(String, Change)> {
    plain(grains(1e-9, 1e-23, 1.0, 1.0))
}

fn megametres() -> Vec<(String, Change)> {
    plain(grains(1e6, 1e21, 1e13, 1.0))
}

fn far() -> Vec<(String, Change)> {
    let mut balls = head_on(1.0, 1.0);
    for ball in &mut balls {
        ball.radius = 1.0;
        ball.position[0] = 1e9 + 102.0 * ball.position[0];
    }
    let law = "normal: LinearSpringDashpot(stiffness: 50, restitution: 0.8)";
    plain(scene(&balls, law, "driver: TimeStep(step: 1e-3), run: (duration: 1)"))
}

fn coincident() -> Vec<(String, Change)> {
    let at = |offset: f64| {
        let balls = [ball([0.0; 3], [0.0; 3]), ball([offset, 0.0, 0.0], [0.0; 3])];
        let more = "allow_overlap: true, driver: TimeStep(step: 1e-6), run: (steps: 10)";
        (scene(&balls, FRICTION, more), Change::default())
    };
    vec![at(0.0), at(1e-160)]
}

fn huge_overlap() -> Vec<(String, Change)> {
    let balls = [ball([0.0; 3], [0.0; 3]), ball([0.001, 0.0, 0.0], [0.0; 3])];
    let more =
        "allow_overlap: true, driver: TimeStep(step: Auto(steps_per_contact: 2000)), run: (duration: 4e-3)";
    plain(scene(&balls, ELASTIC, more))
}

fn grazing() -> Vec<(String, Change)> {
    let balls = [ball([0.0; 3], [1.0, 0.0, 0.0]), ball([3e-7, 0.02 * (1.0 - 1e-12), 0.0], [0.0; 3])];
    plain(scene(&balls, LINEAR, "driver: TimeStep(step: 1e-8), run: (steps: 60)"))
}

fn many_boxes() -> Vec<(String, Change)> {
    let balls = [ball([0.01, 0.05, 0.05], [3.7e4, 0.0, 0.0]), ball([0.05, 0.05, 0.02], [3.7e4, 0.0, 0.0])];
    let more = "cell: (lo: (0, 0, 0), hi: (0.1, 0.1, 0.1), periodic: (true, true, true)), driver: TimeStep(step: \
                1e-5), run: (steps: 1000)";
    plain(scene(&balls, LINEAR, more))
}

fn tunnelling() -> Vec<(String, Change)> {
    let balls = [ball([0.0; 3], [5e3, 0.0, 0.0]), ball([0.1, 0.0, 0.0], [0.0; 3])];
    let text = scene(&balls, LINEAR, "driver: TimeStep(step: 1e-5), run: (duration: 1e-4)");
    vec![(text, Change { scene: Some(narrow), files: None })]
}

/// Two bodies that meet head on with these spins.
fn spinning(first: [f64; 3], laws: &str) -> Vec<(String, Change)> {
    let mut balls = head_on(0.01, 0.01);
    balls[0].spin = first;
    balls[1].spin = first.map(|w| 0.5 * w);
    plain(impact(&balls, laws, 200.0, 4e-3))
}

fn spin() -> Vec<(String, Change)> {
    spinning([0.0, 0.0, 1e8], FRICTION)
}

fn drilling() -> Vec<(String, Change)> {
    spinning([1e6, 0.0, 0.0], FRICTION)
}

fn no_friction() -> Vec<(String, Change)> {
    spinning(
        [30.0, 200.0, -100.0],
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), tangential: TangentialSpring(stiffness: 3e3, \
         friction: 0)",
    )
}

fn denormal() -> Vec<(String, Change)> {
    let mut balls = [ball([0.0; 3], [1e-310, 1e-311, 0.0]), ball([0.02, 0.0, 0.0], [0.0; 3])];
    balls[0].spin = [0.0, 0.0, 1e-312];
    plain(scene(&balls, FRICTION, "impact_speed: 1, driver: TimeStep(step: 1e-5), run: (steps: 1000)"))
}

fn nothing() -> Vec<(String, Change)> {
    plain(format!(
        r#"(version: 1, materials: {{ "a": (density: 2500) }}, bodies: [Lattice(material: "a", kind: Cubic, radius:
        0.01, spacing: 0.021, lo: (0, 0, 0), hi: (0.22, 0.22, 0.22))], impact_speed: 1, contacts: [(between: ("a", "a"),
        {LINEAR})], driver: TimeStep(step: 1e-5), run: (steps: 1000))"#
    ))
}

fn column() -> Vec<(String, Change)> {
    // Overlaps of rest: (N - i) m g/k between bodies i and i + 1, counted from the floor.
    let (count, weight, stiffness) = (1000, 1e-3 * 9.81, 1e6);
    let mut height = 1e-3;
    let mut balls = String::new();
    for k in 0..count {
        let carried = f64::from(count - k) * weight;
        height -= carried / stiffness;
        balls += &format!(
            "Sphere(material: \"a\", radius: 0.001, mass: 0.001, position: (0, 0, {height:?}), velocity: (0, 0, 0)),\n"
        );
        height += 2e-3;
    }
    plain(format!(
        r#"(version: 1, gravity: (0, 0, -9.81), materials: {{ "a": (), "b": () }}, allow_overlap: true, impact_speed: 0.1,
        bodies: [{balls}], walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "b") }},
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e6, damping: 2)),
        (between: ("a", "b"), normal: LinearSpringDashpot(stiffness: 1e6, damping: 2))],
        driver: TimeStep(step: 2e-6), run: (steps: 20000))"#
    ))
}

fn one_body() -> Vec<(String, Change)> {
    // A law is there for a second body, which the engines are not told.
    let balls = [ball([0.0; 3], [1.0, 0.0, 0.0]), ball([5.0, 0.0, 0.0], [0.0; 3])];
    let more = "gravity: (0, 0, -9.81), impact_speed: 1, driver: TimeStep(step: 1e-3), run: (steps: 1000)";
    let alone = |scene: &mut PeerScene| {
        scene.bodies.truncate(1);
        narrow(scene);
        scene.lower[2] = -5.0;
    };
    vec![(scene(&balls, LINEAR, more), Change { scene: Some(alone), files: None })]
}

/// Forces of the first positions alone.
fn sizes(small: usize) -> Vec<(String, Change)> {
    let law = "normal: LinearSpringDashpot(stiffness: 1e-3, restitution: 1)";
    plain(scene(&crowd(small), law, "allow_overlap: true, driver: TimeStep(), run: (steps: 1)"))
}

fn fast() -> Vec<(String, Change)> {
    // Without damping: a limited dashpot hides contacts that part.
    let more = "allow_overlap: true, cell: (lo: (0, 0, 0), hi: (0.3, 0.3, 0.3), periodic: (true, true, true)), driver: \
                TimeStep(step: 1e-5, skin: 1e-3), run: (steps: 500)";
    plain(scene(&swarm(), ELASTIC, more))
}
