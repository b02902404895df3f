//! The `.pvd` collection: which `.vtp` file belongs to which time.

use super::arrays::Compression;
use super::polydata;
use crate::atomic::{self, read_text};
use crate::error::FormatError;
use crate::number;
use crate::particles::Frame;
use crate::provenance::Provenance;
use std::path::{Path, PathBuf};

/// One file of a collection.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Simulated time \[s\].
    pub time: f64,
    /// Path relative to the folder of the collection.
    pub file: String,
}

/// Frames `NAME_000000.vtp`, `NAME_000001.vtp`, ... beside a collection `NAME.pvd`.
///
/// The collection is replaced atomically after each frame, so that it names whole frames only. That costs a small file
/// a frame, about 70 bytes for each frame so far.
#[derive(Debug)]
pub struct Series {
    path: PathBuf,
    stem: String,
    provenance: Provenance,
    compression: Compression,
    entries: Vec<Entry>,
}

impl Series {
    /// Prepares a series; its first frame replaces a collection of that name.
    ///
    /// # Errors
    /// [`FormatError::Unwritable`] when the path has no file name in UTF-8, or one that contains control characters.
    pub fn create(
        path: impl AsRef<Path>,
        provenance: &Provenance,
        compression: Compression,
    ) -> Result<Series, FormatError> {
        let path = path.as_ref().to_path_buf();
        let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default().to_string();
        if stem.is_empty() || stem.contains(char::is_control) {
            return Err(FormatError::unwritable(&path, "the file name must be printable text in UTF-8"));
        }
        Ok(Series { path, stem, provenance: provenance.clone(), compression, entries: Vec::new() })
    }

    /// Continues a series: keeps its frames up to the first one that `keep` refuses by its time. Files of later frames
    /// are overwritten as the series goes on.
    ///
    /// # Errors
    /// As [`Series::create`] and [`read_collection`].
    pub fn resume(
        path: impl AsRef<Path>,
        provenance: &Provenance,
        compression: Compression,
        mut keep: impl FnMut(f64) -> bool,
    ) -> Result<Series, FormatError> {
        let mut series = Series::create(path, provenance, compression)?;
        let entries = read_collection(&series.path)?;
        series.entries = entries.into_iter().take_while(|entry| keep(entry.time)).collect();
        Ok(series)
    }

    /// Continues a series behind its first `frames` frames. Files of later ones are overwritten as the series goes on.
    ///
    /// # Errors
    /// As [`Series::resume`], and when the collection has fewer frames or one of their files is missing.
    pub fn resume_at(
        path: impl AsRef<Path>,
        provenance: &Provenance,
        compression: Compression,
        frames: u64,
    ) -> Result<Series, FormatError> {
        let mut left = frames;
        let keep = |_| {
            left = left.saturating_sub(1);
            true
        };
        let mut series = Series::resume(path, provenance, compression, keep)?;
        series.entries.truncate(usize::try_from(frames).unwrap_or(usize::MAX));
        let there = |entry: &Entry| series.path.with_file_name(&entry.file).is_file();
        if left > 0 || !series.entries.iter().all(there) {
            let problem = format!("it must name {frames} files that exist");
            return Err(FormatError::refused(&series.path, problem));
        }
        Ok(series)
    }

    /// Writes a frame and adds it to the collection.
    ///
    /// # Errors
    /// As [`super::write`]. The collection then names the frames before.
    pub fn append(&mut self, frame: &Frame<'_>) -> Result<(), FormatError> {
        let file = format!("{}_{:06}.vtp", self.stem, self.entries.len());
        polydata::write(self.path.with_file_name(&file), frame, &self.provenance, self.compression)?;
        self.entries.push(Entry { time: frame.time, file });
        let written = atomic::write(&self.path, self.collection().as_bytes());
        if written.is_err() {
            self.entries.pop();
        }
        written
    }

    /// Frames so far.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Path of the collection.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The provenance is a processing instruction: unlike an XML comment it may contain `--`.
    fn collection(&self) -> String {
        let mut out = format!(
            "<?xml version=\"1.0\"?>\n<?source {} ?>\n\
             <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n",
            self.provenance
        );
        for Entry { time, file } in &self.entries {
            let (time, file) = (number::text(*time), escape(file));
            out += &format!("<DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>\n");
        }
        out + "</Collection>\n</VTKFile>\n"
    }
}

/// Reads a collection as [`Series`] writes it: one `DataSet` a line, with `timestep` and `file`.
///
/// # Errors
/// [`FormatError::Io`], or [`FormatError::Syntax`] for a `DataSet` without a finite time or without a file, and for a
/// file that is no collection.
pub fn read_collection(path: impl AsRef<Path>) -> Result<Vec<Entry>, FormatError> {
    let path = path.as_ref();
    parse(path, &read_text(path)?)
}

fn parse(path: &Path, text: &str) -> Result<Vec<Entry>, FormatError> {
    let mut entries = Vec::new();
    let mut is_collection = false;
    for (line, number) in text.lines().zip(1..) {
        is_collection |= line.contains("type=\"Collection\"");
        let Some(element) = line.trim().strip_prefix("<DataSet ") else { continue };
        let wrong = |expected| FormatError::syntax(path, number, None, line.trim(), expected);
        let time = attribute(element, "timestep").and_then(|time| number::parse(&time));
        let time = time.ok_or_else(|| wrong("`timestep=\"...\"` with a finite number"))?;
        let file = attribute(element, "file").ok_or_else(|| wrong("`file=\"...\"`"))?;
        entries.push(Entry { time, file });
    }
    if !is_collection || !text.trim_end().ends_with("</VTKFile>") {
        let last = text.lines().count() as u64;
        return Err(FormatError::syntax(path, last, None, "", "a whole VTK file of `type=\"Collection\"`"));
    }
    Ok(entries)
}

fn attribute(element: &str, name: &str) -> Option<String> {
    let mut rest = element;
    while let Some((before, value)) = rest.split_once("=\"") {
        let (value, after) = value.split_once('"')?;
        if before.trim() == name {
            return Some(unescape(value));
        }
        rest = after;
    }
    None
}

const ESCAPES: [(&str, &str); 4] = [("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ("\"", "&quot;")];

fn escape(text: &str) -> String {
    ESCAPES.iter().fold(text.to_string(), |text, (plain, escaped)| text.replace(plain, escaped))
}

fn unescape(text: &str) -> String {
    ESCAPES.iter().rev().fold(text.to_string(), |text, (plain, escaped)| text.replace(escaped, plain))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::tests::Owned;
    use proptest::prelude::*;
    use std::fs;

    fn provenance() -> Provenance {
        Provenance::new("0.1.0--x", "0f3a", 1_764_000_000).unwrap()
    }

    #[test]
    fn a_series_goes_on_where_it_was_cut() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a & \"b\".pvd");
        let owned = Owned::new(3);
        let frame = |step: u64| Frame { step, time: 0.1 * step as f64, ..owned.frame(&[]) };
        let mut series = Series::create(&path, &provenance(), Compression::Raw).unwrap();
        for step in 0..4 {
            series.append(&frame(step)).unwrap();
            assert_eq!(read_collection(&path).unwrap(), series.entries());
        }
        let mut series =
            Series::resume(&path, &provenance(), Compression::Zlib, |time| time <= 0.2 + 1e-12).unwrap();
        series.append(&frame(7)).unwrap();
        let entries = read_collection(&path).unwrap();
        assert_eq!(entries.iter().map(|entry| entry.time).collect::<Vec<_>>(), [0.0, 0.1, 0.2, 0.1 * 7.0]);
        assert_eq!(entries[3].file, "a & \"b\"_000003.vtp");
        for entry in &entries {
            assert!(path.with_file_name(&entry.file).exists());
        }
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.lines().any(|line| Provenance::parse(line) == Some(provenance())));
    }

    #[test]
    fn a_bad_frame_is_not_in_the_collection() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pvd");
        let owned = Owned::new(1);
        let mut series = Series::create(&path, &provenance(), Compression::Raw).unwrap();
        series.append(&owned.frame(&[])).unwrap();
        assert!(series.append(&Frame { radius: &[f64::NAN], ..owned.frame(&[]) }).is_err());
        assert_eq!(read_collection(&path).unwrap().len(), 1);
        assert_eq!(series.entries().len(), 1);
        assert!(Series::create("", &provenance(), Compression::Raw).is_err());
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        let whole = "<VTKFile type=\"Collection\">\n<DataSet timestep=\"1\" file=\"a\"/>\n</VTKFile>\n";
        let error = |text: &str| parse(Path::new("a.pvd"), text).unwrap_err().to_string();
        assert_eq!(parse(Path::new("a.pvd"), whole).unwrap().len(), 1);
        assert!(
            error(&whole.replace("\"1\"", "\"nan\""))
                .starts_with("a.pvd:2: found `<DataSet timestep=\"nan\"")
        );
        assert!(error(&whole.replace("file", "fine")).ends_with("expected `file=\"...\"`"));
        assert!(
            error(&whole.replace("Collection", "PolyData")).contains("a.pvd:3: expected a whole VTK file")
        );
        assert!(error(&whole[..40]).contains("expected"));
    }

    proptest! {
        #[test]
        fn names_survive(name in "[ -~]{0,20}") {
            prop_assert_eq!(unescape(&escape(&name)), name.clone());
            let element = format!("part=\"0\" file=\"{}\"/>", escape(&name));
            prop_assert_eq!(attribute(&element, "file"), Some(name));
        }

        #[test]
        fn never_panics(text in "[<>=\"&a-z0-9 \n/]{0,120}", tail in "(<DataSet [a-z=\" 0-9]{0,40}\n){0,3}") {
            let _ = parse(Path::new("a.pvd"), &(text + &tail));
        }
    }
}
