//! LAMMPS data file of the last state.

use std::path::{Path, PathBuf};

use granule_drivers::View;
use granule_formats::Provenance;
use granule_formats::lammps_data::{self, Atom};

use crate::{Mark, ObserveError, Observer, Snapshot};

/// Keeps a LAMMPS data file (`atom_style sphere`) of the latest entry: each one replaces the one before in a single
/// stroke. [`Observers::from_plan`](crate::Observers::from_plan) lets it look at the start and at the end of a run.
///
/// The file holds diameter and density. The density is that of a sphere with the body's mass, whatever its inertia factor.
pub struct DataFile {
    path: PathBuf,
    provenance: Provenance,
}

impl DataFile {
    /// A data file at a path.
    pub fn new(path: PathBuf, provenance: Provenance) -> Self {
        Self { path, provenance }
    }
}

impl Observer for DataFile {
    fn path(&self) -> &Path {
        &self.path
    }

    fn kind(&self) -> &'static str {
        "lammps-data"
    }

    fn start(&mut self, _view: &View<'_>) -> Result<(), ObserveError> {
        Ok(())
    }

    fn observe(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        let plan = view.plan();
        let snapshot = Snapshot::of(view);
        let frame = snapshot.frame(&[]);
        let atoms = (0..frame.len()).map(|index| Atom {
            id: frame.id[index],
            material: frame.material[index],
            diameter: 2.0 * frame.radius[index],
            density: Atom::density_of(frame.mass[index], frame.radius[index]),
            position: frame.position[index],
            image: snapshot.image(index),
            velocity: frame.velocity[index],
            angular_velocity: frame.angular_velocity.map_or([0.0; 3], |spin| spin[index]),
        });
        // A title is one short line.
        let title: String =
            plan.title.chars().map(|c| if c.is_control() { ' ' } else { c }).take(40).collect();
        let file = lammps_data::DataFile {
            title: format!("{} step {}", title.trim(), view.step()).trim().to_string(),
            provenance: None,
            materials: u16::try_from(plan.materials.len().max(1)).unwrap_or(u16::MAX),
            lo: frame.cell.lo,
            hi: frame.cell.hi,
            atoms: atoms.collect(),
        };
        Ok(lammps_data::write(&self.path, &file, &self.provenance)?)
    }

    fn mark(&self) -> Result<Mark, ObserveError> {
        Ok(Mark::Nothing)
    }

    fn resume(&mut self, mark: &Mark, _view: &View<'_>) -> Result<(), ObserveError> {
        if matches!(mark, Mark::Nothing) { Ok(()) } else { Err(Mark::foreign(&self.path)) }
    }

    fn finish(&mut self) -> Result<(), ObserveError> {
        Ok(())
    }
}
