//! Instantaneous collisions of hard bodies: normal restitution, friction, tangential restitution.

mod hard_sphere;
mod impulse;
mod speed_dependent;

pub use hard_sphere::HardSphere;
pub use speed_dependent::SpeedDependentHardSphere;

#[cfg(test)]
mod tests;
