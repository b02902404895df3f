//! What a trade has found, for readers and programs.

use granule_report::{Align, Axis, Block, Cell, Column, Document, Plot, ReportError, Series, Status, Table};
use serde_json::{Value, json as object};

use crate::front::Scored;
use crate::setting::{integrator_name, precision_name};
use crate::study::Study;

/// Error over cost: every setting, and the front.
pub fn front_plot(study: &Study) -> Plot {
    let shown = |scored: &Scored| if scored.unresolved { scored.bar } else { scored.error };
    let mut plot = Plot::new(
        "Error against cost",
        Axis::log("seconds on one thread for a second of the scene"),
        Axis::log("relative error"),
    )
    .with_size(820.0, 480.0);
    let mut families: Vec<String> = Vec::new();
    for scored in &study.settings {
        let family = scored.setting.family();
        if !families.contains(&family) {
            families.push(family);
        }
    }
    for family in families {
        let of = study.settings.iter().filter(|scored| scored.setting.family() == family);
        let (x, y) = of.map(|scored| (scored.cost, shown(scored))).unzip();
        plot = plot.with(Series::points(family, x, y));
    }
    let front = study.settings.iter().filter(|scored| !scored.dominated);
    let (x, y): (Vec<f64>, Vec<f64>) = front.map(|scored| (scored.cost, shown(scored))).unzip();
    plot = plot.with(Series::line("front", x, y));
    if let (Some(first), Some(last)) = (study.settings.first(), study.settings.last()) {
        let target = vec![study.target; 2];
        plot = plot.with(Series::dashed("target", vec![first.cost, last.cost], target));
    }
    plot
}

/// The page.
///
/// # Errors
/// A figure cannot be drawn.
pub fn document(study: &Study) -> Result<Document, ReportError> {
    let title = if study.title.is_empty() { "a scene" } else { &study.title };
    let mut page = Document::new(format!("Speed and accuracy: {title}"));
    let names: Vec<String> =
        study.observables.iter().map(|(name, unit)| format!("`{name}` [{unit}]")).collect();
    page.push(match study.chosen.map(|at| &study.settings[at]) {
        Some(best) => Block::Verdict {
            status: Status::Pass,
            text: format!(
                "An error of {} is kept by `{}`: error {:.2e} with an uncertainty of {:.1e}, {:.3e} s on one thread for a \
                 second of the scene. The scene with this setting is in `chosen.ron`.",
                study.target,
                best.setting.label(),
                best.error,
                best.bar,
                best.cost
            ),
        },
        None => Block::Verdict {
            status: Status::Warning,
            text: format!("No setting that was tried keeps an error of {}.", study.target),
        },
    });
    let how = if study.paths {
        "Paths are compared at the end of each run, and the worst run counts; the bar is how much the \
         runs' errors differ and the uncertainty of the reference."
    } else {
        "Means over the last fifth of the time and over the runs are compared with the reference, run by run of equal initial states; the bar is two standard errors. An error \
         within its bar is not told from zero, and counts as its bar."
    };
    let other = if study.seeds { "with other seeds" } else { "with steps that differ by a few per cent" };
    page.push(Block::paragraph(format!(
        "{} bodies, {} s, {} runs of every setting {other}. Errors are those of {}, over the largest size in the run. {how}",
        study.bodies,
        study.duration,
        study.realisations,
        names.join(", ")
    )));
    page.push(Block::plot(
        front_plot(study).to_svg()?,
        "Each point is a setting; the line joins what nothing else beats.",
    ));
    page.push(Block::heading(2, "Reference"));
    let mut reference = Table::new(["quantity", "unit", "size", "relative uncertainty"]);
    for (at, (name, unit)) in study.observables.iter().enumerate() {
        reference.push(vec![
            Cell::text(*name),
            Cell::text(*unit),
            Cell::number(study.reference.scale[at]),
            Cell::Number { value: study.reference.uncertainty[at], digits: 2 },
        ]);
    }
    page.push(Block::paragraph(format!(
        "{} runs of velocity Verlet with {} steps in a contact, double precision, all physics.",
        study.reference.realisations, study.reference.steps_per_contact
    )));
    page.push(Block::Table(reference));
    page.push(Block::heading(2, "Settings"));
    page.push(Block::Table(table(study)));
    if !study.left_out.is_empty() {
        page.push(Block::heading(2, "Does not apply"));
        page.push(Block::List(
            study.left_out.iter().map(|(label, reason)| format!("`{label}`: {reason}")).collect(),
        ));
    }
    Ok(page)
}

fn table(study: &Study) -> Table {
    let right = |title: &str| Column { title: title.to_string(), align: Align::Right };
    let mut columns = vec![Column { title: "setting".into(), align: Align::Left }];
    columns.extend(["step [s]", "s for 1 s", "steps for 1 s", "bytes a body", "error", "bar"].map(right));
    columns.extend(study.observables.iter().map(|(name, _)| right(name)));
    columns.push(Column { title: "front".into(), align: Align::Centre });
    let mut table = Table { columns, rows: Vec::new() };
    for (at, scored) in study.settings.iter().enumerate() {
        let short = |value: f64| Cell::Number { value, digits: 3 };
        let mut row = vec![
            Cell::text(scored.setting.label()),
            short(scored.step),
            short(scored.cost),
            short(scored.steps_per_second),
            Cell::Number { value: scored.bytes_per_body.round(), digits: 6 },
            short(scored.error),
            Cell::Number { value: scored.bar, digits: 2 },
        ];
        row.extend(scored.errors.iter().map(|error| short(*error)));
        row.push(match (study.chosen == Some(at), scored.dominated) {
            (true, _) => Cell::Badge { status: Status::Pass, text: "chosen".into() },
            (false, false) => Cell::Badge { status: Status::Note, text: "front".into() },
            (false, true) => Cell::text(""),
        });
        table.push(row);
    }
    table
}

/// Everything as JSON.
pub fn json(study: &Study) -> Value {
    let settings: Vec<Value> = study
        .settings
        .iter()
        .enumerate()
        .map(|(at, scored)| {
            object!({
                "setting": scored.setting.label(),
                "integrator": integrator_name(scored.setting.integrator),
                "precision": precision_name(scored.setting.precision),
                "without": scored.setting.without,
                "steps_per_contact": scored.setting.steps_per_contact,
                "stiffness_factor": scored.setting.stiffness,
                "step_s": scored.step,
                "seconds_per_second": scored.cost,
                "steps_per_second": scored.steps_per_second,
                "bytes_per_body": scored.bytes_per_body,
                "error": scored.error,
                "bar": scored.bar,
                "errors": scored.errors,
                "bars": scored.bars,
                "unresolved": scored.unresolved,
                "dominated": scored.dominated,
                "chosen": study.chosen == Some(at),
            })
        })
        .collect();
    let observables: Vec<Value> = study
        .observables
        .iter()
        .enumerate()
        .map(|(at, (name, unit))| {
            object!({
                "name": name,
                "unit": unit,
                "scale": study.reference.scale[at],
                "relative_uncertainty": study.reference.uncertainty[at],
                "reference": study.reference.values[at],
            })
        })
        .collect();
    object!({
        "title": study.title,
        "scene": study.scene,
        "bodies": study.bodies,
        "duration_s": study.duration,
        "realisations": study.realisations,
        "comparison": if study.paths { "paths" } else { "means" },
        "target": study.target,
        "reference": {
            "steps_per_contact": study.reference.steps_per_contact,
            "realisations": study.reference.realisations,
        },
        "observables": observables,
        "settings": settings,
        "left_out": study.left_out.iter().map(|(label, reason)| object!({ "setting": label, "reason": reason })).collect::<Vec<_>>(),
    })
}
