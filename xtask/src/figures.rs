//! `cargo xtask figures`: the figures of the papers, computed.

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
