//! Dynamic Coulomb friction.

mod coulomb;

pub use coulomb::Coulomb;
