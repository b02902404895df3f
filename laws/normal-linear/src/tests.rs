use super::*;
use granule_law_api::testing::{Contacts, conformance, reference};
use proptest::prelude::*;

#[test]
fn conforms() {
    conformance::<LinearSpringDashpot>();
}

fn context(end: ContactEnd, mass: f64) -> PairContext {
    PairContext { contact_end: end, ..PairContext::single(mass, 1e-3, 0.4, 0.5) }
}

fn compiled(values: &[(&str, f64)], pair: &PairContext) -> Box<dyn Stage<f64>> {
    let params = Params::new(&LinearSpringDashpot::INFO, values).unwrap();
    LinearSpringDashpot::compile::<f64>(&params, pair).unwrap()
}

/// A head-on impact of the compiled stage by the reference integration.
fn collide(values: &[(&str, f64)], end: ContactEnd, mass: f64, scale: f64) -> ImpactOutcome {
    let impact = Impact { reduced_mass: mass, reduced_radius: 1e-3, normal_speed: 0.5 };
    reference::impact_with(&*compiled(values, &context(end, mass)), &impact, end, scale)
}

/// Luding 1998, Eqs. (32)-(36) with m12 = ω0 = v = 1, at η/ω0 = 0.05 to 0.5: restitution under the force end and the
/// overlap end, and the largest overlap exp[-(η/ω) asin(ω/ω0)].
#[test]
fn reference_restitution_and_largest_overlap() {
    let table = [
        (0.05, 0.858758, 0.854468),
        (0.1, 0.744079, 0.729248),
        (0.2, 0.571740, 0.526621),
        (0.3, 0.450975, 0.372326),
        (0.5, 0.298436, 0.163034),
    ];
    for (eta, force_end, overlap_end) in table {
        let values = [("stiffness", 1.0), ("damping", 2.0 * eta)];
        for (end, expected) in [(ContactEnd::Force, force_end), (ContactEnd::Overlap, overlap_end)] {
            let outcome = collide(&values, end, 1.0, 1.0);
            // The table has six digits.
            assert!((outcome.restitution - expected).abs() < 1e-6, "{eta} {end:?} {outcome:?}");
            let omega = f64::sqrt(1.0 - eta * eta);
            let largest = 0.5 * (-(eta / omega) * omega.asin()).exp();
            assert!((outcome.maximum_overlap - largest).abs() < 1e-9, "{eta} {outcome:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// (restitution, contact_duration) gives both to every pair, whatever its mass, under either end of contact.
    #[test]
    fn every_pair_has_the_intended_restitution_and_duration(
        restitution in 0.02..1.0_f64,
        duration in -6.0..0.0_f64,
        mass in -9.0..3.0_f64,
        by_force in any::<bool>(),
    ) {
        let end = if by_force { ContactEnd::Force } else { ContactEnd::Overlap };
        let (duration, mass) = (10.0_f64.powf(duration), 10.0_f64.powf(mass));
        let values = [("restitution", restitution), ("contact_duration", duration)];
        let outcome = collide(&values, end, mass, duration);
        // The reference integration is good to 1e-9; strong damping magnifies that where the end is approached slowly.
        prop_assert!((outcome.restitution - restitution).abs() < 1e-7);
        prop_assert!((outcome.duration / duration - 1.0).abs() < 1e-7);
    }

    /// (stiffness, restitution) gives the restitution to every pair.
    #[test]
    fn every_pair_has_the_intended_restitution(restitution in 0.02..1.0_f64, mass in -9.0..3.0_f64) {
        let mass = 10.0_f64.powf(mass);
        for end in [ContactEnd::Force, ContactEnd::Overlap] {
            let scale = (mass / 1e4).sqrt();
            let outcome = collide(&[("stiffness", 1e4), ("restitution", restitution)], end, mass, scale);
            prop_assert!((outcome.restitution - restitution).abs() < 1e-7);
        }
    }
}

/// Erratum L-E7: damping tuned with Luding 1998, Eq. (32), gives more than asked for when the force ends the contact.
#[test]
fn printed_restitution_holds_for_the_overlap_end_only() {
    let table = [
        (0.95, 0.950506585),
        (0.9, 0.902026069),
        (0.8, 0.808099335),
        (0.7, 0.718201361),
        (0.6, 0.632290516),
        (0.5, 0.550283170),
        (0.3, 0.397140500),
    ];
    for (asked, realised) in table {
        let log = f64::ln(asked);
        // Eq. (32): η/ω = -ln e/π, with m12 = k = 1.
        let damping = 2.0 * -log / (PI * PI + log * log).sqrt();
        let tuned = [("stiffness", 1.0), ("damping", damping)];
        assert!((collide(&tuned, ContactEnd::Overlap, 1.0, 1.0).restitution - asked).abs() < 1e-8);
        assert!((collide(&tuned, ContactEnd::Force, 1.0, 1.0).restitution - realised).abs() < 1e-8);
        let corrected = [("stiffness", 1.0), ("restitution", asked)];
        assert!((collide(&corrected, ContactEnd::Force, 1.0, 1.0).restitution - asked).abs() < 1e-8);
    }
}

/// Erratum L-E8: of the two forms of Luding 1998, Eq. (36), the first fails beyond η = ω.
#[test]
fn second_form_of_the_force_ended_duration_is_right() {
    for eta_per_omega in [0.5, 1.5, 2.0] {
        // ω = 1, m12 = 1: k = 1 + η².
        let eta: f64 = eta_per_omega;
        let values = [("stiffness", 1.0 + eta * eta), ("damping", 2.0 * eta)];
        let duration = collide(&values, ContactEnd::Force, 1.0, 1.0).duration;
        let first = PI - (2.0 * eta / (1.0 - eta * eta)).atan();
        let second = PI - 2.0 * eta.atan();
        assert!((duration - second).abs() < 1e-8, "{eta}: {duration}");
        assert_eq!((duration - first).abs() < 1e-8, eta < 1.0, "{eta}: {duration} {first}");
    }
}

/// Beyond critical damping (the paper is silent): e = [(η-W)/(η+W)]^(η/W), t_c = ln[(η+W)/(η-W)]/W, W = sqrt(η²-ω0²).
#[test]
fn overdamped_contacts_end_with_the_force_or_never() {
    for eta in [1.2_f64, 2.0, 5.0] {
        let values = [("stiffness", 1.0), ("damping", 2.0 * eta)];
        let w = (eta * eta - 1.0).sqrt();
        let outcome = collide(&values, ContactEnd::Force, 1.0, 1.0);
        let ratio = (eta - w) / (eta + w);
        assert!((outcome.restitution - ratio.powf(eta / w)).abs() < 1e-8, "{eta} {outcome:?}");
        assert!((outcome.duration + ratio.ln() / w).abs() < 1e-8, "{eta} {outcome:?}");

        let pair = context(ContactEnd::Overlap, 1.0);
        let params = Params::new(&LinearSpringDashpot::INFO, &values).unwrap();
        let impact = Impact { reduced_mass: 1.0, reduced_radius: 1e-3, normal_speed: 0.5 };
        let Oracle::Normal(oracle) = LinearSpringDashpot::oracle(&params, &pair) else { panic!("no oracle") };
        assert_eq!((oracle(&impact).duration, oracle(&impact).restitution), (f64::INFINITY, 0.0));
        let scale = LinearSpringDashpot::time_scale(&params, &pair, &impact).unwrap().unwrap();
        assert!((scale.duration - outcome.duration).abs() < 1e-8);
        let summary = LinearSpringDashpot::summary(&params, &pair).unwrap();
        assert_eq!(summary.duration, DurationRule::Unknown);
    }
}

#[test]
fn only_the_overlap_end_attracts() {
    let values = [("stiffness", 1e4), ("restitution", 0.5)];
    for (end, attracts) in [(ContactEnd::Force, false), (ContactEnd::Overlap, true)] {
        let mut contact = Contacts::new(3, 0);
        contact.overlap = vec![1e-9, 1e-5, 1e-9];
        contact.normal_velocity = vec![-0.1, -0.1, 0.1];
        contact.reduced_mass = vec![1e-4; 3];
        contact.run(&*compiled(&values, &context(end, 1e-4)), 0.0);
        assert_eq!(contact.normal_force[0] < 0.0, attracts);
        assert!(contact.normal_force[1] > 0.0 || attracts);
        assert!(contact.normal_force[2] > 0.0);
    }
}

/// LAMMPS gran/hooke and LIGGGHTS hooke/stiffness: F_n = K_n δ - m12 γ_n v_n with v_n negative on approach.
#[test]
fn lammps_gran_hooke_is_a_form() {
    let pair = context(ContactEnd::Overlap, 2e-6);
    let mut contact = Contacts::new(1, 0);
    contact.overlap[0] = 1e-5;
    contact.normal_velocity[0] = 0.13;
    contact.reduced_mass[0] = 2e-6;
    contact.run(&*compiled(&[("stiffness", 1000.0), ("damping_rate", 2620.0)], &pair), 0.0);
    approx::assert_relative_eq!(
        contact.normal_force[0],
        1000.0 * 1e-5 + 2e-6 * 2620.0 * 0.13,
        max_relative = 1e-15
    );
    assert_eq!(contact.normal_stiffness[0], 1000.0);
    approx::assert_relative_eq!(contact.normal_damping[0], 2e-6 * 2620.0, max_relative = 1e-15);
}

#[test]
fn duration_is_told_to_tangential_laws() {
    let summary = |values: &[(&str, f64)], pair: &PairContext| {
        let params = Params::new(&LinearSpringDashpot::INFO, values).unwrap();
        LinearSpringDashpot::summary(&params, pair).unwrap().duration
    };
    let single = context(ContactEnd::Force, 1e-4);
    let mut spread = single;
    spread.reduced_mass.max = 2e-4;
    let DurationRule::Constant(duration) =
        summary(&[("restitution", 0.5), ("contact_duration", 3e-5)], &spread)
    else {
        panic!("the duration is the same for every pair");
    };
    approx::assert_relative_eq!(duration, 3e-5, max_relative = 1e-14);
    assert!(matches!(
        summary(&[("stiffness", 1e4), ("restitution", 0.5)], &spread),
        DurationRule::Oscillator(_)
    ));
    let damped = [("stiffness", 1e4), ("damping", 0.1)];
    assert!(matches!(summary(&damped, &single), DurationRule::Oscillator(_)));
    assert_eq!(summary(&damped, &spread), DurationRule::Unknown);
    assert_eq!(summary(&[("stiffness", 1e4), ("damping", 0.0)], &spread), DurationRule::Oscillator(PI));
}

#[test]
fn zero_restitution_is_refused() {
    let errors = Params::new(&LinearSpringDashpot::INFO, &[("restitution", 0.0), ("contact_duration", 1e-4)]);
    assert_eq!(
        errors.unwrap_err()[0].to_string(),
        "restitution: 0 is not allowed (restitution must be greater than 0 and at most 1)"
    );
}
