//! Bodies that slide and roll on a plane between hard collisions.
//!
//! After a collision a body slides: kinetic friction slows its centre and turns it, both at a constant rate, until the slip is
//! zero; then it rolls, which rolling friction slows until it rests (Kondic 1999, Secs. IV A 3 and IV B 1). Where the plate
//! moves or is tilted, the direction of the friction turns; arcs are then cut into pieces of constant friction. What the
//! plate does to a rolling body does not depend on the friction and is exact: x = parabola + β D(t), with the displacement
//! D of the plate and β = 0 for a body that slides, 1/(1 + Q) for one that rolls, and 1 for one at rest on the plate.

mod account;
mod arc;
mod engine;
mod gait;
mod impact;
mod neighbourhood;
mod plate;
mod predict;
mod saved;
mod setup;
mod side;
mod touch;

pub use account::{RollingTally, RollingWork};
pub use engine::RollingEngine;
pub use saved::RollingState;
pub use setup::{Between, RollingSetup};
