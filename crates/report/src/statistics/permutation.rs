//! Two-sample permutation test: no assumption about the distribution but that, if both programs are the same, which run
//! came from which is a matter of labels.

use super::check;
use crate::ReportError;
use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha12Rng;

/// How far to go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PermutationSettings {
    /// All arrangements are enumerated if there are at most this many.
    pub exact_up_to: u64,
    /// Otherwise so many random arrangements are drawn.
    pub draws: u64,
    /// Seed of the draws (ChaCha12): the same seed gives the same p-value.
    pub seed: u64,
}

impl Default for PermutationSettings {
    /// Exact up to 200 000 arrangements (two samples of 10 have 184 756), else 100 000 draws from seed 1.
    fn default() -> Self {
        Self { exact_up_to: 200_000, draws: 100_000, seed: 1 }
    }
}

/// Result of a permutation test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PermutationTest {
    /// The statistic of the two samples as they are.
    pub statistic: f64,
    /// The chance of a statistic at least as large if the labels mean nothing. Rejecting when `p_value <= level` gives a
    /// false alarm with a probability of at most `level`, exactly.
    pub p_value: f64,
    /// All arrangements were enumerated.
    pub exact: bool,
    /// Arrangements looked at.
    pub arrangements: u64,
    /// The smallest p-value that samples of these sizes can give with a statistic that does not tell `a` from `b`
    /// (two arrangements are then always alike). A level below it can never be met: the test has no power there.
    pub least_p_value: f64,
}

/// Tests whether `a` and `b` come from one distribution. `statistic` must be larger the more two samples differ, such as
/// [`super::difference_of_means`] or the distance of [`super::kolmogorov_smirnov`]. It is called with samples of the
/// same two lengths each time.
///
/// The random version counts the given arrangement among the draws, `p = (1 + hits) / (1 + draws)`, so that p is never
/// zero and the stated false-alarm rate holds (Phipson and Smyth 2010, Eq. (2)).
///
/// # Errors
/// An empty sample, a value or a statistic that is not finite, or zero draws where draws are needed.
pub fn permutation_test(
    a: &[f64],
    b: &[f64],
    settings: PermutationSettings,
    mut statistic: impl FnMut(&[f64], &[f64]) -> f64,
) -> Result<PermutationTest, ReportError> {
    check("permutation test, first sample", a, 1)?;
    check("permutation test, second sample", b, 1)?;
    let observed = statistic(a, b);
    if !observed.is_finite() {
        return Err(ReportError::NotFinite {
            what: "statistic of the permutation test".to_owned(),
            index: 0,
        });
    }
    // Arrangements that are equal in exact arithmetic may differ by rounding; they must count as equal.
    let scale = a.iter().chain(b).fold(observed.abs(), |m, v| m.max(v.abs()));
    let threshold = observed - 1e-12 * observed.abs() - 4.0 * f64::EPSILON * scale;
    let pool: Vec<f64> = a.iter().chain(b).copied().collect();
    let total = binomial(pool.len() as u64, a.len() as u64);
    let alike = if a.len() == b.len() && pool.len() > 1 { 2.0 } else { 1.0 };
    match total {
        Some(total) if total <= settings.exact_up_to => {
            let mut hits = 0;
            for_each_choice(&pool, a.len(), |x, y| hits += u64::from(statistic(x, y) >= threshold));
            Ok(PermutationTest {
                statistic: observed,
                p_value: hits as f64 / total as f64,
                exact: true,
                arrangements: total,
                least_p_value: alike / total as f64,
            })
        }
        _ if settings.draws == 0 => Err(ReportError::Invalid(
            "permutation test: too many arrangements to enumerate, and no draws allowed".to_owned(),
        )),
        _ => {
            let mut random = ChaCha12Rng::seed_from_u64(settings.seed);
            let mut shuffled = pool;
            let mut hits = 0;
            for _ in 0..settings.draws {
                choose_front(&mut shuffled, a.len(), &mut random);
                let (x, y) = shuffled.split_at(a.len());
                hits += u64::from(statistic(x, y) >= threshold);
            }
            let least = total.map_or(0.0, |t| alike / t as f64);
            Ok(PermutationTest {
                statistic: observed,
                p_value: (1 + hits) as f64 / (1 + settings.draws) as f64,
                exact: false,
                arrangements: settings.draws,
                least_p_value: least.max(1.0 / (1 + settings.draws) as f64),
            })
        }
    }
}

/// Binomial coefficient; `None` if it does not fit.
fn binomial(n: u64, k: u64) -> Option<u64> {
    let k = k.min(n - k);
    let mut result: u128 = 1;
    for i in 0..k {
        result = result * u128::from(n - i) / u128::from(i + 1);
        if result > u128::from(u64::MAX) {
            return None;
        }
    }
    u64::try_from(result).ok()
}

/// Calls `visit` with every choice of `k` values of the pool and the values left, in lexicographic order of places.
fn for_each_choice(pool: &[f64], k: usize, mut visit: impl FnMut(&[f64], &[f64])) {
    let n = pool.len();
    let mut places: Vec<usize> = (0..k).collect();
    let (mut chosen, mut left) = (Vec::with_capacity(k), Vec::with_capacity(n - k));
    loop {
        chosen.clear();
        left.clear();
        let mut next = places.iter().peekable();
        for (index, value) in pool.iter().enumerate() {
            if next.next_if(|place| **place == index).is_some() {
                chosen.push(*value);
            } else {
                left.push(*value);
            }
        }
        visit(&chosen, &left);
        // The last place that can still move right does; those behind it follow closely.
        let Some(moving) = (0..k).rev().find(|&i| places[i] < n - k + i) else { return };
        places[moving] += 1;
        for i in moving + 1..k {
            places[i] = places[i - 1] + 1;
        }
    }
}

/// Moves a uniformly random choice of `k` values to the front (the first `k` steps of a Fisher-Yates shuffle).
fn choose_front(values: &mut [f64], k: usize, random: &mut ChaCha12Rng) {
    let n = values.len();
    for i in 0..k {
        values.swap(i, i + below((n - i) as u64, random) as usize);
    }
}

/// A uniform integer below `bound`: draws from the incomplete last block are thrown away.
fn below(bound: u64, random: &mut ChaCha12Rng) -> u64 {
    let whole = u64::MAX - u64::MAX % bound;
    loop {
        let draw = random.next_u64();
        if draw < whole {
            return draw % bound;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::difference_of_means;
    use super::*;

    #[test]
    fn separated_samples_have_the_smallest_p_value() {
        for (n, arrangements) in [(3u32, 20), (5, 252), (7, 3432)] {
            let a: Vec<f64> = (0..n).map(f64::from).collect();
            let b: Vec<f64> = a.iter().map(|v| v + 100.0).collect();
            let test = permutation_test(&a, &b, PermutationSettings::default(), difference_of_means).unwrap();
            assert!(test.exact);
            assert_eq!(test.arrangements, arrangements);
            assert_eq!(test.p_value, 2.0 / arrangements as f64);
            assert_eq!(test.p_value, test.least_p_value);
        }
    }

    #[test]
    fn a_p_value_counted_by_hand() {
        // Pool 1, 2, 3, 4, 6 with a = {1, 2}: the sum 3 of a differs from its mean 6.4 by 3.4. Of the ten pairs only
        // 1 + 2 = 3 and 4 + 6 = 10 (difference 3.6) are as far off.
        let test = permutation_test(
            &[1.0, 2.0],
            &[3.0, 4.0, 6.0],
            PermutationSettings::default(),
            difference_of_means,
        )
        .unwrap();
        assert_eq!((test.p_value, test.arrangements), (0.2, 10));
    }

    #[test]
    fn equal_samples_never_differ() {
        let test =
            permutation_test(&[0.1; 4], &[0.1; 6], PermutationSettings::default(), difference_of_means)
                .unwrap();
        assert_eq!(test.p_value, 1.0);
    }

    #[test]
    fn draws_agree_with_enumeration_and_repeat() {
        let a = [0.3, 1.1, 0.8, 1.9, 0.2, 1.4];
        let b = [1.3, 2.1, 1.8, 0.9, 2.2, 1.7];
        let exact = permutation_test(&a, &b, PermutationSettings::default(), difference_of_means).unwrap();
        let draws = PermutationSettings { exact_up_to: 0, draws: 40_000, seed: 7 };
        let drawn = permutation_test(&a, &b, draws, difference_of_means).unwrap();
        assert!(exact.exact && !drawn.exact);
        // scipy.stats.permutation_test, all arrangements, statistic |mean a - mean b|: 66 of 924.
        assert_eq!(exact.p_value, 66.0 / 924.0);
        // Five standard deviations of a binomial share.
        let deviation = (exact.p_value * (1.0 - exact.p_value) / 40_000.0).sqrt();
        assert!(
            (drawn.p_value - exact.p_value).abs() < 5.0 * deviation,
            "{} {}",
            drawn.p_value,
            exact.p_value
        );
        assert_eq!(drawn, permutation_test(&a, &b, draws, difference_of_means).unwrap());
    }

    #[test]
    fn the_false_alarm_rate_is_the_level() {
        // 2000 pairs of samples of 5 from one distribution: p <= 12/252 happens with probability 12/252 exactly (the
        // p-values are 2/252, 4/252, ...). Five standard deviations: 0.0476 +- 0.0238.
        let mut random = ChaCha12Rng::seed_from_u64(11);
        let mut uniform = || (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        let mut alarms = 0;
        for _ in 0..2000 {
            let a: Vec<f64> = (0..5).map(|_| uniform()).collect();
            let b: Vec<f64> = (0..5).map(|_| uniform()).collect();
            let test = permutation_test(&a, &b, PermutationSettings::default(), difference_of_means).unwrap();
            alarms += u32::from(test.p_value <= 12.0 / 252.0);
        }
        let rate = f64::from(alarms) / 2000.0;
        assert!((rate - 12.0 / 252.0).abs() < 0.0238, "{rate}");
    }

    #[test]
    fn binomials_that_do_not_fit_are_told() {
        assert_eq!(binomial(10, 5), Some(252));
        assert_eq!(binomial(64, 32), Some(1_832_624_140_942_590_534));
        assert_eq!(binomial(100, 50), None);
        assert_eq!(binomial(5, 0), Some(1));
    }

    #[test]
    fn every_choice_is_visited_once() {
        let mut seen = Vec::new();
        for_each_choice(&[1.0, 2.0, 4.0, 8.0, 16.0], 3, |x, y| {
            assert_eq!(x.iter().chain(y).sum::<f64>(), 31.0);
            seen.push(x.iter().sum::<f64>() as u32);
        });
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), 10);
    }

    #[test]
    fn bad_input_is_refused() {
        let run = |a: &[f64], b: &[f64], s| permutation_test(a, b, s, difference_of_means).map(|_| ());
        let usual = PermutationSettings::default();
        assert!(run(&[], &[1.0], usual).is_err() && run(&[1.0], &[f64::INFINITY], usual).is_err());
        let none = PermutationSettings { exact_up_to: 0, draws: 0, seed: 0 };
        assert!(run(&[1.0], &[2.0], none).unwrap_err().to_string().contains("no draws"));
        assert!(permutation_test(&[1.0], &[2.0], usual, |_, _| f64::NAN).is_err());
    }
}
