//! The files of the project.

use std::path::{Path, PathBuf};

use crate::command::Error;

/// Root of the workspace: of the cargo that runs this, or of the build if the program was started directly.
pub fn root() -> PathBuf {
    let own = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    let own = own.unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")));
    let is_root = |folder: &&Path| folder.join("Cargo.toml").is_file() && folder.join("laws").is_dir();
    own.ancestors().find(is_root).map_or_else(|| own.clone(), Path::to_path_buf)
}

/// A text file.
///
/// # Errors
/// It cannot be read.
pub fn read(path: &Path) -> Result<String, Error> {
    std::fs::read_to_string(path).map_err(|error| Error::file(path, &error))
}

/// Writes a text file and the folders that lead to it.
///
/// # Errors
/// It cannot be written.
pub fn write(path: &Path, text: &str) -> Result<(), Error> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|error| Error::file(folder, &error))?;
    }
    std::fs::write(path, text).map_err(|error| Error::file(path, &error))
}

/// Names in a folder, sorted; folders end with a slash.
///
/// # Errors
/// The folder cannot be read.
pub fn entries(folder: &Path) -> Result<Vec<String>, Error> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|error| Error::file(folder, &error))? {
        let entry = entry.map_err(|error| Error::file(folder, &error))?;
        let kind = entry.file_type().map_err(|error| Error::file(&entry.path(), &error))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        names.push(if kind.is_dir() { format!("{name}/") } else { name });
    }
    names.sort();
    Ok(names)
}

/// Every file below `root` that belongs to the project, as paths relative to it with forward slashes, sorted. Build
/// folders and `.git` are not entered.
///
/// # Errors
/// A folder cannot be read.
pub fn project(root: &Path) -> Result<Vec<String>, Error> {
    let mut files = Vec::new();
    let mut folders = vec![String::new()];
    while let Some(folder) = folders.pop() {
        for name in entries(&root.join(&folder))? {
            let path = format!("{folder}{name}");
            let skipped = path == ".git/"
                || path == ".git"
                || (folder.is_empty() && name.starts_with("target") && name.ends_with('/'));
            if skipped {
                continue;
            }
            if path.ends_with('/') {
                folders.push(path);
            } else {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_the_project_without_build_folders() {
        let folder = tempfile::tempdir().unwrap();
        for path in
            ["a/b.rs", "target/x", "target-2/x", ".git/config", ".cargo/config.toml", "a/target/keep.rs"]
        {
            write(&folder.path().join(path), "x").unwrap();
        }
        assert_eq!(project(folder.path()).unwrap(), [".cargo/config.toml", "a/b.rs", "a/target/keep.rs"]);
        assert_eq!(entries(folder.path()).unwrap(), [".cargo/", ".git/", "a/", "target-2/", "target/"]);
    }

    #[test]
    fn root_is_the_workspace() {
        assert!(root().join("xtask/src/files.rs").is_file());
    }
}
