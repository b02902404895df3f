//! The engines' equations once more: plain, slow, one contact at a time, every convention a switch.
//!
//! With [`ConventionSet::of`] it follows the running engine to round-off; with one switch turned it shows how much of a
//! difference that convention makes.

mod coefficients;
mod contact;
mod conventions;
mod march;

pub use conventions::{Arm, ContactEnd, ConventionSet, CoulombCap, CoulombTest, HistoryOrder, Velocity};
pub use march::{march, march_with};

use super::compare::{CompareError, Comparison, Scales, compare};
use super::{Frame, PeerError, PeerScene, Quantity};

/// How much one convention moves a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    /// Name of the convention.
    pub convention: &'static str,
    /// Its setting in the reference run and in the other, in words.
    pub settings: (String, String),
    /// Difference from the reference run when this convention alone is turned.
    pub comparison: Comparison,
}

/// Why causes cannot be told.
#[derive(Debug)]
pub enum CauseError {
    /// The oracle cannot run the scene.
    Scene(PeerError),
    /// Its runs cannot be compared (nothing was to be dumped).
    Compare(CompareError),
}

impl std::fmt::Display for CauseError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Scene(error) => error.fmt(f),
            Self::Compare(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for CauseError {}

/// Turns, one at a time, each convention in which `other` differs from the engine's own, and compares with the engine's
/// own run. The last entry, `all together`, turns them all.
///
/// # Errors
/// [`CauseError`].
pub fn causes(scene: &PeerScene, other: &ConventionSet) -> Result<Vec<Cause>, CauseError> {
    let reference = march(scene).map_err(CauseError::Scene)?;
    let scales = Scales::of(scene, &reference);
    let against = |frames: &[Frame]| {
        compare(scene, &reference, frames, &scales, &Quantity::ALL).map_err(CauseError::Compare)
    };
    let mut causes = Vec::new();
    for switch in conventions::SWITCHES {
        let mut settings = None;
        for law in scene.laws.values() {
            let own = ConventionSet::of(law);
            let (from, to) = ((switch.show)(&own), (switch.show)(other));
            if from != to {
                settings = Some((from, to));
            }
        }
        if let Some(settings) = settings {
            let frames = march_with(scene, &|law| {
                let mut set = ConventionSet::of(law);
                (switch.turn)(&mut set, other);
                set
            })
            .map_err(CauseError::Scene)?;
            causes.push(Cause { convention: switch.name, settings, comparison: against(&frames)? });
        }
    }
    let frames = march_with(scene, &|_| *other).map_err(CauseError::Scene)?;
    causes.push(Cause {
        convention: "all together",
        settings: (String::new(), String::new()),
        comparison: against(&frames)?,
    });
    Ok(causes)
}

#[cfg(test)]
mod tests;
