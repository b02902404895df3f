//! Which bodies a body may meet soon: shells, a grid of them, and mutual lists.

use super::engine::{RollingEngine, SHELL};
use super::plate::{Vector, dot, size, sum};
use crate::body::Shell;
use crate::setup::EventError;

/// Wanted number of neighbours in a list.
const NEIGHBOURS: f64 = 9.0;
/// Least and largest radius of a shell over that of the largest body, less 1.
const MARGINS: (f64, f64) = (0.1, 8.0);
/// Bodies may overlap by this share of a radius at the start, which is round-off.
const ROUND_OFF: f64 = 1e-10;
/// A body that is closer to the rim of its shell than this share of its room gets a new one.
const RIM: f64 = 0.05;

impl RollingEngine {
    /// Shells, neighbours and first events.
    pub(super) fn prepare(&mut self) -> Result<(), EventError> {
        let count = self.fixed.len();
        let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let mut largest: f64 = 0.0;
        let mut filled = 0.0;
        for body in 0..count as u32 {
            let (place, radius) = (self.motion(body, 0.0).place, self.fixed[body as usize].radius);
            for k in 0..2 {
                lo[k] = lo[k].min(place[k] - radius);
                hi[k] = hi[k].max(place[k] + radius);
            }
            largest = largest.max(radius);
            filled += std::f64::consts::PI * radius * radius;
        }
        let periodic = self.cell.periodic();
        for k in 0..2 {
            if periodic[k] {
                (lo[k], hi[k]) = (self.cell.lo()[k], self.cell.hi()[k]);
            }
        }
        (lo[2], hi[2]) = (0.0, 0.0);
        if count == 0 {
            (lo, hi) = ([0.0; 3], [1.0, 1.0, 0.0]);
        }
        // A body has 4 φ (1 + m)² others within twice its reach.
        let share = filled / ((hi[0] - lo[0]) * (hi[1] - lo[1]));
        let margin = (NEIGHBOURS / (4.0 * share)).sqrt() - 1.0;
        let margin = if margin.is_finite() { margin } else { MARGINS.1 };
        let mut margin = margin.max(MARGINS.0).min(MARGINS.1);
        // Bodies whose shells meet are no farther from each other than 2 R + 4 m R, of which half a period must be more: the
        // nearest image is then the one that they may touch.
        for period in self.period.length() {
            if period > 0.0 {
                margin = margin.min((0.124 * period / largest - 0.5).max(1e-3));
            }
        }
        for (shell, fixed) in self.shells.iter_mut().zip(&self.fixed) {
            shell.reach = fixed.radius + margin * largest;
        }
        let widest = (1.0 + margin) * largest;
        self.largest_reach = widest;
        self.cells.reset(lo, hi, [periodic[0], periodic[1], false], 2.0 * widest, count);
        self.neighbours.reset(count);
        for body in 0..count as u32 {
            self.wrap(body);
            self.place(body, 0.0);
            self.find(body);
            for &other in &self.found {
                self.neighbours.join(body, other);
            }
            self.cells.insert(body, self.shells[body as usize].centre);
        }
        self.check_overlaps()?;
        let mut times = Vec::with_capacity(count);
        for body in 0..count as u32 {
            let (time, partner, seen) = self.next(body, 0.0);
            let aim = self.queue.payload_mut(body);
            (aim.partner, aim.seen) = (partner, seen);
            times.push(time);
        }
        self.queue.fill(&times);
        Ok(())
    }

    /// A body may be about to leave its shell: if so a new one, and new neighbours.
    pub(super) fn relist(&mut self, body: u32, time: f64) {
        let Shell { centre, reach } = self.shells[body as usize];
        let room = reach - self.fixed[body as usize].radius;
        let place = self.motion(body, time).place;
        let d = self.period.nearest([place[0] - centre[0], place[1] - centre[1], 0.0]);
        if size([d[0], d[1]]) < (1.0 - RIM) * room {
            return;
        }
        self.counts.relisted += 1;
        self.wrap(body);
        self.cells.remove(body);
        self.place(body, time);
        self.find(body);
        self.neighbours.replace(body, &self.found);
        self.cells.insert(body, self.shells[body as usize].centre);
    }

    /// Time that a body certainly stays in its shell, with a share of `most` of the motion of the plate \[s\].
    pub(super) fn stay(&self, body: u32, place: Vector, velocity: Vector) -> f64 {
        let path = &self.paths[body as usize];
        let Shell { centre, reach } = self.shells[body as usize];
        let d = self.period.nearest([place[0] - centre[0], place[1] - centre[1], 0.0]);
        let gap = (reach - self.fixed[body as usize].radius - size([d[0], d[1]])).max(0.0);
        let speed = size(velocity);
        let pull = size(path.acceleration) + path.share * self.plate.most_acceleration;
        // No path is longer than speed h + pull h²/2.
        let stay = 2.0 * gap / (speed + (speed * speed + 2.0 * pull * gap).sqrt());
        if stay.is_nan() { f64::INFINITY } else { stay }
    }

    /// Into the cell, in periodic directions.
    fn wrap(&mut self, body: u32) {
        let time = self.now;
        let fixed = self.fixed[body as usize];
        let place = self.motion(body, time).place;
        let (wrapped, turns) = self.cell.wrap([place[0], place[1], fixed.height]);
        if turns != [0; 3] {
            let path = &mut self.paths[body as usize].place;
            let fixed = &mut self.fixed[body as usize];
            for k in 0..2 {
                path[k] += wrapped[k] - place[k];
                fixed.image[k] = fixed.image[k].saturating_add(turns[k]);
            }
        }
    }

    /// Centres the shell of a body ahead of it.
    fn place(&mut self, body: u32, time: f64) {
        let motion = self.motion(body, time);
        let height = self.height();
        let shell = &mut self.shells[body as usize];
        let speed = size(motion.velocity);
        let room = shell.reach - self.fixed[body as usize].radius;
        let lead = if speed > 0.0 { 0.3 * room / speed } else { 0.0 };
        let centre = sum(motion.place, lead, motion.velocity);
        let [x, y, _] = self.cell.wrap([centre[0], centre[1], height]).0;
        shell.centre = [x, y, 0.0];
    }

    /// Finds the bodies in the grid that a body may touch: those whose shells meet its own.
    fn find(&mut self, body: u32) {
        let shell = self.shells[body as usize];
        let frozen = self.fixed[body as usize].inverse_mass == 0.0;
        let mut found = std::mem::take(&mut self.found);
        self.cells.around(shell.centre, shell.reach + self.largest_reach, &mut found);
        found.retain(|&other| {
            let there = &self.shells[other as usize];
            let d = self.period.nearest(std::array::from_fn(|k| shell.centre[k] - there.centre[k]));
            let reach = shell.reach + there.reach;
            let both_frozen = frozen && self.fixed[other as usize].inverse_mass == 0.0;
            dot([d[0], d[1]], [d[0], d[1]]) < reach * reach
                && !both_frozen
                && self.rule_of(body, other).is_some()
                && self.contact(body, other) > 0.0
        });
        self.found = found;
    }

    /// Squared distance along the plate at which two bodies touch, at most 0 if they never do \[m²\].
    #[inline]
    pub(super) fn contact(&self, a: u32, b: u32) -> f64 {
        let (a, b) = (&self.fixed[a as usize], &self.fixed[b as usize]);
        let (reach, step) = (a.radius + b.radius, a.height - b.height);
        reach * reach - step * step
    }

    /// Refuses bodies that overlap by more than round-off.
    fn check_overlaps(&self) -> Result<(), EventError> {
        for a in 0..self.fixed.len() as u32 {
            let one = &self.fixed[a as usize];
            let here = self.motion(a, 0.0).place;
            let mut worst: Option<(u32, f64)> = None;
            self.neighbours.each(a, |b| {
                let other = &self.fixed[b as usize];
                let there = self.motion(b, 0.0).place;
                let r = self.period.nearest([here[0] - there[0], here[1] - there[1], 0.0]);
                let rise = one.height - other.height;
                let overlap = one.radius + other.radius - (r[0] * r[0] + r[1] * r[1] + rise * rise).sqrt();
                if overlap > ROUND_OFF * one.radius.min(other.radius)
                    && worst.is_none_or(|(_, most)| overlap > most)
                {
                    worst = Some((other.id, overlap));
                }
            });
            if let Some((other, overlap)) = worst {
                return Err(EventError::Overlap { id: one.id, other: Ok(other), overlap });
            }
            for (index, wall) in self.walls.iter().enumerate() {
                let known = self.wall_rules[index * self.materials + usize::from(one.material)].is_some();
                let overlap = one.radius - wall.gap(here, 0.0).0;
                if known && one.inverse_mass > 0.0 && overlap > ROUND_OFF * one.radius {
                    return Err(EventError::Overlap { id: one.id, other: Err(index), overlap });
                }
            }
        }
        Ok(())
    }

    /// Gives a body its next event.
    pub(super) fn predict(&mut self, body: u32, time: f64) {
        let (event, partner, seen) = self.next(body, time);
        let aim = self.queue.payload_mut(body);
        (aim.partner, aim.seen) = (partner, seen);
        self.queue.schedule(body, event);
    }

    /// Relative time, partner if it is the shell.
    pub(super) fn least(
        &self,
        body: u32,
        place: Vector,
        velocity: Vector,
        horizon: f64,
        partner: u32,
    ) -> (f64, u32) {
        let stay = self.stay(body, place, velocity);
        if stay < horizon { (stay, SHELL) } else { (horizon, partner) }
    }
}
