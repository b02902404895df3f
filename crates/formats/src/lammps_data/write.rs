//! Writing a data file.

use super::{Atom, BOUNDS, DataFile, LARGEST_ID};
use crate::atomic;
use crate::error::FormatError;
use crate::number;
use crate::particles::{ANGULAR_VELOCITY, POSITION, VELOCITY};
use crate::provenance::Provenance;
use std::path::Path;

/// Longest title: LIGGGHTS reads lines of at most 255 characters, and the provenance takes up to 170.
const LONGEST_TITLE: usize = 80;

/// Writes a data file that LAMMPS (`atom_style sphere`) and LIGGGHTS (`atom_style granular`) read alike.
///
/// Image flags are written when any of them is not 0, velocities always.
///
/// # Errors
/// [`FormatError::NonFinite`], [`FormatError::Unwritable`] for what [`super::read`] would refuse, [`FormatError::Io`].
pub fn write(path: impl AsRef<Path>, data: &DataFile, provenance: &Provenance) -> Result<(), FormatError> {
    let path = path.as_ref();
    check(path, data)?;
    let title = data.title.split(" | granule ").next().unwrap_or_default();
    let mut out = Vec::with_capacity(200 + 250 * data.atoms.len());
    let text =
        format!("{title} | {provenance}\n\n{} atoms\n{} atom types\n\n", data.atoms.len(), data.materials);
    out.extend_from_slice(text.as_bytes());
    for (axis, names) in BOUNDS.iter().enumerate() {
        row(&mut out, &[], &[data.lo[axis], data.hi[axis]]);
        out.pop();
        out.extend_from_slice(format!(" {} {}\n", names[0], names[1]).as_bytes());
    }
    out.extend_from_slice(b"\nAtoms\n\n");
    let images = data.atoms.iter().any(|atom| atom.image != [0; 3]);
    for atom in &data.atoms {
        let [x, y, z] = atom.position;
        row(
            &mut out,
            &[i64::from(atom.id), i64::from(atom.material) + 1],
            &[atom.diameter, atom.density, x, y, z],
        );
        if images {
            out.pop();
            out.push(b' ');
            row(&mut out, &atom.image.map(i64::from), &[]);
        }
    }
    out.extend_from_slice(b"\nVelocities\n\n");
    for atom in &data.atoms {
        let ([vx, vy, vz], [wx, wy, wz]) = (atom.velocity, atom.angular_velocity);
        row(&mut out, &[i64::from(atom.id)], &[vx, vy, vz, wx, wy, wz]);
    }
    atomic::write(path, &out)
}

fn row(out: &mut Vec<u8>, integers: &[i64], numbers: &[f64]) {
    for integer in integers {
        number::push_integer(out, *integer);
        out.push(b' ');
    }
    for value in numbers {
        number::push(out, *value);
        out.push(b' ');
    }
    out.pop();
    out.push(b'\n');
}

fn check(path: &Path, data: &DataFile) -> Result<(), FormatError> {
    let refuse = |problem: String| Err(FormatError::unwritable(path, problem));
    let title = data.title.split(" | granule ").next().unwrap_or_default();
    if title.chars().count() > LONGEST_TITLE || title.contains(char::is_control) {
        return refuse(format!("the title `{title}` must be one line of at most {LONGEST_TITLE} characters"));
    }
    for axis in 0..3 {
        let (lo, hi) = (data.lo[axis], data.hi[axis]);
        if !(lo.is_finite() && hi.is_finite() && lo < hi) {
            return refuse(format!(
                "the box from {lo} to {hi} in direction {axis} has no finite positive length"
            ));
        }
    }
    if data.materials == 0 {
        return refuse("a data file needs at least one atom type".into());
    }
    for atom in &data.atoms {
        check_atom(atom)?;
        if atom.material >= data.materials {
            return refuse(format!(
                "atom {} has material {} of only {}",
                atom.id, atom.material, data.materials
            ));
        }
        if atom.id == 0 || i64::from(atom.id) > LARGEST_ID {
            return refuse(format!("the id {} is not between 1 and {LARGEST_ID}", atom.id));
        }
        if atom.diameter <= 0.0 || atom.density <= 0.0 {
            return refuse(format!(
                "diameter {} and density {} of atom {} must be above 0",
                atom.diameter, atom.density, atom.id
            ));
        }
    }
    let mut ids: Vec<u32> = data.atoms.iter().map(|atom| atom.id).collect();
    ids.sort_unstable();
    match ids.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => refuse(format!("two atoms have the id {}", pair[0])),
        None => Ok(()),
    }
}

fn check_atom(atom: &Atom) -> Result<(), FormatError> {
    let vectors =
        [(POSITION, atom.position), (VELOCITY, atom.velocity), (ANGULAR_VELOCITY, atom.angular_velocity)];
    let scalars = [("diameter", atom.diameter), ("density", atom.density)];
    let components =
        vectors.iter().flat_map(|(names, values)| names.iter().copied().zip(values.iter().copied()));
    match scalars.into_iter().chain(components).find(|(_, value)| !value.is_finite()) {
        Some((quantity, value)) => {
            Err(FormatError::NonFinite { body: atom.id, quantity: quantity.to_string(), value })
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn provenance() -> Provenance {
        Provenance::new("0.1.0", "0f3a", 1_764_000_000).unwrap()
    }

    fn sample() -> DataFile {
        super::super::parse(Path::new("two.data"), include_str!("two.data")).unwrap()
    }

    #[test]
    fn is_readable_by_both_engines() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.data");
        let mut data = sample();
        data.atoms[0].image = [0; 3];
        write(&path, &data, &provenance()).unwrap();
        let expected = "two spheres, oblique | granule 0.1.0 plan=0f3a created=1764000000\n\n\
            2 atoms\n2 atom types\n\n-0.01 0.01 xlo xhi\n-0.02 0.02 ylo yhi\n-0.03 0.03 zlo zhi\n\n\
            Atoms\n\n7 1 0.001 2500 0 0 0\n2 2 0.0012 2500 0.00106 0.0003 0.0002\n\n\
            Velocities\n\n7 0.15 0.02 -0.01 10 -20 30\n2 -0.12 0.01 0.03 -5 15 40\n";
        assert_eq!(std::fs::read_to_string(&path).unwrap(), expected);
    }

    #[test]
    fn writing_again_keeps_one_provenance() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.data");
        write(&path, &sample(), &provenance()).unwrap();
        let once = super::super::read(&path).unwrap();
        assert_eq!(once.provenance, Some(provenance()));
        write(&path, &once, &provenance()).unwrap();
        assert_eq!(super::super::read(&path).unwrap(), once);
    }

    #[test]
    fn refuses_what_the_engines_would_refuse() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.data");
        let refused = |change: fn(&mut DataFile)| {
            let mut data = sample();
            change(&mut data);
            write(&path, &data, &provenance()).unwrap_err().to_string()
        };
        assert!(refused(|d| d.atoms[1].velocity[2] = f64::NAN).starts_with("vz of body 2 is NaN"));
        assert!(refused(|d| d.atoms[1].density = f64::INFINITY).starts_with("density of body 2 is inf"));
        assert!(refused(|d| d.atoms[1].id = 7).contains("two atoms have the id 7"));
        assert!(refused(|d| d.atoms[1].id = 0).contains("the id 0 is not between 1"));
        assert!(refused(|d| d.atoms[1].id = 1 << 31).contains("the id 2147483648 is not"));
        assert!(refused(|d| d.atoms[1].material = 2).contains("material 2 of only 2"));
        assert!(refused(|d| d.atoms[1].diameter = 0.0).contains("must be above 0"));
        assert!(refused(|d| d.hi[1] = d.lo[1]).contains("no finite positive length"));
        assert!(refused(|d| d.materials = 0).contains("at least one atom type"));
        assert!(refused(|d| d.title = "a\nb".into()).contains("one line of at most"));
        assert!(!path.exists());
    }

    fn finite() -> impl Strategy<Value = f64> {
        any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |value| value.is_finite())
    }

    fn positive() -> impl Strategy<Value = f64> {
        finite().prop_map(f64::abs).prop_filter("above 0", |value| *value > 0.0)
    }

    prop_compose! {
        fn atom()(
            id in 1u32..1 << 31, material in 0u16..5, diameter in positive(), density in positive(),
            position in prop::array::uniform3(finite()), image: [i32; 3],
            velocity in prop::array::uniform3(finite()), angular_velocity in prop::array::uniform3(finite()),
        ) -> Atom {
            Atom { id, material, diameter, density, position, image, velocity, angular_velocity }
        }
    }

    proptest! {
        #[test]
        fn any_file_survives(mut atoms in prop::collection::vec(atom(), 0..6), hi in prop::array::uniform3(positive())) {
            atoms.sort_by_key(|atom| atom.id);
            atoms.dedup_by_key(|atom| atom.id);
            let data = DataFile { title: "any".into(), provenance: None, materials: 5, lo: [0.0; 3], hi, atoms };
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("any.data");
            write(&path, &data, &provenance()).unwrap();
            let back = super::super::read(&path).unwrap();
            prop_assert_eq!(back.provenance, Some(provenance()));
            prop_assert_eq!((back.lo, back.hi, back.atoms), (data.lo, data.hi, data.atoms));
        }

        #[test]
        fn never_panics_on_noise(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = super::super::parse(Path::new("noise"), &String::from_utf8_lossy(&bytes));
        }

        #[test]
        fn never_panics_on_damaged_files(
            edits in prop::collection::vec((0usize..400, prop::sample::select(b" \n#-0159.enaAV\xff".to_vec()), 0u8..3), 1..8),
        ) {
            let mut bytes = include_bytes!("two.data").to_vec();
            for (at, byte, kind) in edits {
                let at = at % bytes.len();
                match kind {
                    0 => bytes[at] = byte,
                    1 => bytes.insert(at, byte),
                    _ => drop(bytes.remove(at)),
                }
            }
            let _ = super::super::parse(Path::new("damaged"), &String::from_utf8_lossy(&bytes));
        }
    }
}
