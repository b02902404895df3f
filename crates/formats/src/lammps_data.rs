//! Data files of LAMMPS and LIGGGHTS with `atom_style sphere` (`granular` in LIGGGHTS).
//!
//! ```text
//! two spheres
//!
//! 2 atoms
//! 1 atom types
//!
//! -0.01 0.01 xlo xhi
//! -0.01 0.01 ylo yhi
//! -0.01 0.01 zlo zhi
//!
//! Atoms                                # id type diameter density x y z [image flags]
//!
//! 1 1 0.001 2500 0 0 0
//! 2 1 0.0012 2500 0.00106 0.0003 0.0002
//!
//! Velocities                           # id vx vy vz omegax omegay omegaz
//!
//! 1 0.15 0.02 -0.01 10 -20 30
//! 2 -0.12 0.01 0.03 -5 15 40
//! ```
//! The first line is a title. Diameter and density are what both engines read; they compute the mass as
//! `4 π / 3 R³ ρ`, and so does [`Atom::mass`], with the same rounding.

mod pieces;
mod read;
mod write;

pub use read::{parse, read};
pub use write::write;

use crate::provenance::Provenance;
use std::f64::consts::PI;

/// What a data file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct DataFile {
    /// The first line. When written with a provenance, that follows the title.
    pub title: String,
    /// Provenance found in the title.
    pub provenance: Option<Provenance>,
    /// Number of materials (`atom types`).
    pub materials: u16,
    /// Lower corner of the box \[m\].
    pub lo: [f64; 3],
    /// Upper corner of the box \[m\].
    pub hi: [f64; 3],
    /// The particles, in the order of the file.
    pub atoms: Vec<Atom>,
}

/// A particle of a data file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Atom {
    /// Identity, from 1 to 2³¹ - 1.
    pub id: u32,
    /// Index of the material, from 0: the type in the file less 1.
    pub material: u16,
    /// Diameter \[m\], above 0.
    pub diameter: f64,
    /// Density \[kg/m³\], above 0.
    pub density: f64,
    /// Position of the centre \[m\].
    pub position: [f64; 3],
    /// How often the particle has crossed the periodic box in each direction.
    pub image: [i32; 3],
    /// Velocity of the centre \[m/s\]; 0 when the file gives none.
    pub velocity: [f64; 3],
    /// Angular velocity \[rad/s\]; 0 when the file gives none.
    pub angular_velocity: [f64; 3],
}

impl Atom {
    /// Radius \[m\].
    pub fn radius(&self) -> f64 {
        0.5 * self.diameter
    }

    /// Mass \[kg\] of the sphere, computed in the order in which LAMMPS and LIGGGHTS do.
    pub fn mass(&self) -> f64 {
        let radius = self.radius();
        4.0 * PI / 3.0 * radius * radius * radius * self.density
    }

    /// Density \[kg/m³\] that a sphere of this mass and radius has.
    pub fn density_of(mass: f64, radius: f64) -> f64 {
        mass / (4.0 * PI / 3.0 * radius * radius * radius)
    }
}

/// Largest identity: both engines count in 32-bit signed integers.
const LARGEST_ID: i64 = i32::MAX as i64;
/// Largest number of materials.
const MOST_MATERIALS: i64 = u16::MAX as i64;
/// Names of the lines of the box.
const BOUNDS: [[&str; 2]; 3] = [["xlo", "xhi"], ["ylo", "yhi"], ["zlo", "zhi"]];
