//! What can go wrong with a peer.

use std::path::PathBuf;
use std::time::Duration;

use super::Engine;

/// Failure to describe, run, read or recall a peer.
#[derive(Debug)]
pub enum PeerError {
    /// The scene makes no sense to any engine.
    Scene(String),
    /// The scene is sound, but this engine cannot do it.
    Unsupported(Engine, String),
    /// The executable is not on this machine.
    NotInstalled(Engine),
    /// A file could not be read or written.
    File(PathBuf, std::io::Error),
    /// The engine did not end in time; its last lines.
    Timeout(Engine, Duration, String),
    /// The engine ended with an error; its last lines.
    Failed(Engine, Option<i32>, String),
    /// The engine ended well, but its output is not what was asked for.
    Output(Engine, String),
    /// A recorded reference cannot be read.
    Record(PathBuf, String),
    /// A recorded reference belongs to other inputs than would be written today.
    Stale {
        /// The record.
        path: PathBuf,
        /// Hash of the inputs it was made with.
        recorded: String,
        /// Hash of the inputs of today.
        today: String,
    },
}

impl std::fmt::Display for PeerError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Scene(what) => write!(f, "the scene for the engines is wrong: {what}"),
            Self::Unsupported(engine, what) => write!(f, "{} cannot do this: {what}", engine.name()),
            Self::NotInstalled(engine) => {
                write!(f, "{} is not installed (no `{}` in PATH)", engine.name(), engine.binary())
            }
            Self::File(path, error) => write!(f, "{}: {error}", path.display()),
            Self::Timeout(engine, limit, tail) => {
                write!(
                    f,
                    "{} did not end within {} s; its last lines:\n{tail}",
                    engine.name(),
                    limit.as_secs_f64()
                )
            }
            Self::Failed(engine, Some(code), tail) => {
                write!(f, "{} ended with code {code}; its last lines:\n{tail}", engine.name())
            }
            Self::Failed(engine, None, tail) => {
                write!(f, "{} was killed by a signal; its last lines:\n{tail}", engine.name())
            }
            Self::Output(engine, what) => write!(f, "unexpected output of {}: {what}", engine.name()),
            Self::Record(path, what) => write!(f, "recorded reference {}: {what}", path.display()),
            Self::Stale { path, recorded, today } => write!(
                f,
                "recorded reference {} is stale: it was made with inputs {recorded}, today's are {today}; record it again",
                path.display()
            ),
        }
    }
}

impl std::error::Error for PeerError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::File(_, error) => Some(error),
            _ => None,
        }
    }
}
