//! Visiting tiles with exclusive access to the rows of their bodies, in parallel and without copies.

use granule_integrators::{Integrator, Pass, Tile as RowTile};
use granule_state::{Bodies, Row};

use crate::engine::Sweep;
use crate::level::Level;
use crate::tile::{Evaluation, Tile};

/// Rows of consecutive bodies. Columns that the layout does not have stay empty when split.
pub(crate) struct Rows<'a> {
    position: &'a mut [Row],
    velocity: &'a mut [Row],
    force: &'a mut [Row],
    spin: &'a mut [Row],
    torque: &'a mut [Row],
    previous: &'a mut [Row],
    previous_angular: &'a mut [Row],
    predicted: &'a mut [Row],
    predicted_angular: &'a mut [Row],
    planar_inverse_inertia: &'a [f64],
    planar: bool,
}

impl<'a> Rows<'a> {
    pub fn of(bodies: &'a mut Bodies) -> Self {
        let planar = bodies.layout().planar;
        Self {
            position: &mut bodies.position,
            velocity: &mut bodies.velocity,
            force: &mut bodies.force,
            spin: &mut bodies.spin,
            torque: &mut bodies.torque,
            previous: &mut bodies.previous_acceleration,
            previous_angular: &mut bodies.previous_angular_acceleration,
            predicted: &mut bodies.predicted_acceleration,
            predicted_angular: &mut bodies.predicted_angular_acceleration,
            planar_inverse_inertia: &bodies.planar_inverse_inertia,
            planar,
        }
    }

    fn split(self, at: usize) -> (Self, Self) {
        fn cut(rows: &mut [Row], at: usize) -> (&mut [Row], &mut [Row]) {
            let at = at.min(rows.len());
            rows.split_at_mut(at)
        }
        let (position, position_rest) = cut(self.position, at);
        let (velocity, velocity_rest) = cut(self.velocity, at);
        let (force, force_rest) = cut(self.force, at);
        let (spin, spin_rest) = cut(self.spin, at);
        let (torque, torque_rest) = cut(self.torque, at);
        let (previous, previous_rest) = cut(self.previous, at);
        let (previous_angular, previous_angular_rest) = cut(self.previous_angular, at);
        let (predicted, predicted_rest) = cut(self.predicted, at);
        let (predicted_angular, predicted_angular_rest) = cut(self.predicted_angular, at);
        let (inertia, inertia_rest) =
            self.planar_inverse_inertia.split_at(at.min(self.planar_inverse_inertia.len()));
        let planar = self.planar;
        (
            Self {
                position,
                velocity,
                force,
                spin,
                torque,
                previous,
                previous_angular,
                predicted,
                predicted_angular,
                planar_inverse_inertia: inertia,
                planar,
            },
            Self {
                position: position_rest,
                velocity: velocity_rest,
                force: force_rest,
                spin: spin_rest,
                torque: torque_rest,
                previous: previous_rest,
                previous_angular: previous_angular_rest,
                predicted: predicted_rest,
                predicted_angular: predicted_angular_rest,
                planar_inverse_inertia: inertia_rest,
                planar,
            },
        )
    }
}

/// Calls `work` for the tiles `first..end` with their rows and combines what the passes report; `None` without tiles.
pub(crate) fn visit<F: Fn(usize, Rows<'_>) -> Pass + Sync>(
    first: usize,
    end: usize,
    rows: Rows<'_>,
    size: usize,
    parallel: bool,
    work: &F,
) -> Option<Pass> {
    if end <= first {
        return None;
    }
    if end - first == 1 {
        return Some(work(first, rows));
    }
    let middle = first + (end - first) / 2;
    let (left, right) = rows.split((middle - first) * size);
    let (left, right) = if parallel {
        rayon::join(
            || visit(first, middle, left, size, true, work),
            || visit(middle, end, right, size, true, work),
        )
    } else {
        (visit(first, middle, left, size, false, work), visit(middle, end, right, size, false, work))
    };
    match (left, right) {
        (Some(left), Some(right)) => Some(Pass {
            maximum_displacement_squared: left
                .maximum_displacement_squared
                .max(right.maximum_displacement_squared),
            poison: left.poison + right.poison,
        }),
        (one, other) => one.or(other),
    }
}

/// One sweep of the integration over one tile.
pub(crate) fn sweep(
    tile: usize,
    rows: Rows<'_>,
    tiles: &[Tile],
    level: &Level,
    integrator: &dyn Integrator,
    kind: Sweep,
    dt: f64,
) -> Pass {
    if kind != Sweep::Begin {
        crate::dispatch::receive(level.instructions, &tiles[tile].inbox, tiles, rows.force, rows.torque);
    }
    let mut rows = RowTile {
        position: rows.position,
        velocity: rows.velocity,
        force: rows.force,
        spin: rows.spin,
        torque: rows.torque,
        previous: rows.previous,
        previous_angular: rows.previous_angular,
        predicted: rows.predicted,
        predicted_angular: rows.predicted_angular,
        planar_inverse_inertia: rows.planar_inverse_inertia,
        planar: rows.planar,
        instructions: level.instructions,
    };
    match kind {
        Sweep::Receive => Pass::default(),
        Sweep::Begin => integrator.begin(&mut rows, dt),
        Sweep::Finish => integrator.finish(&mut rows, dt),
        Sweep::FinishBegin => integrator.finish_begin(&mut rows, dt),
    }
}

/// Evaluates the forces of all tiles.
pub(crate) fn forces(
    tiles: &mut [Tile],
    force: &mut [Row],
    torque: &mut [Row],
    size: usize,
    parallel: bool,
    level: &Level,
    at: &Evaluation<'_>,
) {
    match tiles {
        [] => {}
        [tile] => tile.evaluate(level, at, force, torque),
        _ => {
            let middle = tiles.len() / 2;
            let (left, right) = tiles.split_at_mut(middle);
            let (force_left, force_right) = force.split_at_mut(middle * size);
            let (torque_left, torque_right) = torque.split_at_mut((middle * size).min(torque.len()));
            if parallel {
                rayon::join(
                    || forces(left, force_left, torque_left, size, true, level, at),
                    || forces(right, force_right, torque_right, size, true, level, at),
                );
            } else {
                forces(left, force_left, torque_left, size, false, level, at);
                forces(right, force_right, torque_right, size, false, level, at);
            }
        }
    }
}
