//! The engine: bodies fly freely from event to event.

use std::sync::Arc;

use granule_geometry::Cell;
use granule_law_api::CollisionRule;
use serde::{Deserialize, Serialize};

use crate::body::{Body, Identity, Period, Shell};
use crate::cells::Cells;
use crate::fault::{caught, watched};
use crate::look_ahead::Ahead;
use crate::neighbours::Neighbours;
use crate::queue::Calendar;
use crate::report::Counts;
use crate::setup::{EventError, Setup};
use crate::wall::HardWall;

/// Partners from here on are walls.
pub(crate) const WALLS: u32 = 0xFFFF_0000;
/// The body leaves its shell.
pub(crate) const SHELL: u32 = u32::MAX;
/// The flight must be looked at again.
pub(crate) const AGAIN: u32 = u32::MAX - 1;
/// Most walls that a number can name.
const MOST_WALLS: usize = 0xFF00;
/// Events within one contact duration, for each body and in all, before a run counts as stalled.
const STALL: (u64, u64) = (1000, 1_000_000);

/// What the next event of a body is.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Target {
    /// Body, wall, or one of the constants above.
    pub partner: u32,
    /// Number of the event at which this was predicted.
    pub made: u32,
    /// Number of the event at which the body itself last collided.
    pub changed: u32,
}

/// A rule, and whether it needs spins.
#[derive(Clone, Debug)]
pub(crate) struct Rule {
    pub rule: Arc<dyn CollisionRule>,
    pub rough: bool,
}

/// Choices that change the speed and, through round-off, the bits, but not the physics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Wanted number of neighbours in a list.
    pub neighbours: f64,
    /// How far shells are centred ahead of their body, as a share of their radius, below 1; `None` lets the mean free path
    /// decide.
    pub ahead: Option<f64>,
    /// Events a body between two renumberings.
    pub renumber_every: f64,
}

impl Default for Tuning {
    fn default() -> Self {
        Self { neighbours: 11.0, ahead: None, renumber_every: 100.0 }
    }
}

/// State of one body at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Identity.
    pub id: u32,
    /// Centre, inside the cell in periodic directions \[m\].
    pub position: [f64; 3],
    /// How often the body has crossed each periodic boundary.
    pub image: [i32; 3],
    /// Velocity \[m/s\].
    pub velocity: [f64; 3],
    /// Spin \[rad/s\]; as at the start if no rule is rough.
    pub spin: [f64; 3],
}

/// Hard bodies in motion.
///
/// Every body has a local time, up to which it has been moved, and one event in the queue: the earliest of what it will meet.
/// Times are relative to an epoch that moves along with every renumbering, so that they never grow large. Positions are
/// touched at events only, so the results do not depend on when somebody looks.
#[derive(Clone, Debug)]
pub struct EventEngine {
    pub(crate) cell: Cell,
    pub(crate) period: Period,
    pub(crate) gravity: [f64; 3],
    pub(crate) falls: bool,
    /// Frozen bodies among falling ones: relative flights are not straight.
    pub(crate) mixed: bool,
    pub(crate) walls: Vec<HardWall>,
    /// Rule of each wall and material.
    pub(crate) wall_rules: Vec<Option<u16>>,
    pub(crate) pairs: Vec<Option<u16>>,
    pub(crate) rules: Vec<Rule>,
    pub(crate) materials: usize,
    pub(crate) rotation: bool,
    pub(crate) contact_duration: f64,
    pub(crate) tuning: Tuning,

    pub(crate) bodies: Vec<Body>,
    pub(crate) identities: Vec<Identity>,
    /// Spins; empty unless some rule is rough.
    pub(crate) spins: Vec<[f64; 3]>,
    /// Spins at the start where they never change.
    pub(crate) idle_spins: Vec<(u32, [f64; 3])>,
    pub(crate) shells: Vec<Shell>,
    /// Time of the last collision; empty without a contact duration.
    pub(crate) last: Vec<f64>,
    pub(crate) queue: Calendar<Target>,
    pub(crate) neighbours: Neighbours,
    pub(crate) cells: Cells,
    /// Room for the neighbours that a search finds.
    pub(crate) found: Vec<u32>,
    /// Radius of shells over that of their body.
    pub(crate) margin: f64,
    /// How far they are centred ahead, as a share of their own radius.
    pub(crate) lead: f64,
    /// The largest reach \[m\], and whether all have it.
    pub(crate) largest_reach: f64,
    pub(crate) uniform: bool,
    /// Some bodies pass through each other.
    pub(crate) selective: bool,
    pub(crate) ahead: Ahead,
    /// Simulated time at which relative times are zero, and the relative time of the last event.
    pub(crate) epoch: f64,
    pub(crate) now: f64,
    pub(crate) counts: Counts,
    pub(crate) since: u64,
    pub(crate) window: (f64, u64),
}

impl EventEngine {
    /// Sets bodies in motion.
    ///
    /// # Errors
    /// See [`EventError`].
    pub fn new(setup: &Setup) -> Result<Self, EventError> {
        Self::with_tuning(setup, Tuning::default())
    }

    /// As [`new`](Self::new) with other choices for speed.
    ///
    /// # Errors
    /// See [`EventError`].
    pub fn with_tuning(setup: &Setup, tuning: Tuning) -> Result<Self, EventError> {
        check(setup)?;
        let walls = setup
            .walls
            .iter()
            .enumerate()
            .map(|(index, input)| HardWall::new(&input.wall, index))
            .collect::<Result<Vec<_>, _>>()?;
        let falls = setup.gravity != [0.0; 3];
        let frozen = setup.bodies.iter().any(|body| body.frozen);
        let used = |index: usize| {
            setup.pairs.contains(&Some(index))
                || setup.walls.iter().any(|wall| wall.rules.contains(&Some(index)))
        };
        let rules = watched(&setup.rules);
        let rotation = rules.iter().enumerate().any(|(index, rule)| rule.rough && used(index));
        let short = |rule: &Option<usize>| rule.and_then(|index| u16::try_from(index).ok());
        let count = setup.bodies.len();
        let mut engine = Self {
            cell: setup.cell,
            period: Period::new(setup.cell.period()),
            gravity: setup.gravity,
            falls,
            mixed: falls && frozen,
            wall_rules: setup.walls.iter().flat_map(|wall| wall.rules.iter().map(short)).collect(),
            walls,
            pairs: setup.pairs.iter().map(short).collect(),
            rules,
            materials: setup.materials,
            rotation,
            contact_duration: setup.contact_duration,
            tuning,
            bodies: Vec::with_capacity(count),
            identities: Vec::with_capacity(count),
            spins: Vec::new(),
            idle_spins: Vec::new(),
            shells: vec![Shell::default(); count],
            last: if setup.contact_duration > 0.0 { vec![f64::NEG_INFINITY; count] } else { Vec::new() },
            queue: Calendar::new(count, Target::default()),
            neighbours: Neighbours::default(),
            cells: Cells::default(),
            found: Vec::new(),
            margin: 0.0,
            lead: 0.0,
            largest_reach: 0.0,
            uniform: false,
            selective: setup.pairs.iter().any(Option::is_none),
            ahead: Ahead::default(),
            epoch: 0.0,
            now: 0.0,
            counts: Counts::default(),
            since: 0,
            window: (0.0, 0),
        };
        for input in &setup.bodies {
            let velocity = if input.frozen { [0.0; 3] } else { input.velocity };
            engine.bodies.push(Body { position: input.position, time: 0.0, velocity, radius: input.radius });
            engine.identities.push(Identity {
                inverse_mass: if input.frozen { 0.0 } else { 1.0 / input.mass },
                inertia_factor: input.inertia_factor,
                id: input.id,
                material: input.material,
                image: [0; 3],
            });
            if rotation {
                engine.spins.push(if input.frozen { [0.0; 3] } else { input.spin });
            } else if input.spin != [0.0; 3] {
                engine.idle_spins.push((input.id, input.spin));
            }
        }
        engine.idle_spins.sort_unstable_by_key(|(id, _)| *id);
        engine.renumber();
        engine.counts.renumbered = 0;
        engine.check_overlaps()?;
        Ok(engine)
    }

    /// Identity of a body.
    fn id(&self, body: u32) -> u32 {
        self.identities[body as usize].id
    }

    /// Simulated time of the last event \[s\].
    pub fn time(&self) -> f64 {
        self.epoch + self.now
    }

    /// What happened so far.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// True without bodies.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// True if spins exist.
    pub fn has_rotation(&self) -> bool {
        self.rotation
    }

    /// Bytes of state.
    pub fn bytes(&self) -> usize {
        self.bodies.capacity() * size_of::<Body>()
            + self.identities.capacity() * size_of::<Identity>()
            + self.spins.capacity() * size_of::<[f64; 3]>()
            + self.shells.capacity() * size_of::<Shell>()
            + self.last.capacity() * size_of::<f64>()
            + self.queue.bytes()
            + self.neighbours.bytes()
            + self.cells.bytes()
    }

    /// Events up to a simulated time \[s\], but no more than `most`. True if all of them have happened.
    ///
    /// # Errors
    /// [`EventError::NotFinite`] and [`EventError::Stalled`].
    pub fn advance(&mut self, until: f64, most: u64) -> Result<bool, EventError> {
        // Events are numbered anew each time, in 32 bits.
        let every = (self.tuning.renumber_every * self.bodies.len() as f64).max(10_000.0).min(4e9) as u64;
        for _ in 0..most {
            if self.since >= every {
                self.renumber();
            }
            let Some((time, _)) = self.queue.first() else { return Ok(true) };
            if time > until - self.epoch {
                return Ok(true);
            }
            self.step()?;
        }
        Ok(false)
    }

    /// As many collisions as asked for, or fewer if the bodies run out of events.
    ///
    /// # Errors
    /// As for [`advance`](Self::advance).
    pub fn advance_collisions(&mut self, collisions: u64) -> Result<(), EventError> {
        let end = self.counts.all().saturating_add(collisions);
        while self.counts.all() < end {
            let before = self.counts.all();
            let left = end - before;
            if self.advance(f64::INFINITY, left)? && self.queue.first().is_none() {
                break;
            }
        }
        Ok(())
    }

    fn step(&mut self) -> Result<(), EventError> {
        let Some((time, body, target)) = self.queue.pop() else { return Ok(()) };
        self.look_ahead();
        self.now = time;
        self.since += 1;
        if time - self.window.0 > self.contact_duration {
            self.window = (time, 0);
        }
        self.window.1 += 1;
        let limit = STALL.0 * self.bodies.len() as u64 + STALL.1;
        if self.window.1 > limit {
            let (time, id) = (self.time(), self.id(body));
            return Err(EventError::Stalled { time, id, events: limit, span: self.contact_duration });
        }
        match target.partner {
            SHELL => {
                self.relist(body, time);
                self.predict(body, time);
            }
            AGAIN => self.predict(body, time),
            wall if wall >= WALLS => {
                let wall = (wall - WALLS) as usize;
                let met = |engine: &Self| (engine.id(body), Err(wall), engine.time());
                caught(self, |engine| engine.hit_wall(body, wall, time), met)?;
                self.predict(body, time);
            }
            other if self.queue.event(other).1.changed > target.made => {
                self.counts.void += 1;
                self.predict(body, time);
            }
            other => {
                let met = |engine: &Self| (engine.id(body), Ok(engine.id(other)), engine.time());
                caught(self, |engine| engine.collide(body, other, time), met)?;
                self.predict(body, time);
                self.predict(other, time);
            }
        }
        Ok(())
    }

    /// Position and velocity of a body at a relative time.
    #[inline(always)]
    pub(crate) fn at(&self, body: u32, time: f64) -> ([f64; 3], [f64; 3]) {
        let Body { position, time: local, velocity, .. } = self.bodies[body as usize];
        let dt = time - local;
        if !self.falls || (self.mixed && self.identities[body as usize].inverse_mass == 0.0) {
            return (std::array::from_fn(|k| position[k] + dt * velocity[k]), velocity);
        }
        let g = self.gravity;
        (
            std::array::from_fn(|k| position[k] + dt * (velocity[k] + 0.5 * dt * g[k])),
            std::array::from_fn(|k| velocity[k] + dt * g[k]),
        )
    }

    /// Moves a body to a relative time.
    #[inline(always)]
    pub(crate) fn bring(&mut self, body: u32, time: f64) {
        let (position, velocity) = self.at(body, time);
        let record = &mut self.bodies[body as usize];
        (record.position, record.velocity, record.time) = (position, velocity, time);
    }

    /// All bodies at a simulated time \[s\], which must not be before the last event nor after the next, in the order of
    /// their identities.
    pub fn states(&self, time: f64) -> Vec<BodyState> {
        let relative = time - self.epoch;
        let mut states: Vec<BodyState> = (0..self.bodies.len() as u32)
            .map(|body| {
                let identity = &self.identities[body as usize];
                let (position, velocity) = self.at(body, relative);
                let (position, turns) = self.cell.wrap(position);
                let image = std::array::from_fn(|k| identity.image[k].saturating_add(turns[k]));
                let idle = || {
                    let found = self.idle_spins.binary_search_by_key(&identity.id, |(id, _)| *id);
                    found.map_or([0.0; 3], |index| self.idle_spins[index].1)
                };
                let spin = self.spins.get(body as usize).copied().unwrap_or_else(idle);
                BodyState { id: identity.id, position, image, velocity, spin }
            })
            .collect();
        states.sort_unstable_by_key(|state| state.id);
        states
    }

    /// Kinetic energy of translation and of rotation at a simulated time \[J\].
    pub fn kinetic_energy(&self, time: f64) -> (f64, f64) {
        let mut sums = (0.0, 0.0);
        for (body, identity) in self.identities.iter().enumerate() {
            if identity.inverse_mass == 0.0 {
                continue;
            }
            let mass = 1.0 / identity.inverse_mass;
            let (_, v) = self.at(body as u32, time - self.epoch);
            sums.0 += 0.5 * mass * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
            if let Some(w) = self.spins.get(body) {
                let radius = self.bodies[body].radius;
                let inertia = identity.inertia_factor * mass * radius * radius;
                sums.1 += 0.5 * inertia * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
            }
        }
        sums
    }

    /// Rule of two bodies.
    #[inline]
    pub(crate) fn rule_of(&self, a: u32, b: u32) -> Option<u16> {
        let material = |body: u32| usize::from(self.identities[body as usize].material);
        self.pairs[material(a) * self.materials + material(b)]
    }

    /// Gives a body its next event.
    #[inline]
    fn predict(&mut self, body: u32, time: f64) {
        let (event, partner) = self.next(body, time);
        let made = self.since as u32;
        let target = self.queue.payload_mut(body);
        (target.partner, target.made) = (partner, made);
        self.queue.schedule(body, event);
    }

    /// Begins a new window of the guard against stalling, with relative times that begin at zero.
    pub(crate) fn reset_window(&mut self, shift: f64) {
        self.window.0 -= shift;
    }
}

pub(crate) fn check(setup: &Setup) -> Result<(), EventError> {
    let input = |message: &str| Err(EventError::Input(message.to_string()));
    let materials = setup.materials;
    if setup.bodies.len() >= WALLS as usize || setup.walls.len() > MOST_WALLS || setup.rules.len() > 0xFFFF {
        return input("more bodies, walls or rules than can be numbered");
    }
    let known = |rule: &Option<usize>| rule.is_none_or(|index| index < setup.rules.len());
    if setup.pairs.len() != materials * materials
        || setup.walls.iter().any(|wall| wall.rules.len() != materials || !wall.rules.iter().all(known))
        || !setup.pairs.iter().all(known)
    {
        return input("the tables of rules do not fit the materials");
    }
    if setup.bodies.iter().any(|body| usize::from(body.material) >= materials) {
        return input("a body has an unknown material");
    }
    let t_c = setup.contact_duration;
    if !(t_c >= 0.0 && t_c.is_finite()) {
        return input("the contact duration must be at least 0 and finite");
    }
    let moving =
        setup.walls.iter().any(|wall| !wall.wall.keeps_its_place() || HardWall::is_hollow(&wall.wall));
    let inelastic = setup.rules.iter().any(|rule| rule.is_inelastic());
    if t_c == 0.0 && (inelastic || moving || setup.gravity != [0.0; 3]) {
        return input(
            "a contact duration greater than 0 is needed: with inelastic collisions, gravity, moving or hollow walls there can be \
             infinitely many collisions in a finite time",
        );
    }
    for body in &setup.bodies {
        let numbers = body.position.iter().chain(&body.velocity).chain(&body.spin).chain(&setup.gravity);
        if numbers.into_iter().any(|x| !x.is_finite()) {
            return Err(EventError::NotFinite { id: body.id, time: 0.0 });
        }
        let positive = |x: f64| x > 0.0 && x.is_finite();
        if !(positive(body.radius) && positive(body.mass) && positive(body.inertia_factor)) {
            return input("radius, mass and inertia factor must be greater than 0 and finite");
        }
    }
    let largest = setup.bodies.iter().fold(0.0, |r: f64, body| r.max(body.radius));
    setup
        .cell
        .check_minimum_length(largest, 0.04 * largest)
        .map_err(|error| EventError::Cell(error.to_string()))
}
