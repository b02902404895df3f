//! Running other programs, and what can go wrong.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Why a task did not succeed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// What went wrong and what to do.
    pub message: String,
    /// Exit code of the whole task.
    pub code: u8,
}

impl Error {
    /// An error with exit code 1.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), code: 1 }
    }

    /// An error about a file.
    pub fn file(path: &Path, error: &std::io::Error) -> Self {
        Self::new(format!("{}: {error}", path.display()))
    }

    /// Words on the command line that the task does not know; exit code 2.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { message: message.into(), code: 2 }
    }
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.message)
    }
}

impl std::error::Error for Error {}

/// The cargo that runs this task, so that a chosen toolchain stays chosen.
pub fn cargo() -> OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// Prints a command, runs it with its output passed through, and waits.
///
/// # Errors
/// The program cannot be run, or ends with another exit code than 0; its code is passed on.
pub fn run(command: &mut Command) -> Result<(), Error> {
    let shown = show(command);
    println!("$ {shown}");
    let status = command.status().map_err(|error| {
        Error::new(format!("cannot run `{}`: {error}", command.get_program().to_string_lossy()))
    })?;
    if status.success() {
        return Ok(());
    }
    let code = status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1).max(1);
    let how =
        status.code().map_or_else(|| "was killed".to_string(), |code| format!("ended with exit code {code}"));
    Err(Error { message: format!("`{shown}` {how}"), code })
}

/// A command as one would type it, without the path of the program.
fn show(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or_default();
    let environment = command.get_envs().filter_map(|(name, value)| {
        value.map(|value| format!("{}={}", name.to_string_lossy(), quoted(value)))
    });
    environment
        .chain(std::iter::once(quoted(program)))
        .chain(command.get_args().map(quoted))
        .collect::<Vec<_>>()
        .join(" ")
}

fn quoted(word: &OsStr) -> String {
    let word = word.to_string_lossy();
    if word.is_empty() || word.contains(char::is_whitespace) {
        format!("'{word}'")
    } else {
        word.into_owned()
    }
}

/// The program of that name in `PATH`, if there is one.
pub fn in_path(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).map(|folder| folder.join(name)).find(|candidate| candidate.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shows_what_one_would_type() {
        let mut command = Command::new("/a/b/cargo");
        command.args(["test", "two words"]).env("X", "y");
        assert_eq!(show(&command), "X=y cargo test 'two words'");
    }

    #[test]
    fn passes_exit_codes_on() {
        let error = run(Command::new("sh").args(["-c", "exit 7"])).unwrap_err();
        assert_eq!(error.code, 7);
        assert!(error.message.contains("exit code 7"));
        assert!(
            run(&mut Command::new("no-such-program-anywhere")).unwrap_err().message.contains("cannot run")
        );
    }

    #[test]
    fn looks_for_programs_in_the_path() {
        assert_eq!(in_path("no-such-program-anywhere"), None);
    }
}
