//! From piece to piece: when a body slips, rolls and rests.

use granule_law_api::SurfaceFriction;

use super::arc::{self, Slowing};
use super::engine::{End, Gait, Motion, Path, Piece, RollingEngine};
use super::plate::{dot, size, sum};
use super::setup::Between;

/// Slips below this share of the velocities that make it are rounding.
const ROUNDING: f64 = 1e-12;

impl RollingEngine {
    pub(super) fn end_piece(&mut self, body: u32, time: f64) {
        let mut motion = self.motion(body, time);
        self.settle(body, time);
        let Piece { gait, end_by, .. } = self.pieces[body as usize];
        let next = match (gait, end_by) {
            (Gait::Sliding, End::Stops) => {
                motion.spin = sum(motion.plate, -1.0, motion.velocity);
                self.grips(body, time)
            }
            (Gait::Rolling, End::Stops) => {
                motion.velocity = motion.plate;
                motion.spin = [0.0; 2];
                Gait::Resting
            }
            (Gait::Rolling, End::Starts) => Gait::Sliding,
            (Gait::Resting, End::Starts) => match self.grips(body, time) {
                Gait::Sliding => Gait::Sliding,
                _ => Gait::Rolling,
            },
            (_, End::Jump) => {
                motion.plate = self.plate.at(time).1;
                return self.leave(body, time, motion);
            }
            (gait, _) => gait,
        };
        self.begin(body, time, &motion, next);
    }

    /// A body whose motion has changed in an instant goes on its way.
    pub(super) fn leave(&mut self, body: u32, time: f64, mut motion: Motion) {
        let friction = self.surface(body);
        let (kinetic, static_limit) = (friction.kinetic_friction, friction.static_friction);
        let slip = motion.slip();
        let rounding = ROUNDING * (size(motion.velocity) + size(motion.spin) + size(motion.plate));
        let effective = self.between == Between::EffectiveRestitution;
        let weight = self.plate.weight > 0.0;
        let held = weight && (kinetic == f64::INFINITY || effective);
        let gait = if size(slip) <= rounding || held {
            self.grip(body, &mut motion);
            self.grips(body, time)
        } else if static_limit == f64::INFINITY && weight && self.is_jump(body, time) {
            self.grip(body, &mut motion);
            Gait::Rolling
        } else {
            Gait::Sliding
        };
        self.begin(body, time, &motion, gait);
    }

    /// True if the piece that a body leaves ends because the plate jumps.
    fn is_jump(&self, body: u32, time: f64) -> bool {
        let piece = &self.pieces[body as usize];
        piece.end_by == End::Jump && piece.end == time && piece.gait != Gait::Sliding
    }

    /// Stops the slip of a body in an instant.
    pub(super) fn grip(&mut self, body: u32, motion: &mut Motion) {
        let fixed = &self.fixed[body as usize];
        let (slip, q) = (motion.slip(), fixed.inertia_number);
        motion.velocity = sum(motion.velocity, -1.0 / (1.0 + q), slip);
        motion.spin = sum(motion.plate, -1.0, motion.velocity);
        if self.ledger {
            self.work.sliding += 0.5 * fixed.mass * dot(slip, slip) / (1.0 + q);
            self.work.plate -= fixed.mass * dot(slip, motion.plate) / (1.0 + q);
        }
    }

    pub(super) fn surface(&self, body: u32) -> &SurfaceFriction {
        const NONE: &SurfaceFriction = &SurfaceFriction {
            static_friction: 0.0,
            kinetic_friction: 0.0,
            rolling: Vec::new(),
            drilling: 0.0,
        };
        let material = usize::from(self.fixed[body as usize].material);
        self.friction.get(material).and_then(Option::as_ref).unwrap_or(NONE)
    }

    /// A friction coefficient times the weight: not 0 · inf.
    fn hold(&self, coefficient: f64) -> f64 {
        if self.plate.weight > 0.0 { coefficient * self.plate.weight } else { 0.0 }
    }

    /// What a body without slip does: rests or rolls if static friction can hold it, else slides.
    fn grips(&self, body: u32, time: f64) -> Gait {
        if self.between == Between::EffectiveRestitution {
            return Gait::Rolling;
        }
        let pull = size(sum(self.plate.along, -1.0, self.plate.at(time).2));
        let q = self.fixed[body as usize].inertia_number;
        let limit = (1.0 + q) * self.hold(self.surface(body).static_friction);
        if self.plate.weight > 0.0 && pull <= limit { Gait::Resting } else { Gait::Sliding }
    }

    /// Sets a body on its next piece. A gait of `Resting` is changed to rolling if it moves, or cannot rest.
    fn begin(&mut self, body: u32, time: f64, motion: &Motion, gait: Gait) {
        self.pieces_begun += 1;
        let q = self.fixed[body as usize].inertia_number;
        let friction = self.surface(body);
        let jump = self.plate.next_jump(time);
        let (there, plate, acceleration) = self.plate.at(time);
        let pull = size(sum(self.plate.along, -1.0, acceleration));
        let slips_at = (1.0 + q) * self.hold(friction.static_friction);
        let rolling = Rolling::of(self, body, motion, pull);
        let gait = match gait {
            Gait::Resting => {
                let rests = motion.velocity == motion.plate && rolling.can_rest;
                if rests { Gait::Resting } else { Gait::Rolling }
            }
            gait => gait,
        };
        let mut piece = Piece {
            gait,
            end_by: End::Long,
            spin: motion.spin,
            spin_rate: [0.0; 2],
            upright: motion.upright,
            upright_rate: self.hold(friction.drilling) * q / self.fixed[body as usize].radius,
            friction: [0.0; 2],
            end: f64::INFINITY,
        };
        let error = match self.between {
            Between::Arcs { error } => error,
            Between::EffectiveRestitution => f64::INFINITY,
        };
        let relative = sum(motion.velocity, -1.0, plate);
        let (share, acceleration, duration) = match gait {
            Gait::Frozen => return,
            Gait::Sliding => {
                let centre_rate = self.hold(friction.kinetic_friction);
                let slowing = Slowing {
                    velocity: motion.slip(),
                    share: 1.0,
                    rate: (1.0 + q) * centre_rate,
                    centre_rate,
                };
                let found = arc::piece(&self.plate, time, &slowing, error, jump);
                piece.friction = found.direction.map(|d| -centre_rate * d);
                piece.spin_rate = piece.friction.map(|f| q * f);
                piece.end_by = if found.stops { End::Stops } else { End::Long };
                (0.0, sum(self.plate.along, 1.0, piece.friction), found.duration)
            }
            Gait::Rolling => {
                let slips = match self.between {
                    Between::Arcs { .. } => self.plate.next_exceeding(time, slips_at),
                    Between::EffectiveRestitution => f64::INFINITY,
                };
                let slowing = Slowing {
                    velocity: relative,
                    share: q / (1.0 + q),
                    rate: rolling.rate,
                    centre_rate: rolling.rate,
                };
                let horizon = slips.min(jump).min(rolling.longest);
                let found = arc::piece(&self.plate, time, &slowing, error, horizon);
                piece.friction = found.direction.map(|d| -rolling.rate * d);
                piece.end_by = match (found.stops, found.duration >= slips) {
                    (true, _) => End::Stops,
                    (false, true) => End::Starts,
                    (false, false) => End::Long,
                };
                let carried = self.plate.along.map(|g| q / (1.0 + q) * g);
                (1.0 / (1.0 + q), sum(carried, 1.0, piece.friction), found.duration)
            }
            Gait::Resting => {
                piece.end_by = End::Starts;
                let limit = slips_at.min((1.0 + q) / q * rolling.rate);
                (1.0, [0.0; 2], self.plate.next_exceeding(time, limit))
            }
        };
        if duration >= jump {
            piece.end_by = End::Jump;
        }
        piece.end = time + duration.min(jump);
        self.paths[body as usize] = Path {
            time,
            place: sum(motion.place, -share, there),
            velocity: sum(motion.velocity, -share, plate),
            acceleration,
            share,
        };
        self.pieces[body as usize] = piece;
        let aim = self.queue.payload_mut(body);
        aim.pieces = aim.pieces.wrapping_add(1);
    }
}

/// Rolling friction of a body for its next piece.
struct Rolling {
    /// Deceleration \[m/s²\].
    rate: f64,
    /// Longest piece for which it may count as constant \[s\].
    longest: f64,
    /// At rest it stays.
    can_rest: bool,
}

impl Rolling {
    fn of(engine: &RollingEngine, body: u32, motion: &Motion, pull: f64) -> Self {
        let q = engine.fixed[body as usize].inertia_number;
        let friction = engine.surface(body);
        let Between::Arcs { error } = engine.between else {
            return Self { rate: 0.0, longest: f64::INFINITY, can_rest: false };
        };
        let speed = size(sum(motion.velocity, -1.0, motion.plate));
        let hold = |speed: f64| engine.hold(friction.rolling_at(speed));
        let mut longest = f64::INFINITY;
        let mut rate = hold(speed);
        if friction.rolling.len() > 1 {
            // A coefficient that is wrong by the slope of the table times the change of the speed, over a piece.
            let steepest = friction
                .rolling
                .windows(2)
                .map(|rows| ((rows[1].1 - rows[0].1) / (rows[1].0 - rows[0].0)).abs())
                .fold(0.0, f64::max);
            let most = friction.rolling.iter().map(|row| engine.hold(row.1)).fold(0.0, f64::max);
            let gain = most + q / (1.0 + q) * engine.plate.most_pull;
            let wrong = engine.hold(steepest) * gain;
            if wrong > 0.0 {
                longest = (4.0 * error / wrong).cbrt();
            }
            rate = hold((speed - 0.5 * longest * rate).max(0.0));
        }
        // It acts through the contact, too: no more of it than static friction leaves.
        let left = engine.hold(friction.static_friction) - pull / (1.0 + q);
        let rate = rate.min(left.max(0.0));
        Self { rate, longest, can_rest: q / (1.0 + q) * pull <= rate }
    }
}
