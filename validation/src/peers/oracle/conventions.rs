//! Choices in which the engines differ from each other and from a synchronised, momentum-conserving scheme.

use crate::peers::PeerLaw;

/// Lever arm from the centre of a body to its contact point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arm {
    /// R.
    Full,
    /// R - δ/2.
    Shortened,
    /// R - δ: the surface of a rigid wall.
    ToWall,
}

/// When the tangential spring is turned into the tangent plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HistoryOrder {
    /// Add the slip, then project; the spring shrinks.
    IncrementThenProject,
    /// Turn keeping the length, then add the slip.
    RotateThenIncrement,
    /// The same, but only if the out-of-plane spring force exceeds 1e-10 of the Coulomb limit.
    RotateIfTiltedThenIncrement,
}

/// Which tangential force is held against the Coulomb limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoulombTest {
    /// Spring and damper together.
    Total,
    /// The spring alone.
    SpringOnly,
}

/// What the Coulomb limit is computed from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoulombCap {
    /// μ |f_n|.
    Magnitude,
    /// μ max(f_n, 0).
    Repulsive,
}

/// Velocities with which forces are evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Velocity {
    /// Half a step before the positions.
    HalfStep,
    /// Predicted to the time of the positions with the last acceleration, corrected after.
    Synchronised,
}

/// When the normal force of a contact ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactEnd {
    /// With the overlap; damping may attract before.
    Overlap,
    /// When it would attract.
    Force,
}

/// All of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConventionSet {
    /// Arm of the torque between two bodies.
    pub pair_torque_arm: Arm,
    /// Arm in the slip velocity between two bodies.
    pub pair_slip_arm: Arm,
    /// Arm of the torque at a wall.
    pub wall_torque_arm: Arm,
    /// Arm in the slip velocity at a wall.
    pub wall_slip_arm: Arm,
    /// When the spring is turned.
    pub history_order: HistoryOrder,
    /// Which force is held against the Coulomb limit.
    pub coulomb_test: CoulombTest,
    /// Whether the tangential damper acts while the contact slides: with `Total` the spring keeps what the damper leaves of
    /// the Coulomb force; with `SpringOnly` the damper comes on top of it.
    pub damper_while_sliding: bool,
    /// What the Coulomb limit is computed from.
    pub coulomb_cap: CoulombCap,
    /// Velocities in forces.
    pub velocity: Velocity,
    /// When the normal force ends.
    pub contact_end: ContactEnd,
}

impl ConventionSet {
    /// Synchronised velocities, momenta conserved to round-off, no attraction.
    pub const PHYSICAL: Self = Self {
        pair_torque_arm: Arm::Shortened,
        pair_slip_arm: Arm::Shortened,
        wall_torque_arm: Arm::ToWall,
        wall_slip_arm: Arm::ToWall,
        history_order: HistoryOrder::RotateThenIncrement,
        coulomb_test: CoulombTest::Total,
        damper_while_sliding: true,
        coulomb_cap: CoulombCap::Repulsive,
        velocity: Velocity::Synchronised,
        contact_end: ContactEnd::Force,
    };

    /// What the engine of a law does.
    pub fn of(law: &PeerLaw) -> Self {
        let end = |limit: bool| if limit { ContactEnd::Force } else { ContactEnd::Overlap };
        let peers = Self {
            pair_torque_arm: Arm::Full,
            pair_slip_arm: Arm::Full,
            wall_torque_arm: Arm::Full,
            wall_slip_arm: Arm::Full,
            history_order: HistoryOrder::IncrementThenProject,
            coulomb_test: CoulombTest::Total,
            damper_while_sliding: true,
            coulomb_cap: CoulombCap::Magnitude,
            velocity: Velocity::HalfStep,
            contact_end: ContactEnd::Overlap,
        };
        match law {
            PeerLaw::Classic(law) => Self { contact_end: end(law.limit_damping), ..peers },
            PeerLaw::Granular(law) => Self {
                pair_torque_arm: Arm::Shortened,
                history_order: HistoryOrder::RotateIfTiltedThenIncrement,
                contact_end: end(law.limit_damping),
                ..peers
            },
            PeerLaw::Liggghts(law) => Self {
                pair_torque_arm: Arm::Shortened,
                pair_slip_arm: Arm::Shortened,
                wall_torque_arm: Arm::Shortened,
                wall_slip_arm: Arm::Shortened,
                coulomb_test: CoulombTest::SpringOnly,
                damper_while_sliding: false,
                contact_end: end(law.limit_force),
                ..peers
            },
        }
    }
}
