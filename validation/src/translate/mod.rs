//! From a plan to the words of a peer: engine inputs are written from the scene, never kept beside it.
//!
//! ```text
//! composition ──> Contact (the same whatever parameters the scene gave) ──> law of the target, or why there is none
//! ```

mod contact;
mod laws;
mod moduli;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::f64::consts::PI;

use granule_geometry::Surface;
use granule_plan::{Dimensions, Partner, Plan};
use serde::Deserialize;

use self::moduli::Moduli;
use crate::peers::{Axis, Engine, PeerBody, PeerLaw, PeerScene, PeerWall, Quantity, Side, Tuning};

/// A peer, with the family of commands that it is told a scene in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Target {
    /// LAMMPS `pair gran/*` and `fix wall/gran`.
    LammpsClassic,
    /// LAMMPS `pair granular` and `fix wall/gran granular`.
    LammpsGranular,
    /// LIGGGHTS `pair gran`.
    Liggghts,
}

impl Target {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::LammpsClassic, Self::LammpsGranular, Self::Liggghts];

    /// The engine.
    pub fn engine(self) -> Engine {
        match self {
            Self::LammpsClassic | Self::LammpsGranular => Engine::Lammps,
            Self::Liggghts => Engine::Liggghts,
        }
    }

    /// Name in reports and in names of files.
    pub fn name(self) -> &'static str {
        match self {
            Self::LammpsClassic => "lammps-classic",
            Self::LammpsGranular => "lammps-granular",
            Self::Liggghts => "liggghts",
        }
    }

    /// Our conventions that match it.
    pub fn preset(self) -> &'static str {
        self.name()
    }
}

/// Why a peer cannot be told a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Untranslatable {
    /// The law, wall or body at fault, or the engine's command that lacks it.
    pub what: String,
    /// What is missing.
    pub why: String,
}

impl std::fmt::Display for Untranslatable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.what, self.why)
    }
}

impl std::error::Error for Untranslatable {}

fn refuse<T>(what: impl Into<String>, why: impl Into<String>) -> Result<T, Untranslatable> {
    Err(Untranslatable { what: what.into(), why: why.into() })
}

/// Describes a plan to a peer. The dump interval is left at zero.
///
/// # Errors
/// [`Untranslatable`] names what the peer does not have.
pub fn translate(plan: &Plan, target: Target) -> Result<PeerScene, Untranslatable> {
    if plan.dimensions == Dimensions::Two {
        return refuse("dimensions: 2", "the peers are told scenes in space only");
    }
    let largest = plan.bodies.radius.iter().fold(0.0, |a: f64, b| a.max(*b));
    let (lower, upper) = bounds(plan, largest);
    let mut scene = PeerScene {
        title: if plan.title.is_empty() { "granule".into() } else { plan.title.replace(['\n', '\r'], " ") },
        bodies: bodies(plan)?,
        frozen: (0..plan.bodies.len())
            .filter(|&i| plan.bodies.frozen[i])
            .map(|i| u64::from(plan.bodies.id[i]))
            .collect(),
        lower,
        upper,
        periodic: plan.cell.periodic(),
        gravity: plan.gravity,
        materials: vec![None; plan.materials.len()],
        laws: BTreeMap::new(),
        walls: walls(plan)?,
        time_step: plan.driver.step,
        steps: plan.driver.steps,
        warm_up: 0,
        dump_every: 0,
        quantities: Quantity::ALL.to_vec(),
        skin: if plan.driver.skin > 0.0 { plan.driver.skin } else { 0.4 * largest },
        tuning: Tuning::default(),
    };
    let mut moduli = Moduli::default();
    for composition in &plan.compositions {
        let other = match composition.partner {
            Partner::Body(material) => material,
            Partner::Wall(wall) => plan.walls[usize::from(wall)].material,
        };
        let (i, j) = (usize::from(composition.material) + 1, usize::from(other) + 1);
        let contact = contact::contact(composition)?;
        let law = match target {
            Target::LammpsClassic => PeerLaw::Classic(laws::classic(&contact)?),
            Target::LammpsGranular => PeerLaw::Granular(laws::granular(&contact)?),
            Target::Liggghts => PeerLaw::Liggghts(laws::liggghts(&contact, (i, j), &mut moduli)?),
        };
        if let Some(earlier) = scene.laws.insert((i.min(j), i.max(j)), law)
            && earlier != law
        {
            let names = [i, j].map(|kind| plan.materials[kind - 1].name.as_str());
            return refuse(
                format!("{} and {}", names[0], names[1]),
                "the same law has other numbers between bodies than at a wall, because the masses differ",
            );
        }
    }
    if target == Target::Liggghts {
        scene.materials = moduli.materials(plan.materials.len())?;
    }
    // What the engine itself cannot do (one law for all pairs, one model for the run) is known when its inputs are written.
    scene
        .check()
        .and_then(|_| crate::peers::inputs(&scene))
        .map_err(|error| Untranslatable { what: target.name().to_owned(), why: error.to_string() })?;
    Ok(scene)
}

fn bodies(plan: &Plan) -> Result<Vec<PeerBody>, Untranslatable> {
    let table = &plan.bodies;
    (0..table.len())
        .map(|i| {
            if (table.inertia_factor[i] - 0.4).abs() > 1e-15 {
                return refuse(format!("body {}", table.id[i]), "the peers know homogeneous spheres only");
            }
            let r = table.radius[i];
            Ok(PeerBody {
                id: u64::from(table.id[i]),
                kind: usize::from(table.material[i]) + 1,
                diameter: 2.0 * r,
                density: density(table.mass[i], r),
                position: table.position[i],
                velocity: table.velocity[i],
                angular_velocity: table.spin[i],
            })
        })
        .collect()
}

/// The density from which the peers' formula makes this mass again, to the last bit where there is one; the one with the
/// fewest digits among those.
fn density(mass: f64, r: f64) -> f64 {
    let made = |density: f64| 4.0 * PI / 3.0 * r * r * r * density;
    let quotient = mass / (4.0 * PI / 3.0 * r * r * r);
    let short = format!("{quotient:.12e}").parse().unwrap_or(quotient);
    let near = [short, quotient, quotient.next_down(), quotient.next_up()];
    near.into_iter().find(|density| made(*density) == mass).unwrap_or(quotient)
}

/// A box for engines that must have one: the cell where it is finite, else room for ten times the motion.
fn bounds(plan: &Plan, largest_radius: f64) -> ([f64; 3], [f64; 3]) {
    let duration = plan.driver.step * plan.driver.steps as f64;
    let (mut lower, mut upper) = (plan.cell.lo(), plan.cell.hi());
    for axis in 0..3 {
        let fall = 0.5 * plan.gravity[axis].abs() * duration * duration;
        let speed = plan.bodies.velocity.iter().fold(0.0, |a: f64, v| {
            // A hit can turn all of the speed into this direction.
            a.max(v.iter().map(|c| c * c).sum::<f64>().sqrt())
        });
        let room = 10.0 * (largest_radius + speed * duration + fall);
        let first = plan.bodies.position.iter().fold(f64::INFINITY, |a, x| a.min(x[axis]));
        let last = plan.bodies.position.iter().fold(f64::NEG_INFINITY, |a, x| a.max(x[axis]));
        if !lower[axis].is_finite() {
            lower[axis] = first - room;
        }
        if !upper[axis].is_finite() {
            upper[axis] = last + room;
        }
    }
    (lower, upper)
}

fn walls(plan: &Plan) -> Result<Vec<PeerWall>, Untranslatable> {
    plan.walls
        .iter()
        .map(|wall| {
            let name = || format!("wall `{}`", wall.name);
            let Surface::Plane(plane) = wall.wall.surface() else {
                return refuse(name(), "the peers are told planes only");
            };
            let normal = plane.normal();
            let Some(index) = (0..3).find(|&axis| normal[axis].abs() == 1.0) else {
                return refuse(name(), "the planes of the peers are perpendicular to an axis");
            };
            let Some(velocity) = wall.wall.motion().steady_velocity() else {
                return refuse(name(), "the peers' walls move with a constant velocity only");
            };
            if velocity[index] != 0.0 || velocity.iter().filter(|v| **v != 0.0).count() > 1 {
                return refuse(name(), "the peers' walls slide in their own plane, along one axis");
            }
            Ok(PeerWall {
                axis: [Axis::X, Axis::Y, Axis::Z][index],
                position: plane.point()[index],
                side: if normal[index] > 0.0 { Side::Above } else { Side::Below },
                velocity: velocity.into(),
                kind: usize::from(wall.material) + 1,
            })
        })
        .collect()
}
