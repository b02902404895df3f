//! One run of one setting.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use granule_drivers::{Advance, Driver, EventDriver, RollingDriver, TimeStepDriver};
use granule_law_api::Registry;
use granule_plan::Plan;
use granule_scene::{BodyBlock, Scene, Spanned, StepChoice};
use serde::{Deserialize, Serialize};

use crate::meter::Meter;
use crate::observable::Observable;
use crate::{Omission, Setting, TradeError};

/// Shortest wall-clock time that is measured: shorter runs are repeated.
const MEASURABLE: Duration = Duration::from_millis(20);
/// Realisations of a scene without random parts take up to this share of steps more: enough to move a contact that begins
/// after six steps through all phases of a step.
const SPREAD: f64 = 1.0 / 6.0;
/// The golden ratio, whose multiples cover an interval evenly, however many there are.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// What one run shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sample {
    /// Components of each observable.
    pub values: Vec<Vec<f64>>,
    /// Size of each observable: the largest component at the moments looked at.
    pub scales: Vec<f64>,
    /// Wall-clock time \[s\].
    pub wall: f64,
    /// Steps.
    pub steps: u64,
    /// Time step \[s\].
    pub step: f64,
    /// Bytes of state and lists a body.
    pub bytes_per_body: f64,
}

/// A scene to run.
pub(crate) struct Subject<'a> {
    pub scene: &'a Scene,
    pub registry: &'a Registry,
    /// Folder of the scene, for imports.
    pub folder: &'a Path,
    /// Simulated time of every run \[s\].
    pub duration: f64,
    pub observables: &'a [Observable],
    pub ledger: bool,
}

impl Subject<'_> {
    /// The plan of a setting; `None` with the reason if it does not apply.
    pub fn plan(&self, setting: &Setting) -> Result<Plan, String> {
        if setting.without == Omission::Softness
            && let Some(observable) = self.observables.iter().find(|observable| observable.needs_contacts())
        {
            return Err(format!("hard bodies have no contacts that last, and so no `{}`", observable.name()));
        }
        let scene = setting.apply(self.scene, self.registry, self.folder, self.duration)?;
        self.plan_scene(scene)
    }

    fn plan_scene(&self, mut scene: Scene) -> Result<Plan, String> {
        scene.ledger |= self.ledger;
        let (plan, diagnostics) = granule_plan::build(&scene, self.registry, self.folder);
        plan.ok_or_else(|| {
            let messages = diagnostics.iter().filter(|d| d.severity == granule_scene::Severity::Error);
            messages.map(|d| d.message.clone()).collect::<Vec<_>>().join("; ")
        })
    }

    /// The plan of one realisation of a setting: another seed where the scene has random parts, else another step.
    pub fn realisation(&self, setting: &Setting, index: u64) -> Result<Plan, String> {
        let mut scene = setting.apply(self.scene, self.registry, self.folder, self.duration)?;
        if index == 0 {
            return self.plan_scene(scene);
        }
        if is_random(&scene) {
            scene.seed = scene.seed.wrapping_add(index);
            return self.plan_scene(scene);
        }
        let steps = self.plan_scene(scene.clone())?.driver.steps;
        let more = steps + (steps as f64 * SPREAD * (index as f64 * GOLDEN).fract()).round() as u64;
        let span = scene.driver.step.span.clone();
        scene.driver.step = Spanned::new(StepChoice::Fixed(self.duration / more as f64), span);
        self.plan_scene(scene)
    }

    /// Runs one realisation.
    pub fn run(&self, setting: &Setting, index: u64, stop: &AtomicBool) -> Result<Sample, TradeError> {
        let failed = |reason: String| TradeError::Run { setting: setting.label(), reason };
        let plan = Arc::new(self.realisation(setting, index).map_err(failed)?);
        let mut best: Option<Sample> = None;
        let begin = Instant::now();
        loop {
            let sample = self.once(&plan, stop).map_err(|error| match error {
                Some(reason) => failed(reason),
                None => TradeError::Stopped,
            })?;
            best = match best {
                Some(best) if best.wall <= sample.wall => Some(best),
                _ => Some(sample),
            };
            if begin.elapsed() >= MEASURABLE
                && let Some(best) = best
            {
                return Ok(best);
            }
        }
    }

    fn once(&self, plan: &Arc<Plan>, stop: &AtomicBool) -> Result<Sample, Option<String>> {
        let failed = |error: granule_drivers::EngineError| Some(error.to_string());
        let count = plan.bodies.len().max(1) as f64;
        if plan.event.is_some() && plan.substrate.is_some() {
            let mut driver = RollingDriver::new(plan.clone()).map_err(failed)?;
            let sample = self.follow(plan, &mut driver, stop)?;
            return Ok(Sample { bytes_per_body: driver.engine().bytes() as f64 / count, ..sample });
        }
        if plan.event.is_some() {
            let mut driver = EventDriver::new(plan.clone()).map_err(failed)?;
            let sample = self.follow(plan, &mut driver, stop)?;
            return Ok(Sample { bytes_per_body: driver.engine().bytes() as f64 / count, ..sample });
        }
        let mut driver = TimeStepDriver::new(plan.clone(), Some(1)).map_err(failed)?;
        let sample = self.follow(plan, &mut driver, stop)?;
        let engine = driver.engine();
        let bytes = engine.bodies().layout().bytes_per_body() as f64 + engine.list_bytes() as f64 / count;
        Ok(Sample { bytes_per_body: bytes, ..sample })
    }

    fn follow(
        &self,
        plan: &Plan,
        driver: &mut dyn Driver,
        stop: &AtomicBool,
    ) -> Result<Sample, Option<String>> {
        let mut meter = Meter::new(plan, self.observables);
        meter.begin(&driver.view());
        let mut wall = Duration::ZERO;
        while let Some(moment) = meter.next_due() {
            let begin = Instant::now();
            match driver.advance(moment, stop) {
                Ok(Advance::Reached) => {}
                Ok(Advance::Stopped) => return Err(None),
                Err(error) => return Err(Some(error.to_string())),
            }
            wall += begin.elapsed();
            meter.look(&driver.view());
        }
        let (values, scales) = meter.result().unwrap_or_default();
        let (wall, steps, step) = (wall.as_secs_f64(), plan.driver.steps, plan.driver.step);
        Ok(Sample { values, scales, wall, steps, step, bytes_per_body: 0.0 })
    }
}

/// The initial state has random parts, so that another seed is another realisation.
pub(crate) fn is_random(scene: &Scene) -> bool {
    scene.bodies.items.iter().any(|block| match block {
        BodyBlock::Fill(_) => true,
        BodyBlock::Lattice(lattice) => {
            lattice.jitter.as_ref().is_some_and(|jitter| jitter.value > 0.0)
                || lattice.velocity_spread.as_ref().is_some_and(|spread| spread.value > 0.0)
        }
        BodyBlock::Single(_) | BodyBlock::Import(_) => false,
    })
}
