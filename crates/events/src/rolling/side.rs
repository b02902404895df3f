//! Upright planes at the sides of a plate, at rest or moving.

use granule_geometry::{Surface, Wall};

use super::plate::{Vector, dot};
use crate::setup::EventError;

/// How a plane moves along its normal.
#[derive(Clone, Copy, Debug)]
enum Shift {
    /// At a steady speed \[m/s\], which may be 0.
    Steady(f64),
    /// amplitude · sin(ω t + phase) \[m\].
    Oscillating { amplitude: f64, angular_frequency: f64, phase: f64 },
    /// Along straight lines between given times.
    Table,
}

/// An upright plane that bodies on a plate meet.
#[derive(Clone, Debug)]
pub struct SideWall {
    wall: Wall,
    /// Unit normal, towards where bodies may be.
    pub normal: Vector,
    offset: f64,
    shift: Shift,
}

impl SideWall {
    pub fn new(wall: &Wall, index: usize) -> Result<Self, EventError> {
        let refused = |what| EventError::Wall { wall: index, what };
        let Surface::Plane(plane) = wall.surface() else {
            return Err(refused("is not a plane, as the walls of bodies on a plate must be"));
        };
        let n = plane.normal();
        if n.z != 0.0 {
            return Err(refused("is not upright, as the walls of bodies on a plate must be"));
        }
        let shift = if wall.keeps_its_place() {
            Shift::Steady(0.0)
        } else if let Some(velocity) = wall.motion().steady_velocity() {
            Shift::Steady(velocity.dot(&n))
        } else if let Some((amplitude, angular_frequency, phase)) = wall.motion().oscillation() {
            Shift::Oscillating { amplitude: amplitude.dot(&n), angular_frequency, phase }
        } else if wall.motion().is_table() {
            Shift::Table
        } else {
            return Err(refused("turns out of its place"));
        };
        Ok(Self { wall: wall.clone(), normal: [n.x, n.y], offset: plane.point().dot(&n), shift })
    }

    /// Displacement along the normal \[m\], its speed \[m/s\] and acceleration \[m/s²\] at a time.
    fn displacement(&self, time: f64) -> [f64; 3] {
        match self.shift {
            Shift::Steady(speed) => [speed * time, speed, 0.0],
            Shift::Oscillating { amplitude, angular_frequency, phase } => {
                let (sin, cos) = (angular_frequency * time + phase).sin_cos();
                let speed = amplitude * angular_frequency;
                [amplitude * sin, speed * cos, -speed * angular_frequency * sin]
            }
            Shift::Table => {
                let (motion, [x, y]) = (self.wall.motion(), self.normal);
                let (d, v) = (motion.displacement(time), motion.velocity(time));
                [d.x * x + d.y * y, v.x * x + v.y * y, 0.0]
            }
        }
    }

    /// Distance of a centre from the plane \[m\], positive where bodies may be, and the speed of the plane towards it \[m/s\].
    #[inline]
    pub fn gap(&self, place: Vector, time: f64) -> (f64, f64) {
        let [moved, speed, _] = self.displacement(time);
        (dot(self.normal, place) - self.offset - moved, speed)
    }

    /// Velocity of the wall's material at a place \[m/s\].
    pub fn velocity(&self, place: [f64; 3], time: f64) -> [f64; 3] {
        self.wall.velocity_at(place.into(), time).into()
    }

    /// Acceleration with which a body is drawn towards the wall \[m/s²\], if its own is `acceleration`.
    pub fn pull(&self, acceleration: Vector, time: f64) -> f64 {
        self.displacement(time)[2] - dot(acceleration, self.normal)
    }

    /// Largest acceleration along the normal \[m/s²\].
    pub fn most_acceleration(&self) -> f64 {
        match self.shift {
            Shift::Steady(_) | Shift::Table => 0.0,
            Shift::Oscillating { amplitude, angular_frequency, .. } => {
                (amplitude * angular_frequency * angular_frequency).abs()
            }
        }
    }

    /// Time until the next jump of the velocity, after a time; infinite without one.
    pub fn next_jump(&self, time: f64) -> f64 {
        match self.shift {
            Shift::Table => self.wall.motion().next_jump(time).map_or(f64::INFINITY, |jump| jump - time),
            Shift::Steady(_) | Shift::Oscillating { .. } => f64::INFINITY,
        }
    }
}
