//! The whole trade: reference, ladder, scores.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use granule_law_api::Registry;
use granule_scene::{IntegratorChoice, PrecisionChoice, Scene, Severity};

use crate::front::{Scored, choose, mark, score};
use crate::measure::{Sample, Subject, is_random};
use crate::observable::{Kind, Observable, kind, need_ledger, observables};
use crate::reference::{Reference, judge};
use crate::store::Store;
use crate::{Omission, Setting, TradeError};

/// What a user may choose.
#[derive(Clone, Debug)]
pub struct Options {
    /// Folder of the results; runs that are found there are not done again.
    pub directory: PathBuf,
    /// Quantities whose errors count; what the scene names, or the usual ones of its kind, if empty.
    pub observe: Vec<String>,
    /// Realisations of every setting, at least 3.
    pub realisations: u64,
    /// The relative error that a choice may have.
    pub target: f64,
}

/// Who is told how far a trade is.
pub trait Watch {
    /// So many of so many runs are done; the next one is of this setting.
    fn progress(&mut self, done: usize, all: usize, setting: &str);
}

/// What a trade has found.
pub struct Study {
    /// Title of the scene.
    pub title: String,
    /// Which scene it is of: equal for equal scenes, whatever their settings.
    pub scene: String,
    /// Names and units of the observables.
    pub observables: Vec<(&'static str, &'static str)>,
    /// Paths are compared, not means.
    pub paths: bool,
    /// Realisations have other seeds, not other steps.
    pub seeds: bool,
    /// Realisations of every setting.
    pub realisations: u64,
    /// Simulated time of every run \[s\].
    pub duration: f64,
    /// Bodies.
    pub bodies: usize,
    /// What errors are measured against.
    pub reference: Reference,
    /// All settings, the cheapest first.
    pub settings: Vec<Scored>,
    /// Settings that do not apply to this scene, with the reason.
    pub left_out: Vec<(String, String)>,
    /// The relative error that a choice may have.
    pub target: f64,
    /// Index of the cheapest setting that keeps the target.
    pub chosen: Option<usize>,
}

const FULL: Setting = Setting {
    integrator: IntegratorChoice::VelocityVerlet,
    steps_per_contact: 0.0,
    precision: PrecisionChoice::Double,
    stiffness: 1.0,
    without: Omission::None,
};

/// Trades the speed of a scene for accuracy. `folder` is where the scene lies, for the files that it imports.
///
/// # Errors
/// See [`TradeError`].
pub fn trade(
    text: &str,
    folder: &Path,
    registry: &Registry,
    options: &Options,
    watch: &mut dyn Watch,
    stop: &AtomicBool,
) -> Result<Study, TradeError> {
    let parsed = granule_scene::parse(text);
    let Some(mut scene) = parsed.scene else { return Err(TradeError::Scene(parsed.diagnostics)) };
    // A trade finds out what an accuracy needs.
    scene.accuracy = None;
    let (plan, mut diagnostics) = granule_plan::build(&scene, registry, folder);
    diagnostics.extend(parsed.diagnostics);
    diagnostics.retain(|diagnostic| diagnostic.severity == Severity::Error);
    let Some(plan) = plan.filter(|_| diagnostics.is_empty()) else {
        return Err(TradeError::Scene(diagnostics));
    };
    if plan.compositions.is_empty() || plan.bodies.is_empty() {
        return Err(TradeError::Nothing("nothing touches in this scene".into()));
    }
    let observables = observables(&options.observe, &scene, &plan)?;
    let kind = kind(&plan);
    let duration = plan.driver.steps as f64 * plan.driver.step;
    let identity = identity(&scene, registry, folder, duration)?;
    let subject = Subject {
        scene: &scene,
        registry,
        folder,
        duration,
        observables: &observables,
        ledger: need_ledger(&observables),
    };
    let mut bench = Bench { subject, store: Store::open(&options.directory)?, stop };
    let realisations = options.realisations.max(3);
    let mut left_out = Vec::new();
    let mut ladder = Vec::new();
    for setting in candidates(kind, plan.gravity != [0.0; 3], plan.rotation) {
        match bench.subject.plan(&setting) {
            Ok(_) => ladder.push(setting),
            Err(reason) => left_out.push((setting.label(), reason)),
        }
    }
    let rungs: &[f64] = match kind {
        Kind::Paths => &[320.0, 640.0, 1280.0, 2560.0],
        Kind::Means => &[160.0, 320.0],
    };
    let all = (rungs.len() + ladder.len()) * realisations as usize;
    let mut done = 0;
    let mut runs = |setting: &Setting, bench: &mut Bench<'_>| -> Result<Vec<Sample>, TradeError> {
        (0..realisations)
            .map(|index| {
                watch.progress(done, all, &setting.label());
                done += 1;
                bench.run(setting, index)
            })
            .collect()
    };
    let mut finer = Vec::new();
    for steps_per_contact in rungs {
        let samples = runs(&Setting { steps_per_contact: *steps_per_contact, ..FULL }, &mut bench)?;
        finer.push((*steps_per_contact, samples));
    }
    let reference = judge(kind, &observables, &finer)?;
    let mut settings = Vec::new();
    for setting in ladder {
        let samples = runs(&setting, &mut bench)?;
        settings.push(score(setting, kind, &samples, &reference, bench.subject.duration));
    }
    settings.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    mark(&mut settings);
    let chosen = choose(&settings, options.target)
        .and_then(|best| settings.iter().position(|scored| scored.setting == best.setting));
    Ok(Study {
        title: scene.title.clone(),
        scene: identity,
        observables: observables.iter().map(|observable| (observable.name(), observable.unit())).collect(),
        paths: kind == Kind::Paths,
        seeds: is_random(&scene),
        realisations,
        duration: bench.subject.duration,
        bodies: plan.bodies.len(),
        reference,
        settings,
        left_out,
        target: options.target,
        chosen,
    })
}

/// The same for the same scene, whatever its step, scheme, precision, outputs and seed.
pub(crate) fn identity(
    scene: &Scene,
    registry: &Registry,
    folder: &Path,
    duration: f64,
) -> Result<String, TradeError> {
    let mut scene = scene.clone();
    if is_random(&scene) {
        scene.seed = 0;
    }
    let subject = Subject { scene: &scene, registry, folder, duration, observables: &[], ledger: false };
    let setting = Setting { steps_per_contact: 160.0, ..FULL };
    match subject.plan(&setting) {
        Ok(plan) => Ok(plan.fingerprint),
        Err(reason) => Err(TradeError::Run { setting: setting.label(), reason }),
    }
}

/// Runs that are done once and remembered.
pub(crate) struct Bench<'a> {
    pub subject: Subject<'a>,
    pub store: Store,
    pub stop: &'a AtomicBool,
}

impl Bench<'_> {
    pub fn run(&mut self, setting: &Setting, index: u64) -> Result<Sample, TradeError> {
        let plan = self
            .subject
            .realisation(setting, index)
            .map_err(|reason| TradeError::Run { setting: setting.label(), reason })?;
        let names: Vec<&str> = self.subject.observables.iter().map(Observable::name).collect();
        let key = format!("{} {}", plan.fingerprint, names.join(","));
        drop(plan);
        if let Some(sample) = self.store.get(&key) {
            return Ok(sample.clone());
        }
        let sample = self.subject.run(setting, index, self.stop)?;
        self.store.put(key, sample.clone())?;
        Ok(sample)
    }
}

/// What is tried: the steps in a contact from the fewest that follow a contact at all, and at some of them every other
/// choice that a scene has.
fn candidates(kind: Kind, gravity: bool, rotation: bool) -> Vec<Setting> {
    let at = |steps_per_contact: f64| Setting { steps_per_contact, ..FULL };
    let (ladder, few): (&[f64], &[f64]) = match kind {
        Kind::Paths => {
            (&[10.0, 14.0, 20.0, 28.0, 40.0, 56.0, 80.0, 113.0, 160.0, 320.0], &[20.0, 40.0, 80.0, 160.0])
        }
        Kind::Means => (&[10.0, 20.0, 40.0, 80.0, 160.0], &[20.0, 80.0]),
    };
    let mut settings: Vec<Setting> = ladder.iter().map(|steps| at(*steps)).collect();
    for steps in few {
        for integrator in [
            IntegratorChoice::ClassicVelocityVerlet,
            IntegratorChoice::ContactResolved,
            IntegratorChoice::Leapfrog,
            IntegratorChoice::SymplecticEuler,
        ] {
            settings.push(Setting { integrator, ..at(*steps) });
        }
        settings.push(Setting { precision: PrecisionChoice::Single, ..at(*steps) });
    }
    for stiffness in [0.1, 0.01] {
        for steps in [20.0, 40.0] {
            settings.push(Setting { stiffness, ..at(steps) });
        }
    }
    settings.push(Setting { without: Omission::Softness, ..at(40.0) });
    if rotation {
        settings.push(Setting { without: Omission::Friction, ..at(40.0) });
        settings.push(Setting { without: Omission::History, ..at(40.0) });
    }
    if gravity {
        settings.push(Setting { without: Omission::Gravity, ..at(40.0) });
    }
    settings
}
