//! Printed forms that are wrong.

use std::f64::consts::PI;

use super::{ContactEnd, Impact, closed_form};
use granule_law_api::testing::reference;

/// Duration and restitution under loading along `k1` and unloading along `k2`, integrated in two phases.
fn integrated(k1: f64, k2: f64, mass: f64, speed: f64) -> (f64, f64) {
    let (rise, [largest, _], _) = reference::integrate_until(
        0.0,
        [0.0, speed],
        1.0,
        |_, [x, v]| [v, -k1 * x / mass],
        |_, [_, v]| v <= 0.0,
    );
    let left = (1.0 - k1 / k2) * largest;
    let (end, [_, v], _) = reference::integrate_until(
        rise,
        [largest, 0.0],
        1.0,
        |_, [x, v]| [v, -k2 * (x - left) / mass],
        |time, [x, _]| time > rise && x <= left,
    );
    (end, -v / speed)
}

/// Errata L-E1 and L-E2: Luding 1998, text after Eq. (47), prints k_1 = m12 π² (1 + e²)/(4 t_c²) and k_2 = k_1/e; asked for
/// e = 0.6 and t_c = 0.1 ms that gives 0.7746 and 0.152 ms. What the law uses gives what was asked for.
#[test]
fn printed_inversion_misses_restitution_and_duration() {
    let (mass, speed, wanted) = (1e-4, 0.5, 1e-4);
    for e in [0.9_f64, 0.6, 0.3] {
        let scale = mass * PI * PI / (4.0 * wanted * wanted);
        let printed = scale * (1.0 + e * e);
        let (duration, restitution) = integrated(printed, printed / e, mass, speed);
        assert!((restitution - e.sqrt()).abs() < 1e-8 && (duration / wanted - 1.0).abs() > 0.04, "{e}");
        if e == 0.6 {
            assert!((restitution - 0.7746).abs() < 5e-5 && (duration - 1.52e-4).abs() < 5e-7, "{duration}");
        }
        let impact = Impact { reduced_mass: mass, reduced_radius: 1e-3, normal_speed: speed };
        let values = [("restitution", e), ("contact_duration", wanted)];
        let outcome = closed_form(&values, ContactEnd::Force, &impact);
        let k1 = mass * (speed / outcome.maximum_overlap).powi(2);
        let (duration, restitution) = integrated(k1, k1 / (e * e), mass, speed);
        // The reference integration is good to about 1e-9.
        assert!((restitution - e).abs() < 1e-8 && (duration / wanted - 1.0).abs() < 1e-8, "{e} {duration}");
    }
}

/// The duration asked for under the overlap end contains the free flight from δ_0 to zero overlap.
#[test]
fn overlap_ended_duration_is_the_one_asked_for() {
    let impact = Impact { reduced_mass: 1e-4, reduced_radius: 1e-3, normal_speed: 0.5 };
    for e in [1.0, 0.8, 0.2] {
        let values = [("restitution", e), ("contact_duration", 1e-4)];
        let outcome = closed_form(&values, ContactEnd::Overlap, &impact);
        assert!((outcome.duration / 1e-4 - 1.0).abs() < 1e-14, "{e} {outcome:?}");
        let k1 = impact.reduced_mass * (impact.normal_speed / outcome.maximum_overlap).powi(2);
        let (force_ended, restitution) =
            integrated(k1, k1 / (e * e), impact.reduced_mass, impact.normal_speed);
        let left = (1.0 - e * e) * outcome.maximum_overlap;
        let total = force_ended + left / (restitution * impact.normal_speed);
        assert!((total / 1e-4 - 1.0).abs() < 1e-8, "{e} {total}");
    }
}
