//! The plate: where it is, and when it moves so hard that static friction gives way.

use std::cell::Cell;

use granule_geometry::Motion;

/// Vectors in the plane of the plate.
pub type Vector = [f64; 2];

#[inline(always)]
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[inline(always)]
pub fn size(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

#[inline(always)]
pub fn sum(a: Vector, factor: f64, b: Vector) -> Vector {
    [a[0] + factor * b[0], a[1] + factor * b[1]]
}

/// How a plate moves, always along x and y.
#[derive(Clone, Debug)]
enum Kind {
    /// Always with this velocity.
    Steady(Vector),
    /// amplitude · sin(ω t + phase), ω > 0.
    Oscillating { amplitude: Vector, angular_frequency: f64, phase: f64 },
    /// Straight lines between rows; the velocity jumps.
    Table(Motion),
}

/// A plate under gravity.
#[derive(Clone, Debug)]
pub struct Plate {
    kind: Kind,
    /// Gravity along the plate \[m/s²\].
    pub along: Vector,
    /// Gravity onto the plate \[m/s²\].
    pub weight: f64,
    /// Largest |g - a_S| along the plate \[m/s²\].
    pub most_pull: f64,
    /// Largest |a_S| \[m/s²\].
    pub most_acceleration: f64,
    /// Largest rate of change of a_S \[m/s³\].
    pub most_jerk: f64,
    /// The moment that was asked for last, and what was there.
    last: Cell<(f64, (Vector, Vector, Vector))>,
}

impl Plate {
    /// `None` for a plate that turns.
    pub fn new(motion: &Motion, gravity: [f64; 3]) -> Option<Self> {
        let along = [gravity[0], gravity[1]];
        let kind = if let Some(velocity) = motion.steady_velocity() {
            Kind::Steady([velocity.x, velocity.y])
        } else if let Some((amplitude, omega, phase)) = motion.oscillation() {
            let sign = if omega < 0.0 { -1.0 } else { 1.0 };
            if omega == 0.0 {
                Kind::Steady([0.0; 2])
            } else {
                Kind::Oscillating {
                    amplitude: [sign * amplitude.x, sign * amplitude.y],
                    angular_frequency: sign * omega,
                    phase: sign * phase,
                }
            }
        } else if motion.rotation_at(0.0).is_some() {
            return None;
        } else {
            Kind::Table(motion.clone())
        };
        let (most_acceleration, most_jerk) = match &kind {
            Kind::Oscillating { amplitude, angular_frequency, .. } => {
                let most = size(*amplitude) * angular_frequency * angular_frequency;
                (most, most * angular_frequency)
            }
            Kind::Steady(_) | Kind::Table(_) => (0.0, 0.0),
        };
        let most_pull = size(along) + most_acceleration;
        let last = Cell::new((f64::NAN, ([0.0; 2], [0.0; 2], [0.0; 2])));
        Some(Self {
            last,
            kind,
            along,
            weight: (-gravity[2]).max(0.0),
            most_pull,
            most_acceleration,
            most_jerk,
        })
    }

    /// Displacement \[m\], velocity \[m/s\] and acceleration \[m/s²\] at a time.
    #[inline]
    pub fn at(&self, time: f64) -> (Vector, Vector, Vector) {
        match &self.kind {
            // An event asks ten times for the same moment.
            Kind::Oscillating { .. } => {
                let (known, last) = self.last.get();
                if known == time {
                    return last;
                }
                let now = self.compute(time);
                self.last.set((time, now));
                now
            }
            Kind::Steady(_) | Kind::Table(_) => self.compute(time),
        }
    }

    fn compute(&self, time: f64) -> (Vector, Vector, Vector) {
        match &self.kind {
            Kind::Steady(velocity) => ([velocity[0] * time, velocity[1] * time], *velocity, [0.0; 2]),
            Kind::Oscillating { amplitude, angular_frequency, phase } => {
                let (sin, cos) = (angular_frequency * time + phase).sin_cos();
                let (speed, pull) = (angular_frequency * cos, -angular_frequency * angular_frequency * sin);
                (amplitude.map(|a| a * sin), amplitude.map(|a| a * speed), amplitude.map(|a| a * pull))
            }
            Kind::Table(motion) => {
                let (d, v) = (motion.displacement(time), motion.velocity(time));
                ([d.x, d.y], [v.x, v.y], [0.0; 2])
            }
        }
    }

    /// True if nothing along the plate ever accelerates a body but friction and jumps of the velocity.
    pub fn is_calm(&self) -> bool {
        self.most_pull == 0.0
    }

    /// Longest piece in which the acceleration of the plate counts as changing slowly \[s\].
    pub fn calm_time(&self) -> f64 {
        match &self.kind {
            Kind::Oscillating { angular_frequency, .. } => std::f64::consts::TAU / 16.0 / angular_frequency,
            Kind::Steady(_) | Kind::Table(_) => f64::INFINITY,
        }
    }

    /// Farthest that the plate gets within a time from `time` on, if its velocity does not jump \[m\].
    #[inline]
    pub fn reach(&self, time: f64, within: f64) -> f64 {
        match &self.kind {
            Kind::Steady(velocity) => size(*velocity) * within,
            Kind::Oscillating { amplitude, angular_frequency, .. } => {
                size(*amplitude) * (angular_frequency * within).min(2.0)
            }
            Kind::Table(motion) => motion.velocity(time).norm() * within,
        }
    }

    /// Displacement and acceleration at a time, and the velocity there on a path that began at `begin`: a jump at `time`
    /// is yet to come.
    #[inline]
    pub fn along_path(&self, begin: f64, time: f64) -> (Vector, Vector, Vector) {
        let (place, mut velocity, acceleration) = self.at(time);
        if let Kind::Table(motion) = &self.kind {
            let before = motion.velocity(begin);
            velocity = [before.x, before.y];
        }
        (place, velocity, acceleration)
    }

    /// Time until the next jump of the velocity, after a time; infinite without one.
    pub fn next_jump(&self, time: f64) -> f64 {
        match &self.kind {
            Kind::Table(motion) => motion.next_jump(time).map_or(f64::INFINITY, |knot| knot - time),
            Kind::Steady(_) | Kind::Oscillating { .. } => f64::INFINITY,
        }
    }

    /// Time until |g - a_S| along the plate exceeds a limit, after a time: 0 if it does already, infinite if it never does.
    pub fn next_exceeding(&self, time: f64, limit: f64) -> f64 {
        let at_rest = size(self.along);
        let Kind::Oscillating { amplitude, angular_frequency, phase } = &self.kind else {
            return if at_rest > limit { 0.0 } else { f64::INFINITY };
        };
        if self.most_pull <= limit {
            return f64::INFINITY;
        }
        // |A y + g|² = limit² with y = sin(ω t + phase) and A = amplitude ω².
        let pull = amplitude.map(|a| a * angular_frequency * angular_frequency);
        let (a, b) = (dot(pull, pull), dot(pull, self.along));
        let discriminant = b * b - a * (at_rest * at_rest - limit * limit);
        if a == 0.0 || discriminant < 0.0 {
            return if at_rest > limit { 0.0 } else { f64::INFINITY };
        }
        let (low, high) = ((-b - discriminant.sqrt()) / a, (-b + discriminant.sqrt()) / a);
        let angle = angular_frequency * time + phase;
        let y = angle.sin();
        if y > high || y < low {
            return 0.0;
        }
        // A turn less round-off is a crossing that happens now.
        let turn = |target: f64| {
            let angle = (target - angle).rem_euclid(std::f64::consts::TAU);
            if angle > std::f64::consts::TAU - 1e-9 { 0.0 } else { angle / angular_frequency }
        };
        let rising = if high < 1.0 { turn(high.max(-1.0).asin()) } else { f64::INFINITY };
        let falling =
            if low > -1.0 { turn(std::f64::consts::PI - low.min(1.0).asin()) } else { f64::INFINITY };
        rising.min(falling)
    }
}
