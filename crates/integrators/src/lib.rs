//! Time integration of body rows.
//!
//! A step is `begin` (before the forces of the step), the force evaluation, and `finish` (after it). `finish_begin` does
//! the end of one step and the beginning of the next in one pass over the rows, with the same bits. Knows nothing about
//! contacts.

mod integrator;
mod pass;
mod schemes;

pub use integrator::{Integrator, Pass, Tile, integrator};
pub use schemes::{
    ClassicVelocityVerlet, ContactResolved, Leapfrog, Memory, Scheme, Step, SymplecticEuler, VelocityVerlet,
};
