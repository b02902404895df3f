//! Layout of a figure: title, frame, ticks, series, legend, notes.

use super::legend::Legend;
use super::marks::{self, Look};
use super::range::{self, Mapping};
use super::ticks::{Label, Ticks, ticks};
use super::{Plot, SkippedPoints};
use crate::svg::{Anchor, Svg, escape, px, wrap};

const TITLE: f64 = 15.0;
const LABEL: f64 = 13.0;
const TICK: f64 = 12.0;
const NOTE: f64 = 11.0;
const TICK_LENGTH: f64 = 5.0;

/// The frame of the axes in pixels.
struct Frame {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

/// A whole figure. The plot was checked before.
pub(super) fn figure(plot: &Plot) -> String {
    let legend = Legend::of(plot);
    let notes = notes(plot);
    let title = wrap(&plot.title, TITLE * 1.06, plot.width - 40.0);
    let x_range = range::horizontal(plot);
    let y_range = range::vertical(plot);

    // The ticks of y need the height and give the left margin; the ticks of x need what is left.
    let x_label = wrap(&plot.x.label, LABEL, 0.8 * plot.width);
    let title_height = title.len() as f64 * (TITLE + 4.0);
    let bottom_margin = 8.0 + TICK_LENGTH + TICK + 8.0 + x_label.len() as f64 * (LABEL + 3.0);
    let mut frame =
        Frame { left: 0.0, right: 0.0, top: 14.0 + title_height, bottom: plot.height - bottom_margin };
    let mut y = Mapping::new(plot.y.scale, y_range, frame.bottom, frame.top);
    let mut y_ticks = ticks(&y, count(frame.bottom - frame.top, 52.0));
    if !y_ticks.common.is_empty() {
        frame.top += TICK + 5.0;
        y = Mapping::new(plot.y.scale, y_range, frame.bottom, frame.top);
        y_ticks = ticks(&y, count(frame.bottom - frame.top, 52.0));
    }
    let y_label = wrap(&plot.y.label, LABEL, frame.bottom - frame.top + 20.0);
    let tick_room = y_ticks.major.iter().map(|(_, l)| l.width(TICK)).fold(0.0, f64::max);
    frame.left = 12.0 + y_label.len() as f64 * (LABEL + 3.0) + 6.0 + tick_room + 4.0 + TICK_LENGTH;
    let legend_width = legend.as_ref().map_or(0.0, Legend::width);
    frame.right = plot.width - if legend_width > 0.0 { legend_width + 16.0 } else { 24.0 };
    let x = Mapping::new(plot.x.scale, x_range, frame.left, frame.right);
    let x_ticks = horizontal_ticks(&x, frame.right - frame.left);

    let legend_height = legend.as_ref().map_or(0.0, Legend::height);
    let notes_height = notes.len() as f64 * (NOTE + 5.0);
    let mut svg = Svg::new(plot.width, plot.height + legend_height + notes_height, name(plot));
    for (k, line) in title.iter().enumerate() {
        let at = (frame.left, 12.0 + TITLE * 0.85 + k as f64 * (TITLE + 4.0));
        svg.text(at, TITLE, Anchor::Start, "font-weight=\"600\"", line);
    }
    draw_x(&mut svg, &frame, &x, &x_ticks, &x_label);
    draw_y(&mut svg, &frame, &y, &y_ticks, &y_label);
    draw_series(&mut svg, plot, &frame, &x, &y);
    svg.line((frame.left, frame.bottom), (frame.right, frame.bottom), 1.2, 0.9);
    svg.line((frame.left, frame.top), (frame.left, frame.bottom), 1.2, 0.9);
    if let Some(legend) = &legend {
        if legend.right {
            legend.draw(&mut svg, frame.right + 16.0, frame.top);
        } else {
            legend.draw(&mut svg, frame.left, plot.height + 2.0);
        }
    }
    for (k, note) in notes.iter().enumerate() {
        let at = (frame.left, plot.height + legend_height + NOTE + k as f64 * (NOTE + 5.0));
        svg.text(at, NOTE, Anchor::Start, "fill-opacity=\"0.75\"", note);
    }
    svg.finish()
}

/// The accessible name of the figure.
fn name(plot: &Plot) -> &str {
    if plot.title.is_empty() { "plot" } else { &plot.title }
}

fn count(length: f64, each: f64) -> usize {
    ((length / each).round() as usize).max(2).min(12)
}

/// As many ticks as fit without their labels touching.
fn horizontal_ticks(x: &Mapping, length: f64) -> Ticks {
    let mut wanted = count(length, 80.0);
    loop {
        let found = ticks(x, wanted);
        let places: Vec<(f64, f64)> = found
            .major
            .iter()
            .filter_map(|(value, label)| Some((x.pixel(*value)?, 0.5 * label.width(TICK))))
            .collect();
        let apart = places.windows(2).all(|w| w[1].0 - w[0].0 >= w[0].1 + w[1].1 + 6.0);
        if apart || wanted <= 2 {
            return found;
        }
        wanted -= 1;
    }
}

fn draw_x(svg: &mut Svg, frame: &Frame, x: &Mapping, ticks: &Ticks, label: &[String]) {
    for pixel in ticks.minor.iter().filter_map(|v| x.pixel(*v)) {
        svg.line((pixel, frame.bottom), (pixel, frame.bottom + 0.6 * TICK_LENGTH), 0.8, 0.7);
    }
    for (value, text) in &ticks.major {
        let Some(pixel) = x.pixel(*value) else { continue };
        svg.line((pixel, frame.top), (pixel, frame.bottom), 1.0, 0.1);
        svg.line((pixel, frame.bottom), (pixel, frame.bottom + TICK_LENGTH), 1.0, 0.9);
        let at = (pixel, frame.bottom + TICK_LENGTH + TICK + 3.0);
        svg.rich_text(at, TICK, Anchor::Middle, "", &text.markup(TICK));
    }
    let below = frame.bottom + TICK_LENGTH + TICK + 8.0 + LABEL;
    for (k, line) in label.iter().enumerate() {
        let at = (0.5 * (frame.left + frame.right), below + k as f64 * (LABEL + 3.0));
        svg.text(at, LABEL, Anchor::Middle, "", line);
    }
    common(svg, (frame.right, below), Anchor::End, &ticks.common);
}

fn draw_y(svg: &mut Svg, frame: &Frame, y: &Mapping, ticks: &Ticks, label: &[String]) {
    for pixel in ticks.minor.iter().filter_map(|v| y.pixel(*v)) {
        svg.line((frame.left - 0.6 * TICK_LENGTH, pixel), (frame.left, pixel), 0.8, 0.7);
    }
    for (value, text) in &ticks.major {
        let Some(pixel) = y.pixel(*value) else { continue };
        svg.line((frame.left, pixel), (frame.right, pixel), 1.0, 0.1);
        svg.line((frame.left - TICK_LENGTH, pixel), (frame.left, pixel), 1.0, 0.9);
        let at = (frame.left - TICK_LENGTH - 4.0, pixel + 0.36 * TICK);
        svg.rich_text(at, TICK, Anchor::End, "", &text.markup(TICK));
    }
    let middle = 0.5 * (frame.top + frame.bottom);
    for (k, line) in label.iter().enumerate() {
        let x = 8.0 + LABEL + k as f64 * (LABEL + 3.0);
        let turn = format!("transform=\"rotate(-90 {} {})\"", px(x), px(middle));
        svg.text((x, middle), LABEL, Anchor::Middle, &turn, line);
    }
    common(svg, (frame.left, frame.top - 7.0), Anchor::Start, &ticks.common);
}

/// What the labels of an axis leave out.
pub(crate) fn common(svg: &mut Svg, at: (f64, f64), anchor: Anchor, labels: &[Label]) {
    if labels.is_empty() {
        return;
    }
    // A superscript shifts the baseline, so the next piece must shift it back.
    let markup: Vec<String> = labels
        .iter()
        .enumerate()
        .map(|(k, label)| {
            let back = if k > 0 && labels[k - 1].exponent.is_some() { 0.4 * TICK } else { 0.0 };
            format!("<tspan dy=\"{}\">{}</tspan>", px(back), label.markup(TICK))
        })
        .collect();
    svg.rich_text(at, TICK, anchor, "", &markup.join(" "));
}

fn draw_series(svg: &mut Svg, plot: &Plot, frame: &Frame, x: &Mapping, y: &Mapping) {
    let (left, top) = (px(frame.left), px(frame.top));
    let (width, height) = (px(frame.right - frame.left), px(frame.bottom - frame.top));
    // A nested viewport clips without an id, so that many figures can share a page. Markers may reach over the frame.
    let clips =
        plot.x.range.is_some() || plot.y.range.is_some() || plot.series.iter().any(|s| s.y_error.is_some());
    let overflow = if clips { "hidden" } else { "visible" };
    svg.raw(&format!(
        "<svg x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"{left} {top} {width} {height}\" overflow=\"{overflow}\">\n"
    ));
    for (place, series) in plot.series.iter().enumerate() {
        let name = escape(&series.name);
        svg.raw(&format!(
            "<g aria-label=\"{name}\">\n{}</g>\n",
            marks::series(series, Look::of(series, place), x, y)
        ));
    }
    svg.raw("</svg>\n");
    let points: usize = plot.series.iter().map(|s| s.x.len()).sum();
    let SkippedPoints { not_finite, not_positive, out_of_range } = plot.skipped();
    if points == not_finite + not_positive + out_of_range {
        let at = (0.5 * (frame.left + frame.right), 0.5 * (frame.top + frame.bottom));
        svg.text(at, LABEL, Anchor::Middle, "fill-opacity=\"0.75\"", "nothing to draw");
    }
}

/// One line for each kind of point that is not drawn.
fn notes(plot: &Plot) -> Vec<String> {
    let skipped = plot.skipped();
    let points = |n: usize, one: &str, many: &str| match n {
        0 => None,
        1 => Some(format!("Not drawn: 1 point {one}.")),
        _ => Some(format!("Not drawn: {n} points {many}.")),
    };
    let log = "that a logarithmic axis cannot show (zero or negative)";
    let outside = "outside the range shown";
    let text = [
        points(skipped.not_positive, log, log),
        points(skipped.not_finite, "that is not a finite number", "that are not finite numbers"),
        points(skipped.out_of_range, outside, outside),
    ];
    text.iter().flatten().flat_map(|t| wrap(t, NOTE, plot.width - 60.0)).collect()
}
