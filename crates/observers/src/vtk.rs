//! VTK files for ParaView.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use granule_drivers::View;
use granule_formats::Provenance;
use granule_formats::vtk::{Compression, Series};

use crate::{Mark, ObserveError, Observer, Snapshot};

/// Writes one `.vtp` file an entry and a `.pvd` collection that names them with their times. Positions are those inside
/// the cell.
pub struct VtkSeries {
    path: PathBuf,
    compression: Compression,
    provenance: Provenance,
    series: Option<Series>,
}

impl VtkSeries {
    /// A series with the base name `base`: `base.pvd`, `base_000000.vtp`, ...
    pub fn new(base: &Path, compressed: bool, provenance: Provenance) -> Self {
        let compression = if compressed { Compression::Zlib } else { Compression::Raw };
        Self { path: collection(base), compression, provenance, series: None }
    }
}

/// The collection of a series with a base name, which may already end in `.pvd`.
pub(crate) fn collection(base: &Path) -> PathBuf {
    if base.extension().is_some_and(|extension| extension == "pvd") {
        return base.to_path_buf();
    }
    let mut name = OsString::from(base.as_os_str());
    name.push(".pvd");
    PathBuf::from(name)
}

impl Observer for VtkSeries {
    fn path(&self) -> &Path {
        &self.path
    }

    fn kind(&self) -> &'static str {
        "vtk"
    }

    fn start(&mut self, _view: &View<'_>) -> Result<(), ObserveError> {
        self.series = Some(Series::create(&self.path, &self.provenance, self.compression)?);
        Ok(())
    }

    fn observe(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        if let Some(series) = &mut self.series {
            series.append(&Snapshot::of(view).frame(&[]))?;
        }
        Ok(())
    }

    fn mark(&self) -> Result<Mark, ObserveError> {
        // Every file of a series is on the disk when it is complete.
        Ok(Mark::Files(self.series.as_ref().map_or(0, |series| series.entries().len() as u64)))
    }

    fn resume(&mut self, mark: &Mark, _view: &View<'_>) -> Result<(), ObserveError> {
        let Mark::Files(files) = mark else { return Err(Mark::foreign(&self.path)) };
        self.series = Some(Series::resume_at(&self.path, &self.provenance, self.compression, *files)?);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), ObserveError> {
        self.series = None;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_base_name_keeps_its_dots() {
        assert_eq!(collection(Path::new("a/run.1")), Path::new("a/run.1.pvd"));
        assert_eq!(collection(Path::new("a/run.pvd")), Path::new("a/run.pvd"));
    }
}
