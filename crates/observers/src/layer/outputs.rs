//! Files of layers.

use std::path::{Path, PathBuf};

use granule_drivers::{ContactPartner, View};
use granule_formats::Provenance;
use granule_formats::csv::{self, AppendLog, Column, Table};
use granule_plan::Plan;

use super::{ImpactMeter, Layer, Touch, clusters, pair_correlation, segregation_index};
use crate::{Mark, ObserveError, Observer};

/// CSV time series: density, clusters, index of segregation, granular temperature of all bodies and of each material.
pub struct LayerSeries {
    path: PathBuf,
    provenance: Provenance,
    gap: f64,
    neighbours: f64,
    materials: Vec<(u16, String)>,
    log: Option<AppendLog>,
}

impl LayerSeries {
    /// Clusters are connected by gaps below `gap` \[m\]; bodies whose gap is below `neighbours` \[m\] are neighbours for the
    /// index of segregation.
    pub fn new(path: PathBuf, gap: f64, neighbours: f64, plan: &Plan, provenance: Provenance) -> Self {
        let mut used: Vec<u16> = plan.bodies.material.clone();
        used.sort_unstable();
        used.dedup();
        let name = |material: u16| Some((material, plan.materials.get(usize::from(material))?.name.clone()));
        let materials = used.into_iter().filter_map(name).collect();
        Self { path, provenance, gap, neighbours, materials, log: None }
    }

    fn columns(&self) -> Vec<Column> {
        let mut columns = vec![Column::new("step", ""), Column::new("time", "s")];
        for name in ["density", "clusters", "largest_cluster", "mean_cluster", "segregation_index"] {
            columns.push(Column::new(name, ""));
        }
        columns.push(Column::new("granular_temperature", "m^2/s^2"));
        for (_, name) in &self.materials {
            columns.push(Column::new(format!("granular_temperature {name}"), "m^2/s^2"));
        }
        columns
    }
}

impl Observer for LayerSeries {
    fn path(&self) -> &Path {
        &self.path
    }

    fn kind(&self) -> &'static str {
        "csv"
    }

    fn start(&mut self, _view: &View<'_>) -> Result<(), ObserveError> {
        self.log = Some(AppendLog::create(&self.path, &self.provenance, &self.columns())?);
        Ok(())
    }

    fn observe(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        let Some(log) = &mut self.log else { return Ok(()) };
        let layer = Layer::of(view);
        let clusters = clusters(&layer, self.gap);
        let mut row = vec![
            view.step() as f64,
            view.time(),
            layer.density(),
            clusters.sizes.len() as f64,
            clusters.largest() as f64,
            clusters.mean_size(),
            segregation_index(&layer, self.neighbours),
            layer.granular_temperature(None),
        ];
        row.extend(self.materials.iter().map(|(material, _)| layer.granular_temperature(Some(*material))));
        Ok(log.append(&row)?)
    }

    fn mark(&self) -> Result<Mark, ObserveError> {
        Ok(Mark::Length(Mark::length(self.log.as_ref())?))
    }

    fn resume(&mut self, mark: &Mark, _view: &View<'_>) -> Result<(), ObserveError> {
        let Mark::Length(length) = mark else { return Err(Mark::foreign(&self.path)) };
        self.log = Some(AppendLog::resume_at(&self.path, &self.provenance, &self.columns(), *length)?);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), ObserveError> {
        Ok(self.log.take().map_or(Ok(()), |log| log.sync())?)
    }
}

/// CSV of pair correlations: one row an interval of distances and entry.
pub struct PairCorrelation {
    path: PathBuf,
    provenance: Provenance,
    range: f64,
    bins: usize,
    log: Option<AppendLog>,
}

impl PairCorrelation {
    /// g(r) up to `range` \[m\] in `bins` intervals.
    pub fn new(path: PathBuf, range: f64, bins: usize, provenance: Provenance) -> Self {
        Self { path, provenance, range, bins, log: None }
    }

    fn columns(&self) -> Vec<Column> {
        let units =
            [("step", ""), ("time", "s"), ("distance", "m"), ("g", ""), ("g_like", ""), ("g_unlike", "")];
        units.map(|(name, unit)| Column::new(name, unit)).to_vec()
    }
}

impl Observer for PairCorrelation {
    fn path(&self) -> &Path {
        &self.path
    }

    fn kind(&self) -> &'static str {
        "csv"
    }

    fn start(&mut self, _view: &View<'_>) -> Result<(), ObserveError> {
        self.log = Some(AppendLog::create(&self.path, &self.provenance, &self.columns())?);
        Ok(())
    }

    fn observe(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        let Some(log) = &mut self.log else { return Ok(()) };
        let bins = pair_correlation(&Layer::of(view), self.range, self.bins);
        let row = |bin: &super::CorrelationBin| {
            [view.step() as f64, view.time(), bin.distance, bin.all, bin.like, bin.unlike]
        };
        let rows: Vec<[f64; 6]> = bins.iter().map(row).collect();
        Ok(log.append_rows(rows.iter().map(<[f64; 6]>::as_slice))?)
    }

    fn mark(&self) -> Result<Mark, ObserveError> {
        Ok(Mark::Length(Mark::length(self.log.as_ref())?))
    }

    fn resume(&mut self, mark: &Mark, _view: &View<'_>) -> Result<(), ObserveError> {
        let Mark::Length(length) = mark else { return Err(Mark::foreign(&self.path)) };
        self.log = Some(AppendLog::resume_at(&self.path, &self.provenance, &self.columns(), *length)?);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), ObserveError> {
        Ok(self.log.take().map_or(Ok(()), |log| log.sync())?)
    }
}

/// CSV table, written at the end: restitution and effective restitution by density and speed.
pub struct ImpactTable {
    path: PathBuf,
    provenance: Provenance,
    reach: f64,
    meter: ImpactMeter,
}

impl ImpactTable {
    /// The density about a pair is that of the discs or balls of radius `reach` \[m\] about its bodies: what bodies with their
    /// centres in it cover or fill.
    pub fn new(path: PathBuf, reach: f64, provenance: Provenance) -> Self {
        Self { path, provenance, reach, meter: ImpactMeter::new() }
    }

    /// What has been seen so far.
    pub fn meter(&self) -> &ImpactMeter {
        &self.meter
    }

    fn write(&self) -> Result<(), ObserveError> {
        let units = [
            ("density_from", ""),
            ("density_to", ""),
            ("speed_from", "m/s"),
            ("speed_to", "m/s"),
            ("contacts", ""),
            ("crowded", ""),
            ("interrupted", ""),
            ("rolled", ""),
            ("restitution", ""),
            ("restitution_deviation", ""),
            ("effective_restitution", ""),
            ("effective_restitution_deviation", ""),
        ];
        let columns = units.map(|(name, unit)| Column::new(name, unit)).to_vec();
        let mut values = vec![Vec::new(); columns.len()];
        for bin in self.meter.table() {
            let row = [
                bin.density[0],
                bin.density[1],
                bin.speed[0],
                bin.speed[1],
                bin.contacts as f64,
                bin.crowded as f64,
                bin.interrupted as f64,
                bin.rolled as f64,
                bin.restitution[0],
                bin.restitution[1],
                bin.effective[0],
                bin.effective[1],
            ];
            values.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
        }
        let table = Table { provenance: Some(self.provenance.clone()), columns, values };
        Ok(csv::write(&self.path, &table)?)
    }
}

impl Observer for ImpactTable {
    fn path(&self) -> &Path {
        &self.path
    }

    fn kind(&self) -> &'static str {
        "csv"
    }

    fn start(&mut self, _view: &View<'_>) -> Result<(), ObserveError> {
        // An empty table shows early that the file can be written.
        self.write()
    }

    fn observe(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        let (bodies, order) = (view.bodies(), view.order());
        let velocity: Vec<[f64; 3]> = order.iter().map(|place| bodies.velocity_of(*place as usize)).collect();
        let slips: Vec<bool> = order.iter().map(|place| view.slips(*place as usize)).collect();
        let rank = |id: u32| order.binary_search_by_key(&id, |&place| bodies.id[place as usize]);
        let mut walled = vec![false; order.len()];
        let mut touches = Vec::new();
        for contact in view.contacts() {
            let Ok(i) = rank(contact.id) else { continue };
            match contact.partner {
                ContactPartner::Wall(_) => walled[i] = true,
                ContactPartner::Body(id) => {
                    let Ok(j) = rank(id) else { continue };
                    let normal = contact.normal;
                    touches.push(if i < j {
                        Touch { bodies: (i, j), normal }
                    } else {
                        Touch { bodies: (j, i), normal: normal.map(|n| -n) }
                    });
                }
            }
        }
        let plane =
            view.plan().dimensions == granule_plan::Dimensions::Two || view.plan().substrate.is_some();
        let (cell, reach) = (view.plan().cell, self.reach);
        let period = cell.period();
        let about = |center: usize| {
            let at = bodies.position[order[center] as usize];
            let covered: f64 = bodies
                .position
                .iter()
                .filter(|row| {
                    let square = |axis: usize| {
                        let d = row[axis] - at[axis];
                        let p = period[axis];
                        (if p > 0.0 { d - (d / p).round() * p } else { d }).powi(2)
                    };
                    square(0) + square(1) + square(2) < reach * reach
                })
                .map(|row| if plane { row[3].powi(2) } else { row[3].powi(3) })
                .sum();
            covered / if plane { reach.powi(2) } else { reach.powi(3) }
        };
        self.meter.look(&velocity, &slips, &walled, &touches, |(i, j)| 0.5 * (about(i) + about(j)));
        Ok(())
    }

    fn mark(&self) -> Result<Mark, ObserveError> {
        Ok(Mark::Impacts(self.meter.clone()))
    }

    fn resume(&mut self, mark: &Mark, view: &View<'_>) -> Result<(), ObserveError> {
        match mark {
            Mark::Impacts(meter) if meter.fits(view.bodies().len()) => self.meter = meter.clone(),
            _ => return Err(Mark::foreign(&self.path)),
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<(), ObserveError> {
        self.write()
    }
}
