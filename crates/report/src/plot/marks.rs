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

/// Fewer points with the same picture: in each quarter of a pixel the first, lowest, highest and last point stay, in
/// their order. Only for long runs that go from left to right.
fn thinned(run: &[(f64, f64)]) -> Vec<(f64, f64)> {
    const LONG: usize = 4000;
    if run.len() <= LONG || run.windows(2).any(|w| w[1].0 < w[0].0) {
        return run.to_vec();
    }
    let column = |p: &(f64, f64)| (p.0 * 4.0).floor();
    let mut kept = Vec::new();
    for group in run.chunk_by(|a, b| column(a) == column(b)) {
        let by_height = |a: &usize, b: &usize| group[*a].1.total_cmp(&group[*b].1);
        let lowest = (0..group.len()).min_by(by_height).unwrap_or(0);
        let highest = (0..group.len()).max_by(by_height).unwrap_or(0);
        let chosen = BTreeSet::from([0, lowest, highest, group.len() - 1]);
        kept.extend(chosen.into_iter().map(|k| group[k]));
    }
    kept
}

/// One marker per tenth of a pixel: further ones would hide exactly behind it.
fn markers(out: &mut String, pixels: &[Option<(f64, f64)>], look: Look) {
    let mut seen = BTreeSet::new();
    for &(vx, vy) in pixels.iter().flatten() {
        if seen.insert(((vx * 10.0).round() as i64, (vy * 10.0).round() as i64)) {
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
    fn short_runs_and_closed_curves_stay_whole() {
        let circle: Vec<(f64, f64)> = (0..9000).map(|k| (f64::from(k) * 1e-3).sin_cos()).collect();
        assert_eq!(thinned(&circle).len(), circle.len());
        assert_eq!(thinned(&circle[..10]).len(), 10);
    }
}
