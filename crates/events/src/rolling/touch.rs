//! When two bodies on arcs touch.
//!
//! Both move by a parabola and a share of the motion of the plate. Where the shares are equal, the squared distance is a
//! polynomial of the fourth degree in time. Its least second derivative over the horizon is known in closed form, which lets
//! the safe search step as far as no contact can hide, and converge to the first one quadratically.

use super::plate::{Plate, Vector, dot, size, sum};
use crate::flight::{Root, safe_root};

/// Relative motion of two centres from a moment on.
#[derive(Clone, Copy, Debug)]
pub struct Approach {
    /// Separation \[m\].
    pub place: Vector,
    /// Its rate without the share of the plate \[m/s\].
    pub velocity: Vector,
    /// Its acceleration without the share of the plate \[m/s²\].
    pub acceleration: Vector,
    /// Difference of the shares of the motion of the plate.
    pub share: f64,
}

/// When they touch within a horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Touch {
    /// Not at all.
    Never,
    /// After this time.
    At(f64),
    /// Not before this time, when it must be asked again.
    AskAgain(f64),
}

impl Touch {
    fn of(root: Root, horizon: f64) -> Self {
        match root {
            Root::At(after) => Self::At(after),
            Root::PositiveUntil(after) if after >= horizon => Self::Never,
            Root::PositiveUntil(after) => Self::AskAgain(after),
        }
    }
}

/// The first contact at a squared distance of `contact` (m²) within `horizon`.
#[inline]
pub fn touch(approach: &Approach, contact: f64, plate: &Plate, time: f64, horizon: f64) -> Touch {
    let Approach { place: r, velocity: w, acceleration: a, share } = *approach;
    let apart = dot(r, r) - contact;
    // As far as the distance can shrink: |r| - shrink > σ means |r|² > σ² + 2 σ shrink + shrink².
    let (ww, aa) = (dot(w, w), dot(a, a));
    if horizon.is_finite() {
        let plate_shrink = if share == 0.0 { 0.0 } else { share.abs() * plate.reach(time, horizon) };
        let shrink = ww.sqrt() * horizon + 0.5 * aa.sqrt() * horizon * horizon + plate_shrink;
        if apart > shrink * (2.0 * contact.sqrt() + shrink) {
            return Touch::Never;
        }
    }
    let round_off = 4.0 * f64::EPSILON * contact;
    if share != 0.0 {
        return touch_shaken(approach, contact, plate, time, horizon, round_off);
    }
    let c = [apart, 2.0 * dot(r, w), ww + dot(r, a), dot(w, a), 0.25 * aa];
    let end = if horizon.is_finite() { horizon } else { last_root(&c) };
    let second = |t: f64| 2.0 * c[2] + t * (6.0 * c[3] + 12.0 * c[4] * t);
    let mut least = second(0.0).min(second(end));
    if c[4] > 0.0 {
        let vertex = -c[3] / (4.0 * c[4]);
        if vertex > 0.0 && vertex < end {
            least = least.min(second(vertex));
        }
    }
    if c[1] >= 0.0 && least >= 0.0 {
        return Touch::Never;
    }
    let curvature = (-least).max(0.0);
    let value = |t: f64| {
        (
            c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * c[4]))),
            c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * 4.0 * c[4])),
        )
    };
    let step = if curvature > 0.0 { (round_off / curvature).sqrt() } else { 0.0 };
    Touch::of(safe_root(value, curvature, end, round_off, step), horizon)
}

/// A time after which the polynomial is positive (Cauchy's bound of its roots).
fn last_root(c: &[f64; 5]) -> f64 {
    let Some(degree) = (1..5).rev().find(|degree| c[*degree] != 0.0) else { return 0.0 };
    // Roots of Σ c_k t^k are below 2 max |c_k/c_d|^(1/(d - k)) (Fujiwara).
    let mut bound: f64 = 0.0;
    for k in 0..degree {
        bound = bound.max((c[k] / c[degree]).abs().powf(1.0 / (degree - k) as f64));
    }
    2.0 * bound
}

fn touch_shaken(
    approach: &Approach,
    contact: f64,
    plate: &Plate,
    time: f64,
    horizon: f64,
    round_off: f64,
) -> Touch {
    let Approach { place, velocity, acceleration, share } = *approach;
    let (start, _, _) = plate.at(time);
    let value = |t: f64| {
        let (there, speed, _) = plate.at(time + t);
        let r = [0, 1].map(|k| {
            place[k] + t * (velocity[k] + 0.5 * t * acceleration[k]) + share * (there[k] - start[k])
        });
        let w = [0, 1].map(|k| velocity[k] + t * acceleration[k] + share * speed[k]);
        (dot(r, r) - contact, 2.0 * dot(r, w))
    };
    // d²|r|²/dt² ≥ -2 |r| |a|, wherever they are closer than now.
    let pull = size(acceleration) + share.abs() * plate.most_acceleration;
    let mut begin = 0.0;
    // Part by part: the bound of the distance is tight where the part is short.
    for _ in 0..64 {
        let moved = sum(velocity, share, plate.at(time + begin).1);
        let speed = size(sum(moved, begin, acceleration));
        let distance = (value(begin).0 + contact).max(0.0).sqrt();
        // A part in which the distance grows by no more than itself.
        let part = if speed > 0.0 { distance / speed } else { f64::INFINITY };
        let part = part.min(if pull > 0.0 { (2.0 * distance / pull).sqrt() } else { f64::INFINITY });
        let part = part.min(horizon - begin);
        if !part.is_finite() {
            return Touch::Never;
        }
        let farthest = distance + part * (speed + 0.5 * pull * part);
        let curvature = 2.0 * farthest * pull;
        let step = if curvature > 0.0 { (round_off / curvature).sqrt() } else { 0.0 };
        match safe_root(|t| value(begin + t), curvature, part, round_off, step) {
            Root::At(after) => return Touch::At(begin + after),
            Root::PositiveUntil(after) if after < part => return Touch::AskAgain(begin + after),
            Root::PositiveUntil(_) => begin += part,
        }
        if begin >= horizon {
            return Touch::Never;
        }
    }
    Touch::AskAgain(begin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use granule_geometry::Motion;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    fn shaken() -> Plate {
        Plate::new(&Motion::sinusoidal(Vector3::new(0.4, 0.1, 0.0), 7.0, 0.4).unwrap(), [0.0, 0.0, -9.81])
            .unwrap()
    }

    proptest! {
        #[test]
        fn the_first_contact_is_that_of_a_scan(
            r in prop::array::uniform2(-3.0f64..3.0), w in prop::array::uniform2(-3.0f64..3.0),
            a in prop::array::uniform2(-2.0f64..2.0), share in prop::sample::select(vec![0.0, 0.3, -0.7]),
            horizon in prop::sample::select(vec![0.5, 3.0, f64::INFINITY]),
        ) {
            prop_assume!(dot(r, r) > 1.0);
            let plate = shaken();
            let end = if horizon.is_finite() { horizon } else { 20.0 };
            prop_assume!(horizon.is_finite() || share == 0.0);
            let approach = Approach { place: r, velocity: w, acceleration: a, share };
            let there = |t: f64| {
                let d = sum(plate.at(0.7 + t).0, -1.0, plate.at(0.7).0);
                [0, 1].map(|k| r[k] + t * (w[k] + 0.5 * t * a[k]) + share * d[k])
            };
            let found = touch(&approach, 1.0, &plate, 0.7, horizon);
            match found {
                Touch::At(t) => {
                    prop_assert!((size(there(t)) - 1.0).abs() < 1e-7, "{t}: {}", size(there(t)));
                    for k in 0..2000 { prop_assert!(size(there(t * f64::from(k) / 2000.0)) > 1.0 - 1e-9); }
                }
                Touch::Never => for k in 0..=4000 {
                    prop_assert!(size(there(end * f64::from(k) / 4000.0)) > 1.0 - 1e-9);
                },
                Touch::AskAgain(t) => for k in 0..=2000 {
                    prop_assert!(size(there(t * f64::from(k) / 2000.0)) > 1.0 - 1e-9);
                },
            }
        }
    }

    #[test]
    fn bodies_that_just_touched_and_are_pressed_together_touch_again() {
        // Leaves at 1, comes back after 2 · 1/4.
        let approach =
            Approach { place: [1.0, 0.0], velocity: [1.0, 0.0], acceleration: [-4.0, 0.0], share: 0.0 };
        let plate = shaken();
        let Touch::At(time) = touch(&approach, 1.0, &plate, 0.0, 10.0) else { panic!("it comes back") };
        assert!((time - 0.5).abs() < 1e-12, "{time}");
    }
}
