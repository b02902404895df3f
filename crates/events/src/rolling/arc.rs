//! Pieces of arcs: how friction slows a velocity that other forces change.
//!
//! Slip and rolling velocity obey the same equation, dw/dt = b(t) - c w/|w| with b = f (g - a_S): f = 1 and c = (1 + Q) μ_k g
//! for the slip, f = Q/(1 + Q) and c = μ_r g for the rolling velocity. Along a piece the direction of the friction is
//! constant, so that w follows exactly. Without b there is a single piece, from the beginning to rest.

use super::plate::{Plate, Vector, dot, size, sum};
use crate::flight::{Root, safe_root};

/// A velocity relative to the plate under friction.
#[derive(Clone, Copy, Debug)]
pub struct Slowing {
    /// The velocity w \[m/s\].
    pub velocity: Vector,
    /// Share f of g - a_S that changes it.
    pub share: f64,
    /// Deceleration c by friction \[m/s²\].
    pub rate: f64,
    /// What friction does to the centre \[m/s²\]: it decides how much a wrong direction matters.
    pub centre_rate: f64,
}

/// A piece of constant friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Against this unit vector friction acts; zero if there is none.
    pub direction: Vector,
    /// Length \[s\], maybe infinite.
    pub duration: f64,
    /// The velocity is zero at its end.
    pub stops: bool,
}

/// The next piece from a time on, at most `horizon` long. `error` is the wanted error of the centre over a piece \[m\].
pub fn piece(plate: &Plate, time: f64, slowing: &Slowing, error: f64, horizon: f64) -> Piece {
    let Slowing { velocity, share, rate, centre_rate } = *slowing;
    let speed = size(velocity);
    if rate <= 0.0 {
        return Piece { direction: [0.0; 2], duration: horizon, stops: false };
    }
    if plate.is_calm() {
        let direction = if speed > 0.0 { velocity.map(|w| w / speed) } else { [0.0; 2] };
        let duration = speed / rate;
        return Piece { direction, duration: duration.min(horizon), stops: duration <= horizon };
    }
    let (_, plate_velocity, acceleration) = plate.at(time);
    let pull = |acceleration: Vector| sum(plate.along, -1.0, acceleration).map(|b| share * b);
    // ∫b over a part of the piece.
    let gained = |after: f64| {
        let (_, later, _) = plate.at(time + after);
        [0, 1].map(|k| share * (plate.along[k] * after - (later[k] - plate_velocity[k])))
    };
    let start = pull(acceleration);
    // A wrong direction over h costs centre_rate h²/2 at most; one that turns by |b×w| h/w² costs centre_rate |b×w| h³/(4 w²).
    let shortest = (error / centre_rate).sqrt();
    let across = (velocity[0] * start[1] - velocity[1] * start[0]).abs();
    let turning = if across > 0.0 {
        (4.0 * error * speed * speed / (centre_rate * across)).cbrt()
    } else {
        plate.calm_time()
    };
    let length = turning.max(shortest).min(plate.calm_time()).min(horizon);
    if speed > 0.0 && speed <= (share * plate.most_pull + rate) * length {
        let left = |after: f64| {
            let free = sum(velocity, 1.0, gained(after));
            let (_, _, acceleration) = plate.at(time + after);
            let slope = pull(acceleration);
            (
                dot(free, free) - rate * rate * after * after,
                2.0 * dot(free, slope) - 2.0 * rate * rate * after,
            )
        };
        let fastest = speed + share * plate.most_pull * length;
        let curvature = 2.0 * rate * rate + 2.0 * fastest * share * plate.most_jerk;
        let round_off = 1e-14 * speed * speed;
        let least = (round_off / curvature).sqrt();
        if let Root::At(after) = safe_root(left, curvature, length, round_off, least)
            && after > 0.0
        {
            let free = sum(velocity, 1.0, gained(after));
            let total = size(free);
            if total > 0.0 {
                return Piece { direction: free.map(|w| w / total), duration: after, stops: true };
            }
        }
    }
    let before = if speed > 0.0 { velocity.map(|w| w / speed) } else { [0.0; 2] };
    let half = 0.5 * length;
    let middle = sum(sum(velocity, 1.0, gained(half)), -rate * half, before);
    let total = size(middle);
    let direction = if total > 0.0 { middle.map(|w| w / total) } else { before };
    Piece { direction, duration: length, stops: false }
}

#[cfg(test)]
mod tests {
    use super::*;
    use granule_geometry::Motion;
    use nalgebra::Vector3;

    fn shaken() -> Plate {
        let motion = Motion::sinusoidal(Vector3::new(2e-3, 1e-3, 0.0), 60.0, 0.3).unwrap();
        Plate::new(&motion, [0.3, -0.2, -9.81]).unwrap()
    }

    /// Slip on a shaken, tilted plate until it stops or a time is over: place of the centre less that of free motion.
    fn follow(plate: &Plate, error: f64, end: f64) -> (Vector, Vector) {
        let (rate, centre_rate) = (3.5 * 0.981, 0.981);
        let (mut time, mut w, mut x, mut v) = (0.0, [0.4, 0.3], [0.0; 2], [0.0; 2]);
        while time < end {
            let slowing = Slowing { velocity: w, share: 1.0, rate, centre_rate };
            let next = piece(plate, time, &slowing, error, end - time);
            let (_, before, _) = plate.at(time);
            let (_, after, _) = plate.at(time + next.duration);
            let h = next.duration;
            for k in 0..2 {
                w[k] += plate.along[k] * h - (after[k] - before[k]) - rate * h * next.direction[k];
                x[k] += h * v[k] - 0.5 * h * h * centre_rate * next.direction[k];
                v[k] -= h * centre_rate * next.direction[k];
            }
            if next.stops {
                break;
            }
            time += h;
        }
        (x, w)
    }

    #[test]
    fn on_a_calm_plate_one_piece_ends_at_the_closed_form() {
        let plate = Plate::new(&Motion::fixed(), [0.0, 0.0, -9.81]).unwrap();
        let slowing = Slowing { velocity: [3.0, 4.0], share: 1.0, rate: 2.0, centre_rate: 0.5 };
        let found = piece(&plate, 7.0, &slowing, 1e-9, f64::INFINITY);
        assert_eq!(found, Piece { direction: [0.6, 0.8], duration: 2.5, stops: true });
    }

    /// Friction whose direction is that of the middle of each piece: the error of a piece is of the third order in its length
    /// at least, so that of the path falls as (error)^(2/3) or faster.
    #[test]
    fn pieces_converge_with_the_error_that_is_asked_for() {
        let plate = shaken();
        let exact = follow(&plate, 1e-16, 0.1).0;
        let off = |error: f64| {
            let found = follow(&plate, error, 0.1).0;
            size(sum(found, -1.0, exact))
        };
        let (coarse, fine) = (off(1e-8), off(1e-11));
        assert!(coarse < 1e-6, "{coarse}");
        // 1000^(2/3) = 100, with a margin of 3 for where pieces end.
        assert!(fine < coarse / 30.0, "{coarse} {fine}");
        // Velocities are wrong by 2 error/h a piece, which acts until the end: N² error over all N < 30 pieces.
        assert!(fine < 1e-8, "{fine}");
    }

    #[test]
    fn a_limit_is_exceeded_when_a_scan_says() {
        for plate in [
            shaken(),
            Plate::new(&Motion::sinusoidal(Vector3::x() * 1e-3, -60.0, 1.0).unwrap(), [0.0, 0.0, -9.81])
                .unwrap(),
        ] {
            for limit in [0.5, 1.0, 3.0, 5.0, 7.9, 20.0] {
                for start in 0..20 {
                    let start = 0.013 * f64::from(start);
                    let excess = |t: f64| size(sum(plate.along, -1.0, plate.at(start + t).2)) - limit;
                    let scan = (0..40_000).map(|k| 5e-6 * f64::from(k)).find(|t| excess(*t) > 0.0);
                    let found = plate.next_exceeding(start, limit);
                    match scan {
                        // A step of the scan.
                        Some(time) => {
                            assert!((time - found).abs() <= 6e-6, "{limit} {start}: {time} {found}")
                        }
                        None => assert!(found > 0.19, "{limit} {start}: {found}"),
                    }
                }
            }
        }
    }
}
