//! Comparing samples: is the distribution over seeds of one program that of another?
//!
//! Every function refuses empty samples and values that are not finite.

mod kolmogorov;
mod permutation;

pub use kolmogorov::{KolmogorovSmirnov, kolmogorov_smirnov, kolmogorov_survival};
pub use permutation::{PermutationSettings, PermutationTest, permutation_test};

use crate::ReportError;

/// Checks that a sample has at least `needed` values, all finite.
fn check(what: &'static str, values: &[f64], needed: usize) -> Result<(), ReportError> {
    if values.len() < needed {
        return Err(ReportError::TooFewValues { what, needed, found: values.len() });
    }
    match values.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(ReportError::NotFinite { what: what.to_owned(), index }),
        None => Ok(()),
    }
}

/// Arithmetic mean.
///
/// # Errors
/// An empty sample, or a value that is not finite.
pub fn mean(values: &[f64]) -> Result<f64, ReportError> {
    check("mean", values, 1)?;
    Ok(plain_mean(values))
}

/// The mean of a checked sample: shifting by the first value keeps the digits of values that differ little.
fn plain_mean(values: &[f64]) -> f64 {
    let shift = values.first().copied().unwrap_or(0.0);
    shift + values.iter().map(|v| v - shift).sum::<f64>() / values.len() as f64
}

/// Standard deviation of the population that the sample is from: divides by `n - 1`.
///
/// # Errors
/// Fewer than two values, or a value that is not finite.
pub fn standard_deviation(values: &[f64]) -> Result<f64, ReportError> {
    check("standard deviation", values, 2)?;
    let centre = plain_mean(values);
    let squares: f64 = values.iter().map(|v| (v - centre) * (v - centre)).sum();
    Ok((squares / (values.len() - 1) as f64).sqrt())
}

/// Standard error of the mean: the standard deviation over the square root of `n`.
///
/// # Errors
/// Fewer than two values, or a value that is not finite.
pub fn standard_error(values: &[f64]) -> Result<f64, ReportError> {
    Ok(standard_deviation(values)? / (values.len() as f64).sqrt())
}

/// Median.
///
/// # Errors
/// An empty sample, or a value that is not finite.
pub fn median(values: &[f64]) -> Result<f64, ReportError> {
    quantile(values, 0.5)
}

/// The value below which the share `fraction` of the sample lies, interpolated linearly between order statistics at
/// `1 + (n - 1) fraction`: Hyndman and Fan 1996, definition 7, as numpy and R have it.
///
/// # Errors
/// An empty sample, a value that is not finite, or a fraction outside 0 to 1.
pub fn quantile(values: &[f64], fraction: f64) -> Result<f64, ReportError> {
    check("quantile", values, 1)?;
    if !(0.0..=1.0).contains(&fraction) {
        return Err(ReportError::Invalid(format!("quantile of fraction {fraction}: must be within 0 and 1")));
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = (sorted.len() - 1) as f64 * fraction;
    let low = place.floor() as usize;
    let high = (low + 1).min(sorted.len() - 1);
    Ok(sorted[low] + (place - low as f64) * (sorted[high] - sorted[low]))
}

/// `|mean a - mean b|`, a statistic for [`permutation_test`]. It is zero for empty samples.
#[must_use]
pub fn difference_of_means(a: &[f64], b: &[f64]) -> f64 {
    if a.is_empty() || b.is_empty() { 0.0 } else { (plain_mean(a) - plain_mean(b)).abs() }
}

/// p-values corrected for having asked several questions at once (Holm 1979): testing each result against a level keeps
/// the chance of any false alarm at or below that level, whatever the dependence between the questions. The order is
/// that of the input.
///
/// # Errors
/// A p-value outside 0 to 1.
pub fn holm(p_values: &[f64]) -> Result<Vec<f64>, ReportError> {
    if let Some(bad) = p_values.iter().find(|p| !(0.0..=1.0).contains(*p)) {
        return Err(ReportError::Invalid(format!("p-value {bad}: must be within 0 and 1")));
    }
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|a, b| p_values[*a].total_cmp(&p_values[*b]));
    let mut corrected = vec![1.0; p_values.len()];
    let mut largest = 0.0f64;
    for (rank, &index) in order.iter().enumerate() {
        let p = (p_values.len() - rank) as f64 * p_values[index];
        largest = largest.max(p).min(1.0);
        corrected[index] = largest;
    }
    Ok(corrected)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) {
        // A handful of roundings on numbers of order one.
        assert!((a - b).abs() <= 4e-15 * b.abs().max(1.0), "{a:e} against {b:e}");
    }

    #[test]
    fn moments_of_one_to_n() {
        // 1..=n has mean (n + 1) / 2 and variance n (n + 1) / 12.
        for n in [2u32, 5, 100] {
            let values: Vec<f64> = (1..=n).map(f64::from).collect();
            let n = f64::from(n);
            close(mean(&values).unwrap(), 0.5 * (n + 1.0));
            close(standard_deviation(&values).unwrap(), (n * (n + 1.0) / 12.0).sqrt());
            close(standard_error(&values).unwrap(), ((n + 1.0) / 12.0).sqrt());
        }
    }

    #[test]
    fn a_large_offset_costs_no_digits() {
        let values: Vec<f64> = (1..=5).map(|k| 1e9 + f64::from(k)).collect();
        assert_eq!(mean(&values).unwrap(), 1e9 + 3.0);
        assert_eq!(standard_deviation(&values).unwrap(), 2.5f64.sqrt());
    }

    #[test]
    fn quantiles_interpolate_between_order_statistics() {
        let values = [4.0, 1.0, 3.0, 2.0];
        for (fraction, wanted) in [(0.0, 1.0), (0.25, 1.75), (0.5, 2.5), (1.0 / 3.0, 2.0), (1.0, 4.0)] {
            close(quantile(&values, fraction).unwrap(), wanted);
        }
        assert_eq!(median(&[7.0]).unwrap(), 7.0);
        assert_eq!(median(&[3.0, -1.0, 10.0]).unwrap(), 3.0);
    }

    #[test]
    fn holm_meets_its_worked_example() {
        // R: p.adjust(c(0.01, 0.04, 0.03, 0.005), "holm") = 0.03 0.06 0.06 0.02
        let corrected = holm(&[0.01, 0.04, 0.03, 0.005]).unwrap();
        for (found, wanted) in corrected.into_iter().zip([0.03, 0.06, 0.06, 0.02]) {
            close(found, wanted);
        }
        assert_eq!(holm(&[0.9, 0.8]).unwrap(), [1.0, 1.0]);
        assert!(holm(&[1.5]).is_err() && holm(&[f64::NAN]).is_err());
    }

    #[test]
    fn bad_samples_are_refused() {
        let text = |r: Result<f64, ReportError>| r.unwrap_err().to_string();
        assert_eq!(text(mean(&[])), "mean needs at least 1 value(s), got 0");
        assert_eq!(text(standard_deviation(&[1.0])), "standard deviation needs at least 2 value(s), got 1");
        assert_eq!(text(median(&[1.0, f64::NAN])), "quantile: value 1 is not a finite number");
        assert_eq!(text(quantile(&[1.0], -0.1)), "quantile of fraction -0.1: must be within 0 and 1");
    }
}
