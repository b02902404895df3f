//! Scene and registry to a plan: what will run, and every problem at once.
//!
//! [`build`] turns a scene into a [`Plan`]: bodies and walls in place, laws compiled for the pairs of materials that can
//! meet, a time step that is stable. The plan holds only what the scene requires; [`explain()`] says what that is and why.

mod allowance;
mod bodies;
mod build;
mod checkpoint;
mod checks;
mod conventions;
mod event;
mod explain;
mod fingerprint;
mod guards;
mod impacts;
mod laws;
mod limits;
mod model;
mod outputs;
mod place;
mod resolution;
mod schedule;
mod single;
mod speed;
mod substrate;
mod walls;

pub use allowance::{Allowance, DataFiles, memory_estimate};
pub use build::{build, build_within};
pub use explain::explain;
pub use fingerprint::fingerprint;
pub use limits::{Limits, limits};
pub use model::{
    BodyTable, CheckpointPlan, CollisionPlan, Composition, Decision, Dimensions, EventPlan, Guard, Guards,
    MaterialPlan, OutputKind, OutputPlan, Partner, Plan, Precision, SERIES, Scheme, Search, Slides,
    StagePlan, SubstrateMaterial, SubstratePlan, TimeStepPlan, WallPlan,
};
pub use place::{FEWEST_STEPS, Place, map_name};
pub use single::SingleImpact;
