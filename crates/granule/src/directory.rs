//! The folder that a run writes into.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use granule_observers::MANIFEST;
use granule_plan::Plan;
use granule_report::Manifest;

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

/// Makes the folder, and refuses one that holds something else unless `force` says to replace it.
pub(crate) fn prepare(directory: &Path, plan: &Plan, force: bool) -> Result<(), DirectoryError> {
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
    std::fs::create_dir_all(directory).map_err(system(directory))
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
