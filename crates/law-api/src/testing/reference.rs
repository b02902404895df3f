//! High-accuracy integration of small problems, independent of every stage: for oracles without closed form.
//!
//! The method is Dormand and Prince's pair of orders 5 and 4 (J. Comput. Appl. Math. 6 (1980) 19) with step control at a
//! local error of 1e-12 of the largest value seen; results are good to about 1e-9.

use std::cell::RefCell;

use super::Contacts;
use crate::{ContactEnd, Impact, ImpactOutcome, Stage};

const TOLERANCE: f64 = 1e-12;

/// Integrates y' = f(t, y) from t = 0 to `end` and returns y(end).
pub fn integrate<const N: usize>(
    start: [f64; N],
    end: f64,
    derivative: impl Fn(f64, [f64; N]) -> [f64; N],
) -> [f64; N] {
    let mut path = Path::new(start, 1e-4 * end, derivative);
    while path.time < end {
        path.step = path.step.min(end - path.time);
        path.advance();
    }
    path.state
}

/// Integrates y' = f(t, y) from `time` until `happened(t, y)` or until `latest`, and returns where it stopped, the state
/// there, and whether it happened.
pub fn integrate_until<const N: usize>(
    time: f64,
    start: [f64; N],
    latest: f64,
    derivative: impl Fn(f64, [f64; N]) -> [f64; N],
    happened: impl Fn(f64, [f64; N]) -> bool,
) -> (f64, [f64; N], bool) {
    let mut path = Path::new(start, 1e-6 * (latest - time), derivative);
    path.time = time;
    let happened = path.advance_until(latest, happened);
    (path.time, path.state, happened)
}

/// A head-on impact under the normal force `force(overlap, velocity)` \[N\]. `scale` is a time in the order of the contact's
/// duration. The duration is infinite and the restitution zero if the contact has not ended after a thousand such times.
pub fn impact(
    impact: &Impact,
    end: ContactEnd,
    scale: f64,
    force: impl Fn(f64, f64) -> f64,
) -> ImpactOutcome {
    let mass = impact.reduced_mass;
    let speed = impact.normal_speed;
    let derivative =
        |_: f64, [overlap, velocity]: [f64; 2]| [velocity, -force(overlap.max(0.0), velocity) / mass];
    let turned = |_: f64, state: [f64; 2]| state[1] <= 0.0;
    let ended = |_: f64, state: [f64; 2]| match end {
        ContactEnd::Force => state[1] < 0.0 && force(state[0].max(0.0), state[1]) <= 0.0,
        ContactEnd::Overlap => state[0] <= 0.0,
    };
    let mut path = Path::new([0.0, speed], 1e-6 * scale, derivative);
    path.advance();
    let latest = 1e3 * scale;
    path.advance_until(latest, turned);
    let maximum_overlap = path.state[0];
    if path.advance_until(latest, ended) {
        ImpactOutcome { duration: path.time, maximum_overlap, restitution: -path.state[1] / speed }
    } else {
        ImpactOutcome { duration: f64::INFINITY, maximum_overlap, restitution: 0.0 }
    }
}

/// As [`impact`], under a normal stage without history.
pub fn impact_with(stage: &dyn Stage<f64>, case: &Impact, end: ContactEnd, scale: f64) -> ImpactOutcome {
    let contact = RefCell::new(Contacts::<f64>::new(1, 0));
    impact(case, end, scale, |overlap, velocity| {
        let mut contact = contact.borrow_mut();
        // The force at first touch is the limit from above.
        contact.overlap[0] = overlap.max(f64::MIN_POSITIVE);
        contact.normal_velocity[0] = velocity;
        contact.reduced_mass[0] = case.reduced_mass;
        contact.reduced_radius[0] = case.reduced_radius;
        contact.run_with(stage, 0.0, false, false);
        contact.normal_force[0]
    })
}

struct Path<const N: usize, F> {
    time: f64,
    state: [f64; N],
    step: f64,
    size: [f64; N],
    derivative: F,
}

impl<const N: usize, F: Fn(f64, [f64; N]) -> [f64; N]> Path<N, F> {
    fn new(state: [f64; N], step: f64, derivative: F) -> Self {
        Self { time: 0.0, state, step, size: state.map(f64::abs), derivative }
    }

    /// State after a step of length `h`, and the estimated error of each component.
    fn trial(&self, h: f64) -> ([f64; N], [f64; N]) {
        const A: [&[f64]; 6] = [
            &[1.0 / 5.0],
            &[3.0 / 40.0, 9.0 / 40.0],
            &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
            &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
            &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
            &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
        ];
        const C: [f64; 6] = [1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];
        // Fifth-order minus fourth-order weights.
        const E: [f64; 7] = [
            71.0 / 57600.0,
            0.0,
            -71.0 / 16695.0,
            71.0 / 1920.0,
            -17253.0 / 339200.0,
            22.0 / 525.0,
            -1.0 / 40.0,
        ];
        let mut slopes = [[0.0; N]; 7];
        slopes[0] = (self.derivative)(self.time, self.state);
        let mut next = self.state;
        for stage in 0..6 {
            next = self.state;
            for (weight, slope) in A[stage].iter().zip(&slopes) {
                for i in 0..N {
                    next[i] += h * weight * slope[i];
                }
            }
            slopes[stage + 1] = (self.derivative)(self.time + C[stage] * h, next);
        }
        let mut error = [0.0; N];
        for (weight, slope) in E.iter().zip(&slopes) {
            for i in 0..N {
                error[i] += h * weight * slope[i];
            }
        }
        (next, error)
    }

    /// One accepted step.
    fn advance(&mut self) {
        loop {
            let (next, error) = self.trial(self.step);
            let mut worst: f64 = 0.0;
            for i in 0..N {
                let size = self.size[i].max(next[i].abs());
                if size > 0.0 {
                    worst = worst.max(error[i].abs() / (TOLERANCE * size));
                }
            }
            let factor = if worst > 0.0 { (0.9 * worst.powf(-0.2)).min(4.0).max(0.1) } else { 4.0 };
            let taken = self.step;
            self.step *= factor;
            if worst <= 1.0 || taken <= self.time.abs() * f64::EPSILON {
                self.accept(taken, next);
                return;
            }
        }
    }

    fn accept(&mut self, step: f64, next: [f64; N]) {
        self.time += step;
        self.state = next;
        for i in 0..N {
            self.size[i] = self.size[i].max(next[i].abs());
        }
    }

    /// Advances to the first moment at which `happened` holds, located to round-off by bisecting the step; false if that is
    /// later than `latest`.
    fn advance_until(&mut self, latest: f64, happened: impl Fn(f64, [f64; N]) -> bool) -> bool {
        loop {
            if self.time >= latest {
                return false;
            }
            self.step = self.step.min(latest - self.time);
            let (time, state) = (self.time, self.state);
            self.advance();
            if !happened(self.time, self.state) {
                continue;
            }
            let (mut low, mut high) = (0.0, self.time - time);
            (self.time, self.state) = (time, state);
            for _ in 0..80 {
                let middle = 0.5 * (low + high);
                if middle <= low || middle >= high {
                    break;
                }
                if happened(time + middle, self.trial(middle).0) { high = middle } else { low = middle }
            }
            let next = self.trial(high).0;
            self.step = 1e-3 * high.max(self.step * 1e-6);
            self.accept(high, next);
            return true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oscillator;

    #[test]
    fn damped_oscillator_is_met() {
        for (end, beta) in [
            (ContactEnd::Force, 0.0),
            (ContactEnd::Force, 0.3),
            (ContactEnd::Force, 1.0),
            (ContactEnd::Force, 2.0),
            (ContactEnd::Overlap, 0.3),
            (ContactEnd::Overlap, 0.9),
        ] {
            let case = Impact { reduced_mass: 2.0, reduced_radius: 1.0, normal_speed: 3.0 };
            let omega = (5.0_f64 / 2.0).sqrt();
            let damping = 2.0 * beta * (5.0_f64 * 2.0).sqrt();
            let outcome = impact(&case, end, 1.0, |overlap, velocity| 5.0 * overlap + damping * velocity);
            // A thousand steps at a local error of 1e-12, located events included.
            assert!((outcome.duration * omega - oscillator::duration(beta, end)).abs() < 1e-9);
            assert!((outcome.restitution - oscillator::restitution(beta, end)).abs() < 1e-9);
            let largest = 3.0 / omega * oscillator::largest_overlap(beta);
            assert!((outcome.maximum_overlap / largest - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_contact_without_end_is_reported() {
        let case = Impact { reduced_mass: 1.0, reduced_radius: 1.0, normal_speed: 1.0 };
        let outcome = impact(&case, ContactEnd::Overlap, 0.1, |overlap, velocity| overlap + 6.0 * velocity);
        assert_eq!((outcome.duration, outcome.restitution), (f64::INFINITY, 0.0));
        assert!((outcome.maximum_overlap / oscillator::largest_overlap(3.0) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn integrate_meets_the_cosine() {
        let end = integrate([1.0, 0.0], 20.0, |_, [x, v]| [v, -x]);
        assert!((end[0] - 20.0_f64.cos()).abs() < 1e-9 && (end[1] + 20.0_f64.sin()).abs() < 1e-9);
    }
}
