//! Formulas as Kondic 1999 prints them where that is wrong: for figures that show the difference, and for tests that fail if
//! one of them comes back. Each names its erratum; nothing computes with them.

use std::f64::consts::PI;

use super::Spheres;

/// Eq. (15), K-E16: 5/7 of the acceleration of the surface instead of 2/7.
pub fn rolling_acceleration(spheres: &Spheres, plate: f64) -> f64 {
    plate / (1.0 + 1.0 / spheres.inertia_number)
}

/// Eq. (24), K-E17: gravity counts with 2/7 instead of 5/7.
pub fn rolling_acceleration_on_incline(spheres: &Spheres, plate: f64, pull: f64) -> f64 {
    (plate + pull) / (1.0 + spheres.inertia_number)
}

/// Eqs. (33) and (C4), K-E3.
pub fn slip_compression(spheres: &Spheres, omega: f64) -> f64 {
    0.5 * spheres.slip_acceleration() / (spheres.radius * omega * omega)
}

/// Eqs. (34) and (C3), K-E4.
pub fn slip_time(spheres: &Spheres, speed: f64, omega: f64) -> f64 {
    spheres.slip_acceleration() / (speed * omega * omega)
}

/// Eq. (35), K-E5.
pub fn slip_speed(spheres: &Spheres, omega: f64) -> f64 {
    spheres.slip_acceleration() / omega
}

/// Eq. (E2), K-E6.
pub fn spin_gain_before_slip(spheres: &Spheres, speed: f64, omega: f64) -> f64 {
    0.5 * super::during::spin_gain_before_slip(spheres, speed, omega)
}

/// Eq. (39), K-E19.
pub fn largest_compression(spheres: &Spheres, speed: f64, omega: f64, rate: f64) -> f64 {
    speed / (2.0 * spheres.radius * omega) * (1.0 - 0.5 * PI * rate / omega)
}

/// Eq. (D1), K-E11.
pub fn balance_compression(spheres: &Spheres, omega: f64) -> f64 {
    0.5 * super::during::balance_compression(spheres, omega)
}

/// Eq. (D3), K-E12.
pub fn longer(spheres: &Spheres, speed: f64, omega: f64) -> f64 {
    0.5 * super::during::longer(spheres, speed, omega)
}

/// Eq. (D4), K-E13.
pub fn deeper(spheres: &Spheres, speed: f64, omega: f64) -> f64 {
    0.5 * super::during::deeper(spheres, speed, omega)
}

/// Eq. (44), K-E23: 1 + e in the denominator.
pub fn distance(spheres: &Spheres, speed: f64, restitution: f64) -> f64 {
    let (q, e) = (spheres.inertia_number, restitution);
    let friction = spheres.kinetic_friction * spheres.gravity;
    speed * speed * (e - 1.0 + 2.0 * q * e) / (8.0 * friction * (1.0 + q) * (1.0 + q) * (1.0 + e))
}

/// Eq. (61), K-E24.
pub fn no_distance_ratio(inertia_number: f64, restitution: f64, spin_share: f64) -> f64 {
    let (q, e, c) = (inertia_number, restitution, spin_share);
    ((e + 2.0) * (1.0 + q) + e * q - 2.0 * c) / ((e - 2.0) * (1.0 + q) + e * q + 2.0 * c)
}

/// Eq. (62), K-E25: the struck sphere with C of the wrong sign.
pub fn energy_share_struck(inertia_number: f64, restitution: f64, spin_share: f64) -> f64 {
    let (q, e, c) = (inertia_number, restitution, spin_share);
    (0.5 * (1.0 + e) - c) / ((1.0 + q) * (1.0 + q)) * ((1.0 + e) * (0.5 + q) - c)
}

/// Eq. (64), K-E26.
pub fn energy_share_both(inertia_number: f64, restitution: f64, spin_share: f64) -> f64 {
    let (q, e, c) = (inertia_number, restitution, spin_share);
    (0.5 * (1.0 + e) - c) * ((1.0 + e) * q - (1.0 - e) * (1.0 + q)) / ((1.0 + q) * (1.0 + q))
}

/// Eq. (E13), K-E30: the exponent without the duration, as printed in units where it is 1 s.
pub fn spin_left(inertia_number: f64, shear_rate: f64) -> f64 {
    (-inertia_number * shear_rate).exp()
}

/// Eq. (E6), K-E14.
pub fn cut_compression(shear_rate: f64, friction: f64, omega: f64, sum: f64, difference: f64) -> f64 {
    0.5 * super::vertical::cut_compression(shear_rate, friction, omega, sum, difference)
}
