//! Driver settings: scheme, search, skin, time step, number of steps.

use std::ops::Range;

use granule_scene::{EveryChoice, RunBlock, StepChoice};

use crate::build::Builder;
use crate::limits::{Limits, limits};
use crate::model::{Partner, Plan, Scheme, Search, TimeStepPlan};
use crate::place::FEWEST_STEPS;

/// Up to this many bodies, looking at every pair is faster than a search structure.
const FEW: usize = 16;
/// Default skin as a share of the mean radius.
const SKIN: f64 = 0.2;
/// Largest number of steps: beyond it, times are no longer exact multiples of the step.
pub(crate) const MOST_STEPS: f64 = 9_007_199_254_740_992.0;

/// Share of the largest stable step that an automatic step may reach.
const SAFETY: f64 = 0.5;

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
    if let Some(event) = &scene.event {
        return if judged { crate::event::schedule(builder, plan, event) } else { Some(()) };
    }
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
    let mut limits = limits(plan);
    if limits.crowded && !builder.scene.driver.packing_limit {
        limits.crowded = false;
        let why = format!("the scene lifts the limit of a dense packing, {:.6e} s", limits.packing);
        builder.decide_one("packing limit", false, why);
    }
    plan.driver.step_limit = limits.step();
    let (mut step, why) = match choice.value {
        StepChoice::Fixed(step) => {
            judge(builder, &choice.span, step, &limits);
            (step, "given by the scene".to_string())
        }
        StepChoice::Auto { steps_per_contact } => {
            automatic_step(builder, &choice.span, steps_per_contact, &limits)?
        }
    };
    let automatic = matches!(choice.value, StepChoice::Auto { .. });
    let steps = match run {
        RunBlock::Steps(steps) => steps.value as f64,
        RunBlock::Duration(duration) => {
            if automatic {
                step = fitted(step, duration.value, shortest_interval(builder));
            }
            let exact = duration.value / step;
            let (steps, fits) = whole(exact);
            if !fits {
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

/// A share of the shortest contact, and never near the limit of stability.
fn automatic_step(
    builder: &mut Builder<'_>,
    span: &Range<usize>,
    steps_per_contact: f64,
    limits: &Limits,
) -> Option<(f64, String)> {
    let by_contact = limits.shortest_contact.map(|duration| {
        let why = format!("{steps_per_contact} steps in the shortest contact of {duration:.6e} s");
        (duration / steps_per_contact, why)
    });
    let safe = SAFETY * limits.step();
    match by_contact {
        Some((step, why)) if step <= safe => Some((step, why)),
        _ if safe.is_finite() => {
            Some((safe, format!("{SAFETY} of the largest stable step; {}", limits.stiffest)))
        }
        _ => {
            builder.error_help(
                span.clone(),
                "the time step cannot be chosen: no law of this scene has a contact duration",
                "give a step, as in `driver: TimeStep(step: \"1e-5 s\")`",
            );
            None
        }
    }
}

/// Refuses a step at which the scene is unstable, and warns of one that follows no contact.
fn judge(builder: &mut Builder<'_>, span: &Range<usize>, step: f64, limits: &Limits) {
    let limit = limits.step();
    if step > limit {
        let why = if limits.crowded && step <= limits.pair {
            format!(
                "a single pair would be stable up to {:.6e} s, but a body in a packing is held by all its neighbours: {:.6e} s \
                 (`packing_limit: false` lifts this for a loose one)",
                limits.pair, limits.packing
            )
        } else {
            limits.stiffest.clone()
        };
        let here = limits.place.as_ref().map(|place| {
            let crowded = limits.crowded && limits.packing < limits.pair;
            place.describe(step, place.duration / limit, crowded) + "; "
        });
        builder.error_help(
            span.clone(),
            format!("a time step of {step:e} s is unstable here: the largest is {limit:.6e} s"),
            format!("{why}; {}`step: Auto()` chooses one", here.unwrap_or_default()),
        );
    } else if let Some(duration) = limits.shortest_contact
        && step * FEWEST_STEPS > duration
    {
        builder.warning(
            span.clone(),
            format!("the shortest contact, {duration:.6e} s, has only {:.1} steps", duration / step),
            match &limits.place {
                Some(place) => {
                    let here = place.describe(step, FEWEST_STEPS, false);
                    format!("stable, but inaccurate, 50 are usual; {here}")
                }
                None => format!("stable, but inaccurate: {FEWEST_STEPS} steps are few, 50 are usual"),
            },
        );
    }
}

/// The number of steps of a run that is `exact` steps long, and whether it fits: rounded up, but not for the round-off of the
/// quotient.
pub(crate) fn whole(exact: f64) -> (f64, bool) {
    let nearest = exact.round();
    // Duration, step and their quotient are each rounded by half an ulp.
    let round_off = 4.0 * f64::EPSILON * exact;
    let steps = if (exact - nearest).abs() <= round_off.max(1e-9) { nearest } else { exact.ceil() };
    (steps, (steps - exact).abs() <= round_off.max(1e-6))
}

/// Shortest interval of an output that is given as a time \[s\].
pub(crate) fn shortest_interval(builder: &Builder<'_>) -> Option<f64> {
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
    if (1.0..=MOST_STEPS).contains(&number) { whole / number } else { step }
}

#[cfg(test)]
mod tests {
    use super::whole;

    #[test]
    fn durations_are_whole_numbers_of_steps_up_to_round_off() {
        assert_eq!(whole(1000.0 / 1e-7), (1e10, true));
        assert_eq!(whole(1e-3 / 1e-5), (100.0, true));
        assert_eq!(whole(99.7), (100.0, false));
        assert_eq!(whole(100.001), (101.0, false));
        assert_eq!(whole(1e10 + 0.5), (1e10 + 1.0, false));
        assert_eq!(whole(0.0), (0.0, true));
    }
}
