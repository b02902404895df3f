//! Changing single values in the text of a scene, so that comments, order and units of the rest stay as they are.

use std::ops::Range;

use crate::Diagnostic;
use crate::syntax::{Node, skip_blank};

/// The text with a field of a block set to a value: replaced where the field is, added where it is not. `block` names the
/// field of the scene that holds it and the kind to write if the block is missing, as in `("driver", "TimeStep")`; without
/// a block the field is one of the scene itself.
///
/// # Errors
/// The text is no RON.
pub fn set_field(
    text: &str,
    block: Option<(&str, &str)>,
    field: &str,
    value: &str,
) -> Result<String, Diagnostic> {
    let scene = Node::whole(text)?;
    let Some((name, kind)) = block else { return Ok(set_in(text, &scene, field, value)) };
    let existing = scene.fields().into_iter().flatten().find(|entry| entry.name == name);
    Ok(match existing {
        Some(entry) => match entry.value.variant() {
            Some((_, span, None)) => replaced(text, span.end..span.end, &format!("({field}: {value})")),
            Some((_, _, Some(content))) => set_in(text, &content, field, value),
            None => set_in(text, &entry.value, field, value),
        },
        None => set_in(text, &scene, name, &format!("{kind}({field}: {value})")),
    })
}

/// The text without a field of the scene, and without the comma behind it.
///
/// # Errors
/// The text is no RON.
pub fn remove_field(text: &str, field: &str) -> Result<String, Diagnostic> {
    let scene = Node::whole(text)?;
    let Some(entry) = scene.fields().into_iter().flatten().find(|entry| entry.name == field) else {
        return Ok(text.to_string());
    };
    let end = entry.value.span().end;
    let next = skip_blank(text, end);
    let end = if text[next..].starts_with(',') { next + 1 } else { end };
    Ok(replaced(text, entry.span.start..end, ""))
}

/// The text with other words at some places. The places must not overlap.
pub fn replace_all(text: &str, mut changes: Vec<(Range<usize>, String)>) -> String {
    changes.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
    changes.into_iter().fold(text.to_string(), |text, (span, value)| replaced(&text, span, &value))
}

fn replaced(text: &str, span: Range<usize>, value: &str) -> String {
    format!("{}{value}{}", &text[..span.start], &text[span.end..])
}

fn set_in(text: &str, node: &Node<'_>, field: &str, value: &str) -> String {
    let span = node.span();
    let fields = node.fields().unwrap_or_default();
    if let Some(entry) = fields.iter().find(|entry| entry.name == field) {
        return replaced(text, entry.value.span(), value);
    }
    match fields.last() {
        None => replaced(text, span.start + 1..span.start + 1, &format!("{field}: {value}")),
        Some(last) => {
            let end = last.value.span().end;
            // Behind the comma that follows the last field, if there is one.
            let next = skip_blank(text, end);
            let comma = text[next..].starts_with(',');
            let at = if comma { next + 1 } else { end };
            let line_end = text[at..].starts_with('\n');
            let space = if line_end { "\n    " } else { " " };
            let (before, after) = if comma { ("", ",") } else { (",", "") };
            replaced(text, at..at, &format!("{before}{space}{field}: {value}{after}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: Option<(&str, &str)> = Some(("driver", "TimeStep"));

    #[test]
    fn a_value_is_replaced_where_it_stands() {
        let text = "(version: 1, // one\n driver: TimeStep(step: 1e-5 /* s */, skin: 2), run: (steps: 1))";
        let set = set_field(text, STEP, "step", "Auto()").unwrap();
        assert_eq!(set, text.replace("1e-5", "Auto()"));
    }

    #[test]
    fn a_missing_field_is_added() {
        for (text, expected) in [
            ("(driver: TimeStep)", "(driver: TimeStep(step: 1))"),
            ("(driver: TimeStep())", "(driver: TimeStep(step: 1))"),
            ("(driver: TimeStep(skin: 2))", "(driver: TimeStep(skin: 2, step: 1))"),
            ("(driver: TimeStep(skin: 2,))", "(driver: TimeStep(skin: 2, step: 1,))"),
            ("(run: (steps: 1))", "(run: (steps: 1), driver: TimeStep(step: 1))"),
            ("(\n    run: 1,\n)", "(\n    run: 1,\n    driver: TimeStep(step: 1),\n)"),
        ] {
            assert_eq!(set_field(text, STEP, "step", "1").unwrap(), expected);
        }
        assert_eq!(set_field("(a: 1)", None, "b", "2").unwrap(), "(a: 1, b: 2)");
        assert_eq!(set_field("(a: 1)", None, "a", "2").unwrap(), "(a: 2)");
    }

    #[test]
    fn a_field_is_removed() {
        for (text, expected) in [
            ("(a: 1, b: (c: 2), d: 3)", "(a: 1,  d: 3)"),
            ("(b: x(1) , a: 1)", "( a: 1)"),
            ("(a: 1, b: 2)", "(a: 1, )"),
            ("(a: 1)", "(a: 1)"),
        ] {
            let removed = remove_field(text, "b").unwrap();
            assert_eq!(removed, expected);
            assert!(Node::whole(&removed).unwrap().fields().is_some(), "{removed}");
        }
    }

    #[test]
    fn several_places_change_at_once() {
        assert_eq!(replace_all("abcdef", vec![(1..2, "XX".into()), (4..6, String::new())]), "aXXcd");
    }
}
