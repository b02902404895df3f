//! References recorded from live runs, for machines without the engines.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use super::{Frame, InputFiles, PeerError, PeerRun};

/// Version of the file format.
const FORMAT: u32 = 1;

/// A live run as kept in the repository. Numbers are written with as many digits as bring the same bits back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Version of the file format.
    pub format: u32,
    /// `lammps` or `liggghts`.
    pub engine: String,
    /// The engine's version, as its banner says it.
    pub version: String,
    /// Day of the run, UTC, as `2026-01-31`.
    pub recorded: String,
    /// The command that was run.
    pub command: String,
    /// Hash of the inputs.
    pub inputs: String,
    /// Dumped frames.
    pub frames: Vec<Frame>,
}

impl Record {
    /// A record of a live run of today.
    pub fn of(run: &PeerRun) -> Self {
        Self {
            format: FORMAT,
            engine: run.engine.name().to_owned(),
            version: run.version.clone(),
            recorded: today(),
            command: run.command.clone(),
            inputs: run.inputs.clone(),
            frames: run.frames.clone(),
        }
    }

    /// Writes the record, one frame a line, replacing a former one only when complete.
    ///
    /// # Errors
    /// [`PeerError::File`], or [`PeerError::Record`] if a number is not finite.
    pub fn save(&self, path: &Path) -> Result<(), PeerError> {
        let bad = |error: serde_json::Error| PeerError::Record(path.to_path_buf(), error.to_string());
        let head = Self { frames: Vec::new(), ..self.clone() };
        let head = serde_json::to_string_pretty(&head).map_err(bad)?;
        let head = head.strip_suffix("[]\n}").unwrap_or(&head);
        let mut lines = Vec::with_capacity(self.frames.len());
        for frame in &self.frames {
            let line = serde_json::to_string(frame).map_err(bad)?;
            // serde_json writes NaN as null, which would come back as an error much later.
            if line.contains("null") {
                return Err(PeerError::Record(path.to_path_buf(), "a number is not finite".into()));
            }
            lines.push(line);
        }
        let text = format!("{head}[\n{}\n]\n}}\n", lines.join(",\n"));
        let file = |error| PeerError::File(path.to_path_buf(), error);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(file)?;
        }
        let unfinished = path.with_extension("unfinished");
        std::fs::write(&unfinished, text).map_err(file)?;
        std::fs::rename(&unfinished, path).map_err(file)
    }

    /// Reads a record and verifies that it was made with the inputs of today.
    ///
    /// # Errors
    /// [`PeerError::File`], [`PeerError::Record`] if it cannot be understood, [`PeerError::Stale`] if its inputs differ.
    pub fn load(path: &Path, files: &InputFiles) -> Result<Self, PeerError> {
        let text =
            std::fs::read_to_string(path).map_err(|error| PeerError::File(path.to_path_buf(), error))?;
        let bad = |what: String| PeerError::Record(path.to_path_buf(), what);
        let record: Self = serde_json::from_str(&text).map_err(|error| bad(error.to_string()))?;
        if record.format != FORMAT {
            return Err(bad(format!("format {} is not {FORMAT}", record.format)));
        }
        if record.engine != files.engine.name() {
            return Err(bad(format!("it is of {}, not of {}", record.engine, files.engine.name())));
        }
        let today = files.hash();
        if record.inputs != today {
            return Err(PeerError::Stale { path: path.to_path_buf(), recorded: record.inputs, today });
        }
        Ok(record)
    }
}

/// Today's date, UTC, as `2026-01-31`.
pub fn today() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |age| age.as_secs());
    date(seconds / 86_400)
}

/// Gregorian date of a day counted from 1970-01-01.
fn date(day: u64) -> String {
    // Years are counted from March, so that the leap day ends a year; eras have 400 years.
    let day = day + 719_468;
    let (era, day) = (day / 146_097, day % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (month, next_year) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    format!("{:04}-{month:02}-{day:02}", era * 400 + year + next_year)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::Engine;

    fn record(inputs: &InputFiles) -> Record {
        let frame =
            Frame { step: 3, ids: vec![1], position: vec![[0.1, 5e-324, -1.0 / 3.0]], ..Frame::default() };
        Record {
            format: FORMAT,
            engine: "lammps".into(),
            version: "29 Sep 2021".into(),
            recorded: today(),
            command: "lmp".into(),
            inputs: inputs.hash(),
            frames: vec![frame.clone(), frame],
        }
    }

    fn files() -> InputFiles {
        InputFiles {
            engine: Engine::Lammps,
            script_name: "in.lammps",
            script: "run 1".into(),
            bodies: String::new(),
        }
    }

    #[test]
    fn comes_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("case").join("reference.json");
        let record = record(&files());
        record.save(&path).unwrap();
        assert_eq!(Record::load(&path, &files()).unwrap(), record);
    }

    #[test]
    fn refuses_other_inputs_other_engines_and_nan() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("reference.json");
        let mut record = record(&files());
        record.save(&path).unwrap();
        let changed = InputFiles { script: "run 2".into(), ..files() };
        assert!(matches!(Record::load(&path, &changed), Err(PeerError::Stale { .. })));
        let other = InputFiles { engine: Engine::Liggghts, ..files() };
        assert!(matches!(Record::load(&path, &other), Err(PeerError::Record(..))));
        record.frames[0].position[0][1] = f64::NAN;
        assert!(matches!(record.save(&path), Err(PeerError::Record(..))));
    }

    #[test]
    fn dates() {
        for (day, text) in
            [(0, "1970-01-01"), (11_016, "2000-02-29"), (11_017, "2000-03-01"), (20_780, "2026-11-23")]
        {
            assert_eq!(date(day), text);
        }
    }
}
