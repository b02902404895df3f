//! During a collision of two spheres with opposite velocities (Kondic 1999, Sec. IV A, Appendices A, C, D and E 1).
//!
//! `speed` is their relative speed v \[m/s\], `omega` the frequency ω0 = sqrt(2 k/m) \[1/s\], `rate` the damping γ_N \[1/s\].

use std::f64::consts::PI;

use super::Spheres;

/// Largest compression x = overlap/(2R) without damping: Eq. (32).
pub fn largest_compression(spheres: &Spheres, speed: f64, omega: f64) -> f64 {
    speed / (2.0 * spheres.radius * omega)
}

/// Largest compression with damping, exact: Eqs. (A2) and (A4).
pub fn largest_compression_damped(spheres: &Spheres, speed: f64, omega: f64, rate: f64) -> f64 {
    let damped = (omega * omega - 0.25 * rate * rate).sqrt();
    largest_compression(spheres, speed, omega) * (-0.5 * rate / damped * (damped / omega).asin()).exp()
}

/// Largest compression to first order of ε = γ_N/ω0, with 1 - π ε/4: Eq. (39), erratum K-E19.
pub fn largest_compression_first_order(spheres: &Spheres, speed: f64, omega: f64, rate: f64) -> f64 {
    largest_compression(spheres, speed, omega) * (1.0 - 0.25 * PI * rate / omega)
}

/// ε = γ_N/ω0 of a restitution, to first order: Sec. IV A 2 with erratum K-E20.
pub fn damping_of_restitution(restitution: f64) -> f64 {
    -2.0 / PI * restitution.ln()
}

/// Compression at which slip begins without damping: Eqs. (33) and (C4), erratum K-E3.
pub fn slip_compression(spheres: &Spheres, omega: f64) -> f64 {
    spheres.slip_acceleration() / (spheres.radius * omega * omega)
}

/// Time at which slip begins without damping \[s\]: Eqs. (34) and (C2), erratum K-E4; `None` if it never does.
pub fn slip_time(spheres: &Spheres, speed: f64, omega: f64) -> Option<f64> {
    let sine = slip_speed(spheres, omega) / speed;
    (sine <= 1.0).then(|| sine.asin() / omega)
}

/// The same with damping, to first order and not before the collision: Eq. (C6), erratum K-E8.
pub fn slip_time_damped(spheres: &Spheres, speed: f64, omega: f64, rate: f64) -> f64 {
    (slip_speed(spheres, omega) / (speed * omega) - rate / (omega * omega)).max(0.0)
}

/// Relative speed v^b above which spheres slip in an elastic collision \[m/s\]: Eq. (35), erratum K-E5.
pub fn slip_speed(spheres: &Spheres, omega: f64) -> f64 {
    2.0 * spheres.slip_acceleration() / omega
}

/// Relative speed v^c above which damping makes spheres slip from the beginning \[m/s\]: erratum K-E9.
pub fn immediate_slip_speed(spheres: &Spheres, rate: f64) -> f64 {
    2.0 * spheres.slip_acceleration() / rate
}

/// Speed v^a far above which the surface does not change the collision \[m/s\]: Appendix D.
pub fn unaffected_speed(spheres: &Spheres, omega: f64) -> f64 {
    spheres.kinetic_friction * spheres.gravity / omega
}

/// What friction does to the spin during an elastic collision, R (Ω_f - Ω_0) \[m/s\]: Eqs. (36) and (E4), errata K-E6.
pub fn spin_gain(spheres: &Spheres, speed: f64, omega: f64) -> f64 {
    let Spheres { inertia_number: q, gravity: g, static_friction: s, kinetic_friction: k, .. } = *spheres;
    let first = 2.0 * (1.0 + q) * s * g / (speed * omega) * (0.5 * s - k);
    q * g / omega * (PI * k + first)
}

/// Part of it from before slip begins \[m/s\]: Eq. (E2), errata K-E6 and K-E32.
pub fn spin_gain_before_slip(spheres: &Spheres, speed: f64, omega: f64) -> f64 {
    let pressed = spheres.static_friction * spheres.gravity;
    spheres.inertia_number * (1.0 + spheres.inertia_number) * pressed * pressed / (speed * omega * omega)
}

/// Slip after an elastic collision \[m/s\]: Eq. (37), erratum K-E7.
pub fn slip_after_elastic(spheres: &Spheres, speed: f64, omega: f64) -> f64 {
    speed - spin_gain(spheres, speed, omega)
}

/// Slip after a damped collision \[m/s\]: Eqs. (40) and (41).
pub fn slip_after(spheres: &Spheres, speed: f64, restitution: f64, duration: f64) -> f64 {
    0.5 * (1.0 + restitution) * speed
        - spheres.inertia_number * spheres.kinetic_friction * spheres.gravity * duration
}

/// Energy of the friction with the surface over that of the collision: Eq. (38) with its coefficient 4 μ_s/π (erratum
/// K-E41).
pub fn energy_ratio(spheres: &Spheres, speed: f64, duration: f64) -> f64 {
    4.0 * spheres.static_friction / PI * spheres.gravity * duration / speed
}

/// Relative growth of the duration by friction with the surface: Eq. (D3), erratum K-E12.
pub fn longer(spheres: &Spheres, speed: f64, omega: f64) -> f64 {
    4.0 * spheres.kinetic_friction * spheres.gravity / (PI * speed * omega)
}

/// Relative growth of the largest compression by friction with the surface: Eq. (D4), erratum K-E13.
pub fn deeper(spheres: &Spheres, speed: f64, omega: f64) -> f64 {
    2.0 * spheres.kinetic_friction * spheres.gravity / (speed * omega)
}

/// Compression at which friction and spring balance, x_f: Eqs. (D1) and (D2), erratum K-E11.
pub fn balance_compression(spheres: &Spheres, omega: f64) -> f64 {
    spheres.kinetic_friction * spheres.gravity / (spheres.radius * omega * omega)
}
