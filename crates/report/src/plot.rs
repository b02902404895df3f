//! A figure with axes, as SVG text.
//!
//! The SVG is written here and not by a library: plotters rounds every point to whole pixels, and kuva 0.6 drew values
//! of 1e-16 to 1e-12 on its logarithmic axis as one flat line without a tick, which is the plot that matters most here.

pub(crate) mod draw;
mod legend;
mod marks;
mod range;
pub(crate) mod ticks;

use crate::{Colour, ReportError};

/// How values become distances along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// In proportion to the value.
    #[default]
    Linear,
    /// In proportion to the logarithm. Zero and negative values have no place: they are left out and counted.
    Log,
}

/// One axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// What is measured, with its unit, such as `time [s]`.
    pub label: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// First and last value shown. `None` shows all data with a small margin.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis that shows all data.
    #[must_use]
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None }
    }

    /// A logarithmic axis that shows all positive data.
    #[must_use]
    pub fn log(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Log, range: None }
    }

    /// The same axis from `low` to `high` only.
    #[must_use]
    pub fn with_range(mut self, low: f64, high: f64) -> Self {
        self.range = Some([low, high]);
        self
    }
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// A line through the points; it breaks where a point cannot be drawn.
    #[default]
    Line,
    /// A marker at each point; its shape differs from series to series.
    Points,
    /// `y[i]` held from `x[i]` to `x[i + 1]`. A histogram gives its bin edges and repeats the last count.
    Steps,
    /// A dashed line, for references and tolerances.
    Dashed,
}

/// One named set of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Name in the legend; an empty name has no legend entry.
    pub name: String,
    /// How it is drawn.
    pub style: Style,
    /// Values along the horizontal axis.
    pub x: Vec<f64>,
    /// Values along the vertical axis, as many as `x`.
    pub y: Vec<f64>,
    /// Half length of a vertical error bar at each point, not negative.
    pub y_error: Option<Vec<f64>>,
    /// Colour; `None` takes the next of [`Colour::PALETTE`].
    pub colour: Option<Colour>,
}

impl Series {
    /// A solid line.
    #[must_use]
    pub fn line(name: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { name: name.into(), style: Style::Line, x, y, y_error: None, colour: None }
    }

    /// Markers.
    #[must_use]
    pub fn points(name: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { style: Style::Points, ..Self::line(name, x, y) }
    }

    /// Steps, see [`Style::Steps`].
    #[must_use]
    pub fn steps(name: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { style: Style::Steps, ..Self::line(name, x, y) }
    }

    /// A dashed line.
    #[must_use]
    pub fn dashed(name: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { style: Style::Dashed, ..Self::line(name, x, y) }
    }

    /// The same series with vertical error bars of half length `y_error`.
    #[must_use]
    pub fn with_error(mut self, y_error: Vec<f64>) -> Self {
        self.y_error = Some(y_error);
        self
    }

    /// The same series in a colour of its own.
    #[must_use]
    pub fn with_colour(mut self, colour: Colour) -> Self {
        self.colour = Some(colour);
        self
    }
}

/// A figure: title, two axes, series.
///
/// ```
/// use granule_report::{Axis, Plot, Series};
/// let plot = Plot::new("Free fall", Axis::linear("time [s]"), Axis::linear("height [m]"))
///     .with(Series::line("exact", vec![0.0, 0.1, 0.2], vec![1.0, 0.951, 0.804]));
/// assert!(plot.to_svg().unwrap().starts_with("<svg"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// Title above the figure; may be empty.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// What is drawn, first to last, later over earlier.
    pub series: Vec<Series>,
    /// Width of the whole figure in pixels, 240 to 8000.
    pub width: f64,
    /// Height of the whole figure in pixels, 160 to 8000. A legend below the axes adds to it.
    pub height: f64,
}

/// Points that a figure cannot show, all series together. A point is counted once, under the first that applies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SkippedPoints {
    /// NaN or infinite in x or y.
    pub not_finite: usize,
    /// Zero or negative on a logarithmic axis.
    pub not_positive: usize,
    /// Outside a range that the axis was given.
    pub out_of_range: usize,
}

impl Plot {
    /// An empty figure of 720 by 420 pixels.
    #[must_use]
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self { title: title.into(), x, y, series: Vec::new(), width: 720.0, height: 420.0 }
    }

    /// The same figure with one more series.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// The same figure in another size, in pixels.
    #[must_use]
    pub fn with_size(mut self, width: f64, height: f64) -> Self {
        self.width = width;
        self.height = height;
        self
    }

    /// Points that the figure leaves out. The figure says so too, below its axes.
    #[must_use]
    pub fn skipped(&self) -> SkippedPoints {
        let mut count = SkippedPoints::default();
        let outside = |axis: &Axis, v: f64| axis.range.is_some_and(|[low, high]| v < low || v > high);
        for series in &self.series {
            for (&x, &y) in series.x.iter().zip(&series.y) {
                if !x.is_finite() || !y.is_finite() {
                    count.not_finite += 1;
                } else if (self.x.scale == Scale::Log && x <= 0.0) || (self.y.scale == Scale::Log && y <= 0.0)
                {
                    count.not_positive += 1;
                } else if outside(&self.x, x) || outside(&self.y, y) {
                    count.out_of_range += 1;
                }
            }
        }
        count
    }

    /// The figure as a complete SVG document. The same figure always gives the same text.
    ///
    /// # Errors
    /// Arrays of different lengths in one series, a negative error bar, a range that is empty, not finite or (on a
    /// logarithmic axis) not positive, or a size outside its bounds.
    pub fn to_svg(&self) -> Result<String, ReportError> {
        self.check()?;
        Ok(draw::figure(self))
    }

    fn check(&self) -> Result<(), ReportError> {
        let within = |v: f64, low: f64| v >= low && v <= 8000.0;
        if !within(self.width, 240.0) || !within(self.height, 160.0) {
            return Err(ReportError::Invalid(format!(
                "a plot of {} by {} pixels: the width must be within 240 and 8000, the height within 160 and 8000",
                self.width, self.height
            )));
        }
        for (name, axis) in [("x", &self.x), ("y", &self.y)] {
            let Some([low, high]) = axis.range else { continue };
            let positive = axis.scale == Scale::Linear || low > 0.0;
            if !(low.is_finite() && high.is_finite() && low < high && positive) {
                let rule = if axis.scale == Scale::Log { "0 < low < high" } else { "low < high" };
                return Err(ReportError::Invalid(format!(
                    "the range of the {name} axis is {low} to {high}: needs {rule}, both finite"
                )));
            }
        }
        for series in &self.series {
            let what = || format!("series `{}`", series.name);
            let same = |found: usize| {
                let expected = series.x.len();
                if found == expected {
                    Ok(())
                } else {
                    Err(ReportError::LengthMismatch { what: what(), expected, found })
                }
            };
            same(series.y.len())?;
            if let Some(bars) = &series.y_error {
                same(bars.len())?;
                if let Some(bad) = bars.iter().find(|bar| **bar < 0.0) {
                    return Err(ReportError::Invalid(format!(
                        "{}: error bar of negative length {bad}",
                        what()
                    )));
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
