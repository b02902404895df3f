//! `granule advise`: what a scene requires.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use granule::Allowance;
use granule::parts::formats::atomic;
use granule::trade::{Advice, Options, Setting, TradeError, advice_json, chosen_scene};

use super::run::catch_signals;
use super::trade::Lines;
use super::{Exit, show_load_error};
use crate::args::AdviseArguments;
use crate::terminal;

/// Probes a scene and judges its physics.
pub fn advise(arguments: &AdviseArguments, allowance: &Allowance) -> Exit {
    // Loading first shows every problem of the scene with its place.
    let loaded = match granule::load_without_wish(&arguments.scene, allowance) {
        Ok(loaded) => loaded,
        Err(error) => {
            show_load_error(&error);
            return Exit::Input;
        }
    };
    terminal::diagnostics(&loaded.source, &loaded.warnings);
    let stop = Arc::new(AtomicBool::new(false));
    if let Err(error) = catch_signals(&stop) {
        terminal::error(&format!("signals cannot be caught: {error}"));
        return Exit::Run;
    }
    match advice(arguments, &loaded.source.text, &stop) {
        Ok(report) => {
            if !arguments.quiet {
                terminal::out(&report);
            }
            Exit::Success
        }
        Err(TradeError::Stopped) => {
            terminal::err(&format!("{}\n", TradeError::Stopped));
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

fn advice(arguments: &AdviseArguments, text: &str, stop: &AtomicBool) -> Result<String, TradeError> {
    let laws = granule::laws().map_err(|error| TradeError::Nothing(error.to_string()))?;
    let directory = arguments.output.clone().unwrap_or_else(|| {
        Path::new("advice").join(arguments.scene.file_stem().unwrap_or(arguments.scene.as_os_str()))
    });
    let options = Options {
        directory: directory.clone(),
        observe: arguments.observe.clone(),
        realisations: arguments.runs,
        target: arguments.error,
    };
    let mut watch = Lines::new(arguments.quiet);
    let beside = arguments.scene.parent().unwrap_or_else(|| Path::new(""));
    let advice = granule::trade::advise(text, beside, &laws, &options, &mut watch, stop);
    watch.end();
    let advice = advice?;
    let mut report = report(&advice);
    let mut write = |path: &Path, content: &str| {
        atomic::write(path, content.as_bytes()).map_err(|error| TradeError::File(error.to_string()))?;
        // Writing to a string cannot fail.
        let _ = writeln!(report, "{}", path.display());
        Ok(())
    };
    write(&directory.join("advice.json"), &format!("{:#}\n", advice_json(&advice)))?;
    if let (Some(path), Some(best)) = (&arguments.write, advice.best()) {
        let setting = Setting { without: best.without, ..advice.setting };
        let scene = chosen_scene(text, &setting, &laws, beside).map_err(TradeError::Scene)?;
        let header = format!(
            "// By `granule advise`: {}, which changes {} by {:.1e} (uncertainty {:.1e}).\n",
            best.without.words(),
            best.quantity,
            best.error,
            best.bar
        );
        write(path, &(header + &scene))?;
    }
    Ok(report)
}

fn report(advice: &Advice) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, "What happens{}", if advice.whole { "" } else { " (in windows of the run)" });
    for group in &advice.groups {
        let of = if group.of.is_empty() { String::new() } else { format!(" ({})", group.of) };
        let threshold =
            group.threshold.map_or_else(String::new, |threshold| format!(", threshold {threshold:.3}"));
        let _ = writeln!(
            out,
            "  {}{of}: {} = {:.3e}{threshold}: {} [{}]",
            group.name, group.symbol, group.value, group.meaning, group.source
        );
    }
    let _ = writeln!(
        out,
        "\nWhat it requires ({} runs with and without each; change of {})",
        advice.realisations,
        advice.observables.join(", ")
    );
    for claim in &advice.claims {
        let _ = writeln!(
            out,
            "  {:<20} {:<22} {} changes by {:.1e} +- {:.1e}, time x {:.2} [{}]",
            claim.without.physics(),
            claim.verdict.words(),
            claim.quantity,
            claim.error,
            claim.bar,
            claim.cost,
            claim.source
        );
    }
    for (without, reason) in &advice.left_out {
        let _ = writeln!(out, "  {:<20} cannot be left out on trial: {reason}", without.physics());
    }
    let _ = match advice.best() {
        Some(best) => writeln!(
            out,
            "\nWithin {}: {} takes {:.2} of the time",
            advice.target,
            best.without.words(),
            best.cost
        ),
        None => writeln!(out, "\nWithin {}: nothing that is left out saves time", advice.target),
    };
    out
}
