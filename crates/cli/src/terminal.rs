//! Writing to the terminal: colours only where there is one, and no panic when nobody reads any more.

use std::io::Write;

use anstyle::{AnsiColor, Style};
use granule::prelude::{Diagnostic, Severity, Source};

/// Style of errors.
pub const ERROR: Style = AnsiColor::Red.on_default().bold();
/// Style of warnings.
pub const WARNING: Style = AnsiColor::Yellow.on_default().bold();
/// Style of headings.
pub const HEADING: Style = Style::new().bold();

/// Writes to standard output. A reader that has gone away (`granule laws | head`) is no error.
pub fn out(text: &str) {
    let mut stream = anstream::stdout().lock();
    // Nothing useful can be done when standard output is closed.
    let _ = stream.write_all(text.as_bytes()).and_then(|()| stream.flush());
}

/// Writes to standard error.
pub fn err(text: &str) {
    let mut stream = anstream::stderr().lock();
    // Nothing useful can be done when standard error is closed.
    let _ = stream.write_all(text.as_bytes()).and_then(|()| stream.flush());
}

/// Writes `error: message` to standard error.
pub fn error(message: &str) {
    err(&format!("{ERROR}error{ERROR:#}: {message}\n"));
}

/// A text in a style.
pub fn styled(style: Style, text: &str) -> String {
    format!("{style}{text}{style:#}")
}

/// Shows the problems of a scene on standard error.
pub fn diagnostics(source: &Source, diagnostics: &[Diagnostic]) {
    let file = source.path.display().to_string();
    for diagnostic in diagnostics {
        err(&colour(&diagnostic.render(&file, &source.text), diagnostic.severity));
    }
}

/// Number of errors and warnings in words, as in `2 errors, 1 warning`.
pub fn count(diagnostics: &[Diagnostic]) -> String {
    let plural = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    let of = |severity| diagnostics.iter().filter(|diagnostic| diagnostic.severity == severity).count();
    let (errors, warnings) = (of(Severity::Error), of(Severity::Warning));
    match (errors, warnings) {
        (errors, 0) => plural(errors, "error"),
        (0, warnings) => plural(warnings, "warning"),
        (errors, warnings) => format!("{}, {}", plural(errors, "error"), plural(warnings, "warning")),
    }
}

/// Colours a rendered diagnostic: the severity in its first line, and the mark under the source line.
fn colour(rendered: &str, severity: Severity) -> String {
    let style = match severity {
        Severity::Error => ERROR,
        Severity::Warning => WARNING,
    };
    let name = severity.name();
    let mut out = String::with_capacity(rendered.len() + 64);
    for (index, line) in rendered.lines().enumerate() {
        let carets = line.trim_end().trim_end_matches('^');
        let is_mark = index == 3 && carets.len() < line.trim_end().len();
        match line.split_once(&format!(" {name}: ")) {
            Some((place, message)) if index == 0 => {
                out.push_str(&format!("{HEADING}{place}{HEADING:#} {style}{name}{style:#}: {message}"));
            }
            _ if is_mark => out.push_str(&format!("{carets}{style}{}{style:#}", &line[carets.len()..])),
            _ => out.push_str(line),
        }
        out.push('\n');
    }
    out
}

/// Breaks a text into lines of at most `width` characters at its spaces; words longer than that stay whole.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > width {
                lines.push(std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_severity_and_the_mark_are_coloured() {
        let text = "(a: x)";
        let plain = Diagnostic::error(4..5, "no error: here").help("^^").render("f:1", text);
        let coloured = colour(&plain, Severity::Error);
        assert_eq!(anstream::adapter::strip_str(&coloured).to_string(), plain);
        let lines: Vec<&str> = coloured.lines().collect();
        assert_eq!(lines[0], format!("{HEADING}f:1:1:5:{HEADING:#} {ERROR}error{ERROR:#}: no error: here"));
        assert!(lines[3].ends_with(&format!("{ERROR}^{ERROR:#}")), "{:?}", lines[3]);
        assert!(!lines[4].contains('\u{1b}'), "{:?}", lines[4]);
    }

    #[test]
    fn wrapping_keeps_every_word() {
        let text = "one two three four\nfive sixsixsixsix";
        assert_eq!(wrap(text, 9), ["one two", "three", "four", "five", "sixsixsixsix"]);
    }
}
