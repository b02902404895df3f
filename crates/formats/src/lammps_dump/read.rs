//! Reading dumps, one frame at a time.

use super::ITEM;
use super::frame::{DumpColumn, DumpFrame, Values};
use crate::error::FormatError;
use crate::particles::Cell;
use crate::provenance::Provenance;
use crate::text::{Line, Word};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

/// Columns that hold words.
const WORDS: [&str; 2] = ["element", "typelabel"];

/// Items that are allowed.
const ITEMS: &str = "one of `ITEM: UNITS`, `ITEM: TIME`, `ITEM: TIMESTEP`, `ITEM: NUMBER OF ATOMS`, \
                     `ITEM: BOX BOUNDS`, `ITEM: ATOMS`";

/// Reads all frames of a dump.
///
/// # Errors
/// As [`Reader`].
pub fn read(path: impl AsRef<Path>) -> Result<Vec<DumpFrame>, FormatError> {
    Reader::open(path)?.collect()
}

/// Frames of a dump, one after the other, so that only one needs to be in memory. Ends after the first error.
///
/// Reads what LAMMPS, LIGGGHTS (which ends lines with a blank) and [`super::DumpWriter`] write. Tilted boxes and dumps
/// of anything but atoms are refused by name.
#[derive(Debug)]
pub struct Reader<R> {
    file: PathBuf,
    input: R,
    line: u64,
    bytes: Vec<u8>,
    text: String,
    offset: u64,
    torn: bool,
    done: bool,
}

impl Reader<BufReader<File>> {
    /// Opens a dump.
    ///
    /// # Errors
    /// [`FormatError::Io`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, FormatError> {
        let path = path.as_ref();
        let file = File::open(path).map_err(FormatError::io(path, "read"))?;
        Ok(Reader::new(path, BufReader::with_capacity(1 << 18, file)))
    }
}

impl<R: BufRead> Reader<R> {
    /// Reads a dump from any source; `file` is the name for messages.
    pub fn new(file: impl AsRef<Path>, input: R) -> Self {
        let file = file.as_ref().to_path_buf();
        let (bytes, text) = (Vec::new(), String::new());
        Reader { file, input, line: 0, bytes, text, offset: 0, torn: false, done: false }
    }

    /// Bytes read so far: after a frame, its end.
    pub fn offset(&self) -> u64 {
        self.offset
    }

    /// Whether the file ended within a frame, or its last line has no line feed: so ends a file whose writer died.
    pub fn torn(&self) -> bool {
        self.torn
    }

    /// Takes the next line; `None` at the end of the file.
    fn line(&mut self) -> Result<Option<Line<'_>>, FormatError> {
        self.bytes.clear();
        let read =
            self.input.read_until(b'\n', &mut self.bytes).map_err(FormatError::io(&self.file, "read"))?;
        self.offset += read as u64;
        if read == 0 {
            return Ok(None);
        }
        self.line += 1;
        self.torn |= self.bytes.last() != Some(&b'\n');
        self.text.clear();
        match std::str::from_utf8(&self.bytes) {
            Ok(text) => self.text.push_str(text),
            // No number contains `U+FFFD`.
            Err(_) => self.text.push_str(&String::from_utf8_lossy(&self.bytes)),
        }
        Ok(Some(Line { file: &self.file, number: self.line, text: self.text.trim_end() }))
    }

    /// Takes the next line, which must exist.
    fn need(&mut self, expected: &str) -> Result<Line<'_>, FormatError> {
        match self.line()? {
            // Asked again because of the borrow.
            Some(_) => Ok(Line { file: &self.file, number: self.line, text: self.text.trim_end() }),
            None => {
                self.torn = true;
                Err(FormatError::syntax(&self.file, self.line, None, "", expected))
            }
        }
    }

    fn frame(&mut self) -> Result<Option<DumpFrame>, FormatError> {
        let mut header = Header::default();
        loop {
            let Some(line) = self.line()? else {
                if header == Header::default() {
                    return Ok(None);
                }
                self.torn = true;
                return Err(FormatError::syntax(&self.file, self.line, None, "", "`ITEM: ATOMS`"));
            };
            let content = line.text.trim_start();
            if content.is_empty() && header == Header::default() {
                continue;
            }
            let Some(item) = content.strip_prefix(ITEM).map(|item| item.trim().to_string()) else {
                return Err(line.error(ITEMS));
            };
            if let Some(names) =
                item.strip_prefix("ATOMS").filter(|rest| !rest.starts_with(char::is_alphabetic))
            {
                let names: Vec<String> = names.split_ascii_whitespace().map(str::to_string).collect();
                if names.is_empty() {
                    return Err(line.error("`ITEM: ATOMS` with the names of the columns"));
                }
                let (step, count, cell) = header.complete(line)?;
                let columns = self.atoms(names, count)?;
                let Header { time, units, provenance, .. } = header;
                return Ok(Some(DumpFrame { step, time, units, provenance, cell, columns }));
            }
            self.item(&item, &mut header)?;
        }
    }

    fn item(&mut self, item: &str, header: &mut Header) -> Result<(), FormatError> {
        let heading = Line { file: &self.file, number: self.line, text: self.text.trim_end() };
        match item.split_ascii_whitespace().collect::<Vec<_>>()[..] {
            ["UNITS"] => header.units = Some(self.need("the name of a unit system")?.text.trim().to_string()),
            ["TIME"] => {
                header.time = Some(only_word(self.need("the time")?, "the time")?.number("the time")?)
            }
            ["TIMESTEP"] => {
                let word = only_word(self.need("the time step")?, "the time step")?;
                header.step = Some(word.integer("the time step", 0, i64::MAX)? as u64);
            }
            ["NUMBER", "OF", "ATOMS", ..] => {
                header.provenance = Provenance::parse(item);
                let time = item.split_ascii_whitespace().find_map(|word| word.strip_prefix("time="));
                header.time = header.time.or_else(|| time.and_then(crate::number::parse));
                let word = only_word(self.need("the number of atoms")?, "the number of atoms")?;
                header.count = Some(word.integer("the number of atoms", 0, i64::MAX)? as u64);
            }
            ["BOX", "BOUNDS", "xy", "xz", "yz", ..] | ["BOX", "BOUNDS", "abc", "origin", ..] => {
                return Err(
                    heading.error("a box without tilt, `ITEM: BOX BOUNDS` and three flags such as `pp`")
                );
            }
            ["BOX", "BOUNDS", ref flags @ ..] if flags.is_empty() || flags.len() == 3 => {
                let periodic = std::array::from_fn(|k| flags.get(k) == Some(&"pp"));
                let mut cell = Cell { lo: [0.0; 3], hi: [0.0; 3], periodic };
                for k in 0..3 {
                    (cell.lo[k], cell.hi[k]) = bounds(self.need("the bounds of the box")?)?;
                }
                header.cell = Some(cell);
            }
            _ => return Err(heading.error(ITEMS)),
        }
        Ok(())
    }

    fn atoms(&mut self, names: Vec<String>, count: u64) -> Result<Vec<DumpColumn>, FormatError> {
        // Grows with the lines that are there: the promised count may be any number.
        let new = |name: String| {
            let words = WORDS.contains(&name.as_str());
            let values = if words { Values::Word(Vec::new()) } else { Values::Number(Vec::new()) };
            DumpColumn { name, values }
        };
        let mut columns: Vec<DumpColumn> = names.into_iter().map(new).collect();
        let width = columns.len();
        for i in 0..count {
            let Some(line) = self.line()? else {
                self.torn = true;
                let left = format!("{} more lines of atoms", count - i);
                return Err(FormatError::syntax(&self.file, self.line, None, "", left));
            };
            row(line, &mut columns).map_err(|error| {
                // A line with a column too few or too many is better told so than by a word in the wrong place.
                if line.text.split_ascii_whitespace().count() == width {
                    return error;
                }
                line.error(format!("{width} columns, as `ITEM: ATOMS` says"))
            })?;
        }
        Ok(columns)
    }
}

impl<R: BufRead> Iterator for Reader<R> {
    type Item = Result<DumpFrame, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.done {
            return None;
        }
        let frame = self.frame();
        self.done = !matches!(frame, Ok(Some(_)));
        frame.transpose()
    }
}

#[derive(Default, PartialEq)]
struct Header {
    step: Option<u64>,
    time: Option<f64>,
    units: Option<String>,
    provenance: Option<Provenance>,
    count: Option<u64>,
    cell: Option<Cell>,
}

impl Header {
    fn complete(&self, atoms: Line<'_>) -> Result<(u64, u64, Cell), FormatError> {
        let missing = |item: &str| atoms.error(format!("`{ITEM} {item}` above this line"));
        let step = self.step.ok_or_else(|| missing("TIMESTEP"))?;
        let count = self.count.ok_or_else(|| missing("NUMBER OF ATOMS"))?;
        Ok((step, count, self.cell.ok_or_else(|| missing("BOX BOUNDS"))?))
    }
}

/// Adds a line of atoms to the columns.
fn row(line: Line<'_>, columns: &mut [DumpColumn]) -> Result<(), FormatError> {
    let mut words = line.text.split_ascii_whitespace().map(|text| Word { line, text });
    for column in columns {
        let Some(word) = words.next() else { return Err(line.error("more columns")) };
        match (&mut column.values, column.name.as_str()) {
            (Values::Word(values), _) => values.push(word.text.to_string()),
            (Values::Number(values), "id") => {
                values.push(word.integer("the id", 1, i64::from(u32::MAX))? as f64)
            }
            (Values::Number(values), "type") => {
                values.push(word.integer("the type", 1, i64::from(u16::MAX))? as f64);
            }
            (Values::Number(values), name) => values.push(word.number(name)?),
        }
    }
    if words.next().is_some() { Err(line.error("fewer columns")) } else { Ok(()) }
}

fn only_word<'a>(line: Line<'a>, what: &str) -> Result<Word<'a>, FormatError> {
    let mut words = line.text.split_ascii_whitespace().map(|text| Word { line, text });
    match (words.next(), words.next()) {
        (Some(word), None) => Ok(word),
        _ => Err(line.error(format!("{what} alone"))),
    }
}

fn bounds(line: Line<'_>) -> Result<(f64, f64), FormatError> {
    let words: Vec<_> = line.text.split_ascii_whitespace().map(|text| Word { line, text }).collect();
    let [lo, hi] = words[..] else { return Err(line.error("two bounds of the box")) };
    let (low, high) = (lo.number("the lower bound")?, hi.number("the upper bound")?);
    if low <= high {
        Ok((low, high))
    } else {
        Err(hi.error("an upper bound that is not below the lower one"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// As LIGGGHTS 3.8 writes it: a blank at the end of each line of atoms.
    const TWO: &str = include_str!("two.dump");

    fn parse(bytes: &[u8]) -> Result<Vec<DumpFrame>, String> {
        Reader::new("two.dump", bytes)
            .collect::<Result<_, _>>()
            .map_err(|error: FormatError| error.to_string())
    }

    #[test]
    fn reads_frames_of_the_engines() {
        let frames = parse(TWO.as_bytes()).unwrap();
        assert_eq!(frames.iter().map(|frame| frame.step).collect::<Vec<_>>(), [0, 10]);
        let mut frame = frames[1].clone();
        assert_eq!((frame.time, frame.units.as_deref(), frame.len()), (Some(0.5), Some("si"), 2));
        assert_eq!(
            frame.cell,
            Cell { lo: [-1.0, 0.0, 0.0], hi: [1.0, 2.0, 4.0], periodic: [true, false, false] }
        );
        assert_eq!(frame.ids().unwrap(), [2, 1]);
        assert_eq!(frame.positions().unwrap(), [[0.0, 0.5, 3.0], [-0.5, 1.0, 4.0]]);
        frame.sort_by_id();
        assert_eq!(frame.number("c_1[2]").unwrap(), [1e-300, -7.25]);
        assert_eq!(frame.materials().unwrap(), [0, 1]);
        assert_eq!(frame.columns[5].values, Values::Word(vec!["Si".into(), "O".into()]));
        assert_eq!(
            (frame.number("element"), frame.number("x"), frame.vector(["x", "y", "z"])),
            (None, None, None)
        );
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        for (old, new, message) in [
            ("TIMESTEP\n10", "TIMESTEP\n1.5", "17:1: found `1.5`, expected the time step, an integer from 0"),
            ("TIMESTEP\n10", "TIMESTEP\n10 11", "17: found `10 11`, expected the time step alone"),
            ("TIME\n0.5", "TIME\nnan", "15:1: found `nan`, expected the time, a finite number"),
            ("ITEM: TIMESTEP", "TIMESTEP", "16: found `TIMESTEP`, expected one of `ITEM: UNITS`"),
            (
                "ITEM: TIMESTEP\n10\n",
                "",
                "22: found `ITEM: ATOMS id type xs ys zs element c_1[2]`, expected `ITEM: TIMESTEP` above",
            ),
            (
                "ATOMS\n2\nITEM: BOX BOUNDS pp",
                "ATOMS\n-2\nITEM: BOX BOUNDS pp",
                "19:1: found `-2`, expected the number",
            ),
            (
                "ATOMS\n2\nITEM: BOX BOUNDS pp",
                "ENTRIES\n2\nITEM: BOX BOUNDS pp",
                "18: found `ITEM: NUMBER OF ENTRIES`, expected one of",
            ),
            (
                "pp ff mm",
                "xy xz yz pp ff mm",
                "20: found `ITEM: BOX BOUNDS xy xz yz pp ff mm`, expected a box without tilt",
            ),
            (
                "pp ff mm",
                "abc origin pp ff mm",
                "20: found `ITEM: BOX BOUNDS abc origin pp ff mm`, expected a box",
            ),
            ("-1 1", "-1 -2", "21:4: found `-2`, expected an upper bound"),
            ("-1 1", "-1 1 0", "21: found `-1 1 0`, expected two bounds"),
            (
                "ITEM: ATOMS id type xs ys zs element c_1[2]",
                "ITEM: ATOMS",
                "24: found `ITEM: ATOMS`, expected `ITEM: ATOMS` with the names",
            ),
            ("2 2 0.5", "2.5 2 0.5", "25:1: found `2.5`, expected the id, an integer from 1"),
            ("2 2 0.5", "2 0 0.5", "25:3: found `0`, expected the type, an integer from 1 to 65535"),
            ("2 2 0.5", "2 2 inf", "25:5: found `inf`, expected xs, a finite number"),
            ("2 2 0.5", "2 2", "25: found `2 2 0.25 0.75 O -7.25`, expected 7 columns"),
            ("2 2 0.5", "2 2 0.5 1", "25: found `2 2 0.5 1 0.25 0.75 O -7.25`, expected 7 columns"),
        ] {
            assert!(TWO.contains(old), "{old}");
            // In the second frame, if both have it.
            let at = TWO.rfind(old).unwrap_or_default();
            let error =
                parse(format!("{}{new}{}", &TWO[..at], &TWO[at + old.len()..]).as_bytes()).unwrap_err();
            let expected = format!("two.dump:{message}");
            assert!(error.starts_with(&expected), "{error}\nnot\n{expected}");
        }
        let (short, _) = TWO.rsplit_once("1 1 0.25").unwrap();
        assert_eq!(parse(short.as_bytes()).unwrap_err(), "two.dump:25: expected 1 more lines of atoms");
        assert_eq!(parse(b"ITEM: TIMESTEP\n").unwrap_err(), "two.dump:1: expected the time step");
        assert_eq!(parse(b"ITEM: TIMESTEP\n1\n").unwrap_err(), "two.dump:2: expected `ITEM: ATOMS`");
        assert_eq!(parse(b"1 2 3\n").unwrap_err()[..26], "two.dump:1: found `1 2 3`,"[..26]);
        assert_eq!(parse(b"\n\n").unwrap(), []);
    }

    #[test]
    fn good_frames_come_before_the_error() {
        let (short, _) = TWO.rsplit_once("1 1 0.25").unwrap();
        let mut reader = Reader::new("two.dump", short.as_bytes());
        assert_eq!(reader.next().unwrap().unwrap().step, 0);
        assert!(!reader.torn());
        assert!(reader.next().unwrap().is_err());
        assert!(reader.torn() && reader.next().is_none());
    }

    #[test]
    fn a_promised_count_allocates_nothing() {
        let text = TWO.replacen("ATOMS\n2", "ATOMS\n9000000000000000000", 1);
        assert!(parse(text.as_bytes()).is_err());
    }

    proptest! {
        #[test]
        fn never_panics_on_noise(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = parse(&bytes);
        }

        #[test]
        fn never_panics_on_damaged_files(
            edits in prop::collection::vec((0usize..600, prop::sample::select(b" \n:-0159.enaAV\xff".to_vec()), 0u8..3), 1..8),
        ) {
            let mut bytes = TWO.as_bytes().to_vec();
            for (at, byte, kind) in edits {
                let at = at % bytes.len();
                match kind {
                    0 => bytes[at] = byte,
                    1 => bytes.insert(at, byte),
                    _ => drop(bytes.remove(at)),
                }
            }
            if let Ok(frames) = parse(&bytes) {
                for mut frame in frames {
                    frame.sort_by_id();
                    let _ = (frame.positions(), frame.ids(), frame.materials(), frame.len());
                }
            }
        }
    }
}
