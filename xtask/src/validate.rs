//! `cargo xtask validate`: our scenes against LAMMPS and LIGGGHTS.

use std::path::Path;
use std::process::Command;

use crate::command::{Error, cargo, in_path, run};

/// The engines: name, program, Debian package.
const ENGINES: [(&str, &str, &str); 2] = [("LAMMPS", "lmp", "lammps"), ("LIGGGHTS", "liggghts", "liggghts")];

/// What the user asked for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Install the engines first.
    pub install: bool,
    /// Fail unless every engine is there.
    pub live: bool,
    /// Rewrite the recorded references.
    pub record: bool,
    /// Only the cases of these names.
    pub cases: Vec<String>,
}

impl Options {
    /// Reads the words after `validate`.
    ///
    /// # Errors
    /// A word is unknown, or `--case` has no name.
    pub fn parse(words: &[String]) -> Result<Self, Error> {
        let mut options = Self::default();
        let mut words = words.iter();
        while let Some(word) = words.next() {
            match word.as_str() {
                "--install" => options.install = true,
                "--live" => options.live = true,
                "--record" => options.record = true,
                "--case" => {
                    let name = words.next().filter(|name| !name.starts_with('-'));
                    let name = name.ok_or_else(|| Error::usage("--case needs the name of a case"))?;
                    options.cases.push(name.clone());
                }
                other => {
                    return Err(Error::usage(format!(
                        "validate does not know `{other}`; it takes --install, --live, --record and --case NAME"
                    )));
                }
            }
        }
        Ok(options)
    }
}

/// Runs the extremes, ours and in the engines; `words` are options of the validation program.
///
/// # Errors
/// An option is unknown, a file cannot be written, or one of ours is wrong; the exit code is that of the program.
pub fn extremes(root: &Path, words: &[String]) -> Result<(), Error> {
    let mut command = Command::new(cargo());
    command.args([
        "run",
        "--quiet",
        "--release",
        "--package",
        "granule-validation",
        "--bin",
        "granule-validation",
    ]);
    run(command.args(["--", "extremes"]).args(words).current_dir(root))
}

/// Builds the validation program in release and runs it. Its report is in `target/validate`.
///
/// # Errors
/// An engine cannot be installed or is missing though asked for, or a case fails; the exit code is that of the program.
pub fn validate(root: &Path, options: &Options) -> Result<(), Error> {
    if options.install {
        install()?;
    }
    announce(options.live)?;
    let mut command = Command::new(cargo());
    command.args([
        "run",
        "--quiet",
        "--release",
        "--package",
        "granule-validation",
        "--bin",
        "granule-validation",
    ]);
    command.args(["--", "validate", "--out", "target/validate"]).current_dir(root);
    for case in &options.cases {
        command.args(["--case", case]);
    }
    if options.record {
        command.arg("--record");
    }
    run(&mut command)
}

/// Says which engines answer live, and which through their recorded references.
fn announce(live: bool) -> Result<(), Error> {
    let mut missing = Vec::new();
    for (engine, program, _) in ENGINES {
        match in_path(program) {
            Some(path) => println!("{engine}: LIVE, {}", path.display()),
            None => {
                println!("{engine}: RECORDED references only, because `{program}` is not in PATH");
                missing.push(engine);
            }
        }
    }
    match (missing.as_slice(), live) {
        ([], _) => Ok(()),
        (_, false) => {
            println!(
                "`cargo xtask validate --install` installs what is missing (Debian and its relatives, as root)"
            );
            Ok(())
        }
        (missing, true) => Err(Error::new(format!("--live: not installed: {}", missing.join(", ")))),
    }
}

fn install() -> Result<(), Error> {
    if ENGINES.iter().all(|(_, program, _)| in_path(program).is_some()) {
        println!("both engines are installed already");
        return Ok(());
    }
    if in_path("apt-get").is_none() {
        return Err(Error::new(
            "--install: there is no apt-get here; install LAMMPS (`lmp`) and LIGGGHTS (`liggghts`) so that they are in PATH",
        ));
    }
    let packages: Vec<&str> = ENGINES.iter().map(|(_, _, package)| *package).collect();
    if !is_root() {
        return Err(Error::new(format!(
            "--install: installing packages takes root; run `sudo apt-get update && sudo apt-get install -y {}`, then \
             `cargo xtask validate`",
            packages.join(" ")
        )));
    }
    let apt = || {
        let mut command = Command::new("apt-get");
        command.env("DEBIAN_FRONTEND", "noninteractive");
        command
    };
    run(apt().arg("update"))?;
    run(apt().args(["install", "-y", "--no-install-recommends"]).args(packages))
}

fn is_root() -> bool {
    let output = Command::new("id").arg("-u").output();
    output.is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<Options, Error> {
        Options::parse(&line.split_whitespace().map(str::to_string).collect::<Vec<_>>())
    }

    #[test]
    fn reads_the_command_line() {
        let options = parse("--install --case head-on --record --case pile").unwrap();
        assert!(options.install && options.record && !options.live);
        assert_eq!(options.cases, ["head-on", "pile"]);
        assert_eq!(parse("").unwrap(), Options::default());
        for (line, word) in [("--case", "--case needs"), ("--case --record", "--case needs"), ("-x", "`-x`")]
        {
            let error = parse(line).unwrap_err();
            assert!(error.message.contains(word) && error.code == 2, "{line}: {error}");
        }
    }
}
