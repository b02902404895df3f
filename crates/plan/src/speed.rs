//! How fast an impact of the run may be, from the initial state.

use granule_geometry::Surface;
use granule_scene::{MotionChoice, RunBlock, Scene};
use nalgebra::Vector3;

use crate::laws::Setting;

/// Where the impact speed comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SpeedReason {
    /// The scene gives it.
    Given,
    /// Velocities at the start, a fall, moving walls.
    Estimate {
        /// Largest relative speed of two bodies, or of a body and a wall at rest \[m/s\].
        start: f64,
        /// Height of the fall \[m\].
        fall: f64,
        /// Fastest wall \[m/s\].
        wall: f64,
    },
    /// Nothing moves: a hundredth of a radius in the time to fall it, or 1 mm/s.
    Rest,
}

impl SpeedReason {
    pub fn text(self) -> String {
        match self {
            Self::Given => "given by the scene".to_string(),
            Self::Estimate { start, fall, wall } => format!(
                "estimated from a relative speed of {start:.3e} m/s at the start, a fall of {fall:.3e} m and walls at \
                 {wall:.3e} m/s"
            ),
            Self::Rest => {
                "a nominal value, as nothing moves at the start; set `impact_speed` to change it".to_string()
            }
        }
    }
}

/// Nominal impact speed where nothing moves \[m/s\].
const NOMINAL: f64 = 1e-3;

/// Largest impact speed to expect.
pub(crate) fn estimate(setting: &Setting<'_>, scene: &Scene) -> (f64, SpeedReason) {
    let speed = |v: &[f64; 3]| Vector3::from(*v).norm();
    let (mut first, mut second) = (0.0f64, 0.0f64);
    for body in setting.bodies {
        let v = speed(&body.velocity);
        (first, second) = if v > first { (v, first) } else { (first, second.max(v)) };
    }
    let start = first + second;
    let wall =
        scene.walls.items.iter().map(|wall| wall_speed(&wall.motion.value, setting)).fold(0.0, f64::max);
    let plate = scene.substrate.as_ref().and_then(|substrate| substrate.motion.as_ref());
    let wall = wall.max(plate.map_or(0.0, |motion| wall_speed(&motion.value, setting)));
    // A substrate carries the bodies: they fall along it only.
    let gravity = match &scene.substrate {
        Some(_) => Vector3::new(setting.gravity[0], setting.gravity[1], 0.0),
        None => Vector3::from(setting.gravity),
    };
    let g = gravity.norm();
    let fall = if g > 0.0 { fall(setting, gravity / g) } else { 0.0 };
    // A fall from any height is cut short by the end of the run.
    let gain = match &scene.run {
        Some(RunBlock::Duration(duration)) => g * duration.value,
        _ => f64::INFINITY,
    };
    let falling = ((start * start + 2.0 * g * fall).sqrt()).min(start + gain);
    let total = falling + wall;
    if total.is_finite() && total > 0.0 {
        (total, SpeedReason::Estimate { start, fall, wall })
    } else {
        (NOMINAL, SpeedReason::Rest)
    }
}

fn wall_speed(motion: &MotionChoice, setting: &Setting<'_>) -> f64 {
    let norm = |v: &granule_scene::Vector| v.components.iter().map(|c| c.value * c.value).sum::<f64>().sqrt();
    match motion {
        MotionChoice::Static => 0.0,
        MotionChoice::Constant { velocity } => norm(velocity),
        MotionChoice::Sinusoidal { amplitude, angular_frequency, .. } => {
            norm(amplitude) * angular_frequency.abs()
        }
        MotionChoice::Table(rows) => rows
            .windows(2)
            .map(|pair| {
                let squared: f64 = pair[0]
                    .1
                    .components
                    .iter()
                    .zip(&pair[1].1.components)
                    .map(|(a, b)| (b.value - a.value) * (b.value - a.value))
                    .sum();
                squared.sqrt() / (pair[1].0.value - pair[0].0.value)
            })
            .fold(0.0, f64::max),
        MotionChoice::Rotation { point, angular_velocity, .. } => {
            // As far out as the farthest body.
            let at = |axis: usize| point.components.get(axis).map_or(0.0, |c| c.value);
            let centre = Vector3::new(at(0), at(1), at(2));
            let arm = setting
                .bodies
                .iter()
                .map(|body| (Vector3::from(body.position) - centre).norm() + body.radius)
                .fold(0.0, f64::max);
            angular_velocity.abs() * arm
        }
    }
}

/// Largest height that a body can fall: to the first plane below it, else to the lowest body.
fn fall(setting: &Setting<'_>, down: Vector3<f64>) -> f64 {
    let depth = |body: &crate::bodies::Draft| Vector3::from(body.position).dot(&down) + body.radius;
    let deepest = setting.bodies.iter().map(depth).fold(f64::NEG_INFINITY, f64::max);
    let surfaces: Vec<Surface> = setting.walls.iter().map(|wall| wall.wall.surface_at(0.0)).collect();
    let mut most = 0.0f64;
    for body in setting.bodies.iter().filter(|body| !body.frozen) {
        let position = Vector3::from(body.position);
        let floor = surfaces
            .iter()
            .filter_map(|surface| match surface {
                Surface::Plane(plane) => {
                    let slope = -plane.normal().dot(&down);
                    (slope > 1e-6)
                        .then(|| ((plane.contact(position).distance - body.radius) / slope).max(0.0))
                }
                // Across a drum, at most its diameter.
                Surface::Cylinder(cylinder) if cylinder.inside() => {
                    let slope = (1.0 - cylinder.axis().dot(&down).powi(2)).max(0.0).sqrt();
                    (slope > 1e-6).then(|| 2.0 * cylinder.radius() / slope)
                }
                Surface::Cylinder(_) => None,
            })
            .fold(f64::INFINITY, f64::min);
        let height = if floor.is_finite() { floor } else { (deepest - depth(body)).max(0.0) };
        most = most.max(height);
    }
    most
}
