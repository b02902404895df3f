//! When free flights end: closed forms for straight and parabolic relative motion, and a safe search for the rest.

/// Time until two spheres touch whose centres are `r` apart (m) and move by `w` (m/s), if they do: the smaller root of
/// |r + w τ| = σ. Pairs that overlap by round-off and approach touch at once.
#[inline(always)]
pub fn touch(r: [f64; 3], w: [f64; 3], contact: f64) -> Option<f64> {
    let b = r[0] * w[0] + r[1] * w[1] + r[2] * w[2];
    if b >= 0.0 {
        return None;
    }
    let rr = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    let ww = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
    let c = rr - contact * contact;
    if c <= 0.0 {
        return Some(0.0);
    }
    let discriminant = b * b - ww * c;
    // The form without cancellation: c = (smaller root)(larger root) ww.
    (discriminant >= 0.0).then(|| c / (discriminant.sqrt() - b))
}

/// Time until `gap + speed τ + acceleration τ²/2` falls through zero. A gap that is negative by round-off counts as zero;
/// `Some(0)` if it would go on closing.
pub fn fall_through(gap: f64, speed: f64, acceleration: f64) -> Option<f64> {
    let gap = gap.max(0.0);
    if gap == 0.0 && (speed < 0.0 || (speed == 0.0 && acceleration < 0.0)) {
        return Some(0.0);
    }
    if acceleration == 0.0 {
        return (speed < 0.0).then(|| -gap / speed);
    }
    let discriminant = speed * speed - 2.0 * acceleration * gap;
    if acceleration < 0.0 {
        let root = discriminant.max(0.0).sqrt();
        return Some(if speed < 0.0 { 2.0 * gap / (root - speed) } else { (speed + root) / -acceleration });
    }
    (speed < 0.0 && discriminant >= 0.0).then(|| 2.0 * gap / (discriminant.sqrt() - speed))
}

/// Time at which a body leaves the sphere of radius `s` about the origin, from `d` with velocity `v`; infinite at rest.
#[inline(always)]
pub fn leave(d: [f64; 3], v: [f64; 3], s: f64) -> f64 {
    let vv = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if vv == 0.0 {
        return f64::INFINITY;
    }
    let b = d[0] * v[0] + d[1] * v[1] + d[2] * v[2];
    let c = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - s * s).min(0.0);
    let root = (b * b - vv * c).sqrt();
    if b < 0.0 { (root - b) / vv } else { -c / (root + b) }
}

/// As [`leave`] under an acceleration `g`: a time at which the body is still inside, close to the end of its stay.
pub fn leave_falling(d: [f64; 3], v: [f64; 3], g: [f64; 3], s: f64) -> f64 {
    let length = |a: [f64; 3]| (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt();
    let fall = length(g);
    let mut time = 0.0;
    for _ in 0..16 {
        let at: [f64; 3] = std::array::from_fn(|k| d[k] + time * (v[k] + 0.5 * time * g[k]));
        let speed = length(std::array::from_fn(|k| v[k] + time * g[k]));
        let gap = s - length(at);
        if gap <= 0.02 * s {
            break;
        }
        // No path is longer than speed h + g h²/2, so the body stays inside for h.
        let h = 2.0 * gap / (speed + (speed * speed + 2.0 * fall * gap).sqrt());
        if h == f64::INFINITY {
            return h;
        }
        time += h;
    }
    time
}

/// What a safe search found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Root {
    /// The function falls through zero at this time.
    At(f64),
    /// It is positive up to this time; nothing is known beyond.
    PositiveUntil(f64),
}

/// First time within `horizon` at which `f` falls through zero. `f` gives value and slope; its second derivative is at
/// least `-curvature`. Each step goes as far as the parabola of that curvature stays positive, so no root is passed over,
/// and near a root the steps converge quadratically. `least` is a step that may be taken wherever the function does not
/// fall: `curvature`·least² must be below round-off.
pub fn safe_root(
    f: impl Fn(f64) -> (f64, f64),
    curvature: f64,
    horizon: f64,
    tolerance: f64,
    least: f64,
) -> Root {
    let mut time = 0.0;
    for _ in 0..200 {
        let (value, slope) = f(time);
        if value <= tolerance && slope < 0.0 {
            return Root::At(time);
        }
        if time >= horizon {
            return Root::PositiveUntil(horizon);
        }
        let value = value.max(0.0);
        let root = (slope * slope + 2.0 * curvature * value).sqrt();
        // The form without cancellation for either sign of the slope.
        let step = if slope < 0.0 {
            let step = 2.0 * value / (root - slope);
            if time + step == time {
                return Root::At(time);
            }
            step
        } else if curvature > 0.0 {
            ((slope + root) / curvature).max(least)
        } else {
            f64::INFINITY
        };
        time += step;
        time = if time < horizon { time } else { horizon };
    }
    Root::PositiveUntil(time)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn spheres_touch_at_the_closed_form() {
        // Head on: the gap of 1 closes at 2.
        assert_eq!(touch([2.0, 0.0, 0.0], [-2.0, 0.0, 0.0], 1.0), Some(0.5));
        assert_eq!(touch([2.0, 0.0, 0.0], [2.0, 0.0, 0.0], 1.0), None);
        assert_eq!(touch([2.0, 1.1, 0.0], [-2.0, 0.0, 0.0], 1.0), None);
        assert_eq!(touch([0.999_999_999, 0.0, 0.0], [-2.0, 0.0, 0.0], 1.0), Some(0.0));
    }

    #[test]
    fn a_ball_falls_on_the_floor() {
        // From rest at height 5 under 10 m/s²: one second; thrown up with 3 m/s from the floor: 0.6 s.
        assert_eq!(fall_through(5.0, 0.0, -10.0), Some(1.0));
        assert_eq!(fall_through(0.0, 3.0, -10.0), Some(0.6));
        assert_eq!(fall_through(-1e-18, 3.0, -10.0), Some(0.6));
        assert_eq!(fall_through(0.0, 0.0, -10.0), Some(0.0));
        assert_eq!(fall_through(1.0, -1.0, 10.0), None);
        assert_eq!(fall_through(1.0, 1.0, 0.0), None);
        assert_eq!(fall_through(1.0, -2.0, 0.0), Some(0.5));
    }

    proptest! {
        #[test]
        fn touching_pairs_touch(r in prop::array::uniform3(-3.0f64..3.0), w in prop::array::uniform3(-2.0f64..2.0)) {
            let at = |t: f64| (0..3).map(|k| (r[k] + w[k] * t).powi(2)).sum::<f64>().sqrt();
            prop_assume!(at(0.0) > 1.0);
            match touch(r, w, 1.0) {
                // The distance changes by at most |w| times the rounding of the time, which grows where paths graze.
                Some(t) => prop_assert!((at(t) - 1.0).abs() < 1e-9),
                None => for k in 0..200 { prop_assert!(at(0.05 * f64::from(k)) >= 1.0); },
            }
        }

        #[test]
        fn falls_are_the_first_crossing(gap in 0.0f64..3.0, speed in -3.0f64..3.0, a in -3.0f64..3.0) {
            let at = |t: f64| gap + speed * t + 0.5 * a * t * t;
            match fall_through(gap, speed, a) {
                Some(t) => {
                    prop_assert!(at(t).abs() < 1e-9 * (1.0 + t * t));
                    for k in 1..100 { prop_assert!(at(t * f64::from(k) / 100.0) > -1e-9 * (1.0 + t * t)); }
                }
                None => for k in 0..200 { prop_assert!(at(0.1 * f64::from(k)) >= -1e-12); },
            }
        }

        #[test]
        fn a_body_is_on_the_rim_when_it_leaves(
            d in prop::array::uniform3(-0.5f64..0.5), v in prop::array::uniform3(-2.0f64..2.0),
            g in prop::array::uniform3(-4.0f64..4.0),
        ) {
            let size = |a: [f64; 3]| a.iter().map(|c| c * c).sum::<f64>().sqrt();
            prop_assume!(size(v) > 1e-3);
            let t = leave(d, v, 1.0);
            prop_assert!((size(std::array::from_fn(|k| d[k] + v[k] * t)) - 1.0).abs() < 1e-12);
            let t = leave_falling(d, v, g, 1.0);
            prop_assert!(t > 0.0);
            for step in 0..=50 {
                let t = t * f64::from(step) / 50.0;
                prop_assert!(size(std::array::from_fn(|k| d[k] + t * (v[k] + 0.5 * g[k] * t))) <= 1.0 + 1e-12);
            }
        }

        /// A ball over a shaken floor: the first crossing agrees with a fine scan.
        #[test]
        fn the_safe_search_finds_the_first_crossing(
            gap in 0.0f64..2.0, speed in -3.0f64..3.0, amplitude in 0.0f64..1.0, omega in 0.5f64..20.0,
            phase in 0.0f64..6.3,
        ) {
            let height = |t: f64| gap + speed * t - 5.0 * t * t - amplitude * ((omega * t + phase).sin() - phase.sin());
            let slope = |t: f64| speed - 10.0 * t - amplitude * omega * (omega * t + phase).cos();
            let curvature = 10.0 + amplitude * omega * omega;
            let mut start = 0.0;
            let found = loop {
                match safe_root(|t| (height(start + t), slope(start + t)), curvature, 10.0, 1e-14, 1e-9 / omega) {
                    Root::At(t) => break start + t,
                    Root::PositiveUntil(t) => start += t,
                }
                prop_assert!(start < 10.0);
            };
            prop_assert!(height(found).abs() < 1e-9);
            for k in 0..=2000 {
                let t = found * f64::from(k) / 2000.0;
                prop_assert!(height(t) > -1e-12, "passed over a crossing at {t} before {found}");
            }
        }
    }
}
