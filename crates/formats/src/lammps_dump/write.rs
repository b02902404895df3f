//! Writing dumps.

use super::frame::DumpFrame;
use super::read::Reader;
use crate::atomic::{GrowingFile, continued};
use crate::error::FormatError;
use crate::number;
use crate::particles::Frame;
use crate::provenance::Provenance;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Longest line that LAMMPS and LIGGGHTS read, without the line feed.
const LONGEST_LINE: usize = 1022;
/// Bytes of rows that are written together.
const BUFFER: usize = 1 << 18;
/// Longest number, with the blank in front of it.
const LONGEST_NUMBER: usize = 25;

/// Which programs shall read the dump.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialect {
    /// Frames start with `ITEM: TIME`: OVITO shows the time. LAMMPS since 2021, ASE and OVITO read this.
    #[default]
    Lammps,
    /// Frames start with `ITEM: TIMESTEP`: LIGGGHTS and MDAnalysis read this too.
    Liggghts,
}

/// A dump that grows by a frame at a time.
///
/// The file appears with its first frame, whole; each further frame is with the operating system when
/// [`DumpWriter::append`] returns. [`DumpWriter::resume`] cuts off a frame that a crash tore apart.
#[derive(Debug)]
pub struct DumpWriter {
    path: PathBuf,
    dialect: Dialect,
    provenance: Provenance,
    file: Option<GrowingFile>,
}

impl DumpWriter {
    /// Prepares a dump; its first frame replaces a file of that name.
    pub fn create(path: impl AsRef<Path>, provenance: &Provenance, dialect: Dialect) -> DumpWriter {
        let path = path.as_ref().to_path_buf();
        DumpWriter { path, dialect, provenance: provenance.clone(), file: None }
    }

    /// Continues a dump: keeps its frames up to the first one that `keep` refuses, for instance the first one after the
    /// step of the checkpoint from which the run goes on. A torn last frame is cut off.
    ///
    /// # Errors
    /// When the file cannot be read, or is damaged before its end; then it is left as it is.
    pub fn resume(
        path: impl AsRef<Path>,
        provenance: &Provenance,
        dialect: Dialect,
        mut keep: impl FnMut(&DumpFrame) -> bool,
    ) -> Result<DumpWriter, FormatError> {
        let mut writer = DumpWriter::create(path, provenance, dialect);
        let mut reader = Reader::open(&writer.path)?;
        let mut length = 0;
        while let Some(frame) = reader.next() {
            match frame {
                // A last line without its line feed is torn, even if it reads well.
                Ok(frame) if !reader.torn() && keep(&frame) => length = reader.offset(),
                Err(error) if !reader.torn() => return Err(error),
                _ => break,
            }
        }
        writer.file = Some(GrowingFile::open(&writer.path, length)?);
        Ok(writer)
    }

    /// Continues a dump at a length that it once had: frames that were written later are cut off.
    ///
    /// # Errors
    /// When the file is shorter than that or no dump; then it is left as it is.
    pub fn resume_at(
        path: impl AsRef<Path>,
        provenance: &Provenance,
        dialect: Dialect,
        length: u64,
    ) -> Result<DumpWriter, FormatError> {
        let mut writer = DumpWriter::create(path, provenance, dialect);
        if length > 0 {
            let head: &[u8] = match dialect {
                Dialect::Lammps => b"ITEM: TIME\n",
                Dialect::Liggghts => b"ITEM: TIMESTEP\n",
            };
            continued(&writer.path, head, length)?;
            writer.file = Some(GrowingFile::open(&writer.path, length)?);
        }
        Ok(writer)
    }

    /// Bytes of all frames so far.
    pub fn length(&self) -> u64 {
        self.file.as_ref().map_or(0, GrowingFile::length)
    }

    /// Appends a frame, with the particles in the order in which they are given.
    ///
    /// Columns are `id type radius mass x y z vx vy vz`, `omegax omegay omegaz`, `fx fy fz` and `tqx tqy tqz` if the
    /// frame has them, and the further columns of the frame.
    ///
    /// # Errors
    /// [`FormatError::NonFinite`], [`FormatError::Unwritable`] when columns do not fit together or are more than
    /// the readers of LAMMPS take, [`FormatError::Io`]. The file then ends with the frame before.
    pub fn append(&mut self, frame: &Frame<'_>) -> Result<(), FormatError> {
        frame.check(&self.path)?;
        let header = self.header(frame)?;
        let write = |out: &mut dyn Write| {
            out.write_all(header.as_bytes())?;
            rows(out, frame)
        };
        match &mut self.file {
            Some(file) => file.append(write),
            None => {
                self.file = Some(GrowingFile::create(&self.path, write)?);
                Ok(())
            }
        }
    }

    /// Waits until everything is on the disk.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn sync(&self) -> Result<(), FormatError> {
        self.file.as_ref().map_or(Ok(()), GrowingFile::sync)
    }

    /// Path of the dump.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn header(&self, frame: &Frame<'_>) -> Result<String, FormatError> {
        let time = number::text(frame.time);
        let mut text = match self.dialect {
            Dialect::Lammps => format!("ITEM: TIME\n{time}\n"),
            Dialect::Liggghts => String::new(),
        };
        let flag = |periodic: bool| if periodic { "pp" } else { "ff" };
        let [x, y, z] = frame.cell.periodic.map(flag);
        text += &format!(
            "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS {} time={time}\n{}\nITEM: BOX BOUNDS {x} {y} {z}\n",
            frame.step,
            self.provenance,
            frame.len(),
        );
        for (lo, hi) in frame.cell.lo.into_iter().zip(frame.cell.hi) {
            text += &format!("{} {}\n", number::text(lo), number::text(hi));
        }
        let vectors = frame.vectors().flat_map(|(names, _)| names);
        let extra = frame.extra.iter().map(|column| column.name);
        let names: Vec<&str> =
            ["id", "type", "radius", "mass"].into_iter().chain(vectors).chain(extra).collect();
        let names_line = format!("ITEM: ATOMS {}", names.join(" "));
        if names_line.len() > LONGEST_LINE || names.len() * LONGEST_NUMBER > LONGEST_LINE {
            let problem = format!(
                "{} columns; LAMMPS reads lines of at most {LONGEST_LINE} characters, which is {} columns",
                names.len(),
                LONGEST_LINE / LONGEST_NUMBER
            );
            return Err(FormatError::unwritable(&self.path, problem));
        }
        Ok(text + &names_line + "\n")
    }
}

fn rows(out: &mut dyn Write, frame: &Frame<'_>) -> io::Result<()> {
    let mut buffer = Vec::with_capacity(BUFFER + LONGEST_LINE + 1);
    let vectors: Vec<_> = frame.vectors().map(|(_, values)| values).collect();
    for i in 0..frame.len() {
        number::push_integer(&mut buffer, i64::from(frame.id[i]));
        buffer.push(b' ');
        number::push_integer(&mut buffer, i64::from(frame.material[i]) + 1);
        let scalars = [frame.radius[i], frame.mass[i]].into_iter();
        let components = vectors.iter().flat_map(|values| values[i]);
        let extra = frame.extra.iter().map(|column| column.values[i]);
        for value in scalars.chain(components).chain(extra) {
            buffer.push(b' ');
            number::push(&mut buffer, value);
        }
        buffer.push(b'\n');
        if buffer.len() >= BUFFER {
            out.write_all(&buffer)?;
            buffer.clear();
        }
    }
    out.write_all(&buffer)
}

#[cfg(test)]
mod tests {
    use super::super::read::read;
    use super::*;
    use crate::particles::ScalarColumn;
    use crate::particles::tests::Owned;
    use proptest::prelude::*;
    use std::fs;

    fn provenance() -> Provenance {
        Provenance::new("0.1.0", "0f3a", 1_764_000_000).unwrap()
    }

    fn write(path: &Path, steps: &[u64]) {
        let owned = Owned::new(4);
        let mut writer = DumpWriter::create(path, &provenance(), Dialect::Lammps);
        for step in steps {
            writer.append(&Frame { step: *step, ..owned.frame(&owned.extra()) }).unwrap();
        }
        writer.sync().unwrap();
    }

    #[test]
    fn looks_as_documented() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.dump");
        let frame = Frame {
            step: 400,
            time: 0.0004,
            cell: crate::Cell { lo: [-0.01; 3], hi: [0.01; 3], periodic: [true, false, false] },
            id: &[2, 1],
            material: &[0, 1],
            radius: &[0.5, 0.25],
            mass: &[1.0, 0.1],
            position: &[[0.0, -0.0, 1e-7], [1.0, 2.0, 3.0]],
            velocity: &[[0.5; 3]; 2],
            angular_velocity: None,
            force: Some(&[[4.0, 5.0, 6.0]; 2]),
            torque: None,
            extra: &[ScalarColumn { name: "c_1[2]", values: &[7.0, 8.5] }],
        };
        DumpWriter::create(&path, &provenance(), Dialect::Liggghts).append(&frame).unwrap();
        let common = "ITEM: TIMESTEP\n400\n\
            ITEM: NUMBER OF ATOMS granule 0.1.0 plan=0f3a created=1764000000 time=0.0004\n2\n\
            ITEM: BOX BOUNDS pp ff ff\n-0.01 0.01\n-0.01 0.01\n-0.01 0.01\n\
            ITEM: ATOMS id type radius mass x y z vx vy vz fx fy fz c_1[2]\n\
            2 1 0.5 1 0 -0 1e-7 0.5 0.5 0.5 4 5 6 7\n\
            1 2 0.25 0.1 1 2 3 0.5 0.5 0.5 4 5 6 8.5\n";
        assert_eq!(fs::read_to_string(&path).unwrap(), common);
        DumpWriter::create(&path, &provenance(), Dialect::Lammps).append(&frame).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), format!("ITEM: TIME\n0.0004\n{common}"));
    }

    #[test]
    fn every_bit_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.dump");
        let owned = Owned::new(50);
        let extra = owned.extra();
        let frame = owned.frame(&extra);
        for dialect in [Dialect::Lammps, Dialect::Liggghts] {
            DumpWriter::create(&path, &provenance(), dialect).append(&frame).unwrap();
            let [back] = &read(&path).unwrap()[..] else { panic!("not one frame") };
            assert_eq!((back.step, back.time, back.cell), (frame.step, Some(frame.time), frame.cell));
            assert_eq!(back.provenance, Some(provenance()));
            assert_eq!(back.ids().unwrap(), owned.id);
            assert_eq!(back.materials().unwrap(), owned.material);
            assert_eq!(back.number("radius").unwrap(), owned.scalars[0]);
            assert_eq!(back.number("mass").unwrap(), owned.scalars[1]);
            assert_eq!(back.number("pressure").unwrap(), owned.pressure);
            for ((names, values), k) in frame.vectors().zip(0..) {
                assert_eq!(back.vector(names).unwrap(), values, "{k}");
            }
            assert_eq!(back.positions().unwrap(), owned.vectors[0]);
        }
    }

    #[test]
    fn a_bad_frame_leaves_the_file_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.dump");
        let owned = Owned::new(3);
        let frame = owned.frame(&[]);
        let mut writer = DumpWriter::create(&path, &provenance(), Dialect::Lammps);
        assert!(writer.append(&Frame { mass: &[1.0, f64::NAN, 1.0], ..frame }).is_err());
        assert!(!path.exists());
        writer.append(&frame).unwrap();
        let before = fs::read(&path).unwrap();
        let error = writer.append(&Frame { mass: &[1.0, f64::NAN, 1.0], ..frame }).unwrap_err();
        assert_eq!(error.to_string(), "mass of body 2 is NaN: only finite values can be written");
        assert_eq!(fs::read(&path).unwrap(), before);
        let names: Vec<String> = (0..23).map(|k| format!("c{k}")).collect();
        let extra: Vec<_> = names.iter().map(|name| ScalarColumn { name, values: &owned.pressure }).collect();
        let error = writer.append(&Frame { extra: &extra, ..frame }).unwrap_err().to_string();
        assert!(
            error.contains("42 columns; LAMMPS reads lines of at most 1022 characters, which is 40"),
            "{error}"
        );
        writer.append(&Frame { extra: &extra[..21], ..frame }).unwrap();
        assert_eq!(read(&path).unwrap().len(), 2);
    }

    #[test]
    fn resuming_leaves_a_damaged_file_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.dump");
        write(&path, &[0, 10, 20]);
        let damaged = fs::read_to_string(&path).unwrap().replacen("TIMESTEP\n10", "TIMESTEP\nten", 1);
        fs::write(&path, &damaged).unwrap();
        let error =
            DumpWriter::resume(&path, &provenance(), Dialect::Lammps, |_| true).unwrap_err().to_string();
        assert!(error.contains(":19:1: found `ten`, expected the time step"), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), damaged);
    }

    proptest! {
        /// A file that was cut anywhere, as by a crash, goes on with whole frames.
        #[test]
        fn any_torn_end_is_repaired(cut in 0.0..1.0f64, last in 0u64..40) {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.dump");
            write(&path, &[0, 10, 20]);
            let whole = fs::read(&path).unwrap();
            // Frames of equal content, but the number of the first step is shorter by one digit.
            let first = (whole.len() - 2) / 3;
            let ends = [first, 2 * first + 1, whole.len()];
            let cut = (cut * whole.len() as f64) as usize;
            fs::write(&path, &whole[..cut]).unwrap();
            let mut writer =
                DumpWriter::resume(&path, &provenance(), Dialect::Lammps, |frame| frame.step <= last).unwrap();
            let owned = Owned::new(2);
            writer.append(&Frame { step: 99, ..owned.frame(&[]) }).unwrap();
            let steps: Vec<_> = read(&path).unwrap().iter().map(|frame| frame.step).collect();
            let kept = [0, 10, 20].into_iter().zip(ends).filter(|(step, end)| *step <= last && *end <= cut);
            let expected: Vec<_> = kept.map(|(step, _)| step).chain([99]).collect();
            prop_assert_eq!(steps, expected);
        }
    }
}
