//! The energy ledger as observers see it.

use granule_drivers::View;
use serde::{Deserialize, Serialize};

use crate::quantities;

/// Energies at one moment, and what was dissipated and supplied until then.
///
/// Elastic energy, dissipation and work of walls are zero unless the plan has the energy ledger.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Energy {
    /// Kinetic energy of translation \[J\].
    pub kinetic: f64,
    /// Kinetic energy of rotation \[J\].
    pub rotational: f64,
    /// Potential energy in the field of gravity \[J\].
    pub gravity: f64,
    /// Energy stored in contacts \[J\].
    pub elastic: f64,
    /// Dissipated by damping and in landings on a substrate since the start \[J\].
    pub dissipated_viscous: f64,
    /// Dissipated by sliding since the start, on a substrate by rolling, too \[J\].
    pub dissipated_friction: f64,
    /// Work done by moving walls and a moving substrate on the bodies since the start \[J\].
    pub wall_work: f64,
}

impl Energy {
    /// The energies of a view.
    pub fn of(view: &View<'_>) -> Self {
        let work = view.work();
        let substrate = view.substrate().work;
        let rubbed = substrate.sliding + substrate.rolling + substrate.drilling;
        Self {
            kinetic: quantities::kinetic_energy(view),
            rotational: quantities::rotational_energy(view),
            gravity: quantities::gravity_energy(view),
            elastic: quantities::elastic_energy(view),
            dissipated_viscous: work.viscous.iter().sum::<f64>() + substrate.impact,
            dissipated_friction: work.friction.iter().sum::<f64>() + rubbed,
            wall_work: work.walls + substrate.plate,
        }
    }

    /// Kinetic, rotational, gravity and elastic energy together \[J\].
    pub fn mechanical(&self) -> f64 {
        self.kinetic + self.rotational + self.gravity + self.elastic
    }

    /// What the ledger does not account for since `start` \[J\]: change of the mechanical energy, plus what was
    /// dissipated, less the work of walls. It is the error of the time integration and vanishes with the time step.
    pub fn residual_since(&self, start: &Self) -> f64 {
        let dissipated = (self.dissipated_viscous - start.dissipated_viscous)
            + (self.dissipated_friction - start.dissipated_friction);
        (self.mechanical() - start.mechanical()) + dissipated - (self.wall_work - start.wall_work)
    }
}
