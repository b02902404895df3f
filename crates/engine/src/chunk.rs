//! One batch of touching contacts: from gathered kinematics through the stages to forces.

use std::sync::Arc;

use granule_law_api::{Arm, Columns, ContactChunk, EnergyColumns, Real, Stage};
use granule_plan::Composition;
use granule_state::Row;
use nalgebra::Vector3;

use crate::blame;
use crate::tally::Tally;

/// Contacts per batch. A fraction of the largest chunk that laws must accept: the columns of a batch then stay in the
/// first level cache.
pub(crate) const BATCH: usize = 96;

/// One number for each contact of a batch. The cache line behind them shifts the next column: with all columns a power of
/// two apart, the same place of several columns would share few sets of the cache, and a load would wait for stores to
/// addresses that only look the same.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Column<T>([T; BATCH], [u64; 8]);

impl<T: Copy> Column<T> {
    /// The same number everywhere.
    pub fn filled(value: T) -> Self {
        Self([value; BATCH], [0; 8])
    }
}

impl<T> Column<T> {
    /// The numbers of group `group` of four.
    #[inline(always)]
    pub fn four(&self, group: usize) -> &[T; 4] {
        &self.0.as_chunks::<4>().0[group]
    }

    /// The same, to be written.
    #[inline(always)]
    pub fn four_mut(&mut self, group: usize) -> &mut [T; 4] {
        &mut self.0.as_chunks_mut::<4>().0[group]
    }

    /// Four numbers from place `k`, which is at most [`BATCH`] - 4, on.
    #[inline(always)]
    pub fn four_at(&mut self, k: usize) -> &mut [T; 4] {
        let k = k.min(BATCH - 4);
        // The length is right by construction; the compiler sees it, too.
        self.0[k..].first_chunk_mut::<4>().unwrap_or_else(|| unreachable!())
    }
}

impl<T> std::ops::Deref for Column<T> {
    type Target = [T; BATCH];
    #[inline(always)]
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<T> std::ops::DerefMut for Column<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

/// Columns of one batch. Kinematics are double precision; what stages see is `T`.
pub(crate) struct Batch<T> {
    /// Number of contacts.
    pub count: usize,
    /// Separation x_i - x_j, without normalisation \[m\].
    pub separation: [Column<f64>; 3],
    /// Squared distance of the centres \[m²\].
    pub distance_squared: Column<f64>,
    /// Distance at which they touch \[m\].
    pub touching_distance: Column<f64>,
    /// Index of the pair in its list.
    pub pair: Column<u32>,
    /// Place of body i within the tile.
    pub i: Column<u32>,
    /// Place of body j among all bodies.
    pub j: Column<u32>,
    /// Where the force on j goes (see [`ForceList`](crate::list::ForceList)); the wall.
    pub to: Column<u32>,
    /// Lever arms of the torque \[m\].
    pub arm: [Column<f64>; 2],
    /// Relative spin \[rad/s\].
    pub relative_spin: [Column<T>; 3],
    pub overlap: Column<T>,
    pub normal: [Column<T>; 3],
    pub normal_velocity: Column<T>,
    pub tangential_velocity: [Column<T>; 3],
    pub reduced_mass: Column<T>,
    pub reduced_radius: Column<T>,
    pub normal_force: Column<T>,
    pub normal_stiffness: Column<T>,
    pub normal_damping: Column<T>,
    pub tangential_force: [Column<T>; 3],
    pub contact_torque: [Column<T>; 3],
    pub energy: [Column<T>; 4],
    pub history: Vec<Column<T>>,
    /// Contacts of the batch that may have begun in the step, for a scheme that wants to know.
    pub begun: Vec<u32>,
    /// Pairs that may have parted in it.
    pub parted: Vec<Parted>,
}

/// A pair that does not touch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parted {
    /// Index of the pair in its list.
    pub pair: u32,
    /// Place of body i within the tile.
    pub i: u32,
    /// Place of body j among all bodies.
    pub j: u32,
    /// Separation x_i - x_j \[m\].
    pub separation: [f64; 3],
}

impl<T: Real> Batch<T> {
    pub fn new(history_width: usize) -> Self {
        let double = Column::filled(0.0);
        let index = Column::filled(0);
        let scalar = Column::filled(T::ZERO);
        Self {
            count: 0,
            separation: [double; 3],
            distance_squared: double,
            touching_distance: double,
            pair: index,
            i: index,
            j: index,
            to: index,
            arm: [double; 2],
            relative_spin: [scalar; 3],
            overlap: scalar,
            normal: [scalar; 3],
            normal_velocity: scalar,
            tangential_velocity: [scalar; 3],
            reduced_mass: scalar,
            reduced_radius: scalar,
            normal_force: scalar,
            normal_stiffness: scalar,
            normal_damping: scalar,
            tangential_force: [scalar; 3],
            contact_torque: [scalar; 3],
            energy: [scalar; 4],
            history: vec![scalar; history_width],
            begun: Vec::with_capacity(BATCH),
            parted: Vec::with_capacity(BATCH),
        }
    }

    /// Says how many contacts there are. The last group of four is filled up, so that it refers to existing pairs.
    #[inline(always)]
    pub fn close(&mut self, count: usize) {
        self.count = count;
        for k in count..count.next_multiple_of(4).min(BATCH) {
            (self.pair[k], self.i[k]) = (self.pair[0], self.i[0]);
            (self.j[k], self.to[k]) = (self.j[0], self.to[0]);
        }
    }

    /// The law has cut the force of contact `k`, which separates, to zero.
    #[inline(always)]
    pub fn is_clipped(&self, k: usize) -> bool {
        self.normal_force[k] == T::ZERO && self.normal_velocity[k] < T::ZERO
    }

    /// Separation of the centres of contact `k`.
    pub fn separation_of(&self, k: usize) -> Vector3<f64> {
        Vector3::new(self.separation[0][k], self.separation[1][k], self.separation[2][k])
    }

    /// The largest number of a column of indices; those that fill the last group up count, too.
    #[inline(always)]
    pub fn largest(&self, column: &Column<u32>) -> u32 {
        let mut largest = [0; 4];
        for g in 0..self.groups() {
            let four = column.four(g);
            for lane in 0..4 {
                largest[lane] = largest[lane].max(four[lane]);
            }
        }
        largest[0].max(largest[1]).max(largest[2]).max(largest[3])
    }

    /// Number of contacts, in a form from which the compiler sees that no column is left.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.count.min(BATCH)
    }

    /// Number of groups of four, the last of which may not be full.
    #[inline(always)]
    pub fn groups(&self) -> usize {
        self.len().div_ceil(4)
    }

    /// Runs the stages of a composition.
    pub fn run(
        &mut self,
        composition: &Composition,
        stages: &[Arc<dyn Stage<T>>],
        time_step: f64,
        tally: Option<&mut Tally>,
    ) {
        // Loops over a multiple of the widest vector have no rest. What stands behind the last contact is old but finite,
        // and nobody reads what becomes of it.
        let n = self.len().next_multiple_of(8).min(BATCH);
        if composition.writes.contains(Columns::TORQUE) {
            for column in &mut self.contact_torque {
                column[..n].fill(T::ZERO);
            }
        }
        self.normal_force[..n].fill(T::ZERO);
        let wanted =
            |column: Columns, length: usize| if composition.reads.contains(column) { length } else { 0 };
        let slip = wanted(Columns::TANGENTIAL_VELOCITY, n);
        let spin = wanted(Columns::RELATIVE_SPIN, n);
        let stiffness = wanted(Columns::NORMAL_STIFFNESS, n);
        let damping = wanted(Columns::NORMAL_DAMPING, n);
        let tangential = if composition.writes.contains(Columns::TANGENTIAL_FORCE) { n } else { 0 };
        let torque = if composition.writes.contains(Columns::TORQUE) { n } else { 0 };
        let (ledger, count) = (tally.is_some(), self.len());
        let mut tally = tally;
        for (plan, stage) in composition.stages.iter().zip(stages) {
            // Width 3 covers a vector of history; wider laws take the general path with a small vector of slices.
            let columns = &mut self.history[plan.history_offset..plan.history_offset + plan.history_width];
            let mut slices: [&mut [T]; HISTORY_LIMIT] = std::array::from_fn(|_| &mut [][..]);
            for (slice, column) in slices.iter_mut().zip(columns) {
                *slice = &mut column[..n];
            }
            let [elastic, viscous, friction, slipped] = &mut self.energy;
            if ledger {
                slipped[..n].fill(T::ZERO);
            }
            let [fx, fy, fz] = &mut self.tangential_force;
            let [tx, ty, tz] = &mut self.contact_torque;
            let mut chunk = ContactChunk {
                time_step: T::of(time_step),
                overlap: &self.overlap[..n],
                normal: [&self.normal[0][..n], &self.normal[1][..n], &self.normal[2][..n]],
                normal_velocity: &self.normal_velocity[..n],
                tangential_velocity: [
                    &self.tangential_velocity[0][..slip],
                    &self.tangential_velocity[1][..slip],
                    &self.tangential_velocity[2][..slip],
                ],
                relative_spin: [
                    &self.relative_spin[0][..spin],
                    &self.relative_spin[1][..spin],
                    &self.relative_spin[2][..spin],
                ],
                reduced_mass: &self.reduced_mass[..n],
                reduced_radius: &self.reduced_radius[..n],
                normal_force: &mut self.normal_force[..n],
                normal_stiffness: &mut self.normal_stiffness[..stiffness],
                normal_damping: &mut self.normal_damping[..damping],
                tangential_force: [&mut fx[..tangential], &mut fy[..tangential], &mut fz[..tangential]],
                torque: [&mut tx[..torque], &mut ty[..torque], &mut tz[..torque]],
                history: &mut slices[..plan.history_width],
                energy: ledger.then_some(EnergyColumns {
                    elastic: &mut elastic[..n],
                    viscous: &mut viscous[..n],
                    friction: &mut friction[..n],
                    slipped: &mut slipped[..n],
                }),
            };
            blame::run(plan.law.info.name, stage.as_ref(), &mut chunk);
            if let Some(tally) = tally.as_deref_mut() {
                let sum =
                    |column: &Column<T>| column[..count].iter().fold(0.0, |sum, value| sum + value.wide());
                let slot = plan.slot as usize;
                tally.elastic[slot] += sum(&self.energy[0]);
                tally.viscous[slot] += sum(&self.energy[1]);
                tally.friction[slot] += sum(&self.energy[2]);
                tally.slipped[slot] += sum(&self.energy[3]);
            }
        }
    }

    /// Largest overlap over the radius of the smaller body: of the `own` bodies of a tile with all bodies.
    #[cold]
    #[inline(never)]
    pub fn relative_overlap(&self, own: &[Row], all: &[Row]) -> f64 {
        let relative = |k: usize| {
            let radius = own[self.i[k] as usize][3].min(all[self.j[k] as usize][3]);
            self.overlap[k].wide() / radius
        };
        (0..self.count).map(relative).fold(0.0, f64::max)
    }

    /// Largest overlap of the batch \[m\].
    pub fn maximum_overlap(&self) -> f64 {
        self.overlap[..self.count].iter().fold(0.0, |largest: f64, overlap| largest.max(overlap.wide()))
    }
}

/// Most scalar history columns of one stage.
pub(crate) const HISTORY_LIMIT: usize = 16;

/// Share of the overlap by which an arm is shorter than the radius.
#[inline(always)]
pub(crate) fn share(rule: Arm) -> f64 {
    match rule {
        Arm::Radius => 0.0,
        Arm::HalfOverlap => 0.5,
        Arm::FullOverlap => 1.0,
    }
}
