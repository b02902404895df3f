//! What is watched during a run, as a scene says it.

use super::Spanned;

/// What a guard does where its limit is passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GuardChoice {
    /// Nothing.
    Off,
    /// Says so once and goes on.
    Warn(f64),
    /// Ends the run.
    Stop(f64),
}

/// `guards: (..)`; what is absent has its default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GuardsBlock {
    /// Overlap over the smaller radius.
    pub overlap: Option<Spanned<GuardChoice>>,
    /// Motion in one step over the smallest radius.
    pub travel: Option<Spanned<GuardChoice>>,
    /// Bodies outside of the cell where it is not periodic, by so many radii.
    pub lost: Option<Spanned<GuardChoice>>,
    /// Residual of the energy ledger over the energy turned over.
    pub energy: Option<Spanned<GuardChoice>>,
}
