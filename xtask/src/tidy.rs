//! The project's rules about its own files, as code.

use std::path::Path;
use std::process::Command;

use crate::command::{Error, cargo, run};
use crate::{directions, files};

mod catalog;
mod text;

/// What the top level holds besides packages.
pub const TOP_LEVEL: [&str; 17] = [
    ".cargo/",
    ".ci/",
    ".gitignore",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "Cargo.lock",
    "Cargo.toml",
    "GLOSSARY.md",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "clippy.toml",
    "crates/",
    "docs/",
    "laws/",
    "rustfmt.toml",
];

/// Folders of the top level that are packages themselves.
pub const TOP_PACKAGES: [&str; 4] = ["figures/", "tests/", "validation/", "xtask/"];

/// Runs every check, the format included.
///
/// # Errors
/// Some rule is broken; the message names each file and what to do.
pub fn tidy(root: &Path) -> Result<(), Error> {
    let mut problems = problems(root)?;
    let format = run(Command::new(cargo()).args(["fmt", "--all", "--check"]).current_dir(root));
    if format.is_err() {
        problems.push("the format differs from rustfmt's; run `cargo fmt --all`".to_string());
    }
    if problems.is_empty() {
        println!("tidy: no problem");
        return Ok(());
    }
    Err(Error::new(format!("tidy: {} problem(s)\n{}", problems.len(), problems.join("\n"))))
}

/// Every broken rule but the format, one message each. Spawns nothing but `cargo metadata`, so that tests may call it.
///
/// # Errors
/// The project cannot be read.
pub fn problems(root: &Path) -> Result<Vec<String>, Error> {
    let files = files::project(root)?;
    let mut problems = top_level(root)?;
    for path in &files {
        problems.extend(text::check(
            path,
            &std::fs::read(root.join(path)).map_err(|e| Error::file(Path::new(path), &e))?,
        ));
    }
    problems.extend(catalog::check(root, &files)?);
    problems.extend(directions::check(root)?);
    Ok(problems)
}

fn top_level(root: &Path) -> Result<Vec<String>, Error> {
    let entries = files::entries(root)?;
    let allowed = || TOP_LEVEL.iter().chain(&TOP_PACKAGES);
    let build = |name: &str| name.starts_with("target") && name.ends_with('/');
    // A linked work tree has a file `.git`; an archive has none.
    let unknown = entries
        .iter()
        .filter(|name| !build(name) && name.trim_end_matches('/') != ".git")
        .filter(|name| !allowed().any(|allowed| allowed == name))
        .map(|name| {
            format!("{name}: does not belong to the top level; move it, or allow it in xtask/src/tidy.rs")
        });
    let missing = allowed()
        .filter(|allowed| !entries.iter().any(|name| name == *allowed))
        .map(|allowed| format!("{allowed}: is missing from the top level"));
    Ok(unknown.chain(missing).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_top_level_is_the_list() {
        let folder = tempfile::tempdir().unwrap();
        let write = |path: &str| files::write(&folder.path().join(path), "x").unwrap();
        for path in TOP_LEVEL.iter().chain(&TOP_PACKAGES) {
            write(&if path.ends_with('/') { format!("{path}x") } else { (*path).to_string() });
        }
        write("target/x");
        write(".git");
        assert_eq!(top_level(folder.path()).unwrap(), Vec::<String>::new());
        write("notes.txt");
        std::fs::remove_file(folder.path().join("README.md")).unwrap();
        let problems = top_level(folder.path()).unwrap();
        assert!(
            problems[0].starts_with("notes.txt: does not belong")
                && problems[1].starts_with("README.md: is missing")
        );
        assert_eq!(problems.len(), 2);
    }
}
