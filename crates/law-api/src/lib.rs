//! What a contact law is.
//!
//! A contact *composition* is a list of stages, one per [`Slot`]. A stage runs over a [`ContactChunk`]: the contacts of
//! one pair of materials, at most [`CHUNK`] of them, laid out as columns. The dynamic call is paid once per chunk and
//! stage; inside, a law is an ordinary element-wise loop that the compiler vectorises.
//!
//! A law crate depends on this crate alone. It implements [`ContactLaw`] for a unit type, calls [`register_law!`], and
//! passes [`testing::conformance`]. This crate knows nothing about engines, scenes or files.

mod chunk;
mod collision;
mod collision_pair;
mod context;
mod conventions;
mod dispatch;
mod info;
mod oracle;
pub mod oscillator;
mod params;
pub mod probe;
mod real;
mod registry;
mod substrate;
pub mod testing;

pub use chunk::{CHUNK, ContactChunk, EnergyColumns, Stage};
pub use collision::{Collision, CollisionEntry, CollisionImpulse, CollisionLaw, CollisionRule};
pub use collision_pair::{Collided, CollidingBody, collide};
pub use context::{ContactEnd, DurationRule, NormalSummary, PairContext, Span};
pub use conventions::{Arm, Conventions, CoulombCap, CoulombTest, HistoryUpdate, VelocityRule};
pub use dispatch::vectorised;
pub use granule_units::Dimension;
pub use info::{Columns, HistoryColumn, LawInfo, Parity, Slot, Source};
pub use oracle::{Impact, ImpactOutcome, NormalOracle, ObliqueImpact, Oracle, TangentialOracle, TimeScale};
pub use params::{Bound, Form, LawError, ParamSpec, Params, ValueRange};
pub use real::Real;
pub use registry::{API_VERSION, ContactLaw, LawEntry, Registry, RegistryError, nearest};
pub use substrate::{
    Footing, SubstrateContact, SubstrateContext, SubstrateEntry, SubstrateInfo, SubstrateLaw, SubstrateStage,
    SurfaceFriction,
};

#[doc(hidden)]
pub mod reexport {
    pub use inventory;
}
