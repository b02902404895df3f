//! The earliest event of a body.

use super::engine::{AGAIN, PIECE, RollingEngine, SHELL, WALLS};
use super::plate::{Vector, dot, size, sum};
use super::touch::{Approach, Touch, touch};
use crate::flight::{Root, safe_root};

impl RollingEngine {
    /// Time, partner and the partner's number of pieces.
    pub(super) fn next(&self, body: u32, time: f64) -> (f64, u32, u32) {
        let (path, fixed) = (&self.paths[body as usize], &self.fixed[body as usize]);
        if fixed.inverse_mass == 0.0 {
            return (f64::INFINITY, SHELL, 0);
        }
        let dt = time - path.time;
        let (there, speed, _) = self.plate.at(time);
        let own = sum(path.velocity, dt, path.acceleration);
        let place = [0, 1].map(|k| {
            path.place[k] + dt * (path.velocity[k] + 0.5 * dt * path.acceleration[k]) + path.share * there[k]
        });
        let velocity = sum(own, path.share, speed);
        let end = (self.pieces[body as usize].end - time).max(0.0);
        let (mut best, mut partner) = self.least(body, place, velocity, end, PIECE);
        if !self.walls.is_empty() {
            (best, partner) = self.next_wall(body, place, own, time, (best, partner));
        }
        self.neighbours.each(body, |other| {
            let path_of = &self.paths[other as usize];
            let dt = time - path_of.time;
            let r = self.period.nearest([
                place[0]
                    - (path_of.place[0]
                        + dt * (path_of.velocity[0] + 0.5 * dt * path_of.acceleration[0])
                        + path_of.share * there[0]),
                place[1]
                    - (path_of.place[1]
                        + dt * (path_of.velocity[1] + 0.5 * dt * path_of.acceleration[1])
                        + path_of.share * there[1]),
                0.0,
            ]);
            let approach = Approach {
                place: [r[0], r[1]],
                velocity: sum(own, -1.0, sum(path_of.velocity, dt, path_of.acceleration)),
                acceleration: sum(path.acceleration, -1.0, path_of.acceleration),
                share: path.share - path_of.share,
            };
            match touch(&approach, self.contact(body, other), &self.plate, time, best) {
                Touch::At(after) if after < best => (best, partner) = (after, other),
                Touch::AskAgain(after) if after < best => (best, partner) = (after, AGAIN),
                Touch::At(_) | Touch::AskAgain(_) | Touch::Never => {}
            }
        });
        let seen = if partner < WALLS { self.queue.event(partner).1.pieces } else { 0 };
        let event = if partner == PIECE { self.pieces[body as usize].end } else { time + best };
        (event, partner, seen)
    }

    fn next_wall(
        &self,
        body: u32,
        place: Vector,
        own: Vector,
        time: f64,
        (mut best, mut partner): (f64, u32),
    ) -> (f64, u32) {
        let (path, fixed) = (&self.paths[body as usize], &self.fixed[body as usize]);
        let (there, _, _) = self.plate.at(time);
        for (index, wall) in self.walls.iter().enumerate() {
            if self.wall_rules[index * self.materials + usize::from(fixed.material)].is_none() {
                continue;
            }
            let normal = wall.normal;
            let pull = size(path.acceleration)
                + path.share * self.plate.most_acceleration
                + wall.most_acceleration();
            let gap = |after: f64| {
                let (here, speed, _) = self.plate.at(time + after);
                let at = [0, 1].map(|k| {
                    place[k]
                        + after * (own[k] + 0.5 * after * path.acceleration[k])
                        + path.share * (here[k] - there[k])
                });
                let moves = [0, 1].map(|k| own[k] + after * path.acceleration[k] + path.share * speed[k]);
                let (gap, speed) = wall.gap(at, time + after);
                (gap - fixed.radius, dot(normal, moves) - speed)
            };
            // Far away: the path and the wall together are too slow.
            let (now, closing) = gap(0.0);
            if best.is_finite()
                && wall.next_jump(time) > best
                && now > best * (closing.abs() + 0.5 * pull * best)
            {
                continue;
            }
            let round_off = 4.0 * f64::EPSILON * fixed.radius;
            let least = if pull > 0.0 { (round_off / pull).sqrt() } else { 0.0 };
            let jump = wall.next_jump(time);
            match safe_root(gap, pull, best.min(jump), round_off, least) {
                Root::At(after) if after < best => (best, partner) = (after, WALLS + index as u32),
                Root::PositiveUntil(after) if after < best => (best, partner) = (after, AGAIN),
                Root::At(_) | Root::PositiveUntil(_) => {}
            }
        }
        (best, partner)
    }
}
