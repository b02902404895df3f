//! LAMMPS text dump.

use std::path::{Path, PathBuf};

use granule_drivers::View;
use granule_formats::lammps_dump::{Dialect, DumpWriter};
use granule_formats::{Provenance, ScalarColumn};

use crate::{Mark, ObserveError, Observer, Snapshot};

/// Names of the image flags of a dump.
const IMAGES: [&str; 3] = ["ix", "iy", "iz"];

/// Appends one frame an entry to a LAMMPS text dump. Positions are those inside the cell; where it is periodic, image
/// flags tell how often a body has crossed it.
pub struct Dump {
    path: PathBuf,
    provenance: Provenance,
    writer: Option<DumpWriter>,
}

impl Dump {
    /// A dump at a path.
    pub fn new(path: PathBuf, provenance: Provenance) -> Self {
        Self { path, provenance, writer: None }
    }
}

impl Observer for Dump {
    fn path(&self) -> &Path {
        &self.path
    }

    fn kind(&self) -> &'static str {
        "lammps-dump"
    }

    fn start(&mut self, _view: &View<'_>) -> Result<(), ObserveError> {
        self.writer = Some(DumpWriter::create(&self.path, &self.provenance, Dialect::Lammps));
        Ok(())
    }

    fn observe(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        if let Some(writer) = &mut self.writer {
            let snapshot = Snapshot::of(view);
            let images = snapshot.images();
            let columns: Vec<ScalarColumn<'_>> = IMAGES
                .iter()
                .zip(&images)
                .filter(|_| view.plan().cell.is_periodic())
                .map(|(name, values)| ScalarColumn { name, values })
                .collect();
            writer.append(&snapshot.frame(&columns))?;
        }
        Ok(())
    }

    fn mark(&self) -> Result<Mark, ObserveError> {
        let Some(writer) = &self.writer else { return Ok(Mark::Length(0)) };
        writer.sync()?;
        Ok(Mark::Length(writer.length()))
    }

    fn resume(&mut self, mark: &Mark, _view: &View<'_>) -> Result<(), ObserveError> {
        let Mark::Length(length) = mark else { return Err(Mark::foreign(&self.path)) };
        self.writer = Some(DumpWriter::resume_at(&self.path, &self.provenance, Dialect::Lammps, *length)?);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), ObserveError> {
        Ok(self.writer.take().map_or(Ok(()), |writer| writer.sync())?)
    }
}
