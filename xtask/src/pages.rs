//! `cargo xtask pages`: the pages of docs/ that are made from what the program knows about itself.

use std::path::Path;
use std::process::Command;

use crate::command::{Error, cargo, run};

/// Builds the generator with all laws and rewrites the generated pages under `root`.
///
/// # Errors
/// The project does not build, or a page cannot be written.
pub fn pages(root: &Path) -> Result<(), Error> {
    let mut command = Command::new(cargo());
    command.args(["run", "--quiet", "--package", "granule-tests", "--bin", "pages"]);
    run(command.current_dir(root))
}
