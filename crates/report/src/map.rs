//! A map: a field of coloured cells, each of one class, with lines over it.

use crate::ReportError;
use crate::colour::Colour;
use crate::svg::{Anchor, Svg, px, text_width};

/// A class of cells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MapClass {
    /// Name in the legend.
    pub name: String,
    /// Colour of its cells.
    pub colour: Colour,
}

/// A line through a map: one column for each row, where it crosses; columns count from the left edge of the first cell.
#[derive(Clone, Debug, PartialEq)]
pub struct MapLine {
    /// Name in the legend.
    pub name: String,
    /// Where it crosses the middle of each row, in columns from the left; rows without a crossing have none.
    pub columns: Vec<Option<f64>>,
}

/// A field of cells over two settings.
///
/// ```
/// use granule_report::{ClassMap, Colour, MapClass};
/// let map = ClassMap {
///     title: "stability".into(),
///     x_label: "steps".into(),
///     x: vec!["1".into(), "2".into()],
///     y_label: "damping".into(),
///     y: vec!["0".into()],
///     classes: vec![MapClass { name: "stable".into(), colour: Colour::new(0, 158, 115) }],
///     cells: vec![vec![0, 0]],
///     lines: vec![],
/// };
/// assert!(map.to_svg().unwrap().contains("stable"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ClassMap {
    /// Title.
    pub title: String,
    /// Label of the horizontal axis.
    pub x_label: String,
    /// Value of each column, as shown.
    pub x: Vec<String>,
    /// Label of the vertical axis.
    pub y_label: String,
    /// Value of each row from the bottom, as shown.
    pub y: Vec<String>,
    /// Classes.
    pub classes: Vec<MapClass>,
    /// Class of each cell, rows from the bottom.
    pub cells: Vec<Vec<usize>>,
    /// Lines over the cells.
    pub lines: Vec<MapLine>,
}

const CELL: (f64, f64) = (30.0, 22.0);
const LEFT: f64 = 84.0;
const TOP: f64 = 34.0;
const SMALL: f64 = 11.0;

impl ClassMap {
    /// The map as a complete SVG document. The same map always gives the same text.
    ///
    /// # Errors
    /// No cells, rows of different lengths, or a class that does not exist.
    pub fn to_svg(&self) -> Result<String, ReportError> {
        self.check()?;
        let (columns, rows) = (self.x.len() as f64, self.y.len() as f64);
        let legend = self
            .classes
            .iter()
            .map(|class| text_width(&class.name, SMALL))
            .fold(self.lines.iter().map(|line| text_width(&line.name, SMALL)).fold(90.0, f64::max), f64::max);
        let (field_width, field_height) = (columns * CELL.0, rows * CELL.1);
        let width = LEFT + field_width + 40.0 + legend + 16.0;
        let entries = (self.classes.len() + self.lines.len()) as f64;
        let height = TOP + field_height.max(20.0 * entries) + 58.0;
        let mut svg = Svg::new(width, height, &self.title);
        svg.text((LEFT, 20.0), 14.0, Anchor::Start, "font-weight=\"bold\"", &self.title);
        let bottom = TOP + field_height;
        for (row, cells) in self.cells.iter().enumerate() {
            let y = bottom - (row + 1) as f64 * CELL.1;
            for (column, class) in cells.iter().enumerate() {
                let x = LEFT + column as f64 * CELL.0;
                rectangle(&mut svg, x, y, CELL, self.classes[*class].colour);
            }
            svg.text((LEFT - 6.0, y + 0.65 * CELL.1), SMALL, Anchor::End, "", &self.y[row]);
        }
        for (column, value) in self.x.iter().enumerate() {
            let x = LEFT + (column as f64 + 0.5) * CELL.0;
            svg.text((x, bottom + 14.0), SMALL, Anchor::Middle, "", value);
        }
        svg.text((LEFT + 0.5 * field_width, bottom + 34.0), 12.0, Anchor::Middle, "", &self.x_label);
        let middle = TOP + 0.5 * field_height;
        let turn = format!("transform=\"rotate(-90 16 {})\"", px(middle));
        svg.text((16.0, middle), 12.0, Anchor::Middle, &turn, &self.y_label);
        for (index, line) in self.lines.iter().enumerate() {
            self.draw(&mut svg, line, index, bottom);
        }
        self.legend(&mut svg, LEFT + field_width + 14.0);
        Ok(svg.finish())
    }

    /// Vertical pieces through the rows, joined by horizontal ones.
    fn draw(&self, svg: &mut Svg, line: &MapLine, index: usize, bottom: f64) {
        let width = 3.0 - index as f64;
        let mut before: Option<f64> = None;
        for (row, column) in line.columns.iter().enumerate().take(self.y.len()) {
            let (low, high) = (bottom - row as f64 * CELL.1, bottom - (row + 1) as f64 * CELL.1);
            let place = column.map(|column| LEFT + column.max(0.0).min(self.x.len() as f64) * CELL.0);
            if let Some(x) = place {
                svg.line((x, low), (x, high), width.max(1.0), 1.0);
                if let Some(last) = before {
                    svg.line((last, low), (x, low), width.max(1.0), 1.0);
                }
            }
            before = place;
        }
    }

    fn legend(&self, svg: &mut Svg, x: f64) {
        let mut y = TOP;
        for class in &self.classes {
            rectangle(svg, x, y, (14.0, 14.0), class.colour);
            svg.text((x + 20.0, y + 11.0), SMALL, Anchor::Start, "", &class.name);
            y += 20.0;
        }
        for (index, line) in self.lines.iter().enumerate() {
            svg.line((x, y + 7.0), (x + 14.0, y + 7.0), (3.0 - index as f64).max(1.0), 1.0);
            svg.text((x + 20.0, y + 11.0), SMALL, Anchor::Start, "", &line.name);
            y += 20.0;
        }
    }

    fn check(&self) -> Result<(), ReportError> {
        if self.x.is_empty() || self.y.is_empty() {
            return Err(ReportError::Invalid(format!("map `{}` has no cells", self.title)));
        }
        let length = |expected: usize, found: usize| {
            let what = format!("map `{}`", self.title);
            if expected == found {
                Ok(())
            } else {
                Err(ReportError::LengthMismatch { what, expected, found })
            }
        };
        length(self.y.len(), self.cells.len())?;
        for cells in &self.cells {
            length(self.x.len(), cells.len())?;
            if let Some(class) = cells.iter().find(|class| **class >= self.classes.len()) {
                return Err(ReportError::Invalid(format!("map `{}` has no class {class}", self.title)));
            }
        }
        Ok(())
    }
}

fn rectangle(svg: &mut Svg, x: f64, y: f64, size: (f64, f64), colour: Colour) {
    svg.raw(&format!(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"0.5\"/>\n",
        px(x),
        px(y),
        px(size.0),
        px(size.1),
        colour.hex()
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> ClassMap {
        ClassMap {
            title: "a < b".into(),
            x_label: "x".into(),
            x: vec!["1".into(), "2".into()],
            y_label: "y".into(),
            y: vec!["0".into(), "5".into()],
            classes: ["one", "two"]
                .map(|name| MapClass { name: name.into(), colour: Colour::PALETTE[name.len() - 3] })
                .to_vec(),
            cells: vec![vec![0, 1], vec![1, 1]],
            lines: vec![MapLine { name: "limit".into(), columns: vec![Some(0.5), Some(1.0)] }],
        }
    }

    #[test]
    fn every_cell_label_and_line_is_drawn() {
        let svg = map().to_svg().unwrap();
        // The paper, four cells and two entries of the legend.
        assert_eq!(svg.matches("<rect").count(), 7);
        assert!(svg.contains("a &lt; b") && svg.contains(">limit<") && svg.contains(">5<"));
        // Two pieces, a joint, and the entry of the legend.
        assert_eq!(svg.matches("<line").count(), 4);
    }

    #[test]
    fn fields_that_do_not_fit_are_refused() {
        assert!(ClassMap { cells: vec![vec![0, 1]], ..map() }.to_svg().is_err());
        assert!(ClassMap { cells: vec![vec![0, 1], vec![1]], ..map() }.to_svg().is_err());
        assert!(ClassMap { cells: vec![vec![0, 1], vec![1, 2]], ..map() }.to_svg().is_err());
        assert!(ClassMap { x: vec![], ..map() }.to_svg().is_err());
    }
}
