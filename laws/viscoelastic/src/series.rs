//! How the restitution depends on the one number that matters.
//!
//! In units of the impact speed and of (m12/ρ)^(2/5) v^(4/5) the motion is x'' = -(x^(3/2) + q √x x'), so that the
//! restitution is a function of q = 3/2 A (ρ/m12)^(2/5) v^(1/5) alone, with ρ = 4/3 E* √R*.

use granule_law_api::testing::reference;
use granule_law_api::{ContactEnd, Impact};

/// Restitution at a given q by integration; good to 1e-7.
pub(crate) fn restitution(q: f64, end: ContactEnd) -> f64 {
    let unit = Impact { reduced_mass: 1.0, reduced_radius: 1.0, normal_speed: 1.0 };
    reference::impact(&unit, end, 1.0, |overlap, velocity| {
        let root = overlap.sqrt();
        root * (overlap + q * velocity)
    })
    .restitution
}

/// The q that gives a restitution in (0, 1], to the accuracy of [`restitution`].
pub(crate) fn dissipation(wanted: f64, end: ContactEnd) -> f64 {
    if wanted >= 1.0 {
        return 0.0;
    }
    // The loss is at most C1 q.
    let mut low = (1.0 - wanted) / C1;
    let mut high = 2.0 * low;
    while restitution(high, end) > wanted && high < f64::MAX {
        low = high;
        high *= 2.0;
    }
    // Each halving costs an integration; beyond its accuracy they would only chase noise.
    while high - low > 1e-10 * high {
        let middle = 0.5 * (low + high);
        if restitution(middle, end) > wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// First coefficient of the series at low speed, e = 1 - C1 q + C2 q² - ... (Ramírez et al. 1999, Eq. (21); Schwager and
/// Pöschel 1998): Γ(3/5) √π/(2^(1/5) 5^(2/5) Γ(21/10)).
pub(crate) const C1: f64 = 1.153_448_858_095_288;

#[cfg(test)]
mod tests {
    use super::*;

    /// The overlap-ended series e = 1 - C1 q + 3/5 C1² q² - ... (Ramírez et al. 1999; Schwager and Pöschel 1998). What is left
    /// after two terms is -0.5229 q³ + 0.349 q⁴, extrapolated from an integration in the plane of √x and x' with 8000 steps.
    #[test]
    fn restitution_is_the_series_at_low_speed() {
        for q in [0.01, 0.03, 0.1] {
            let exact = restitution(q, ContactEnd::Overlap);
            let two = 1.0 - C1 * q + 0.6 * C1 * C1 * q * q;
            // The next terms are 0.23 q⁵ and smaller ones; the integration is good to 1e-7.
            let left = exact - two + 0.5229 * q.powi(3) - 0.349 * q.powi(4);
            assert!(left.abs() < 0.4 * q.powi(5) + 1e-7, "{q}: {left:e}");
            assert!((exact - (1.0 - C1 * q)).abs() < 0.8 * q * q);
        }
    }

    /// A contact that ends with its force recovers later and loses less: 4/15 q^(5/2) to lowest order (Schwager and Pöschel
    /// 2008, Eq. (33): 0.266666).
    #[test]
    fn force_ended_contacts_lose_less() {
        for q in [0.02, 0.05] {
            let gain = restitution(q, ContactEnd::Force) - restitution(q, ContactEnd::Overlap);
            let expected = 4.0 / 15.0 * q.powf(2.5);
            // The next term is of order q^(7/2) or q³ with a coefficient of order one.
            assert!(
                gain > 0.0 && (gain / expected - 1.0).abs() < 3.0 * q.sqrt(),
                "{q}: {gain:e} {expected:e}"
            );
        }
    }

    #[test]
    fn dissipation_inverts_restitution() {
        for end in [ContactEnd::Force, ContactEnd::Overlap] {
            for wanted in [1.0, 0.999, 0.9, 0.5, 0.1, 0.01] {
                let q = dissipation(wanted, end);
                assert!((restitution(q, end) - wanted).abs() < 1e-7, "{end:?} {wanted} {q}");
            }
        }
    }
}
