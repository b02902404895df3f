//! Two-sample Kolmogorov-Smirnov test.

use super::check;
use crate::ReportError;

/// Result of a two-sample Kolmogorov-Smirnov test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KolmogorovSmirnov {
    /// Largest distance of the two empirical distribution functions, 0 to 1.
    pub distance: f64,
    /// The chance of a distance at least as large if both samples come from one distribution.
    pub p_value: f64,
    /// Counted exactly, ties included; otherwise from the limit for large samples.
    pub exact: bool,
}

/// Above this product of the sample sizes the limit distribution is used.
const EXACT_UP_TO: usize = 4_000_000;

/// Tests whether two samples come from one distribution, both sides.
///
/// The p-value is counted exactly up to a product of sizes of four million: of all arrangements of the pooled sample,
/// the share whose distance is at least that found. Tied values are one step (conditional on the ties, as in Schröer
/// and Trenkler 1995). Larger samples use the limit distribution at `distance * sqrt(n m / (n + m))`.
///
/// # Errors
/// An empty sample, or a value that is not finite.
pub fn kolmogorov_smirnov(a: &[f64], b: &[f64]) -> Result<KolmogorovSmirnov, ReportError> {
    check("Kolmogorov-Smirnov test, first sample", a, 1)?;
    check("Kolmogorov-Smirnov test, second sample", b, 1)?;
    let (n, m) = (a.len(), b.len());
    let mut pool: Vec<(f64, bool)> =
        a.iter().map(|v| (*v, true)).chain(b.iter().map(|v| (*v, false))).collect();
    // Zeros of either sign are one value, as for every comparison but total_cmp.
    pool.sort_by(|x, y| (x.0 + 0.0).total_cmp(&(y.0 + 0.0)));

    // Distances are counted in units of 1/(n m): whole numbers, without rounding.
    let mut ends = vec![false; n + m + 1];
    let (mut i, mut j, mut largest) = (0usize, 0usize, 0u128);
    for k in 0..pool.len() {
        if pool[k].1 {
            i += 1;
        } else {
            j += 1;
        }
        if pool.get(k + 1).is_none_or(|next| next.0 != pool[k].0) {
            ends[k + 1] = true;
            largest = largest.max(gap(i, j, n, m));
        }
    }
    let distance = largest as f64 / (n as f64 * m as f64);
    let exact = n.checked_mul(m).is_some_and(|product| product <= EXACT_UP_TO);
    let p_value = if exact {
        share_of_paths(n, m, largest, &ends)
    } else {
        let effective = n as f64 / (n + m) as f64 * m as f64;
        kolmogorov_survival(distance * effective.sqrt())
    };
    Ok(KolmogorovSmirnov { distance, p_value, exact })
}

fn gap(i: usize, j: usize, n: usize, m: usize) -> u128 {
    (i as u128 * m as u128).abs_diff(j as u128 * n as u128)
}

/// The share of the monotone lattice paths from (0, 0) to (n, m) that meet a gap of at least `bound` at a point where a
/// group of ties ends. Paths are followed as probabilities, and each is taken out where it first meets the bound, so
/// that a small share is a sum of small numbers and keeps its digits.
fn share_of_paths(n: usize, m: usize, bound: u128, ends: &[bool]) -> f64 {
    if bound == 0 {
        return 1.0;
    }
    let mut met = 0.0;
    let mut row = vec![0.0; m + 1];
    for i in 0..=n {
        for j in 0..=m {
            // The next value is from the first sample with the share of its values that are left.
            let from_left =
                if j > 0 { row[j - 1] * (m + 1 - j) as f64 / (n + m + 1 - i - j) as f64 } else { 0.0 };
            let from_below =
                if i > 0 { row[j] * (n + 1 - i) as f64 / (n + m + 1 - i - j) as f64 } else { 0.0 };
            let here = if i == 0 && j == 0 { 1.0 } else { from_left + from_below };
            if ends[i + j] && gap(i, j, n, m) >= bound {
                met += here;
                row[j] = 0.0;
            } else {
                row[j] = here;
            }
        }
    }
    f64::min(met, 1.0)
}

/// The Kolmogorov distribution: the chance that the largest distance exceeds `x` in the limit of large samples, scaled
/// by the square root of the effective size. 1 for `x <= 0`; NaN stays NaN.
#[must_use]
pub fn kolmogorov_survival(x: f64) -> f64 {
    use std::f64::consts::PI;
    if x.is_nan() {
        return x;
    }
    if x < 0.04 {
        // 1 - Q < exp(-700) here.
        return 1.0;
    }
    // Two forms of one theta function; each converges in a few terms on its side.
    if x < 1.18 {
        let y = -PI * PI / (8.0 * x * x);
        let sum: f64 = (0..20).map(|k| f64::from((2 * k + 1) * (2 * k + 1))).map(|odd| (odd * y).exp()).sum();
        1.0 - (2.0 * PI).sqrt() / x * sum
    } else {
        let term = |k: i32| (-2.0 * f64::from(k * k) * x * x).exp() * if k % 2 == 1 { 1.0 } else { -1.0 };
        2.0 * (1..20).map(term).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{PermutationSettings, permutation_test};
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn separated_samples_have_distance_one() {
        for n in [1u32, 3, 5, 20] {
            let a: Vec<f64> = (0..n).map(f64::from).collect();
            let b: Vec<f64> = a.iter().map(|v| v + 50.0).collect();
            let test = kolmogorov_smirnov(&a, &b).unwrap();
            // Two of binomial(2n, n) arrangements; the path probabilities multiply 2n factors, 2n roundings.
            let arrangements: f64 = (1..=n).map(|k| f64::from(n + k) / f64::from(k)).product();
            assert_eq!(test.distance, 1.0);
            assert!((test.p_value * arrangements / 2.0 - 1.0).abs() < 1e-14, "{n}: {}", test.p_value);
        }
    }

    #[test]
    fn equal_samples_have_distance_zero() {
        let test = kolmogorov_smirnov(&[1.0, 2.0, 2.0, -0.0], &[2.0, 0.0, 2.0, 1.0]).unwrap();
        assert_eq!((test.distance, test.p_value), (0.0, 1.0));
    }

    #[test]
    fn the_limit_distribution_has_its_known_values() {
        // The alternating series 2 sum (-1)^(k-1) exp(-2 k^2 x^2), summed with 40 digits. 1.1799 and 1.18 are the last
        // and first value of the two forms.
        for (x, p, digits) in [
            (0.2, 0.999_999_999_999_495, 1e-15),
            (0.5, 0.963_945_243_664_875_1, 1e-15),
            (1.0, 0.269_999_671_677_354_5, 1e-15),
            (1.179_9, 0.123_512_049_711_886_72, 1e-15),
            (2.0, 6.709_252_557_796_953e-4, 1e-18),
        ] {
            assert!((kolmogorov_survival(x) - p).abs() < digits, "{x}: {:.17}", kolmogorov_survival(x));
        }
        assert_eq!((kolmogorov_survival(-1.0), kolmogorov_survival(f64::INFINITY)), (1.0, 0.0));
        assert!(kolmogorov_survival(f64::NAN).is_nan());
    }

    #[test]
    fn a_sample_without_ties_agrees_with_scipy() {
        // scipy.stats.ks_2samp(a, b, method="exact"): distance 3/7, p = 6/11.
        let test =
            kolmogorov_smirnov(&[0.3, 1.1, 0.8, 1.9, 0.2, 1.4, 2.5], &[1.3, 2.1, 1.8, 0.9, 2.2]).unwrap();
        assert_eq!(test.distance, 3.0 / 7.0);
        // Twelve steps, each with a rounded product and a rounded sum.
        assert!((test.p_value - 6.0 / 11.0).abs() < 1e-14, "{}", test.p_value);
    }

    #[test]
    fn exact_and_limit_agree_for_large_samples() {
        let a: Vec<f64> = (0..1500).map(f64::from).collect();
        let b: Vec<f64> = (0..1500).map(|k| f64::from(k) * 1.04 + 0.3).collect();
        let test = kolmogorov_smirnov(&a, &b).unwrap();
        let limit = kolmogorov_survival(test.distance * 750f64.sqrt());
        // The limit is off by O(1/sqrt(n)) in p, here a few hundredths of a middling p.
        assert!(test.exact && (test.p_value - limit).abs() < 0.05, "{} {limit}", test.p_value);
        assert!(test.p_value > 0.01 && test.p_value < 0.99);
    }

    #[test]
    fn large_samples_use_the_limit() {
        let a: Vec<f64> = (0..2500).map(f64::from).collect();
        let test = kolmogorov_smirnov(&a, &a).unwrap();
        assert!(!test.exact);
        assert_eq!(test.p_value, 1.0);
    }

    #[test]
    fn bad_samples_are_refused() {
        assert!(kolmogorov_smirnov(&[], &[1.0]).is_err());
        assert!(kolmogorov_smirnov(&[1.0], &[f64::NAN]).is_err());
    }

    proptest! {
        /// Counting paths and enumerating arrangements are the same thing, ties included.
        #[test]
        fn paths_agree_with_enumeration(
            a in prop::collection::vec(0u8..6, 1..6), b in prop::collection::vec(0u8..6, 1..6)
        ) {
            let a: Vec<f64> = a.into_iter().map(f64::from).collect();
            let b: Vec<f64> = b.into_iter().map(f64::from).collect();
            let paths = kolmogorov_smirnov(&a, &b).unwrap();
            let distance = |x: &[f64], y: &[f64]| kolmogorov_smirnov(x, y).map_or(f64::NAN, |t| t.distance);
            let all = permutation_test(&a, &b, PermutationSettings::default(), distance).unwrap();
            // Up to ten multiplications by rounded ratios.
            prop_assert!((paths.p_value - all.p_value).abs() < 1e-14, "{paths:?} {all:?}");
        }
    }
}
