//! Forces between rolling spheres as in Kondic 1999.

mod friction;
mod material;
mod normal;

pub use friction::KondicFriction;
pub use material::{collision_time, printed_collision_time};
pub use normal::KondicNormal;
