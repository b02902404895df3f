//! Claims of Luding 1998, Sec. 8, measured.

use granule_reference::Collision;
use granule_tests::{plan, run};

/// Row L75: a constant e_n instead of that of an impact whose damping is linear in the speed under a Hertz force. Taken at
/// 0.3 m/s, it errs by the slow change of 1 - e_n with v^(-1/5) (Luding 1998, Eq. (42)).
#[test]
fn error_of_a_constant_restitution() {
    let restitution = |speed: f64| {
        let plan = plan(&format!(
            r#"(version: 1, materials: {{ "a": (density: 1000) }},
            bodies: [Sphere(material: "a", radius: 0.01, position: (0, 0, 0.01), velocity: (0, 0, -{speed}))],
            walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
            contacts: [(between: ("a", "a"), contact_end: Overlap,
                normal: PowerLaw(modulus: 1e7, exponent: 0.5, damping: 0.3))],
            run: (duration: "1 ms"))"#
        ));
        let (collision, composition) = Collision::of_plan(&plan).unwrap();
        collision.hard_limit().run(composition).unwrap().restitution
    };
    let at = restitution(0.3);
    assert!((0.9..0.999).contains(&at), "{at}");
    let mut last: f64 = 0.0;
    for factor in [1.25, 2.0, 4.0, 10.0] {
        let error = (restitution(0.3 * factor) - at).abs().max((restitution(0.3 / factor) - at).abs());
        // 1 - e_n changes by the factor^(1/5), at most.
        let bound = (1.0 - at) * (f64::powf(factor, 0.2) - 1.0);
        assert!(error > last && (0.8 * bound..1.1 * bound).contains(&error), "{factor}: {error} {bound}");
        last = error;
    }
}

/// Normal speed of the oblique impacts \[m/s\].
const SPEED: f64 = 0.1;
/// 1 + 1/q of a solid sphere.
const INERTIA: f64 = 3.5;

/// A sphere of 1 mm hits a wall with the slip psi times the normal speed; contacts last 20 µs.
fn oblique(tangential: &str, psi: f64, driver: &str) -> String {
    format!(
        r#"(version: 1, materials: {{ "a": (density: 1000) }},
        bodies: [Sphere(material: "a", radius: 1e-3, position: (0, 0, 1.0000001e-3), velocity: ({}, 0, -{SPEED}))],
        walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(contact_duration: 20e-6, restitution: 1),
            tangential: {tangential})], {driver} run: (duration: 60e-6))"#,
        psi * SPEED
    )
}

/// Ψ2 in the hard limit, and of a run of the engine with 400 steps in the contact.
fn slip_after(tangential: &str, psi: f64) -> (f64, f64) {
    let plan = plan(&oblique(tangential, psi, ""));
    let (collision, composition) = Collision::of_plan(&plan).unwrap();
    let limit = collision.hard_limit().run(composition).unwrap().tangential_speed / SPEED;
    let driver = "driver: TimeStep(step: Auto(steps_per_contact: 400)),";
    let body = run(&oblique(tangential, psi, driver))[0];
    (limit, (body.velocity[0] - 1e-3 * body.spin[1]) / SPEED)
}

/// Row L71 (Luding 1998, Fig. 7): Ψ2 against Ψ1 of the three tangential laws. A damper takes the same share of any slip,
/// Eq. (48); friction takes the same amount of it and stops, Eq. (51); a spring turns it back, Eq. (53). The limits are the
/// lines of slope +1 (no friction) and -1 (a spring of restitution 1 that never slides).
#[test]
fn tangential_laws_of_figure_7() {
    let mass = 4.0 / 3.0 * std::f64::consts::PI * 1e-6;
    // 2 η_t t_c = ln 2 with the mass that slip feels, m q/(1 + q).
    let viscosity = 2.0_f64.ln() / 20e-6 * mass / INERTIA;
    let taken = 0.3 * 2.0 * INERTIA;
    let cases: [(String, &dyn Fn(f64) -> f64); 5] = [
        (format!("ViscousTangential(damping: {viscosity:e})"), &|psi| 0.5 * psi),
        ("Coulomb(friction: 0.3)".into(), &|psi| (psi - taken).max(0.0)),
        ("TangentialSpring(tangential_restitution: 0.5, friction: inf)".into(), &|psi| -0.5 * psi),
        ("Coulomb(friction: 0)".into(), &|psi| psi),
        ("TangentialSpring(tangential_restitution: 1, friction: inf)".into(), &|psi| -psi),
    ];
    for (law, expected) in cases {
        for psi in [0.1, 0.9, 1.7, 2.5, 3.3, 4.9] {
            let (limit, engine) = slip_after(&law, psi);
            let expected = expected(psi);
            // The reference integrates to 1e-10; friction whose force vanishes with the overlap stops within that of a step.
            assert!((limit - expected).abs() < 1e-6, "{law} at {psi}: {limit} instead of {expected}");
            // The arm is shorter by half of the overlap, 0.6 µm of 1 mm at most, and 400 steps err by some 1e-3 of Ψ.
            assert!(
                (engine - expected).abs() < 5e-3 * (1.0 + psi),
                "{law} at {psi}: engine {engine}, not {expected}"
            );
        }
    }
}

/// Root of the part of its energy that a column of beads keeps when it falls on a plate and comes apart.
fn column(law: &str, count: usize, gap: f64) -> f64 {
    const RADIUS: f64 = 1e-3;
    let bodies: String = (0..count)
        .map(|index| {
            let height = RADIUS + gap + (2.0 * RADIUS + gap) * index as f64;
            format!("Sphere(material: \"a\", radius: {RADIUS}, position: (0, 0, {height}), velocity: (0, 0, -0.2)), ")
        })
        .collect();
    let bodies = run(&format!(
        r#"(version: 1, materials: {{ "a": (density: 2500) }}, bodies: [{bodies}],
        walls: {{ "plate": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), normal: {law})],
        driver: TimeStep(step: 5e-7), run: (duration: {}))"#,
        0.01 + 0.01 * count as f64
    ));
    let energy: f64 = bodies.iter().map(|body| body.velocity[2] * body.velocity[2]).sum();
    (energy / (count as f64 * 0.04)).sqrt()
}

/// Row L74: pairs do not tell which law they have (row L73), dense systems do. Ten beads in a column with the same restitution
/// and the same contact duration by two laws: one bead, and beads 1 mm apart whose contacts follow one another, keep the same
/// energy; beads that touch from the start, so that contacts overlap in time, do not.
#[test]
fn many_contacts_at_once_tell_the_law() {
    let laws = [
        "LinearSpringDashpot(restitution: 0.9, contact_duration: 5e-5)",
        "WaltonBraun(restitution: 0.9, contact_duration: 5e-5)",
    ];
    let difference = |count: usize, gap: f64| {
        let [linear, hysteretic] = laws.map(|law| column(law, count, gap));
        linear - hysteretic
    };
    // A hundred steps in a contact: 0.2 % of a restitution, once for a bead and for ten in turn with random signs.
    assert!(difference(1, 0.0).abs() < 3e-3);
    assert!(difference(10, 1e-3).abs() < 5e-3);
    // Linear contacts pass the shock on and lose less the more beads there are, hysteretic ones lose it where it is largest.
    assert!(difference(10, 0.0) > 0.05);
}
