//! Errors and costs of settings, and which settings are worth having.

use crate::Setting;
use crate::measure::Sample;
use crate::observable::Kind;
use crate::reference::{Reference, difference, distance};

/// A setting with its error and cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Scored {
    /// The setting.
    pub setting: Setting,
    /// Relative error of each observable: of the worst run for paths, of the mean over the runs for means.
    pub errors: Vec<f64>,
    /// Uncertainty of each error: for paths how much further the worst run may be (as much as the runs' errors differ) and the uncertainty of the reference, for means two standard errors of the differences from the reference, run by run.
    pub bars: Vec<f64>,
    /// The largest error.
    pub error: f64,
    /// Its uncertainty.
    pub bar: f64,
    /// The error is not told apart from zero by these runs.
    pub unresolved: bool,
    /// Wall-clock time on one thread for one second of the scene \[s\].
    pub cost: f64,
    /// Time steps for one second of the scene.
    pub steps_per_second: f64,
    /// Time step \[s\].
    pub step: f64,
    /// Bytes of state and lists a body.
    pub bytes_per_body: f64,
    /// Some other setting costs less and errs less.
    pub dominated: bool,
}

impl Scored {
    /// What a user can rely on: the error, or what the runs could have told of it.
    pub fn reliable_error(&self) -> f64 {
        if self.unresolved { self.bar } else { self.error + self.bar }
    }
}

pub(crate) fn score(
    setting: Setting,
    kind: Kind,
    samples: &[Sample],
    reference: &Reference,
    duration: f64,
) -> Scored {
    let (mut errors, mut bars) = (Vec::new(), Vec::new());
    for at in 0..reference.values.len() {
        let scale = reference.scale[at];
        match kind {
            Kind::Paths => {
                let each: Vec<f64> = samples
                    .iter()
                    .map(|sample| distance(&sample.values[at], &reference.values[at], scale))
                    .collect();
                let (least, most) = each.iter().fold((f64::INFINITY, 0.0_f64), |(least, most), error| {
                    (least.min(*error), most.max(*error))
                });
                // The error of a run depends on the phases at which contacts begin, with a long tail: a run that was not
                // made may be worse by about as much as those that were made differ.
                let further = most - least;
                errors.push(most);
                bars.push(further + reference.uncertainty[at]);
            }
            Kind::Means => {
                let share = |value: f64| if scale > 0.0 { value / scale } else { value };
                let (error, deviation) = difference(samples, &reference.runs, at);
                errors.push(share(error));
                bars.push(2.0 * share(deviation));
            }
        }
    }
    let worst = (0..errors.len()).max_by(|a, b| errors[*a].total_cmp(&errors[*b])).unwrap_or(0);
    let (error, bar) = (errors[worst], bars[worst]);
    let mut walls: Vec<f64> = samples.iter().map(|sample| sample.wall).collect();
    walls.sort_by(f64::total_cmp);
    let steps = samples.iter().map(|sample| sample.steps as f64).sum::<f64>() / samples.len() as f64;
    Scored {
        setting,
        unresolved: (0..errors.len()).all(|at| errors[at] <= bars[at]) && kind == Kind::Means,
        errors,
        error,
        bar: if kind == Kind::Means { bars.iter().copied().fold(0.0, f64::max) } else { bar },
        bars,
        cost: walls[walls.len() / 2] / duration,
        steps_per_second: steps / duration,
        step: samples[0].step,
        bytes_per_body: samples[0].bytes_per_body,
        dominated: false,
    }
}

/// Marks what another setting beats in cost and in error. Errors that the runs do not tell from zero count as their bars.
pub(crate) fn mark(settings: &mut [Scored]) {
    let errors: Vec<(f64, f64)> = settings
        .iter()
        .map(|scored| (scored.cost, if scored.unresolved { scored.bar } else { scored.error }))
        .collect();
    for (at, scored) in settings.iter_mut().enumerate() {
        let (cost, error) = errors[at];
        scored.dominated = errors.iter().enumerate().any(|(other, (c, e))| {
            other != at && *c <= cost && *e <= error && (*c < cost || *e < error || other < at)
        });
    }
}

/// The cheapest setting whose error can be relied on to be at most `target`.
pub(crate) fn choose(settings: &[Scored], target: f64) -> Option<&Scored> {
    settings
        .iter()
        .filter(|scored| scored.reliable_error() <= target)
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
}

#[cfg(test)]
mod tests {
    use granule_scene::{IntegratorChoice, PrecisionChoice};

    use super::*;
    use crate::Omission;

    fn scored(cost: f64, error: f64, bar: f64) -> Scored {
        Scored {
            setting: Setting {
                integrator: IntegratorChoice::VelocityVerlet,
                steps_per_contact: 10.0,
                precision: PrecisionChoice::Double,
                stiffness: 1.0,
                without: Omission::None,
            },
            errors: vec![error],
            bars: vec![bar],
            error,
            bar,
            unresolved: error <= bar,
            cost,
            steps_per_second: 1.0,
            step: 1.0,
            bytes_per_body: 1.0,
            dominated: false,
        }
    }

    #[test]
    fn the_front_is_what_nothing_beats() {
        let mut all = vec![
            scored(1.0, 0.1, 0.01),
            scored(2.0, 0.05, 0.01),
            scored(2.5, 0.06, 0.01),
            scored(4.0, 0.001, 0.02),
            scored(5.0, 0.0, 0.02),
        ];
        mark(&mut all);
        let marks: Vec<bool> = all.iter().map(|scored| scored.dominated).collect();
        assert_eq!(marks, [false, false, true, false, true]);
        assert_eq!(choose(&all, 0.065).unwrap().cost, 2.0);
        assert_eq!(choose(&all, 0.02).unwrap().cost, 4.0, "an unresolved error counts as its bar");
        assert!(choose(&all, 1e-3).is_none());
    }
}
