//! Choices in which engines of the field differ, as data.

/// Lever arm from the centre of a body to its contact point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arm {
    /// The full radius R.
    Radius,
    /// R - δ/2: the arms of a pair add up to the distance of the centres, so that angular momentum is conserved exactly.
    HalfOverlap,
    /// R - δ: the contact point of a sphere on a rigid wall.
    FullOverlap,
}

/// How the tangential spring follows the turning contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HistoryUpdate {
    /// Turn the spring into the tangent plane keeping its length, then add the step's slip.
    RotateThenIncrement,
    /// As `RotateThenIncrement`, but only if the out-of-plane spring force exceeds 1e-10 of the Coulomb limit
    /// (LAMMPS `pair granular`).
    RotateIfTiltedThenIncrement,
    /// Add the step's slip, then project into the tangent plane; the length shrinks.
    IncrementThenProject,
}

/// Which tangential force is held against the Coulomb limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoulombTest {
    /// First the spring alone: it is cut to the limit. Then spring and damper together: the force is cut to the limit
    /// and the spring stays as it is. Never creates energy.
    SpringThenTotal,
    /// Spring and damper together; while sliding the spring keeps what the damper leaves (LAMMPS). Where the damper takes
    /// more than the limit the spring is wound up backwards, with energy that nobody has put in.
    Total,
    /// The spring alone; the damper acts only while sticking (LIGGGHTS).
    SpringOnly,
}

/// The normal force that the Coulomb limit is computed from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoulombCap {
    /// μ max(f_n, 0): an attractive contact carries no friction.
    Repulsive,
    /// μ |f_n| (LAMMPS, LIGGGHTS).
    Magnitude,
}

/// Velocity with which forces are evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VelocityRule {
    /// Of the same time as the positions.
    Synchronised,
    /// Of the same time as the positions, predicted with an acceleration that is extrapolated from the last two
    /// (`ContactResolved`).
    Extrapolated,
    /// Of half a step earlier (classic velocity Verlet with velocity-dependent forces).
    HalfStep,
}

/// The conventions of a run. [`Conventions::PHYSICAL`] is the default; the other presets reproduce peers to round-off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conventions {
    /// Arm of the torque between two bodies.
    pub pair_torque_arm: Arm,
    /// Arm in the slip velocity between two bodies.
    pub pair_slip_arm: Arm,
    /// Arm of the torque at a wall.
    pub wall_torque_arm: Arm,
    /// Arm in the slip velocity at a wall.
    pub wall_slip_arm: Arm,
    /// How tangential history is turned and advanced.
    pub history_update: HistoryUpdate,
    /// Which force is held against the Coulomb limit.
    pub coulomb_test: CoulombTest,
    /// What the Coulomb limit is computed from.
    pub coulomb_cap: CoulombCap,
    /// Time of the velocities in forces.
    pub velocity: VelocityRule,
}

impl Conventions {
    /// Conserves linear and angular momentum to round-off and synchronises velocities. A wall is the limit of an ever
    /// larger body, so it has the arm of a pair.
    pub const PHYSICAL: Self = Self {
        pair_torque_arm: Arm::HalfOverlap,
        pair_slip_arm: Arm::HalfOverlap,
        wall_torque_arm: Arm::HalfOverlap,
        wall_slip_arm: Arm::HalfOverlap,
        history_update: HistoryUpdate::RotateThenIncrement,
        coulomb_test: CoulombTest::SpringThenTotal,
        coulomb_cap: CoulombCap::Repulsive,
        velocity: VelocityRule::Synchronised,
    };
    /// LAMMPS `pair gran/hooke`, `gran/hooke/history`, `gran/hertz/history` and their walls.
    pub const LAMMPS_CLASSIC: Self = Self {
        pair_torque_arm: Arm::Radius,
        pair_slip_arm: Arm::Radius,
        wall_torque_arm: Arm::Radius,
        wall_slip_arm: Arm::Radius,
        history_update: HistoryUpdate::IncrementThenProject,
        coulomb_test: CoulombTest::Total,
        coulomb_cap: CoulombCap::Magnitude,
        velocity: VelocityRule::HalfStep,
    };
    /// LAMMPS `pair granular` and `fix wall/gran granular`.
    pub const LAMMPS_GRANULAR: Self = Self {
        pair_torque_arm: Arm::HalfOverlap,
        pair_slip_arm: Arm::Radius,
        wall_torque_arm: Arm::Radius,
        wall_slip_arm: Arm::Radius,
        history_update: HistoryUpdate::RotateIfTiltedThenIncrement,
        coulomb_test: CoulombTest::Total,
        coulomb_cap: CoulombCap::Magnitude,
        velocity: VelocityRule::HalfStep,
    };
    /// LIGGGHTS `pair gran` with its default surface model, and `fix wall/gran`.
    pub const LIGGGHTS: Self = Self {
        pair_torque_arm: Arm::HalfOverlap,
        pair_slip_arm: Arm::HalfOverlap,
        wall_torque_arm: Arm::HalfOverlap,
        wall_slip_arm: Arm::HalfOverlap,
        history_update: HistoryUpdate::IncrementThenProject,
        coulomb_test: CoulombTest::SpringOnly,
        coulomb_cap: CoulombCap::Magnitude,
        velocity: VelocityRule::HalfStep,
    };

    /// Presets by their name in a scene.
    pub const PRESETS: [(&'static str, Self); 4] = [
        ("physical", Self::PHYSICAL),
        ("lammps-classic", Self::LAMMPS_CLASSIC),
        ("lammps-granular", Self::LAMMPS_GRANULAR),
        ("liggghts", Self::LIGGGHTS),
    ];

    /// The preset of that name, if there is one.
    pub fn preset(name: &str) -> Option<Self> {
        Self::PRESETS.iter().find(|(preset, _)| *preset == name).map(|(_, conventions)| *conventions)
    }
}
