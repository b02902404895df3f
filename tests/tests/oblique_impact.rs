//! Oblique impacts, friction and rolling of single bodies.

use granule_tests::run;

fn wall_impact(angle: f64, step: f64, conventions: &str) -> granule_tests::BodyState {
    let (sine, cosine) = angle.to_radians().sin_cos();
    run(&format!(
        r#"(version: 1, materials: {{ "a": (density: 4000) }},
        bodies: [Sphere(material: "a", radius: "2.5 mm", position: (0, 0, 0.0025001), velocity: ({}, 0, {}))],
        walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1.72e7, damping: 0),
            tangential: TangentialSpring(stiffness: 1.48e7, friction: 0.092))],
        conventions: {conventions}, driver: TimeStep(step: {step:e}), run: (duration: "20 us"))"#,
        3.9 * sine,
        -3.9 * cosine,
    ))[0]
}

/// Case B02 (MFiX DEM05): spin and tangential restitution after an oblique impact on a wall, 2.5 to 65 degrees. With the
/// lever arm R of the step-converged reference: 0.5 % of its spin and of e_t. With the physical arm, shorter by half of the
/// overlap of 0.6 % of the radius: 0.5 % of the largest spin. The recorded run (whose step is coarse) within 3 % of the
/// largest spin, all angles.
#[test]
fn oblique_impact_on_a_wall() {
    let data: serde_json::Value = serde_json::from_str(include_str!("../data/oblique-wall.json")).unwrap();
    let rows = data["rows"].as_array().unwrap();
    let largest = rows.iter().map(|row| row["recorded_omega"].as_f64().unwrap()).fold(0.0, f64::max);
    let same_arm = r#"(preset: "physical", wall_slip_arm: Radius, wall_torque_arm: Radius)"#;
    let mut compared = 0;
    for row in rows {
        let angle = row["angle"].as_f64().unwrap();
        for step in [2e-8, 1e-8] {
            let body = wall_impact(angle, step, same_arm);
            let tangential = body.velocity[0] / (3.9 * angle.to_radians().sin());
            if let (Some(spin), Some(expected)) = (row["omega"].as_f64(), row["et"].as_f64()) {
                assert!(
                    (body.spin[1] - spin).abs() < 5e-3 * spin,
                    "{angle} deg: spin {} against {spin}",
                    body.spin[1]
                );
                assert!(
                    (tangential - expected).abs() < 5e-3 * expected,
                    "{angle} deg: {tangential} against {expected}"
                );
                let physical = wall_impact(angle, step, "\"physical\"");
                assert!(
                    (physical.spin[1] - spin).abs() < 5e-3 * largest,
                    "{angle} deg: spin {}",
                    physical.spin[1]
                );
                compared += 1;
            }
            let recorded = row["recorded_omega"].as_f64().unwrap();
            assert!(
                (body.spin[1] - recorded).abs() < 3e-2 * largest,
                "{angle} deg: spin {} recorded {recorded}",
                body.spin[1]
            );
        }
    }
    assert_eq!(compared, 44, "22 converged rows at two steps");
}

/// Case B01: gross sliding, tan θ > 7/2 μ (1 + e). The tangential impulse is μ (1+e) m v_n whatever the law.
#[test]
fn gross_sliding() {
    for (restitution, friction) in [(0.9, 0.1), (0.6, 0.2), (1.0, 0.3)] {
        let (normal, tangential): (f64, f64) = (1.0, 4.0 * friction * (1.0 + restitution));
        for steps_per_contact in [200, 400] {
            let body = run(&format!(
                r#"(version: 1, materials: {{ "a": (density: 2500) }},
                bodies: [Sphere(material: "a", radius: 0.01, position: (0, 0, 0.01001), velocity: ({tangential}, 0, {normal_in}))],
                walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
                contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e8, restitution: {restitution}),
                    tangential: Coulomb(friction: {friction}))],
                driver: TimeStep(step: Auto(steps_per_contact: {steps_per_contact})), run: (duration: "200 us"))"#,
                normal_in = -normal,
            ))[0];
            let impulse = friction * (1.0 + restitution) * normal;
            // Arm R - δ/2 against R: δ/R is 0.1 % here. First-order error of e_n: 0.3 % at 200 steps.
            assert!(
                (body.velocity[0] - (tangential - impulse)).abs() < 5e-3 * impulse,
                "{}",
                body.velocity[0]
            );
            assert!((0.01 * body.spin[1] - 2.5 * impulse).abs() < 5e-3 * 2.5 * impulse, "{}", body.spin[1]);
        }
    }
}

/// Case B05 (LAMMPS granular test dem04): 2.5 mm sphere on a wall, linear spring with damping for e = 0.98 and a
/// tangential spring. Step-converged reference; 1e-4 asks for the lever arm R of that code.
#[test]
fn oblique_impact_of_the_lammps_suite() {
    let mass = 4.0 / 3.0 * std::f64::consts::PI * 0.0025_f64.powi(3) * 2700.0;
    let log = 0.98_f64.ln();
    let damping = 2.0 * -log * (2e7 * mass / (std::f64::consts::PI.powi(2) + log * log)).sqrt();
    for step in [1e-8, 5e-9] {
        let body = run(&format!(
            r#"(version: 1, materials: {{ "a": (density: 2700) }},
            bodies: [Sphere(material: "a", radius: "2.5 mm", position: (0, 0, 0.0025001), velocity: (2.5069, 0, -2.9876))],
            walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
            contacts: [(between: ("a", "a"), contact_end: Overlap,
                normal: LinearSpringDashpot(stiffness: 2e7, damping: {damping}),
                tangential: TangentialSpring(stiffness: 5.7e6, friction: 0.092))],
            conventions: "lammps-classic",
            driver: TimeStep(step: {step:e}), run: (duration: "20 us"))"#
        ))[0];
        assert!((body.velocity[0] / 1.96266 - 1.0).abs() < 1e-4, "vx = {}", body.velocity[0]);
        assert!((body.velocity[2] / 2.92785 - 1.0).abs() < 1e-4, "vz = {}", body.velocity[2]);
        assert!((body.spin[1] / 544.243 - 1.0).abs() < 1e-4, "wy = {}", body.spin[1]);
    }
}

/// Case B07: without sliding, the tangential spring gives e_t = -cos(ω_t t_c) (Luding 1998, Eqs. (55)-(57)):
/// k_t/k_n = 2/7 reverses the slip, 1/14 stops it. Central part of a glancing contact: k large, v_t small.
#[test]
fn tangential_restitution_of_the_spring() {
    for (ratio, expected) in [(2.0 / 7.0, 1.0), (1.0 / 14.0, 0.0), (2.0 / 7.0 * (2.0_f64 / 3.0).powi(2), 0.5)]
    {
        for steps_per_contact in [400, 800] {
            let body = run(&format!(
                r#"(version: 1, materials: {{ "a": (density: 2500) }},
                bodies: [Sphere(material: "a", radius: 0.01, position: (0, 0, 0.01001), velocity: (0.1, 0, -1))],
                walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
                contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e8, damping: 0),
                    tangential: TangentialSpring(stiffness: {:e}, friction: inf))],
                driver: TimeStep(step: Auto(steps_per_contact: {steps_per_contact})), run: (duration: "200 us"))"#,
                ratio * 1e8,
            ))[0];
            let slip = body.velocity[0] - 0.01 * body.spin[1];
            // Overlap over radius is 3e-4; phase errors of 400 steps are smaller still.
            assert!((-slip / 0.1 - expected).abs() < 5e-3, "k_t/k_n = {ratio}: e_t = {}", -slip / 0.1);
        }
    }
}

/// The tangential restitution that is asked for is realised with dissipative normal laws under both ends of contact: tangential
/// forces act as long as the normal force does, Luding 1998, Eqs. (49), (50) and (55)-(57) with errata L-E5 and L-E6.
#[test]
fn tangential_restitution_under_both_ends_of_contact() {
    for (law, wanted) in [("TangentialSpring", 0.5), ("ViscousTangential", -0.4)] {
        for normal in [
            "LinearSpringDashpot(stiffness: 1e8, restitution: 0.9)",
            "LinearSpringDashpot(stiffness: 1e8, restitution: 0.5)",
            "WaltonBraun(loading_stiffness: 1e8, restitution: 0.7)",
        ] {
            for end in ["Force", "Overlap"] {
                let body = run(&format!(
                    r#"(version: 1, materials: {{ "a": (density: 2500) }},
                    bodies: [Sphere(material: "a", radius: 0.01, position: (0, 0, 0.01001), velocity: (0.1, 0, -1))],
                    walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
                    contacts: [(between: ("a", "a"), contact_end: {end}, normal: {normal},
                        tangential: {law}(tangential_restitution: {wanted}, friction: inf))],
                    driver: TimeStep(integrator: ContactResolved, step: Auto(steps_per_contact: 800)), run: (duration: "400 us"))"#,
                ))[0];
                let slip = -(body.velocity[0] - 0.01 * body.spin[1]) / 0.1;
                // The arm is shorter by half of the overlap, 3e-4 of the radius; one step of 800 turns the slip by 3e-3.
                assert!((slip - wanted).abs() < 5e-3, "{normal}, {law}, {end}: {slip} for {wanted}");
            }
        }
    }
}

/// Case B09: viscous tangential force, v_t' = v_t exp(-2 η_t t_c), η_t = (1 + 1/q) γ_t / (2 m12) (Luding 1998,
/// Eqs. (49)-(50)).
#[test]
fn viscous_tangential_force() {
    let mass = 4.0 / 3.0 * std::f64::consts::PI * 1e-6 * 2500.0;
    let duration = std::f64::consts::PI * (mass / 1e8_f64).sqrt();
    for damping in [5.0, 50.0] {
        for steps_per_contact in [200, 400] {
            let body = run(&format!(
                r#"(version: 1, materials: {{ "a": (density: 2500) }},
                bodies: [Sphere(material: "a", radius: 0.01, position: (0, 0, 0.01001), velocity: (0.1, 0, -1))],
                walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
                contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e8, damping: 0),
                    tangential: ViscousTangential(damping: {damping}))],
                driver: TimeStep(step: Auto(steps_per_contact: {steps_per_contact})), run: (duration: "200 us"))"#,
            ))[0];
            let slip = (body.velocity[0] - 0.01 * body.spin[1]) / 0.1;
            let expected = (-3.5 * damping / mass * duration).exp();
            // One step more or less of contact is 1/200 of the exponent.
            assert!((slip - expected).abs() < 5e-3, "damping {damping}: {slip} against {expected}");
        }
    }
}

/// Case B14 (Chung & Ooi 2011, test 7): equal spheres with opposite spins meet head-on. The contact points move
/// together: no slip, no tangential velocity, spins unchanged.
#[test]
fn counter_spinning_spheres_do_not_slip() {
    for spin in [2.0, 22.86] {
        let bodies = run(&format!(
            r#"(version: 1, materials: {{ "a": (density: 2700) }},
            bodies: [
                Sphere(material: "a", radius: 0.1, position: (0, 0, 0), velocity: (0.2, 0, 0), spin: (0, {spin}, 0)),
                Sphere(material: "a", radius: 0.1, position: (0.201, 0, 0), velocity: (-0.2, 0, 0), spin: (0, {}, 0)),
            ],
            contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e7, restitution: 0.8),
                tangential: TangentialSpring(stiffness: 2e6, friction: 0.4))],
            run: (duration: "20 ms"))"#,
            -spin
        ));
        assert!(bodies[0].velocity[0] < 0.0, "they have met");
        for (body, spin) in bodies.iter().zip([spin, -spin]) {
            assert!((body.spin[1] - spin).abs() <= 1e-12 * spin.abs(), "spin {}", body.spin[1]);
            assert!(body.velocity[2].abs() <= 1e-12 * 0.2, "tangential velocity {}", body.velocity[2]);
        }
    }
}

/// A sphere of 1 cm radius resting on a tilted or level plane, with its static overlap.
fn on_plane(
    angle: f64,
    friction: f64,
    velocity: f64,
    duration: f64,
    steps_per_contact: u32,
) -> granule_tests::BodyState {
    let (sine, cosine) = angle.to_radians().sin_cos();
    let mass = 4.0 / 3.0 * std::f64::consts::PI * 1e-6 * 2500.0;
    let overlap = mass * 9.81 * cosine / 1e5;
    run(&format!(
        r#"(version: 1, gravity: ({}, 0, {}), materials: {{ "a": (density: 2500) }}, impact_speed: 0.01,
        bodies: [Sphere(material: "a", radius: 0.01, position: (0, 0, {:e}), velocity: ({velocity}, 0, 0))],
        walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e5, restitution: 0.5),
            tangential: TangentialSpring(stiffness: 3e4, friction: {friction}, damping: 2))],
        driver: TimeStep(step: Auto(steps_per_contact: {steps_per_contact})), run: (duration: {duration}))"#,
        9.81 * sine,
        -9.81 * cosine,
        0.01 - overlap,
    ))[0]
}

/// Case B10 (MFiX DEM04): a sliding sphere comes to roll after t_s = 2 u0/(7 μ g) at 5/7 u0; during the slip its speed
/// is u0 - μ g t and its spin 5/2 μ g t / R.
#[test]
fn sliding_turns_into_rolling() {
    for friction in [0.2, 0.5, 1.0] {
        let until_rolling = 2.0 / (7.0 * friction * 9.81);
        for steps_per_contact in [50, 100] {
            let half = 0.5 * until_rolling;
            let sliding = on_plane(0.0, friction, 1.0, half, steps_per_contact);
            assert!((sliding.velocity[0] / (1.0 - friction * 9.81 * half) - 1.0).abs() < 2e-3);
            assert!((0.01 * sliding.spin[1] / (2.5 * friction * 9.81 * half) - 1.0).abs() < 2e-3);
            // At 0.6 % before the time the sphere still slips; well after it it rolls.
            let slips = on_plane(0.0, friction, 1.0, 0.994 * until_rolling, steps_per_contact);
            assert!(slips.velocity[0] - 0.01 * slips.spin[1] > 1e-3, "rolls too early");
            let rolling = on_plane(0.0, friction, 1.0, 2.0 * until_rolling, steps_per_contact);
            assert!((rolling.velocity[0] / (5.0 / 7.0) - 1.0).abs() < 2e-3, "{}", rolling.velocity[0]);
            assert!((0.01 * rolling.spin[1] / (5.0 / 7.0) - 1.0).abs() < 2e-3, "{}", rolling.spin[1]);
        }
    }
}

/// Case B11: on an incline the sphere rolls with 5/7 g sin θ if tan θ < 7/2 μ, else slips with g (sin θ - μ cos θ).
#[test]
fn inclined_plane() {
    for angle in [5.0_f64, 15.0, 30.0, 50.0, 65.0] {
        let (sine, cosine) = angle.to_radians().sin_cos();
        let friction = 0.5;
        let rolls = sine / cosine <= 3.5 * friction;
        let acceleration = if rolls { 5.0 / 7.0 * 9.81 * sine } else { 9.81 * (sine - friction * cosine) };
        let angular = if rolls { acceleration / 0.01 } else { 2.5 * friction * 9.81 * cosine / 0.01 };
        for steps_per_contact in [50, 100] {
            let body = on_plane(angle, friction, 0.0, 0.2, steps_per_contact);
            // Arm R - δ/2 with δ/R = 1e-4; the start-up of the tangential spring lasts a contact duration, 1e-3 of the run.
            assert!(
                (body.velocity[0] / (acceleration * 0.2) - 1.0).abs() < 1e-3,
                "{angle}: {}",
                body.velocity[0]
            );
            assert!((body.spin[1] / (angular * 0.2) - 1.0).abs() < 1.5e-3, "{angle}: {}", body.spin[1]);
        }
    }
}
