//! Every block and field of a scene, in one place: the reader refuses what is not listed here, and the manual prints it.

mod accuracy;
mod checkpoint;
mod event;
mod guards;
mod layer;
mod outputs;
mod substrate;

pub use accuracy::{ACCURACY, BUDGET};
pub use checkpoint::CHECKPOINT;
pub use event::{ARCS, EFFECTIVE_RESTITUTION, EVENT};
pub use guards::GUARDS;
pub use layer::{IMPACTS_OUTPUT, LAYER_OUTPUT, PAIR_CORRELATION_OUTPUT};
pub use outputs::{BODIES_OUTPUT, CONTACTS_OUTPUT, DATA_OUTPUT, DUMP_OUTPUT, SERIES_OUTPUT, VTK_OUTPUT};
pub use substrate::SUBSTRATE;

/// One field.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Name.
    pub name: &'static str,
    /// What it takes, with unit and allowed values.
    pub takes: &'static str,
    /// Default in words; `None` if the field must be given.
    pub default: Option<&'static str>,
    /// Meaning.
    pub doc: &'static str,
}

/// One block of named fields, `Name(field: value, ...)`.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Name, as in messages.
    pub name: &'static str,
    /// Meaning.
    pub doc: &'static str,
    /// Its fields.
    pub fields: &'static [Field],
}

impl Block {
    /// Names of all fields.
    pub fn names(&self) -> Vec<&'static str> {
        self.fields.iter().map(|field| field.name).collect()
    }
}

const fn need(name: &'static str, takes: &'static str, doc: &'static str) -> Field {
    Field { name, takes, default: None, doc }
}

const fn opt(name: &'static str, takes: &'static str, default: &'static str, doc: &'static str) -> Field {
    Field { name, takes, default: Some(default), doc }
}

const LENGTH: &str = "length in m, greater than 0";
const POINT: &str = "vector of lengths in m";
const VELOCITY: &str = "vector of velocities in m/s";
const FROZEN: &str = "`true` or `false`";
const SPREAD: Field = opt(
    "velocity_spread",
    "velocity in m/s, at least 0",
    "0",
    "Each velocity component gets a random addition, even between minus and plus this; on a `substrate` that bodies never \
     leave, along x and y alone.",
);
const SHAPE: Field = opt(
    "shape",
    "`Sphere`, `Disc` (2 dimensions only), `HollowSphere` or `Body(q)`",
    "`Sphere`; `Disc` in 2 dimensions",
    "How mass is distributed: inertia factor q = I/(m R^2) of 2/5, 1/2, 2/3, or a number q greater than 0 and at most 1. A \
     disc is 1 m thick where a density makes its mass.",
);
const MATERIAL: Field =
    need("material", "name of a material", "Decides which laws act, and the mass by its density.");

pub const SCENE: Block = Block {
    name: "the scene",
    doc: "The whole file.",
    fields: &[
        need("version", "`1`", "Version of this format."),
        opt("title", "text", "no title", "Title, as in reports."),
        opt(
            "seed",
            "whole number",
            "0",
            "Seed of everything that is random in the initial state. The same scene and seed give the same bits.",
        ),
        opt(
            "dimensions",
            "`2` or `3`",
            "3",
            "In 2 dimensions bodies move in the x-y plane and spin about z; vectors then have two components, or a third \
             that is 0, and a spin is a single number.",
        ),
        opt(
            "gravity",
            "vector of accelerations in m/s^2",
            "no gravity",
            "Acceleration of every body that is not frozen.",
        ),
        opt(
            "cell",
            "block Cell",
            "all of space, nothing periodic",
            "Bounds of space and periodic directions.",
        ),
        need("materials", "map of names to blocks Material", "Materials by name."),
        need("bodies", "list of bodies", "Bodies at the start."),
        opt(
            "walls",
            "map of names to walls",
            "no walls",
            "Walls by name. Their material decides which laws act.",
        ),
        opt(
            "substrate",
            "block Substrate",
            "no substrate",
            "A surface that bodies roll and slide on; 3 dimensions only.",
        ),
        opt(
            "contacts",
            "list of blocks Contact",
            "no laws: nothing touches",
            "Laws between pairs of materials.",
        ),
        opt(
            "conventions",
            "`\"physical\"`, `\"lammps-classic\"`, `\"lammps-granular\"`, `\"liggghts\"`, or block Conventions",
            "`\"physical\"`",
            "Choices in which engines of the field differ.",
        ),
        opt(
            "precision",
            "`Double` or `Single`",
            "`Double`",
            "Arithmetic of the contact laws; the state is always double.",
        ),
        opt(
            "impact_speed",
            "velocity in m/s, greater than 0",
            "estimated from velocities, falls and moving walls",
            "Largest impact speed to expect. Laws whose contact duration depends on the speed need it for the time step.",
        ),
        opt(
            "allow_overlap",
            FROZEN,
            "false",
            "Accepts bodies that overlap each other or a wall by more than 1 % of the smaller radius at the start. Bodies \
             from one imported file may always overlap each other.",
        ),
        opt(
            "accuracy",
            "block Accuracy",
            "what the driver says",
            "Error that the scene may have; chooses step and integrator.",
        ),
        opt("budget", "block Budget", "no bound", "Time that the run may take; chooses step and integrator."),
        opt(
            "driver",
            "block TimeStep or Event",
            "`TimeStep()`",
            "How time advances: in steps, or from collision to collision.",
        ),
        need("run", "block Run", "How long it runs."),
        opt("outputs", "list of outputs", "no outputs", "Files to write."),
        opt(
            "checkpoint",
            "block Checkpoint, or `Never`",
            "every 10 minutes of the clock",
            "When the state of the run is kept, so that it can be continued.",
        ),
        opt(
            "guards",
            "block Guards",
            "as in that block",
            "What is watched, and what happens where a limit is passed.",
        ),
        opt(
            "ledger",
            FROZEN,
            "false, or true if an output needs it",
            "Accounts for energy: elastic, and dissipated by damping and sliding.",
        ),
    ],
};

pub const CELL: Block = Block {
    name: "Cell",
    doc: "`cell: (lo: .., hi: .., periodic: ..)`. The cell confines nothing where it is not periodic: walls do that.",
    fields: &[
        need("lo", "vector of lengths in m; `-inf` where not periodic", "Lower corner."),
        need("hi", "vector of lengths in m; `inf` where not periodic", "Upper corner."),
        opt(
            "periodic",
            "two or three of `true` or `false`",
            "false in each direction",
            "Which directions are periodic.",
        ),
    ],
};

pub const MATERIAL_BLOCK: Block = Block {
    name: "Material",
    doc: "`\"glass\": (density: ..)`.",
    fields: &[opt(
        "density",
        "density in kg/m^3, greater than 0",
        "none: bodies give their mass",
        "Makes the mass of a body from its volume.",
    )],
};

const SINGLE: [Field; 8] = [
    opt(
        "id",
        "whole number from 1",
        "the smallest number that no other body has",
        "Identity in outputs; unique. It stays with the body.",
    ),
    MATERIAL,
    need("radius", LENGTH, "Radius."),
    opt(
        "mass",
        "mass in kg, greater than 0",
        "density times volume",
        "Mass, instead of the material's density.",
    ),
    need("position", POINT, "Centre."),
    opt("velocity", VELOCITY, "at rest", "Velocity."),
    opt("spin", "vector of angular velocities in rad/s; one number in 2 dimensions", "0", "Spin."),
    opt("frozen", FROZEN, "false", "The body never moves and counts as infinitely heavy."),
];

const fn with_inertia() -> [Field; 9] {
    let mut fields = [need(
        "inertia_factor",
        "number greater than 0 and at most 1",
        "q = I/(m R^2). The inertia number of Kondic 1999 is 1/q.",
    ); 9];
    let mut at = 0;
    while at < 8 {
        fields[at] = SINGLE[at];
        at += 1;
    }
    fields
}

pub const SPHERE: Block =
    Block { name: "Sphere", doc: "A homogeneous sphere, inertia factor 2/5.", fields: &SINGLE };
pub const DISC: Block = Block {
    name: "Disc",
    doc: "A homogeneous disc, inertia factor 1/2; 2 dimensions only. Its volume is that of a disc 1 m thick.",
    fields: &SINGLE,
};
pub const HOLLOW: Block = Block {
    name: "HollowSphere",
    doc: "A thin spherical shell, inertia factor 2/3. Its density is the mean of shell and void.",
    fields: &SINGLE,
};
pub const BODY: Block = Block {
    name: "Body",
    doc: "A round body with a given inertia factor and the volume of a sphere.",
    fields: &with_inertia(),
};

pub const LATTICE: Block = Block {
    name: "Lattice",
    doc: "Bodies on a lattice. Centres fill the region from `lo` to `hi`, both included; at the upper end of a periodic \
          direction only up to one spacing before the first image.",
    fields: &[
        SHAPE,
        MATERIAL,
        need("radius", LENGTH, "Radius."),
        opt(
            "kind",
            "`Cubic`, `FaceCentred` (3 dimensions only) or `Hexagonal` (2 dimensions only)",
            "`Cubic`",
            "Lattice; `Cubic` is square in 2 dimensions.",
        ),
        need("spacing", LENGTH, "Distance of nearest neighbours."),
        need("lo", POINT, "Lower corner of the region of the centres: the first centre."),
        need("hi", POINT, "Upper corner of the region of the centres."),
        opt(
            "jitter",
            "length in m, at least 0",
            "0",
            "Each coordinate is displaced at random, evenly between minus and plus this; on a `substrate` that bodies never leave, \
             x and y alone.",
        ),
        opt("velocity", VELOCITY, "at rest", "Common velocity."),
        SPREAD,
        opt("frozen", FROZEN, "false", "The bodies never move."),
    ],
};

pub const FILL: Block = Block {
    name: "Fill",
    doc: "Bodies at random places that touch neither each other, nor bodies of earlier blocks, nor walls (random \
          sequential addition, largest first). It is an error if they do not all find a place: the method cannot fill more \
          than about 0.38 of a volume, or 0.54 of an area.",
    fields: &[
        SHAPE,
        MATERIAL,
        need(
            "radius",
            "length in m, or `Uniform(min: .., max: ..)`, `Normal(mean: .., standard_deviation: ..)`, `Mixture([(radius, \
             share), ..])`",
            "Radii. `Normal` is cut at three standard deviations; shares of a `Mixture` are those of the number of bodies.",
        ),
        opt("count", "whole number from 1", "from `volume_fraction`", "How many bodies."),
        opt(
            "volume_fraction",
            "number greater than 0 and less than 1",
            "from `count`",
            "Share of the region's volume (area in 2 dimensions) instead of `count`.",
        ),
        need("lo", POINT, "Lower corner of the region."),
        need(
            "hi",
            POINT,
            "Upper corner of the region. Bodies lie wholly inside, except across a periodic direction that the region spans.",
        ),
        opt("velocity", VELOCITY, "at rest", "Common velocity."),
        SPREAD,
    ],
};

pub const UNIFORM: Block = Block {
    name: "Uniform",
    doc: "Radii evenly distributed between two.",
    fields: &[need("min", LENGTH, "Smallest radius."), need("max", LENGTH, "Largest radius.")],
};

pub const NORMAL: Block = Block {
    name: "Normal",
    doc: "Radii normally distributed, cut at three standard deviations.",
    fields: &[
        need("mean", LENGTH, "Mean radius."),
        need("standard_deviation", LENGTH, "Standard deviation; less than a third of the mean."),
    ],
};

pub const IMPORT: Block = Block {
    name: "Import",
    doc: "Bodies from a file of LAMMPS or LIGGGHTS, with ids, radii, masses, positions, velocities and spins as they stand there.",
    fields: &[
        need("file", "text", "Path, relative to the folder of the scene."),
        need("format", "`LammpsData` or `LammpsDump(frame: ..)`", "Format of the file."),
        need(
            "materials",
            "map of atom types to names of materials, as in `{ 1: \"glass\" }`",
            "Material of each atom type.",
        ),
        opt("frozen_types", "list of atom types", "none", "Types whose bodies never move."),
        SHAPE,
    ],
};

pub const LAMMPS_DUMP: Block = Block {
    name: "LammpsDump",
    doc: "A text dump with columns id, type, radius (or diameter), x, y, z; velocities, spins, masses (or densities) if \
          present. Without masses, those of the material's density.",
    fields: &[opt("frame", "`Last` or a time step", "`Last`", "Which snapshot.")],
};

const WALL_MATERIAL: Field =
    need("material", "name of a material", "Laws are those between this and the body's material.");
const MOTION: Field = opt(
    "motion",
    "`Static`, `Constant(..)`, `Sinusoidal(..)`, `Table([..])` or `Rotation(..)`",
    "`Static`",
    "How it moves; bodies do not push it.",
);

pub const PLANE: Block = Block {
    name: "Plane",
    doc: "An infinite plane.",
    fields: &[
        need("point", POINT, "A point of the plane."),
        need("normal", "vector of numbers, not 0", "Normal of any length, towards the bodies."),
        WALL_MATERIAL,
        MOTION,
    ],
};

pub const BOX: Block = Block {
    name: "Box",
    doc: "The faces of a box with the bodies inside, as infinite planes; named after the wall, as in `box.x-`. In 2 \
          dimensions there are no z faces.",
    fields: &[
        need("lo", POINT, "Lower corner."),
        need("hi", POINT, "Upper corner."),
        opt(
            "open",
            "list of `\"x-\"`, `\"x+\"`, `\"y-\"`, `\"y+\"`, `\"z-\"`, `\"z+\"`",
            "none",
            "Faces that do not exist. Those in periodic directions never do.",
        ),
        WALL_MATERIAL,
        MOTION,
    ],
};

pub const CYLINDER: Block = Block {
    name: "Cylinder",
    doc: "An infinite circular cylinder.",
    fields: &[
        need("point", POINT, "A point of the axis."),
        opt("axis", "vector of numbers, not 0", "(0, 0, 1)", "Direction of the axis; z in 2 dimensions."),
        need("radius", LENGTH, "Radius."),
        opt("inside", FROZEN, "true", "Bodies are inside (a drum) or outside (a post)."),
        WALL_MATERIAL,
        MOTION,
    ],
};

pub const CONSTANT: Block = Block {
    name: "Constant",
    doc: "Motion with constant velocity from the place described.",
    fields: &[need("velocity", VELOCITY, "Velocity.")],
};

pub const SINUSOIDAL: Block = Block {
    name: "Sinusoidal",
    doc: "Displacement `amplitude * sin(2 pi frequency t + phase)`. One of `frequency`, `angular_frequency`, `period`.",
    fields: &[
        need("amplitude", POINT, "Amplitude and direction."),
        opt("frequency", "frequency in Hz, greater than 0", "from the others", "Oscillations per second."),
        opt(
            "angular_frequency",
            "rate in rad/s, greater than 0",
            "from the others",
            "2 pi times the frequency.",
        ),
        opt("period", "time in s, greater than 0", "from the others", "Time of one oscillation."),
        opt("phase", "angle in rad", "0", "Phase at time 0."),
    ],
};

pub const ROTATION: Block = Block {
    name: "Rotation",
    doc: "Turning about a fixed axis.",
    fields: &[
        need("point", POINT, "A point of the axis."),
        opt("axis", "vector of numbers, not 0", "(0, 0, 1)", "Direction of the axis; z in 2 dimensions."),
        need("angular_velocity", "rate in rad/s", "Positive by the right-hand rule."),
    ],
};

const LAW: &str = "law, as in `Name(parameter: value, ..)`";

pub const CONTACT: Block = Block {
    name: "Contact",
    doc: "`(between: (\"glass\", \"steel\"), normal: .., tangential: ..)`: laws between two materials, for bodies and for \
          walls. `granule laws` lists the laws with their parameters.",
    fields: &[
        need("between", "two names of materials", "The pair; its order does not matter."),
        opt("normal", LAW, "none", "Repulsion along the normal."),
        opt("cohesion", LAW, "none", "Attraction along the normal; needs `normal`."),
        opt("tangential", LAW, "none", "Force in the tangent plane: friction."),
        opt("rolling", LAW, "none", "Torque against rolling."),
        opt("torsion", LAW, "none", "Torque about the normal."),
        opt(
            "collision",
            LAW,
            "none",
            "Rule of instantaneous collisions. The driver `Event` uses it and none of the laws above; `TimeStep` uses the laws \
             above and not the rule. A scene with both runs hard or soft.",
        ),
        opt(
            "contact_end",
            "`Force` or `Overlap`",
            "`Force`",
            "When a contact ends: when the normal force has fallen to zero (no attraction), or when the overlap has vanished.",
        ),
    ],
};

pub const CONVENTIONS: Block = Block {
    name: "Conventions",
    doc: "A preset with changes. Arms are `Radius` (R), `HalfOverlap` (R - overlap/2) or `FullOverlap` (R - overlap).",
    fields: &[
        opt(
            "preset",
            "`\"physical\"`, `\"lammps-classic\"`, `\"lammps-granular\"` or `\"liggghts\"`",
            "`\"physical\"`",
            "What is changed.",
        ),
        opt("pair_torque_arm", "arm", "of the preset", "Arm of the torque between two bodies."),
        opt("pair_slip_arm", "arm", "of the preset", "Arm in the slip velocity between two bodies."),
        opt("wall_torque_arm", "arm", "of the preset", "Arm of the torque at a wall."),
        opt("wall_slip_arm", "arm", "of the preset", "Arm in the slip velocity at a wall."),
        opt(
            "history_update",
            "`RotateThenIncrement`, `RotateIfTiltedThenIncrement` or `IncrementThenProject`",
            "of the preset",
            "How the tangential spring follows the turning contact.",
        ),
        opt(
            "coulomb_test",
            "`SpringThenTotal`, `Total` or `SpringOnly`",
            "of the preset",
            "Which force is held against the Coulomb limit.",
        ),
        opt(
            "coulomb_cap",
            "`Repulsive` or `Magnitude`",
            "of the preset",
            "Coulomb limit from the repulsive part or from the magnitude of the normal force.",
        ),
        opt(
            "velocity",
            "`Synchronised` or `HalfStep`",
            "of the preset",
            "Velocities in forces: of the time of the positions, or half a step earlier. Chooses the default integrator.",
        ),
    ],
};

pub const TIME_STEP: Block = Block {
    name: "TimeStep",
    doc: "The time-stepped driver.",
    fields: &[
        opt(
            "integrator",
            "`VelocityVerlet`, `ClassicVelocityVerlet`, `ContactResolved`, `Leapfrog` or `SymplecticEuler`",
            "`VelocityVerlet`; `ClassicVelocityVerlet` if the conventions say `HalfStep`",
            "Integration scheme. `ContactResolved` computes the impulse of a step in which a contact begins or ends from the \
             part in which it acts: see docs/accuracy.md for what \
             that gains and costs.",
        ),
        opt(
            "step",
            "time in s, greater than 0, or `Auto(steps_per_contact: ..)`",
            "`Auto()`",
            "Time step. A step at which the scene would be unstable is refused.",
        ),
        opt(
            "packing_limit",
            FROZEN,
            "true",
            "Refuses a step at which a dense packing of these bodies would be unstable. A loose one may be stable beyond; with \
             `false` only a step at which a single pair is unstable is refused.",
        ),
        opt(
            "skin",
            LENGTH,
            "a fifth of the mean radius",
            "Pairs closer than touching plus this are kept in lists between searches. Speed only.",
        ),
        opt("threads", "whole number from 1", "all cores", "Worker threads. Results do not depend on it."),
    ],
};

pub const AUTO: Block = Block {
    name: "Auto",
    doc: "The time step is a fraction of the shortest contact, rounded so that the run is a whole number of steps.",
    fields: &[opt("steps_per_contact", "number, at least 10", "50", "Steps in the shortest contact.")],
};

pub const RUN: Block = Block {
    name: "Run",
    doc: "`run: (duration: ..)` or `run: (steps: ..)`: one of them.",
    fields: &[
        opt("duration", "time in s, at least 0", "from `steps`", "Simulated time."),
        opt("steps", "whole number", "from `duration`", "Number of steps."),
    ],
};
