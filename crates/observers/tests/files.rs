//! Particle files read back: they hold what the view held, bit by bit.

mod support;

use granule_drivers::Driver;
use granule_formats::{lammps_data, lammps_dump, vtk};
use granule_geometry::Cell;
use granule_observers::quantities;
use granule_plan::{Dimensions, OutputKind, Plan};
use support::{Body, FINGERPRINT, output, plan, run};

/// Spheres that fly through a periodic box and meet.
fn gas(steps: u64) -> Plan {
    let bodies: Vec<Body> = (0..5)
        .map(|k| {
            let k = f64::from(k);
            Body {
                mass: 1.0 + 0.1 * k,
                radius: 0.1 + 0.01 * k,
                position: [0.3 + 0.4 * k, 0.7 * k % 2.0, 0.31 * k],
                velocity: [3.1 - k, 0.3 * k, -1.7],
                spin: [0.1 * k, -0.2, 0.3],
                frozen: false,
            }
        })
        .collect();
    let mut plan = plan(&bodies, 1e4, 1.0, 1e-4, steps);
    plan.cell = Cell::new([0.0; 3], [2.0, 2.0, 5.0], [true, true, false]).unwrap();
    plan
}

#[test]
fn a_dump_is_the_view() {
    let folder = tempfile::tempdir().unwrap();
    let mut plan = gas(20_000);
    plan.outputs = vec![output("a.dump", OutputKind::LammpsDump, 6_000)];
    let driver = run(plan, folder.path());
    let frames = lammps_dump::read(folder.path().join("a.dump")).unwrap();
    let steps: Vec<u64> = frames.iter().map(|frame| frame.step).collect();
    assert_eq!(steps, [0, 6_000, 12_000, 18_000, 20_000]);
    let (view, last) = (driver.view(), frames.last().unwrap());
    assert_eq!(last.time, Some(view.time()));
    assert_eq!(last.provenance.as_ref().unwrap(), &support::provenance());
    assert_eq!(last.ids().unwrap(), [1, 2, 3, 4, 5]);
    let images = last.vector(["ix", "iy", "iz"]).unwrap();
    let column = |names| last.vector(names).unwrap();
    for rank in 0..5 {
        let (bodies, place) = (view.bodies(), view.order()[rank] as usize);
        assert_eq!(last.positions().unwrap()[rank], view.position(rank));
        assert_eq!(column(["vx", "vy", "vz"])[rank], bodies.velocity_of(place));
        assert_eq!(column(["omegax", "omegay", "omegaz"])[rank], bodies.spin_of(place));
        assert_eq!(column(["fx", "fy", "fz"])[rank], bodies.force_of(place));
        assert_eq!(column(["tqx", "tqy", "tqz"])[rank], bodies.torque_of(place));
        assert_eq!(last.number("radius").unwrap()[rank], bodies.position[place][3]);
        assert_eq!(last.number("mass").unwrap()[rank], bodies.mass[place]);
        let unwrapped = quantities::unwrapped_position(&view, rank);
        for axis in 0..3 {
            let back = view.position(rank)[axis] + images[rank][axis] * [2.0, 2.0, 0.0][axis];
            // One rounding each of a wrap and of adding the periods back, at the size of the way, about 10 m.
            assert!((back - unwrapped[axis]).abs() <= 4.0 * 10.0 * f64::EPSILON);
        }
    }
    assert!(images.iter().any(|image| image[0].abs() > 1.0), "somebody has gone round");
    // The open direction holds all spheres whole.
    let lowest = (0..5)
        .map(|rank| view.position(rank)[2] - last.number("radius").unwrap()[rank])
        .fold(f64::INFINITY, f64::min);
    assert!(last.cell.lo[2] <= lowest && last.cell.periodic == [true, true, false]);
}

#[test]
fn a_data_file_holds_the_last_state() {
    let folder = tempfile::tempdir().unwrap();
    let mut plan = gas(1_000);
    plan.outputs = vec![output("end.data", OutputKind::LammpsData, 300)];
    let driver = run(plan, folder.path());
    let data = lammps_data::read(folder.path().join("end.data")).unwrap();
    let view = driver.view();
    assert_eq!(data.provenance.as_ref(), Some(&support::provenance()));
    assert!(data.title.starts_with("step 1000"), "{}", data.title);
    for (rank, atom) in data.atoms.iter().enumerate() {
        let (bodies, place) = (view.bodies(), view.order()[rank] as usize);
        assert_eq!(atom.position, view.position(rank));
        assert_eq!(atom.velocity, bodies.velocity_of(place));
        assert_eq!(atom.angular_velocity, bodies.spin_of(place));
        assert_eq!(atom.radius(), bodies.position[place][3]);
        // Mass to density and back: one rounding for each of seven operations.
        assert!((atom.mass() - bodies.mass[place]).abs() <= 7.0 * f64::EPSILON * atom.mass());
    }
}

#[test]
fn a_collection_names_every_frame() {
    for compressed in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let mut plan = gas(100);
        plan.outputs = vec![output("vtk/gas", OutputKind::Vtk { compressed }, 40)];
        run(plan, folder.path());
        let entries = vtk::read_collection(folder.path().join("vtk/gas.pvd")).unwrap();
        let times: Vec<f64> = entries.iter().map(|entry| entry.time).collect();
        assert_eq!(times, [0.0, 40.0 * 1e-4, 80.0 * 1e-4, 100.0 * 1e-4]);
        for entry in entries {
            let file = std::fs::read(folder.path().join("vtk").join(entry.file)).unwrap();
            // Texts are character codes in VTK files; they end with a zero.
            let codes: Vec<String> = FINGERPRINT.bytes().map(|byte| byte.to_string()).collect();
            assert!(String::from_utf8_lossy(&file).contains(&format!(">{} 0<", codes.join(" "))));
        }
    }
}

#[test]
fn what_does_not_exist_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let bodies = [Body { velocity: [1.0, 0.5, 0.0], ..Body::default() }];
    let mut smooth = plan(&bodies, 1000.0, 0.0, 1e-3, 10);
    smooth.rotation = false;
    smooth.dimensions = Dimensions::Two;
    smooth.outputs = vec![
        output("a.dump", OutputKind::LammpsDump, 10),
        output("a.csv", OutputKind::BodySeries(vec![1]), 10),
    ];
    run(smooth, folder.path());
    let text = std::fs::read_to_string(folder.path().join("a.dump")).unwrap();
    assert!(text.contains("ITEM: ATOMS id type radius mass x y z vx vy vz fx fy fz\n"), "{text}");
    let table = granule_formats::csv::read(folder.path().join("a.csv")).unwrap();
    let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["step", "time", "id", "x", "y", "vx", "vy", "fx", "fy"]);
    let x = table.column("x").unwrap();
    // Ten additions round.
    assert!((x[1] - 0.01).abs() <= 10.0 * f64::EPSILON * 0.01, "{x:?}");
}
