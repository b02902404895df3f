//! How a run tells what it is doing.

use std::path::Path;
use std::time::Duration;

/// What a run will do, told once before its first step.
#[derive(Clone, Copy, Debug)]
pub struct Outlook<'a> {
    /// Title of the scene, may be empty.
    pub title: &'a str,
    /// Bodies.
    pub bodies: usize,
    /// Steps of the whole run.
    pub steps: u64,
    /// Simulated time of the whole run \[s\].
    pub duration: f64,
    /// Worker threads.
    pub threads: usize,
    /// Folder of the outputs.
    pub directory: &'a Path,
}

/// How far a run is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Status {
    /// Steps done.
    pub step: u64,
    /// Simulated time \[s\].
    pub time: f64,
    /// Bodies times steps, per second of wall-clock time since the first step.
    pub particle_steps_per_second: f64,
    /// Wall-clock time since the first step.
    pub elapsed: Duration,
    /// Wall-clock time that is probably left; `None` before the first step.
    pub left: Option<Duration>,
}

/// Somebody who wants to know how far a run is. It is told at least a few times a second, and after each output.
pub trait Progress {
    /// Before the first step.
    fn begin(&mut self, outlook: &Outlook<'_>);
    /// Now and then.
    fn advance(&mut self, status: &Status);
    /// Something that the user should know.
    fn warn(&mut self, _message: &str) {}
    /// After the last step, however the run ended.
    fn end(&mut self, status: &Status);
}

/// Tells nobody.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&mut self, _outlook: &Outlook<'_>) {}
    fn advance(&mut self, _status: &Status) {}
    fn end(&mut self, _status: &Status) {}
}
