//! `cargo xtask test`: the tests of all packages.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::command::{Error, cargo, run};

/// What the user asked for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Run the tests that are ignored because they are slow, too.
    pub all: bool,
    /// Only tests whose names contain one of these.
    pub names: Vec<String>,
}

impl Options {
    /// Reads the words after `test`.
    ///
    /// # Errors
    /// An option is unknown.
    pub fn parse(words: &[String]) -> Result<Self, Error> {
        let mut options = Self::default();
        for word in words {
            match word.as_str() {
                "--all" => options.all = true,
                option if option.starts_with('-') => {
                    return Err(Error::usage(format!(
                        "test does not know `{option}`; it takes --all and parts of names"
                    )));
                }
                name => options.names.push(name.to_string()),
            }
        }
        Ok(options)
    }

    /// What is run, in words.
    fn describe(&self, runner: &str) -> String {
        let which = if self.names.is_empty() {
            "all packages".to_string()
        } else {
            format!("names with {}", self.names.join(" or "))
        };
        let slow = if self.all {
            "slow tests included"
        } else {
            "without the slow tests, which `cargo xtask test --all` adds"
        };
        format!("tests of {which} by {runner}, {slow}")
    }
}

/// Runs documentation tests, then all others: with cargo-nextest if it is installed, else with cargo's own runner.
///
/// # Errors
/// A test fails or does not build.
pub fn test(root: &Path, options: &Options) -> Result<(), Error> {
    let nextest = has_nextest();
    let runner = if nextest { "cargo nextest" } else { "cargo test" };
    let cargo = |words: &[&str]| {
        let mut command = Command::new(cargo());
        command.args(words).current_dir(root);
        command
    };
    if options.names.is_empty() {
        run(&mut cargo(&["test", "--quiet", "--workspace", "--doc"]))?;
    }
    println!("running {}", options.describe(runner));
    if nextest {
        let mut command = cargo(&["nextest", "run", "--workspace", "--no-fail-fast"]);
        if options.all {
            command.args(["--run-ignored", "all"]);
        }
        run(command.args(&options.names))?;
    } else {
        let mut command =
            cargo(&["test", "--workspace", "--no-fail-fast", "--lib", "--bins", "--tests", "--", "--quiet"]);
        if options.all {
            command.arg("--include-ignored");
        }
        run(command.args(&options.names))?;
    }
    println!("passed: {}", options.describe(runner));
    Ok(())
}

fn has_nextest() -> bool {
    let mut command = Command::new(cargo());
    command.args(["nextest", "--version"]).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_the_command_line() {
        let words = ["--all".to_string(), "hertz".to_string()];
        let options = Options::parse(&words).unwrap();
        assert_eq!(options, Options { all: true, names: vec!["hertz".to_string()] });
        assert_eq!(options.describe("x"), "tests of names with hertz by x, slow tests included");
        assert_eq!(Options::parse(&["--al".to_string()]).unwrap_err().code, 2);
    }
}
