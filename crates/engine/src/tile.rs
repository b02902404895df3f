//! A tile: consecutive bodies, the pairs whose first body they are, and their forces.

use granule_plan::Composition;
use granule_state::{Bodies, Row};

use crate::chunk::{BATCH, Batch, OWN};
use crate::gather::{Arena, Level, gather_pairs};
use crate::history::PairHistory;
use crate::space::{Space, add};
use crate::tally::Tally;
use crate::walls::{MovedWall, WallList};

/// Two bodies that may touch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// Place of i within the tile, times 32, plus the image code of j.
    pub i_image: u32,
    /// Place of j among all bodies.
    pub j: u32,
}

/// Pairs of one composition within a list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range {
    pub composition: u32,
    pub start: u32,
    pub end: u32,
}

/// Force and torque on a body of another tile.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outgoing {
    pub force: [f64; 3],
    pub torque: [f64; 3],
}

/// Where a body of this tile finds a force that another tile has computed for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Incoming {
    /// Place within this tile.
    pub body: u32,
    /// The other tile.
    pub tile: u32,
    /// Slot in its outbox.
    pub slot: u32,
}

/// Consecutive bodies with the lists that belong to them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tile {
    pub first: usize,
    pub len: usize,
    /// Candidates within the Verlet skin.
    pub outer: Vec<Pair>,
    pub outer_ranges: Vec<Range>,
    /// Candidates within the inner skin: a subsequence of `outer`.
    pub inner: Vec<Pair>,
    pub inner_ranges: Vec<Range>,
    /// Index in `outer` of each inner pair.
    pub inner_outer: Vec<u32>,
    pub history: PairHistory,
    pub outbox: Vec<Outgoing>,
    pub inbox: Vec<Incoming>,
    pub walls: WallList,
    pub tally: Tally,
}

/// What a force evaluation needs besides the tile.
pub(crate) struct Evaluation<'a> {
    pub bodies: &'a Shared<'a>,
    pub compositions: &'a [Composition],
    /// Shift of the separation by image code.
    pub shifts: &'a [[f64; 3]; 27],
    pub walls: &'a [MovedWall<'a>],
    pub gravity: [f64; 3],
    pub time_step: f64,
    /// Number of this evaluation.
    pub now: u32,
    /// Energies are summed.
    pub ledger: bool,
    /// The largest overlap is sought.
    pub overlap: bool,
}

/// Rows that all tiles read while each writes its own forces.
pub(crate) struct Shared<'a> {
    pub position: &'a [Row],
    pub velocity: &'a [Row],
    pub spin: &'a [Row],
    pub mass: &'a [f64],
}

impl Shared<'_> {
    /// Spin of a body; zero components where none exist.
    #[inline(always)]
    pub fn spin<S: Space>(&self, place: usize) -> [f64; 3] {
        if !S::ROTATION {
            [0.0; 3]
        } else if S::PLANAR {
            [0.0, 0.0, self.velocity[place][2]]
        } else {
            self.spin[place].vector()
        }
    }

    /// Velocity of a body.
    #[inline(always)]
    pub fn velocity<S: Space>(&self, place: usize) -> [f64; 3] {
        let row = &self.velocity[place];
        [row[0], row[1], if S::PLANAR { 0.0 } else { row[2] }]
    }
}

impl Tile {
    /// Computes the forces of all contacts that this tile owns. `force` and `torque` are the rows of its bodies.
    pub fn evaluate(&mut self, level: &Level, at: &Evaluation<'_>, force: &mut [Row], torque: &mut [Row]) {
        self.tally.reset();
        for (row, mass) in force.iter_mut().zip(&at.bodies.mass[self.first..]) {
            *row = Row::new([mass * at.gravity[0], mass * at.gravity[1], mass * at.gravity[2]], 0.0);
        }
        torque.fill(Row::ZERO);
        self.outbox.fill(Outgoing::default());
        level.evaluate(self, at, force, torque);
    }

    #[inline(always)]
    pub(crate) fn evaluate_with<S: Space, T: crate::gather::Arithmetic>(
        &mut self,
        arena: &Arena<T>,
        at: &Evaluation<'_>,
        force: &mut [Row],
        torque: &mut [Row],
    ) {
        let mut batch = arena.batch();
        let own = self.first..self.first + self.len;
        let mut outgoing = 0u32;
        for index in 0..self.inner_ranges.len() {
            let range = self.inner_ranges[index];
            let composition = &at.compositions[range.composition as usize];
            let mut next = range.start as usize;
            let end = range.end as usize;
            while next < end {
                next = gather_pairs(
                    &mut batch,
                    &self.inner,
                    next..end,
                    &own,
                    &mut outgoing,
                    at,
                    composition.reach,
                );
                if batch.count > 0 {
                    self.pair_batch::<S, T>(&mut batch, arena, range.composition as usize, at, force, torque);
                }
            }
        }
        if !self.walls.ranges.is_empty() {
            self.wall_contacts::<S, T>(&mut batch, arena, at, force, torque);
        }
    }

    #[inline(always)]
    fn pair_batch<S: Space, T: crate::gather::Arithmetic>(
        &mut self,
        batch: &mut Batch<T>,
        arena: &Arena<T>,
        index: usize,
        at: &Evaluation<'_>,
        force: &mut [Row],
        torque: &mut [Row],
    ) {
        let composition = &at.compositions[index];
        let reads = composition.reads;
        let tangential = composition.writes.contains(granule_law_api::Columns::TANGENTIAL_FORCE);
        let own = self.first..self.first + self.len;
        batch.normalise();
        crate::gather::gather_kinematics::<S, T>(batch, &own, at.bodies, composition);
        batch.project(reads.contains(granule_law_api::Columns::TANGENTIAL_VELOCITY));
        let remembers = composition.history_width > 0;
        if remembers {
            self.history.load(batch, at.now);
        }
        let tally = at.ledger.then_some(&mut self.tally);
        batch.run(composition, &arena.stages[index], at.time_step, tally);
        if remembers {
            self.history.store(batch, at.now);
        }
        batch.assemble(tangential);
        self.tally.contacts += batch.count as u64;
        if at.overlap {
            self.tally.maximum_overlap = self.tally.maximum_overlap.max(batch.maximum_overlap());
        }
        let rolls = composition.writes.contains(granule_law_api::Columns::TORQUE);
        let force = &mut force[..self.len];
        for k in 0..batch.len() {
            let f = [batch.force[0][k], batch.force[1][k], batch.force[2][k]];
            let (mut on_i, mut on_j) = ([0.0; 3], [0.0; 3]);
            if S::ROTATION {
                for axis in 0..3 {
                    if tangential {
                        on_i[axis] = -batch.arm[0][k] * batch.turning[axis][k];
                        on_j[axis] = -batch.arm[1][k] * batch.turning[axis][k];
                    }
                    if rolls {
                        on_i[axis] += batch.contact_torque[axis][k].wide();
                        on_j[axis] -= batch.contact_torque[axis][k].wide();
                    }
                }
            }
            add::<S>(force, torque, batch.i[k] as usize, 1.0, f, on_i);
            if batch.outgoing[k] == OWN {
                add::<S>(force, torque, batch.j[k] as usize - self.first, -1.0, f, on_j);
            } else {
                let out = &mut self.outbox[batch.outgoing[k] as usize];
                *out = Outgoing { force: [-f[0], -f[1], -f[2]], torque: on_j };
            }
        }
    }

    /// Adds what other tiles have computed for the bodies of this one, in the order of those tiles.
    pub fn receive<S: Space>(inbox: &[Incoming], tiles: &[Tile], force: &mut [Row], torque: &mut [Row]) {
        for incoming in inbox {
            let from = &tiles[incoming.tile as usize].outbox[incoming.slot as usize];
            add::<S>(force, torque, incoming.body as usize, 1.0, from.force, from.torque);
        }
    }

    /// Heap bytes of the lists.
    pub fn bytes(&self) -> usize {
        self.outer.capacity() * size_of::<Pair>()
            + self.inner.capacity() * size_of::<Pair>()
            + self.inner_outer.capacity() * 4
            + self.history.values.capacity() * 8
            + self.history.stamp.capacity() * 4
            + self.outbox.capacity() * size_of::<Outgoing>()
            + self.inbox.capacity() * size_of::<Incoming>()
            + self.walls.bytes()
    }
}

/// Number of bodies in a tile for a run of `bodies` bodies. It must not depend on the number of threads.
pub(crate) fn tile_size(bodies: usize) -> usize {
    (bodies / 16).clamp(128, 1024)
}

/// The rows that a force evaluation reads.
pub(crate) fn shared(bodies: &Bodies) -> Shared<'_> {
    Shared { position: &bodies.position, velocity: &bodies.velocity, spin: &bodies.spin, mass: &bodies.mass }
}

const _: () = assert!(BATCH <= granule_law_api::CHUNK);
