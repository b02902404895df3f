//! Continues a run from the last checkpoint in its output folder.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use granule_drivers::Driver;
use granule_formats::Provenance;
use granule_observers::{MANIFEST, Observers};
use granule_plan::{Allowance, Plan};
use granule_report::Manifest;

use crate::checkpoint::{self, Checkpoint, Head};
use crate::directory::{self, DirectoryError};
use crate::load::{LoadError, Source, load_text_within};
use crate::progress::Progress;
use crate::run::{Run, RunError, RunSummary};

/// How a run is continued. None of this changes its results.
pub struct ResumeOptions<'a> {
    /// Worker threads; what the scene says if absent.
    pub threads: Option<usize>,
    /// What the scene may use.
    pub allowance: Allowance,
    /// Who is told how far the run is.
    pub progress: &'a mut dyn Progress,
    /// Set it, from any thread, to end the run early.
    pub stop: &'a AtomicBool,
    /// Ends the run when it has taken so long.
    pub max_time: Option<Duration>,
}

/// Why a run cannot be continued.
#[derive(Debug)]
pub enum ResumeError {
    /// There is no checkpoint in the folder; why, as far as it is known.
    None {
        /// The folder.
        directory: PathBuf,
        /// How the run there has ended, if its manifest tells.
        outcome: Option<String>,
    },
    /// No checkpoint can be used; the reasons, the latest first.
    Unusable(Vec<String>),
    /// The run has failed, after it was continued or because its folder cannot be used.
    Run(RunError),
}

impl std::fmt::Display for ResumeError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::None { directory, outcome: Some(outcome) } => write!(
                f,
                "{} has no checkpoint to continue from; its manifest says: {outcome}",
                directory.display()
            ),
            Self::None { directory, outcome: None } => {
                write!(f, "{} has no checkpoint and no manifest: no run was begun there", directory.display())
            }
            Self::Unusable(reasons) => f.write_str(&reasons.join("\n")),
            Self::Run(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for ResumeError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Run(error) => Some(error),
            _ => None,
        }
    }
}

/// A run that was taken up again and has not gone on yet.
struct Ready {
    head: Head,
    source: Source,
    plan: Arc<Plan>,
    driver: Box<dyn Driver>,
    observers: Observers,
    step: u64,
}

/// Continues the run whose outputs lie in a folder, from its last checkpoint, or from the one before if that cannot be used.
/// Outputs, and the hash of the result, are then those of a run that was never interrupted, byte for byte.
///
/// # Errors
/// See [`ResumeError`].
pub fn resume(directory: &Path, options: ResumeOptions<'_>) -> Result<RunSummary, ResumeError> {
    let failed = |error| ResumeError::Run(RunError::Directory(error));
    let system = |error| failed(DirectoryError::System { path: directory.to_path_buf(), error });
    let lock = directory::lock(directory).map_err(failed)?;
    let all = checkpoint::list(directory).map_err(system)?;
    if all.is_empty() {
        let manifest = std::fs::read_to_string(directory.join(MANIFEST)).ok();
        let outcome =
            manifest.and_then(|text| Manifest::from_json(&text).ok()).map(|manifest| manifest.outcome);
        return Err(ResumeError::None { directory: directory.to_path_buf(), outcome });
    }
    let mut reasons = Vec::new();
    for path in &all {
        match ready(path, directory, &options) {
            Ok(ready) => {
                for reason in &reasons {
                    options.progress.warn(&format!("{reason}; the checkpoint before is taken"));
                }
                options.progress.warn(&format!("continued at step {} from {}", ready.step, path.display()));
                clean(directory, &ready.plan);
                return go(ready, directory, options, lock).map_err(ResumeError::Run);
            }
            Err(reason) => reasons.push(reason),
        }
    }
    Err(ResumeError::Unusable(reasons))
}

/// Takes a run up again; what is wrong, if it cannot be.
fn ready(path: &Path, directory: &Path, options: &ResumeOptions<'_>) -> Result<Ready, String> {
    let Checkpoint { head, state } = checkpoint::read(path)?;
    let refuse = |problem: String| format!("`{}` cannot be used: {problem}", path.display());
    let loaded = load_text_within(&head.scene_path, head.scene.clone(), &options.allowance)
        .map_err(|error: LoadError| refuse(error.to_string()))?;
    if loaded.plan.fingerprint != head.fingerprint {
        return Err(refuse(format!(
            "its run had the plan {}, but its scene now gives {}: files that the scene reads have changed, or laws of another \
             version are linked",
            head.fingerprint, loaded.plan.fingerprint
        )));
    }
    let plan = Arc::new(loaded.plan);
    let step = state.step();
    let driver = granule_drivers::restore(Arc::clone(&plan), options.threads, state)
        .map_err(|error| refuse(error.to_string()))?;
    let provenance = Provenance::new(crate::run::VERSION, &plan.fingerprint, head.created).map_err(refuse)?;
    let mut observers =
        Observers::from_plan(&plan, directory, &provenance).map_err(|error| refuse(error.to_string()))?;
    observers.resume(&head.marks, &driver.view()).map_err(|error| refuse(error.to_string()))?;
    Ok(Ready { head, source: loaded.source, plan, driver, observers, step })
}

/// Removes what a killed run has left half-written beside its outputs.
fn clean(directory: &Path, plan: &Plan) {
    checkpoint::sweep(directory);
    for output in &plan.outputs {
        if let Some(folder) = directory.join(&output.path).parent() {
            checkpoint::sweep(folder);
        }
    }
}

fn go(
    ready: Ready,
    directory: &Path,
    options: ResumeOptions<'_>,
    lock: directory::Lock,
) -> Result<RunSummary, RunError> {
    let Ready { head, source, plan, driver, observers, .. } = ready;
    let mut run = Run::new(plan, driver, observers, Some(&source), directory, head.created, lock);
    run.go_on(head.start_energy, options.progress, options.stop, options.max_time)
}
