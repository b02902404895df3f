//! Runs LAMMPS and LIGGGHTS on the cases and rewrites their recorded references.
//!
//! ```text
//! cargo run -p granule-validation --bin record-references -- --bless [CASE ...]
//! ```
//! Without cases, all of them.

use std::process::ExitCode;

use granule_validation::cases;
use granule_validation::peers::RunOptions;

fn main() -> ExitCode {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    if words.first().map(String::as_str) != Some("--bless") {
        eprintln!("records are rewritten only on purpose: record-references --bless [CASE ...]");
        return ExitCode::FAILURE;
    }
    words.remove(0);
    let cases = cases::all();
    if let Some(unknown) = words.iter().find(|word| cases.iter().all(|case| case.slug != **word)) {
        eprintln!("there is no case `{unknown}`");
        return ExitCode::FAILURE;
    }
    let folder = std::env::temp_dir().join(format!("granule-references-{}", std::process::id()));
    let mut failed = false;
    for case in cases.iter().filter(|case| words.is_empty() || words.iter().any(|word| word == case.slug)) {
        match granule_validation::bless(case, &folder, &RunOptions::default()) {
            Ok(written) => println!("{}: {} of {} rewritten", case.slug, written.len(), case.laws.len()),
            Err(error) => {
                eprintln!("{}: {error}", case.slug);
                failed = true;
            }
        }
    }
    if let Err(error) = std::fs::remove_dir_all(&folder) {
        eprintln!("{}: {error}", folder.display());
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}
