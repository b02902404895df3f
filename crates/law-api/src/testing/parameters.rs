//! Check `parameters`: at the corners of their ranges, alone and together, a law refuses or answers with numbers.

use std::panic::{AssertUnwindSafe, catch_unwind};

use super::pointwise::{STEP, Sequence, corners};
use super::{Case, Report, contexts, describe};
use crate::{Bound, Form, LawEntry, ParamSpec, Params};

/// Values that are tried wherever the range allows them. Products of four of them with the largest motions are still numbers.
const VALUES: [f64; 10] =
    [0.0, 1e-60, 1e-12, 1e-3, 0.999_999_999_999_999_9, 1.0, 1e3, 1e12, 1e60, f64::INFINITY];
/// Random choices of all parameters together, for each form.
const CHOICES: usize = 40;

pub(super) fn check(law: &LawEntry, report: &mut Report) {
    for form in law.info.forms {
        let mut random = Sequence::new(3);
        for _ in 0..CHOICES {
            let given = choose(form, &mut random);
            // Some parameters exclude each other, which the law says.
            let Ok(params) = Params::new(law.info, &given) else { continue };
            for pair in contexts(law) {
                let case = Case { law, params: &params, pair: &pair };
                let found = catch_unwind(AssertUnwindSafe(|| not_a_number(&case)));
                let message = match found {
                    Ok(None) => continue,
                    Ok(Some(message)) => message,
                    Err(_) => "it panics".to_string(),
                };
                report.case = describe(&given, pair.contact_end, pair.normal);
                report.fail("parameters", message);
                report.case = String::new();
                return;
            }
        }
    }
}

/// Every required parameter, and every second optional one, at some corner.
fn choose(form: &Form, random: &mut Sequence) -> Vec<(&'static str, f64)> {
    let mut given = Vec::new();
    let optional = form.optional.iter().map(|(spec, _)| (*spec, true));
    for (spec, optional) in form.required.iter().map(|spec| (*spec, false)).chain(optional) {
        if optional && random.next() < 0.0 {
            continue;
        }
        let values = allowed(spec);
        let at = ((random.next() + 1.0) / 2.0 * values.len() as f64) as usize;
        given.extend(values.get(at.min(values.len().saturating_sub(1))).map(|value| (spec.name, *value)));
    }
    given
}

fn allowed(spec: &ParamSpec) -> Vec<f64> {
    let ends = [spec.range.low, spec.range.high].into_iter().filter_map(|bound| match bound {
        Bound::Inclusive(limit) | Bound::Exclusive(limit) if limit != 0.0 => Some(limit),
        _ => None,
    });
    let ends = ends.flat_map(|limit| [limit, limit.next_up(), limit.next_down()]);
    let both = VALUES.into_iter().chain(VALUES.map(|value| -value)).chain(ends);
    both.filter(|value| spec.range.contains(*value)).collect()
}

/// The first output that is no number, if the law takes the parameters. Infinity is one: a stiffness of 1e60 N/m has forces
/// beyond the range of numbers.
fn not_a_number(case: &Case<'_>) -> Option<String> {
    let stage = (case.law.compile_f64)(case.params, case.pair).ok()?;
    let mut contacts = corners::<f64>(case.law.info.history_width());
    for step in [STEP, 0.0] {
        contacts.run(&*stage, step);
        for (name, _, column) in contacts.outputs() {
            if let Some(k) = column.iter().position(|value| value.is_nan()) {
                return Some(format!("{name} becomes no number for {}", contacts.describe(k)));
            }
        }
    }
    None
}
