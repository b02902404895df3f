//! The commands, one file each.

pub mod advise;
pub mod calibrate;
pub mod check;
pub mod compare_models;
pub mod explain;
pub mod law;
pub mod laws;
pub mod resume;
pub mod run;
pub mod selftest;
pub mod trade;

use std::process::ExitCode;

use granule::prelude::LoadError;

use crate::terminal;

/// How a command ended. The numbers are part of the interface; `granule --help` lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Done.
    Success = 0,
    /// The scene has errors or cannot be read, or there is no such law.
    Input = 1,
    /// The run failed, or a self-test did.
    Run = 3,
    /// Stopped because its time was over.
    OutOfTime = 4,
    /// Stopped by a signal.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// Shows why a scene cannot be loaded.
pub fn show_load_error(error: &LoadError) {
    match error {
        LoadError::Scene { source, diagnostics } => {
            terminal::diagnostics(source, diagnostics);
            terminal::error(&format!("{}: {}", source.path.display(), terminal::count(diagnostics)));
        }
        other => terminal::error(&other.to_string()),
    }
}
