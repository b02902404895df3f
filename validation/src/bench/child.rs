//! One run of ours in a process of its own, so that its memory and its start can be told apart from the benchmark's.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use granule_drivers::{Driver, TimeStepDriver};
use granule_formats::Provenance;
use granule_observers::{Observer, VtkSeries};
use serde::{Deserialize, Serialize};

use crate::ours::SceneFile;
use crate::peers::{peak_resident, processor_seconds};

/// A scene with what the benchmark adds to it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Job {
    /// Scene file.
    pub scene: PathBuf,
    /// Folder of the files that it imports; its own if absent.
    pub base: Option<PathBuf>,
    /// Lateral copies along x and y: how many times the cell is as long.
    pub copies: [usize; 2],
    /// Arithmetic of the laws in single precision, whatever the scene says.
    pub single: bool,
    /// Worker threads.
    pub cores: usize,
    /// Steps before the clock starts.
    pub warm_up: u64,
    /// Steps that are timed.
    pub steps: u64,
    /// Writes VTK files at the end, to time that.
    pub vtp: bool,
}

/// What one run of ours shows.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Measured {
    /// Bodies.
    pub n: usize,
    /// Seconds of the timed steps.
    pub seconds: f64,
    /// Seconds of the processor in them, for a run on one core, if the system tells.
    pub processor_seconds: Option<f64>,
    /// Seconds of them spent on candidate lists, on contacts and forces, and on time integration.
    pub phases: [f64; 3],
    /// Seconds from reading the scene to the end of the first step.
    pub start_seconds: f64,
    /// Contacts with bodies and walls a body: 4.4 in a settled packing means 4.4 neighbours.
    pub coordination: f64,
    /// Contacts with bodies and walls at the end.
    pub contacts: f64,
    /// Bytes of state, lists and histories.
    pub working_bytes: f64,
    /// Largest resident memory of the whole process until the end, if the system tells \[bytes\].
    pub peak_bytes: Option<u64>,
    /// Seconds until a `.vtp` file of all bodies is on the disk, raw and compressed, if that was asked for.
    pub vtp_seconds: Option<[f64; 2]>,
    /// Bytes that a step must move a body.
    pub moved_per_body: f64,
    /// Hash of the last positions, velocities and spins.
    pub hash: String,
}

impl Measured {
    /// 10^6 particle-steps a second; on one core, a second of the processor.
    pub fn mps(&self, job: &Job) -> f64 {
        self.n as f64 * job.steps as f64 / self.processor_seconds.unwrap_or(self.seconds) / 1e6
    }
}

impl Job {
    /// The scene with the additions.
    ///
    /// # Errors
    /// The problems of the file, as text.
    pub fn scene(&self) -> Result<SceneFile, String> {
        let mut scene = SceneFile::read(&self.scene)?.repeated(self.copies);
        if let Some(base) = &self.base {
            scene = scene.in_folder(base);
        }
        Ok(if self.single { scene.in_single_precision() } else { scene })
    }
}

/// Runs a job in a new process of the program that `program` is.
///
/// # Errors
/// The process cannot be started, fails, or answers something else.
pub fn measure(program: &Path, job: &Job) -> Result<Measured, String> {
    let words = serde_json::to_string(job).map_err(|error| error.to_string())?;
    let output = Command::new(program)
        .args(["bench-ours", &words])
        .output()
        .map_err(|error| format!("{}: {error}", program.display()))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).trim().to_string());
    }
    serde_json::from_slice(&output.stdout).map_err(|error| format!("answer of a run: {error}"))
}

/// Runs a job here.
///
/// # Errors
/// The scene cannot be planned, or the run stops.
pub fn run(job: &Job) -> Result<Measured, String> {
    let begin = Instant::now();
    let plan = job.scene()?.plan()?;
    let mut driver = TimeStepDriver::new(plan.clone(), Some(job.cores)).map_err(|error| error.to_string())?;
    let never = AtomicBool::new(false);
    driver.advance(1, &never).map_err(|error| error.to_string())?;
    let start_seconds = begin.elapsed().as_secs_f64();
    driver.advance(job.warm_up, &never).map_err(|error| error.to_string())?;
    let before = driver.timings();
    let begin = Instant::now();
    let processor = processor_seconds("self");
    driver.advance(job.warm_up + job.steps, &never).map_err(|error| error.to_string())?;
    let seconds = begin.elapsed().as_secs_f64();
    // On one core all is done by this thread.
    let spent = processor.zip(processor_seconds("self")).map(|(before, after)| after - before);
    let processor_seconds = spent.filter(|_| job.cores == 1);
    let after = driver.timings();
    let peak_bytes = peak_resident("self");
    let n = plan.bodies.len();
    let engine = driver.engine();
    let tally = engine.tally();
    let (pairs, walls) = (tally.contacts as f64, tally.wall_contacts as f64);
    let width = plan.compositions.iter().map(|composition| composition.history_width).max().unwrap_or(0);
    Ok(Measured {
        n,
        seconds,
        processor_seconds,
        phases: [
            (after.lists - before.lists).as_secs_f64(),
            (after.forces - before.forces).as_secs_f64(),
            (after.integration - before.integration).as_secs_f64(),
        ],
        start_seconds,
        coordination: (2.0 * pairs + walls) / n as f64,
        contacts: pairs + walls,
        working_bytes: (engine.bodies().layout().bytes_per_body() * n + engine.list_bytes()) as f64,
        peak_bytes,
        vtp_seconds: if job.vtp {
            Some([write_vtp(&driver, false)?, write_vtp(&driver, true)?])
        } else {
            None
        },
        moved_per_body: moved(plan.rotation, width, (pairs + walls) / n as f64),
        hash: format!("{:016x}", driver.result_hash()),
    })
}

/// Seconds to write a `.vtp` file.
fn write_vtp(driver: &TimeStepDriver, compressed: bool) -> Result<f64, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let provenance =
        Provenance::new(env!("CARGO_PKG_VERSION"), driver.engine().plan().fingerprint.as_str(), 0)?;
    let mut series = VtkSeries::new(&folder.path().join("bodies"), compressed, provenance);
    let begin = Instant::now();
    let view = driver.view();
    series.start(&view).and_then(|()| series.observe(&view)).map_err(|error| error.to_string())?;
    series.finish().map_err(|error| error.to_string())?;
    Ok(begin.elapsed().as_secs_f64())
}

/// Bytes that a step must move a body: rows of 32 bytes (position, velocity and force; spin and torque if they exist) are
/// read and written once, each contact's pair (8 bytes) is read, and its history (8 bytes a column and a stamp of 4) is
/// read and written.
fn moved(rotation: bool, history_width: usize, contacts_per_body: f64) -> f64 {
    let rows = if rotation { 5.0 } else { 3.0 };
    let history = if history_width > 0 { 8.0 * history_width as f64 + 4.0 } else { 0.0 };
    2.0 * 32.0 * rows + contacts_per_body * (8.0 + 2.0 * history)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_step_moves() {
        // Frictional packing with 4.4 neighbours: 320 bytes of rows, 2.2 contacts of 8 + 2 * 28 bytes.
        assert!((moved(true, 3, 2.2) - (320.0 + 2.2 * 64.0)).abs() < 1e-9);
        assert!((moved(false, 0, 3.0) - (192.0 + 24.0)).abs() < 1e-9);
    }
}
