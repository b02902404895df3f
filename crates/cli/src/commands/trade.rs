//! `granule trade`: what speed costs in accuracy.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use granule::Allowance;
use granule::trade::{Options, Study, TradeError, Watch};

use super::run::catch_signals;
use super::{Exit, show_load_error};
use crate::args::TradeArguments;
use crate::{progress, terminal, text};

/// Trades the speed of a scene for accuracy.
pub fn trade(arguments: &TradeArguments, allowance: &Allowance) -> Exit {
    // Loading first shows every problem of the scene with its place.
    let loaded = match granule::load_without_wish(&arguments.scene, allowance) {
        Ok(loaded) => loaded,
        Err(error) => {
            show_load_error(&error);
            return Exit::Input;
        }
    };
    terminal::diagnostics(&loaded.source, &loaded.warnings);
    if !(arguments.error > 0.0 && arguments.error.is_finite()) {
        terminal::error(&format!("--error must be greater than 0, not {}", arguments.error));
        return Exit::Input;
    }
    let stop = Arc::new(AtomicBool::new(false));
    if let Err(error) = catch_signals(&stop) {
        terminal::error(&format!("signals cannot be caught: {error}"));
        return Exit::Run;
    }
    let directory = arguments.output.clone().unwrap_or_else(|| folder(&arguments.scene));
    match study(arguments, &loaded.source.text, directory.clone(), &stop) {
        Ok((study, files)) => {
            if !arguments.quiet {
                terminal::out(&report(&study, &files));
            }
            Exit::Success
        }
        Err(TradeError::Stopped) => {
            terminal::err(&format!(
                "{}; runs that are done are in {}\n",
                TradeError::Stopped,
                directory.display()
            ));
            Exit::Interrupted
        }
        Err(error @ (TradeError::Run { .. } | TradeError::File(_))) => {
            terminal::error(&error.to_string());
            Exit::Run
        }
        Err(error) => {
            terminal::error(&format!("{}: {error}", arguments.scene.display()));
            Exit::Input
        }
    }
}

fn study(
    arguments: &TradeArguments,
    text: &str,
    directory: PathBuf,
    stop: &AtomicBool,
) -> Result<(Study, Vec<PathBuf>), TradeError> {
    let laws = granule::laws().map_err(|error| TradeError::Nothing(error.to_string()))?;
    let options = Options {
        directory: directory.clone(),
        observe: arguments.observe.clone(),
        realisations: arguments.runs,
        target: arguments.error,
    };
    let mut watch = Lines::new(arguments.quiet);
    let beside = arguments.scene.parent().unwrap_or_else(|| Path::new(""));
    let study = granule::trade::trade(text, beside, &laws, &options, &mut watch, stop);
    watch.end();
    let study = study?;
    let files = granule::trade::write(&study, text, &laws, beside, &directory)?;
    Ok((study, files))
}

fn folder(scene: &Path) -> PathBuf {
    Path::new("trade").join(scene.file_stem().unwrap_or(scene.as_os_str()))
}

/// The progress of a trade.
#[derive(Default)]
pub(super) struct Lines {
    quiet: bool,
    begin: Option<Instant>,
    bar: Option<progress::Count>,
}

impl Watch for Lines {
    fn progress(&mut self, done: usize, all: usize, setting: &str) {
        if self.quiet {
            return;
        }
        let begin = *self.begin.get_or_insert_with(Instant::now);
        let left = (done > 0).then(|| {
            Duration::from_secs_f64(begin.elapsed().as_secs_f64() / done as f64 * (all - done) as f64)
        });
        let bar = self.bar.get_or_insert_with(|| progress::Count::new(all));
        let left = left.map_or_else(|| "?".to_string(), text::duration);
        bar.show(done, &format!("{done} of {all} runs, about {left} left: {setting}"));
    }
}

impl Lines {
    pub fn new(quiet: bool) -> Self {
        Self { quiet, ..Self::default() }
    }

    pub fn end(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.end();
        }
    }
}

/// The front as a table, and the choice.
fn report(study: &Study, files: &[PathBuf]) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, "{:<34} {:>11} {:>10} {:>10}", "on the front", "s for 1 s", "error", "bar");
    for scored in study.settings.iter().filter(|scored| !scored.dominated) {
        let _ = writeln!(
            out,
            "{:<34} {:>11.3e} {:>10.2e} {:>10.1e}",
            scored.setting.label(),
            scored.cost,
            scored.error,
            scored.bar
        );
    }
    match study.chosen.map(|at| &study.settings[at]) {
        Some(best) => {
            let _ = writeln!(out, "chosen for an error of {}: {}", study.target, best.setting.label());
        }
        None => {
            let _ = writeln!(out, "no setting keeps an error of {}", study.target);
        }
    }
    for file in files {
        let _ = writeln!(out, "{}", file.display());
    }
    out
}
