//! The surface that bodies roll and slide on.

use std::f64::consts::FRAC_PI_2;

use granule_units::Dimension;

use super::{contacts, walls};
use crate::reader::{Allowed, Reader};
use crate::scene::{RollingTable, Spanned, SubstrateBlock};
use crate::spec;
use crate::syntax::Node;

/// The block.
pub fn block(r: &mut Reader, node: Node<'_>) -> Option<SubstrateBlock> {
    let start = node.span().start;
    let f = r.block(Some(node), &spec::SUBSTRATE, start..start + 1)?;
    let height =
        r.optional(&f, "height", |r, name, node| r.quantity(name, node, Dimension::LENGTH, Allowed::Any));
    let motion = r.optional(&f, "motion", walls::motion);
    let inclination = r.optional(&f, "inclination", |r, name, node| {
        let angle = r.quantity(name, node, Dimension::DIMENSIONLESS, Allowed::Any)?;
        if angle.value.abs() >= FRAC_PI_2 {
            r.error(
                node.span(),
                format!("`{name}` must be between -90 and 90 deg, not {}", node.quoted()),
                "",
            );
            return None;
        }
        Some(angle)
    });
    let confined = r.optional(&f, "confined", Reader::boolean);
    let restitution = r.optional(&f, "restitution", |r, name, node| {
        let value = r.quantity(name, node, Dimension::DIMENSIONLESS, Allowed::NonNegative)?;
        if value.value > 1.0 {
            r.error(node.span(), format!("`{name}` must be at most 1, not {}", node.quoted()), "");
            return None;
        }
        Some(value)
    });
    let laws = r.required(&f, "laws", |r, name, node| {
        let laws: Vec<_> = r
            .named(name, node)?
            .into_iter()
            .map(|(material, node)| contacts::law(r, "law", node).map(|law| (material, law)))
            .collect();
        laws.into_iter().collect::<Option<Vec<_>>>()
    });
    let rolling_friction = r.optional(&f, "rolling_friction", |r, name, node| {
        let tables: Vec<_> = r
            .named(name, node)?
            .into_iter()
            .map(|(material, node)| table(r, name, node).map(|table| (material, table)))
            .collect();
        tables.into_iter().collect::<Option<Vec<_>>>()
    });
    Some(SubstrateBlock {
        height: height?,
        motion: motion?,
        inclination: inclination?,
        confined: confined?.unwrap_or(true),
        restitution: restitution?,
        laws: laws?,
        rolling_friction: rolling_friction?.unwrap_or_default(),
        span: node.span(),
    })
}

fn table(r: &mut Reader, name: &str, node: Node<'_>) -> Option<RollingTable> {
    const USE: &str = "as in `[(0, 1e-3), (\"0.1 m/s\", 2e-3)]`";
    let rows = r.list(name, node)?;
    if rows.is_empty() {
        r.error(node.span(), format!("`{name}` must have at least one row"), USE);
        return None;
    }
    let rows: Vec<Option<(Spanned<f64>, Spanned<f64>)>> = rows
        .into_iter()
        .map(|row| {
            let Some(pair) = row.items().filter(|pair| pair.len() == 2) else {
                let message = format!("expected a velocity and a coefficient, not `{}`", row.quoted());
                r.error(row.span(), message, USE);
                return None;
            };
            let speed = r.quantity("velocity", pair[0], Dimension::VELOCITY, Allowed::NonNegative);
            let friction = r.quantity(name, pair[1], Dimension::DIMENSIONLESS, Allowed::NonNegative);
            speed.zip(friction)
        })
        .collect();
    let rows: RollingTable = rows.into_iter().collect::<Option<_>>()?;
    for pair in rows.windows(2) {
        if pair[1].0.value <= pair[0].0.value {
            r.error(pair[1].0.span.clone(), "the velocities of a table must increase", "");
            return None;
        }
    }
    Some(rows)
}
