//! Parameters that are known come back, with intervals that hold them as often as they say.

use granule_calibration::{Estimate, Fit, FitError, Impact, Options, Value, fit};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

const TRUTH: [f64; 3] = [0.9, 0.25, 0.4];

/// A normal deviate, by the sum of twelve uniform ones (its kurtosis is 0.1 off).
fn normal(random: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
}

/// Impacts of solid spheres at Ψ1 from `low` to `high`, with noise.
fn impacts(count: usize, low: f64, high: f64, noise: f64, seed: u64) -> Vec<Impact> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let [restitution, friction, sticking] = TRUTH;
    let loss = friction * (1.0 + restitution) * 3.5;
    (0..count)
        .map(|index| {
            let psi1 = low + (high - low) * index as f64 / (count - 1) as f64;
            let psi2 = (psi1 - loss).max(-sticking * psi1) + noise * normal(&mut random);
            Impact { psi1, psi2, restitution: Some(restitution + noise * normal(&mut random)) }
        })
        .collect()
}

fn value(estimate: &Estimate) -> Value {
    match estimate {
        Estimate::Value(value) => *value,
        Estimate::Undetermined { why, .. } => panic!("{why}"),
    }
}

fn all(fit: &Fit) -> [Value; 3] {
    [value(&fit.restitution), value(&fit.friction), value(&fit.tangential_restitution)]
}

#[test]
fn exact_data_give_exact_parameters() {
    let fit = fit(&impacts(20, 0.1, 5.0, 0.0, 1), &Options::default()).unwrap();
    for (found, truth) in all(&fit).iter().zip(TRUTH) {
        // Sums of twenty numbers of order one.
        assert!((found.value - truth).abs() < 1e-13, "{found:?} {truth}");
        assert!(found.error < 1e-13);
    }
    assert!(fit.remarks.is_empty() && fit.sliding + fit.sticking == 20);
    assert!(fit.sticking >= 4 && fit.sliding >= 10);
}

/// Of 400 data sets, intervals of 95 % and of 68 % hold the truth as often as they say: within four standard deviations of
/// the binomial distribution, 0.044 and 0.093.
#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    for (confidence, slack) in [(0.95, 0.044), (0.68, 0.093)] {
        let options = Options { confidence, ..Options::default() };
        let mut inside = [0; 3];
        for seed in 0..400 {
            let found = all(&fit(&impacts(30, 0.1, 4.0, 0.02, seed), &options).unwrap());
            for ((count, found), truth) in inside.iter_mut().zip(found).zip(TRUTH) {
                *count += u32::from((found.interval[0]..=found.interval[1]).contains(&truth));
            }
        }
        for count in inside {
            let share = f64::from(count) / 400.0;
            assert!((share - confidence).abs() < slack, "{inside:?} of 400 at {confidence}");
        }
    }
}

#[test]
fn what_the_data_cannot_determine_is_said() {
    let undetermined = |estimate: &Estimate| match estimate {
        Estimate::Undetermined { why, at_least } => (why.clone(), *at_least),
        Estimate::Value(value) => panic!("determined: {value:?}"),
    };
    // The corner lies at Ψ1 = 1.19.
    let sliding = fit(&impacts(20, 1.5, 5.0, 0.02, 7), &Options::default()).unwrap();
    let (why, at_least) = undetermined(&sliding.tangential_restitution);
    assert!(why.contains("every impact slid") && at_least.unwrap() < 0.4, "{why} {at_least:?}");
    assert!((value(&sliding.friction).value - 0.25).abs() < 0.01);
    let sticking = fit(&impacts(20, 0.1, 1.0, 0.01, 7), &Options::default()).unwrap();
    let (why, at_least) = undetermined(&sticking.friction);
    assert!(
        why.contains("every impact stuck") && (0.2..0.25).contains(&at_least.unwrap()),
        "{why} {at_least:?}"
    );
    assert!((value(&sticking.tangential_restitution).value - 0.4).abs() < 0.05);
    let mut ratios = impacts(20, 0.1, 5.0, 0.01, 7);
    ratios.iter_mut().for_each(|impact| impact.restitution = None);
    let blind = fit(&ratios, &Options::default()).unwrap();
    assert!(undetermined(&blind.friction).0.contains("without e_n"));
    assert!(undetermined(&blind.restitution).0.contains("no normal rebound"));
    assert!((value(&blind.sliding_loss).value - 0.25 * 1.9 * 3.5).abs() < 0.02);
    let told = fit(&ratios, &Options { restitution: Some(0.9), ..Options::default() }).unwrap();
    assert!((value(&told.friction).value - 0.25).abs() < 0.005);
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    assert_eq!(fit(&impacts(2, 0.1, 1.0, 0.0, 1), &Options::default()), Err(FitError::TooFew(2)));
    let data = impacts(9, 0.1, 4.0, 0.0, 1);
    for options in [
        Options { inertia_factor: 0.0, ..Options::default() },
        Options { confidence: 1.0, ..Options::default() },
        Options { restitution: Some(1.5), ..Options::default() },
    ] {
        assert!(matches!(fit(&data, &options), Err(FitError::NotAllowed(_))), "{options:?}");
    }
    let gain: Vec<Impact> =
        data.iter().map(|impact| Impact { psi2: -1.5 * impact.psi1, ..*impact }).collect();
    let fit = fit(&gain, &Options::default()).unwrap();
    assert!(fit.remarks[0].contains("e_t0 = 1.5"), "{:?}", fit.remarks);
}
