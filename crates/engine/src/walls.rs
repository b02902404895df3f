//! Contacts with walls.

use granule_geometry::{Surface, Wall};
use granule_law_api::{Columns, ContactEnd};
use granule_plan::Composition;
use granule_state::{Lanes, Row};
use nalgebra::Vector3;

use crate::blame;
use crate::chunk::{BATCH, Batch, share};
use crate::history::PairHistory;
use crate::level::{Arena, Arithmetic};
use crate::records::{self, Written};
use crate::resolve::{Path, Resolver, history_before};
use crate::scatter::wrenches;
use crate::space::Space;
use crate::tile::{Evaluation, Range, Tile};

/// A wall at the time of the force evaluation.
#[derive(Clone, Debug)]
pub(crate) struct MovedWall {
    pub surface: Surface,
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
        self.pairs.capacity() * size_of::<WallPair>() + self.history.bytes()
    }
}

impl Tile {
    #[inline(always)]
    pub(crate) fn wall_contacts<S: Space, T: Arithmetic, L: Lanes>(
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
            if at.resolved.is_some() {
                self.leave_walls::<S, T>(arena, range, at);
            }
            while next < range.end as usize {
                next = self.gather_wall_contacts::<S, T>(batch, next..range.end as usize, composition, at);
                if batch.count > 0 {
                    self.wall_batch::<S, T, L>(batch, arena, range.composition as usize, at, force, torque);
                }
            }
        }
    }

    #[inline(always)]
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
                batch.to[count] = pair.wall;
                let overlap = row[3] - contact.distance;
                batch.overlap[count] = T::of(overlap);
                let touching_point = position - contact.normal * contact.distance;
                let moving = at.wall_plans[pair.wall as usize].wall.velocity_at(touching_point, wall.time);
                let velocity = Vector3::from(at.bodies.velocity::<S>(place)) - moving;
                let inverse_mass = at.bodies.velocity[place][3];
                let mass = if inverse_mass > 0.0 { 1.0 / inverse_mass } else { at.bodies.mass[place] };
                batch.reduced_mass[count] = T::of(mass);
                batch.reduced_radius[count] = T::of(1.0 / (1.0 / row[3] + 1.0 / contact.curvature_radius));
                let conventions = &composition.context.conventions;
                batch.arm[0][count] = row[3] - share(conventions.wall_torque_arm) * overlap;
                let slip_arm = row[3] - share(conventions.wall_slip_arm) * overlap;
                let spin = Vector3::from(at.bodies.spin::<S>(place));
                project(batch, count, contact.normal, velocity, spin, slip_arm);
                count += 1;
            }
            index += 1;
        }
        batch.close(count);
        index
    }

    #[inline(always)]
    fn wall_batch<S: Space, T: Arithmetic, L: Lanes>(
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
        let remembers = composition.history_width > 0;
        if remembers {
            self.walls.history.load::<T, L>(batch, at.now);
        }
        let tally = at.ledger.then_some(&mut self.tally);
        batch.run(composition, &arena.stages[index], at.time_step, tally);
        if at.inquest {
            let first = self.first as u32;
            blame::inquire(batch, composition, &arena.stages[index], at.time_step, |batch, k| {
                [Some(first + batch.i[k]), None]
            });
        }
        if at.resolved.is_some() {
            self.resolve_wall_contacts::<S, T>(batch, arena, index, at);
        }
        if remembers {
            self.walls.history.store::<T, L>(batch, at.now);
        }
        self.tally.wall_contacts += batch.count as u64;
        if at.overlap {
            self.tally.maximum_overlap = self.tally.maximum_overlap.max(batch.maximum_overlap());
            for k in 0..batch.count {
                let radius = at.bodies.position[self.first + batch.i[k] as usize][3];
                let relative = batch.overlap[k].wide() / radius;
                self.tally.relative_overlap = self.tally.relative_overlap.max(relative);
            }
        }
        let rolls = composition.writes.contains(Columns::TORQUE);
        if at.records {
            let written = Written { tangential, torque: rolls };
            records::keep(&mut self.records, batch, self.first, true, written);
        }
        for g in 0..batch.groups() {
            let wrenches = wrenches::<S, T, L>(batch, g, tangential, rolls, true);
            let (mut forces, mut torques) = ([Row::ZERO; 4], [Row::ZERO; 4]);
            for lane in 0..4 {
                wrenches.force[lane].store(&mut forces[lane].0);
                wrenches.torque[0][lane].store(&mut torques[lane].0);
            }
            for k in 4 * g..batch.len().min(4 * g + 4) {
                let (body, f) = (batch.i[k] as usize, forces[k - 4 * g]);
                add(&mut force[body], f);
                if let Some(torque) = torque.get_mut(body) {
                    add(torque, torques[k - 4 * g]);
                }
                let wall = batch.to[k] as usize;
                let (moving, prescribed) = (&at.walls[wall], &at.wall_plans[wall].wall);
                let f = if S::PLANAR { [f[0], f[1], 0.0] } else { f.vector() };
                let sum = &mut self.tally.wall_force[wall];
                for axis in 0..3 {
                    sum[axis] -= f[axis];
                }
                if at.ledger && !prescribed.motion().is_fixed() {
                    let row = at.bodies.position[self.first + body];
                    self.tally.wall_power += wall_power(moving, prescribed, row, f);
                }
            }
        }
    }
}

impl Tile {
    /// Impulses of the bodies that touched a wall at the beginning of the step and do not at its end.
    fn leave_walls<S: Space, T: Arithmetic>(&mut self, arena: &Arena<T>, range: Range, at: &Evaluation<'_>) {
        let Some(rows) = &at.resolved else { return };
        let composition = &at.compositions[range.composition as usize];
        let mut single = arena.single();
        let (impulses, tally) = (&mut self.impulses, &mut self.tally);
        let index = range.composition as usize;
        let mut laws = Resolver::new(&mut single, arena, index, at, impulses, tally);
        for number in range.start..range.end {
            let pair = self.walls.pairs[number as usize];
            let wall = &at.walls[pair.wall as usize];
            let place = self.first + pair.body as usize;
            let row = at.bodies.position[place];
            let distance = wall.surface.contact(Vector3::new(row[0], row[1], row[2])).distance;
            let gap = distance - row[3] - composition.reach;
            if gap >= 0.0 && gap < rows.margin {
                let prescribed = &at.wall_plans[pair.wall as usize].wall;
                let path = Path::at_wall::<S>(at, rows, composition, place, (prescribed, wall.time));
                let before = history_before(&self.walls.history, number, at.now);
                laws.ended(&path, before, (place as u32, None));
            }
        }
    }

    /// Resolves those contacts of a batch that have begun or come to the end of their force within the step.
    fn resolve_wall_contacts<S: Space, T: Arithmetic>(
        &mut self,
        batch: &mut Batch<T>,
        arena: &Arena<T>,
        index: usize,
        at: &Evaluation<'_>,
    ) {
        let Some(rows) = &at.resolved else { return };
        let composition = &at.compositions[index];
        let mut single = arena.single();
        let (impulses, tally) = (&mut self.impulses, &mut self.tally);
        let mut laws = Resolver::new(&mut single, arena, index, at, impulses, tally);
        for k in 0..batch.len() {
            let clipped = composition.contact_end == ContactEnd::Force && batch.is_clipped(k);
            if batch.overlap[k].wide() + composition.reach > rows.margin && !clipped {
                continue;
            }
            let place = self.first + batch.i[k] as usize;
            let wall = batch.to[k] as usize;
            let prescribed = (&at.wall_plans[wall].wall, at.walls[wall].time);
            let path = Path::at_wall::<S>(at, rows, composition, place, prescribed);
            let before = history_before(&self.walls.history, batch.pair[k], at.now);
            laws.touching(batch, k, &path, before, (place as u32, None));
        }
    }
}

fn add(to: &mut Row, value: Row) {
    for k in 0..4 {
        to[k] += value[k];
    }
}

/// Normal and tangential velocity and relative spin of contact `k`, from the velocity of the centre against the wall and
/// the spin.
#[inline(always)]
fn project<T: Arithmetic>(
    batch: &mut Batch<T>,
    k: usize,
    normal: Vector3<f64>,
    velocity: Vector3<f64>,
    spin: Vector3<f64>,
    slip_arm: f64,
) {
    let along = velocity.dot(&normal);
    let tangential = velocity - normal * along + normal.cross(&(spin * slip_arm));
    batch.normal_velocity[k] = T::of(-along);
    for axis in 0..3 {
        batch.normal[axis][k] = T::of(normal[axis]);
        batch.tangential_velocity[axis][k] = T::of(tangential[axis]);
        batch.relative_spin[axis][k] = T::of(spin[axis]);
    }
}

/// Power that a moving wall exerts on a body through the force `f` on it \[W\].
fn wall_power(wall: &MovedWall, prescribed: &Wall, row: Row, f: [f64; 3]) -> f64 {
    let position = Vector3::new(row[0], row[1], row[2]);
    let contact = wall.surface.contact(position);
    let velocity = prescribed.velocity_at(position - contact.normal * contact.distance, wall.time);
    f[0] * velocity[0] + f[1] * velocity[1] + f[2] * velocity[2]
}
