//! A run that is saved, ended, taken up again and continued has the bits of a run that was never interrupted.

use std::sync::atomic::AtomicBool;

use granule_drivers::{Driver, DriverState, restore};
use granule_tests::plan;

/// A frictional pile between walls that move: `laws` between the bodies, `driver` of the scene.
fn pile(laws: &str, driver: &str, steps: u64) -> String {
    format!(
        r#"(version: 1, seed: 7, gravity: (0, 0, -9.81), materials: {{ "a": (density: 2500), "b": (density: 900) }},
        cell: (lo: (0, 0, 0), hi: ("8 mm", "8 mm", "40 mm"), periodic: (true, true, false)),
        bodies: [
            Fill(material: "a", radius: Uniform(min: "0.4 mm", max: "0.6 mm"), count: 500,
                lo: (0, 0, 0), hi: ("8 mm", "8 mm", "16 mm"), velocity: (0, 0, -0.5), velocity_spread: 0.2),
            Fill(material: "b", radius: "0.3 mm", count: 200,
                lo: (0, 0, 0), hi: ("8 mm", "8 mm", "16 mm"), velocity: (0, 0, -0.5), velocity_spread: 0.2),
        ],
        walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a",
            motion: Sinusoidal(amplitude: (0, 0, "0.2 mm"), frequency: "200 Hz")) }},
        contacts: [(between: ("a", "a"), {laws}), (between: ("a", "b"), {laws}), (between: ("b", "b"), {laws})],
        {driver}, run: (steps: {steps}))"#
    )
}

const SPRINGS: &str = "normal: LinearSpringDashpot(stiffness: 1e3, restitution: 0.7),
    tangential: TangentialSpring(stiffness: 285, friction: 0.5, damping: 1e-3)";

fn with(scheme: &str) -> String {
    format!("driver: TimeStep(integrator: {scheme}, packing_limit: false, step: \"5 us\")")
}

fn to_bytes(state: &DriverState<'_>) -> Vec<u8> {
    postcard::to_stdvec(state).unwrap()
}

fn advance(driver: &mut dyn Driver, until: u64) {
    driver.advance(until, &AtomicBool::new(false)).expect("the run stays finite");
}

/// Runs a scene at once, and in parts on different numbers of threads with nothing but bytes between them; the states at the
/// end are the same to the last byte: positions, histories, lists, sums.
fn same_bits_in_parts(name: &str, text: &str, parts: &[(u64, usize)]) {
    let plan = plan(text);
    let steps = plan.driver.steps;
    let mut whole = granule_drivers::driver(plan.clone(), Some(2)).unwrap();
    advance(whole.as_mut(), steps);
    let mut driver = granule_drivers::driver(plan.clone(), Some(1)).unwrap();
    for (until, threads) in parts {
        advance(driver.as_mut(), *until);
        let bytes = to_bytes(&driver.save());
        drop(driver);
        let state = postcard::from_bytes(&bytes).unwrap();
        driver = restore(plan.clone(), Some(*threads), state).unwrap();
        assert_eq!(driver.step(), *until);
        assert!(to_bytes(&driver.save()) == bytes, "{name}: what was restored is what was saved");
    }
    advance(driver.as_mut(), steps);
    assert_eq!(driver.result_hash(), whole.result_hash(), "{name}");
    assert!(to_bytes(&driver.save()) == to_bytes(&whole.save()), "{name}: every byte of the state");
}

/// Parts that end in flight, at the first impacts and in the settled pile.
const PARTS: [(u64, usize); 5] = [(1, 3), (700, 1), (701, 2), (1999, 4), (3333, 1)];

#[test]
fn springs_that_remember() {
    let text = pile(SPRINGS, &with("VelocityVerlet"), 4000);
    let plan = plan(&text);
    let mut driver = granule_drivers::driver(plan, Some(2)).unwrap();
    advance(driver.as_mut(), 4000);
    assert!(driver.view().tally().contacts > 100, "the pile has contacts");
    same_bits_in_parts("springs", &text, &PARTS);
    let ledger = text.replace("version: 1,", "version: 1, ledger: true,");
    same_bits_in_parts("with the ledger", &ledger, &PARTS);
}

#[test]
fn every_integrator() {
    for scheme in ["ContactResolved", "ClassicVelocityVerlet", "Leapfrog", "SymplecticEuler"] {
        same_bits_in_parts(scheme, &pile(SPRINGS, &with(scheme), 4000), &PARTS);
    }
}

#[test]
fn a_normal_law_that_remembers_and_single_precision() {
    let laws = "normal: WaltonBraun(loading_stiffness: 1e3, restitution: 0.7),
        tangential: TangentialSpring(stiffness: 285, friction: 0.5)";
    same_bits_in_parts("hysteretic", &pile(laws, &with("VelocityVerlet"), 4000), &PARTS);
    let single =
        pile(SPRINGS, &with("ContactResolved"), 4000).replace("seed: 7,", "seed: 7, precision: Single,");
    same_bits_in_parts("single", &single, &PARTS);
}

#[test]
fn walls_that_turn_in_the_plane_and_in_space() {
    let drum = r#"(version: 1, seed: 3, gravity: (0, 0, -9.81), materials: { "a": (density: 2500) },
        cell: (lo: (-inf, 0, -inf), hi: (inf, "6 mm", inf), periodic: (false, true, false)),
        bodies: [Fill(material: "a", radius: "0.5 mm", count: 300, lo: ("-5 mm", 0, "-5 mm"), hi: ("5 mm", "6 mm", "5 mm"))],
        walls: { "drum": Cylinder(point: (0, 0, 0), axis: (0, 1, 0), radius: "10 mm", inside: true, material: "a",
            motion: Rotation(point: (0, 0, 0), axis: (0, 1, 0), angular_velocity: 6)) },
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e3, restitution: 0.5),
            tangential: TangentialSpring(stiffness: 285, friction: 0.5))],
        driver: TimeStep(step: "5 us"), run: (steps: 4000))"#;
    same_bits_in_parts("drum", drum, &PARTS);
    let discs = r#"(version: 1, seed: 7, dimensions: 2, gravity: (0, -9.81), materials: { "a": (density: 2500) },
        cell: (lo: (0, 0), hi: ("15 mm", "40 mm"), periodic: (true, false)),
        bodies: [Fill(material: "a", radius: Uniform(min: "0.2 mm", max: "0.3 mm"), count: 500,
            lo: (0, 0), hi: ("15 mm", "15 mm"), velocity: (0, -0.5), velocity_spread: 0.2)],
        walls: { "floor": Plane(point: (0, 0), normal: (0, 1), material: "a") },
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e5, restitution: 0.7),
            tangential: TangentialSpring(stiffness: 2.85e4, friction: 0.5, damping: 1e-3))],
        driver: TimeStep(step: "5 us"), run: (steps: 4000))"#;
    same_bits_in_parts("discs", discs, &PARTS);
}

/// Beads that roll, slip and collide on a shaken plate which they may leave or not.
#[test]
fn beads_on_a_substrate() {
    let motion = r#"Sinusoidal(amplitude: ("2 mm", 0, 0), frequency: "40 Hz")"#;
    for confined in [false, true] {
        let text = format!(
            r#"(version: 1, seed: 5, gravity: (0, 0, -9.81), materials: {{ "a": (density: 7850), "b": (density: 7850) }},
              bodies: [
                Lattice(material: "a", radius: 2e-3, spacing: 4.2e-3, lo: (0.003, 0.003, 0.002),
                    hi: (0.05, 0.048, 0.002), velocity_spread: 0.1),
                Lattice(material: "b", radius: 2e-3, spacing: 4.2e-3, lo: (0.003, 0.0525, 0.002),
                    hi: (0.05, 0.1, 0.002), velocity_spread: 0.1),
              ],
              walls: {{ "frame": Box(lo: (0, 0, -1), hi: (0.053, 0.103, 1), open: ["z-", "z+"], material: "a",
                  motion: {motion}) }},
              substrate: (motion: {motion}, confined: {confined}, laws: {{
                "a": StickSlip(static_friction: 0.5, kinetic_friction: 0.1, rolling_friction: 1e-3),
                "b": StickSlip(static_friction: 0.5, kinetic_friction: 0.1, rolling_friction: 1e-2) }}),
              contacts: [(between: ("a", "a"), {SPRINGS}), (between: ("a", "b"), {SPRINGS}), (between: ("b", "b"), {SPRINGS})],
              driver: TimeStep(step: 5e-6), run: (steps: 4000), ledger: true)"#
        );
        same_bits_in_parts(if confined { "confined" } else { "free" }, &text, &PARTS);
    }
}

/// Hard spheres: a dense gas that starts on a lattice, where many pairs meet at the same moment; one that falls and cools
/// between walls that move; one of two sizes with frozen obstacles in a periodic cell. Long enough that bodies are brought
/// into a new order several times.
#[test]
fn hard_bodies_that_fly() {
    let gas = r#"(version: 1, seed: 3, materials: { "a": (density: 2500) },
        cell: (lo: (0, 0, 0), hi: ("12 mm", "12 mm", "12 mm"), periodic: (true, true, true)),
        bodies: [Lattice(material: "a", radius: "0.4 mm", spacing: "1 mm", lo: (0, 0, 0), hi: ("11.9 mm", "11.9 mm", "11.9 mm"),
            velocity_spread: 0.2)],
        contacts: [(between: ("a", "a"), collision: HardSphere(restitution: 1))],
        driver: Event(step: 1e-3), run: (steps: 900))"#;
    same_bits_in_parts("gas", gas, &[(1, 1), (300, 1), (301, 2), (650, 1)]);
    let lockstep = gas.replace("velocity_spread: 0.2", "velocity: (0.1, 0, 0)").replace(
        "bodies: [",
        r#"bodies: [Sphere(material: "a", radius: "0.05 mm", position: ("0.55 mm", "0.55 mm", "0.55 mm"), velocity: (0.5, 0.5, 0.5)),"#,
    );
    same_bits_in_parts("lockstep", &lockstep, &[(1, 1), (300, 1), (301, 2), (650, 1)]);
    let falling = r#"(version: 1, seed: 3, gravity: (0, 0, -9.81), materials: { "a": (density: 2500), "b": (density: 900) },
        cell: (lo: (0, 0, 0), hi: ("12 mm", "12 mm", inf), periodic: (true, true, false)),
        bodies: [
            Fill(material: "a", radius: Uniform(min: "0.3 mm", max: "0.5 mm"), count: 150, lo: (0, 0, "2 mm"),
                hi: ("12 mm", "12 mm", "30 mm"), velocity_spread: 0.3),
            Sphere(material: "b", radius: "1 mm", position: ("6 mm", "6 mm", "1.2 mm"), frozen: true),
        ],
        walls: { "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "b",
            motion: Sinusoidal(amplitude: (0, 0, "1 mm"), frequency: "30 Hz")) },
        contacts: [
            (between: ("a", "a"), collision: HardSphere(restitution: 0.9, friction: 0.2)),
            (between: ("a", "b"), collision: HardSphere(restitution: 0.95, friction: 0.2)),
        ],
        driver: Event(step: 1e-3, contact_duration: 1e-5), run: (steps: 1500), ledger: true)"#;
    same_bits_in_parts("falling", falling, &[(1, 1), (300, 1), (301, 2), (650, 1), (1400, 1)]);
}

/// Hard bodies that slide and roll along arcs between collisions, on a plate that is tilted and shaken.
#[test]
fn hard_bodies_that_slide_and_roll() {
    let motion = "Sinusoidal(amplitude: (0.004, 0.001, 0), frequency: 5)";
    for slides in ["Arcs()", "EffectiveRestitution"] {
        let text = format!(
            r#"(version: 1, seed: 5, gravity: (0, 0.3, -9.81), materials: {{ "a": (density: 7850), "b": (density: 7850) }},
              cell: (lo: (0, 0, -inf), hi: (0.053, 0.12, inf), periodic: (false, true, false)),
              bodies: [
                Lattice(material: "a", radius: 2e-3, spacing: 4.5e-3, lo: (0.003, 0.003, 0.002),
                    hi: (0.05, 0.048, 0.002), velocity_spread: 0.1),
                Lattice(material: "b", radius: 2e-3, spacing: 4.5e-3, lo: (0.003, 0.0525, 0.002),
                    hi: (0.05, 0.1, 0.002), velocity_spread: 0.1),
              ],
              walls: {{
                "left": Plane(point: (0, 0, 0), normal: (1, 0, 0), material: "a", motion: {motion}),
                "right": Plane(point: (0.053, 0, 0), normal: (-1, 0, 0), material: "a", motion: {motion}),
              }},
              substrate: (motion: {motion}, laws: {{
                "a": StickSlip(static_friction: 0.5, kinetic_friction: 0.1, rolling_friction: 1e-3),
                "b": StickSlip(static_friction: 0.5, kinetic_friction: 0.1, rolling_friction: 1e-2) }}),
              contacts: [
                (between: ("a", "a"), collision: HardSphere(restitution: 0.9, friction: 0.2)),
                (between: ("a", "b"), collision: HardSphere(restitution: 0.9, friction: 0.2)),
                (between: ("b", "b"), collision: HardSphere(restitution: 0.9, friction: 0.2)),
              ],
              driver: Event(step: 1e-3, slides: {slides}), run: (steps: 800), ledger: true)"#
        );
        same_bits_in_parts(slides, &text, &[(1, 1), (300, 1), (301, 2), (650, 1)]);
    }
}

/// A state under another scene, or one that was changed, is refused and never used.
#[test]
fn what_does_not_fit_the_plan_is_refused() {
    let text = pile(SPRINGS, &with("VelocityVerlet"), 2000);
    let plan = plan(&text);
    let mut driver = granule_drivers::driver(plan.clone(), Some(1)).unwrap();
    advance(driver.as_mut(), 1500);
    let bytes = to_bytes(&driver.save());
    let refused = |text: &str| {
        let state: DriverState<'_> = postcard::from_bytes(&bytes).unwrap();
        let error =
            restore(granule_tests::plan(text), Some(1), state).err().expect("another scene").to_string();
        assert!(error.starts_with("the saved state does not fit the scene, or is damaged:"), "{error}");
        error
    };
    assert!(refused(&text.replace("count: 500", "count: 499")).contains("bodies"));
    assert!(refused(&text.replace("density: 900", "density: 901")).contains("mass of a body"));
    assert!(refused(&text.replace("steps: 2000", "steps: 1000")).contains("step"));
    assert!(refused(&text.replace("VelocityVerlet", "Leapfrog")).len() > 10);
    let hard = granule_tests::plan(
        r#"(version: 1, seed: 3, materials: { "a": (density: 2500) },
        cell: (lo: (0, 0, 0), hi: ("12 mm", "12 mm", "12 mm"), periodic: (true, true, true)),
        bodies: [Lattice(material: "a", radius: "0.4 mm", spacing: "2 mm", lo: (0, 0, 0), hi: ("11 mm", "11 mm", "11 mm"),
            velocity_spread: 0.2)],
        contacts: [(between: ("a", "a"), collision: HardSphere(restitution: 1))],
        driver: Event(step: 1e-3), run: (steps: 300))"#,
    );
    let state: DriverState<'_> = postcard::from_bytes(&bytes).unwrap();
    assert!(restore(hard, Some(1), state).is_err(), "the state of another driver");
}
