//! Contracts across crates. This library holds what the tests share: from the text of a scene to bodies after a run.

pub mod pages;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use granule_drivers::{Driver, TimeStepDriver};
use granule_law_api::Registry;
use granule_laws as _;
use granule_plan::Plan;

/// State of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Centre \[m\].
    pub position: [f64; 3],
    /// Velocity \[m/s\].
    pub velocity: [f64; 3],
    /// Spin \[rad/s\].
    pub spin: [f64; 3],
    /// Force \[N\].
    pub force: [f64; 3],
    /// Torque \[N m\].
    pub torque: [f64; 3],
}

/// Plans a scene.
///
/// # Panics
/// The scene has errors; they are in the message.
pub fn plan(text: &str) -> Arc<Plan> {
    let parsed = granule_scene::parse(text);
    let registry = Registry::collect().expect("one registry");
    let mut diagnostics = parsed.diagnostics;
    let plan = parsed.scene.and_then(|scene| {
        let (plan, problems) = granule_plan::build(&scene, &registry, Path::new("."));
        diagnostics.extend(problems);
        plan
    });
    let problems: Vec<String> =
        diagnostics.iter().map(|diagnostic| diagnostic.render("scene.ron", text)).collect();
    match plan {
        Some(plan) => Arc::new(plan),
        None => panic!("{}", problems.join("\n")),
    }
}

/// A driver at the start of a scene, with a given number of threads.
pub fn driver_with(text: &str, threads: usize) -> TimeStepDriver {
    TimeStepDriver::new(plan(text), Some(threads)).expect("a plan that was built can be set up")
}

/// A single-threaded driver at the start of a scene.
pub fn driver(text: &str) -> TimeStepDriver {
    driver_with(text, 1)
}

/// Advances to a step.
pub fn advance(driver: &mut TimeStepDriver, step: u64) {
    driver.advance(step, &AtomicBool::new(false)).expect("the run stays finite");
}

/// All bodies, in the order of their identities.
pub fn bodies(driver: &TimeStepDriver) -> Vec<BodyState> {
    let view = driver.view();
    let rows = view.bodies();
    let state = |rank: usize| {
        let place = view.order()[rank] as usize;
        BodyState {
            position: rows.position[place].vector(),
            velocity: rows.velocity_of(place),
            spin: rows.spin_of(place),
            force: rows.force_of(place),
            torque: rows.torque_of(place),
        }
    };
    (0..rows.len()).map(state).collect()
}

/// Bodies at the end of a scene's run.
pub fn run(text: &str) -> Vec<BodyState> {
    let mut driver = driver(text);
    let steps = driver.engine().plan().driver.steps;
    advance(&mut driver, steps);
    bodies(&driver)
}

/// Largest overlap of all contacts at any step of the run \[m\], and the time between the first and the last step with a
/// contact \[s\].
pub fn overlap_and_duration(text: &str) -> (f64, f64) {
    let mut driver = driver(text);
    let plan = driver.engine().plan().clone();
    let (mut largest, mut touching) = (0.0_f64, 0_u64);
    for step in 1..=plan.driver.steps {
        advance(&mut driver, step);
        let tally = driver.engine().tally();
        largest = largest.max(tally.maximum_overlap);
        touching += u64::from(tally.contacts + tally.wall_contacts > 0);
    }
    (largest, touching as f64 * plan.driver.step)
}
