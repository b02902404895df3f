//! Laws of one contact block: names, slots, parameters, and whether each finds what it reads.

use std::panic::{AssertUnwindSafe, catch_unwind};

use granule_law_api::probe::{self, Fault};
use granule_law_api::{
    Columns, ContactEnd, LawEntry, LawError, PairContext, ParamSpec, Params, RegistryError, Slot,
};
use granule_scene::{ContactBlock, ContactEndChoice, LawBlock, ParameterValue, suggestion};
use granule_units::parse_as;

use crate::build::Builder;
use crate::place::SHIPPED;

/// Columns that exist for every contact.
const GEOMETRY: Columns = Columns::NORMAL_VELOCITY
    .and(Columns::TANGENTIAL_VELOCITY)
    .and(Columns::RELATIVE_SPIN)
    .and(Columns::REDUCED_MASS)
    .and(Columns::REDUCED_RADIUS);

/// A law with checked parameters, and where it stands.
pub(super) struct Chosen<'s> {
    pub entry: &'static LawEntry,
    pub params: Params,
    pub block: &'s LawBlock,
}

fn slot_of(name: &str) -> Option<Slot> {
    Slot::ALL.into_iter().find(|slot| slot.name() == name)
}

/// The laws of a block; `None` if any is wrong.
pub(super) fn check_laws<'s>(builder: &mut Builder<'_>, block: &'s ContactBlock) -> Option<Vec<Chosen<'s>>> {
    let mut chosen = Vec::new();
    let mut good = true;
    for (slot, law) in &block.laws {
        match check_law(builder, slot, law) {
            Some(law) => chosen.push(law),
            None => good = false,
        }
    }
    if !good {
        return None;
    }
    let mut written = GEOMETRY;
    for law in &chosen {
        let info = law.entry.info;
        let missing = (law.entry.reads)(&law.params).without(written);
        if !missing.is_empty() {
            let message = format!(
                "{} reads the {}, which no law before it computes",
                info.name,
                missing.names().join(" and the ")
            );
            let help = if written.contains(Columns::NORMAL_FORCE) {
                "choose another normal law, or other parameters"
            } else {
                "a contact with this law needs a `normal` law too"
            };
            builder.error_help(law.block.name.span.clone(), message, help);
            good = false;
        }
        written = written.and(info.writes);
        let end = contact_end(block);
        if !info.contact_ends.is_empty() && !info.contact_ends.contains(&end) {
            let span = block.contact_end.as_ref().map_or(&law.block.name.span, |end| &end.span);
            let known: Vec<&str> = info.contact_ends.iter().map(|end| end_name(*end)).collect();
            builder.error_help(
                span.clone(),
                format!("{} cannot have the contact end {}", info.name, end_name(end)),
                format!("set `contact_end: {}`", known.join("` or `")),
            );
            good = false;
        }
    }
    let turns = Columns::TANGENTIAL_FORCE.and(Columns::TORQUE).and(Columns::NORMAL_FORCE);
    let idle = chosen.iter().all(|law| law.entry.info.writes.without(turns) == law.entry.info.writes);
    if good && idle && !chosen.is_empty() {
        builder.error(block.span.clone(), "none of these laws makes a force");
        good = false;
    }
    good.then_some(chosen)
}

pub(super) fn contact_end(block: &ContactBlock) -> ContactEnd {
    match block.contact_end.as_ref().map(|end| end.value) {
        Some(ContactEndChoice::Overlap) => ContactEnd::Overlap,
        Some(ContactEndChoice::Force) | None => ContactEnd::Force,
    }
}

fn end_name(end: ContactEnd) -> &'static str {
    match end {
        ContactEnd::Force => "Force",
        ContactEnd::Overlap => "Overlap",
    }
}

fn check_law<'s>(builder: &mut Builder<'_>, slot: &str, law: &'s LawBlock) -> Option<Chosen<'s>> {
    let entry = match builder.registry.get(&law.name.value) {
        Ok(entry) => entry,
        Err(RegistryError::Unknown { name, known, .. }) => {
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            let help = suggestion("laws", &name, &known);
            builder.error_help(law.name.span.clone(), format!("there is no law `{name}`"), help);
            return None;
        }
        Err(error) => {
            builder.error(law.name.span.clone(), error.to_string());
            return None;
        }
    };
    let info = entry.info;
    if slot_of(slot) != Some(info.slot) {
        let fitting: Vec<&str> = builder
            .registry
            .entries()
            .iter()
            .filter(|entry| slot_of(slot) == Some(entry.info.slot))
            .map(|entry| entry.info.name)
            .collect();
        builder.error_help(
            law.name.span.clone(),
            format!("{} is a {} law, not a {slot} law", info.name, info.slot.name()),
            format!(
                "{slot} laws: {}",
                if fitting.is_empty() { "none".to_string() } else { fitting.join(", ") }
            ),
        );
        return None;
    }
    let given = given_parameters(builder, law, info.name, info.parameters)?;
    match Params::new(info, &given) {
        Ok(params) => Some(Chosen { entry, params, block: law }),
        Err(errors) => {
            for error in errors {
                law_error(builder, law, info.name, &error);
            }
            None
        }
    }
}

/// Values of the parameters of a law in SI units; `None` if any is unknown, repeated, unreadable or out of range.
pub(crate) fn given_parameters(
    builder: &mut Builder<'_>,
    law: &LawBlock,
    name_of_law: &str,
    parameters: &'static [&'static ParamSpec],
) -> Option<Vec<(&'static str, f64)>> {
    let mut good = true;
    let mut given: Vec<(&'static str, f64)> = Vec::new();
    for (index, (name, value)) in law.parameters.iter().enumerate() {
        let Some(spec) = parameters.iter().find(|spec| spec.name == name.value) else {
            let known: Vec<&str> = parameters.iter().map(|spec| spec.name).collect();
            let help = suggestion("parameters", &name.value, &known);
            builder.error_help(
                name.span.clone(),
                format!("{} has no parameter `{}`", name_of_law, name.value),
                help,
            );
            good = false;
            continue;
        };
        if law.parameters[..index].iter().any(|(earlier, _)| earlier.value == name.value) {
            builder.error(name.span.clone(), format!("parameter `{}` is given twice", name.value));
            good = false;
            continue;
        }
        let (number, text) = match &value.value {
            ParameterValue::Number(number) => (*number, number.to_string()),
            ParameterValue::Text(text) => match parse_as(text, spec.dimension) {
                Ok(number) => (number, format!("\"{text}\"")),
                Err(error) => {
                    builder.error(value.span.clone(), format!("`{}`: {error}", spec.name));
                    good = false;
                    continue;
                }
            },
        };
        if !spec.range.contains(number) {
            let range =
                if number.is_finite() { spec.range.describe() } else { finite(spec.range.describe()) };
            builder.error_help(
                value.span.clone(),
                format!("`{}` must be {range}, not {text}", spec.name),
                format!("{} in {}: {}", spec.symbol, spec.dimension, spec.doc),
            );
            good = false;
            continue;
        }
        given.push((spec.name, number));
    }
    good.then_some(given)
}

fn finite(range: String) -> String {
    if range.contains("finite") { range } else { format!("finite and {range}") }
}

/// Reports what a law says, at the parameter that it blames.
pub(crate) fn law_error(builder: &mut Builder<'_>, law: &LawBlock, name: &str, error: &LawError) {
    let blamed = error
        .parameter
        .as_ref()
        .and_then(|parameter| law.parameters.iter().find(|(name, _)| name.value == *parameter));
    let span = blamed.map_or(&law.name.span, |(_, value)| &value.span);
    let message = match &error.parameter {
        Some(parameter) => format!("{name}: `{parameter}` {}", error.message),
        None if error.message.starts_with(name) => error.message.clone(),
        None => format!("{name}: {}", error.message),
    };
    let diagnostic = granule_scene::Diagnostic::error(span.clone(), message);
    builder.diagnostics.push(match &error.help {
        Some(help) => diagnostic.help(help.clone()),
        None => diagnostic,
    });
}

/// Tries a law of somebody else with the parameters and bodies of the scene: one that gives no numbers or creates energy is an
/// error before the run. Shipped laws are held to it by their tests. A law that panics here does so in the run, where it ends.
pub(crate) fn keeps_its_promises(
    builder: &mut Builder<'_>,
    block: &LawBlock,
    entry: &'static LawEntry,
    params: &Params,
    context: &PairContext,
) {
    if entry.crate_name.starts_with(SHIPPED) {
        return;
    }
    let found = catch_unwind(AssertUnwindSafe(|| probe::try_out(entry, params, context)));
    if let Ok(Err(fault)) = found {
        misbehaves(builder, block, entry.info.name, &fault);
    }
}

/// Names a law at fault.
pub(crate) fn misbehaves(builder: &mut Builder<'_>, block: &LawBlock, name: &str, fault: &Fault) {
    let message = format!("the law {name} {fault}");
    // Once, whatever the number of pairs that it is for.
    if builder.diagnostics.iter().any(|known| known.message == message) {
        return;
    }
    builder.error_help(
        block.name.span.clone(),
        message,
        "this is a fault of the law, to be reported to its author; `granule_law_api::testing` shows it there",
    );
}
