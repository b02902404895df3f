//! The contests: scenes and what counts as error.

use std::fmt::Write as _;

use super::runner::{Run, State};

/// Pairs in a scene of single impacts: as many phases of the step.
const PAIRS: usize = 500;
/// Golden and plastic ratios, whose multiples cover intervals evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
const PLASTIC: f64 = 0.754_877_666_246_692_7;
/// Length of single impacts in contacts: no simple fraction, so that the step does not divide the contact.
const LENGTH: f64 = 3.137;

/// A scene with its time unit.
pub struct Scene {
    /// Its text, with `STEP`, `STEPS`, `INTEGRATOR` where they go.
    pub text: String,
    /// The same for hard bodies, if they do.
    pub hard: Option<String>,
    /// Duration of a contact.
    pub contact: f64,
    /// Length of the run.
    pub duration: f64,
}

/// What a run is held against.
#[derive(Clone, Copy)]
pub enum Right {
    /// Exact velocities.
    Exact(fn() -> Run),
    /// The engine's own run with so many steps in a contact.
    OwnLimit(f64),
    /// Hard bodies.
    Hard,
}

/// A contest.
pub struct Contest {
    /// Name.
    pub name: &'static str,
    /// What is measured.
    pub what: &'static str,
    /// The scenes at a stiffness, one a realisation.
    pub scenes: fn(f64) -> Vec<Scene>,
    /// Stiffnesses that may be chosen.
    pub stiffnesses: &'static [f64],
    /// What counts as right.
    pub right: Right,
    /// Most steps in a contact that are tried.
    pub most: f64,
    /// States of a run that are looked at, evenly in time, the last one at its end.
    pub frames: u64,
    /// Largest error of the runs of all scenes against their limits.
    pub error: fn(&[Run], &[Run]) -> f64,
}

/// All contests.
pub const CONTESTS: [Contest; 5] = [
    Contest {
        name: "restitution",
        what: "largest error of e_n = 0.9 over 500 phases of the step against the contact, linear spring-dashpot",
        scenes: head_on,
        stiffnesses: &[1e6],
        right: Right::Exact(rebound),
        most: 4096.0,
        frames: 1,
        error: worst_velocity,
    },
    Contest {
        name: "oblique",
        what: "largest error of a velocity after 500 oblique impacts, Psi_1 from 0 to 4, spring, friction 0.3, over the normal speed",
        scenes: oblique,
        stiffnesses: &[1e6],
        right: Right::OwnLimit(20_480.0),
        most: 4096.0,
        frames: 1,
        error: worst_velocity,
    },
    Contest {
        name: "cooling-soft",
        what: "energy that a gas (phi = 0.05, e_n = 0.9, 1000 spheres, k = 1e5) has lost after half a mean free time, 4 states: error over \
               the loss, against the engine's own limit of small steps",
        scenes: gas,
        stiffnesses: &[1e5],
        right: Right::OwnLimit(640.0),
        most: 226.0,
        frames: 1,
        error: energy,
    },
    Contest {
        name: "cooling-hard",
        what: "the same against hard spheres, where the stiffness may be chosen from 1e4 to 1e7",
        scenes: gas,
        stiffnesses: &[1e4, 1e5, 1e6, 1e7],
        right: Right::Hard,
        most: 40.0,
        frames: 1,
        error: energy,
    },
    Contest {
        name: "pile",
        what: "a pile of five spheres (e_n = 0.5, friction 0.5) settles on nine frozen ones, 8 states: error of the mean time of the \
               kinetic energy and of the potential energy lost, each over itself; the larger one, against the engine's own limit",
        scenes: pile,
        stiffnesses: &[1e4],
        right: Right::OwnLimit(1280.0),
        most: 453.0,
        frames: 400,
        error: settling,
    },
];

pub const RESTITUTION: f64 = 0.9;

fn contact(stiffness: f64) -> f64 {
    contact_of(stiffness, RESTITUTION)
}

/// Duration of a contact: masses are 1, m12 = 1/2.
fn contact_of(stiffness: f64, restitution: f64) -> f64 {
    let ratio = restitution.ln() / (std::f64::consts::PI.powi(2) + restitution.ln().powi(2)).sqrt();
    std::f64::consts::PI / (2.0 * stiffness * (1.0 - ratio * ratio)).sqrt()
}

fn frame(cell: &str, bodies: &str, laws: &str, hard: bool) -> String {
    let driver =
        if hard { "Event(step: STEP)" } else { "TimeStep(INTEGRATOR step: STEP, packing_limit: false)" };
    format!(
        "(version: 1, {cell} materials: {{ \"a\": (density: 1.909859317102744) }}, bodies: [{bodies}], \
         contacts: [(between: (\"a\", \"a\"), {laws})], driver: {driver}, run: (steps: STEPS))"
    )
}

/// Pairs far from each other; the first one of each moves towards the second with speed 1.
fn pairs(stiffness: f64, tangential: impl Fn(usize) -> f64) -> String {
    let mut bodies = String::new();
    let flight = contact(stiffness);
    for pair in 0..PAIRS {
        let phase = |ratio: f64| (pair as f64 * ratio).fract();
        let (x, y, z) = (4.0 * (pair % 8) as f64, 4.0 * (pair / 8 % 8) as f64, 4.0 * (pair / 64) as f64);
        let gap = (0.2 + phase(GOLDEN)) * flight;
        // Writing to a string cannot fail.
        let _ = write!(
            bodies,
            "Sphere(material: \"a\", radius: 0.5, position: ({x:?}, {y:?}, {z:?}), velocity: (1, {:?}, 0)), \
             Sphere(material: \"a\", radius: 0.5, position: ({:?}, {y:?}, {z:?})), ",
            tangential(pair),
            x + 1.0 + gap
        );
    }
    bodies
}

const BOX: &str = "cell: (lo: (-4, -4, -4), hi: (36, 36, 36), periodic: (true, true, true)),";

fn head_on(stiffness: f64) -> Vec<Scene> {
    let normal = format!(
        "contact_end: Overlap, normal: LinearSpringDashpot(stiffness: {stiffness:?}, restitution: {RESTITUTION})"
    );
    let bodies = pairs(stiffness, |_| 0.0);
    vec![Scene {
        text: frame(BOX, &bodies, &normal, false),
        hard: Some(frame(BOX, &bodies, &format!("collision: HardSphere(restitution: {RESTITUTION})"), true)),
        contact: contact(stiffness),
        duration: LENGTH * contact(stiffness),
    }]
}

/// What a head-on impact of equal masses leaves: (1 - e)/2 and (1 + e)/2.
fn rebound() -> Run {
    let each = [[0.5 * (1.0 - RESTITUTION), 0.0, 0.0], [0.5 * (1.0 + RESTITUTION), 0.0, 0.0]];
    let none = vec![[0.0; 3]; 2 * PAIRS];
    vec![State { position: none.clone(), velocity: (0..PAIRS).flat_map(|_| each).collect(), surface: none }]
}

fn oblique(stiffness: f64) -> Vec<Scene> {
    let tangential = 2.0 / 7.0 * stiffness;
    let laws = format!(
        "contact_end: Overlap, normal: LinearSpringDashpot(stiffness: {stiffness:?}, restitution: {RESTITUTION}), \
         tangential: TangentialSpring(stiffness: {tangential:?}, friction: 0.3)"
    );
    let bodies = pairs(stiffness, |pair| 4.0 * (pair as f64 * PLASTIC).fract());
    vec![Scene {
        text: frame(BOX, &bodies, &laws, false),
        hard: None,
        contact: contact(stiffness),
        duration: LENGTH * contact(stiffness),
    }]
}

fn worst_velocity(runs: &[Run], exact: &[Run]) -> f64 {
    let mut worst: f64 = 0.0;
    for (run, exact) in runs.iter().flatten().zip(exact.iter().flatten()) {
        for (a, b) in run.velocity.iter().zip(&exact.velocity).chain(run.surface.iter().zip(&exact.surface)) {
            for axis in 0..3 {
                worst = worst.max((a[axis] - b[axis]).abs());
            }
        }
    }
    worst
}

/// States of a gas. Mean free time at this density is about 0.9 d over the thermal speed 1.
fn gas(stiffness: f64) -> Vec<Scene> {
    let side = 21.9;
    let cell = format!(
        "cell: (lo: (0, 0, 0), hi: ({side}, {side}, {side}), periodic: (true, true, true)), seed: SEED,"
    );
    let bodies = format!(
        "Fill(material: \"a\", radius: 0.5, count: 1000, lo: (0, 0, 0), hi: ({side}, {side}, {side}), velocity_spread: 1.7320508)"
    );
    let laws = format!(
        "contact_end: Overlap, normal: LinearSpringDashpot(stiffness: {stiffness:?}, restitution: {RESTITUTION})"
    );
    let rule = format!("collision: HardSphere(restitution: {RESTITUTION})");
    (1..=4)
        .map(|seed| {
            let seeded = |text: String| text.replace("SEED", &seed.to_string());
            Scene {
                text: seeded(frame(&cell, &bodies, &laws, false)),
                hard: Some(seeded(frame(&cell, &bodies, &rule, true))),
                contact: contact(stiffness),
                duration: 0.5,
            }
        })
        .collect()
}

fn energy(runs: &[Run], exact: &[Run]) -> f64 {
    let energy = |state: &State| state.velocity.iter().flatten().map(|v| 0.5 * v * v).sum::<f64>();
    // The spread of a velocity component that is even between -√3 and √3 is 1.
    let start = 1.5 * 1000.0;
    let (mut error, mut lost) = (0.0, 0.0);
    for (run, exact) in runs.iter().flatten().zip(exact.iter().flatten()) {
        error += energy(run) - energy(exact);
        lost += start - energy(exact);
    }
    (error / lost).abs()
}

/// Four spheres and one on them above the pockets of nine frozen ones, each a little off its place.
fn pile(stiffness: f64) -> Vec<Scene> {
    const RESTITUTION: f64 = 0.5;
    let contact = contact_of(stiffness, RESTITUTION);
    // The same for every mass, as frozen bodies count as walls.
    let rate = -2.0 * RESTITUTION.ln() / contact;
    let laws = format!(
        "contact_end: Overlap, normal: LinearSpringDashpot(stiffness: {stiffness:?}, damping_rate: {rate:?}), \
         tangential: TangentialSpring(stiffness: {:?}, damping_rate: {:?}, friction: 0.5)",
        2.0 / 7.0 * stiffness,
        0.5 * rate
    );
    let cell =
        "gravity: (0, 0, -1), cell: (lo: (-4, -4, -4), hi: (4, 4, 6), periodic: (false, false, false)),";
    (0..8)
        .map(|state| {
            let mut bodies = String::new();
            // Writing to a string cannot fail.
            let mut sphere = |position: [f64; 3], frozen: bool| {
                let [x, y, z] = position;
                let frozen = if frozen { ", frozen: true" } else { "" };
                let _ = write!(
                    bodies,
                    "Sphere(material: \"a\", radius: 0.5, position: ({x:?}, {y:?}, {z:?}){frozen}), "
                );
            };
            for place in 0..9 {
                sphere([f64::from(place % 3) - 1.0, f64::from(place / 3) - 1.0, 0.0], true);
            }
            for body in 0..5 {
                let number = f64::from(5 * state + body + 1);
                let off = |ratio: f64| 0.04 * (number * ratio).fract() - 0.02;
                let (x, y, layer) = match body {
                    4 => (0.0, 0.0, 2.0),
                    _ => (1.1 * (f64::from(body % 2) - 0.5), 1.1 * (f64::from(body / 2) - 0.5), 1.0),
                };
                let height = layer * (0.5_f64.sqrt() + 0.1) + off(PLASTIC * PLASTIC);
                sphere([x + off(GOLDEN), y + off(PLASTIC), height], false);
            }
            Scene { text: frame(cell, &bodies, &laws, false), hard: None, contact, duration: 4.0 }
        })
        .collect()
}

fn settling(runs: &[Run], right: &[Run]) -> f64 {
    let kinetic = |state: &State| {
        let share = |rows: &[[f64; 3]], inertia: f64| {
            rows.iter().flatten().map(|v| 0.5 * inertia * v * v).sum::<f64>()
        };
        share(&state.velocity, 1.0) + share(&state.surface, 0.4)
    };
    let height = |state: &State| state.position.iter().map(|x| x[2]).sum::<f64>();
    // Mean time of the kinetic energy: a first passage below a threshold jumps where a late bounce just reaches it.
    let settled = |run: &Run| {
        let (mut sum, mut moment) = (0.0, 0.0);
        for (frame, state) in run.iter().enumerate() {
            sum += kinetic(state);
            moment += frame as f64 * kinetic(state);
        }
        moment / sum
    };
    let fallen =
        |run: &Run| run.first().zip(run.last()).map_or(0.0, |(first, last)| height(first) - height(last));
    let off = |value: &dyn Fn(&Run) -> f64| {
        let sum = |runs: &[Run]| runs.iter().map(value).sum::<f64>();
        (sum(runs) / sum(right) - 1.0).abs()
    };
    off(&settled).max(off(&fallen))
}
