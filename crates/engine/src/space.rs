//! How bodies are read from and written to rows, for each layout.

/// A combination of dimension and rotation, resolved at compile time.
pub(crate) trait Space: Send + Sync {
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
    ($name:ident, $rotation:expr, $planar:expr) => {
        impl Space for $name {
            const ROTATION: bool = $rotation;
            const PLANAR: bool = $planar;
        }
    };
}
space!(SpaceRotating, true, false);
space!(SpaceSmooth, false, false);
space!(PlaneRotating, true, true);
space!(PlaneSmooth, false, true);
