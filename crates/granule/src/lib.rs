//! granule: granular matter, simulated grain by grain.
//!
//! [`load`] reads a scene file into a plan and reports all its problems at once; [`run`] does what the plan says and
//! writes the outputs. The program `granule` is a thin layer above these two.
//!
//! ```no_run
//! use granule::prelude::*;
//!
//! let stop = std::sync::atomic::AtomicBool::new(false);
//! let summary = granule::run(
//!     "scene.ron",
//!     RunOptions { output_dir: None, threads: None, force: false, progress: &mut Silent, stop: &stop, max_time: None },
//! )?;
//! println!("{} steps, result {}", summary.steps, summary.result_hash);
//! # Ok::<(), RunError>(())
//! ```
//!
//! To look at every step oneself, take the plan and drive it:
//!
//! ```no_run
//! use granule::prelude::*;
//!
//! let plan = std::sync::Arc::new(granule::load("scene.ron")?.plan);
//! let steps = plan.driver.steps;
//! let mut driver = TimeStepDriver::new(plan, None)?;
//! let never = std::sync::atomic::AtomicBool::new(false);
//! for step in 1..=steps {
//!     driver.advance(step, &never)?;
//!     println!("{} {}", driver.time(), quantities::kinetic_energy(&driver.view()));
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! This crate links every law that granule ships. A program that wants its own laws too depends on their crates and
//! names each once: `use my_law as _;`.

mod calibrate;
mod capsule;
mod checkpoint;
mod directory;
mod drift;
mod guards;
mod law_check;
mod load;
mod progress;
mod record;
mod resume;
mod run;
mod selftest;

pub use calibrate::{CalibrateError, calibrate};
pub use directory::{DirectoryError, default_directory};
pub use drift::EnergyDrift;
pub use granule_calibration as calibration;
pub use granule_plan::{Allowance, DataFiles, explain};
pub use granule_trade as trade;
pub use law_check::{Figures, LawCheck, law_check};
pub use load::{
    LoadError, Loaded, Source, laws, load, load_text, load_within, load_without_wish, measured_again,
};
pub use progress::{Outlook, Progress, Silent, Status};
pub use resume::{ResumeError, ResumeOptions, resume};
pub use run::{Aftermath, Ending, RunError, RunOptions, RunSummary, VERSION, run, run_choice, run_plan};
pub use selftest::{SelftestResult, selftest, selftest_names};

/// The crates behind this one, for whoever needs more of them than the [`prelude`] has.
pub mod parts {
    pub use granule_drivers as drivers;
    pub use granule_engine as engine;
    pub use granule_formats as formats;
    pub use granule_geometry as geometry;
    pub use granule_law_api as law_api;
    pub use granule_observers as observers;
    pub use granule_plan as plan;
    pub use granule_report as report;
    pub use granule_scene as scene;
    pub use granule_state as state;
    pub use granule_units as units;
}

/// What most programs need.
pub mod prelude {
    pub use granule_drivers::{
        Advance, ContactPartner, ContactRecord, Counts, Driver, EngineError, EventDriver, TimeStepDriver,
        View,
    };
    pub use granule_law_api::{
        CollisionEntry, ContactEnd, Form, LawEntry, LawInfo, ParamSpec, Registry, Slot, SubstrateEntry,
        SubstrateInfo,
    };
    pub use granule_observers::{Energy, Observer, Observers, quantities};
    pub use granule_plan::{Dimensions, OutputKind, Plan};
    pub use granule_scene::{Diagnostic, Severity};

    pub use crate::{
        Ending, LawCheck, LoadError, Loaded, Outlook, Progress, RunError, RunOptions, RunSummary, Silent,
        Source, Status,
    };
}
