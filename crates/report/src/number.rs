//! Numbers as people read them.

/// A number with `digits` significant digits (at least one): plain between 0.001 and 100000, otherwise with an exponent.
/// Whole numbers below a million keep all their digits.
///
/// ```
/// use granule_report::format_number;
/// assert_eq!(format_number(0.012345, 3), "0.0123");
/// assert_eq!(format_number(3.2e-16, 3), "3.20e-16");
/// assert_eq!(format_number(500.0, 3), "500");
/// ```
#[must_use]
pub fn format_number(value: f64, digits: usize) -> String {
    let digits = digits.max(1);
    if value.is_nan() {
        return "NaN".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "inf".to_owned() } else { "-inf".to_owned() };
    }
    if value == value.trunc() && value.abs() < 1e6 {
        // Adding zero turns -0 into 0.
        return format!("{:.0}", value + 0.0);
    }
    // Rounding may carry into the next decade, so the exponent is read off the rounded text.
    let scientific = format!("{value:.*e}", digits - 1);
    let exponent: i32 = scientific.rsplit('e').next().and_then(|e| e.parse().ok()).unwrap_or(0);
    if (-3..5).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        scientific
    }
}

/// A duration in seconds as text: `850 µs`, `12.3 ms`, `4.56 s`, `3 min 05 s`, `2 h 07 min`.
#[must_use]
pub fn format_duration(seconds: f64) -> String {
    if !seconds.is_finite() || seconds < 0.0 {
        return format!("{seconds} s");
    }
    let whole = seconds.round();
    if seconds == 0.0 {
        "0 s".to_owned()
    } else if seconds < 1e-6 {
        format!("{} ns", format_number(seconds * 1e9, 3))
    } else if seconds < 1e-3 {
        format!("{} µs", format_number(seconds * 1e6, 3))
    } else if seconds < 1.0 {
        format!("{} ms", format_number(seconds * 1e3, 3))
    } else if whole < 60.0 {
        format!("{} s", format_number(seconds, 3))
    } else if whole < 3600.0 {
        format!("{:.0} min {:02.0} s", (whole / 60.0).floor(), whole % 60.0)
    } else {
        let minutes = (seconds / 60.0).round();
        format!("{:.0} h {:02.0} min", (minutes / 60.0).floor(), minutes % 60.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_and_scientific_numbers() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (-10.0, "-10"),
            (1.0, "1"),
            (123456.0, "123456"),
            (0.001, "0.00100"),
            (9.996, "10.0"),
            (99999.6, "1.00e5"),
            (1.5e-9, "1.50e-9"),
            (-2.346e7, "-2.35e7"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(format_number(value, 3), text, "{value:e}");
        }
    }

    #[test]
    fn durations() {
        for (seconds, text) in [
            (0.0, "0 s"),
            (3.5e-8, "35 ns"),
            (850e-6, "850 µs"),
            (0.01234, "12.3 ms"),
            (4.561, "4.56 s"),
            (59.7, "1 min 00 s"),
            (185.0, "3 min 05 s"),
            (7620.0, "2 h 07 min"),
        ] {
            assert_eq!(format_duration(seconds), text);
        }
    }
}
