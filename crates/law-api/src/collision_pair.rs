//! Kinematics of a collision: from the motion of two bodies to what a rule sees, and from its impulse back.

use crate::{Collision, CollisionImpulse, CollisionRule};

/// One side of a collision. A wall or a frozen body has an inverse mass of 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollidingBody {
    /// Velocity of the centre; of a wall that of its material at the contact \[m/s\].
    pub velocity: [f64; 3],
    /// Spin \[rad/s\].
    pub spin: [f64; 3],
    /// 1/m \[1/kg\].
    pub inverse_mass: f64,
    /// q = I/(m R²), greater than zero.
    pub inertia_factor: f64,
    /// Radius \[m\], greater than zero.
    pub radius: f64,
}

/// What a collision did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collided {
    /// What the rule saw.
    pub collision: Collision,
    /// Impulse on the first body.
    pub impulse: CollisionImpulse,
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Changes the velocities and spins of two bodies that touch, by a rule. `normal` is the unit vector from the second to
/// the first. `None`, and no change, if they do not approach or neither can move.
///
/// The contact points move by v_c = v1 - v2 - (R1 ω1 + R2 ω2) × n (Luding 1998, Eq. (7)); the impulse changes velocities
/// and spins by Eqs. (10)-(13). Linear and angular momentum about any point are conserved for any two bodies (erratum
/// L-E17). `elastic` takes the normal loss away; the normal speed after the collision is `least_rebound` \[m/s\] at least.
#[inline]
pub fn collide(
    rule: &dyn CollisionRule,
    rough: bool,
    normal: [f64; 3],
    first: &mut CollidingBody,
    second: &mut CollidingBody,
    elastic: bool,
    least_rebound: f64,
) -> Option<Collided> {
    let n = normal;
    let mut v: [f64; 3] = std::array::from_fn(|axis| first.velocity[axis] - second.velocity[axis]);
    let normal_speed = -dot(v, n);
    let inverse = first.inverse_mass + second.inverse_mass;
    if !(normal_speed > 0.0 && inverse > 0.0) {
        return None;
    }
    let mut tangential_mass = 0.0;
    let mut tangential_velocity = [0.0; 3];
    if rough {
        let turning: [f64; 3] =
            std::array::from_fn(|axis| first.radius * first.spin[axis] + second.radius * second.spin[axis]);
        let turning = cross(turning, n);
        v = std::array::from_fn(|axis| v[axis] - turning[axis]);
        // What the turning adds is tangential, but for round-off.
        let along = dot(v, n);
        tangential_velocity = std::array::from_fn(|axis| v[axis] - along * n[axis]);
        tangential_mass = 1.0
            / (first.inverse_mass * (1.0 + 1.0 / first.inertia_factor)
                + second.inverse_mass * (1.0 + 1.0 / second.inertia_factor));
    }
    let reduced_mass = 1.0 / inverse;
    let collision = Collision { normal_speed, tangential_velocity, reduced_mass, tangential_mass, elastic };
    let mut impulse = rule.impulse(&collision);
    let least = reduced_mass * (normal_speed + least_rebound);
    if impulse.normal < least {
        impulse.normal = least;
    }
    let total: [f64; 3] = std::array::from_fn(|axis| impulse.normal * n[axis] + impulse.tangential[axis]);
    for axis in 0..3 {
        first.velocity[axis] += first.inverse_mass * total[axis];
        second.velocity[axis] -= second.inverse_mass * total[axis];
    }
    if rough {
        let torque = cross(n, impulse.tangential);
        for body in [first, second] {
            let share = body.inverse_mass / (body.inertia_factor * body.radius);
            for axis in 0..3 {
                body.spin[axis] -= share * torque[axis];
            }
        }
    }
    Some(Collided { collision, impulse })
}
