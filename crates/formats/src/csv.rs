//! Tables of numbers: comma-separated values as in RFC 4180, with the units in the header.
//!
//! ```text
//! # granule 0.1.0 plan=0f3a created=1764000000
//! time [s],kinetic_energy [J]
//! 0,0.0012
//! 0.25,0.0011
//! ```
//! The first line is the provenance. RFC 4180 has no comments; `#` is what pandas (`comment="#"`), NumPy, gnuplot and R
//! skip. Fields that contain a comma, a quote or a line break are quoted. Lines end with a line feed alone.

mod log;
mod read;

pub use log::AppendLog;
pub use read::{parse, read};

use crate::atomic;
use crate::error::FormatError;
use crate::number;
use crate::provenance::Provenance;
use std::path::Path;

/// Name and unit of a column; in the header `name [unit]`, or `name` alone for a pure number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name of the quantity.
    pub name: String,
    /// SI unit; empty for a pure number.
    pub unit: String,
}

impl Column {
    /// A column with a unit; an empty unit means a pure number.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Column {
        Column { name: name.into(), unit: unit.into() }
    }

    fn header(&self) -> String {
        if self.unit.is_empty() { self.name.clone() } else { format!("{} [{}]", self.name, self.unit) }
    }

    fn from_header(text: &str) -> Column {
        match text.strip_suffix(']').and_then(|text| text.rsplit_once(" [")) {
            Some((name, unit)) if !unit.is_empty() => Column::new(name, unit),
            _ => Column::new(text, ""),
        }
    }
}

/// A table of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Where it comes from; `None` for a table of another program.
    pub provenance: Option<Provenance>,
    /// The columns.
    pub columns: Vec<Column>,
    /// Values, one vector a column, all of the same length.
    pub values: Vec<Vec<f64>>,
}

impl Table {
    /// Values of the column of that name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let index = self.columns.iter().position(|column| column.name == name)?;
        self.values.get(index).map(Vec::as_slice)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.values.first().map_or(0, Vec::len)
    }
}

/// Writes a table, whole or not at all.
///
/// # Errors
/// [`FormatError::Unwritable`] for columns of different length, names that could not be read back, or a value that is
/// not finite; [`FormatError::Io`].
pub fn write(path: impl AsRef<Path>, table: &Table) -> Result<(), FormatError> {
    let path = path.as_ref();
    let mut out = head(path, table.provenance.as_ref(), &table.columns)?;
    if table.values.len() != table.columns.len() || table.values.iter().any(|v| v.len() != table.rows()) {
        let lengths: Vec<_> = table.values.iter().map(Vec::len).collect();
        let problem = format!("{} columns have values of lengths {lengths:?}", table.columns.len());
        return Err(FormatError::unwritable(path, problem));
    }
    let mut row = vec![0.0; table.columns.len()];
    for i in 0..table.rows() {
        for (value, column) in row.iter_mut().zip(&table.values) {
            *value = column[i];
        }
        push_row(&mut out, path, &table.columns, &row)?;
    }
    atomic::write(path, &out)
}

/// Provenance and header.
fn head(path: &Path, provenance: Option<&Provenance>, columns: &[Column]) -> Result<Vec<u8>, FormatError> {
    if columns.is_empty() {
        return Err(FormatError::unwritable(path, "a table needs at least one column"));
    }
    let mut out = String::new();
    if let Some(provenance) = provenance {
        out.push_str(&format!("# {provenance}\n"));
    }
    for (i, column) in columns.iter().enumerate() {
        let header = column.header();
        if column.name.is_empty()
            || header.trim() != header
            || Column::from_header(&header) != *column
            || header.contains(|c: char| c.is_control() && c != '\n')
        {
            let problem = format!("a column `{}` in `{}` could not be read back", column.name, column.unit);
            return Err(FormatError::unwritable(path, problem));
        }
        if columns[..i].iter().any(|other| other.name == column.name) {
            return Err(FormatError::unwritable(path, format!("the column `{}` appears twice", column.name)));
        }
        if i > 0 {
            out.push(',');
        }
        // A first field that starts with `#` would look like a comment.
        if header.starts_with('#') || header.contains(['"', ',', '\n']) {
            out.push_str(&format!("\"{}\"", header.replace('"', "\"\"")));
        } else {
            out.push_str(&header);
        }
    }
    out.push('\n');
    Ok(out.into_bytes())
}

fn push_row(out: &mut Vec<u8>, path: &Path, columns: &[Column], row: &[f64]) -> Result<(), FormatError> {
    if row.len() != columns.len() {
        let problem = format!("a row has {} values for {} columns", row.len(), columns.len());
        return Err(FormatError::unwritable(path, problem));
    }
    for (i, (value, column)) in row.iter().zip(columns).enumerate() {
        if !value.is_finite() {
            let first = format!("{} = {}", columns[0].name, row[0]);
            let problem = format!("`{}` is {value} in the row with {first}", column.name);
            return Err(FormatError::unwritable(path, problem));
        }
        if i > 0 {
            out.push(b',');
        }
        number::push(out, *value);
    }
    out.push(b'\n');
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn provenance() -> Provenance {
        Provenance::new("0.1.0", "0f3a", 1_764_000_000).unwrap()
    }

    #[test]
    fn looks_as_documented() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        let table = Table {
            provenance: Some(provenance()),
            columns: vec![
                Column::new("time", "s"),
                Column::new("kinetic_energy", "J"),
                Column::new("a,\"b", ""),
            ],
            values: vec![vec![0.0, 0.25], vec![0.0012, 0.0011], vec![1.0, -2.5]],
        };
        write(&path, &table).unwrap();
        let expected = "# granule 0.1.0 plan=0f3a created=1764000000\n\
                        time [s],kinetic_energy [J],\"a,\"\"b\"\n0,0.0012,1\n0.25,0.0011,-2.5\n";
        assert_eq!(std::fs::read_to_string(&path).unwrap(), expected);
        let back = read(&path).unwrap();
        assert_eq!(back, table);
        assert_eq!(back.column("kinetic_energy"), Some(&[0.0012, 0.0011][..]));
        assert_eq!((back.rows(), back.column("nothing")), (2, None));
    }

    #[test]
    fn refuses_what_could_not_be_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        let table = |columns: &[Column], values: Vec<Vec<f64>>| Table {
            provenance: None,
            columns: columns.to_vec(),
            values,
        };
        let time = Column::new("time", "s");
        for (table, words) in [
            (table(&[], vec![]), "at least one column"),
            (table(&[time.clone(), time.clone()], vec![vec![], vec![]]), "appears twice"),
            (table(&[Column::new("a [b]", "")], vec![vec![]]), "could not be read back"),
            (table(&[Column::new(" a", "")], vec![vec![]]), "could not be read back"),
            (table(std::slice::from_ref(&time), vec![vec![1.0], vec![2.0]]), "lengths [1, 1]"),
            (
                table(&[time.clone(), Column::new("e", "J")], vec![vec![1.0], vec![f64::NAN]]),
                "`e` is NaN in the row",
            ),
        ] {
            let error = write(&path, &table).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        assert!(!path.exists());
    }

    proptest! {
        #[test]
        fn any_table_survives(
            names in prop::collection::btree_set("[ -~é\n]{0,12}", 1..5), unit in "[a-zA-Z/^0-9 ]{0,5}",
            rows in 0usize..6, bits in prop::collection::vec(any::<u64>(), 30), with: bool,
        ) {
            let number = |i: usize| Some(f64::from_bits(bits[i % 30])).filter(|v| v.is_finite()).unwrap_or(-0.0);
            let columns: Vec<_> = names.iter().map(|name| Column::new(name, &unit)).collect();
            let values: Vec<Vec<_>> =
                (0..columns.len()).map(|k| (0..rows).map(|i| number(5 * i + k)).collect()).collect();
            let table = Table { provenance: with.then(provenance), columns, values };
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("t.csv");
            if write(&path, &table).is_ok() {
                let back = read(&path).unwrap();
                let bits = |t: &Table| t.values.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
                prop_assert_eq!(bits(&back), bits(&table));
                prop_assert_eq!(back, table);
            } else {
                let readable = |c: &Column| !c.name.is_empty() && c.name.trim() == c.name && !c.name.contains('[')
                    && c.unit.trim() == c.unit;
                prop_assert!(!table.columns.iter().all(readable));
            }
        }
    }
}
