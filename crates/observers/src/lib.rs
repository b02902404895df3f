//! Observers: they look at a run and write what they see. They never change it.
//!
//! [`Observers`] holds the outputs that a plan asks for and knows when each is due. [`quantities`] and [`Energy`] are
//! plain functions of a view, for whoever wants a number rather than a file.

mod body_series;
mod contacts;
mod data_file;
mod dump;
mod energy;
pub mod layer;
mod observer;
pub mod quantities;
mod series;
mod set;
mod snapshot;
mod vtk;

pub use body_series::BodySeries;
pub use contacts::ContactSeries;
pub use data_file::DataFile;
pub use dump::Dump;
pub use energy::Energy;
pub use granule_formats::Provenance;
pub use observer::{Mark, ObserveError, Observer};
pub use series::{Compute, Series, compute};
pub use set::{MANIFEST, Observers};
pub use snapshot::Snapshot;
pub use vtk::VtkSeries;
