//! Scene and registry to a plan: what will run, and every problem at once

mod model;

pub use model::{
    BodyTable, Composition, Decision, Dimensions, MaterialPlan, OutputKind, OutputPlan, Partner, Plan, Precision, SERIES,
    Scheme, Search, StagePlan, TimeStepPlan, WallPlan,
};
