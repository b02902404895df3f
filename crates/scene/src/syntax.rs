//! RON with places: a fragment of the text, opened one level at a time.
//!
//! The parsing is that of `ron`, whose [`RawValue`] borrows a fragment from the text; the offset of a fragment is
//! the difference of two pointers into the same text. Opening level by level lets one problem not hide the next.

use std::fmt;
use std::ops::Range;

use ron::value::RawValue;
use serde::Deserializer as _;
use serde::de::{DeserializeSeed, MapAccess, SeqAccess, Visitor};

use crate::Diagnostic;

/// A value of the text, not yet opened.
#[derive(Clone, Copy, Debug)]
pub struct Node<'a> {
    text: &'a str,
    start: usize,
}

/// A named value of a struct.
#[derive(Clone, Debug)]
pub struct Entry<'a> {
    /// Name of the field.
    pub name: String,
    /// Where the name stands.
    pub span: Range<usize>,
    /// The value.
    pub value: Node<'a>,
}

impl<'a> Node<'a> {
    /// The whole text as one value.
    pub fn whole(text: &'a str) -> Result<Self, Diagnostic> {
        let start = skip_blank(text, 0);
        if text[start..].starts_with("#!") {
            return Err(Diagnostic::error(start..start + 2, "a scene takes no RON attributes")
                .help("remove the `#![...]` line: everything is written out in a scene"));
        }
        match RawValue::from_ron(text) {
            Ok(raw) => Ok(Self::of(raw, text, 0)),
            Err(error) => {
                let at = byte_offset(text, error.span.start.line, error.span.start.col);
                let end = byte_offset(text, error.span.end.line, error.span.end.col);
                Err(Diagnostic::error(at..end.max(at), format!("not a RON text: {}", error.code)))
            }
        }
    }

    fn of(raw: &'a RawValue, text: &'a str, start: usize) -> Self {
        let fragment = raw.get_ron();
        // Reading it once more to find its end is needed only if a comment may follow.
        let trimmed = if fragment.contains("//") || fragment.contains("/*") {
            raw.trim().get_ron()
        } else {
            fragment.trim_matches(is_blank)
        };
        let offset = (trimmed.as_ptr() as usize).wrapping_sub(text.as_ptr() as usize);
        Self { text: trimmed, start: start + offset }
    }

    /// Bytes of the text.
    pub fn span(&self) -> Range<usize> {
        self.start..self.start + self.text.len()
    }

    /// The text as written, cut to a readable length.
    pub fn quoted(&self) -> String {
        let line = self.text.lines().next().unwrap_or("");
        let short: String = line.chars().take(40).collect();
        if short.len() < self.text.len() { format!("{short}...") } else { short }
    }

    /// Name and content of `Name`, `Name(...)`; `None` if the value does not begin with a name.
    pub fn variant(&self) -> Option<(&'a str, Range<usize>, Option<Node<'a>>)> {
        let length = self
            .text
            .char_indices()
            .find(|(at, c)| !(c.is_alphabetic() || *c == '_' || (*at > 0 && c.is_numeric())))
            .map_or(self.text.len(), |(at, _)| at);
        if length == 0 {
            return None;
        }
        let name = &self.text[..length];
        let span = self.start..self.start + length;
        let rest = skip_blank(self.text, length);
        if rest == self.text.len() {
            return Some((name, span, None));
        }
        // A raw string or a range begins with letters too.
        self.text[rest..]
            .starts_with('(')
            .then(|| (name, span, Some(Node { text: &self.text[rest..], start: self.start + rest })))
    }

    /// The fields of `(name: value, ...)`.
    pub fn fields(&self) -> Option<Vec<Entry<'a>>> {
        if !self.text.starts_with('(') {
            return None;
        }
        let mut de = ron::Deserializer::from_str(self.text).ok()?;
        let pairs = de.deserialize_struct("", &[], Pairs::<Name>::default()).ok()?;
        de.end().ok()?;
        let mut at = 1;
        let mut entries = Vec::with_capacity(pairs.len());
        for (name, raw) in pairs {
            let value = Self::of(raw, self.text, self.start);
            at = skip_blank(self.text, at);
            if self.text[at..].starts_with(',') {
                at = skip_blank(self.text, at + 1);
            }
            let prefix = if self.text[at..].starts_with("r#") { 2 } else { 0 };
            let span = self.start + at..self.start + at + prefix + name.len();
            at = value.span().end - self.start;
            entries.push(Entry { name, span, value });
        }
        Some(entries)
    }

    /// The values of `(a, b, ...)` or `[a, b, ...]`.
    pub fn items(&self) -> Option<Vec<Node<'a>>> {
        let mut de = ron::Deserializer::from_str(self.text).ok()?;
        let raws = match self.text.as_bytes().first()? {
            b'(' => de.deserialize_tuple(0, Items).ok()?,
            b'[' => de.deserialize_seq(Items).ok()?,
            _ => return None,
        };
        de.end().ok()?;
        Some(raws.into_iter().map(|raw| Self::of(raw, self.text, self.start)).collect())
    }

    /// The keys and values of `{ key: value, ... }`.
    pub fn map(&self) -> Option<Vec<(Node<'a>, Node<'a>)>> {
        if !self.text.starts_with('{') {
            return None;
        }
        let mut de = ron::Deserializer::from_str(self.text).ok()?;
        let pairs = de.deserialize_map(Pairs::<Raw>::default()).ok()?;
        de.end().ok()?;
        let node = |raw| Self::of(raw, self.text, self.start);
        Some(pairs.into_iter().map(|(key, value)| (node(key), node(value))).collect())
    }

    /// A text in quotes.
    pub fn string(&self) -> Option<String> {
        if !self.text.starts_with(['"', 'r']) {
            return None;
        }
        ron::from_str(self.text).ok()
    }

    /// A number; `inf` and `NaN` are numbers to RON.
    pub fn number(&self) -> Option<f64> {
        let number = self.text.starts_with(|c: char| c.is_ascii_digit() || "+-.iN".contains(c));
        if number { ron::from_str(self.text).ok() } else { None }
    }

    /// A whole number.
    pub fn whole_number(&self) -> Option<u64> {
        ron::from_str(self.text).ok()
    }

    /// `true` or `false`.
    pub fn boolean(&self) -> Option<bool> {
        ron::from_str(self.text).ok()
    }
}

/// White space, with the two marks of writing direction that RON counts to it.
fn is_blank(c: char) -> bool {
    c.is_whitespace() || matches!(c, '\u{200e}' | '\u{200f}')
}

/// The offset behind blanks and comments.
pub(crate) fn skip_blank(text: &str, mut at: usize) -> usize {
    loop {
        let rest = &text[at..];
        let blank = rest.len() - rest.trim_start_matches(is_blank).len();
        at += blank;
        let rest = &rest[blank..];
        if rest.starts_with("//") {
            at += rest.find('\n').map_or(rest.len(), |end| end + 1);
        } else if rest.starts_with("/*") {
            let (mut depth, mut cursor) = (0usize, 0usize);
            let bytes = rest.as_bytes();
            while cursor < bytes.len() {
                if bytes[cursor..].starts_with(b"/*") {
                    depth += 1;
                    cursor += 2;
                } else if bytes[cursor..].starts_with(b"*/") {
                    depth -= 1;
                    cursor += 2;
                    if depth == 0 {
                        break;
                    }
                } else {
                    cursor += 1;
                }
            }
            at += cursor;
        } else {
            return at;
        }
    }
}

fn byte_offset(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let rest = &text[start.min(text.len())..];
    start + rest.char_indices().nth(column.saturating_sub(1)).map_or(rest.len(), |(at, _)| at)
}

struct Items;

impl<'de> Visitor<'de> for Items {
    type Value = Vec<&'de RawValue>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut access: A) -> Result<Self::Value, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = access.next_element()? {
            items.push(item);
        }
        Ok(items)
    }
}

/// How the keys of a map are read.
trait Key<'de>: Default {
    type Output;
    fn seed() -> impl DeserializeSeed<'de, Value = Self::Output>;
}

#[derive(Default)]
struct Raw;

impl<'de> Key<'de> for Raw {
    type Output = &'de RawValue;
    fn seed() -> impl DeserializeSeed<'de, Value = Self::Output> {
        std::marker::PhantomData::<&'de RawValue>
    }
}

#[derive(Default)]
struct Name;

impl<'de> Key<'de> for Name {
    type Output = String;
    fn seed() -> impl DeserializeSeed<'de, Value = Self::Output> {
        Name
    }
}

impl<'de> DeserializeSeed<'de> for Name {
    type Value = String;
    fn deserialize<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<String, D::Error> {
        deserializer.deserialize_identifier(self)
    }
}

impl Visitor<'_> for Name {
    type Value = String;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a field name")
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<String, E> {
        Ok(name.to_string())
    }
}

#[derive(Default)]
struct Pairs<K>(std::marker::PhantomData<K>);

impl<'de, K: Key<'de>> Visitor<'de> for Pairs<K> {
    type Value = Vec<(K::Output, &'de RawValue)>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("named values")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut access: A) -> Result<Self::Value, A::Error> {
        let mut pairs = Vec::new();
        while let Some(key) = access.next_key_seed(K::seed())? {
            pairs.push((key, access.next_value()?));
        }
        Ok(pairs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole(text: &str) -> Node<'_> {
        Node::whole(text).unwrap()
    }

    #[test]
    fn fields_know_their_places() {
        let text = "// head\n( a: 1, /* b: 2 */ bc : \"x, y\" , // c: 3\n  d: (1, \"2 mm\", [3]) )";
        let fields = whole(text).fields().unwrap();
        let names: Vec<&str> = fields.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["a", "bc", "d"]);
        for field in &fields {
            assert_eq!(&text[field.span.clone()], field.name);
        }
        assert_eq!(&text[fields[1].value.span()], "\"x, y\"");
        let items = fields[2].value.items().unwrap();
        assert_eq!(&text[items[1].span()], "\"2 mm\"");
        assert_eq!(items[2].items().unwrap()[0].number(), Some(3.0));
    }

    #[test]
    fn maps_and_variants() {
        let text = "{ \"glass\": Plane /* c */ (x: 1), \"b\": Static }";
        let map = whole(text).map().unwrap();
        assert_eq!(map[0].0.string().unwrap(), "glass");
        let (name, span, content) = map[0].1.variant().unwrap();
        assert_eq!((name, &text[span]), ("Plane", "Plane"));
        assert_eq!(content.unwrap().fields().unwrap()[0].name, "x");
        assert!(matches!(map[1].1.variant(), Some(("Static", _, None))));
        assert!(whole("(1, 2)").fields().is_none());
        assert!(whole("(a: 2)").items().is_none());
    }

    #[test]
    fn comments_and_blanks_are_not_part_of_a_value() {
        let text = "(a: /* x */ 1 /* y */ , // z\n b: \u{200e}\"//\" // w\n )";
        let fields = whole(text).fields().unwrap();
        assert_eq!(&text[fields[0].value.span()], "1");
        assert_eq!(&text[fields[1].span.clone()], "b");
        assert_eq!(fields[1].value.string().unwrap(), "//");
        assert_eq!(&text[fields[1].value.span()], "\"//\"");
    }

    #[test]
    fn numbers_as_ron_reads_them() {
        assert_eq!(whole("-1.5e-3").number(), Some(-1.5e-3));
        assert_eq!(whole("inf").number(), Some(f64::INFINITY));
        assert!(whole("NaN").number().unwrap().is_nan());
        assert_eq!(whole("true").number(), None);
        assert_eq!(whole("7").whole_number(), Some(7));
        assert_eq!(whole("-7").whole_number(), None);
    }

    #[test]
    fn broken_text_has_a_place() {
        let text = "(\n a: 1\n b: 2)";
        let error = Node::whole(text).unwrap_err();
        assert_eq!(error.position(text).0, 3);
        assert!(Node::whole("").is_err());
        assert!(Node::whole(&"(".repeat(100_000)).is_err());
        assert!(Node::whole("#![enable(implicit_some)] (a: 1)").unwrap_err().message.contains("attributes"));
    }
}
