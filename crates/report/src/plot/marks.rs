//! Lines, markers and error bars of one series.

use super::range::Mapping;
use super::{Series, Style};
use crate::Colour;
use crate::svg::px;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// How the series of one place in the figure looks.
#[derive(Clone, Copy)]
pub(super) struct Look {
    pub(super) colour: Colour,
    /// Number of times that the palette was used up before: chooses a dash pattern for lines.
    pub(super) round: usize,
    /// Chooses the marker.
    pub(super) place: usize,
}

impl Look {
    pub(super) fn of(series: &Series, place: usize) -> Self {
        let palette = Colour::PALETTE;
        Self {
            colour: series.colour.unwrap_or(palette[place % palette.len()]),
            round: place / palette.len(),
            place,
        }
    }

    /// The stroke attributes of a line in this look.
    pub(super) fn stroke(&self, style: Style) -> String {
        let dash = match (style, self.round % 3) {
            (Style::Dashed, 0) => " stroke-dasharray=\"7 4\"",
            (Style::Dashed, _) => " stroke-dasharray=\"3 3\"",
            (_, 0) => "",
            (_, 1) => " stroke-dasharray=\"9 3 2 3\"",
            (_, _) => " stroke-dasharray=\"2 2\"",
        };
        format!(
            "fill=\"none\" stroke=\"{}\" stroke-width=\"1.75\" stroke-linejoin=\"round\"{dash}",
            self.colour.hex()
        )
    }

    /// A marker centred at a point: circle, square, triangle, diamond, in turn.
    pub(super) fn marker(&self, x: f64, y: f64) -> String {
        let fill = self.colour.hex();
        match self.place % 4 {
            0 => format!("<circle cx=\"{}\" cy=\"{}\" r=\"3\" fill=\"{fill}\"/>", px(x), px(y)),
            1 => format!(
                "<rect x=\"{}\" y=\"{}\" width=\"5.4\" height=\"5.4\" fill=\"{fill}\"/>",
                px(x - 2.7),
                px(y - 2.7)
            ),
            2 => format!("<path d=\"M{} {}l3.6 6.2h-7.2z\" fill=\"{fill}\"/>", px(x), px(y - 3.9)),
            _ => format!(
                "<path d=\"M{} {}l3.8 3.8l-3.8 3.8l-3.8 -3.8z\" fill=\"{fill}\"/>",
                px(x),
                px(y - 3.8)
            ),
        }
    }
}

/// The markup of one series on two axes.
pub(super) fn series(series: &Series, look: Look, x: &Mapping, y: &Mapping) -> String {
    let mut out = String::new();
    let pixels: Vec<Option<(f64, f64)>> =
        series.x.iter().zip(&series.y).map(|(&vx, &vy)| Some((x.pixel(vx)?, y.pixel(vy)?))).collect();
    if let Some(bars) = &series.y_error {
        error_bars(&mut out, series, bars, look, x, y);
    }
    if series.style == Style::Points {
        markers(&mut out, &pixels, look);
        return out;
    }
    let mut path = String::new();
    for run in pixels.split(Option::is_none) {
        let run: Vec<(f64, f64)> = run.iter().flatten().copied().collect();
        match run.as_slice() {
            [] => {}
            // A single point between two gaps would be an invisible line.
            [(px_x, px_y)] => out.push_str(&look.marker(*px_x, *px_y)),
            _ => append_line(&mut path, &thinned(&run), series.style == Style::Steps),
        }
    }
    if !path.is_empty() {
        let _ = writeln!(out, "<path d=\"{path}\" {}/>", look.stroke(series.style));
    }
    out
}

fn append_line(path: &mut String, run: &[(f64, f64)], steps: bool) {
    let mut before: Option<(String, String)> = None;
    for &(vx, vy) in run {
        let here = (px(vx), px(vy));
        if before.as_ref() == Some(&here) {
            continue;
        }
        match &before {
            None => {
                let _ = write!(path, "M{} {}", here.0, here.1);
            }
            Some(_) if steps => {
                let _ = write!(path, "H{}V{}", here.0, here.1);
            }
            Some(_) => {
                let _ = write!(path, "L{} {}", here.0, here.1);
            }
        }
        before = Some(here);
    }
}

/// Fewer points with the same picture: points on a straight piece go, where straight means within a tenth of a pixel; in each
/// half of a pixel the first, lowest, highest and last point stay, in their order. Only for long runs that go from left to
/// right.
fn thinned(run: &[(f64, f64)]) -> Vec<(f64, f64)> {
    const LONG: usize = 100;
    if run.len() <= LONG || run.windows(2).any(|w| w[1].0 < w[0].0) {
        return run.to_vec();
    }
    let column = |p: &(f64, f64)| (p.0 * 2.0).floor();
    let mut kept = Vec::new();
    for group in run.chunk_by(|a, b| column(a) == column(b)) {
        let by_height = |a: &usize, b: &usize| group[*a].1.total_cmp(&group[*b].1);
        let lowest = (0..group.len()).min_by(by_height).unwrap_or(0);
        let highest = (0..group.len()).max_by(by_height).unwrap_or(0);
        let chosen = BTreeSet::from([0, lowest, highest, group.len() - 1]);
        kept.extend(chosen.into_iter().map(|k| group[k]));
    }
    straightened(&kept)
}

/// Leaves out points that are within a tenth of a pixel of the line between their neighbours that stay (greedy, from left to
/// right): a corridor of that half width is narrowed by each point until one leaves it.
fn straightened(run: &[(f64, f64)]) -> Vec<(f64, f64)> {
    const HALF_WIDTH: f64 = 0.1;
    let mut kept: Vec<(f64, f64)> = Vec::new();
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for (index, &point) in run.iter().enumerate() {
        let Some(&start) = kept.last() else {
            kept.push(point);
            continue;
        };
        let slope = |y: f64| (y - start.1) / (point.0 - start.0);
        let inside = point.0 > start.0 && (low..=high).contains(&slope(point.1));
        if !inside && run[index - 1] != start {
            kept.push(run[index - 1]);
            (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        let start = *kept.last().unwrap_or(&point);
        if point.0 > start.0 {
            low = low.max((point.1 - HALF_WIDTH - start.1) / (point.0 - start.0));
            high = high.min((point.1 + HALF_WIDTH - start.1) / (point.0 - start.0));
        } else if point != start {
            kept.push(point);
            (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        }
    }
    if let Some(&last) = run.last()
        && kept.last() != Some(&last)
    {
        kept.push(last);
    }
    kept
}

/// One marker per square of two pixels: further ones would hide behind it, for a marker is six pixels wide.
fn markers(out: &mut String, pixels: &[Option<(f64, f64)>], look: Look) {
    let mut seen = BTreeSet::new();
    for &(vx, vy) in pixels.iter().flatten() {
        if seen.insert(((vx / 2.0).round() as i64, (vy / 2.0).round() as i64)) {
            out.push_str(&look.marker(vx, vy));
            out.push('\n');
        }
    }
}

fn error_bars(out: &mut String, series: &Series, bars: &[f64], look: Look, x: &Mapping, y: &Mapping) {
    const CAP: f64 = 3.5;
    let mut path = String::new();
    for ((&vx, &vy), &bar) in series.x.iter().zip(&series.y).zip(bars) {
        if !bar.is_finite() || bar == 0.0 {
            continue;
        }
        let (Some(at), Some(_), Some(top)) = (x.pixel(vx), y.pixel(vy), y.pixel(vy + bar)) else { continue };
        let _ = write!(path, "M{} {}H{}", px(at - CAP), px(top), px(at + CAP));
        // On a logarithmic axis a bar that reaches zero runs out of the figure and has no lower cap.
        match y.pixel(vy - bar) {
            Some(bottom) => {
                let _ = write!(path, "M{} {}H{}", px(at - CAP), px(bottom), px(at + CAP));
                let _ = write!(path, "M{} {}V{}", px(at), px(top), px(bottom));
            }
            None => {
                let _ = write!(path, "M{} {}V{}", px(at), px(top), px(1e6));
            }
        }
    }
    if !path.is_empty() {
        let _ = writeln!(
            out,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.2\" stroke-opacity=\"0.8\"/>",
            look.colour.hex()
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_ends_and_extremes() {
        let run: Vec<(f64, f64)> = (0..200_000)
            .map(|k| {
                let x = f64::from(k) * 0.002;
                (x, if k == 77_777 { 1000.0 } else { (x * 3.0).sin() })
            })
            .collect();
        let kept = thinned(&run);
        assert!(kept.len() < 7000, "{}", kept.len());
        assert_eq!((kept.first(), kept.last()), (run.first(), run.last()));
        assert!(kept.iter().any(|p| p.1 == 1000.0));
        assert!(kept.windows(2).all(|w| w[0].0 <= w[1].0));
    }

    #[test]
    fn straight_pieces_lose_their_points_and_nothing_moves() {
        let run: Vec<(f64, f64)> = (0..6000)
            .map(|k| {
                let x = f64::from(k) * 0.1;
                (x, if x < 200.0 { 50.0 } else { 50.0 + 30.0 * ((x - 200.0) / 40.0).sin() })
            })
            .collect();
        let kept = thinned(&run);
        assert!(kept.len() < 300, "{}", kept.len());
        // Every point that was left out is near the line through those that stayed: a tenth of a pixel for the corridor, and
        // another one because its far end may be on its edge.
        for &(x, y) in &run {
            let after = kept.iter().position(|p| p.0 >= x).unwrap();
            let (a, b) = (kept[after.max(1) - 1], kept[after.max(1)]);
            let line = a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0);
            assert!((line - y).abs() < 0.2, "{x}: {y} {line}");
        }
    }

    #[test]
    fn short_runs_and_closed_curves_stay_whole() {
        let circle: Vec<(f64, f64)> = (0..9000).map(|k| (f64::from(k) * 1e-3).sin_cos()).collect();
        assert_eq!(thinned(&circle).len(), circle.len());
        assert_eq!(thinned(&circle[..10]).len(), 10);
    }
}
