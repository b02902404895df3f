//! Writing a `.vtp` file.

use super::arrays::{Array, Compression};
use crate::atomic::AtomicFile;
use crate::error::FormatError;
use crate::number;
use crate::particles::Frame;
use crate::provenance::Provenance;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

/// Writes a frame, whole or not at all.
///
/// # Errors
/// [`FormatError::NonFinite`], [`FormatError::Unwritable`] when columns do not fit together or are more than 2³¹ - 1
/// particles, [`FormatError::Io`].
pub fn write(
    path: impl AsRef<Path>,
    frame: &Frame<'_>,
    provenance: &Provenance,
    compression: Compression,
) -> Result<(), FormatError> {
    let path = path.as_ref();
    frame.check(path)?;
    let Ok(count) = i32::try_from(frame.len()) else {
        return Err(FormatError::unwritable(
            path,
            format!("{} particles are above {}", frame.len(), i32::MAX),
        ));
    };
    let kinds: Vec<u32> = frame.material.iter().map(|material| u32::from(*material) + 1).collect();
    let cell =
        Verts { connectivity: (0..count).collect(), offsets: if count > 0 { vec![count] } else { vec![] } };
    let encode = || encode(frame, &kinds, &cell, compression);
    let arrays = encode().map_err(FormatError::io(path, "write"))?;
    let header = header(frame, provenance, compression, &arrays);
    let mut file = AtomicFile::create(path)?;
    let mut write = || {
        file.write_all(header.as_bytes())?;
        arrays.all().try_for_each(|array| array.write(&mut file))?;
        file.write_all(b"\n</AppendedData>\n</VTKFile>\n")
    };
    write().map_err(FormatError::io(path, "write"))?;
    file.commit()
}

/// One cell of all points.
struct Verts {
    connectivity: Vec<i32>,
    offsets: Vec<i32>,
}

struct Arrays<'a> {
    point_data: Vec<Array<'a>>,
    points: Array<'a>,
    verts: [Array<'a>; 2],
}

impl<'a> Arrays<'a> {
    /// All arrays, in the order in which they are appended.
    fn all(&self) -> impl Iterator<Item = &Array<'a>> {
        self.point_data.iter().chain([&self.points]).chain(&self.verts)
    }
}

fn encode<'a>(
    frame: &Frame<'a>,
    kinds: &'a [u32],
    cell: &'a Verts,
    compression: Compression,
) -> io::Result<Arrays<'a>> {
    let scalar = |name, values| Array::new(name, 1, values, compression);
    let vector = |name, values: &'a [[f64; 3]]| Array::new(name, 3, values.as_flattened(), compression);
    let mut point_data = vec![
        Array::new("id", 1, frame.id, compression)?,
        Array::new("type", 1, kinds, compression)?,
        scalar("radius", frame.radius)?,
        scalar("mass", frame.mass)?,
        vector("velocity", frame.velocity)?,
    ];
    let optional =
        [("angular_velocity", frame.angular_velocity), ("force", frame.force), ("torque", frame.torque)];
    for (name, values) in optional {
        if let Some(values) = values {
            point_data.push(vector(name, values)?);
        }
    }
    for column in frame.extra {
        point_data.push(scalar(column.name, column.values)?);
    }
    let verts = [
        Array::new("connectivity", 1, &cell.connectivity, compression)?,
        Array::new("offsets", 1, &cell.offsets, compression)?,
    ];
    Ok(Arrays { point_data, points: vector("Points", frame.position)?, verts })
}

/// Everything up to the appended bytes. Names need no escaping: [`Frame::check`] and [`Provenance::new`] see to that.
fn header(
    frame: &Frame<'_>,
    provenance: &Provenance,
    compression: Compression,
    arrays: &Arrays<'_>,
) -> String {
    let compressor = match compression {
        Compression::Raw => "",
        Compression::Zlib => r#" compressor="vtkZLibDataCompressor""#,
    };
    let mut offset = 0;
    let mut declared = arrays.all().map(|array| {
        let line = format!("<DataArray {} format=\"appended\" offset=\"{offset}\"/>\n", array.attributes);
        offset += array.len();
        line
    });
    let mut next = |count: usize| declared.by_ref().take(count).collect::<String>();
    let point_data = next(arrays.point_data.len());
    let (points, verts) = (next(1), next(2));
    let numbers = |values: &[f64]| values.iter().map(|v| number::text(*v)).collect::<Vec<_>>().join(" ");
    let periodic = frame.cell.periodic.map(|p| f64::from(u8::from(p)));
    let mut out = format!(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"{compressor}>\n\
         <PolyData>\n<FieldData>\n"
    );
    let fields = [
        ("TimeValue", "Float64", 1, 1, number::text(frame.time)),
        ("step", "Int64", 1, 1, frame.step.to_string()),
        ("cell_lo", "Float64", 3, 1, numbers(&frame.cell.lo)),
        ("cell_hi", "Float64", 3, 1, numbers(&frame.cell.hi)),
        ("cell_periodic", "UInt8", 3, 1, numbers(&periodic)),
        ("created", "Int64", 1, 1, provenance.created().to_string()),
    ];
    for (name, kind, components, tuples, values) in fields {
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
             NumberOfTuples=\"{tuples}\" format=\"ascii\">{values}</DataArray>"
        );
    }
    let texts = [
        ("program_version", provenance.program_version()),
        ("plan_fingerprint", provenance.plan_fingerprint()),
    ];
    for (name, text) in texts {
        // VTK writes a string as the numbers of its bytes and a zero.
        let bytes: Vec<String> = text.bytes().chain([0]).map(|b| b.to_string()).collect();
        let _ = writeln!(
            out,
            "<Array type=\"String\" Name=\"{name}\" NumberOfTuples=\"1\" format=\"ascii\">{}</Array>",
            bytes.join(" ")
        );
    }
    let _ = write!(
        out,
        "</FieldData>\n\
         <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n\
         <PointData Scalars=\"radius\" Vectors=\"velocity\">\n{point_data}</PointData>\n\
         <Points>\n{points}</Points>\n<Verts>\n{verts}</Verts>\n\
         </Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_",
        frame.len(),
        u8::from(!frame.is_empty()),
    );
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::tests::Owned;
    use std::fs;

    fn provenance() -> Provenance {
        Provenance::new("0.1.0", "0f3a", 1_764_000_000).unwrap()
    }

    /// Bytes of an array of a raw file, found by its name and offset.
    fn array<'a>(file: &'a [u8], name: &str) -> &'a [u8] {
        let marker = b"<AppendedData encoding=\"raw\">\n_";
        let start = file.windows(marker.len()).position(|w| w == marker).unwrap() + marker.len();
        let header = std::str::from_utf8(&file[..start]).unwrap();
        let (_, declared) = header.split_once(&format!("Name=\"{name}\"")).unwrap();
        let (_, offset) = declared.split_once("offset=\"").unwrap();
        let at = start + offset.split_once('"').unwrap().0.parse::<usize>().unwrap();
        let length = u64::from_le_bytes(file[at..at + 8].try_into().unwrap()) as usize;
        &file[at + 8..at + 8 + length]
    }

    fn doubles(bytes: &[u8]) -> Vec<f64> {
        bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
    }

    #[test]
    fn every_bit_is_at_its_offset() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtp");
        let owned = Owned::new(40);
        let extra = owned.extra();
        let frame = owned.frame(&extra);
        write(&path, &frame, &provenance(), Compression::Raw).unwrap();
        let file = fs::read(&path).unwrap();
        for (name, values) in
            [("radius", frame.radius), ("mass", frame.mass), ("pressure", owned.pressure.as_slice())]
        {
            assert_eq!(doubles(array(&file, name)), values, "{name}");
        }
        let names = ["Points", "velocity", "angular_velocity", "force", "torque"];
        for (name, values) in names.iter().zip(&owned.vectors) {
            assert_eq!(doubles(array(&file, name)), values.as_flattened(), "{name}");
        }
        let integers = |name| -> Vec<u32> {
            array(&file, name).chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect()
        };
        assert_eq!(integers("id"), owned.id);
        assert_eq!(integers("type"), owned.material.iter().map(|m| u32::from(*m) + 1).collect::<Vec<_>>());
        assert_eq!(integers("connectivity"), (0..40).collect::<Vec<_>>());
        assert_eq!(integers("offsets"), [40]);
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains(r#"Name="TimeValue" NumberOfComponents="1" NumberOfTuples="1" format="ascii">0.30000000000000004<"#));
        // "0f3a" in bytes.
        assert!(
            text.contains(r#"Name="plan_fingerprint" NumberOfTuples="1" format="ascii">48 102 51 97 0<"#)
        );
        assert!(text.ends_with("\n</AppendedData>\n</VTKFile>\n"));
    }

    #[test]
    fn absent_columns_are_absent_and_no_particles_are_no_cell() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtp");
        let owned = Owned::new(0);
        let frame = Frame { angular_velocity: None, force: None, torque: None, ..owned.frame(&[]) };
        for compression in [Compression::Raw, Compression::Zlib] {
            write(&path, &frame, &provenance(), compression).unwrap();
            let file = fs::read(&path).unwrap();
            let text = String::from_utf8_lossy(&file);
            assert!(text.contains(r#"NumberOfPoints="0" NumberOfVerts="0""#));
            assert!(!text.contains("torque") && !text.contains("angular"));
        }
    }

    #[test]
    fn refuses_what_is_not_finite() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtp");
        let mut owned = Owned::new(4);
        owned.vectors[3][2][0] = f64::NEG_INFINITY;
        let error = write(&path, &owned.frame(&[]), &provenance(), Compression::Raw).unwrap_err();
        assert_eq!(error.to_string(), "fx of body 2 is -inf: only finite values can be written");
        assert!(!path.exists());
    }
}
