//! Lines and words with their place in the file.

use crate::error::FormatError;
use crate::number;
use std::path::Path;

/// A line of a text file.
#[derive(Clone, Copy)]
pub(crate) struct Line<'a> {
    pub file: &'a Path,
    /// From 1.
    pub number: u64,
    pub text: &'a str,
}

/// A word of a line.
#[derive(Clone, Copy)]
pub(crate) struct Word<'a> {
    pub line: Line<'a>,
    pub text: &'a str,
}

impl<'a> Line<'a> {
    /// The line without a comment that starts with `#`, and without blanks at its ends.
    pub fn content(self) -> &'a str {
        self.text.split_once('#').map_or(self.text, |(content, _)| content).trim()
    }

    /// Words of the content.
    pub fn words(self) -> impl Iterator<Item = Word<'a>> + Clone {
        self.content().split_ascii_whitespace().map(move |text| Word { line: self, text })
    }

    /// An error about the whole line.
    pub fn error(self, expected: impl Into<String>) -> FormatError {
        FormatError::syntax(self.file, self.number, None, self.text.trim(), expected)
    }
}

impl Word<'_> {
    /// An error about this word.
    pub fn error(&self, expected: impl Into<String>) -> FormatError {
        let offset = self.text.as_ptr() as usize - self.line.text.as_ptr() as usize;
        let column = self.line.text.get(..offset).map_or(0, |before| before.chars().count()) + 1;
        FormatError::syntax(self.line.file, self.line.number, Some(column), self.text, expected)
    }

    /// The word as a finite number.
    pub fn number(&self, what: &str) -> Result<f64, FormatError> {
        number::parse(self.text).ok_or_else(|| self.error(format!("{what}, a finite number")))
    }

    /// The word as a finite number above 0.
    pub fn positive(&self, what: &str) -> Result<f64, FormatError> {
        let value = number::parse(self.text).filter(|value| *value > 0.0);
        value.ok_or_else(|| self.error(format!("{what}, a finite number above 0")))
    }

    /// The word as an integer from `least` to `most`.
    pub fn integer(&self, what: &str, least: i64, most: i64) -> Result<i64, FormatError> {
        match self.text.parse() {
            Ok(value) if (least..=most).contains(&value) => Ok(value),
            _ => Err(self.error(format!("{what}, an integer from {least} to {most}"))),
        }
    }
}

/// Lines of a text, with numbers from 1.
pub(crate) fn lines<'a>(file: &'a Path, text: &'a str) -> impl Iterator<Item = Line<'a>> + Clone {
    text.lines().zip(1..).map(move |(text, number)| Line { file, number, text })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_knows_its_column_in_characters() {
        let file = Path::new("f");
        let line = lines(file, "a\n  µm  x1 # y\n").nth(1).unwrap();
        let words: Vec<_> = line.words().collect();
        assert_eq!(words.len(), 2);
        assert_eq!(words[1].error("z").to_string(), "f:2:7: found `x1`, expected z");
        assert_eq!(words[1].integer("n", 0, 9).unwrap_err().to_string(), {
            "f:2:7: found `x1`, expected n, an integer from 0 to 9"
        });
    }
}
