//! Shapes, walls, the periodic cell and neighbour search.
//!
//! Lengths are in metres, angles in radians and times in seconds; nothing here knows masses or forces.
//!
//! - [`Shape`]: inertia factor and volume of a body.
//! - [`Cell`]: the periodic cell, wrapping, minimum image and image codes.
//! - [`Surface`], [`Wall`], [`Motion`], [`BoxWalls`]: planes and cylinders that may move as prescribed.
//! - [`NeighbourGrid`] and its oracle [`brute_force_pairs`]: which bodies are near each other.
//! - [`BodyOrder`]: an order of the bodies in which neighbours in memory are neighbours in space.

mod cell;
mod error;
mod motion;
mod search;
mod shape;
mod surface;
mod vector;
mod wall;

pub use cell::{Cell, IMAGE_CODES, NO_IMAGE, image_code, image_shift, opposite_image};
pub use error::GeometryError;
pub use motion::Motion;
pub use search::{BodyOrder, NeighbourGrid, PairScratch, brute_force_pairs};
pub use shape::{InertiaFactor, Shape};
pub use surface::{Cylinder, Plane, Surface, SurfaceContact};
pub use wall::{BoxWalls, Wall};
