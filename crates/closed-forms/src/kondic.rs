//! Closed forms of Kondic 1999 for equal spheres that roll on a surface and meet head-on, with the errata.
//!
//! Velocities are signed along the line of centres, from body j to body i, which stands ahead: i recedes with positive
//! velocities. The inertia number is Q = m R²/I. What the paper prints differently is in [`printed`].

pub mod after;
pub mod during;
pub mod printed;
pub mod vertical;

/// A surface and the spheres on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spheres {
    /// Inertia number Q = m R²/I: 5/2 for homogeneous spheres.
    pub inertia_number: f64,
    /// Radius R \[m\].
    pub radius: f64,
    /// Gravity onto the surface g \[m/s²\].
    pub gravity: f64,
    /// Static friction μ_s.
    pub static_friction: f64,
    /// Kinetic friction μ_k.
    pub kinetic_friction: f64,
}

impl Spheres {
    /// Acceleration of a sphere that rolls on a surface of acceleration `plate` while gravity pulls it along the surface with
    /// `pull` \[m/s²\]: Kondic 1999, Eqs. (15) and (24) with errata K-E16 and K-E17.
    pub fn rolling_acceleration(&self, plate: f64, pull: f64) -> f64 {
        (plate + self.inertia_number * pull) / (1.0 + self.inertia_number)
    }

    /// Smallest acceleration of the surface at which a sphere slips \[m/s²\]: Kondic 1999, Eq. (19).
    pub fn slip_acceleration(&self) -> f64 {
        (1.0 + self.inertia_number) * self.static_friction * self.gravity
    }
}
