//! Planes and cylinders, at rest or moving, and when bodies reach them.

use granule_geometry::{Cylinder, Surface, Wall};
use nalgebra::Vector3;

use crate::flight::{Root, fall_through, leave, safe_root, touch};
use crate::setup::EventError;

/// How a wall is displaced.
#[derive(Clone, Copy, Debug)]
enum Shift {
    /// At a steady velocity \[m/s\], which may be 0.
    Steady(Vector3<f64>),
    /// amplitude · sin(ω t + phase) \[m\].
    Oscillating { amplitude: Vector3<f64>, angular_frequency: f64, phase: f64 },
    /// Along straight lines between given times.
    Table,
}

/// A wall that hard bodies meet.
#[derive(Clone, Debug)]
pub struct HardWall {
    wall: Wall,
    shift: Shift,
}

/// When a body reaches a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// Not within the horizon.
    Never,
    /// After this time.
    At(f64),
    /// Not before this time, when it must be asked again.
    AskAgain(f64),
}

/// A flight: place \[m\], velocity \[m/s\], acceleration \[m/s²\].
pub type Flight = ([f64; 3], [f64; 3], [f64; 3]);

impl HardWall {
    pub fn new(wall: &Wall, index: usize) -> Result<Self, EventError> {
        let shift = if wall.keeps_its_place() {
            Shift::Steady(Vector3::zeros())
        } else if let Some(velocity) = wall.motion().steady_velocity() {
            Shift::Steady(velocity)
        } else if let Some((amplitude, angular_frequency, phase)) = wall.motion().oscillation() {
            Shift::Oscillating { amplitude, angular_frequency, phase }
        } else if wall.motion().is_table() {
            Shift::Table
        } else {
            return Err(EventError::Wall { wall: index, what: "turns out of its place" });
        };
        Ok(Self { wall: wall.clone(), shift })
    }

    /// True where bodies may slide along a hollow, against which their motion presses them.
    pub fn is_hollow(wall: &Wall) -> bool {
        matches!(wall.surface(), Surface::Cylinder(cylinder) if cylinder.inside())
    }

    /// Displacement \[m\], its velocity \[m/s\] and acceleration \[m/s²\] at an absolute time.
    fn displacement(&self, time: f64) -> [Vector3<f64>; 3] {
        match self.shift {
            Shift::Steady(velocity) => [velocity * time, velocity, Vector3::zeros()],
            Shift::Oscillating { amplitude, angular_frequency, phase } => {
                let (sin, cos) = (angular_frequency * time + phase).sin_cos();
                let speed = amplitude * angular_frequency;
                [amplitude * sin, speed * cos, -speed * (angular_frequency * sin)]
            }
            Shift::Table => {
                let motion = self.wall.motion();
                [motion.displacement(time), motion.velocity(time), Vector3::zeros()]
            }
        }
    }

    /// Distance of a centre from the surface \[m\], positive where bodies may be, at an absolute time.
    pub fn distance(&self, position: [f64; 3], time: f64) -> f64 {
        self.contact(position, time).0
    }

    /// Distance of a centre from the surface \[m\] and the normal towards it, at an absolute time.
    pub fn contact(&self, position: [f64; 3], time: f64) -> (f64, [f64; 3]) {
        let [place, ..] = self.displacement(time);
        let contact = self.wall.surface().contact(Vector3::from(position) - place);
        (contact.distance, contact.normal.into())
    }

    /// Velocity of the wall's material at a place \[m/s\].
    pub fn velocity(&self, position: [f64; 3], time: f64) -> [f64; 3] {
        self.wall.velocity_at(Vector3::from(position), time).into()
    }

    /// Acceleration with which a body in free flight is drawn towards the wall \[m/s²\]: it falls, the wall comes, or a hollow
    /// surface turns into its way.
    pub fn pull(&self, (position, velocity, gravity): Flight, time: f64) -> f64 {
        let [place, wall_velocity, acceleration] = self.displacement(time);
        let at = Vector3::from(position) - place;
        let normal = self.wall.surface().contact(at).normal;
        let falling = (acceleration - Vector3::from(gravity)).dot(&normal);
        let Surface::Cylinder(cylinder) = self.wall.surface() else { return falling };
        let u = across(cylinder, Vector3::from(velocity) - wall_velocity);
        let along_wall = u - normal * u.dot(&normal);
        let bend = along_wall.norm_squared() / across(cylinder, at - cylinder.point()).norm();
        if cylinder.inside() { falling + bend } else { falling - bend }
    }

    /// When a body of the given radius, in flight from an absolute `time` on, reaches the wall within `horizon`.
    pub fn reach(&self, flight: Flight, radius: f64, time: f64, horizon: f64) -> Reach {
        match self.shift {
            Shift::Steady(velocity) => {
                self.reach_steady(flight, radius, (velocity * time, velocity), time, horizon)
            }
            Shift::Oscillating { .. } => self.reach_curved(flight, radius, time, horizon),
            Shift::Table => {
                // A time that is a jump but for round-off belongs to the line that begins there.
                let motion = self.wall.motion();
                let now = time + 8.0 * f64::EPSILON * time.abs();
                let jump = motion.next_jump(now).map_or(f64::INFINITY, |jump| jump - time);
                let place = (motion.displacement(now), motion.velocity(now));
                match self.reach_steady(flight, radius, place, time, horizon.min(jump)) {
                    Reach::Never if jump < horizon => Reach::AskAgain(jump),
                    found => found,
                }
            }
        }
    }

    /// The wall is displaced by `place` and moves at a steady velocity.
    fn reach_steady(
        &self,
        flight: Flight,
        radius: f64,
        (place, wall): (Vector3<f64>, Vector3<f64>),
        time: f64,
        horizon: f64,
    ) -> Reach {
        let (position, velocity, gravity) = flight;
        let (at, u) = (Vector3::from(position) - place, Vector3::from(velocity) - wall);
        let within = |after: Option<f64>| match after {
            Some(after) if after <= horizon => Reach::At(after),
            _ => Reach::Never,
        };
        match self.wall.surface() {
            Surface::Plane(plane) => {
                let n = plane.normal();
                let gap = plane.contact(at).distance - radius;
                within(fall_through(gap, u.dot(&n), Vector3::from(gravity).dot(&n)))
            }
            Surface::Cylinder(cylinder) => {
                if across(cylinder, Vector3::from(gravity)) != Vector3::zeros() {
                    return self.reach_curved(flight, radius, time, horizon);
                }
                let (r, u) = (across(cylinder, at - cylinder.point()).into(), across(cylinder, u).into());
                within(if cylinder.inside() {
                    // On the rim without a speed across it: the wall is met at once.
                    let after = leave(r, u, cylinder.radius() - radius);
                    Some(if after.is_nan() { 0.0 } else { after })
                } else {
                    touch(r, u, cylinder.radius() + radius)
                })
            }
        }
    }

    /// The relative motion is curved: a safe search.
    fn reach_curved(&self, flight: Flight, radius: f64, time: f64, horizon: f64) -> Reach {
        let (position, velocity, gravity) = flight;
        let (x, v, g) = (Vector3::from(position), Vector3::from(velocity), Vector3::from(gravity));
        let relative = |after: f64| {
            let [place, wall, _] = self.displacement(time + after);
            (x + after * (v + 0.5 * after * g) - place, v + after * g - wall)
        };
        let (fastest, omega) = match self.shift {
            Shift::Oscillating { amplitude, angular_frequency, .. } => {
                (amplitude * (angular_frequency * angular_frequency), angular_frequency.abs())
            }
            Shift::Steady(_) | Shift::Table => (Vector3::zeros(), 0.0),
        };
        let (found, horizon_here) = match self.wall.surface() {
            Surface::Plane(plane) => {
                let n = plane.normal();
                let gap = |after: f64| {
                    let (at, u) = relative(after);
                    (plane.contact(at).distance - radius, u.dot(&n))
                };
                let curvature = g.dot(&n).abs() + fastest.dot(&n).abs();
                let least = 1e-9 / omega.max(f64::MIN_POSITIVE);
                (safe_root(gap, curvature, horizon, 4.0 * f64::EPSILON * radius, least), horizon)
            }
            Surface::Cylinder(cylinder) => {
                let sign = if cylinder.inside() { -1.0 } else { 1.0 };
                let reach = cylinder.radius() + sign * radius;
                let gap = |after: f64| {
                    let (at, u) = relative(after);
                    let r = across(cylinder, at - cylinder.point());
                    (sign * (r.norm_squared() - reach * reach), sign * 2.0 * r.dot(&u))
                };
                let (at, u) = relative(0.0);
                let far = across(cylinder, at - cylinder.point()).norm() + reach;
                let pull = across(cylinder, g).norm() + across(cylinder, fastest).norm();
                let speed = across(cylinder, u).norm();
                // Within the time of this motion over this distance speeds stay of this size; beyond it, ask again.
                let here = horizon.min(far / (speed + (pull * far).sqrt()));
                let speed = speed + pull * here;
                let curvature = if cylinder.inside() {
                    2.0 * (speed * speed + reach * pull)
                } else {
                    2.0 * (far + speed * here) * pull
                };
                let round_off = 4.0 * f64::EPSILON * reach * reach;
                let least = (round_off / curvature).sqrt();
                (safe_root(gap, curvature, here, round_off, least), here)
            }
        };
        match found {
            Root::At(after) => Reach::At(after),
            Root::PositiveUntil(after) if after >= horizon_here && horizon_here >= horizon => Reach::Never,
            Root::PositiveUntil(after) => Reach::AskAgain(after),
        }
    }
}

/// The part of a vector that is normal to the axis of a cylinder.
fn across(cylinder: &Cylinder, v: Vector3<f64>) -> Vector3<f64> {
    v - cylinder.axis() * v.dot(&cylinder.axis())
}

#[cfg(test)]
mod tests {
    use super::*;
    use granule_geometry::{Motion, Plane};
    use proptest::prelude::*;

    fn floor(motion: Motion) -> HardWall {
        let plane = Plane::new(Vector3::zeros(), Vector3::z()).unwrap();
        HardWall::new(&Wall::new(plane, motion), 0).unwrap()
    }

    fn cylinder(radius: f64, inside: bool, motion: Motion) -> HardWall {
        let cylinder = Cylinder::new(Vector3::new(0.3, 0.0, 0.1), Vector3::y(), radius, inside).unwrap();
        HardWall::new(&Wall::new(cylinder, motion), 0).unwrap()
    }

    #[test]
    fn a_rising_floor_meets_a_falling_ball() {
        let floor = floor(Motion::constant_velocity(Vector3::new(3.0, 0.0, 1.0)).unwrap());
        let flight = ([0.0, 0.0, 5.5], [0.0; 3], [0.0; 3]);
        // Five metres of gap at 1 m/s.
        assert_eq!(floor.reach(flight, 0.5, 0.0, 10.0), Reach::At(5.0));
        assert_eq!(floor.reach(flight, 0.5, 0.0, 4.0), Reach::Never);
        assert_eq!(floor.velocity([0.0; 3], 1.0), [3.0, 0.0, 1.0]);
    }

    #[test]
    fn a_shaken_floor_is_met_when_it_comes() {
        let floor = floor(Motion::sinusoidal(Vector3::z() * 0.1, 2.0, 0.0).unwrap());
        // At rest half an amplitude above the middle: sin(2 t) = 1/2.
        let flight = ([0.0, 0.0, 1.05], [0.0; 3], [0.0; 3]);
        let Reach::At(time) = floor.reach(flight, 1.0, 0.0, 10.0) else { panic!("it comes") };
        // The tolerance of the gap, 1e-15 m, over the speed of the wall.
        assert!((time - std::f64::consts::PI / 12.0).abs() < 1e-13);
        assert!(floor.pull(([0.0; 3], [0.0; 3], [0.0, 0.0, -9.81]), time) < 9.81, "the floor slows down");
    }

    #[test]
    fn a_table_is_followed_from_jump_to_jump() {
        let rows = vec![(1.0, Vector3::zeros()), (2.0, Vector3::z() * 0.5), (4.0, Vector3::z() * 0.5)];
        let floor = floor(Motion::table(rows).unwrap());
        let rests = ([0.0, 0.0, 1.25], [0.0; 3], [0.0; 3]);
        assert_eq!(floor.reach(rests, 1.0, 0.0, 10.0), Reach::AskAgain(1.0));
        // A quarter of a metre at half a metre a second.
        for now in [1.0, 1.0 - 1e-16] {
            let Reach::At(after) = floor.reach(rests, 1.0, now, 10.0) else { panic!("it comes") };
            assert!((after - 0.5).abs() < 1e-14);
        }
        assert_eq!(floor.reach(([0.0, 0.0, 2.0], [0.0; 3], [0.0; 3]), 1.0, 4.0, 10.0), Reach::Never);
    }

    #[test]
    fn drums_and_posts_are_met_where_circles_are() {
        let drum = cylinder(2.0, true, Motion::fixed());
        let from_axis = ([0.3, 5.0, 0.1], [3.0, 7.0, 4.0], [0.0; 3]);
        assert_eq!(drum.reach(from_axis, 0.5, 0.0, 10.0), Reach::At(0.3));
        let post = cylinder(2.0, false, Motion::constant_velocity(Vector3::x()).unwrap());
        assert_eq!(post.reach(([5.3, 5.0, 0.1], [0.0; 3], [0.0; 3]), 0.5, 0.0, 10.0), Reach::At(2.5));
        // Straight down from the axis by s: half g t².
        let falls = ([0.3, 0.0, 0.1], [0.0; 3], [0.0, 0.0, -10.0]);
        let mut time = 0.0;
        let found = loop {
            let at = 0.1 - 5.0 * time * time;
            match drum.reach(([0.3, 0.0, at], [0.0, 0.0, -10.0 * time], falls.2), 0.5, time, 10.0) {
                Reach::At(after) => break time + after,
                Reach::AskAgain(after) => time += after,
                Reach::Never => panic!("it falls on the wall"),
            }
        };
        assert!((found - 0.3f64.sqrt()).abs() < 1e-14, "{found}");
        // A body that runs around in a drum of effective radius 1.5 at 3 m/s is pressed on it by 6 m/s².
        let round = ([0.3, 0.0, -1.4], [3.0, 1.0, 0.0], [0.0; 3]);
        assert!((drum.pull(round, 0.0) - 6.0).abs() < 1e-12);
        assert_eq!(drum.reach(round, 0.5, 0.0, 1.0), Reach::At(0.0));
    }

    #[test]
    fn other_walls_are_refused() {
        let plane = Plane::new(Vector3::zeros(), Vector3::x()).unwrap();
        let turning = Motion::rotation(Vector3::zeros(), Vector3::z(), 1.0).unwrap();
        assert!(HardWall::new(&Wall::new(plane, turning), 0).is_err());
        let turning = Motion::rotation(Vector3::zeros(), Vector3::x(), 1.0).unwrap();
        assert!(HardWall::new(&Wall::new(plane, turning), 0).is_ok(), "it turns in its own plane");
    }

    proptest! {
        /// The first contact on a curved way agrees with a fine scan, for drums and posts, at rest and shaken.
        #[test]
        fn nothing_flies_through_a_cylinder(
            inside: bool, at in prop::array::uniform3(-0.8f64..0.8), v in prop::array::uniform3(-3.0f64..3.0),
            g in prop::array::uniform3(-5.0f64..5.0), amplitude in prop::array::uniform3(-0.2f64..0.2), omega in 0.5f64..15.0,
        ) {
            let motion = Motion::sinusoidal(Vector3::from(amplitude), omega, 0.3).unwrap();
            let wall = if inside { cylinder(2.0, true, motion) } else { cylinder(0.4, false, motion) };
            let start = if inside { at } else { [at[0] + 2.5, at[1], at[2]] };
            let place = |t: f64| std::array::from_fn(|k| start[k] + t * (v[k] + 0.5 * t * g[k]));
            let gap = |t: f64| wall.distance(place(t), t) - 0.5;
            prop_assume!(gap(0.0) > 1e-3);
            let (mut time, end) = (0.0, 1.5);
            let found = loop {
                let velocity = std::array::from_fn(|k| v[k] + time * g[k]);
                match wall.reach((place(time), velocity, g), 0.5, time, end - time) {
                    Reach::At(after) => break time + after,
                    Reach::AskAgain(after) => { prop_assert!(after > 0.0); time += after }
                    Reach::Never => break end,
                }
            };
            prop_assert!(found >= end || gap(found).abs() < 1e-12, "{found}: {:e}", gap(found));
            for k in 0..3000 {
                let t = found * f64::from(k) / 3000.0;
                prop_assert!(gap(t) > -1e-12, "passed through at {t} before {found}: {:e}", gap(t));
            }
        }
    }
}
