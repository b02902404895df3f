//! The document model: what a page says, without how it looks.
//!
//! Texts may hold `code` between backticks; everything else is literal and is escaped by the renderer.

use crate::number::format_number;

/// A document, rendered by [`Document::to_html`] as one self-contained page and by [`Document::to_markdown`] for logs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// Title of the page.
    pub title: String,
    /// The body, first to last.
    pub blocks: Vec<Block>,
}

/// A piece of a document.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// A heading; level 2 is a chapter, up to 6. Other levels are taken as the nearest of these.
    Heading {
        /// 2 to 6.
        level: u8,
        /// The text.
        text: String,
    },
    /// A paragraph.
    Paragraph(String),
    /// A list of short points.
    List(Vec<String>),
    /// A table.
    Table(Table),
    /// A figure.
    Plot {
        /// A complete SVG document as this crate writes it. It is put into the page as it is, so only SVG from a
        /// trusted source belongs here.
        svg: String,
        /// Text below the figure; may be empty.
        caption: String,
        /// Where the figure also lies as a file, relative to the document: Markdown links to it.
        file: Option<String>,
    },
    /// Text in a fixed-width face, kept letter by letter.
    Code {
        /// Language for highlighting, such as `ron`; may be empty.
        language: String,
        /// The text.
        text: String,
    },
    /// A part that the reader can open and close.
    Details {
        /// The line that is always visible.
        summary: String,
        /// A badge at the end of that line.
        status: Option<Status>,
        /// Open at first.
        open: bool,
        /// What it holds.
        blocks: Vec<Block>,
    },
    /// One line that tells the outcome.
    Verdict {
        /// The outcome.
        status: Status,
        /// What it means.
        text: String,
    },
}

/// An outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Met.
    Pass,
    /// Not met.
    Fail,
    /// Met or not, the reader must know something about it.
    Warning,
    /// A fact without a judgement.
    Note,
}

/// Where the text of a column stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// For text.
    #[default]
    Left,
    /// For numbers; digits have one width.
    Right,
    /// For badges.
    Centre,
}

/// The head of a column.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Column {
    /// Its title.
    pub title: String,
    /// Alignment of the whole column.
    pub align: Align,
}

/// A table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Column heads.
    pub columns: Vec<Column>,
    /// Rows. A short row is filled with empty cells; cells beyond the last column get a column without a title.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Text.
    Text(String),
    /// A number with so many significant digits, see [`format_number`].
    Number {
        /// The number.
        value: f64,
        /// Significant digits.
        digits: usize,
    },
    /// A badge with its own word, or the usual word of its status if that is empty.
    Badge {
        /// Chooses the colour.
        status: Status,
        /// The word.
        text: String,
    },
    /// A link to a heading of the same document, or to a file beside it.
    Link {
        /// What is read.
        text: String,
        /// Where it leads: [`Document::anchor`] of a heading behind `#`, or a relative address.
        target: String,
    },
}

impl Status {
    /// The usual word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "FAIL",
            Self::Warning => "warning",
            Self::Note => "note",
        }
    }

    /// Pass or fail.
    #[must_use]
    pub fn of(pass: bool) -> Self {
        if pass { Self::Pass } else { Self::Fail }
    }
}

impl Cell {
    /// A text cell.
    #[must_use]
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// A number with three significant digits.
    #[must_use]
    pub fn number(value: f64) -> Self {
        Self::Number { value, digits: 3 }
    }

    /// A badge with the usual word of its status.
    #[must_use]
    pub fn badge(status: Status) -> Self {
        Self::Badge { status, text: String::new() }
    }

    /// What a reader sees, without markup.
    #[must_use]
    pub fn plain(&self) -> String {
        match self {
            Self::Text(text) | Self::Link { text, .. } => text.clone(),
            Self::Number { value, digits } => format_number(*value, *digits),
            Self::Badge { status, text } if text.is_empty() => status.word().to_owned(),
            Self::Badge { text, .. } => text.clone(),
        }
    }
}

impl Table {
    /// A table without rows; a title that begins with `>` makes its column right-aligned, with `|` centred.
    ///
    /// ```
    /// use granule_report::{Align, Table};
    /// assert_eq!(Table::new(["name", ">time [s]"]).columns[1].align, Align::Right);
    /// ```
    #[must_use]
    pub fn new<'a>(titles: impl IntoIterator<Item = &'a str>) -> Self {
        let column = |title: &str| {
            let (title, align) = match (title.strip_prefix('>'), title.strip_prefix('|')) {
                (Some(rest), _) => (rest, Align::Right),
                (_, Some(rest)) => (rest, Align::Centre),
                _ => (title, Align::Left),
            };
            Column { title: title.to_owned(), align }
        };
        Self { columns: titles.into_iter().map(column).collect(), rows: Vec::new() }
    }

    /// Appends a row.
    pub fn push(&mut self, row: Vec<Cell>) {
        self.rows.push(row);
    }

    /// Number of columns that the widest row or the head needs.
    pub(crate) fn width(&self) -> usize {
        self.rows.iter().map(Vec::len).fold(self.columns.len(), usize::max)
    }

    pub(crate) fn align(&self, column: usize) -> Align {
        self.columns.get(column).map_or(Align::Left, |c| c.align)
    }

    /// The table as text with aligned columns, for a terminal.
    #[must_use]
    pub fn to_text(&self) -> String {
        let rows: Vec<Vec<String>> =
            self.rows.iter().map(|row| row.iter().map(Cell::plain).collect()).collect();
        let head: Vec<String> = self.columns.iter().map(|c| c.title.clone()).collect();
        let length = |row: &Vec<String>, k: usize| row.get(k).map_or(0, |text| text.chars().count());
        let widths: Vec<usize> = (0..self.width())
            .map(|k| rows.iter().map(|row| length(row, k)).fold(length(&head, k), usize::max))
            .collect();
        let has_head = head.iter().any(|title| !title.is_empty());
        let mut out = String::new();
        let rule: Vec<String> = widths.iter().map(|w| "-".repeat(*w)).collect();
        for row in has_head.then_some([&head, &rule]).into_iter().flatten().chain(&rows) {
            let line: Vec<String> = widths
                .iter()
                .enumerate()
                .map(|(k, width)| {
                    let text = row.get(k).map_or("", String::as_str);
                    match self.align(k) {
                        Align::Left => format!("{text:<width$}"),
                        Align::Right => format!("{text:>width$}"),
                        Align::Centre => format!("{text:^width$}"),
                    }
                })
                .collect();
            out.push_str(line.join("  ").trim_end());
            out.push('\n');
        }
        out
    }
}

impl Block {
    /// A heading of a chapter (2) or below.
    #[must_use]
    pub fn heading(level: u8, text: impl Into<String>) -> Self {
        Self::Heading { level, text: text.into() }
    }

    /// A paragraph.
    #[must_use]
    pub fn paragraph(text: impl Into<String>) -> Self {
        Self::Paragraph(text.into())
    }

    /// A figure without a file.
    #[must_use]
    pub fn plot(svg: impl Into<String>, caption: impl Into<String>) -> Self {
        Self::Plot { svg: svg.into(), caption: caption.into(), file: None }
    }

    /// Text in a fixed-width face.
    #[must_use]
    pub fn code(language: impl Into<String>, text: impl Into<String>) -> Self {
        Self::Code { language: language.into(), text: text.into() }
    }
}

impl Document {
    /// A document with a title only.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), blocks: Vec::new() }
    }

    /// Appends a block.
    pub fn push(&mut self, block: Block) {
        self.blocks.push(block);
    }

    /// The anchor that a heading with this text has: lower case, words joined by `-`, as common Markdown viewers make it.
    #[must_use]
    pub fn anchor(heading: &str) -> String {
        heading
            .chars()
            .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'))
            .flat_map(char::to_lowercase)
            .map(|c| if c == ' ' { '-' } else { c })
            .collect()
    }
}

/// A text cut at its backticks: `(piece, is code)`. A backtick without its partner is literal.
pub(crate) fn code_spans(text: &str) -> Vec<(&str, bool)> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(open) = rest.find('`') {
        let Some(length) = rest[open + 1..].find('`') else { break };
        let close = open + 1 + length;
        if open > 0 {
            pieces.push((&rest[..open], false));
        }
        if length > 0 {
            pieces.push((&rest[open + 1..close], true));
        }
        rest = &rest[close + 1..];
    }
    if !rest.is_empty() {
        pieces.push((rest, false));
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backticks_make_code_only_in_pairs() {
        assert_eq!(code_spans("a `b` c"), [("a ", false), ("b", true), (" c", false)]);
        assert_eq!(code_spans("a ` b"), [("a ` b", false)]);
        assert_eq!(code_spans("`x`"), [("x", true)]);
        assert_eq!(code_spans(""), []);
    }

    #[test]
    fn a_table_is_aligned_for_the_terminal() {
        let mut table = Table::new(["phase", ">time [s]", "|ok"]);
        table.push(vec![Cell::text("search"), Cell::number(1.25), Cell::badge(Status::Pass)]);
        table.push(vec![Cell::text("µ"), Cell::number(12.0)]);
        assert_eq!(
            table.to_text(),
            "phase   time [s]   ok\n------  --------  ----\nsearch      1.25  pass\nµ             12\n"
        );
    }

    #[test]
    fn anchors_are_those_of_markdown_viewers() {
        assert_eq!(Document::anchor("Head-on, `LSD` (force end)"), "head-on-lsd-force-end");
    }
}
