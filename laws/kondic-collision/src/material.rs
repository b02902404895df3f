//! From elastic constants to the duration of a collision (Kondic 1999, Appendix B).

use std::f64::consts::PI;

/// ∫₀¹ dx/sqrt(1 - x^(5/2)), times 2: J(1/2) of the Hertz model, √π Γ(2/5)/(5/4 · Γ(9/10)) (Kondic 1999, I(0.5) = 2.94).
pub const HERTZ_INTEGRAL: f64 = 2.943_275_184_324_704_3;

/// Duration of an elastic Hertz collision \[s\] of two bodies of the same material with reduced mass m12 \[kg\], reduced
/// radius R* \[m\], Young modulus Y \[Pa\], Poisson ratio σ and relative speed v \[m/s\]:
/// I(1/2) (5/4)^(2/5) (m12/E')^(2/5) v^(-1/5) with E' = (4/3) E* sqrt(R*), E* = Y/(2 (1 - σ²)).
///
/// This is Kondic 1999, Eq. (B2) with the exponents 1/(2+β) and -β/(2+β) (errata K-E33, K-E34).
pub fn collision_time(mass: f64, radius: f64, young: f64, poisson: f64, speed: f64) -> f64 {
    let modulus = young / (2.0 * (1.0 - poisson * poisson));
    let stiffness = 4.0 / 3.0 * modulus * radius.sqrt();
    HERTZ_INTEGRAL * 1.25f64.powf(0.4) * (mass / stiffness).powf(0.4) * speed.powf(-0.2)
}

/// The duration that Kondic 1999 works with: 2^(2/5) times too long, as Eq. (B1) lacks a factor 2 (erratum K-E33).
pub fn printed_collision_time(mass: f64, radius: f64, young: f64, poisson: f64, speed: f64) -> f64 {
    2.0f64.powf(0.4) * collision_time(mass, radius, young, poisson, speed)
}

/// Angular frequency ω0 and damping rate γ_N of the linear model with this duration and restitution under the end of a
/// contact with its overlap: exact at any damping (Kondic 1999, Eqs. (A3) and (A6)).
pub(crate) fn linear_model(collision_time: f64, restitution: f64) -> (f64, f64) {
    let rate = -2.0 * restitution.ln() / collision_time;
    let omega = PI / collision_time;
    ((omega * omega + 0.25 * rate * rate).sqrt(), rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steel spheres of radius 2 mm: mass, R*, Y, σ as in Kondic 1999, Appendix B.
    fn steel(speed: f64, time: fn(f64, f64, f64, f64, f64) -> f64) -> f64 {
        let (radius, density) = (2e-3, 7850.0);
        let mass = 4.0 / 3.0 * PI * density * radius * radius * radius;
        time(0.5 * mass, 0.5 * radius, 2.06e11, 0.28, speed)
    }

    #[test]
    fn steel_spheres_touch_for_the_time_of_hertz_and_not_for_the_printed_one() {
        for (speed, hertz, printed) in [
            (0.01, 3.061320e-5, 4.039436e-5),
            (0.1, 1.931563e-5, 2.548712e-5),
            (1.0, 1.218734e-5, 1.608129e-5),
        ] {
            // Seven digits, of which the last is rounded.
            assert!((steel(speed, collision_time) / hertz - 1.0).abs() < 5e-7);
            assert!((steel(speed, printed_collision_time) / printed - 1.0).abs() < 5e-7);
            assert!(steel(speed, collision_time) < 0.8 * printed);
        }
        // An integration of the Hertz impact: m12 δ'' = -(4/3) E* sqrt(R*) δ^(3/2).
        let (radius, density, speed) = (2e-3_f64, 7850.0, 0.1);
        let mass = 2.0 / 3.0 * PI * density * radius * radius * radius;
        let stiffness = 4.0 / 3.0 * 2.06e11 / (2.0 * (1.0 - 0.28 * 0.28)) * (0.5 * radius).sqrt();
        let (mut x, mut v, mut t, dt) = (0.0_f64, speed, 0.0, 1e-10);
        while x >= 0.0 {
            v -= dt * stiffness / mass * x.powf(1.5);
            x += dt * v;
            t += dt;
        }
        // First order in a step of 5e-6 of the collision.
        assert!((steel(speed, collision_time) / t - 1.0).abs() < 1e-5, "{t}");
    }

    #[test]
    fn the_linear_model_has_the_duration_and_restitution_asked_for() {
        for restitution in [1.0, 0.9, 0.3] {
            let (omega, rate) = linear_model(2e-5, restitution);
            let damped = (omega * omega - 0.25 * rate * rate).sqrt();
            assert!((PI / damped / 2e-5 - 1.0).abs() < 1e-14);
            assert!(((-0.5 * rate * 2e-5).exp() / restitution - 1.0).abs() < 1e-14);
        }
    }
}
