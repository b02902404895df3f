//! The folder that a run writes into.

use std::ffi::OsStr;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

use granule_observers::MANIFEST;
use granule_plan::Plan;
use granule_report::Manifest;

use crate::checkpoint;

/// Why a folder cannot take the outputs of a run.
#[derive(Debug)]
pub enum DirectoryError {
    /// It holds the outputs of another plan.
    OtherPlan {
        /// The folder.
        directory: PathBuf,
        /// Fingerprint of the plan whose outputs lie there.
        found: String,
        /// Fingerprint of this plan.
        wanted: String,
    },
    /// It holds files of the names that the run would write, but no manifest that says where they come from.
    ForeignFile(PathBuf),
    /// It holds a run that was interrupted and can be continued.
    Unfinished {
        /// The folder.
        directory: PathBuf,
    },
    /// Another run is writing into it.
    InUse {
        /// The folder.
        directory: PathBuf,
    },
    /// It cannot be made or read.
    System {
        /// The folder or file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
}

impl std::fmt::Display for DirectoryError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::OtherPlan { directory, found, wanted } => write!(
                f,
                "{} holds outputs of another scene (plan {found}; this one is {wanted}): choose another folder with \
                 --output, or replace them with --force",
                directory.display()
            ),
            Self::ForeignFile(path) => write!(
                f,
                "{} exists and was not written by a run of this program: choose another folder with --output, or \
                 replace it with --force",
                path.display()
            ),
            Self::Unfinished { directory } => write!(
                f,
                "{0} holds a run that was interrupted: continue it with `granule resume {0}`, or begin anew with --force, \
                 which removes its checkpoints",
                directory.display()
            ),
            Self::InUse { directory } => {
                write!(f, "another run is writing into {}: wait for its end", directory.display())
            }
            Self::System { path, error } => write!(f, "cannot write to {}: {error}", path.display()),
        }
    }
}

impl std::error::Error for DirectoryError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::System { error, .. } => Some(error),
            _ => None,
        }
    }
}

/// The folder for a scene if the user names none: `out/<name of the scene>` under the current folder.
pub fn default_directory(scene: &Path) -> PathBuf {
    Path::new("out").join(scene.file_stem().unwrap_or(OsStr::new("scene")))
}

/// As long as it exists, no other run writes into the folder.
pub(crate) struct Lock(#[expect(dead_code, reason = "the lock ends when the file is closed")] Option<File>);

/// Locks a folder; the lock ends with the process, however that ends.
pub(crate) fn lock(directory: &Path) -> Result<Lock, DirectoryError> {
    let path = directory.to_path_buf();
    let file = match File::open(directory) {
        Ok(file) => file,
        // Not every system opens folders.
        Err(_) if !cfg!(unix) && directory.is_dir() => return Ok(Lock(None)),
        Err(error) => return Err(DirectoryError::System { path, error }),
    };
    match file.try_lock() {
        Ok(()) => Ok(Lock(Some(file))),
        Err(TryLockError::WouldBlock) => Err(DirectoryError::InUse { directory: path }),
        // Some file systems have no locks.
        Err(TryLockError::Error(_)) => Ok(Lock(None)),
    }
}

/// Makes the folder, refuses one that holds something else, or a run that can be continued, unless `force` says to replace
/// it, and locks it.
pub(crate) fn prepare(directory: &Path, plan: &Plan, force: bool) -> Result<Lock, DirectoryError> {
    let system = |path: &Path| {
        let path = path.to_path_buf();
        move |error| DirectoryError::System { path, error }
    };
    if !force {
        let manifest = directory.join(MANIFEST);
        match std::fs::read_to_string(&manifest) {
            Ok(text) => match Manifest::from_json(&text) {
                Ok(found) if found.plan_fingerprint == plan.fingerprint => {}
                Ok(found) => {
                    return Err(DirectoryError::OtherPlan {
                        directory: directory.to_path_buf(),
                        found: found.plan_fingerprint,
                        wanted: plan.fingerprint.clone(),
                    });
                }
                Err(_) => return Err(DirectoryError::ForeignFile(manifest)),
            },
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                let taken = plan.outputs.iter().map(|output| directory.join(&output.path));
                if let Some(path) = taken.into_iter().find(|path| path.exists()) {
                    return Err(DirectoryError::ForeignFile(path));
                }
            }
            Err(error) if error.kind() == std::io::ErrorKind::InvalidData => {
                return Err(DirectoryError::ForeignFile(manifest));
            }
            Err(error) => return Err(system(&manifest)(error)),
        }
    }
    std::fs::create_dir_all(directory).map_err(system(directory))?;
    let lock = lock(directory)?;
    let checkpoints = checkpoint::list(directory).map_err(system(directory))?;
    if !checkpoints.is_empty() && !force {
        return Err(DirectoryError::Unfinished { directory: directory.to_path_buf() });
    }
    for path in checkpoints {
        std::fs::remove_file(&path).map_err(system(&path))?;
    }
    Ok(lock)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_folder_is_named_after_the_scene() {
        assert_eq!(default_directory(Path::new("a/pile.ron")), Path::new("out/pile"));
        assert_eq!(default_directory(Path::new("/")), Path::new("out/scene"));
    }
}
