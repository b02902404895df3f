//! How bodies are read from and written to rows, for each layout.

use granule_state::Row;

/// A combination of dimension and rotation, resolved at compile time.
pub(crate) trait Space: Send + Sync {
    /// Components of vectors that exist.
    const COMPONENTS: usize;
    /// Spins and torques exist.
    const ROTATION: bool;
    /// Spins sit in the velocity rows.
    const PLANAR: bool;
}

/// Three dimensions with rotation.
pub(crate) struct SpaceRotating;
/// Three dimensions without rotation.
pub(crate) struct SpaceSmooth;
/// The plane with rotation.
pub(crate) struct PlaneRotating;
/// The plane without rotation.
pub(crate) struct PlaneSmooth;

macro_rules! space {
    ($name:ident, $components:expr, $rotation:expr, $planar:expr) => {
        impl Space for $name {
            const COMPONENTS: usize = $components;
            const ROTATION: bool = $rotation;
            const PLANAR: bool = $planar;
        }
    };
}
space!(SpaceRotating, 3, true, false);
space!(SpaceSmooth, 3, false, false);
space!(PlaneRotating, 2, true, true);
space!(PlaneSmooth, 2, false, true);

/// Adds `sign` times a force and a torque to the rows of one body.
#[inline(always)]
pub(crate) fn add<S: Space>(
    force: &mut [Row],
    torque: &mut [Row],
    place: usize,
    sign: f64,
    f: [f64; 3],
    t: [f64; 3],
) {
    let row = &mut force[place].0;
    if S::PLANAR {
        row[0] += sign * f[0];
        row[1] += sign * f[1];
        if S::ROTATION {
            row[2] += t[2];
        }
    } else {
        row[0] += sign * f[0];
        row[1] += sign * f[1];
        row[2] += sign * f[2];
        if S::ROTATION {
            let row = &mut torque[place].0;
            row[0] += t[0];
            row[1] += t[1];
            row[2] += t[2];
        }
    }
}
