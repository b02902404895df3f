//! What is wrong, where, and what would be right.

use std::fmt::Write as _;
use std::ops::Range;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Nothing can run.
    Error,
    /// It runs, but is probably not what was meant.
    Warning,
}

impl Severity {
    /// `error` or `warning`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
        }
    }
}

/// One problem of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// Bytes of the scene text that it is about.
    pub span: Range<usize>,
    /// What is wrong, with the offending value.
    pub message: String,
    /// What is allowed, or what to do.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error.
    pub fn error(span: Range<usize>, message: impl Into<String>) -> Self {
        Self { severity: Severity::Error, span, message: message.into(), help: None }
    }

    /// A warning.
    pub fn warning(span: Range<usize>, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, span, message: message.into(), help: None }
    }

    /// Adds what is allowed, or what to do.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Line and column, counted from 1 in characters, where it begins.
    pub fn position(&self, text: &str) -> (usize, usize) {
        position(text, self.span.start)
    }

    /// Plain text for a terminal: place, message, the line with a mark under it, and help.
    pub fn render(&self, file: &str, text: &str) -> String {
        let (line, column) = self.position(text);
        let mut out = format!("{file}:{line}:{column}: {}: {}\n", self.severity.name(), self.message);
        let start = floor_boundary(text, self.span.start);
        let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let source = text[line_start..].lines().next().unwrap_or("");
        // A long line is shown around the mark only.
        let (shown, offset) = window(source, column - 1);
        let end = floor_boundary(text, self.span.end.max(start)).min(line_start + source.len());
        let marked = text.get(start..end.max(start)).map_or(0, |marked| marked.chars().count());
        let room = shown.chars().count().saturating_sub(offset);
        let width = marked.min(room).max(1);
        let number = line.to_string();
        let margin = " ".repeat(number.len());
        let blank: String = shown.chars().take(offset).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(out, " {margin} |");
        let _ = writeln!(out, " {number} | {shown}");
        let _ = writeln!(out, " {margin} | {blank}{}", "^".repeat(width));
        if let Some(help) = &self.help {
            let _ = writeln!(out, " {margin} = help: {help}");
        }
        out
    }
}

/// Line and column, counted from 1 in characters, of a byte offset.
pub fn position(text: &str, offset: usize) -> (usize, usize) {
    let before = &text[..floor_boundary(text, offset)];
    let line_start = before.rfind('\n').map_or(0, |at| at + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

fn floor_boundary(text: &str, offset: usize) -> usize {
    let mut at = offset.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// At most 120 characters of a line around a character, and where that character then is.
fn window(line: &str, at: usize) -> (String, usize) {
    const WIDTH: usize = 120;
    let count = line.chars().count();
    if count <= WIDTH {
        return (line.to_string(), at.min(count));
    }
    let first = at.saturating_sub(WIDTH / 2).min(count - WIDTH);
    (line.chars().skip(first).take(WIDTH).collect(), at.saturating_sub(first).min(WIDTH))
}

/// Sorts by place, errors before warnings at the same place, and drops repetitions.
pub fn tidy(diagnostics: &mut Vec<Diagnostic>) {
    diagnostics.sort_by(|a, b| {
        (a.span.start, a.severity, a.span.end, &a.message).cmp(&(
            b.span.start,
            b.severity,
            b.span.end,
            &b.message,
        ))
    });
    diagnostics.dedup();
}

/// The candidate that is most similar to `name`, if it is similar enough to be a slip of the pen.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = name.to_lowercase();
    candidates
        .into_iter()
        .map(|candidate| (strsim::jaro_winkler(&lower, &candidate.to_lowercase()), candidate))
        .filter(|(similarity, _)| *similarity >= 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// `did you mean ...? ` if something is near, then the allowed names.
pub fn suggestion(what: &str, name: &str, candidates: &[&str]) -> String {
    let allowed = format!("{what}: {}", candidates.join(", "));
    match nearest(name, candidates.iter().copied()) {
        Some(near) => format!("did you mean `{near}`? {allowed}"),
        None => allowed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mark_is_under_the_value() {
        let text = "(\n  radius: -1,\n)";
        let d = Diagnostic::error(12..14, "`radius` must be greater than 0, not -1").help("try 1");
        assert_eq!(
            d.render("s.ron", text),
            "s.ron:2:11: error: `radius` must be greater than 0, not -1\n   |\n 2 |   radius: -1,\n   |           ^^\n   \
             = help: try 1\n"
        );
    }

    #[test]
    fn spans_out_of_the_text_are_cut() {
        let text = "(ä: 1)";
        for start in 0..12 {
            for end in 0..12 {
                let _ = Diagnostic::warning(start..end, "m").render("s", text);
            }
        }
        let long = format!("(a: \"{}\", b: x)", "y".repeat(500));
        let at = long.len() - 2;
        let shown = Diagnostic::error(at..at + 1, "m").render("s", &long);
        assert!(shown.lines().nth(2).unwrap().ends_with("b: x)"));
        assert!(shown.lines().nth(3).unwrap().ends_with('^'));
    }

    #[test]
    fn a_slip_of_the_pen_is_found() {
        assert_eq!(nearest("radios", ["radius", "mass"]), Some("radius"));
        assert_eq!(nearest("zzz", ["radius", "mass"]), None);
    }
}
