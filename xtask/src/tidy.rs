//! The project's rules about its own files, as code.

use std::path::Path;
use std::process::Command;

use crate::command::{Error, cargo, run};
use crate::{directions, files};

mod catalog;
mod text;

/// What `git clone` may show at the top level, apart from build folders.
pub const TOP_LEVEL: [&str; 18] = [
    ".cargo/",
    ".ci/",
    ".git/",
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
pub const TOP_PACKAGES: [&str; 3] = ["tests/", "validation/", "xtask/"];

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
    let unknown = files::entries(root)?.into_iter().filter(|name| {
        !(TOP_LEVEL.contains(&name.as_str())
            || TOP_PACKAGES.contains(&name.as_str())
            || name == ".git"
            || name.starts_with("target") && name.ends_with('/'))
    });
    Ok(unknown
        .map(|name| {
            format!("{name}: does not belong to the top level; move it, or allow it in xtask/src/tidy.rs")
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_unknown_names_at_the_top() {
        let folder = tempfile::tempdir().unwrap();
        for path in ["Cargo.toml", "notes.txt", "target/x", "rust-toolchain.toml"] {
            files::write(&folder.path().join(path), "x").unwrap();
        }
        let problems = top_level(folder.path()).unwrap();
        assert_eq!(problems.len(), 2);
        assert!(problems[0].starts_with("notes.txt: "));
    }
}
