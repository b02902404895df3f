//! The particle snapshot that every particle format writes.

use crate::error::FormatError;
use std::path::Path;

/// The box that holds the particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Lower corner \[m\].
    pub lo: [f64; 3],
    /// Upper corner \[m\].
    pub hi: [f64; 3],
    /// Directions in which the box repeats.
    pub periodic: [bool; 3],
}

/// One more number for every particle.
#[derive(Clone, Copy, Debug)]
pub struct ScalarColumn<'a> {
    /// Name in the file: ASCII letters, digits and `_ [ ]`, not one of the names that the format itself uses.
    pub name: &'a str,
    /// One value a particle.
    pub values: &'a [f64],
}

/// All particles at one moment. Slices have one entry a particle, all in the same order.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Number of time steps done.
    pub step: u64,
    /// Simulated time \[s\].
    pub time: f64,
    /// The box.
    pub cell: Cell,
    /// Identity, at least 1.
    pub id: &'a [u32],
    /// Index of the material, from 0 to 65534. Files number types from 1, as LAMMPS does: type = material + 1.
    pub material: &'a [u16],
    /// Radius R \[m\].
    pub radius: &'a [f64],
    /// Mass m \[kg\].
    pub mass: &'a [f64],
    /// Position of the centre \[m\].
    pub position: &'a [[f64; 3]],
    /// Velocity of the centre \[m/s\].
    pub velocity: &'a [[f64; 3]],
    /// Angular velocity \[rad/s\], if the particles can rotate.
    pub angular_velocity: Option<&'a [[f64; 3]]>,
    /// Sum of the forces \[N\].
    pub force: Option<&'a [[f64; 3]]>,
    /// Sum of the torques about the centre \[N m\].
    pub torque: Option<&'a [[f64; 3]]>,
    /// Further columns.
    pub extra: &'a [ScalarColumn<'a>],
}

/// Names that the formats use themselves.
const TAKEN: [&str; 28] = [
    "id",
    "type",
    "radius",
    "mass",
    "x",
    "y",
    "z",
    "vx",
    "vy",
    "vz",
    "omegax",
    "omegay",
    "omegaz",
    "fx",
    "fy",
    "fz",
    "tqx",
    "tqy",
    "tqz",
    "element",
    "typelabel",
    "velocity",
    "angular_velocity",
    "force",
    "torque",
    "Points",
    "connectivity",
    "offsets",
];

/// Names of the columns of a vector, as LAMMPS has them.
pub(crate) const POSITION: [&str; 3] = ["x", "y", "z"];
pub(crate) const VELOCITY: [&str; 3] = ["vx", "vy", "vz"];
pub(crate) const ANGULAR_VELOCITY: [&str; 3] = ["omegax", "omegay", "omegaz"];
pub(crate) const FORCE: [&str; 3] = ["fx", "fy", "fz"];
pub(crate) const TORQUE: [&str; 3] = ["tqx", "tqy", "tqz"];

impl<'a> Frame<'a> {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// Whether there is no particle.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }

    /// The vectors that are present, with the names of their components.
    pub(crate) fn vectors(&self) -> impl Iterator<Item = ([&'static str; 3], &'a [[f64; 3]])> {
        [
            (POSITION, Some(self.position)),
            (VELOCITY, Some(self.velocity)),
            (ANGULAR_VELOCITY, self.angular_velocity),
            (FORCE, self.force),
            (TORQUE, self.torque),
        ]
        .into_iter()
        .filter_map(|(names, values)| Some((names, values?)))
    }

    /// Checks that all columns are of equal length, all names are usable and all values finite.
    ///
    /// # Errors
    /// The first problem; for a value that is not finite it names the body.
    pub(crate) fn check(&self, file: &Path) -> Result<(), FormatError> {
        self.check_shape(file)?;
        let cell = self.cell;
        if !(0..3).all(|k| cell.lo[k].is_finite() && cell.hi[k].is_finite() && cell.lo[k] <= cell.hi[k]) {
            let problem = format!("the box from {:?} to {:?} is not a finite box", cell.lo, cell.hi);
            return Err(FormatError::unwritable(file, problem));
        }
        if !self.time.is_finite() {
            return Err(FormatError::unwritable(file, format!("the time {} is not finite", self.time)));
        }
        if let Some(i) = self.id.iter().position(|id| *id == 0) {
            return Err(FormatError::unwritable(file, format!("particle {i} has the id 0; ids start at 1")));
        }
        if self.material.contains(&u16::MAX) {
            return Err(FormatError::unwritable(
                file,
                format!("material {} is above {}", u16::MAX, u16::MAX - 1),
            ));
        }
        for (quantity, values) in [("radius", self.radius), ("mass", self.mass)] {
            self.check_finite(quantity, values)?;
        }
        for (names, values) in self.vectors() {
            if !values.as_flattened().iter().all(|value| value.is_finite()) {
                self.check_vector(names, values)?;
            }
        }
        self.extra.iter().try_for_each(|column| self.check_finite(column.name, column.values))
    }

    fn check_shape(&self, file: &Path) -> Result<(), FormatError> {
        let scalars =
            [("type", self.material.len()), ("radius", self.radius.len()), ("mass", self.mass.len())];
        let vectors = self.vectors().map(|(names, values)| (names[0], values.len()));
        let extra = self.extra.iter().map(|column| (column.name, column.values.len()));
        for (name, length) in scalars.into_iter().chain(vectors).chain(extra) {
            if length != self.len() {
                let problem = format!("column {name} has {length} values for {} particles", self.len());
                return Err(FormatError::unwritable(file, problem));
            }
        }
        for (i, column) in self.extra.iter().enumerate() {
            let plain = |b: u8| b.is_ascii_alphanumeric() || b"_[]".contains(&b);
            if column.name.is_empty() || column.name.len() > 40 || !column.name.bytes().all(plain) {
                let problem = format!(
                    "column name `{}` must be 1 to 40 ASCII letters, digits or any of `_ [ ]`",
                    column.name
                );
                return Err(FormatError::unwritable(file, problem));
            }
            if TAKEN.contains(&column.name) || self.extra[..i].iter().any(|other| other.name == column.name) {
                return Err(FormatError::unwritable(
                    file,
                    format!("column name `{}` is used twice", column.name),
                ));
            }
        }
        Ok(())
    }

    fn check_finite(&self, quantity: &str, values: &[f64]) -> Result<(), FormatError> {
        match values.iter().position(|value| !value.is_finite()) {
            None => Ok(()),
            Some(i) => Err(FormatError::NonFinite {
                body: self.id[i],
                quantity: quantity.to_string(),
                value: values[i],
            }),
        }
    }

    fn check_vector(&self, names: [&str; 3], values: &[[f64; 3]]) -> Result<(), FormatError> {
        for (i, vector) in values.iter().enumerate() {
            if let Some(k) = vector.iter().position(|value| !value.is_finite()) {
                let quantity = names[k].to_string();
                return Err(FormatError::NonFinite { body: self.id[i], quantity, value: vector[k] });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Columns of a frame, to borrow from.
    #[derive(Clone)]
    pub(crate) struct Owned {
        pub id: Vec<u32>,
        pub material: Vec<u16>,
        pub scalars: [Vec<f64>; 2],
        pub vectors: [Vec<[f64; 3]>; 5],
        pub pressure: Vec<f64>,
    }

    impl Owned {
        /// Particles with values that need all 17 digits.
        pub fn new(count: usize) -> Owned {
            let value = |i: usize, k: usize| (i as f64 + 1.0).sqrt() * (k as f64 - 2.3) / 3.0;
            let vector =
                |k: usize| (0..count).map(|i| [value(i, k), value(i, k + 1), value(i, k + 2)]).collect();
            Owned {
                id: (1..=count as u32).rev().collect(),
                material: (0..count).map(|i| (i % 3) as u16).collect(),
                scalars: [5, 7].map(|k| (0..count).map(|i| value(i, k)).collect()),
                vectors: [0, 3, 6, 9, 12].map(vector),
                pressure: (0..count).map(|i| value(i, 20)).collect(),
            }
        }

        pub fn extra(&self) -> [ScalarColumn<'_>; 1] {
            [ScalarColumn { name: "pressure", values: &self.pressure }]
        }

        pub fn frame<'a>(&'a self, extra: &'a [ScalarColumn<'a>]) -> Frame<'a> {
            let [position, velocity, angular_velocity, force, torque] = &self.vectors;
            Frame {
                step: 1200,
                time: 0.1 + 0.2,
                cell: Cell { lo: [-0.1, 0.0, 1.0 / 3.0], hi: [0.7, 2.0, 4.0], periodic: [true, false, true] },
                id: &self.id,
                material: &self.material,
                radius: &self.scalars[0],
                mass: &self.scalars[1],
                position,
                velocity,
                angular_velocity: Some(angular_velocity),
                force: Some(force),
                torque: Some(torque),
                extra,
            }
        }
    }

    #[test]
    fn a_value_that_is_not_finite_is_refused_with_the_body() {
        for (column, quantity) in
            ["radius", "mass", "y", "vy", "omegay", "fy", "tqy", "pressure"].iter().enumerate()
        {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut owned = Owned::new(5);
                match column {
                    0 | 1 => owned.scalars[column][3] = value,
                    7 => owned.pressure[3] = value,
                    _ => owned.vectors[column - 2][3][1] = value,
                }
                let error = owned.frame(&owned.extra()).check(Path::new("f")).unwrap_err();
                let FormatError::NonFinite { body, quantity: named, .. } = error else { panic!("{error}") };
                assert_eq!((body, named.as_str()), (2, *quantity));
            }
        }
    }

    #[test]
    fn columns_must_fit_together() {
        let owned = Owned::new(3);
        let check = |frame: Frame<'_>| frame.check(Path::new("f")).unwrap_err().to_string();
        assert!(check(Frame { mass: &[1.0], ..owned.frame(&[]) }).contains("column mass has 1 values for 3"));
        assert!(check(Frame { force: Some(&[]), ..owned.frame(&[]) }).contains("column fx has 0 values"));
        assert!(check(Frame { id: &[1, 0, 2], ..owned.frame(&[]) }).contains("ids start at 1"));
        assert!(check(Frame { material: &[0, 1, u16::MAX], ..owned.frame(&[]) }).contains("material 65535"));
        assert!(check(Frame { time: f64::NAN, ..owned.frame(&[]) }).contains("time NaN"));
        let cell = Cell { lo: [1.0; 3], hi: [0.0; 3], periodic: [false; 3] };
        assert!(check(Frame { cell, ..owned.frame(&[]) }).contains("not a finite box"));
        for name in ["", "a b", "x", "velocity", "a\n", "\"", &"n".repeat(41)] {
            let extra = [ScalarColumn { name, values: &owned.pressure }];
            assert!(owned.frame(&extra).check(Path::new("f")).is_err(), "{name:?}");
        }
        let twice = [owned.extra()[0], owned.extra()[0]];
        assert!(check(owned.frame(&twice)).contains("used twice"));
    }
}
