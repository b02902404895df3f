//! Driver settings: scheme, search, skin, time step, number of steps.

use granule_law_api::Impact;
use granule_scene::{EveryChoice, RunBlock, StepChoice};

use crate::build::Builder;
use crate::model::{Partner, Plan, Scheme, Search, TimeStepPlan};

/// Up to this many bodies, looking at every pair is faster than a search structure.
const FEW: usize = 16;
/// Default skin as a share of the mean radius.
const SKIN: f64 = 0.2;
/// Largest number of steps: beyond it, times are no longer exact multiples of the step.
const MOST_STEPS: f64 = 9_007_199_254_740_992.0;

/// Settings before anything is known.
pub(crate) fn blank(scheme: Scheme) -> TimeStepPlan {
    TimeStepPlan {
        scheme,
        step: 0.0,
        steps: 0,
        step_limit: f64::INFINITY,
        search: Search::None,
        skin: 0.0,
        threads: None,
    }
}

/// Fills in the driver of a plan. Without `judged`, only what does not depend on laws. `None` if the time step cannot
/// be known.
pub(crate) fn driver(builder: &mut Builder<'_>, plan: &mut Plan, judged: bool) -> Option<()> {
    let scene = builder.scene;
    plan.driver.threads = scene.driver.threads.as_ref().map(|threads| threads.value as usize);
    search(builder, plan, judged);
    if !judged {
        return Some(());
    }
    let run = scene.run.as_ref()?;
    step(builder, plan, run)
}

fn search(builder: &mut Builder<'_>, plan: &mut Plan, judged: bool) {
    let count = plan.bodies.len();
    let pairs = plan.compositions.iter().any(|composition| matches!(composition.partner, Partner::Body(_)));
    let (search, why) = if !pairs || count < 2 {
        (Search::None, "no two bodies interact".to_string())
    } else if count <= FEW {
        (Search::AllPairs, format!("no search structure: all pairs of {count} bodies are looked at"))
    } else {
        (Search::Grid, format!("{count} bodies: Verlet lists from a grid"))
    };
    plan.driver.search = search;
    let mean = plan.bodies.radius.iter().sum::<f64>() / count.max(1) as f64;
    let given = builder.scene.driver.skin.as_ref();
    if search == Search::Grid {
        plan.driver.skin = given.map_or(SKIN * mean, |skin| skin.value);
    }
    let why = match (search, given) {
        (Search::Grid, Some(_)) => {
            format!("{why} with the skin of {:.3e} m that the scene gives", plan.driver.skin)
        }
        (Search::Grid, None) => {
            format!("{why} with a skin of {:.3e} m, {SKIN} of the mean radius", plan.driver.skin)
        }
        (_, Some(skin)) => {
            builder.warning(skin.span.clone(), "`skin` has no effect", why.clone());
            why
        }
        (_, None) => why,
    };
    builder.decide_one("search structure", search == Search::Grid, why);
    if let Some(block) = &builder.scene.cell
        && judged
        && pairs
    {
        let largest = plan.bodies.radius.iter().fold(0.0, |a: f64, b| a.max(*b));
        let reach = plan.compositions.iter().fold(0.0, |a: f64, b| a.max(b.reach));
        if let Err(error) = plan.cell.check_minimum_length(largest, plan.driver.skin + reach) {
            builder.error_help(block.span.clone(), error.to_string(), "a larger cell, or a smaller skin");
        }
    }
}

fn step(builder: &mut Builder<'_>, plan: &mut Plan, run: &RunBlock) -> Option<()> {
    let choice = builder.scene.driver.step.clone();
    let (mut step, why) = match choice.value {
        StepChoice::Fixed(step) => (step, "given by the scene".to_string()),
        StepChoice::Auto { steps_per_contact } => match shortest_contact(plan) {
            Some(duration) => {
                let why = format!("{steps_per_contact} steps in the shortest contact of {duration:.6e} s");
                (duration / steps_per_contact, why)
            }
            None => {
                builder.error_help(
                    choice.span.clone(),
                    "the time step cannot be chosen: no law of this scene has a contact duration",
                    "give a step, as in `driver: TimeStep(step: \"1e-5 s\")`",
                );
                return None;
            }
        },
    };
    let automatic = matches!(choice.value, StepChoice::Auto { .. });
    let steps = match run {
        RunBlock::Steps(steps) => steps.value as f64,
        RunBlock::Duration(duration) => {
            if automatic {
                step = fitted(step, duration.value, shortest_interval(builder));
            }
            let exact = duration.value / step;
            let steps = (exact - 1e-9 * exact.max(1.0)).ceil().max(0.0);
            if (steps - exact).abs() > 1e-6 {
                let help = if automatic {
                    "the step fits the shortest interval of an output; choose a duration that is a multiple of it"
                } else {
                    "choose a step that divides the duration, or `Auto()`"
                };
                builder.warning(
                    duration.span.clone(),
                    format!(
                        "the duration is {exact:.3} steps of {step:e} s; the run takes {steps} steps, {:e} s",
                        steps * step
                    ),
                    help,
                );
            }
            steps
        }
    };
    if !(steps <= MOST_STEPS && step > 0.0) {
        let span = match run {
            RunBlock::Duration(duration) => duration.span.clone(),
            RunBlock::Steps(steps) => steps.span.clone(),
        };
        builder.error(span, format!("{steps:e} steps are more than can be counted"));
        return None;
    }
    plan.driver.step = step;
    plan.driver.steps = steps as u64;
    builder.decide_one("time step", true, format!("{step:.6e} s, {} steps: {why}", plan.driver.steps));
    Some(())
}

/// Duration of the shortest contact between the bodies of the scene \[s\].
fn shortest_contact(plan: &Plan) -> Option<f64> {
    let mut shortest: Option<f64> = None;
    for composition in &plan.compositions {
        let context = &composition.context;
        for reduced_mass in [context.reduced_mass.min, context.reduced_mass.max] {
            for reduced_radius in [context.reduced_radius.min, context.reduced_radius.max] {
                let impact = Impact { reduced_mass, reduced_radius, normal_speed: context.impact_speed };
                for stage in &composition.stages {
                    let scale = (stage.law.time_scale)(&stage.params, context, &impact).ok().flatten();
                    if let Some(scale) =
                        scale.filter(|scale| scale.duration > 0.0 && scale.duration.is_finite())
                    {
                        shortest = Some(shortest.map_or(scale.duration, |least| least.min(scale.duration)));
                    }
                }
            }
        }
    }
    shortest
}

/// Shortest interval of an output that is given as a time \[s\].
fn shortest_interval(builder: &Builder<'_>) -> Option<f64> {
    let intervals =
        builder.scene.outputs.items.iter().filter_map(|output| match output.every.as_ref()?.value {
            EveryChoice::Time(time) => Some(time),
            EveryChoice::Steps(_) => None,
        });
    intervals.min_by(f64::total_cmp)
}

/// The largest step, `step` at most, of which the interval between outputs, or else the duration, is a whole number.
fn fitted(step: f64, duration: f64, interval: Option<f64>) -> f64 {
    let whole = interval.filter(|interval| *interval < duration).unwrap_or(duration);
    let number = (whole / step * (1.0 - 1e-12)).ceil();
    if number >= 1.0 && number <= MOST_STEPS { whole / number } else { step }
}
