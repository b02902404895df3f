//! Reading a table.

use super::{Column, Table};
use crate::atomic::read_text;
use crate::error::FormatError;
use crate::number;
use crate::provenance::Provenance;
use std::path::Path;

/// Reads a table of numbers with one header line. Blank lines and lines that start with `#` are skipped; numbers may
/// be quoted and have blanks around them; lines end with LF or CRLF.
///
/// # Errors
/// [`FormatError::Io`], or [`FormatError::Syntax`] for anything but a finite number below the header, rows of a
/// different length, and columns that share a name.
pub fn read(path: impl AsRef<Path>) -> Result<Table, FormatError> {
    let path = path.as_ref();
    parse(path, &read_text(path)?)
}

/// Reads a table from text; `file` is the name for messages.
///
/// # Errors
/// As [`read`].
pub fn parse(file: &Path, text: &str) -> Result<Table, FormatError> {
    let mut records = Records::new(file, text);
    let header = records.next().transpose()?;
    let Some(header) = header else {
        return Err(FormatError::syntax(
            file,
            records.line,
            None,
            "",
            "a header line with the names of the columns",
        ));
    };
    let mut columns: Vec<Column> = Vec::new();
    for field in &header {
        let column = Column::from_header(&field.text);
        if columns.iter().any(|other| other.name == column.name) {
            return Err(field.error(file, "names of columns that differ"));
        }
        columns.push(column);
    }
    let mut values = vec![Vec::new(); columns.len()];
    while let Some(record) = records.next().transpose()? {
        if record.len() != columns.len() {
            let expected = format!("{} fields, as in the header", columns.len());
            let found = format!("{} fields", record.len());
            let line = record.first().map_or(records.line, |field| field.line);
            return Err(FormatError::syntax(file, line, None, &found, expected));
        }
        for ((field, column), values) in record.iter().zip(&columns).zip(&mut values) {
            let value = number::parse(field.text.trim());
            let expected = || field.error(file, format!("a finite number for `{}`", column.name));
            values.push(value.ok_or_else(expected)?);
        }
    }
    Ok(Table { provenance: records.provenance, columns, values })
}

struct Field {
    text: String,
    line: u64,
    column: usize,
}

impl Field {
    fn error(&self, file: &Path, expected: impl Into<String>) -> FormatError {
        FormatError::syntax(file, self.line, Some(self.column), &self.text, expected)
    }
}

/// Records of a text in the sense of RFC 4180, without comments and blank lines.
struct Records<'a> {
    file: &'a Path,
    rest: &'a str,
    line: u64,
    column: usize,
    provenance: Option<Provenance>,
}

impl<'a> Records<'a> {
    fn new(file: &'a Path, text: &'a str) -> Records<'a> {
        let rest = text.strip_prefix('\u{feff}').unwrap_or(text);
        Records { file, rest, line: 1, column: 1, provenance: None }
    }

    /// Takes the next character.
    fn take(&mut self) -> Option<char> {
        let c = self.rest.chars().next()?;
        self.rest = &self.rest[c.len_utf8()..];
        if c == '\n' {
            self.line += 1;
            self.column = 1;
        } else {
            self.column += 1;
        }
        Some(c)
    }

    fn skip_line(&mut self) -> &'a str {
        let (line, rest) = self.rest.split_once('\n').unwrap_or((self.rest, ""));
        self.line += u64::from(line.len() < self.rest.len());
        self.rest = rest;
        line
    }

    /// A field; its end is `,`, a line break or the end of the text, and stays.
    fn field(&mut self) -> Result<Field, FormatError> {
        let (line, column) = (self.line, self.column);
        if !self.rest.starts_with('"') {
            let end = self.rest.find([',', '\n']).unwrap_or(self.rest.len());
            let (text, rest) = self.rest.split_at(end);
            self.rest = rest;
            self.column += text.chars().count();
            let text = if rest.starts_with(',') { text } else { text.strip_suffix('\r').unwrap_or(text) };
            if text.contains('"') {
                return Err(FormatError::syntax(
                    self.file,
                    line,
                    Some(column),
                    text,
                    "quotes around the whole field",
                ));
            }
            return Ok(Field { text: text.trim().to_string(), line, column });
        }
        self.take();
        let mut text = String::new();
        loop {
            match self.take() {
                Some('"') if self.rest.starts_with('"') => {
                    self.take();
                    text.push('"');
                }
                Some('"') => break,
                Some(c) => text.push(c),
                None => {
                    return Err(FormatError::syntax(self.file, line, Some(column), &text, "a closing quote"));
                }
            }
        }
        if self.rest.starts_with("\r\n") || self.rest == "\r" {
            self.take();
        }
        if !(self.rest.is_empty() || self.rest.starts_with([',', '\n'])) {
            let found: String = self.rest.chars().take_while(|c| *c != '\n').take(20).collect();
            let expected = "a comma or the end of the line after a quoted field";
            return Err(FormatError::syntax(self.file, self.line, Some(self.column), &found, expected));
        }
        Ok(Field { text, line, column })
    }

    fn record(&mut self) -> Result<Vec<Field>, FormatError> {
        let mut fields = vec![self.field()?];
        while self.take() == Some(',') {
            fields.push(self.field()?);
        }
        Ok(fields)
    }
}

impl Iterator for Records<'_> {
    type Item = Result<Vec<Field>, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let line = self.rest.split_once('\n').map_or(self.rest, |(line, _)| line);
            if self.rest.is_empty() {
                return None;
            } else if line.starts_with('#') {
                let comment = self.skip_line();
                self.provenance = self.provenance.take().or_else(|| Provenance::parse(comment));
            } else if line.trim().is_empty() {
                self.skip_line();
            } else {
                return Some(self.record());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn table(text: &str) -> Result<Table, String> {
        parse(Path::new("t.csv"), text).map_err(|error| error.to_string())
    }

    #[test]
    fn reads_what_other_programs_write() {
        let expected = table("t [s],e [J]\n1,2\n3,4\n").unwrap();
        for text in [
            "\u{feff}t [s],e [J]\r\n1,2\r\n3,4",
            "# by hand\n\n\"t [s]\",\"e [J]\"\n \"1\",2\n".replace(" \"1\"", "\"1\"").as_str(),
            "t [s], e [J]\n1 , 2\n\n# half time\n3,4\n\n",
        ] {
            let read = table(text).unwrap();
            assert_eq!(read.columns, expected.columns, "{text:?}");
            assert!(read.values[0].starts_with(&[1.0]) && read.values[1].starts_with(&[2.0]));
        }
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        for (text, message) in [
            ("", "t.csv:1: expected a header line with the names of the columns"),
            ("# x\n\n", "t.csv:3: expected a header line with the names of the columns"),
            ("t,t\n", "t.csv:1:3: found `t`, expected names of columns that differ"),
            ("t,e\n1,2\n1\n", "t.csv:3: found `1 fields`, expected 2 fields, as in the header"),
            ("t,e\n1,x2\n", "t.csv:2:3: found `x2`, expected a finite number for `e`"),
            ("t,e\n1,\n", "t.csv:2:3: expected a finite number for `e`"),
            ("t,e\nnan,1\n", "t.csv:2:1: found `nan`, expected a finite number for `t`"),
            ("t,e\n1,1e999\n", "t.csv:2:3: found `1e999`, expected a finite number for `e`"),
            ("t\n\"1", "t.csv:2:1: found `1`, expected a closing quote"),
            (
                "t\n\"1\"2\n",
                "t.csv:2:4: found `2`, expected a comma or the end of the line after a quoted field",
            ),
            ("t\n1\"2\n", "t.csv:2:1: found `1\"2`, expected quotes around the whole field"),
        ] {
            assert_eq!(table(text).unwrap_err(), message, "{text:?}");
        }
    }

    proptest! {
        #[test]
        fn never_panics(text in "[0-9a-e,\"\n\r #\\[\\].-]{0,80}", bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = table(&text);
            let _ = table(&String::from_utf8_lossy(&bytes));
        }
    }
}
