//! When the state of a run is kept, as a scene says it.

use super::{EveryChoice, Spanned};

/// `checkpoint: (..)` or `checkpoint: Never`.
#[derive(Clone, Debug, PartialEq)]
pub enum CheckpointChoice {
    /// Nothing is kept.
    Never,
    /// At intervals.
    Kept {
        /// Interval in simulated time.
        every: Option<Spanned<EveryChoice>>,
        /// Interval on the clock \[s\].
        wall: Option<f64>,
        /// How many checkpoints are kept.
        keep: u32,
    },
}
