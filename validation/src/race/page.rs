//! What a race leaves: JSON, a table, a figure a contest.

use std::fmt::Write as _;
use std::path::Path;

use granule_report::{Axis, Plot, Series};

use super::{Entry, Outcome, TARGETS};

/// One engine in one line.
pub fn line(entry: &Entry) -> String {
    let times: Vec<String> = TARGETS
        .iter()
        .zip(&entry.time_to)
        .map(|(target, time)| match time {
            Some(time) => format!("{target:e}: {time:.3e} s"),
            None => format!("{target:e}: not reached"),
        })
        .collect();
    format!("{:<22} {}", entry.name, times.join(", "))
}

/// Writes `race.json`, `race.md` and `race-<contest>.svg`.
pub fn write(outcomes: &[Outcome], out: &Path) -> Result<(), String> {
    let fail = |error: &dyn std::fmt::Display| error.to_string();
    std::fs::create_dir_all(out).map_err(|error| fail(&error))?;
    let json = serde_json::to_string_pretty(outcomes).map_err(|error| fail(&error))?;
    let save = |name: &str, text: &str| {
        granule_formats::atomic::write(out.join(name), text.as_bytes()).map_err(|error| fail(&error))
    };
    save("race.json", &json)?;
    save("race.md", &markdown(outcomes))?;
    for outcome in outcomes {
        let mut plot = Plot::new(
            format!("{}: error against time", outcome.contest),
            Axis::log("time of the steps on one core [s]"),
            Axis::log("error"),
        );
        for entry in &outcome.entries {
            let (x, y) = entry.points.iter().map(|point| (point.seconds, point.error.max(1e-16))).unzip();
            plot = plot.with(Series::points(entry.name.clone(), x, y));
        }
        let svg = plot.to_svg().map_err(|error| fail(&error))?;
        save(&format!("race-{}.svg", outcome.contest), &svg)?;
    }
    Ok(())
}

fn markdown(outcomes: &[Outcome]) -> String {
    let mut out = String::new();
    for outcome in outcomes {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "**{}**: {}\n", outcome.contest, outcome.what);
        let _ =
            writeln!(out, "| engine | {} |", TARGETS.map(|target| format!("s for {target:e}")).join(" | "));
        let _ = writeln!(out, "|---|{}", "---:|".repeat(TARGETS.len()));
        for entry in &outcome.entries {
            let times: Vec<String> = entry
                .time_to
                .iter()
                .map(|time| time.map_or("not reached".into(), |time| format!("{time:.3e}")))
                .collect();
            let _ = writeln!(out, "| {} | {} |", entry.name, times.join(" | "));
        }
        out.push('\n');
    }
    out
}
