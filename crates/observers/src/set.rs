//! All observers of a run, and when each is due.

use std::path::{Component, Path, PathBuf};

use granule_drivers::View;
use granule_formats::FormatError;
use granule_plan::{OutputKind, OutputPlan, Plan};

use crate::layer::{ImpactTable, LayerSeries, PairCorrelation};
use crate::{
    BodySeries, ContactSeries, DataFile, Dump, Mark, ObserveError, Observer, Provenance, Series, VtkSeries,
};

/// An observer with the interval at which it looks.
struct Scheduled {
    observer: Box<dyn Observer>,
    every: u64,
    /// Step of its last entry.
    seen: Option<u64>,
}

/// The observers of a run. Each writes an entry at the first step, at every multiple of its interval, and at the end.
#[derive(Default)]
pub struct Observers {
    scheduled: Vec<Scheduled>,
}

impl Observers {
    /// No observers.
    pub fn new() -> Self {
        Self::default()
    }

    /// The observers of the outputs of a plan. Files go into `directory` and below; folders that lack are made when the
    /// run starts. Every file says where it comes from.
    ///
    /// # Errors
    /// A path leaves the folder or is used twice, or an output names a quantity or body that does not exist.
    pub fn from_plan(plan: &Plan, directory: &Path, provenance: &Provenance) -> Result<Self, ObserveError> {
        let mut observers = Self::new();
        let mut taken: Vec<PathBuf> = Vec::new();
        for output in &plan.outputs {
            for path in files(output) {
                check(&path, &taken)?;
                taken.push(path);
            }
            // Of the last state only the last one counts. The entry at the start shows early that the file can be written.
            let every = if output.kind == OutputKind::LammpsData { u64::MAX } else { output.every };
            observers.push(every, sink(plan, output, directory, provenance)?);
        }
        Ok(observers)
    }

    /// Adds an observer that looks every `every` steps (at least 1).
    pub fn push(&mut self, every: u64, observer: Box<dyn Observer>) {
        self.scheduled.push(Scheduled { observer, every: every.max(1), seen: None });
    }

    /// Number of observers.
    pub fn len(&self) -> usize {
        self.scheduled.len()
    }

    /// True without observers.
    pub fn is_empty(&self) -> bool {
        self.scheduled.is_empty()
    }

    /// Path and kind of the file of each observer.
    pub fn files(&self) -> impl Iterator<Item = (&Path, &'static str)> {
        self.scheduled.iter().map(|scheduled| (scheduled.observer.path(), scheduled.observer.kind()))
    }

    /// The first step after `step` at which an observer is due; `None` without observers.
    pub fn next_due(&self, step: u64) -> Option<u64> {
        self.scheduled
            .iter()
            .map(|scheduled| (step / scheduled.every + 1).saturating_mul(scheduled.every))
            .min()
    }

    /// Where all observers are, in their order, each with the step of its last entry; what they have written is then on the
    /// disk.
    ///
    /// # Errors
    /// See [`ObserveError`].
    pub fn marks(&self) -> Result<Vec<(Option<u64>, Mark)>, ObserveError> {
        self.scheduled.iter().map(|scheduled| Ok((scheduled.seen, scheduled.observer.mark()?))).collect()
    }

    /// Goes on from marks instead of [`start`](Self::start): what was written later is cut off.
    ///
    /// # Errors
    /// The marks are not those of these observers, or a file is not as it was.
    pub fn resume(&mut self, marks: &[(Option<u64>, Mark)], view: &View<'_>) -> Result<(), ObserveError> {
        for (index, scheduled) in self.scheduled.iter_mut().enumerate() {
            let Some((seen, mark)) = marks.get(index) else {
                return Err(Mark::foreign(scheduled.observer.path()));
            };
            scheduled.seen = *seen;
            scheduled.observer.resume(mark, view)?;
        }
        Ok(())
    }

    /// Opens all observers and lets them look for the first time.
    ///
    /// # Errors
    /// See [`ObserveError`].
    pub fn start(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        for scheduled in &mut self.scheduled {
            make_folder(scheduled.observer.path())?;
            scheduled.observer.start(view)?;
            scheduled.look(view)?;
        }
        Ok(())
    }

    /// Lets every observer that is due look.
    ///
    /// # Errors
    /// See [`ObserveError`].
    pub fn observe(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        for scheduled in &mut self.scheduled {
            if view.step().is_multiple_of(scheduled.every) {
                scheduled.look(view)?;
            }
        }
        Ok(())
    }

    /// Lets every observer look at the last state, unless it has done so, and completes all files.
    ///
    /// # Errors
    /// The first error; the remaining observers are completed all the same.
    pub fn finish(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        let mut result = Ok(());
        for scheduled in &mut self.scheduled {
            let looked = scheduled.look(view).and_then(|()| scheduled.observer.finish());
            result = result.and(looked);
        }
        result
    }

    /// Completes all files without a further look: for a run whose last state is not worth keeping.
    ///
    /// # Errors
    /// The first error; the remaining observers are completed all the same.
    pub fn close(&mut self) -> Result<(), ObserveError> {
        let mut result = Ok(());
        for scheduled in &mut self.scheduled {
            result = result.and(scheduled.observer.finish());
        }
        result
    }
}

impl Scheduled {
    fn look(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        if self.seen == Some(view.step()) {
            return Ok(());
        }
        self.seen = Some(view.step());
        self.observer.observe(view)
    }
}

fn sink(
    plan: &Plan,
    output: &OutputPlan,
    directory: &Path,
    provenance: &Provenance,
) -> Result<Box<dyn Observer>, ObserveError> {
    let path = directory.join(&output.path);
    let provenance = provenance.clone();
    Ok(match &output.kind {
        OutputKind::Series(columns) => Box::new(Series::new(path, columns, provenance)?),
        OutputKind::BodySeries(ids) => Box::new(BodySeries::new(path, ids, plan, provenance)?),
        OutputKind::LammpsDump => Box::new(Dump::new(path, provenance)),
        OutputKind::Vtk { compressed } => Box::new(VtkSeries::new(&path, *compressed, provenance)),
        OutputKind::LammpsData => Box::new(DataFile::new(path, provenance)),
        OutputKind::Layer { gap, neighbours } => {
            Box::new(LayerSeries::new(path, *gap, *neighbours, plan, provenance))
        }
        OutputKind::PairCorrelation { range, bins } => {
            Box::new(PairCorrelation::new(path, *range, *bins, provenance))
        }
        OutputKind::Contacts => Box::new(ContactSeries::new(path, provenance)),
        OutputKind::Impacts { reach } => Box::new(ImpactTable::new(path, *reach, provenance)),
    })
}

/// Makes the folder that a file will lie in.
fn make_folder(path: &Path) -> Result<(), ObserveError> {
    let Some(folder) = path.parent() else { return Ok(()) };
    std::fs::create_dir_all(folder).map_err(|source| {
        ObserveError::Write(FormatError::Io { file: folder.to_path_buf(), action: "create", source })
    })
}

/// The files that an output writes, as far as they can clash.
fn files(output: &OutputPlan) -> Vec<PathBuf> {
    match output.kind {
        OutputKind::Vtk { .. } => vec![crate::vtk::collection(&output.path)],
        _ => vec![output.path.clone()],
    }
}

fn check(path: &Path, taken: &[PathBuf]) -> Result<(), ObserveError> {
    let fail = |reason| Err(ObserveError::Path { path: path.to_path_buf(), reason });
    let inside = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !inside || path.file_name().is_none() {
        return fail("must be a path inside the output folder");
    }
    let plain =
        |path: &Path| path.components().filter(|part| *part != Component::CurDir).collect::<PathBuf>();
    if plain(path) == Path::new(MANIFEST) {
        return fail("is the name of the run's manifest");
    }
    if taken.iter().any(|other| plain(other) == plain(path)) {
        return fail("two outputs write this file");
    }
    Ok(())
}

/// Name of the manifest beside the outputs.
pub const MANIFEST: &str = "manifest.json";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_inside_and_differ() {
        let good = |path: &str, taken: &[&str]| {
            let taken: Vec<PathBuf> = taken.iter().map(PathBuf::from).collect();
            check(Path::new(path), &taken).is_ok()
        };
        assert!(good("a.csv", &[]));
        assert!(good("deep/a.csv", &["a.csv"]));
        assert!(!good("../a.csv", &[]));
        assert!(!good("/tmp/a.csv", &[]));
        assert!(!good("", &[]));
        assert!(!good("deep/..", &[]));
        assert!(!good("./a.csv", &["a.csv"]));
        assert!(!good("./manifest.json", &[]));
    }
}
