//! Finding and running an executable, with a time limit.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::{Engine, PeerError};

/// How to run an engine.
#[derive(Clone, Copy, Debug)]
pub struct RunOptions {
    /// MPI ranks; 1 runs without `mpirun`. Dumps of different rank counts differ in the last bits.
    pub ranks: usize,
    /// After this time the run is killed.
    pub timeout: Duration,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self { ranks: 1, timeout: Duration::from_secs(120) }
    }
}

/// What a finished process left.
pub struct Finished {
    /// The command, as one would type it.
    pub command: String,
    /// Its standard output.
    pub output: String,
    /// Largest resident memory of the process that was started (not of its children), if the system tells \[bytes\].
    pub peak_bytes: Option<u64>,
    /// Seconds since the start, and seconds of the processor that its first thread had got by then, every few hundredths.
    pub processor: Vec<[f64; 2]>,
    /// Seconds from the start to the end.
    pub seconds: f64,
}

impl Finished {
    /// Share of a processor that the first thread had over the last `seconds` of the run; `None` if that is not known.
    pub fn share_of_last(&self, seconds: f64) -> Option<f64> {
        let last = self.processor.last()?;
        let begin = self.seconds - seconds;
        let first = self.processor.iter().rev().find(|[time, _]| *time <= begin)?;
        (last[0] > first[0]).then(|| (last[1] - first[1]) / (last[0] - first[0]))
    }
}

/// Seconds of the processor that the first thread of a process has got; `process` as in `/proc`. Unlike the time of the clock
/// it does not count when other programs had the processor. `None` where there is no `/proc`.
pub fn processor_seconds(process: &str) -> Option<f64> {
    let text = std::fs::read_to_string(format!("/proc/{process}/schedstat")).ok()?;
    Some(text.split_whitespace().next()?.parse::<u64>().ok()? as f64 * 1e-9)
}

/// Largest resident memory of a process until now \[bytes\]; `process` as in `/proc`. `None` where there is no `/proc`.
pub fn peak_resident(process: &str) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// The engine's executable, if it is in `PATH`.
pub fn find_binary(engine: Engine) -> Option<PathBuf> {
    in_path(engine.binary())
}

fn in_path(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).map(|folder| folder.join(name)).find(|candidate| candidate.is_file())
}

/// Last lines of a text, for error messages.
pub fn last_lines(text: &str) -> String {
    const LINES: usize = 15;
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    lines[lines.len().saturating_sub(LINES)..].join("\n")
}

/// Arguments of the engine for a script, as typed; also recorded with references.
pub fn command_line(engine: Engine, script: &str, ranks: usize) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    if ranks > 1 {
        words.extend(["mpirun", "-np", &ranks.to_string(), "--bind-to", "none"].map(str::to_owned));
    }
    words.extend([engine.binary(), "-in", script, "-log", "none"].map(str::to_owned));
    words
}

/// Runs the engine on a script in a folder and waits. Output goes through files, so that a full pipe cannot stop it.
pub fn run_script(
    engine: Engine,
    script: &str,
    folder: &Path,
    options: &RunOptions,
) -> Result<Finished, PeerError> {
    if find_binary(engine).is_none() {
        return Err(PeerError::NotInstalled(engine));
    }
    let words = command_line(engine, script, options.ranks);
    let stdout_path = folder.join("stdout.txt");
    let stderr_path = folder.join("stderr.txt");
    let create =
        |path: &PathBuf| std::fs::File::create(path).map_err(|error| PeerError::File(path.clone(), error));
    let mut command = Command::new(&words[0]);
    if options.ranks == 1 {
        // Without other ranks Open MPI need not look for networks: that is most of the time of a small run.
        command.env("OMPI_MCA_pml", "ob1").env("OMPI_MCA_btl", "self");
    }
    let mut child = command
        .args(&words[1..])
        .current_dir(folder)
        .env("OMP_NUM_THREADS", "1")
        // Containers run as root, which Open MPI refuses unless told twice.
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .stdin(Stdio::null())
        .stdout(create(&stdout_path)?)
        .stderr(create(&stderr_path)?)
        .spawn()
        .map_err(|error| PeerError::File(PathBuf::from(&words[0]), error))?;
    let read = |path: &PathBuf| match std::fs::read(path) {
        Ok(bytes) => Ok(String::from_utf8_lossy(&bytes).into_owned()),
        Err(error) => Err(PeerError::File(path.clone(), error)),
    };
    let started = Instant::now();
    let process = child.id().to_string();
    let mut peak_bytes = None;
    let mut processor = Vec::new();
    let status = loop {
        // The value only grows, and after the end there is nothing to read.
        peak_bytes = peak_resident(&process).or(peak_bytes);
        processor
            .extend(processor_seconds(&process).map(|seconds| [started.elapsed().as_secs_f64(), seconds]));
        match child.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) if started.elapsed() > options.timeout => {
                // It may have ended in between; then there is nothing to kill and the verdict stays.
                let _already_gone = child.kill();
                let _reaped = child.wait();
                let tail = last_lines(&(read(&stdout_path)? + &read(&stderr_path)?));
                return Err(PeerError::Timeout(engine, options.timeout, tail));
            }
            // Seldom for a long run, so that nobody takes a core from it.
            Ok(None) => std::thread::sleep(
                (started.elapsed() / 50).max(Duration::from_millis(2)).min(Duration::from_millis(50)),
            ),
            Err(error) => return Err(PeerError::File(PathBuf::from(&words[0]), error)),
        }
    };
    let ended = started.elapsed().as_secs_f64();
    let output = read(&stdout_path)?;
    // Both engines print `ERROR` and some builds still end with code 0.
    if !status.success() || output.lines().any(|line| line.starts_with("ERROR")) {
        let tail = engine_lines(&output, &read(&stderr_path)?);
        return Err(PeerError::Failed(engine, status.code(), tail));
    }
    Ok(Finished { command: words.join(" "), output, peak_bytes, processor, seconds: ended })
}

/// The engine's own words first; what MPI adds to an abort only if there are none.
fn engine_lines(output: &str, stderr: &str) -> String {
    let own = last_lines(output);
    if own.is_empty() { last_lines(stderr) } else { own }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_that_of_the_end() {
        let finished = Finished {
            command: String::new(),
            output: String::new(),
            peak_bytes: None,
            // Two seconds of preparation with the whole processor, then four with half of it.
            processor: vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [4.0, 3.0], [6.0, 4.0]],
            seconds: 6.0,
        };
        assert_eq!(finished.share_of_last(4.0), Some(0.5));
        assert_eq!(finished.share_of_last(7.0), None);
    }

    #[test]
    fn this_thread_has_used_the_processor() {
        if let Some(before) = processor_seconds("self") {
            assert!(before >= 0.0);
        }
    }
}
