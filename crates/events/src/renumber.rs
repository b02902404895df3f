//! Shells, lists and the order of bodies in memory.

use crate::body::{Body, dot};
use crate::engine::{EventEngine, Target};
use crate::look_ahead::Ahead;
use crate::setup::EventError;

/// Largest and smallest radius of a shell over that of its body.
const MARGINS: (f64, f64) = (0.08, 4.0);
/// Overlap at the start that counts as round-off, as a share of the smaller radius.
const ROUND_OFF: f64 = 1e-9;

impl EventEngine {
    /// Brings all bodies to the time of the last event, which becomes the epoch, and into an order in memory that follows
    /// their places; makes lists and predictions anew.
    pub(crate) fn renumber(&mut self) {
        let now = self.now;
        for body in 0..self.bodies.len() as u32 {
            self.bring(body, now);
            self.wrap(body);
            self.bodies[body as usize].time = 0.0;
        }
        for last in &mut self.last {
            *last -= now;
        }
        self.reset_window(now);
        self.epoch += now;
        self.now = 0.0;
        self.since = 0;
        self.counts.renumbered += 1;
        let (lo, hi) = self.bounds();
        self.sort(lo, hi);
        self.choose_margin(lo, hi);
        let frozen = |engine: &Self, body: usize| engine.identities[body].inverse_mass == 0.0;
        let (mut reach, mut least) = (0.0f64, f64::INFINITY);
        for body in 0..self.bodies.len() {
            let margin = if frozen(self, body) { 0.0 } else { self.margin };
            let radius = self.bodies[body].radius;
            self.shells[body].reach = radius + margin * radius;
            reach = reach.max(self.shells[body].reach);
            least = least.min(self.shells[body].reach);
        }
        (self.largest_reach, self.uniform) = (reach, least == reach);
        self.cells.reset(lo, hi, self.cell.periodic(), 2.0 * reach, self.bodies.len());
        self.neighbours.reset(self.bodies.len());
        for body in 0..self.bodies.len() as u32 {
            self.place(body);
            self.find(body);
            for &other in &self.found {
                self.neighbours.join(body, other);
            }
            self.cells.insert(body, self.shells[body as usize].centre);
            *self.queue.payload_mut(body) = Target::default();
        }
        let mut times = Vec::with_capacity(self.bodies.len());
        for body in 0..self.bodies.len() as u32 {
            let (time, partner) = self.next(body, 0.0);
            self.queue.payload_mut(body).partner = partner;
            times.push(time);
        }
        self.queue.fill(&times);
        self.ahead = Ahead::default();
    }

    /// A body is about to leave its shell: a new one, and new neighbours.
    pub(crate) fn relist(&mut self, body: u32, time: f64) {
        self.bring(body, time);
        self.wrap(body);
        self.counts.relisted += 1;
        self.cells.remove(body);
        self.place(body);
        self.find(body);
        self.neighbours.replace(body, &self.found);
        self.cells.insert(body, self.shells[body as usize].centre);
    }

    /// True if a body whose shell has this centre, and all its neighbours, are in the image of the centre.
    #[inline]
    pub(crate) fn is_inside(&self, centre: [f64; 3]) -> bool {
        let lo = self.cell.lo();
        let length = self.period.length();
        // To the centre of a neighbour's shell, and from there to the neighbour.
        let reach = 3.0 * self.largest_reach;
        (0..3)
            .all(|k| length[k] == 0.0 || (centre[k] - lo[k] > reach && lo[k] + length[k] - centre[k] > reach))
    }

    /// Into the cell, in periodic directions.
    fn wrap(&mut self, body: u32) {
        let record = &mut self.bodies[body as usize];
        let (position, turns) = self.cell.wrap(record.position);
        if turns != [0; 3] {
            record.position = position;
            let image = &mut self.identities[body as usize].image;
            for k in 0..3 {
                image[k] = image[k].saturating_add(turns[k]);
            }
        }
    }

    /// Centres the shell of a body ahead of it.
    fn place(&mut self, body: u32) {
        let Body { position, velocity, radius, .. } = self.bodies[body as usize];
        let shell = &mut self.shells[body as usize];
        let speed = dot(velocity, velocity).sqrt();
        let lead = if speed > 0.0 { self.lead * (shell.reach - radius) / speed } else { 0.0 };
        let centre = std::array::from_fn(|k| position[k] + lead * velocity[k]);
        shell.centre = self.cell.wrap(centre).0;
    }

    /// Finds the bodies in the grid that a body may touch: those whose shells meet its own.
    fn find(&mut self, body: u32) {
        let shell = self.shells[body as usize];
        let frozen = self.identities[body as usize].inverse_mass == 0.0;
        let selective = self.mixed || frozen || self.selective;
        let mut found = std::mem::take(&mut self.found);
        self.cells.around(shell.centre, shell.reach + self.largest_reach, &mut found);
        if selective || !self.uniform {
            found.retain(|&other| {
                let there = &self.shells[other as usize];
                let d = self.period.nearest(std::array::from_fn(|k| shell.centre[k] - there.centre[k]));
                let reach = shell.reach + there.reach;
                let both_frozen = frozen && self.identities[other as usize].inverse_mass == 0.0;
                dot(d, d) < reach * reach && !both_frozen && self.rule_of(body, other).is_some()
            });
        }
        self.found = found;
    }

    /// The cell in periodic directions, and where the bodies are in the others.
    fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        let mut lo = [f64::INFINITY; 3];
        let mut hi = [f64::NEG_INFINITY; 3];
        for body in &self.bodies {
            for k in 0..3 {
                lo[k] = lo[k].min(body.position[k] - body.radius);
                hi[k] = hi[k].max(body.position[k] + body.radius);
            }
        }
        let periodic = self.cell.periodic();
        for k in 0..3 {
            if periodic[k] {
                (lo[k], hi[k]) = (self.cell.lo()[k], self.cell.hi()[k]);
            }
        }
        (lo, hi)
    }

    /// Sorts bodies along a space-filling curve.
    fn sort(&mut self, lo: [f64; 3], hi: [f64; 3]) {
        let longest = (0..3).fold(0.0, |l: f64, k| l.max(hi[k] - lo[k]));
        let scale = if longest > 0.0 { 65_535.0 / longest } else { 0.0 };
        let mut keys: Vec<(u64, u32)> = self
            .bodies
            .iter()
            .enumerate()
            .map(|(body, record)| {
                let cell = |k: usize| spread(((record.position[k] - lo[k]) * scale) as u64);
                (cell(0) | cell(1) << 1 | cell(2) << 2, body as u32)
            })
            .collect();
        // By place, then by the order before, which is the same in every run.
        keys.sort_unstable();
        let order: Vec<u32> = keys.into_iter().map(|(_, body)| body).collect();
        gather(&mut self.bodies, &order);
        gather(&mut self.identities, &order);
        gather(&mut self.spins, &order);
        gather(&mut self.last, &order);
    }

    /// Shells so large that lists have the wanted length at the mean density.
    fn choose_margin(&mut self, lo: [f64; 3], hi: [f64; 3]) {
        let count = self.bodies.len().max(1) as f64;
        let largest = self.bodies.iter().fold(0.0, |r: f64, body| r.max(body.radius));
        let thin = (0..3).filter(|&k| hi[k] - lo[k] <= 2.0 * largest * (1.0 + 1e-9)).count();
        let dimensions = 3usize.saturating_sub(thin).max(1) as i32;
        let room: f64 =
            (0..3).filter(|&k| hi[k] - lo[k] > 2.0 * largest * (1.0 + 1e-9)).map(|k| hi[k] - lo[k]).product();
        let ball = match dimensions {
            3 => 4.0 / 3.0 * std::f64::consts::PI,
            2 => std::f64::consts::PI,
            _ => 2.0,
        };
        let filled: f64 =
            self.bodies.iter().map(|body| ball * body.radius.powi(dimensions)).sum::<f64>() / room;
        // A body has 2^d φ (1 + m)^d others within twice its reach.
        let wanted = self.tuning.neighbours / (filled * 2.0f64.powi(dimensions));
        let margin = wanted.powf(1.0 / f64::from(dimensions)) - 1.0;
        let margin = if margin.is_finite() { margin } else { MARGINS.1 };
        let mut margin = margin.max(MARGINS.0).min(MARGINS.1);
        // Few bodies know each other anyway.
        if count < 32.0 {
            margin = margin.max(1.0);
        }
        // Bodies whose shells meet are no farther from each other than 2 R + 4 m R, of which half a period must be more: the
        // nearest image is then the one that they may touch.
        for period in self.period.length() {
            if period > 0.0 {
                margin = margin.min((0.124 * period / largest - 0.5).max(1e-3));
            }
        }
        self.margin = margin;
        // Who flies far without a collision crosses its shell from one end to the other.
        let phi = filled.min(0.6).max(1e-9);
        let contact_value = (1.0 - 0.5 * phi) / (1.0 - phi).powi(3);
        let free_path = 1.0 / (3.0 * std::f64::consts::SQRT_2 * phi * contact_value);
        let share = free_path / (free_path + 0.5 * margin);
        self.lead = self.tuning.ahead.unwrap_or(if share.is_finite() { share.min(0.85) } else { 0.0 });
    }

    /// Refuses bodies that overlap by more than round-off.
    pub(crate) fn check_overlaps(&self) -> Result<(), EventError> {
        for a in 0..self.bodies.len() as u32 {
            let (one, radius) = (self.identities[a as usize], self.bodies[a as usize].radius);
            let mut worst: Option<(u32, f64)> = None;
            self.neighbours.each(a, |b| {
                let (x, y) = (self.bodies[a as usize].position, self.bodies[b as usize].position);
                let r = self.period.nearest(std::array::from_fn(|k| x[k] - y[k]));
                let other = self.bodies[b as usize].radius;
                let overlap = radius + other - dot(r, r).sqrt();
                if overlap > ROUND_OFF * radius.min(other) && worst.is_none_or(|(_, most)| overlap > most) {
                    worst = Some((self.identities[b as usize].id, overlap));
                }
            });
            if let Some((other, overlap)) = worst {
                return Err(EventError::Overlap { id: one.id, other: Ok(other), overlap });
            }
            for (index, wall) in self.walls.iter().enumerate() {
                let known = self.wall_rules[index * self.materials + usize::from(one.material)].is_some();
                let overlap = radius - wall.distance(self.bodies[a as usize].position, 0.0);
                if known && one.inverse_mass > 0.0 && overlap > ROUND_OFF * radius {
                    return Err(EventError::Overlap { id: one.id, other: Err(index), overlap });
                }
            }
        }
        Ok(())
    }

    /// Mean number of neighbours in a list.
    pub fn mean_neighbours(&self) -> f64 {
        self.neighbours.mean()
    }
}

/// Spreads the lowest 16 bits to every third place.
fn spread(x: u64) -> u64 {
    let mut x = x & 0xFFFF;
    x = (x | x << 32) & 0x001F_0000_0000_FFFF;
    x = (x | x << 16) & 0x001F_0000_FF00_00FF;
    x = (x | x << 8) & 0x100F_00F0_0F00_F00F;
    x = (x | x << 4) & 0x10C3_0C30_C30C_30C3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

fn gather<T: Copy>(column: &mut Vec<T>, order: &[u32]) {
    if !column.is_empty() {
        *column = order.iter().map(|&from| column[from as usize]).collect();
    }
}
