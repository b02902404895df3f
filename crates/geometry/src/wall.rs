//! Walls: surfaces with a prescribed motion.

use nalgebra::Vector3;

use crate::{Cell, GeometryError, Motion, Plane, Surface, SurfaceContact};

/// A surface and how it moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    surface: Surface,
    motion: Motion,
    /// The motion turns the surface in its own place, so its geometry never changes.
    turns_in_place: bool,
}

impl Wall {
    /// A wall whose surface is described at rest, before its motion displaces it.
    pub fn new(surface: impl Into<Surface>, motion: Motion) -> Self {
        let surface = surface.into();
        let turns_in_place = motion
            .rotation_at(0.0)
            .is_some_and(|(centre, axis, _)| surface.is_invariant_under_rotation(centre, axis));
        Self { surface, motion, turns_in_place }
    }

    /// The surface as it was described, at rest.
    pub const fn surface(&self) -> &Surface {
        &self.surface
    }

    /// The motion.
    pub const fn motion(&self) -> &Motion {
        &self.motion
    }

    /// True when the surface stays where it is: a fixed wall, or a drum that turns about its own axis.
    pub fn keeps_its_place(&self) -> bool {
        self.turns_in_place || self.motion.is_fixed()
    }

    /// The surface at time `t` (s).
    pub fn surface_at(&self, t: f64) -> Surface {
        if self.keeps_its_place() {
            return self.surface;
        }
        match self.motion.rotation_at(t) {
            Some((centre, _, _)) => self.surface.rotated(&self.motion.orientation(t), centre),
            None => self.surface.displaced(self.motion.displacement(t)),
        }
    }

    /// Where `position` (m) lies relative to the wall at time `t` (s). For many bodies at one time, call
    /// [`Self::surface_at`] once.
    pub fn contact(&self, position: Vector3<f64>, t: f64) -> SurfaceContact {
        self.surface_at(t).contact(position)
    }

    /// Velocity of the wall's material at the place `position` (m) at time `t` (s), m/s.
    pub fn velocity_at(&self, position: Vector3<f64>, t: f64) -> Vector3<f64> {
        self.motion.velocity_at(position, t)
    }
}

/// The faces of a box as planes whose allowed side is the inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxWalls {
    lo: [f64; 3],
    hi: [f64; 3],
    faces: [[bool; 2]; 3],
}

impl BoxWalls {
    /// A box from `lo` to `hi` (m); `faces[axis]` says whether there is a wall at its lower and its upper bound.
    ///
    /// # Errors
    /// [`GeometryError::NotFinite`] where a face has no finite place, [`GeometryError::EmptyExtent`] where a direction
    /// with two faces has no room between them.
    pub fn new(lo: [f64; 3], hi: [f64; 3], faces: [[bool; 2]; 3]) -> Result<Self, GeometryError> {
        for axis in 0..3 {
            let [below, above] = faces[axis];
            if (below && !lo[axis].is_finite()) || (above && !hi[axis].is_finite()) {
                return Err(GeometryError::NotFinite { what: "place of a box wall" });
            }
            if below && above && lo[axis] >= hi[axis] {
                return Err(GeometryError::EmptyExtent { axis, lo: lo[axis], hi: hi[axis] });
            }
        }
        Ok(Self { lo, hi, faces })
    }

    /// Walls at each finite bound of the directions of `cell` that are not periodic.
    ///
    /// # Errors
    /// [`GeometryError::EmptyExtent`] for a direction without extent.
    pub fn around(cell: &Cell) -> Result<Self, GeometryError> {
        let (lo, hi, periodic) = (cell.lo(), cell.hi(), cell.periodic());
        let faces = std::array::from_fn(|axis| {
            [!periodic[axis] && lo[axis].is_finite(), !periodic[axis] && hi[axis].is_finite()]
        });
        Self::new(lo, hi, faces)
    }

    /// The planes that exist, in the order x low, x high, y low, y high, z low, z high.
    pub fn planes(&self) -> Vec<Plane> {
        let mut planes = Vec::with_capacity(6);
        for axis in 0..3 {
            for (present, place, direction) in
                [(self.faces[axis][0], self.lo[axis], 1.0), (self.faces[axis][1], self.hi[axis], -1.0)]
            {
                let (mut point, mut normal) = (Vector3::zeros(), Vector3::zeros());
                point[axis] = place;
                normal[axis] = direction;
                // The constructor checked the places, and the normals are unit vectors.
                planes.extend(present.then(|| Plane::new(point, normal).ok()).flatten());
            }
        }
        planes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cylinder;

    #[test]
    fn six_planes_point_inwards() {
        let cell = Cell::new([0.0, -1.0, 2.0], [1.0, 1.0, 5.0], [false; 3]).unwrap();
        let planes = BoxWalls::around(&cell).unwrap().planes();
        assert_eq!(planes.len(), 6);
        let inside = Vector3::new(0.25, 0.5, 4.0);
        let distances: Vec<f64> = planes.iter().map(|p| p.contact(inside).distance).collect();
        assert_eq!(distances, [0.25, 0.75, 1.5, 0.5, 2.0, 1.0]);
    }

    #[test]
    fn only_the_faces_asked_for() {
        let cell = Cell::new([0.0; 3], [1.0, 1.0, f64::INFINITY], [true, false, false]).unwrap();
        let planes = BoxWalls::around(&cell).unwrap().planes();
        let normals: Vec<_> = planes.iter().map(Plane::normal).collect();
        assert_eq!(normals, [Vector3::y(), -Vector3::y(), Vector3::z()]);
        assert!(BoxWalls::new([0.0; 3], [0.0, 1.0, 1.0], [[true; 2]; 3]).is_err());
        assert!(BoxWalls::new([f64::NEG_INFINITY; 3], [1.0; 3], [[true; 2]; 3]).is_err());
    }

    #[test]
    fn shaken_floor_carries_its_surface() {
        let floor = Plane::new(Vector3::zeros(), Vector3::z()).unwrap();
        let motion = Motion::sinusoidal(Vector3::z() * 0.1, 2.0, 0.0).unwrap();
        let wall = Wall::new(floor, motion);
        let t = 0.3;
        let contact = wall.contact(Vector3::new(0.0, 0.0, 1.0), t);
        // One subtraction apart from the closed form.
        assert!((contact.distance - (1.0 - 0.1 * (0.6f64).sin())).abs() < 2.0 * f64::EPSILON);
        assert!(!wall.keeps_its_place());
    }

    #[test]
    fn a_turning_drum_keeps_its_place_and_its_skin_moves() {
        let drum = Cylinder::new(Vector3::zeros(), Vector3::y(), 2.0, true).unwrap();
        let wall = Wall::new(drum, Motion::rotation(Vector3::zeros(), Vector3::y(), 3.0).unwrap());
        assert!(wall.keeps_its_place());
        assert_eq!(wall.surface_at(17.3), *wall.surface());
        assert_eq!(wall.velocity_at(Vector3::new(0.0, 1.0, 2.0), 17.3), Vector3::new(6.0, 0.0, 0.0));
    }

    #[test]
    fn a_turning_blade_sweeps() {
        let blade = Plane::new(Vector3::zeros(), Vector3::x()).unwrap();
        let wall = Wall::new(blade, Motion::rotation(Vector3::zeros(), Vector3::z(), 1.0).unwrap());
        let quarter = std::f64::consts::FRAC_PI_2;
        let Surface::Plane(turned) = wall.surface_at(quarter) else { unreachable!("a plane stays a plane") };
        // Sine and cosine of the rounded quarter turn.
        assert!((turned.normal() - Vector3::y()).norm() < 2.0 * f64::EPSILON);
    }
}
