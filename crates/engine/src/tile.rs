//! A tile: consecutive bodies, the pairs whose first body they are, and their forces.

use granule_law_api::{Columns, ContactEnd};
use granule_plan::{Composition, WallPlan};
use granule_state::{Bodies, Lanes, Portable, Row};

use crate::blame;
use crate::chunk::{BATCH, Batch};
use crate::gather::{Changes, find_contacts, gather_kinematics};
use crate::history::PairHistory;
use crate::level::{Arena, Arithmetic, Level};
use crate::list::ForceList;
use crate::records::{self, Record, Written};
use crate::resolve::{Impulse, Marks, Path, Resolver, StepRows, history_before};
use crate::scatter::{Sums, scatter};
use crate::space::Space;
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

impl Pair {
    /// Place of i within the tile.
    #[inline(always)]
    pub fn place(&self) -> usize {
        (self.i_image >> 5) as usize
    }
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
    pub force: Row,
    pub torque: Row,
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
    /// The inner pairs as the force loop reads them.
    pub list: ForceList,
    pub history: PairHistory,
    pub outbox: Vec<Outgoing>,
    pub inbox: Vec<Incoming>,
    pub walls: WallList,
    /// What contacts that begin or end within the step give besides their forces.
    pub impulses: Vec<Impulse>,
    /// Which pairs touched, for a scheme that wants to know.
    pub marks: Marks,
    /// What its contacts do, where somebody wants to see it.
    pub records: Vec<Record>,
    pub tally: Tally,
}

/// What a force evaluation needs besides the tile.
pub(crate) struct Evaluation<'a> {
    pub bodies: &'a Shared<'a>,
    pub compositions: &'a [Composition],
    /// Shift of the separation by image code.
    pub shifts: &'a [Row; 32],
    pub walls: &'a [MovedWall],
    pub wall_plans: &'a [WallPlan],
    pub gravity: [f64; 3],
    /// The radius of all bodies, if they have the same.
    pub radius: Option<f64>,
    pub time_step: f64,
    /// Number of this evaluation.
    pub now: u32,
    /// Energies are summed.
    pub ledger: bool,
    /// The largest overlap is sought.
    pub overlap: bool,
    /// What each contact does is kept.
    pub records: bool,
    /// The step whose contacts are resolved where they begin and end, if they are.
    pub resolved: Option<StepRows<'a>>,
    /// Pairs that touch are marked.
    pub marks: bool,
    /// Some force is not finite: the law at fault is sought.
    pub inquest: bool,
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
        self.begin(at);
        blame::among(self.first..self.first + self.len, || level.evaluate(self, at, force, torque));
    }

    fn begin(&mut self, at: &Evaluation<'_>) {
        self.tally.reset();
        self.impulses.clear();
        self.records.clear();
        if at.marks {
            self.marks.begin(self.inner.len(), self.inner_ranges.len());
        }
        // Pairs that do not touch leave their slots alone.
        self.outbox.fill(Outgoing::default());
    }

    #[inline(always)]
    pub(crate) fn evaluate_with<S: Space, T: Arithmetic, L: Lanes>(
        &mut self,
        arena: &Arena<T>,
        at: &Evaluation<'_>,
        force: &mut [Row],
        torque: &mut [Row],
    ) {
        self.contacts::<S, T, L>(arena, at, force, torque);
        // One sum over the bodies tells whether any of the contacts gave a number that is not finite.
        let rows = force[..self.len].iter().chain(torque.iter());
        let sum = rows.fold(L::splat(0.0), |sum, row| sum + L::load(&row.0));
        let mut row = Row::ZERO;
        sum.store(&mut row.0);
        if row.0.iter().any(|component| !component.is_finite()) {
            self.inquire::<S, T>(arena, at, force, torque);
        }
    }

    /// Evaluates once more, and blames the law whose force is not finite although all that it got is. If there is none, the
    /// input was at fault, which the integration tells.
    #[cold]
    #[inline(never)]
    fn inquire<S: Space, T: Arithmetic>(
        &mut self,
        arena: &Arena<T>,
        at: &Evaluation<'_>,
        force: &mut [Row],
        torque: &mut [Row],
    ) {
        // The histories of the first time are those of the step before.
        let again = Evaluation { inquest: true, now: at.now.wrapping_add(1), ..*at };
        self.begin(&again);
        self.contacts::<S, T, Portable>(arena, &again, force, torque);
    }

    #[inline(always)]
    fn contacts<S: Space, T: Arithmetic, L: Lanes>(
        &mut self,
        arena: &Arena<T>,
        at: &Evaluation<'_>,
        force: &mut [Row],
        torque: &mut [Row],
    ) {
        let mut batch = arena.batch();
        let own = self.first..self.first + self.len;
        let force = &mut force[..self.len];
        let gravity = L::load(&Row::new(at.gravity, 0.0).0);
        for (row, mass) in force.iter_mut().zip(&at.bodies.mass[own.clone()]) {
            (L::splat(*mass) * gravity).store(&mut row.0);
        }
        torque.fill(Row::ZERO);
        self.list.check_sums(force, torque, &self.outbox);
        for index in 0..self.inner_ranges.len() {
            let range = self.inner_ranges[index];
            let reach = at.compositions[range.composition as usize].reach;
            let mut next = range.start as usize;
            let end = range.end as usize;
            while next < end {
                let list = self.list.view(at.bodies);
                let pairs = (next, end);
                next = if at.marks {
                    let start = range.start as usize;
                    let margin = at.resolved.map_or(0.0, |rows| rows.margin);
                    let changes = Changes { start, marks: self.marks.of_range(index, start), margin };
                    find_contacts::<T, L, true>(&mut batch, &list, pairs, at, reach, Some(changes))
                } else {
                    find_contacts::<T, L, false>(&mut batch, &list, pairs, at, reach, None)
                };
                if !batch.parted.is_empty() {
                    self.part::<S, T>(&batch, arena, range.composition as usize, at);
                }
                if batch.count > 0 {
                    let sums = (&mut *force, &mut *torque);
                    self.pair_batch::<S, T, L>(&mut batch, arena, range.composition as usize, at, sums);
                }
            }
        }
        if !self.walls.ranges.is_empty() {
            self.wall_contacts::<S, T, L>(&mut batch, arena, at, force, torque);
        }
    }

    #[inline(always)]
    fn pair_batch<S: Space, T: Arithmetic, L: Lanes>(
        &mut self,
        batch: &mut Batch<T>,
        arena: &Arena<T>,
        index: usize,
        at: &Evaluation<'_>,
        (force, torque): (&mut [Row], &mut [Row]),
    ) {
        let composition = &at.compositions[index];
        gather_kinematics::<S, T, L>(batch, &self.list.view(at.bodies), at, composition);
        let remembers = composition.history_width > 0;
        if remembers {
            self.history.load::<T, L>(batch, at.now);
        }
        let tally = at.ledger.then_some(&mut self.tally);
        batch.run(composition, &arena.stages[index], at.time_step, tally);
        if at.inquest {
            let first = self.first as u32;
            blame::inquire(batch, composition, &arena.stages[index], at.time_step, |batch, k| {
                [Some(first + batch.i[k]), Some(batch.j[k])]
            });
        }
        if at.marks {
            self.resolve_touching::<S, T>(batch, arena, index, at);
        }
        if remembers {
            self.history.store::<T, L>(batch, at.now);
        }
        self.tally.contacts += batch.count as u64;
        if at.overlap {
            let largest = batch.maximum_overlap();
            self.tally.maximum_overlap = self.tally.maximum_overlap.max(largest);
            let relative = match at.radius {
                Some(radius) => largest / radius,
                None => batch.relative_overlap(&at.bodies.position[self.first..], at.bodies.position),
            };
            self.tally.relative_overlap = self.tally.relative_overlap.max(relative);
        }
        let tangential = composition.writes.contains(Columns::TANGENTIAL_FORCE);
        let rolls = composition.writes.contains(Columns::TORQUE);
        if at.records {
            let written = Written { tangential, torque: rolls };
            records::keep(&mut self.records, batch, self.first, false, written);
        }
        let mut sums = Sums { force, torque, outbox: &mut self.outbox };
        scatter::<S, T, L>(batch, &mut sums, tangential, rolls, at.radius.is_some());
    }

    /// Impulses of those pairs that touched at the beginning of the step and do not at its end.
    fn part<S: Space, T: Arithmetic>(
        &mut self,
        batch: &Batch<T>,
        arena: &Arena<T>,
        index: usize,
        at: &Evaluation<'_>,
    ) {
        let Some(rows) = &at.resolved else { return };
        let composition = &at.compositions[index];
        let Self { first, history, marks, impulses, tally, .. } = self;
        let mut single = arena.single();
        let mut laws = Resolver::new(&mut single, arena, index, at, impulses, tally);
        for parted in &batch.parted {
            // Without force, only what the contact still stores is lost.
            if marks.was_clipped(parted.pair) && !at.ledger {
                continue;
            }
            let (i, j) = (*first + parted.i as usize, parted.j as usize);
            let path = Path::of_bodies::<S>(at, rows, composition, (i, j), parted.separation.into());
            laws.ended(&path, history_before(history, parted.pair, at.now), (i as u32, Some(j as u32)));
        }
    }

    /// Resolves the contacts of a batch that have begun or come to the end of their force within the step.
    fn resolve_touching<S: Space, T: Arithmetic>(
        &mut self,
        batch: &mut Batch<T>,
        arena: &Arena<T>,
        index: usize,
        at: &Evaluation<'_>,
    ) {
        let composition = &at.compositions[index];
        let Self { first, history, marks, impulses, tally, .. } = self;
        let mut single = arena.single();
        let mut laws = Resolver::new(&mut single, arena, index, at, impulses, tally);
        let mut resolve = |batch: &mut Batch<T>, k: usize| {
            let Some(rows) = &at.resolved else { return };
            let (i, j) = (*first + batch.i[k] as usize, batch.j[k] as usize);
            let path = Path::of_bodies::<S>(at, rows, composition, (i, j), batch.separation_of(k));
            let before = history_before(history, batch.pair[k], at.now);
            laws.touching(batch, k, &path, before, (i as u32, Some(j as u32)));
        };
        if composition.contact_end == ContactEnd::Force {
            for k in 0..batch.len() {
                if batch.is_clipped(k) {
                    let pair = batch.pair[k];
                    marks.clip(pair);
                    if !marks.was_clipped(pair) {
                        resolve(batch, k);
                    }
                }
            }
        }
        for number in 0..batch.begun.len() {
            let k = batch.begun[number] as usize;
            // One that has begun and come to its end of force in the same step was resolved above.
            if composition.contact_end == ContactEnd::Overlap || !batch.is_clipped(k) {
                resolve(batch, k);
            }
        }
    }

    /// Adds what other tiles have computed for the bodies of this one, in the order of those tiles.
    #[inline(always)]
    pub fn receive<L: Lanes>(inbox: &[Incoming], tiles: &[Tile], force: &mut [Row], torque: &mut [Row]) {
        let add = |to: &mut Row, from: &Row| (L::load(&to.0) + L::load(&from.0)).store(&mut to.0);
        for incoming in inbox {
            let from = &tiles[incoming.tile as usize].outbox[incoming.slot as usize];
            add(&mut force[incoming.body as usize], &from.force);
            if let Some(torque) = torque.get_mut(incoming.body as usize) {
                add(torque, &from.torque);
            }
        }
    }

    /// Heap bytes of the lists.
    pub fn bytes(&self) -> usize {
        self.outer.capacity() * size_of::<Pair>()
            + self.inner.capacity() * size_of::<Pair>()
            + self.inner_outer.capacity() * 4
            + self.list.bytes()
            + self.history.bytes()
            + self.marks.bytes()
            + self.impulses.capacity() * size_of::<Impulse>()
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
