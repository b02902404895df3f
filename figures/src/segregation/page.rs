//! The page.

use std::fmt::Write as _;

use super::scene::{MODELS, Model, PACKING, RESTITUTION, ROLLING, SHAKING, STEPS};
use super::sweep::{Record, Row};
use super::{CONTACT, CONTACTS, DURATION, LATE, SIDE, SMALL};
use crate::mean_and_error;

const TEXT: &str = "\
Kondic 1999, Sec. V, expects beads that differ in rolling friction alone to part on a shaken plate. They do, in both ways to run
the scene: in time steps on the `substrate` (a), and from collision to collision along arcs in closed form,
`Event(slides: Arcs())` (c). Computed by `cargo xtask figures segregation --docs`; the runs take four to five hours of a processor.
";

pub(super) fn page(records: &[Record], shorter: &[Record], contacts: &[Record], pictures: &str) -> String {
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
        1e3 * CONTACT,
        STEPS,
    );
    let _ = writeln!(text, "\n![index of segregation]({pictures}/index.svg)\n");
    let _ = writeln!(
        text,
        "Means over the seeds with standard errors ([index.csv]({pictures}/index.csv)); late means from {LATE} s on:\n\n\
         | model | seeds | index, late | temperature of the easy rollers, late | of the others | beads in the cluster of a bead | s of a processor |\n\
         |---|--:|--:|--:|--:|--:|--:|"
    );
    for model in MODELS {
        let runs: Vec<&Record> = records.iter().filter(|record| record.case.model == model).collect();
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
    let of =
        |model| records.iter().filter(move |record: &&Record| record.case.model == model).collect::<Vec<_>>();
    let [steps, arcs] = [Model::TimeSteps, Model::Arcs].map(of);
    let _ = writeln!(
        text,
        "\n(a) with these contacts parts the species less than (c), at a higher temperature and in smaller clusters, by more than the \
         seeds scatter: its contacts are too long, as the next table shows. Beads of equal rolling friction move with the plate as \
         one: they hardly collide, and lie as they lay."
    );
    approach(text, &steps, shorter, &arcs);
    softness(text, contacts);
    let _ = writeln!(
        text,
        "\n![granular temperature]({pictures}/temperature.svg)\n\nNumbers: [temperature.csv]({pictures}/temperature.csv)"
    );
    for model in [Model::TimeSteps, Model::Arcs] {
        let _ = writeln!(text, "\n![{}]({pictures}/{}.svg)", model.label(), model.name());
    }
    page
}

/// How the large layers of (a) approach those of (c) as their contacts become shorter.
fn approach(text: &mut String, steps: &[&Record], shorter: &[Record], arcs: &[&Record]) {
    let [wide, close] = [steps, arcs].map(|runs| runs.len().to_string());
    let _ = writeln!(
        text,
        "\n## (a) approaches (c) as its contacts become shorter\n\nIn clusters contacts follow each other faster than long ones end. The same \
         large layers, late means; errors of means over seeds where there are several:\n\n\
         | model | seeds | index | temperature of the easy rollers | of the others | beads in the cluster of a bead | s of a processor |\n\
         |---|--:|--:|--:|--:|--:|--:|"
    );
    let mut row = |name: String, seeds: &str, runs: &[&Record]| {
        let cost: Vec<f64> = runs.iter().map(|run| run.cost).collect();
        let _ = writeln!(
            text,
            "| {name} | {seeds} | {} | {} mm²/s² | {} mm²/s² | {} | {:.0} |",
            told(&late(runs, |row| row.index), 1.0, 3),
            told(&late(runs, |row| row.temperature[0]), 1e6, 1),
            told(&late(runs, |row| row.temperature[1]), 1e6, 1),
            told(&late(runs, |row| row.cluster), 1.0, 1),
            mean_and_error(&cost).0,
        );
    };
    row(format!("(a), contacts of {} ms", 1e3 * CONTACT), &wide, steps);
    for run in shorter.iter().rev() {
        row(format!("(a), contacts of {} ms", 1e3 * run.case.contact), "1", &[run]);
    }
    row("(c)".to_string(), &close, arcs);
    let Some(shortest) = shorter.first() else { return };
    let hard = mean_and_error(&late(arcs, |row| row.index)).0;
    let soft = mean_and_error(&late(&[shortest], |row| row.index)).0;
    let cost = mean_and_error(&arcs.iter().map(|run| run.cost).collect::<Vec<_>>()).0;
    let _ = writeln!(
        text,
        "\nWith contacts of {} ms the index of (a) differs from that of (c) by {:+.3}, and (c) takes {:.1} times fewer seconds of a processor.",
        1e3 * shortest.case.contact,
        soft - hard,
        shortest.cost / cost,
    );
}

/// What the duration of a contact does, by the small layers.
fn softness(text: &mut String, records: &[Record]) {
    let (side, duration, _, seeds) = SMALL;
    let from = 0.5 * duration;
    let index = |model: Model, contact: f64| {
        let of = |record: &&Record| record.case.model == model && record.case.contact == contact;
        let runs: Vec<&Record> = records.iter().filter(of).collect();
        let cost: Vec<f64> = runs.iter().map(|run| run.cost).collect();
        (mean_and_error(&since(from, &runs, |row| row.index)), mean_and_error(&cost).0)
    };
    let (hard, seconds) = index(Model::Arcs, 0.0);
    let _ = writeln!(
        text,
        "\n## How soft the contacts of (a) may be in small layers\n\nWhile beads touch, the surface brakes them: contacts that are softer than those of steel, which \
         last 0.02 ms, take up to μ_k g t_c from their relative velocity, where a collision of (c) takes no time. In small layers of {} beads \
         that changes the index by no more than the scatter; means over {seeds} seeds and the times from {from} s to {duration} s:\n\n\
         | model | μ_k g t_c | index | difference to (c) | s of a processor |\n|---|--:|--:|--:|--:|",
        2 * side * side
    );
    for contact in CONTACTS {
        let (found, seconds) = index(Model::TimeSteps, contact);
        let _ = writeln!(
            text,
            "| (a), contacts of {} ms | {:.2} mm/s | {:.3} ± {:.3} | {:+.3} ± {:.3} | {seconds:.0} |",
            1e3 * contact,
            1e3 * 0.1 * 9.81 * contact,
            found.0,
            found.1,
            found.0 - hard.0,
            found.1.hypot(hard.1)
        );
    }
    let _ = writeln!(text, "| (c) | 0 | {:.3} ± {:.3} | | {seconds:.0} |", hard.0, hard.1);
}

/// Means over the late times of each run.
fn late(runs: &[&Record], value: impl Fn(&Row) -> f64) -> Vec<f64> {
    since(LATE, runs, value)
}

/// Means of each run over the times from `begin` on.
fn since(begin: f64, runs: &[&Record], value: impl Fn(&Row) -> f64) -> Vec<f64> {
    runs.iter()
        .map(|run| {
            let values: Vec<f64> = run.rows.iter().filter(|row| row.time >= begin).map(&value).collect();
            mean_and_error(&values).0
        })
        .collect()
}

/// Mean, and its standard error if there are several values.
fn told(values: &[f64], unit: f64, digits: usize) -> String {
    let (mean, error) = mean_and_error(values);
    if values.len() < 2 {
        return format!("{:.digits$}", unit * mean);
    }
    format!("{:.digits$} ± {:.digits$}", unit * mean, unit * error)
}
