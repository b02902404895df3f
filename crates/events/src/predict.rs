//! The earliest event of a body.

use crate::body::{Shell, Twins, dot};
use crate::engine::{AGAIN, EventEngine, SHELL, WALLS};
use crate::flight::{Root, leave, leave_falling, safe_root, touch};
use crate::two::Two;
use crate::wall::Reach;

impl EventEngine {
    /// Relative time and partner.
    #[inline]
    pub(crate) fn next(&self, body: u32, time: f64) -> (f64, u32) {
        if self.identities[body as usize].inverse_mass == 0.0 {
            return (f64::INFINITY, SHELL);
        }
        let (x, v) = self.at(body, time);
        let radius = self.bodies[body as usize].radius;
        let Shell { centre, reach } = self.shells[body as usize];
        let offset = self.period.nearest(std::array::from_fn(|k| x[k] - centre[k]));
        let mut best = if self.falls {
            leave_falling(offset, v, self.gravity, reach - radius)
        } else {
            leave(offset, v, reach - radius)
        };
        let mut partner = SHELL;
        if !self.walls.is_empty() {
            (best, partner) = self.next_wall(body, (x, v), radius, time, best);
        }
        if self.falls {
            self.next_falling(body, (x, v), time, &mut best, &mut partner);
        } else {
            let (r, limit) = ((x, v, radius), (best, partner));
            (best, partner) = if self.is_inside(centre) {
                self.next_straight::<false>(body, r, time, limit)
            } else {
                self.next_straight::<true>(body, r, time, limit)
            };
        }
        (time + best, partner)
    }

    /// The earliest touch of a body that flies straight, as its neighbours do.
    #[inline(always)]
    fn next_straight<const WRAP: bool>(
        &self,
        body: u32,
        (x, v, radius): ([f64; 3], [f64; 3], f64),
        time: f64,
        (mut best, mut partner): (f64, u32),
    ) -> (f64, u32) {
        let (x2, v2) = (x.map(Two::both), v.map(Two::both));
        let (time2, radius2, zero) = (Two::both(time), Two::both(radius), Two::both(0.0));
        let mut twice_best = Two::both(2.0 * best);
        for list in self.neighbours.lists(body) {
            let (twos, odd) = list.as_chunks::<2>();
            let odd = odd.first().map(|one| [*one, *one]);
            for &[one, two] in twos.iter().chain(&odd) {
                let others = Twins::new(&self.bodies[one as usize], &self.bodies[two as usize]);
                let dt = time2 - others.time;
                let mut r: [Two; 3] =
                    std::array::from_fn(|k| x2[k] - (others.position[k] + dt * others.velocity[k]));
                if WRAP {
                    r = self.period.nearest_of_two(r);
                }
                let w: [Two; 3] = std::array::from_fn(|k| v2[k] - others.velocity[k]);
                let b = r[0] * w[0] + r[1] * w[1] + r[2] * w[2];
                let contact = radius2 + others.radius;
                let c = r[0] * r[0] + r[1] * r[1] + r[2] * r[2] - contact * contact;
                // The square of the distance less that of the contact is c + 2 b τ + w² τ²: most neighbours are too far
                // away to be met before something else happens.
                let far = (c + twice_best * b).greater(zero);
                if far == 3 {
                    continue;
                }
                for (lane, other) in [one, two].into_iter().enumerate() {
                    if far >> lane & 1 == 0
                        && let Some(after) = self.meet::<WRAP>(other, (x, v, radius), time)
                        && after < best
                    {
                        (best, partner) = (after, other);
                        twice_best = Two::both(2.0 * best);
                    }
                }
            }
        }
        (best, partner)
    }

    /// After what time a body that flies straight touches another one.
    #[inline]
    fn meet<const WRAP: bool>(
        &self,
        other: u32,
        (x, v, radius): ([f64; 3], [f64; 3], f64),
        time: f64,
    ) -> Option<f64> {
        let record = &self.bodies[other as usize];
        let dt = time - record.time;
        let mut r: [f64; 3] = std::array::from_fn(|k| x[k] - (record.position[k] + dt * record.velocity[k]));
        if WRAP {
            r = self.period.nearest(r);
        }
        touch(r, std::array::from_fn(|k| v[k] - record.velocity[k]), radius + record.radius)
    }

    /// As above under gravity, where bodies may also meet frozen ones on curved paths.
    fn next_falling(
        &self,
        body: u32,
        (x, v): ([f64; 3], [f64; 3]),
        time: f64,
        best: &mut f64,
        partner: &mut u32,
    ) {
        let radius = self.bodies[body as usize].radius;
        let shell = self.shells[body as usize].reach - radius;
        self.neighbours.each(body, |other| {
            let (y, u) = self.at(other, time);
            let r = self.period.nearest(std::array::from_fn(|k| x[k] - y[k]));
            let w: [f64; 3] = std::array::from_fn(|k| v[k] - u[k]);
            let contact = radius + self.bodies[other as usize].radius;
            if self.identities[other as usize].inverse_mass > 0.0 {
                if let Some(after) = touch(r, w, contact)
                    && after < *best
                {
                    (*best, *partner) = (after, other);
                }
                return;
            }
            let g = self.gravity;
            let squared = |after: f64| {
                let r: [f64; 3] = std::array::from_fn(|k| r[k] + after * (w[k] + 0.5 * after * g[k]));
                let w: [f64; 3] = std::array::from_fn(|k| w[k] + after * g[k]);
                (dot(r, r) - contact * contact, 2.0 * dot(r, w))
            };
            // The body stays in its shell, so that the distance grows by a diameter of it at most.
            let farthest = dot(r, r).sqrt() + 2.0 * shell;
            let curvature = 2.0 * dot(g, g).sqrt() * farthest;
            let round_off = 4.0 * f64::EPSILON * contact * contact;
            let least = (round_off / curvature).sqrt();
            match safe_root(squared, curvature, *best, round_off, least) {
                Root::At(after) if after < *best => (*best, *partner) = (after, other),
                Root::PositiveUntil(after) if after < *best => (*best, *partner) = (after, AGAIN),
                Root::At(_) | Root::PositiveUntil(_) => {}
            }
        });
    }

    fn next_wall(
        &self,
        body: u32,
        (x, v): ([f64; 3], [f64; 3]),
        radius: f64,
        time: f64,
        horizon: f64,
    ) -> (f64, u32) {
        let (mut best, mut partner) = (horizon, SHELL);
        let material = usize::from(self.identities[body as usize].material);
        for (index, wall) in self.walls.iter().enumerate() {
            if self.wall_rules[index * self.materials + material].is_none() {
                continue;
            }
            match wall.reach((x, v, self.gravity), radius, self.epoch + time, best) {
                Reach::At(after) if after < best => (best, partner) = (after, WALLS + index as u32),
                Reach::AskAgain(after) if after < best => (best, partner) = (after, AGAIN),
                Reach::At(_) | Reach::AskAgain(_) | Reach::Never => {}
            }
        }
        (best, partner)
    }
}
