//! `granule explain`: what a run would include, what it leaves out, and why.

use std::path::Path;

use granule::Allowance;

use super::{Exit, show_load_error};
use crate::terminal;

/// Prints the plan of a scene.
pub fn explain(scene: &Path, allowance: &Allowance) -> Exit {
    match granule::load_within(scene, allowance) {
        Ok(loaded) => {
            terminal::diagnostics(&loaded.source, &loaded.warnings);
            terminal::out(&granule::explain(&loaded.plan));
            Exit::Success
        }
        Err(error) => {
            show_load_error(&error);
            Exit::Input
        }
    }
}
