//! The figures of the papers that granule implements, computed: points from runs of the engine on lines from closed forms.
//!
//! A [`Chapter`] is the figures of one paper. `cargo xtask figures NAME` makes them as SVG and CSV with a page that explains
//! them. To add a paper: a module with a function that gives its [`Figure`]s, and a line in [`CHAPTERS`].

pub mod atlas;
mod kondic;
mod luding;
pub mod segregation;
pub mod simulate;

use std::fmt::Write as _;
use std::path::Path;

use granule_report::Plot;

/// Why a figure could not be made.
pub type Error = Box<dyn std::error::Error + Send + Sync>;

/// One figure: what is drawn and what it shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Name of its files, without ending.
    pub name: &'static str,
    /// The figure.
    pub plot: Plot,
    /// What one sees, which errata it shows, and measured differences; Markdown.
    pub caption: String,
}

/// The figures of one paper.
pub struct Chapter {
    /// Name on the command line, and of the folder.
    pub name: &'static str,
    /// Heading of its page.
    pub title: &'static str,
    /// The paper, and what is common to all figures; Markdown.
    pub introduction: &'static str,
    /// Computes all figures.
    pub figures: fn() -> Result<Vec<Figure>, Error>,
}

/// All chapters.
pub const CHAPTERS: &[Chapter] = &[luding::CHAPTER, kondic::CHAPTER];

impl Chapter {
    /// The chapter of that name.
    pub fn named(name: &str) -> Option<&'static Self> {
        CHAPTERS.iter().find(|chapter| chapter.name == name)
    }

    /// Writes each figure as SVG and CSV into `folder`/NAME and the page as `folder`/NAME-figures.md.
    ///
    /// # Errors
    /// A figure cannot be computed or drawn, or a file not written.
    pub fn write(&self, figures: &[Figure], folder: &Path, pictures: &str) -> Result<(), Error> {
        let place = folder.join(pictures);
        std::fs::create_dir_all(&place)?;
        let mut page = format!("# {}\n\n{}\n", self.title, self.introduction.trim());
        for figure in figures {
            std::fs::write(place.join(format!("{}.svg", figure.name)), figure.plot.to_svg()?)?;
            std::fs::write(place.join(format!("{}.csv", figure.name)), csv(&figure.plot))?;
            let (title, name) = (&figure.plot.title, figure.name);
            let _ = write!(
                page,
                "\n## {title}\n\n![{title}]({pictures}/{name}.svg)\n\n{}\n\nNumbers: [{name}.csv]({pictures}/{name}.csv)\n",
                figure.caption.trim()
            );
        }
        std::fs::write(folder.join(format!("{}-figures.md", self.name)), page)?;
        Ok(())
    }
}

/// A plot as a table of one line a point: series, x, y, and the error where there is one.
pub fn csv(plot: &Plot) -> String {
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let mut text = format!("series,{},{},error\n", quoted(&plot.x.label), quoted(&plot.y.label));
    for series in &plot.series {
        for (index, (x, y)) in series.x.iter().zip(&series.y).enumerate() {
            let error = series.y_error.as_ref().and_then(|errors| errors.get(index));
            let error = error.map(|error| format!("{error:.6e}")).unwrap_or_default();
            let _ = writeln!(text, "{},{x:.9e},{y:.9e},{error}", quoted(&series.name));
        }
    }
    text
}

/// Mean and its standard error, 0 for a single value.
fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    (mean, if values.len() > 1 { (square / (count - 1.0) / count).sqrt() } else { 0.0 })
}

/// `count` values from `low` to `high`, both included.
pub fn spread(low: f64, high: f64, count: usize) -> Vec<f64> {
    let last = count.saturating_sub(1).max(1) as f64;
    (0..count).map(|index| low + (high - low) * index as f64 / last).collect()
}

#[cfg(test)]
mod tests {
    use granule_report::{Axis, Series};

    use super::*;

    #[test]
    fn a_chapter_is_written_with_page_picture_and_numbers() {
        let folder = tempfile::tempdir().unwrap();
        let plot = Plot::new("a \"b\"", Axis::linear("x, first"), Axis::linear("y"))
            .with(Series::points("p", vec![1.0], vec![2.0]).with_error(vec![0.5]));
        let figures = [Figure { name: "one", plot, caption: "What it shows.".to_string() }];
        CHAPTERS[0].write(&figures, folder.path(), "figures/luding").unwrap();
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
        assert!(read("figures/luding/one.svg").starts_with("<svg"));
        assert_eq!(
            read("figures/luding/one.csv"),
            "series,\"x, first\",\"y\",error\n\"p\",1.000000000e0,2.000000000e0,5.000000e-1\n"
        );
        let page = read(&format!("{}-figures.md", CHAPTERS[0].name));
        assert!(page.contains("](figures/luding/one.svg)") && page.contains("What it shows."));
    }

    #[test]
    fn names_of_chapters_are_unique() {
        for (index, chapter) in CHAPTERS.iter().enumerate() {
            assert!(CHAPTERS[..index].iter().all(|other| other.name != chapter.name));
            assert!(Chapter::named(chapter.name).is_some());
        }
        assert!(Chapter::named("nobody").is_none());
    }
}
