//! Laws that panic: which one it was, from the thread where it happened to the error that ends the run.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use granule_law_api::{ContactChunk, Real, Stage};

use crate::error::EngineError;

/// What unwinds from a law that panicked.
pub(crate) struct Blame {
    law: &'static str,
    message: String,
}

/// Runs a stage. If it panics, its law is named to [`end`], across threads. Costs nothing as long as it does not.
#[inline]
pub(crate) fn run<T: Real>(law: &'static str, stage: &dyn Stage<T>, chunk: &mut ContactChunk<'_, T>) {
    // The columns of a chunk are numbers whatever happened to them, and nobody reads them after a panic.
    if let Err(payload) = catch_unwind(AssertUnwindSafe(|| stage.run(chunk))) {
        let message = message(payload.as_ref());
        resume_unwind(Box::new(Blame { law, message }));
    }
}

/// Does what may meet a law that panics. Every other panic goes on.
pub(crate) fn caught<R>(work: impl FnOnce() -> R) -> Result<R, Box<Blame>> {
    catch_unwind(AssertUnwindSafe(work))
        .map_err(|payload| payload.downcast::<Blame>().unwrap_or_else(|other| resume_unwind(other)))
}

impl Blame {
    /// The error of a run.
    pub fn at(self, step: u64, time: f64) -> EngineError {
        EngineError::LawPanicked { law: self.law, message: self.message, step, time }
    }
}

fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| text.to_string());
    text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_string())
}
