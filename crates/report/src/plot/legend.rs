//! The legend: always outside the axes, at the right or below.

use super::marks::Look;
use super::{Plot, Style};
use crate::svg::{Anchor, Svg, px, text_width, wrap};

pub(super) const SIZE: f64 = 12.0;
const LINE: f64 = 15.0;
const SAMPLE: f64 = 26.0;
const GAP: f64 = 8.0;

/// A legend with its place still open.
pub(super) struct Legend {
    entries: Vec<Entry>,
    /// At the right of the axes; otherwise below.
    pub(super) right: bool,
    columns: usize,
    column_width: f64,
}

struct Entry {
    lines: Vec<String>,
    look: Look,
    style: Style,
    bars: bool,
}

impl Legend {
    /// The legend of a figure; `None` if there is nothing to tell apart and nothing named.
    pub(super) fn of(plot: &Plot) -> Option<Self> {
        let named: Vec<_> =
            plot.series.iter().enumerate().filter(|(_, s)| !s.name.trim().is_empty()).collect();
        if named.is_empty() {
            return None;
        }
        let widest = named.iter().map(|(_, s)| text_width(&s.name, SIZE)).fold(0.0, f64::max);
        let right = widest <= 0.26 * plot.width && named.len() as f64 * (LINE + 5.0) <= plot.height - 80.0;
        let room = plot.width - 80.0;
        let text_room = (room - SAMPLE - GAP).min(widest + 1.0);
        let column_width = SAMPLE + GAP + text_room + 18.0;
        let columns =
            if right { 1 } else { ((room / column_width).floor() as usize).max(1).min(named.len()) };
        let entries = named
            .into_iter()
            .map(|(place, s)| Entry {
                lines: wrap(&s.name, SIZE, text_room),
                look: Look::of(s, place),
                style: s.style,
                bars: s.y_error.is_some(),
            })
            .collect();
        Some(Self { entries, right, columns, column_width })
    }

    /// Width that it takes from the axes at the right.
    pub(super) fn width(&self) -> f64 {
        if self.right { self.column_width } else { 0.0 }
    }

    /// Height that it adds below the axes.
    pub(super) fn height(&self) -> f64 {
        if self.right {
            return 0.0;
        }
        self.rows().map(row_height).sum::<f64>() + 8.0
    }

    fn rows(&self) -> impl Iterator<Item = &[Entry]> {
        self.entries.chunks(self.columns)
    }

    /// Draws it with its top left corner at a point.
    pub(super) fn draw(&self, svg: &mut Svg, left: f64, top: f64) {
        let mut y = top;
        for row in self.rows() {
            for (column, entry) in row.iter().enumerate() {
                let x = left + column as f64 * self.column_width;
                let middle = y + 0.5 * LINE;
                entry.sample(svg, x, middle);
                for (k, line) in entry.lines.iter().enumerate() {
                    let at = (x + SAMPLE + GAP, middle + 4.0 + k as f64 * LINE);
                    svg.text(at, SIZE, Anchor::Start, "", line);
                }
            }
            y += row_height(row);
        }
    }
}

fn row_height(row: &[Entry]) -> f64 {
    row.iter().map(|e| e.lines.len()).max().unwrap_or(1) as f64 * LINE + 5.0
}

impl Entry {
    fn sample(&self, svg: &mut Svg, x: f64, middle: f64) {
        let centre = x + 0.5 * SAMPLE;
        if self.style != Style::Points {
            let path = format!("M{} {}H{}", px(x), px(middle), px(x + SAMPLE));
            svg.raw(&format!("<path d=\"{path}\" {}/>\n", self.look.stroke(self.style)));
        }
        if self.bars {
            let (low, high) = (px(middle - 6.0), px(middle + 6.0));
            let (l, c, r) = (px(centre - 3.5), px(centre), px(centre + 3.5));
            svg.raw(&format!(
                "<path d=\"M{l} {low}H{r}M{l} {high}H{r}M{c} {low}V{high}\" fill=\"none\" stroke=\"{}\" \
                 stroke-width=\"1.2\" stroke-opacity=\"0.8\"/>\n",
                self.look.colour.hex()
            ));
        }
        if self.style == Style::Points {
            svg.raw(&self.look.marker(centre, middle));
        }
    }
}
