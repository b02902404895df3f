//! Reading a large data file piece by piece on all threads.
//!
//! Whatever is unusual makes [`read`] give up: the plain reader then says what is wrong and where, or reads it.

use super::read::{Header, style_fits};
use super::{Atom, DataFile, LARGEST_ID};
use crate::number;
use crate::provenance::Provenance;
use crate::text::lines;
use rayon::prelude::*;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Bytes that are read at a time.
const BLOCK: usize = 1 << 24;
/// Bytes of lines that one thread parses at a time.
const PIECE: usize = 1 << 17;

/// Bytes of the shortest line of an atom.
const SHORTEST: u64 = 14;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    Header,
    Atoms,
    Velocities,
}

type Motion = (u32, [f64; 3], [f64; 3]);

/// Reads a file whose sections are in the usual order, whose ids differ, and in which each atom's velocity, if there are
/// any, stands in the same place as the atom. `None` for any other file.
pub(super) fn read(path: &Path) -> Option<DataFile> {
    let mut file = File::open(path).ok()?;
    let about = file.metadata().ok()?;
    // A pipe can be read once only: it is for the plain reader.
    if !about.is_file() {
        return None;
    }
    let most = (about.len() / SHORTEST) as usize;
    let mut text = Text { head: None, atoms: Vec::new(), moving: 0, section: Section::Header, most, path };
    let mut block = Vec::new();
    loop {
        let kept = block.len();
        block.resize(kept + BLOCK, 0);
        let mut filled = kept;
        while filled < block.len() {
            match file.read(&mut block[filled..]).ok()? {
                0 => break,
                read => filled += read,
            }
        }
        let last = filled < block.len();
        block.truncate(filled);
        // Whole lines only; the rest goes with the next block.
        let end = if last { filled } else { block.iter().rposition(|byte| *byte == b'\n')? + 1 };
        text.take(std::str::from_utf8(&block[..end]).ok()?)?;
        block.drain(..end);
        if last {
            return text.finish();
        }
    }
}

struct Text<'a> {
    head: Option<(String, Header)>,
    atoms: Vec<Atom>,
    /// Atoms that have got their velocity.
    moving: usize,
    section: Section,
    /// More atoms than this have no room in the file.
    most: usize,
    path: &'a Path,
}

impl Text<'_> {
    /// Takes the next lines of the file.
    fn take(&mut self, mut text: &str) -> Option<()> {
        if self.section == Section::Header {
            let mut all = lines(self.path, text);
            let title = all.next()?.text.trim_end().to_string();
            let mut rest = all.filter(|line| !line.content().is_empty()).peekable();
            let header = Header::read(self.path, 0, &mut rest).ok()?;
            let heading = rest.next()?;
            if heading.content() != "Atoms" || !style_fits(heading) {
                return None;
            }
            text = after(text, heading.text);
            self.atoms.reserve_exact(header.atoms.min(self.most));
            self.head = Some((title, header));
            self.section = Section::Atoms;
        }
        while !text.is_empty() {
            let end = heading(text);
            match self.section {
                Section::Atoms => self.atoms(&text[..end])?,
                _ => self.velocities(&text[..end])?,
            }
            text = &text[end..];
            if let Some(line) = lines(self.path, text).next() {
                if self.section != Section::Atoms || line.content() != "Velocities" || !style_fits(line) {
                    return None;
                }
                self.section = Section::Velocities;
                text = after(text, line.text);
            }
        }
        Some(())
    }

    fn atoms(&mut self, text: &str) -> Option<()> {
        let (_, header) = self.head.as_ref()?;
        for piece in parse(text, |line| atom(line, header.materials))? {
            self.atoms.extend(piece);
        }
        (self.atoms.len() <= header.atoms).then_some(())
    }

    fn velocities(&mut self, text: &str) -> Option<()> {
        for piece in parse(text, motion)? {
            let atoms = self.atoms.get_mut(self.moving..self.moving + piece.len())?;
            for (atom, (id, velocity, angular_velocity)) in atoms.iter_mut().zip(&piece) {
                if atom.id != *id {
                    return None;
                }
                (atom.velocity, atom.angular_velocity) = (*velocity, *angular_velocity);
            }
            self.moving += piece.len();
        }
        Some(())
    }

    fn finish(self) -> Option<DataFile> {
        let (title, Header { atoms, materials, lo, hi }) = self.head?;
        let moving = self.section == Section::Velocities;
        if self.atoms.len() != atoms || moving && self.moving != atoms {
            return None;
        }
        let ascending = self.atoms.windows(2).all(|pair| pair[0].id < pair[1].id);
        if !ascending {
            let mut ids: Vec<u32> = self.atoms.iter().map(|atom| atom.id).collect();
            ids.par_sort_unstable();
            if ids.windows(2).any(|pair| pair[0] == pair[1]) {
                return None;
            }
        }
        let provenance = Provenance::parse(&title);
        Some(DataFile { title, provenance, materials, lo, hi, atoms: self.atoms })
    }
}

/// What follows a line of a text.
fn after<'a>(text: &'a str, line: &str) -> &'a str {
    let end = line.as_ptr() as usize - text.as_ptr() as usize + line.len();
    text[end..].split_once('\n').map_or("", |(_, rest)| rest)
}

/// Where the first line begins that starts with a letter; the end if there is none.
fn heading(text: &str) -> usize {
    let bytes = text.as_bytes();
    if bytes.first().is_some_and(u8::is_ascii_alphabetic) {
        return 0;
    }
    let begins = |at: usize| bytes[at] == b'\n' && bytes.get(at + 1).is_some_and(u8::is_ascii_alphabetic);
    let pieces = bytes.len().div_ceil(PIECE);
    let found = (0..pieces).into_par_iter().find_map_first(|piece| {
        (piece * PIECE..((piece + 1) * PIECE).min(bytes.len())).find(|at| begins(*at))
    });
    found.map_or(bytes.len(), |at| at + 1)
}

/// Parses lines on all threads, in pieces that keep their order.
fn parse<T: Send>(text: &str, read: impl Fn(&str) -> Option<T> + Sync) -> Option<Vec<Vec<T>>> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while rest.len() > PIECE {
        let line = rest.as_bytes()[PIECE..].iter().position(|byte| *byte == b'\n');
        let (piece, later) = rest.split_at(line.map_or(rest.len(), |line| PIECE + line + 1));
        pieces.push(piece);
        rest = later;
    }
    pieces.push(rest);
    pieces
        .into_par_iter()
        .map(|piece| {
            let content = |line: &'_ str| line.find('#').unwrap_or(line.len());
            let lines = piece.lines().map(|line| line[..content(line)].trim());
            lines.filter(|line| !line.is_empty()).map(&read).collect()
        })
        .collect()
}

fn atom(line: &str, materials: u16) -> Option<Atom> {
    let mut words = line.split_ascii_whitespace();
    let id = integer(words.next()?, LARGEST_ID)?;
    let material = integer(words.next()?, i64::from(materials))? - 1;
    let mut number = || number::parse(words.next()?);
    let (diameter, density) = (number()?, number()?);
    let position = [number()?, number()?, number()?];
    let mut image = [0; 3];
    if let Some(first) = words.next() {
        image = [first.parse().ok()?, words.next()?.parse().ok()?, words.next()?.parse().ok()?];
    }
    let good = diameter > 0.0 && density > 0.0 && words.next().is_none();
    good.then_some(Atom {
        id: id as u32,
        material: material as u16,
        diameter,
        density,
        position,
        image,
        velocity: [0.0; 3],
        angular_velocity: [0.0; 3],
    })
}

fn motion(line: &str) -> Option<Motion> {
    let mut words = line.split_ascii_whitespace();
    let id = integer(words.next()?, LARGEST_ID)?;
    let mut number = || number::parse(words.next()?);
    let velocity = [number()?, number()?, number()?];
    let angular_velocity = [number()?, number()?, number()?];
    words.next().is_none().then_some((id as u32, velocity, angular_velocity))
}

/// An integer from 1 to `most`.
fn integer(word: &str, most: i64) -> Option<i64> {
    word.parse().ok().filter(|value| (1..=most).contains(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lammps_data::parse as plain;
    use proptest::prelude::*;
    use std::fmt::Write as _;

    fn file(atoms: usize, stride: usize, images: bool) -> String {
        let mut text = format!(
            "t\n\n{atoms} atoms\n2 atom types\n\n-1 1 xlo xhi\n-1 1 ylo yhi\n-1 1 zlo zhi\n\nAtoms # sphere\n\n"
        );
        let id = |k: usize| k * stride % (atoms + 1);
        for k in 1..=atoms {
            let x = (k as f64).sqrt();
            write!(text, "{} {} {} 2500 {} {} {x}", id(k), k % 2 + 1, 1.0 + x, -x, 1e-3 * x).unwrap();
            text += if images { " 1 -2 0 # here\n" } else { "\n" };
        }
        text += "\nVelocities\n\n";
        for k in 1..=atoms {
            let v = (k as f64).ln();
            writeln!(text, "{} {v} {} 0 {} -1e-7 {v}", id(k), -v, 3.0 * v).unwrap();
        }
        text
    }

    fn by_pieces(text: &str) -> Option<DataFile> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.data");
        std::fs::write(&path, text).unwrap();
        read(&path)
    }

    #[test]
    fn large_files_read_as_by_the_plain_reader() {
        // More than one block of 16 MiB.
        for (atoms, stride, images) in [(140_000, 1, false), (140_000, 2, true), (10, 1, true), (1, 1, false)]
        {
            let text = file(atoms, stride, images);
            let found = by_pieces(&text);
            assert!(found.is_some(), "{atoms} {stride}");
            assert_eq!(found, plain(Path::new("a"), &text).ok());
        }
        let text = file(1000, 1, false);
        let (still, _) = text.split_once("Velocities").unwrap();
        assert_eq!(by_pieces(still), plain(Path::new("a"), still).ok());
        assert_eq!(by_pieces(still.trim_end()), plain(Path::new("a"), still).ok());
    }

    #[test]
    fn what_is_wrong_is_left_to_the_plain_reader() {
        let good = file(1000, 1, false);
        for (old, new) in [
            ("1000 atoms", "1001 atoms"),
            ("1000 atoms", "999 atoms"),
            ("Atoms # sphere", "Atoms # full"),
            ("\nVelocities", "\nMasses"),
            ("\n17 2 ", "\n18 2 "),
            ("\n17 2 ", "\n17 3 "),
            ("\n17 2 ", "\n17 2 x"),
            ("\n17 2 ", "\n17 2 -"),
        ] {
            assert!(good.contains(old));
            let bad = good.replacen(old, new, 1);
            assert!(by_pieces(&bad).is_none(), "{old} {new}");
            assert!(plain(Path::new("a"), &bad).is_err(), "{old} {new}");
        }
        // Unusual, but good.
        let (head, atoms) = good.split_once("Atoms # sphere\n").unwrap();
        let (atoms, velocities) = atoms.split_once("Velocities\n").unwrap();
        let swapped = format!("{head}Velocities\n{velocities}\nAtoms\n{atoms}");
        assert!(by_pieces(&swapped).is_none() && plain(Path::new("a"), &swapped).is_ok());
    }

    proptest! {
        #[test]
        fn damaged_files_never_read_differently(
            edits in prop::collection::vec((0usize..1500, prop::sample::select(b" \n#-0159.enaAV\xff".to_vec()), 0u8..3), 1..6),
        ) {
            let mut bytes = file(12, 1, true).into_bytes();
            for (at, byte, kind) in edits {
                let at = at % bytes.len();
                match kind {
                    0 => bytes[at] = byte,
                    1 => bytes.insert(at, byte),
                    _ => drop(bytes.remove(at)),
                }
            }
            let text = String::from_utf8_lossy(&bytes);
            if let Some(found) = by_pieces(&text) {
                prop_assert_eq!(Some(found), plain(Path::new("a"), &text).ok());
            }
        }
    }
}
