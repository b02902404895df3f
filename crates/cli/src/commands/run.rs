//! `granule run`: runs a scene and writes its outputs.

use std::fmt::Write as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use granule::Allowance;
use granule::prelude::{Counts, Ending, RunError, RunOptions, RunSummary, Source};
use granule::trade::{Choice, Realised};

use super::{Exit, show_load_error};
use crate::args::RunArguments;
use crate::{progress, terminal, text};

/// Runs a scene.
pub fn run(arguments: &RunArguments, allowance: &Allowance) -> Exit {
    let loaded = match granule::load_within(&arguments.scene, allowance) {
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
    let directory =
        arguments.output.clone().unwrap_or_else(|| granule::default_directory(&loaded.source.path));
    let mut display = progress::display(arguments.quiet);
    let options = RunOptions {
        output_dir: None,
        threads: arguments.threads.map(usize::from),
        force: arguments.force,
        progress: display.as_mut(),
        stop: &stop,
        max_time: arguments.max_time,
    };
    let steps = loaded.plan.driver.steps;
    let (plan, source, choice) = (loaded.plan, loaded.source, loaded.choice);
    let result = match &choice {
        Some(choice) => granule::run_choice(plan, choice, &source, &directory, options),
        None => granule::run_plan(plan, Some(&source), &directory, options).map(|summary| (summary, None)),
    };
    match result {
        Ok((summary, measured)) => {
            let exit = finished(&summary, steps, arguments.quiet);
            if let (Some(choice), Exit::Success, false) = (choice, exit, arguments.quiet) {
                terminal::out(&realised(&choice, measured, &source, &summary));
            }
            exit
        }
        Err(error) => {
            failed(&error);
            Exit::Run
        }
    }
}

/// Tells why a run has failed.
pub(super) fn failed(error: &RunError) {
    terminal::error(&error.to_string());
    if let RunError::Engine { directory, .. } = error {
        terminal::err(&format!("what was written until then is in {}\n", directory.display()));
    }
}

/// Lets the first Ctrl-C or termination signal end the run after its current steps, and a second one end the program at
/// once.
pub(super) fn catch_signals(stop: &Arc<AtomicBool>) -> Result<(), ctrlc::Error> {
    let stop = Arc::clone(stop);
    ctrlc::set_handler(move || {
        if stop.swap(true, Ordering::Relaxed) {
            std::process::exit(Exit::Interrupted as i32);
        }
    })
}

/// Tells how a run has ended.
pub(super) fn finished(summary: &RunSummary, steps: u64, quiet: bool) -> Exit {
    if summary.ending != Ending::Completed {
        let (why, exit) = match summary.ending {
            Ending::OutOfTime => ("the time is over", Exit::OutOfTime),
            _ => ("stopped", Exit::Interrupted),
        };
        let directory = summary.directory.display();
        let next = match &summary.checkpoint {
            Some(_) => format!("`granule resume {directory}` continues the run"),
            None => "no checkpoint was kept: the run cannot be continued".to_string(),
        };
        terminal::err(&format!(
            "{why} at step {} of {steps}, t = {} s; the outputs in {directory} are whole up to there; {next}\n",
            summary.steps,
            text::number(text::rounded(summary.time)),
        ));
        return exit;
    }
    if !quiet {
        terminal::out(&report(summary));
    }
    Exit::Success
}

/// What was expected of the setting that the scene asked for, and what came of it.
fn realised(choice: &Choice, measured: Option<Realised>, source: &Source, summary: &RunSummary) -> String {
    let mut out = format!("accuracy       {:.1e} expected of {}", choice.error, choice.quantity);
    // Writing to a string cannot fail.
    let _ = match (granule::measured_again(choice, source), measured) {
        (Ok(_), Some(Realised { error, chance })) => writeln!(
            out,
            ", {error:.1e} from the reference of the table, of which {chance:.1e} may be chance in a single run"
        ),
        (Ok(Some(error)), None) => writeln!(out, ", {error:.1e} measured again at other phases of the step"),
        (Ok(None), None) => writeln!(out),
        (Err(reason), _) => writeln!(out, "; it cannot be measured again: {reason}"),
    };
    if let Some(seconds) = choice.seconds {
        let loop_time = summary.wall.saturating_sub(summary.output_wall).as_secs_f64();
        let _ = writeln!(out, "time           {seconds:.3} s expected, {loop_time:.3} s taken");
    }
    out
}

/// What hard bodies did, and whether they are a model of this scene.
fn events(out: &mut String, counts: &Counts, seconds: f64) {
    let rate = if seconds > 0.0 { counts.all() as f64 / seconds } else { 0.0 };
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "collisions     {} of bodies, {} with walls ({}collisions/s)",
        counts.collisions,
        counts.wall_collisions,
        text::short(rate)
    );
    let _ = writeln!(
        out,
        "overlapping    {} collisions within the contact duration, {:.3} % of all",
        counts.overlapping,
        100.0 * counts.overlapping_share()
    );
    if counts.leaves_the_hard_sphere_world() {
        let _ = writeln!(
            out,
            "               this scene leaves the hard-sphere world: contacts overlap in time from t = {} s on",
            text::number(text::rounded(counts.first_overlapping.unwrap_or(0.0)))
        );
    }
}

/// The summary of a run.
fn report(summary: &RunSummary) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, "steps          {}", summary.steps);
    let _ = writeln!(out, "time           {} s", text::number(text::rounded(summary.time)));
    let _ = writeln!(
        out,
        "speed          {}particle-steps/s ({}, of which {} for outputs)",
        text::short(summary.particle_steps_per_second),
        text::duration(summary.wall),
        text::duration(summary.output_wall)
    );
    if let Some(counts) = &summary.events {
        events(&mut out, counts, summary.wall.as_secs_f64());
    }
    if let Some(drift) = &summary.energy_drift {
        let _ = writeln!(
            out,
            "energy drift   {:.3e} J, {:.1e} of the energy turned over",
            drift.residual,
            drift.relative()
        );
    }
    let _ = writeln!(out, "result hash    {}", summary.result_hash);
    for (index, path) in summary.outputs.iter().enumerate() {
        let _ = writeln!(
            out,
            "{}{}",
            if index == 0 { "outputs        " } else { "               " },
            path.display()
        );
    }
    out
}
