//! What each contact does, as the output `Contacts` tells it.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use granule_drivers::{Driver, TimeStepDriver};
use granule_formats::csv::{self, Table};
use granule_observers::{Observers, Provenance};
use granule_tests::plan;

/// Runs a scene with its outputs.
fn run(text: &str, folder: &Path) -> u64 {
    let plan = plan(text);
    let provenance = Provenance::new("0", "0", 0).unwrap();
    let mut observers = Observers::from_plan(&plan, folder, &provenance).unwrap();
    let mut driver = TimeStepDriver::new(plan.clone(), Some(2)).unwrap();
    observers.start(&driver.view()).unwrap();
    while driver.step() < plan.driver.steps {
        let next = observers.next_due(driver.step()).unwrap_or(plan.driver.steps).min(plan.driver.steps);
        driver.advance(next, &AtomicBool::new(false)).unwrap();
        observers.observe(&driver.view()).unwrap();
    }
    observers.finish(&driver.view()).unwrap();
    driver.result_hash()
}

fn table(folder: &Path, name: &str) -> Table {
    csv::read(folder.join(name)).unwrap()
}

fn value(table: &Table, name: &str, row: usize) -> f64 {
    table.column(name).unwrap_or_else(|| panic!("no column {name}"))[row]
}

fn vector(table: &Table, names: [&str; 3], row: usize) -> [f64; 3] {
    names.map(|name| value(table, name, row))
}

const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
const TANGENTIAL: [&str; 3] = ["ftx", "fty", "ftz"];
const TORQUE: [&str; 3] = ["tqx", "tqy", "tqz"];

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A heap that falls into a box, with two sizes, in a cell that is periodic along y.
fn heap(outputs: &str, arithmetic: &str) -> String {
    format!(
        r#"(version: 1, gravity: (0, 0, -9.81), materials: {{ "a": (density: 2500) }},
        bodies: [
            Lattice(material: "a", radius: "1 mm", kind: Cubic, spacing: "2.6 mm", lo: (0.0015, 0.0014, 0.0012), hi: (0.0095, 0.0091, 0.0066),
                jitter: 2e-4, velocity_spread: 0.3),
            Sphere(material: "a", radius: "1.7 mm", position: (0.005, 0.005, 0.0105), velocity: (0.1, 0, -0.5), spin: (20, 0, 9)),
        ],
        cell: (lo: (-1, 0, -1), hi: (1, 0.0105, 1), periodic: (false, true, false)),
        walls: {{
            "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a"),
            "left": Plane(point: (0, 0, 0), normal: (1, 0, 0), material: "a"),
            "right": Plane(point: (0.011, 0, 0), normal: (-1, 0, 0), material: "a"),
        }},
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(restitution: 0.6, contact_duration: "0.2 ms"),
            tangential: TangentialSpring(stiffness_ratio: 0.3, friction: 0.4))],
        driver: TimeStep(step: "4 us"{arithmetic}), run: (duration: "60 ms"), {outputs})"#
    )
}

/// The forces and torques of all contacts of a body, with its weight, are those on the body, at every entry.
#[test]
fn forces_of_contacts_add_up_to_those_on_bodies() {
    let ids: Vec<String> = (1..=37).map(|id| id.to_string()).collect();
    let outputs = format!(
        r#"outputs: [Contacts(path: "contacts.csv", every: 300), Bodies(path: "bodies.csv", every: 300, ids: [{}])]"#,
        ids.join(", ")
    );
    let folder = tempfile::tempdir().unwrap();
    let seen = run(&heap(&outputs, ""), folder.path());
    // Looking at contacts changes nothing.
    let other = tempfile::tempdir().unwrap();
    assert_eq!(seen, run(&heap("outputs: []", ""), other.path()));

    let (contacts, bodies) = (table(folder.path(), "contacts.csv"), table(folder.path(), "bodies.csv"));
    assert!(contacts.rows() > 150, "{} contacts", contacts.rows());
    let (mut with_walls, mut slid) = (0, 0);
    for row in 0..bodies.rows() {
        let (step, id) = (value(&bodies, "step", row), value(&bodies, "id", row));
        let radius = if id == 37.0 { 1.7e-3 } else { 1e-3_f64 };
        let mass = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * 2500.0;
        let (mut force, mut torque) = ([0.0, 0.0, -9.81 * mass], [0.0; 3]);
        let mut scale = 9.81 * mass;
        for k in 0..contacts.rows() {
            if value(&contacts, "step", k) != step {
                continue;
            }
            let first = value(&contacts, "id", k) == id;
            if !first && value(&contacts, "partner", k) != id {
                continue;
            }
            let is_wall = value(&contacts, "partner", k) < 0.0;
            assert_eq!(is_wall, value(&contacts, "wall", k) >= 0.0);
            assert!(is_wall || value(&contacts, "id", k) < value(&contacts, "partner", k));
            let (n, f) = (vector(&contacts, NORMAL, k), vector(&contacts, TANGENTIAL, k));
            let push = value(&contacts, "normal_force", k);
            let size = f.iter().map(|c| c * c).sum::<f64>().sqrt();
            assert!(size <= 0.4 * push.abs() * (1.0 + 1e-12), "{size} {push}");
            assert_eq!(vector(&contacts, TORQUE, k), [0.0; 3]);
            with_walls += usize::from(is_wall);
            slid += usize::from(size > 0.399 * push && push > 0.0);
            let turned = cross(n, f);
            // Both lever arms are shorter by half of the overlap, and the same side of the law acts on both.
            let arm = radius - 0.5 * value(&contacts, "overlap", k);
            for axis in 0..3 {
                force[axis] += (push * n[axis] + f[axis]) * if first { 1.0 } else { -1.0 };
                torque[axis] -= arm * turned[axis];
            }
            scale += push.abs();
        }
        // Sums of up to ten numbers of that size in another order.
        for (axis, (f, tq)) in [("fx", "tqx"), ("fy", "tqy"), ("fz", "tqz")].into_iter().enumerate() {
            assert!((force[axis] - value(&bodies, f, row)).abs() < 1e-13 * scale, "{step} {id} {f}");
            assert!(
                (torque[axis] - value(&bodies, tq, row)).abs() < 1e-13 * scale * radius,
                "{step} {id} {tq}"
            );
        }
    }
    assert!(with_walls > 100 && slid > 10, "{with_walls} {slid}");
}

/// Accelerations by collision, Kondic 1999, Eqs. (2), (4), (6) to (8) and (10): along the normal, in the plane, and what the
/// rolling of the other one does to the spin when no surface holds it (erratum K-E37).
#[test]
fn accelerations_by_collision_come_from_each_kind_of_force() {
    let (stiffness, normal_rate, shear_rate, radius): (f64, f64, f64, f64) = (4e6, 1e4, 5e3, 2e-3);
    let mass = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * 7850.0;
    let text = format!(
        r#"(version: 1, materials: {{ "steel": (density: 7850) }},
        bodies: [
            Sphere(material: "steel", radius: {radius}, position: (0.001988835, 0.0003, 0.002)),
            Sphere(material: "steel", radius: {radius}, position: (-0.002, 0, 0.002), velocity: (0.1, 0.02, 0), spin: (-10, 50, 4)),
        ],
        contacts: [(between: ("steel", "steel"), contact_end: Overlap,
            normal: KondicNormal(force_constant: {stiffness}, damping_rate: {normal_rate}),
            tangential: KondicFriction(damping_rate: {shear_rate}, shear_friction: inf, vertical_friction: inf))],
        driver: TimeStep(step: 1e-9), run: (duration: 30e-6),
        outputs: [Contacts(path: "contacts.csv", every: 1), Bodies(path: "bodies.csv", every: 1, ids: [1, 2])])"#
    );
    let folder = tempfile::tempdir().unwrap();
    run(&text, folder.path());
    let (contacts, bodies) = (table(folder.path(), "contacts.csv"), table(folder.path(), "bodies.csv"));
    let (reduced, inertia) = (0.5 * mass, 0.4 * mass * radius * radius);
    let duration = contacts.rows();
    assert!(duration > 15_000, "a contact of 15000 steps and more: {duration}");
    let (largest_push, largest_slip) = (stiffness * 0.1 * 1e-5, reduced * shear_rate * 0.1);
    let mut seen = 0;
    for k in (duration / 20..duration * 19 / 20).step_by(duration / 10) {
        let first = 2 * value(&contacts, "step", k) as usize;
        let state = |body: usize, names| vector(&bodies, names, first + body);
        let difference = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|axis| a[axis] - b[axis]);
        let v = difference(state(0, ["vx", "vy", "vz"]), state(1, ["vx", "vy", "vz"]));
        let spins = [0, 1].map(|body| state(body, ["omegax", "omegay", "omegaz"]));
        let n = vector(&contacts, NORMAL, k);
        let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();

        // Eq. (2), and with Eqs. (3) and (4) the slip in the plane: s = k x n.
        let push = stiffness * value(&contacts, "overlap", k) - normal_rate * reduced * dot(v, n);
        // Velocities change by 1e-4 of themselves in a step.
        assert!((push - value(&contacts, "normal_force", k)).abs() < 1e-3 * largest_push);
        let across = (n[0] * n[0] + n[1] * n[1]).sqrt();
        let s = [-n[1] / across, n[0] / across, 0.0];
        let arm = radius - 0.5 * value(&contacts, "overlap", k);
        let rolling = [0, 1, 2].map(|axis| arm * (spins[0][axis] + spins[1][axis]));
        let slip = difference(v, cross(rolling, n));
        let force = vector(&contacts, TANGENTIAL, k);
        let shear = -shear_rate * reduced * dot(slip, s);
        assert!((dot(force, s) - shear).abs() < 1e-3 * largest_slip, "{} {shear}", dot(force, s));
        // Eq. (6): the vertical force by the spins that roll along the normal.
        let vertical = -shear_rate * reduced * slip[2];
        assert!((force[2] - vertical).abs() < 1e-3 * largest_slip, "{} {vertical}", force[2]);

        // Eq. (10): both linear accelerations, and R² F_R/I for the spin that would roll along the normal.
        let acting = state(0, ["fx", "fy", "fz"]);
        for axis in 0..3 {
            let sum = value(&contacts, "normal_force", k) * n[axis] + force[axis];
            assert!((acting[axis] - sum).abs() < 1e-12 * largest_push, "{} {sum}", acting[axis]);
        }
        let spin = |row: usize| dot(vector(&bodies, ["omegax", "omegay", "omegaz"], row), s);
        let accelerated = radius * (spin(first + 2) - spin(first - 2)) / 2e-9;
        let expected = radius * arm * force[2] / inertia;
        // R dω/dt = ± R² F_R/I: n x k = -s. The difference of two spins of 50 1/s over two steps has lost 9 digits.
        assert!(
            (accelerated - expected).abs() < 1e-3 * (radius * arm * largest_slip / inertia),
            "{accelerated} {expected}"
        );
        seen += 1;
    }
    assert!(seen >= 9, "{seen}");
}

#[test]
fn hard_bodies_have_no_contacts_to_show() {
    let text = r#"(version: 1, materials: { "a": (density: 2500) }, bodies: [Sphere(material: "a", radius: 1, position: (0, 0, 0))],
        contacts: [(between: ("a", "a"), collision: HardSphere(restitution: 0.9))], driver: Event(step: 1.0), run: (duration: 1.0),
        outputs: [Contacts(path: "contacts.csv")])"#;
    let parsed = granule_scene::parse(text);
    let registry = granule_law_api::Registry::collect().unwrap();
    let (_, problems) = granule_plan::build(&parsed.scene.unwrap(), &registry, Path::new("."));
    assert!(problems[0].render("scene", text).contains("no contacts that last, so no `Contacts`"));
}
