//! `cargo xtask figures`: the figures of the papers, computed; `cargo xtask atlas`: the stability atlas.

use std::path::Path;
use std::process::Command;

use crate::command::{Error, cargo, run};

/// Builds the program that makes the figures in release and runs it; `words` are its options.
///
/// # Errors
/// An option is unknown, or a figure cannot be made; the exit code is that of the program.
pub fn figures(root: &Path, words: &[String]) -> Result<(), Error> {
    let mut command = Command::new(cargo());
    command.args(["run", "--quiet", "--release", "--package", "granule-figures", "--"]);
    run(command.args(words).current_dir(root))
}

/// Computes the stability atlas; `words` are its options.
///
/// # Errors
/// As for [`figures`].
pub fn atlas(root: &Path, words: &[String]) -> Result<(), Error> {
    let all: Vec<String> = std::iter::once("atlas".to_string()).chain(words.iter().cloned()).collect();
    figures(root, &all)
}
