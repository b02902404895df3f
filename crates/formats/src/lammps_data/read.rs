//! Reading a data file.

use super::{Atom, BOUNDS, DataFile, LARGEST_ID, MOST_MATERIALS};
use crate::atomic::read_text;
use crate::error::FormatError;
use crate::provenance::Provenance;
use crate::text::{Line, Word, lines};
use std::iter::Peekable;
use std::path::Path;

/// Header lines of molecular models, which are harmless when they count nothing.
const COUNTED: [&str; 8] =
    ["bonds", "angles", "dihedrals", "impropers", "ellipsoids", "lines", "triangles", "bodies"];

/// Header lines that are allowed.
const HEADER: &str = "one of `N atoms`, `N atom types`, `LO HI xlo xhi`, `LO HI ylo yhi`, `LO HI zlo zhi`, \
                      or a section `Atoms` or `Velocities`";

/// Reads a data file of `atom_style sphere`.
///
/// Comments (`#`) and blank lines are skipped, sections may come in any order. Without a section `Velocities` all
/// particles are at rest, as in LAMMPS; with one, each particle needs its line.
///
/// # Errors
/// [`FormatError::Io`], or [`FormatError::Syntax`] for everything else that a data file of another style could hold:
/// tilted boxes, other sections and other columns are refused by name.
pub fn read(path: impl AsRef<Path>) -> Result<DataFile, FormatError> {
    let path = path.as_ref();
    match super::pieces::read(path) {
        Some(data) => Ok(data),
        None => parse(path, &read_text(path)?),
    }
}

/// Reads a data file from text; `file` is the name for messages.
///
/// # Errors
/// As [`read`].
pub fn parse(file: &Path, text: &str) -> Result<DataFile, FormatError> {
    let mut all = lines(file, text);
    let title = all.next().map_or("", |line| line.text).trim_end().to_string();
    let last = text.lines().count() as u64;
    let mut lines = all.filter(|line| !line.content().is_empty()).peekable();
    let header = Header::read(file, last, &mut lines)?;
    let mut atoms = None;
    let mut velocities = None;
    while let Some(line) = lines.next() {
        match line.content() {
            "Atoms" if atoms.is_none() => {
                check_style_hint(line)?;
                atoms = Some(section(header.atoms, "atoms", file, last, &mut lines, |line| {
                    read_atom(line, header.materials)
                })?);
            }
            "Velocities" if velocities.is_none() => {
                check_style_hint(line)?;
                velocities =
                    Some(section(header.atoms, "velocities", file, last, &mut lines, read_velocity)?);
            }
            "Atoms" | "Velocities" => return Err(line.error("each section once")),
            name if is_heading(name) => return Err(line.error("only the sections `Atoms` and `Velocities`")),
            _ => return Err(line.error("a section `Atoms` or `Velocities`, or the end of the file")),
        }
    }
    if atoms.is_none() && header.atoms > 0 {
        return Err(FormatError::syntax(file, last, None, "", "a section `Atoms`"));
    }
    let atoms = join(atoms.unwrap_or_default(), velocities.unwrap_or_default())?;
    let provenance = Provenance::parse(&title);
    Ok(DataFile { title, provenance, materials: header.materials, lo: header.lo, hi: header.hi, atoms })
}

/// What stands above the first section.
pub(super) struct Header {
    pub atoms: usize,
    pub materials: u16,
    pub lo: [f64; 3],
    pub hi: [f64; 3],
}

impl Header {
    /// Reads the header; `last` is the number of the last line, for messages.
    pub fn read<'a>(
        file: &Path,
        last: u64,
        lines: &mut Peekable<impl Iterator<Item = Line<'a>>>,
    ) -> Result<Header, FormatError> {
        let (mut atoms, mut materials, mut bounds) = (None, None, [None; 3]);
        while let Some(line) = lines.next_if(|line| !is_heading(line.content())) {
            let words: Vec<_> = line.words().collect();
            let names: Vec<_> = words.iter().map(|word| word.text).collect();
            let repeated = match names[..] {
                [_, "atoms"] => {
                    atoms.replace(words[0].integer("the number of atoms", 0, LARGEST_ID)? as usize).is_some()
                }
                [_, "atom", "types"] => {
                    let count = words[0].integer("the number of atom types", 1, MOST_MATERIALS)?;
                    materials.replace(count as u16).is_some()
                }
                [_, _, lo, hi] if BOUNDS.contains(&[lo, hi]) => {
                    let axis = BOUNDS.iter().position(|names| *names == [lo, hi]).unwrap_or(0);
                    let (low, high) = (words[0].number(lo)?, words[1].number(hi)?);
                    if low >= high {
                        return Err(words[1].error(format!("{hi} above {lo}")));
                    }
                    bounds[axis].replace((low, high)).is_some()
                }
                ["0", name] | ["0", name, "types"]
                    if COUNTED.iter().any(|c| c.trim_end_matches('s') == name || *c == name) =>
                {
                    false
                }
                [_, _, _, "xy", "xz", "yz"] => return Err(line.error("a box without tilt: no `xy xz yz`")),
                _ => return Err(line.error(HEADER)),
            };
            if repeated {
                return Err(line.error("each line of the header once"));
            }
        }
        let end = lines.peek().map_or(last, |line| line.number);
        let missing =
            |what: &str| FormatError::syntax(file, end, None, "", format!("{what} above this line"));
        let mut header = Header {
            atoms: atoms.ok_or_else(|| missing("`N atoms`"))?,
            materials: materials.ok_or_else(|| missing("`N atom types`"))?,
            lo: [0.0; 3],
            hi: [0.0; 3],
        };
        for (axis, bounds) in bounds.into_iter().enumerate() {
            let [lo, hi] = BOUNDS[axis];
            (header.lo[axis], header.hi[axis]) =
                bounds.ok_or_else(|| missing(&format!("`LO HI {lo} {hi}`")))?;
        }
        Ok(header)
    }
}

/// Names of sections are words of letters, all other lines contain a number.
pub(super) fn is_heading(content: &str) -> bool {
    content.starts_with(char::is_alphabetic)
        && content.split_whitespace().all(|word| word.chars().all(char::is_alphabetic))
}

/// `Atoms # sphere` says which columns follow; any other style has other columns.
pub(super) fn style_fits(line: Line<'_>) -> bool {
    let hint = line.text.split_once('#').map_or("", |(_, hint)| hint).split_whitespace().next();
    matches!(hint, None | Some("sphere" | "granular"))
}

fn check_style_hint(line: Line<'_>) -> Result<(), FormatError> {
    if style_fits(line) { Ok(()) } else { Err(line.error("no comment here, or the atom style `# sphere`")) }
}

/// Reads as many lines as the header promised.
fn section<'a, T>(
    count: usize,
    what: &str,
    file: &Path,
    last: u64,
    lines: &mut Peekable<impl Iterator<Item = Line<'a>>>,
    mut read: impl FnMut(Line<'a>) -> Result<T, FormatError>,
) -> Result<Vec<T>, FormatError> {
    // Grows with the lines that are there: the promised count may be any number.
    let mut entries = Vec::new();
    while entries.len() < count {
        let left = format!("{} more lines of {what}", count - entries.len());
        match lines.next() {
            None => return Err(FormatError::syntax(file, last, None, "", left)),
            Some(line) if is_heading(line.content()) => return Err(line.error(left)),
            Some(line) => entries.push(read(line)?),
        }
    }
    match lines.peek() {
        Some(line) if !is_heading(line.content()) => {
            Err(line.error(format!("no more than {count} lines of {what}, as the header says")))
        }
        _ => Ok(entries),
    }
}

fn read_atom(line: Line<'_>, materials: u16) -> Result<(Word<'_>, Atom), FormatError> {
    let words: Vec<_> = line.words().collect();
    if words.len() != 7 && words.len() != 10 {
        return Err(line.error("`id type diameter density x y z`, or these and three image flags"));
    }
    let mut image = [0; 3];
    if let Some(flags) = words.get(7..10) {
        for (image, word) in image.iter_mut().zip(flags) {
            *image = word.integer("an image flag", i64::from(i32::MIN), i64::from(i32::MAX))? as i32;
        }
    }
    let atom = Atom {
        id: words[0].integer("the id of an atom", 1, LARGEST_ID)? as u32,
        material: (words[1].integer("the type of an atom", 1, i64::from(materials))? - 1) as u16,
        diameter: words[2].positive("the diameter")?,
        density: words[3].positive("the density")?,
        position: vector(&words[4..7], ["x", "y", "z"])?,
        image,
        velocity: [0.0; 3],
        angular_velocity: [0.0; 3],
    };
    Ok((words[0], atom))
}

type Velocity<'a> = (Word<'a>, u32, [f64; 3], [f64; 3]);

fn read_velocity(line: Line<'_>) -> Result<Velocity<'_>, FormatError> {
    let words: Vec<_> = line.words().collect();
    if words.len() != 7 {
        return Err(line.error("`id vx vy vz omegax omegay omegaz`"));
    }
    let id = words[0].integer("the id of an atom", 1, LARGEST_ID)? as u32;
    let velocity = vector(&words[1..4], ["vx", "vy", "vz"])?;
    Ok((words[0], id, velocity, vector(&words[4..7], ["omegax", "omegay", "omegaz"])?))
}

fn vector(words: &[Word<'_>], names: [&str; 3]) -> Result<[f64; 3], FormatError> {
    Ok([words[0].number(names[0])?, words[1].number(names[1])?, words[2].number(names[2])?])
}

/// Gives the atoms their velocities, by id.
fn join(atoms: Vec<(Word<'_>, Atom)>, mut velocities: Vec<Velocity<'_>>) -> Result<Vec<Atom>, FormatError> {
    let mut order: Vec<usize> = (0..atoms.len()).collect();
    order.sort_by_key(|i| atoms[*i].1.id);
    if let Some(pair) = order.windows(2).find(|pair| atoms[pair[0]].1.id == atoms[pair[1]].1.id) {
        return Err(atoms[pair[1]].0.error("ids that differ"));
    }
    velocities.sort_by_key(|(_, id, ..)| *id);
    if let Some(pair) = velocities.windows(2).find(|pair| pair[0].1 == pair[1].1) {
        return Err(pair[1].0.error("one velocity for each atom"));
    }
    let mut joined: Vec<Atom> = atoms.into_iter().map(|(_, atom)| atom).collect();
    for (word, id, velocity, angular_velocity) in velocities {
        let found = order.binary_search_by_key(&id, |i| joined[*i].id);
        let Ok(found) = found else { return Err(word.error("the id of an atom under `Atoms`")) };
        let atom = &mut joined[order[found]];
        (atom.velocity, atom.angular_velocity) = (velocity, angular_velocity);
    }
    Ok(joined)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO: &str = include_str!("two.data");

    fn parse(text: &str) -> Result<DataFile, String> {
        super::parse(Path::new("two.data"), text).map_err(|error| error.to_string())
    }

    #[test]
    fn reads_two_spheres() {
        let data = parse(TWO).unwrap();
        assert_eq!((data.materials, data.lo, data.hi), (2, [-0.01, -0.02, -0.03], [0.01, 0.02, 0.03]));
        let [first, second] = data.atoms[..] else { panic!("{} atoms", data.atoms.len()) };
        assert_eq!((first.id, first.material, first.image), (7, 0, [0, 1, -2]));
        assert_eq!((first.velocity, first.angular_velocity), ([0.15, 0.02, -0.01], [10.0, -20.0, 30.0]));
        assert_eq!((second.id, second.material, second.diameter), (2, 1, 0.0012));
        assert_eq!(second.velocity, [-0.12, 0.01, 0.03]);
        assert_eq!(second.angular_velocity, [-5.0, 15.0, 40.0]);
        // The mass that LAMMPS 29 Sep 2021 dumps for this sphere with `%24.17g`: equal bits.
        assert_eq!(second.mass(), 2.2619467105846502e-06);
        assert_eq!(second.radius(), 0.0006);
        // Three products and a quotient: relative error below 4 rounding units.
        let density = Atom::density_of(second.mass(), second.radius());
        assert!((density / 2500.0 - 1.0).abs() < 4.0 * f64::EPSILON);
    }

    #[test]
    fn without_velocities_all_are_at_rest() {
        let (text, _) = TWO.split_once("Velocities").unwrap();
        let still = |atom: &Atom| (atom.velocity, atom.angular_velocity) == ([0.0; 3], [0.0; 3]);
        assert!(parse(text).unwrap().atoms.iter().all(still));
    }

    #[test]
    fn sections_may_be_swapped_and_lines_end_with_crlf() {
        let (head, atoms) = TWO.split_once("Atoms").unwrap();
        let (atoms, velocities) = atoms.split_once("Velocities").unwrap();
        let swapped = format!("{head}Velocities{velocities}\nAtoms{atoms}");
        assert_eq!(parse(&swapped).unwrap(), parse(TWO).unwrap());
        assert_eq!(parse(&TWO.replace('\n', "\r\n")).unwrap(), parse(TWO).unwrap());
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        for (old, new, message) in [
            ("2 atoms", "2.5 atoms", "3:1: found `2.5`, expected the number of atoms, an integer from 0"),
            ("2 atoms", "", "13: expected `N atoms` above this line"),
            ("2 atoms", "2 atoms\n2 atoms", "4: found `2 atoms`, expected each line of the header once"),
            ("2 atoms", "3 bonds", "3: found `3 bonds`, expected one of `N atoms`"),
            (
                "2 atom types",
                "0 atom types",
                "4:1: found `0`, expected the number of atom types, an integer from 1",
            ),
            ("2 atom types", "", "13: expected `N atom types` above this line"),
            ("-0.02 0.02", "0.02 -0.02", "8:6: found `-0.02`, expected yhi above ylo"),
            ("-0.02 0.02", "nan 0.02", "8:1: found `nan`, expected ylo, a finite number"),
            ("zlo zhi", "", "9: found `-0.03 0.03`, expected one of"),
            ("zlo zhi", "zlo zhi\n0 0 0 xy xz yz", "10: found `0 0 0 xy xz yz`, expected a box without tilt"),
            ("-0.03 0.03 zlo zhi", "", "13: expected `LO HI zlo zhi` above this line"),
            (
                "Atoms # sphere",
                "Masses",
                "13: found `Masses`, expected only the sections `Atoms` and `Velocities`",
            ),
            ("Atoms # sphere", "Pair Coeffs", "13: found `Pair Coeffs`, expected only the sections"),
            (
                "Atoms # sphere",
                "Atoms # full",
                "13: found `Atoms # full`, expected no comment here, or the atom style",
            ),
            (
                "7 1 0.001 2500 0.0 0.0 0.0 0 1 -2",
                "",
                "18: found `Velocities`, expected 1 more lines of atoms",
            ),
            ("7 1 0.001", "x7 1 0.001", "15:1: found `x7`, expected the id of an atom, an integer from 1"),
            ("7 1 0.001", "0 1 0.001", "15:1: found `0`, expected the id of an atom, an integer from 1"),
            ("7 1 0.001", "2 1 0.001", "16:1: found `2`, expected ids that differ"),
            (
                "7 1 0.001",
                "7 3 0.001",
                "15:3: found `3`, expected the type of an atom, an integer from 1 to 2",
            ),
            ("7 1 0.001", "7 1 -1", "15:5: found `-1`, expected the diameter, a finite number above 0"),
            ("7 1 0.001", "7 1 inf", "15:5: found `inf`, expected the diameter, a finite number above 0"),
            (
                "7 1 0.001 2500",
                "7 1 0.001 0",
                "15:11: found `0`, expected the density, a finite number above 0",
            ),
            (
                "0.0 0 1 -2",
                "0.0 0 1",
                "15: found `7 1 0.001 2500 0.0 0.0 0.0 0 1`, expected `id type diameter",
            ),
            ("0 1 -2", "0 1 0.5", "15:32: found `0.5`, expected an image flag"),
            ("2 -0.12", "3 -0.12", "20:1: found `3`, expected the id of an atom under `Atoms`"),
            ("2 -0.12", "2 2 -0.12", "20: found `2 2 -0.12"),
            ("2 -0.12 0.01 0.03 -5 15 40", "", "21: expected 1 more lines of velocities"),
            ("2 -0.12", "7 -0.12", "21:1: found `7`, expected one velocity for each atom"),
            ("2 -0.12", "2 x", "20:3: found `x`, expected vx, a finite number"),
            ("Velocities", "Atoms", "18: found `Atoms`, expected each section once"),
            ("Velocities", "1 2 3", "18: found `1 2 3`, expected no more than 2 lines of atoms"),
        ] {
            assert!(TWO.contains(old), "{old}");
            let error = parse(&TWO.replacen(old, new, 1)).unwrap_err();
            assert!(error.starts_with(&format!("two.data:{message}")), "{error}\nnot\n{message}");
        }
        assert_eq!(parse("").unwrap_err(), "two.data:0: expected `N atoms` above this line");
    }

    #[test]
    fn molecular_counts_of_zero_are_harmless() {
        let text = TWO.replacen("2 atoms", "2 atoms\n0 bonds\n0 bond types\n0 improper types", 1);
        assert_eq!(parse(&text).unwrap(), parse(TWO).unwrap());
    }

    #[test]
    fn a_promised_count_allocates_nothing() {
        let text = TWO.replacen("2 atoms", "2000000000 atoms", 1);
        assert!(parse(&text).unwrap_err().contains("1999999998 more lines of atoms"));
    }
}
