//! Long runs, runs on any number of threads, and runs that are taken up again.

use std::sync::Arc;

use granule_drivers::{driver, restore};

use crate::run::{advance, bodies, ensure, start};
use crate::scene::{ball, scene};
use crate::{Case, Lab};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "energy-drift",
        extreme: "an elastic ball between two spring walls, 1e4 contacts of 50 steps",
        expected: "its energy is off by 2.8e-4 at most, at any time",
        slow: false,
        check: |lab| drift(lab, 10_000),
    },
    Case {
        name: "energy-drift-long",
        extreme: "the same for 1e5 contacts",
        expected: "the same: no growth",
        slow: true,
        check: |lab| drift(lab, 100_000),
    },
    Case {
        name: "any-number-of-threads",
        extreme: "200 bodies that roll in a box, on 1, 2, 3 and 5 threads",
        expected: "the same bits",
        slow: false,
        check: threads,
    },
    Case {
        name: "taken-up-again",
        extreme: "the same run saved and restored every 100 steps, in the middle of its frictional contacts",
        expected: "the bits of the run that was never interrupted",
        slow: false,
        check: again,
    },
];

/// Velocity Verlet keeps a shadow energy; what differs is where in a step a contact begins: 1.4e-4 at 50 steps a contact was
/// computed for 1e5 contacts, and twice as much is allowed.
fn drift(lab: &Lab, contacts: u32) -> Result<String, String> {
    let text = r#"(version: 1, materials: { "a": () },
        bodies: [Sphere(material: "a", mass: 1, radius: 0.5, position: (0.507, 0, 0), velocity: (1, 0, 0))],
        walls: { "left": Plane(point: (0, 0, 0), normal: (1, 0, 0), material: "a"),
            "right": Plane(point: (1.02, 0, 0), normal: (-1, 0, 0), material: "a") },
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e4, damping: 0))],
        driver: TimeStep(step: 6.283185307179586e-4), run: (steps: 1000000000))"#;
    let plan = lab.plan(text)?.plan;
    let mut driver = start(&plan)?;
    let (mut seen, mut step, mut largest, mut touching) = (0, 0, 0.0_f64, false);
    while seen < contacts {
        step += 1;
        ensure(step < 1000 * u64::from(contacts), || format!("{seen} contacts after {step} steps"))?;
        advance(&mut *driver, step)?;
        let view = driver.view();
        let now = view.tally().wall_contacts > 0;
        if touching && !now {
            seen += 1;
            let speed = bodies(&view)[0].speed();
            largest = largest.max((speed * speed - 1.0).abs());
        }
        touching = now;
    }
    ensure(largest < 2.8e-4, || format!("energy off by {largest:.2e}"))?;
    Ok(format!("energy off by {largest:.1e} at most in {step} steps"))
}

/// Bodies that are thrown into a box and roll in it.
fn box_of_bodies() -> String {
    let balls: Vec<_> = (0..200)
        .map(|k| {
            let [x, y, z] = [k % 6, k / 6 % 6, k / 36].map(|n| 0.0201 * (f64::from(n) + 0.6));
            let lively = |n: i32| f64::from((k * n) % 17 - 8) / 8.0;
            ball([x, y, z], [lively(3), lively(5), -1.0 + 0.2 * lively(7)])
        })
        .collect();
    scene(
        &balls,
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.3), tangential: TangentialSpring(stiffness: 3e3, \
         friction: 0.4)",
        r#"gravity: (0, 0, -9.81), walls: { "box": Box(lo: (0, 0, 0), hi: (0.125, 0.125, 0.3), material: "a") },
        driver: TimeStep(step: 2e-5), run: (steps: 10000)"#,
    )
}

fn threads(lab: &Lab) -> Result<String, String> {
    let plan = lab.plan(&box_of_bodies())?.plan;
    let mut hashes = Vec::new();
    let mut contacts = 0;
    for count in [1, 2, 3, 5] {
        let mut driver = driver(Arc::clone(&plan), Some(count)).map_err(|error| error.to_string())?;
        advance(&mut *driver, plan.driver.steps)?;
        contacts = driver.view().tally().contacts;
        hashes.push(driver.result_hash());
    }
    ensure(contacts > 100, || format!("only {contacts} contacts"))?;
    ensure(hashes.iter().all(|hash| *hash == hashes[0]), || format!("hashes {hashes:x?}"))?;
    Ok(format!("the same bits, {contacts} contacts at the end"))
}

fn again(lab: &Lab) -> Result<String, String> {
    let plan = lab.plan(&box_of_bodies())?.plan;
    let mut whole = start(&plan)?;
    advance(&mut *whole, plan.driver.steps)?;
    let mut parts = start(&plan)?;
    let mut times = 0;
    for until in (100..=plan.driver.steps).step_by(100) {
        advance(&mut *parts, until)?;
        let threads = 1 + times % 3;
        let next =
            restore(Arc::clone(&plan), Some(threads), parts.save()).map_err(|error| error.to_string())?;
        parts = next;
        times += 1;
    }
    let same = parts.result_hash() == whole.result_hash();
    ensure(same, || {
        format!("{:x?} after {times} interruptions, {:x?} without", parts.result_hash(), whole.result_hash())
    })?;
    Ok(format!("the same bits after {times} interruptions"))
}
