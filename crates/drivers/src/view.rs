//! A read-only view of a run at one moment.

use granule_engine::{ContactRecord, Engine, SubstrateTally, Tally, Work};
use granule_plan::Plan;
use granule_state::Bodies;

/// Bodies and sums at one moment. Bodies are listed in the order of their identities.
pub struct View<'a> {
    engine: &'a Engine,
    order: Vec<u32>,
}

impl<'a> View<'a> {
    pub(crate) fn new(engine: &'a Engine) -> Self {
        Self { engine, order: engine.bodies().order_by_id() }
    }

    /// The plan that runs.
    pub fn plan(&self) -> &'a Plan {
        self.engine.plan()
    }

    /// Steps done.
    pub fn step(&self) -> u64 {
        self.engine.step()
    }

    /// Simulated time \[s\].
    pub fn time(&self) -> f64 {
        self.engine.time()
    }

    /// Body rows in memory order; [`order`](Self::order) leads from identities to places.
    pub fn bodies(&self) -> &'a Bodies {
        self.engine.bodies()
    }

    /// Places of the bodies in the order of their identities.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Sums over the contacts.
    pub fn tally(&self) -> &'a Tally {
        self.engine.tally()
    }

    /// Work and dissipation since the start; zero without the energy ledger.
    pub fn work(&self) -> &'a Work {
        self.engine.work()
    }

    /// What bodies do on the substrate, and its work and dissipation since the start; zero without one.
    pub fn substrate(&self) -> &'a SubstrateTally {
        self.engine.substrate()
    }

    /// All contacts, ordered by identities.
    pub fn contacts(&self) -> Vec<ContactRecord> {
        self.engine.contacts()
    }

    /// Centre of a body inside the cell, by its rank in the order of identities \[m\].
    pub fn position(&self, rank: usize) -> [f64; 3] {
        let place = self.order[rank] as usize;
        self.plan().cell.wrap(self.bodies().position[place].vector()).0
    }

    /// FNV-1a hash over the bits of positions, velocities and spins.
    pub(crate) fn hash(&self) -> u64 {
        let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
        let mut mix = |vector: [f64; 3]| {
            for component in vector {
                for byte in component.to_bits().to_le_bytes() {
                    hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
                }
            }
        };
        for rank in 0..self.order.len() {
            let place = self.order[rank] as usize;
            mix(self.position(rank));
            mix(self.bodies().velocity_of(place));
            mix(self.bodies().spin_of(place));
        }
        hash
    }
}
