//! Laws between materials.

use std::ops::Range;

use super::{Blocks, keep};
use crate::reader::Reader;
use crate::scene::{ContactBlock, ContactEndChoice, LawBlock, ParameterValue, Spanned};
use crate::spec;
use crate::syntax::Node;

/// Slots of a composition, in the order of execution.
const SLOTS: [&str; 5] = ["normal", "cohesion", "tangential", "rolling", "torsion"];

/// The list of contacts.
pub fn list(r: &mut Reader, node: Node<'_>) -> Option<Blocks<ContactBlock>> {
    let items = r.list("contacts", node)?;
    Some(keep(items.into_iter().map(|item| contact(r, item)).collect()))
}

fn contact(r: &mut Reader, node: Node<'_>) -> Option<ContactBlock> {
    let start = node.span().start;
    let f = r.block(Some(node), &spec::CONTACT, start..start + 1)?;
    let between = r.required(&f, "between", |r, name, node| {
        let Some(pair) = node.items().filter(|pair| pair.len() == 2) else {
            let message = format!("`{name}` must be two names of materials, not `{}`", node.quoted());
            r.error(node.span(), message, "as in (\"glass\", \"steel\")");
            return None;
        };
        let (first, second) = (r.string("material", pair[0]), r.string("material", pair[1]));
        first.zip(second)
    });
    let laws: Vec<_> =
        SLOTS.iter().map(|slot| r.optional(&f, slot, law).map(|law| law.map(|law| (*slot, law)))).collect();
    let collision = r.optional(&f, "collision", law);
    let contact_end = r.optional(&f, "contact_end", |r, name, node| {
        r.choice(name, node, &[("Force", ContactEndChoice::Force), ("Overlap", ContactEndChoice::Overlap)])
    });
    let laws: Vec<Option<_>> = laws.into_iter().collect::<Option<_>>()?;
    Some(ContactBlock {
        between: between?,
        laws: laws.into_iter().flatten().collect(),
        collision: collision?,
        contact_end: contact_end?,
        span: node.span(),
    })
}

pub(super) fn law(r: &mut Reader, slot: &str, node: Node<'_>) -> Option<LawBlock> {
    let Some((name, span, content)) = node.variant() else {
        r.error(
            node.span(),
            format!("`{slot}` must be a law such as `Name(parameter: value)`, not `{}`", node.quoted()),
            "",
        );
        return None;
    };
    let name = Spanned::new(name.to_string(), span);
    let Some(content) = content else {
        return Some(LawBlock { name, parameters: Vec::new(), span: node.span() });
    };
    let empty = content.items().is_some_and(|items| items.is_empty());
    let Some(entries) = content.fields().or_else(|| empty.then(Vec::new)) else {
        let message = format!("parameters of `{}` need names, as in `(stiffness: 1e5)`", name.value);
        r.error(content.span(), message, "");
        return None;
    };
    let mut parameters: Vec<(Spanned<String>, Spanned<ParameterValue>)> = Vec::new();
    let mut good = true;
    for entry in entries {
        let value = entry
            .value
            .string()
            .map(ParameterValue::Text)
            .or_else(|| entry.value.number().map(ParameterValue::Number));
        match value {
            Some(value) => parameters
                .push((Spanned::new(entry.name, entry.span), Spanned::new(value, entry.value.span()))),
            None => {
                good = false;
                let quoted = entry.value.quoted();
                let message =
                    format!("`{}` must be a number or a text with a unit, not `{quoted}`", entry.name);
                r.error(entry.value.span(), message, "");
            }
        }
    }
    let span: Range<usize> = node.span();
    good.then_some(LawBlock { name, parameters, span })
}
