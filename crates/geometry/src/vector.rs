//! Checks on vectors that a user wrote.

use nalgebra::Vector3;

use crate::GeometryError;

pub(crate) fn finite(value: f64, what: &'static str) -> Result<f64, GeometryError> {
    if value.is_finite() { Ok(value) } else { Err(GeometryError::NotFinite { what }) }
}

pub(crate) fn finite_vector(v: Vector3<f64>, what: &'static str) -> Result<Vector3<f64>, GeometryError> {
    if v.iter().all(|c| c.is_finite()) { Ok(v) } else { Err(GeometryError::NotFinite { what }) }
}

/// The unit vector along `v`; a vector that is already a unit vector keeps its bits.
pub(crate) fn unit(v: Vector3<f64>, what: &'static str) -> Result<Vector3<f64>, GeometryError> {
    let v = finite_vector(v, what)?;
    if v.norm_squared() == 1.0 {
        return Ok(v);
    }
    // Scaled first, so that neither 1e-200 nor 1e200 leaves the range of a double when squared.
    let largest = v.amax();
    if largest == 0.0 {
        return Err(GeometryError::ZeroVector { what });
    }
    let scaled = v / largest;
    Ok(scaled / scaled.norm())
}

/// A unit vector perpendicular to the unit vector `axis`, always the same one.
pub(crate) fn perpendicular(axis: Vector3<f64>) -> Vector3<f64> {
    let least = axis.iamin();
    let mut other = Vector3::zeros();
    other[least] = 1.0;
    let across = axis.cross(&other);
    across / across.norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_vectors_from_any_size() {
        // Three roundings of relative size epsilon/2 each.
        let tolerance = 2.0 * f64::EPSILON;
        for scale in [1e-300, 1.0, 7.0, 1e300] {
            let u = unit(Vector3::new(3.0, 4.0, 0.0) * scale, "axis").unwrap();
            assert!((u - Vector3::new(0.6, 0.8, 0.0)).norm() <= tolerance, "{scale}: {u}");
        }
        assert_eq!(unit(Vector3::zeros(), "axis"), Err(GeometryError::ZeroVector { what: "axis" }));
        assert_eq!(
            unit(Vector3::new(f64::NAN, 1.0, 0.0), "axis"),
            Err(GeometryError::NotFinite { what: "axis" })
        );
        assert_eq!(unit(Vector3::z(), "axis"), Ok(Vector3::z()));
    }

    #[test]
    fn perpendicular_is_perpendicular() {
        for axis in [Vector3::x(), Vector3::y(), Vector3::z(), Vector3::new(1.0, 1.0, 1.0).normalize()] {
            let p = perpendicular(axis);
            assert!(p.dot(&axis).abs() <= f64::EPSILON);
            assert!((p.norm() - 1.0).abs() <= 2.0 * f64::EPSILON);
        }
    }
}
