//! One live run: inputs out, frames in.

use std::path::Path;

use super::inputs::DUMP;
use super::process::{Finished, run_script};
use super::{Engine, Frame, InputFiles, PeerError, PeerScene, RunOptions, dump, inputs};

/// What an engine answered.
#[derive(Clone, Debug)]
pub struct PeerRun {
    /// Which engine.
    pub engine: Engine,
    /// Its version, as its banner says it.
    pub version: String,
    /// The command that was run, in a folder with the inputs.
    pub command: String,
    /// Hash of the inputs.
    pub inputs: String,
    /// Seconds of the timed `run` (the engine's own `Loop time of`).
    pub loop_seconds: f64,
    /// Dumped frames, step 0 first; empty if no dump was asked for.
    pub frames: Vec<Frame>,
}

/// Writes the inputs of a scene into a folder, runs its engine there and reads the answer.
///
/// # Errors
/// Every [`PeerError`] but those of records. A run that loses a body or a frame is an error.
pub fn run(scene: &PeerScene, folder: &Path, options: &RunOptions) -> Result<PeerRun, PeerError> {
    let files = inputs(scene)?;
    let engine = files.engine;
    std::fs::create_dir_all(folder).map_err(|error| PeerError::File(folder.to_path_buf(), error))?;
    // A dump of an earlier run must not pass for this one's.
    let dump_path = folder.join(DUMP);
    if let Err(error) = std::fs::remove_file(&dump_path)
        && error.kind() != std::io::ErrorKind::NotFound
    {
        return Err(PeerError::File(dump_path, error));
    }
    files.write(folder)?;
    let Finished { command, output, .. } = run_script(engine, files.script_name, folder, options)?;
    let unexpected = |what: &str| PeerError::Output(engine, what.to_owned());
    let version = version(&output).ok_or_else(|| unexpected("no version banner"))?;
    let loop_seconds = loop_time(&output).ok_or_else(|| unexpected("no `Loop time of` line"))?;
    let mut frames = Vec::new();
    if scene.dump_every > 0 {
        let text =
            std::fs::read_to_string(&dump_path).map_err(|error| PeerError::File(dump_path.clone(), error))?;
        frames = dump::frames(&text).map_err(|what| PeerError::Output(engine, what))?;
        check_frames(scene, &frames).map_err(|what| PeerError::Output(engine, what))?;
    }
    Ok(PeerRun { engine, version, command, inputs: files.hash(), loop_seconds, frames })
}

/// What an engine left that may have been told nonsense.
#[derive(Clone, Debug, Default)]
pub struct Attempt {
    /// Dumped frames, as far as they can be read.
    pub frames: Vec<Frame>,
    /// Lines with warnings.
    pub warnings: Vec<String>,
}

/// Runs inputs that may make no sense, for forty seconds at most: nothing of the answer is checked.
///
/// # Errors
/// The engine is missing, stops with an error or does not end, or files cannot be written.
pub fn attempt(files: &InputFiles, folder: &Path) -> Result<Attempt, PeerError> {
    let file = |path: &Path, error| PeerError::File(path.to_path_buf(), error);
    // What an earlier run left must not pass for this one's.
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(|error| file(folder, error))?;
    }
    std::fs::create_dir_all(folder).map_err(|error| file(folder, error))?;
    files.write(folder)?;
    let options = RunOptions { timeout: std::time::Duration::from_secs(40), ..RunOptions::default() };
    let finished = run_script(files.engine, files.script_name, folder, &options)?;
    let warnings = finished.output.lines().filter(|line| line.contains("WARNING"));
    let warnings = warnings.map(str::to_owned).collect();
    let dump = std::fs::read_to_string(folder.join(DUMP)).unwrap_or_default();
    let frames = dump::frames(&dump).unwrap_or_default();
    Ok(Attempt { frames, warnings })
}

/// What a run for timing tells.
#[derive(Clone, Debug)]
pub struct Timed {
    /// Version of the engine, as its banner says it.
    pub version: String,
    /// Seconds of the last `run` (the engine's own `Loop time of`).
    pub loop_seconds: f64,
    /// Seconds of the processor in it, for a run of one rank, if the system tells.
    pub processor_seconds: Option<f64>,
    /// Largest resident memory, if the system tells \[bytes\]; of one rank only if there are several.
    pub peak_bytes: Option<u64>,
}

/// Runs inputs that are in a folder already; see [`InputFiles::write`].
///
/// # Errors
/// The engine is missing, fails, or does not say how long it took.
pub fn time(files: &InputFiles, folder: &Path, options: &RunOptions) -> Result<Timed, PeerError> {
    let engine = files.engine;
    let finished = run_script(engine, files.script_name, folder, options)?;
    let unexpected = |what: &str| PeerError::Output(engine, what.to_owned());
    let loop_seconds = loop_time(&finished.output).ok_or_else(|| unexpected("no `Loop time of` line"))?;
    // The loop is the last that the engine does.
    let share = if options.ranks == 1 { finished.share_of_last(loop_seconds) } else { None };
    Ok(Timed {
        version: version(&finished.output).ok_or_else(|| unexpected("no version banner"))?,
        loop_seconds,
        processor_seconds: share.map(|share| share * loop_seconds),
        peak_bytes: finished.peak_bytes,
    })
}

/// `LAMMPS (29 Sep 2021 - Update 2)` or `LIGGGHTS (Version LIGGGHTS-PUBLIC 3.8.0, ...)`: what the brackets hold.
fn version(output: &str) -> Option<String> {
    output.lines().find_map(|line| {
        let rest = line.strip_prefix("LAMMPS (").or_else(|| line.strip_prefix("LIGGGHTS ("))?;
        Some(rest.strip_suffix(')')?.to_owned())
    })
}

/// Seconds of the last `Loop time of 0.00095 on 1 procs ...`.
fn loop_time(output: &str) -> Option<f64> {
    let line = output.lines().rev().find(|line| line.starts_with("Loop time of "))?;
    line.split_whitespace().nth(3)?.parse().ok()
}

/// Every step that was asked for, every body in it, every number finite.
fn check_frames(scene: &PeerScene, frames: &[Frame]) -> Result<(), String> {
    let expected: Vec<u64> = (0..=scene.steps / scene.dump_every).map(|k| k * scene.dump_every).collect();
    let steps: Vec<u64> = frames.iter().map(|frame| frame.step).collect();
    if steps != expected {
        return Err(format!("{} dumped steps where {} were asked for", steps.len(), expected.len()));
    }
    let mut ids: Vec<u64> = scene.bodies.iter().map(|body| body.id).collect();
    ids.sort_unstable();
    for frame in frames {
        if frame.ids != ids {
            return Err(format!(
                "step {}: {} bodies where {} are expected",
                frame.step,
                frame.ids.len(),
                ids.len()
            ));
        }
        for quantity in &scene.quantities {
            let column = frame.column(*quantity);
            if column.len() != ids.len() {
                return Err(format!("step {}: {} was not dumped", frame.step, quantity.name()));
            }
            if column.iter().flatten().any(|value| !value.is_finite()) {
                return Err(format!("step {}: {} is not finite", frame.step, quantity.name()));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_banners_and_loop_times() {
        let lammps =
            "LAMMPS (29 Sep 2021 - Update 2)\nLoop time of 1 on 1 procs\nLoop time of 0.25 on 1 procs\n";
        assert_eq!(version(lammps).unwrap(), "29 Sep 2021 - Update 2");
        assert_eq!(loop_time(lammps), Some(0.25));
        let liggghts = "LIGGGHTS (Version LIGGGHTS-PUBLIC 3.8.0, compiled x by y, git commit unknown)\n";
        assert_eq!(
            version(liggghts).unwrap(),
            "Version LIGGGHTS-PUBLIC 3.8.0, compiled x by y, git commit unknown"
        );
        assert_eq!(loop_time(liggghts), None);
    }
}
