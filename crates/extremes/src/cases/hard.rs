//! Hard bodies from collision to collision.

use crate::run::{advance, bodies, ensure, start};
use crate::scene::{Ball, ball, head_on, scene};
use crate::{Case, Lab};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "plastic-hard",
        extreme: "hard bodies with a restitution of exactly 0",
        expected: "one common velocity to 1e-15, one collision",
        slow: false,
        check: plastic_hard,
    },
    Case {
        name: "mass-ratio-hard",
        extreme: "hard bodies with a mass ratio of 1e12",
        expected: "the light one comes back with -e v, to 1e-11",
        slow: false,
        check: mass_ratio_hard,
    },
    Case {
        name: "grazing-hard",
        extreme: "hard bodies that pass at (1 - 1e-12) and (1 + 1e-12) diameters",
        expected: "one collision, and none",
        slow: false,
        check: grazing_hard,
    },
    Case {
        name: "inelastic-collapse",
        extreme: "100 hard bodies with restitution 0.1 driven against a wall: infinitely many collisions in finite time",
        expected: "time goes on: fewer than 1e4 collisions a body in 5 s; no overlap beyond 1e-9 of a radius",
        slow: false,
        check: inelastic_collapse,
    },
    Case {
        name: "three-body-collapse",
        extreme: "three hard bodies in a row with restitution 0.05, below the limit 7 - 4 sqrt(3) of collapse",
        expected: "time goes on: fewer than 100 collisions; momentum is kept to 1e-12",
        slow: false,
        check: three_body_collapse,
    },
    Case {
        name: "simultaneous-events",
        extreme: "1e4 pairs that collide at the same time",
        expected: "1e4 collisions, each pair exchanges its velocities, to 1e-12",
        slow: false,
        check: |lab| simultaneous(lab, 10_000),
    },
    Case {
        name: "simultaneous-events-million",
        extreme: "1e6 pairs that collide at the same time",
        expected: "1e6 collisions, each pair exchanges its velocities, to 1e-12",
        slow: true,
        check: |lab| simultaneous(lab, 1_000_000),
    },
];

fn plastic_hard(lab: &Lab) -> Result<String, String> {
    let text = scene(
        &head_on(0.01, 0.01),
        "collision: HardSphere(restitution: 0)",
        "driver: Event(), run: (duration: 1)",
    );
    let plan = lab.plan(&text)?.plan;
    let mut driver = start(&plan)?;
    advance(&mut *driver, plan.driver.steps)?;
    let view = driver.view();
    let end = bodies(&view);
    let collisions = view.events().map_or(0, |counts| counts.all());
    let apart = (end[1].velocity[0] - end[0].velocity[0]).abs();
    ensure(apart < 1e-15 && (end[0].velocity[0] - 0.5).abs() < 1e-15, || format!("{end:?}"))?;
    ensure(collisions == 1, || format!("{collisions} collisions"))?;
    Ok(format!("velocities differ by {apart:e} m/s after {collisions} collision"))
}

fn mass_ratio_hard(lab: &Lab) -> Result<String, String> {
    let end = lab.run(&scene(
        &head_on(0.01, 1e10),
        "collision: HardSphere(restitution: 0.8)",
        "driver: Event(), run: (duration: 0.01)",
    ))?;
    let off = (end[0].velocity[0] + 0.8).abs();
    ensure(off < 1e-11, || format!("{end:?}"))?;
    Ok(format!("velocity off by {off:.0e} m/s"))
}

fn grazing_hard(lab: &Lab) -> Result<String, String> {
    let mut found = Vec::new();
    for (gap, expected) in [(-1e-12, 1), (1e-12, 0)] {
        let balls = [ball([0.0; 3], [1.0, 0.0, 0.0]), ball([0.05, 0.02 * (1.0 + gap), 0.0], [0.0; 3])];
        let text =
            scene(&balls, "collision: HardSphere(restitution: 0.8)", "driver: Event(), run: (duration: 0.1)");
        let plan = lab.plan(&text)?.plan;
        let mut driver = start(&plan)?;
        advance(&mut *driver, plan.driver.steps)?;
        let collisions = driver.view().events().map_or(0, |counts| counts.all());
        ensure(collisions == expected, || format!("gap {gap:e} d: {collisions} collisions"))?;
        found.push(collisions.to_string());
    }
    Ok(format!("{} collisions", found.join(" and ")))
}

/// Collisions of a run, and the deepest overlap of its end over a radius.
fn collapse(lab: &Lab, text: &str) -> Result<(u64, f64, f64), String> {
    let plan = lab.plan(text)?.plan;
    let mut driver = start(&plan)?;
    advance(&mut *driver, plan.driver.steps)?;
    ensure(driver.step() == plan.driver.steps, || format!("it stands at step {}", driver.step()))?;
    let view = driver.view();
    let end = bodies(&view);
    let mut deepest: f64 = 0.0;
    for (k, a) in end.iter().enumerate() {
        for b in &end[k + 1..] {
            let square: f64 = (0..3).map(|axis| (a.position[axis] - b.position[axis]).powi(2)).sum();
            deepest = deepest.max((0.02 - square.sqrt()) / 0.01);
        }
    }
    let momentum = end.iter().map(|body| body.velocity[0]).sum();
    Ok((view.events().map_or(0, |counts| counts.all()), deepest, momentum))
}

fn inelastic_collapse(lab: &Lab) -> Result<String, String> {
    let balls: Vec<Ball> =
        (0..100).map(|k| ball([0.01 + 0.021 * f64::from(k), 0.0, 0.0], [-1.0, 0.0, 0.0])).collect();
    let text = scene(
        &balls,
        "collision: HardSphere(restitution: 0.1)",
        r#"walls: { "end": Plane(point: (0, 0, 0), normal: (1, 0, 0), material: "a") }, driver: Event(), run: (duration: 5)"#,
    );
    let (collisions, deepest, _) = collapse(lab, &text)?;
    ensure(collisions < 1_000_000 && deepest < 1e-9, || {
        format!("{collisions} collisions, overlap {deepest:e} R")
    })?;
    Ok(format!("{collisions} collisions, overlap {:.0e} R", deepest.max(0.0)))
}

fn three_body_collapse(lab: &Lab) -> Result<String, String> {
    let balls = [
        ball([0.0; 3], [1.0, 0.0, 0.0]),
        ball([0.03, 0.0, 0.0], [0.0; 3]),
        ball([0.06, 0.0, 0.0], [-1.0, 0.0, 0.0]),
    ];
    let text =
        scene(&balls, "collision: HardSphere(restitution: 0.05)", "driver: Event(), run: (duration: 1)");
    let (collisions, deepest, momentum) = collapse(lab, &text)?;
    ensure(collisions < 100 && deepest < 1e-9, || format!("{collisions} collisions, overlap {deepest:e} R"))?;
    ensure(momentum.abs() < 1e-12, || format!("momentum {momentum:e}"))?;
    Ok(format!("{collisions} collisions, momentum {:.0e}", momentum.abs()))
}

fn simultaneous(lab: &Lab, pairs: usize) -> Result<String, String> {
    let side = (pairs as f64).sqrt().round();
    // They are two radii apart and meet at t = 1. Two lattices of one layer each.
    let layer = |x: f64, velocity: f64| {
        let last = 4.0 * (side - 0.9);
        format!(
            "Lattice(material: \"a\", radius: 1, spacing: 4, lo: ({x:?}, 0, 0), hi: ({x:?}, {last:?}, {last:?}), velocity: \
             ({velocity:?}, 0, 0))"
        )
    };
    let text = format!(
        r#"(version: 1, materials: {{ "a": (density: 1000) }}, bodies: [{}, {}],
        contacts: [(between: ("a", "a"), collision: HardSphere(restitution: 1))], driver: Event(), run: (duration: 1.5))"#,
        layer(0.0, 1.0),
        layer(4.0, -1.0)
    );
    let plan = lab.plan(&text)?.plan;
    let mut driver = start(&plan)?;
    advance(&mut *driver, plan.driver.steps)?;
    let view = driver.view();
    let collisions = view.events().map_or(0, |counts| counts.all());
    ensure(collisions == pairs as u64, || format!("{collisions} collisions of {pairs} pairs"))?;
    let mut worst: f64 = 0.0;
    for (rank, body) in bodies(&view).iter().enumerate() {
        let velocity = if rank < pairs { -1.0 } else { 1.0 };
        worst = worst.max((body.velocity[0] - velocity).abs());
    }
    ensure(worst < 1e-12, || format!("velocities off by {worst:e}"))?;
    Ok(format!("{collisions} collisions, velocities off by {worst:e}"))
}
