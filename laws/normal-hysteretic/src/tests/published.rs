//! Numbers known from elsewhere.

use super::{ContactEnd, Impact, closed_form};

/// Luding 1998, Eqs. (45)-(47), with k_1 = 10^4 N/m, k_2 = 2 10^4 N/m, m12 = 1 g at 1 m/s: restitution, duration, largest
/// and plastic overlap.
#[test]
fn reference_impact() {
    let values = [("loading_stiffness", 1e4), ("unloading_stiffness", 2e4)];
    let impact = Impact { reduced_mass: 1e-3, reduced_radius: 1e-2, normal_speed: 1.0 };
    let outcome = closed_form(&values, ContactEnd::Force, &impact);
    // The references have six to eight digits.
    assert!((outcome.restitution - std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-14, "{outcome:?}");
    assert!((outcome.duration / 8.47970e-4 - 1.0).abs() < 1e-6, "{outcome:?}");
    assert!((outcome.maximum_overlap / 3.16228e-4 - 1.0).abs() < 1e-6, "{outcome:?}");
    // What is left of the overlap closes at the speed of separation.
    let apart = closed_form(&values, ContactEnd::Overlap, &impact);
    let plastic = (apart.duration - outcome.duration) * outcome.restitution;
    assert!((plastic / 1.58114e-4 - 1.0).abs() < 1e-5, "{plastic}");
}

/// k_1 t_c²/m12 and δ_0/δ_max of given restitutions.
#[test]
fn golden_stiffnesses_and_plastic_overlaps() {
    for (e, stiffness, plastic) in
        [(0.9, 8.907317972, 0.19), (0.6, 6.316546817, 0.64), (0.3, 4.169907859, 0.91)]
    {
        let duration = 1e-4;
        let values = [("restitution", e), ("contact_duration", duration)];
        let impact = Impact { reduced_mass: 3e-5, reduced_radius: 1e-3, normal_speed: 0.3 };
        let outcome = closed_form(&values, ContactEnd::Force, &impact);
        let loading = impact.reduced_mass * (impact.normal_speed / outcome.maximum_overlap).powi(2);
        // The table has nine decimals.
        let found = loading * duration * duration / impact.reduced_mass;
        assert!((found - stiffness).abs() < 1e-8, "{e}: {found}");
        assert!((outcome.duration / duration - 1.0).abs() < 1e-14 && (outcome.restitution - e).abs() < 1e-14);
        let left = 1.0 - e * e;
        assert!((left - plastic).abs() < 1e-14, "{e}");
    }
}

/// Restitutions that LIGGGHTS 3.8 `hooke/hysteresis` (coefficientRestitution near 1, no adhesion) gives for two spheres of
/// 1 cm radius and 2500 kg/m³ at 1 m/s with k_1 = 6265.123 N/m: k_2/k_1 = 2, 5, 10 and plasticity depth 0.2 and 0.5.
#[test]
fn restitution_as_measured_in_liggghts() {
    let mass = 0.5 * 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-6;
    for (ratio, depth, measured) in [
        (2.0, 0.2, 0.902203),
        (5.0, 0.2, 0.637227),
        (10.0, 0.2, 0.461145),
        (2.0, 0.5, 0.957204),
        (5.0, 0.5, 0.794282),
        (10.0, 0.5, 0.634875),
    ] {
        let values = [
            ("loading_stiffness", 6265.123),
            ("largest_unloading_stiffness", ratio * 6265.123),
            ("plasticity_depth", depth),
        ];
        let impact = Impact { reduced_mass: mass, reduced_radius: 5e-3, normal_speed: 1.0 };
        let found = closed_form(&values, ContactEnd::Force, &impact).restitution;
        // Measured to six digits.
        assert!((found - measured).abs() < 2e-6, "{ratio} {depth}: {found} {measured}");
    }
}
