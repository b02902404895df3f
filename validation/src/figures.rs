//! Figures of a case: trajectories overlaid, differences against time.

use granule_report::verdict::Figure;
use granule_report::{Axis, Colour, Plot, Series};

use crate::causes::Alone;
use crate::peers::compare::Comparison;
use crate::peers::{Frame, Quantity};
use crate::translate::Target;

/// Differences of zero are drawn here: a logarithmic axis has no place for them.
const FLOOR: f64 = 1e-17;
const SIZE: (f64, f64) = (640.0, 320.0);

fn figure(plot: Plot, caption: impl Into<String>) -> Result<Figure, String> {
    let svg = plot.with_size(SIZE.0, SIZE.1).to_svg().map_err(|error| error.to_string())?;
    Ok(Figure { svg, caption: caption.into(), file: None })
}

fn unit(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Position => "m",
        Quantity::Velocity => "m/s",
        Quantity::AngularVelocity => "rad/s",
        Quantity::Force => "N",
        Quantity::Torque => "N m",
    }
}

/// One quantity of one body, component by component: ours as lines, the peer's as points.
pub fn trajectory(
    quantity: Quantity,
    body: usize,
    ours: &[Frame],
    theirs: &[Frame],
    target: Target,
    step: f64,
) -> Result<Figure, String> {
    let id = theirs.first().and_then(|frame| frame.ids.get(body)).copied().unwrap_or_default();
    let label = format!("{} [{}]", quantity.name(), unit(quantity));
    let word = if matches!(quantity, Quantity::Force | Quantity::Torque) { "on" } else { "of" };
    let title = format!("{} {word} body {id}", quantity.name());
    let mut plot = Plot::new(title, Axis::linear("time [s]"), Axis::linear(label));
    let column = |frames: &[Frame], component: usize| -> (Vec<f64>, Vec<f64>) {
        let value =
            |frame: &Frame| frame.column(quantity).get(body).map_or(f64::NAN, |vector| vector[component]);
        frames.iter().map(|frame| (frame.step as f64 * step, value(frame))).unzip()
    };
    for (component, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let colour = Colour::PALETTE[component];
        let (t, y) = column(ours, component);
        plot = plot.with(Series::line(format!("{axis}, granule"), t, y).with_colour(colour));
        let (t, y) = column(theirs, component);
        plot = plot.with(Series::points(format!("{axis}, {}", target.name()), t, y).with_colour(colour));
    }
    figure(plot, "Lines: granule with the conventions of the peer. Points: the peer.")
}

/// The body whose velocity changes most: the one worth looking at.
pub fn busiest(frames: &[Frame]) -> usize {
    let (Some(first), Some(last)) = (frames.first(), frames.last()) else { return 0 };
    let change = |body: usize| {
        let (a, b) = (first.velocity.get(body), last.velocity.get(body));
        a.zip(b).map_or(0.0, |(a, b)| (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>())
    };
    (0..first.ids.len()).max_by(|a, b| change(*a).total_cmp(&change(*b))).unwrap_or(0)
}

fn line(comparison: &Comparison, quantity: Option<Quantity>, step: f64) -> (Vec<f64>, Vec<f64>) {
    let rows = comparison.rows.iter().filter(|row| !row.is_empty());
    let largest = |row: &[crate::peers::compare::Difference]| {
        let wanted = row.iter().filter(|entry| quantity.is_none_or(|quantity| entry.quantity == quantity));
        wanted.map(|entry| entry.scaled).fold(FLOOR, f64::max)
    };
    rows.map(|row| (row[0].step as f64 * step, largest(row))).unzip()
}

fn bound(comparison: &Comparison, value: f64, step: f64) -> Series {
    let (t, _) = line(comparison, None, step);
    let ends: Vec<f64> = t.first().into_iter().chain(t.last()).copied().collect();
    let height = vec![value; ends.len()];
    Series::dashed("tolerance", ends, height)
}

/// Scaled differences to the peer, one line a quantity, with the tolerance.
pub fn differences(comparison: &Comparison, tolerance: f64, step: f64) -> Result<Figure, String> {
    let mut plot = Plot::new(
        "difference to the peer, conventions of the peer",
        Axis::linear("time [s]"),
        Axis::log("scaled difference"),
    );
    let quantities: Vec<Quantity> = comparison
        .rows
        .first()
        .map(|row| row.iter().map(|entry| entry.quantity).collect())
        .unwrap_or_default();
    for quantity in quantities {
        let (t, y) = line(comparison, Some(quantity), step);
        plot = plot.with(Series::line(quantity.name(), t, y));
    }
    plot = plot.with(bound(comparison, tolerance, step));
    figure(plot, format!("Differences below {FLOOR:e}, zero among them, are drawn there."))
}

/// The difference with `physical`, and what each convention makes of it alone.
pub fn causes(
    whole: &Comparison,
    alone: &[Alone],
    matching: &Comparison,
    step: f64,
) -> Result<Figure, String> {
    let mut plot = Plot::new(
        "difference to the peer, physical conventions",
        Axis::linear("time [s]"),
        Axis::log("largest scaled difference"),
    );
    let (t, y) = line(whole, None, step);
    plot = plot.with(Series::points("physical", t, y));
    for one in alone {
        let (t, y) = line(&one.comparison, None, step);
        let words = one.words.split(':').next().unwrap_or(&one.words);
        plot = plot.with(Series::line(words, t, y));
    }
    let (t, y) = line(matching, None, step);
    plot = plot.with(Series::dashed("all conventions of the peer", t, y));
    figure(plot, format!("Lines: one convention turned alone. Differences below {FLOOR:e} are drawn there."))
}
