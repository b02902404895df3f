//! Slip after a collision, until the spheres roll (Kondic 1999, Secs. IV A 3 to IV B 2).

use super::Spheres;

/// Slip of one sphere from the end of a collision until it rolls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slide {
    /// Velocity at the beginning v^f \[m/s\].
    pub velocity: f64,
    /// Slip at the beginning u^f \[m/s\].
    pub slip: f64,
    /// How long it slips t^s \[s\].
    pub duration: f64,
    /// Velocity when it rolls v^s \[m/s\].
    pub final_velocity: f64,
    /// How far its centre goes s \[m\].
    pub distance: f64,
}

impl Slide {
    /// Under constant friction: Eqs. (42)-(44), (59) and (60).
    pub fn new(spheres: &Spheres, velocity: f64, slip: f64) -> Self {
        let q = spheres.inertia_number;
        let duration = slip.abs() / ((1.0 + q) * spheres.kinetic_friction * spheres.gravity);
        let final_velocity = velocity - slip / (1.0 + q);
        let distance = 0.5 * (velocity + final_velocity) * duration;
        Self { velocity, slip, duration, final_velocity, distance }
    }

    /// Loss of translational energy, 2 ΔE/m \[m²/s²\]: Eq. (45).
    pub fn energy_loss(&self) -> f64 {
        self.velocity * self.velocity - self.final_velocity * self.final_velocity
    }

    /// Loss of momentum, Δp/m \[m/s\].
    pub fn momentum_loss(&self) -> f64 {
        self.velocity - self.final_velocity
    }
}

/// Both spheres after a collision of rolling ones with velocities `v_i` and `v_j` \[m/s\]: Eqs. (A7) and (57). The first one
/// is i, which is ahead. `spin_share` is C of Eq. (56), or [`C_eff`](super::vertical::effective_share).
pub fn slides(spheres: &Spheres, v_i: f64, v_j: f64, restitution: f64, spin_share: f64) -> [Slide; 2] {
    let (sum, difference) = (v_i + v_j, v_i - v_j);
    let slip = -0.5 * (1.0 + restitution) * difference;
    [
        Slide::new(spheres, 0.5 * (sum - restitution * difference), slip + spin_share * sum),
        Slide::new(spheres, 0.5 * (sum + restitution * difference), -slip + spin_share * sum),
    ]
}

/// How long spheres slip after a symmetric collision \[s\]: Eq. (42).
pub fn duration(spheres: &Spheres, speed: f64, restitution: f64) -> f64 {
    let friction = spheres.kinetic_friction * spheres.gravity;
    0.5 * (1.0 + restitution) * speed / (friction * (1.0 + spheres.inertia_number))
}

/// Velocity with which they then roll \[m/s\]: Eq. (43).
pub fn final_velocity(spheres: &Spheres, speed: f64, restitution: f64) -> f64 {
    0.5 * speed * effective_restitution(spheres.inertia_number, restitution)
}

/// How far each has gone \[m\]: Eq. (44), erratum K-E23.
pub fn distance(spheres: &Spheres, speed: f64, restitution: f64) -> f64 {
    let (q, e) = (spheres.inertia_number, restitution);
    let friction = spheres.kinetic_friction * spheres.gravity;
    speed * speed * (1.0 + e) * (e - 1.0 + 2.0 * q * e) / (8.0 * friction * (1.0 + q) * (1.0 + q))
}

/// Signed effective restitution of rolling spheres: Eq. (68), erratum K-E40. Below zero they approach again.
pub fn effective_restitution(inertia_number: f64, restitution: f64) -> f64 {
    (restitution * inertia_number - 1.0) / (1.0 + inertia_number)
}

/// Share of the translational energy that slip takes after a symmetric collision: Eq. (46).
pub fn energy_share(inertia_number: f64, restitution: f64) -> f64 {
    let (q, e) = (inertia_number, restitution);
    (1.0 + e) * (e - 1.0 + 2.0 * e * q) / ((1.0 + q) * (1.0 + q))
}

/// Energy lost in the collision over that lost by slip: Eq. (47).
pub fn energy_ratio(inertia_number: f64, restitution: f64) -> f64 {
    (1.0 - restitution * restitution) / energy_share(inertia_number, restitution)
}

/// Share of the momentum that slip takes: Eq. (48).
pub fn momentum_share(inertia_number: f64, restitution: f64) -> f64 {
    (1.0 + restitution) / (1.0 + inertia_number)
}

/// Momentum lost in the collision over that lost by slip: Eq. (49).
pub fn momentum_ratio(inertia_number: f64, restitution: f64) -> f64 {
    (1.0 - restitution) / momentum_share(inertia_number, restitution)
}

/// Ratio v_i/v_j at which sphere i is back at the place of the collision when it rolls: Eq. (61), erratum K-E24.
pub fn no_distance_ratio(inertia_number: f64, restitution: f64, spin_share: f64) -> f64 {
    let (q, e, c) = (inertia_number, restitution, spin_share);
    ((e + 2.0) * (1.0 + q) + e * q - 1.0 - 2.0 * c) / ((e - 2.0) * (1.0 + q) + e * q - 1.0 + 2.0 * c)
}

/// Energies that slip takes after one sphere has hit another at rest, over the initial energy: of the struck one, of the
/// other, and of both. Eqs. (62)-(64), errata K-E25 and K-E26.
pub fn energy_shares_one_at_rest(inertia_number: f64, restitution: f64, spin_share: f64) -> [f64; 3] {
    let (q, e, c) = (inertia_number, restitution, spin_share);
    let square = (1.0 + q) * (1.0 + q);
    let half = 0.5 * (1.0 + e);
    let struck = (half + c) / square * ((1.0 + e) * (0.5 + q) - c);
    let other = -(half - c) / square * ((1.0 - e) * (1.0 + q) + half - c);
    let both = (half * ((1.0 + e) * q - (1.0 - e) * (1.0 + q)) + 2.0 * c * (1.0 + q) - 2.0 * c * c) / square;
    [struck, other, both]
}

/// Of both after an elastic collision with one at rest: Eq. (65).
pub fn elastic_one_at_rest(inertia_number: f64) -> f64 {
    2.0 * inertia_number / ((1.0 + inertia_number) * (1.0 + inertia_number))
}

/// Of both after a symmetric elastic collision: Eq. (66), twice Eq. (65).
pub fn elastic_symmetric(inertia_number: f64) -> f64 {
    2.0 * elastic_one_at_rest(inertia_number)
}

/// Momentum Δp/m that sphere i loses by slip after an elastic collision \[m/s\]: Eq. (67).
pub fn elastic_momentum_loss(inertia_number: f64, difference: f64) -> f64 {
    -difference / (1.0 + inertia_number)
}
