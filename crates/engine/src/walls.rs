//! Contacts with walls.

use granule_geometry::Surface;
use granule_law_api::Columns;
use granule_plan::{Composition, WallPlan};
use granule_state::Row;
use nalgebra::Vector3;

use crate::chunk::{BATCH, Batch, share};
use crate::gather::{Arena, Arithmetic};
use crate::history::PairHistory;
use crate::space::{Space, add};
use crate::tile::{Evaluation, Range, Shared, Tile};

/// A wall at the time of the force evaluation.
#[derive(Clone, Debug)]
pub(crate) struct MovedWall<'a> {
    pub surface: Surface,
    pub plan: &'a WallPlan,
    pub time: f64,
}

/// A body that may touch a wall.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallPair {
    /// Place of the body within the tile.
    pub body: u32,
    /// Index of the wall.
    pub wall: u32,
}

/// Candidates of one tile with walls.
#[derive(Clone, Debug, Default)]
pub(crate) struct WallList {
    pub pairs: Vec<WallPair>,
    pub ranges: Vec<Range>,
    pub history: PairHistory,
}

impl WallList {
    /// Heap bytes.
    pub fn bytes(&self) -> usize {
        self.pairs.capacity() * size_of::<WallPair>()
            + self.history.values.capacity() * 8
            + self.history.stamp.capacity() * 4
    }
}

impl Tile {
    pub(crate) fn wall_contacts<S: Space, T: Arithmetic>(
        &mut self,
        batch: &mut Batch<T>,
        arena: &Arena<T>,
        at: &Evaluation<'_>,
        force: &mut [Row],
        torque: &mut [Row],
    ) {
        for index in 0..self.walls.ranges.len() {
            let range = self.walls.ranges[index];
            let composition = &at.compositions[range.composition as usize];
            let mut next = range.start as usize;
            while next < range.end as usize {
                next = self.gather_wall_contacts::<S, T>(batch, next..range.end as usize, composition, at);
                if batch.count > 0 {
                    self.wall_batch::<S, T>(batch, arena, range.composition as usize, at, force, torque);
                }
            }
        }
    }

    fn gather_wall_contacts<S: Space, T: Arithmetic>(
        &self,
        batch: &mut Batch<T>,
        range: std::ops::Range<usize>,
        composition: &Composition,
        at: &Evaluation<'_>,
    ) -> usize {
        let mut count = 0;
        let mut index = range.start;
        while index < range.end && count < BATCH {
            let pair = self.walls.pairs[index];
            let wall = &at.walls[pair.wall as usize];
            let place = self.first + pair.body as usize;
            let row = at.bodies.position[place];
            let position = Vector3::new(row[0], row[1], row[2]);
            let contact = wall.surface.contact(position);
            let limit: f64 = row[3] + composition.reach;
            if contact.distance < limit {
                batch.pair[count] = index as u32;
                batch.i[count] = pair.body;
                batch.j[count] = pair.wall;
                let overlap = row[3] - contact.distance;
                batch.overlap[count] = T::of(overlap);
                for axis in 0..3 {
                    batch.direction[axis][count] = contact.normal[axis];
                }
                let touching_point = position - contact.normal * contact.distance;
                let moving = wall.plan.wall.velocity_at(touching_point, wall.time);
                let velocity = at.bodies.velocity::<S>(place);
                for axis in 0..3 {
                    batch.velocity[axis][count] = velocity[axis] - moving[axis];
                }
                let inverse_mass = at.bodies.velocity[place][3];
                let mass = if inverse_mass > 0.0 { 1.0 / inverse_mass } else { at.bodies.mass[place] };
                batch.reduced_mass[count] = T::of(mass);
                batch.reduced_radius[count] = T::of(1.0 / (1.0 / row[3] + 1.0 / contact.curvature_radius));
                self.wall_arms::<S, T>(batch, count, row[3], overlap, composition, at.bodies, place);
                count += 1;
            }
            index += 1;
        }
        batch.count = count;
        index
    }

    #[inline(always)]
    fn wall_arms<S: Space, T: Arithmetic>(
        &self,
        batch: &mut Batch<T>,
        k: usize,
        radius: f64,
        overlap: f64,
        composition: &Composition,
        bodies: &Shared<'_>,
        place: usize,
    ) {
        let conventions = &composition.context.conventions;
        batch.arm[0][k] = radius - share(conventions.wall_torque_arm) * overlap;
        if S::ROTATION {
            let slip = radius - share(conventions.wall_slip_arm) * overlap;
            let spin = bodies.spin::<S>(place);
            for axis in 0..3 {
                batch.surface_velocity[axis][k] = slip * spin[axis];
                batch.relative_spin[axis][k] = T::of(spin[axis]);
            }
        }
    }

    fn wall_batch<S: Space, T: Arithmetic>(
        &mut self,
        batch: &mut Batch<T>,
        arena: &Arena<T>,
        index: usize,
        at: &Evaluation<'_>,
        force: &mut [Row],
        torque: &mut [Row],
    ) {
        let composition = &at.compositions[index];
        let tangential = composition.writes.contains(Columns::TANGENTIAL_FORCE);
        batch.project(composition.reads.contains(Columns::TANGENTIAL_VELOCITY));
        let remembers = composition.history_width > 0;
        if remembers {
            self.walls.history.load(batch, at.now);
        }
        let tally = at.ledger.then_some(&mut self.tally);
        batch.run(composition, &arena.stages[index], at.time_step, tally);
        if remembers {
            self.walls.history.store(batch, at.now);
        }
        batch.assemble(tangential);
        self.tally.wall_contacts += batch.count as u64;
        if at.overlap {
            self.tally.maximum_overlap = self.tally.maximum_overlap.max(batch.maximum_overlap());
        }
        let rolls = composition.writes.contains(Columns::TORQUE);
        for k in 0..batch.len() {
            let f = [batch.force[0][k], batch.force[1][k], batch.force[2][k]];
            let mut on_body = [0.0; 3];
            if S::ROTATION {
                for axis in 0..3 {
                    if tangential {
                        on_body[axis] = -batch.arm[0][k] * batch.turning[axis][k];
                    }
                    if rolls {
                        on_body[axis] += batch.contact_torque[axis][k].wide();
                    }
                }
            }
            let body = batch.i[k] as usize;
            add::<S>(force, torque, body, 1.0, f, on_body);
            let wall = batch.j[k] as usize;
            let moving = &at.walls[wall];
            let sum = &mut self.tally.wall_force[wall];
            for axis in 0..3 {
                sum[axis] -= f[axis];
            }
            if at.ledger && !moving.plan.wall.motion().is_fixed() {
                self.tally.wall_power += wall_power(moving, at.bodies.position[self.first + body], f);
            }
        }
    }
}

/// Power that a moving wall exerts on a body through the force `f` on it \[W\].
fn wall_power(wall: &MovedWall<'_>, row: Row, f: [f64; 3]) -> f64 {
    let position = Vector3::new(row[0], row[1], row[2]);
    let contact = wall.surface.contact(position);
    let velocity = wall.plan.wall.velocity_at(position - contact.normal * contact.distance, wall.time);
    f[0] * velocity[0] + f[1] * velocity[1] + f[2] * velocity[2]
}
