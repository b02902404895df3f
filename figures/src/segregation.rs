//! Two species of beads that differ in rolling friction alone, on a shaken plate (Kondic 1999, Sec. V): do they part, and do
//! time steps and events agree about it?

mod page;
mod scene;
mod sweep;

use std::path::PathBuf;

use granule_report::{Axis, Plot, ScenePicture, Series, View};

use self::scene::{Case, MODELS, Model};
use self::sweep::{Record, sweep};
use crate::{Error, csv, mean_and_error};

/// Beads of each species along a side.
const SIDE: usize = 71;
/// Simulated time \[s\].
const DURATION: f64 = 60.0;
/// Records of each run after its start.
const RECORDS: usize = 30;
/// Time from which on means over time are compared \[s\].
const LATE: f64 = 40.0;

/// Duration of a contact of (a) in the large layers \[s\].
const CONTACT: f64 = 2e-3;
/// Durations of contacts of (a) in further large layers, one seed each \[s\].
const SHORTER: [f64; 2] = [1e-3, 5e-4];
/// Small layers, for the duration of contacts: beads of each species along a side, simulated time, records, seeds.
const SMALL: (usize, f64, usize, u64) = (22, 30.0, 30, 6);
/// Durations of contacts of (a) in small layers \[s\].
const CONTACTS: [f64; 3] = [2e-3, 1e-3, 5e-4];

/// The large layers, the dearest first.
fn large() -> Vec<Case> {
    let seeds = |model| match model {
        Model::TimeSteps => 3,
        Model::Arcs => 4,
        Model::Control => 2,
    };
    let case = |model, seed| Case { model, side: SIDE, duration: DURATION, contact: CONTACT, seed };
    MODELS.iter().flat_map(|model| (1..=seeds(*model)).map(|seed| case(*model, seed))).collect()
}

/// The large layers with shorter contacts, the dearest first.
fn shorter() -> Vec<Case> {
    let case = |contact| Case { model: Model::TimeSteps, side: SIDE, duration: DURATION, contact, seed: 1 };
    SHORTER.iter().rev().map(|contact| case(*contact)).collect()
}

/// The small layers.
fn small() -> Vec<Case> {
    let (side, duration, _, seeds) = SMALL;
    let case = |model, contact, seed| Case { model, side, duration, contact, seed };
    let steps = CONTACTS.iter().rev().map(|contact| (Model::TimeSteps, *contact));
    let models = steps.chain([(Model::Arcs, 0.0)]);
    models.flat_map(|(model, contact)| (1..=seeds).map(move |seed| case(model, contact, seed))).collect()
}

/// Runs all layers, and writes plot, table, pictures and page into `docs/` or `target/figures`, below the current folder.
///
/// # Errors
/// A run ends with an error, or a file cannot be written.
pub fn make(docs: bool) -> Result<(), Error> {
    let folder = PathBuf::from(if docs { "docs" } else { "target/figures" });
    let pictures = if docs { "figures/segregation" } else { "segregation" };
    let place = folder.join(pictures);
    std::fs::create_dir_all(&place)?;
    let shorter = sweep(&shorter(), RECORDS)?;
    let records = sweep(&large(), RECORDS)?;
    let contacts = sweep(&small(), SMALL.2)?;
    for (name, plot) in [("index", index(&records)), ("temperature", temperature(&records))] {
        std::fs::write(place.join(format!("{name}.svg")), plot.to_svg()?)?;
        std::fs::write(place.join(format!("{name}.csv")), csv(&plot))?;
    }
    for model in [Model::TimeSteps, Model::Arcs] {
        let Some(record) = records.iter().find(|record| record.case.model == model) else { continue };
        std::fs::write(place.join(format!("{}.svg", model.name())), picture(record)?)?;
    }
    let path = folder.join("segregation.md");
    std::fs::write(&path, page::page(&records, &shorter, &contacts, pictures))?;
    println!("segregation: {}", path.display());
    Ok(())
}

/// Of one model, by time: mean over the seeds and its standard error.
fn over_seeds(records: &[Record], model: Model, value: impl Fn(&sweep::Row) -> f64) -> [Vec<f64>; 3] {
    let runs: Vec<&Record> = records.iter().filter(|record| record.case.model == model).collect();
    let mut columns = [Vec::new(), Vec::new(), Vec::new()];
    let rows = runs.first().map_or(0, |record| record.rows.len());
    for k in 0..rows {
        let values: Vec<f64> = runs.iter().map(|record| value(&record.rows[k])).collect();
        let (mean, error) = mean_and_error(&values);
        columns[0].push(runs[0].rows[k].time);
        columns[1].push(mean);
        columns[2].push(error);
    }
    columns
}

fn index(records: &[Record]) -> Plot {
    let title = "Beads of two rolling frictions part on a shaken plate";
    let mut plot = Plot::new(title, Axis::linear("time [s]"), Axis::linear("index of segregation"))
        .with_size(720.0, 460.0);
    for model in MODELS {
        let [time, mean, error] = over_seeds(records, model, |row| row.index);
        plot = plot.with(Series::points(model.label(), time, mean).with_error(error));
    }
    plot
}

fn temperature(records: &[Record]) -> Plot {
    let title = "Granular temperature of the species that rolls easily (1) and of the other one (2)";
    let mut plot = Plot::new(title, Axis::linear("time [s]"), Axis::log("granular temperature [m^2/s^2]"))
        .with_size(720.0, 460.0);
    for model in [Model::TimeSteps, Model::Arcs] {
        for species in 0..2 {
            // The layer starts at a temperature of its own.
            let [mut time, mut mean, mut error] = over_seeds(records, model, |row| row.temperature[species]);
            for column in [&mut time, &mut mean, &mut error] {
                column.remove(0);
            }
            let name = format!("{}, {}", model.label(), species + 1);
            plot = plot.with(Series::points(name, time, mean).with_error(error));
        }
    }
    plot
}

/// The beads at the end, seen from above.
fn picture(record: &Record) -> Result<String, Error> {
    let positions: Vec<[f64; 3]> = record.last.rows.iter().map(|row| [row[0], row[1], row[3]]).collect();
    let radii: Vec<f64> = record.last.rows.iter().map(|row| row[3]).collect();
    let kinds: Vec<f64> = record.last.kind.iter().map(|kind| f64::from(*kind)).collect();
    let title = format!("{}, after {DURATION} s", record.case.model.label());
    let picture =
        ScenePicture::new(&positions, &radii, &kinds, "species").with_view(View::Top).with_title(title);
    Ok(picture.to_svg()?)
}
