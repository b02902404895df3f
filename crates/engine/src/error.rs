//! Why a run stops.

use crate::guards::Alarm;

/// A run that cannot go on.
#[derive(Clone, Debug, PartialEq)]
pub enum EngineError {
    /// A position, velocity, spin or force is not finite.
    NotFinite {
        /// The body.
        id: u32,
        /// What is not finite.
        quantity: &'static str,
        /// Step at which it was found.
        step: u64,
        /// Simulated time \[s\].
        time: f64,
    },
    /// A law panicked: a fault of the law, whatever the scene holds.
    LawPanicked {
        /// Its name in scenes.
        law: &'static str,
        /// What it said.
        message: String,
        /// Bodies among which those are that it was asked about: both of a collision, or those of a neighbourhood.
        among: Vec<u32>,
        /// Step in which it happened.
        step: u64,
        /// Simulated time \[s\].
        time: f64,
    },
    /// A law made a number that is not finite of numbers that are: a fault of the law, or a step far too large for it.
    LawNotFinite {
        /// Its name in scenes.
        law: &'static str,
        /// What is not finite.
        quantity: &'static str,
        /// Both bodies, or body and wall.
        between: String,
        /// What the law was given, in words.
        contact: String,
        /// Step in which it happened.
        step: u64,
        /// Simulated time \[s\].
        time: f64,
    },
    /// A limit was passed at which the run ends.
    Guard(Alarm),
    /// The periodic cell is too small for one image per pair, or candidates cannot be found.
    Search(String),
    /// What the event-driven engine says at the start.
    Events(String),
    /// Hard bodies cannot go on: events follow each other without end, or speeds grow beyond all numbers.
    Crushed {
        /// A body that takes part.
        id: u32,
        /// What happened, and when.
        reason: String,
    },
    /// A saved state does not fit the plan; the part that does not.
    Saved(&'static str),
    /// Worker threads could not be started.
    Threads(String),
}

impl std::fmt::Display for EngineError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFinite { id, quantity, step, time } => write!(
                f,
                "the {quantity} of body {id} is not finite at step {step} (time {time:e} s): the time step is too \
                 large for the forces on it, or its input was not finite"
            ),
            Self::LawPanicked { law, message, step, time, .. } => write!(
                f,
                "the law {law} panicked at step {step} (time {time:e} s): {message}; this is a fault of the law, to be \
                 reported to its author"
            ),
            Self::LawNotFinite { law, quantity, between, contact, step, time } => write!(
                f,
                "the law {law} gave a {quantity} that is not finite between {between} at step {step} (time {time:e} s): {contact}; \
                 this is a fault of the law, to be reported to its author, unless these numbers are absurd because the step is too \
                 large"
            ),
            Self::Guard(alarm) => alarm.fmt(f),
            Self::Search(reason) => write!(f, "candidates cannot be found: {reason}"),
            Self::Events(reason) | Self::Crushed { reason, .. } => f.write_str(reason),
            Self::Saved(what) => {
                write!(f, "the saved state does not fit the scene, or is damaged: {what}")
            }
            Self::Threads(reason) => write!(f, "worker threads cannot be started: {reason}"),
        }
    }
}

impl std::error::Error for EngineError {}
