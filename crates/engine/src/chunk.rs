//! One batch of touching contacts: from gathered kinematics through the stages to forces.

use std::sync::Arc;

use granule_law_api::{Arm, Columns, ContactChunk, EnergyColumns, Real, Stage};
use granule_plan::Composition;

use crate::tally::Tally;

/// Contacts per batch. Half of the largest chunk that laws must accept: the columns of a batch then stay in the first
/// and second level cache.
pub(crate) const BATCH: usize = 64;

type Column<T> = [T; BATCH];

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
    /// Overlap in double precision \[m\].
    pub depth: Column<f64>,
    /// Sum of the inverse masses \[1/kg\].
    pub inverse_mass: Column<f64>,
    /// Index of the pair in its list.
    pub pair: Column<u32>,
    /// Place of body i within the tile.
    pub i: Column<u32>,
    /// Place of body j, or the wall.
    pub j: Column<u32>,
    /// Slot in the outbox, or [`OWN`] if the tile owns j.
    pub outgoing: Column<u32>,
    /// Radii, then lever arms of the torque \[m\].
    pub arm: [Column<f64>; 2],
    /// Relative velocity of the centres \[m/s\].
    pub velocity: [Column<f64>; 3],
    /// a_i ω_i + a_j ω_j with the arms of the slip velocity \[m/s\].
    pub surface_velocity: [Column<f64>; 3],
    /// Relative spin \[rad/s\].
    pub relative_spin: [Column<T>; 3],
    /// Unit normal in double precision.
    pub direction: [Column<f64>; 3],
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
    pub energy: [Column<T>; 3],
    pub history: Vec<Column<T>>,
    /// Force on i \[N\].
    pub force: [Column<f64>; 3],
    /// n × f_t \[N\].
    pub turning: [Column<f64>; 3],
}

/// Marks a contact whose second body belongs to the tile itself.
pub(crate) const OWN: u32 = u32::MAX;

impl<T: Real> Batch<T> {
    pub fn new(history_width: usize) -> Self {
        let double = || [[0.0; BATCH]; 3];
        let vector = || [[T::ZERO; BATCH]; 3];
        let scalar = || [T::ZERO; BATCH];
        Self {
            count: 0,
            separation: double(),
            distance_squared: [0.0; BATCH],
            touching_distance: [0.0; BATCH],
            depth: [0.0; BATCH],
            inverse_mass: [0.0; BATCH],
            pair: [0; BATCH],
            i: [0; BATCH],
            j: [0; BATCH],
            outgoing: [0; BATCH],
            arm: [[0.0; BATCH]; 2],
            velocity: double(),
            surface_velocity: double(),
            relative_spin: vector(),
            direction: double(),
            overlap: scalar(),
            normal: vector(),
            normal_velocity: scalar(),
            tangential_velocity: vector(),
            reduced_mass: scalar(),
            reduced_radius: scalar(),
            normal_force: scalar(),
            normal_stiffness: scalar(),
            normal_damping: scalar(),
            tangential_force: vector(),
            contact_torque: vector(),
            energy: vector(),
            history: vec![scalar(); history_width],
            force: double(),
            turning: double(),
        }
    }

    /// Number of contacts, in a form from which the compiler sees that no column is left.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.count.min(BATCH)
    }

    /// Unit normals and overlaps from the separations. Coincident centres get the x direction as normal: any choice is
    /// as good, and this one keeps action and reaction opposite and the run reproducible.
    #[inline(always)]
    pub fn normalise(&mut self) {
        for k in 0..self.len() {
            let squared = self.distance_squared[k];
            let distance = squared.sqrt();
            let coincident = squared == 0.0;
            let inverse = 1.0 / if coincident { 1.0 } else { distance };
            self.direction[0][k] = if coincident { 1.0 } else { self.separation[0][k] * inverse };
            self.direction[1][k] = self.separation[1][k] * inverse;
            self.direction[2][k] = self.separation[2][k] * inverse;
            self.depth[k] = self.touching_distance[k] - distance;
            self.overlap[k] = T::of(self.depth[k]);
        }
    }

    /// Normal and tangential velocity from relative and surface velocities.
    #[inline(always)]
    pub fn project(&mut self, tangential: bool) {
        let count = self.len();
        let [nx, ny, nz] = &self.direction;
        let [vx, vy, vz] = &self.velocity;
        for k in 0..count {
            let along = vx[k] * nx[k] + vy[k] * ny[k] + vz[k] * nz[k];
            self.normal_velocity[k] = T::of(-along);
        }
        for axis in 0..3 {
            for k in 0..count {
                self.normal[axis][k] = T::of(self.direction[axis][k]);
            }
        }
        if tangential {
            let [sx, sy, sz] = &self.surface_velocity;
            let [tx, ty, tz] = &mut self.tangential_velocity;
            for k in 0..count {
                let along = vx[k] * nx[k] + vy[k] * ny[k] + vz[k] * nz[k];
                tx[k] = T::of(vx[k] - along * nx[k] + (ny[k] * sz[k] - nz[k] * sy[k]));
                ty[k] = T::of(vy[k] - along * ny[k] + (nz[k] * sx[k] - nx[k] * sz[k]));
                tz[k] = T::of(vz[k] - along * nz[k] + (nx[k] * sy[k] - ny[k] * sx[k]));
            }
        }
    }

    /// Runs the stages of a composition.
    pub fn run(
        &mut self,
        composition: &Composition,
        stages: &[Arc<dyn Stage<T>>],
        time_step: f64,
        tally: Option<&mut Tally>,
    ) {
        let n = self.len();
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
        let ledger = tally.is_some();
        let mut tally = tally;
        for (plan, stage) in composition.stages.iter().zip(stages) {
            // Width 3 covers a vector of history; wider laws take the general path with a small vector of slices.
            let columns = &mut self.history[plan.history_offset..plan.history_offset + plan.history_width];
            let mut slices: [&mut [T]; HISTORY_LIMIT] = std::array::from_fn(|_| &mut [][..]);
            for (slice, column) in slices.iter_mut().zip(columns) {
                *slice = &mut column[..n];
            }
            let [elastic, viscous, friction] = &mut self.energy;
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
                }),
            };
            stage.run(&mut chunk);
            if let Some(tally) = tally.as_deref_mut() {
                let sum = |column: &Column<T>| column[..n].iter().fold(0.0, |sum, value| sum + value.wide());
                let slot = plan.slot as usize;
                tally.elastic[slot] += sum(&self.energy[0]);
                tally.viscous[slot] += sum(&self.energy[1]);
                tally.friction[slot] += sum(&self.energy[2]);
            }
        }
    }

    /// Force on i, and n × f_t, in double precision.
    #[inline(always)]
    pub fn assemble(&mut self, tangential: bool) {
        let count = self.len();
        for axis in 0..3 {
            let (force, direction) = (&mut self.force[axis], &self.direction[axis]);
            for k in 0..count {
                force[k] = self.normal_force[k].wide() * direction[k];
            }
            if tangential {
                for k in 0..count {
                    force[k] += self.tangential_force[axis][k].wide();
                }
            }
        }
        if tangential {
            let [nx, ny, nz] = &self.direction;
            let [fx, fy, fz] = &self.tangential_force;
            for k in 0..count {
                let f = [fx[k].wide(), fy[k].wide(), fz[k].wide()];
                self.turning[0][k] = ny[k] * f[2] - nz[k] * f[1];
                self.turning[1][k] = nz[k] * f[0] - nx[k] * f[2];
                self.turning[2][k] = nx[k] * f[1] - ny[k] * f[0];
            }
        }
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
