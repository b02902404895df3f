//! Collisions as they happen: rules, the contact-duration model, sums.

use granule_law_api::{Collided, CollidingBody, collide};

use crate::body::dot;
use crate::engine::EventEngine;
use crate::setup::EventError;

/// Speed after which a resting body comes back, over its pull times the contact duration: a flight of 0.9 contact durations,
/// so that the bounces of a body at rest count as overlapping.
const REST: f64 = 0.45;

impl EventEngine {
    /// Two bodies touch at a relative time.
    pub(crate) fn collide(&mut self, a: u32, b: u32, time: f64) -> Result<(), EventError> {
        self.bring(a, time);
        self.bring(b, time);
        let (one, two) = (a as usize, b as usize);
        let (x, y) = (self.bodies[one].position, self.bodies[two].position);
        let r = self.period.nearest(std::array::from_fn(|k| x[k] - y[k]));
        let distance = dot(r, r).sqrt();
        let normal = r.map(|c| c / distance);
        let Some(index) = self.rule_of(a, b) else { return Ok(()) };
        let (mut first, mut second) = (self.colliding(one), self.colliding(two));
        // Only a body that cannot fall can carry another one.
        let pull = match (self.mixed, first.inverse_mass == 0.0, second.inverse_mass == 0.0) {
            (true, false, true) => -dot(self.gravity, normal),
            (true, true, false) => dot(self.gravity, normal),
            _ => 0.0,
        };
        let least = REST * self.contact_duration * pull.max(0.0);
        let elastic = self.is_overlapping(one, time) || self.is_overlapping(two, time);
        let rule = &self.rules[usize::from(index)];
        let done = collide(&*rule.rule, rule.rough, normal, &mut first, &mut second, elastic, least);
        match done {
            Some(done) => {
                self.counts.collisions += 1;
                self.counts.virial += done.impulse.normal * distance;
                self.account(&done, least);
            }
            None if pull > 0.0 => {
                self.lift(&mut first, &mut second, normal, least);
                self.counts.collisions += 1;
            }
            None => return Ok(()),
        }
        self.finish(one, &first, time)?;
        self.finish(two, &second, time)?;
        if elastic {
            self.note_overlapping(time);
        }
        Ok(())
    }

    /// A body reaches a wall at a relative time.
    pub(crate) fn hit_wall(&mut self, body: u32, wall: usize, time: f64) -> Result<(), EventError> {
        self.bring(body, time);
        let one = body as usize;
        let material = usize::from(self.identities[one].material);
        let Some(index) = self.wall_rules[wall * self.materials + material] else { return Ok(()) };
        let (position, radius) = (self.bodies[one].position, self.bodies[one].radius);
        let absolute = self.epoch + time;
        let surface = &self.walls[wall];
        let (_, normal) = surface.contact(position, absolute);
        let contact = std::array::from_fn(|k| position[k] - radius * normal[k]);
        let velocity = surface.velocity(contact, absolute);
        let pull = surface.pull((position, self.bodies[one].velocity, self.gravity), absolute);
        let least = REST * self.contact_duration * pull.max(0.0);
        let mut first = self.colliding(one);
        let mut second =
            CollidingBody { velocity, spin: [0.0; 3], inverse_mass: 0.0, inertia_factor: 1.0, radius };
        let elastic = self.is_overlapping(one, time);
        let rule = &self.rules[usize::from(index)];
        let done = collide(&*rule.rule, rule.rough, normal, &mut first, &mut second, elastic, least);
        match done {
            Some(done) => {
                let total: [f64; 3] =
                    std::array::from_fn(|k| done.impulse.normal * normal[k] + done.impulse.tangential[k]);
                self.counts.wall_work += dot(total, velocity);
                self.account(&done, least);
            }
            None if pull > 0.0 => self.lift(&mut first, &mut second, normal, least),
            None => return Ok(()),
        }
        self.counts.wall_collisions += 1;
        self.finish(one, &first, time)?;
        if elastic {
            self.note_overlapping(time);
        }
        Ok(())
    }

    fn colliding(&self, body: usize) -> CollidingBody {
        let (record, identity) = (&self.bodies[body], &self.identities[body]);
        CollidingBody {
            velocity: record.velocity,
            spin: self.spins.get(body).copied().unwrap_or([0.0; 3]),
            inverse_mass: identity.inverse_mass,
            inertia_factor: identity.inertia_factor,
            radius: record.radius,
        }
    }

    /// True if the last collision of a body was less than the contact duration ago.
    #[inline]
    fn is_overlapping(&self, body: usize, time: f64) -> bool {
        self.last.get(body).is_some_and(|last| time - last < self.contact_duration)
    }

    /// A body that rests on another one exactly: it leaves as after an impact with the least rebound.
    fn lift(&mut self, first: &mut CollidingBody, second: &mut CollidingBody, normal: [f64; 3], least: f64) {
        let w: [f64; 3] = std::array::from_fn(|k| first.velocity[k] - second.velocity[k]);
        let missing = (least - dot(w, normal)).max(0.0);
        let share = 1.0 / (first.inverse_mass + second.inverse_mass);
        for k in 0..3 {
            first.velocity[k] += first.inverse_mass * share * missing * normal[k];
            second.velocity[k] -= second.inverse_mass * share * missing * normal[k];
        }
        self.counts.resting += 1;
        self.counts.lost_normal -= 0.5 * share * least * least;
    }

    fn account(&mut self, done: &Collided, least: f64) {
        let (seen, impulse) = (&done.collision, &done.impulse);
        let before = seen.normal_speed;
        let after = impulse.normal / seen.reduced_mass - before;
        self.counts.lost_normal += 0.5 * seen.reduced_mass * (before - after) * (before + after);
        if seen.tangential_mass > 0.0 {
            let j = impulse.tangential;
            self.counts.lost_tangential -=
                dot(j, seen.tangential_velocity) + 0.5 * dot(j, j) / seen.tangential_mass;
        }
        if least > 0.0 && after <= least * (1.0 + 1e-9) {
            self.counts.resting += 1;
        }
    }

    fn note_overlapping(&mut self, time: f64) {
        self.counts.overlapping += 1;
        self.counts.first_overlapping.get_or_insert(self.epoch + time);
    }

    fn finish(&mut self, body: usize, after: &CollidingBody, time: f64) -> Result<(), EventError> {
        let v = after.velocity;
        if !(v[0] + v[1] + v[2]).is_finite() {
            let (id, time) = (self.identities[body].id, self.epoch + time);
            return Err(EventError::NotFinite { id, time });
        }
        self.bodies[body].velocity = v;
        if let Some(spin) = self.spins.get_mut(body) {
            *spin = after.spin;
        }
        if let Some(last) = self.last.get_mut(body) {
            *last = time;
        }
        self.queue.payload_mut(body as u32).changed = self.since as u32;
        Ok(())
    }
}
