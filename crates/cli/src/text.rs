//! Numbers and times as people read them.

use std::time::Duration;

/// A number as short as it reads back exactly, with an exponent where that is shorter to read.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-3..1e5).contains(&size) || !value.is_finite() {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// A number to six significant digits: what a person wants to see of a time, which is a step times a number of steps.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// A number with three significant digits and a decimal prefix, as in `12.3 M`.
pub fn short(value: f64) -> String {
    const PREFIXES: [(f64, &str); 4] = [(1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k")];
    let (scaled, prefix) = PREFIXES
        .into_iter()
        .find(|(scale, _)| value.abs() >= *scale)
        .map_or((value, ""), |(scale, prefix)| (value / scale, prefix));
    let decimals = match scaled.abs() {
        size if size >= 100.0 => 0,
        size if size >= 10.0 => 1,
        _ => 2,
    };
    format!("{scaled:.decimals$} {prefix}")
}

/// A span of wall-clock time, as in `1 h 05 min`, `3 min 20 s`, `12.3 s`.
pub fn duration(duration: Duration) -> String {
    let seconds = duration.as_secs();
    match seconds {
        0..60 => format!("{:.1} s", duration.as_secs_f64()),
        60..3600 => format!("{} min {:02} s", seconds / 60, seconds % 60),
        3600..86400 => format!("{} h {:02} min", seconds / 3600, seconds / 60 % 60),
        _ => format!("{} d {:02} h", seconds / 86400, seconds / 3600 % 24),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back() {
        for value in [0.0, 1.0, 0.1, 1e5, 99999.0, 1e-4, -2.5e-7, f64::INFINITY, 0.001] {
            assert_eq!(number(value).parse::<f64>(), Ok(value));
        }
        assert_eq!(number(1e5), "1e5");
        assert_eq!(number(2500.0), "2500");
    }

    #[test]
    fn times_are_shown_to_six_digits() {
        assert_eq!(rounded(0.1 + 0.2), 0.3);
        assert_eq!(rounded(123_456.789), 123_457.0);
        assert_eq!(rounded(0.0), 0.0);
    }

    #[test]
    fn short_numbers_have_three_digits() {
        assert_eq!(short(0.0), "0.00 ");
        assert_eq!(short(999.0), "999 ");
        assert_eq!(short(12_345_678.0), "12.3 M");
        assert_eq!(short(1e15), "1000 T");
    }

    #[test]
    fn times_are_told_in_two_units() {
        assert_eq!(duration(Duration::from_millis(1234)), "1.2 s");
        assert_eq!(duration(Duration::from_secs(200)), "3 min 20 s");
        assert_eq!(duration(Duration::from_secs(3900)), "1 h 05 min");
        assert_eq!(duration(Duration::from_secs(90_000)), "1 d 01 h");
    }
}
