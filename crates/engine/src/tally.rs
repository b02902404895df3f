//! Sums over contacts, in a fixed order.

use granule_law_api::Slot;
use serde::{Deserialize, Serialize};

use crate::resolve::Losses;

/// Sums over all contacts of one force evaluation. Partial sums of tiles are added in the order of the tiles.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Body-body contacts.
    pub contacts: u64,
    /// Body-wall contacts.
    pub wall_contacts: u64,
    /// Largest overlap \[m\].
    pub maximum_overlap: f64,
    /// Largest overlap over the radius of the smaller body.
    pub relative_overlap: f64,
    /// Elastic energy \[J\] by slot; zero without the energy ledger.
    pub elastic: [f64; Slot::ALL.len()],
    /// Viscous (or plastic) dissipation \[W\] by slot; zero without the energy ledger.
    pub viscous: [f64; Slot::ALL.len()],
    /// Frictional dissipation \[W\] by slot; zero without the energy ledger.
    pub friction: [f64; Slot::ALL.len()],
    /// Energy lost by sliding within the step that ends now \[J\] by slot; zero without the energy ledger.
    pub slipped: [f64; Slot::ALL.len()],
    /// What contacts that begin or end within the step lose beyond the trapezoidal rule.
    pub lacking: Losses,
    /// Power that moving walls exert on the bodies \[W\].
    pub wall_power: f64,
    /// Force of the bodies on each wall \[N\].
    pub wall_force: Vec<[f64; 3]>,
}

impl Tally {
    pub(crate) fn new(walls: usize) -> Self {
        Self { wall_force: vec![[0.0; 3]; walls], ..Self::default() }
    }

    pub(crate) fn reset(&mut self) {
        let mut wall_force = std::mem::take(&mut self.wall_force);
        wall_force.fill([0.0; 3]);
        *self = Self { wall_force, ..Self::default() };
    }

    pub(crate) fn powers(&self) -> Powers {
        Powers {
            viscous: self.viscous,
            friction: self.friction,
            slipped: self.slipped,
            lacking: self.lacking,
            walls: self.wall_power,
        }
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.contacts += other.contacts;
        self.wall_contacts += other.wall_contacts;
        self.maximum_overlap = self.maximum_overlap.max(other.maximum_overlap);
        self.relative_overlap = self.relative_overlap.max(other.relative_overlap);
        self.add_energies(other, 1.0);
        for slot in 0..Slot::ALL.len() {
            self.lacking.viscous[slot] += other.lacking.viscous[slot];
            self.lacking.friction[slot] += other.lacking.friction[slot];
        }
        self.wall_power += other.wall_power;
        for (sum, part) in self.wall_force.iter_mut().zip(&other.wall_force) {
            for k in 0..3 {
                sum[k] += part[k];
            }
        }
    }
}

impl Tally {
    /// Adds energies and powers of contacts, times a sign.
    pub(crate) fn add_energies(&mut self, other: &Self, sign: f64) {
        for slot in 0..Slot::ALL.len() {
            self.elastic[slot] += sign * other.elastic[slot];
            self.viscous[slot] += sign * other.viscous[slot];
            self.friction[slot] += sign * other.friction[slot];
            self.slipped[slot] += sign * other.slipped[slot];
        }
    }
}

/// The powers of a tally.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Powers {
    viscous: [f64; Slot::ALL.len()],
    friction: [f64; Slot::ALL.len()],
    slipped: [f64; Slot::ALL.len()],
    lacking: Losses,
    walls: f64,
}

/// Work and dissipation since the start of the run, integrated with the trapezoidal rule over the steps; what
/// springs lose by sliding within a step is added as it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Work {
    /// Viscous (or plastic) dissipation \[J\] by slot.
    pub viscous: [f64; Slot::ALL.len()],
    /// Frictional dissipation \[J\] by slot.
    pub friction: [f64; Slot::ALL.len()],
    /// Work of moving walls on the bodies \[J\].
    pub walls: f64,
}

impl Work {
    pub(crate) fn accumulate(&mut self, before: &Powers, after: &Powers, time_step: f64) {
        let mean = |a: f64, b: f64| 0.5 * (a + b) * time_step;
        for slot in 0..Slot::ALL.len() {
            self.viscous[slot] +=
                mean(before.viscous[slot], after.viscous[slot]) + after.lacking.viscous[slot];
            self.friction[slot] += mean(before.friction[slot], after.friction[slot])
                + after.slipped[slot]
                + after.lacking.friction[slot];
        }
        self.walls += mean(before.walls, after.walls);
    }
}

/// The other side of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ContactPartner {
    /// Identity of the other body.
    Body(u32),
    /// Index of the wall.
    Wall(u32),
}

/// What a contact did in the last force evaluation, seen from the body whose identity is smaller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce {
    /// Identity of body i.
    pub id: u32,
    /// The other side.
    pub partner: ContactPartner,
    /// Overlap δ \[m\].
    pub overlap: f64,
    /// Unit normal from j to i.
    pub normal: [f64; 3],
    /// Force along the normal on i \[N\]; positive pushes the bodies apart.
    pub normal_force: f64,
    /// Force across the normal on i \[N\].
    pub tangential_force: [f64; 3],
    /// Torque of laws such as rolling friction on i, without that of the tangential force \[N m\].
    pub torque: [f64; 3],
}

/// One contact, as observers see it.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactRecord {
    /// Identity of body i.
    pub id: u32,
    /// The other side.
    pub partner: ContactPartner,
    /// Overlap δ \[m\].
    pub overlap: f64,
    /// Unit normal from j to i.
    pub normal: [f64; 3],
    /// History columns of the composition.
    pub history: Vec<f64>,
}
