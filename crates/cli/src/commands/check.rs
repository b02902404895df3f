//! `granule check`: all problems of scenes at once.

use std::path::{Path, PathBuf};

use granule::Allowance;

use super::{Exit, show_load_error};
use crate::{terminal, text};

/// Checks each scene; the exit code says whether all of them could run.
pub fn check(scenes: &[PathBuf], allowance: &Allowance) -> Exit {
    let mut exit = Exit::Success;
    for scene in scenes {
        if !check_one(scene, allowance) {
            exit = Exit::Input;
        }
    }
    exit
}

fn check_one(scene: &Path, allowance: &Allowance) -> bool {
    match granule::load_within(scene, allowance) {
        Ok(loaded) => {
            terminal::diagnostics(&loaded.source, &loaded.warnings);
            let plan = &loaded.plan;
            let (bodies, steps) = (plan.bodies.len(), plan.driver.steps);
            let warnings = if loaded.warnings.is_empty() {
                String::new()
            } else {
                format!("; {}", terminal::count(&loaded.warnings))
            };
            terminal::out(&format!(
                "{}: ok: {bodies} bodies, {steps} steps of {} s{warnings}\n",
                scene.display(),
                text::number(text::rounded(plan.driver.step)),
            ));
            true
        }
        Err(error) => {
            show_load_error(&error);
            false
        }
    }
}
