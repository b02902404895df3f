//! A document as Markdown, for logs and code-review comments.

use crate::document::{Align, Block, Cell, Document, Status, Table, code_spans};
use std::fmt::Write as _;

impl Document {
    /// The document as Markdown in the dialect that common forges show (tables included). A figure becomes a link to its
    /// file; without a file only its caption remains, with the note that the figure is in the page.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        let mut out = format!("# {}\n\n", inline(&self.title));
        blocks(&mut out, &self.blocks);
        while out.ends_with("\n\n") {
            out.pop();
        }
        out
    }
}

fn blocks(out: &mut String, list: &[Block]) {
    for block in list {
        one(out, block);
    }
}

fn one(out: &mut String, block: &Block) {
    match block {
        Block::Heading { level, text } => {
            let level = usize::from((*level).max(2).min(6));
            let _ = write!(out, "{} {}\n\n", "#".repeat(level), inline(text));
        }
        Block::Paragraph(text) => {
            let _ = write!(out, "{}\n\n", inline(text));
        }
        Block::List(points) if points.is_empty() => {}
        Block::List(points) => {
            for point in points {
                let _ = writeln!(out, "- {}", inline(point));
            }
            out.push('\n');
        }
        Block::Table(content) => table(out, content),
        Block::Plot { caption, file, .. } => {
            let caption = if caption.is_empty() { "figure".to_owned() } else { inline(caption) };
            let _ = match file {
                Some(file) => write!(out, "![{caption}](<{}>)\n\n", file.replace(['<', '>', '\n'], "_")),
                None => write!(out, "*Figure, in the HTML report only: {caption}*\n\n"),
            };
        }
        Block::Code { language, text } => {
            let fence = fence(text);
            let language: String = language.chars().filter(|c| c.is_ascii_alphanumeric()).collect();
            let _ = write!(out, "{fence}{language}\n{}\n{fence}\n\n", text.trim_end_matches('\n'));
        }
        Block::Details { summary, status, open, blocks: inner } => {
            let open = if *open { " open" } else { "" };
            let status = status.map_or(String::new(), |s| format!(" ({})", s.word()));
            let summary = crate::svg::escape(summary);
            let _ = write!(out, "<details{open}><summary>{summary}{status}</summary>\n\n");
            blocks(out, inner);
            out.push_str("</details>\n\n");
        }
        Block::Verdict { status, text } => {
            let _ = write!(out, "**{}**: {}\n\n", word(*status), inline(text));
        }
    }
}

fn word(status: Status) -> String {
    status.word().to_uppercase()
}

fn table(out: &mut String, table: &Table) {
    let width = table.width();
    if width == 0 {
        return;
    }
    let row = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let title = |k: usize| table.columns.get(k).map_or(String::new(), |c| in_table(&inline(&c.title)));
    out.push_str(&row((0..width).map(title).collect()));
    let rule = (0..width).map(|k| match table.align(k) {
        Align::Left => "---".to_owned(),
        Align::Right => "---:".to_owned(),
        Align::Centre => ":---:".to_owned(),
    });
    out.push_str(&row(rule.collect()));
    for cells in &table.rows {
        let text = |k: usize| cells.get(k).map_or(String::new(), |c| in_table(&cell(c)));
        out.push_str(&row((0..width).map(text).collect()));
    }
    out.push('\n');
}

fn cell(cell: &Cell) -> String {
    match cell {
        Cell::Text(text) => inline(text),
        Cell::Number { .. } => cell.plain(),
        Cell::Badge { status: Status::Fail, .. } => format!("**{}**", inline(&cell.plain())),
        Cell::Badge { .. } => inline(&cell.plain()),
        Cell::Link { text, target } => {
            let target: String =
                target.chars().filter(|c| !matches!(c, '<' | '>' | '\n' | ' ' | '(' | ')')).collect();
            format!("[{}]({target})", inline(text))
        }
    }
}

/// A table row is one line, and a bar ends a cell even within code.
fn in_table(markdown: &str) -> String {
    markdown.replace("\\|", "|").replace('|', "\\|").replace(['\n', '\r'], " ")
}

/// Text with code spans; all other characters with a meaning in Markdown are escaped.
fn inline(text: &str) -> String {
    code_spans(text)
        .into_iter()
        .map(|(piece, code)| if code { format!("`{piece}`") } else { escaped(piece) })
        .collect::<String>()
        .replace(['\n', '\r'], " ")
}

fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let chars: Vec<char> = text.chars().collect();
    for (k, &c) in chars.iter().enumerate() {
        let special = match c {
            '\\' | '`' | '*' | '<' | '>' | '[' | ']' | '|' | '&' | '$' => true,
            // An underscore or tilde inside a word has no meaning, and names such as k_n stay readable.
            '_' | '~' => {
                !(k > 0
                    && chars[k - 1].is_alphanumeric()
                    && chars.get(k + 1).is_some_and(|n| n.is_alphanumeric()))
            }
            '#' | '-' | '+' => k == 0 && chars.get(1).is_none_or(|n| n.is_whitespace() || *n == c),
            _ => false,
        };
        if special {
            out.push('\\');
        }
        out.push(c);
    }
    out
}

/// A fence longer than any run of backticks in the text.
fn fence(text: &str) -> String {
    let longest = text.split(|c| c != '`').map(str::len).max().unwrap_or(0);
    "`".repeat(longest.max(2) + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_block_has_its_form() {
        let mut values = Table::new(["name", ">largest difference", "|state"]);
        values.push(vec![Cell::text("a|b `c|d`"), Cell::number(3.2e-16), Cell::badge(Status::Pass)]);
        values.push(vec![
            Cell::Link { text: "case".into(), target: "#case".into() },
            Cell::number(f64::INFINITY),
            Cell::badge(Status::Fail),
        ]);
        let document = Document {
            title: "Validation of k_n".into(),
            blocks: vec![
                Block::Verdict { status: Status::Fail, text: "1 of 2 cases".into() },
                Block::heading(2, "Cases"),
                Block::paragraph("A *star*, a <tag> and `code *x*`.\nnext line"),
                Block::List(vec!["one".into(), "two".into()]),
                Block::Table(values),
                Block::Plot {
                    svg: "<svg/>".into(),
                    caption: "speed".into(),
                    file: Some("plots/speed.svg".into()),
                },
                Block::plot("<svg/>", "height"),
                Block::Details {
                    summary: "more <b>".into(),
                    status: Some(Status::Pass),
                    open: false,
                    blocks: vec![Block::code("ron", "a ``` b\n")],
                },
            ],
        };
        let wanted = "# Validation of k_n\n\n**FAIL**: 1 of 2 cases\n\n## Cases\n\n\
            A \\*star\\*, a \\<tag\\> and `code *x*`. next line\n\n- one\n- two\n\n\
            | name | largest difference | state |\n| --- | ---: | :---: |\n\
            | a\\|b `c\\|d` | 3.20e-16 | pass |\n| [case](#case) | inf | **FAIL** |\n\n\
            ![speed](<plots/speed.svg>)\n\n*Figure, in the HTML report only: height*\n\n\
            <details><summary>more &lt;b&gt; (pass)</summary>\n\n````ron\na ``` b\n````\n\n</details>\n";
        assert_eq!(document.to_markdown(), wanted);
    }
}
