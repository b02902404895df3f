//! The accuracy or the time that a scene asks for.

use granule_units::Dimension;

use crate::reader::{Allowed, Fields, Reader};
use crate::scene::{AccuracyBlock, AccuracyGoal};
use crate::spec;
use crate::syntax::Node;

/// `accuracy` or `budget` of a scene, which must not say what they choose.
pub fn goal(r: &mut Reader, f: &Fields<'_>) -> Option<Option<AccuracyBlock>> {
    let accuracy = r.optional(f, "accuracy", |r, _, node| accuracy(r, node))?;
    let budget = r.optional(f, "budget", |r, _, node| budget(r, node))?;
    let goal = match (accuracy, budget) {
        (Some(_), Some(budget)) => {
            r.error(
                budget.span,
                "a scene has either an `accuracy` or a `budget`",
                "`granule trade` shows both against each other",
            );
            return None;
        }
        (None, None) => return Some(None),
        (accuracy, budget) => accuracy.or(budget)?,
    };
    let name = goal.goal.field();
    let mut chosen = vec!["step", "integrator"];
    let driver = f.get("driver").and_then(|driver| driver.variant());
    if let Some(("Event", span, _)) = driver {
        r.error(
            span,
            format!("`{name}` chooses a time step, which the driver Event does not have"),
            "`driver: TimeStep()`, or no `driver`",
        );
        return None;
    }
    let mut given = Vec::new();
    if let Some((_, _, Some(content))) = driver {
        given.extend(
            content.fields().into_iter().flatten().filter(|field| chosen.contains(&field.name.as_str())),
        );
    }
    if goal.goal.table().is_some() {
        chosen.push("precision");
        given.extend(f.entries().into_iter().filter(|field| field.name == "precision"));
    }
    for field in &given {
        r.error(
            field.span.clone(),
            format!("`{}` is given, but `{name}` chooses it", field.name),
            format!("leave out either `{}` or `{name}`", field.name),
        );
    }
    given.is_empty().then_some(Some(goal))
}

fn positive(r: &mut Reader, name: &str, node: Node<'_>) -> Option<crate::Spanned<f64>> {
    r.quantity(name, node, Dimension::DIMENSIONLESS, Allowed::Positive)
}

fn accuracy(r: &mut Reader, node: Node<'_>) -> Option<AccuracyBlock> {
    let f = r.block(Some(node), &spec::ACCURACY, node.span())?;
    let restitution = r.optional(&f, "restitution", positive);
    let observable = r.optional(&f, "observable", Reader::string);
    let error = r.optional(&f, "error", positive);
    let table = r.optional(&f, "table", Reader::string);
    let goal = match (restitution?, observable?, error?, table?) {
        (Some(error), None, None, None) => AccuracyGoal::Restitution { error },
        (None, Some(observable), Some(error), Some(table)) => {
            AccuracyGoal::Observable { observable, error, table }
        }
        (None, Some(_), Some(_), None) => {
            r.error(
                node.span(),
                "the error of an observable is known from a table only",
                "`granule trade SCENE -o DIR` makes one; then `table: \"DIR\"`",
            );
            return None;
        }
        _ => {
            r.error(
                node.span(),
                "`accuracy` takes either `restitution`, or `observable`, `error` and `table`",
                "as in accuracy: (restitution: 1e-3)",
            );
            return None;
        }
    };
    Some(AccuracyBlock { goal, span: node.span() })
}

fn budget(r: &mut Reader, node: Node<'_>) -> Option<AccuracyBlock> {
    let f = r.block(Some(node), &spec::BUDGET, node.span())?;
    let seconds =
        r.required(&f, "seconds", |r, name, node| r.quantity(name, node, Dimension::TIME, Allowed::Positive));
    let table = r.optional(&f, "table", Reader::string);
    Some(AccuracyBlock { goal: AccuracyGoal::Budget { seconds: seconds?, table: table? }, span: node.span() })
}
