//! Which convention makes how much of the difference between our run with `physical` and a peer's.
//!
//! Starting from the peer's conventions, our engine turns one convention after the other to `physical`. Each turn moves the
//! run by some vector; projected on the whole difference where that is largest, the turns add up to it exactly, and what is
//! left over is what no convention explains. Each convention turned alone shows its own size.

use granule_law_api::Conventions;
use granule_report::verdict::Cause;
use granule_report::{Block, Cell, Table};

use crate::ours::{SceneFile, frames};
use crate::peers::compare::{Comparison, Difference, Scales, compare, displacement};
use crate::peers::{Frame, PeerScene, Quantity};
use crate::translate::Target;

/// One convention: its name in a scene, what it is, and its choice in a set.
struct Field {
    name: &'static str,
    words: &'static str,
    choice: fn(&Conventions) -> String,
}

/// All of them, in the order in which they are turned.
const FIELDS: [Field; 8] = [
    Field {
        name: "pair_torque_arm",
        words: "torque arm between bodies",
        choice: |set| format!("{:?}", set.pair_torque_arm),
    },
    Field {
        name: "pair_slip_arm",
        words: "slip arm between bodies",
        choice: |set| format!("{:?}", set.pair_slip_arm),
    },
    Field {
        name: "wall_torque_arm",
        words: "torque arm at a wall",
        choice: |set| format!("{:?}", set.wall_torque_arm),
    },
    Field {
        name: "wall_slip_arm",
        words: "slip arm at a wall",
        choice: |set| format!("{:?}", set.wall_slip_arm),
    },
    Field {
        name: "history_update",
        words: "update of the tangential spring",
        choice: |set| format!("{:?}", set.history_update),
    },
    Field {
        name: "coulomb_test",
        words: "force held to the Coulomb limit",
        choice: |set| format!("{:?}", set.coulomb_test),
    },
    Field {
        name: "coulomb_cap",
        words: "normal force of the Coulomb limit",
        choice: |set| format!("{:?}", set.coulomb_cap),
    },
    Field { name: "velocity", words: "velocities in forces", choice: |set| format!("{:?}", set.velocity) },
];

/// Everything that a comparison with one peer needs.
pub struct Against<'a> {
    /// The scene.
    pub scene: &'a SceneFile,
    /// The peer.
    pub target: Target,
    /// What it was told.
    pub peer: &'a PeerScene,
    /// What it answered.
    pub answer: &'a [Frame],
    /// Scales of the differences.
    pub scales: Scales,
}

impl Against<'_> {
    /// Compares frames of ours with the peer's.
    ///
    /// # Errors
    /// The frames do not hold the same.
    pub fn compare(&self, frames: &[Frame]) -> Result<Comparison, String> {
        self.between(self.answer, frames)
    }

    /// Compares two runs on the same scales.
    ///
    /// # Errors
    /// The frames do not hold the same.
    pub fn between(&self, one: &[Frame], other: &[Frame]) -> Result<Comparison, String> {
        compare(self.peer, one, other, &self.scales, &self.peer.quantities).map_err(|error| error.to_string())
    }

    /// Our run with the peer's conventions and these changes.
    ///
    /// # Errors
    /// The scene cannot be planned or run.
    pub fn ours(&self, changes: &[(&str, &str)]) -> Result<Vec<Frame>, String> {
        frames(&self.scene.plan_under(self.target.preset(), changes)?, self.peer.dump_every, 1)
    }
}

/// One convention turned alone.
pub struct Alone {
    /// What is turned, and from what to what.
    pub words: String,
    /// Difference from our run with the peer's conventions.
    pub comparison: Comparison,
}

/// What is found out about a difference.
pub struct Explanation {
    /// Contributions where the difference is largest; with the remainder they add up to it.
    pub causes: Vec<Cause>,
    /// Each convention alone, those without any effect left out.
    pub alone: Vec<Alone>,
    /// Conventions that differ but have no effect here.
    pub idle: Vec<&'static str>,
}

/// Explains the difference of `physical` (our run with these conventions) from the peer's run at its worst place; `own` is our
/// run with the peer's conventions.
///
/// # Errors
/// A scene cannot be planned or run.
pub fn explain(
    against: &Against<'_>,
    own: &[Frame],
    physical: &[Frame],
    worst: &Difference,
) -> Result<Explanation, String> {
    let preset = Conventions::preset(against.target.preset()).ok_or("a target without a preset")?;
    let mut explanation = Explanation { causes: Vec::new(), alone: Vec::new(), idle: Vec::new() };
    let whole = displacement(against.peer, against.answer, physical, worst);
    let size = whole.iter().map(|c| c * c).sum::<f64>().sqrt();
    let along = |from: &[Frame], to: &[Frame]| {
        let moved = displacement(against.peer, from, to, worst);
        let projected = (0..3).map(|k| moved[k] * whole[k]).sum::<f64>();
        if size > 0.0 { projected / size / against.scales.get(worst.quantity) } else { 0.0 }
    };
    let differing: Vec<(&Field, String, String)> = FIELDS
        .iter()
        .map(|field| (field, (field.choice)(&preset), (field.choice)(&Conventions::PHYSICAL)))
        .filter(|(_, from, to)| from != to)
        .collect();
    let mut turned: Vec<(&str, &str)> = Vec::new();
    let mut before = own.to_vec();
    for (field, from, to) in &differing {
        let words = format!("{}: `{from}` → `{to}`", field.words);
        turned.push((field.name, to));
        let after = against.ours(&turned)?;
        let alone = against.between(own, &against.ours(&[(field.name, to)])?)?;
        let largest = alone.worst().ok_or("nothing was compared")?;
        if largest.scaled == 0.0 && after == before {
            explanation.idle.push(field.words);
            continue;
        }
        explanation.causes.push(Cause {
            cause: words.clone(),
            contribution: along(&before, &after),
            explanation: format!(
                "alone: {:.1e}, largest in {} at step {}",
                largest.scaled,
                largest.quantity.name(),
                largest.step
            ),
        });
        explanation.alone.push(Alone { words, comparison: alone });
        before = after;
    }
    Ok(explanation)
}

/// Each convention alone, quantity by quantity.
pub fn table(explanation: &Explanation, quantities: &[Quantity], whole: &Comparison) -> Block {
    let heads = quantities.iter().map(|quantity| format!(">{}", quantity.name())).collect::<Vec<_>>();
    let titles = std::iter::once("turned alone").chain(heads.iter().map(String::as_str));
    let mut table = Table::new(titles);
    let row = |words: &str, comparison: &Comparison| {
        let cells =
            comparison.largest().into_iter().map(|entry| Cell::Number { value: entry.scaled, digits: 2 });
        std::iter::once(Cell::text(words)).chain(cells).collect::<Vec<_>>()
    };
    for alone in &explanation.alone {
        table.push(row(&alone.words, &alone.comparison));
    }
    table.push(row("all of them: `physical` against the peer", whole));
    Block::Table(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases;
    use crate::peers::{Record, inputs};

    /// Calls with the recorded answer to a case.
    fn recorded(slug: &str, target: Target, look: impl FnOnce(&Against<'_>, &[Frame])) {
        let case = cases::find(slug).unwrap();
        let scene = SceneFile::read(&case.scene()).unwrap();
        let peer = case.peer(target).unwrap();
        let record = Record::load(&case.record(target), &inputs(&peer).unwrap()).unwrap();
        let scales = Scales::of(&peer, &record.frames);
        let physical = frames(&scene.plan_under("physical", &[]).unwrap(), case.dump_every, 1).unwrap();
        look(&Against { scene: &scene, target, peer: &peer, answer: &record.frames, scales }, &physical);
    }

    /// What is not explained is what differs with the peer's own conventions: round-off of the frames, 1e-12 at most.
    #[test]
    fn contributions_add_up_to_the_difference() {
        for target in Target::ALL {
            recorded("two-sphere-oblique", target, |against, physical| {
                let worst = against.compare(physical).unwrap().worst().unwrap();
                let explanation = explain(against, &against.ours(&[]).unwrap(), physical, &worst).unwrap();
                let sum: f64 = explanation.causes.iter().map(|cause| cause.contribution).sum();
                assert!(worst.scaled > 1e-3 && (sum - worst.scaled).abs() < 1e-12, "{sum} {}", worst.scaled);
                // There is no wall whose arms could matter.
                assert!(
                    ["torque arm at a wall", "slip arm at a wall"]
                        .iter()
                        .all(|arm| { explanation.idle.contains(arm) || target == Target::Liggghts })
                );
            });
        }
    }

    /// A comparison with any one convention wrong is far beyond the tolerance.
    #[test]
    fn each_convention_that_acts_would_be_noticed() {
        for (slug, changes) in [
            ("two-sphere-oblique", &[("pair_torque_arm", "HalfOverlap")][..]),
            ("two-sphere-oblique", &[("pair_slip_arm", "HalfOverlap")]),
            ("wall-oblique", &[("wall_torque_arm", "HalfOverlap")]),
            ("wall-oblique", &[("wall_slip_arm", "HalfOverlap")]),
            ("two-sphere-oblique", &[("history_update", "RotateThenIncrement")]),
            ("two-sphere-oblique", &[("coulomb_test", "SpringThenTotal")]),
            ("oblique-viscous", &[("coulomb_cap", "Repulsive")]),
            ("head-on-lsd-overlap", &[("velocity", "Synchronised")]),
        ] {
            recorded(slug, Target::LammpsClassic, |against, _| {
                let right = against.compare(&against.ours(&[]).unwrap()).unwrap().worst().unwrap();
                let wrong = against.compare(&against.ours(changes).unwrap()).unwrap().worst().unwrap();
                assert!(right.scaled <= 1e-12 && wrong.scaled > 1e-7, "{slug} {changes:?}: {wrong:?}");
            });
        }
    }
}
