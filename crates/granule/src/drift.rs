//! How well the energy ledger of a run closes.

use granule_observers::Energy;

/// How well the energy ledger closes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyDrift {
    /// What the ledger does not account for \[J\].
    pub residual: f64,
    /// The largest energy that the residual can be held against \[J\]: kinetic and elastic energy at the start and the
    /// end, and what was dissipated, supplied by walls, or taken from gravity in between.
    pub scale: f64,
}

impl EnergyDrift {
    pub(crate) fn between(start: &Energy, end: &Energy) -> Self {
        let contained = |energy: &Energy| energy.kinetic + energy.rotational + energy.elastic;
        let dissipated = end.dissipated_viscous + end.dissipated_friction;
        let exchanged = [dissipated, end.wall_work, end.gravity - start.gravity];
        let scale = exchanged.into_iter().map(f64::abs).fold(contained(start).max(contained(end)), f64::max);
        Self { residual: end.residual_since(start), scale }
    }

    /// Residual over scale; zero if nothing has energy.
    pub fn relative(&self) -> f64 {
        if self.scale > 0.0 { self.residual / self.scale } else { 0.0 }
    }
}
