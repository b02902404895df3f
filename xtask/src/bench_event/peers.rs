//! Other event-driven programs, which continue from the same fluid.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::{number, output};
use crate::command::{Error, run};

/// Programs of EDMD: name, folder, source.
const EDMD: [(&str, &str, &str); 2] =
    [("EDMD Single", "Single", "mdSingle.c"), ("EDMD Cell", "Cell", "mdCell.c")];
/// Its input is XML, one line a sphere: more would only be a test of reading it.
const MOST_OF_DYNAMO: f64 = 2e5;

/// A program to compare with.
pub struct Peer {
    /// Name in tables.
    pub name: &'static str,
    program: PathBuf,
    is_edmd: bool,
}

impl Peer {
    /// True if the program can run such a gas.
    pub fn knows(&self, spheres: f64, restitution: f64) -> bool {
        if self.is_edmd { restitution == 1.0 } else { spheres <= MOST_OF_DYNAMO }
    }

    /// Collisions a second from the fluid in the first or second file: seconds that EDMD had the processor, those of the clock
    /// that DynamO itself reports.
    pub fn run(&self, edmd: &Path, dynamo: &Path, collisions: f64, duration: f64) -> Result<f64, Error> {
        let place = self.program.parent().unwrap_or(edmd);
        if self.is_edmd {
            // It reads its state from a fixed name beside it.
            let state = place.join("init.sph");
            std::fs::copy(edmd, &state).map_err(|error| Error::file(&state, &error))?;
            let mut command = Command::new(&self.program);
            let text = output(command.current_dir(place).env("GRANULE_DURATION", duration.to_string()))?;
            return Ok(number(&text, "RESULT ", " ")? / number(&text, "seconds ", "\n")?);
        }
        let (end, report) = (dynamo.with_extension("end.xml"), dynamo.with_extension("report.xml"));
        let mut command = Command::new(&self.program);
        command.args(["-c", &collisions.to_string()]).arg(dynamo).arg("-o").arg(&end);
        output(command.arg("--out-data-file").arg(&report))?;
        let text = std::fs::read_to_string(&report).map_err(|error| Error::file(&report, &error))?;
        number(&text, "EventsPerSec=\"", "\"")
    }
}

/// DynamO as it was built.
pub fn dynamo(programs: &Path) -> Result<Peer, Error> {
    let program = programs.join("dynarun");
    if !program.is_file() {
        return Err(Error::new(format!("{}: not there; --dynamo takes its folder", program.display())));
    }
    Ok(Peer { name: "DynamO", program, is_edmd: false })
}

/// Builds both programs of EDMD.
pub fn edmd(sources: &Path, folder: &Path) -> Result<Vec<Peer>, Error> {
    let build = |(name, part, source): (&'static str, &str, &str)| {
        let program = build_edmd(&sources.join(part), source, &folder.join(part))?;
        Ok(Peer { name, program, is_edmd: true })
    };
    EDMD.into_iter().map(build).collect()
}

/// Builds a program of EDMD that starts from a snapshot, runs for a given duration without its thermostat, and reports
/// collisions and seconds of the processor.
fn build_edmd(sources: &Path, source: &str, folder: &Path) -> Result<PathBuf, Error> {
    std::fs::create_dir_all(folder).map_err(|error| Error::file(folder, &error))?;
    for entry in std::fs::read_dir(sources).map_err(|error| Error::file(sources, &error))?.flatten() {
        let to = folder.join(entry.file_name());
        std::fs::copy(entry.path(), &to).map_err(|error| Error::file(&to, &error))?;
    }
    let file = folder.join(source);
    // Headers come before the variables.
    let header = folder.join(source.replace(".c", ".h"));
    change(&header, &[("int main();", "#include <time.h>\nclock_t granule_begin;\nint main();")])?;
    change(
        &file,
        &[
            (
                "    printf(\"Starting\\n\");",
                "    maxtime = atof(getenv(\"GRANULE_DURATION\")); granule_begin = clock();",
            ),
            (
                "    simtime = maxtime;",
                "    printf(\"RESULT %u collisions seconds %f\\n\", colcounter, (double)(clock() - granule_begin) / \
                 CLOCKS_PER_SEC);\n    simtime = maxtime;",
            ),
        ],
    )?;
    let text = std::fs::read_to_string(&file).map_err(|error| Error::file(&file, &error))?;
    // Some of its programs are like this already.
    let text = text.replace("int initialconfig = 1;", "int initialconfig = 0;");
    let text = text.replace("int usethermostat = 1;", "int usethermostat = 0;");
    std::fs::write(&file, text).map_err(|error| Error::file(&file, &error))?;
    let program = folder.join("md");
    let flags = ["-Ofast", "-funroll-loops", "-march=native", "-w", "-o"];
    run(Command::new("cc").args(flags).arg(&program).arg(&file).arg("-lm"))?;
    Ok(program)
}

/// Replaces what must be in a file exactly once.
fn change(file: &Path, changes: &[(&str, &str)]) -> Result<(), Error> {
    let mut text = std::fs::read_to_string(file).map_err(|error| Error::file(file, &error))?;
    for (from, to) in changes {
        if text.matches(from).count() != 1 {
            return Err(Error::new(format!(
                "{}: `{from}` is not there once: another version?",
                file.display()
            )));
        }
        text = text.replace(from, to);
    }
    std::fs::write(file, text).map_err(|error| Error::file(file, &error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_version_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("md.c");
        std::fs::write(&file, "const int one = 1;\n").unwrap();
        change(&file, &[("one = 1", "one = 2")]).unwrap();
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "const int one = 2;\n");
        assert!(change(&file, &[("one = 1", "one = 2")]).unwrap_err().message.contains("another version"));
        assert!(dynamo(folder.path()).is_err());
    }

    #[test]
    fn programs_get_gases_that_they_know() {
        let peer = |is_edmd| Peer { name: "", program: PathBuf::new(), is_edmd };
        assert!(peer(true).knows(1e6, 1.0) && !peer(true).knows(1e4, 0.9));
        assert!(peer(false).knows(1e5, 0.9) && !peer(false).knows(1e6, 1.0));
    }
}
