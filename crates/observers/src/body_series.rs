//! CSV time series of single bodies.

use std::path::{Path, PathBuf};

use granule_drivers::View;
use granule_formats::Provenance;
use granule_formats::csv::{AppendLog, Column};
use granule_plan::{Dimensions, Plan};

use crate::{Mark, ObserveError, Observer, quantities};

/// Writes one row a body and entry: step, time, identity, position, velocity, spin, force and torque, as far as they
/// exist in the plan. Positions do not jump at periodic boundaries.
pub struct BodySeries {
    path: PathBuf,
    provenance: Provenance,
    ids: Vec<u32>,
    planar: bool,
    rotation: bool,
    /// Ranks of the bodies in the order of identities.
    ranks: Vec<usize>,
    log: Option<AppendLog>,
}

impl BodySeries {
    /// A time series of bodies by their identities.
    ///
    /// # Errors
    /// [`ObserveError::UnknownBody`].
    pub fn new(
        path: PathBuf,
        ids: &[u32],
        plan: &Plan,
        provenance: Provenance,
    ) -> Result<Self, ObserveError> {
        if let Some(id) = ids.iter().find(|id| !plan.bodies.id.contains(id)) {
            return Err(ObserveError::UnknownBody { id: *id });
        }
        Ok(Self {
            path,
            provenance,
            ids: ids.to_vec(),
            planar: plan.dimensions == Dimensions::Two,
            rotation: plan.rotation,
            ranks: Vec::new(),
            log: None,
        })
    }

    fn columns(&self) -> Vec<Column> {
        let mut columns = vec![Column::new("step", ""), Column::new("time", "s"), Column::new("id", "")];
        let axes: &[&str] = if self.planar { &["x", "y"] } else { &["x", "y", "z"] };
        let turns: &[&str] = if self.planar { &["z"] } else { &["x", "y", "z"] };
        let mut add = |prefix: &str, axes: &[&str], unit: &str| {
            columns.extend(axes.iter().map(|axis| Column::new(format!("{prefix}{axis}"), unit)));
        };
        add("", axes, "m");
        add("v", axes, "m/s");
        if self.rotation {
            add("omega", turns, "rad/s");
        }
        add("f", axes, "N");
        if self.rotation {
            add("tq", turns, "N m");
        }
        columns
    }

    fn find(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        let bodies = view.bodies();
        self.ranks.clear();
        for id in &self.ids {
            let rank = view.order().binary_search_by_key(id, |&place| bodies.id[place as usize]);
            self.ranks.push(rank.map_err(|_| ObserveError::UnknownBody { id: *id })?);
        }
        Ok(())
    }

    fn row(&self, view: &View<'_>, id: u32, rank: usize) -> Vec<f64> {
        let (bodies, place) = (view.bodies(), view.order()[rank] as usize);
        let mut row = vec![view.step() as f64, view.time(), f64::from(id)];
        let axes = if self.planar { 0..2 } else { 0..3 };
        let turns = if self.planar { 2..3 } else { 0..3 };
        row.extend_from_slice(&quantities::unwrapped_position(view, rank)[axes.clone()]);
        row.extend_from_slice(&bodies.velocity_of(place)[axes.clone()]);
        if self.rotation {
            row.extend_from_slice(&bodies.spin_of(place)[turns.clone()]);
        }
        row.extend_from_slice(&bodies.force_of(place)[axes]);
        if self.rotation {
            row.extend_from_slice(&bodies.torque_of(place)[turns]);
        }
        row
    }
}

impl Observer for BodySeries {
    fn path(&self) -> &Path {
        &self.path
    }

    fn kind(&self) -> &'static str {
        "csv"
    }

    fn start(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        self.find(view)?;
        self.log = Some(AppendLog::create(&self.path, &self.provenance, &self.columns())?);
        Ok(())
    }

    fn observe(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        let rows: Vec<Vec<f64>> =
            self.ids.iter().zip(&self.ranks).map(|(id, rank)| self.row(view, *id, *rank)).collect();
        if let Some(log) = &mut self.log {
            log.append_rows(rows.iter().map(Vec::as_slice))?;
        }
        Ok(())
    }

    fn mark(&self) -> Result<Mark, ObserveError> {
        Ok(Mark::Length(Mark::length(self.log.as_ref())?))
    }

    fn resume(&mut self, mark: &Mark, view: &View<'_>) -> Result<(), ObserveError> {
        let Mark::Length(length) = mark else { return Err(Mark::foreign(&self.path)) };
        self.find(view)?;
        self.log = Some(AppendLog::resume_at(&self.path, &self.provenance, &self.columns(), *length)?);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), ObserveError> {
        Ok(self.log.take().map_or(Ok(()), |log| log.sync())?)
    }
}
