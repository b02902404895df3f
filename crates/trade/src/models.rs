//! One scene of bodies on a substrate in the ways in which it can be run: what each costs, and how far they are apart.

mod compare;
mod ways;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use granule_drivers::{Advance, Driver, driver};
use granule_law_api::Registry;
use granule_observers::quantities;
use granule_plan::Plan;
use granule_scene::{Scene, Severity};

pub use self::compare::{Compared, Difference, ModelComparison, models_json};
use crate::TradeError;
use crate::measure::is_random;
use crate::study::Watch;

/// Up to this many bodies, paths are compared; beyond it, means over runs.
const FEW: usize = 16;
/// Looks at a run; means are over the last half of them.
const LOOKS: u64 = 100;
/// Shortest wall-clock time that is measured: shorter runs are repeated.
const MEASURABLE: Duration = Duration::from_millis(20);
/// Velocities of another realisation of a scene without random parts differ by this share.
const NUDGE: f64 = 1e-2;
/// The golden ratio, whose multiples cover an interval evenly, however many there are.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A way to run bodies on a substrate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// Time steps with three-dimensional contacts between the bodies and a plane wall.
    Contact,
    /// Time steps on the substrate.
    Substrate,
    /// Hard bodies along arcs.
    Arcs,
    /// Hard bodies with the effective restitution of Kondic 1999, Eq. (68).
    EffectiveRestitution,
}

impl Model {
    /// All of them, the most detailed first.
    pub const ALL: [Self; 4] = [Self::Contact, Self::Substrate, Self::Arcs, Self::EffectiveRestitution];

    /// Short name, as in the JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Contact => "contact",
            Self::Substrate => "substrate",
            Self::Arcs => "arcs",
            Self::EffectiveRestitution => "effective-restitution",
        }
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Contact => "contacts with a plane, in time steps",
            Self::Substrate => "substrate, in time steps",
            Self::Arcs => "hard bodies along arcs",
            Self::EffectiveRestitution => "hard bodies, effective restitution",
        }
    }
}

/// What a user may choose.
#[derive(Clone, Copy, Debug)]
pub struct ModelOptions {
    /// Runs of each model of more than 16 bodies, at least 2.
    pub realisations: u64,
    /// Simulated time of each run \[s\]; that of the scene if absent.
    pub duration: Option<f64>,
}

/// What one run shows.
#[derive(Clone, Debug)]
pub(crate) struct Sample {
    /// Components of each quantity.
    values: Vec<Vec<f64>>,
    /// Wall-clock time for a simulated second.
    cost: f64,
}

/// Runs the scene in every way that it can be run. `folder` is where the scene lies, for the files that it imports.
///
/// # Errors
/// See [`TradeError`]; [`TradeError::Nothing`] for a scene without a substrate.
pub fn compare_models(
    text: &str,
    folder: &Path,
    registry: &Registry,
    options: &ModelOptions,
    watch: &mut dyn Watch,
    stop: &AtomicBool,
) -> Result<ModelComparison, TradeError> {
    let parsed = granule_scene::parse(text);
    let Some(scene) = parsed.scene else { return Err(TradeError::Scene(parsed.diagnostics)) };
    let (plan, mut diagnostics) = granule_plan::build(&scene, registry, folder);
    diagnostics.extend(parsed.diagnostics);
    diagnostics.retain(|diagnostic| diagnostic.severity == Severity::Error);
    let Some(plan) = plan.filter(|_| diagnostics.is_empty()) else {
        return Err(TradeError::Scene(diagnostics));
    };
    if plan.substrate.is_none() || plan.bodies.is_empty() {
        return Err(TradeError::Nothing("the scene has no bodies on a `substrate`".into()));
    }
    let duration = options.duration.unwrap_or(plan.driver.steps as f64 * plan.driver.step);
    if !(duration > 0.0 && duration.is_finite()) {
        return Err(TradeError::Nothing("the run has no duration".into()));
    }
    let few = plan.bodies.len() <= FEW;
    let realisations = if few { 1 } else { options.realisations.max(2) };
    let ways = ways::Ways { scene: &scene, registry, folder, duration, looks: LOOKS };
    let mut left_out = Vec::new();
    let mut able = Vec::new();
    for model in Model::ALL {
        match ways.scene_of(model).and_then(|way| realisation(&way.scene, registry, folder, 0).map(|_| way)) {
            Ok(way) => able.push((model, way)),
            Err(reason) => left_out.push((model, reason)),
        }
    }
    let all = able.len() * realisations as usize;
    let mut samples = Vec::new();
    for (number, (model, way)) in able.into_iter().enumerate() {
        let mut tell = |index: u64| {
            watch.progress(number * realisations as usize + index as usize, all, model.words());
        };
        let of_model: Result<Vec<Sample>, Option<String>> = (0..realisations)
            .map(|index| {
                tell(index);
                let plan = realisation(&way.scene, registry, folder, index).map_err(Some)?;
                run(&Arc::new(plan), few, stop)
            })
            .collect();
        match of_model {
            Ok(of_model) => samples.push((model, way.notes, of_model)),
            Err(Some(reason)) => left_out.push((model, format!("a run failed: {reason}"))),
            Err(None) => return Err(TradeError::Stopped),
        }
    }
    let names: &[(&str, &str)] = if few {
        &[("displacements", "m"), ("velocities", "m/s"), ("spins", "rad/s")]
    } else {
        &[("kinetic_energy", "J"), ("rotational_energy", "J"), ("root-mean-square displacement", "m")]
    };
    Ok(compare::compare(
        ModelComparison {
            title: scene.title.clone(),
            bodies: plan.bodies.len(),
            duration,
            realisations,
            paths: few,
            quantities: names.to_vec(),
            reference: samples.first().map(|(model, ..)| *model),
            models: Vec::new(),
            left_out,
        },
        &samples,
    ))
}

/// The plan of one realisation: another seed where the scene has random parts, else velocities that differ a little.
fn realisation(scene: &Scene, registry: &Registry, folder: &Path, index: u64) -> Result<Plan, String> {
    let mut scene = scene.clone();
    let random = is_random(&scene);
    if random {
        scene.seed = scene.seed.wrapping_add(index);
    }
    let (plan, diagnostics) = granule_plan::build(&scene, registry, folder);
    let mut plan = plan.ok_or_else(|| {
        let errors = diagnostics.iter().filter(|problem| problem.severity == Severity::Error);
        errors.map(|problem| problem.message.clone()).collect::<Vec<_>>().join("; ")
    })?;
    if index > 0 && !random {
        let size = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
        let fastest = plan.bodies.velocity.iter().map(size).fold(0.0, f64::max);
        let falls =
            size(&plan.gravity) * plan.bodies.radius.iter().fold(0.0, |r: f64, radius| r.max(*radius));
        let speed = NUDGE * fastest.max(falls.sqrt());
        for (body, velocity) in plan.bodies.velocity.iter_mut().enumerate() {
            if !plan.bodies.frozen[body] {
                let turn = std::f64::consts::TAU * ((body as f64 + 0.1) * index as f64 * GOLDEN).fract();
                velocity[0] += speed * turn.cos();
                velocity[1] += speed * turn.sin();
            }
        }
    }
    Ok(plan)
}

/// One run; the fastest of several if it is short. `Err(None)` if it was stopped.
fn run(plan: &Arc<Plan>, few: bool, stop: &AtomicBool) -> Result<Sample, Option<String>> {
    let begin = Instant::now();
    let mut best: Option<Sample> = None;
    loop {
        let failed = |error: granule_drivers::EngineError| Some(error.to_string());
        let mut driver = driver(plan.clone(), Some(1)).map_err(failed)?;
        let sample = follow(plan, &mut *driver, few, stop)?;
        let best_now = match best {
            Some(best) if best.cost <= sample.cost => best,
            _ => sample,
        };
        if begin.elapsed() >= MEASURABLE {
            return Ok(best_now);
        }
        best = Some(best_now);
    }
}

fn follow(
    plan: &Plan,
    driver: &mut dyn Driver,
    few: bool,
    stop: &AtomicBool,
) -> Result<Sample, Option<String>> {
    let places = |driver: &dyn Driver| -> Vec<[f64; 3]> {
        let view = driver.view();
        let (rows, period) = (view.bodies(), plan.cell.period());
        view.order()
            .iter()
            .map(|place| {
                let place = *place as usize;
                let (at, image) = (rows.position[place].vector(), rows.image[place]);
                std::array::from_fn(|k| at[k] + f64::from(image[k]) * period[k])
            })
            .collect()
    };
    let start = places(driver);
    let steps = plan.driver.steps;
    let (mut kinetic, mut rotational) = (Vec::new(), Vec::new());
    let mut wall = Duration::ZERO;
    for look in 1..=LOOKS {
        let begin = Instant::now();
        match driver.advance(steps * look / LOOKS, stop) {
            Ok(Advance::Reached) => {}
            Ok(Advance::Stopped) => return Err(None),
            Err(error) => return Err(Some(error.to_string())),
        }
        wall += begin.elapsed();
        if !few && 2 * look > LOOKS {
            kinetic.push(quantities::kinetic_energy(&driver.view()));
            rotational.push(quantities::rotational_energy(&driver.view()));
        }
    }
    let moved: Vec<[f64; 3]> = places(driver)
        .iter()
        .zip(&start)
        .map(|(there, here)| [there[0] - here[0], there[1] - here[1], 0.0])
        .collect();
    let values = if few {
        let view = driver.view();
        let each = |of: &dyn Fn(usize) -> [f64; 3], axes: &[usize]| -> Vec<f64> {
            let bodies = view.order().iter().map(|place| of(*place as usize));
            bodies.flat_map(|v| axes.iter().map(move |axis| v[*axis]).collect::<Vec<_>>()).collect()
        };
        vec![
            moved.iter().flat_map(|d| [d[0], d[1]]).collect(),
            each(&|place| view.bodies().velocity_of(place), &[0, 1]),
            each(&|place| view.bodies().spin_of(place), &[0, 1, 2]),
        ]
    } else {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let squared = moved.iter().map(|d| d[0] * d[0] + d[1] * d[1]).sum::<f64>() / moved.len() as f64;
        vec![vec![mean(&kinetic)], vec![mean(&rotational)], vec![squared.sqrt()]]
    };
    let simulated = steps as f64 * plan.driver.step;
    Ok(Sample { values, cost: wall.as_secs_f64() / simulated })
}
