//! Misprints of Luding 1998 that change physics: the corrected form meets a reference, and the printed one does not.
//!
//! The reference is granule-reference: the registered laws, integrated to about 1e-10.

use std::f64::consts::PI;

use granule_law_api::{ContactEnd, oscillator};
use granule_reference::{Collision, HardLimitOutcome};
use granule_tests::plan;

const NORMAL_SPEED: f64 = 0.1;
/// 1 + 1/q of a solid sphere.
const INERTIA: f64 = 3.5;
const MASS: f64 = 4.0 / 3.0 * PI * 1e-6;

/// A solid sphere of radius 1 mm hits a wall in the hard limit, with the slip `psi` times the normal speed.
fn impact(laws: &str, psi: f64) -> HardLimitOutcome {
    let plan = plan(&format!(
        r#"(version: 1, materials: {{ "a": (density: 1000) }},
        bodies: [Sphere(material: "a", radius: 1e-3, position: (0, 0, 1e-3), velocity: ({}, 0, -{NORMAL_SPEED}))],
        walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), {laws})], run: (duration: "1 ms"))"#,
        psi * NORMAL_SPEED
    ));
    let (collision, composition) = Collision::of_plan(&plan).unwrap();
    let outcome = collision.hard_limit().run(composition).unwrap();
    assert!(outcome.error < 3e-4, "{}", outcome.error);
    outcome
}

fn psi2(outcome: &HardLimitOutcome) -> f64 {
    outcome.tangential_speed / NORMAL_SPEED
}

/// Errata L-E1 and L-E2: k1 = m12 π² (1 + e)²/(4 t_c²) and k2 = k1/e² give the restitution and the duration asked for; the
/// printed (1 + e²) and k1/e give sqrt(e) and another duration.
#[test]
fn hysteretic_stiffnesses() {
    for restitution in [0.9, 0.6, 0.3] {
        let duration = 1e-4;
        let unit = MASS * PI * PI / (4.0 * duration * duration);
        let outcome = |k1: f64, k2: f64| {
            impact(
                &format!(
                    "contact_end: Force, normal: WaltonBraun(loading_stiffness: {k1:e}, unloading_stiffness: {k2:e})"
                ),
                0.0,
            )
        };
        let k1 = unit * (1.0 + restitution) * (1.0 + restitution);
        let right = outcome(k1, k1 / (restitution * restitution));
        // The memory of the largest overlap is a maximum over substeps, which extrapolates badly.
        assert!((right.restitution - restitution).abs() < 1e-5, "{}", right.restitution);
        assert!((right.force_duration / duration - 1.0).abs() < 1e-3, "{}", right.force_duration);
        let k1 = unit * (1.0 + restitution * restitution);
        let printed = outcome(k1, k1 / restitution);
        assert!((printed.restitution - restitution.sqrt()).abs() < 1e-5);
        assert!((printed.restitution - restitution).abs() > 0.04 && printed.force_duration > 1.1 * duration);
    }
}

/// Erratum L-E3: impacts slide at small angles γ (grazing) and stick at large ones (central), not the other way round.
#[test]
fn grazing_impacts_slide_and_central_ones_stick() {
    let laws = "normal: LinearSpringDashpot(contact_duration: 20e-6, restitution: 1), \
                tangential: TangentialSpring(tangential_restitution: 0.5, friction: 0.2)";
    let angle = |gamma: f64| -gamma.to_radians().tan();
    let grazing = impact(laws, angle(100.0));
    // Sliding takes μ (1 + e_n)(1 + 1/q) whatever the spring; the last bit of the contact may stick.
    assert!((psi2(&grazing) - (angle(100.0) - 0.2 * 2.0 * INERTIA)).abs() < 1e-3, "{}", psi2(&grazing));
    assert!((psi2(&grazing) + 0.5 * angle(100.0)).abs() > 1.0, "as printed");
    // A sticking spring reverses a half; it slides only when the force has fallen to the share Ψ1/Ψ1_0 of the largest.
    let central = impact(laws, angle(179.5));
    assert!((psi2(&central) / angle(179.5) + 0.5).abs() < 0.02, "{}", psi2(&central));
    assert!((psi2(&central) - (angle(179.5) - 0.2 * 2.0 * INERTIA)).abs() > 1.0, "as printed");
}

/// Erratum L-E4: friction slows the slip by μ (1 + 1/q)(1 + e_n) v_n; as printed it would speed it up.
#[test]
fn friction_slows_the_slip() {
    for restitution in [1.0, 0.7] {
        let laws = format!(
            "normal: LinearSpringDashpot(contact_duration: 20e-6, restitution: {restitution}), \
             tangential: Coulomb(friction: 0.25)"
        );
        let taken = 0.25 * INERTIA * (1.0 + restitution);
        let found = psi2(&impact(&laws, 4.0));
        assert!((found - (4.0 - taken)).abs() < 1e-8, "{found}");
        assert!((found - (4.0 + taken)).abs() > 1.0, "as printed");
    }
}

/// Errata L-E5 and L-E6: the tangential stiffness for a wanted e_t0, with the true duration of the contact. As printed,
/// Eq. (57) gives 0.5010, 0.5236, 0.6227 for the overlap end and 0.4618, 0.3272, 0.1490 for the force end where 0.5 was
/// asked for (independent integration).
#[test]
fn tangential_stiffness_for_a_tangential_restitution() {
    // In per cent.
    let printed = [
        (0.9, ContactEnd::Overlap, 50.10),
        (0.6, ContactEnd::Overlap, 52.36),
        (0.3, ContactEnd::Overlap, 62.27),
        (0.9, ContactEnd::Force, 46.18),
        (0.6, ContactEnd::Force, 32.72),
        (0.3, ContactEnd::Force, 14.90),
    ];
    for (restitution, end, expected) in printed {
        let normal = format!(
            "contact_end: {end:?}, normal: LinearSpringDashpot(stiffness: 1e4, restitution: {restitution})"
        );
        // Friction high enough that nothing slides, and finite, so that the spring goes with the force.
        let limit = if end == ContactEnd::Force { "1e9" } else { "inf" };
        let found = |spring: &str| {
            let laws = format!("{normal}, tangential: TangentialSpring({spring}, friction: {limit})");
            -psi2(&impact(&laws, 0.01)) / 0.01
        };
        let right = found("tangential_restitution: 0.5");
        assert!((right - 0.5).abs() < 1e-6, "{restitution} {end:?}: {right}");
        // Eq. (57) as printed: k_t/k = (arccos(-e_t0)/π)²/(1 + 1/q).
        let ratio = ((-0.5_f64).acos() / PI).powi(2) / INERTIA;
        let as_printed = found(&format!("stiffness_ratio: {ratio}"));
        // Four digits are published, and the damping of the force end is that of e_n under Eq. (32).
        if end == ContactEnd::Overlap {
            assert!((100.0 * as_printed - expected).abs() < 1e-2, "{restitution} {end:?}: {as_printed}");
        }
        assert!((as_printed - 0.5).abs() > 9e-4, "{restitution} {end:?}: {as_printed}");
    }
}

/// Erratum L-E7: damping that Eq. (32) tunes for e_n gives more under the force end; the corrected inversion gives e_n.
#[test]
fn restitution_of_a_contact_that_ends_with_the_force() {
    for (restitution, realised) in [(0.9, 0.902026069), (0.6, 0.632290516), (0.3, 0.397140500)] {
        let run = |beta: f64| {
            let damping = 2.0 * beta * (1e4 * MASS).sqrt();
            let laws = format!(
                "contact_end: Force, normal: LinearSpringDashpot(stiffness: 1e4, damping: {damping:e})"
            );
            impact(&laws, 0.0).restitution
        };
        let right = run(oscillator::damping_ratio(restitution, ContactEnd::Force));
        assert!((right - restitution).abs() < 1e-8, "{right}");
        let printed = run(oscillator::damping_ratio(restitution, ContactEnd::Overlap));
        assert!((printed - realised).abs() < 1e-8, "{printed}");
    }
    // Overdamped, where the paper is silent: e^f = [(η - W)/(η + W)]^(η/W).
    for eta in [1.2_f64, 2.0, 5.0] {
        let w = (eta * eta - 1.0).sqrt();
        let damping = 2.0 * eta * (1e4 * MASS).sqrt();
        let laws =
            format!("contact_end: Force, normal: LinearSpringDashpot(stiffness: 1e4, damping: {damping:e})");
        let found = impact(&laws, 0.0).restitution;
        assert!((found - ((eta - w) / (eta + w)).powf(eta / w)).abs() < 1e-8, "{eta}: {found}");
    }
}

/// Erratum L-E8: beyond η = ω only the second form of Eq. (36) gives the duration, 0.054051 of restitution at η/ω = 1.5...
#[test]
fn duration_beyond_equal_damping_and_frequency() {
    let ratio: f64 = 1.5;
    let beta = ratio / f64::hypot(1.0, ratio);
    let damping = 2.0 * beta * (1e4 * MASS).sqrt();
    let omega = (1e4 / MASS).sqrt() / f64::hypot(1.0, ratio);
    let laws =
        format!("contact_end: Force, normal: LinearSpringDashpot(stiffness: 1e4, damping: {damping:e})");
    let outcome = impact(&laws, 0.0);
    let second = PI - 2.0 * ratio.atan();
    let first = PI - (2.0 * ratio / (1.0 - ratio * ratio)).atan();
    assert!(
        (outcome.force_duration * omega / second - 1.0).abs() < 1e-8,
        "{}",
        outcome.force_duration * omega
    );
    assert!((outcome.restitution - (-ratio * second).exp()).abs() < 1e-8);
    assert!((outcome.force_duration * omega - first).abs() > 1.0, "as printed");
}

/// Erratum L-E19: the damping of Eq. (38) goes with |v/v_0|^ζ1 v. As printed, with the signed v/v_0, the exponent 1 gives a
/// force v²: it drives the separation instead of damping it.
#[test]
fn damping_with_a_power_of_the_speed() {
    let laws = "contact_end: Overlap, normal: PowerLaw(modulus: 1e6, exponent: 0, damping: 0.2, velocity_exponent: 1)";
    let found = impact(laws, 0.0);
    let impact_case =
        granule_law_api::Impact { reduced_mass: MASS, reduced_radius: 1e-3, normal_speed: NORMAL_SPEED };
    // d = 4 R*: k = Y d, and the damping is 0.2 kg/s at 1 m/s.
    let (stiffness, damping) = (1e6 * 4e-3, 0.2);
    let scale = PI * (MASS / stiffness).sqrt();
    let solve = |printed: bool| {
        let force = move |overlap: f64, velocity: f64| {
            let power = if printed { velocity * velocity } else { velocity.abs() * velocity };
            stiffness * overlap + damping * power
        };
        granule_law_api::testing::reference::impact(&impact_case, ContactEnd::Overlap, scale, force)
    };
    let (right, printed) = (solve(false), solve(true));
    assert!((found.restitution - right.restitution).abs() < 1e-8, "{} {right:?}", found.restitution);
    assert!(found.restitution < 1.0 && (found.restitution - printed.restitution).abs() > 1e-3, "{printed:?}");
}
