//! Walls and their motion.

use std::f64::consts::PI;

use granule_units::Dimension;

use super::{Blocks, keep};
use crate::reader::{Allowed, Fields, Reader, Variant};
use crate::scene::{MotionChoice, Spanned, Vector, WallBlock, WallShape};
use crate::spec::{self, Block};
use crate::suggestion;
use crate::syntax::Node;

const FACES: [&str; 6] = ["x-", "x+", "y-", "y+", "z-", "z+"];

/// The map of walls.
pub fn map(r: &mut Reader, node: Node<'_>) -> Option<Blocks<WallBlock>> {
    let named = r.named("walls", node)?;
    Some(keep(named.into_iter().map(|(name, node)| wall(r, name, node)).collect()))
}

fn point(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Vector> {
    r.vector(name, node, Dimension::LENGTH, Allowed::Any)
}

fn direction(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Vector> {
    let vector = r.vector(name, node, Dimension::DIMENSIONLESS, Allowed::Any)?;
    if vector.components.iter().all(|component| component.value == 0.0) {
        r.error(vector.span, format!("`{name}` must not be the zero vector"), "");
        return None;
    }
    Some(vector)
}

fn wall(r: &mut Reader, name: Spanned<String>, node: Node<'_>) -> Option<WallBlock> {
    let variant = r.variant("wall", node, &["Plane", "Box", "Cylinder"])?;
    let spec: &'static Block = match variant.name {
        "Plane" => &spec::PLANE,
        "Box" => &spec::BOX,
        _ => &spec::CYLINDER,
    };
    let f = r.block(variant.content, spec, variant.span.clone())?;
    let shape = match variant.name {
        "Plane" => {
            let (point, normal) = (r.required(&f, "point", point), r.required(&f, "normal", direction));
            point.zip(normal).map(|(point, normal)| WallShape::Plane { point, normal })
        }
        "Box" => box_shape(r, &f),
        _ => cylinder_shape(r, &f),
    };
    let material = r.required(&f, "material", Reader::string);
    let motion = r.optional(&f, "motion", motion);
    Some(WallBlock {
        name,
        material: material?,
        shape: shape?,
        motion: motion?.unwrap_or(Spanned::new(MotionChoice::Static, node.span())),
        span: node.span(),
    })
}

fn box_shape(r: &mut Reader, f: &Fields<'_>) -> Option<WallShape> {
    let (lo, hi) = (r.required(f, "lo", point), r.required(f, "hi", point));
    let open = r.optional(f, "open", |r, name, node| {
        let faces: Vec<Option<Spanned<String>>> = r
            .list(name, node)?
            .into_iter()
            .map(|item| {
                let face = r.string("face", item)?;
                if !FACES.contains(&face.value.as_str()) {
                    let message = format!("`{}` is not a face of a box", face.value);
                    r.error(face.span, message, suggestion("faces", &face.value, &FACES));
                    return None;
                }
                Some(face)
            })
            .collect();
        faces.into_iter().collect::<Option<Vec<_>>>()
    });
    let (lo, hi, open) = (lo?, hi?, open?);
    if lo.components.len() != hi.components.len() {
        r.error(hi.span, "`hi` must have as many components as `lo`", "");
        return None;
    }
    for (low, high) in lo.components.iter().zip(&hi.components) {
        if low.value >= high.value {
            r.error(
                high.span.clone(),
                format!("the upper bound {} m must be above the lower bound {} m", high.value, low.value),
                "",
            );
            return None;
        }
    }
    Some(WallShape::Box { lo, hi, open: open.unwrap_or_default() })
}

fn cylinder_shape(r: &mut Reader, f: &Fields<'_>) -> Option<WallShape> {
    let point = r.required(f, "point", point);
    let axis = r.optional(f, "axis", direction);
    let radius =
        r.required(f, "radius", |r, name, node| r.quantity(name, node, Dimension::LENGTH, Allowed::Positive));
    let inside = r.optional(f, "inside", Reader::boolean);
    Some(WallShape::Cylinder { point: point?, axis: axis?, radius: radius?, inside: inside?.unwrap_or(true) })
}

pub(super) fn motion(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Spanned<MotionChoice>> {
    let variant = r.variant(name, node, &["Static", "Constant", "Sinusoidal", "Table", "Rotation"])?;
    let span = node.span();
    let motion = match variant.name {
        "Static" => match variant.content {
            None => Some(MotionChoice::Static),
            Some(content) => {
                r.error(content.span(), "`Static` takes nothing in parentheses", "");
                None
            }
        },
        "Constant" => {
            let f = r.block(variant.content, &spec::CONSTANT, variant.span)?;
            let velocity = r.required(&f, "velocity", |r, name, node| {
                r.vector(name, node, Dimension::VELOCITY, Allowed::Any)
            });
            velocity.map(|velocity| MotionChoice::Constant { velocity })
        }
        "Sinusoidal" => sinusoidal(r, variant),
        "Table" => table(r, &variant),
        _ => {
            let f = r.block(variant.content, &spec::ROTATION, variant.span)?;
            let point = r.required(&f, "point", point);
            let axis = r.optional(&f, "axis", direction);
            let speed = r.required(&f, "angular_velocity", |r, name, node| {
                r.quantity(name, node, Dimension::ANGULAR_VELOCITY, Allowed::Any)
            });
            Some(MotionChoice::Rotation { point: point?, axis: axis?, angular_velocity: speed?.value })
        }
    };
    motion.map(|motion| Spanned::new(motion, span))
}

fn sinusoidal(r: &mut Reader, variant: Variant<'_>) -> Option<MotionChoice> {
    let at = variant.span.clone();
    let f = r.block(variant.content, &spec::SINUSOIDAL, variant.span)?;
    let amplitude = r.required(&f, "amplitude", point);
    let rate = |r: &mut Reader, name: &str, node: Node<'_>| {
        r.quantity(name, node, Dimension::RATE, Allowed::Positive)
    };
    let frequency = r.optional(&f, "frequency", rate);
    let angular = r.optional(&f, "angular_frequency", rate);
    let period =
        r.optional(&f, "period", |r, name, node| r.quantity(name, node, Dimension::TIME, Allowed::Positive));
    let phase = r.optional(&f, "phase", |r, name, node| {
        r.quantity(name, node, Dimension::DIMENSIONLESS, Allowed::Any)
    });
    let angular_frequency = match (frequency?, angular?, period?) {
        (Some(frequency), None, None) => 2.0 * PI * frequency.value,
        (None, Some(angular), None) => angular.value,
        (None, None, Some(period)) => 2.0 * PI / period.value,
        _ => {
            r.error(at, "`Sinusoidal` takes exactly one of frequency, angular_frequency, period", "");
            return None;
        }
    };
    Some(MotionChoice::Sinusoidal {
        amplitude: amplitude?,
        angular_frequency,
        phase: phase?.map_or(0.0, |phase| phase.value),
    })
}

fn table(r: &mut Reader, variant: &Variant<'_>) -> Option<MotionChoice> {
    const USE: &str = "as in `Table([(0, (0, 0, 0)), (\"1 s\", (0, 0, \"5 mm\"))])`";
    let rows = variant
        .content
        .and_then(|content| content.items())
        .filter(|items| items.len() == 1)
        .and_then(|items| items[0].items())
        .filter(|rows| !rows.is_empty());
    let Some(rows) = rows else {
        r.error(variant.span.clone(), "`Table` takes a list of times and displacements", USE);
        return None;
    };
    let rows: Vec<Option<(Spanned<f64>, Vector)>> = rows
        .into_iter()
        .map(|row| {
            let Some(pair) = row.items().filter(|pair| pair.len() == 2) else {
                r.error(
                    row.span(),
                    format!("expected a time and a displacement, not `{}`", row.quoted()),
                    USE,
                );
                return None;
            };
            let time = r.quantity("time", pair[0], Dimension::TIME, Allowed::Any);
            let displacement = point(r, "displacement", pair[1]);
            Some((time?, displacement?))
        })
        .collect();
    let rows: Vec<_> = rows.into_iter().collect::<Option<_>>()?;
    for pair in rows.windows(2) {
        if pair[1].0.value <= pair[0].0.value {
            r.error(pair[1].0.span.clone(), "the times of a table must increase", "");
            return None;
        }
    }
    Some(MotionChoice::Table(rows))
}
