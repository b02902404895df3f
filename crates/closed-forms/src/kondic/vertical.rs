//! The force across the surface between spheres that roll (Kondic 1999, Appendices C 2, E 2 and F).
//!
//! `shear_rate` is γ_S \[1/s\], `omega` ω0 \[1/s\], `duration` t_col \[s\]; `sum` and `difference` are |v_i + v_j| and
//! |v_i - v_j| \[m/s\].

use std::f64::consts::PI;

use super::Spheres;

/// C of Eq. (56) to first order of γ_S/ω0: π Q γ_S/(2 ω0).
pub fn spin_share(inertia_number: f64, shear_rate: f64, omega: f64) -> f64 {
    0.5 * PI * inertia_number * shear_rate / omega
}

/// C that is exact for a linear force: (1 - exp(-2 C))/2 (errata K-E30, K-E31).
pub fn effective_share(spin_share: f64) -> f64 {
    0.5 * (1.0 - (-2.0 * spin_share).exp())
}

/// Share of the common spin Ω_i + Ω_j that is left after a time \[s\], exp(-Q γ_S t): Eqs. (E12) and (E13), erratum K-E30.
pub fn spin_left(inertia_number: f64, shear_rate: f64, time: f64) -> f64 {
    (-inertia_number * shear_rate * time).exp()
}

/// Compression below which the force is cut off, over the largest one: Eq. (E6), erratum K-E14. From 1 on, it always is:
/// Eq. (E5).
pub fn cut_compression(shear_rate: f64, friction: f64, omega: f64, sum: f64, difference: f64) -> f64 {
    shear_rate * sum / (friction * omega * difference)
}

/// Time until which the force is cut off, over that of the largest compression: Eq. (E7), erratum K-E15.
pub fn cut_time(shear_rate: f64, friction: f64, omega: f64, sum: f64, difference: f64) -> f64 {
    2.0 / PI * cut_compression(shear_rate, friction, omega, sum, difference)
}

/// Damping γ_N from which on a sphere that hits a slower one slips from the beginning \[1/s\]: Eq. (C9), erratum K-E10.
pub fn immediate_slip_rate(spheres: &Spheres, shear_rate: f64, sum: f64, difference: f64) -> f64 {
    let (q, s) = (spheres.inertia_number, spheres.static_friction);
    shear_rate * sum / difference * (q - (1.0 + q) * s)
}

/// Sum of velocities |v_i + v_j| above which the faster sphere leaves the surface, v^d \[m/s\]: Eq. (F1).
pub fn jump_speed(spheres: &Spheres, shear_rate: f64) -> f64 {
    2.0 * spheres.gravity / shear_rate
}

/// Vertical velocity after the collision \[m/s\] of the sphere that hits a slower one (erratum K-E28), with the decay of the
/// common spin: Eq. (F2), erratum K-E31.
pub fn jump_velocity(spheres: &Spheres, shear_rate: f64, sum: f64, duration: f64) -> f64 {
    let decay = spheres.inertia_number * shear_rate;
    let pushed = 0.5 * shear_rate * sum * (1.0 - (-decay * duration).exp()) / decay;
    pushed - spheres.gravity * duration
}

/// How high it jumps \[m\].
pub fn jump_height(spheres: &Spheres, velocity: f64) -> f64 {
    0.5 * velocity * velocity / spheres.gravity
}

/// How long it is in the air \[s\]: 2 v/g, erratum K-E29.
pub fn jump_time(spheres: &Spheres, velocity: f64) -> f64 {
    2.0 * velocity / spheres.gravity
}
