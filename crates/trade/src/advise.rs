//! What a scene requires: which physics acts in it, and which could go.

mod groups;
mod probe;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use granule_law_api::Registry;
use granule_plan::{Plan, Scheme, limits};
use granule_scene::{IntegratorChoice, Severity, StepChoice};
use serde_json::{Value, json as object};

pub use self::groups::Group;
use crate::measure::{Sample, Subject, is_random};
use crate::observable::{Kind, Observable, kind, observables};
use crate::reference::{difference, distance};
use crate::store::Store;
use crate::study::{Bench, Options, Watch};
use crate::{Omission, Setting, TradeError};

/// Differences below this share of a quantity are round-off.
const ROUND_OFF: f64 = 1e-12;

/// What can be said of a piece of physics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Runs with and without are the same to round-off.
    NeverActs,
    /// Leaving it out changes no quantity by more than the target.
    CanGo,
    /// Leaving it out changes some quantity by more than the target.
    Needed,
    /// The difference is not told apart from the target.
    Open,
}

impl Verdict {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::NeverActs => "never acts",
            Self::CanGo => "can go",
            Self::Needed => "is needed",
            Self::Open => "not told by these runs",
        }
    }
}

/// A piece of physics, judged by runs with and without it.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// What is left out.
    pub without: Omission,
    /// The verdict.
    pub verdict: Verdict,
    /// Quantity that changes most, and its relative change.
    pub quantity: String,
    /// The change.
    pub error: f64,
    /// Its uncertainty.
    pub bar: f64,
    /// Time of a run without it over that of a run with it.
    pub cost: f64,
    /// The equations behind.
    pub source: &'static str,
}

/// What a scene requires.
#[derive(Clone, Debug)]
pub struct Advice {
    /// Title of the scene.
    pub title: String,
    /// Dimensionless groups.
    pub groups: Vec<Group>,
    /// Physics that the scene has, judged.
    pub claims: Vec<Claim>,
    /// What could not be tried, with the reason.
    pub left_out: Vec<(Omission, String)>,
    /// Names of the quantities.
    pub observables: Vec<String>,
    /// Runs with and without each piece.
    pub realisations: u64,
    /// The relative change that is allowed.
    pub target: f64,
    /// Every step of the probe was looked at.
    pub whole: bool,
    /// The setting of the scene.
    pub setting: Setting,
}

impl Advice {
    /// The change that saves most among those that may be made, if one saves anything.
    pub fn best(&self) -> Option<&Claim> {
        let allowed =
            self.claims.iter().filter(|claim| matches!(claim.verdict, Verdict::NeverActs | Verdict::CanGo));
        allowed.min_by(|a, b| a.cost.total_cmp(&b.cost)).filter(|claim| claim.cost < 1.0)
    }
}

/// Probes a scene, and runs it with and without each piece of its physics. `folder` is where the scene lies.
///
/// # Errors
/// See [`TradeError`].
pub fn advise(
    text: &str,
    folder: &Path,
    registry: &Registry,
    options: &Options,
    watch: &mut dyn Watch,
    stop: &AtomicBool,
) -> Result<Advice, TradeError> {
    let parsed = granule_scene::parse(text);
    let Some(mut scene) = parsed.scene else { return Err(TradeError::Scene(parsed.diagnostics)) };
    scene.accuracy = None;
    let (plan, mut diagnostics) = granule_plan::build(&scene, registry, folder);
    diagnostics.extend(parsed.diagnostics);
    diagnostics.retain(|diagnostic| diagnostic.severity == Severity::Error);
    let Some(plan) = plan.filter(|_| diagnostics.is_empty()) else {
        return Err(TradeError::Scene(diagnostics));
    };
    if plan.event.is_some() {
        return Err(TradeError::Nothing(
            "the scene has hard bodies already; advice is for `driver: TimeStep`".into(),
        ));
    }
    let Some(contact) = limits(&plan).shortest_contact.filter(|_| !plan.bodies.is_empty()) else {
        return Err(TradeError::Nothing("nothing touches in this scene".into()));
    };
    let plan = Arc::new(plan);
    let full = own_setting(&plan, &scene.driver.step.value, scene.precision, contact);
    let asked = observables(&options.observe, &scene, &plan)?;
    let moving: Vec<Observable> =
        asked.iter().filter(|observable| !observable.needs_contacts()).cloned().collect();
    let duration = plan.driver.steps as f64 * plan.driver.step;
    let realisations = options.realisations.max(3);
    let omissions = present(&plan);
    let all = 1 + (1 + omissions.len()) * realisations as usize;
    watch.progress(0, all, "probe");
    let seen = probe::probe(&plan, contact, stop)?;
    let mut done = 1;
    let mut store = Some(Store::open(&options.directory)?);
    let mut run = |setting: Setting, observables: &[Observable]| -> Result<Vec<Sample>, TradeError> {
        let subject = Subject {
            scene: &scene,
            registry,
            folder,
            duration,
            observables,
            ledger: crate::observable::need_ledger(observables),
        };
        let Some(own) = store.take() else { return Err(TradeError::Stopped) };
        let mut bench = Bench { subject, store: own, stop };
        let samples = (0..realisations)
            .map(|index| {
                watch.progress(done.min(all), all, &setting.label());
                done += 1;
                bench.run(&setting, index)
            })
            .collect();
        store = Some(bench.store);
        samples
    };
    let with = run(full, &asked)?;
    let with_moving =
        if moving.len() == asked.len() || moving.is_empty() { None } else { Some(run(full, &moving)?) };
    let (mut claims, mut left_out) = (Vec::new(), Vec::new());
    for without in omissions {
        let soft = without != Omission::Softness;
        let (observables, reference) = match (&with_moving, soft) {
            (_, true) => (&asked, &with),
            (Some(reference), false) => (&moving, reference),
            (None, false) if moving.is_empty() => {
                left_out.push((without, "hard bodies have none of the quantities".into()));
                continue;
            }
            (None, false) => (&asked, &with),
        };
        let setting = Setting { without, ..full };
        let applies = setting.apply(&scene, registry, folder, duration).and_then(|changed| {
            let (plan, problems) = granule_plan::build(&changed, registry, folder);
            let errors = problems.iter().filter(|problem| problem.severity == Severity::Error);
            plan.map(drop)
                .ok_or_else(|| errors.map(|problem| problem.message.clone()).collect::<Vec<_>>().join("; "))
        });
        if let Err(reason) = applies {
            left_out.push((without, reason));
            continue;
        }
        let samples = run(setting, observables)?;
        claims.push(claim(kind(&plan), without, observables, reference, &samples, options.target));
    }
    Ok(Advice {
        title: scene.title.clone(),
        groups: groups::groups(&plan, &seen),
        claims,
        left_out,
        observables: asked.iter().map(|observable| observable.name().to_string()).collect(),
        realisations,
        target: options.target,
        whole: seen.whole && !is_random(&scene),
        setting: full,
    })
}

/// The setting that the scene has.
fn own_setting(
    plan: &Plan,
    step: &StepChoice,
    precision: granule_scene::PrecisionChoice,
    contact: f64,
) -> Setting {
    Setting {
        integrator: match plan.driver.scheme {
            Scheme::VelocityVerlet => IntegratorChoice::VelocityVerlet,
            Scheme::ClassicVelocityVerlet => IntegratorChoice::ClassicVelocityVerlet,
            Scheme::ContactResolved => IntegratorChoice::ContactResolved,
            Scheme::Leapfrog => IntegratorChoice::Leapfrog,
            Scheme::SymplecticEuler => IntegratorChoice::SymplecticEuler,
        },
        steps_per_contact: match step {
            StepChoice::Auto { steps_per_contact } => *steps_per_contact,
            StepChoice::Fixed(step) => contact / step,
        },
        precision,
        stiffness: 1.0,
        without: Omission::None,
    }
}

/// The physics that a plan has and that can be left out.
fn present(plan: &Plan) -> Vec<Omission> {
    use granule_law_api::Slot;
    let has = |slots: &[Slot]| {
        plan.compositions.iter().any(|laws| laws.stages.iter().any(|stage| slots.contains(&stage.slot)))
    };
    let remembers = plan.compositions.iter().any(|laws| {
        laws.stages.iter().any(|stage| stage.slot == Slot::Tangential && stage.history_width > 0)
    });
    let mut omissions = Vec::new();
    if has(&[Slot::Tangential, Slot::Rolling, Slot::Torsion]) {
        omissions.push(Omission::Friction);
    }
    if remembers {
        omissions.push(Omission::History);
    }
    if has(&[Slot::Rolling, Slot::Torsion]) {
        omissions.push(Omission::Rolling);
    }
    if plan.gravity != [0.0; 3] && plan.substrate.is_none() {
        omissions.push(Omission::Gravity);
    }
    omissions.push(Omission::Softness);
    omissions
}

fn claim(
    kind: Kind,
    without: Omission,
    observables: &[Observable],
    with: &[Sample],
    left: &[Sample],
    target: f64,
) -> Claim {
    let mut worst = (String::new(), 0.0, 0.0);
    let mut exact = true;
    for (at, observable) in observables.iter().enumerate() {
        let scale = with.iter().map(|sample| sample.scales[at]).fold(0.0, f64::max);
        let (error, bar) = match kind {
            Kind::Paths => {
                let each: Vec<f64> = with
                    .iter()
                    .zip(left)
                    .map(|(a, b)| distance(&a.values[at], &b.values[at], scale))
                    .collect();
                let most = each.iter().copied().fold(0.0, f64::max);
                let least = each.iter().copied().fold(f64::INFINITY, f64::min);
                (most, most - least)
            }
            Kind::Means => {
                let share = |value: f64| if scale > 0.0 { value / scale } else { value };
                let (error, deviation) = difference(left, with, at);
                (share(error), 2.0 * share(deviation))
            }
        };
        exact &= error <= ROUND_OFF && bar <= ROUND_OFF;
        if worst.0.is_empty() || error + bar > worst.1 + worst.2 {
            worst = (observable.name().to_string(), error, bar);
        }
    }
    let (quantity, error, bar) = worst;
    let verdict = if exact {
        Verdict::NeverActs
    } else if error + bar <= target {
        Verdict::CanGo
    } else if error - bar > target || (kind == Kind::Paths && error > target) {
        Verdict::Needed
    } else {
        Verdict::Open
    };
    let wall = |samples: &[Sample]| {
        let mut walls: Vec<f64> = samples.iter().map(|sample| sample.wall).collect();
        walls.sort_by(f64::total_cmp);
        walls[walls.len() / 2]
    };
    Claim { without, verdict, quantity, error, bar, cost: wall(left) / wall(with), source: source(without) }
}

/// The equations behind a claim.
fn source(without: Omission) -> &'static str {
    match without {
        Omission::None => "",
        Omission::Friction => "Luding 1998, Eqs. (17)-(21): no slip, no tangential impulse",
        Omission::History => "Luding 1998, Eqs. (54)-(57): the spring acts below Psi_1,0",
        Omission::Rolling => "Kondic 1999, Eq. (16): rolling friction",
        Omission::Gravity => "Kondic 1999, Eq. (38): g t_c/v",
        Omission::Softness => "Luding 1998, Eqs. (5), (6) and (16)-(21): t_(k+1) against t_c",
    }
}

/// Everything as JSON.
pub fn advice_json(advice: &Advice) -> Value {
    let finite = |value: f64| if value.is_finite() { object!(value) } else { Value::Null };
    object!({
        "title": advice.title,
        "observables": advice.observables,
        "realisations": advice.realisations,
        "target": advice.target,
        "setting": advice.setting.label(),
        "groups": advice.groups.iter().map(|group| object!({
            "name": group.name, "symbol": group.symbol, "of": group.of, "value": finite(group.value),
            "threshold": group.threshold.map(finite), "meaning": group.meaning, "source": group.source,
        })).collect::<Vec<_>>(),
        "claims": advice.claims.iter().map(|claim| object!({
            "physics": claim.without.physics(), "without": claim.without, "verdict": claim.verdict.words(), "quantity": claim.quantity, "error": claim.error,
            "bar": claim.bar, "cost": claim.cost, "source": claim.source,
        })).collect::<Vec<_>>(),
        "left_out": advice.left_out.iter()
            .map(|(without, reason)| object!({ "without": without, "reason": reason })).collect::<Vec<_>>(),
    })
}
