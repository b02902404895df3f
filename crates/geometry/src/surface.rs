//! Surfaces that bodies touch.

use nalgebra::{Rotation3, Vector3};

use crate::GeometryError;
use crate::vector::{finite, finite_vector, perpendicular, unit};

/// Where a point lies relative to a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceContact {
    /// Signed distance of the point to the surface, m; positive on the allowed side.
    pub distance: f64,
    /// Unit normal at the nearest surface point, from the wall into the allowed side.
    pub normal: Vector3<f64>,
    /// Radius of curvature of the surface, m: infinite for a plane, positive where the wall bulges towards the body,
    /// negative where it is hollow (inside of a cylinder).
    pub curvature_radius: f64,
}

/// An infinite plane; the allowed side is the one its normal points to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    point: Vector3<f64>,
    normal: Vector3<f64>,
}

impl Plane {
    /// A plane through `point` (m); `normal` may have any length and points to the allowed side.
    ///
    /// # Errors
    /// [`GeometryError::NotFinite`], [`GeometryError::ZeroVector`].
    pub fn new(point: Vector3<f64>, normal: Vector3<f64>) -> Result<Self, GeometryError> {
        Ok(Self { point: finite_vector(point, "plane point")?, normal: unit(normal, "plane normal")? })
    }

    /// A point of the plane, m.
    pub const fn point(&self) -> Vector3<f64> {
        self.point
    }

    /// The unit normal towards the allowed side.
    pub const fn normal(&self) -> Vector3<f64> {
        self.normal
    }

    /// Where `position` (m) lies relative to the plane.
    pub fn contact(&self, position: Vector3<f64>) -> SurfaceContact {
        SurfaceContact {
            distance: (position - self.point).dot(&self.normal),
            normal: self.normal,
            curvature_radius: f64::INFINITY,
        }
    }
}

/// An infinite circular cylinder; bodies live inside it (a drum) or outside it (a post).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    point: Vector3<f64>,
    axis: Vector3<f64>,
    radius: f64,
    inside: bool,
}

impl Cylinder {
    /// A cylinder around the line through `point` (m) along `axis` (of any length), of positive `radius` (m);
    /// `inside` says that the allowed side is the inside.
    ///
    /// # Errors
    /// [`GeometryError::NotFinite`], [`GeometryError::ZeroVector`], [`GeometryError::NotPositive`].
    pub fn new(
        point: Vector3<f64>,
        axis: Vector3<f64>,
        radius: f64,
        inside: bool,
    ) -> Result<Self, GeometryError> {
        let point = finite_vector(point, "point on the cylinder axis")?;
        let axis = unit(axis, "cylinder axis")?;
        let radius = finite(radius, "cylinder radius")?;
        if radius <= 0.0 {
            return Err(GeometryError::NotPositive { what: "cylinder radius", value: radius });
        }
        Ok(Self { point, axis, radius, inside })
    }

    /// A point of the axis, m.
    pub const fn point(&self) -> Vector3<f64> {
        self.point
    }

    /// Unit vector along the axis.
    pub const fn axis(&self) -> Vector3<f64> {
        self.axis
    }

    /// Radius, m.
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// True when the allowed side is the inside.
    pub const fn inside(&self) -> bool {
        self.inside
    }

    /// Where `position` (m) lies relative to the cylinder. On the axis, where each direction is as near, the normal is
    /// a fixed one across the axis.
    pub fn contact(&self, position: Vector3<f64>) -> SurfaceContact {
        let from_point = position - self.point;
        let across = from_point - self.axis * from_point.dot(&self.axis);
        let from_axis = across.norm();
        let outward = if from_axis > 0.0 { across / from_axis } else { perpendicular(self.axis) };
        if self.inside {
            SurfaceContact {
                distance: self.radius - from_axis,
                normal: -outward,
                curvature_radius: -self.radius,
            }
        } else {
            SurfaceContact {
                distance: from_axis - self.radius,
                normal: outward,
                curvature_radius: self.radius,
            }
        }
    }
}

/// A surface of any kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// An infinite plane.
    Plane(Plane),
    /// An infinite circular cylinder.
    Cylinder(Cylinder),
}

impl From<Plane> for Surface {
    fn from(plane: Plane) -> Self {
        Self::Plane(plane)
    }
}

impl From<Cylinder> for Surface {
    fn from(cylinder: Cylinder) -> Self {
        Self::Cylinder(cylinder)
    }
}

impl Surface {
    /// Where `position` (m) lies relative to the surface.
    pub fn contact(&self, position: Vector3<f64>) -> SurfaceContact {
        match self {
            Self::Plane(plane) => plane.contact(position),
            Self::Cylinder(cylinder) => cylinder.contact(position),
        }
    }

    /// The surface displaced by `displacement` (m).
    pub fn displaced(mut self, displacement: Vector3<f64>) -> Self {
        match &mut self {
            Self::Plane(plane) => plane.point += displacement,
            Self::Cylinder(cylinder) => cylinder.point += displacement,
        }
        self
    }

    /// The surface turned by `rotation` about `centre` (m).
    pub fn rotated(mut self, rotation: &Rotation3<f64>, centre: Vector3<f64>) -> Self {
        let (point, direction) = match &mut self {
            Self::Plane(plane) => (&mut plane.point, &mut plane.normal),
            Self::Cylinder(cylinder) => (&mut cylinder.point, &mut cylinder.axis),
        };
        *point = centre + rotation * (*point - centre);
        *direction = rotation * *direction;
        self
    }

    /// True when a rotation about the line through `centre` along the unit vector `axis` maps the surface onto
    /// itself: a plane about its normal, a cylinder about its own axis.
    pub fn is_invariant_under_rotation(&self, centre: Vector3<f64>, axis: Vector3<f64>) -> bool {
        // Directions that a user wrote with 12 or more digits count as parallel.
        let parallel = |a: Vector3<f64>| a.cross(&axis).norm() < 1e-12;
        match self {
            Self::Plane(plane) => parallel(plane.normal),
            Self::Cylinder(cylinder) => {
                let offset = centre - cylinder.point;
                let across = offset - axis * offset.dot(&axis);
                parallel(cylinder.axis) && across.norm() < 1e-12 * cylinder.radius
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn axis_parallel_plane_is_exact() {
        let floor = Plane::new(Vector3::new(5.0, 6.0, 0.1), Vector3::z()).unwrap();
        let contact = floor.contact(Vector3::new(1.0, 2.0, 0.3));
        assert_eq!(contact.distance, 0.3 - 0.1);
        assert_eq!(contact.normal, Vector3::z());
        assert_eq!(contact.curvature_radius, f64::INFINITY);
    }

    #[test]
    fn drum_and_post() {
        let at = Vector3::new(3.0, 7.0, 0.0);
        let drum = Cylinder::new(Vector3::zeros(), Vector3::new(0.0, 2.0, 0.0), 4.0, true).unwrap();
        let c = drum.contact(at);
        assert_eq!((c.distance, c.normal, c.curvature_radius), (1.0, -Vector3::x(), -4.0));
        let post = Cylinder::new(Vector3::zeros(), Vector3::y(), 2.0, false).unwrap();
        let c = post.contact(at);
        assert_eq!((c.distance, c.normal, c.curvature_radius), (1.0, Vector3::x(), 2.0));
        // On the axis the normal is still a unit vector across it.
        let c = drum.contact(Vector3::new(0.0, 3.0, 0.0));
        assert_eq!(c.distance, 4.0);
        assert_eq!(c.normal.dot(&Vector3::y()), 0.0);
        assert_eq!(c.normal.norm(), 1.0);
    }

    #[test]
    fn bad_surfaces_are_refused() {
        let (zero, nan) = (Vector3::zeros(), Vector3::new(f64::NAN, 0.0, 0.0));
        assert!(Plane::new(zero, zero).is_err());
        assert!(Plane::new(nan, Vector3::z()).is_err());
        assert!(Cylinder::new(zero, Vector3::z(), 0.0, true).is_err());
        assert!(Cylinder::new(zero, Vector3::z(), f64::INFINITY, true).is_err());
        assert!(Cylinder::new(zero, nan, 1.0, true).is_err());
    }

    #[test]
    fn symmetry_axes() {
        let plane: Surface = Plane::new(Vector3::zeros(), Vector3::z()).unwrap().into();
        assert!(plane.is_invariant_under_rotation(Vector3::new(4.0, 5.0, 6.0), -Vector3::z()));
        assert!(!plane.is_invariant_under_rotation(Vector3::zeros(), Vector3::x()));
        let drum: Surface = Cylinder::new(Vector3::zeros(), Vector3::y(), 1.0, true).unwrap().into();
        assert!(drum.is_invariant_under_rotation(Vector3::new(0.0, 8.0, 0.0), Vector3::y()));
        assert!(!drum.is_invariant_under_rotation(Vector3::new(0.1, 8.0, 0.0), Vector3::y()));
    }

    proptest! {
        #[test]
        fn distance_is_the_derivative_along_the_normal_and_moves_with_the_surface(
            p in prop::array::uniform3(-2.0f64..2.0), q in prop::array::uniform3(-1.0f64..1.0),
            n in prop::array::uniform3(0.1f64..1.0), inside: bool, angle in -3.0f64..3.0,
        ) {
            let (p, q, n) = (Vector3::from(p), Vector3::from(q), Vector3::from(n));
            let plane: Surface = Plane::new(q, n).unwrap().into();
            let cylinder: Surface = Cylinder::new(q, n, 0.5, inside).unwrap().into();
            for surface in [plane, cylinder] {
                let at = surface.contact(p);
                prop_assert!((at.normal.norm() - 1.0).abs() < 1e-14);
                let step = 0.01;
                let ahead = surface.contact(p + at.normal * step);
                // Straight lines along the normal stay along it; crossing the axis of a drum would turn it round.
                if ahead.normal.dot(&at.normal) > 0.0 {
                    // A dozen roundings of numbers up to 4.
                    prop_assert!((ahead.distance - at.distance - step).abs() < 1e-14);
                }
                let moved = surface.displaced(Vector3::new(0.3, -0.2, 0.1));
                let with = moved.contact(p + Vector3::new(0.3, -0.2, 0.1));
                prop_assert!((with.distance - at.distance).abs() < 1e-14);
                let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), angle);
                let turned = surface.rotated(&turn, q);
                let with = turned.contact(q + turn * (p - q));
                prop_assert!((with.distance - at.distance).abs() < 1e-14);
            }
        }
    }
}
