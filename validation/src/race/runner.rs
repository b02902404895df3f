//! Who takes part, and how a scene is run.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use granule_drivers::{View, driver};

use super::contests::{Contest, Right, Scene};
use crate::ours::SceneFile;
use crate::peers::{self, Engine, Quantity, RunOptions, inputs};
use crate::translate::{Target, translate};

/// Runs that are timed; the fastest counts, as what else the machine does only adds.
const TIMED: usize = 3;

/// Bodies in the order of their identities.
#[derive(Clone, Debug)]
pub struct State {
    pub position: Vec<[f64; 3]>,
    pub velocity: Vec<[f64; 3]>,
    /// Spins times radius.
    pub surface: Vec<[f64; 3]>,
}

/// The states of a run that are looked at.
pub type Run = Vec<State>;

/// An engine with a scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Racer {
    /// Ours with an integrator.
    Ours(&'static str),
    /// Ours with hard bodies.
    Hard,
    /// A peer.
    Peer(Target),
}

/// Those that can take part: peers only where they are installed.
pub fn racers(contest: &Contest) -> Vec<Racer> {
    let mut racers = vec![Racer::Ours("VelocityVerlet"), Racer::Ours("ContactResolved")];
    let scenes = (contest.scenes)(contest.stiffnesses[0]);
    let soft = matches!(contest.right, Right::OwnLimit(_));
    if !soft && scenes.iter().all(|scene| scene.hard.is_some()) {
        racers.push(Racer::Hard);
    }
    for (target, engine) in [(Target::LammpsClassic, Engine::Lammps), (Target::Liggghts, Engine::Liggghts)] {
        if peers::find_binary(engine).is_some() {
            racers.push(Racer::Peer(target));
        } else {
            println!("  {} is not installed: not compared", engine.name());
        }
    }
    racers
}

/// A finished run.
pub struct Done {
    pub run: Run,
    /// Time of the steps \[s\].
    pub seconds: f64,
    pub version: String,
}

/// Radius of all spheres of all contests.
const RADIUS: f64 = 0.5;

impl Racer {
    pub fn name(self) -> &'static str {
        match self {
            Self::Ours(integrator) => integrator,
            Self::Hard => "Event",
            Self::Peer(target) => target.name(),
        }
    }

    pub fn is_hard(self) -> bool {
        self == Self::Hard
    }

    /// What the run of a scene is held against.
    pub fn right(self, scene: &Scene, contest: &Contest) -> Result<Run, String> {
        match contest.right {
            Right::Exact(exact) => Ok(exact()),
            Right::OwnLimit(steps) => Ok(self.run(scene, steps, contest.frames)?.run),
            Right::Hard => Ok(Self::Hard.run(scene, 0.0, contest.frames)?.run),
        }
    }

    /// Runs a scene with so many steps in a contact, or a few more so that they are a multiple of `frames`.
    pub fn run(self, scene: &Scene, steps_per_contact: f64, frames: u64) -> Result<Done, String> {
        let every = (scene.duration / scene.contact * steps_per_contact / frames as f64).ceil();
        let steps = every * frames as f64;
        let text = match (self, &scene.hard) {
            (Self::Hard, Some(hard)) => {
                let step = scene.duration / frames as f64;
                hard.replace("STEPS", &frames.to_string()).replace("STEP", &format!("{step:?}"))
            }
            _ => {
                let integrator = match self {
                    Self::Ours(name) => format!("integrator: {name},"),
                    _ => String::new(),
                };
                scene
                    .text
                    .replace("STEPS", &format!("{steps}"))
                    .replace("STEP", &format!("{:?}", scene.duration / steps))
                    .replace("INTEGRATOR", &integrator)
            }
        };
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        let path = folder.path().join("scene.ron");
        std::fs::write(&path, text).map_err(|error| error.to_string())?;
        let scene = SceneFile::read(&path)?;
        match self {
            Self::Peer(target) => peer(&scene, target, steps as u64, every as u64),
            Self::Ours(_) | Self::Hard => ours(&scene, frames),
        }
    }
}

fn ours(scene: &SceneFile, frames: u64) -> Result<Done, String> {
    let plan = scene.plan()?;
    let steps = plan.driver.steps;
    let never = AtomicBool::new(false);
    let start = || driver(plan.clone(), Some(1)).map_err(|error| error.to_string());
    let mut fastest = f64::INFINITY;
    for _ in 0..TIMED {
        let mut driver = start()?;
        // Lists are made in the first step, and by the peers before their first one.
        if plan.event.is_none() {
            driver.advance(1, &never).map_err(|error| error.to_string())?;
        }
        let clock = Instant::now();
        driver.advance(steps, &never).map_err(|error| error.to_string())?;
        fastest = fastest.min(clock.elapsed().as_secs_f64());
    }
    let mut driver = start()?;
    let mut run = Vec::new();
    for frame in 1..=frames {
        driver.advance(steps / frames * frame, &never).map_err(|error| error.to_string())?;
        run.push(state(&driver.view(), plan.rotation));
    }
    Ok(Done { run, seconds: fastest, version: format!("granule {}", env!("CARGO_PKG_VERSION")) })
}

fn state(view: &View<'_>, rotation: bool) -> State {
    let bodies = view.bodies();
    let places = || view.order().iter().map(|place| *place as usize);
    let surface = |place| if rotation { bodies.spin_of(place).map(|spin| RADIUS * spin) } else { [0.0; 3] };
    State {
        position: places().map(|place| bodies.position[place].vector()).collect(),
        velocity: places().map(|place| bodies.velocity_of(place)).collect(),
        surface: places().map(surface).collect(),
    }
}

/// One run for the answer, which is dumped, and some for the time, which dump nothing.
fn peer(scene: &SceneFile, target: Target, steps: u64, every: u64) -> Result<Done, String> {
    let plan = scene.plan_under(target.preset(), &[])?;
    let rotation = plan.rotation;
    let mut told = translate(&plan, target).map_err(|error| error.to_string())?;
    let options = RunOptions { ranks: 1, timeout: std::time::Duration::from_secs(1800) };
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    told.dump_every = every;
    told.quantities = vec![Quantity::Position, Quantity::Velocity, Quantity::AngularVelocity];
    let answer = peers::run(&told, folder.path(), &options).map_err(|error| error.to_string())?;
    told.dump_every = 0;
    let files = inputs(&told).map_err(|error| error.to_string())?;
    files.write(folder.path()).map_err(|error| error.to_string())?;
    let mut fastest = f64::INFINITY;
    let mut version = String::new();
    for _ in 0..TIMED {
        let timed = peers::time(&files, folder.path(), &options).map_err(|error| error.to_string())?;
        fastest = fastest.min(timed.loop_seconds);
        version = timed.version;
    }
    let surface = |spin: &[f64; 3]| if rotation { spin.map(|spin| RADIUS * spin) } else { [0.0; 3] };
    let run: Run = answer
        .frames
        .iter()
        .filter(|frame| frame.step > 0)
        .map(|frame| State {
            position: frame.position.clone(),
            velocity: frame.velocity.clone(),
            surface: frame.angular_velocity.iter().map(surface).collect(),
        })
        .collect();
    if run.len() as u64 != steps / every {
        return Err(format!("{} left {} states instead of {}", target.name(), run.len(), steps / every));
    }
    Ok(Done { run, seconds: fastest, version })
}
