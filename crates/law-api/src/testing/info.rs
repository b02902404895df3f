//! Check `info`: what a law says about itself.

use super::Report;
use crate::{Columns, LawEntry, LawInfo, ParamSpec, Params, Slot};

pub(super) fn check(law: &LawEntry, report: &mut Report) {
    let info = law.info;
    let mut wrong = Vec::new();
    if !is_camel_case(info.name) {
        wrong.push(format!("the name `{}` is not a CamelCase identifier", info.name));
    }
    for (what, text) in [("summary", info.summary), ("formula", info.formula)] {
        if text.trim().is_empty() {
            wrong.push(format!("the {what} is empty"));
        }
    }
    if info.sources.is_empty() {
        wrong.push("no source is given".to_string());
    }
    for source in info.sources {
        if source.work.trim().is_empty() || source.place.trim().is_empty() {
            wrong.push(format!("a source lacks its work or place: {source:?}"));
        }
    }
    columns(info, &mut wrong);
    history(info, &mut wrong);
    parameters(info, &mut wrong);
    examples(law, &mut wrong);
    for message in wrong {
        report.fail("info", message);
    }
}

fn columns(info: &LawInfo, wrong: &mut Vec<String>) {
    let outputs = Columns::NORMAL_FORCE
        .and(Columns::NORMAL_STIFFNESS)
        .and(Columns::NORMAL_DAMPING)
        .and(Columns::TANGENTIAL_FORCE)
        .and(Columns::TORQUE);
    let (must, may) = match info.slot {
        Slot::Normal => (Columns::NORMAL_FORCE, Columns::NORMAL_STIFFNESS.and(Columns::NORMAL_DAMPING)),
        Slot::Cohesion => (Columns::NORMAL_FORCE, Columns::NONE),
        Slot::Tangential => (Columns::TANGENTIAL_FORCE, Columns::NONE),
        Slot::Rolling | Slot::Torsion => (Columns::TORQUE, Columns::NONE),
        Slot::Collision => (Columns::NONE, Columns::NONE),
    };
    if !info.writes.contains(must) || !must.and(may).contains(info.writes) {
        wrong.push(format!(
            "a {} law writes {:?} and may write {:?}, but this one declares {:?}",
            info.slot.name(),
            must.names(),
            may.names(),
            info.writes.names()
        ));
    }
    if info.slot == Slot::Normal && !info.reads.without(outputs).contains(info.reads) {
        wrong.push(format!("a normal law runs first and cannot read {:?}", info.reads.names()));
    }
}

fn history(info: &LawInfo, wrong: &mut Vec<String>) {
    for (index, column) in info.history.iter().enumerate() {
        if !is_snake_case(column.name) {
            wrong.push(format!("the history column `{}` is not in snake_case", column.name));
        }
        if column.components != 1 && column.components != 3 {
            wrong.push(format!(
                "the history column `{}` has {} components instead of 1 or 3",
                column.name, column.components
            ));
        }
        if info.history[..index].iter().any(|earlier| earlier.name == column.name) {
            wrong.push(format!("the history column `{}` is declared twice", column.name));
        }
    }
}

fn parameters(info: &LawInfo, wrong: &mut Vec<String>) {
    for (index, spec) in info.parameters.iter().enumerate() {
        if !is_snake_case(spec.name) {
            wrong.push(format!("the parameter `{}` is not in snake_case", spec.name));
        }
        if spec.doc.trim().is_empty() || spec.symbol.trim().is_empty() {
            wrong.push(format!("the parameter `{}` lacks its document or symbol", spec.name));
        }
        if info.parameters[..index].iter().any(|earlier| earlier.name == spec.name) {
            wrong.push(format!("the parameter `{}` is declared twice", spec.name));
        }
        let used = info.forms.iter().any(|form| {
            form.required.iter().any(|other| other.name == spec.name)
                || form.optional.iter().any(|(other, _)| other.name == spec.name)
        });
        if !used {
            wrong.push(format!("the parameter `{}` belongs to no form", spec.name));
        }
    }
    if info.forms.is_empty() {
        wrong.push("there is no form of parameters".to_string());
    }
    let known = |spec: &ParamSpec| info.parameters.iter().any(|other| other.name == spec.name);
    for form in info.forms {
        if form.doc.trim().is_empty() {
            wrong.push(format!("the form {} lacks its document", form.describe()));
        }
        for spec in form.required.iter().copied().chain(form.optional.iter().map(|(spec, _)| *spec)) {
            if !known(spec) {
                wrong.push(format!(
                    "the form {} uses `{}`, which is not declared",
                    form.describe(),
                    spec.name
                ));
            }
        }
        for (spec, default) in form.optional {
            if !spec.range.contains(*default) {
                wrong.push(format!("the default {default} of `{}` is out of its range", spec.name));
            }
        }
    }
}

fn examples(law: &LawEntry, wrong: &mut Vec<String>) {
    let info = law.info;
    let mut covered = vec![false; info.forms.len()];
    for example in info.examples {
        match Params::new(info, example) {
            Ok(params) => {
                covered[params.form()] = true;
                if !info.reads.contains((law.reads)(&params)) {
                    wrong
                        .push(format!("the example {example:?} reads columns that the law does not declare"));
                }
                if (law.dissipative)(&params) && !info.dissipative {
                    wrong.push(format!("the example {example:?} promises dissipation, the law does not"));
                }
            }
            Err(errors) => {
                let errors: Vec<String> = errors.iter().map(ToString::to_string).collect();
                wrong.push(format!("the example {example:?} is not valid: {}", errors.join("; ")));
            }
        }
    }
    for (form, covered) in info.forms.iter().zip(covered) {
        if !covered {
            wrong.push(format!("no example uses the form {}", form.describe()));
        }
    }
}

fn is_camel_case(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_uppercase()) && name.chars().all(|c| c.is_ascii_alphanumeric())
}

fn is_snake_case(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
}
