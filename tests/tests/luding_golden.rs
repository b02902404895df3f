//! Golden numbers of Luding 1998 in their corrected forms, through the registered laws and the reference integrator.

use std::f64::consts::PI;

use granule_law_api::{ContactEnd, oscillator};
use granule_reference::{Collision, HardLimitOutcome};
use granule_tests::plan;

const MASS: f64 = 4.0 / 3.0 * PI * 1e-6;

/// A solid sphere of radius 1 mm hits a wall in the hard limit.
fn impact(laws: &str, normal_speed: f64, slip: f64) -> HardLimitOutcome {
    let plan = plan(&format!(
        r#"(version: 1, materials: {{ "a": (density: 1000) }},
        bodies: [Sphere(material: "a", radius: 1e-3, position: (0, 0, 1e-3), velocity: ({slip:e}, 0, {:e}))],
        walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), {laws})], run: (duration: "1 ms"))"#,
        -normal_speed
    ));
    let (collision, composition) = Collision::of_plan(&plan).unwrap();
    collision.hard_limit().run(composition).unwrap()
}

/// Golden numbers have nine decimals; the integration is good to some 1e-10.
fn near(found: f64, golden: f64) {
    assert!((found - golden).abs() < 2e-9 * golden.abs().max(1.0), "{found} {golden}");
}

/// Eq. (3): 0.6^80 = 1.787e-18. The restitution of a linear contact is the same down to speeds of 1e-18 of the first.
#[test]
fn eighty_impacts() {
    let laws = "normal: LinearSpringDashpot(contact_duration: 20e-6, restitution: 0.6)";
    let mut speed = 1.0;
    for bounce in 0..80 {
        // Every tenth is integrated; those between have the same restitution.
        let restitution = if bounce % 10 == 0 { impact(laws, speed, 0.0).restitution } else { 0.6 };
        speed *= restitution;
    }
    // Eight restitutions, each good to 1e-9.
    assert!((speed / 1.7868991025e-18 - 1.0).abs() < 1e-7, "{speed:e}");
}

/// Eq. (4) with v_0 = 6.3 m/s, e = 0.9, g = 9.81 m/s²: the impacts end 11.5596 s after the first one; and with t_c = 1 µs
/// the 133.5th is the last that is followed by a flight longer than a contact.
#[test]
fn end_of_bouncing() {
    let (gravity, restitution) = (9.81, 0.9);
    let (mut speed, mut time, mut separate) = (6.3, 0.0, 0);
    loop {
        speed *= restitution;
        let flight = 2.0 * speed / gravity;
        if flight < 1e-18 {
            break;
        }
        separate += u32::from(flight > 1e-6);
        time += flight;
    }
    near(time, 11.559633028);
    near((gravity * 1e-6 / (2.0 * 6.3_f64)).ln() / restitution.ln(), 133.501673124);
    assert_eq!(separate, 133);
}

/// Eqs. (32) and (36): ω t_c^f, e_n and e_n^f over η/ω.
#[test]
fn damped_contacts() {
    for (ratio, phase, overlap_ended, force_ended) in [
        (0.1, 2.942255349, 0.730402691, 0.745108425),
        (0.5, 2.214297436, 0.207879576, 0.330499968),
        (1.0, 0.5 * PI, 0.043213918, 0.207879576),
        (2.0, 0.927295218, 0.001867443, 0.156517033),
    ] {
        let beta = ratio / f64::hypot(1.0, ratio);
        let omega = (1e4 / MASS).sqrt() / f64::hypot(1.0, ratio);
        let damping = 2.0 * beta * (1e4 * MASS).sqrt();
        let run = |end: &str| {
            let laws = format!(
                "contact_end: {end}, normal: LinearSpringDashpot(stiffness: 1e4, damping: {damping:e})"
            );
            impact(&laws, 0.1, 0.0)
        };
        let force = run("Force");
        near(force.force_duration * omega, phase);
        near(force.restitution, force_ended);
        near(run("Overlap").restitution, overlap_ended);
    }
}

/// What the force end realises if the damping is tuned with Eq. (32), and the η/ω that gives the restitution asked for.
#[test]
fn tuning_for_the_force_end() {
    for (restitution, realised) in [
        (0.95, 0.950506585),
        (0.9, 0.902026069),
        (0.8, 0.808099335),
        (0.7, 0.718201361),
        (0.6, 0.632290516),
        (0.5, 0.550283170),
        (0.3, 0.397140500),
    ] {
        let beta = oscillator::damping_ratio(restitution, ContactEnd::Overlap);
        let damping = 2.0 * beta * (1e4 * MASS).sqrt();
        let laws =
            format!("contact_end: Force, normal: LinearSpringDashpot(stiffness: 1e4, damping: {damping:e})");
        near(impact(&laws, 0.1, 0.0).restitution, realised);
    }
    for (restitution, ratio) in
        [(0.95, 0.016500477), (0.9, 0.034285337), (0.8, 0.074561496), (0.6, 0.183890822), (0.3, 0.573111715)]
    {
        let beta = oscillator::damping_ratio(restitution, ContactEnd::Force);
        near(beta / (1.0 - beta * beta).sqrt(), ratio);
    }
    near(oscillator::restitution(1.0, ContactEnd::Force), 0.135335283);
}

/// Eq. (41): J(α) is t_c v_0/δ_max of an elastic contact with the exponent α.
#[test]
fn duration_of_power_law_contacts() {
    for (exponent, golden) in
        [(0.0, PI), (0.25, 3.032817662), (0.5, 2.943275184), (1.0, 2.804364211), (1.5, 2.701449061)]
    {
        let laws = format!("normal: PowerLaw(modulus: 1e7, exponent: {exponent}, restitution: 1)");
        let outcome = impact(&laws, 0.1, 0.0);
        near(outcome.duration * 0.1 / outcome.maximum_overlap, golden);
    }
}

/// Eqs. (46) and (47): k2/k1, k1 t_c²/m12 and the overlap that remains, over the largest one.
#[test]
fn hysteretic_contacts() {
    for (restitution, stiffnesses, duration, remains) in [
        (0.9, 1.234567901, 8.907317972, 0.190000000),
        (0.6, 2.777777778, 6.316546817, 0.640000000),
        (0.3, 11.111111111, 4.169907859, 0.910000000),
    ] {
        let laws = format!(
            "contact_end: Force, normal: WaltonBraun(loading_stiffness: 1e4, unloading_stiffness: {})",
            1e4 * stiffnesses
        );
        let outcome = impact(&laws, 0.1, 0.0);
        // The memory of the largest overlap is a maximum over substeps: good to some 1e-6.
        let close =
            |found: f64, golden: f64| assert!((found / golden - 1.0).abs() < 1e-3, "{found} {golden}");
        close(outcome.restitution, restitution);
        close(1e4 * outcome.force_duration.powi(2) / MASS, duration);
        // From the end of the force on it flies: δ0 = e_n v_0 (t - t_c).
        let left = outcome.restitution * 0.1 * (outcome.duration - outcome.force_duration);
        close(left / outcome.maximum_overlap, remains);
    }
}

/// Eq. (57): k_t/k of an undamped contact for e_t0 of solid spheres; corrected for damped ones (errata L-E5, L-E6).
#[test]
fn stiffness_of_the_tangential_spring() {
    let found = |normal: &str, ratio: f64, friction: &str| {
        let laws =
            format!("{normal}, tangential: TangentialSpring(stiffness_ratio: {ratio}, friction: {friction})");
        -impact(&laws, 0.1, 1e-3).tangential_speed / 1e-3
    };
    let elastic = "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 1)";
    for (restitution, ratio) in
        [(0.0, 0.071428571), (0.25, 0.096257060), (0.5, 0.126984127), (0.75, 0.169376480), (1.0, 0.285714286)]
    {
        // Nine decimals of the ratio are some 1e-8 of e_t0.
        let e_t0 = found(elastic, ratio, "inf");
        assert!((e_t0 - restitution).abs() < 3e-8, "{e_t0} {restitution}");
    }
    for (end, restitution, ratio) in [
        ("Overlap", 0.9, 0.126841462),
        ("Force", 0.9, 0.132556203),
        ("Overlap", 0.6, 0.123713268),
        ("Force", 0.6, 0.157101656),
    ] {
        let normal = format!(
            "contact_end: {end}, normal: LinearSpringDashpot(stiffness: 1e4, restitution: {restitution})"
        );
        // A limit that is high and finite lets the spring go with the force.
        let e_t0 = found(&normal, ratio, if end == "Force" { "1e9" } else { "inf" });
        assert!((e_t0 - 0.5).abs() < 1e-6, "{end} {restitution}: {e_t0}");
    }
}

/// Eq. (21): the corner Ψ1_0 and its angle γ0. On both sides of it, twice away, impacts follow the two branches.
#[test]
fn corner_of_the_three_parameter_rule() {
    for (friction, restitution, sticking, corner, angle) in [
        (0.1, 0.9, 0.5, 0.443333333, 156.090694),
        (0.3, 0.9, 0.5, 1.330000000, 126.938763),
        (0.5, 0.6, 0.0, 2.800000000, 109.653824),
    ] {
        near(friction * (1.0 + restitution) * 3.5 / (1.0 + sticking), corner);
        assert!((180.0 - f64::atan(corner).to_degrees() - angle).abs() < 1e-6);
        let laws = format!(
            "normal: LinearSpringDashpot(contact_duration: 20e-6, restitution: {restitution}), \
             tangential: TangentialSpring(tangential_restitution: {sticking}, friction: {friction})"
        );
        let psi2 = |share: f64| impact(&laws, 0.1, 0.1 * share * corner).tangential_speed / 0.1;
        // The last part of a sticking contact slides (erratum L-E28): second order in the share.
        assert!((psi2(0.05) + sticking * 0.05 * corner).abs() < 0.01 * corner, "{}", psi2(0.05));
        let slides = 5.0 * corner - (1.0 + sticking) * corner;
        assert!((psi2(5.0) - slides).abs() < 0.03 * corner, "{} {slides}", psi2(5.0));
    }
}
