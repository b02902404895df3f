//! Step and integrator of a scene that asks for an accuracy or a time instead.

mod impacts;
mod table;

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use granule_drivers::{Advance, Driver, TimeStepDriver};
use granule_law_api::Registry;
use granule_plan::{Plan, limits};
use granule_scene::{
    AccuracyGoal, Diagnostic, IntegratorChoice, PrecisionChoice, RunBlock, Scene, Severity, remove_field,
    set_field,
};

pub use self::impacts::Impacts;
use crate::observable::{need_ledger, observable};
use crate::reference::distance;
use crate::setting::integrator_name;
use crate::{Meter, Omission, Setting, chosen_scene};

/// Steps in a contact that are tried: factors of √2 from the fewest that follow a contact at all.
const FEWEST: f64 = 10.0;
const MOST: f64 = 5_120.0;
/// The stated error of an impact is the worst of the phases that were tried times this: other phases may be worse.
const MARGIN: f64 = 1.25;
/// Share of a time budget that a prediction may fill: the speed of the first steps is not that of all.
const FILLED: f64 = 0.8;
/// Time of the clock in which the speed of a scene is measured.
const PROBE: Duration = Duration::from_millis(300);
/// Share of the largest stable step that an automatic step may reach, as in plans.
const STABLE: f64 = 0.5;

/// Why a setting was chosen, and what it is expected to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The scene with the setting, without the wish for accuracy.
    pub text: String,
    /// The setting.
    pub setting: Setting,
    /// What was asked for.
    pub goal: AccuracyGoal,
    /// Quantity whose error is predicted.
    pub quantity: String,
    /// The error expected of it.
    pub error: f64,
    /// Time of the clock expected for the run \[s\], if it is known.
    pub seconds: Option<f64>,
    /// Measured settings, in words.
    pub table: Vec<String>,
    /// Step in impacts \[s\]; what a repetition of the measurement needs.
    step: Option<f64>,
    /// What quantities should be, of a table.
    against: Option<Against>,
}

/// What a run can be held against.
#[derive(Clone, Debug, PartialEq)]
struct Against {
    /// Names of the quantities whose errors count.
    names: Vec<String>,
    /// Components of each in the reference.
    values: Vec<Vec<f64>>,
    /// Size of each, which errors are divided by.
    scales: Vec<f64>,
    /// How far single runs of the reference lie from its mean, or how well it is known if it is a path; relative.
    scatter: Vec<f64>,
}

/// How far a run was from the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Realised {
    /// Largest relative error of the quantities that count.
    pub error: f64,
    /// What of it may be chance: standard deviation of single runs of the reference, or its uncertainty if it is a path; relative.
    pub chance: f64,
}

impl Choice {
    /// The choice in one line.
    pub fn why(&self) -> String {
        let time =
            self.seconds.map_or_else(String::new, |seconds| format!(", about {seconds:.3} s of the clock"));
        format!("{}: error of {} {:.2e}{time}", self.setting.label(), self.quantity, self.error)
    }

    /// What has to be looked at during the run, so that its error is known afterwards. `None` where no table says what should
    /// come out.
    pub fn meter(&self, plan: &Plan) -> Option<Meter> {
        let against = self.against.as_ref()?;
        let observables: Result<Vec<_>, _> = against.names.iter().map(|name| observable(name)).collect();
        Some(Meter::new(plan, &observables.ok()?))
    }

    /// How far the run was from the reference of the table; `None` if it was not followed to its end.
    pub fn realised(&self, meter: Meter) -> Option<Realised> {
        let against = self.against.as_ref()?;
        let (values, _) = meter.result()?;
        let errors =
            values.iter().zip(&against.values).zip(&against.scales).map(|((a, b), s)| distance(a, b, *s));
        let (at, error) = errors.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(Realised { error, chance: against.scatter[at] })
    }

    /// Repeats the measurement of impacts at phases that were not used for the prediction. `None` where another quantity
    /// was predicted.
    ///
    /// # Errors
    /// An impact has no result.
    pub fn measured_again(&self, plan: &Plan) -> Result<Option<f64>, String> {
        let Some(step) = self.step else { return Ok(None) };
        Ok(Some(Impacts::of(plan)?.worst_error(plan, step, impacts::Phases::Others)?))
    }
}

/// One measured row.
#[derive(Clone, Copy)]
struct Row {
    setting: Setting,
    step: f64,
    error: f64,
}

/// Decides on the setting of a scene that asks for an accuracy or a time. `None` if it does not ask. `folder` is where the
/// scene lies.
///
/// # Errors
/// The wish cannot be fulfilled, each reason with its place in the text.
pub fn decide(
    text: &str,
    scene: &Scene,
    registry: &Registry,
    folder: &Path,
) -> Result<Option<Choice>, Vec<Diagnostic>> {
    let Some(block) = &scene.accuracy else { return Ok(None) };
    let duration = match &scene.run {
        Some(RunBlock::Duration(duration)) => duration.value,
        Some(RunBlock::Steps(steps)) => {
            let message =
                format!("`run: (steps: ..)` has no meaning while `{}` chooses the step", block.goal.field());
            return Err(vec![Diagnostic::error(steps.span.clone(), message).help("give a `duration`")]);
        }
        None => return Ok(None),
    };
    let wish = Wish { scene, registry, folder, duration };
    let choice = match &block.goal {
        AccuracyGoal::Restitution { error } => wish.restitution(error.value, &error.span)?,
        AccuracyGoal::Observable { observable, error, table } => {
            let rows = table::read(&wish, table)?;
            rows.cheapest(observable, error)?
        }
        AccuracyGoal::Budget { seconds, table: Some(table) } => {
            let rows = table::read(&wish, table)?;
            rows.most_accurate(seconds, duration)?
        }
        AccuracyGoal::Budget { seconds, table: None } => wish.budget(seconds.value, &seconds.span)?,
    };
    let Decided { setting, quantity, error, seconds, table, step, against } = choice;
    let text = chosen_scene(text, &setting, registry, folder)?;
    let text = remove_field(&text, block.goal.field()).map_err(|problem| vec![problem])?;
    let kept = against.iter().flat_map(|against| &against.names).filter_map(|name| observable(name).ok());
    let text = if need_ledger(&kept.collect::<Vec<_>>()) {
        set_field(&text, None, "ledger", "true").map_err(|problem| vec![problem])?
    } else {
        text
    };
    let goal = block.goal.clone();
    Ok(Some(Choice { text, setting, goal, quantity, error, seconds, table, step, against }))
}

/// A choice that is not yet written into the scene.
struct Decided {
    setting: Setting,
    quantity: String,
    error: f64,
    seconds: Option<f64>,
    table: Vec<String>,
    step: Option<f64>,
    against: Option<Against>,
}

/// A scene and what belongs to it.
struct Wish<'a> {
    scene: &'a Scene,
    registry: &'a Registry,
    folder: &'a Path,
    duration: f64,
}

impl Wish<'_> {
    fn setting(&self, integrator: IntegratorChoice, steps_per_contact: f64) -> Setting {
        Setting {
            integrator,
            steps_per_contact,
            precision: self.scene.precision,
            stiffness: 1.0,
            without: Omission::None,
        }
    }

    /// The plan of a setting.
    fn plan(&self, setting: &Setting) -> Result<Plan, Vec<Diagnostic>> {
        let scene = setting
            .apply(self.scene, self.registry, self.folder, self.duration)
            .map_err(|reason| vec![Diagnostic::error(0..0, reason)])?;
        let (plan, mut problems) = granule_plan::build(&scene, self.registry, self.folder);
        problems.retain(|problem| problem.severity == Severity::Error);
        plan.ok_or(problems)
    }

    /// Every scheme that the scene admits, with its plan and the impacts under it.
    fn schemes(&self, span: &Range<usize>) -> Result<Vec<Scheme>, Vec<Diagnostic>> {
        let first = self.plan(&self.setting(IntegratorChoice::VelocityVerlet, FEWEST))?;
        if first.compositions.is_empty() {
            let message = "nothing touches in this scene, so that no accuracy can be chosen";
            return Err(vec![Diagnostic::error(span.clone(), message)]);
        }
        // Conventions of engines whose forces see velocities of half a step earlier belong to one scheme.
        let conventions = &self.scene.conventions;
        let asked = conventions.preset.as_ref().is_some_and(|preset| preset.value != "physical")
            || conventions.changes.iter().any(|(name, _)| name.value == "velocity");
        let integrators: &[IntegratorChoice] =
            if asked { &[IntegratorChoice::ClassicVelocityVerlet] } else { &CANDIDATES };
        let mut schemes = Vec::new();
        for integrator in integrators {
            let plan = match self.plan(&self.setting(*integrator, FEWEST)) {
                Ok(plan) => plan,
                // A scheme that the scene does not admit is no candidate, but the first one must be.
                Err(_) if !schemes.is_empty() => continue,
                Err(problems) => return Err(problems),
            };
            let impacts = Impacts::of(&plan).map_err(|reason| {
                vec![Diagnostic::error(span.clone(), format!("no accuracy can be chosen: {reason}"))]
            })?;
            let bounds = limits(&plan);
            let Some(contact) = bounds.shortest_contact else {
                let message =
                    "no law of this scene has a contact duration, so that no accuracy can be chosen";
                return Err(vec![Diagnostic::error(span.clone(), message).help("give a step instead")]);
            };
            let stable = STABLE * bounds.step();
            schemes.push(Scheme { integrator: *integrator, plan, impacts, contact, stable });
        }
        Ok(schemes)
    }

    fn row(&self, scheme: &Scheme, steps: f64, span: &Range<usize>) -> Result<Row, Vec<Diagnostic>> {
        let step = (scheme.contact / steps).min(scheme.stable);
        let worst = scheme
            .impacts
            .worst_error(&scheme.plan, step, impacts::Phases::First)
            .map_err(|reason| vec![Diagnostic::error(span.clone(), format!("an impact fails: {reason}"))])?;
        Ok(Row { setting: self.setting(scheme.integrator, steps), step, error: MARGIN * worst })
    }

    /// The largest step with this error.
    fn restitution(&self, target: f64, span: &Range<usize>) -> Result<Decided, Vec<Diagnostic>> {
        let mut best: Option<Row> = None;
        let mut nearest = f64::INFINITY;
        let mut table = Vec::new();
        let mut tried = 0;
        for scheme in self.schemes(span)? {
            let mut steps = FEWEST;
            let mut rows = Vec::new();
            while steps <= MOST {
                // A scheme that needs smaller steps than another one is not worth more effort.
                if best.is_some_and(|best| scheme.contact / steps < best.step) {
                    break;
                }
                let row = self.row(&scheme, steps, span)?;
                rows.push(format!("{} {:.1e}", row.setting.steps_per_contact, row.error));
                tried += 1;
                nearest = nearest.min(row.error);
                if row.error <= target {
                    if best.is_none_or(|best| row.step > best.step) {
                        best = Some(row);
                    }
                    break;
                }
                steps = next(steps);
            }
            table.push(format!(
                "error of {} by steps in a contact: {}",
                integrator_name(scheme.integrator),
                rows.join(", ")
            ));
        }
        let Some(row) = best else {
            let message = format!("an error of {target:e} is out of reach");
            let help = format!("the best of {tried} settings has {nearest:.1e}");
            return Err(vec![Diagnostic::error(span.clone(), message).help(help)]);
        };
        Ok(decided(row, None, table))
    }

    /// The most accurate step that fits into a time.
    fn budget(&self, seconds: f64, span: &Range<usize>) -> Result<Decided, Vec<Diagnostic>> {
        let schemes = self.schemes(span)?;
        let mut best: Option<(Row, f64)> = None;
        let mut table = Vec::new();
        let mut shortest = f64::INFINITY;
        for scheme in &schemes {
            let each = seconds_a_step(
                scheme.plan.driver.threads,
                self.plan(&self.setting(scheme.integrator, FEWEST))?,
            )
            .map_err(|reason| vec![Diagnostic::error(span.clone(), reason)])?;
            let time = |steps: f64| each * self.duration / (scheme.contact / steps).min(scheme.stable);
            shortest = shortest.min(time(FEWEST));
            let mut most = None;
            let mut steps = FEWEST;
            while steps <= MOST && time(steps) <= FILLED * seconds {
                most = Some(steps);
                steps = next(steps);
            }
            let Some(steps) = most else { continue };
            let row = self.row(scheme, steps, span)?;
            table.push(format!("{}, {:.3e} s of the clock", words(&row), time(steps)));
            if best.as_ref().is_none_or(|(best, _)| row.error < best.error) {
                best = Some((row, time(steps)));
            }
        }
        let Some((row, time)) = best else {
            let message = format!("the run does not fit into {seconds} s");
            let help = format!("with {FEWEST} steps in the shortest contact it takes about {shortest:.3} s");
            return Err(vec![Diagnostic::error(span.clone(), message).help(help)]);
        };
        Ok(decided(row, Some(time), table))
    }
}

/// Schemes that are tried, the first one wins where they are equal.
const CANDIDATES: [IntegratorChoice; 4] = [
    IntegratorChoice::VelocityVerlet,
    IntegratorChoice::ContactResolved,
    IntegratorChoice::Leapfrog,
    IntegratorChoice::SymplecticEuler,
];

/// A scheme with the impacts of the scene.
struct Scheme {
    integrator: IntegratorChoice,
    plan: Plan,
    impacts: Impacts,
    /// Duration of the shortest contact \[s\].
    contact: f64,
    /// Largest step of an automatic choice \[s\].
    stable: f64,
}

fn decided(row: Row, seconds: Option<f64>, table: Vec<String>) -> Decided {
    Decided {
        setting: row.setting,
        quantity: "the velocities after an impact".into(),
        error: row.error,
        seconds,
        table,
        step: Some(row.step),
        against: None,
    }
}

/// The next number of steps in a contact, with three digits.
fn next(steps: f64) -> f64 {
    (steps * std::f64::consts::SQRT_2).round()
}

fn words(row: &Row) -> String {
    let single = if row.setting.precision == PrecisionChoice::Single { ", single precision" } else { "" };
    format!(
        "{} with {} steps in a contact{single}: {:.2e}",
        integrator_name(row.setting.integrator),
        row.setting.steps_per_contact,
        row.error
    )
}

/// Time of the clock that a step of a scene takes at its start \[s\].
fn seconds_a_step(threads: Option<usize>, plan: Plan) -> Result<f64, String> {
    let steps = plan.driver.steps.max(1);
    let mut driver = TimeStepDriver::new(Arc::new(plan), threads).map_err(|error| error.to_string())?;
    let never = AtomicBool::new(false);
    let mut advance = |to: u64| match driver.advance(to, &never) {
        Ok(Advance::Reached | Advance::Stopped) => Ok(()),
        Err(error) => Err(error.to_string()),
    };
    // The first steps build lists and fill caches.
    let warm = (steps / 100).clamp(1, 20);
    advance(warm)?;
    let (begin, mut done, mut stride) = (Instant::now(), warm, 1);
    while begin.elapsed() < PROBE && done < steps {
        done = steps.min(done + stride);
        advance(done)?;
        stride *= 2;
    }
    Ok(begin.elapsed().as_secs_f64() / (done - warm).max(1) as f64)
}
