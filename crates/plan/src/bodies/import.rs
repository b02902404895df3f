//! Bodies from files of LAMMPS and LIGGGHTS.

use std::collections::BTreeSet;
use std::path::Path;

use granule_formats::lammps_dump::{DumpFrame, Reader};
use granule_formats::{FormatError, lammps_data};
use granule_geometry::Shape;
use granule_scene::{FrameChoice, ImportBlock, ImportFormat};

use super::{Draft, density, shape};
use crate::build::Builder;
use crate::model::Dimensions;

/// A particle of a file.
struct Particle {
    id: u32,
    /// Type in the file, from 1.
    kind: u32,
    radius: f64,
    mass: Mass,
    position: [f64; 3],
    velocity: [f64; 3],
    spin: [f64; 3],
}

/// What a file says about the mass of a particle.
#[derive(Clone, Copy)]
enum Mass {
    Given(f64),
    Density(f64),
    Nothing,
}

/// Adds the bodies of one block.
pub fn bodies(builder: &mut Builder<'_>, block: &ImportBlock, index: usize, drafts: &mut Vec<Draft>) {
    let shape = shape(builder, block.shape.as_ref());
    let mut materials: Vec<(u32, Option<u16>)> = Vec::new();
    for (kind, name) in &block.materials {
        materials.push((kind.value, builder.material(name)));
    }
    let Some(shape) = shape else { return };
    let Some(path) = builder.data_file(&block.file) else { return };
    let particles = match &block.format {
        ImportFormat::LammpsData => data(&path, shape).map_err(|error| error.to_string()),
        ImportFormat::LammpsDump { frame } => dump(&path, *frame),
    };
    let particles = match particles {
        Ok(particles) => particles,
        Err(error) => {
            // The path as the user wrote it.
            let error = error.replace(&path.display().to_string(), &block.file.value);
            builder.error(block.file.span.clone(), error);
            return;
        }
    };
    let kinds: BTreeSet<u32> = particles.iter().map(|particle| particle.kind).collect();
    let mut good = true;
    for kind in &kinds {
        if !materials.iter().any(|(known, _)| known == kind) {
            builder.error_help(
                block.span.clone(),
                format!("{} has bodies of type {kind}, which has no material", block.file.value),
                format!("add {kind}: \"..\" to `materials`"),
            );
            good = false;
        }
    }
    for (kind, name) in &block.materials {
        if !kinds.contains(&kind.value) {
            builder.warning(
                kind.span.clone(),
                format!("{} has no bodies of type {}", block.file.value, kind.value),
                format!("nothing of this file becomes `{}`", name.value),
            );
        }
    }
    for kind in &block.frozen_types {
        if !kinds.contains(&kind.value) {
            builder.error(
                kind.span.clone(),
                format!("{} has no bodies of type {}, so none can be frozen", block.file.value, kind.value),
            );
            good = false;
        }
    }
    let massless =
        particles.iter().filter(|particle| matches!(particle.mass, Mass::Nothing)).find(|particle| {
            let material =
                materials.iter().find(|(kind, _)| *kind == particle.kind).and_then(|(_, material)| *material);
            material.is_some_and(|material| density(builder, material).is_none())
        });
    if let Some(particle) = massless {
        builder.error_help(
            block.file.span.clone(),
            format!("{} has neither mass nor density of body {}", block.file.value, particle.id),
            "give the material a density",
        );
        good = false;
    }
    let leaves = |particle: &&Particle| {
        particle.position[2] != 0.0 || particle.velocity[2] != 0.0 || particle.spin[..2] != [0.0; 2]
    };
    if builder.dimensions == Dimensions::Two
        && let Some(particle) = particles.iter().find(leaves)
    {
        builder.error(
            block.file.span.clone(),
            format!("body {} of {} is not in the x-y plane, or leaves it", particle.id, block.file.value),
        );
        good = false;
    }
    if !good {
        return;
    }
    let count = particles.len();
    if !builder.affords(count as f64, &block.file.span) {
        return;
    }
    builder.decide_one("import", true, format!("{count} bodies from {}", block.file.value));
    // Each as large as a cache line or two: no copy is made of a million of them.
    drafts.reserve_exact(count);
    drafts.extend(particles.into_iter().filter_map(|particle| {
        let frozen = block.frozen_types.iter().any(|kind| kind.value == particle.kind);
        let material = materials.iter().find(|(kind, _)| *kind == particle.kind)?.1?;
        let mass = match particle.mass {
            Mass::Given(mass) => mass,
            Mass::Density(density) => shape.mass(density, particle.radius),
            Mass::Nothing => shape.mass(density(builder, material)?, particle.radius),
        };
        Some(Draft {
            id: particle.id,
            material,
            radius: particle.radius,
            mass,
            inertia_factor: shape.inertia_factor(),
            position: particle.position,
            // What a frozen body does in the other program does not matter: here it rests.
            velocity: if frozen { [0.0; 3] } else { particle.velocity },
            spin: if frozen { [0.0; 3] } else { particle.spin },
            frozen,
            block: index,
            imported: true,
            span: block.span.clone(),
        })
    }));
}

fn data(path: &Path, shape: Shape) -> Result<Vec<Particle>, FormatError> {
    let file = lammps_data::read(path)?;
    Ok(file
        .atoms
        .into_iter()
        .map(|atom| Particle {
            id: atom.id,
            kind: u32::from(atom.material) + 1,
            radius: atom.radius(),
            mass: if shape == Shape::Disc { Mass::Density(atom.density) } else { Mass::Given(atom.mass()) },
            position: atom.position,
            velocity: atom.velocity,
            spin: atom.angular_velocity,
        })
        .collect())
}

fn dump(path: &Path, choice: FrameChoice) -> Result<Vec<Particle>, String> {
    let mut found: Option<DumpFrame> = None;
    let mut steps = (u64::MAX, 0);
    for frame in Reader::open(path).map_err(|error| error.to_string())? {
        let frame = frame.map_err(|error| error.to_string())?;
        steps = (steps.0.min(frame.step), steps.1.max(frame.step));
        if choice == FrameChoice::Last || choice == FrameChoice::Step(frame.step) {
            found = Some(frame);
        }
    }
    let Some(frame) = found else {
        let wanted = match choice {
            FrameChoice::Last => "has no snapshot".to_string(),
            FrameChoice::Step(step) => {
                format!("has no snapshot of step {step}; its steps go from {} to {}", steps.0, steps.1)
            }
        };
        return Err(format!("{} {wanted}", path.display()));
    };
    let lacks = |what: &str| format!("the dump {} lacks {what}", path.display());
    let ids = frame.ids().ok_or_else(|| lacks("the column id"))?;
    let kinds = frame.materials().ok_or_else(|| lacks("the column type"))?;
    let positions = frame.positions().ok_or_else(|| lacks("the columns x y z"))?;
    let radii: Vec<f64> = match (frame.number("radius"), frame.number("diameter")) {
        (Some(radii), _) => radii.to_vec(),
        (None, Some(diameters)) => diameters.iter().map(|diameter| 0.5 * diameter).collect(),
        (None, None) => return Err(lacks("the column radius")),
    };
    let (masses, densities) = (frame.number("mass"), frame.number("density"));
    let rest = vec![[0.0; 3]; ids.len()];
    let velocities = frame.vector(["vx", "vy", "vz"]).unwrap_or_else(|| rest.clone());
    let spins = frame.vector(["omegax", "omegay", "omegaz"]).unwrap_or(rest);
    let positive = |what: &str, values: &[f64]| match values.iter().position(|value| *value <= 0.0) {
        Some(at) => Err(format!("{}: the {what} of body {} is {}", path.display(), ids[at], values[at])),
        None => Ok(()),
    };
    positive("radius", &radii)?;
    positive("mass", masses.unwrap_or_default())?;
    positive("density", densities.unwrap_or_default())?;
    Ok((0..ids.len())
        .map(|k| Particle {
            id: ids[k],
            kind: u32::from(kinds[k]) + 1,
            radius: radii[k],
            mass: match (masses, densities) {
                (Some(masses), _) => Mass::Given(masses[k]),
                (None, Some(densities)) => Mass::Density(densities[k]),
                (None, None) => Mass::Nothing,
            },
            position: positions[k],
            velocity: velocities[k],
            spin: spins[k],
        })
        .collect())
}
