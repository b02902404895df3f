//! Dimensions, precision, frozen bodies, moving walls and the energy ledger: each mode of the engine against another that
//! must agree with it, or against a closed form.

use granule_drivers::Driver;
use granule_plan::{Dimensions, Precision, Search};
use granule_tests::{BodyState, advance, bodies, driver, plan, run};

/// Ten discs that collide in the plane, as a scene of two or of three dimensions.
fn discs(planar: bool) -> String {
    let mut list = String::new();
    for i in 0..10u32 {
        let turn = f64::from(i) * std::f64::consts::TAU / 10.0;
        let (x, y) = (0.05 * turn.cos(), 0.05 * turn.sin());
        let speed = 1.0 + 0.1 * f64::from(i % 3);
        let (z, spin) = if planar { ("", "7".to_string()) } else { (", 0", "(0, 0, 7)".to_string()) };
        list += &format!(
            "Body(material: \"a\", mass: 0.01, radius: {:?}, inertia_factor: 0.5, position: ({x:?}, {y:?}{z}), \
             velocity: ({:?}, {:?}{z}), spin: {spin}),\n",
            0.008 + 0.001 * f64::from(i % 4),
            -speed * turn.cos(),
            -speed * turn.sin(),
        );
    }
    format!(
        r#"(version: 1, dimensions: {}, impact_speed: 3, materials: {{ "a": () }}, bodies: [{list}],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e5, restitution: 0.8),
            tangential: TangentialSpring(stiffness: 3e4, friction: 0.5))],
        driver: TimeStep(step: "5 us"), run: (duration: "60 ms"))"#,
        if planar { 2 } else { 3 }
    )
}

fn largest_difference(a: &[BodyState], b: &[BodyState], of: impl Fn(&BodyState) -> [f64; 3]) -> f64 {
    a.iter()
        .zip(b)
        .flat_map(|(a, b)| (0..3).map(|k| (of(a)[k] - of(b)[k]).abs()).collect::<Vec<_>>())
        .fold(0.0, f64::max)
}

/// Plane motion has no third dimension in memory, and the same physics.
#[test]
fn the_plane_is_three_dimensions_without_the_third() {
    let (plane, space) = (discs(true), discs(false));
    assert_eq!(plan(&plane).dimensions, Dimensions::Two);
    let (flat, full) = (driver(&plane), driver(&space));
    let bytes = |driver: &granule_drivers::TimeStepDriver| driver.engine().bodies().layout().bytes_per_body();
    assert!(bytes(&flat) + 64 <= bytes(&full), "{} against {}", bytes(&flat), bytes(&full));
    let (a, b) = (run(&plane), run(&space));
    assert!(a.iter().any(|body| (body.spin[2] - 7.0).abs() > 1.0), "friction has acted");
    // The same operations in another grouping: round-off, amplified by a few collisions a body.
    assert!(largest_difference(&a, &b, |body| body.velocity) < 1e-9);
    assert!(largest_difference(&a, &b, |body| body.spin) < 1e-6);
}

/// Single-precision stages see relative quantities, so one impact is good to the rounding of `f32`, 6e-8, times the steps
/// of the contact, 60.
#[test]
fn single_precision_costs_what_its_rounding_costs() {
    let text = |precision: &str| {
        format!(
            r#"(version: 1, precision: {precision}, materials: {{ "a": (density: 2500) }},
            bodies: [
                Sphere(material: "a", radius: 0.01, position: (100, 0, 0), velocity: (1, 0.3, 0), spin: (0, 5, 9)),
                Sphere(material: "a", radius: 0.01, position: (100.0201, 0, 0), velocity: (-1, 0, 0.1)),
            ],
            contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e5, restitution: 0.8),
                tangential: TangentialSpring(stiffness: 3e4, friction: 0.5))],
            run: (duration: "3 ms"))"#
        )
    };
    assert_eq!(plan(&text("Single")).precision, Precision::Single);
    let (single, double) = (run(&text("Single")), run(&text("Double")));
    let error = largest_difference(&single, &double, |body| body.velocity);
    assert!(error > 0.0, "single precision is in use");
    assert!(error < 4e-6, "error {error} m/s of 2 m/s");
}

/// Frictionless smooth spheres have no spins, torques or histories.
#[test]
fn only_what_the_scene_requires_exists() {
    let text = r#"(version: 1, materials: { "a": (density: 2500) },
        bodies: [Lattice(material: "a", radius: "1 mm", spacing: "3 mm", lo: (0, 0, 0), hi: (0.03, 0.03, 0.03),
            velocity_spread: 1)],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.9))],
        run: (duration: "1 ms"))"#;
    let plan = plan(text);
    assert!(!plan.rotation && !plan.ledger && plan.walls.is_empty());
    assert_eq!(plan.driver.search, Search::Grid);
    assert!(plan.compositions.iter().all(|composition| composition.history_width == 0));
    let driver = driver(text);
    let rows = driver.engine().bodies();
    assert!(rows.spin.is_empty() && rows.torque.is_empty() && rows.previous_angular_acceleration.is_empty());
}

/// A frozen sphere is a wall: it never moves, and what hits it rebounds as from an infinite mass.
#[test]
fn frozen_bodies_never_move() {
    let bodies = run(r#"(version: 1, gravity: (0, 0, -9.81), materials: { "a": (density: 2500) },
        bodies: [
            Sphere(material: "a", radius: 0.01, position: (0, 0, 0), frozen: true),
            Sphere(material: "a", radius: 0.01, position: (0, 0, 0.0205), velocity: (0, 0, -2)),
        ],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e7, damping: 0))],
        driver: TimeStep(step: Auto(steps_per_contact: 400)), run: (duration: "1 ms"))"#);
    assert_eq!(bodies[0].position, [0.0; 3]);
    assert_eq!(bodies[0].velocity, [0.0; 3]);
    // Gravity over a millisecond moves the speed by 0.01 m/s, there and back.
    assert!((bodies[1].velocity[2] - 2.0).abs() < 0.02, "{}", bodies[1].velocity[2]);
}

/// An elastic ball that meets a wall moving at V leaves with 2 V - v; the ledger books the work of the wall, and what it
/// cannot account for is the error of the integration, which falls as the square of the step.
#[test]
fn a_moving_wall_does_work() {
    let text = |steps: u32| {
        format!(
            r#"(version: 1, ledger: true, materials: {{ "a": () }},
            bodies: [Sphere(material: "a", mass: 2, radius: 0.01, position: (0, 0, 0.0101), velocity: (0, 0, -1))],
            walls: {{ "piston": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a",
                motion: Constant(velocity: (0, 0, 0.5))) }},
            contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e7, damping: 0))],
            driver: TimeStep(step: Auto(steps_per_contact: {steps})), run: (duration: "3 ms"))"#
        )
    };
    let mut residuals = Vec::new();
    for steps in [100, 200] {
        let mut driver = driver(&text(steps));
        let last = driver.engine().plan().driver.steps;
        advance(&mut driver, last);
        let speed = bodies(&driver)[0].velocity[2];
        assert!((speed - 2.0).abs() < 1e-3, "leaves with {speed} m/s");
        let gained = 0.5 * 2.0 * (speed * speed - 1.0);
        residuals.push((gained - driver.engine().work().walls).abs() / gained);
    }
    assert!(residuals[0] < 1e-3, "{residuals:?}");
    assert!(residuals[1] < 0.5 * residuals[0], "the residual falls with the step: {residuals:?}");
}

/// With damping, friction and gravity the ledger closes: kinetic, elastic and gravity energy plus what is dissipated stay
/// constant. The residual is the error of the scheme; it falls with the step.
#[test]
fn the_energy_ledger_closes() {
    let residual = |step: f64| {
        let mut driver = driver(&format!(
            r#"(version: 1, seed: 5, ledger: true, gravity: (0, 0, -9.81), materials: {{ "a": (density: 2500) }},
            bodies: [Fill(material: "a", radius: Uniform(min: "2 mm", max: "3 mm"), count: 40,
                lo: (0, 0, 0), hi: (0.03, 0.03, 0.04), velocity_spread: 0.5)],
            walls: {{ "box": Box(lo: (0, 0, 0), hi: (0.03, 0.03, 0.1), material: "a") }},
            contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 2e4, restitution: 0.7),
                tangential: TangentialSpring(stiffness: 6e3, friction: 0.4))],
            driver: TimeStep(step: {step:e}), run: (duration: 0.1))"#
        ));
        let energy = |driver: &granule_drivers::TimeStepDriver| {
            let plan = driver.engine().plan().clone();
            let mut sum = driver.view().tally().elastic.iter().sum::<f64>();
            for (rank, body) in bodies(driver).iter().enumerate() {
                let (m, r, q) =
                    (plan.bodies.mass[rank], plan.bodies.radius[rank], plan.bodies.inertia_factor[rank]);
                let square = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>();
                sum += 0.5 * m * square(body.velocity)
                    + 0.5 * q * m * r * r * square(body.spin)
                    + m * 9.81 * body.position[2];
            }
            sum
        };
        let before = energy(&driver);
        let last = driver.engine().plan().driver.steps;
        advance(&mut driver, last);
        let view = driver.view();
        let work = view.work();
        let dissipated: f64 = work.viscous.iter().sum::<f64>() + work.friction.iter().sum::<f64>();
        assert!(work.viscous[0] > 0.0 && work.friction[2] > 0.0, "both mechanisms act");
        (energy(&driver) + dissipated - before) / dissipated
    };
    let (coarse, fine) = (residual(4e-6), residual(1e-6));
    // First order where contacts begin and end inside a step: 1e3 impacts whose signs are random.
    assert!(coarse.abs() < 2e-2, "residual {coarse}");
    assert!(fine.abs() < 5e-3, "residual {fine}");
}
