//! Bodies of the scene, one by one.

mod fill;
mod import;
mod lattice;
mod occupancy;
mod random;

use std::ops::Range;

use granule_geometry::{Cell, Shape};
use granule_scene::{BodyBlock, ShapeChoice, SingleBody, Spanned, Vector};

use crate::build::Builder;
use crate::model::WallPlan;
use crate::model::{BodyTable, Dimensions};

use occupancy::Occupancy;

/// Most bodies that lattices and fills may make.
const MOST: usize = 10_000_000;

/// One body and where it comes from.
#[derive(Clone, Debug)]
pub(crate) struct Draft {
    pub id: u32,
    pub material: u16,
    pub radius: f64,
    pub mass: f64,
    pub inertia_factor: f64,
    pub position: [f64; 3],
    pub velocity: [f64; 3],
    pub spin: [f64; 3],
    pub frozen: bool,
    /// Block in the list of bodies.
    pub block: usize,
    /// From a file.
    pub imported: bool,
    /// Where its block stands.
    pub span: Range<usize>,
}

/// What all bodies of a block have in common.
#[derive(Clone, Debug)]
struct Common {
    material: u16,
    shape: Shape,
    density: Option<f64>,
    velocity: [f64; 3],
    frozen: bool,
    block: usize,
    span: Range<usize>,
}

impl Common {
    /// A body without id. The density is there: [`common`] saw to it.
    fn body(&self, radius: f64, position: [f64; 3]) -> Draft {
        Draft {
            id: 0,
            material: self.material,
            radius,
            mass: self.shape.mass(self.density.unwrap_or(0.0), radius),
            inertia_factor: self.shape.inertia_factor(),
            position,
            velocity: self.velocity,
            spin: [0.0; 3],
            frozen: self.frozen,
            block: self.block,
            imported: false,
            span: self.span.clone(),
        }
    }
}

/// All bodies in the order of their ids. Random fills need `room`, the cell, and the walls; without it they are left out.
pub(crate) fn drafts(builder: &mut Builder<'_>, room: Option<&Cell>, walls: &[WallPlan]) -> Vec<Draft> {
    let scene = builder.scene;
    let mut drafts: Vec<Draft> = Vec::new();
    let singles = scene.bodies.items.iter().filter(|body| matches!(body, BodyBlock::Single(_))).count();
    if !builder.affords(singles as f64, &scene.bodies.span) {
        return drafts;
    }
    for (block, body) in scene.bodies.items.iter().enumerate() {
        let before = drafts.len();
        match body {
            BodyBlock::Single(body) => drafts.extend(single(builder, body, block)),
            BodyBlock::Lattice(lattice) => drafts.extend(lattice::bodies(builder, lattice, block, room)),
            BodyBlock::Fill(fill) => {
                let more = room.map(|cell| fill::bodies(builder, fill, block, cell, walls, &drafts));
                drafts.extend(more.unwrap_or_default());
            }
            BodyBlock::Import(import) => import::bodies(builder, import, block, &mut drafts),
        }
        for draft in &mut drafts[before..] {
            check(builder, draft);
        }
    }
    if scene.bodies.items.is_empty() && scene.bodies.complete && scene.complete {
        builder.error(scene.bodies.span.clone(), "a scene needs at least one body");
    }
    number(builder, &mut drafts);
    if let Some(cell) = room {
        let mut wrapped = 0usize;
        for draft in &mut drafts {
            let (position, periods) = cell.wrap(draft.position);
            wrapped += usize::from(periods != [0; 3]);
            draft.position = position;
        }
        if wrapped > 0 {
            let why = format!("{wrapped} bodies moved into the cell by whole periods");
            builder.decide_one("wrapping at the start", true, why);
        }
    }
    drafts.sort_by_key(|draft| draft.id);
    drafts
}

/// The bodies as columns.
pub(crate) fn table(drafts: &[Draft]) -> BodyTable {
    BodyTable {
        id: drafts.iter().map(|draft| draft.id).collect(),
        material: drafts.iter().map(|draft| draft.material).collect(),
        radius: drafts.iter().map(|draft| draft.radius).collect(),
        mass: drafts.iter().map(|draft| draft.mass).collect(),
        inertia_factor: drafts.iter().map(|draft| draft.inertia_factor).collect(),
        position: drafts.iter().map(|draft| draft.position).collect(),
        velocity: drafts.iter().map(|draft| draft.velocity).collect(),
        spin: drafts.iter().map(|draft| draft.spin).collect(),
        frozen: drafts.iter().map(|draft| draft.frozen).collect(),
    }
}

/// Masses, inertias and energies must be representable: a radius of 1e-200 m has none.
fn check(builder: &mut Builder<'_>, draft: &Draft) {
    let inertia = draft.inertia_factor * draft.mass * draft.radius * draft.radius;
    if !(draft.mass.is_normal() && inertia.is_normal() && (1.0 / inertia).is_finite()) {
        builder.error(
            draft.span.clone(),
            format!(
                "a mass of {:e} kg at a radius of {:e} m is outside the range of numbers",
                draft.mass, draft.radius
            ),
        );
    }
    let square = |v: [f64; 3]| v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let (speed, spin) = (square(draft.velocity), square(draft.spin));
    if !(speed.is_finite() && spin.is_finite() && (draft.mass * speed + inertia * spin).is_finite()) {
        builder.error(draft.span.clone(), "the kinetic energy of this body is outside the range of numbers");
    }
}

/// Gives ids to the bodies without, the smallest free ones in the order of the scene, and refuses repeated ones.
fn number(builder: &mut Builder<'_>, drafts: &mut [Draft]) {
    let mut given: Vec<(u32, usize)> = drafts
        .iter()
        .enumerate()
        .filter(|(_, draft)| draft.id != 0)
        .map(|(at, draft)| (draft.id, at))
        .collect();
    given.sort_unstable();
    for pair in given.windows(2) {
        if pair[0].0 == pair[1].0 {
            let later = &drafts[pair[1].1];
            let span = match &builder.scene.bodies.items[later.block] {
                BodyBlock::Single(SingleBody { id: Some(id), .. }) => id.span.clone(),
                _ => later.span.clone(),
            };
            builder.error(span, format!("id {} is given twice", pair[0].0));
        }
    }
    let mut taken = given.iter().map(|(id, _)| *id).peekable();
    let mut next = 1u32;
    for draft in drafts.iter_mut().filter(|draft| draft.id == 0) {
        loop {
            while taken.peek().is_some_and(|id| *id < next) {
                taken.next();
            }
            if taken.peek() != Some(&next) {
                break;
            }
            next = next.saturating_add(1);
        }
        draft.id = next;
        next = next.saturating_add(1);
    }
}

fn shape(builder: &mut Builder<'_>, choice: Option<&Spanned<ShapeChoice>>) -> Option<Shape> {
    let planar = builder.dimensions == Dimensions::Two;
    let Some(choice) = choice else {
        return Some(if planar { Shape::Disc } else { Shape::Sphere });
    };
    match choice.value {
        ShapeChoice::Sphere => Some(Shape::Sphere),
        ShapeChoice::Disc if !planar => {
            builder.error_help(
                choice.span.clone(),
                "a disc needs `dimensions: 2`",
                "a round body with the inertia factor of a disc is `Body` with 0.5",
            );
            None
        }
        ShapeChoice::Disc => Some(Shape::Disc),
        ShapeChoice::HollowSphere => Some(Shape::HollowSphere),
        ShapeChoice::Body(q) => match Shape::custom(q) {
            Ok(shape) => Some(shape),
            Err(error) => {
                builder.error(choice.span.clone(), error.to_string());
                None
            }
        },
    }
}

fn density(builder: &Builder<'_>, material: u16) -> Option<f64> {
    let block = builder.scene.materials.items.get(usize::from(material))?;
    block.density.as_ref().map(|density| density.value)
}

fn no_density(builder: &mut Builder<'_>, material: &Spanned<String>, help: &str) {
    let message = format!("material `{}` has no density, so the mass is not known", material.value);
    builder.error_help(material.span.clone(), message, help);
}

/// What a block says about all its bodies.
#[allow(clippy::too_many_arguments)]
fn common(
    builder: &mut Builder<'_>,
    shape_choice: Option<&Spanned<ShapeChoice>>,
    material: &Spanned<String>,
    velocity: Option<&Vector>,
    frozen: bool,
    block: usize,
    span: &Range<usize>,
) -> Option<Common> {
    let shape = shape(builder, shape_choice);
    let index = builder.material(material);
    let velocity = match velocity {
        Some(velocity) => builder.vector(velocity, "velocity"),
        None => Some([0.0; 3]),
    };
    let index = index?;
    let density = density(builder, index);
    if density.is_none() {
        no_density(builder, material, "give the material a density");
        return None;
    }
    Some(Common {
        material: index,
        shape: shape?,
        density,
        velocity: velocity?,
        frozen,
        block,
        span: span.clone(),
    })
}

fn single(builder: &mut Builder<'_>, body: &SingleBody, block: usize) -> Option<Draft> {
    let shape = shape(builder, Some(&body.shape));
    let material = builder.material(&body.material);
    let position = builder.vector(&body.position, "position");
    let velocity = match &body.velocity {
        Some(velocity) => builder.vector(velocity, "velocity"),
        None => Some([0.0; 3]),
    };
    let spin = match &body.spin {
        Some(spin) => builder.spin(spin),
        None => Some([0.0; 3]),
    };
    let (shape, material) = (shape?, material?);
    let mass = match (&body.mass, density(builder, material)) {
        (Some(mass), _) => mass.value,
        (None, Some(density)) => shape.mass(density, body.radius.value),
        (None, None) => {
            no_density(builder, &body.material, "give the material a density, or the body a mass");
            return None;
        }
    };
    let (velocity, spin) = (velocity?, spin?);
    if body.frozen && (velocity != [0.0; 3] || spin != [0.0; 3]) {
        builder.error_help(
            body.span.clone(),
            "a frozen body has no velocity and no spin",
            "leave them out; bodies that push others without being pushed are walls with a motion",
        );
    }
    Some(Draft {
        id: body.id.as_ref().map_or(0, |id| id.value),
        material,
        radius: body.radius.value,
        mass,
        inertia_factor: shape.inertia_factor(),
        position: position?,
        velocity,
        spin,
        frozen: body.frozen,
        block,
        imported: false,
        span: body.span.clone(),
    })
}
