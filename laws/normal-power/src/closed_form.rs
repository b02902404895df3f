//! Impacts under f = K δ^(1+α) with damping in proportion to δ^(α/2): exact at any strength of damping.
//!
//! With u = (2/(2+α) · K/m12)^(1/2) δ^((2+α)/2) the motion in the (u, v) plane is v dv/du = -u - 2 β v: that of the damped
//! linear oscillator with ω0 = 1 (Luding 1998, Eqs. (37)-(44); errata L-E23, L-E26). Restitution and largest overlap follow
//! at once; the duration is a quadrature along the oscillator's motion, J(α) δ_max/v_0 of Eqs. (40) and (41) without
//! damping.

use granule_law_api::{ContactEnd, Impact, ImpactOutcome, oscillator};

/// One contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PowerContact {
    /// Exponent α of f = K δ^(1+α).
    pub exponent: f64,
    /// K \[N/m^(1+α)\].
    pub stiffness: f64,
    /// Damping ratio β: γ = 2 β sqrt((2+α)/2 · K δ^α m12).
    pub damping_ratio: f64,
}

impl PowerContact {
    pub fn outcome(&self, impact: &Impact, end: ContactEnd) -> ImpactOutcome {
        let power = 2.0 / (2.0 + self.exponent);
        let beta = self.damping_ratio;
        let speed = impact.normal_speed;
        let length = (impact.reduced_mass / (power * self.stiffness)).sqrt();
        let overlap_at = |u: f64| (length * u).powf(power);
        let span = oscillator::duration(beta, end);
        let duration = if span.is_finite() {
            power * overlap_at(speed) / speed * stretch(beta, end, span, power - 1.0)
        } else {
            f64::INFINITY
        };
        ImpactOutcome {
            duration,
            maximum_overlap: overlap_at(speed * oscillator::largest_overlap(beta)),
            restitution: oscillator::restitution(beta, end),
        }
    }
}

/// Integral over the contact of u(s)^exponent, where u is the oscillator's overlap after an impact at unit speed.
fn stretch(beta: f64, end: ContactEnd, span: f64, exponent: f64) -> f64 {
    let half = 0.5 * span;
    let forward = |s: f64| response(beta, s).powf(exponent);
    // The end of an overlap-ended contact is a zero of u: count from there, so that no digits are lost.
    let backward = |s: f64| match end {
        ContactEnd::Overlap => ((-beta * span).exp() * response(-beta, s)).powf(exponent),
        ContactEnd::Force => response(beta, span - s).powf(exponent),
    };
    integral(half, forward) + integral(half, backward)
}

/// exp(-β s) sin(ω s)/ω with ω = sqrt(1-β²), or its overdamped continuation.
fn response(beta: f64, s: f64) -> f64 {
    let square = (1.0 - beta) * (1.0 + beta);
    let omega = square.abs().sqrt();
    let decay = (-beta * s).exp();
    if omega * s < 1e-5 {
        // sin(x)/x = 1 - x²/6, the rest is below round-off.
        decay * s * (1.0 - square * s * s / 6.0)
    } else if square > 0.0 {
        decay * (omega * s).sin() / omega
    } else {
        decay * (omega * s).sinh() / omega
    }
}

/// Double-exponential quadrature of f over (0, b), where f may have an integrable singularity at 0.
fn integral(b: f64, f: impl Fn(f64) -> f64) -> f64 {
    const STEPS_PER_UNIT: i32 = 32;
    let step = 1.0 / f64::from(STEPS_PER_UNIT);
    let mut sum = 0.0;
    for index in -6 * STEPS_PER_UNIT..=4 * STEPS_PER_UNIT {
        let t = step * f64::from(index);
        let q = (-std::f64::consts::PI * t.sinh()).exp();
        let place = 1.0 / (1.0 + q);
        let weight = std::f64::consts::PI * t.cosh() * place * (q * place);
        let term = weight * f(b * place);
        if term.is_finite() {
            sum += term;
        }
    }
    b * step * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use granule_law_api::testing::reference;

    const IMPACT: Impact = Impact { reduced_mass: 0.7, reduced_radius: 0.5, normal_speed: 1.3 };

    /// J(α) of Luding 1998, Eq. (41), by independent quadrature to ten digits.
    #[test]
    fn undamped_duration_is_j_of_alpha() {
        for (exponent, j) in [
            (0.0, std::f64::consts::PI),
            (0.25, 3.032817662),
            (0.5, 2.943275184),
            (1.0, 2.804364211),
            (1.5, 2.701449061),
        ] {
            let contact = PowerContact { exponent, stiffness: 11.0, damping_ratio: 0.0 };
            let outcome = contact.outcome(&IMPACT, ContactEnd::Force);
            let found = outcome.duration * IMPACT.normal_speed / outcome.maximum_overlap;
            assert!((found - j).abs() < 1e-9, "{exponent}: {found}");
            assert_eq!(outcome.restitution, 1.0);
        }
    }

    #[test]
    fn damped_impacts_meet_the_reference_integration() {
        for exponent in [0.0, 0.5, 1.5] {
            for (end, beta) in [
                (ContactEnd::Force, 0.05),
                (ContactEnd::Force, 0.5),
                (ContactEnd::Force, 1.5),
                (ContactEnd::Overlap, 0.05),
                (ContactEnd::Overlap, 0.5),
            ] {
                let contact = PowerContact { exponent, stiffness: 11.0, damping_ratio: beta };
                let closed = contact.outcome(&IMPACT, end);
                let damping = 2.0 * beta * ((2.0 + exponent) / 2.0 * 11.0 * IMPACT.reduced_mass).sqrt();
                let numeric = reference::impact(&IMPACT, end, closed.duration, |overlap, velocity| {
                    11.0 * overlap.powf(1.0 + exponent) + damping * overlap.powf(0.5 * exponent) * velocity
                });
                // The integrator resolves the start of non-linear contacts to about 1e-8; where the overlap ends the
                // contact, dt/dδ ~ 1/v is steep for strong damping.
                assert!((closed.restitution - numeric.restitution).abs() < 1e-7, "{exponent} {end:?} {beta}");
                assert!((closed.duration / numeric.duration - 1.0).abs() < 1e-6, "{exponent} {end:?} {beta}");
                assert!((closed.maximum_overlap / numeric.maximum_overlap - 1.0).abs() < 1e-7);
            }
        }
    }

    /// Erratum L-E26: damping tuned for an overlap-ended restitution gives these under the force end.
    #[test]
    fn force_end_gives_more_than_the_overlap_end_was_tuned_for() {
        for (asked, given) in
            [(0.95, 0.950507), (0.9, 0.902026), (0.7, 0.718201), (0.6, 0.632291), (0.3, 0.397141)]
        {
            let damping_ratio = oscillator::damping_ratio(asked, ContactEnd::Overlap);
            let contact = PowerContact { exponent: 0.5, stiffness: 1.0, damping_ratio };
            let overlap_end = contact.outcome(&IMPACT, ContactEnd::Overlap).restitution;
            let force_end = contact.outcome(&IMPACT, ContactEnd::Force).restitution;
            assert!((overlap_end - asked).abs() < 1e-12);
            assert!((force_end - given).abs() < 1e-6, "{asked}: {force_end}");
        }
    }
}
