//! One dumped step of a run, of a peer or of ours.

use serde::{Deserialize, Serialize};

/// What a frame can hold of each body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Quantity {
    /// Centre (m).
    Position,
    /// Velocity of the centre at the full step (m/s).
    Velocity,
    /// Angular velocity at the full step (rad/s).
    AngularVelocity,
    /// Force, gravity included (N). Peers evaluate it with half-step velocities.
    Force,
    /// Torque about the centre (N m).
    Torque,
}

impl Quantity {
    /// All of them, in the order of dump columns.
    pub const ALL: [Self; 5] =
        [Self::Position, Self::Velocity, Self::AngularVelocity, Self::Force, Self::Torque];

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::AngularVelocity => "angular velocity",
            Self::Force => "force",
            Self::Torque => "torque",
        }
    }

    /// Columns of a LAMMPS or LIGGGHTS `dump custom`.
    pub fn columns(self) -> [&'static str; 3] {
        match self {
            Self::Position => ["x", "y", "z"],
            Self::Velocity => ["vx", "vy", "vz"],
            Self::AngularVelocity => ["omegax", "omegay", "omegaz"],
            Self::Force => ["fx", "fy", "fz"],
            Self::Torque => ["tqx", "tqy", "tqz"],
        }
    }
}

/// State of all bodies at one step, sorted by id. A column that was not dumped is empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Step number; step 0 is the initial state with its forces.
    pub step: u64,
    /// Ids of the bodies, ascending.
    pub ids: Vec<u64>,
    /// Centres (m).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub position: Vec<[f64; 3]>,
    /// Velocities (m/s).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub velocity: Vec<[f64; 3]>,
    /// Angular velocities (rad/s).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub angular_velocity: Vec<[f64; 3]>,
    /// Forces (N).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub force: Vec<[f64; 3]>,
    /// Torques (N m).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub torque: Vec<[f64; 3]>,
}

impl Frame {
    /// One column.
    pub fn column(&self, quantity: Quantity) -> &[[f64; 3]] {
        match quantity {
            Quantity::Position => &self.position,
            Quantity::Velocity => &self.velocity,
            Quantity::AngularVelocity => &self.angular_velocity,
            Quantity::Force => &self.force,
            Quantity::Torque => &self.torque,
        }
    }

    /// One column, to fill.
    pub fn column_mut(&mut self, quantity: Quantity) -> &mut Vec<[f64; 3]> {
        match quantity {
            Quantity::Position => &mut self.position,
            Quantity::Velocity => &mut self.velocity,
            Quantity::AngularVelocity => &mut self.angular_velocity,
            Quantity::Force => &mut self.force,
            Quantity::Torque => &mut self.torque,
        }
    }
}
