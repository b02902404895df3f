//! Runs a plan and writes its outputs.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use granule_drivers::{Advance, Alarm, Counts, Driver, EngineError, View};
use granule_formats::Provenance;
use granule_observers::{Energy, MANIFEST, ObserveError, Observers};
use granule_plan::Plan;
use granule_trade::{Choice, Meter, Realised};

use crate::capsule::{self, Moments};
use crate::checkpoint::{KeepError, Keeper};
use crate::directory::{self, DirectoryError, default_directory};
use crate::drift::EnergyDrift;
use crate::guards::{self, Lookout};
use crate::load::{LoadError, Loaded, Source, load};
use crate::progress::{Outlook, Progress, Status};
use crate::record::{Record, Recorder};

/// Version of this program, as outputs carry it.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Wall-clock time between two reports of progress.
const REPORT: Duration = Duration::from_millis(200);

/// How a run is done. None of this changes its results.
pub struct RunOptions<'a> {
    /// Folder of the outputs; [`default_directory`] if absent.
    pub output_dir: Option<PathBuf>,
    /// Worker threads; what the scene says if absent.
    pub threads: Option<usize>,
    /// Replaces outputs of another plan.
    pub force: bool,
    /// Who is told how far the run is.
    pub progress: &'a mut dyn Progress,
    /// Set it, from any thread, to end the run early.
    pub stop: &'a AtomicBool,
    /// Ends the run when it has taken so long.
    pub max_time: Option<Duration>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// At its last step.
    Completed,
    /// Earlier, because it was asked to stop.
    Stopped,
    /// Earlier, because it took as long as it may.
    OutOfTime,
}

/// What a run has done.
#[derive(Clone, Debug)]
pub struct RunSummary {
    /// How it ended.
    pub ending: Ending,
    /// Steps done, with those before an interruption.
    pub steps: u64,
    /// Steps of the whole run.
    pub planned: u64,
    /// Simulated time \[s\].
    pub time: f64,
    /// Wall-clock time of the steps and outputs.
    pub wall: Duration,
    /// The part of `wall` that outputs took.
    pub output_wall: Duration,
    /// Bodies times steps over `wall` \[1/s\].
    pub particle_steps_per_second: f64,
    /// Collisions of the event-driven driver.
    pub events: Option<Counts>,
    /// How well the energy ledger closes, if it exists.
    pub energy_drift: Option<EnergyDrift>,
    /// Hash of the last positions, velocities and spins: equal hashes mean equal bits.
    pub result_hash: String,
    /// Folder of the outputs.
    pub directory: PathBuf,
    /// The files that were written, the manifest last.
    pub outputs: Vec<PathBuf>,
    /// The checkpoint from which a run that has ended early can be continued; `None` where there is none.
    pub checkpoint: Option<PathBuf>,
}

/// What is known of a failure of the physics.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Aftermath {
    /// Where the bodies are that it speaks of, what they touch, the likely cause, and a remedy: further lines of the message,
    /// or nothing.
    pub about: String,
    /// The smallest scene found in which the same happens.
    pub capsule: Option<PathBuf>,
}

/// Why a run failed.
#[derive(Debug)]
pub enum RunError {
    /// The scene cannot be loaded.
    Load(LoadError),
    /// The output folder cannot be used.
    Directory(DirectoryError),
    /// The physics cannot go on. What was written until then is whole.
    Engine {
        /// Why.
        error: EngineError,
        /// What else is known of it.
        aftermath: Box<Aftermath>,
        /// Folder of the outputs.
        directory: Box<Path>,
    },
    /// An output cannot be written.
    Output(ObserveError),
    /// The manifest cannot be written.
    Manifest(String),
    /// A checkpoint cannot be written. Earlier ones are as they were.
    Checkpoint(String),
}

impl std::fmt::Display for RunError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Load(error) => error.fmt(f),
            Self::Directory(error) => error.fmt(f),
            Self::Engine { error, aftermath, .. } => write!(f, "{error}{}", aftermath.about),
            Self::Output(error) => error.fmt(f),
            Self::Manifest(reason) => write!(f, "the manifest cannot be written: {reason}"),
            Self::Checkpoint(reason) => write!(f, "no checkpoint can be written: {reason}"),
        }
    }
}

impl std::error::Error for RunError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Load(error) => Some(error),
            Self::Directory(error) => Some(error),
            Self::Engine { error, .. } => Some(error),
            Self::Output(error) => Some(error),
            Self::Manifest(_) | Self::Checkpoint(_) => None,
        }
    }
}

impl From<ObserveError> for RunError {
    fn from(error: ObserveError) -> Self {
        Self::Output(error)
    }
}

/// Loads a scene and runs it.
///
/// # Errors
/// See [`RunError`].
pub fn run(path: impl AsRef<Path>, options: RunOptions<'_>) -> Result<RunSummary, RunError> {
    let Loaded { source, plan, .. } = load(path).map_err(RunError::Load)?;
    let directory = options.output_dir.clone().unwrap_or_else(|| default_directory(&source.path));
    run_plan(plan, Some(&source), &directory, options)
}

/// Runs a plan with all its outputs. `source` enters the manifest.
///
/// # Errors
/// See [`RunError`].
pub fn run_plan(
    plan: Plan,
    source: Option<&Source>,
    directory: &Path,
    options: RunOptions<'_>,
) -> Result<RunSummary, RunError> {
    Ok(run_measured(plan, None, source, directory, options)?.0)
}

/// Runs the plan of a scene that asked for an accuracy or a time, and tells how far it was from the reference of its table; `None`
/// if it has none, or the run ended early.
///
/// # Errors
/// See [`RunError`].
pub fn run_choice(
    plan: Plan,
    choice: &Choice,
    source: &Source,
    directory: &Path,
    options: RunOptions<'_>,
) -> Result<(RunSummary, Option<Realised>), RunError> {
    let meter = choice.meter(&plan);
    let (summary, meter) = run_measured(plan, meter, Some(source), directory, options)?;
    Ok((summary, meter.and_then(|meter| choice.realised(meter))))
}

fn run_measured(
    plan: Plan,
    meter: Option<Meter>,
    source: Option<&Source>,
    directory: &Path,
    options: RunOptions<'_>,
) -> Result<(RunSummary, Option<Meter>), RunError> {
    let created = created();
    let provenance = Provenance::new(VERSION, &plan.fingerprint, created).map_err(RunError::Manifest)?;
    let observers = Observers::from_plan(&plan, directory, &provenance)?;
    let lock = directory::prepare(directory, &plan, options.force).map_err(RunError::Directory)?;
    let plan = Arc::new(plan);
    let engine = |error| RunError::Engine { error, aftermath: Box::default(), directory: directory.into() };
    let driver = granule_drivers::driver(Arc::clone(&plan), options.threads).map_err(engine)?;
    let mut run = Run::new(plan, driver, observers, source, directory, created, lock);
    run.meter = meter;
    let summary = run.begin(options.progress, options.stop, options.max_time)?;
    Ok((summary, run.meter))
}

/// The moment that outputs carry: now, or that of `SOURCE_DATE_EPOCH`, with which two runs write the same files to the last
/// byte.
fn created() -> u64 {
    let given = std::env::var("SOURCE_DATE_EPOCH").ok().and_then(|text| text.trim().parse().ok());
    given.unwrap_or_else(|| SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs()))
}

/// What ends a run early.
struct Limits<'a> {
    stop: &'a AtomicBool,
    max_time: Option<Duration>,
}

/// A run under way.
pub(crate) struct Run {
    plan: Arc<Plan>,
    bodies: usize,
    driver: Box<dyn Driver>,
    observers: Observers,
    recorder: Recorder,
    keeper: Option<Keeper>,
    lookout: Lookout,
    meter: Option<Meter>,
    moments: Moments,
    source: Option<Source>,
    start_energy: Option<Energy>,
    directory: PathBuf,
    /// The last checkpoint that was written.
    kept: Option<PathBuf>,
    /// Step at which this part of the run begins.
    first: u64,
    output_time: Duration,
    output_calls: u64,
    begin: Instant,
    /// Nobody else writes into the folder.
    _lock: directory::Lock,
}

impl Run {
    pub(crate) fn new(
        plan: Arc<Plan>,
        driver: Box<dyn Driver>,
        observers: Observers,
        source: Option<&Source>,
        directory: &Path,
        created: u64,
        lock: directory::Lock,
    ) -> Self {
        // Without its scene, a run cannot be planned again.
        let keeper = plan
            .checkpoint
            .zip(source)
            .map(|(plan_of, source)| Keeper::new(plan_of, directory, source, &plan.fingerprint, created));
        Self {
            bodies: plan.bodies.len(),
            recorder: Recorder::new(&plan, source, directory, SystemTime::now()),
            keeper,
            lookout: Lookout::new(&plan),
            meter: None,
            moments: Moments::default(),
            source: source.cloned(),
            start_energy: None,
            directory: directory.to_path_buf(),
            kept: None,
            first: driver.step(),
            plan,
            driver,
            observers,
            output_time: Duration::ZERO,
            output_calls: 0,
            begin: Instant::now(),
            _lock: lock,
        }
    }

    /// Runs from the start.
    pub(crate) fn begin(
        &mut self,
        progress: &mut dyn Progress,
        stop: &AtomicBool,
        max_time: Option<Duration>,
    ) -> Result<RunSummary, RunError> {
        let energy = self.plan.ledger.then(|| Energy::of(&self.driver.view()));
        self.go(energy, true, progress, &Limits { stop, max_time })
    }

    /// Goes on from where driver and observers are.
    pub(crate) fn go_on(
        &mut self,
        start_energy: Option<Energy>,
        progress: &mut dyn Progress,
        stop: &AtomicBool,
        max_time: Option<Duration>,
    ) -> Result<RunSummary, RunError> {
        self.go(start_energy, false, progress, &Limits { stop, max_time })
    }

    fn go(
        &mut self,
        start_energy: Option<Energy>,
        fresh: bool,
        progress: &mut dyn Progress,
        limits: &Limits<'_>,
    ) -> Result<RunSummary, RunError> {
        self.record("running", None)?;
        if let Some(keeper) = &mut self.keeper {
            keeper.start(start_energy, (!fresh).then_some(self.first));
        }
        self.start_energy = start_energy;
        let directory = self.directory.clone();
        let steps = self.plan.driver.steps;
        progress.begin(&Outlook {
            title: &self.plan.title,
            bodies: self.bodies,
            steps,
            duration: steps as f64 * self.plan.driver.step,
            threads: self.driver.threads(),
            directory: &directory,
        });
        self.begin = Instant::now();
        let result = self.steps(fresh, progress, limits);
        progress.end(&self.status());
        let ending = match result {
            Ok(ending) => ending,
            Err(error) => {
                // The first error is the one to tell; what was written is completed as far as it goes.
                let _ = self.observers.close();
                let _ = self.record(&format!("failed: {error}"), None);
                return Err(match error {
                    Failure::Engine(error) => {
                        let mut about = guards::about(&error, &self.driver.view());
                        let capsule = self.capsule(&error);
                        if let Some((path, bodies)) = &capsule {
                            let plural = if *bodies == 1 { "body" } else { "bodies" };
                            about.push_str(&format!(
                                "\n  the same happens in a scene of {bodies} {plural}: {}",
                                path.display()
                            ));
                        }
                        {
                            let capsule = capsule.map(|(path, _)| path);
                            let aftermath = Box::new(Aftermath { about, capsule });
                            RunError::Engine { error, aftermath, directory: directory.into() }
                        }
                    }
                    Failure::Observe(error) => RunError::Output(error),
                    Failure::Keep(error) => error.into(),
                });
            }
        };
        let wall = self.begin.elapsed();
        let view = self.driver.view();
        let energy_drift = start_energy.map(|start| EnergyDrift::between(&start, &Energy::of(&view)));
        let events = view.events().copied();
        let result_hash = format!("{:016x}", self.driver.result_hash());
        let outcome = match ending {
            Ending::Completed => "completed",
            Ending::Stopped => "stopped by the user",
            Ending::OutOfTime => "stopped when its time was over",
        };
        self.record(outcome, Some(result_hash.clone()))?;
        if let (Ending::Completed, Some(keeper)) = (ending, &self.keeper) {
            keeper.clear();
        }
        let checkpoint = if ending == Ending::Completed { None } else { self.kept.clone() };
        let mut outputs: Vec<PathBuf> = self.observers.files().map(|(path, _)| path.to_path_buf()).collect();
        outputs.push(directory.join(MANIFEST));
        Ok(RunSummary {
            ending,
            steps: self.driver.step(),
            planned: steps,
            time: self.driver.time(),
            wall,
            output_wall: self.output_time,
            particle_steps_per_second: self.rate(wall),
            events,
            energy_drift,
            result_hash,
            directory,
            outputs,
            checkpoint,
        })
    }

    fn steps(
        &mut self,
        fresh: bool,
        progress: &mut dyn Progress,
        limits: &Limits<'_>,
    ) -> Result<Ending, Failure> {
        let steps = self.plan.driver.steps;
        if fresh {
            if let Some(meter) = &mut self.meter {
                meter.begin(&self.driver.view());
            }
            self.observe(Observers::start)?;
        } else {
            self.moments.keep(&self.driver.view());
        }
        // Steps between two reports: doubled and halved until they take about as long as `REPORT`.
        let mut stride: u64 = 1;
        while self.driver.step() < steps {
            let step = self.driver.step();
            let due = self.observers.next_due(step).unwrap_or(u64::MAX);
            let keep = self.keeper.as_ref().map_or(u64::MAX, |keeper| keeper.next_due(step));
            let report = step.saturating_add(stride);
            let meter = self.meter.as_ref().and_then(Meter::next_due).unwrap_or(u64::MAX);
            let until = steps.min(due).min(report).min(keep).min(meter).min(self.lookout.next_due(step));
            let before = Instant::now();
            let advance = self.driver.advance(until, limits.stop)?;
            let spent = before.elapsed();
            if spent < REPORT / 2 && until == report {
                stride = stride.saturating_mul(2);
            } else if spent > REPORT {
                stride = (stride / 2).max(1);
            }
            for alarm in self.driver.alarms() {
                warn(progress, &alarm, &self.driver.view());
            }
            if advance == Advance::Stopped {
                return self.end_early(Ending::Stopped);
            }
            if until == due {
                self.observe(Observers::observe)?;
            }
            if until == meter
                && let Some(meter) = &mut self.meter
            {
                meter.look(&self.driver.view());
            }
            self.look(progress)?;
            progress.advance(&self.status());
            let over = limits.max_time.is_some_and(|most| self.begin.elapsed() >= most);
            let step = self.driver.step();
            if over && step < steps {
                return self.end_early(Ending::OutOfTime);
            }
            if step < steps && self.keeper.as_ref().is_some_and(|keeper| keeper.is_due(step)) {
                self.keep()?;
            }
        }
        self.observe(Observers::finish)?;
        Ok(Ending::Completed)
    }

    /// Looks for what the engine does not watch.
    fn look(&mut self, progress: &mut dyn Progress) -> Result<(), Failure> {
        if self.lookout.next_due(self.driver.step().saturating_sub(1)) == self.driver.step() {
            let view = self.driver.view();
            for alarm in self.lookout.look(&view, self.start_energy.as_ref())? {
                warn(progress, &alarm, &view);
            }
            self.moments.keep(&view);
        }
        Ok(())
    }

    /// Leaves the smallest scene in which the run fails as it has.
    fn capsule(&self, error: &EngineError) -> Option<(PathBuf, usize)> {
        let source = self.source.as_ref()?;
        capsule::write(&self.directory, source, &self.plan, &self.moments, error, &self.driver.view())
    }

    /// Keeps the state before outputs get the entry of an early end, which a continued run does not have.
    fn end_early(&mut self, ending: Ending) -> Result<Ending, Failure> {
        let kept = self.keep();
        self.observe(Observers::finish)?;
        kept.map(|()| ending)
    }

    /// Writes a checkpoint, where the run has them.
    fn keep(&mut self) -> Result<(), Failure> {
        let Some(keeper) = &mut self.keeper else { return Ok(()) };
        let before = Instant::now();
        self.kept = Some(keeper.keep(self.driver.as_ref(), &self.observers).map_err(Failure::Keep)?);
        self.output_time += before.elapsed();
        Ok(())
    }

    fn observe(
        &mut self,
        look: impl FnOnce(&mut Observers, &View<'_>) -> Result<(), ObserveError>,
    ) -> Result<(), Failure> {
        if self.observers.is_empty() {
            return Ok(());
        }
        let before = Instant::now();
        let result = look(&mut self.observers, &self.driver.view());
        self.output_time += before.elapsed();
        self.output_calls += 1;
        Ok(result?)
    }

    fn rate(&self, wall: Duration) -> f64 {
        let seconds = wall.as_secs_f64();
        let work = self.bodies as f64 * (self.driver.step() - self.first) as f64;
        if seconds > 0.0 { work / seconds } else { 0.0 }
    }

    fn status(&self) -> Status {
        let (step, steps) = (self.driver.step(), self.plan.driver.steps);
        let elapsed = self.begin.elapsed();
        let done = step - self.first;
        let left = (done > 0).then(|| {
            let seconds = elapsed.as_secs_f64() * (steps.saturating_sub(step)) as f64 / done as f64;
            Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)
        });
        Status {
            step,
            time: self.driver.time(),
            particle_steps_per_second: self.rate(elapsed),
            elapsed,
            left,
        }
    }

    fn record(&self, outcome: &str, result_hash: Option<String>) -> Result<(), RunError> {
        let timings = self.driver.timings();
        let tally = self.driver.view().tally().clone();
        self.recorder.write(&Record {
            outcome,
            threads: self.driver.threads(),
            wall: self.begin.elapsed(),
            phases: [
                ("candidate lists", timings.lists, self.driver.step()),
                ("contacts and forces", timings.forces, self.driver.step()),
                ("time integration", timings.integration, self.driver.step()),
                ("outputs", self.output_time, self.output_calls),
            ],
            steps: self.driver.step(),
            time: self.driver.time(),
            contacts: tally.contacts + tally.wall_contacts,
            files: self.observers.files().collect(),
            result_hash,
        })
    }
}

/// Tells of a limit that was passed in a run that goes on.
fn warn(progress: &mut dyn Progress, alarm: &Alarm, view: &View<'_>) {
    let error = EngineError::Guard(*alarm);
    progress.warn(&format!("warning: {alarm}{}", guards::about(&error, view)));
}

/// Why the steps of a run ended early.
enum Failure {
    Engine(EngineError),
    Observe(ObserveError),
    Keep(KeepError),
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Engine(error) => error.fmt(f),
            Self::Observe(error) => error.fmt(f),
            Self::Keep(error) => f.write_str(&error.0),
        }
    }
}

impl From<EngineError> for Failure {
    fn from(error: EngineError) -> Self {
        Self::Engine(error)
    }
}

impl From<ObserveError> for Failure {
    fn from(error: ObserveError) -> Self {
        Self::Observe(error)
    }
}
