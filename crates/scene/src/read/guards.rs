//! What is watched during a run.

use granule_units::Dimension;

use crate::reader::{Allowed, Reader};
use crate::scene::{GuardChoice, GuardsBlock, Spanned};
use crate::spec;
use crate::syntax::Node;

/// `guards: (..)`.
pub fn block(r: &mut Reader, node: Node<'_>) -> Option<GuardsBlock> {
    let f = r.block(Some(node), &spec::GUARDS, node.span())?;
    let overlap = r.optional(&f, "overlap", guard);
    let travel = r.optional(&f, "travel", guard);
    let lost = r.optional(&f, "lost", guard);
    let energy = r.optional(&f, "energy", guard);
    Some(GuardsBlock { overlap: overlap?, travel: travel?, lost: lost?, energy: energy? })
}

/// `Stop(0.5)`, `Warn(0.5)` or `Off`.
fn guard(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Spanned<GuardChoice>> {
    let variant = r.variant(name, node, &["Stop", "Warn", "Off"])?;
    let choice = match (variant.name, variant.content) {
        ("Off", None) => GuardChoice::Off,
        (kind @ ("Stop" | "Warn"), Some(content)) => {
            let inner =
                content.items().filter(|items| items.len() == 1).and_then(|items| items.into_iter().next());
            let Some(inner) = inner else {
                r.error(
                    content.span(),
                    format!("`{kind}` takes one number"),
                    format!("as in {name}: {kind}(0.5)"),
                );
                return None;
            };
            let limit = r.quantity(name, inner, Dimension::DIMENSIONLESS, Allowed::Positive)?.value;
            if kind == "Stop" { GuardChoice::Stop(limit) } else { GuardChoice::Warn(limit) }
        }
        (kind, _) => {
            r.error(
                node.span(),
                format!("`{kind}` takes {}", if kind == "Off" { "nothing" } else { "a limit" }),
                format!("as in {name}: Stop(0.5), {name}: Warn(0.5) or {name}: Off"),
            );
            return None;
        }
    };
    Some(Spanned::new(choice, node.span()))
}
