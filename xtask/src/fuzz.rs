//! `cargo xtask fuzz`: hostile inputs in numbers.

use std::path::Path;
use std::process::Command;

use crate::command::{Error, cargo, run};

/// Inputs of each target unless the user says otherwise.
const INPUTS: u64 = 1_000_000;

/// What the user asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Options {
    /// The only target; all of them if absent.
    pub target: Option<String>,
    /// Inputs of each target.
    pub inputs: u64,
}

impl Options {
    /// Reads the words after `fuzz`.
    ///
    /// # Errors
    /// An option is unknown, or the number of inputs is none.
    pub fn parse(words: &[String]) -> Result<Self, Error> {
        let mut options = Self { target: None, inputs: INPUTS };
        let mut words = words.iter();
        while let Some(word) = words.next() {
            match word.as_str() {
                "--inputs" => {
                    let number = words.next().and_then(|text| text.parse().ok()).filter(|inputs| *inputs > 0);
                    options.inputs =
                        number.ok_or_else(|| Error::usage("--inputs takes a number above 0".to_string()))?;
                }
                option if option.starts_with('-') => {
                    return Err(Error::usage(format!("fuzz does not know `{option}`; it takes --inputs N")));
                }
                name if options.target.is_none() => options.target = Some(name.to_string()),
                other => return Err(Error::usage(format!("fuzz takes one target, but got `{other}`, too"))),
            }
        }
        Ok(options)
    }
}

/// Feeds random inputs to the fuzz targets of `tests/tests/fuzz.rs` and prints how many, the slowest, and the one that held
/// most memory.
///
/// # Errors
/// An input makes a target panic, hang, or hold too much memory; its bytes are printed.
pub fn fuzz(root: &Path, options: &Options) -> Result<(), Error> {
    let mut command = Command::new(cargo());
    command.args(["test", "--quiet", "--package", "granule-tests", "--test", "fuzz", "--"]);
    if let Some(target) = &options.target {
        command.args(["--exact", target]);
    }
    command.args(["--nocapture", "--test-threads", "1"]);
    run(command.env("GRANULE_FUZZ_INPUTS", options.inputs.to_string()).current_dir(root))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_the_command_line() {
        let parse = |words: &[&str]| Options::parse(&words.iter().map(|w| w.to_string()).collect::<Vec<_>>());
        assert_eq!(parse(&[]).unwrap(), Options { target: None, inputs: 1_000_000 });
        let one = Options { target: Some("dump".to_string()), inputs: 10 };
        assert_eq!(parse(&["dump", "--inputs", "10"]).unwrap(), one);
        for words in [&["--inputs"][..], &["--inputs", "0"], &["--input", "5"], &["dump", "walls"]] {
            assert_eq!(parse(words).unwrap_err().code, 2, "{words:?}");
        }
    }
}
