//! `granule compare-models`: bodies on a substrate in the ways in which they can be run.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use granule::Allowance;
use granule::trade::{Model, ModelComparison, ModelOptions, TradeError, compare_models, models_json};

use super::run::catch_signals;
use super::trade::Lines;
use super::{Exit, show_load_error};
use crate::args::CompareModelsArguments;
use crate::terminal;

/// Runs a scene in all ways and tells what each costs.
pub fn compare(arguments: &CompareModelsArguments, allowance: &Allowance) -> Exit {
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
    let laws = match granule::laws() {
        Ok(laws) => laws,
        Err(error) => {
            terminal::error(&error.to_string());
            return Exit::Input;
        }
    };
    let options = ModelOptions { realisations: arguments.runs, duration: arguments.duration };
    let beside = arguments.scene.parent().unwrap_or_else(|| Path::new(""));
    let mut watch = Lines::new(arguments.quiet);
    let found = compare_models(&loaded.source.text, beside, &laws, &options, &mut watch, &stop);
    watch.end();
    match found {
        Ok(comparison) if arguments.json => {
            terminal::out(&format!("{:#}\n", models_json(&comparison)));
            Exit::Success
        }
        Ok(comparison) => {
            terminal::out(&report(&comparison));
            Exit::Success
        }
        Err(TradeError::Stopped) => {
            terminal::err("stopped\n");
            Exit::Interrupted
        }
        Err(error @ TradeError::Run { .. }) => {
            terminal::error(&error.to_string());
            Exit::Run
        }
        Err(error) => {
            terminal::error(&format!("{}: {error}", arguments.scene.display()));
            Exit::Input
        }
    }
}

fn letter(model: Model) -> &'static str {
    match model {
        Model::Substrate => "(a)",
        Model::Contact => "(b)",
        Model::Arcs => "(c)",
        Model::EffectiveRestitution => "(d)",
    }
}

fn report(comparison: &ModelComparison) -> String {
    let mut out = String::new();
    let how = if comparison.paths {
        "bodies one by one at the end".to_string()
    } else {
        format!("means of {} runs over their last half", comparison.realisations)
    };
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "{} bodies for {} s on one thread; {how}; differences from {}",
        comparison.bodies,
        comparison.duration,
        comparison.reference.map_or("none", letter)
    );
    let _ = write!(out, "\n{:<41} {:>10}", "model", "s for 1 s");
    for (name, _) in &comparison.quantities {
        let _ = write!(out, "  {name:>22}");
    }
    out.push('\n');
    for compared in &comparison.models {
        let _ =
            write!(out, "{} {:<37} {:>10.3e}", letter(compared.model), compared.model.words(), compared.cost);
        for difference in &compared.differences {
            let cell = if Some(compared.model) == comparison.reference {
                format!("{:.4e} {}", difference.value, difference.unit)
            } else if comparison.paths {
                format!("{:.1e}", difference.error)
            } else {
                format!("{:.1e} +- {:.1e}", difference.error, difference.bar)
            };
            let _ = write!(out, "  {cell:>22}");
        }
        out.push('\n');
        for note in &compared.notes {
            let _ = writeln!(out, "      {note}");
        }
    }
    for (model, reason) in &comparison.left_out {
        let _ = writeln!(out, "{} {:<37} not for this scene: {reason}", letter(*model), model.words());
    }
    out
}
