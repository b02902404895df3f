//! Rewrites the generated pages of docs/: `cargo xtask pages`.

use std::io;
use std::path::Path;
use std::process::ExitCode;

use granule_law_api::Registry;
use granule_tests::pages;

fn main() -> ExitCode {
    let registry = match Registry::collect() {
        Ok(registry) => registry,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::FAILURE;
        }
    };
    for (path, text) in pages::pages(&registry) {
        if let Err(error) = write(&pages::docs().join(&path), &text) {
            eprintln!("error: docs/{}: {error}", path.display());
            return ExitCode::FAILURE;
        }
    }
    match pages::stale(&registry) {
        Ok(stale) => {
            for path in stale {
                println!("docs/{} belongs to no law; remove it", path.display());
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: docs/laws: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Writes a page unless it is current.
fn write(path: &Path, text: &str) -> io::Result<()> {
    if std::fs::read_to_string(path).is_ok_and(|old| old == text) {
        return Ok(());
    }
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    std::fs::write(path, text)?;
    println!("wrote {}", path.file_name().unwrap_or_default().to_string_lossy());
    Ok(())
}
