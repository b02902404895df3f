//! The few SVG pieces that plots and pictures share: escaping, numbers, text widths, a writer.

use std::fmt::Write as _;

/// Fonts that exist on the common systems, all with the Greek, superscript and minus signs used here.
pub(crate) const FONT: &str = "Helvetica Neue, Arial, Liberation Sans, DejaVu Sans, sans-serif";

/// Escapes text for XML and HTML, in elements and in quoted attributes. Control characters that no XML document may
/// hold become U+FFFD.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push(c),
            c if c.is_control() || matches!(c, '\u{FFFE}' | '\u{FFFF}') => out.push('\u{FFFD}'),
            c => out.push(c),
        }
    }
    out
}

/// A coordinate to a hundredth of a pixel without trailing zeros. Coordinates are held within ±10^6 pixels, far outside
/// any picture, so that no viewer overflows.
pub(crate) fn px(value: f64) -> String {
    let held = value.max(-1e6).min(1e6);
    let mut text = format!("{held:.2}");
    while text.ends_with('0') {
        text.pop();
    }
    if text.ends_with('.') {
        text.pop();
    }
    if text == "-0" { "0".to_owned() } else { text }
}

/// Estimated width of text in pixels. The advance widths are those of a wide sans-serif face (DejaVu Sans), so space
/// reserved with them is enough for the narrower ones.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    let em: f64 = text
        .chars()
        .map(|c| match c {
            'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | ' ' | '!' => 0.32,
            'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '/' | '-' => 0.40,
            'm' | 'w' | 'M' | 'W' | '@' | '%' | '−' | '×' | '+' | '=' | '<' | '>' => 0.90,
            c if c.is_ascii_uppercase() => 0.70,
            c if c.is_ascii() => 0.62,
            c if c.is_alphabetic() && (c as u32) < 0x2E80 => 0.66,
            _ => 1.0,
        })
        .sum();
    em * size
}

/// Breaks text at spaces into lines no wider than `width`; a single word wider than that keeps its own line.
pub(crate) fn wrap(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line)
                if text_width(line, size) + text_width(" ", size) + text_width(word, size) <= width =>
            {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Where a text is anchored horizontally.
#[derive(Clone, Copy)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Middle => "middle",
            Self::End => "end",
        }
    }
}

/// An SVG document being written.
pub(crate) struct Svg {
    out: String,
}

impl Svg {
    /// Begins a picture with an accessible name. Ink is `currentColor` and the paper has the class `paper`, so that a
    /// page may set both for a dark scheme; a file opened alone is dark ink on white.
    pub(crate) fn new(width: f64, height: f64, name: &str) -> Self {
        let (w, h) = (px(width), px(height));
        let mut out = String::new();
        let _ = write!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             color=\"#1f2328\" font-family=\"{FONT}\" role=\"img\" aria-label=\"{}\">\n\
             <rect class=\"paper\" width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n",
            escape(name)
        );
        Self { out }
    }

    /// Appends markup that is well formed already.
    pub(crate) fn raw(&mut self, markup: &str) {
        self.out.push_str(markup);
    }

    /// A straight line in ink.
    pub(crate) fn line(&mut self, from: (f64, f64), to: (f64, f64), width: f64, opacity: f64) {
        let _ = writeln!(
            self.out,
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" stroke=\"currentColor\" stroke-width=\"{width}\" \
             stroke-opacity=\"{opacity}\"/>",
            px(from.0),
            px(from.1),
            px(to.0),
            px(to.1)
        );
    }

    /// Text in ink. `attributes` is appended as it is.
    pub(crate) fn text(&mut self, at: (f64, f64), size: f64, anchor: Anchor, attributes: &str, text: &str) {
        self.rich_text(at, size, anchor, attributes, &escape(text));
    }

    /// Text in ink whose content is markup already (for superscripts).
    pub(crate) fn rich_text(
        &mut self,
        at: (f64, f64),
        size: f64,
        anchor: Anchor,
        attributes: &str,
        markup: &str,
    ) {
        let space = if attributes.is_empty() { "" } else { " " };
        let _ = writeln!(
            self.out,
            "<text x=\"{}\" y=\"{}\" font-size=\"{size}\" text-anchor=\"{}\" fill=\"currentColor\"{space}{attributes}>\
             {markup}</text>",
            px(at.0),
            px(at.1),
            anchor.name()
        );
    }

    /// Ends the picture.
    pub(crate) fn finish(mut self) -> String {
        self.out.push_str("</svg>\n");
        self.out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escaping_covers_markup_quotes_and_control_characters() {
        assert_eq!(escape("a<b>&\"c\"'\u{1}\t"), "a&lt;b&gt;&amp;&quot;c&quot;&#39;\u{FFFD}\t");
    }

    #[test]
    fn coordinates_keep_hundredths_and_drop_zeros() {
        for (value, text) in
            [(1.0, "1"), (0.125, "0.12"), (12.5, "12.5"), (-0.001, "0"), (100.0, "100"), (1e300, "1000000")]
        {
            assert_eq!(px(value), text);
        }
    }

    #[test]
    fn wrapping_keeps_every_word_and_the_width() {
        let text = "one two three four five sixteenletterword";
        let lines = wrap(text, 10.0, 60.0);
        assert_eq!(lines.join(" "), text);
        assert!(lines.iter().all(|l| text_width(l, 10.0) <= 60.0 || !l.contains(' ')), "{lines:?}");
    }
}
