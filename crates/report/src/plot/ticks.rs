//! Ticks at 1, 2 or 5 times a power of ten, with exact labels.

use super::Scale;
use super::range::Mapping;
use crate::svg::{escape, text_width};

/// A label: text, then perhaps a superscript.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Label {
    pub(crate) text: String,
    pub(crate) exponent: Option<i32>,
}

impl Label {
    fn plain(text: String) -> Self {
        Self { text, exponent: None }
    }

    /// SVG content of the label.
    pub(crate) fn markup(&self, size: f64) -> String {
        let text = escape(&self.text);
        self.exponent.map_or(text.clone(), |e| {
            let small = size * 0.75;
            let rise = size * 0.4;
            format!("{text}<tspan font-size=\"{small}\" dy=\"{:.1}\">{}</tspan>", -rise, minus(e.to_string()))
        })
    }

    pub(crate) fn width(&self, size: f64) -> f64 {
        text_width(&self.text, size)
            + self.exponent.map_or(0.0, |e| text_width(&minus(e.to_string()), size * 0.75))
    }
}

/// The ticks of one axis.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ticks {
    /// Labelled ticks.
    pub(crate) major: Vec<(f64, Label)>,
    /// Ticks without a label.
    pub(crate) minor: Vec<f64>,
    /// Factor and offset that all labels leave out, such as `×10` to the `−6`, in reading order.
    pub(crate) common: Vec<Label>,
}

/// Ticks for an axis on which about `wanted` labels have room.
pub(super) fn ticks(mapping: &Mapping, wanted: usize) -> Ticks {
    let wanted = wanted.max(2);
    match mapping.scale {
        Scale::Linear => linear(mapping.low, mapping.high, wanted),
        Scale::Log => log(mapping.low, mapping.high, wanted),
    }
}

fn minus(text: String) -> String {
    text.replace('-', "−")
}

/// `mantissa * 10^exponent`, rounded once.
fn value_of(mantissa: i64, exponent: i32) -> f64 {
    format!("{mantissa}e{exponent}").parse().unwrap_or(f64::NAN)
}

/// `mantissa * 10^exponent` written out in full.
fn decimal(mantissa: i64, exponent: i32) -> String {
    let sign = if mantissa < 0 { "−" } else { "" };
    let digits = mantissa.unsigned_abs().to_string();
    if mantissa == 0 || exponent >= 0 {
        let zeros = if mantissa == 0 { 0 } else { exponent as usize };
        let places = if exponent < 0 {
            format!(".{}", "0".repeat(exponent.unsigned_abs() as usize))
        } else {
            String::new()
        };
        return format!("{sign}{digits}{}{places}", "0".repeat(zeros));
    }
    let places = exponent.unsigned_abs() as usize;
    let padded = format!("{digits:0>width$}", width = places + 1);
    let (whole, part) = padded.split_at(padded.len() - places);
    format!("{sign}{whole}.{part}")
}

fn digits_of(mantissa: i64) -> i32 {
    mantissa.unsigned_abs().to_string().len() as i32
}

/// The factor that labels leave out: 0 while plain numbers are short, otherwise the exponent of the largest.
fn common_exponent(largest: i64, exponent: i32) -> i32 {
    let leading = digits_of(largest) - 1 + exponent;
    if (-3..5).contains(&leading) && exponent >= -5 { 0 } else { leading }
}

/// Ticks from `low` to `high` on a linear scale.
pub(crate) fn linear(low: f64, high: f64, wanted: usize) -> Ticks {
    let raw = (high / wanted as f64) - (low / wanted as f64);
    let mut exponent = raw.log10().floor() as i32;
    let lead = raw / value_of(1, exponent);
    let mut factor = [1, 2, 5].into_iter().find(|m| lead <= *m as f64 * 1.000_001).unwrap_or(10);
    if factor == 10 {
        (factor, exponent) = (1, exponent + 1);
    }
    let step = value_of(factor, exponent);
    // A hair of tolerance keeps a tick that lies on the end of the axis but for rounding.
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    let mantissas: Vec<i64> = (first..=last).map(|k| k * factor).collect();
    let largest = mantissas.iter().copied().max_by_key(|k| k.unsigned_abs()).unwrap_or(0);

    let mut common = Vec::new();
    // Labels that repeat the same leading digits tell nothing: they go into an offset.
    let offset = if digits_of(largest) > 5 { mantissas.first().copied().unwrap_or(0) } else { 0 };
    let shifted = mantissas.iter().map(|k| k - offset).max_by_key(|k| k.unsigned_abs()).unwrap_or(0);
    let shared = common_exponent(shifted, exponent);
    if shared != 0 {
        common.push(Label { text: "×10".to_owned(), exponent: Some(shared) });
    }
    if offset != 0 {
        let sign = if offset < 0 { "− " } else { "+ " };
        let size = common_exponent(offset, exponent.max(-12));
        let places = exponent - size;
        let text = decimal(offset.abs(), places);
        let text = if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        };
        common.push(Label {
            text: format!("{sign}{text}{}", if size == 0 { "" } else { "×10" }),
            exponent: (size != 0).then_some(size),
        });
    }
    let major = mantissas
        .iter()
        .map(|&k| (value_of(k, exponent), Label::plain(decimal(k - offset, exponent - shared))))
        .collect();
    Ticks { major, minor: Vec::new(), common }
}

fn log(low: f64, high: f64, wanted: usize) -> Ticks {
    let (a, b) = (low.log10(), high.log10());
    let first = (a - 1e-9).ceil() as i32;
    let last = (b + 1e-9).floor() as i32;
    let decades = (last - first + 1).max(0) as usize;
    let inside = |v: f64| v >= low * (1.0 - 1e-9) && v <= high * (1.0 + 1e-9);
    if decades >= 3 {
        let least = ((decades + wanted / 2) / wanted).max(1) as i32;
        // The first stride that gives few enough labels, unless it leaves fewer than two.
        let strides = [1, 2, 3, 5, 10, 20, 50, 100];
        let labelled =
            |stride: i32| (first..=last).filter(move |n| n.rem_euclid(stride) == 0).collect::<Vec<_>>();
        let fit = strides.iter().position(|s| *s >= least).unwrap_or(strides.len() - 1);
        let stride = strides[..=fit].iter().rev().copied().find(|s| labelled(*s).len() >= 2).unwrap_or(1);
        let labelled = labelled(stride);
        let plain = first >= -2 && last <= 4;
        let major = labelled.iter().map(|&n| (value_of(1, n), power(1, n, plain))).collect();
        let minor = if stride == 1 {
            multiples(first - 1, last, &[2, 3, 4, 5, 6, 7, 8, 9])
                .map(|(_, _, v)| v)
                .filter(|v| inside(*v))
                .collect()
        } else {
            (first..=last).filter(|n| n.rem_euclid(stride) != 0).map(|n| value_of(1, n)).collect()
        };
        return Ticks { major, minor, common: Vec::new() };
    }
    for factors in [&[1, 2, 5][..], &[1, 2, 3, 4, 5, 6, 7, 8, 9]] {
        let found: Vec<_> = multiples(first - 1, last, factors).filter(|(_, _, v)| inside(*v)).collect();
        if found.len() >= 3 {
            let plain = found.iter().all(|(_, n, _)| (-3..=4).contains(n));
            let major: Vec<_> = found.iter().map(|&(m, n, v)| (v, power(m, n, plain))).collect();
            let minor = multiples(first - 1, last, &[1, 2, 3, 4, 5, 6, 7, 8, 9])
                .map(|(_, _, v)| v)
                .filter(|v| inside(*v) && major.iter().all(|(at, _)| at != v))
                .collect();
            return Ticks { major, minor, common: Vec::new() };
        }
    }
    // Less than half a decade: the axis is nearly linear, and so are its ticks.
    linear(low, high, wanted.min(5))
}

fn multiples(first: i32, last: i32, factors: &[i64]) -> impl Iterator<Item = (i64, i32, f64)> {
    (first..=last).flat_map(move |n| factors.iter().map(move |&m| (m, n, value_of(m, n))))
}

fn power(factor: i64, exponent: i32, plain: bool) -> Label {
    if plain {
        return Label::plain(decimal(factor, exponent));
    }
    let text = if factor == 1 { "10".to_owned() } else { format!("{factor}×10") };
    Label { text, exponent: Some(exponent) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(ticks: &Ticks) -> Vec<String> {
        ticks
            .major
            .iter()
            .map(|(_, l)| l.exponent.map_or(l.text.clone(), |e| format!("{}^{e}", l.text)))
            .collect()
    }

    fn common(ticks: &Ticks) -> Vec<String> {
        ticks
            .common
            .iter()
            .map(|l| l.exponent.map_or(l.text.clone(), |e| format!("{}^{e}", l.text)))
            .collect()
    }

    #[test]
    fn linear_ticks_are_plain_while_numbers_are_short() {
        let t = linear(0.0, 1.0, 5);
        assert_eq!(labels(&t), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert!(t.common.is_empty());
        assert_eq!(t.major[3].0, 0.6);
        assert_eq!(labels(&linear(-30.0, 70.0, 5)), ["−20", "0", "20", "40", "60"]);
        assert_eq!(labels(&linear(0.0, 40000.0, 4)), ["0", "10000", "20000", "30000", "40000"]);
    }

    #[test]
    fn small_and_large_numbers_share_a_factor() {
        let t = linear(0.0, 2e-4, 4);
        assert_eq!(labels(&t), ["0.0", "0.5", "1.0", "1.5", "2.0"]);
        assert_eq!(common(&t), ["×10^-4"]);
        let t = linear(0.0, 3e7, 3);
        assert_eq!(
            (labels(&t), common(&t)),
            (vec!["0".into(), "1".into(), "2".into(), "3".into()], vec!["×10^7".into()])
        );
    }

    #[test]
    fn a_narrow_range_far_from_zero_gets_an_offset() {
        let t = linear(1.0, 1.000_000_4, 4);
        assert_eq!(common(&t), ["×10^-7", "+ 1"]);
        assert_eq!(labels(&t), ["0", "1", "2", "3", "4"]);
        assert_eq!(t.major[3].0, 1.000_000_3);
        let t = linear(-250_000_020.0, -250_000_000.0, 2);
        assert_eq!(common(&t), ["− 2.5000002×10^8"]);
        assert_eq!(labels(&t), ["0", "10", "20"]);
    }

    #[test]
    fn log_ticks_are_decades_with_minor_ticks() {
        let t = log(1e-17, 1e-12, 8);
        assert_eq!(labels(&t), ["10^-17", "10^-16", "10^-15", "10^-14", "10^-13", "10^-12"]);
        assert_eq!(t.minor.len(), 5 * 8);
        assert_eq!(labels(&log(0.5, 2000.0, 8)), ["1", "10", "100", "1000"]);
        assert_eq!(
            labels(&log(1e-30, 1e0, 6)),
            ["10^-30", "10^-25", "10^-20", "10^-15", "10^-10", "10^-5", "10^0"]
        );
        assert_eq!(labels(&log(3e-6, 6e-5, 6)), ["5×10^-6", "10^-5", "2×10^-5", "5×10^-5"]);
        assert_eq!(labels(&log(2.0, 2.2, 6)), ["2.00", "2.05", "2.10", "2.15", "2.20"]);
    }

    proptest! {
        #[test]
        fn ticks_lie_inside_rise_and_are_neither_few_nor_many(
            middle in -1e3..1e3f64, exponent in -250..250i32, span in 1e-6..1e3f64, wanted in 3usize..10
        ) {
            let unit = 10f64.powi(exponent);
            let (low, high) = ((middle - span) * unit, (middle + span) * unit);
            let t = linear(low, high, wanted);
            let slack = 1e-6 * (high - low);
            prop_assert!(t.major.iter().all(|(v, _)| *v >= low - slack && *v <= high + slack));
            prop_assert!(t.major.windows(2).all(|w| w[0].0 < w[1].0));
            // Steps grow by 2 to 2.5, so there are at least `wanted / 2.5 - 1` and at most `wanted + 1` ticks.
            prop_assert!(t.major.len() <= wanted + 1 && t.major.len() as f64 >= (wanted as f64 / 2.5 - 1.0).floor());
            // All labels differ, and none is long.
            let texts = labels(&t);
            prop_assert!(texts.windows(2).all(|w| w[0] != w[1]), "{texts:?}");
            prop_assert!(texts.iter().all(|s| s.chars().count() <= 8), "{texts:?}");
        }

        #[test]
        fn log_ticks_lie_inside_and_rise(a in -300.0..300.0f64, span in 0.01..200.0f64, wanted in 3usize..10) {
            let (low, high) = (10f64.powf(a), 10f64.powf((a + span).min(307.0)));
            let t = log(low, high, wanted);
            prop_assert!(t.major.len() >= 2, "{:?}", labels(&t));
            prop_assert!(t.major.iter().all(|(v, _)| *v >= low * 0.999_99 && *v <= high * 1.000_01));
            prop_assert!(t.major.windows(2).all(|w| w[0].0 < w[1].0));
        }
    }
}
