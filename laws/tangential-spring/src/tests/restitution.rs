//! Tangential restitution: errata L-E5 and L-E6, and what the law refuses.

use std::f64::consts::PI;

use granule_law_api::testing::reference;
use granule_law_api::{
    ContactEnd, ContactLaw, DurationRule, Impact, NormalSummary, ObliqueImpact, Oracle, PairContext, Params,
    Span, oscillator,
};

use crate::TangentialSpring;
use crate::forms::{Model, Stiffness};

const SPHERE: f64 = 0.4;

fn context(duration: DurationRule) -> PairContext {
    PairContext {
        normal: Some(NormalSummary { duration, scale: None }),
        ..PairContext::single(1.0, 1.0, SPHERE, 1.0)
    }
}

fn model(tangential_restitution: f64, pair: &PairContext) -> Model {
    let values = [("tangential_restitution", tangential_restitution), ("friction", f64::INFINITY)];
    Model::new(&Params::new(&TangentialSpring::INFO, &values).unwrap(), pair).unwrap()
}

/// k_t/k for a normal contact of restitution `e` under the given end.
fn ratio(e: f64, tangential_restitution: f64, end: ContactEnd) -> f64 {
    let beta = oscillator::damping_ratio(e, end);
    let pair = context(DurationRule::Oscillator(oscillator::duration(beta, end)));
    let Stiffness::Normal(ratio) = model(tangential_restitution, &pair).stiffness else {
        panic!("not a ratio")
    };
    ratio
}

#[test]
fn golden_stiffness_ratios() {
    for (restitution, expected) in
        [(0.0, 0.071428571), (0.25, 0.096257060), (0.5, 0.126984127), (0.75, 0.169376480), (1.0, 0.285714286)]
    {
        // The table has nine decimals.
        assert!((ratio(1.0, restitution, ContactEnd::Force) - expected).abs() < 1e-9);
    }
    for (e, end, expected) in [
        (0.9, ContactEnd::Overlap, 0.126841462),
        (0.9, ContactEnd::Force, 0.132556203),
        (0.6, ContactEnd::Overlap, 0.123713268),
        (0.6, ContactEnd::Force, 0.157101656),
    ] {
        assert!((ratio(e, 0.5, end) - expected).abs() < 1e-9, "{e} {end:?}");
    }
}

/// Tangential restitution realised by a stiffness ratio: the spring swings freely for the duration of the normal contact,
/// which is integrated with its damper and its end of contact.
fn realised(e: f64, stiffness_ratio: f64, end: ContactEnd, tuned_for: ContactEnd) -> f64 {
    let damping = 2.0 * oscillator::damping_ratio(e, tuned_for);
    let normal = Impact { reduced_mass: 1.0, reduced_radius: 1.0, normal_speed: 1.0 };
    let duration =
        reference::impact(&normal, end, 1.0, |overlap, velocity| overlap + damping * velocity).duration;
    let mobility = 1.0 + 1.0 / SPHERE;
    let [_, velocity] =
        reference::integrate([0.0, 1.0], duration, |_, [x, v]| [v, -stiffness_ratio * mobility * x]);
    -velocity
}

/// Luding 1998, Eq. (57) ignores damping: k_t/k = q/(1+q) (arccos(-e_t0)/π)² gives too much under the overlap end (erratum
/// L-E5) and too little under the force end (erratum L-E6). What the law uses gives one half always.
#[test]
fn printed_stiffness_misses_the_tangential_restitution() {
    let phase = f64::acos(-0.5) / PI;
    let printed = SPHERE / (1.0 + SPHERE) * phase * phase;
    for (e, by_overlap, by_force) in
        [(0.9, 50.10e-2, 46.18e-2), (0.6, 52.36e-2, 32.72e-2), (0.3, 62.27e-2, 14.90e-2)]
    {
        for (end, expected) in [(ContactEnd::Overlap, by_overlap), (ContactEnd::Force, by_force)] {
            // The printed values were taken with damping tuned for the overlap end, to four digits.
            let found = realised(e, printed, end, ContactEnd::Overlap);
            assert!((found - expected).abs() < 6e-5, "{e} {end:?}: {found}");
            let found = realised(e, ratio(e, 0.5, end), end, end);
            assert!((found - 0.5).abs() < 1e-8, "{e} {end:?}: {found}");
        }
    }
}

#[test]
fn constant_durations_give_a_stiffness_in_proportion_to_the_mass() {
    let duration = 3e-5;
    let Stiffness::Mass(factor) = model(0.25, &context(DurationRule::Constant(duration))).stiffness else {
        panic!("not in proportion to the mass")
    };
    let omega = (factor * (1.0 + 1.0 / SPHERE)).sqrt();
    assert!(((omega * duration).cos() + 0.25).abs() < 1e-14);
}

#[test]
fn what_has_no_tangential_restitution_is_refused_with_a_way_out() {
    let values = [("tangential_restitution", 0.5), ("friction", 0.3)];
    let params = Params::new(&TangentialSpring::INFO, &values).unwrap();
    let error = Model::new(&params, &context(DurationRule::Unknown)).unwrap_err().to_string();
    assert_eq!(
        error,
        "tangential_restitution: needs a normal law whose contact duration is the same at every speed (use \
         LinearSpringDashpot with (restitution, contact_duration) or (stiffness, restitution), or give stiffness_ratio \
         instead)"
    );
    let mixed =
        PairContext { inertia_factor: Span { min: 0.4, max: 0.5 }, ..context(DurationRule::Constant(1e-4)) };
    let error = Model::new(&params, &mixed).unwrap_err().to_string();
    assert!(error.contains("the bodies have 0.4 to 0.5"), "{error}");
}

/// A spring under a Coulomb limit agrees with the rigid-body result, Luding 1998, Eq. (21), for central and grazing impacts,
/// and not in between (erratum L-E28): it sticks first and slides at the end, as the force fades.
#[test]
fn rigid_body_result_is_met_in_its_limits_only() {
    let (mu, e_t0) = (0.3, 0.5);
    let values = [("tangential_restitution", e_t0), ("friction", mu)];
    let params = Params::new(&TangentialSpring::INFO, &values).unwrap();
    let Oracle::Tangential(oracle) =
        TangentialSpring::oracle(&params, &context(DurationRule::Oscillator(PI)))
    else {
        panic!("no oracle")
    };
    let impact = Impact { reduced_mass: 1.0, reduced_radius: 1.0, normal_speed: 1.0 };
    let mobility = 1.0 + 1.0 / SPHERE;
    let border = 2.0 * mu * mobility / (1.0 + e_t0);
    let difference = |psi: f64| {
        let oblique = ObliqueImpact {
            impact,
            normal_stiffness: 1.0,
            duration: PI,
            tangential_speed: psi,
            tangential_mass: 1.0 / mobility,
        };
        let rigid = (-e_t0 * psi).max(psi - 2.0 * mu * mobility);
        (oracle(&oblique).unwrap() - rigid).abs() / border
    };
    assert!(difference(0.003 * border) < 0.003);
    assert!(difference(5.0 * border) < 1e-9);
    assert!(difference(0.95 * border) > 0.1);
}
