//! The engine's answer to a case: live if the engine is installed, else as recorded in the repository.

use std::path::{Path, PathBuf};

use crate::cases::Case;
use crate::peers::{Engine, Frame, PeerError, PeerScene, Record, RunOptions, find_binary, inputs, run};

/// An engine's answer and where it comes from.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Which engine.
    pub engine: Engine,
    /// Its version, as its banner says it.
    pub version: String,
    /// The command that was run.
    pub command: String,
    /// Day of the recording; `None` for a live run.
    pub recorded: Option<String>,
    /// Dumped frames.
    pub frames: Vec<Frame>,
}

impl Reference {
    /// True if the engine ran just now.
    pub fn live(&self) -> bool {
        self.recorded.is_none()
    }
}

/// Where the reference of a case and law is kept.
pub fn reference_path(case: &str, law: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("cases").join(case).join(format!("{law}.reference.json"))
}

/// Runs the engine in the folder if it is installed, and reads the record otherwise.
///
/// # Errors
/// Every [`PeerError`]; a stale record is an error, and so is a failing live run: neither falls back to the other.
pub fn reference(
    case: &str,
    law: &str,
    scene: &PeerScene,
    folder: &Path,
    options: &RunOptions,
) -> Result<Reference, PeerError> {
    let files = inputs(scene)?;
    let engine = files.engine;
    if find_binary(engine).is_some() {
        let run = run(scene, folder, options)?;
        return Ok(Reference {
            engine,
            version: run.version,
            command: run.command,
            recorded: None,
            frames: run.frames,
        });
    }
    let record = Record::load(&reference_path(case, law), &files)?;
    Ok(Reference {
        engine,
        version: record.version,
        command: record.command,
        recorded: Some(record.recorded),
        frames: record.frames,
    })
}

/// Runs every law of a case live and rewrites its records; returns their paths. Records with unchanged inputs and frames
/// keep their file, date included.
///
/// # Errors
/// Every [`PeerError`]; nothing is written for the law that failed.
pub fn bless(case: &Case, folder: &Path, options: &RunOptions) -> Result<Vec<PathBuf>, PeerError> {
    let mut written = Vec::new();
    for (law, scene) in case.scenes() {
        let fresh = Record::of(&run(&scene, folder, options)?);
        let path = reference_path(case.slug, &law);
        let same = |old: Record| Record { recorded: fresh.recorded.clone(), ..old } == fresh;
        if !Record::load(&path, &inputs(&scene)?).is_ok_and(same) {
            fresh.save(&path)?;
            written.push(path);
        }
    }
    Ok(written)
}
