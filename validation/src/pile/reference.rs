//! What a peer answered to a case of many bodies, live or recorded.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::samples::Answers;

use crate::peers::{Frame, PeerError, PeerScene, inputs, today};

/// A peer's answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// Version of the engine, as its banner says it.
    pub version: String,
    /// Day of the run, UTC, as `2026-01-31`; may be empty.
    #[serde(default)]
    pub recorded: String,
    /// Hashes of the inputs, with blanks between: of every seed, or of the comparison step by step if there is one.
    pub inputs: String,
    /// Positions over the first steps; empty if the case compares none.
    pub positions: Vec<Frame>,
    /// What is asked of the end state, seed by seed.
    pub settled: Vec<Answers>,
    /// Mean height of the heap over rings about its axis, seed by seed \[m\]; empty if it is no heap.
    #[serde(default)]
    pub profiles: Vec<Vec<[f64; 2]>>,
}

impl Reference {
    /// Writes it, unless nothing but the day would change.
    ///
    /// # Errors
    /// The file cannot be written, or a number is not finite.
    pub fn save(&self, path: &Path, scenes: &[PeerScene]) -> Result<(), String> {
        let old = Self::load(path, scenes);
        if old.is_ok_and(|old| Self { recorded: self.recorded.clone(), ..old } == *self) {
            return Ok(());
        }
        let text = serde_json::to_string(self).map_err(|error| error.to_string())?;
        // serde_json writes NaN as null, which would come back as an error much later.
        if text.contains("null") {
            return Err(format!("{}: a number is not finite", path.display()));
        }
        std::fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
    }

    /// Reads it and verifies that it was made with the inputs of today, which are those of `scenes`.
    ///
    /// # Errors
    /// It cannot be read, or it answers other inputs.
    pub fn load(path: &Path, scenes: &[PeerScene]) -> Result<Self, String> {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let read: Self =
            serde_json::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))?;
        let today = hashes(scenes)?;
        if read.inputs != today {
            let stale = PeerError::Stale { path: path.to_path_buf(), recorded: read.inputs, today };
            return Err(stale.to_string());
        }
        Ok(read)
    }

    /// Day of a run of now.
    pub fn day() -> String {
        today()
    }
}

/// Hashes of what the engines are told, with blanks between.
///
/// # Errors
/// An engine cannot be told a scene.
pub fn hashes(scenes: &[PeerScene]) -> Result<String, String> {
    let hash = |scene: &PeerScene| Ok(inputs(scene).map_err(|error| error.to_string())?.hash());
    Ok(scenes.iter().map(hash).collect::<Result<Vec<_>, String>>()?.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases;
    use crate::translate::Target;

    #[test]
    fn refuses_answers_to_other_inputs() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("reference.json");
        let scene = cases::find("wall-bounce").unwrap().peer(Target::Liggghts).unwrap();
        let reference = Reference {
            version: "1".into(),
            recorded: Reference::day(),
            inputs: hashes(std::slice::from_ref(&scene)).unwrap(),
            positions: Vec::new(),
            settled: vec![vec![0.1, 5e-324]],
            profiles: Vec::new(),
        };
        reference.save(&path, std::slice::from_ref(&scene)).unwrap();
        assert_eq!(Reference::load(&path, std::slice::from_ref(&scene)).unwrap(), reference);
        let other = PeerScene { time_step: 2.0 * scene.time_step, ..scene.clone() };
        let refused = Reference::load(&path, &[other]).unwrap_err();
        assert!(refused.contains("stale"), "{refused}");
        assert!(Reference::load(&path, &[scene.clone(), scene]).is_err(), "another number of runs");
    }
}
