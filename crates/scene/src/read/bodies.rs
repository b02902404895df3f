//! Blocks of bodies.

use std::ops::Range;

use granule_units::Dimension;

use super::{Blocks, keep};
use crate::reader::{Allowed, Fields, Reader, Variant};
use crate::scene::{
    BodyBlock, FillAmount, FillBlock, FrameChoice, ImportBlock, ImportFormat, LatticeBlock, LatticeKind,
    RadiusChoice, ShapeChoice, SingleBody, Spanned, Vector,
};
use crate::spec::{self, Block};
use crate::syntax::Node;

const KINDS: [&str; 7] = ["Sphere", "Disc", "HollowSphere", "Body", "Lattice", "Fill", "Import"];

/// The list of bodies.
pub fn list(r: &mut Reader, node: Node<'_>) -> Option<Blocks<BodyBlock>> {
    let items = r.list("bodies", node)?;
    Some(keep(items.into_iter().map(|item| block(r, item)).collect()))
}

fn block(r: &mut Reader, node: Node<'_>) -> Option<BodyBlock> {
    let variant = r.variant("bodies", node, &KINDS)?;
    match variant.name {
        "Lattice" => lattice(r, &variant, node.span()).map(BodyBlock::Lattice),
        "Fill" => fill(r, &variant, node.span()).map(BodyBlock::Fill),
        "Import" => import(r, &variant, node.span()).map(BodyBlock::Import),
        _ => single(r, &variant, node.span()).map(BodyBlock::Single),
    }
}

fn length(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Spanned<f64>> {
    r.quantity(name, node, Dimension::LENGTH, Allowed::Positive)
}

fn point(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Vector> {
    r.vector(name, node, Dimension::LENGTH, Allowed::Any)
}

fn velocity(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Vector> {
    r.vector(name, node, Dimension::VELOCITY, Allowed::Any)
}

fn spread(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Spanned<f64>> {
    r.quantity(name, node, Dimension::VELOCITY, Allowed::NonNegative)
}

fn spin(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Vector> {
    if node.items().is_some() {
        return r.vector(name, node, Dimension::ANGULAR_VELOCITY, Allowed::Any);
    }
    let about_z = r.quantity(name, node, Dimension::ANGULAR_VELOCITY, Allowed::Any)?;
    Some(Vector { span: about_z.span.clone(), components: vec![about_z] })
}

fn identity(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Spanned<u32>> {
    let id = r.whole(name, node, 1, u64::from(u32::MAX - 1))?;
    u32::try_from(id.value).ok().map(|value| Spanned::new(value, id.span))
}

fn shape(r: &mut Reader, name: &str, node: Node<'_>) -> Option<Spanned<ShapeChoice>> {
    let variant = r.variant(name, node, &["Sphere", "Disc", "HollowSphere", "Body"])?;
    let shape = match (variant.name, variant.content) {
        ("Body", Some(content)) => {
            let items = content.items().filter(|items| items.len() == 1);
            let Some(items) = items else {
                r.error(content.span(), "`Body` takes the inertia factor, as in `Body(0.4)`", "");
                return None;
            };
            let q =
                r.quantity("inertia factor", items[0], Dimension::DIMENSIONLESS, Allowed::PositiveUnit)?;
            ShapeChoice::Body(q.value)
        }
        ("Body", None) => {
            r.error(variant.span, "`Body` takes the inertia factor, as in `Body(0.4)`", "");
            return None;
        }
        (name, Some(content)) => {
            r.error(content.span(), format!("`{name}` takes nothing in parentheses"), "");
            return None;
        }
        ("Sphere", None) => ShapeChoice::Sphere,
        ("Disc", None) => ShapeChoice::Disc,
        (_, None) => ShapeChoice::HollowSphere,
    };
    Some(Spanned::new(shape, node.span()))
}

/// The default shape is a sphere; the plan makes it a disc in the plane.
fn shape_of(r: &mut Reader, f: &Fields<'_>) -> Option<Option<Spanned<ShapeChoice>>> {
    r.optional(f, "shape", shape)
}

fn single(r: &mut Reader, variant: &Variant<'_>, span: Range<usize>) -> Option<SingleBody> {
    let spec: &'static Block = match variant.name {
        "Sphere" => &spec::SPHERE,
        "Disc" => &spec::DISC,
        "HollowSphere" => &spec::HOLLOW,
        _ => &spec::BODY,
    };
    let f = r.block(variant.content, spec, variant.span.clone())?;
    let shape = match variant.name {
        "Sphere" => Some(ShapeChoice::Sphere),
        "Disc" => Some(ShapeChoice::Disc),
        "HollowSphere" => Some(ShapeChoice::HollowSphere),
        _ => r
            .required(&f, "inertia_factor", |r, name, node| {
                r.quantity(name, node, Dimension::DIMENSIONLESS, Allowed::PositiveUnit)
            })
            .map(|q| ShapeChoice::Body(q.value)),
    };
    let id = r.optional(&f, "id", identity);
    let material = r.required(&f, "material", Reader::string);
    let radius = r.required(&f, "radius", length);
    let mass =
        r.optional(&f, "mass", |r, name, node| r.quantity(name, node, Dimension::MASS, Allowed::Positive));
    let position = r.required(&f, "position", point);
    let velocity = r.optional(&f, "velocity", velocity);
    let spin = r.optional(&f, "spin", spin);
    let frozen = r.optional(&f, "frozen", Reader::boolean);
    Some(SingleBody {
        shape: Spanned::new(shape?, variant.span.clone()),
        id: id?,
        material: material?,
        radius: radius?,
        mass: mass?,
        position: position?,
        velocity: velocity?,
        spin: spin?,
        frozen: frozen?.unwrap_or(false),
        span,
    })
}

fn lattice(r: &mut Reader, variant: &Variant<'_>, span: Range<usize>) -> Option<LatticeBlock> {
    let f = r.block(variant.content, &spec::LATTICE, variant.span.clone())?;
    let shape = shape_of(r, &f);
    let material = r.required(&f, "material", Reader::string);
    let radius = r.required(&f, "radius", length);
    let kind = r.optional(&f, "kind", |r, name, node| {
        r.choice(
            name,
            node,
            &[
                ("Cubic", LatticeKind::Cubic),
                ("FaceCentred", LatticeKind::FaceCentred),
                ("Hexagonal", LatticeKind::Hexagonal),
            ],
        )
    });
    let spacing = r.required(&f, "spacing", length);
    let lo = r.required(&f, "lo", point);
    let hi = r.required(&f, "hi", point);
    let jitter = r.optional(&f, "jitter", |r, name, node| {
        r.quantity(name, node, Dimension::LENGTH, Allowed::NonNegative)
    });
    let velocity = r.optional(&f, "velocity", velocity);
    let velocity_spread = r.optional(&f, "velocity_spread", spread);
    let frozen = r.optional(&f, "frozen", Reader::boolean);
    Some(LatticeBlock {
        shape: shape?,
        material: material?,
        radius: radius?,
        kind: kind?.unwrap_or(Spanned::new(LatticeKind::Cubic, variant.span.clone())),
        spacing: spacing?,
        lo: lo?,
        hi: hi?,
        jitter: jitter?,
        velocity: velocity?,
        velocity_spread: velocity_spread?,
        frozen: frozen?.unwrap_or(false),
        span,
    })
}

fn fill(r: &mut Reader, variant: &Variant<'_>, span: Range<usize>) -> Option<FillBlock> {
    let f = r.block(variant.content, &spec::FILL, variant.span.clone())?;
    let shape = shape_of(r, &f);
    let material = r.required(&f, "material", Reader::string);
    let radius = r.required(&f, "radius", radii);
    let count = r.optional(&f, "count", |r, name, node| r.whole(name, node, 1, 100_000_000));
    let fraction = r.optional(&f, "volume_fraction", |r, name, node| {
        r.quantity(name, node, Dimension::DIMENSIONLESS, Allowed::InsideUnit)
    });
    let lo = r.required(&f, "lo", point);
    let hi = r.required(&f, "hi", point);
    let velocity = r.optional(&f, "velocity", velocity);
    let velocity_spread = r.optional(&f, "velocity_spread", spread);
    let amount = match (count?, fraction?) {
        (Some(count), None) => {
            FillAmount::Count(Spanned::new(u32::try_from(count.value).unwrap_or(u32::MAX), count.span))
        }
        (None, Some(fraction)) => FillAmount::VolumeFraction(fraction),
        (count, _) => {
            let message = match count {
                Some(_) => "give `count` or `volume_fraction`, not both",
                None => "missing field `count` or `volume_fraction` in Fill",
            };
            r.error(variant.span.clone(), message, "");
            return None;
        }
    };
    Some(FillBlock {
        shape: shape?,
        material: material?,
        radius: radius?,
        amount,
        lo: lo?,
        hi: hi?,
        velocity: velocity?,
        velocity_spread: velocity_spread?,
        span,
    })
}

fn radii(r: &mut Reader, name: &str, node: Node<'_>) -> Option<RadiusChoice> {
    if node.variant().is_none() || node.number().is_some() {
        return length(r, name, node).map(RadiusChoice::Fixed);
    }
    let variant = r.variant(name, node, &["Uniform", "Normal", "Mixture"])?;
    match variant.name {
        "Uniform" => {
            let f = r.block(variant.content, &spec::UNIFORM, variant.span)?;
            let (min, max) = (r.required(&f, "min", length), r.required(&f, "max", length));
            let (min, max) = (min?, max?);
            if min.value > max.value {
                r.error(max.span, format!("`max` must be at least `min`, {} m", min.value), "");
                return None;
            }
            Some(RadiusChoice::Uniform { min, max })
        }
        "Normal" => {
            let f = r.block(variant.content, &spec::NORMAL, variant.span)?;
            let (mean, deviation) =
                (r.required(&f, "mean", length), r.required(&f, "standard_deviation", length));
            let (mean, standard_deviation) = (mean?, deviation?);
            if 3.0 * standard_deviation.value >= mean.value {
                r.error(
                    standard_deviation.span,
                    "`standard_deviation` must be less than a third of `mean`",
                    "radii down to three standard deviations below the mean must be greater than 0",
                );
                return None;
            }
            Some(RadiusChoice::Normal { mean, standard_deviation })
        }
        _ => mixture(r, &variant),
    }
}

fn mixture(r: &mut Reader, variant: &Variant<'_>) -> Option<RadiusChoice> {
    const USE: &str = "as in `Mixture([(\"1 mm\", 0.3), (\"2 mm\", 0.7)])`";
    let parts = variant
        .content
        .and_then(|content| content.items())
        .filter(|items| items.len() == 1)
        .and_then(|items| items[0].items())
        .filter(|parts| !parts.is_empty());
    let Some(parts) = parts else {
        r.error(variant.span.clone(), "`Mixture` takes a list of radii and shares", USE);
        return None;
    };
    let parts: Vec<_> = parts
        .into_iter()
        .map(|part| {
            let pair = part.items().filter(|pair| pair.len() == 2);
            let Some(pair) = pair else {
                r.error(part.span(), format!("expected a radius and a share, not `{}`", part.quoted()), USE);
                return None;
            };
            let radius = length(r, "radius", pair[0]);
            let share = r.quantity("share", pair[1], Dimension::DIMENSIONLESS, Allowed::Positive);
            Some((radius?, share?))
        })
        .collect();
    Some(RadiusChoice::Mixture(parts.into_iter().collect::<Option<_>>()?))
}

fn import(r: &mut Reader, variant: &Variant<'_>, span: Range<usize>) -> Option<ImportBlock> {
    let f = r.block(variant.content, &spec::IMPORT, variant.span.clone())?;
    let file = r.required(&f, "file", Reader::string);
    let format = r.required(&f, "format", |r, name, node| {
        let variant = r.variant(name, node, &["LammpsData", "LammpsDump"])?;
        if variant.name == "LammpsData" {
            if let Some(content) = variant.content {
                r.error(content.span(), "`LammpsData` takes nothing in parentheses", "");
                return None;
            }
            return Some(ImportFormat::LammpsData);
        }
        let f = r.block(variant.content, &spec::LAMMPS_DUMP, variant.span)?;
        let frame = r.optional(&f, "frame", |r, name, node| {
            if node.whole_number().is_some() {
                return r.whole(name, node, 0, u64::MAX).map(|step| FrameChoice::Step(step.value));
            }
            r.choice(name, node, &[("Last", FrameChoice::Last)]).map(|frame| frame.value)
        })?;
        Some(ImportFormat::LammpsDump { frame: frame.unwrap_or(FrameChoice::Last) })
    });
    let materials = r.required(&f, "materials", |r, name, node| {
        let Some(entries) = node.map() else {
            let message =
                format!("`{name}` must be a map such as {{ 1: \"glass\" }}, not `{}`", node.quoted());
            r.error(node.span(), message, "");
            return None;
        };
        let mut map: Vec<(Spanned<u32>, Spanned<String>)> = Vec::new();
        for (key, value) in entries {
            let (key, value) = (identity(r, "atom type", key), r.string("material", value));
            let (key, value) = (key?, value?);
            if map.iter().any(|(earlier, _)| earlier.value == key.value) {
                r.error(key.span, format!("atom type {} is given twice in `{name}`", key.value), "");
                return None;
            }
            map.push((key, value));
        }
        Some(map)
    });
    let frozen_types = r.optional(&f, "frozen_types", |r, name, node| {
        let types: Vec<_> =
            r.list(name, node)?.into_iter().map(|item| identity(r, "atom type", item)).collect();
        types.into_iter().collect::<Option<Vec<_>>>()
    });
    let shape = shape_of(r, &f);
    Some(ImportBlock {
        file: file?,
        format: format?,
        materials: materials?,
        frozen_types: frozen_types?.unwrap_or_default(),
        shape: shape?,
        span,
    })
}
