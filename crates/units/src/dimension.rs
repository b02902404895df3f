//! Exponents of length, mass and time.

use std::fmt;

/// A physical dimension: integer exponents of length, mass and time.
///
/// Angles carry no dimension, so an angular velocity and a rate are the same dimension, and so are an energy and a
/// torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct Dimension {
    /// Exponent of the metre.
    pub length: i8,
    /// Exponent of the kilogram.
    pub mass: i8,
    /// Exponent of the second.
    pub time: i8,
}

impl Dimension {
    /// A pure number or an angle in radians.
    pub const DIMENSIONLESS: Self = Self::new(0, 0, 0);
    /// Length, m.
    pub const LENGTH: Self = Self::new(1, 0, 0);
    /// Area, m^2.
    pub const AREA: Self = Self::new(2, 0, 0);
    /// Volume, m^3.
    pub const VOLUME: Self = Self::new(3, 0, 0);
    /// Mass, kg.
    pub const MASS: Self = Self::new(0, 1, 0);
    /// Time, s.
    pub const TIME: Self = Self::new(0, 0, 1);
    /// Velocity, m/s.
    pub const VELOCITY: Self = Self::new(1, 0, -1);
    /// Acceleration, m/s^2.
    pub const ACCELERATION: Self = Self::new(1, 0, -2);
    /// Angular velocity, rad/s; the same dimension as [`Self::RATE`].
    pub const ANGULAR_VELOCITY: Self = Self::new(0, 0, -1);
    /// Angular acceleration, rad/s^2.
    pub const ANGULAR_ACCELERATION: Self = Self::new(0, 0, -2);
    /// Force, N.
    pub const FORCE: Self = Self::new(1, 1, -2);
    /// Stiffness of a linear spring, N/m.
    pub const STIFFNESS: Self = Self::new(0, 1, -2);
    /// Coefficient of a viscous damper (force per velocity), kg/s.
    pub const DAMPING: Self = Self::new(0, 1, -1);
    /// Rate or frequency, 1/s.
    pub const RATE: Self = Self::new(0, 0, -1);
    /// Pressure, stress or elastic modulus, Pa.
    pub const PRESSURE: Self = Self::new(-1, 1, -2);
    /// Mass density, kg/m^3.
    pub const DENSITY: Self = Self::new(-3, 1, 0);
    /// Energy, J; the same dimension as [`Self::TORQUE`].
    pub const ENERGY: Self = Self::new(2, 1, -2);
    /// Torque, N m; the same dimension as [`Self::ENERGY`].
    pub const TORQUE: Self = Self::new(2, 1, -2);
    /// Moment of inertia, kg m^2.
    pub const MOMENT_OF_INERTIA: Self = Self::new(2, 1, 0);
    /// Momentum, kg m/s.
    pub const MOMENTUM: Self = Self::new(1, 1, -1);
    /// Angular momentum, or a damper that acts on rotation (torque per angular velocity), kg m^2/s.
    pub const ANGULAR_MOMENTUM: Self = Self::new(2, 1, -1);
    /// Power, W.
    pub const POWER: Self = Self::new(2, 1, -3);
    /// Dynamic viscosity, Pa s.
    pub const VISCOSITY: Self = Self::new(-1, 1, -1);

    /// The dimension metre^`length` kilogram^`mass` second^`time`.
    pub const fn new(length: i8, mass: i8, time: i8) -> Self {
        Self { length, mass, time }
    }

    /// True for a pure number.
    pub const fn is_dimensionless(self) -> bool {
        self.length == 0 && self.mass == 0 && self.time == 0
    }

    /// Dimension of a product; `None` when an exponent leaves the range of `i8`.
    pub fn checked_mul(self, other: Self) -> Option<Self> {
        Some(Self {
            length: self.length.checked_add(other.length)?,
            mass: self.mass.checked_add(other.mass)?,
            time: self.time.checked_add(other.time)?,
        })
    }

    /// Dimension of an integer power; `None` when an exponent leaves the range of `i8`.
    pub fn checked_pow(self, power: i8) -> Option<Self> {
        Some(Self {
            length: self.length.checked_mul(power)?,
            mass: self.mass.checked_mul(power)?,
            time: self.time.checked_mul(power)?,
        })
    }

    /// What the dimension is called, where it has a common name: `"stiffness"`, `"energy or torque"`.
    pub fn name(self) -> Option<&'static str> {
        self.known().map(|(_, _, name)| name)
    }

    fn known(self) -> Option<(Self, &'static str, &'static str)> {
        KNOWN.iter().copied().find(|(dimension, _, _)| *dimension == self)
    }
}

/// Dimensions with an established unit text; every text is one that the parser reads back.
const KNOWN: &[(Dimension, &str, &str)] = &[
    (Dimension::DIMENSIONLESS, "1", "plain number"),
    (Dimension::LENGTH, "m", "length"),
    (Dimension::AREA, "m^2", "area"),
    (Dimension::VOLUME, "m^3", "volume"),
    (Dimension::MASS, "kg", "mass"),
    (Dimension::TIME, "s", "time"),
    (Dimension::VELOCITY, "m/s", "velocity"),
    (Dimension::ACCELERATION, "m/s^2", "acceleration"),
    (Dimension::RATE, "1/s", "rate or angular velocity"),
    (Dimension::ANGULAR_ACCELERATION, "1/s^2", "angular acceleration"),
    (Dimension::FORCE, "N", "force"),
    (Dimension::STIFFNESS, "N/m", "stiffness"),
    (Dimension::DAMPING, "kg/s", "damping"),
    (Dimension::PRESSURE, "Pa", "pressure"),
    (Dimension::DENSITY, "kg/m^3", "density"),
    (Dimension::ENERGY, "J", "energy or torque"),
    (Dimension::MOMENT_OF_INERTIA, "kg m^2", "moment of inertia"),
    (Dimension::MOMENTUM, "kg m/s", "momentum"),
    (Dimension::ANGULAR_MOMENTUM, "kg m^2/s", "angular momentum"),
    (Dimension::POWER, "W", "power"),
    (Dimension::VISCOSITY, "Pa s", "viscosity"),
];

impl fmt::Display for Dimension {
    /// SI unit text: `N/m`, `kg/s`, `1` for a pure number, else base units such as `kg m^-4 s^-2`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((_, text, _)) = self.known() {
            return f.write_str(text);
        }
        let mut separator = "";
        for (symbol, power) in [("kg", self.mass), ("m", self.length), ("s", self.time)] {
            match power {
                0 => continue,
                1 => write!(f, "{separator}{symbol}")?,
                _ => write!(f, "{separator}{symbol}^{power}")?,
            }
            separator = " ";
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn display_uses_the_established_unit_else_base_units() {
        assert_eq!(Dimension::STIFFNESS.to_string(), "N/m");
        assert_eq!(Dimension::DAMPING.to_string(), "kg/s");
        assert_eq!(Dimension::TORQUE.to_string(), "J");
        assert_eq!(Dimension::DIMENSIONLESS.to_string(), "1");
        assert_eq!(Dimension::new(-4, 1, -2).to_string(), "kg m^-4 s^-2");
        assert_eq!(Dimension::new(0, 2, 1).to_string(), "kg^2 s");
    }

    #[test]
    fn products_and_powers_of_dimensions() {
        let velocity = Dimension::LENGTH.checked_mul(Dimension::TIME.checked_pow(-1).unwrap()).unwrap();
        assert_eq!(velocity, Dimension::VELOCITY);
        assert_eq!(Dimension::STIFFNESS.checked_mul(Dimension::LENGTH), Some(Dimension::FORCE));
        assert_eq!(Dimension::AREA.checked_pow(100), None);
        assert_eq!(Dimension::new(127, 0, 0).checked_mul(Dimension::LENGTH), None);
    }

    #[test]
    fn known_dimensions_are_listed_once() {
        for (k, a) in KNOWN.iter().enumerate() {
            assert!(KNOWN[..k].iter().all(|b| a.0 != b.0 && a.1 != b.1), "{a:?} is listed twice");
        }
    }
}
