//! CSV of what each contact does.

use std::path::{Path, PathBuf};

use granule_drivers::{ContactForce, ContactPartner, View};
use granule_formats::Provenance;
use granule_formats::csv::{AppendLog, Column};

use crate::{Mark, ObserveError, Observer};

/// Writes one row a contact and entry: step, time, the two sides, overlap, normal, normal force, tangential force and torque
/// on the first body. Partner and wall are -1 where they are not.
pub struct ContactSeries {
    path: PathBuf,
    provenance: Provenance,
    log: Option<AppendLog>,
}

impl ContactSeries {
    /// The plan must have an output that shows contacts.
    pub fn new(path: PathBuf, provenance: Provenance) -> Self {
        Self { path, provenance, log: None }
    }
}

fn columns() -> Vec<Column> {
    let names = [
        ("step", ""),
        ("time", "s"),
        ("id", ""),
        ("partner", ""),
        ("wall", ""),
        ("overlap", "m"),
        ("nx", ""),
        ("ny", ""),
        ("nz", ""),
        ("normal_force", "N"),
        ("ftx", "N"),
        ("fty", "N"),
        ("ftz", "N"),
        ("tqx", "N m"),
        ("tqy", "N m"),
        ("tqz", "N m"),
    ];
    names.map(|(name, unit)| Column::new(name, unit)).to_vec()
}

fn row(view: &View<'_>, contact: &ContactForce) -> [f64; 16] {
    let (partner, wall) = match contact.partner {
        ContactPartner::Body(id) => (f64::from(id), -1.0),
        ContactPartner::Wall(wall) => (-1.0, f64::from(wall)),
    };
    let ([nx, ny, nz], [fx, fy, fz], [tx, ty, tz]) =
        (contact.normal, contact.tangential_force, contact.torque);
    let (step, id) = (view.step() as f64, f64::from(contact.id));
    let (overlap, push) = (contact.overlap, contact.normal_force);
    [step, view.time(), id, partner, wall, overlap, nx, ny, nz, push, fx, fy, fz, tx, ty, tz]
}

impl Observer for ContactSeries {
    fn path(&self) -> &Path {
        &self.path
    }

    fn kind(&self) -> &'static str {
        "csv"
    }

    fn start(&mut self, _view: &View<'_>) -> Result<(), ObserveError> {
        self.log = Some(AppendLog::create(&self.path, &self.provenance, &columns())?);
        Ok(())
    }

    fn observe(&mut self, view: &View<'_>) -> Result<(), ObserveError> {
        let Some(log) = &mut self.log else { return Ok(()) };
        let rows: Vec<[f64; 16]> = view.contact_forces().iter().map(|contact| row(view, contact)).collect();
        Ok(log.append_rows(rows.iter().map(<[f64; 16]>::as_slice))?)
    }

    fn mark(&self) -> Result<Mark, ObserveError> {
        Ok(Mark::Length(Mark::length(self.log.as_ref())?))
    }

    fn resume(&mut self, mark: &Mark, _view: &View<'_>) -> Result<(), ObserveError> {
        let Mark::Length(length) = mark else { return Err(Mark::foreign(&self.path)) };
        self.log = Some(AppendLog::resume_at(&self.path, &self.provenance, &columns(), *length)?);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), ObserveError> {
        Ok(self.log.take().map_or(Ok(()), |log| log.sync())?)
    }
}
