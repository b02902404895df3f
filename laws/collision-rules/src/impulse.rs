//! The three-parameter impulse, shared by all rules of this crate.

use granule_law_api::{Bound, Collision, CollisionImpulse, Dimension, ParamSpec, ValueRange};

pub(crate) const FRICTION: ParamSpec = ParamSpec {
    name: "friction",
    symbol: "mu",
    doc: "Coefficient of friction: bound of the tangential impulse by the normal one.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange { low: Bound::Inclusive(0.0), high: Bound::Open, infinite: true },
};

pub(crate) const TANGENTIAL_RESTITUTION: ParamSpec = ParamSpec {
    name: "tangential_restitution",
    symbol: "e_t0",
    doc: "Tangential restitution of sticking contacts: 1 reverses the slip, 0 stops it, -1 leaves it as it is.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange { low: Bound::Inclusive(-1.0), high: Bound::Inclusive(1.0), infinite: false },
};

/// Friction and tangential restitution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surface {
    pub friction: f64,
    pub tangential_restitution: f64,
}

impl Surface {
    /// The tangential motion changes at all.
    pub fn is_rough(&self) -> bool {
        self.friction > 0.0 && self.tangential_restitution > -1.0
    }

    /// Impulse of a collision with normal restitution `e_n`.
    ///
    /// The normal part is m12 (1 + e_n) v_n (Luding 1998, Eq. (16)). The tangential part is -m_t (1 + e_t0) v_t (Eqs.
    /// (19)-(20) with the general m_t of erratum L-E18) unless that is more than mu times the normal part (Eq. (17),
    /// erratum L-E10): then the contact slides.
    #[inline]
    pub fn impulse(&self, e_n: f64, collision: &Collision) -> CollisionImpulse {
        let normal = collision.reduced_mass * (1.0 + e_n) * collision.normal_speed;
        if !self.is_rough() {
            return CollisionImpulse { normal, tangential: [0.0; 3] };
        }
        let [x, y, z] = collision.tangential_velocity;
        let slip = length([x, y, z]);
        if slip == 0.0 {
            return CollisionImpulse { normal, tangential: [0.0; 3] };
        }
        let stick = collision.tangential_mass * (1.0 + self.tangential_restitution);
        let slide = self.friction * normal / slip;
        let factor = -if slide < stick { slide } else { stick };
        CollisionImpulse { normal, tangential: [factor * x, factor * y, factor * z] }
    }
}

/// Length of a vector whose squares may leave the range of numbers.
fn length(v: [f64; 3]) -> f64 {
    let largest = v.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let scaled = v.map(|c| c / largest);
    largest * (scaled[0] * scaled[0] + scaled[1] * scaled[1] + scaled[2] * scaled[2]).sqrt()
}
