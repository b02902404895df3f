//! What an engine is made of.

use std::sync::Arc;

use granule_geometry::{Cell, Wall};
use granule_law_api::{Collision, CollisionRule};

use crate::fault::RuleFault;

/// One body at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyInput {
    /// Stable identity.
    pub id: u32,
    /// Index into the materials.
    pub material: u16,
    /// Radius R \[m\].
    pub radius: f64,
    /// Mass \[kg\].
    pub mass: f64,
    /// Inertia factor q = I/(m R²).
    pub inertia_factor: f64,
    /// Centre \[m\].
    pub position: [f64; 3],
    /// Velocity \[m/s\].
    pub velocity: [f64; 3],
    /// Spin \[rad/s\].
    pub spin: [f64; 3],
    /// Never moves.
    pub frozen: bool,
}

/// A wall and the rules at it.
#[derive(Clone, Debug)]
pub struct WallInput {
    /// A plane or cylinder that is fixed, moves steadily, oscillates or follows a table; its surface may turn in its place.
    pub wall: Wall,
    /// Rule for each material, as an index into [`Setup::rules`]; `None` where bodies pass.
    pub rules: Vec<Option<usize>>,
}

/// Everything that an engine needs.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Bodies, in the order in which they are numbered.
    pub bodies: Vec<BodyInput>,
    /// Walls.
    pub walls: Vec<WallInput>,
    /// Collision rules.
    pub rules: Vec<Arc<dyn CollisionRule>>,
    /// Rule of each pair of materials, `pairs[a * materials + b]`, symmetric; `None` where bodies pass through each other.
    pub pairs: Vec<Option<usize>>,
    /// Number of materials.
    pub materials: usize,
    /// Periodic cell.
    pub cell: Cell,
    /// Gravity \[m/s²\].
    pub gravity: [f64; 3],
    /// Contact duration t_c \[s\]: a collision of a body that collided less than this ago loses no energy along the normal
    /// (Luding and McNamara 1998). 0: every collision is inelastic; only for scenes in which none is.
    pub contact_duration: f64,
}

/// Why an engine cannot be set up, or a run cannot go on.
#[derive(Clone, Debug, PartialEq)]
pub enum EventError {
    /// A wall of a motion that flights are not known for.
    Wall {
        /// Index of the wall.
        wall: usize,
        /// What it does.
        what: &'static str,
    },
    /// The periodic cell is too small for one image of a pair.
    Cell(String),
    /// Something about the input that no scene may have.
    Input(String),
    /// Two bodies, or a body and a wall, overlap more than round-off at the start.
    Overlap {
        /// Identity of the body.
        id: u32,
        /// The other: an identity, or a wall by its index.
        other: Result<u32, usize>,
        /// Depth \[m\].
        overlap: f64,
    },
    /// A position or velocity is not finite.
    NotFinite {
        /// Identity of the body.
        id: u32,
        /// Simulated time \[s\].
        time: f64,
    },
    /// A collision rule at fault.
    Rule {
        /// Index into [`Setup::rules`].
        rule: usize,
        /// What was wrong with it.
        fault: RuleFault,
        /// What it was given.
        seen: Collision,
        /// Identity of a body.
        id: u32,
        /// What it met: an identity, or a wall by its index.
        other: Result<u32, usize>,
        /// Simulated time \[s\].
        time: f64,
    },
    /// A saved state does not fit the setup; the part that does not.
    Saved(&'static str),
    /// Events follow each other without end: bodies are crushed.
    Stalled {
        /// Simulated time \[s\].
        time: f64,
        /// Identity of a body that takes part.
        id: u32,
        /// Events within `span`.
        events: u64,
        /// Time in which they happened \[s\].
        span: f64,
    },
}

impl std::fmt::Display for EventError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Wall { wall, what } => {
                write!(
                    f,
                    "wall {wall} {what}: the event-driven driver knows walls that move without turning, or turn in place"
                )
            }
            Self::Cell(reason) | Self::Input(reason) => f.write_str(reason),
            Self::Overlap { id, other: Ok(other), overlap } => {
                write!(f, "bodies {id} and {other} overlap by {overlap:e} m: hard bodies cannot")
            }
            Self::Overlap { id, other: Err(wall), overlap } => {
                write!(f, "body {id} overlaps wall {wall} by {overlap:e} m: hard bodies cannot")
            }
            Self::Rule { rule, fault, id, other, time, .. } => {
                let other = match other {
                    Ok(id) => format!("body {id}"),
                    Err(wall) => format!("wall {wall}"),
                };
                let what = match fault {
                    RuleFault::Panicked(message) => format!("panicked: {message}"),
                    RuleFault::NotFinite => "gave an impulse that is not finite".to_string(),
                };
                write!(f, "collision rule {rule}, of body {id} and {other} at time {time:e} s, {what}")
            }
            Self::Saved(what) => {
                write!(f, "the saved state does not fit the scene, or is damaged: {what}")
            }
            Self::NotFinite { id, time } => {
                write!(f, "the motion of body {id} is not finite at time {time:e} s")
            }
            Self::Stalled { time, id, events, span } => write!(
                f,
                "{events} events within {span:e} s at time {time:e} s, about body {id}: bodies are crushed between others that do \
                 not give way, which hard bodies cannot follow"
            ),
        }
    }
}

impl std::error::Error for EventError {}
