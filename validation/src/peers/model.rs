//! What both engines must be told, and nothing else: SI units throughout.

use std::collections::{BTreeMap, BTreeSet};

use super::{PeerError, Quantity};

/// An engine to compare with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Engine {
    /// LAMMPS with its GRANULAR package (binary `lmp`).
    Lammps,
    /// LIGGGHTS-PUBLIC (binary `liggghts`).
    Liggghts,
}

impl Engine {
    /// Name in reports and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lammps => "lammps",
            Self::Liggghts => "liggghts",
        }
    }

    /// Name of the executable.
    pub fn binary(self) -> &'static str {
        match self {
            Self::Lammps => "lmp",
            Self::Liggghts => "liggghts",
        }
    }
}

/// A sphere.
#[derive(Clone, Debug, PartialEq)]
pub struct PeerBody {
    /// Positive and unique.
    pub id: u64,
    /// Type, counted from 1.
    pub kind: usize,
    /// Diameter (m).
    pub diameter: f64,
    /// Density (kg/m³).
    pub density: f64,
    /// Centre (m).
    pub position: [f64; 3],
    /// Velocity (m/s).
    pub velocity: [f64; 3],
    /// Angular velocity (rad/s).
    pub angular_velocity: [f64; 3],
}

impl PeerBody {
    /// Radius (m), halved as the engines do.
    pub fn radius(&self) -> f64 {
        0.5 * self.diameter
    }

    /// Mass (kg), in the engines' order of multiplication.
    pub fn mass(&self) -> f64 {
        let r = self.radius();
        4.0 * std::f64::consts::PI / 3.0 * r * r * r * self.density
    }
}

/// Elastic properties of a type; LIGGGHTS wants them per type for `hertz`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeerMaterial {
    /// Young's modulus (Pa).
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
}

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// First coordinate.
    X,
    /// Second coordinate.
    Y,
    /// Third coordinate.
    Z,
}

impl Axis {
    /// Index of the coordinate.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Letter in engine inputs.
    pub fn letter(self) -> &'static str {
        ["x", "y", "z"][self.index()]
    }
}

/// On which side of a wall the bodies are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Bodies have the larger coordinate, as above a floor.
    Above,
    /// Bodies have the smaller coordinate, as below a lid.
    Below,
}

/// A plane perpendicular to an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct PeerWall {
    /// Normal axis.
    pub axis: Axis,
    /// Coordinate of the plane (m).
    pub position: f64,
    /// Where the bodies are.
    pub side: Side,
    /// Velocity of the surface within its plane, along one axis, or zero (m/s).
    pub velocity: [f64; 3],
    /// Type of the wall, counted from 1; the law of a body on it is `laws[(body type, wall type)]`.
    pub kind: usize,
}

/// LAMMPS `gran/hooke`, `gran/hooke/history` or `gran/hertz/history`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClassicStyle {
    /// Linear, no tangential spring.
    HookeNoHistory,
    /// Linear with tangential spring.
    HookeHistory,
    /// Hertz with tangential spring.
    HertzHistory,
}

/// Arguments of the classic LAMMPS styles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClassicLaw {
    /// Which style.
    pub style: ClassicStyle,
    /// Kn: (N/m), Hertz (Pa).
    pub kn: f64,
    /// Kt: (N/m), Hertz (Pa).
    pub kt: f64,
    /// gamma_n: (1/s), Hertz (1/(s m)).
    pub gamma_n: f64,
    /// gamma_t: (1/s), Hertz (1/(s m)).
    pub gamma_t: f64,
    /// Friction coefficient.
    pub friction: f64,
    /// `dampflag`.
    pub tangential_damping: bool,
    /// `limit_damping`: no attractive normal force.
    pub limit_damping: bool,
}

/// Normal model of LAMMPS `pair granular`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GranularNormal {
    /// `hooke`, stiffness (N/m).
    Hooke(f64),
    /// `hertz`, stiffness (Pa).
    Hertz(f64),
}

/// Normal damping of LAMMPS `pair granular`, with its coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GranularDamping {
    /// `velocity` (kg/s).
    Velocity(f64),
    /// `mass_velocity` (1/s).
    MassVelocity(f64),
    /// `viscoelastic` (1/(s m)).
    Viscoelastic(f64),
    /// `tsuji`, the restitution asked for (LAMMPS delivers another one, see its pull request 5113).
    Tsuji(f64),
}

/// Tangential model of LAMMPS `pair granular`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GranularTangential {
    /// `linear_nohistory`.
    LinearNoHistory,
    /// `linear_history`, stiffness (N/m).
    LinearHistory(f64),
    /// `mindlin`, stiffness (Pa).
    Mindlin(f64),
}

/// Arguments of LAMMPS `pair granular` for one pair of types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GranularLaw {
    /// Normal model.
    pub normal: GranularNormal,
    /// Normal damping.
    pub damping: GranularDamping,
    /// Tangential model.
    pub tangential: GranularTangential,
    /// Tangential damping as a multiple of the normal damping.
    pub tangential_damping: f64,
    /// Friction coefficient.
    pub friction: f64,
    /// `limit_damping`: no attractive normal force.
    pub limit_damping: bool,
}

/// Normal model of LIGGGHTS `pair gran`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LiggghtsNormal {
    /// `hooke/stiffness`: (N/m) and (1/s).
    HookeStiffness {
        /// Normal stiffness (N/m).
        kn: f64,
        /// Tangential stiffness (N/m).
        kt: f64,
        /// Normal damping (1/s).
        gamma_n: f64,
        /// Tangential damping (1/s).
        gamma_t: f64,
    },
    /// `hertz/stiffness`: (Pa) and (1/(s m)), all times the contact radius.
    HertzStiffness {
        /// Normal stiffness (Pa).
        kn: f64,
        /// Tangential stiffness (Pa).
        kt: f64,
        /// Normal damping (1/(s m)).
        gamma_n: f64,
        /// Tangential damping (1/(s m)).
        gamma_t: f64,
    },
    /// `hooke/hysteresis`: stiffness of loading from the materials at a characteristic velocity of 1 m/s, no adhesion, no
    /// dashpot.
    HookeHysteresis {
        /// Largest stiffness of unloading over that of loading, `coefficientMaxElasticStiffness`.
        ratio: f64,
        /// `coefficientPlasticityDepth`.
        depth: f64,
    },
    /// `hertz`: from the materials.
    Hertz {
        /// Coefficient of restitution.
        restitution: f64,
    },
}

/// Tangential model of LIGGGHTS `pair gran`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LiggghtsTangential {
    /// `no_history`.
    NoHistory,
    /// `history`.
    History,
}

/// Arguments of LIGGGHTS `pair gran` for one pair of types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiggghtsLaw {
    /// Normal model.
    pub normal: LiggghtsNormal,
    /// Tangential model.
    pub tangential: LiggghtsTangential,
    /// Friction coefficient.
    pub friction: f64,
    /// `tangential_damping on` (the engine's default) or `off`.
    pub tangential_damping: bool,
    /// `limitForce on`: no attractive normal force.
    pub limit_force: bool,
}

/// Law of one pair of types, in the words of the engine that has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PeerLaw {
    /// LAMMPS `pair gran/*` and `fix wall/gran`.
    Classic(ClassicLaw),
    /// LAMMPS `pair granular` and `fix wall/gran granular`.
    Granular(GranularLaw),
    /// LIGGGHTS `pair gran` and `fix wall/gran`.
    Liggghts(LiggghtsLaw),
}

impl PeerLaw {
    /// The engine that has this law.
    pub fn engine(&self) -> Engine {
        match self {
            Self::Classic(_) | Self::Granular(_) => Engine::Lammps,
            Self::Liggghts(_) => Engine::Liggghts,
        }
    }
}

/// How an engine is to work. All but `always_anew` changes its speed, and its results by round-off only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tuning {
    /// Ranks along x, y and z; `None` leaves x and y to the engine, with one rank along z.
    pub ranks: Option<[usize; 3]>,
    /// Largest diameters of the classes of sizes that LAMMPS searches separately (m); empty for one class.
    pub size_classes: Vec<f64>,
    /// Neighbour lists are made anew in every step. LIGGGHTS forgets the spring of a contact that has ended only when it
    /// makes its lists anew: two bodies that touch again before that begin with the old spring.
    pub always_anew: bool,
}

impl Tuning {
    /// Last argument of `neigh_modify delay 0 every 1 check`.
    pub(super) fn check(&self) -> &'static str {
        if self.always_anew { "no" } else { "yes" }
    }

    /// Arguments of `processors`.
    pub(super) fn processors(&self) -> String {
        self.ranks.map_or("* * 1".to_owned(), |[x, y, z]| format!("{x} {y} {z}"))
    }
}

/// Everything that one run of one engine is told.
#[derive(Clone, Debug, PartialEq)]
pub struct PeerScene {
    /// One line for the head of the files.
    pub title: String,
    /// At least one; any order.
    pub bodies: Vec<PeerBody>,
    /// Ids of bodies that never move; they must be at rest.
    pub frozen: Vec<u64>,
    /// Lower corner of the box (m).
    pub lower: [f64; 3],
    /// Upper corner of the box (m).
    pub upper: [f64; 3],
    /// Periodic directions; the others are open, and a body that leaves there ends the run with an error.
    pub periodic: [bool; 3],
    /// Acceleration of gravity (m/s²).
    pub gravity: [f64; 3],
    /// One entry per type; `None` where no law asks for it.
    pub materials: Vec<Option<PeerMaterial>>,
    /// Law of each pair of types `(i, j)`, `i <= j`. Every pair that can meet must be there: engines mix unset pairs wrongly.
    pub laws: BTreeMap<(usize, usize), PeerLaw>,
    /// Plane walls.
    pub walls: Vec<PeerWall>,
    /// Time step (s).
    pub time_step: f64,
    /// Steps of the one `run` command.
    pub steps: u64,
    /// Steps of an additional `run` before it, for timing only: a second run command recomputes forces with full-step
    /// velocities, so its trajectory is not comparable and no dump is allowed.
    pub warm_up: u64,
    /// Steps between dumps, a divisor of `steps`; 0 for no dump.
    pub dump_every: u64,
    /// What to dump.
    pub quantities: Vec<Quantity>,
    /// Skin of the neighbour lists (m).
    pub skin: f64,
    /// How the engine works.
    pub tuning: Tuning,
}

impl PeerScene {
    /// Number of types.
    pub fn kinds(&self) -> usize {
        self.materials.len()
    }

    /// Law of two types in either order.
    pub fn law(&self, i: usize, j: usize) -> Option<&PeerLaw> {
        self.laws.get(&(i.min(j), i.max(j)))
    }

    /// Types that at least one body has, ascending.
    pub fn body_kinds(&self) -> Vec<usize> {
        (1..=self.kinds()).filter(|kind| self.bodies.iter().any(|body| body.kind == *kind)).collect()
    }

    /// Checks what an engine would not, or would only say in passing, and returns the engine of the laws.
    ///
    /// # Errors
    /// [`PeerError::Scene`] with the first thing that is wrong.
    pub fn check(&self) -> Result<Engine, PeerError> {
        let fail = |what: String| Err(PeerError::Scene(what));
        if self.bodies.is_empty() {
            return fail("it has no bodies".into());
        }
        if self.title.contains(['\n', '\r']) {
            return fail("its title has more than one line".into());
        }
        let mut ids: Vec<u64> = self.bodies.iter().map(|body| body.id).collect();
        ids.sort_unstable();
        if ids[0] == 0 || ids.windows(2).any(|pair| pair[0] == pair[1]) {
            return fail("body ids must be positive and unique".into());
        }
        for body in &self.bodies {
            let numbers = [body.position, body.velocity, body.angular_velocity].concat();
            if !(body.diameter > 0.0 && body.density > 0.0 && body.mass().is_finite())
                || numbers.iter().any(|value| !value.is_finite())
            {
                return fail(format!("body {} has an invalid size, density or state", body.id));
            }
            if body.kind == 0 || body.kind > self.kinds() {
                return fail(format!("body {} has the unknown type {}", body.id, body.kind));
            }
            for k in 0..3 {
                if !(self.lower[k] <= body.position[k] && body.position[k] < self.upper[k]) {
                    return fail(format!("body {} starts outside the box", body.id));
                }
            }
        }
        let mut rank: Vec<usize> = (0..self.bodies.len()).collect();
        rank.sort_unstable_by_key(|&place| self.bodies[place].id);
        for id in &self.frozen {
            let found = rank.binary_search_by_key(id, |&place| self.bodies[place].id);
            match found.ok().map(|at| &self.bodies[rank[at]]) {
                None => return fail(format!("the frozen body {id} does not exist")),
                Some(body) if body.velocity != [0.0; 3] || body.angular_velocity != [0.0; 3] => {
                    return fail(format!("the frozen body {id} is not at rest"));
                }
                Some(_) => {}
            }
        }
        self.check_numbers()?;
        self.check_laws()
    }

    fn check_numbers(&self) -> Result<(), PeerError> {
        let fail = |what: &str| Err(PeerError::Scene(what.into()));
        if !(self.time_step > 0.0 && self.time_step.is_finite() && self.skin > 0.0 && self.skin.is_finite()) {
            return fail("time step and skin must be positive");
        }
        if self.gravity.iter().any(|value| !value.is_finite()) {
            return fail("gravity is not finite");
        }
        if self.steps == 0 || (self.dump_every > 0 && !self.steps.is_multiple_of(self.dump_every)) {
            return fail("steps must be a positive multiple of the dump interval");
        }
        if self.warm_up > 0 && self.dump_every > 0 {
            return fail("a run with a warm-up is for timing and cannot be dumped");
        }
        if self.dump_every > 0 && self.quantities.is_empty() {
            return fail("a dump needs at least one quantity");
        }
        for wall in &self.walls {
            let moving = (0..3).filter(|k| wall.velocity[*k] != 0.0).count();
            let finite = wall.position.is_finite() && wall.velocity.iter().all(|value| value.is_finite());
            if wall.velocity[wall.axis.index()] != 0.0 || moving > 1 || !finite {
                return fail("a wall of the engines moves only within its plane, along one axis");
            }
            if self.periodic[wall.axis.index()] {
                return fail("a wall stands across a periodic direction");
            }
            if wall.kind == 0 || wall.kind > self.kinds() {
                return fail("a wall has an unknown type");
            }
        }
        Ok(())
    }

    fn check_laws(&self) -> Result<Engine, PeerError> {
        let kinds = self.body_kinds();
        let frozen: BTreeSet<u64> = self.frozen.iter().copied().collect();
        let mobile: BTreeSet<usize> =
            self.bodies.iter().filter(|body| !frozen.contains(&body.id)).map(|body| body.kind).collect();
        for (position, i) in kinds.iter().enumerate() {
            // Bodies that never move need no law among themselves, nor at a wall.
            let walls = self.walls.iter().map(|wall| wall.kind).filter(|_| mobile.contains(i));
            let bodies = kinds[position..].iter().copied();
            let bodies = bodies.filter(|j| mobile.contains(i) || mobile.contains(j) || j == i);
            let partners = bodies.chain(walls);
            for (rank, j) in partners.enumerate() {
                // The first partner is the type itself; a single body of it never meets another one.
                let still = rank == 0 && !mobile.contains(i);
                let alone = rank == 0 && self.bodies.iter().filter(|body| body.kind == *i).count() == 1;
                if !alone && !still && self.law(*i, j).is_none() {
                    return Err(PeerError::Scene(format!("types {i} and {j} can meet but have no law")));
                }
            }
        }
        let mut engines = self.laws.values().map(PeerLaw::engine);
        let engine = engines.next().ok_or_else(|| PeerError::Scene("it has no laws".into()))?;
        if engines.any(|other| other != engine) {
            return Err(PeerError::Scene("it mixes laws of two engines".into()));
        }
        Ok(engine)
    }
}
