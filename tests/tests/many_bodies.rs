//! Several contacts at once: static forces, chains, columns, symmetries and conservation.

use std::fmt::Write as _;

use granule_tests::{BodyState, bodies, driver, run};

/// Case C01: forces and torques on 40 overlapping spheres of different sizes, computed with LAMMPS and independently with
/// numpy; 1e-11 of the largest force and torque. The torques exist for both lever arms, R and R - overlap/2.
#[test]
fn static_forces_on_forty_overlapping_spheres() {
    let data: serde_json::Value =
        serde_json::from_str(include_str!("../data/static-forces-40.json")).unwrap();
    let (state, case) = (&data["state"], &data["cases"][0]);
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let vector = |value: &serde_json::Value| [0, 1, 2].map(|axis| number(&value[axis]));
    let mut list = String::new();
    for i in 0..40 {
        let [x, v, w] = ["x", "v", "omega"].map(|name| vector(&state[name][i]));
        let radius = number(&state["R"][i]);
        let mass = 4.0 * std::f64::consts::PI / 3.0 * radius * radius * radius * number(&state["rho"][i]);
        let _ = writeln!(
            list,
            "Sphere(id: {}, material: \"a\", radius: {radius:?}, mass: {mass:?}, position: ({:?}, {:?}, {:?}), \
             velocity: ({:?}, {:?}, {:?}), spin: ({:?}, {:?}, {:?})),",
            i + 1,
            x[0],
            x[1],
            x[2],
            v[0],
            v[1],
            v[2],
            w[0],
            w[1],
            w[2]
        );
    }
    let (stiffness, damping, friction) = (number(&case["kn"]), number(&case["gamma_n"]), number(&case["mu"]));
    let forces = &case["forces"];
    let largest =
        |of: &serde_json::Value| (0..40).flat_map(|i| vector(&of[i])).map(f64::abs).fold(0.0, f64::max);
    for (arm, torques) in [("HalfOverlap", "torques_arm_R_minus_half_delta"), ("Radius", "torques_arm_R")] {
        let torques = &case[torques];
        let text = format!(
            r#"(version: 1, materials: {{ "a": () }}, allow_overlap: true, bodies: [{list}],
            contacts: [(between: ("a", "a"), contact_end: Overlap,
                normal: LinearSpringDashpot(stiffness: {stiffness}, damping: {damping}),
                tangential: ViscousTangential(damping: {}, friction: {friction}))],
            conventions: (preset: "lammps-granular", pair_torque_arm: {arm}),
            driver: TimeStep(step: 1e-6), run: (steps: 0))"#,
            0.5 * damping
        );
        let bodies = bodies(&driver(&text));
        let (force_scale, torque_scale) = (largest(forces), largest(torques));
        assert!(force_scale > 100.0 && torque_scale > 1.0, "the data have forces and torques");
        for (i, body) in bodies.iter().enumerate() {
            for axis in 0..3 {
                let (force, torque) = (vector(&forces[i])[axis], vector(&torques[i])[axis]);
                let id = i + 1;
                assert!(
                    (body.force[axis] - force).abs() <= 1e-11 * force_scale,
                    "force on {id}: {:?}",
                    body.force
                );
                assert!(
                    (body.torque[axis] - torque).abs() <= 1e-11 * torque_scale,
                    "torque on {id}: {:?}",
                    body.torque
                );
            }
        }
    }
}

/// Case C03: Newton's cradle with linear springs; the chain disperses. Reference integrated with DOP853.
#[test]
fn linear_newtons_cradle() {
    let data: serde_json::Value = serde_json::from_str(include_str!("../data/cradle-linear.json")).unwrap();
    for row in data["rows"].as_array().unwrap() {
        let count = row["N"].as_u64().unwrap() as usize;
        for step in [2e-3, 1e-3] {
            let mut list = String::new();
            for i in 0..count {
                let velocity = if i == 0 { 1.0 } else { 0.0 };
                let _ = write!(
                    list,
                    "Sphere(material: \"a\", mass: 1, radius: 50, position: ({}, 0, 0), velocity: ({velocity}, 0, 0)),",
                    100 * i
                );
            }
            let bodies = run(&format!(
                r#"(version: 1, materials: {{ "a": () }}, bodies: [{list}],
                contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1, damping: 0))],
                driver: TimeStep(step: {step}), run: (duration: {}))"#,
                4 * count + 40
            ));
            for (i, body) in bodies.iter().enumerate() {
                let expected = row["v_final"][i].as_f64().unwrap();
                assert!(
                    (body.velocity[0] - expected).abs() < 1e-4,
                    "N = {count}, bead {i}: {} against {expected}",
                    body.velocity[0]
                );
            }
        }
    }
}

/// A loose cluster of unequal spheres that collide with spin; `transform` may change each body's state.
fn cluster(restitution: f64, friction: f64, transform: impl Fn(&mut [[f64; 3]; 3])) -> String {
    cluster_listed(restitution, friction, "2 us", &ORDER, transform)
}

/// The bodies of the cluster in the order in which they are made.
const ORDER: [u32; 14] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13];

/// The cluster with its bodies listed, and so numbered, in the order `listed`.
fn cluster_listed(
    restitution: f64,
    friction: f64,
    step: &str,
    listed: &[u32; 14],
    transform: impl Fn(&mut [[f64; 3]; 3]),
) -> String {
    let mut list = String::new();
    // Irregular by construction: a body-centred arrangement with golden-ratio offsets, all moving to the centre.
    for &i in listed {
        let turn = f64::from(i) * 2.399_963_229_728_653;
        let height = 1.0 - 2.0 * (f64::from(i) + 0.5) / 14.0;
        let ring = (1.0 - height * height).sqrt();
        let direction = [ring * turn.cos(), ring * turn.sin(), height];
        let radius = 0.008 + 0.002 * (f64::from(i) * 0.618).fract();
        let mut state = [
            direction.map(|component| component * 0.04),
            direction.map(|component| -component * (1.0 + 0.1 * f64::from(i % 3))),
            [10.0 * turn.sin(), 20.0 * height, -15.0 * turn.cos()],
        ];
        transform(&mut state);
        let [x, v, w] = state;
        let _ = writeln!(
            list,
            "Sphere(material: \"a\", radius: {radius:?}, position: ({:?}, {:?}, {:?}), velocity: ({:?}, {:?}, {:?}), \
             spin: ({:?}, {:?}, {:?})),",
            x[0], x[1], x[2], v[0], v[1], v[2], w[0], w[1], w[2]
        );
    }
    format!(
        r#"(version: 1, materials: {{ "a": (density: 2500) }}, impact_speed: 3, bodies: [{list}],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e5, restitution: {restitution}),
            tangential: TangentialSpring(stiffness: 3e4, friction: {friction}))],
        driver: TimeStep(step: "{step}"), run: (duration: "60 ms"))"#
    )
}

fn masses(text: &str) -> Vec<(f64, f64)> {
    let plan = granule_tests::plan(text);
    (0..plan.bodies.len())
        .map(|i| {
            (
                plan.bodies.mass[i],
                plan.bodies.inertia_factor[i] * plan.bodies.mass[i] * plan.bodies.radius[i].powi(2),
            )
        })
        .collect()
}

fn momenta(bodies: &[BodyState], masses: &[(f64, f64)]) -> ([f64; 3], [f64; 3]) {
    let (mut linear, mut angular) = ([0.0; 3], [0.0; 3]);
    for (body, (mass, inertia)) in bodies.iter().zip(masses) {
        let (x, v) = (body.position, body.velocity);
        for k in 0..3 {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            linear[k] += mass * v[k];
            angular[k] += mass * (x[a] * v[b] - x[b] * v[a]) + inertia * body.spin[k];
        }
    }
    (linear, angular)
}

/// Case C06: with the physical conventions an isolated cluster keeps linear momentum, and angular momentum up to the
/// rotation of the lever arm within a step: torque and force are exactly opposite at every evaluation, and what is left
/// is round-off of 3e4 steps.
#[test]
fn momentum_is_conserved() {
    for (step, steps) in [("2 us", 30_000), ("1 us", 60_000)] {
        let text = cluster_listed(0.8, 0.5, step, &ORDER, |_| {});
        let masses = masses(&text);
        let mut driver = driver(&text);
        let before = momenta(&bodies(&driver), &masses);
        granule_tests::advance(&mut driver, steps);
        let after = momenta(&bodies(&driver), &masses);
        let scale: f64 = masses.iter().map(|(mass, _)| mass).sum::<f64>();
        for k in 0..3 {
            assert!((after.0[k] - before.0[k]).abs() < 1e-12 * scale, "linear momentum {k}, {step}");
            assert!(
                (after.1[k] - before.1[k]).abs() < 1e-12 * scale * 0.04,
                "angular momentum {k}, {step}: {:?} {:?}",
                before.1,
                after.1
            );
        }
    }
}

/// Case C08: a boost, a rotation and a renumbering of the bodies give the same physics. Sensitivity to round-off grows
/// with each collision; 24 milliseconds hold two or three collisions a body, which leaves 1e-9.
#[test]
fn physics_does_not_depend_on_the_frame_or_the_numbering() {
    const SHUFFLED: [u32; 14] = [9, 2, 13, 0, 6, 11, 4, 1, 12, 8, 3, 10, 5, 7];
    let (sine, cosine) = 37.7_f64.to_radians().sin_cos();
    let rotate = |v: [f64; 3]| [cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1], v[2]];
    for (step, steps) in [("2 us", 12_000), ("1 us", 24_000)] {
        let at = |listed: &[u32; 14], transform: &dyn Fn(&mut [[f64; 3]; 3])| {
            let mut driver = driver(&cluster_listed(0.8, 0.5, step, listed, transform));
            granule_tests::advance(&mut driver, steps);
            bodies(&driver)
        };
        let plain = at(&ORDER, &|_| {});
        assert!(plain.iter().any(|body| body.velocity[2].abs() > 0.05), "bodies have collided");
        let boosted = at(&ORDER, &|state| state[1][0] += 1e3);
        let rotated = at(&ORDER, &|state| *state = state.map(rotate));
        let renumbered = at(&SHUFFLED, &|_| {});
        for (i, body) in plain.iter().enumerate() {
            let turned = rotate(body.velocity);
            let place = SHUFFLED.iter().position(|&each| each as usize == i).expect("a permutation");
            let same = &renumbered[place];
            for k in 0..3 {
                let boost = if k == 0 { 1e3 } else { 0.0 };
                // The boost costs digits: positions of 24 m against overlaps of 1e-5 m leave 4e-15/1e-5 of the force.
                assert!(
                    (boosted[i].velocity[k] - boost - body.velocity[k]).abs() < 1e-6,
                    "boost, body {i}, {step}"
                );
                assert!((rotated[i].velocity[k] - turned[k]).abs() < 1e-9, "rotation, body {i}, {step}");
                assert!(
                    (same.velocity[k] - body.velocity[k]).abs() < 1e-9,
                    "renumbering, body {i}, {step}: {same:?} {body:?}"
                );
                assert!(
                    (same.spin[k] - body.spin[k]).abs() < 1e-9 / 0.008,
                    "renumbering, spin of body {i}, {step}"
                );
            }
        }
    }
}

/// Case C08, time reversal: an elastic frictionless cluster run backwards returns to where it came from, to 1e-6 of its
/// size: the scheme is reversible, what is lost is round-off that the collisions amplify.
#[test]
fn elastic_collisions_can_be_undone() {
    let forward = cluster(1.0, 0.5, |_| {})
        .replace(", tangential: TangentialSpring(stiffness: 3e4, friction: 0.5)", "");
    let smooth = forward
        .replace("tangential: TangentialSpring(stiffness: 3e4, friction: 0.5)", "")
        .replace("2 us", "1 us");
    let mut driver = driver(&smooth);
    let start = bodies(&driver);
    granule_tests::advance(&mut driver, 25_000);
    let turned = bodies(&driver);
    let plan = driver.engine().plan().clone();
    let mut list = String::new();
    for (i, body) in turned.iter().enumerate() {
        let (x, v) = (body.position, body.velocity.map(|component| -component));
        let _ = writeln!(
            list,
            "Sphere(material: \"a\", radius: {:?}, position: ({:?}, {:?}, {:?}), velocity: ({:?}, {:?}, {:?})),",
            plan.bodies.radius[i], x[0], x[1], x[2], v[0], v[1], v[2]
        );
    }
    let back = format!(
        r#"(version: 1, materials: {{ "a": (density: 2500) }}, impact_speed: 3, allow_overlap: true, bodies: [{list}],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e5, restitution: 1))],
        driver: TimeStep(step: "1 us"), run: (steps: 25000))"#
    );
    let returned = run(&back);
    for (before, after) in start.iter().zip(&returned) {
        for k in 0..3 {
            assert!((before.position[k] - after.position[k]).abs() < 1e-6 * 0.04, "{before:?} {after:?}");
        }
    }
}

/// Case C10: static column of 1000 spheres. Overlap i is (N - i) m g / k; started from the analytic state it must stay
/// there, bottom force and total compression within 0.1 %.
#[test]
fn static_column_of_a_thousand_spheres() {
    let (count, stiffness, mass, gravity, radius) = (1000_u32, 1e6, 1e-3, 9.81, 5e-3);
    let mut list = String::new();
    let mut height = 0.0;
    for i in 0..count {
        let overlap = f64::from(count - i) * mass * gravity / stiffness;
        height += if i == 0 { radius } else { 2.0 * radius } - overlap;
        let _ = writeln!(
            list,
            "Sphere(material: \"a\", mass: {mass}, radius: {radius}, position: (0, 0, {height:?})),"
        );
    }
    let text = format!(
        r#"(version: 1, gravity: (0, 0, -{gravity}), materials: {{ "a": () }}, impact_speed: 0.01, allow_overlap: true,
        bodies: [{list}],
        walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: {stiffness}, restitution: 0.5))],
        driver: TimeStep(step: "1 us"), run: (steps: 20000))"#
    );
    let start: Vec<f64> = bodies(&driver(&text)).iter().map(|body| body.position[2]).collect();
    let bodies = run(&text);
    let overlap = radius - bodies[0].position[2];
    assert!((overlap / 9.81e-6 - 1.0).abs() < 1e-3, "bottom overlap {overlap}");
    let compression = (2.0 * f64::from(count) - 1.0) * radius - bodies[999].position[2];
    assert!((compression / 4.909905e-3 - 1.0).abs() < 1e-3, "total compression {compression}");
    for (body, start) in bodies.iter().zip(start) {
        assert!((body.position[2] - start).abs() < 1e-9, "moved by {}", body.position[2] - start);
        assert_eq!(body.position[0], 0.0, "no buckling: the column is exactly straight");
    }
}
