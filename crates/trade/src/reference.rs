//! What the errors are measured against, and how well it is known.

use crate::TradeError;
use crate::measure::Sample;
use crate::observable::{Kind, Observable};

/// Means over realisations of each component of each observable, with their spread.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mean {
    pub values: Vec<Vec<f64>>,
    /// Largest distance of a realisation from the mean, by observable.
    pub spread: Vec<f64>,
    /// Largest standard error of a component, by observable.
    pub standard_error: Vec<f64>,
    /// Size, by observable.
    pub scale: Vec<f64>,
}

/// What the errors are measured against.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Means over the finest runs.
    pub(crate) values: Vec<Vec<f64>>,
    /// The finest runs: errors of means are differences run by run, of equal initial states.
    pub(crate) runs: Vec<Sample>,
    /// Size of each observable, which errors are divided by.
    pub scale: Vec<f64>,
    /// Relative uncertainty of each observable.
    pub uncertainty: Vec<f64>,
    /// Steps in a contact of the finest runs.
    pub steps_per_contact: f64,
    /// Realisations of the finest runs.
    pub realisations: usize,
}

/// Paths whose reference is less certain than this share of their size are no paths to compare with.
const CERTAIN: f64 = 0.01;
/// Changes below this share of the size are round-off.
const ROUND_OFF: f64 = 1e-9;

pub(crate) fn mean(samples: &[Sample]) -> Mean {
    let count = samples.len() as f64;
    let mut values = samples[0].values.clone();
    for sample in &samples[1..] {
        for (sum, value) in values.iter_mut().flatten().zip(sample.values.iter().flatten()) {
            *sum += value;
        }
    }
    values.iter_mut().flatten().for_each(|value| *value /= count);
    let observables = 0..values.len();
    let deviations = |observable: usize, component: usize| {
        samples.iter().map(move |sample| sample.values[observable][component])
    };
    let over_components = |of: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
        observables
            .clone()
            .map(|observable| (0..values[observable].len()).map(|at| of(observable, at)).fold(0.0, f64::max))
            .collect()
    };
    let spread = over_components(&|observable, at| {
        deviations(observable, at).map(|v| (v - values[observable][at]).abs()).fold(0.0, f64::max)
    });
    let standard_error = over_components(&|observable, at| {
        let squares: f64 = deviations(observable, at).map(|v| (v - values[observable][at]).powi(2)).sum();
        (squares / (count - 1.0).max(1.0) / count).sqrt()
    });
    let scale = observables
        .clone()
        .map(|observable| samples.iter().map(|sample| sample.scales[observable]).fold(0.0, f64::max))
        .collect();
    Mean { values, spread, standard_error, scale }
}

/// Largest distance of two results, over the size of the observable. An observable that is zero throughout has no size
/// and no error.
pub(crate) fn distance(a: &[f64], b: &[f64], scale: f64) -> f64 {
    let most = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if scale > 0.0 { most / scale } else { most }
}

/// Mean difference of two sets of runs, run by run, and its standard error; of the component where it is largest.
pub(crate) fn difference(a: &[Sample], b: &[Sample], observable: usize) -> (f64, f64) {
    let count = a.len().min(b.len()) as f64;
    let mut worst = (0.0, 0.0);
    for at in 0..a[0].values[observable].len() {
        let each = |a: &Sample, b: &Sample| a.values[observable][at] - b.values[observable][at];
        let mean = a.iter().zip(b).map(|(a, b)| each(a, b)).sum::<f64>() / count;
        let squares: f64 = a.iter().zip(b).map(|(a, b)| (each(a, b) - mean).powi(2)).sum();
        let error = (squares / (count - 1.0).max(1.0) / count).sqrt();
        if mean.abs() >= f64::abs(worst.0) {
            worst = (mean, error);
        }
    }
    (worst.0.abs(), worst.1)
}

/// Judges runs at ever finer steps, the finest last.
pub(crate) fn judge(
    kind: Kind,
    observables: &[Observable],
    rungs: &[(f64, Vec<Sample>)],
) -> Result<Reference, TradeError> {
    let [.., (_, runs_before), (steps_per_contact, finest_runs)] = rungs else {
        return Err(TradeError::Nothing("a reference needs two settings".into()));
    };
    let (coarsest, before, finest) = (mean(&rungs[0].1), mean(runs_before), mean(finest_runs));
    let mut uncertainty = Vec::new();
    for (at, observable) in observables.iter().enumerate() {
        let scale = finest.scale[at];
        let share = |value: f64| if scale > 0.0 { value / scale } else { value };
        let change = distance(&before.values[at], &finest.values[at], scale);
        let refuse = |change: f64, allowed: f64, advice: &str| {
            Err(TradeError::NotConverged {
                quantity: observable.name().to_string(),
                change,
                allowed,
                advice: advice.to_string(),
            })
        };
        match kind {
            Kind::Paths => {
                let spread = share(finest.spread[at]);
                let known = spread.max(change);
                if known > CERTAIN {
                    return refuse(
                        known,
                        CERTAIN,
                        "the paths are chaotic or discontinuous: a shorter run has an answer, or quantities that are no paths",
                    );
                }
                let first = share(coarsest.spread[at]);
                if spread > 0.5 * first && spread > ROUND_OFF {
                    return refuse(spread, 0.5 * first, "a smaller step does not make it more certain");
                }
                uncertainty.push(known);
            }
            Kind::Means => {
                let (change, error) = difference(runs_before, finest_runs, at);
                // Four standard errors of few runs; runs without any scatter must not change at all.
                let (change, allowed) = (share(change), 4.0 * share(error) + ROUND_OFF);
                if change > allowed {
                    return refuse(
                        change,
                        allowed,
                        "the mean depends on the step even at the finest: give it more steps in a contact",
                    );
                }
                uncertainty.push(share(finest.standard_error[at]));
            }
        }
    }
    Ok(Reference {
        values: finest.values.clone(),
        runs: finest_runs.clone(),
        scale: finest.scale.clone(),
        uncertainty,
        steps_per_contact: *steps_per_contact,
        realisations: finest_runs.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(values: &[f64]) -> Vec<Sample> {
        values
            .iter()
            .map(|value| Sample {
                values: vec![vec![*value]],
                scales: vec![1.0],
                wall: 1.0,
                steps: 1,
                step: 1.0,
                bytes_per_body: 1.0,
            })
            .collect()
    }

    fn rungs(values: &[&[f64]]) -> Vec<(f64, Vec<Sample>)> {
        values.iter().map(|values| (100.0, samples(values))).collect()
    }

    #[test]
    fn mean_spread_and_standard_error() {
        let mean = mean(&samples(&[1.0, 2.0, 6.0]));
        assert_eq!((mean.values[0][0], mean.spread[0]), (3.0, 3.0));
        assert!((mean.standard_error[0] - (14.0_f64 / 6.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn paths_converge_when_their_spread_falls() {
        let good = rungs(&[&[1.0, 1.004], &[1.0015, 1.0025], &[1.002, 1.0022]]);
        let reference = judge(Kind::Paths, &[Observable::Velocities], &good).unwrap();
        assert!((reference.values[0][0] - 1.0021).abs() < 1e-12);
        let chaotic = rungs(&[&[1.0, 1.3], &[0.8, 1.1], &[1.2, 0.9]]);
        let error = judge(Kind::Paths, &[Observable::Velocities], &chaotic).unwrap_err().to_string();
        assert!(error.contains("chaotic") && error.contains("velocities"), "{error}");
        let stuck = rungs(&[&[1.0, 1.004], &[1.0, 1.004], &[1.0, 1.004]]);
        assert!(judge(Kind::Paths, &[Observable::Velocities], &stuck).is_err());
    }

    #[test]
    fn means_converge_when_they_stop_to_move() {
        let good = rungs(&[&[1.0, 1.1, 0.9], &[1.02, 1.08, 0.95]]);
        let reference = judge(Kind::Means, &[Observable::Velocities], &good).unwrap();
        assert_eq!(reference.realisations, 3);
        let (change, error) = difference(&good[1].1, &good[0].1, 0);
        assert!((change - 0.05 / 3.0).abs() < 1e-12 && error > 0.0, "{change} {error}");
        let moving = rungs(&[&[1.0, 1.01, 0.99], &[1.2, 1.21, 1.19]]);
        assert!(judge(Kind::Means, &[Observable::Velocities], &moving).is_err());
    }
}
