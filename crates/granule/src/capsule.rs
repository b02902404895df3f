//! The smallest scene in which a run fails in the same way.
//!
//! Bodies near those of the error are taken as they were some steps before; then as many as possible are left out while the
//! same still happens. What is written was run and fails. Hard bodies that are crushed are taken as they are then.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use granule_drivers::{Advance, AlarmKind, EngineError, View};
use granule_observers::Energy;
use granule_plan::{Allowance, Dimensions, Guard, Plan};
use granule_scene::{remove_field, set_field};

use crate::guards::{Lookout, bodies_of};
use crate::load::{Source, load_text_within};

/// Name of the scene in the output folder.
const NAME: &str = "crash.ron";
/// How many bodies around those of the error are tried, one after the other.
const SIZES: [usize; 6] = [2, 5, 16, 64, 256, 1024];
/// Most time that the search may take.
const PATIENCE: Duration = Duration::from_secs(20);
/// Runs of more bodies keep no moments.
const MOST_BODIES: usize = 1_000_000;

/// The bodies at one moment.
struct Moment {
    step: u64,
    /// In the order of identities: position, velocity, spin.
    bodies: Vec<[[f64; 3]; 3]>,
}

impl Moment {
    fn of(view: &View<'_>) -> Self {
        let bodies = view.bodies();
        let row = |place: &u32| {
            let place = *place as usize;
            [bodies.position[place].vector(), bodies.velocity_of(place), bodies.spin_of(place)]
        };
        Self { step: view.step(), bodies: view.order().iter().map(row).collect() }
    }
}

/// The last moments of a run, from which a failure may be reproduced.
#[derive(Default)]
pub(crate) struct Moments(Vec<Moment>);

impl Moments {
    /// Keeps a moment, and the one before.
    pub fn keep(&mut self, view: &View<'_>) {
        let bodies = view.bodies();
        if bodies.len() > MOST_BODIES || !is_still(view.plan()) {
            return;
        }
        if self.0.len() > 1 {
            self.0.remove(0);
        }
        self.0.push(Moment::of(view));
    }
}

/// True if walls and substrate are the same at any time, so that a run may begin at any moment.
fn is_still(plan: &Plan) -> bool {
    plan.walls.iter().all(|wall| wall.wall.keeps_its_place())
        && plan.substrate.as_ref().is_none_or(|substrate| substrate.motion.is_fixed())
}

/// How a run fails, whoever the bodies are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Failure {
    NotFinite,
    Law(&'static str),
    Panic(&'static str),
    Crushed,
    Limit(AlarmKind),
}

fn failure(error: &EngineError) -> Option<Failure> {
    match error {
        EngineError::NotFinite { .. } => Some(Failure::NotFinite),
        EngineError::LawNotFinite { law, .. } => Some(Failure::Law(law)),
        EngineError::LawPanicked { law, .. } => Some(Failure::Panic(law)),
        EngineError::Crushed { .. } => Some(Failure::Crushed),
        EngineError::Guard(alarm) => Some(Failure::Limit(alarm.kind)),
        _ => None,
    }
}

/// Writes the smallest scene found in which a run fails as it has. Its path and the number of its bodies; `None` if there is
/// none.
pub(crate) fn write(
    directory: &Path,
    source: &Source,
    plan: &Plan,
    moments: &Moments,
    error: &EngineError,
    view: &View<'_>,
) -> Option<(PathBuf, usize)> {
    let (over, found) = (AtomicBool::new(false), AtomicBool::new(false));
    let search = Search { source, plan, failure: failure(error)?, over: &over };
    let until = Instant::now() + PATIENCE;
    std::thread::scope(|scope| {
        let clock = scope.spawn(|| {
            while !found.load(Ordering::Relaxed) {
                match until.checked_duration_since(Instant::now()) {
                    Some(left) => std::thread::park_timeout(left),
                    None => return over.store(true, Ordering::Relaxed),
                }
            }
        });
        let capsule = quietly(|| write_within(directory, &search, moments, error, view));
        found.store(true, Ordering::Relaxed);
        clock.thread().unpark();
        capsule
    })
}

/// Says nothing of panics: a law that panics does so again and again while the scene is made smaller.
fn quietly<R>(work: impl FnOnce() -> R) -> R {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let done = work();
    std::panic::set_hook(hook);
    done
}

fn write_within(
    directory: &Path,
    search: &Search<'_>,
    moments: &Moments,
    error: &EngineError,
    view: &View<'_>,
) -> Option<(PathBuf, usize)> {
    let (plan, step) = (search.plan, view.step());
    let start = Moment {
        step: 0,
        bodies: (0..plan.bodies.len())
            .map(|k| [plan.bodies.position[k], plan.bodies.velocity[k], plan.bodies.spin[k]])
            .collect(),
    };
    let mut named = bodies_of(error);
    if let EngineError::LawPanicked { among, .. } = error {
        named.extend(among.first());
    }
    let named: Vec<usize> = named.iter().filter_map(|id| plan.bodies.id.binary_search(id).ok()).collect();
    // Soft bodies at fault are no longer where they can be put.
    let now = plan.event.is_some() && is_still(plan) && plan.bodies.len() <= MOST_BODIES;
    let now = now.then(|| Moment::of(view));
    for moment in now.iter().chain(moments.0.iter().rev()).chain([&start]) {
        // Twice as long as the run itself went on, and long enough for every guard to look.
        let steps = 2 * step.saturating_sub(moment.step) + 2048;
        let near = near(plan, moment, &named);
        let all = [near.len()];
        let sizes = SIZES.iter().filter(|size| **size < near.len()).chain(&all);
        for size in sizes {
            let mut chosen = near[..*size].to_vec();
            chosen.sort_unstable();
            if let Some(fails) = search.fails(moment, &chosen, steps) {
                let (chosen, fails) = search.shrink(moment, chosen, fails);
                let mut text = search.text(moment, &chosen, fails + 1)?;
                let title = format!(
                    "// {} bodies of {} as they were at step {}: {}\n",
                    chosen.len(),
                    search.source.path.display(),
                    moment.step,
                    error.to_string().replace('\n', " ")
                );
                text.insert_str(0, &title);
                let path = directory.join(NAME);
                granule_formats::atomic::write(&path, text.as_bytes()).ok()?;
                return Some((path, chosen.len()));
            }
            if search.over.load(Ordering::Relaxed) {
                return None;
            }
        }
    }
    None
}

/// All bodies, those of the error first, then by their distance from the nearest of them.
fn near(plan: &Plan, moment: &Moment, named: &[usize]) -> Vec<usize> {
    let distance = |k: usize| {
        named
            .iter()
            .map(|other| {
                let (a, b) = (moment.bodies[k][0], moment.bodies[*other][0]);
                let (d, _) = plan.cell.minimum_image([a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
                d.iter().map(|d| d * d).sum::<f64>()
            })
            .fold(f64::INFINITY, f64::min)
    };
    let mut order: Vec<(f64, usize)> = (0..moment.bodies.len()).map(|k| (distance(k), k)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    order.into_iter().map(|(_, k)| k).collect()
}

struct Search<'a> {
    source: &'a Source,
    plan: &'a Plan,
    failure: Failure,
    /// The time for it is over.
    over: &'a AtomicBool,
}

impl Search<'_> {
    /// The step at which a run of some bodies fails in the same way, if it does within `steps`.
    fn fails(&self, moment: &Moment, chosen: &[usize], steps: u64) -> Option<u64> {
        let text = self.text(moment, chosen, steps)?;
        let plan = Arc::new(load_text_within(&self.source.path, text, &Allowance::UNBOUNDED).ok()?.plan);
        let mut driver = granule_drivers::driver(Arc::clone(&plan), Some(1)).ok()?;
        let mut lookout = Lookout::new(&plan);
        let start = plan.ledger.then(|| Energy::of(&driver.view()));
        while driver.step() < steps {
            let until = lookout.next_due(driver.step()).min(steps);
            let advanced = driver.advance(until, self.over);
            let looked = match advanced {
                Ok(Advance::Reached) => lookout.look(&driver.view(), start.as_ref()).map(|_| ()),
                Ok(Advance::Stopped) => return None,
                Err(error) => Err(error),
            };
            if let Err(error) = looked {
                // A guard of the engine looks at the step that is being done.
                return (failure(&error) == Some(self.failure)).then(|| driver.step() + 1);
            }
        }
        None
    }

    /// Leaves out as many bodies as possible.
    fn shrink(&self, moment: &Moment, mut chosen: Vec<usize>, mut fails: u64) -> (Vec<usize>, u64) {
        let mut part = chosen.len().div_ceil(2);
        while part > 0 && chosen.len() > 1 {
            let mut begin = 0;
            let mut less = false;
            while begin < chosen.len() && chosen.len() > 1 {
                let end = (begin + part).min(chosen.len());
                let mut rest = chosen.clone();
                rest.drain(begin..end);
                let found = if rest.is_empty() { None } else { self.fails(moment, &rest, 2 * fails + 2048) };
                match found {
                    Some(step) => {
                        (chosen, fails) = (rest, step);
                        less = true;
                    }
                    None => begin = end,
                }
            }
            part = match (part, less) {
                (1, false) => 0,
                (1, true) => 1,
                _ => part.div_ceil(2),
            };
        }
        (chosen, fails)
    }

    /// The scene with some of its bodies as they were at a moment.
    fn text(&self, moment: &Moment, chosen: &[usize], steps: u64) -> Option<String> {
        let plan = self.plan;
        let table = &plan.bodies;
        let mut bodies = String::from("[\n");
        for k in chosen {
            let [position, velocity, spin] = moment.bodies[*k];
            let numbers =
                [position, velocity, spin, [table.radius[*k], table.mass[*k], table.inertia_factor[*k]]];
            if numbers.as_flattened().iter().any(|number| !number.is_finite()) {
                return None;
            }
            let planar = plan.dimensions == Dimensions::Two;
            let vector = |v: [f64; 3]| match planar {
                true => format!("({:e}, {:e})", v[0], v[1]),
                false => format!("({:e}, {:e}, {:e})", v[0], v[1], v[2]),
            };
            let spin = if planar { format!("{:e}", spin[2]) } else { vector(spin) };
            let material = &plan.materials[usize::from(table.material[*k])].name;
            // Writing to a string cannot fail.
            let _ = writeln!(
                bodies,
                "        Body(id: {}, material: {material:?}, radius: {:e}, mass: {:e}, inertia_factor: {:e},\n            \
                 position: {}, velocity: {}, spin: {spin}{}),",
                table.id[*k],
                table.radius[*k],
                table.mass[*k],
                table.inertia_factor[*k],
                vector(position),
                vector(velocity),
                if table.frozen[*k] { ", frozen: true" } else { "" }
            );
        }
        bodies.push_str("    ]");
        let guard = |guard: Guard| match guard {
            Guard::Off => "Off".to_string(),
            Guard::Warn(limit) => format!("Warn({limit:e})"),
            Guard::Stop(limit) => format!("Stop({limit:e})"),
        };
        let g = plan.guards;
        let mut guards = vec![("lost", g.lost), ("energy", g.energy)];
        if plan.event.is_none() {
            guards.extend([("overlap", g.overlap), ("travel", g.travel)]);
        }
        let guards: Vec<String> =
            guards.into_iter().map(|(name, choice)| format!("{name}: {}", guard(choice))).collect();
        let text = ["accuracy", "budget", "checkpoint", "outputs"]
            .into_iter()
            .try_fold(self.source.text.clone(), |text, field| remove_field(&text, field))
            .ok()?;
        let step = format!("{:e}", plan.driver.step);
        let mut changes = vec![
            (None, "bodies", bodies),
            (None, "run", format!("(steps: {steps})")),
            (None, "guards", format!("({})", guards.join(", "))),
        ];
        match &plan.event {
            None => changes.extend([
                (None, "allow_overlap", "true".to_string()),
                (Some(("driver", "TimeStep")), "step", step),
            ]),
            Some(event) => {
                let driver = Some(("driver", "Event"));
                changes.push((driver, "step", step));
                if event.contact_duration > 0.0 {
                    changes.push((driver, "contact_duration", format!("{:e}", event.contact_duration)));
                }
            }
        }
        changes
            .into_iter()
            .try_fold(text, |text, (block, field, value)| set_field(&text, block, field, &value))
            .ok()
    }
}
