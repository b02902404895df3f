//! Soft contacts at the extremes of their parameters: the right answer, or one clear error before the run.

use std::fmt::Write as _;

use granule_drivers::{Driver, TimeStepDriver};
use granule_tests::{advance, bodies, driver, run};

/// One sphere of the scene.
struct Ball {
    radius: f64,
    mass: f64,
    position: [f64; 3],
    velocity: [f64; 3],
    spin: [f64; 3],
}

fn ball(position: [f64; 3], velocity: [f64; 3]) -> Ball {
    Ball { radius: 0.01, mass: 0.01, position, velocity, spin: [0.0; 3] }
}

fn listed(balls: &[Ball]) -> String {
    let mut list = String::new();
    for ball in balls {
        let ([x, y, z], [u, v, w], [p, q, r]) = (ball.position, ball.velocity, ball.spin);
        let _ = writeln!(
            list,
            "Sphere(material: \"a\", radius: {:?}, mass: {:?}, position: ({x:?}, {y:?}, {z:?}), velocity: ({u:?}, {v:?}, \
             {w:?}), spin: ({p:?}, {q:?}, {r:?})),",
            ball.radius, ball.mass
        );
    }
    list
}

/// A scene of these spheres; `laws` goes into the contact block, `more` beside it.
fn scene(balls: &[Ball], laws: &str, more: &str) -> String {
    format!(
        r#"(version: 1, materials: {{ "a": () }}, bodies: [{}], contacts: [(between: ("a", "a"), {laws})], {more})"#,
        listed(balls)
    )
}

/// Two spheres that meet head on with 1 m/s after a hundredth of a radius.
fn head_on(mass: f64, partner: f64) -> [Ball; 2] {
    [
        Ball { mass, ..ball([0.0; 3], [1.0, 0.0, 0.0]) },
        Ball { mass: partner, ..ball([0.0201, 0.0, 0.0], [0.0; 3]) },
    ]
}

/// Case X01: mass ratios to 10^12. The light one comes back with -e v, momentum is kept, and the step follows the reduced
/// mass. The restitution of this scheme has an error of first order in the step: the force of the step in which the contact begins is
/// up to half a step off. With 2 η/ω = 0.14 that is up to 0.16 of a step's share, 2e5 steps leave 1e-6.
#[test]
fn extreme_mass_ratios() {
    for partner in [1e4, 1e10] {
        let text = scene(
            &head_on(0.01, partner),
            "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
            "driver: TimeStep(step: Auto(steps_per_contact: 200000)), run: (duration: 4e-3)",
        );
        let end = run(&text);
        let expected = 1.0 - 1.8 * partner / (0.01 + partner);
        assert!((end[0].velocity[0] - expected).abs() < 2e-6, "{partner}: {:?}", end[0]);
        let momentum = 0.01 * end[0].velocity[0] + partner * end[1].velocity[0];
        assert!((momentum / 0.01 - 1.0).abs() < 1e-13 * partner.sqrt(), "{partner}: {momentum}");
    }
}

/// Case X06: at critical damping e = exp(-2) and the force has vanished at ω0 t = 2.
#[test]
fn critical_damping() {
    let (stiffness, reduced) = (1e4_f64, 0.005_f64);
    let omega = (stiffness / reduced).sqrt();
    let step = 1.0 / (omega * 20_000.0);
    let text = scene(
        &head_on(0.01, 0.01),
        &format!(
            "normal: LinearSpringDashpot(stiffness: {stiffness:?}, damping: {:?})",
            2.0 * (stiffness * reduced).sqrt()
        ),
        &format!("driver: TimeStep(step: {step:?}), run: (duration: 4e-3)"),
    );
    let mut driver = driver(&text);
    let (mut begin, mut end) = (0, 0);
    let steps = driver.view().plan().driver.steps;
    for at in 1..=steps {
        advance(&mut driver, at);
        if bodies(&driver)[0].force[0] != 0.0 {
            end = at;
            if begin == 0 {
                begin = at;
            }
        }
    }
    let duration = omega * step * (end - begin) as f64;
    // One step at either end, 1/20000 each; the restitution is of first order in the step.
    assert!((duration - 2.0).abs() < 2e-4, "ω0 t = {duration}");
    let end = bodies(&driver);
    assert!((end[1].velocity[0] - end[0].velocity[0] - 0.135_335_283).abs() < 1e-4, "{end:?}");
}

/// Case X03: no finite damping has restitution zero, so it is refused; and a million times critical damping creeps apart
/// without adding speed.
#[test]
fn overdamped_contacts_stop() {
    let critical = 2.0 * (1e4_f64 * 0.005).sqrt();
    for factor in [1.0, 10.0, 1e3, 1e6] {
        let text = scene(
            &head_on(0.01, 0.01),
            &format!("normal: LinearSpringDashpot(stiffness: 1e4, damping: {:?})", critical * factor),
            "driver: TimeStep(), run: (duration: 1e-3)",
        );
        let end = run(&text);
        let separation = end[1].velocity[0] - end[0].velocity[0];
        assert!(
            separation.abs() < 0.14 && end.iter().all(|b| b.velocity[0].abs() < 1.0),
            "{factor}: {end:?}"
        );
        assert!((end[0].velocity[0] + end[1].velocity[0] - 1.0).abs() < 1e-12, "{factor}: momentum {end:?}");
    }
}

/// Restitution and largest overlap of a head-on impact at 1 m/s.
fn impact(stiffness: f64) -> (f64, f64) {
    let text = scene(
        &head_on(0.01, 0.01),
        &format!("normal: LinearSpringDashpot(stiffness: {stiffness:?}, restitution: 0.8)"),
        &format!(
            "driver: TimeStep(step: Auto(steps_per_contact: 500)), run: (duration: {:?})",
            4e-4 + 2.0 * std::f64::consts::PI * (0.005 / stiffness).sqrt()
        ),
    );
    let mut driver = driver(&text);
    let mut deepest: f64 = 0.0;
    let steps = driver.view().plan().driver.steps;
    for at in 1..=steps {
        advance(&mut driver, at);
        let state = bodies(&driver);
        deepest = deepest.max(0.02 - (state[1].position[0] - state[0].position[0]));
    }
    let end = bodies(&driver);
    (end[1].velocity[0] - end[0].velocity[0], deepest)
}

/// Case X08: over 14 decades of stiffness the restitution is the same to 1e-3 (first order in the step: 4e-4 at 500 steps
/// a contact) and the largest overlap goes with k^(-1/2).
#[test]
fn fourteen_decades_of_stiffness() {
    let (_, reference) = impact(1e4);
    for exponent in [3, 6, 9, 12, 14] {
        let stiffness = 10f64.powi(exponent);
        let (restitution, deepest) = impact(stiffness);
        assert!((restitution - 0.8).abs() < 1e-3, "k = {stiffness:e}: e = {restitution}");
        let slope = (deepest / reference).ln() / (stiffness / 1e4).ln();
        // Overlaps of 1e-8 m are differences of positions of 0.02 m with an ulp of 3.5e-18 m.
        assert!((slope + 0.5).abs() < 1e-3, "k = {stiffness:e}: slope {slope}");
    }
}

/// Case X11: coincident and nearly coincident centres have a direction all the same, and equal and opposite forces.
#[test]
fn coincident_centres() {
    for offset in [0.0, 5e-324, 1e-300, 1e-160, 1e-20] {
        let balls = [ball([0.0; 3], [0.0; 3]), ball([offset, 0.0, 0.0], [0.0; 3])];
        let text = scene(
            &balls,
            "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), tangential: TangentialSpring(stiffness: 3e3, \
             friction: 0.5)",
            "allow_overlap: true, driver: TimeStep(), run: (steps: 10)",
        );
        let mut driver = driver(&text);
        for at in 0..=10 {
            advance(&mut driver, at);
            let state = bodies(&driver);
            for axis in 0..3 {
                assert!(state[0].force[axis].is_finite(), "{offset:e}: {state:?}");
                assert_eq!(state[0].force[axis], -state[1].force[axis], "{offset:e}: {state:?}");
            }
            let force = state[0].force.iter().map(|f| f * f).sum::<f64>().sqrt();
            assert!(force > 10.0, "{offset:e}: spheres in one place repel, {force}");
        }
    }
}

/// An irregular frictional cluster under gravity, in units of `length`, `mass` and `time`.
fn cluster(length: f64, mass: f64, time: f64) -> String {
    let balls: Vec<Ball> = (0..24)
        .map(|i| {
            let turn = f64::from(i) * 2.399_963_229_728_653;
            let height = 1.0 - 2.0 * (f64::from(i) + 0.5) / 24.0;
            let ring = (1.0 - height * height).sqrt();
            let direction = [ring * turn.cos(), ring * turn.sin(), height];
            let radius = 0.75 + 0.25 * (f64::from(i) * 0.618).fract();
            Ball {
                radius: radius * length,
                mass: radius * mass,
                position: direction.map(|c| 5.0 * c * length),
                velocity: direction.map(|c| -c * (1.0 + 0.1 * f64::from(i % 3)) * length / time),
                spin: [turn.sin() / time, 2.0 * height / time, -turn.cos() / time],
            }
        })
        .collect();
    scene(
        &balls,
        &format!(
            "normal: LinearSpringDashpot(stiffness: {:?}, damping: {:?}), tangential: TangentialSpring(stiffness: {:?}, \
             friction: 0.5)",
            500.0 * mass / (time * time),
            5.0 * mass / time,
            150.0 * mass / (time * time)
        ),
        &format!(
            "gravity: (0, 0, {:?}), driver: TimeStep(step: {:?}), run: (steps: 4000)",
            -0.1 * length / (time * time),
            0.002 * time
        ),
    )
}

/// Case X16: nothing in the engine has a size of its own. Other units that are powers of two give the same bits; X14:
/// grains of a nanometre and 10^-23 kg give the same to round-off, which two or three collisions a body amplify to 1e-9.
#[test]
fn units_do_not_matter() {
    let plain = run(&cluster(1.0, 1.0, 1.0));
    let outwards = |body: &&granule_tests::BodyState| {
        (0..3).map(|axis| body.position[axis] * body.velocity[axis]).sum::<f64>() > 0.0
    };
    assert!(plain.iter().filter(outwards).count() > 15, "bodies have collided");
    for (length, mass, time) in
        [(2f64.powi(-30), 2f64.powi(-77), 2f64.powi(-40)), (2f64.powi(20), 2f64.powi(60), 2f64.powi(10))]
    {
        for (a, b) in plain.iter().zip(run(&cluster(length, mass, time))) {
            for axis in 0..3 {
                assert_eq!((a.position[axis] * length).to_bits(), b.position[axis].to_bits());
                assert_eq!((a.velocity[axis] * length / time).to_bits(), b.velocity[axis].to_bits());
                assert_eq!((a.spin[axis] / time).to_bits(), b.spin[axis].to_bits());
            }
        }
    }
    let (length, mass, time) = (1e-9, 1e-23, 1e-11);
    for (a, b) in plain.iter().zip(run(&cluster(length, mass, time))) {
        for axis in 0..3 {
            assert!((a.velocity[axis] - b.velocity[axis] * time / length).abs() < 1e-9, "{a:?} {b:?}");
        }
    }
}

/// Case X17: a pass that overlaps by 1e-12 of a diameter is seen once and deflects by next to nothing.
#[test]
fn grazing() {
    for (gap, touches) in [(-1e-12, true), (1e-12, false)] {
        let balls = [ball([0.0; 3], [1.0, 0.0, 0.0]), ball([3e-7, 0.02 * (1.0 + gap), 0.0], [0.0; 3])];
        let text = scene(
            &balls,
            "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
            "driver: TimeStep(step: 1e-8), run: (steps: 60)",
        );
        let mut driver = driver(&text);
        let mut touched = 0;
        for at in 1..=60 {
            advance(&mut driver, at);
            touched += driver.view().tally().contacts;
        }
        // The chord of the pass is 2 d sqrt(2e-12) = 5.7e-8 m, which takes 5 to 6 steps.
        assert!(if touches { (5..=6).contains(&touched) } else { touched == 0 }, "{gap}: {touched}");
        let end = bodies(&driver);
        assert!((end[0].velocity[0] - 1.0).abs() < 1e-12 && end[0].velocity[1].abs() < 1e-6, "{end:?}");
    }
}

fn energy(driver: &TimeStepDriver) -> f64 {
    bodies(driver)
        .iter()
        .map(|body| {
            let square = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>();
            0.5 * 0.01 * square(body.velocity) + 0.5 * 0.4 * 0.01 * 1e-4 * square(body.spin)
        })
        .sum()
}

/// Case X19: at ω R = 10^6 v friction stays at its limit against the slip, and no energy appears.
#[test]
fn extreme_spin() {
    let mut balls = head_on(0.01, 0.01);
    balls[0].spin = [0.0, 0.0, 1e8];
    for laws in [
        "tangential: TangentialSpring(stiffness: 3e3, friction: 0.3)",
        "tangential: Coulomb(friction: 0.3)",
        "tangential: ViscousTangential(damping: 1, friction: 0.3)",
    ] {
        let text = scene(
            &balls,
            &format!("normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), {laws}"),
            "driver: TimeStep(), run: (duration: 4e-3)",
        );
        let mut driver = driver(&text);
        let steps = driver.view().plan().driver.steps;
        let mut before = energy(&driver);
        let mut slid = false;
        for at in 1..=steps {
            advance(&mut driver, at);
            let state = bodies(&driver);
            // Components along the line of centres and at right angles to it, in the plane of the motion.
            let [x, y] = [0, 1].map(|k| state[1].position[k] - state[0].position[k]);
            let distance = (x * x + y * y).sqrt();
            let force = state[0].force;
            let normal = (force[0] * x + force[1] * y) / distance;
            let tangential = (force[1] * x - force[0] * y) / distance;
            assert!(
                tangential.abs() <= 0.3 * normal.abs() * (1.0 + 1e-12) + 1e-300,
                "{laws}: {:?}",
                state[0]
            );
            // The spin about +z moves the contact point of the first body up; the force on it is down.
            assert!(tangential <= 0.0, "{laws}: {:?}", state[0]);
            slid |= tangential < 0.0;
            let after = energy(&driver);
            // The energy of the spin is 2e9 J, whose ulp is 2e-7 J.
            assert!(after <= before * (1.0 + 1e-15 * 8.0), "{laws}: {before} {after}");
            before = after;
        }
        assert!(slid, "{laws}");
    }
}

/// Case X20: a spin about the line of centres meets no friction.
#[test]
fn drilling_meets_no_friction() {
    let mut balls = head_on(0.01, 0.01);
    balls[0].spin = [1e6, 0.0, 0.0];
    let text = scene(
        &balls,
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), tangential: TangentialSpring(stiffness: 3e3, \
         friction: 0.3)",
        "driver: TimeStep(), run: (duration: 4e-3)",
    );
    let end = run(&text);
    assert!(end[0].velocity[0] < 0.2, "they have collided");
    for (body, spin) in end.iter().zip([1e6, 0.0]) {
        assert_eq!(body.spin, [spin, 0.0, 0.0]);
        assert_eq!(body.velocity[1..], [0.0, 0.0]);
    }
}

/// Friction of zero is no friction, and infinite friction never slides.
#[test]
fn friction_of_zero_and_infinity() {
    let mut balls = head_on(0.01, 0.01);
    balls[0].velocity[1] = 0.5;
    let end = |friction: &str| {
        run(&scene(
            &balls,
            &format!(
                "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), tangential: TangentialSpring(stiffness: \
                 3e3, friction: {friction})"
            ),
            "driver: TimeStep(), run: (duration: 4e-3)",
        ))
    };
    assert!(end("0").iter().all(|body| body.spin == [0.0; 3]));
    let (large, infinite) = (end("1e6"), end("inf"));
    assert!(infinite[0].spin[2].abs() > 1.0);
    for (a, b) in large.iter().zip(&infinite) {
        assert!((a.spin[2] - b.spin[2]).abs() < 1e-2 * b.spin[2].abs(), "{a:?} {b:?}");
    }
}

/// Case X24: speeds below the smallest normal number.
#[test]
fn denormal_velocities() {
    let mut balls = [ball([0.0; 3], [1e-310, 3e-320, 0.0]), ball([0.02, 0.0, 0.0], [0.0; 3])];
    balls[0].spin = [0.0, 0.0, 1e-312];
    for law in ["TangentialSpring(stiffness: 3e3, friction: 0.3)", "Coulomb(friction: 0.3)"] {
        let end = run(&scene(
            &balls,
            &format!("normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), tangential: {law}"),
            "allow_overlap: true, driver: TimeStep(), run: (duration: 1e-2)",
        ));
        assert!(end.iter().all(|body| body.velocity.iter().all(|v| v.abs() <= 1e-310)), "{law}: {end:?}");
    }
}

/// Case X27: bodies at rest that do not touch stay where they are, to the bit.
#[test]
fn nothing_happens_where_nothing_acts() {
    let text = r#"(version: 1, seed: 4, materials: { "a": (density: 1000) },
        bodies: [Lattice(material: "a", radius: 0.01, spacing: 0.021, lo: (0, 0, 0), hi: (0.44, 0.44, 0.44), jitter: 4e-4)],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8),
            tangential: TangentialSpring(stiffness: 3e3, friction: 0.3))],
        driver: TimeStep(), run: (steps: 1000))"#;
    let start = bodies(&driver(text));
    assert!(start.len() > 9000, "{}", start.len());
    assert_eq!(start, run(text));
}

/// Case X36: without friction spins never change.
#[test]
fn spins_stay_without_friction() {
    let mut balls = head_on(0.01, 0.01);
    balls[0].spin = [1.0, 2.0, 3.0];
    let text = scene(
        &balls,
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
        "driver: TimeStep(), run: (duration: 4e-3)",
    );
    let driver = driver(&text);
    assert!(!driver.view().plan().rotation, "nothing turns, so no spins are stored");
    let end = run(&text);
    assert!(end[0].velocity[0] < 0.2, "they have collided");
    assert!(end.iter().all(|body| body.torque == [0.0; 3]));
}

/// Case X42: a body that crosses the periodic cell 3.7 times in a step still meets what is there.
#[test]
fn many_periods_in_one_step() {
    let balls = [ball([0.01, 0.05, 0.05], [3.7e4, 0.0, 0.0]), ball([0.05, 0.05, 0.02], [3.7e4, 0.0, 0.0])];
    let text = scene(
        &balls,
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
        "cell: (lo: (0, 0, 0), hi: (0.1, 0.1, 0.1), periodic: (true, true, true)), driver: TimeStep(step: 1e-5), run: \
         (steps: 1000)",
    );
    let driver_end = {
        let mut driver = driver(&text);
        advance(&mut driver, 1000);
        driver
    };
    let cell = driver_end.view().plan().cell;
    for (body, start) in bodies(&driver_end).iter().zip(&balls) {
        let wrapped = cell.wrap(body.position).0;
        let travelled = 3.7e4 * 1e-5 * 1000.0;
        let expected = (start.position[0] + travelled).rem_euclid(0.1);
        // The position is a sum of a thousand steps of 0.37 m in a cell of 0.1 m or at 370 m: 1000 ulps of 6e-14 m.
        assert!((wrapped[0] - expected).abs() < 1e-10, "{wrapped:?} {expected}");
        assert!((0.0..0.1).contains(&wrapped[0]));
    }
}

/// Positions of 10^9 radii leave an ulp of 1e-7 radii, and the impact is right to what that leaves.
#[test]
fn far_from_the_origin() {
    let at = |origin: f64| {
        let mut balls = head_on(1.0, 1.0);
        for ball in &mut balls {
            ball.radius = 1.0;
            ball.position[0] = origin + 102.0 * ball.position[0];
        }
        run(&scene(
            &balls,
            "normal: LinearSpringDashpot(stiffness: 50, restitution: 0.8)",
            "driver: TimeStep(step: 1e-3), run: (duration: 1)",
        ))
    };
    let (near, far) = (at(0.0), at(1e9));
    assert!(near[0].velocity[0] < 0.2, "they have collided");
    for (a, b) in near.iter().zip(&far) {
        // Steps of 1e-3 m are rounded to multiples of 1.2e-7 m: 1e-4 of every step, at random in sign.
        assert!((a.velocity[0] - b.velocity[0]).abs() < 1e-3, "{a:?} {b:?}");
    }
}

/// A sphere in a wedge of 60 degrees rests on both sides, each with its weight / (2 sin 30°).
#[test]
fn wedge() {
    let text = r#"(version: 1, gravity: (0, 0, -9.81), materials: { "a": (density: 2500) },
        bodies: [Sphere(material: "a", radius: 0.01, position: (0, 0, 0.0201))],
        walls: { "left": Plane(point: (0, 0, 0), normal: (0.8660254037844386, 0, 0.5), material: "a"),
                 "right": Plane(point: (0, 0, 0), normal: (-0.8660254037844386, 0, 0.5), material: "a") },
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.3))],
        driver: TimeStep(), run: (duration: 1))"#;
    let end = run(text);
    let weight = 4.0 / 3.0 * std::f64::consts::PI * 1e-6 * 2500.0 * 9.81;
    let overlap = weight / 1e4;
    // Two springs at 30 degrees above the horizontal carry N = W / (2 sin 30°) = W each, an overlap of W/k.
    assert!((end[0].position[2] - (0.02 - 2.0 * overlap)).abs() < 1e-3 * overlap, "{:?} {overlap}", end[0]);
    assert!(end[0].position[0].abs() < 1e-15 && end[0].velocity[2].abs() < 1e-9);
}

/// Size ratio 1:1000: the light sphere bounces off the large one, whose surface is a plane to it.
#[test]
fn size_ratio_of_a_thousand() {
    let mut balls = head_on(1e-12, 1e-3);
    balls[0].radius = 1e-5;
    balls[1].position[0] = 0.010_012;
    let end = run(&scene(
        &balls,
        "normal: LinearSpringDashpot(stiffness: 10, restitution: 0.8)",
        "driver: TimeStep(step: Auto(steps_per_contact: 1000)), run: (duration: 1e-5)",
    ));
    // First order in the step: 2e-4 at a thousand steps a contact.
    assert!((end[0].velocity[0] + 0.8).abs() < 5e-4, "{end:?}");
}

/// Case X50: a single body flies freely; its time is the number of steps times the step, not a sum.
#[test]
fn one_body() {
    let text = scene(
        &[ball([0.0; 3], [1.0, 0.0, 0.0])],
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
        "gravity: (0, 0, -10), driver: TimeStep(step: 1e-3), run: (duration: 1)",
    );
    let mut driver = driver(&text);
    advance(&mut driver, 1000);
    assert_eq!(driver.view().time(), 1.0);
    let end = bodies(&driver)[0];
    assert!((end.position[2] + 5.0).abs() < 1e-12 && (end.position[0] - 1.0).abs() < 1e-12, "{end:?}");
}
