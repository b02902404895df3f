//! Quantities of a whole system at one moment, as pure functions of a [`View`].
//!
//! Bodies that are frozen are part of the boundary, like walls: they count in no energy, momentum or height. Sums run in
//! the order of the identities and carry their rounding error along, so that they depend neither on the number of threads
//! nor on the order in memory.

use granule_drivers::View;
use granule_plan::Dimensions;

/// A sum that carries the rounding error of its additions along (Neumaier's form of Kahan's sum).
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    fn add(&mut self, value: f64) {
        let next = self.sum + value;
        self.lost +=
            if self.sum.abs() >= value.abs() { (self.sum - next) + value } else { (value - next) + self.sum };
        self.sum = next;
    }

    fn value(self) -> f64 {
        self.sum + self.lost
    }
}

/// Places of the bodies that can move, in the order of their identities, with their ranks in that order.
fn movable<'a>(view: &'a View<'_>) -> impl Iterator<Item = (usize, usize)> + 'a {
    let bodies = view.bodies();
    view.order()
        .iter()
        .enumerate()
        .map(|(rank, &place)| (rank, place as usize))
        .filter(move |(_, place)| !bodies.is_frozen(*place))
}

fn sum(view: &View<'_>, mut term: impl FnMut(usize, usize) -> f64) -> f64 {
    let mut total = Sum::default();
    for (rank, place) in movable(view) {
        total.add(term(rank, place));
    }
    total.value()
}

fn sum_vector(view: &View<'_>, mut term: impl FnMut(usize, usize) -> [f64; 3]) -> [f64; 3] {
    let mut total = [Sum::default(); 3];
    for (rank, place) in movable(view) {
        for (total, component) in total.iter_mut().zip(term(rank, place)) {
            total.add(component);
        }
    }
    total.map(Sum::value)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// Centre of a body without the jumps at periodic boundaries \[m\]: the position inside the cell plus all periods that
/// it has crossed since the start.
pub fn unwrapped_position(view: &View<'_>, rank: usize) -> [f64; 3] {
    let place = view.order()[rank] as usize;
    let (row, image) = (view.bodies().position[place], view.bodies().image[place]);
    let period = view.plan().cell.period();
    std::array::from_fn(|axis| row[axis] + f64::from(image[axis]) * period[axis])
}

/// Kinetic energy of translation, Σ m v²/2 \[J\].
pub fn kinetic_energy(view: &View<'_>) -> f64 {
    let bodies = view.bodies();
    sum(view, |_, place| {
        let velocity = bodies.velocity_of(place);
        0.5 * bodies.mass[place] * dot(velocity, velocity)
    })
}

/// Kinetic energy of rotation, Σ q m R² ω²/2 \[J\]; zero where rotation does not exist.
pub fn rotational_energy(view: &View<'_>) -> f64 {
    if !view.plan().rotation {
        return 0.0;
    }
    let bodies = view.bodies();
    sum(view, |_, place| {
        let spin = bodies.spin_of(place);
        0.5 * dot(spin, spin) / bodies.inverse_inertia_of(place)
    })
}

/// Potential energy in the field of gravity, -Σ m g·x \[J\]: zero at the origin. A body that has crossed a periodic
/// boundary has fallen by the whole way.
pub fn gravity_energy(view: &View<'_>) -> f64 {
    let gravity = view.plan().gravity;
    let bodies = view.bodies();
    sum(view, |rank, place| -bodies.mass[place] * dot(gravity, unwrapped_position(view, rank)))
}

/// Energy stored in contacts \[J\]; zero without the energy ledger.
pub fn elastic_energy(view: &View<'_>) -> f64 {
    view.tally().elastic.iter().sum()
}

/// Linear momentum Σ m v \[kg m/s\].
pub fn momentum(view: &View<'_>) -> [f64; 3] {
    let bodies = view.bodies();
    sum_vector(view, |_, place| bodies.velocity_of(place).map(|v| bodies.mass[place] * v))
}

/// Angular momentum about the origin, Σ (m x × v + q m R² ω) \[kg m²/s\], with unwrapped positions.
pub fn angular_momentum(view: &View<'_>) -> [f64; 3] {
    let bodies = view.bodies();
    let rotation = view.plan().rotation;
    sum_vector(view, |rank, place| {
        let (x, v, mass) = (unwrapped_position(view, rank), bodies.velocity_of(place), bodies.mass[place]);
        let inertia = if rotation { 1.0 / bodies.inverse_inertia_of(place) } else { 0.0 };
        let spin = bodies.spin_of(place);
        std::array::from_fn(|axis| {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            mass * (x[b] * v[c] - x[c] * v[b]) + inertia * spin[axis]
        })
    })
}

/// Contacts with bodies and walls per body, (2 N_pairs + N_walls) / N. All bodies count, frozen ones too.
pub fn coordination_number(view: &View<'_>) -> f64 {
    let tally = view.tally();
    let count = view.order().len();
    if count == 0 { 0.0 } else { (2 * tally.contacts + tally.wall_contacts) as f64 / count as f64 }
}

/// Unit vector against gravity; without gravity along z, in the plane along y.
pub fn upwards(view: &View<'_>) -> [f64; 3] {
    let gravity = view.plan().gravity;
    let size = norm(gravity);
    if size > 0.0 {
        gravity.map(|component| -component / size)
    } else if view.plan().dimensions == Dimensions::Two {
        [0.0, 1.0, 0.0]
    } else {
        [0.0, 0.0, 1.0]
    }
}

/// Mean height of the centres along [`upwards`] \[m\], with unwrapped positions; zero if no body can move.
pub fn mean_height(view: &View<'_>) -> f64 {
    let up = upwards(view);
    let count = movable(view).count();
    let total = sum(view, |rank, _| dot(up, unwrapped_position(view, rank)));
    if count == 0 { 0.0 } else { total / count as f64 }
}

/// Largest height of a centre along [`upwards`] \[m\], with unwrapped positions; zero if no body can move.
pub fn maximum_height(view: &View<'_>) -> f64 {
    let up = upwards(view);
    let heights = movable(view).map(|(rank, _)| dot(up, unwrapped_position(view, rank)));
    heights.reduce(f64::max).unwrap_or(0.0)
}

/// Angle of repose of a heap \[rad\]: the slope of the cone, in the plane of the triangle, of even density that has the same mean
/// height above the lowest point of all bodies and the same mean distance from the vertical through the mean of the centres. A
/// cone of height h and radius R has h/4 and R/2, a triangle h/3 and R/3. All bodies count, those that rolled away, too; zero
/// if none can move, or all are above each other. Positions are unwrapped.
pub fn repose_angle(view: &View<'_>) -> f64 {
    let up = upwards(view);
    let places: Vec<([f64; 3], f64)> = movable(view)
        .map(|(rank, place)| (unwrapped_position(view, rank), view.bodies().position[place].0[3]))
        .collect();
    let lowest = places.iter().map(|(x, radius)| dot(up, *x) - radius).reduce(f64::min);
    let Some(base) = lowest else { return 0.0 };
    let count = places.len() as f64;
    let mean = [0, 1, 2].map(|axis| places.iter().map(|(x, _)| x[axis]).sum::<f64>() / count);
    let height = places.iter().map(|(x, _)| dot(up, *x) - base).sum::<f64>() / count;
    let aside = |x: &[f64; 3]| {
        let from = [x[0] - mean[0], x[1] - mean[1], x[2] - mean[2]];
        let along = dot(up, from);
        norm([from[0] - along * up[0], from[1] - along * up[1], from[2] - along * up[2]])
    };
    let distance = places.iter().map(|(x, _)| aside(x)).sum::<f64>() / count;
    let factor = if view.plan().dimensions == Dimensions::Two { 1.0 } else { 2.0 };
    if distance > 0.0 { libm::atan(factor * height / distance) } else { 0.0 }
}

/// Largest overlap of all contacts \[m\].
pub fn maximum_overlap(view: &View<'_>) -> f64 {
    view.tally().maximum_overlap
}

/// Largest speed of a body \[m/s\].
pub fn maximum_speed(view: &View<'_>) -> f64 {
    let bodies = view.bodies();
    movable(view).map(|(_, place)| norm(bodies.velocity_of(place))).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_keeps_what_rounding_would_lose() {
        let mut sum = Sum::default();
        for value in [1.0, 1e100, 1.0, -1e100] {
            sum.add(value);
        }
        assert_eq!(sum.value(), 2.0);
    }
}
