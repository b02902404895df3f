//! Force and torques of one contact.

use super::coefficients::Coefficients;
use super::vector::{Vector, ZERO, add, cross, dot, norm, scale, sub};
use super::{Arm, ContactEnd, ConventionSet, CoulombCap, CoulombTest, HistoryOrder};

/// One side of a contact: a body, or a wall with radius zero and without spin.
#[derive(Clone, Copy)]
pub struct Partner {
    pub radius: f64,
    pub velocity: Vector,
    pub spin: Vector,
}

/// Geometry and motion of a contact.
pub struct Contact {
    /// From the second to the first.
    pub normal: Vector,
    pub overlap: f64,
    pub first: Partner,
    pub second: Partner,
    pub wall: bool,
}

/// What a contact does: the force on the first (the second gets the opposite) and the torques on both.
pub struct Action {
    pub force: Vector,
    pub torques: [Vector; 2],
}

/// Evaluates a contact; `dt` is `None` at the set-up of a run, where history is read and not advanced.
pub fn act(
    contact: &Contact,
    c: &Coefficients,
    set: &ConventionSet,
    spring: &mut Vector,
    dt: Option<f64>,
) -> Action {
    let n = contact.normal;
    let (slip_arm, torque_arm) = if contact.wall {
        (set.wall_slip_arm, set.wall_torque_arm)
    } else {
        (set.pair_slip_arm, set.pair_torque_arm)
    };
    let arm = |rule: Arm, radius: f64| match rule {
        Arm::Full => radius,
        Arm::Shortened => radius - 0.5 * contact.overlap,
        Arm::ToWall => radius - contact.overlap,
    };
    let (i, j) = (&contact.first, &contact.second);
    let relative = sub(i.velocity, j.velocity);
    let vn = dot(relative, n);
    let spin_j = if contact.wall { ZERO } else { scale(arm(slip_arm, j.radius), j.spin) };
    let spins = add(scale(arm(slip_arm, i.radius), i.spin), spin_j);
    let slip = add(sub(relative, scale(vn, n)), cross(n, spins));

    let mut normal_force = c.kn * contact.overlap - c.gn * vn;
    if set.contact_end == ContactEnd::Force {
        normal_force = normal_force.max(0.0);
    }
    let cap = match set.coulomb_cap {
        CoulombCap::Magnitude => c.friction * normal_force.abs(),
        CoulombCap::Repulsive => c.friction * normal_force.max(0.0),
    };
    let tangential =
        if c.history { sprung(n, slip, cap, c, set, spring, dt) } else { viscous(slip, cap, c.gt) };

    let force = add(scale(normal_force, n), tangential);
    let turn = cross(n, tangential);
    let torque_j = if contact.wall { ZERO } else { scale(-arm(torque_arm, j.radius), turn) };
    Action { force, torques: [scale(-arm(torque_arm, i.radius), turn), torque_j] }
}

/// Damper alone, cut at the Coulomb limit.
fn viscous(slip: Vector, cap: f64, gt: f64) -> Vector {
    let speed = norm(slip);
    if speed == 0.0 { ZERO } else { scale(-(gt * speed).min(cap) / speed, slip) }
}

/// Spring and damper with Coulomb limit.
fn sprung(
    n: Vector,
    slip: Vector,
    cap: f64,
    c: &Coefficients,
    set: &ConventionSet,
    spring: &mut Vector,
    dt: Option<f64>,
) -> Vector {
    if let Some(dt) = dt {
        advance(n, scale(dt, slip), cap, c.kt, set.history_order, spring);
    }
    let elastic = scale(-c.kt, *spring);
    let damping = scale(-c.gt, slip);
    let total = add(elastic, damping);
    let tested = match set.coulomb_test {
        CoulombTest::Total => total,
        CoulombTest::SpringOnly => elastic,
    };
    let size = norm(tested);
    if size <= cap {
        return total;
    }
    if *spring == ZERO {
        return ZERO;
    }
    let limited = scale(cap / size, tested);
    // The spring keeps its share of the limited force. Only LIGGGHTS leaves it alone at set-up, where springs are zero.
    match (set.coulomb_test, set.damper_while_sliding) {
        (CoulombTest::Total, true) => {
            *spring = scale(-1.0 / c.kt, sub(limited, damping));
            limited
        }
        (CoulombTest::SpringOnly, true) => {
            *spring = scale(-1.0 / c.kt, limited);
            add(limited, damping)
        }
        (_, false) => {
            *spring = scale(-1.0 / c.kt, limited);
            limited
        }
    }
}

/// One step of the spring.
fn advance(n: Vector, step: Vector, cap: f64, kt: f64, order: HistoryOrder, spring: &mut Vector) {
    if order == HistoryOrder::IncrementThenProject {
        *spring = add(*spring, step);
        *spring = sub(*spring, scale(dot(*spring, n), n));
        return;
    }
    let out_of_plane = dot(*spring, n);
    if order == HistoryOrder::RotateThenIncrement || out_of_plane.abs() * kt > 1e-10 * cap {
        let length = norm(*spring);
        let flat = sub(*spring, scale(out_of_plane, n));
        let flat_length = norm(flat);
        *spring = if flat_length > 0.0 { scale(length / flat_length, flat) } else { ZERO };
    }
    *spring = add(*spring, step);
}
