//! Collisions of bodies that stay on the plate.
//!
//! The plate takes the part of the impulse along its normal. So the mass that the rule sees along the normal of the plate is
//! that of the spins alone; and a body that the collision presses onto the plate feels kinetic friction by that impulse
//! (Kondic 1999, Eqs. (9), (55) and (56)). A body that it lifts feels none.

use granule_law_api::{Collision, CollisionImpulse};

use super::engine::{Motion, RollingEngine};
use super::plate::{Vector, dot, size, sum};
use crate::setup::EventError;

/// Speed after which bodies that are pressed together come back, over their pull times the contact duration: a flight of 0.9
/// contact durations.
const REST: f64 = 0.45;
/// Rounding of a relative velocity as a share of the velocities.
const ROUNDING: f64 = 1e-13;

/// Where two sides touch.
struct Contact {
    /// Unit vector along the plate, to the first side.
    along: Vector,
    /// Cosine and sine of the rise of the normal over the plate.
    rise: (f64, f64),
    /// Acceleration with which the sides are pressed together \[m/s²\].
    pull: f64,
    /// One of them collided less than a contact duration ago.
    elastic: bool,
    rule: u16,
}

/// A body or a wall.
struct Side {
    motion: Motion,
    /// Velocity away from the plate \[m/s\]: of walls alone.
    vertical: f64,
    radius: f64,
    inverse_mass: f64,
    inertia_number: f64,
}

/// What the first side got; the second got the opposite.
struct Given {
    /// Impulse along the plate \[N s\].
    plane: Vector,
    /// Impulse away from the plate \[N s\].
    lift: f64,
    /// Impulse along the normal \[N s\].
    normal: f64,
    /// Energy lost along the normal \[J\].
    lost_normal: f64,
}

impl RollingEngine {
    /// Two bodies touch.
    pub(super) fn collide(&mut self, a: u32, b: u32, time: f64) -> Result<(), EventError> {
        let (mut first, mut second) = (self.side(a, time), self.side(b, time));
        let (one, two) = (first.motion.place, second.motion.place);
        let r = self.period.nearest([one[0] - two[0], one[1] - two[1], 0.0]);
        let r = [r[0], r[1]];
        let (level, step) = (size(r), self.fixed[a as usize].height - self.fixed[b as usize].height);
        let distance = (level * level + step * step).sqrt();
        let Some(rule) = self.rule_of(a, b) else { return Ok(()) };
        let along = r.map(|c| c / level);
        let rise = (level / distance, step / distance);
        let drawn = sum(self.acceleration(b, time), -1.0, self.acceleration(a, time));
        let pull = rise.0 * dot(drawn, along);
        let elastic = self.is_overlapping(a, time) || self.is_overlapping(b, time);
        let contact = Contact { along, rise, pull, elastic, rule };
        let before = energy(&first) + energy(&second);
        let Some(given) = self.strike(&contact, &mut first, &mut second) else { return Ok(()) };
        self.counts.collisions += 1;
        self.counts.virial += given.normal * distance;
        if self.has_ledger() {
            self.counts.lost_normal += given.lost_normal;
            self.counts.lost_tangential += before - energy(&first) - energy(&second) - given.lost_normal;
        }
        self.settle(a, time);
        self.settle(b, time);
        self.press(a, &mut first.motion, -given.lift);
        self.press(b, &mut second.motion, given.lift);
        if elastic {
            self.note_overlapping(time);
        }
        if self.has_arcs() {
            self.finish(a, first.motion, time)?;
            return self.finish(b, second.motion, time);
        }
        // The slides are over at once. With a small restitution the bodies would still approach then: they meet again, and
        // stop each other.
        for (body, side) in [(a, &mut first), (b, &mut second)] {
            if side.inverse_mass > 0.0 {
                self.grip(body, &mut side.motion);
            }
        }
        let closing = -dot(sum(first.motion.velocity, -1.0, second.motion.velocity), along);
        if closing > 0.0 {
            let rolling = |side: &Side| side.inverse_mass / (1.0 + 1.0 / side.inertia_number);
            let before = energy(&first) + energy(&second);
            let impulse = closing / (rolling(&first) + rolling(&second));
            for (side, sign) in [(&mut first, 1.0), (&mut second, -1.0)] {
                let change = sign * impulse * rolling(side);
                side.motion.velocity = sum(side.motion.velocity, change, along);
                if side.inverse_mass > 0.0 {
                    side.motion.spin = sum(side.motion.plate, -1.0, side.motion.velocity);
                }
            }
            if self.has_ledger() {
                // Static friction of the plate turns the bodies along: what it gives, the plate works.
                let given = |side: &Side, sign: f64| {
                    let share = if side.inverse_mass > 0.0 { 1.0 / (1.0 + side.inertia_number) } else { 0.0 };
                    -sign * impulse * share * dot(along, side.motion.plate)
                };
                let work = given(&first, 1.0) + given(&second, -1.0);
                self.work.plate += work;
                self.counts.lost_normal += before + work - energy(&first) - energy(&second);
            }
        }
        self.finish(a, first.motion, time)?;
        self.finish(b, second.motion, time)
    }

    /// A body reaches a wall.
    pub(super) fn hit_wall(&mut self, body: u32, wall: usize, time: f64) -> Result<(), EventError> {
        let fixed = self.fixed[body as usize];
        let Some(rule) = self.wall_rules[wall * self.materials + usize::from(fixed.material)] else {
            return Ok(());
        };
        let mut first = self.side(body, time);
        let plane = &self.walls[wall];
        let along = plane.normal;
        let contact_point = sum(first.motion.place, -fixed.radius, along);
        let velocity = plane.velocity([contact_point[0], contact_point[1], fixed.height], time);
        let pull = plane.pull(self.acceleration(body, time), time);
        let mut second = Side {
            motion: Motion {
                place: contact_point,
                velocity: [velocity[0], velocity[1]],
                spin: [0.0; 2],
                upright: 0.0,
                plate: [0.0; 2],
            },
            vertical: velocity[2],
            radius: fixed.radius,
            inverse_mass: 0.0,
            inertia_number: 1.0,
        };
        let elastic = self.is_overlapping(body, time);
        let contact = Contact { along, rise: (1.0, 0.0), pull, elastic, rule };
        let before = energy(&first);
        let Some(given) = self.strike(&contact, &mut first, &mut second) else { return Ok(()) };
        self.counts.wall_collisions += 1;
        if self.has_ledger() {
            // The wall rubs upwards, too: the plate holds the body against that.
            let work = dot(given.plane, [velocity[0], velocity[1]]) + given.lift * velocity[2];
            self.counts.wall_work += work;
            self.counts.lost_normal += given.lost_normal;
            self.counts.lost_tangential += before + work - energy(&first) - given.lost_normal;
        }
        self.settle(body, time);
        self.press(body, &mut first.motion, -given.lift);
        if elastic {
            self.note_overlapping(time);
        }
        if !self.has_arcs() {
            self.grip(body, &mut first.motion);
            let closing = dot(second.motion.velocity, along) - dot(first.motion.velocity, along);
            if closing > 0.0 {
                let share = 1.0 / (1.0 + 1.0 / fixed.inertia_number);
                let impulse = closing * fixed.mass / share;
                let before = energy(&first);
                first.motion.velocity = sum(first.motion.velocity, closing, along);
                first.motion.spin = sum(first.motion.plate, -1.0, first.motion.velocity);
                if self.has_ledger() {
                    let by_wall = impulse * dot(along, second.motion.velocity);
                    let by_plate = -impulse * dot(along, first.motion.plate) / (1.0 + fixed.inertia_number);
                    self.counts.wall_work += by_wall;
                    self.work.plate += by_plate;
                    self.counts.lost_normal += before + by_wall + by_plate - energy(&first);
                }
            }
        }
        self.finish(body, first.motion, time)
    }

    fn side(&self, body: u32, time: f64) -> Side {
        let fixed = &self.fixed[body as usize];
        Side {
            motion: self.motion(body, time),
            vertical: 0.0,
            radius: fixed.radius,
            inverse_mass: fixed.inverse_mass,
            inertia_number: fixed.inertia_number,
        }
    }

    /// Applies the rule. `None`, and no change, if the sides do not approach and nothing presses them together.
    fn strike(&mut self, contact: &Contact, first: &mut Side, second: &mut Side) -> Option<Given> {
        let Contact { along: h, rise: (cos, sin), pull, elastic, rule } = *contact;
        // The normal n = (h cos, sin), and tangents across, k × h, and upwards, (-h sin, cos).
        let across = [-h[1], h[0]];
        let velocity = sum(first.motion.velocity, -1.0, second.motion.velocity);
        let normal_speed = -dot(velocity, h) * cos;
        let inverse = first.inverse_mass + second.inverse_mass;
        let reduced_mass = 1.0 / (cos * cos * inverse);
        // Sides that meet without approaching by more than rounding part as slowly.
        let rounding = ROUNDING * (size(first.motion.velocity) + size(second.motion.velocity));
        let least = (REST * self.contact_duration * pull).max(rounding);
        if !(inverse > 0.0 && (normal_speed > 0.0 || -normal_speed < least)) {
            return None;
        }
        let rule = &self.rules[usize::from(rule)];
        let mut impulse = CollisionImpulse::default();
        let (mut sideways, mut upwards) = (0.0, 0.0);
        if normal_speed > 0.0 {
            let mut seen = Collision {
                normal_speed,
                tangential_velocity: [0.0; 3],
                reduced_mass,
                tangential_mass: 0.0,
                elastic,
            };
            if rule.rough {
                // Σ R Ω of both, with the part along the plate from R k × Ω.
                let turning = |side: &Side| {
                    [side.motion.spin[1], -side.motion.spin[0], side.radius * side.motion.upright]
                };
                let (a, b) = (turning(first), turning(second));
                let w: [f64; 3] = std::array::from_fn(|k| a[k] + b[k]);
                // -(w × n) on the tangents: n × across = upwards, n × upwards = -across.
                let w_up = -sin * dot([w[0], w[1]], h) + cos * w[2];
                let w_across = dot([w[0], w[1]], across);
                let v_across = dot(velocity, across) - w_up;
                let v_up = -sin * dot(velocity, h) + cos * (first.vertical - second.vertical) + w_across;
                let q = |side: &Side| side.inverse_mass * side.inertia_number;
                let turn = q(first) + q(second);
                let (inverse_across, inverse_up) = (inverse + turn, sin * sin * inverse + turn);
                // One mass for the rule: velocities upwards count by the ratio of the masses.
                let ratio = inverse_across / inverse_up;
                seen.tangential_velocity = [v_across, v_up * ratio, 0.0];
                seen.tangential_mass = 1.0 / inverse_across;
            }
            impulse = rule.rule.impulse(&seen);
            (sideways, upwards) = (impulse.tangential[0], impulse.tangential[1]);
        }
        let needed = reduced_mass * (normal_speed + least);
        if impulse.normal < needed {
            impulse.normal = needed;
        }
        let after = impulse.normal / reduced_mass - normal_speed;
        if pull > 0.0 && after <= least * (1.0 + 1e-9) {
            self.counts.resting += 1;
        }
        let level = impulse.normal * cos - upwards * sin;
        let plane = [0, 1].map(|k| level * h[k] + sideways * across[k]);
        let lift = impulse.normal * sin + upwards * cos;
        // Torques: R dΩ = -Q/m n × J on both, with n × J = sideways · upwards' - upwards · across'.
        let torque = [
            -sin * sideways * h[0] - upwards * across[0],
            -sin * sideways * h[1] - upwards * across[1],
            cos * sideways,
        ];
        for (side, sign) in [(first, 1.0), (second, -1.0)] {
            if side.inverse_mass == 0.0 {
                continue;
            }
            let turn = -side.inverse_mass * side.inertia_number;
            let motion = &mut side.motion;
            motion.velocity = sum(motion.velocity, sign * side.inverse_mass, plane);
            motion.spin = [motion.spin[0] - turn * torque[1], motion.spin[1] + turn * torque[0]];
            motion.upright += turn * torque[2] / side.radius;
        }
        let lost_normal = 0.5 * reduced_mass * (normal_speed - after) * (normal_speed + after);
        Some(Given { plane, lift, normal: impulse.normal, lost_normal })
    }

    /// Friction of the plate on a body that a collision presses onto it with an impulse \[N s\]; none if that lifts it.
    fn press(&mut self, body: u32, motion: &mut Motion, impulse: f64) {
        let fixed = self.fixed[body as usize];
        let friction = self.surface(body).kinetic_friction;
        if fixed.inverse_mass == 0.0 || impulse <= 0.0 || friction == 0.0 {
            return;
        }
        let slip = motion.slip();
        let speed = size(slip);
        let change = friction * impulse * fixed.inverse_mass;
        if (1.0 + fixed.inertia_number) * change >= speed {
            self.grip(body, motion);
            return;
        }
        let given = slip.map(|u| -change * u / speed);
        motion.velocity = sum(motion.velocity, 1.0, given);
        motion.spin = sum(motion.spin, fixed.inertia_number, given);
        if self.has_ledger() {
            let after = motion.slip();
            self.work.sliding -= 0.5 * fixed.mass * dot(given, sum(slip, 1.0, after));
            self.work.plate += fixed.mass * dot(given, motion.plate);
        }
    }

    fn is_overlapping(&self, body: u32, time: f64) -> bool {
        time - self.last[body as usize] < self.contact_duration
    }

    fn note_overlapping(&mut self, time: f64) {
        self.counts.overlapping += 1;
        self.counts.first_overlapping.get_or_insert(time);
    }

    fn finish(&mut self, body: u32, motion: Motion, time: f64) -> Result<(), EventError> {
        let fixed = &self.fixed[body as usize];
        if fixed.inverse_mass == 0.0 {
            return Ok(());
        }
        let [x, y] = sum(motion.velocity, 1.0, motion.spin);
        if !(x + y + motion.upright).is_finite() {
            return Err(EventError::NotFinite { id: fixed.id, time });
        }
        self.last[body as usize] = time;
        self.leave(body, time, motion);
        Ok(())
    }
}

/// Kinetic energy \[J\]; 0 for what cannot move.
fn energy(side: &Side) -> f64 {
    if side.inverse_mass == 0.0 {
        return 0.0;
    }
    let Motion { velocity, spin, upright, .. } = &side.motion;
    let turning = dot(*spin, *spin) + (side.radius * upright) * (side.radius * upright);
    0.5 / side.inverse_mass * (dot(*velocity, *velocity) + turning / side.inertia_number)
}
