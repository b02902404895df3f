//! Checkpoints of a run in its output folder: the scene, the state of the driver, and where each output is.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use granule_drivers::{Driver, DriverState};
use granule_formats::FormatError;
use granule_formats::checkpoint as file;
use granule_observers::{Energy, Mark, Observers};
use granule_plan::CheckpointPlan;
use serde::{Deserialize, Serialize};

use crate::load::Source;
use crate::run::{RunError, VERSION};

/// Layout of the content; every change of what is saved gives it a new number.
const LAYOUT: u32 = 2;
/// Names are `checkpoint-`, the number of the step with enough digits to sort by name, and this.
const EXTENSION: &str = "granule";
const PREFIX: &str = "checkpoint-";

/// What a checkpoint says before the state.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Head {
    /// Version of the program that wrote it.
    pub program: String,
    /// Fingerprint of the plan.
    pub fingerprint: String,
    /// Where the scene was read: files that it imports lie beside.
    pub scene_path: PathBuf,
    /// The whole scene.
    pub scene: String,
    /// When the run was begun, as its outputs say it.
    pub created: u64,
    /// Energies at the start, if there is a ledger.
    pub start_energy: Option<Energy>,
    /// Where each output is.
    pub marks: Vec<(Option<u64>, Mark)>,
}

/// A checkpoint that has been read.
pub(crate) struct Checkpoint {
    pub head: Head,
    pub state: DriverState<'static>,
}

/// The checkpoints in a folder, the latest first.
///
/// # Errors
/// The folder cannot be read.
pub(crate) fn list(directory: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found: Vec<(u64, PathBuf)> = Vec::new();
    for entry in std::fs::read_dir(directory)? {
        let path = entry?.path();
        let step = path.file_name().and_then(|name| name.to_str()).and_then(|name| {
            name.strip_prefix(PREFIX)?.strip_suffix(EXTENSION)?.strip_suffix('.')?.parse::<u64>().ok()
        });
        found.extend(step.map(|step| (step, path)));
    }
    found.sort_by(|a, b| b.cmp(a));
    Ok(found.into_iter().map(|(_, path)| path).collect())
}

/// Reads a checkpoint.
///
/// # Errors
/// It cannot be read, is damaged, or was written by another version of the program.
pub(crate) fn read(path: &Path) -> Result<Checkpoint, String> {
    let bytes = file::read(path, LAYOUT).map_err(|error| error.to_string())?;
    let refuse = |problem: &str| format!("`{}` cannot be used: {problem}", path.display());
    let (head, rest): (Head, &[u8]) =
        postcard::take_from_bytes(&bytes).map_err(|_| refuse("what it says of the run is damaged"))?;
    if head.program != VERSION {
        return Err(refuse(&format!(
            "granule {} wrote it, this is granule {VERSION}: continue with the program that wrote it",
            head.program
        )));
    }
    match postcard::take_from_bytes(rest) {
        Ok((state, [])) => Ok(Checkpoint { head, state }),
        _ => Err(refuse("the state in it is damaged")),
    }
}

/// Removes temporary files that a killed run has left in a folder.
pub(crate) fn sweep(directory: &Path) {
    let Ok(entries) = std::fs::read_dir(directory) else { return };
    for path in entries.flatten().map(|entry| entry.path()) {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if name.starts_with(".granule-") && name.ends_with(".part") {
            // A file that cannot be removed does no harm.
            let _ = std::fs::remove_file(&path);
        }
    }
}

/// Writes the checkpoints of a run when they are due.
pub(crate) struct Keeper {
    plan: CheckpointPlan,
    directory: PathBuf,
    head: Head,
    last: Instant,
    /// Step of the last checkpoint.
    kept: Option<u64>,
}

impl Keeper {
    /// For a run that begins or goes on now.
    pub fn new(
        plan: CheckpointPlan,
        directory: &Path,
        source: &Source,
        fingerprint: &str,
        created: u64,
    ) -> Self {
        let scene_path = std::path::absolute(&source.path).unwrap_or_else(|_| source.path.clone());
        let head = Head {
            program: VERSION.to_string(),
            fingerprint: fingerprint.to_string(),
            scene_path,
            scene: source.text.clone(),
            created,
            start_energy: None,
            marks: Vec::new(),
        };
        Self { plan, directory: directory.to_path_buf(), head, last: Instant::now(), kept: None }
    }

    /// Sets the energies at the start of the run.
    pub fn start(&mut self, energy: Option<Energy>, kept: Option<u64>) {
        self.head.start_energy = energy;
        self.last = Instant::now();
        self.kept = kept;
    }

    /// The next step after `step` at which a checkpoint is due.
    pub fn next_due(&self, step: u64) -> u64 {
        self.plan.every.map_or(u64::MAX, |every| (step / every + 1).saturating_mul(every))
    }

    /// True if a checkpoint is due at this step, or on the clock.
    pub fn is_due(&self, step: u64) -> bool {
        let wall = self.plan.wall.map(|wall| Duration::try_from_secs_f64(wall).unwrap_or(Duration::MAX));
        self.plan.every.is_some_and(|every| step.is_multiple_of(every))
            || wall.is_some_and(|wall| self.last.elapsed() >= wall)
    }

    /// Keeps the state of a run, and removes the checkpoints that are too many. The path of the file.
    ///
    /// # Errors
    /// Something cannot be written; earlier checkpoints are as they were.
    pub fn keep(&mut self, driver: &dyn Driver, observers: &Observers) -> Result<PathBuf, KeepError> {
        let state = driver.save();
        let path = self.directory.join(format!("{PREFIX}{:016}.{EXTENSION}", driver.step()));
        // What the marks speak of reaches the disk before the checkpoint.
        self.head.marks = observers.marks().map_err(|error| KeepError(error.to_string()))?;
        let head = &self.head;
        file::write(&path, LAYOUT, |out| {
            let mut out = Remembering { out, error: None };
            let written = postcard::to_io(head, &mut out).and_then(|out| postcard::to_io(&state, out));
            match (written.map(|_| ()), out.error) {
                (_, Some(error)) => Err(error),
                (Err(error), None) => Err(io::Error::other(error)),
                (Ok(()), None) => Ok(()),
            }
        })
        .map_err(|error: FormatError| KeepError(error.to_string()))?;
        self.kept = Some(driver.step());
        self.last = Instant::now();
        let all = list(&self.directory).unwrap_or_default();
        for old in all.iter().filter(|old| **old != path).skip(self.plan.keep.saturating_sub(1)) {
            // One too many does no harm.
            let _ = std::fs::remove_file(old);
        }
        Ok(path)
    }

    /// Removes all checkpoints: the run is complete.
    pub fn clear(&self) {
        for path in list(&self.directory).unwrap_or_default() {
            // One that stays continues at its step and comes to the same end.
            let _ = std::fs::remove_file(path);
        }
    }
}

/// Why a checkpoint could not be written.
#[derive(Debug)]
pub(crate) struct KeepError(pub String);

impl From<KeepError> for RunError {
    fn from(error: KeepError) -> Self {
        Self::Checkpoint(error.0)
    }
}

/// Remembers why writing failed, which the encoder does not tell.
struct Remembering<'a> {
    out: &'a mut dyn Write,
    error: Option<io::Error>,
}

impl Remembering<'_> {
    fn remember<T>(&mut self, result: io::Result<T>) -> io::Result<T> {
        result.map_err(|error| {
            let kind = error.kind();
            self.error.get_or_insert(error);
            kind.into()
        })
    }
}

impl Write for Remembering<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let result = self.out.write(bytes);
        self.remember(result)
    }

    fn flush(&mut self) -> io::Result<()> {
        let result = self.out.flush();
        self.remember(result)
    }
}
