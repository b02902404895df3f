//! How two bodies, or a body and a wall, move against each other during one step.

use granule_geometry::Wall;
use granule_plan::Composition;
use granule_state::Row;
use nalgebra::Vector3;

use crate::chunk::share;
use crate::space::Space;
use crate::tile::{Evaluation, Shared};

/// Accelerations of the step that the evaluation ends.
#[derive(Clone, Copy)]
pub(crate) struct StepRows<'a> {
    /// At its beginning.
    pub previous: &'a [Row],
    pub previous_angular: &'a [Row],
    /// Those with which velocities were predicted to its end.
    pub predicted: &'a [Row],
    pub predicted_angular: &'a [Row],
    /// Bound of what any distance has changed in the step \[m\].
    pub margin: f64,
}

/// Motion of a body in a step: at its beginning and its end.
#[derive(Clone, Copy)]
struct Motion {
    displacement: Vector3<f64>,
    velocity: [Vector3<f64>; 2],
    spin: [Vector3<f64>; 2],
}

impl Motion {
    fn of<S: Space>(bodies: &Shared<'_>, rows: &StepRows<'_>, place: usize, dt: f64) -> Self {
        let vector = |row: &Row| Vector3::new(row[0], row[1], if S::PLANAR { 0.0 } else { row[2] });
        let end = Vector3::from(bodies.velocity::<S>(place));
        let half = end - vector(&rows.predicted[place]) * (0.5 * dt);
        let start = half - vector(&rows.previous[place]) * (0.5 * dt);
        let spin_end = Vector3::from(bodies.spin::<S>(place));
        let angular = |linear: &[Row], angular: &[Row]| {
            if !S::ROTATION {
                Vector3::zeros()
            } else if S::PLANAR {
                Vector3::new(0.0, 0.0, linear[place][2])
            } else {
                angular[place].vector().into()
            }
        };
        let change =
            angular(rows.predicted, rows.predicted_angular) + angular(rows.previous, rows.previous_angular);
        Self {
            displacement: half * dt,
            velocity: [start, end],
            spin: [spin_end - change * (0.5 * dt), spin_end],
        }
    }
}

/// What the laws of a contact see at one moment.
#[derive(Clone, Copy)]
pub(crate) struct Kinematics {
    pub overlap: f64,
    pub normal: Vector3<f64>,
    pub normal_velocity: f64,
    pub tangential_velocity: Vector3<f64>,
    pub relative_spin: Vector3<f64>,
    /// Lever arms of the torques on i and j.
    pub arms: [f64; 2],
}

/// A pair during a step. Of a wall, j is what touches body i: it has no radius and no spin.
#[derive(Clone, Copy)]
pub(crate) struct Path {
    /// From j to i, at the beginning and the end of the step \[m\].
    separation: [Vector3<f64>; 2],
    velocity: [Vector3<f64>; 2],
    spin_i: [Vector3<f64>; 2],
    spin_j: [Vector3<f64>; 2],
    radius_i: f64,
    radius_j: f64,
    slip_share: f64,
    torque_share: f64,
    pub reduced_mass: f64,
    pub reduced_radius: f64,
}

impl Path {
    /// Bodies i and j, at all places, with their separation at the end of the step.
    pub fn of_bodies<S: Space>(
        at: &Evaluation<'_>,
        rows: &StepRows<'_>,
        composition: &Composition,
        (i, j): (usize, usize),
        separation: Vector3<f64>,
    ) -> Self {
        let dt = at.time_step;
        let of = |place| Motion::of::<S>(at.bodies, rows, place, dt);
        let (a, b) = (of(i), of(j));
        let (radius_i, radius_j) = (at.bodies.position[i][3], at.bodies.position[j][3]);
        let conventions = &composition.context.conventions;
        Self {
            separation: [separation - (a.displacement - b.displacement), separation],
            velocity: [a.velocity[0] - b.velocity[0], a.velocity[1] - b.velocity[1]],
            spin_i: a.spin,
            spin_j: b.spin,
            radius_i,
            radius_j,
            slip_share: share(conventions.pair_slip_arm),
            torque_share: share(conventions.pair_torque_arm),
            reduced_mass: 1.0 / (at.bodies.velocity[i][3] + at.bodies.velocity[j][3]),
            reduced_radius: radius_i * radius_j / (radius_i + radius_j),
        }
    }

    /// Body `place` and a wall at the end of the step.
    pub fn at_wall<S: Space>(
        at: &Evaluation<'_>,
        rows: &StepRows<'_>,
        composition: &Composition,
        place: usize,
        (wall, time): (&Wall, f64),
    ) -> Self {
        let dt = at.time_step;
        let body = Motion::of::<S>(at.bodies, rows, place, dt);
        let row = at.bodies.position[place];
        let end = Vector3::new(row[0], row[1], row[2]);
        let mut curvature_radius = f64::INFINITY;
        let mut touch = |position: Vector3<f64>, time: f64| {
            let contact = wall.surface_at(time).contact(position);
            curvature_radius = contact.curvature_radius;
            let arm = contact.normal * contact.distance;
            (arm, wall.velocity_at(position - arm, time))
        };
        let (first, moving_first) = touch(end - body.displacement, time - dt);
        let (last, moving_last) = touch(end, time);
        let inverse_mass = at.bodies.velocity[place][3];
        let conventions = &composition.context.conventions;
        Self {
            separation: [first, last],
            velocity: [body.velocity[0] - moving_first, body.velocity[1] - moving_last],
            spin_i: body.spin,
            spin_j: [Vector3::zeros(); 2],
            radius_i: row[3],
            radius_j: 0.0,
            slip_share: share(conventions.wall_slip_arm),
            torque_share: share(conventions.wall_torque_arm),
            reduced_mass: if inverse_mass > 0.0 { 1.0 / inverse_mass } else { at.bodies.mass[place] },
            reduced_radius: 1.0 / (1.0 / row[3] + 1.0 / curvature_radius),
        }
    }

    /// Overlaps at the beginning and the end of the step.
    pub fn overlaps(&self) -> [f64; 2] {
        self.separation.map(|separation| self.radius_i + self.radius_j - separation.norm())
    }

    /// The contact after a part `q` of the step. Everything changes evenly with time in it.
    pub fn at(&self, q: f64) -> Kinematics {
        let mean = |[start, end]: [Vector3<f64>; 2]| start + (end - start) * q;
        let [first, last] = self.overlaps();
        let overlap = first + (last - first) * q;
        let (velocity, wi, wj) = (mean(self.velocity), mean(self.spin_i), mean(self.spin_j));
        let normal = mean(self.separation).try_normalize(0.0).unwrap_or_else(Vector3::x);
        let along = velocity.dot(&normal);
        let arm = |radius: f64, share: f64| if radius > 0.0 { radius - share * overlap } else { 0.0 };
        let surface = wi * arm(self.radius_i, self.slip_share) + wj * arm(self.radius_j, self.slip_share);
        Kinematics {
            overlap,
            normal,
            normal_velocity: -along,
            tangential_velocity: velocity - normal * along + normal.cross(&surface),
            relative_spin: wi - wj,
            arms: [arm(self.radius_i, self.torque_share), arm(self.radius_j, self.torque_share)],
        }
    }
}
