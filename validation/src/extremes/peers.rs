//! What an engine does with an extreme.

use std::path::Path;

use super::{Change, Right, trials};
use crate::ours::plan_text;
use crate::peers::{Engine, PeerError, PeerScene, attempt, find_binary, inputs};
use crate::translate::{Target, translate};

/// How an engine takes an extreme.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// The extreme cannot be told to it.
    Untold,
    /// It is not installed here.
    Missing,
    /// The right answer, or a refusal where that is right.
    Right,
    /// A warning, and then whatever follows.
    Warns,
    /// It stops with a message where there is an answer.
    Stops,
    /// No end in the time that it had.
    Hangs,
    /// A wrong answer without a word.
    Wrong,
}

impl Class {
    /// Name in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Untold => "-",
            Self::Missing => "not installed",
            Self::Right => "right",
            Self::Warns => "warns",
            Self::Stops => "dies",
            Self::Hangs => "no end",
            Self::Wrong => "wrong silently",
        }
    }
}

/// What an engine did.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// In a word.
    pub class: Class,
    /// In words and numbers.
    pub what: String,
}

impl Answer {
    fn of(class: Class, what: impl Into<String>) -> Self {
        Self { class, what: what.into() }
    }
}

/// What an engine does with a case: the worst of its scenes.
pub fn answer(case: &str, engine: Engine, folder: &Path) -> Answer {
    let Some(trial) = trials::all().find(|trial| trial.case == case) else {
        return Answer::of(Class::Untold, trials::why_not(case));
    };
    if find_binary(engine).is_none() {
        return Answer::of(Class::Missing, "");
    }
    let mut worst = Answer::of(Class::Untold, "");
    for (index, (text, change)) in (trial.scenes)().into_iter().enumerate() {
        let folder = folder.join(format!("{}-{index}", engine.name()));
        let found = match one(&text, &change, engine, &folder, &trial.right) {
            Ok(answer) => answer,
            Err(why) => Answer::of(Class::Untold, why),
        };
        if found.class > worst.class || index == 0 {
            worst = found;
        }
    }
    worst
}

/// An engine on one scene.
fn one(text: &str, change: &Change, engine: Engine, folder: &Path, right: &Right) -> Result<Answer, String> {
    let plan = plan_text(text)?;
    let mut reasons = String::new();
    let mut told: Option<PeerScene> = None;
    for target in Target::ALL.into_iter().filter(|target| target.engine() == engine) {
        match translate(&plan, target) {
            Ok(scene) => {
                told = Some(scene);
                break;
            }
            Err(why) => reasons = why.to_string(),
        }
    }
    let Some(mut scene) = told else { return Err(reasons) };
    scene.dump_every = scene.steps;
    if let Some(change) = change.scene {
        change(&mut scene);
    }
    let mut files = inputs(&scene).map_err(|error| error.to_string())?;
    if let Some(change) = change.files {
        change(&mut files);
    }
    let finished = match attempt(&files, folder) {
        Ok(finished) => finished,
        Err(PeerError::Failed(_, _, tail)) => {
            let class =
                if matches!(right, Right::Refuses | Right::Ends) { Class::Right } else { Class::Stops };
            return Ok(Answer::of(class, message(&tail)));
        }
        Err(PeerError::Timeout(_, limit, _)) => {
            return Ok(Answer::of(Class::Hangs, format!("no end within {} s", limit.as_secs_f64())));
        }
        Err(other) => return Err(other.to_string()),
    };
    let warnings: Vec<&str> =
        finished.warnings.iter().map(String::as_str).filter(|line| !usual(line)).collect();
    let warned = warnings.first().map(|line| message(line));
    let frames = finished.frames;
    let complete = frames.last().is_some_and(|frame| frame.ids.len() == scene.bodies.len());
    let verdict = match right {
        Right::Ends => Ok("runs to its end".to_string()),
        _ if !complete => Err("bodies are lost".to_string()),
        Right::Refuses => Err("runs as if nothing were wrong".to_string()),
        Right::Warns if warned.is_some() => Ok(String::new()),
        Right::Warns => Err("runs without a warning".to_string()),
        Right::Gives(judge) => judge(&scene, &frames),
    };
    Ok(match (verdict, warned) {
        (Ok(_), Some(warning)) if matches!(right, Right::Warns) => Answer::of(Class::Right, warning),
        (Ok(what), _) => Answer::of(Class::Right, what),
        (Err(what), Some(warning)) => Answer::of(Class::Warns, format!("{warning}; {what}")),
        (Err(what), None) => Answer::of(Class::Wrong, what),
    })
}

/// Warnings that say nothing about the extreme.
fn usual(line: &str) -> bool {
    [
        "Communication cutoff",
        "communication cutoff",
        "Using 'neigh_modify",
        "Proc sub-domain size",
        "No fixes",
    ]
    .iter()
    .any(|known| line.contains(known))
}

/// The line of a message that says what is wrong, without the place in the engine's source.
fn message(tail: &str) -> String {
    let lines = || tail.lines().map(str::trim);
    let line = lines()
        .find(|line| line.starts_with("ERROR"))
        .or_else(|| lines().find(|line| line.contains("WARNING")))
        .or_else(|| lines().find(|line| line.chars().any(char::is_alphanumeric)))
        .unwrap_or("no message");
    let end = line.find(" (../").or_else(|| line.find(" (src")).unwrap_or(line.len());
    line[..end].chars().take(160).collect::<String>().replace('|', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_the_words_of_the_engine() {
        let tail =
            "Setting up\nERROR: Lost atoms: original 2 current 1 (../thermo.cpp:438)\nLast command: run 10";
        assert_eq!(message(tail), "ERROR: Lost atoms: original 2 current 1");
        assert_eq!(message("\nkilled"), "killed");
        assert!(usual("WARNING: Communication cutoff is 0. No ghost atoms"));
    }
}
