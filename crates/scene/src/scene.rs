//! What the user wrote, with places. Nothing here is checked against laws, other blocks or geometry: the plan does that.

mod accuracy;
mod checkpoint;
mod guards;
mod outputs;

use std::ops::Range;

pub use accuracy::{AccuracyBlock, AccuracyGoal};
pub use checkpoint::CheckpointChoice;
pub use guards::{GuardChoice, GuardsBlock};
pub use outputs::{EveryChoice, OutputBlock, OutputChoice};

/// A value and the bytes of the text that it was read from.
#[derive(Clone, Debug, PartialEq)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Where it stands.
    pub span: Range<usize>,
}

impl<T> Spanned<T> {
    /// A value at a place.
    pub const fn new(value: T, span: Range<usize>) -> Self {
        Self { value, span }
    }
}

/// Two or three components in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Vector {
    /// The components.
    pub components: Vec<Spanned<f64>>,
    /// Where the vector stands.
    pub span: Range<usize>,
}

/// A list of blocks, less those that could not be read.
#[derive(Clone, Debug, PartialEq)]
pub struct Section<T> {
    /// The blocks that could be read.
    pub items: Vec<T>,
    /// False if some block is missing because it could not be read: conclusions from absence are then void.
    pub complete: bool,
    /// Where the section stands; the beginning of the scene if it is absent.
    pub span: Range<usize>,
}

/// A whole scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Title, as in reports.
    pub title: String,
    /// Seed of everything that is random in the initial state.
    pub seed: u64,
    /// 2 or 3.
    pub dimensions: Spanned<u8>,
    /// Gravity \[m/s²\].
    pub gravity: Option<Vector>,
    /// Bounds of space.
    pub cell: Option<CellBlock>,
    /// Materials by name.
    pub materials: Section<MaterialBlock>,
    /// Bodies at the start.
    pub bodies: Section<BodyBlock>,
    /// Walls by name.
    pub walls: Section<WallBlock>,
    /// The surface that bodies roll and slide on.
    pub substrate: Option<SubstrateBlock>,
    /// Laws between materials.
    pub contacts: Section<ContactBlock>,
    /// Conventions in which engines differ.
    pub conventions: ConventionsBlock,
    /// Arithmetic of the contact laws.
    pub precision: PrecisionChoice,
    /// Largest impact speed to expect \[m/s\], if the user knows better than the estimate.
    pub impact_speed: Option<Spanned<f64>>,
    /// Bodies may overlap at the start.
    pub allow_overlap: bool,
    /// Settings of the time-stepped driver.
    pub driver: TimeStepBlock,
    /// The event-driven driver is asked for, with these settings.
    pub event: Option<EventBlock>,
    /// An accuracy or a time that is asked for instead of a step.
    pub accuracy: Option<AccuracyBlock>,
    /// How long it runs.
    pub run: Option<RunBlock>,
    /// Files to write.
    pub outputs: Section<OutputBlock>,
    /// When the state is kept.
    pub checkpoint: Option<CheckpointChoice>,
    /// What is watched during the run.
    pub guards: GuardsBlock,
    /// The energy ledger is asked for.
    pub ledger: bool,
    /// False if anything could not be read.
    pub complete: bool,
}

/// `cell: (lo: .., hi: .., periodic: ..)`.
#[derive(Clone, Debug, PartialEq)]
pub struct CellBlock {
    /// Lower corner \[m\]; may be infinite where not periodic.
    pub lo: Vector,
    /// Upper corner \[m\]; may be infinite where not periodic.
    pub hi: Vector,
    /// Periodic directions, two or three.
    pub periodic: Spanned<Vec<bool>>,
    /// Where the block stands.
    pub span: Range<usize>,
}

/// One material.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialBlock {
    /// Its name.
    pub name: Spanned<String>,
    /// Density \[kg/m³\].
    pub density: Option<Spanned<f64>>,
}

/// How mass is distributed in a body.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeChoice {
    /// A homogeneous sphere.
    Sphere,
    /// A homogeneous disc.
    Disc,
    /// A thin spherical shell.
    HollowSphere,
    /// A round body with an inertia factor q = I/(m R²) in (0, 1].
    Body(f64),
}

/// Bodies of the initial state.
#[derive(Clone, Debug, PartialEq)]
pub enum BodyBlock {
    /// One body.
    Single(SingleBody),
    /// Bodies on a lattice.
    Lattice(LatticeBlock),
    /// Bodies at random places.
    Fill(FillBlock),
    /// Bodies from a file.
    Import(ImportBlock),
}

/// `Sphere(..)`, `Disc(..)`, `HollowSphere(..)`, `Body(..)`.
#[derive(Clone, Debug, PartialEq)]
pub struct SingleBody {
    /// Shape.
    pub shape: Spanned<ShapeChoice>,
    /// Identity; the next free one if absent.
    pub id: Option<Spanned<u32>>,
    /// Material.
    pub material: Spanned<String>,
    /// Radius \[m\].
    pub radius: Spanned<f64>,
    /// Mass \[kg\], instead of the material's density.
    pub mass: Option<Spanned<f64>>,
    /// Centre \[m\].
    pub position: Vector,
    /// Velocity \[m/s\].
    pub velocity: Option<Vector>,
    /// Spin \[rad/s\]; one component in the plane.
    pub spin: Option<Vector>,
    /// It never moves.
    pub frozen: bool,
    /// Where the block stands.
    pub span: Range<usize>,
}

/// Kind of a lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LatticeKind {
    /// Simple cubic; square in the plane.
    Cubic,
    /// Face-centred cubic: the densest packing in space.
    FaceCentred,
    /// Hexagonal: the densest packing in the plane.
    Hexagonal,
}

/// `Lattice(..)`.
#[derive(Clone, Debug, PartialEq)]
pub struct LatticeBlock {
    /// Shape; the usual one of the dimensions if absent.
    pub shape: Option<Spanned<ShapeChoice>>,
    /// Material.
    pub material: Spanned<String>,
    /// Radius \[m\].
    pub radius: Spanned<f64>,
    /// Kind.
    pub kind: Spanned<LatticeKind>,
    /// Distance of nearest neighbours \[m\].
    pub spacing: Spanned<f64>,
    /// Lower corner of the region of the centres \[m\].
    pub lo: Vector,
    /// Upper corner of the region of the centres \[m\].
    pub hi: Vector,
    /// Largest random displacement of each coordinate \[m\].
    pub jitter: Option<Spanned<f64>>,
    /// Common velocity \[m/s\].
    pub velocity: Option<Vector>,
    /// Largest random addition to each velocity component \[m/s\].
    pub velocity_spread: Option<Spanned<f64>>,
    /// They never move.
    pub frozen: bool,
    /// Where the block stands.
    pub span: Range<usize>,
}

/// Radii of a random fill.
#[derive(Clone, Debug, PartialEq)]
pub enum RadiusChoice {
    /// All equal \[m\].
    Fixed(Spanned<f64>),
    /// Evenly distributed between two radii \[m\].
    Uniform {
        /// Smallest.
        min: Spanned<f64>,
        /// Largest.
        max: Spanned<f64>,
    },
    /// Normally distributed, cut at three standard deviations \[m\].
    Normal {
        /// Mean.
        mean: Spanned<f64>,
        /// Standard deviation.
        standard_deviation: Spanned<f64>,
    },
    /// Several radii \[m\] with shares of the number of bodies.
    Mixture(Vec<(Spanned<f64>, Spanned<f64>)>),
}

/// How much a fill places.
#[derive(Clone, Debug, PartialEq)]
pub enum FillAmount {
    /// A number of bodies.
    Count(Spanned<u32>),
    /// A share of the volume (area in the plane) of the region.
    VolumeFraction(Spanned<f64>),
}

/// `Fill(..)`.
#[derive(Clone, Debug, PartialEq)]
pub struct FillBlock {
    /// Shape; the usual one of the dimensions if absent.
    pub shape: Option<Spanned<ShapeChoice>>,
    /// Material.
    pub material: Spanned<String>,
    /// Radii.
    pub radius: RadiusChoice,
    /// How many.
    pub amount: FillAmount,
    /// Lower corner of the region \[m\].
    pub lo: Vector,
    /// Upper corner of the region \[m\].
    pub hi: Vector,
    /// Common velocity \[m/s\].
    pub velocity: Option<Vector>,
    /// Largest random addition to each velocity component \[m/s\].
    pub velocity_spread: Option<Spanned<f64>>,
    /// Where the block stands.
    pub span: Range<usize>,
}

/// Which snapshot of a dump.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameChoice {
    /// The last one.
    Last,
    /// The one of this time step.
    Step(u64),
}

/// Format of an imported file.
#[derive(Clone, Debug, PartialEq)]
pub enum ImportFormat {
    /// LAMMPS or LIGGGHTS data file, `atom_style sphere`.
    LammpsData,
    /// LAMMPS or LIGGGHTS text dump.
    LammpsDump {
        /// Which snapshot.
        frame: FrameChoice,
    },
}

/// `Import(..)`.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportBlock {
    /// Path, relative to the folder of the scene.
    pub file: Spanned<String>,
    /// Format.
    pub format: ImportFormat,
    /// Material of each atom type.
    pub materials: Vec<(Spanned<u32>, Spanned<String>)>,
    /// Atom types that never move.
    pub frozen_types: Vec<Spanned<u32>>,
    /// Shape; the usual one of the dimensions if absent.
    pub shape: Option<Spanned<ShapeChoice>>,
    /// Where the block stands.
    pub span: Range<usize>,
}

/// Where a wall is.
#[derive(Clone, Debug, PartialEq)]
pub enum WallShape {
    /// An infinite plane.
    Plane {
        /// A point of it \[m\].
        point: Vector,
        /// Normal towards the bodies, of any length.
        normal: Vector,
    },
    /// The faces of a box, bodies inside.
    Box {
        /// Lower corner \[m\].
        lo: Vector,
        /// Upper corner \[m\].
        hi: Vector,
        /// Faces that do not exist: `x-`, `x+`, `y-`, ...
        open: Vec<Spanned<String>>,
    },
    /// An infinite cylinder.
    Cylinder {
        /// A point of its axis \[m\].
        point: Vector,
        /// Direction of its axis, of any length; z if absent.
        axis: Option<Vector>,
        /// Radius \[m\].
        radius: Spanned<f64>,
        /// Bodies are inside.
        inside: bool,
    },
}

/// How a wall moves.
#[derive(Clone, Debug, PartialEq)]
pub enum MotionChoice {
    /// Not at all.
    Static,
    /// With constant velocity \[m/s\].
    Constant {
        /// The velocity.
        velocity: Vector,
    },
    /// Displacement amplitude · sin(ω t + phase).
    Sinusoidal {
        /// Amplitude \[m\].
        amplitude: Vector,
        /// Angular frequency ω \[rad/s\].
        angular_frequency: f64,
        /// Phase \[rad\].
        phase: f64,
    },
    /// Displacements \[m\] at times \[s\].
    Table(Vec<(Spanned<f64>, Vector)>),
    /// Turning about a fixed axis.
    Rotation {
        /// A point of the axis \[m\].
        point: Vector,
        /// Direction of the axis; z if absent.
        axis: Option<Vector>,
        /// Angular velocity \[rad/s\].
        angular_velocity: f64,
    },
}

/// One wall block.
#[derive(Clone, Debug, PartialEq)]
pub struct WallBlock {
    /// Its name.
    pub name: Spanned<String>,
    /// Material.
    pub material: Spanned<String>,
    /// Where it is.
    pub shape: WallShape,
    /// How it moves.
    pub motion: Spanned<MotionChoice>,
    /// Where the block stands.
    pub span: Range<usize>,
}

/// The surface that bodies roll and slide on: a plane of constant z.
#[derive(Clone, Debug, PartialEq)]
pub struct SubstrateBlock {
    /// z of the surface \[m\].
    pub height: Option<Spanned<f64>>,
    /// How it moves.
    pub motion: Option<Spanned<MotionChoice>>,
    /// Angle by which it is tilted \[rad\].
    pub inclination: Option<Spanned<f64>>,
    /// Bodies never leave it.
    pub confined: bool,
    /// Restitution of a landing.
    pub restitution: Option<Spanned<f64>>,
    /// Law of each material.
    pub laws: Vec<(Spanned<String>, LawBlock)>,
    /// Rolling friction by rolling speed \[m/s\] of a material.
    pub rolling_friction: Vec<(Spanned<String>, RollingTable)>,
    /// Where the block stands.
    pub span: Range<usize>,
}

/// Rows of rolling speed \[m/s\] and coefficient.
pub type RollingTable = Vec<(Spanned<f64>, Spanned<f64>)>;

/// A parameter of a law as written.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterValue {
    /// A number in SI units; may be infinite or not a number.
    Number(f64),
    /// A number with a unit.
    Text(String),
}

/// A law with its parameters as written: names and units are checked against the registry.
#[derive(Clone, Debug, PartialEq)]
pub struct LawBlock {
    /// Name of the law.
    pub name: Spanned<String>,
    /// Parameters: name and value.
    pub parameters: Vec<(Spanned<String>, Spanned<ParameterValue>)>,
    /// Where the block stands.
    pub span: Range<usize>,
}

/// When contacts end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactEndChoice {
    /// When the normal force has fallen to zero.
    Force,
    /// When the overlap has vanished.
    Overlap,
}

/// Laws between two materials.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactBlock {
    /// The two materials.
    pub between: (Spanned<String>, Spanned<String>),
    /// Laws: name of the slot as in `normal`, and the law.
    pub laws: Vec<(&'static str, LawBlock)>,
    /// Rule of instantaneous collisions, for the event-driven driver.
    pub collision: Option<LawBlock>,
    /// When contacts end.
    pub contact_end: Option<Spanned<ContactEndChoice>>,
    /// Where the block stands.
    pub span: Range<usize>,
}

/// Conventions: a preset and changes to it.
#[derive(Clone, Debug, PartialEq)]
pub struct ConventionsBlock {
    /// Name of the preset; `physical` if absent.
    pub preset: Option<Spanned<String>>,
    /// Changes: name of the convention, name of the choice.
    pub changes: Vec<(Spanned<String>, Spanned<String>)>,
}

/// Arithmetic of the contact laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrecisionChoice {
    /// 64 bits.
    Double,
    /// 32 bits on relative positions.
    Single,
}

/// Integration scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IntegratorChoice {
    /// Synchronised velocity Verlet.
    VelocityVerlet,
    /// Velocity Verlet with half-step velocities in the forces.
    ClassicVelocityVerlet,
    /// Velocity Verlet that resolves contacts where they begin and end.
    ContactResolved,
    /// Drift-kick-drift.
    Leapfrog,
    /// Kick, then drift.
    SymplecticEuler,
}

/// Time step.
#[derive(Clone, Debug, PartialEq)]
pub enum StepChoice {
    /// Chosen from the shortest contact.
    Auto {
        /// Steps in the shortest contact.
        steps_per_contact: f64,
    },
    /// Given \[s\].
    Fixed(f64),
}

/// `driver: TimeStep(..)`.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeStepBlock {
    /// Scheme; from the conventions if absent.
    pub integrator: Option<Spanned<IntegratorChoice>>,
    /// Time step.
    pub step: Spanned<StepChoice>,
    /// A step at which a dense packing would be unstable is refused.
    pub packing_limit: bool,
    /// Verlet skin \[m\].
    pub skin: Option<Spanned<f64>>,
    /// Worker threads; all cores if absent.
    pub threads: Option<Spanned<u32>>,
}

/// `driver: Event(..)`.
#[derive(Clone, Debug, PartialEq)]
pub struct EventBlock {
    /// Interval at which the run can be looked at \[s\].
    pub step: Option<Spanned<f64>>,
    /// Contact duration of the contact-duration model \[s\].
    pub contact_duration: Option<Spanned<f64>>,
    /// What bodies on a substrate do between collisions.
    pub slides: Option<Spanned<SlidesChoice>>,
    /// Where the block stands.
    pub span: Range<usize>,
}

/// What hard bodies on a substrate do between collisions.
#[derive(Clone, Debug, PartialEq)]
pub enum SlidesChoice {
    /// `Arcs(error: ..)`: they slide and roll.
    Arcs {
        /// Aim for the error of a place over one piece of an arc \[m\].
        error: Option<f64>,
    },
    /// Slides are over at once.
    EffectiveRestitution,
}

/// How long it runs.
#[derive(Clone, Debug, PartialEq)]
pub enum RunBlock {
    /// Simulated time \[s\].
    Duration(Spanned<f64>),
    /// Steps.
    Steps(Spanned<u64>),
}
