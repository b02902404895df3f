//! What is watched during a run.

use granule_scene::{GuardChoice, Spanned};

use crate::build::Builder;
use crate::model::{Guard, Guards, Plan};

/// Fills in the guards of the plan.
pub(crate) fn guards(builder: &mut Builder<'_>, plan: &mut Plan) {
    let block = &builder.scene.guards;
    let choice = |asked: &Option<Spanned<GuardChoice>>, default: Guard| match asked
        .as_ref()
        .map(|asked| asked.value)
    {
        None => default,
        Some(GuardChoice::Off) => Guard::Off,
        Some(GuardChoice::Warn(limit)) => Guard::Warn(limit),
        Some(GuardChoice::Stop(limit)) => Guard::Stop(limit),
    };
    let overlap = if builder.scene.allow_overlap { Guard::Off } else { Guard::Stop(1.0) };
    let energy = choice(&block.energy, if plan.ledger { Guard::Warn(0.1) } else { Guard::Off });
    let soft = plan.event.is_none();
    plan.guards = Guards {
        overlap: if soft { choice(&block.overlap, overlap) } else { Guard::Off },
        travel: if soft { choice(&block.travel, Guard::Warn(1.0)) } else { Guard::Off },
        lost: choice(&block.lost, Guard::Warn(1.0)),
        energy,
    };
    let hard = [("overlap", &block.overlap), ("travel", &block.travel)];
    let void: Vec<_> = hard
        .into_iter()
        .filter(|_| !soft)
        .filter_map(|(name, asked)| Some((name, asked.as_ref()?.span.clone())))
        .collect();
    for (name, span) in void {
        builder.warning(
            span,
            format!("`{name}` has no effect"),
            "hard bodies neither overlap nor pass through each other",
        );
    }
    let Guards { overlap, travel, lost, energy } = plan.guards;
    let words: Vec<String> = [("overlap", overlap), ("travel", travel), ("lost", lost), ("energy", energy)]
        .into_iter()
        .filter_map(|(name, guard)| match guard {
            Guard::Off => None,
            Guard::Warn(limit) => Some(format!("{name} beyond {limit} is said")),
            Guard::Stop(limit) => Some(format!("{name} beyond {limit} stops the run")),
        })
        .collect();
    let why = if words.is_empty() {
        "none but for numbers that are not finite".to_string()
    } else {
        words.join(", ")
    };
    builder.decide_one("guards", !words.is_empty(), why);
}
