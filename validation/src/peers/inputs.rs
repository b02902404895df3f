//! The files an engine reads, as text, and their hash.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

use xxhash_rust::xxh3::xxh3_128;

use super::{Engine, PeerError, PeerScene, lammps, liggghts};

/// Name of the file with the bodies.
pub(super) const BODIES: &str = "bodies.data";
/// Name of the dump that the script asks for.
pub(super) const DUMP: &str = "frames.dump";

/// Inputs of one run, as they are written into a work folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputFiles {
    /// The engine they are for.
    pub engine: Engine,
    /// Name of the script.
    pub script_name: &'static str,
    /// The script.
    pub script: String,
    /// The data file with the bodies.
    pub bodies: String,
}

impl InputFiles {
    /// Hash of both texts and their names, with the algorithm in front.
    pub fn hash(&self) -> String {
        let text = format!("{}\n{}\n{}\n{}", self.script_name, self.script, BODIES, self.bodies);
        format!("xxh3-128:{:032x}", xxh3_128(text.as_bytes()))
    }

    /// Writes both files.
    ///
    /// # Errors
    /// [`PeerError::File`].
    pub fn write(&self, folder: &Path) -> Result<(), PeerError> {
        for (name, text) in [(self.script_name, &self.script), (BODIES, &self.bodies)] {
            let path = folder.join(name);
            std::fs::write(&path, text).map_err(|error| PeerError::File(path, error))?;
        }
        Ok(())
    }
}

/// Inputs of a scene for the engine of its laws.
///
/// # Errors
/// [`PeerError::Scene`] if the scene is wrong, [`PeerError::Unsupported`] if the engine cannot do it.
pub fn inputs(scene: &PeerScene) -> Result<InputFiles, PeerError> {
    let engine = scene.check()?;
    let (script_name, script) = match engine {
        Engine::Lammps => ("in.lammps", lammps::script(scene)?),
        Engine::Liggghts => ("in.liggghts", liggghts::script(scene)?),
    };
    Ok(InputFiles { engine, script_name, script, bodies: bodies(scene) })
}

/// Data file of `atom_style sphere` (LIGGGHTS: `granular`), 17 significant digits; both engines read the same.
fn bodies(scene: &PeerScene) -> String {
    let mut text =
        format!("{}\n\n{} atoms\n{} atom types\n\n", scene.title, scene.bodies.len(), scene.kinds());
    for (k, axis) in ["x", "y", "z"].iter().enumerate() {
        put(&mut text, format_args!("{:.16e} {:.16e} {axis}lo {axis}hi\n", scene.lower[k], scene.upper[k]));
    }
    text.push_str("\nAtoms\n\n");
    for body in &scene.bodies {
        let [x, y, z] = body.position;
        put(
            &mut text,
            format_args!(
                "{} {} {:.16e} {:.16e} {x:.16e} {y:.16e} {z:.16e}\n",
                body.id, body.kind, body.diameter, body.density
            ),
        );
    }
    text.push_str("\nVelocities\n\n");
    for body in &scene.bodies {
        let ([vx, vy, vz], [wx, wy, wz]) = (body.velocity, body.angular_velocity);
        put(
            &mut text,
            format_args!("{} {vx:.16e} {vy:.16e} {vz:.16e} {wx:.16e} {wy:.16e} {wz:.16e}\n", body.id),
        );
    }
    text
}

/// Appends to a string, which cannot fail.
pub(super) fn put(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    let _infallible = text.write_fmt(arguments);
}

/// Lines that both engines share after their laws and walls: gravity, frozen bodies, integration, dump, run.
pub(super) fn tail(scene: &PeerScene, dump_format: &str, freeze: &str) -> String {
    let mut text = String::new();
    let g = scene.gravity;
    if g != [0.0; 3] {
        // The engines normalise the vector themselves; along an axis that is exact.
        let axis = (0..3).find(|k| g[(k + 1) % 3] == 0.0 && g[(k + 2) % 3] == 0.0);
        match axis {
            Some(k) => {
                let mut direction = [0.0; 3];
                direction[k] = g[k].signum();
                let [x, y, z] = direction;
                put(&mut text, format_args!("fix g all gravity {:?} vector {x:?} {y:?} {z:?}\n", g[k].abs()));
            }
            None => {
                let magnitude = super::vector::norm(g);
                let [x, y, z] = g;
                put(&mut text, format_args!("fix g all gravity {magnitude:?} vector {x:?} {y:?} {z:?}\n"));
            }
        }
    }
    if scene.frozen.is_empty() {
        text.push_str("fix i all nve/sphere\n");
    } else {
        match frozen_kinds(scene) {
            Some(kinds) => put(
                &mut text,
                format_args!(
                    "group frozen type {}\nneigh_modify exclude group frozen frozen\n",
                    kinds.join(" ")
                ),
            ),
            None => {
                // A later `group ... id` adds to the group.
                for ids in scene.frozen.chunks(16) {
                    text.push_str("group frozen id");
                    for id in ids {
                        put(&mut text, format_args!(" {id}"));
                    }
                    text.push('\n');
                }
            }
        }
        put(
            &mut text,
            format_args!(
                "group mobile subtract all frozen\nfix i mobile nve/sphere\nfix f frozen {freeze}\n"
            ),
        );
    }
    put(&mut text, format_args!("timestep {:?}\n", scene.time_step));
    if scene.dump_every > 0 {
        put(&mut text, format_args!("dump d all custom {} {DUMP} id", scene.dump_every));
        for column in scene.quantities.iter().flat_map(|quantity| quantity.columns()) {
            put(&mut text, format_args!(" {column}"));
        }
        put(&mut text, format_args!("\ndump_modify d sort id format {dump_format}\n"));
    }
    put(&mut text, format_args!("thermo {}\nthermo_modify lost error norm no\n", scene.steps));
    if scene.warm_up > 0 {
        put(&mut text, format_args!("run {}\n", scene.warm_up));
    }
    put(&mut text, format_args!("run {}\n", scene.steps));
    text
}

/// The types that are frozen, if that says all: for many bodies the engines read it much faster than a list of ids.
fn frozen_kinds(scene: &PeerScene) -> Option<Vec<String>> {
    const FEW: usize = 64;
    if scene.frozen.len() <= FEW {
        return None;
    }
    let frozen: BTreeSet<u64> = scene.frozen.iter().copied().collect();
    let (mut still, mut mobile) = (BTreeSet::new(), BTreeSet::new());
    for body in &scene.bodies {
        let group = if frozen.contains(&body.id) { &mut still } else { &mut mobile };
        group.insert(body.kind);
    }
    still.is_disjoint(&mobile).then(|| still.iter().map(usize::to_string).collect())
}

/// `p` or `f` per direction.
pub(super) fn boundary(scene: &PeerScene) -> String {
    scene.periodic.map(|periodic| if periodic { "p" } else { "f" }).join(" ")
}

/// Wall velocity as the engines' `shear` keyword, or nothing.
pub(super) fn shear(velocity: [f64; 3]) -> String {
    match (0..3).find(|k| velocity[*k] != 0.0) {
        Some(k) => format!(" shear {} {:?}", ["x", "y", "z"][k], velocity[k]),
        None => String::new(),
    }
}
