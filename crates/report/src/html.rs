//! A document as one self-contained HTML page: style inside, no script, no network.

use crate::document::{Align, Block, Cell, Document, Status, Table, code_spans};
use crate::svg::escape;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Light and dark by the reader's setting, and black on white on paper.
const STYLE: &str = include_str!("html.css");

impl Document {
    /// The document as a page that needs no other file. It is well-formed XML too.
    #[must_use]
    pub fn to_html(&self) -> String {
        let mut page = Page { out: String::new(), anchors: BTreeMap::new() };
        let title = escape(&self.title);
        let _ = write!(
            page.out,
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
             <meta name=\"color-scheme\" content=\"light dark\"/>\n<title>{title}</title>\n\
             <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{}</h1>\n",
            inline(&self.title)
        );
        page.contents(&self.blocks);
        page.blocks(&self.blocks);
        page.out.push_str("</main>\n</body>\n</html>\n");
        page.out
    }
}

struct Page {
    out: String,
    /// How often an anchor was given out: the second heading of one name gets `-1`, as in Markdown viewers.
    anchors: BTreeMap<String, usize>,
}

impl Page {
    fn anchor(&mut self, text: &str) -> String {
        let base = Document::anchor(text);
        let count = self.anchors.entry(base.clone()).or_insert(0);
        *count += 1;
        if *count == 1 { base } else { format!("{base}-{}", *count - 1) }
    }

    /// Links to the chapters, if there are enough of them to lose one's way.
    fn contents(&mut self, blocks: &[Block]) {
        let chapters: Vec<&String> = blocks
            .iter()
            .filter_map(|b| match b {
                Block::Heading { level, text } if *level <= 2 => Some(text),
                _ => None,
            })
            .collect();
        if chapters.len() < 3 {
            return;
        }
        self.out.push_str("<nav><ul>\n");
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for text in chapters {
            let base = Document::anchor(text);
            let count = counts.entry(base.clone()).or_insert(0);
            let id = if *count == 0 { base } else { format!("{base}-{count}") };
            *count += 1;
            let _ = writeln!(self.out, "<li><a href=\"#{}\">{}</a></li>", escape(&id), inline(text));
        }
        self.out.push_str("</ul></nav>\n");
    }

    fn blocks(&mut self, blocks: &[Block]) {
        for block in blocks {
            self.block(block);
        }
    }

    fn block(&mut self, block: &Block) {
        match block {
            Block::Heading { level, text } => {
                let level = (*level).max(2).min(6);
                let id = self.anchor(text);
                let _ = writeln!(self.out, "<h{level} id=\"{}\">{}</h{level}>", escape(&id), inline(text));
            }
            Block::Paragraph(text) => {
                let _ = writeln!(self.out, "<p>{}</p>", inline(text));
            }
            Block::List(points) if points.is_empty() => {}
            Block::List(points) => {
                self.out.push_str("<ul>\n");
                for point in points {
                    let _ = writeln!(self.out, "<li>{}</li>", inline(point));
                }
                self.out.push_str("</ul>\n");
            }
            Block::Table(table) => self.table(table),
            Block::Plot { svg, caption, .. } => {
                let _ = writeln!(self.out, "<figure>\n{}", svg.trim_end());
                if !caption.is_empty() {
                    let _ = writeln!(self.out, "<figcaption>{}</figcaption>", inline(caption));
                }
                self.out.push_str("</figure>\n");
            }
            Block::Code { language, text } => {
                let class = if language.is_empty() {
                    String::new()
                } else {
                    format!(" class=\"language-{}\"", escape(language))
                };
                let _ = writeln!(self.out, "<pre><code{class}>{}</code></pre>", escape(text));
            }
            Block::Details { summary, status, open, blocks } => {
                let open = if *open { " open=\"open\"" } else { "" };
                let badge = status.map_or(String::new(), |s| format!(" {}", badge(s, "")));
                let _ = writeln!(
                    self.out,
                    "<details{open}>\n<summary><span>{}</span>{badge}</summary>",
                    inline(summary)
                );
                self.blocks(blocks);
                self.out.push_str("</details>\n");
            }
            Block::Verdict { status, text } => {
                let (class, badge) = (class(*status), badge(*status, ""));
                let _ = writeln!(
                    self.out,
                    "<p class=\"verdict {class}\">{badge} <span>{}</span></p>",
                    inline(text)
                );
            }
        }
    }

    fn table(&mut self, table: &Table) {
        self.out.push_str("<div class=\"scroll\"><table>\n");
        let width = table.width();
        let align = |column: usize| match table.align(column) {
            Align::Left => "",
            Align::Right => " class=\"number\"",
            Align::Centre => " class=\"centre\"",
        };
        if table.columns.iter().any(|c| !c.title.is_empty()) {
            self.out.push_str("<thead><tr>");
            for k in 0..width {
                let title = table.columns.get(k).map_or("", |c| c.title.as_str());
                let _ = write!(self.out, "<th scope=\"col\"{}>{}</th>", align(k), inline(title));
            }
            self.out.push_str("</tr></thead>\n");
        }
        self.out.push_str("<tbody>\n");
        for row in &table.rows {
            self.out.push_str("<tr>");
            for k in 0..width {
                let _ = write!(self.out, "<td{}>{}</td>", align(k), row.get(k).map_or(String::new(), cell));
            }
            self.out.push_str("</tr>\n");
        }
        self.out.push_str("</tbody>\n</table></div>\n");
    }
}

/// Text with its code spans, escaped.
fn inline(text: &str) -> String {
    code_spans(text)
        .into_iter()
        .map(|(piece, code)| if code { format!("<code>{}</code>", escape(piece)) } else { escape(piece) })
        .collect()
}

fn cell(cell: &Cell) -> String {
    match cell {
        Cell::Text(text) => inline(text),
        Cell::Number { .. } => escape(&cell.plain()).replace('-', "−"),
        Cell::Badge { status, text } => badge(*status, text),
        Cell::Link { text, target } if safe(target) => {
            format!("<a href=\"{}\">{}</a>", escape(target), inline(text))
        }
        Cell::Link { text, .. } => inline(text),
    }
}

/// A link may lead within the page, to a file beside it, or to the web; never to a script.
fn safe(target: &str) -> bool {
    let scheme = target.split(['/', '#', '?']).next().unwrap_or("");
    !scheme.contains(':') || target.starts_with("https://") || target.starts_with("http://")
}

fn class(status: Status) -> &'static str {
    match status {
        Status::Pass => "pass",
        Status::Fail => "fail",
        Status::Warning => "warning",
        Status::Note => "note",
    }
}

fn badge(status: Status, text: &str) -> String {
    let word = if text.is_empty() { status.word() } else { text };
    format!("<span class=\"badge {}\">{}</span>", class(status), escape(word))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Plot, Series};

    fn parse(html: &str) -> roxmltree::Document<'_> {
        let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
        roxmltree::Document::parse_with_options(html, options).unwrap()
    }

    fn sample() -> Document {
        let nasty = "<script>alert(\"1\")</script> & 'co' `a<b>`";
        let mut table = Table::new([nasty, ">value", "|state"]);
        table.push(vec![Cell::text(nasty), Cell::number(-1.5e-16), Cell::badge(Status::Fail)]);
        table.push(vec![Cell::Link { text: nasty.into(), target: "#a\"b".into() }]);
        table.push(vec![Cell::Link { text: "bad".into(), target: "javascript:alert(1)".into() }; 4]);
        let svg = Plot::new(nasty, Axis::linear("x"), Axis::linear("y")).with(Series::line(
            "s",
            vec![1.0],
            vec![1.0],
        ));
        let mut document = Document::new(nasty);
        document.blocks = vec![
            Block::Verdict { status: Status::Fail, text: nasty.into() },
            Block::heading(2, "One"),
            Block::paragraph(nasty),
            Block::List(vec![nasty.into()]),
            Block::heading(2, "One"),
            Block::Table(table),
            Block::heading(2, nasty),
            Block::plot(svg.to_svg().unwrap(), nasty),
            Block::Details {
                summary: nasty.into(),
                status: Some(Status::Pass),
                open: true,
                blocks: vec![Block::code("ron", nasty)],
            },
        ];
        document
    }

    #[test]
    fn the_page_is_well_formed_and_holds_no_markup_from_text() {
        let html = sample().to_html();
        let doc = parse(&html);
        assert!(doc.descendants().all(|n| !n.has_tag_name("script")));
        assert_eq!(
            doc.descendants().find(|n| n.has_tag_name("title")).unwrap().text(),
            Some(sample().title.as_str())
        );
        let code = doc.descendants().find(|n| n.has_tag_name("pre")).unwrap().first_element_child().unwrap();
        assert_eq!(code.text(), Some(sample().title.as_str()));
        assert_eq!(
            doc.descendants().filter(|n| n.has_tag_name("code") && n.text() == Some("a<b>")).count(),
            11
        );
    }

    #[test]
    fn the_page_needs_nothing_else() {
        let html = sample().to_html();
        for tag in ["<link", "<img", "<iframe", "src=", "@import", "url(http"] {
            assert!(!html.contains(tag), "{tag}");
        }
        assert!(!html.contains("javascript:"));
    }

    #[test]
    fn anchors_are_unique_and_the_contents_meet_them() {
        let html = sample().to_html();
        let doc = parse(&html);
        let mut ids: Vec<_> = doc.descendants().filter_map(|n| n.attribute("id")).collect();
        let links: Vec<_> = doc
            .descendants()
            .find(|n| n.has_tag_name("nav"))
            .unwrap()
            .descendants()
            .filter_map(|n| n.attribute("href"))
            .map(|href| &href[1..])
            .collect();
        assert_eq!(ids, links);
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), 3);
    }

    #[test]
    fn rows_are_filled_to_one_width_and_numbers_stand_right() {
        let html = sample().to_html();
        let doc = parse(&html);
        for row in doc.descendants().filter(|n| n.has_tag_name("tr")) {
            assert_eq!(row.children().filter(roxmltree::Node::is_element).count(), 4);
        }
        let number = doc.descendants().find(|n| n.text() == Some("−1.50e−16")).unwrap();
        assert_eq!(number.attribute("class"), Some("number"));
    }
}
