//! CSV time series of quantities of the whole system.

use std::path::{Path, PathBuf};

use granule_drivers::View;
use granule_formats::Provenance;
use granule_formats::csv::{AppendLog, Column};
use granule_plan::SERIES;

use crate::{Energy, Mark, ObserveError, Observer, quantities};

/// How a quantity is computed from the view, the energies of the view, and those of the start.
pub type Compute = fn(&View<'_>, &Energy, &Energy) -> f64;

/// The computation behind a name of [`SERIES`].
pub fn compute(name: &str) -> Option<Compute> {
    Some(match name {
        "kinetic_energy" => |_, now, _| now.kinetic,
        "rotational_energy" => |_, now, _| now.rotational,
        "elastic_energy" => |_, now, _| now.elastic,
        "gravity_energy" => |_, now, _| now.gravity,
        "dissipated_viscous" => |_, now, _| now.dissipated_viscous,
        "dissipated_friction" => |_, now, _| now.dissipated_friction,
        "wall_work" => |_, now, _| now.wall_work,
        "energy_residual" => |_, now, start| now.residual_since(start),
        "momentum_x" => |view, _, _| quantities::momentum(view)[0],
        "momentum_y" => |view, _, _| quantities::momentum(view)[1],
        "momentum_z" => |view, _, _| quantities::momentum(view)[2],
        "contacts" => |view, _, _| view.tally().contacts as f64,
        "collisions" => |view, _, _| view.events().map_or(0.0, |counts| counts.all() as f64),
        "overlapping_collisions" => {
            |view, _, _| view.events().map_or(0.0, |counts| counts.overlapping as f64)
        }
        "coordination_number" => |view, _, _| quantities::coordination_number(view),
        "mean_height" => |view, _, _| quantities::mean_height(view),
        "maximum_height" => |view, _, _| quantities::maximum_height(view),
        "repose_angle" => |view, _, _| quantities::repose_angle(view),
        "maximum_overlap" => |view, _, _| quantities::maximum_overlap(view),
        "maximum_speed" => |view, _, _| quantities::maximum_speed(view),
        _ => return None,
    })
}

/// Writes one row an entry: step, time, and the quantities asked for.
pub struct Series {
    path: PathBuf,
    provenance: Provenance,
    columns: Vec<Column>,
    compute: Vec<Compute>,
    start: Energy,
    log: Option<AppendLog>,
}

impl Series {
    /// A time series of quantities by their names in [`SERIES`].
    ///
    /// # Errors
    /// [`ObserveError::UnknownQuantity`].
    pub fn new(path: PathBuf, names: &[String], provenance: Provenance) -> Result<Self, ObserveError> {
        let mut columns = vec![Column::new("step", ""), Column::new("time", "s")];
        let mut functions = Vec::new();
        for name in names {
            let known = SERIES.iter().find(|(known, _, _)| known == name).zip(compute(name));
            let Some(((name, unit, _), function)) = known else {
                return Err(ObserveError::UnknownQuantity { name: name.clone() });
            };
            // A pure number has no unit in a header.
            columns.push(Column::new(*name, if *unit == "1" { "" } else { *unit }));
            functions.push(function);
        }
        Ok(Self { path, provenance, columns, compute: functions, start: Energy::default(), log: None })
    }
}

impl Observer for Series {
    fn path(&self) -> &Path {
        &self.path
    }

    fn kind(&self) -> &'static str {
        "csv"
    }

    fn start(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        self.start = Energy::of(view);
        self.log = Some(AppendLog::create(&self.path, &self.provenance, &self.columns)?);
        Ok(())
    }

    fn observe(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        if let Some(log) = &mut self.log {
            let now = Energy::of(view);
            let mut row = vec![view.step() as f64, view.time()];
            row.extend(self.compute.iter().map(|compute| compute(view, &now, &self.start)));
            log.append(&row)?;
        }
        Ok(())
    }

    fn mark(&self) -> Result<Mark, ObserveError> {
        Ok(Mark::LengthSince(Mark::length(self.log.as_ref())?, self.start))
    }

    fn resume(&mut self, mark: &Mark, _view: &View<'_>) -> Result<(), ObserveError> {
        let Mark::LengthSince(length, start) = mark else { return Err(Mark::foreign(&self.path)) };
        self.start = *start;
        self.log = Some(AppendLog::resume_at(&self.path, &self.provenance, &self.columns, *length)?);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), ObserveError> {
        Ok(self.log.take().map_or(Ok(()), |log| log.sync())?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_quantity_that_a_plan_may_name_is_computed() {
        for (name, _, _) in SERIES {
            assert!(compute(name).is_some(), "{name}");
        }
        let provenance = Provenance::new("0", "0", 0).unwrap();
        let all: Vec<String> = SERIES.iter().map(|(name, _, _)| (*name).to_string()).collect();
        assert!(Series::new(PathBuf::new(), &all, provenance.clone()).is_ok());
        let error = Series::new(PathBuf::new(), &["kinetic".to_string()], provenance).err().unwrap();
        assert!(error.to_string().contains("`kinetic`; known are kinetic_energy,"));
    }
}
