//! A read-only view of a run at one moment.

use granule_engine::{ContactForce, ContactRecord, Engine, SubstrateTally, Tally, Work};
use granule_events::Counts;
use granule_plan::Plan;
use granule_state::Bodies;

/// Bodies and sums at one moment. Bodies are listed in the order of their identities.
pub struct View<'a> {
    plan: &'a Plan,
    step: u64,
    time: f64,
    source: Source<'a>,
    order: Vec<u32>,
}

/// Where the numbers of a view come from.
enum Source<'a> {
    Steps(&'a Engine),
    Events(Box<Snapshot>),
}

/// What hard bodies are at one moment.
pub(crate) struct Snapshot {
    pub bodies: Bodies,
    pub tally: Tally,
    pub work: Work,
    pub substrate: SubstrateTally,
    pub counts: Counts,
}

impl<'a> View<'a> {
    pub(crate) fn new(engine: &'a Engine) -> Self {
        Self {
            plan: engine.plan(),
            step: engine.step(),
            time: engine.time(),
            source: Source::Steps(engine),
            order: engine.bodies().order_by_id(),
        }
    }

    pub(crate) fn of_events(plan: &'a Plan, step: u64, time: f64, snapshot: Snapshot) -> Self {
        let order = snapshot.bodies.order_by_id();
        Self { plan, step, time, source: Source::Events(Box::new(snapshot)), order }
    }

    /// The plan that runs.
    pub fn plan(&self) -> &'a Plan {
        self.plan
    }

    /// Steps done.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Simulated time \[s\].
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Body rows in memory order; [`order`](Self::order) leads from identities to places.
    pub fn bodies(&self) -> &Bodies {
        match &self.source {
            Source::Steps(engine) => engine.bodies(),
            Source::Events(snapshot) => &snapshot.bodies,
        }
    }

    /// Places of the bodies in the order of their identities.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Sums over the contacts; hard bodies have none.
    pub fn tally(&self) -> &Tally {
        match &self.source {
            Source::Steps(engine) => engine.tally(),
            Source::Events(snapshot) => &snapshot.tally,
        }
    }

    /// Work and dissipation since the start; zero without the energy ledger.
    pub fn work(&self) -> &Work {
        match &self.source {
            Source::Steps(engine) => engine.work(),
            Source::Events(snapshot) => &snapshot.work,
        }
    }

    /// What bodies do on the substrate, and its work and dissipation since the start; zero without one.
    pub fn substrate(&self) -> &SubstrateTally {
        match &self.source {
            Source::Steps(engine) => engine.substrate(),
            Source::Events(snapshot) => &snapshot.substrate,
        }
    }

    /// True if the body at a place slips on the substrate; false without one, or in the air.
    pub fn slips(&self, place: usize) -> bool {
        self.bodies().surface.get(place).is_some_and(granule_engine::slips)
    }

    /// All contacts, ordered by identities; hard bodies have none.
    pub fn contacts(&self) -> Vec<ContactRecord> {
        match &self.source {
            Source::Steps(engine) => engine.contacts(),
            Source::Events(_) => Vec::new(),
        }
    }

    /// What each contact did in the last force evaluation, ordered by identities; only where an output of the plan shows it,
    /// and never for hard bodies.
    pub fn contact_forces(&self) -> Vec<ContactForce> {
        match &self.source {
            Source::Steps(engine) => engine.contact_forces(),
            Source::Events(_) => Vec::new(),
        }
    }

    /// Collisions since the start; `None` for the time-stepped driver.
    pub fn events(&self) -> Option<&Counts> {
        match &self.source {
            Source::Steps(_) => None,
            Source::Events(snapshot) => Some(&snapshot.counts),
        }
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
