//! Initial states: poured by our own engine, copied sideways, kept in a folder under names that tell what made them.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use granule_drivers::{Driver, TimeStepDriver};
use granule_formats::Provenance;
use granule_formats::lammps_data::{self, Atom, DataFile};
use granule_plan::Plan;

use crate::ours::SceneFile;

/// Name of the file that scenes import.
pub const BODIES: &str = "bodies.data";

/// What makes an initial state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recipe {
    /// The scene makes its bodies itself.
    Own,
    /// The last state of another scene of the benchmark.
    Poured(&'static str),
    /// The last state of a scene that starts from copies of another one's last state, with bodies of its own.
    Laid {
        /// The scene that pours.
        pour: &'static str,
        /// Copies of what it has poured.
        copies: [usize; 2],
        /// The scene that goes on.
        then: &'static str,
    },
    /// A chute: a slice of a poured packing is frozen as a rough bed, what was above flows for a while.
    Chute {
        /// The scene that pours.
        pour: &'static str,
        /// The scene that flows.
        flow: &'static str,
        /// Bodies of the frozen slice.
        bed: usize,
        /// Bodies that flow.
        mobile: usize,
    },
}

/// Folder of the scenes of the benchmark.
pub fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("bench")
}

/// The folder in which a scene finds its bodies: made now, or left by an earlier run. `None` for scenes that make their
/// own. Files appear when they are complete, under the fingerprint of the plan that made them.
///
/// # Errors
/// A scene cannot be planned, a run stops, or a file cannot be read or written.
pub fn prepare(recipe: Recipe, copies: [usize; 2], cache: &Path) -> Result<Option<PathBuf>, String> {
    let single = match recipe {
        Recipe::Own => return Ok(None),
        Recipe::Poured(scene) => poured(scene, None, [1, 1], cache)?,
        Recipe::Laid { pour, copies, then } => {
            let below = poured(pour, None, [1, 1], cache)?;
            poured(then, Some(&repeated(&below, copies, cache)?), copies, cache)?
        }
        Recipe::Chute { pour, flow, bed, mobile } => {
            let packing = poured(pour, None, [1, 1], cache)?;
            let name = format!("{}-bed", folder_name(&packing));
            let sliced = made(cache, &name, || Ok((sliced(&read(&packing)?, bed, mobile)?, name.clone())))?;
            poured(flow, Some(&sliced), [1, 1], cache)?
        }
    };
    // A laid state has its copies already.
    let more = if matches!(recipe, Recipe::Laid { .. }) { [1, 1] } else { copies };
    repeated(&single, more, cache).map(Some)
}

fn repeated(single: &Path, copies: [usize; 2], cache: &Path) -> Result<PathBuf, String> {
    if copies == [1, 1] {
        return Ok(single.to_path_buf());
    }
    let name = format!("{}-{}x{}", folder_name(single), copies[0], copies[1]);
    made(cache, &name, || Ok((copied(&read(single)?, copies), name.clone())))
}

fn folder_name(folder: &Path) -> String {
    folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn read(folder: &Path) -> Result<DataFile, String> {
    lammps_data::read(folder.join(BODIES)).map_err(|error| error.to_string())
}

/// The folder `name` of the cache with its bodies; `make` is called if it is not there yet.
fn made(
    cache: &Path,
    name: &str,
    make: impl FnOnce() -> Result<(DataFile, String), String>,
) -> Result<PathBuf, String> {
    let folder = cache.join(name);
    let path = folder.join(BODIES);
    if !path.exists() {
        let (data, origin) = make()?;
        std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        // A fixed time, so that the same state is the same file.
        let provenance = Provenance::new(env!("CARGO_PKG_VERSION"), origin.replace('_', "-"), 0)?;
        lammps_data::write(&path, &data, &provenance).map_err(|error| error.to_string())?;
    }
    Ok(folder)
}

/// The last state of a scene that starts from the bodies in `base`, if it imports any.
fn poured(name: &str, base: Option<&Path>, copies: [usize; 2], cache: &Path) -> Result<PathBuf, String> {
    let scene = scenes().join(name).join("scene.ron");
    let mut scene = SceneFile::read(&scene)?.repeated(copies);
    if let Some(base) = base {
        scene = scene.in_folder(base);
    }
    let plan = scene.plan()?;
    let key = format!("{name}-{}", &plan.fingerprint[..12.min(plan.fingerprint.len())]);
    made(cache, &key, || {
        let begin = std::time::Instant::now();
        println!("making the initial state {key}: {} bodies, {} steps", plan.bodies.len(), plan.driver.steps);
        let data = last_state(&plan)?;
        println!("  done in {:.0} s", begin.elapsed().as_secs_f64());
        Ok((data, key.clone()))
    })
}

/// Runs a plan on all cores and describes its last state.
fn last_state(plan: &Arc<Plan>) -> Result<DataFile, String> {
    let mut driver = TimeStepDriver::new(plan.clone(), None).map_err(|error| error.to_string())?;
    driver.advance(plan.driver.steps, &AtomicBool::new(false)).map_err(|error| error.to_string())?;
    let view = driver.view();
    let rows = view.bodies();
    let table = &plan.bodies;
    let atoms = view.order().iter().enumerate().map(|(rank, &place)| {
        let place = place as usize;
        Atom {
            id: rows.id[place],
            material: table.material[rank],
            diameter: 2.0 * table.radius[rank],
            density: Atom::density_of(table.mass[rank], table.radius[rank]),
            position: view.position(rank),
            image: [0; 3],
            velocity: rows.velocity_of(place),
            angular_velocity: if plan.rotation { rows.spin_of(place) } else { table.spin[rank] },
        }
    });
    let atoms: Vec<Atom> = atoms.collect();
    // The file needs bounds, also of an endless cell.
    let (mut lo, mut hi) = (plan.cell.lo(), plan.cell.hi());
    for axis in 0..3 {
        let ends = |sign: f64| atoms.iter().map(move |atom| atom.position[axis] + sign * atom.radius());
        if !lo[axis].is_finite() {
            lo[axis] = ends(-1.0).fold(f64::INFINITY, f64::min);
        }
        if !hi[axis].is_finite() {
            hi[axis] = ends(1.0).fold(f64::NEG_INFINITY, f64::max);
        }
    }
    let materials = u16::try_from(plan.materials.len()).unwrap_or(u16::MAX);
    Ok(DataFile { title: plan.title.clone(), provenance: None, materials, lo, hi, atoms })
}

/// Lateral copies of a periodic state, `copies` along x and y.
pub(super) fn copied(data: &DataFile, copies: [usize; 2]) -> DataFile {
    let mut all =
        DataFile { atoms: Vec::with_capacity(data.atoms.len() * copies[0] * copies[1]), ..data.clone() };
    let length = [data.hi[0] - data.lo[0], data.hi[1] - data.lo[1]];
    let mut id = 0;
    for column in 0..copies[0] {
        for row in 0..copies[1] {
            for atom in &data.atoms {
                id += 1;
                let [x, y, z] = atom.position;
                let position = [x + column as f64 * length[0], y + row as f64 * length[1], z];
                all.atoms.push(Atom { id, position, ..*atom });
            }
        }
    }
    for axis in 0..2 {
        all.hi[axis] = data.lo[axis] + copies[axis] as f64 * length[axis];
    }
    all
}

/// The bed of a chute: the `bed` bodies of a horizontal slice of a packing become the second material, which scenes freeze;
/// the `mobile` bodies above it, up to the surface, stay, and those below go. The slice is moved to the bottom of the cell.
pub(super) fn sliced(data: &DataFile, bed: usize, mobile: usize) -> Result<DataFile, String> {
    let mut atoms = data.atoms.clone();
    atoms.sort_by(|a, b| a.position[2].total_cmp(&b.position[2]).then(a.id.cmp(&b.id)));
    let Some(below) = atoms.len().checked_sub(bed + mobile) else {
        return Err(format!(
            "a chute of {bed} and {mobile} bodies needs more than the {} poured",
            atoms.len()
        ));
    };
    atoms.drain(..below);
    let largest = atoms.iter().map(|atom| atom.radius()).fold(0.0, f64::max);
    let bottom = atoms.first().map_or(0.0, |atom| atom.position[2]) - largest - data.lo[2];
    for (index, atom) in atoms.iter_mut().enumerate() {
        atom.id = index as u32 + 1;
        atom.position[2] -= bottom;
        (atom.velocity, atom.angular_velocity) = ([0.0; 3], [0.0; 3]);
        atom.material = u16::from(index < bed);
    }
    Ok(DataFile { atoms, materials: 2, ..data.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packing() -> DataFile {
        let atom = |id: u32, position: [f64; 3]| Atom {
            id,
            material: 0,
            diameter: 1.0,
            density: 2.0,
            position,
            image: [0; 3],
            velocity: [1.0, 0.0, 0.0],
            angular_velocity: [0.0; 3],
        };
        let heights = [2.5, 0.5, 4.5, 1.5, 3.5];
        DataFile {
            title: "five".into(),
            provenance: None,
            materials: 1,
            lo: [-1.0, 0.0, 0.0],
            hi: [1.0, 3.0, 10.0],
            atoms: heights.iter().zip(1..).map(|(z, id)| atom(id, [0.25, 1.0, *z])).collect(),
        }
    }

    #[test]
    fn copies_lie_side_by_side() {
        let all = copied(&packing(), [2, 3]);
        assert_eq!(all.atoms.len(), 30);
        assert_eq!((all.lo, all.hi), ([-1.0, 0.0, 0.0], [3.0, 9.0, 10.0]));
        let last = all.atoms[29];
        assert_eq!((last.id, last.position), (30, [2.25, 7.0, 3.5]));
        assert_eq!(last.velocity, [1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_chute_keeps_a_slice_and_what_is_above() {
        let chute = sliced(&packing(), 1, 3).unwrap();
        let heights: Vec<f64> = chute.atoms.iter().map(|atom| atom.position[2]).collect();
        assert_eq!(heights, [0.5, 1.5, 2.5, 3.5]);
        let materials: Vec<u16> = chute.atoms.iter().map(|atom| atom.material).collect();
        assert_eq!((materials, chute.materials), (vec![1, 0, 0, 0], 2));
        assert!(chute.atoms.iter().all(|atom| atom.velocity == [0.0; 3]));
        assert!(sliced(&packing(), 3, 3).is_err());
    }
}
