//! Units and sizes: nothing in the engine has a size of its own.

use crate::run::{Body, ensure};
use crate::scene::{Ball, head_on, scene};
use crate::{Case, Lab};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "unit-systems",
        extreme: "lengths, masses and times scaled by powers of two from 2^-77 to 2^60",
        expected: "the same bits",
        slow: false,
        check: unit_systems,
    },
    Case {
        name: "nanometres",
        extreme: "grains of 1e-9 m and 1e-23 kg",
        expected: "the same dimensionless result as in metres, to 1e-9 after two or three collisions a body",
        slow: false,
        check: |lab| other_units(lab, 1e-9, 1e-23, 1e-11),
    },
    Case {
        name: "megametres",
        extreme: "grains of 1e6 m and 1e21 kg",
        expected: "the same dimensionless result as in metres, to 1e-9 after two or three collisions a body",
        slow: false,
        check: |lab| other_units(lab, 1e6, 1e21, 1e3),
    },
    Case {
        name: "size-ratio",
        extreme: "a sphere of 10 um on one of 10 mm (1:1000), masses 1:1e9",
        expected: "it bounces as from a plane: -e v, to 5e-4 at a thousand steps a contact",
        slow: false,
        check: size_ratio,
    },
];

/// An irregular frictional cluster under gravity that falls in on itself, in units of `length`, `mass` and `time`.
fn cluster(lab: &Lab, length: f64, mass: f64, time: f64) -> Result<Vec<Body>, String> {
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
                frozen: false,
            }
        })
        .collect();
    lab.run(&scene(
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
    ))
}

/// The cluster in metres; most of its bodies have been thrown back.
fn plain(lab: &Lab) -> Result<Vec<Body>, String> {
    let end = cluster(lab, 1.0, 1.0, 1.0)?;
    let outwards =
        |body: &&Body| (0..3).map(|axis| body.position[axis] * body.velocity[axis]).sum::<f64>() > 0.0;
    let thrown = end.iter().filter(outwards).count();
    ensure(thrown > 15, || format!("only {thrown} of 24 bodies have collided"))?;
    Ok(end)
}

fn unit_systems(lab: &Lab) -> Result<String, String> {
    let plain = plain(lab)?;
    let (small, large) =
        ((2f64.powi(-30), 2f64.powi(-77), 2f64.powi(-40)), (2f64.powi(20), 2f64.powi(60), 2f64.powi(10)));
    for (length, mass, time) in [small, large] {
        for (a, b) in plain.iter().zip(cluster(lab, length, mass, time)?) {
            let same = (0..3).all(|axis| {
                a.position[axis] * length == b.position[axis]
                    && a.velocity[axis] * length / time == b.velocity[axis]
                    && a.spin[axis] / time == b.spin[axis]
            });
            ensure(same, || format!("length {length:e}: {a:?} {b:?}"))?;
        }
    }
    Ok("the same bits".to_string())
}

fn other_units(lab: &Lab, length: f64, mass: f64, time: f64) -> Result<String, String> {
    let mut worst: f64 = 0.0;
    for (a, b) in plain(lab)?.iter().zip(cluster(lab, length, mass, time)?) {
        for axis in 0..3 {
            worst = worst.max((a.velocity[axis] - b.velocity[axis] * time / length).abs());
        }
    }
    ensure(worst < 1e-9, || format!("velocities differ by {worst:e}"))?;
    Ok(format!("velocities differ by {worst:.0e}"))
}

fn size_ratio(lab: &Lab) -> Result<String, String> {
    let mut balls = head_on(1e-12, 1e-3);
    balls[0].radius = 1e-5;
    balls[1].position[0] = 0.010_012;
    let end = lab.run(&scene(
        &balls,
        "normal: LinearSpringDashpot(stiffness: 10, restitution: 0.8)",
        "driver: TimeStep(step: Auto(steps_per_contact: 1000)), run: (duration: 1e-5)",
    ))?;
    let velocity = end[0].velocity[0];
    ensure((velocity + 0.8).abs() < 5e-4, || format!("velocity {velocity}"))?;
    Ok(format!("velocity {velocity:.5} m/s"))
}
