//! Viscous tangential force, with or without a friction limit.

mod viscous_tangential;

pub use viscous_tangential::ViscousTangential;
