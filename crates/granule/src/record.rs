//! The manifest of a run.

use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use granule_observers::MANIFEST;
use granule_plan::Plan;
use granule_report::{Build, Counts, Machine, Manifest, OutputFile, Phase, SceneRecord, rfc3339};

use crate::load::Source;
use crate::run::{RunError, VERSION};

/// What does not change during a run.
pub(crate) struct Recorder {
    path: PathBuf,
    directory: PathBuf,
    fingerprint: String,
    plan: String,
    bodies: u64,
    scene: Option<SceneRecord>,
    machine: Machine,
    started: String,
}

/// What changes.
pub(crate) struct Record<'a> {
    pub outcome: &'a str,
    pub threads: usize,
    pub wall: Duration,
    /// Name, time and number of calls.
    pub phases: [(&'static str, Duration, u64); 4],
    pub steps: u64,
    pub time: f64,
    pub contacts: u64,
    /// Path and kind.
    pub files: Vec<(&'a Path, &'static str)>,
    pub result_hash: Option<String>,
}

impl Recorder {
    pub(crate) fn new(plan: &Plan, source: Option<&Source>, directory: &Path, started: SystemTime) -> Self {
        Self {
            path: directory.join(MANIFEST),
            directory: directory.to_path_buf(),
            fingerprint: plan.fingerprint.clone(),
            plan: granule_plan::explain(plan),
            bodies: plan.bodies.len() as u64,
            scene: source.map(|source| SceneRecord::new(source.path.display().to_string(), &source.text)),
            machine: Machine::detect(),
            started: rfc3339(started),
        }
    }

    /// Writes the manifest, replacing an earlier one in a single stroke.
    pub(crate) fn write(&self, record: &Record<'_>) -> Result<(), RunError> {
        let manifest = Manifest {
            program: format!("granule {VERSION}"),
            build: Build::current(),
            plan_fingerprint: self.fingerprint.clone(),
            plan: self.plan.clone(),
            scene: self.scene.clone(),
            machine: self.machine.clone(),
            threads: record.threads,
            started: self.started.clone(),
            duration_s: record.wall.as_secs_f64(),
            phases: record
                .phases
                .iter()
                .map(|(name, time, count)| Phase {
                    name: (*name).to_string(),
                    seconds: time.as_secs_f64(),
                    count: *count,
                })
                .collect(),
            counts: Counts { bodies: self.bodies, contacts: record.contacts, steps: record.steps },
            simulated_time_s: record.time,
            outcome: record.outcome.to_string(),
            outputs: record.files.iter().filter_map(|(path, kind)| self.file(path, kind)).collect(),
            result_hash: record.result_hash.clone(),
        };
        let json = manifest.to_json().map_err(|error| RunError::Manifest(error.to_string()))?;
        granule_formats::atomic::write(&self.path, json.as_bytes())
            .map_err(|error| RunError::Manifest(error.to_string()))
    }

    /// The entry of a file, if it exists.
    fn file(&self, path: &Path, kind: &str) -> Option<OutputFile> {
        let bytes = std::fs::metadata(path).ok()?.len();
        let path = path.strip_prefix(&self.directory).unwrap_or(path).display().to_string();
        Some(OutputFile { path, kind: kind.to_string(), bytes })
    }
}
