//! What will run: immutable, complete, and free of everything that the scene does not need.

use std::path::PathBuf;
use std::sync::Arc;

use granule_geometry::{Cell, Motion, Wall};
use granule_law_api::{
    CollisionEntry, CollisionRule, Columns, ContactEnd, Conventions, LawEntry, PairContext, Params, Slot,
    Stage, SubstrateEntry, SubstrateStage,
};

/// Number of space dimensions that exist in the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimensions {
    /// Plane motion: x and y, spin about z. No z column exists.
    Two,
    /// Full space.
    Three,
}

/// Arithmetic of the contact stages. The state is double precision always.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// `f64`.
    Double,
    /// `f32` on relative positions and velocities, accumulated in `f64`.
    Single,
}

/// Time integration scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Velocity Verlet; forces see velocities predicted to the time of the positions. Second order with damping.
    VelocityVerlet,
    /// Velocity Verlet whose forces see half-step velocities (LAMMPS, LIGGGHTS).
    ClassicVelocityVerlet,
    /// Velocity Verlet that resolves contacts where they begin and end within a step.
    ContactResolved,
    /// Leapfrog, drift-kick-drift: forces at the middle of the step.
    Leapfrog,
    /// Symplectic Euler: kick, then drift. First order.
    SymplecticEuler,
}

/// Initial bodies, one entry a body in the order of their ids.
#[derive(Clone, Debug, Default)]
pub struct BodyTable {
    /// Stable identity, unique, at least 1.
    pub id: Vec<u32>,
    /// Index into [`Plan::materials`].
    pub material: Vec<u16>,
    /// Radius R \[m\].
    pub radius: Vec<f64>,
    /// Mass m \[kg\].
    pub mass: Vec<f64>,
    /// Inertia factor q = I/(m R²).
    pub inertia_factor: Vec<f64>,
    /// Centre \[m\].
    pub position: Vec<[f64; 3]>,
    /// Velocity \[m/s\].
    pub velocity: Vec<[f64; 3]>,
    /// Spin ω \[rad/s\].
    pub spin: Vec<[f64; 3]>,
    /// Bodies that never move and count as infinitely heavy.
    pub frozen: Vec<bool>,
}

impl BodyTable {
    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// True without bodies.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }
}

/// A material: a name that contacts refer to.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialPlan {
    /// Name in the scene.
    pub name: String,
}

/// A wall that exists in the run.
#[derive(Clone, Debug)]
pub struct WallPlan {
    /// Name in the scene.
    pub name: String,
    /// Surface and prescribed motion.
    pub wall: Wall,
    /// Index into [`Plan::materials`].
    pub material: u16,
}

/// One stage of a composition, compiled.
pub struct StagePlan {
    /// Slot that it fills.
    pub slot: Slot,
    /// The law.
    pub law: &'static LawEntry,
    /// Its parameters, checked.
    pub params: Params,
    /// Columns that it reads.
    pub reads: Columns,
    /// First scalar history column of this stage within the contact's history.
    pub history_offset: usize,
    /// Number of scalar history columns of this stage.
    pub history_width: usize,
    /// Compiled for double precision.
    pub double: Arc<dyn Stage<f64>>,
    /// Compiled for single precision; present only if the plan's precision is single.
    pub single: Option<Arc<dyn Stage<f32>>>,
}

/// How bodies of one material roll and slide.
pub struct SubstrateMaterial {
    /// The law.
    pub law: &'static SubstrateEntry,
    /// Its parameters, checked.
    pub params: Params,
    /// Coefficient of rolling friction by rolling speed \[m/s\]; empty if it is a parameter.
    pub rolling_friction: Vec<(f64, f64)>,
    /// Compiled.
    pub stage: Arc<dyn SubstrateStage>,
}

/// A surface of constant z that bodies roll and slide on.
pub struct SubstratePlan {
    /// z of the surface \[m\].
    pub height: f64,
    /// Motion in its own plane.
    pub motion: Motion,
    /// Bodies never leave it.
    pub confined: bool,
    /// Restitution of a landing.
    pub restitution: f64,
    /// By material; `None` where no body that can move is made of it.
    pub materials: Vec<Option<SubstrateMaterial>>,
}

/// The other side of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partner {
    /// A body of this material.
    Body(u16),
    /// A wall, by its index in [`Plan::walls`].
    Wall(u16),
}

/// Laws that act between bodies of one material and a partner.
pub struct Composition {
    /// Material of body i.
    pub material: u16,
    /// The other side.
    pub partner: Partner,
    /// Stages in the order of execution.
    pub stages: Vec<StagePlan>,
    /// When contacts end.
    pub contact_end: ContactEnd,
    /// Context that the stages were compiled for.
    pub context: PairContext,
    /// Scalar history columns of a contact.
    pub history_width: usize,
    /// Distance beyond touching at which it acts \[m\].
    pub reach: f64,
    /// Every column that some stage reads.
    pub reads: Columns,
    /// Every column that some stage writes.
    pub writes: Columns,
}

/// A rule of instantaneous collisions between bodies of one material and a partner.
pub struct CollisionPlan {
    /// Material of body i.
    pub material: u16,
    /// The other side.
    pub partner: Partner,
    /// The law.
    pub law: &'static CollisionEntry,
    /// Its parameters, checked.
    pub params: Params,
    /// The law with its parameters folded in.
    pub rule: Arc<dyn CollisionRule>,
}

/// Settings of the event-driven driver.
pub struct EventPlan {
    /// Contact duration t_c \[s\]; 0 where no collision loses energy and nothing accelerates.
    pub contact_duration: f64,
    /// Rules of all pairs of materials and walls that can meet.
    pub collisions: Vec<CollisionPlan>,
    /// What bodies on a substrate do between collisions; `None` without a substrate.
    pub slides: Option<Slides>,
}

/// What hard bodies on a substrate do between collisions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slides {
    /// They slide and roll along arcs.
    Arcs {
        /// Aim for the error of a place over one piece \[m\].
        error: f64,
    },
    /// Slides are over at once, with the effective restitution.
    EffectiveRestitution,
}

/// How candidates are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// No pairs can touch: no search structure exists (a single body, or no body-body law).
    None,
    /// Every pair is a candidate: a handful of bodies.
    AllPairs,
    /// Verlet lists from a grid.
    Grid,
}

/// Settings of the time-stepped driver.
#[derive(Clone, Debug)]
pub struct TimeStepPlan {
    /// Scheme.
    pub scheme: Scheme,
    /// Time step \[s\].
    pub step: f64,
    /// Number of steps of the whole run.
    pub steps: u64,
    /// Largest step that the laws allow \[s\], infinite if nothing limits it.
    pub step_limit: f64,
    /// How candidates are found.
    pub search: Search,
    /// Skin of the outer Verlet list \[m\]: pairs closer than touching + skin are candidates.
    pub skin: f64,
    /// Worker threads; `None`: as many as the machine has.
    pub threads: Option<usize>,
}

/// One output that the scene asks for. Paths are relative to the output directory of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputPlan {
    /// File or, for VTK, base name of the series.
    pub path: PathBuf,
    /// What it is.
    pub kind: OutputKind,
    /// Steps between two entries, at least 1. Entries are written at step 0, every `every` steps, and at the end.
    pub every: u64,
}

/// What happens where a limit is passed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Guard {
    /// Nothing.
    #[default]
    Off,
    /// It is said once, and the run goes on.
    Warn(f64),
    /// The run ends.
    Stop(f64),
}

impl Guard {
    /// The limit; infinite if nothing happens beyond any.
    pub fn limit(self) -> f64 {
        match self {
            Self::Off => f64::INFINITY,
            Self::Warn(limit) | Self::Stop(limit) => limit,
        }
    }

    /// True if the run ends beyond the limit.
    pub fn stops(self) -> bool {
        matches!(self, Self::Stop(_))
    }
}

/// What is watched during a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Guards {
    /// Overlap over the radius of the smaller body.
    pub overlap: Guard,
    /// Distance moved in one step over the smallest radius.
    pub travel: Guard,
    /// Distance of a centre from the cell over the radius.
    pub lost: Guard,
    /// Residual of the energy ledger over the energy turned over.
    pub energy: Guard,
}

/// When the state of a run is kept, besides when it is stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckpointPlan {
    /// Steps between two checkpoints, at least 1.
    pub every: Option<u64>,
    /// Time on the clock between two checkpoints \[s\].
    pub wall: Option<f64>,
    /// How many of the last checkpoints are kept, at least 1.
    pub keep: usize,
}

/// Kinds of output.
#[derive(Clone, Debug, PartialEq)]
pub enum OutputKind {
    /// CSV time series of the named quantities (see [`SERIES`]).
    Series(Vec<String>),
    /// CSV time series of one body: position, velocity, spin, force, torque.
    BodySeries(Vec<u32>),
    /// LAMMPS text dump.
    LammpsDump,
    /// VTK `.vtp` files and a `.pvd` collection.
    Vtk {
        /// zlib-compressed blocks.
        compressed: bool,
    },
    /// LAMMPS data file of the last state.
    LammpsData,
    /// CSV time series of many bodies together.
    Layer {
        /// Gap below which bodies are of one cluster \[m\].
        gap: f64,
        /// Gap below which bodies are neighbours for the index of segregation \[m\].
        neighbours: f64,
    },
    /// CSV of pair correlations.
    PairCorrelation {
        /// Largest distance \[m\].
        range: f64,
        /// Intervals.
        bins: usize,
    },
    /// CSV of what each contact does.
    Contacts,
    /// CSV table of restitutions by density and speed.
    Impacts {
        /// Radius of the surroundings whose density counts \[m\].
        reach: f64,
    },
}

/// Quantities of a CSV time series: name, unit, meaning.
pub const SERIES: [(&str, &str, &str); 20] = [
    ("kinetic_energy", "J", "kinetic energy of translation"),
    ("rotational_energy", "J", "kinetic energy of rotation"),
    ("elastic_energy", "J", "energy stored in contacts (energy ledger)"),
    ("gravity_energy", "J", "potential energy in the field of gravity, zero at the origin"),
    ("dissipated_viscous", "J", "energy dissipated by damping since the start (energy ledger)"),
    ("dissipated_friction", "J", "energy dissipated by sliding since the start (energy ledger)"),
    ("wall_work", "J", "work done by walls on the bodies since the start (energy ledger)"),
    (
        "energy_residual",
        "J",
        "what the energy ledger does not account for: the error of the time integration",
    ),
    ("momentum_x", "kg m/s", "linear momentum, x"),
    ("momentum_y", "kg m/s", "linear momentum, y"),
    ("momentum_z", "kg m/s", "linear momentum, z"),
    ("contacts", "1", "number of body-body contacts"),
    ("collisions", "1", "collisions since the start (event-driven driver)"),
    (
        "overlapping_collisions",
        "1",
        "collisions less than the contact duration after the last one of a body (event-driven driver)",
    ),
    ("coordination_number", "1", "contacts with bodies and walls per body"),
    ("mean_height", "m", "mean height of the centres along the direction against gravity"),
    ("maximum_height", "m", "largest height of a centre along the direction against gravity"),
    (
        "repose_angle",
        "rad",
        "slope of the cone (in the plane, of the triangle) with the mean height and mean distance from the axis of a heap",
    ),
    ("maximum_overlap", "m", "largest overlap of all contacts"),
    ("maximum_speed", "m/s", "largest speed of a body"),
];

/// One line of `granule explain`: a piece of physics or machinery, whether it exists, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// What it is about, as in `rotation`.
    pub topic: &'static str,
    /// True if it is part of the run.
    pub included: bool,
    /// Why, with the numbers that decided it.
    pub why: String,
}

/// What will run.
pub struct Plan {
    /// Title of the scene.
    pub title: String,
    /// Space dimensions.
    pub dimensions: Dimensions,
    /// True if spins and torques exist.
    pub rotation: bool,
    /// True if the energy ledger exists.
    pub ledger: bool,
    /// Arithmetic of the stages.
    pub precision: Precision,
    /// Conventions.
    pub conventions: Conventions,
    /// Gravity \[m/s²\].
    pub gravity: [f64; 3],
    /// The periodic cell.
    pub cell: Cell,
    /// Materials.
    pub materials: Vec<MaterialPlan>,
    /// Bodies at the start.
    pub bodies: BodyTable,
    /// Walls.
    pub walls: Vec<WallPlan>,
    /// The surface that bodies roll and slide on.
    pub substrate: Option<SubstratePlan>,
    /// Compositions of all pairs of materials and walls that can meet.
    pub compositions: Vec<Composition>,
    /// Driver settings. The event-driven driver takes its steps from here as well: they are the times at which it can be
    /// looked at.
    pub driver: TimeStepPlan,
    /// The event-driven driver runs instead of the time-stepped one.
    pub event: Option<EventPlan>,
    /// Outputs.
    pub outputs: Vec<OutputPlan>,
    /// When the state is kept; `None` for never.
    pub checkpoint: Option<CheckpointPlan>,
    /// What is watched during the run.
    pub guards: Guards,
    /// What is included, what is left out, and why.
    pub decisions: Vec<Decision>,
    /// Hash of everything above that determines the results: 32 hexadecimal digits. Outputs do not enter it.
    pub fingerprint: String,
}

impl Plan {
    /// An output shows what each contact does.
    pub fn shows_contacts(&self) -> bool {
        self.outputs.iter().any(|output| output.kind == OutputKind::Contacts)
    }

    /// Index of the composition between a body of `material` and a partner, if they interact. The order of two
    /// materials does not matter.
    pub fn composition(&self, material: u16, partner: Partner) -> Option<usize> {
        self.compositions.iter().position(|composition| {
            (composition.material == material && composition.partner == partner)
                || matches!(partner, Partner::Body(other)
                    if composition.material == other && composition.partner == Partner::Body(material))
        })
    }
}
