//! Candidate lists, histories and periodic images: what the engine sees is what there is.

use std::collections::BTreeSet;

use granule_drivers::{ContactPartner, Driver, TimeStepDriver};
use granule_tests::{advance, bodies, driver, driver_with, plan};

/// Pairs of bodies that overlap, by trying all of them.
fn touching_by_brute_force(driver: &TimeStepDriver) -> BTreeSet<(u32, u32)> {
    let view = driver.view();
    let rows = view.bodies();
    let mut touching = BTreeSet::new();
    for a in 0..rows.len() {
        for b in a + 1..rows.len() {
            let (i, j) = (view.order()[a] as usize, view.order()[b] as usize);
            let (x, y) = (rows.position[i], rows.position[j]);
            let (separation, _) = view.plan().cell.minimum_image([x[0] - y[0], x[1] - y[1], x[2] - y[2]]);
            let distance = separation.iter().map(|component| component * component).sum::<f64>().sqrt();
            if distance < x[3] + y[3] {
                touching.insert((rows.id[i], rows.id[j]));
            }
        }
    }
    touching
}

fn touching_by_engine(driver: &TimeStepDriver) -> BTreeSet<(u32, u32)> {
    let pair = |contact: &granule_drivers::ContactRecord| match contact.partner {
        ContactPartner::Body(other) => Some((contact.id.min(other), contact.id.max(other))),
        ContactPartner::Wall(_) => None,
    };
    driver.view().contacts().iter().filter_map(pair).collect()
}

/// A dense, fast gas of unequal spheres in a cell that is periodic in all directions: lists are made anew often.
fn gas(friction: f64, search: &str) -> String {
    format!(
        r#"(version: 1, seed: 3, materials: {{ "a": (density: 1000) }},
        cell: (lo: (0, 0, 0), hi: (0.1, 0.1, 0.1), periodic: (true, true, true)),
        bodies: [Fill(material: "a", radius: Uniform(min: "3 mm", max: "6 mm"), count: 500,
            lo: (0, 0, 0), hi: (0.1, 0.1, 0.1), velocity: (3, 1, -2), velocity_spread: 2)],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e5, restitution: 0.8),
            tangential: TangentialSpring(stiffness: 3e4, friction: {friction}))],
        driver: TimeStep(step: "5 us"{search}), run: (steps: 20000))"#
    )
}

/// At every tenth step for a while, with lists rebuilt dozens of times, the contacts are those of brute force.
#[test]
fn no_contact_is_ever_missed() {
    let mut driver = driver_with(&gas(0.5, ""), 2);
    let mut seen = 0;
    for step in (0..=4000).step_by(10) {
        advance(&mut driver, step);
        let (engine, truth) = (touching_by_engine(&driver), touching_by_brute_force(&driver));
        assert_eq!(engine, truth, "step {step}");
        assert_eq!(driver.view().tally().contacts, truth.len() as u64, "step {step}");
        seen += truth.len();
    }
    assert!(seen > 1000, "there were contacts: {seen}");
    assert!(
        driver.engine().list_updates().0 > 20,
        "lists were made anew: {:?}",
        driver.engine().list_updates()
    );
}

/// The thickness of the skin decides when lists are made anew and bodies sorted; contact histories must survive that.
/// Sums then run in another order, which leaves round-off; in the 0.5 ms after the first contacts it stays small.
#[test]
fn histories_survive_new_lists() {
    let run = |skin: &str| {
        let mut driver = driver(&gas(0.5, &format!(", skin: \"{skin}\"")));
        advance(&mut driver, 600);
        (bodies(&driver), driver.engine().list_updates().0)
    };
    let (often, updates) = run("0.05 mm");
    let (rarely, few) = run("4 mm");
    assert!(updates > 20 * few.max(1), "{updates} against {few} lists");
    let spun = often.iter().filter(|body| body.spin.iter().any(|spin| spin.abs() > 1.0)).count();
    assert!(spun > 50, "friction acts: {spun} bodies spin");
    for (a, b) in often.iter().zip(&rarely) {
        for axis in 0..3 {
            assert!((a.velocity[axis] - b.velocity[axis]).abs() < 1e-9, "{a:?} {b:?}");
            assert!((a.spin[axis] - b.spin[axis]).abs() < 1e-6, "{a:?} {b:?}");
        }
    }
}

/// Two spheres that roll over each other while the pair drifts across a periodic boundary do the same as without one.
#[test]
fn a_contact_crosses_a_periodic_boundary() {
    let text = |cell: &str, shift: f64| {
        format!(
            r#"(version: 1, materials: {{ "a": (density: 1000) }}, {cell} impact_speed: 1,
            bodies: [
                Sphere(material: "a", radius: 0.01, position: ({}, 0.05, 0.05), velocity: (30.5, 0.1, 0), spin: (0, 0, 20)),
                Sphere(material: "a", radius: 0.01, position: ({}, 0.05, 0.05), velocity: (29.5, -0.1, 0), spin: (0, 0, 5)),
            ],
            contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8),
                tangential: TangentialSpring(stiffness: 3e3, friction: 0.5))],
            driver: TimeStep(step: "1 us"), run: (duration: "3 ms"))"#,
            0.07 + shift,
            0.0901 + shift,
        )
    };
    let open = granule_tests::run(&text("", 0.0));
    let periodic = text("cell: (lo: (0, 0, 0), hi: (0.1, 0.1, 0.1), periodic: (true, true, true)),", 0.0);
    let across = granule_tests::run(&periodic);
    assert!((open[0].spin[2] - 20.0).abs() > 0.1, "friction has turned the spheres");
    for (a, b) in open.iter().zip(&across) {
        for axis in 0..3 {
            // Positions of 0.1 m have an ulp of 1.4e-17 m, the overlap is 1e-4 m: 1e-13 a step, 3e3 steps.
            assert!((a.velocity[axis] - b.velocity[axis]).abs() < 1e-9, "{a:?} {b:?}");
            assert!((a.spin[axis] - b.spin[axis]).abs() < 1e-7, "{a:?} {b:?}");
        }
    }
    let crossed = plan(&periodic).cell.wrap(across[0].position).0[0];
    assert!((0.0..0.1).contains(&crossed));
}

/// A body that flies off to a kilometre neither costs memory for the space in between nor disturbs the others.
#[test]
fn a_body_may_leave_for_good() {
    let text = |runaway: &str| {
        format!(
            r#"(version: 1, seed: 2, materials: {{ "a": (density: 1000) }}, impact_speed: 3,
            bodies: [
                Fill(material: "a", radius: "2 mm", count: 100, lo: (0, 0, 0), hi: (0.05, 0.05, 0.05), velocity_spread: 1),
                {runaway}
            ],
            contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8))],
            driver: TimeStep(step: "10 us"), run: (steps: 2000))"#
        )
    };
    let alone = granule_tests::run(&text(""));
    let mut with = driver(&text(
        r#"Sphere(id: 999, material: "a", radius: "2 mm", position: (1000, 0, 0), velocity: (1000, 0, 0)),"#,
    ));
    advance(&mut with, 2000);
    assert!(with.engine().list_bytes() < 10_000_000, "{} bytes of lists", with.engine().list_bytes());
    let with = bodies(&with);
    // Two thousand additions to a thousand metres leave as many units in the last place of 1e-13 m.
    assert!((with[100].position[0] - 1020.0).abs() < 1e-9, "it flies on: {}", with[100].position[0]);
    for (a, b) in alone.iter().zip(&with) {
        for axis in 0..3 {
            assert!((a.velocity[axis] - b.velocity[axis]).abs() < 1e-9);
        }
    }
}
