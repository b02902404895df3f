//! Whether the bodies can be where they are.

use granule_geometry::{Cell, NeighbourGrid, PairScratch, Surface};
use granule_scene::BodyBlock;
use nalgebra::Vector3;

use crate::bodies::Draft;
use crate::build::Builder;
use crate::model::WallPlan;

/// Share of the smaller radius by which bodies may overlap at the start: deeper than contacts of stiff grains get, far
/// above what round-off or a text file with few digits makes.
const ALLOWANCE: f64 = 0.01;
/// Problems of one kind that are spelt out before the rest is counted.
const SHOWN: usize = 3;

/// Bodies that are looked at before it is asked whether enough overlaps are known.
const PART: usize = 64;
/// Overlaps that are enough.
const ENOUGH: usize = 1000;
/// From so many bodies on, all threads help.
const MANY: usize = 20_000;

/// Reports problems of one kind, the first few in full.
struct Report {
    count: usize,
}

impl Report {
    fn add(&mut self, builder: &mut Builder<'_>, draft: &Draft, message: String, help: &str) {
        self.count += 1;
        if self.count <= SHOWN {
            builder.error_help(draft.span.clone(), message, help);
        }
    }

    fn finish(self, builder: &mut Builder<'_>, what: &str) {
        if self.count > SHOWN {
            let span = builder.scene.bodies.span.clone();
            builder.error(span, format!("{} more bodies {what}", self.count - SHOWN));
        }
    }
}

/// Bodies in the cell, on the right side of the walls, and apart from each other.
pub(crate) fn places(builder: &mut Builder<'_>, drafts: &[Draft], walls: &[WallPlan], cell: &Cell) {
    outside(builder, drafts, cell);
    behind(builder, drafts, walls);
    if !builder.scene.allow_overlap {
        apart(builder, drafts, cell);
    }
}

fn outside(builder: &mut Builder<'_>, drafts: &[Draft], cell: &Cell) {
    let (lo, hi) = (cell.lo(), cell.hi());
    let mut report = Report { count: 0 };
    for draft in drafts {
        let axis =
            (0..3).find(|axis| !(draft.position[*axis] >= lo[*axis] && draft.position[*axis] <= hi[*axis]));
        if let Some(axis) = axis {
            let message = format!(
                "body {} at {} = {} m is outside the cell, which goes from {} to {} m",
                draft.id,
                ["x", "y", "z"][axis],
                draft.position[axis],
                lo[axis],
                hi[axis]
            );
            report.add(builder, draft, message, "");
        }
    }
    report.finish(builder, "are outside the cell");
}

fn behind(builder: &mut Builder<'_>, drafts: &[Draft], walls: &[WallPlan]) {
    let mut report = Report { count: 0 };
    for wall in walls {
        let surface = wall.wall.surface_at(0.0);
        // Frozen bodies may be part of a wall.
        for draft in drafts.iter().filter(|draft| !draft.frozen) {
            let distance = surface.contact(Vector3::from(draft.position)).distance;
            let overlap = draft.radius - distance;
            if let Surface::Cylinder(cylinder) = &surface
                && cylinder.inside()
                && draft.radius >= cylinder.radius()
            {
                let message = format!("body {} does not fit into cylinder `{}`", draft.id, wall.name);
                report.add(builder, draft, message, "its radius is at least that of the cylinder");
            } else if distance < 0.0 {
                let message = format!("body {} is {} m behind wall `{}`", draft.id, -distance, wall.name);
                report.add(builder, draft, message, "the normal of a wall points to the bodies");
            } else if overlap > ALLOWANCE * draft.radius && !builder.scene.allow_overlap {
                let message = format!(
                    "body {} overlaps wall `{}` by {overlap:.6e} m, {:.1} % of its radius",
                    draft.id,
                    wall.name,
                    100.0 * overlap / draft.radius
                );
                report.add(builder, draft, message, "move it, or set `allow_overlap: true`");
            }
        }
    }
    report.finish(builder, "are behind a wall or overlap one");
}

fn apart(builder: &mut Builder<'_>, drafts: &[Draft], cell: &Cell) {
    // Overlaps within one file are the result of another run.
    let one_file = |a: &Draft, b: &Draft| a.imported && b.imported && a.block == b.block;
    if drafts.first().is_none_or(|first| drafts.iter().all(|draft| one_file(first, draft))) {
        return;
    }
    let rows: Vec<[f64; 4]> = drafts
        .iter()
        .map(|draft| {
            let [x, y, z] = draft.position;
            [x, y, z, draft.radius]
        })
        .collect();
    let mut grid = NeighbourGrid::new();
    grid.build(&rows, cell, 0.0, rows.len() > MANY);
    let mut found: Vec<(usize, usize, f64)> = Vec::new();
    let mut scratch = PairScratch::default();
    for first in (0..rows.len()).step_by(PART) {
        grid.pairs_of(first..(first + PART).min(rows.len()), &mut scratch, |i, j, _| {
            let (low, high) = (i.min(j) as usize, i.max(j) as usize);
            let (a, b) = (&drafts[low], &drafts[high]);
            let apart: [f64; 3] = std::array::from_fn(|axis| a.position[axis] - b.position[axis]);
            let distance = Vector3::from(cell.minimum_image(apart).0).norm();
            let overlap = a.radius + b.radius - distance;
            if overlap > ALLOWANCE * a.radius.min(b.radius) && !(one_file(a, b) || a.frozen && b.frozen) {
                found.push((high, low, overlap));
            }
        });
        // A scene full of overlaps would take long to count, and a few say enough.
        if found.len() > ENOUGH {
            break;
        }
    }
    found.sort_unstable_by_key(|(high, low, _)| (*high, *low));
    found.dedup_by_key(|(high, ..)| *high);
    let mut report = Report { count: 0 };
    for (high, low, overlap) in found.into_iter().take(SHOWN) {
        let (other, draft) = (&drafts[low], &drafts[high]);
        let message = format!(
            "bodies {} and {} overlap by {overlap:.6e} m, {:.1} % of the smaller radius",
            other.id,
            draft.id,
            100.0 * overlap / draft.radius.min(other.radius)
        );
        report.add(builder, draft, message, "move them apart, or set `allow_overlap: true`");
    }
}

/// Warns of materials that nothing is made of.
pub(crate) fn unused_materials(builder: &mut Builder<'_>, walls: &[WallPlan]) {
    let scene = builder.scene;
    if scene.bodies.items.is_empty()
        || !(scene.bodies.complete && scene.walls.complete && walls.len() >= scene.walls.items.len())
    {
        return;
    }
    for material in &scene.materials.items {
        let name = &material.name.value;
        let in_bodies = scene.bodies.items.iter().any(|block| match block {
            BodyBlock::Single(body) => body.material.value == *name,
            BodyBlock::Lattice(lattice) => lattice.material.value == *name,
            BodyBlock::Fill(fill) => fill.material.value == *name,
            BodyBlock::Import(import) => import.materials.iter().any(|(_, material)| material.value == *name),
        });
        let in_walls = scene.walls.items.iter().any(|wall| wall.material.value == *name);
        if !(in_bodies || in_walls) {
            builder.warning(
                material.name.span.clone(),
                format!("nothing is made of material `{name}`"),
                "remove it, or give it to a body or a wall",
            );
        }
    }
}
