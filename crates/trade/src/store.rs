//! Runs that are done, one line each, so that an interrupted trade goes on where it stopped.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::TradeError;
use crate::measure::Sample;

/// Name of the file in the output folder.
const FILE: &str = "runs.jsonl";

#[derive(Serialize, Deserialize)]
struct Line {
    key: String,
    sample: Sample,
}

/// Samples by the fingerprint of their plan and what was measured.
pub(crate) struct Store {
    file: File,
    known: BTreeMap<String, Sample>,
}

impl Store {
    /// Opens or begins the file. A last line that was cut off is dropped.
    pub fn open(folder: &Path) -> Result<Self, TradeError> {
        let failed = |what: &str, error: std::io::Error| {
            TradeError::File(format!("{}: {what}: {error}", folder.join(FILE).display()))
        };
        std::fs::create_dir_all(folder).map_err(|error| failed("cannot be made", error))?;
        let path = folder.join(FILE);
        let text = match std::fs::read(&path) {
            Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(failed("cannot be read", error)),
        };
        let mut known = BTreeMap::new();
        for line in text.lines() {
            if let Ok(line) = serde_json::from_str::<Line>(line) {
                known.insert(line.key, line.sample);
            }
        }
        let mut file = OpenOptions::new()
            .append(true)
            .create(true)
            .open(&path)
            .map_err(|error| failed("cannot be written", error))?;
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n").map_err(|error| failed("cannot be written", error))?;
        }
        Ok(Self { file, known })
    }

    pub fn get(&self, key: &str) -> Option<&Sample> {
        self.known.get(key)
    }

    pub fn put(&mut self, key: String, sample: Sample) -> Result<(), TradeError> {
        let line = Line { key, sample };
        let failed = |error: String| TradeError::File(format!("{FILE} cannot be written: {error}"));
        let mut text = serde_json::to_string(&line).map_err(|error| failed(error.to_string()))?;
        text.push('\n');
        self.file.write_all(text.as_bytes()).map_err(|error| failed(error.to_string()))?;
        self.known.insert(line.key, line.sample);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(wall: f64) -> Sample {
        Sample { values: vec![vec![1.5]], scales: vec![2.0], wall, steps: 3, step: 0.5, bytes_per_body: 8.0 }
    }

    #[test]
    fn what_was_written_is_found_again_whatever_comes_after() {
        let folder = tempfile::tempdir().unwrap();
        let mut store = Store::open(folder.path()).unwrap();
        store.put("a".into(), sample(0.25)).unwrap();
        drop(store);
        let path = folder.path().join(FILE);
        let mut text = std::fs::read_to_string(&path).unwrap();
        text.push_str("{\"key\":\"b\",\"sam");
        std::fs::write(&path, text).unwrap();
        let mut store = Store::open(folder.path()).unwrap();
        assert_eq!(store.get("a"), Some(&sample(0.25)));
        assert_eq!(store.get("b"), None);
        store.put("c".into(), sample(1.0)).unwrap();
        drop(store);
        let store = Store::open(folder.path()).unwrap();
        assert!(store.get("a").is_some() && store.get("c").is_some());
    }
}
