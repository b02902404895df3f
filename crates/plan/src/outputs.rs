//! Files that the scene asks for.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use granule_scene::{EveryChoice, GuardChoice, OutputBlock, OutputChoice, Spanned, suggestion};

use crate::build::Builder;
use crate::model::{OutputKind, OutputPlan, Plan, SERIES};

/// Quantities that need the energy ledger.
const LEDGER: [&str; 5] =
    ["elastic_energy", "dissipated_viscous", "dissipated_friction", "wall_work", "energy_residual"];

/// Quantities of the event-driven driver, and those of lasting contacts.
const EVENT: [&str; 2] = ["collisions", "overlapping_collisions"];
const SOFT: [&str; 4] = ["contacts", "coordination_number", "maximum_overlap", "elastic_energy"];

/// Most outputs: each keeps a file open.
const MOST: usize = 1000;
/// Entries of an output whose interval is not given.
const ENTRIES: u64 = 100;

/// Fills in the outputs of the plan and whether it has an energy ledger.
pub(crate) fn outputs(builder: &mut Builder<'_>, plan: &mut Plan) {
    let scene = builder.scene;
    let mut ledger_for: Option<String> = None;
    if scene.outputs.items.len() > MOST {
        builder.error(scene.outputs.span.clone(), format!("at most {MOST} outputs"));
        return;
    }
    let mut first: BTreeMap<PathBuf, &OutputBlock> = BTreeMap::new();
    for block in &scene.outputs.items {
        let path = path(builder, block);
        let earlier = *first.entry(clean(Path::new(&block.path.value))).or_insert(block);
        if !std::ptr::eq(earlier, block) {
            let message = format!("two outputs go to `{}`", block.path.value);
            let help = format!("the other is a {}", kind_name(&earlier.what));
            builder.error_help(block.path.span.clone(), message, help);
        }
        let every = every(builder, block, plan);
        let kind = match &block.what {
            OutputChoice::Series { columns } => {
                let columns = series(builder, columns.as_deref(), plan.rotation, plan.event.is_some());
                let needs = columns.iter().find(|column| LEDGER.contains(&column.as_str()));
                if let Some(column) = needs {
                    ledger_for.get_or_insert_with(|| format!("{column} in {}", block.path.value));
                }
                OutputKind::Series(columns)
            }
            OutputChoice::Bodies { ids } => {
                for id in ids {
                    if scene.bodies.complete
                        && !plan.bodies.is_empty()
                        && plan.bodies.id.binary_search(&id.value).is_err()
                    {
                        let (first, last) = (plan.bodies.id[0], plan.bodies.id[plan.bodies.len() - 1]);
                        builder.error_help(
                            id.span.clone(),
                            format!("there is no body {}", id.value),
                            format!("{} bodies with ids from {first} to {last}", plan.bodies.len()),
                        );
                    }
                }
                if ids.is_empty() {
                    builder.error(block.span.clone(), "`ids` must name at least one body");
                }
                OutputKind::BodySeries(ids.iter().map(|id| id.value).collect())
            }
            OutputChoice::LammpsDump => OutputKind::LammpsDump,
            OutputChoice::Vtk { compressed } => OutputKind::Vtk { compressed: *compressed },
            OutputChoice::LammpsData => OutputKind::LammpsData,
            OutputChoice::Layer { gap, neighbours } => {
                let radius = largest(plan);
                OutputKind::Layer {
                    gap: gap.unwrap_or(0.1 * radius),
                    neighbours: neighbours.unwrap_or(radius),
                }
            }
            OutputChoice::PairCorrelation { range, bins } => {
                OutputKind::PairCorrelation { range: *range, bins: *bins as usize }
            }
            OutputChoice::Contacts => {
                needs_contacts(builder, block, plan);
                OutputKind::Contacts
            }
            OutputChoice::Impacts { reach } => {
                needs_contacts(builder, block, plan);
                OutputKind::Impacts { reach: reach.unwrap_or(6.0 * largest(plan)) }
            }
        };
        plan.outputs.extend(path.map(|path| OutputPlan { path, kind, every }));
    }
    let asked = scene.guards.energy.as_ref().is_some_and(|guard| guard.value != GuardChoice::Off);
    if asked {
        ledger_for.get_or_insert_with(|| "the guard `energy`".to_string());
    }
    plan.ledger = scene.ledger || ledger_for.is_some();
    let why = match (&ledger_for, scene.ledger) {
        (_, true) => "the scene asks for it".to_string(),
        (Some(reason), false) => format!("needed by {reason}"),
        (None, false) => "nobody asks for elastic energy, dissipation or wall work".to_string(),
    };
    builder.decide_one("energy ledger", plan.ledger, why);
}

/// Hard bodies have no contacts that last.
fn needs_contacts(builder: &mut Builder<'_>, block: &OutputBlock, plan: &Plan) {
    if plan.event.is_some() {
        builder.error_help(
            block.span.clone(),
            format!("the driver `Event` has no contacts that last, so no `{}`", kind_name(&block.what)),
            "it is an output of `driver: TimeStep`",
        );
    }
}

fn kind_name(what: &OutputChoice) -> &'static str {
    match what {
        OutputChoice::Series { .. } => "Series",
        OutputChoice::Bodies { .. } => "Bodies",
        OutputChoice::LammpsDump => "LammpsDump",
        OutputChoice::Vtk { .. } => "Vtk",
        OutputChoice::LammpsData => "LammpsData",
        OutputChoice::Layer { .. } => "Layer",
        OutputChoice::PairCorrelation { .. } => "PairCorrelation",
        OutputChoice::Contacts => "Contacts",
        OutputChoice::Impacts { .. } => "Impacts",
    }
}

/// Largest radius of the bodies \[m\].
fn largest(plan: &Plan) -> f64 {
    plan.bodies.radius.iter().copied().fold(0.0, f64::max)
}

/// The path without `.` components.
fn clean(path: &Path) -> PathBuf {
    path.components().filter(|component| *component != Component::CurDir).collect()
}

fn path(builder: &mut Builder<'_>, block: &OutputBlock) -> Option<PathBuf> {
    let text = &block.path.value;
    let path = clean(Path::new(text));
    let inside = path.components().all(|component| matches!(component, Component::Normal(_)));
    let named = !path.as_os_str().is_empty() && !text.ends_with(['/', '\\']) && !text.contains('\0');
    if !(inside && named) {
        builder.error_help(
            block.path.span.clone(),
            format!("`path` must be a file inside the output folder, not \"{text}\""),
            "a relative path without `..`; the folder is chosen when the scene is run",
        );
        return None;
    }
    Some(path)
}

fn every(builder: &mut Builder<'_>, block: &OutputBlock, plan: &Plan) -> u64 {
    let steps = plan.driver.steps;
    match &block.every {
        // Contacts are seen only while they last.
        None if matches!(block.what, OutputChoice::Impacts { .. }) => 1,
        None => (steps / ENTRIES).max(1),
        Some(every) => interval(builder, every, plan.driver.step),
    }
}

/// An interval in steps of `step` \[s\].
pub(crate) fn interval(builder: &mut Builder<'_>, every: &Spanned<EveryChoice>, step: f64) -> u64 {
    match every.value {
        EveryChoice::Steps(steps) => steps.max(1),
        EveryChoice::Time(_) if step <= 0.0 => 1,
        EveryChoice::Time(time) => {
            let exact = time / step;
            // Saturates where the interval is longer than any run.
            let whole = exact.round().max(1.0) as u64;
            if (exact - whole as f64).abs() > 1e-6 * exact.max(1.0) {
                let interval = whole as f64 * step;
                builder.warning(
                    every.span.clone(),
                    format!(
                        "`every` of {time} s is {exact:.3} steps; every {whole} steps, {interval:.6e} s, are written"
                    ),
                    "entries lie on whole steps",
                );
            }
            whole
        }
    }
}

fn series(
    builder: &mut Builder<'_>,
    columns: Option<&[Spanned<String>]>,
    rotation: bool,
    event: bool,
) -> Vec<String> {
    let Some(columns) = columns else {
        let soft = ["kinetic_energy", "rotational_energy", "contacts", "maximum_overlap", "maximum_speed"];
        let hard =
            ["kinetic_energy", "rotational_energy", "collisions", "overlapping_collisions", "maximum_speed"];
        return (if event { hard } else { soft })
            .into_iter()
            .filter(|name| rotation || *name != "rotational_energy")
            .map(str::to_string)
            .collect();
    };
    let known: Vec<&str> = SERIES.iter().map(|(name, _, _)| *name).collect();
    let mut seen: BTreeSet<&str> = BTreeSet::new();
    for column in columns {
        if !known.contains(&column.value.as_str()) {
            let help = suggestion("quantities", &column.value, &known);
            builder.error_help(column.span.clone(), format!("there is no quantity `{}`", column.value), help);
        } else if !event && EVENT.contains(&column.value.as_str())
            || event && SOFT.contains(&column.value.as_str())
        {
            let (has, other) = if event { ("Event", "TimeStep") } else { ("TimeStep", "Event") };
            builder.error_help(
                column.span.clone(),
                format!("the driver `{has}` has no `{}`", column.value),
                format!("it is a quantity of `driver: {other}`"),
            );
        } else if !seen.insert(&column.value) {
            builder.error(column.span.clone(), format!("quantity `{}` is given twice", column.value));
        }
    }
    columns.iter().map(|column| column.value.clone()).collect()
}
