//! Which values an axis shows, and where on the picture a value lies.

use super::{Axis, Plot, Scale, Style};

/// A value range mapped onto a pixel range.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mapping {
    pub(super) scale: Scale,
    pub(super) low: f64,
    pub(super) high: f64,
    pixel_low: f64,
    pixel_high: f64,
}

impl Mapping {
    pub(super) fn new(scale: Scale, (low, high): (f64, f64), pixel_low: f64, pixel_high: f64) -> Self {
        Self { scale, low, high, pixel_low, pixel_high }
    }

    /// Pixel of a value; `None` if the value has no place on the axis.
    pub(super) fn pixel(&self, value: f64) -> Option<f64> {
        if !value.is_finite() {
            return None;
        }
        let fraction = match self.scale {
            // Halves, because the difference of two values near the largest f64 overflows.
            Scale::Linear => (0.5 * value - 0.5 * self.low) / (0.5 * self.high - 0.5 * self.low),
            Scale::Log if value <= 0.0 => return None,
            Scale::Log => (value.log10() - self.low.log10()) / (self.high.log10() - self.low.log10()),
        };
        Some(self.pixel_low + fraction * (self.pixel_high - self.pixel_low))
    }
}

/// The range of the horizontal axis: the data, with a margin only where markers would touch the frame.
pub(super) fn horizontal(plot: &Plot) -> (f64, f64) {
    let values = drawable(plot).map(|(_, x, _)| x);
    let margin = if plot.series.iter().any(|s| s.style == Style::Points) { 0.03 } else { 0.0 };
    resolve(&plot.x, values, margin)
}

/// The range of the vertical axis: the data and their error bars, with a margin.
pub(super) fn vertical(plot: &Plot) -> (f64, f64) {
    let visible = |x: f64| plot.x.range.is_none_or(|[low, high]| x >= low && x <= high);
    let log = plot.y.scale == Scale::Log;
    let values = drawable(plot).filter(|(_, x, _)| visible(*x)).flat_map(|((s, i), _, y)| {
        let bar = plot.series[s].y_error.as_ref().map_or(0.0, |bars| bars[i]);
        let bar = if bar.is_finite() { bar } else { 0.0 };
        let low = if log && y - bar <= 0.0 { y } else { y - bar };
        [low, y + bar]
    });
    resolve(&plot.y, values, 0.05)
}

/// All points that have a place on both axes, with their series and index.
fn drawable(plot: &Plot) -> impl Iterator<Item = ((usize, usize), f64, f64)> + '_ {
    let fits = |axis: &Axis, v: f64| v.is_finite() && (axis.scale == Scale::Linear || v > 0.0);
    plot.series.iter().enumerate().flat_map(move |(s, series)| {
        series
            .x
            .iter()
            .zip(&series.y)
            .enumerate()
            .filter(move |(_, (x, y))| fits(&plot.x, **x) && fits(&plot.y, **y))
            .map(move |(i, (x, y))| ((s, i), *x, *y))
    })
}

fn resolve(axis: &Axis, values: impl Iterator<Item = f64>, margin: f64) -> (f64, f64) {
    if let Some([low, high]) = axis.range {
        return (low, high);
    }
    let (low, high) =
        values.filter(|v| v.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (if v < low { v } else { low }, if v > high { v } else { high })
        });
    match (low <= high, axis.scale) {
        (false, Scale::Linear) => (0.0, 1.0),
        (false, Scale::Log) => (1.0, 10.0),
        (true, Scale::Linear) => padded_linear(low, high, margin),
        (true, Scale::Log) => padded_log(low, high, margin),
    }
}

fn padded_linear(low: f64, high: f64, margin: f64) -> (f64, f64) {
    let largest = low.abs().max(high.abs());
    // A span at the rounding level of the values holds no information, and its ticks would not be distinct numbers.
    let least = if largest < 1e-290 { 1e-280 } else { largest * 1e-12 };
    let half_span = 0.5 * high - 0.5 * low;
    if 2.0 * half_span < least {
        let middle = 0.5 * low + 0.5 * high;
        let half = if largest < 1e-290 { 0.5 } else { 0.05 * largest };
        return (held(middle - half), held(middle + half));
    }
    let extra = 2.0 * margin * half_span;
    (held(low - extra), held(high + extra))
}

fn held(v: f64) -> f64 {
    v.max(-f64::MAX).min(f64::MAX)
}

fn padded_log(low: f64, high: f64, margin: f64) -> (f64, f64) {
    let (a, b) = (low.log10(), high.log10());
    let extra = if b - a < 1e-9 { 0.5 } else { margin * (b - a) };
    let least = f64::MIN_POSITIVE.log10();
    (10f64.powf((a - extra).max(least)), 10f64.powf((b + extra).max(least + 1.0).min(308.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_lies_where_its_share_of_the_axis_says() {
        let linear = Mapping::new(Scale::Linear, (-1.0, 3.0), 100.0, 500.0);
        assert_eq!(linear.pixel(0.0), Some(200.0));
        assert_eq!(linear.pixel(f64::NAN), None);
        let log = Mapping::new(Scale::Log, (1e-4, 1.0), 0.0, 400.0);
        // log10 of powers of ten is right to one unit in the last place, 4e-16 of 400 pixels.
        assert!((log.pixel(1e-3).unwrap() - 100.0).abs() < 1e-12);
        assert_eq!(log.pixel(0.0), None);
        assert_eq!(log.pixel(-1.0), None);
    }

    #[test]
    fn the_whole_range_of_f64_is_mapped_without_overflow() {
        let wide = Mapping::new(Scale::Linear, (-f64::MAX, f64::MAX), 0.0, 100.0);
        assert_eq!(wide.pixel(0.0), Some(50.0));
        assert_eq!(wide.pixel(f64::MAX), Some(100.0));
    }

    #[test]
    fn ranges_without_extent_are_opened() {
        for v in [0.0, 1.0, -3e5, 1e-300, 1e300] {
            let (low, high) = padded_linear(v, v, 0.05);
            assert!(low < v && v < high, "{v:e}: {low:e} {high:e}");
        }
        for v in [1e-300, 1.0, 1e300] {
            let (low, high) = padded_log(v, v, 0.05);
            assert!(low < v && v < high && low > 0.0 && high.is_finite(), "{v:e}");
        }
    }
}
