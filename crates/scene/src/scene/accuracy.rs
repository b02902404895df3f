//! An accuracy or a time that is asked for instead of a step.

use std::ops::Range;

use super::Spanned;

/// What decides on step and integrator instead of the driver block.
#[derive(Clone, Debug, PartialEq)]
pub enum AccuracyGoal {
    /// Error of the velocities after an impact, over the normal speed before it.
    Restitution {
        /// Largest error.
        error: Spanned<f64>,
    },
    /// Relative error of a quantity, as a trade has measured it.
    Observable {
        /// Name of the quantity.
        observable: Spanned<String>,
        /// Largest error.
        error: Spanned<f64>,
        /// Folder of the trade, relative to the scene.
        table: Spanned<String>,
    },
    /// Time of the clock that the run may take.
    Budget {
        /// Time \[s\].
        seconds: Spanned<f64>,
        /// Folder of a trade, relative to the scene.
        table: Option<Spanned<String>>,
    },
}

impl AccuracyGoal {
    /// The field of the scene that asks for it.
    pub fn field(&self) -> &'static str {
        match self {
            Self::Restitution { .. } | Self::Observable { .. } => "accuracy",
            Self::Budget { .. } => "budget",
        }
    }

    /// Folder of the trade that decides, if one does.
    pub fn table(&self) -> Option<&Spanned<String>> {
        match self {
            Self::Restitution { .. } => None,
            Self::Observable { table, .. } => Some(table),
            Self::Budget { table, .. } => table.as_ref(),
        }
    }
}

/// `accuracy: (..)` or `budget: (..)`.
#[derive(Clone, Debug, PartialEq)]
pub struct AccuracyBlock {
    /// What is asked for.
    pub goal: AccuracyGoal,
    /// Where the block stands.
    pub span: Range<usize>,
}
