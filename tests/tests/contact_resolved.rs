//! Contacts that are resolved where they begin and end within a step.

use std::fmt::Write as _;

use granule_tests::{BodyState, advance, driver, driver_with, run};

/// Pairs of spheres far from each other, as many phases of the step against the contact.
const PAIRS: usize = 200;
/// Multiples of it cover an interval evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
const PLASTIC: f64 = 0.754_877_666_246_692_7;

/// Bodies after [`PAIRS`] impacts at normal speed 1 of unit masses of diameter 1, at a tangential speed of each pair.
fn impacts(
    laws: &str,
    contact: f64,
    steps_per_contact: f64,
    integrator: &str,
    tangential: fn(usize) -> f64,
) -> Vec<BodyState> {
    let mut bodies = String::new();
    for pair in 0..PAIRS {
        let (x, y, z) = (4.0 * (pair % 8) as f64, 4.0 * (pair / 8 % 8) as f64, 4.0 * (pair / 64) as f64);
        let gap = (0.2 + (pair as f64 * GOLDEN).fract()) * contact;
        write!(
            bodies,
            "Sphere(material: \"a\", mass: 1, radius: 0.5, position: ({x:?}, {y:?}, {z:?}), velocity: (1, {:?}, 0)), \
             Sphere(material: \"a\", mass: 1, radius: 0.5, position: ({:?}, {y:?}, {z:?})), ",
            tangential(pair),
            x + 1.0 + gap
        )
        .unwrap();
    }
    // The time of the run is no simple multiple of the contact, so that the step does not divide the contact.
    let duration = 4.137 * contact;
    let steps = (4.137 * steps_per_contact).ceil();
    run(&format!(
        "(version: 1, materials: {{ \"a\": () }}, bodies: [{bodies}], \
         contacts: [(between: (\"a\", \"a\"), {laws})], \
         driver: TimeStep(integrator: {integrator}, step: {:e}, skin: 0.1, packing_limit: false), run: (steps: {steps}))",
        duration / steps
    ))
}

/// Rebound speeds of head-on impacts.
fn rebounds(laws: &str, contact: f64, steps_per_contact: f64, integrator: &str) -> Vec<f64> {
    impacts(laws, contact, steps_per_contact, integrator, |_| 0.0)
        .chunks(2)
        .map(|pair| pair[1].velocity[0] - pair[0].velocity[0])
        .collect()
}

/// Root mean square of the differences.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

/// Stiffness of the linear contacts.
const STIFFNESS: f64 = 1e6;

fn linear(restitution: f64, end: &str) -> String {
    format!(
        "contact_end: {end}, normal: LinearSpringDashpot(stiffness: {STIFFNESS:e}, restitution: {restitution})"
    )
}

/// Duration of such a contact of unit masses that ends where the overlap does.
fn duration(restitution: f64) -> f64 {
    let (log, pi) = (f64::ln(restitution), std::f64::consts::PI);
    (pi * pi + log * log).sqrt() / (2.0 * STIFFNESS).sqrt()
}

/// The restitution that the law was asked for is realised whatever the phase of the step. What remains is of second order:
/// with θ = π / steps per contact, Verlet's period is wrong by θ²/24, and the damper sees a velocity that is
/// extrapolated over one step. Both change e by a share of θ² ln e, and the extrapolation where the force jumps by a share
/// of θ² ln² e: the bound is θ² (|ln e| + 2 ln² e) e / 3. Velocity Verlet misses it at all of these steps.
#[test]
fn restitution_at_any_phase_of_the_step() {
    for restitution in [0.9_f64, 0.55] {
        for end in ["Overlap", "Force"] {
            for steps in [10.0, 20.0, 50.0] {
                let worst = |integrator| {
                    let speeds =
                        rebounds(&linear(restitution, end), duration(restitution), steps, integrator);
                    speeds.iter().map(|speed| (speed - restitution).abs()).fold(0.0, f64::max)
                };
                let (angle, log) = (std::f64::consts::PI / steps, restitution.ln().abs());
                let bound = angle * angle * (log + 2.0 * log * log) * restitution / 3.0;
                let (resolved, verlet) = (worst("ContactResolved"), worst("VelocityVerlet"));
                assert!(
                    resolved < bound,
                    "e = {restitution}, {end}, {steps} steps: {resolved:e} > {bound:e}"
                );
                assert!(verlet > bound, "e = {restitution}, {end}, {steps} steps: {verlet:e} < {bound:e}");
            }
        }
    }
}

/// Order of convergence from the errors at 40 and 160 steps in a contact, of the root mean square over the phases. Laws
/// whose damping does not vanish at touch, and those without any, are of second order. A damper that grows as δ^a gives a
/// force that rises as t^a, of whose integral any rule with even steps misses a part of order 1 + a: 1.25 with a = 1/4
/// (Tsuji), 1.5 with a = 1/2 (viscoelastic).
#[test]
fn order_of_convergence_of_dissipative_laws() {
    let linear = |end: &str| {
        format!("contact_end: {end}, normal: LinearSpringDashpot(stiffness: 2e4, restitution: 0.7)")
    };
    let cases = [
        (linear("Overlap"), 2.0),
        (linear("Force"), 2.0),
        ("normal: WaltonBraun(loading_stiffness: 2e4, unloading_stiffness: 3e4)".into(), 2.0),
        ("normal: Hertz(youngs_modulus: 1e6, poisson_ratio: 0.3, restitution: 0.7)".into(), 1.25),
        ("normal: Viscoelastic(youngs_modulus: 1e6, poisson_ratio: 0.3, dissipative_time: 3e-4)".into(), 1.5),
    ];
    let contact = 1.6e-2;
    for (laws, order) in cases {
        let limit = rebounds(&laws, contact, 5120.0, "ContactResolved");
        let error = |steps, integrator| distance(&rebounds(&laws, contact, steps, integrator), &limit);
        let (coarse, fine) = (error(40.0, "ContactResolved"), error(160.0, "ContactResolved"));
        let measured = (coarse / fine).log2() / 2.0;
        // The next term of the expansion is smaller by θ = 0.08 at 40 steps, with a factor of a few: a fifth of an order over two octaves at most.
        assert!(measured > order - 0.2, "{laws}: order {measured}");
    }
}

/// Oblique impacts with a spring and a slider, Ψ1 from 0 to 4: the spring is wound from the moment of touch on. Largest
/// error of a velocity against the limit of small steps. Second order from 20 to 160 steps; where sliding begins within a step
/// the force has a kink, whose share falls as the square of the step, too, but is uneven from phase to phase: half an order.
#[test]
fn oblique_impacts_with_friction() {
    let laws = format!(
        "{}, tangential: TangentialSpring(stiffness: {:?}, friction: 0.3)",
        linear(0.9, "Overlap"),
        2.0 / 7.0 * STIFFNESS
    );
    let tangential = |pair: usize| 4.0 * (pair as f64 * PLASTIC).fract();
    let after = |steps, integrator| {
        let bodies = impacts(&laws, duration(0.9), steps, integrator, tangential);
        bodies.iter().flat_map(|body| body.velocity.into_iter().chain(body.spin)).collect::<Vec<f64>>()
    };
    let limit = after(5120.0, "ContactResolved");
    let worst = |steps, integrator| {
        after(steps, integrator).iter().zip(&limit).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let (coarse, fine) = (worst(20.0, "ContactResolved"), worst(160.0, "ContactResolved"));
    assert!((coarse / fine).log2() / 3.0 > 1.5, "{coarse:e} at 20 steps, {fine:e} at 160");
    assert!(fine < 0.1 * worst(160.0, "VelocityVerlet"));
}

/// Chains of five beads with dampers that meet in all orders, several contacts of a bead at once: largest error of a velocity
/// against the limit of small steps.
#[test]
fn chains_of_five_beads() {
    let restitution = 0.55;
    let contact = duration(restitution);
    let after = |steps_per_contact: f64, integrator: &str| {
        let mut bodies = String::new();
        for chain in 0..12 {
            let mut x = 0.0;
            for (bead, speed) in [1.0, 0.3, 0.0, -0.2, -0.9].into_iter().enumerate() {
                write!(
                    bodies,
                    "Sphere(material: \"a\", mass: 1, radius: 0.5, position: ({x:?}, {:?}, 0), velocity: ({speed:?}, 0, 0)), ",
                    4.0 * f64::from(chain)
                )
                .unwrap();
                let number = f64::from(chain * 5) + bead as f64 + 1.0;
                x += 1.0 + 0.5 * contact * (number * GOLDEN).fract();
            }
        }
        let steps = (16.037 * steps_per_contact).ceil();
        let bodies = run(&format!(
            "(version: 1, materials: {{ \"a\": () }}, bodies: [{bodies}], \
             contacts: [(between: (\"a\", \"a\"), {})], \
             driver: TimeStep(integrator: {integrator}, step: {:e}, skin: 0.1, packing_limit: false), run: (steps: {steps}))",
            linear(restitution, "Overlap"),
            16.037 * contact / steps
        ));
        bodies.iter().map(|body| body.velocity[0]).collect::<Vec<f64>>()
    };
    let limit = after(5120.0, "ContactResolved");
    let momentum: f64 = limit.iter().sum();
    // Rounding of some thousand steps at 1e-16 each.
    assert!((momentum - 12.0 * 0.2).abs() < 1e-11, "momentum {momentum}");
    let worst = |steps, integrator| {
        after(steps, integrator).iter().zip(&limit).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    // Second order: from 20 to 100 steps by 25, of which half may be lost as errors of several impacts add up by chance.
    let (coarse, fine) = (worst(20.0, "ContactResolved"), worst(100.0, "ContactResolved"));
    assert!(coarse / fine > 12.0, "{coarse:e} at 20 steps, {fine:e} at 100");
    assert!(fine < 0.1 * worst(100.0, "VelocityVerlet"), "{fine:e}");
}

/// The impulses of a frictional impact with ten steps in a contact act on both bodies with the arms of one moment: momentum and
/// angular momentum are those of the start, to rounding.
#[test]
fn momentum_and_angular_momentum_are_conserved() {
    let text = "(version: 1, materials: { \"a\": (density: 2500) }, bodies: [\
        Sphere(material: \"a\", radius: 0.5, position: (0, 0, 0), velocity: (1, 0.4, 0.1), spin: (0.3, 1, -2)), \
        Sphere(material: \"a\", radius: 0.3, position: (0.8003, 0.1, 0.05), velocity: (-1, 0.2, -0.3), spin: (2, 0, 1))], \
        contacts: [(between: (\"a\", \"a\"), normal: LinearSpringDashpot(stiffness: 1e7, restitution: 0.6), \
        tangential: TangentialSpring(stiffness: 2e6, damping: 100, friction: 0.4))], \
        driver: TimeStep(integrator: ContactResolved, step: Auto(steps_per_contact: 10)), run: (steps: 60))";
    let mut driver = driver(text);
    let moments = |bodies: &[BodyState]| {
        let mut sums = [0.0; 6];
        for (body, radius) in bodies.iter().zip([0.5_f64, 0.3]) {
            let mass = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * 2500.0;
            let (x, v, w) = (body.position, body.velocity, body.spin);
            for axis in 0..3 {
                let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
                sums[axis] += mass * v[axis];
                sums[3 + axis] += mass * (x[b] * v[c] - x[c] * v[b] + 0.4 * radius * radius * w[axis]);
            }
        }
        sums
    };
    let start = moments(&granule_tests::bodies(&driver));
    let spin = granule_tests::bodies(&driver)[0].spin;
    advance(&mut driver, 60);
    let end = granule_tests::bodies(&driver);
    assert!(driver.engine().tally().contacts == 0 && end[0].spin != spin, "they have met and parted");
    for (a, b) in start.into_iter().zip(moments(&end)) {
        // Momenta are up to 1e3; 60 steps of a few roundings each.
        assert!((a - b).abs() < 1e3 * 60.0 * 1e-15, "{a} became {b}");
    }
}

/// A sphere falls onto a floor that moves up: the impulse counts the motion of the wall within the step.
#[test]
fn rebound_from_a_moving_wall() {
    let restitution = 0.7;
    let contact = 2.0_f64.sqrt() * duration(restitution);
    for phase in 0..40 {
        let height = 0.5 + 1.5 * contact * (0.3 + (f64::from(phase) * GOLDEN).fract());
        let bodies = run(&format!(
            "(version: 1, materials: {{ \"a\": () }}, bodies: [Sphere(material: \"a\", mass: 1, radius: 0.5, \
             position: (0, 0, {height:?}), velocity: (0, 0, -1))], \
             walls: {{ \"floor\": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: \"a\", motion: Constant(velocity: (0, 0, 0.5))) }}, \
             contacts: [(between: (\"a\", \"a\"), {})], \
             driver: TimeStep(integrator: ContactResolved, step: {:e}), run: (steps: 75))",
            linear(restitution, "Overlap"),
            contact / 20.0
        ));
        // 1.5 towards each other; the bound is that of head-on impacts at 20 steps.
        let (angle, log) = (std::f64::consts::PI / 20.0, f64::ln(restitution).abs());
        let bound = 1.5 * angle * angle * (log + 2.0 * log * log) * restitution / 3.0;
        let expected = 0.5 + 1.5 * restitution;
        let error = (bodies[0].velocity[2] - expected).abs();
        assert!(error < bound, "phase {phase}: error {error:e} > {bound:e}");
    }
}

/// A heap of spheres that collapses, with friction and the energy ledger.
fn heap(integrator: &str, steps_per_contact: f64) -> String {
    let step = 2.8e-4 / steps_per_contact;
    format!(
        r#"(version: 1, seed: 7, gravity: (0, 0, -9.81), materials: {{ "a": (density: 2500) }},
        cell: (lo: (0, 0, 0), hi: ("10 mm", "10 mm", "40 mm"), periodic: (true, true, false)),
        bodies: [Fill(material: "a", radius: "0.5 mm", count: 600,
            lo: (0, 0, 0), hi: ("10 mm", "10 mm", "20 mm"), velocity: (0, 0, -0.3), velocity_spread: 0.1)],
        walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 200, restitution: 0.6),
            tangential: TangentialSpring(stiffness: 57, friction: 0.5))],
        ledger: true, driver: TimeStep(integrator: {integrator}, step: {step:e}, packing_limit: false), run: (duration: 0.1))"#
    )
}

/// Many contacts at once, from flight to rest: the ledger, which counts what contacts lose where they begin and end, closes
/// better than that of velocity Verlet by what the trapezoid gets wrong there.
#[test]
fn the_energy_ledger_of_a_heap_closes() {
    let residual = |integrator: &str| {
        let mut driver = driver_with(&heap(integrator, 40.0), 2);
        let steps = driver.engine().plan().driver.steps;
        let energy = |driver: &granule_drivers::TimeStepDriver| {
            let tally = driver.engine().tally();
            let mass = 4.0 / 3.0 * std::f64::consts::PI * 0.5e-3_f64.powi(3) * 2500.0;
            let mut sum: f64 = tally.elastic.iter().sum();
            for body in granule_tests::bodies(driver) {
                let square = |v: [f64; 3]| v.iter().map(|v| v * v).sum::<f64>();
                sum += 0.5 * mass * (square(body.velocity) + 0.4 * 0.25e-6 * square(body.spin));
                sum += mass * 9.81 * body.position[2];
            }
            sum
        };
        let start = energy(&driver);
        advance(&mut driver, steps);
        let work = driver.engine().work();
        let lost: f64 = work.viscous.iter().chain(&work.friction).sum();
        assert!(driver.engine().tally().contacts > 600, "a heap lies there");
        ((start - energy(&driver) - lost) / lost).abs()
    };
    let (resolved, verlet) = (residual("ContactResolved"), residual("VelocityVerlet"));
    assert!(resolved < 0.2 * verlet, "{resolved:e} against {verlet:e}");
}
