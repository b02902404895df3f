//! Hard bodies that slide and roll along arcs between collisions: the closed forms of Kondic 1999 with errata, the ledger,
//! shaken and tilted plates.

use std::sync::atomic::AtomicBool;

use granule_closed_forms::kondic::{Spheres, after};
use granule_drivers::{Driver, RollingDriver, driver};
use granule_observers::Energy;
use granule_tests::{BodyState, plan};

const R: f64 = 2e-3;
const G: f64 = 9.81;
const SHAPES: [(&str, f64); 3] =
    [("Sphere(", 0.4), ("HollowSphere(", 2.0 / 3.0), ("Body(inertia_factor: 0.5, ", 0.5)];

fn start(text: &str) -> RollingDriver {
    RollingDriver::new(plan(text)).unwrap()
}

fn advance(driver: &mut dyn Driver, step: u64) {
    driver.advance(step, &AtomicBool::new(false)).unwrap();
}

fn states(driver: &dyn Driver) -> Vec<BodyState> {
    let view = driver.view();
    let rows = view.bodies();
    let state = |place: &u32| {
        let place = *place as usize;
        BodyState {
            position: rows.position[place].vector(),
            velocity: rows.velocity_of(place),
            spin: rows.spin_of(place),
            force: rows.force_of(place),
            torque: rows.torque_of(place),
        }
    };
    view.order().iter().map(state).collect()
}

fn slip(body: &BodyState) -> f64 {
    body.velocity[0] - R * body.spin[1]
}

/// Two rolling bodies that touch at the start and approach along x.
fn pair(shape: &str, velocities: [f64; 2], rule: &str, slides: &str, step: f64) -> String {
    let body = |x: f64, v: f64| {
        format!(
            "{shape}material: \"steel\", radius: {R}, position: ({x}, 0, {R}), velocity: ({v}, 0, 0), spin: (0, {}, 0))",
            v / R
        )
    };
    format!(
        "(version: 1, gravity: (0, 0, -{G}), materials: {{ \"steel\": (density: 7850) }},
          bodies: [{}, {}],
          substrate: (laws: {{ \"steel\": StickSlip(static_friction: 0.5, kinetic_friction: 0.1) }}),
          contacts: [(between: (\"steel\", \"steel\"), collision: {rule})],
          driver: Event(step: {step:e}, slides: {slides}), run: (duration: 10), ledger: true)",
        body(R + 1e-10, velocities[0]),
        body(-R, velocities[1]),
    )
}

#[test]
fn slides_after_collisions_are_the_closed_forms() {
    let step = 1e-6;
    for (shape, factor) in SHAPES {
        let spheres = Spheres {
            inertia_number: 1.0 / factor,
            radius: R,
            gravity: G,
            static_friction: 0.5,
            kinetic_friction: 0.1,
        };
        for velocities in [[-0.05, 0.05], [0.0, 0.1], [-0.03, 0.07]] {
            for restitution in [0.9, 0.6] {
                let rule = format!("HardSphere(restitution: {restitution})");
                let mut driver = start(&pair(shape, velocities, &rule, "Arcs()", step));
                advance(&mut driver, 1);
                let begin = states(&driver);
                assert_eq!(driver.counts().collisions, 1);
                let expected = after::slides(&spheres, velocities[0], velocities[1], restitution, 0.0);
                let mut done = [false; 2];
                let mut now = 1;
                while done != [true; 2] {
                    now += 1;
                    advance(&mut driver, now);
                    for (k, body) in states(&driver).iter().enumerate() {
                        if done[k] || slip(body).abs() > 1e-12 {
                            continue;
                        }
                        done[k] = true;
                        let expected = expected[k];
                        // Times are looked at in steps of 1e-6 s, a share of 1e-4 of the shortest slide; everything else
                        // is exact but for the free way of 1e-10 m before the collision.
                        let duration = (now - 1) as f64 * step;
                        let near = |found: f64, expected: f64, scale: f64| {
                            assert!(
                                (found - expected).abs() < 2e-4 * scale,
                                "{shape} {velocities:?} {found} {expected}"
                            );
                        };
                        near(begin[k].velocity[0], expected.velocity, 0.1);
                        near(slip(&begin[k]), expected.slip, 0.1);
                        near(duration, expected.duration, expected.duration);
                        near(body.velocity[0], expected.final_velocity, 0.05);
                        let way = body.position[0] - begin[k].position[0];
                        near(way, expected.distance, 0.1 * expected.duration);
                        let energy = begin[k].velocity[0].powi(2) - body.velocity[0].powi(2);
                        near(energy, expected.energy_loss(), 0.0025);
                        near(begin[k].velocity[0] - body.velocity[0], expected.momentum_loss(), 0.05);
                    }
                    assert!(now < 200_000, "they do not stop slipping");
                }
                let end = states(&driver);
                let effective = (end[0].velocity[0] - end[1].velocity[0]) / (velocities[1] - velocities[0]);
                let closed = after::effective_restitution(spheres.inertia_number, restitution);
                assert!((effective - closed).abs() < 1e-9, "{effective} {closed}");
            }
        }
    }
}

#[test]
fn without_slides_a_collision_has_the_effective_restitution() {
    for (shape, factor) in SHAPES {
        for velocities in [[-0.05, 0.05], [0.0, 0.1], [-0.03, 0.07]] {
            for restitution in [1.0, 0.9, 0.6] {
                let rule = format!("HardSphere(restitution: {restitution})");
                let mut driver = start(&pair(shape, velocities, &rule, "EffectiveRestitution", 1e-6));
                let begin = Energy::of(&driver.view());
                advance(&mut driver, 1);
                let after = states(&driver);
                let effective =
                    (after[0].velocity[0] - after[1].velocity[0]) / (velocities[1] - velocities[0]);
                // They would approach again below zero, and then stop each other (erratum K-E40).
                let closed = after::effective_restitution(1.0 / factor, restitution).max(0.0);
                assert!((effective - closed).abs() < 1e-9, "{effective} {closed}");
                for body in &after {
                    assert!(slip(body).abs() < 1e-12, "{body:?}");
                }
                let residual = Energy::of(&driver.view()).residual_since(&begin);
                assert!(residual.abs() < 1e-12 * begin.kinetic, "{residual}");
            }
        }
    }
}

/// A periodic shaken layer with two kinds of beads between two walls, and a driver.
fn layer(slides: &str, motion: &str, gravity: &str, duration: f64, step: f64) -> String {
    // Velocities of a golden-ratio sequence.
    let bodies: String = (0..200)
        .map(|k| {
            let (x, y) = (0.004 * f64::from(k % 20) + 0.002, 0.004 * f64::from(k / 20) + 0.002);
            let name = if k % 2 == 0 { "smooth" } else { "rough" };
            let part = |by: f64| (f64::from(k) * by).fract() - 0.5;
            let (u, v) = (0.1 * part(0.618_033_988_75), 0.1 * part(0.754_877_666_25));
            format!(
                "Sphere(material: \"{name}\", radius: 0.001, position: ({x}, {y}, 0.001), velocity: ({u}, {v}, 0)),"
            )
        })
        .collect();
    format!(
        r#"(version: 1, seed: 3, gravity: {gravity},
          cell: (lo: (0, 0, 0), hi: (0.08, 0.04, 0.01), periodic: (false, true, false)),
          materials: {{ "smooth": (density: 7850), "rough": (density: 7850) }},
          walls: {{
            "left": Plane(point: (0, 0, 0), normal: (1, 0, 0), material: "smooth", motion: {motion}),
            "right": Plane(point: (0.08, 0, 0), normal: (-1, 0, 0), material: "smooth", motion: {motion}),
          }},
          bodies: [{bodies}],
          substrate: (motion: {motion}, laws: {{
            "smooth": StickSlip(static_friction: 0.5, kinetic_friction: 0.1, rolling_friction: 0.001),
            "rough": StickSlip(static_friction: 0.5, kinetic_friction: 0.1, rolling_friction: 0.05),
          }}),
          contacts: [
            (between: ("smooth", "smooth"), collision: HardSphere(restitution: 0.9, friction: 0.2)),
            (between: ("smooth", "rough"), collision: HardSphere(restitution: 0.9, friction: 0.2)),
            (between: ("rough", "rough"), collision: HardSphere(restitution: 0.9, friction: 0.2)),
          ],
          driver: Event(step: {step}, slides: {slides}), run: (duration: {duration}), ledger: true)"#
    )
}

const SHAKEN: &str = "Sinusoidal(amplitude: (0.004, 0.001, 0), frequency: 5)";

#[test]
fn the_ledger_closes_with_the_work_of_the_plate() {
    for slides in ["Arcs()", "EffectiveRestitution"] {
        for gravity in ["(0, 0, -9.81)", "(0.2, 0.3, -9.8)"] {
            let mut driver = start(&layer(slides, SHAKEN, gravity, 1.0, 0.1));
            let begin = Energy::of(&driver.view());
            advance(&mut driver, 10);
            let end = Energy::of(&driver.view());
            let (residual, exchanged) = (
                end.residual_since(&begin).abs(),
                end.wall_work.abs() + end.dissipated_friction + end.dissipated_viscous,
            );
            assert!(driver.counts().all() > 500, "{:?}", driver.counts());
            assert!(exchanged > 3.0 * begin.kinetic, "{begin:?} {end:?}");
            // Every piece is exact; what is left is what counts as no slip, 1e-12 of a velocity, and round-off.
            assert!(residual < 1e-9 * exchanged, "{slides} {gravity}: {residual} of {exchanged}");
        }
    }
}

#[test]
fn on_a_shaken_plate_a_body_rolls_with_two_sevenths_and_slips_from_the_threshold_on() {
    let scene = |acceleration: f64| {
        let omega = 2.0 * std::f64::consts::PI * 10.0;
        format!(
            "(version: 1, gravity: (0, 0, -{G}), materials: {{ \"steel\": (density: 7850) }},
              bodies: [Sphere(material: \"steel\", radius: {R}, position: (0, 0, {R}), velocity: ({}, 0, 0), spin: (0, {}, 0))],
              substrate: (motion: Sinusoidal(amplitude: ({}, 0, 0), frequency: 10), laws: {{
                \"steel\": StickSlip(static_friction: 0.5, kinetic_friction: 0.1) }}),
              driver: Event(step: 1e-3), run: (duration: 10))",
            // Rolls as if it had been at rest before: 2/7 of the plate, which moves at the start.
            2.0 / 7.0 * acceleration / omega,
            -5.0 / 7.0 * acceleration / omega / R,
            acceleration / omega / omega,
        )
    };
    // 3.5 μ_s g, Eq. (19).
    let threshold = 3.5 * 0.5 * G;
    let mut below = start(&scene(0.999 * threshold));
    let omega: f64 = 2.0 * std::f64::consts::PI * 10.0;
    for step in 1..=1000 {
        advance(&mut below, step);
        let body = states(&below)[0];
        let plate = 0.999 * threshold / omega / omega * (omega * below.time()).sin();
        assert!((body.position[0] - 2.0 / 7.0 * plate).abs() < 1e-9 * plate.abs().max(1e-3), "{body:?}");
    }
    assert_eq!(below.view().substrate().sliding, 0);
    let mut above = start(&scene(1.001 * threshold));
    let slips = (1..=100).any(|step| {
        advance(&mut above, step);
        above.view().substrate().sliding == 1
    });
    assert!(slips);
}

/// The time-stepped driver on the same substrate, without collisions: the error of both falls with its step and with the
/// error of the arcs.
#[test]
fn a_bead_on_a_tilted_shaken_plate_goes_as_in_time_steps() {
    let scene = |driver: &str| {
        format!(
            "(version: 1, gravity: (0.4, -0.3, -{G}), materials: {{ \"steel\": (density: 7850) }},
              bodies: [Sphere(material: \"steel\", radius: {R}, position: (0, 0, {R}), velocity: (0.3, 0.2, 0), spin: (30, -20, 10))],
              substrate: (motion: Sinusoidal(amplitude: (2e-3, 1e-3, 0), frequency: 10, phase: 0.7), laws: {{
                \"steel\": StickSlip(static_friction: 0.05, kinetic_friction: 0.04, drilling_friction: 0.1) }},
                rolling_friction: {{ \"steel\": [(0, 0.001), (0.5, 0.01)] }}),
              {driver}, run: (duration: 1))"
        )
    };
    let end = |block: &str| {
        let plan = plan(&scene(block));
        let steps = plan.driver.steps;
        let mut driver = driver(plan, Some(1)).unwrap();
        advance(&mut *driver, steps);
        states(&*driver)[0]
    };
    let off = |a: &BodyState, b: &BodyState| {
        (0..2).map(|k| (a.position[k] - b.position[k]).abs()).fold(0.0, f64::max)
    };
    let arcs = end("driver: Event(slides: Arcs(error: 1e-13))");
    let coarse = end("driver: Event(slides: Arcs(error: 1e-7))");
    let steps = end("driver: TimeStep(step: 1e-6)");
    // Slip and grip begin at a step, an error of the first order: 1e-6 s of 0.3 m/s a switch, of which a second has 40.
    assert!(off(&arcs, &steps) < 1e-5, "{arcs:?} {steps:?}");
    // 100 pieces of 10 ms with an error of 1e-7 m each change the velocity by 2e-5 m/s at most, which acts for a second.
    assert!(off(&arcs, &coarse) < 2e-4, "{arcs:?} {coarse:?}");
}

#[test]
fn a_run_may_be_cut_into_any_steps() {
    let end = |step: f64| {
        let mut driver = start(&layer("Arcs()", SHAKEN, "(0.1, 0, -9.81)", 0.4, step));
        let steps = (0.4_f64 / step).round() as u64;
        advance(&mut driver, steps);
        states(&driver)
    };
    assert_eq!(end(0.4), end(0.1));
}

/// A random layer is a lattice with displacements and velocities along the plate.
#[test]
fn a_random_layer_lies_on_the_plate() {
    let text = format!(
        r#"(version: 1, gravity: (0, 0, -{G}), materials: {{ "steel": (density: 7850) }},
          cell: (lo: (0, 0, 0), hi: (0.06, 0.06, 0.01), periodic: (true, true, false)),
          bodies: [Lattice(material: "steel", radius: {R}, kind: Cubic, spacing: 0.006, jitter: 0.0009,
                           lo: (0.003, 0.003, {R}), hi: (0.057, 0.057, 0.0021), velocity_spread: 0.1)],
          substrate: (laws: {{ "steel": StickSlip(friction: 0.1) }}),
          contacts: [(between: ("steel", "steel"), collision: HardSphere(restitution: 0.9))],
          driver: Event(), run: (duration: 1))"#
    );
    let mut driver = start(&text);
    let begin = states(&driver);
    assert_eq!(begin.len(), 100);
    assert!(begin.iter().any(|body| body.velocity[1].abs() > 0.05));
    advance(&mut driver, 100);
    for body in begin.iter().chain(&states(&driver)) {
        assert_eq!((body.position[2], body.velocity[2]), (R, 0.0));
    }
    assert!(driver.counts().collisions > 50, "{:?}", driver.counts());
}
