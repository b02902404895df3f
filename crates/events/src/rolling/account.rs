//! What the bodies do, and what the plate does to their energy.

use serde::{Deserialize, Serialize};

use super::engine::{Gait, RollingEngine};
use super::plate::{dot, sum};
use crate::engine::BodyState;

/// Work and dissipation of the plate since the start \[J\]; zero without the ledger.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RollingWork {
    /// Dissipated by slip.
    pub sliding: f64,
    /// Dissipated by rolling friction.
    pub rolling: f64,
    /// Dissipated by friction about the normal.
    pub drilling: f64,
    /// Work of the moving plate on the bodies.
    pub plate: f64,
}

/// What the bodies do on the plate at a moment, and what happened until then.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RollingTally {
    /// Bodies that slip.
    pub sliding: u64,
    /// Bodies that roll without slip.
    pub rolling: u64,
    /// Bodies at rest relative to the plate.
    pub resting: u64,
    /// Work and dissipation since the start.
    pub work: RollingWork,
}

impl RollingEngine {
    /// Work and dissipation of a body's piece up to a time, in closed form.
    fn piece_work(&self, body: u32, time: f64) -> RollingWork {
        let (path, piece, fixed) =
            (&self.paths[body as usize], &self.pieces[body as usize], &self.fixed[body as usize]);
        let mut work = RollingWork::default();
        let dt = time - path.time;
        if piece.gait == Gait::Frozen || dt == 0.0 {
            return work;
        }
        let (mass, q) = (fixed.mass, fixed.inertia_number);
        let (place, before, _) = self.plate.at(path.time);
        let (end, after, _) = self.plate.along_path(path.time, time);
        let carried = sum(end, -1.0, place);
        let moved = [0, 1]
            .map(|k| dt * (path.velocity[k] + 0.5 * dt * path.acceleration[k]) + path.share * carried[k]);
        let rolled = sum(moved, -1.0, carried);
        let f = piece.friction;
        // ∫ v_S (a_S - g) dt, for the friction that carries a body along.
        let lift = 0.5 * (dot(after, after) - dot(before, before)) - dot(self.plate.along, carried);
        match piece.gait {
            Gait::Frozen => {}
            Gait::Sliding => {
                let slipped =
                    [0, 1].map(|k| rolled[k] + dt * (piece.spin[k] + 0.5 * dt * piece.spin_rate[k]));
                work.sliding = -mass * dot(f, slipped);
                work.plate = mass * dot(f, carried);
            }
            Gait::Rolling => {
                work.rolling = -mass * (1.0 + 1.0 / q) * dot(f, rolled);
                work.plate = mass * (lift / (1.0 + q) + dot(f, carried));
            }
            Gait::Resting => work.plate = mass * lift,
        }
        let left = (piece.upright.abs() - dt * piece.upright_rate).max(0.0);
        let inertia = mass * fixed.radius * fixed.radius / q;
        work.drilling = 0.5 * inertia * (piece.upright * piece.upright - left * left);
        work
    }

    /// Takes down what a body's piece did until now; the body leaves it.
    pub(super) fn settle(&mut self, body: u32, time: f64) {
        if self.ledger {
            let done = self.piece_work(body, time);
            add(&mut self.work, &done);
        }
    }

    /// All bodies at a simulated time \[s\], which must not be before the last event nor after the next, in the order of
    /// their identities.
    pub fn states(&self, time: f64) -> Vec<BodyState> {
        let mut states: Vec<BodyState> = (0..self.fixed.len() as u32)
            .map(|body| {
                let fixed = &self.fixed[body as usize];
                let motion = self.motion(body, time);
                let at = [motion.place[0], motion.place[1], fixed.height];
                let (position, turns) = self.cell.wrap(at);
                let spin = [motion.spin[1] / fixed.radius, -motion.spin[0] / fixed.radius, motion.upright];
                BodyState {
                    id: fixed.id,
                    position,
                    image: std::array::from_fn(|k| fixed.image[k].saturating_add(turns[k])),
                    velocity: [motion.velocity[0], motion.velocity[1], 0.0],
                    spin,
                }
            })
            .collect();
        states.sort_unstable_by_key(|state| state.id);
        states
    }

    /// What the bodies do at a simulated time \[s\], and the work and dissipation of the plate until then.
    pub fn tally(&self, time: f64) -> RollingTally {
        let mut tally = RollingTally { work: self.work, ..RollingTally::default() };
        for (body, piece) in self.pieces.iter().enumerate() {
            match piece.gait {
                Gait::Frozen => {}
                Gait::Sliding => tally.sliding += 1,
                Gait::Rolling => tally.rolling += 1,
                Gait::Resting => tally.resting += 1,
            }
            if self.ledger {
                add(&mut tally.work, &self.piece_work(body as u32, time));
            }
        }
        tally
    }
}

fn add(work: &mut RollingWork, other: &RollingWork) {
    work.sliding += other.sliding;
    work.rolling += other.rolling;
    work.drilling += other.drilling;
    work.plate += other.plate;
}
