//! Closed forms of a damped linear contact, shared by laws, oracles and parameter inversions.
//!
//! A contact m12 δ'' + γ δ' + k δ = 0 is described by its damping ratio β = γ / (2 sqrt(k m12)), which is η/ω0 in
//! Luding 1998, Eq. (28). Everything follows from one function, g(β) = arccos(β)/sqrt(1-β²) =
//! arcosh(β)/sqrt(β²-1), analytic through critical damping: a contact that ends when the force vanishes lasts
//! t_c = 2 g(β)/ω0 (Eq. (36), second form, erratum L-E8), has the restitution e = exp(-2 β g(β)) (erratum L-E7) and the
//! largest overlap v_0 exp(-β g(β))/ω0 (Eq. (34)).
//!
//! The same ratio governs power laws δ^(1+α) whose damping goes with δ^(α/2) (erratum L-E26).

use std::f64::consts::PI;

use crate::ContactEnd;

/// g(β) = arccos(β)/sqrt(1-β²) below critical damping and arcosh(β)/sqrt(β²-1) above; g(0) = π/2, g(1) = 1.
pub fn half_phase(damping_ratio: f64) -> f64 {
    let beta = damping_ratio;
    let y = 1.0 - beta;
    if y.abs() < 0.05 {
        // Both closed forms are 0/0 at β = 1. The series Σ n!/(1·3·5…(2n+1)) y^n converges like (y/2)^n.
        let (mut sum, mut term) = (1.0, 1.0);
        for n in 1..16 {
            term *= y * f64::from(n) / f64::from(2 * n + 1);
            sum += term;
        }
        sum
    } else if beta < 1.0 {
        beta.acos() / ((1.0 - beta) * (1.0 + beta)).sqrt()
    } else {
        beta.acosh() / ((beta - 1.0).sqrt() * (beta + 1.0).sqrt())
    }
}

/// Duration of the contact times ω0 = sqrt(k/m12). Infinite for a contact that ends with its overlap at or above
/// critical damping: the overlap then creeps to zero and never gets there.
pub fn duration(damping_ratio: f64, end: ContactEnd) -> f64 {
    match end {
        ContactEnd::Force => 2.0 * half_phase(damping_ratio),
        ContactEnd::Overlap if damping_ratio < 1.0 => {
            PI / ((1.0 - damping_ratio) * (1.0 + damping_ratio)).sqrt()
        }
        ContactEnd::Overlap => f64::INFINITY,
    }
}

/// Restitution; zero for a contact that never ends.
pub fn restitution(damping_ratio: f64, end: ContactEnd) -> f64 {
    match end {
        ContactEnd::Force => (-2.0 * damping_ratio * half_phase(damping_ratio)).exp(),
        ContactEnd::Overlap => {
            let duration = duration(damping_ratio, end);
            if duration.is_finite() { (-damping_ratio * duration).exp() } else { 0.0 }
        }
    }
}

/// Largest overlap times ω0/v_0; the same for both ends of contact.
pub fn largest_overlap(damping_ratio: f64) -> f64 {
    (-damping_ratio * half_phase(damping_ratio)).exp()
}

/// The damping ratio that gives the restitution `restitution` in (0, 1]: the inverse of [`restitution`].
pub fn damping_ratio(restitution: f64, end: ContactEnd) -> f64 {
    let loss = -restitution.ln();
    if loss <= 0.0 {
        return 0.0;
    }
    match end {
        ContactEnd::Overlap => loss / (PI * PI + loss * loss).sqrt(),
        ContactEnd::Force => {
            // 2 β g(β) rises from 0 with slope π and is concave, so loss/π is a lower bound.
            let of = |beta: f64| 2.0 * beta * half_phase(beta);
            let mut low = loss / PI;
            let mut high = 2.0 * low;
            while of(high) < loss {
                low = high;
                high *= 2.0;
            }
            loop {
                let middle = 0.5 * (low + high);
                if middle <= low || middle >= high {
                    return middle;
                }
                if of(middle) < loss {
                    low = middle;
                } else {
                    high = middle;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Luding 1998, Eqs. (32) and (36), at given η/ω: ω t_c^f, e of the overlap end, e of the force end.
    #[test]
    fn golden_numbers() {
        let table = [
            (0.1, 2.942255349, 0.730402691, 0.745108425),
            (0.5, 2.214297436, 0.207879576, 0.330499968),
            (1.0, 0.5 * PI, 0.043213918, 0.207879576),
            (2.0, 0.927295218, 0.001867443, 0.156517033),
        ];
        for (eta_per_omega, phase, overlap_end, force_end) in table {
            let f = f64::hypot(eta_per_omega, 1.0);
            let beta = eta_per_omega / f;
            // The table has nine decimals.
            assert!((duration(beta, ContactEnd::Force) / f - phase).abs() < 1e-9);
            assert!((duration(beta, ContactEnd::Overlap) / f - PI).abs() < 1e-12);
            assert!((restitution(beta, ContactEnd::Overlap) - overlap_end).abs() < 1e-9);
            assert!((restitution(beta, ContactEnd::Force) - force_end).abs() < 1e-9);
        }
        assert!((restitution(1.0, ContactEnd::Force) - 0.135335283).abs() < 1e-9);
    }

    #[test]
    fn half_phase_is_smooth_through_critical_damping() {
        for edge in [0.95_f64, 1.05] {
            let (inside, outside) = (half_phase(edge + 1e-9 * (1.0 - edge).signum()), half_phase(edge));
            // The slope is -1/3 there; the closed forms lose about ε/0.05.
            assert!((inside - outside).abs() < 1e-9, "{inside} {outside}");
        }
        assert_eq!(half_phase(1.0), 1.0);
        assert!((half_phase(0.0) - PI / 2.0).abs() < 1e-15);
    }

    #[test]
    fn damping_ratio_inverts_restitution() {
        for end in [ContactEnd::Force, ContactEnd::Overlap] {
            for e in [1.0, 1.0 - 1e-15, 0.999, 0.9, 0.6, 0.3, 0.135335283, 0.1, 1e-3, 1e-12] {
                let back = restitution(damping_ratio(e, end), end);
                // e = exp(-x): an error of a few ε in x is magnified by x; near critical damping of the overlap end
                // 1-β² loses digits in proportion to x².
                let x = -f64::ln(e);
                assert!((back / e - 1.0).abs() < 1e-14 * (1.0 + x * x * x), "{end:?} {e} {back}");
            }
        }
        assert!(damping_ratio(1e-300, ContactEnd::Force).is_finite());
    }

    #[test]
    fn overlap_end_has_no_end_when_overdamped() {
        assert_eq!(duration(1.0, ContactEnd::Overlap), f64::INFINITY);
        assert_eq!(restitution(2.5, ContactEnd::Overlap), 0.0);
        assert!(largest_overlap(2.5) > 0.0);
    }
}
