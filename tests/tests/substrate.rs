//! Bodies that roll and slide on a surface, against closed forms of Kondic 1999 with its errata and of elementary mechanics.

use granule_drivers::Driver;
use granule_observers::Energy;
use granule_tests::{BodyState, advance, bodies, driver, driver_with};

const G: f64 = 9.81;
const R: f64 = 0.002;

/// One sphere of radius 2 mm on a surface.
fn single(gravity: &str, substrate: &str, motion: &str, step: f64, steps: u64) -> String {
    format!(
        "(version: 1, gravity: {gravity},
          materials: {{ \"steel\": (density: 7850) }},
          bodies: [{motion}],
          substrate: ({substrate}),
          driver: TimeStep(step: {step:e}), run: (steps: {steps}), ledger: true)"
    )
}

fn sphere(velocity: [f64; 3], spin: [f64; 3]) -> String {
    format!(
        "Sphere(material: \"steel\", radius: {R}, position: (0, 0, {R}), velocity: {velocity:?}, spin: {spin:?})"
    )
    .replace('[', "(")
    .replace(']', ")")
}

fn end(text: &str) -> BodyState {
    let mut driver = driver(text);
    let steps = driver.engine().plan().driver.steps;
    advance(&mut driver, steps);
    bodies(&driver)[0]
}

/// Share of the energy exchanged that the ledger does not account for.
fn residual(text: &str) -> f64 {
    let mut driver = driver(text);
    let start = Energy::of(&driver.view());
    let steps = driver.engine().plan().driver.steps;
    advance(&mut driver, steps);
    let end = Energy::of(&driver.view());
    let exchanged =
        (end.gravity - start.gravity).abs() + end.dissipated_friction + end.wall_work.abs() + start.kinetic;
    end.residual_since(&start).abs() / exchanged
}

const FLAT: &str = "(0, 0, -9.81)";

#[test]
fn a_sphere_on_a_shaken_plate_follows_two_sevenths_of_it() {
    let laws = "laws: { \"steel\": StickSlip(static_friction: 0.5, kinetic_friction: 0.1) }";
    let (amplitude, omega) = (1e-3, 60.0);
    // At time 0 the plate has the velocity Aω, and the sphere 2/7 of it, spinning with the rest.
    let v = 2.0 / 7.0 * amplitude * omega;
    let spin = (amplitude * omega - v) / R;
    let text = single(
        FLAT,
        &format!("{laws}, motion: Sinusoidal(amplitude: ({amplitude}, 0, 0), angular_frequency: {omega})"),
        &sphere([v, 0.0, 0.0], [0.0, -spin, 0.0]),
        1e-5,
        100_000,
    );
    let mut driver = driver(&text);
    for step in [1_000, 30_000, 100_000] {
        advance(&mut driver, step);
        let body = bodies(&driver)[0];
        let plate = amplitude * (omega * step as f64 * 1e-5).sin();
        // The mean force of a step is that of half a step earlier: (ω dt)²/12 = 3e-8 of the way.
        assert!((body.position[0] - 2.0 / 7.0 * plate).abs() < 1e-7 * amplitude, "{step}: {body:?}");
        assert!(driver.engine().substrate().rolling == 1);
    }
    assert!(residual(&text) < 1e-10, "{}", residual(&text));
}

#[test]
fn slip_starts_at_seven_halves_of_the_static_friction() {
    // The plate accelerates as A ω² sin; its peak is 0.1 % below and above 3.5 μ_s g (Kondic 1999, Eq. (19)).
    let omega = 100.0;
    for (share, slips) in [(0.999, false), (1.001, true)] {
        let amplitude = share * 3.5 * 0.5 * G / (omega * omega);
        let v = 2.0 / 7.0 * amplitude * omega;
        let text = single(
            FLAT,
            &format!(
                "laws: {{ \"steel\": StickSlip(static_friction: 0.5, kinetic_friction: 0.1) }},
                 motion: Sinusoidal(amplitude: ({amplitude}, 0, 0), angular_frequency: {omega})"
            ),
            &sphere([v, 0.0, 0.0], [0.0, -2.5 * v / R, 0.0]),
            1e-6,
            20_000,
        );
        let mut driver = driver(&text);
        advance(&mut driver, 20_000);
        let lost = driver.engine().substrate().work.sliding;
        assert_eq!(lost > 1e-12, slips, "{share}: {lost}");
    }
}

#[test]
fn slip_turns_into_rolling_at_five_sevenths() {
    for friction in [0.2, 0.6, 1.0] {
        let u0 = 0.7;
        let stop = 2.0 * u0 / (7.0 * friction * G);
        let steps = 4_000_u32;
        let dt = 1.5 * stop / f64::from(steps);
        let text = single(
            FLAT,
            &format!("laws: {{ \"steel\": StickSlip(friction: {friction}) }}"),
            &sphere([u0, 0.0, 0.0], [0.0; 3]),
            dt,
            steps.into(),
        );
        let mut driver = driver(&text);
        let half = f64::from(steps) / 3.0;
        advance(&mut driver, half as u64);
        let (body, t) = (bodies(&driver)[0], half.floor() * dt);
        // Constant forces: exact but for rounding, which grows with the number of steps.
        assert!((body.velocity[0] - (u0 - friction * G * t)).abs() < 1e-11);
        assert!((body.spin[1] - 2.5 * friction * G * t / R).abs() < 1e-8);
        let mut switched = None;
        for step in half as u64..u64::from(steps) {
            advance(&mut driver, step + 1);
            if switched.is_none() && driver.engine().substrate().rolling == 1 {
                switched = Some((step + 1) as f64 * dt);
            }
        }
        let body = bodies(&driver)[0];
        assert!((body.velocity[0] / u0 - 5.0 / 7.0).abs() < 1e-12, "{body:?}");
        assert!((body.spin[1] * R / u0 - 5.0 / 7.0).abs() < 1e-12);
        assert!((switched.unwrap() - stop).abs() <= dt, "{switched:?}");
        // Sliding loses 2/7 of the energy.
        let energy = 0.5 * driver.engine().bodies().mass[0] * u0 * u0;
        let lost = driver.engine().substrate().work.sliding;
        // The one step in which slip ends.
        assert!((lost / energy - 2.0 / 7.0).abs() < 1e-6, "{}", lost / energy);
        assert!(residual(&text) < 1e-11);
    }
}

#[test]
fn down_an_incline_it_rolls_or_slips() {
    for degrees in [5.0_f64, 15.0, 30.0, 59.0, 61.0, 75.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let text = single(
            FLAT,
            &format!("laws: {{ \"steel\": StickSlip(friction: 0.5) }}, inclination: \"{degrees} deg\""),
            &sphere([0.0; 3], [0.0; 3]),
            1e-4,
            10_000,
        );
        let body = end(&text);
        let rolls = degrees.to_radians().tan() < 3.5 * 0.5;
        let a = if rolls { 5.0 / 7.0 * G * sin } else { G * (sin - 0.5 * cos) };
        let turn = if rolls { a / R } else { 2.5 * 0.5 * G * cos / R };
        assert!((body.velocity[1] + a).abs() < 1e-9, "{degrees}: {body:?}, a {a}");
        assert!((body.spin[0] - turn).abs() < 1e-6, "{degrees}: {body:?}");
        // Half of a dt² in the first step, whose force is not known beforehand.
        assert!((body.position[1] + 0.5 * a).abs() < 2.0 * G * 1e-8, "{degrees}: {body:?}");
        assert!(residual(&text) < 1e-8, "{degrees}: {}", residual(&text));
    }
}

#[test]
fn an_accelerated_plate_and_an_incline_add_up() {
    // Kondic 1999, Eq. (24) with erratum K-E17: 5/7 g sin + 2/7 a_S; printed, the weight would count only in the 2/7.
    let (omega, amplitude) = (1.0, 2.0);
    let sin = 0.05_f64.sin();
    let text = single(
        FLAT,
        &format!(
            "laws: {{ \"steel\": StickSlip(friction: 5) }}, inclination: 0.05,
             motion: Sinusoidal(amplitude: (0, {amplitude}, 0), angular_frequency: {omega}, phase: {})",
            std::f64::consts::FRAC_PI_2
        ),
        &sphere([0.0; 3], [0.0; 3]),
        1e-5,
        1_000,
    );
    let body = end(&text);
    let t = 0.01_f64;
    let corrected = -5.0 / 7.0 * G * sin * t - 2.0 / 7.0 * amplitude * omega * (omega * t).sin();
    let printed = -2.0 / 7.0 * G * sin * t - 2.0 / 7.0 * amplitude * omega * (omega * t).sin();
    assert!((body.velocity[1] - corrected).abs() < 1e-12, "{body:?}, {corrected}");
    assert!((body.velocity[1] - printed).abs() > 1e-3);
}

#[test]
fn rolling_friction_stops_and_never_reverses() {
    let v0 = 0.05;
    let text = single(
        FLAT,
        "laws: { \"steel\": StickSlip(static_friction: 0.5, kinetic_friction: 0.1, rolling_friction: 1e-3) }",
        &sphere([v0, 0.0, 0.0], [0.0, v0 / R, 0.0]),
        1e-4,
        60_000,
    );
    let mut driver = driver(&text);
    advance(&mut driver, 20_000);
    let body = bodies(&driver)[0];
    // Kondic 1999, Eq. (16); exact but for rounding.
    assert!((body.velocity[0] - (v0 - 1e-3 * G * 2.0)).abs() < 1e-12, "{body:?}");
    let mut stopped = None;
    for step in 20_001..=60_000 {
        advance(&mut driver, step);
        let body = bodies(&driver)[0];
        assert!(body.velocity[0] >= 0.0 && (body.velocity[0] - R * body.spin[1]).abs() < 1e-15, "{body:?}");
        if body.velocity[0] == 0.0 && stopped.is_none() {
            stopped = Some(step as f64 * 1e-4);
        }
    }
    let stop = v0 / (1e-3 * G);
    assert!((stopped.unwrap() - stop).abs() <= 1e-4, "{stopped:?} {stop}");
    let way = v0 * v0 / (2.0 * 1e-3 * G);
    assert!((bodies(&driver)[0].position[0] / way - 1.0).abs() < 1e-6);
    assert_eq!(driver.engine().substrate().resting, 1);
    assert!(residual(&text) < 1e-10);
}

#[test]
fn rolling_friction_follows_its_table() {
    // μ_r = 1e-3 + 0.02 s/m · v: v' = -g (a + b v).
    let v0 = 0.1;
    let text = single(
        FLAT,
        "laws: { \"steel\": StickSlip(friction: 0.5) }, rolling_friction: { \"steel\": [(0, 1e-3), (1, 0.021)] }",
        &sphere([0.0, v0, 0.0], [-v0 / R, 0.0, 0.0]),
        1e-4,
        20_000,
    );
    let body = end(&text);
    let (a, b) = (1e-3, 0.02);
    let expected = (v0 + a / b) * (-G * b * 2.0_f64).exp() - a / b;
    // Second order: (g b dt)² t / 12.
    assert!((body.velocity[1] - expected).abs() < 1e-9, "{body:?} {expected}");
}

#[test]
fn drilling_friction_stops_the_spin_about_the_normal() {
    let text = single(
        FLAT,
        "laws: { \"steel\": StickSlip(friction: 0.5, drilling_friction: 0.01) }",
        &sphere([0.0; 3], [0.0, 0.0, 100.0]),
        1e-4,
        10_000,
    );
    let mut driver = driver(&text);
    advance(&mut driver, 1_000);
    // I dΩ/dt = -μ_d m g R.
    let expected = 100.0 - 0.01 * G * 2.5 / R * 0.1;
    assert!((bodies(&driver)[0].spin[2] - expected).abs() < 1e-9);
    advance(&mut driver, 10_000);
    let body = bodies(&driver)[0];
    assert_eq!((body.spin, body.velocity), ([0.0; 3], [0.0; 3]));
    let energy = 0.2 * driver.engine().bodies().mass[0] * R * R * 1e4;
    assert!((driver.engine().substrate().work.drilling / energy - 1.0).abs() < 1e-10);
}

#[test]
fn a_ball_on_a_turntable_circles_at_two_sevenths_of_its_speed() {
    let omega = 7.0;
    let v = 0.02;
    let text = single(
        FLAT,
        &format!(
            "laws: {{ \"steel\": StickSlip(friction: inf) }},
             motion: Rotation(point: (0, 0, 0), angular_velocity: {omega})"
        ),
        // At the axis the surface is at rest.
        &sphere([v, 0.0, 0.0], [0.0, v / R, 0.0]),
        std::f64::consts::PI * 1e-4,
        10_000,
    );
    let mut driver = driver(&text);
    let radius = v / (2.0 / 7.0 * omega);
    for quarter in 1..=4 {
        advance(&mut driver, quarter * 2_500);
        let angle = 2.0 / 7.0 * omega * f64::from(quarter as u32) * 2_500.0 * std::f64::consts::PI * 1e-4;
        let body = bodies(&driver)[0];
        // dv/dt = 2/7 Ω k × v. Second order: (Ω dt)² = 5e-6, times the angle over 12.
        assert!((body.velocity[0] - v * angle.cos()).abs() < 3e-6 * v, "{quarter}: {body:?}");
        assert!((body.velocity[1] - v * angle.sin()).abs() < 3e-6 * v, "{quarter}: {body:?}");
        assert!(
            (body.position[0] - radius * angle.sin()).abs() < 1e-3 * radius,
            "{quarter}: {body:?} {radius}"
        );
    }
}

#[test]
fn a_slipping_ball_curves_as_a_parabola() {
    // Slip keeps its direction, so friction is constant: the centre moves on a parabola until it rolls.
    let (v, w) = (0.3, 200.0);
    let text = single(
        FLAT,
        "laws: { \"steel\": StickSlip(friction: 0.2) }",
        &sphere([v, 0.0, 0.0], [w, 0.0, 0.0]),
        1e-5,
        20_000,
    );
    let body = end(&text);
    // u = (v, R w): momentum about the contact gives v_end = v - 2/7 u.
    let expected = [v - 2.0 / 7.0 * v, -2.0 / 7.0 * R * w];
    assert!((body.velocity[0] - expected[0]).abs() < 1e-12, "{body:?}");
    assert!((body.velocity[1] - expected[1]).abs() < 1e-12, "{body:?}");
    assert!(residual(&text) < 1e-9);
}

#[test]
fn a_ball_that_may_leave_falls_and_bounces() {
    let body = format!(
        "Sphere(material: \"steel\", radius: {R}, position: (0, 0, {}), velocity: (0.1, 0, 0))",
        R + 0.01
    );
    let restitution = 0.7;
    let text = single(
        FLAT,
        &format!(
            "confined: false, restitution: {restitution}, laws: {{ \"steel\": StickSlip(friction: inf) }}"
        ),
        &body,
        1e-5,
        60_000,
    );
    let mut driver = driver(&text);
    assert_eq!(driver.engine().substrate().airborne, 1);
    let fall = (2.0 * 0.01 / G).sqrt();
    let (mut apex, mut step) = (0.0_f64, 0);
    while step < ((1.0 + 2.0 * restitution) * fall / 1e-5) as u64 - 2 {
        step += 1;
        advance(&mut driver, step);
        if step as f64 * 1e-5 > fall + 1e-4 {
            apex = apex.max(bodies(&driver)[0].position[2] - R);
        }
    }
    // Landing is put at the end of a step: half a step of flight at 0.3 m/s.
    assert!((apex / (restitution * restitution * 0.01) - 1.0).abs() < 1e-3, "{apex}");
    advance(&mut driver, 60_000);
    let body = bodies(&driver)[0];
    assert_eq!((body.position[2], body.velocity[2]), (R, 0.0));
    assert!((body.velocity[0] - 0.1 * 5.0 / 7.0).abs() < 1e-12);
    assert!(residual(&text) < 1e-6, "{}", residual(&text));
}

/// Beads of two kinds on a shaken plate between walls that move with it.
fn beads() -> String {
    let motion = "Sinusoidal(amplitude: (\"5 mm\", 0, 0), frequency: \"5 Hz\")";
    let friction = "normal: LinearSpringDashpot(contact_duration: \"0.1 ms\", restitution: 0.9),
         tangential: KondicFriction(damping_rate: 1e3, shear_friction: 0.5, vertical_friction: 0.5)";
    format!(
        "(version: 1, gravity: {FLAT}, materials: {{ \"steel\": (density: 7850), \"glass\": (density: 7850) }},
          bodies: [
            Lattice(material: \"steel\", radius: {R}, spacing: 5e-3, lo: (0.003, 0.003, {R}), hi: (0.2, 0.05, {R})),
            Lattice(material: \"glass\", radius: {R}, spacing: 5e-3, lo: (0.003, 0.055, {R}), hi: (0.2, 0.1, {R})),
          ],
          walls: {{ \"frame\": Box(lo: (0, 0, -1), hi: (0.205, 0.105, 1), open: [\"z-\", \"z+\"], material: \"steel\",
                                   motion: {motion}) }},
          substrate: (motion: {motion}, confined: false, laws: {{
            \"steel\": StickSlip(static_friction: 0.5, kinetic_friction: 0.1, rolling_friction: 1e-3),
            \"glass\": StickSlip(static_friction: 0.5, kinetic_friction: 0.1, rolling_friction: 1e-2) }}),
          contacts: [
            (between: (\"steel\", \"steel\"), {friction}),
            (between: (\"steel\", \"glass\"), {friction}),
            (between: (\"glass\", \"glass\"), {friction}),
          ],
          driver: TimeStep(step: 2e-6), run: (steps: 20000), ledger: true)"
    )
}

#[test]
fn many_beads_on_a_shaken_plate_have_the_same_bits_for_any_number_of_threads() {
    let text = beads();
    let run = |threads: usize| {
        let mut driver = driver_with(&text, threads);
        let start = Energy::of(&driver.view());
        advance(&mut driver, 20_000);
        let residual = Energy::of(&driver.view()).residual_since(&start);
        (bodies(&driver), *driver.engine().substrate(), residual)
    };
    let (one, tally, residual) = run(1);
    let (three, other, _) = run(3);
    assert!(one == three && tally == other);
    assert_eq!(tally.sliding + tally.rolling + tally.resting + tally.airborne, 800);
    // Something has happened: slip, rolling friction, and work of the plate.
    assert!(tally.work.sliding > 0.0 && tally.work.rolling > 0.0 && tally.work.plate != 0.0);
    let exchanged = tally.work.sliding + tally.work.rolling + tally.work.plate.abs();
    assert!(residual.abs() < 1e-3 * exchanged, "{residual} of {exchanged}");
}
