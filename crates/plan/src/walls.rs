//! Walls of the scene as surfaces.

use std::ops::Range;

use granule_geometry::{Cell, Cylinder, GeometryError, Motion, Plane, Surface, Wall};
use granule_scene::{MotionChoice, Spanned, Vector, WallBlock, WallShape};
use nalgebra::Vector3;

use crate::build::Builder;
use crate::model::{Dimensions, WallPlan};

/// All walls; faces of boxes one by one.
pub(crate) fn walls(builder: &mut Builder<'_>, cell: Option<&Cell>) -> Vec<WallPlan> {
    let mut walls = Vec::new();
    for block in &builder.scene.walls.items {
        let span = block.name.span.clone();
        let material = builder.material(&block.material);
        let motion = motion(builder, &block.motion);
        let surfaces = surfaces(builder, block, cell);
        let (Some(material), Some(motion), Some(surfaces)) = (material, motion, surfaces) else { continue };
        for (name, surface) in surfaces {
            if let Some(cell) = cell
                && let Some(axis) = crossed_period(&surface, cell)
            {
                builder.error_help(
                    span.clone(),
                    format!("wall `{name}` stands across the periodic direction {axis}"),
                    "a wall must lie along the periodic directions, or the direction must not be periodic",
                );
            }
            let wall = Wall::new(surface, motion.clone());
            walls.push(WallPlan { name, wall, material });
        }
    }
    if walls.len() > usize::from(u16::MAX) {
        builder.error(builder.scene.walls.span.clone(), "at most 65535 walls");
        walls.clear();
    }
    walls
}

/// A direction that is periodic although the surface is not the same one period away.
fn crossed_period(surface: &Surface, cell: &Cell) -> Option<&'static str> {
    let periodic = cell.periodic();
    ["x", "y", "z"].into_iter().enumerate().find_map(|(axis, name)| {
        let crosses = match surface {
            Surface::Plane(plane) => plane.normal()[axis].abs() > 1e-12,
            Surface::Cylinder(cylinder) => 1.0 - cylinder.axis()[axis].abs() > 1e-12,
        };
        (periodic[axis] && crosses).then_some(name)
    })
}

fn surfaces(
    builder: &mut Builder<'_>,
    block: &WallBlock,
    cell: Option<&Cell>,
) -> Option<Vec<(String, Surface)>> {
    let name = block.name.value.clone();
    match &block.shape {
        WallShape::Plane { point, normal } => {
            let (at, direction) = (builder.vector(point, "point"), builder.vector(normal, "normal"));
            let plane = Plane::new(at?.into(), direction?.into());
            good(builder, &normal.span, plane).map(|plane| vec![(name, plane.into())])
        }
        WallShape::Box { lo, hi, open } => {
            let (low, high) = (builder.vector(lo, "lo"), builder.vector(hi, "hi"));
            let (low, high) = (low?, high?);
            let axes = if builder.dimensions == Dimensions::Two { 2 } else { 3 };
            let periodic = cell.map_or([false; 3], Cell::periodic);
            let mut faces = Vec::new();
            for axis in (0..axes).filter(|axis| !periodic[*axis]) {
                for (side, place, sign) in [("-", low[axis], 1.0), ("+", high[axis], -1.0)] {
                    let face = format!("{}{side}", ["x", "y", "z"][axis]);
                    if open.iter().any(|open| open.value == face) {
                        continue;
                    }
                    let (mut point, mut normal) = (Vector3::zeros(), Vector3::zeros());
                    point[axis] = place;
                    normal[axis] = sign;
                    let plane = good(builder, &block.span, Plane::new(point, normal))?;
                    faces.push((format!("{name}.{face}"), Surface::from(plane)));
                }
            }
            if faces.is_empty() {
                builder.error(block.name.span.clone(), format!("box `{name}` has no face left"));
            }
            Some(faces)
        }
        WallShape::Cylinder { point, axis, radius, inside } => {
            let at = builder.vector(point, "point");
            let along = along_z(builder, axis.as_ref());
            let cylinder = Cylinder::new(at?.into(), along?, radius.value, *inside);
            let span = axis.as_ref().map_or(&block.span, |axis| &axis.span);
            good(builder, span, cylinder).map(|cylinder| vec![(name, cylinder.into())])
        }
    }
}

/// An axis: any in space, z in the plane.
fn along_z(builder: &mut Builder<'_>, axis: Option<&Vector>) -> Option<Vector3<f64>> {
    let Some(axis) = axis else {
        return Some(Vector3::z());
    };
    let value = |k: usize| axis.components.get(k).map_or(0.0, |component| component.value);
    if axis.components.len() != 3 {
        builder.error(axis.span.clone(), "`axis` needs three components");
        return None;
    }
    if builder.dimensions == Dimensions::Two && (value(0) != 0.0 || value(1) != 0.0) {
        builder.error_help(
            axis.span.clone(),
            "in 2 dimensions an axis is along z",
            "leave it out, or write (0, 0, 1)",
        );
        return None;
    }
    Some(Vector3::new(value(0), value(1), value(2)))
}

pub(crate) fn good<T>(
    builder: &mut Builder<'_>,
    span: &Range<usize>,
    result: Result<T, GeometryError>,
) -> Option<T> {
    result.map_err(|error| builder.error(span.clone(), error.to_string())).ok()
}

pub(crate) fn motion(builder: &mut Builder<'_>, choice: &Spanned<MotionChoice>) -> Option<Motion> {
    let motion = match &choice.value {
        MotionChoice::Static => Ok(Motion::fixed()),
        MotionChoice::Constant { velocity } => {
            Motion::constant_velocity(builder.vector(velocity, "velocity")?.into())
        }
        MotionChoice::Sinusoidal { amplitude, angular_frequency, phase } => {
            Motion::sinusoidal(builder.vector(amplitude, "amplitude")?.into(), *angular_frequency, *phase)
        }
        MotionChoice::Table(rows) => {
            let rows: Vec<Option<(f64, Vector3<f64>)>> = rows
                .iter()
                .map(|(time, displacement)| {
                    builder.vector(displacement, "displacement").map(|value| (time.value, value.into()))
                })
                .collect();
            Motion::table(rows.into_iter().collect::<Option<_>>()?)
        }
        MotionChoice::Rotation { point, axis, angular_velocity } => {
            let at = builder.vector(point, "point");
            let along = along_z(builder, axis.as_ref());
            Motion::rotation(at?.into(), along?, *angular_velocity)
        }
    };
    good(builder, &choice.span, motion)
}
