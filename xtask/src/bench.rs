//! `cargo xtask bench`: speed, ours and the peers'.

use std::path::Path;
use std::process::Command;

use crate::bench_event::bench_event;
use crate::command::{Error, cargo, run};

/// Builds the validation program in release and runs its benchmarks; `words` are options of that program. Results are
/// in `target/bench`.
///
/// # Errors
/// An option is unknown, or a benchmark fails; the exit code is that of the program.
pub fn bench(root: &Path, words: &[String]) -> Result<(), Error> {
    let mut command = Command::new(cargo());
    if let [first, rest @ ..] = words
        && first == "event"
    {
        return bench_event(root, rest);
    }
    command.args([
        "run",
        "--quiet",
        "--release",
        "--package",
        "granule-validation",
        "--bin",
        "granule-validation",
    ]);
    run(command.args(["--", "bench", "--out", "target/bench"]).args(words).current_dir(root))
}
