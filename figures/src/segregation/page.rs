//! The page.

use std::fmt::Write as _;

use super::scene::{CONTACT, MODELS, Model, PACKING, RESTITUTION, ROLLING, SHAKING};
use super::sweep::{Record, Row};
use super::{DURATION, LATE, SIDE};
use crate::mean_and_error;

const TEXT: &str = "\
Kondic 1999, Sec. V, expects beads that differ in rolling friction alone to part on a shaken plate. They do, and both ways to run
the scene tell the same: in time steps on the `substrate` (a), and from collision to collision along arcs in closed form,
`Event(slides: Arcs())` (c). Computed by `cargo xtask figures segregation --docs`; the runs take one to two hours of a processor.
";

pub(super) fn page(records: &[Record], pictures: &str) -> String {
    let mut page = format!("# Segregation by rolling friction\n\n{TEXT}");
    let text = &mut page;
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "\n{} steel beads of 1 mm radius, half of each species, cover {} % of a plate with a frame, both shaken along x by {} mm at \
         {} Hz for {DURATION} s. Rolling friction {} and {}, static friction 0.5, kinetic friction 0.1, restitution {RESTITUTION}. \
         (a) takes contacts of {} ms and {} steps in each. The index is 0 for species mixed at random and 1 for species that \
         have parted; the layers start as a chessboard.",
        2 * SIDE * SIDE,
        100.0 * PACKING,
        1e3 * SHAKING.0,
        SHAKING.1,
        ROLLING[0],
        ROLLING[1],
        1e3 * CONTACT.0,
        CONTACT.0 / CONTACT.1,
    );
    let _ = writeln!(text, "\n![index of segregation]({pictures}/index.svg)\n");
    let _ = writeln!(
        text,
        "Means over the seeds with standard errors ([index.csv]({pictures}/index.csv)); late means from {LATE} s on:\n\n\
         | model | seeds | index, late | temperature of the easy rollers, late | of the others | beads in the cluster of a bead | s of a processor |\n\
         |---|--:|--:|--:|--:|--:|--:|"
    );
    for model in MODELS {
        let runs: Vec<&Record> = records.iter().filter(|record| record.model == model).collect();
        let cost: Vec<f64> = runs.iter().map(|run| run.cost).collect();
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {:.0} |",
            model.label(),
            runs.len(),
            told(&late(&runs, |row| row.index), 1.0, 3),
            told(&late(&runs, |row| row.temperature[0]), 1e6, 1) + " mm²/s²",
            told(&late(&runs, |row| row.temperature[1]), 1e6, 1) + " mm²/s²",
            told(&late(&runs, |row| row.cluster), 1.0, 1),
            mean_and_error(&cost).0,
        );
    }
    let of = |model| records.iter().filter(move |record: &&Record| record.model == model).collect::<Vec<_>>();
    let (steps, arcs) = (of(Model::TimeSteps), of(Model::Arcs));
    let (one, other) = (late(&steps, |row| row.index), late(&arcs, |row| row.index));
    let (a, c) = (mean_and_error(&one), mean_and_error(&other));
    let costs =
        [&steps, &arcs].map(|runs| mean_and_error(&runs.iter().map(|run| run.cost).collect::<Vec<_>>()).0);
    let collisions = arcs.iter().map(|run| run.collisions as f64).sum::<f64>() / arcs.len() as f64;
    let _ = writeln!(
        text,
        "\nThe late indices of (a) and (c) differ by {:.3} with a standard error of {:.3}; (c) takes {:.2} times fewer seconds of a \
         processor than (a), {:.1} million events a run.",
        (a.0 - c.0).abs(),
        a.1.hypot(c.1),
        costs[0] / costs[1],
        1e-6 * collisions,
    );
    let _ = writeln!(
        text,
        "\n![granular temperature]({pictures}/temperature.svg)\n\nNumbers: [temperature.csv]({pictures}/temperature.csv)"
    );
    for model in MODELS {
        let _ = writeln!(text, "\n![{}]({pictures}/{}.svg)", model.label(), model.name());
    }
    page
}

/// Means over the late times of each run.
fn late(runs: &[&Record], value: impl Fn(&Row) -> f64) -> Vec<f64> {
    runs.iter()
        .map(|run| {
            let values: Vec<f64> = run.rows.iter().filter(|row| row.time >= LATE).map(&value).collect();
            mean_and_error(&values).0
        })
        .collect()
}

/// Mean and standard error.
fn told(values: &[f64], unit: f64, digits: usize) -> String {
    let (mean, error) = mean_and_error(values);
    format!("{:.digits$} ± {:.digits$}", unit * mean, unit * error)
}
