//! When the state of a run is kept.

use granule_scene::CheckpointChoice;

use crate::build::Builder;
use crate::model::{CheckpointPlan, Plan};

/// Interval on the clock if the scene gives none \[s\].
const WALL: f64 = 600.0;

/// Fills in the checkpoints of the plan.
pub(crate) fn checkpoint(builder: &mut Builder<'_>, plan: &mut Plan) {
    let asked = builder.scene.checkpoint.as_ref();
    plan.checkpoint = match asked {
        Some(CheckpointChoice::Never) => None,
        None => Some(CheckpointPlan { every: None, wall: Some(WALL), keep: 2 }),
        Some(CheckpointChoice::Kept { every, wall, keep }) => {
            let every =
                every.as_ref().map(|every| crate::outputs::interval(builder, every, plan.driver.step));
            let wall = wall.or(every.is_none().then_some(WALL));
            Some(CheckpointPlan { every, wall, keep: *keep as usize })
        }
    };
    let why = match &plan.checkpoint {
        None => "the scene asks for none: a run that is stopped cannot be continued".to_string(),
        Some(checkpoint) => {
            let every = checkpoint.every.map(|steps| format!("every {steps} steps"));
            let wall = checkpoint.wall.map(|wall| format!("every {wall} s on the clock"));
            let when: Vec<String> = [every, wall].into_iter().flatten().collect();
            format!(
                "{} and when the run is stopped; the last {} are kept until it is complete",
                when.join(", "),
                checkpoint.keep
            )
        }
    };
    builder.decide_one("checkpoints", plan.checkpoint.is_some(), why);
}
