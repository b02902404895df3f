//! Columns of time series against numbers worked out by hand.

mod support;

use granule_drivers::Driver;
use granule_formats::csv;
use granule_geometry::Cell;
use granule_plan::{OutputKind, SERIES};
use support::{Body, output, plan, run};

fn all_columns() -> OutputKind {
    OutputKind::Series(SERIES.iter().map(|(name, _, _)| (*name).to_string()).collect())
}

fn two_bodies() -> [Body; 2] {
    let a = Body {
        mass: 2.0,
        position: [0.0, 0.0, 1.0],
        velocity: [1.0, 0.0, 0.0],
        spin: [0.0, 0.0, 3.0],
        ..Body::default()
    };
    let b = Body {
        mass: 3.0,
        radius: 0.25,
        position: [0.74, 0.0, 1.0],
        velocity: [-1.0, 2.0, 0.0],
        ..Body::default()
    };
    [a, b]
}

#[test]
fn the_first_row_is_what_the_scene_says() {
    let folder = tempfile::tempdir().unwrap();
    let mut plan = plan(&two_bodies(), 1000.0, 0.5, 1e-4, 0);
    plan.gravity = [0.0, 0.0, -10.0];
    plan.outputs = vec![output("all.csv", all_columns(), 1)];
    run(plan, folder.path());
    let table = csv::read(folder.path().join("all.csv")).unwrap();
    let expected = [
        ("kinetic_energy", 0.5 * 2.0 + 0.5 * 3.0 * 5.0),
        ("rotational_energy", 0.5 * (0.4 * 2.0 * 0.25) * 9.0),
        ("elastic_energy", 0.5 * 1000.0 * 0.01 * 0.01),
        ("gravity_energy", 50.0),
        ("dissipated_viscous", 0.0),
        ("dissipated_friction", 0.0),
        ("wall_work", 0.0),
        ("energy_residual", 0.0),
        ("momentum_x", -1.0),
        ("momentum_y", 6.0),
        ("momentum_z", 0.0),
        ("contacts", 1.0),
        ("coordination_number", 1.0),
        ("mean_height", 1.0),
        ("maximum_height", 1.0),
        // Centres 0.5 above the lowest point and 0.37 from the vertical through their mean.
        ("repose_angle", (2.0 * 0.5 / 0.37f64).atan()),
        ("maximum_overlap", 0.01),
        ("maximum_speed", 5.0f64.sqrt()),
        ("collisions", 0.0),
        ("overlapping_collisions", 0.0),
    ];
    assert_eq!(table.rows(), 1);
    assert_eq!(table.columns.len(), 2 + expected.len());
    for (name, value) in expected {
        let found = table.column(name).unwrap()[0];
        // The overlap is the difference of numbers near 0.75: relative error 0.75/0.01 rounding units, twice in a square.
        let tolerance = 4.0 * 75.0 * f64::EPSILON * value.abs();
        assert!((found - value).abs() <= tolerance, "{name}: {found}, expected {value}");
    }
}

#[test]
fn a_damped_impact_follows_its_closed_form() {
    let (stiffness, damping) = (1000.0, 4.0);
    let (m1, m2): (f64, f64) = (2.0, 3.0);
    let reduced = m1 * m2 / (m1 + m2);
    let eta = damping / (2.0 * reduced);
    let omega = (stiffness / reduced - eta * eta).sqrt();
    let contact = std::f64::consts::PI / omega;
    let speed = 2.0;
    let body =
        |mass, x, v| Body { mass, position: [x, 0.0, 0.0], velocity: [v, 0.0, 0.0], ..Body::default() };
    // They touch after the first tenth of the run and part before its end.
    let bodies = [body(m1, 0.0, speed), body(m2, 1.0 + 0.1 * contact * speed, 0.0)];
    let steps = 1500;
    let step = 1.5 * contact / steps as f64;
    let mut plan = plan(&bodies, stiffness, damping, step, steps);
    plan.outputs = vec![output("all.csv", all_columns(), 1)];
    let folder = tempfile::tempdir().unwrap();
    run(plan, folder.path());
    let table = csv::read(folder.path().join("all.csv")).unwrap();
    let column = |name: &str| table.column(name).unwrap();
    let energy = 0.5 * reduced * speed * speed;
    let of_centre = 0.5 * (m1 * speed).powi(2) / (m1 + m2);
    // The closed form begins at the moment of touch; the scheme notices it up to a step late: error eta dt in the velocity
    // that the damper sees, omega dt in the overlap, each relative to the impact, and second-order terms below them.
    let tolerance = 2.0 * omega * step * energy;
    for row in 0..table.rows() {
        let t = (column("time")[row] - 0.1 * contact).max(0.0).min(contact);
        let decay = (-eta * t).exp();
        let overlap = speed / omega * decay * (omega * t).sin();
        let velocity = speed * decay * ((omega * t).cos() - eta / omega * (omega * t).sin());
        let (kinetic, elastic) =
            (0.5 * reduced * velocity * velocity + of_centre, 0.5 * stiffness * overlap * overlap);
        let close = |name: &str, value: f64| {
            let found = column(name)[row];
            assert!((found - value).abs() <= tolerance, "{name}, row {row}: {found}, expected {value}");
        };
        close("kinetic_energy", kinetic);
        close("elastic_energy", elastic);
        close("dissipated_viscous", energy + of_centre - kinetic - elastic);
        close("energy_residual", 0.0);
        // Both bodies get the same force with opposite signs, and 1500 sums round.
        assert!((column("momentum_x")[row] - m1 * speed).abs() < 1500.0 * f64::EPSILON * m1 * speed);
    }
    let touching = column("contacts").iter().filter(|contacts| **contacts == 1.0).count();
    assert!((touching as f64 - contact / step).abs() <= 2.0, "{touching} steps in contact");
}

#[test]
fn the_residual_of_the_ledger_falls_with_the_square_of_the_step() {
    let residual = |steps: u64| {
        // Already overlapping, so that no step straddles the beginning or end of the contact.
        let bodies = [
            Body { velocity: [1.0, 0.0, 0.0], ..Body::default() },
            Body { position: [0.8, 0.0, 0.0], ..Body::default() },
        ];
        let mut plan = plan(&bodies, 1000.0, 2.0, 0.02 / steps as f64, steps);
        plan.outputs = vec![output("r.csv", OutputKind::Series(vec!["energy_residual".into()]), u64::MAX)];
        let folder = tempfile::tempdir().unwrap();
        run(plan, folder.path());
        let table = csv::read(folder.path().join("r.csv")).unwrap();
        assert_eq!(table.rows(), 2);
        table.column("energy_residual").unwrap()[1]
    };
    let (coarse, fine) = (residual(200), residual(400));
    // The next term of the expansion is smaller by omega dt = 0.0045.
    assert!((coarse / fine - 4.0).abs() < 0.05, "{coarse} over {fine}");
}

#[test]
fn energy_of_gravity_does_not_jump_at_a_periodic_boundary() {
    let body = Body { mass: 3.0, position: [0.5, 0.5, 0.9], velocity: [0.7, 0.0, 0.0], ..Body::default() };
    let (g, step, steps) = (9.81, 1e-3, 4000);
    let mut plan = plan(&[body], 1000.0, 0.0, step, steps);
    plan.gravity = [0.0, 0.0, -g];
    plan.cell = Cell::new([0.0; 3], [4.0; 3], [true; 3]).unwrap();
    plan.outputs = vec![
        output("all.csv", all_columns(), 100),
        output("body.csv", OutputKind::BodySeries(vec![1]), 100),
        output("last.dump", OutputKind::LammpsDump, steps),
    ];
    let folder = tempfile::tempdir().unwrap();
    let driver = run(plan, folder.path());
    let table = csv::read(folder.path().join("all.csv")).unwrap();
    let body = csv::read(folder.path().join("body.csv")).unwrap();
    for row in 0..table.rows() {
        let t = table.column("time").unwrap()[row];
        let height = 0.9 - 0.5 * g * t * t;
        // 4000 steps add up rounding errors at the size of the fall, 78 m, and of its energy, 2.3 kJ.
        let round = 4000.0 * f64::EPSILON;
        assert!((table.column("mean_height").unwrap()[row] - height).abs() < 78.0 * round);
        assert!((table.column("gravity_energy").unwrap()[row] - 3.0 * g * height).abs() < 2300.0 * round);
        assert!(table.column("energy_residual").unwrap()[row].abs() < 2300.0 * round);
        assert!((body.column("z").unwrap()[row] - height).abs() < 78.0 * round);
        assert!((body.column("x").unwrap()[row] - (0.5 + 0.7 * t)).abs() < 4.0 * round);
    }
    let wrapped = driver.view().position(0);
    assert!(wrapped.iter().all(|x| (0.0..4.0).contains(x)));
}

#[test]
fn frozen_bodies_are_boundary() {
    let bodies = [
        Body { frozen: true, mass: 7.0, position: [0.0, 0.0, -5.0], ..Body::default() },
        Body { mass: 2.0, position: [0.0, 0.0, 3.0], velocity: [1.0, 0.0, 0.0], ..Body::default() },
    ];
    let mut plan = plan(&bodies, 1000.0, 0.0, 1e-3, 0);
    plan.gravity = [0.0, 0.0, -10.0];
    plan.outputs = vec![output("all.csv", all_columns(), 1)];
    let folder = tempfile::tempdir().unwrap();
    run(plan, folder.path());
    let table = csv::read(folder.path().join("all.csv")).unwrap();
    assert_eq!(table.column("gravity_energy").unwrap(), [60.0]);
    assert_eq!(table.column("mean_height").unwrap(), [3.0]);
    assert_eq!(table.column("momentum_x").unwrap(), [2.0]);
}

#[test]
fn entries_lie_on_multiples_of_the_interval_and_at_the_end() {
    let mut plan = plan(&two_bodies(), 1000.0, 0.5, 1e-4, 20);
    let columns = || OutputKind::Series(vec!["contacts".into()]);
    plan.outputs = vec![output("a.csv", columns(), 7), output("deep/er/b.csv", columns(), 10)];
    let folder = tempfile::tempdir().unwrap();
    run(plan, folder.path());
    let steps = |name: &str| csv::read(folder.path().join(name)).unwrap().column("step").unwrap().to_vec();
    assert_eq!(steps("a.csv"), [0.0, 7.0, 14.0, 20.0]);
    assert_eq!(steps("deep/er/b.csv"), [0.0, 10.0, 20.0]);
    let text = std::fs::read_to_string(folder.path().join("a.csv")).unwrap();
    assert!(text.starts_with("# granule 0.1.0 plan=0123456789abcdef0123456789abcdef created=1764000000\n"));
}

#[test]
fn output_changes_no_bit_of_the_result() {
    let make = || plan(&two_bodies(), 1000.0, 0.5, 1e-4, 500);
    let folder = tempfile::tempdir().unwrap();
    let silent = run(make(), folder.path());
    let mut loud = make();
    loud.outputs = vec![
        output("all.csv", all_columns(), 1),
        output("body.csv", OutputKind::BodySeries(vec![2, 1]), 3),
        output("a.dump", OutputKind::LammpsDump, 7),
        output("v", OutputKind::Vtk { compressed: true }, 50),
        output("end.data", OutputKind::LammpsData, 11),
    ];
    let loud = run(loud, folder.path());
    assert_eq!(silent.result_hash(), loud.result_hash());
    for place in 0..2 {
        let force = |driver: &granule_drivers::TimeStepDriver| driver.view().bodies().force_of(place);
        assert_eq!(force(&silent).map(f64::to_bits), force(&loud).map(f64::to_bits));
    }
}

#[test]
fn the_angle_of_a_heap_is_that_of_its_cone() {
    // Cells of a grid of spacing 1 whose centres lie in cones of radius 15: the outermost ring is missing or not, 1/30 of the radius.
    for slope in [0.4, 1.0] {
        let mut bodies = Vec::new();
        for (x, y) in (-15..=15).flat_map(|x| (-15..=15).map(move |y| (f64::from(x), f64::from(y)))) {
            let height = slope * (15.0 - f64::hypot(x, y));
            let layers = height.max(0.0).round() as u32;
            bodies.extend((0..layers).map(|layer| Body {
                radius: 0.5,
                position: [100.0 + x, y, 7.0 + f64::from(layer)],
                ..Body::default()
            }));
        }
        let mut plan = plan(&bodies, 1000.0, 0.0, 1e-3, 0);
        plan.gravity = [0.0, 0.0, -10.0];
        plan.outputs = vec![output("all.csv", OutputKind::Series(vec!["repose_angle".into()]), 1)];
        let folder = tempfile::tempdir().unwrap();
        run(plan, folder.path());
        let angle = csv::read(folder.path().join("all.csv")).unwrap().column("repose_angle").unwrap()[0];
        assert!((angle.tan() / slope - 1.0).abs() < 1.0 / 30.0, "{} for {slope}", angle.tan());
    }
}
