//! Writes a frame of particles in every format and says how long that took.
//!
//! ```text
//! cargo run --release -p granule-formats --example sample_frame -- FOLDER [NUMBER OF PARTICLES]
//! python3 crates/formats/scripts/check_vtp.py FOLDER/raw.pvd --dump FOLDER/frame.dump
//! ```

use granule_formats::lammps_data::{self, Atom, DataFile};
use granule_formats::lammps_dump::{self, Dialect, DumpWriter};
use granule_formats::vtk::{Compression, Series};
use granule_formats::{Cell, Frame, Provenance, ScalarColumn};
use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("the folder is missing")?);
    let count: usize = arguments.next().map_or(Ok(1000), |text| text.parse())?;
    std::fs::create_dir_all(&folder)?;
    let provenance = Provenance::new(env!("CARGO_PKG_VERSION"), "0f3a", 1_764_000_000)?;

    // Spheres on a jittered grid, numbered against the order of the arrays.
    let side = (count as f64).cbrt().ceil().max(1.0);
    let noise =
        |i: usize, k: usize| ((i * 7919 + k * 104_729) as f64 * 0.618_033_988_749_894_9).fract() - 0.5;
    let place = |i: usize, k: usize| {
        let index = [i % side as usize, i / side as usize % side as usize, i / (side * side) as usize][k];
        1e-3 * (index as f64 + 0.5 + 0.1 * noise(i, k))
    };
    let vectors = |k: usize, scale: f64| -> Vec<[f64; 3]> {
        (0..count).map(|i| [0, 1, 2].map(|axis| scale * noise(i, 3 * k + axis + 3))).collect()
    };
    let atoms: Vec<Atom> = (0..count)
        .map(|i| Atom {
            id: (count - i) as u32,
            material: (i % 2) as u16,
            diameter: 1e-3 * (0.7 + 0.2 * noise(i, 1)),
            density: 2500.0,
            position: [0, 1, 2].map(|axis| place(i, axis)),
            image: [0; 3],
            velocity: [0, 1, 2].map(|axis| 0.1 * noise(i, axis)),
            angular_velocity: [0, 1, 2].map(|axis| 50.0 * noise(i, axis + 9)),
        })
        .collect();
    let cell = Cell { lo: [0.0; 3], hi: [1e-3 * side; 3], periodic: [true, true, false] };
    let radius: Vec<f64> = atoms.iter().map(Atom::radius).collect();
    let frame = Frame {
        step: 1200,
        time: 0.1 + 0.2,
        cell,
        id: &atoms.iter().map(|atom| atom.id).collect::<Vec<_>>(),
        material: &atoms.iter().map(|atom| atom.material).collect::<Vec<_>>(),
        radius: &radius,
        mass: &atoms.iter().map(Atom::mass).collect::<Vec<_>>(),
        position: &atoms.iter().map(|atom| atom.position).collect::<Vec<_>>(),
        velocity: &atoms.iter().map(|atom| atom.velocity).collect::<Vec<_>>(),
        angular_velocity: Some(&atoms.iter().map(|atom| atom.angular_velocity).collect::<Vec<_>>()),
        force: Some(&vectors(4, 1e-3)),
        torque: Some(&vectors(5, 1e-6)),
        extra: &[ScalarColumn { name: "twice_radius", values: &radius }],
    };

    let title = "jittered grid".to_string();
    let data = DataFile { title, provenance: None, materials: 2, lo: cell.lo, hi: cell.hi, atoms };
    timed("data file", || lammps_data::write(folder.join("frame.data"), &data, &provenance))?;
    timed("dump", || {
        DumpWriter::create(folder.join("frame.dump"), &provenance, Dialect::Lammps).append(&frame)
    })?;
    let liggghts = folder.join("frame.liggghts.dump");
    timed("dump", || DumpWriter::create(&liggghts, &provenance, Dialect::Liggghts).append(&frame))?;
    for (name, compression) in [("raw.pvd", Compression::Raw), ("zlib.pvd", Compression::Zlib)] {
        timed(name, || Series::create(folder.join(name), &provenance, compression)?.append(&frame))?;
    }
    timed("read dump", || lammps_dump::read(folder.join("frame.dump")).map(drop))?;
    timed("read data file", || lammps_data::read(folder.join("frame.data")).map(drop))?;
    Ok(())
}

fn timed<E>(what: &str, run: impl FnOnce() -> Result<(), E>) -> Result<(), E> {
    let start = Instant::now();
    run()?;
    println!("{what:>16} {:8.1} ms", 1e3 * start.elapsed().as_secs_f64());
    Ok(())
}
