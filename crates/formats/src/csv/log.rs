//! A time series that grows during a run.

use super::{Column, head, parse, push_row};
use crate::atomic::{GrowingFile, continued};
use crate::error::FormatError;
use crate::provenance::Provenance;
use std::fs;
use std::path::Path;

/// A CSV file to which rows are appended.
///
/// The header is there from the first moment. Rows of one call reach the operating system together before the call
/// returns, so that an interrupted run leaves whole rows; a crash in the middle of a write can tear only the last one,
/// and [`AppendLog::resume`] cuts that off.
#[derive(Debug)]
pub struct AppendLog {
    file: GrowingFile,
    columns: Vec<Column>,
    buffer: Vec<u8>,
}

impl AppendLog {
    /// Starts a time series; a file of that name is replaced.
    ///
    /// # Errors
    /// As [`super::write`].
    pub fn create(
        path: impl AsRef<Path>,
        provenance: &Provenance,
        columns: &[Column],
    ) -> Result<AppendLog, FormatError> {
        let path = path.as_ref();
        let head = head(path, Some(provenance), columns)?;
        let file = GrowingFile::create(path, |out| out.write_all(&head))?;
        Ok(AppendLog { file, columns: columns.to_vec(), buffer: Vec::new() })
    }

    /// Continues a time series: keeps its rows up to the first one that `keep` refuses, for instance the first one
    /// after the time of the checkpoint from which the run goes on. A torn last line is cut off. The provenance
    /// stays that of the first run.
    ///
    /// # Errors
    /// When the file has other columns, or a line above the last one is damaged; then the file is left as it is.
    pub fn resume(
        path: impl AsRef<Path>,
        columns: &[Column],
        mut keep: impl FnMut(&[f64]) -> bool,
    ) -> Result<AppendLog, FormatError> {
        let path = path.as_ref();
        let mut bytes = fs::read(path).map_err(FormatError::io(path, "read"))?;
        bytes.truncate(bytes.iter().rposition(|b| *b == b'\n').map_or(0, |end| end + 1));
        let text = String::from_utf8(bytes).map_err(|error| {
            let line = error.as_bytes()[..error.utf8_error().valid_up_to()].split(|b| *b == b'\n').count();
            FormatError::syntax(path, line as u64, None, "bytes that are not UTF-8", "text in UTF-8")
        })?;
        let comments: usize =
            text.split_inclusive('\n').take_while(|line| line.starts_with('#')).map(str::len).sum();
        let header = String::from_utf8_lossy(&head(path, None, columns)?).into_owned();
        if !text[comments..].starts_with(&header) {
            let line = text[..comments].lines().count();
            let found = text.lines().nth(line).unwrap_or_default();
            let expected = format!("the header `{}` of this run", header.trim_end());
            return Err(FormatError::syntax(path, line as u64 + 1, None, found, expected));
        }
        let table = parse(path, &text)?;
        let mut row = vec![0.0; columns.len()];
        let kept = (0..table.rows()).take_while(|i| {
            row.iter_mut().zip(&table.values).for_each(|(value, column)| *value = column[*i]);
            keep(&row)
        });
        let start = comments + header.len();
        let length = start + length_of_rows(&text[start..], kept.count());
        let file = GrowingFile::open(path, length as u64)?;
        Ok(AppendLog { file, columns: columns.to_vec(), buffer: Vec::new() })
    }

    /// Continues a time series at a length that it once had: what was written later is cut off.
    ///
    /// # Errors
    /// When the file does not begin with the header that [`AppendLog::create`] writes for these columns and this provenance,
    /// or is shorter than `length`; then it is left as it is.
    pub fn resume_at(
        path: impl AsRef<Path>,
        provenance: &Provenance,
        columns: &[Column],
        length: u64,
    ) -> Result<AppendLog, FormatError> {
        let path = path.as_ref();
        let head = head(path, Some(provenance), columns)?;
        continued(path, &head, length)?;
        let file = GrowingFile::open(path, length)?;
        Ok(AppendLog { file, columns: columns.to_vec(), buffer: Vec::new() })
    }

    /// Bytes of all rows so far, with the header.
    pub fn length(&self) -> u64 {
        self.file.length()
    }

    /// Appends a row.
    ///
    /// # Errors
    /// As [`AppendLog::append_rows`].
    pub fn append(&mut self, row: &[f64]) -> Result<(), FormatError> {
        self.append_rows([row])
    }

    /// Appends rows, all or none.
    ///
    /// # Errors
    /// When a row has not one finite value a column, or the operating system refuses to write.
    pub fn append_rows<'r>(&mut self, rows: impl IntoIterator<Item = &'r [f64]>) -> Result<(), FormatError> {
        self.buffer.clear();
        for row in rows {
            push_row(&mut self.buffer, self.file.path(), &self.columns, row)?;
        }
        let rows = &self.buffer;
        self.file.append(|out| out.write_all(rows))
    }

    /// Waits until everything is on the disk.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn sync(&self) -> Result<(), FormatError> {
        self.file.sync()
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        self.file.path()
    }

    /// Columns of the file.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }
}

/// Length in bytes of a number of rows with the comments and blank lines between them.
fn length_of_rows(text: &str, mut rows: usize) -> usize {
    let mut length = 0;
    for line in text.split_inclusive('\n') {
        if !line.starts_with('#') && !line.trim().is_empty() {
            if rows == 0 {
                break;
            }
            rows -= 1;
        }
        length += line.len();
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::path::PathBuf;

    fn columns() -> Vec<Column> {
        vec![Column::new("time", "s"), Column::new("energy, all\nparts", "J")]
    }

    fn start(folder: &Path) -> (PathBuf, AppendLog) {
        let path = folder.join("energy.csv");
        let provenance = Provenance::new("0.1.0", "0f3a", 1).unwrap();
        let log = AppendLog::create(&path, &provenance, &columns()).unwrap();
        (path, log)
    }

    #[test]
    fn rows_are_in_the_file_when_the_call_returns() {
        let folder = tempfile::tempdir().unwrap();
        let (path, mut log) = start(folder.path());
        let header = "# granule 0.1.0 plan=0f3a created=1\ntime [s],\"energy, all\nparts [J]\"\n";
        assert_eq!(fs::read_to_string(&path).unwrap(), header);
        log.append(&[0.0, 2.5]).unwrap();
        log.append_rows([&[0.5, 2.0][..], &[1.0, 1.5]]).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), format!("{header}0,2.5\n0.5,2\n1,1.5\n"));
        assert_eq!(super::super::read(&path).unwrap().columns, columns());
    }

    #[test]
    fn a_bad_row_leaves_the_file_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let (path, mut log) = start(folder.path());
        log.append(&[0.0, 2.5]).unwrap();
        let before = fs::read(&path).unwrap();
        assert!(log.append_rows([&[0.5, 2.0][..], &[1.0, f64::NAN]]).is_err());
        assert!(log.append(&[1.0]).is_err());
        assert_eq!(fs::read(&path).unwrap(), before);
    }

    #[test]
    fn resuming_checks_columns_and_rows() {
        let folder = tempfile::tempdir().unwrap();
        let (path, mut log) = start(folder.path());
        log.append(&[0.0, 2.5]).unwrap();
        let error = AppendLog::resume(&path, &columns()[..1], |_| true).unwrap_err().to_string();
        assert!(
            error.contains(":2: found `time [s],") && error.contains("`time [s]` of this run"),
            "{error}"
        );
        let mut damaged = fs::read(&path).unwrap();
        damaged.extend_from_slice(b"1,x\n2,3\n");
        fs::write(&path, &damaged).unwrap();
        let error = AppendLog::resume(&path, &columns(), |_| true).unwrap_err().to_string();
        assert!(error.contains(":5:3: found `x`"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), damaged);
        damaged.extend_from_slice(b"\xff,1\n");
        fs::write(&path, &damaged).unwrap();
        let error = AppendLog::resume(&path, &columns(), |_| true).unwrap_err().to_string();
        assert!(error.contains(":7: found `bytes that are not UTF-8`"), "{error}");
    }

    proptest! {
        /// A file that was cut anywhere, as by a crash, goes on with whole rows.
        #[test]
        fn any_torn_end_is_repaired(rows in 0usize..6, cut in 0usize..40, keep in 0usize..8) {
            let folder = tempfile::tempdir().unwrap();
            let (path, mut log) = start(folder.path());
            let head = fs::read(&path).unwrap().len();
            for i in 0..rows {
                log.append(&[i as f64, (i as f64).sqrt()]).unwrap();
            }
            let whole = fs::read(&path).unwrap();
            let cut = whole.len().saturating_sub(cut).max(head);
            fs::write(&path, &whole[..cut]).unwrap();
            let mut log = AppendLog::resume(&path, &columns(), |row| row[0] < keep as f64).unwrap();
            let left = whole[head..cut].iter().filter(|b| **b == b'\n').count().min(keep);
            log.append(&[left as f64, (left as f64).sqrt()]).unwrap();
            let table = super::super::read(&path).unwrap();
            let expected: Vec<_> = (0..=left).map(|i| i as f64).collect();
            prop_assert_eq!(table.column("time").unwrap(), &expected[..]);
            prop_assert!(table.provenance.is_some());
        }
    }
}
