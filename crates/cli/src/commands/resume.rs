//! `granule resume`: continues a run that was interrupted.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use granule::{Allowance, ResumeError, ResumeOptions};

use super::Exit;
use super::run::{catch_signals, failed, finished};
use crate::args::ResumeArguments;
use crate::{progress, terminal};

/// Continues the run in a folder.
pub fn resume(arguments: &ResumeArguments, allowance: &Allowance) -> Exit {
    let stop = Arc::new(AtomicBool::new(false));
    if let Err(error) = catch_signals(&stop) {
        terminal::error(&format!("signals cannot be caught: {error}"));
        return Exit::Run;
    }
    let mut display = progress::display(arguments.quiet);
    let options = ResumeOptions {
        threads: arguments.threads.map(usize::from),
        allowance: *allowance,
        progress: display.as_mut(),
        stop: &stop,
        max_time: arguments.max_time,
    };
    match granule::resume(&arguments.directory, options) {
        Ok(summary) => finished(&summary, summary.planned, arguments.quiet),
        Err(ResumeError::Run(error)) => {
            failed(&error);
            Exit::Run
        }
        Err(error) => {
            terminal::error(&error.to_string());
            Exit::Input
        }
    }
}
