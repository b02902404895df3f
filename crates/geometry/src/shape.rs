//! What a body is made like: how its mass is distributed and how much space it fills.

use std::f64::consts::PI;

use crate::GeometryError;

/// An inertia factor q = I/(m R^2) in (0, 1].
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct InertiaFactor(f64);

impl InertiaFactor {
    /// Accepts a factor in (0, 1]: 0 is a point mass, 1 a hoop with all mass at the radius.
    ///
    /// # Errors
    /// [`GeometryError::InertiaFactor`] for anything else, NaN included.
    pub fn new(value: f64) -> Result<Self, GeometryError> {
        if value > 0.0 && value <= 1.0 {
            Ok(Self(value))
        } else {
            Err(GeometryError::InertiaFactor { value })
        }
    }

    /// The factor.
    pub const fn get(self) -> f64 {
        self.0
    }
}

/// The shape of a round body.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Shape {
    /// A homogeneous sphere, q = 2/5.
    #[default]
    Sphere,
    /// A homogeneous disc or cylinder that turns about its own axis, q = 1/2.
    Disc,
    /// A thin spherical shell, q = 2/3.
    HollowSphere,
    /// A round body with a given inertia factor and the volume of a sphere.
    Custom(InertiaFactor),
}

impl Shape {
    /// A body with the inertia factor `q`, in (0, 1].
    ///
    /// # Errors
    /// [`GeometryError::InertiaFactor`] when `q` is outside (0, 1].
    pub fn custom(q: f64) -> Result<Self, GeometryError> {
        InertiaFactor::new(q).map(Self::Custom)
    }

    /// The inertia factor q = I/(m R^2) of Luding 1998; the inertia number of Kondic 1999 is 1/q.
    pub const fn inertia_factor(self) -> f64 {
        match self {
            Self::Sphere => 2.0 / 5.0,
            Self::Disc => 1.0 / 2.0,
            Self::HollowSphere => 2.0 / 3.0,
            Self::Custom(q) => q.get(),
        }
    }

    /// Volume (m^3) at the radius (m) from which a density makes a mass.
    ///
    /// A disc is 1 m thick. A hollow sphere counts with the space that it encloses, so its density is the mean
    /// density of shell and void. The products are taken from left to right as LAMMPS and LIGGGHTS take them, so
    /// that masses agree to the last bit.
    pub fn volume(self, radius: f64) -> f64 {
        match self {
            Self::Disc => PI * radius * radius,
            Self::Sphere | Self::HollowSphere | Self::Custom(_) => 4.0 * PI / 3.0 * radius * radius * radius,
        }
    }

    /// Mass (kg) at the density (kg/m^3) and radius (m).
    pub fn mass(self, density: f64, radius: f64) -> f64 {
        self.volume(radius) * density
    }

    /// Moment of inertia q m R^2 (kg m^2).
    pub fn moment_of_inertia(self, mass: f64, radius: f64) -> f64 {
        self.inertia_factor() * mass * radius * radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inertia_factors_follow_from_the_mass_distribution() {
        // I/(m R^2) by midpoint quadrature over the unit sphere (all mass of a slice at height z) and the unit disc.
        let n = 2000;
        let h = 1.0 / f64::from(n);
        let (mut solid, mut mass, mut shell, mut disc, mut disc_mass) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for k in 0..n {
            let z = (f64::from(k) + 0.5) * h;
            let r2 = 1.0 - z * z;
            solid += 0.5 * r2 * r2 * h;
            mass += r2 * h;
            // Archimedes: a shell has equal area in equal height.
            shell += r2 * h;
            disc += z * z * z * h;
            disc_mass += z * h;
        }
        // Midpoint error h^2/24 times the second derivative integrated, below h^2.
        assert!((Shape::Sphere.inertia_factor() - solid / mass).abs() < h * h);
        assert!((Shape::HollowSphere.inertia_factor() - shell).abs() < h * h);
        assert!((Shape::Disc.inertia_factor() - disc / disc_mass).abs() < h * h);
    }

    #[test]
    fn custom_factor_is_checked() {
        assert_eq!(Shape::custom(0.3).unwrap().inertia_factor(), 0.3);
        assert_eq!(Shape::custom(1.0).unwrap().inertia_factor(), 1.0);
        for bad in [0.0, -0.1, 1.0001, f64::NAN, f64::INFINITY] {
            assert!(Shape::custom(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn mass_and_moment() {
        // Exact by construction: the same products in the same order.
        assert_eq!(Shape::Sphere.mass(2500.0, 1e-3), 4.0 * PI / 3.0 * 1e-3 * 1e-3 * 1e-3 * 2500.0);
        assert_eq!(Shape::Disc.mass(2.0, 0.5), PI * 0.5 * 0.5 * 2.0);
        assert_eq!(Shape::Disc.moment_of_inertia(3.0, 2.0), 6.0);
    }
}
