//! Planes, at rest or moving, and when bodies reach them.

use granule_geometry::{Surface, Wall};
use nalgebra::Vector3;

use crate::flight::{Root, fall_through, safe_root};
use crate::setup::EventError;

/// How far a plane is displaced along its normal.
#[derive(Clone, Copy, Debug)]
enum Shift {
    /// At a steady speed \[m/s\], which may be 0.
    Steady(f64),
    /// amplitude · sin(ω t + phase) along the normal \[m\].
    Oscillating { amplitude: f64, angular_frequency: f64, phase: f64 },
}

/// A plane wall.
#[derive(Clone, Debug)]
pub struct PlaneWall {
    wall: Wall,
    pub normal: [f64; 3],
    /// n·x of the plane at rest.
    offset: f64,
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

impl PlaneWall {
    pub fn new(wall: &Wall, index: usize) -> Result<Self, EventError> {
        let Surface::Plane(plane) = wall.surface() else {
            return Err(EventError::Wall { wall: index, what: "a cylinder" });
        };
        let normal = plane.normal();
        let shift = if wall.keeps_its_place() {
            Shift::Steady(0.0)
        } else if let Some(velocity) = wall.motion().steady_velocity() {
            Shift::Steady(velocity.dot(&normal))
        } else if let Some((amplitude, angular_frequency, phase)) = wall.motion().oscillation() {
            Shift::Oscillating { amplitude: amplitude.dot(&normal), angular_frequency, phase }
        } else {
            let what = match wall.motion().rotation_at(0.0) {
                Some(_) => "a plane that turns out of its place",
                None => "a plane that moves by a table",
            };
            return Err(EventError::Wall { wall: index, what });
        };
        Ok(Self { wall: wall.clone(), normal: normal.into(), offset: plane.point().dot(&normal), shift })
    }

    /// Displacement along the normal \[m\], its speed \[m/s\] and acceleration \[m/s²\] at an absolute time.
    fn displacement(&self, time: f64) -> (f64, f64, f64) {
        match self.shift {
            Shift::Steady(speed) => (speed * time, speed, 0.0),
            Shift::Oscillating { amplitude, angular_frequency, phase } => {
                let (sin, cos) = (angular_frequency * time + phase).sin_cos();
                let speed = amplitude * angular_frequency;
                (amplitude * sin, speed * cos, -speed * angular_frequency * sin)
            }
        }
    }

    /// Distance of a centre from the plane \[m\] at an absolute time.
    pub fn distance(&self, position: [f64; 3], time: f64) -> f64 {
        let n = self.normal;
        n[0] * position[0] + n[1] * position[1] + n[2] * position[2] - self.offset - self.displacement(time).0
    }

    /// Velocity of the wall's material at a place \[m/s\].
    pub fn velocity(&self, position: [f64; 3], time: f64) -> [f64; 3] {
        self.wall.velocity_at(Vector3::from(position), time).into()
    }

    /// Acceleration with which a freely falling body is drawn towards the wall \[m/s²\].
    pub fn pull(&self, gravity: [f64; 3], time: f64) -> f64 {
        let n = self.normal;
        self.displacement(time).2 - (n[0] * gravity[0] + n[1] * gravity[1] + n[2] * gravity[2])
    }

    /// When a body of the given radius, at `position` with `velocity` at an absolute `time`, reaches the wall within
    /// `horizon`. `round_off` is a length below which gaps are nothing.
    pub fn reach(
        &self,
        (position, velocity, gravity): ([f64; 3], [f64; 3], [f64; 3]),
        radius: f64,
        time: f64,
        horizon: f64,
        round_off: f64,
    ) -> Reach {
        let n = self.normal;
        let along = |v: [f64; 3]| n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
        let (speed, acceleration) = (along(velocity), along(gravity));
        match self.shift {
            Shift::Steady(wall) => {
                let gap = self.distance(position, time) - radius;
                match fall_through(gap, speed - wall, acceleration) {
                    Some(after) if after <= horizon => Reach::At(after),
                    _ => Reach::Never,
                }
            }
            Shift::Oscillating { amplitude, angular_frequency, .. } => {
                let rest = along(position) - self.offset - radius;
                let relative = |after: f64| {
                    let (place, wall, _) = self.displacement(time + after);
                    let gap = rest + after * (speed + 0.5 * after * acceleration) - place;
                    (gap, speed + acceleration * after - wall)
                };
                let curvature =
                    acceleration.abs() + (amplitude * angular_frequency * angular_frequency).abs();
                let least = 1e-9 / angular_frequency.abs().max(f64::MIN_POSITIVE);
                match safe_root(relative, curvature, horizon, round_off, least) {
                    Root::At(after) => Reach::At(after),
                    Root::PositiveUntil(after) if after >= horizon => Reach::Never,
                    Root::PositiveUntil(after) => Reach::AskAgain(after),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use granule_geometry::{Cylinder, Motion, Plane};

    fn floor(motion: Motion) -> PlaneWall {
        let plane = Plane::new(Vector3::zeros(), Vector3::z()).unwrap();
        PlaneWall::new(&Wall::new(plane, motion), 0).unwrap()
    }

    #[test]
    fn a_rising_floor_meets_a_falling_ball() {
        let floor = floor(Motion::constant_velocity(Vector3::new(3.0, 0.0, 1.0)).unwrap());
        let flight = ([0.0, 0.0, 5.5], [0.0; 3], [0.0; 3]);
        // Five metres of gap at 1 m/s.
        assert_eq!(floor.reach(flight, 0.5, 0.0, 10.0, 1e-15), Reach::At(5.0));
        assert_eq!(floor.reach(flight, 0.5, 0.0, 4.0, 1e-15), Reach::Never);
        assert_eq!(floor.velocity([0.0; 3], 1.0), [3.0, 0.0, 1.0]);
    }

    #[test]
    fn a_shaken_floor_is_met_when_it_comes() {
        let floor = floor(Motion::sinusoidal(Vector3::z() * 0.1, 2.0, 0.0).unwrap());
        // At rest half an amplitude above the middle: sin(2 t) = 1/2.
        let Reach::At(time) = floor.reach(([0.0, 0.0, 1.05], [0.0; 3], [0.0; 3]), 1.0, 0.0, 10.0, 1e-15)
        else {
            panic!("it comes")
        };
        // The tolerance of the gap, 1e-15 m, over the speed of the wall.
        assert!((time - std::f64::consts::PI / 12.0).abs() < 1e-13);
        assert!(floor.pull([0.0, 0.0, -9.81], time) < 9.81, "the floor slows down");
    }

    #[test]
    fn other_walls_are_refused() {
        let drum = Cylinder::new(Vector3::zeros(), Vector3::y(), 2.0, true).unwrap();
        assert!(PlaneWall::new(&Wall::new(drum, Motion::fixed()), 3).is_err());
        let plane = Plane::new(Vector3::zeros(), Vector3::x()).unwrap();
        let turning = Motion::rotation(Vector3::zeros(), Vector3::z(), 1.0).unwrap();
        assert!(PlaneWall::new(&Wall::new(plane, turning), 0).is_err());
        let turning = Motion::rotation(Vector3::zeros(), Vector3::x(), 1.0).unwrap();
        assert!(PlaneWall::new(&Wall::new(plane, turning), 0).is_ok(), "it turns in its own plane");
        let table = Motion::table(vec![(0.0, Vector3::zeros()), (1.0, Vector3::x())]).unwrap();
        assert!(PlaneWall::new(&Wall::new(plane, table), 0).is_err());
    }
}
