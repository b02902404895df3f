//! Collisions against tables, closed forms and conservation laws.

mod table;

use granule_law_api::{CollidingBody, CollisionLaw, CollisionRule, LawError, Params, Registry, collide};
use proptest::prelude::*;

use crate::{HardSphere, SpeedDependentHardSphere};
use table::ROWS;

fn compile<L: CollisionLaw>(given: &[(&str, f64)]) -> Result<Box<dyn CollisionRule>, Vec<LawError>> {
    let info = Registry::collect().unwrap().collision(L::INFO.name).unwrap().info;
    L::compile(&Params::new(info, given)?).map_err(|error| vec![error])
}

fn rough(e: f64, mu: f64, e_t0: f64) -> Box<dyn CollisionRule> {
    compile::<HardSphere>(&[("restitution", e), ("friction", mu), ("tangential_restitution", e_t0)]).unwrap()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn size(v: [f64; 3]) -> f64 {
    dot(v, v).sqrt()
}

#[test]
fn both_rules_are_registered() {
    let registry = Registry::collect().unwrap();
    let names: Vec<&str> = registry.collisions().iter().map(|entry| entry.info.name).collect();
    assert_eq!(names, ["HardSphere", "SpeedDependentHardSphere"]);
    for entry in registry.collisions() {
        for example in entry.info.examples {
            let params = Params::new(entry.info, example).unwrap();
            assert!((entry.compile)(&params).is_ok());
        }
    }
}

/// The inputs are rounded to doubles and the results follow by a handful of operations: relative to the largest velocity
/// involved the error is a few units of 1e-16, larger by the loss of digits in m_t and m12 for masses that differ by 1e8
/// and more, where the light body takes up the difference of two numbers of size one.
#[test]
fn thirty_collisions_agree_with_fifty_digit_arithmetic() {
    let mut sliding = 0;
    for (index, row) in ROWS.iter().enumerate() {
        let body = |k: usize| CollidingBody {
            velocity: row.velocity[k],
            spin: row.spin[k],
            inverse_mass: 1.0 / row.mass[k],
            inertia_factor: row.inertia_factor,
            radius: row.diameter[k] / 2.0,
        };
        let (mut first, mut second) = (body(0), body(1));
        let rule = rough(row.restitution, row.friction, row.tangential_restitution);
        let done = collide(&*rule, true, row.normal, &mut first, &mut second, false, 0.0).unwrap();
        let ratio = (row.mass[0] / row.mass[1]).max(row.mass[1] / row.mass[0]);
        let tolerance = if ratio > 1e8 { 1e-9 } else { 1e-12 };
        let scale = row.velocity.iter().chain(&row.velocity_after).fold(0.0, |s: f64, v| s.max(size(*v)));
        for (body, k) in [(first, 0), (second, 1)] {
            let spin_scale = size(row.spin[k]).max(size(row.spin_after[k])).max(scale / body.radius);
            for axis in 0..3 {
                let off = (body.velocity[axis] - row.velocity_after[k][axis]).abs();
                assert!(off <= tolerance * scale, "row {index} body {k}: velocity off by {off:e}");
                let off = (body.spin[axis] - row.spin_after[k][axis]).abs();
                assert!(off <= tolerance * spin_scale, "row {index} body {k}: spin off by {off:e}");
            }
        }
        let limit = row.friction * done.impulse.normal;
        let slides = size(done.impulse.tangential) >= limit * (1.0 - 1e-12);
        assert_eq!(slides, row.sliding, "row {index}");
        sliding += usize::from(slides);
    }
    assert!((5..25).contains(&sliding), "both kinds occur");
}

/// Tangential motion of two equal spheres, in numbers scaled by the normal speed: Psi2(Psi1) of Luding 1998, Eq. (21).
fn psi2(e: f64, mu: f64, e_t0: f64, psi1: f64) -> f64 {
    let rule = rough(e, mu, e_t0);
    let body = |velocity| CollidingBody {
        velocity,
        spin: [0.0; 3],
        inverse_mass: 2.0,
        inertia_factor: 0.4,
        radius: 0.1,
    };
    let (mut first, mut second) = (body([-1.0, psi1, 0.0]), body([0.0; 3]));
    collide(&*rule, true, [1.0, 0.0, 0.0], &mut first, &mut second, false, 0.0).unwrap();
    let turning = cross([0.0, 0.0, 0.1 * (first.spin[2] + second.spin[2])], [1.0, 0.0, 0.0]);
    first.velocity[1] - second.velocity[1] - turning[1]
}

#[test]
fn the_corner_of_psi_lies_where_sticking_turns_to_sliding() {
    // Psi1_0 = mu (1 + e)(1 + 1/q)/(1 + e_t0), solid spheres.
    for (e, mu, e_t0, corner) in
        [(0.9, 0.1, 0.5, 0.443_333_333_333_333_3), (0.9, 0.3, 0.5, 1.33), (0.6, 0.5, 0.0, 2.8)]
    {
        let below = corner * (1.0 - 1e-9);
        // One rounding for each of about ten operations.
        assert!((psi2(e, mu, e_t0, below) + e_t0 * below).abs() < 1e-14);
        let above = corner * 1.5;
        assert!((psi2(e, mu, e_t0, above) - (above - mu * (1.0 + e) * 3.5)).abs() < 1e-14);
    }
    assert_eq!(psi2(0.9, 0.0, 0.5, 0.7), 0.7);
    assert!((psi2(0.9, f64::INFINITY, 1.0, 5.0) + 5.0).abs() < 1e-14);
}

#[test]
fn a_wall_is_an_infinitely_heavy_body() {
    let rule = rough(0.8, 0.2, 0.5);
    let mut ball = CollidingBody {
        velocity: [1.0, 0.0, -2.0],
        spin: [0.0; 3],
        inverse_mass: 4.0,
        inertia_factor: 0.4,
        radius: 0.5,
    };
    let mut wall = CollidingBody { velocity: [0.0, 0.0, 0.5], inverse_mass: 0.0, spin: [0.0; 3], ..ball };
    let before = wall;
    collide(&*rule, true, [0.0, 0.0, 1.0], &mut ball, &mut wall, false, 0.0).unwrap();
    assert_eq!(wall, before);
    // The speed of approach is 2.5; sliding takes mu (1 + e) 2.5 = 0.9 of the slip, sticking would take 2/7 1.5.
    assert!((ball.velocity[2] - (0.5 + 0.8 * 2.5)).abs() < 1e-15);
    assert!((ball.velocity[0] - (1.0 - 1.5 * 2.0 / 7.0)).abs() < 1e-15);
    let slip = ball.velocity[0] - 0.5 * ball.spin[1];
    assert!((slip + 0.5).abs() < 1e-14, "the slip is reversed with e_t0: {slip}");
}

/// The direction t of the slip is no number without slip: the impulse is normal alone, and the smallest slip there is has
/// a direction.
#[test]
fn no_slip_at_all_gives_no_tangential_impulse() {
    // Opposite spins: the contact points move together. 2^-1074 is the smallest number above zero.
    for (slip, friction) in [(0.0, 0.3), (0.0, f64::INFINITY), (f64::from_bits(1), 0.3)] {
        let rule = rough(0.5, friction, 0.5);
        let body = |side: f64| CollidingBody {
            velocity: [-side, slip * side, 0.0],
            spin: [0.0, 7.0 * side, 0.0],
            inverse_mass: 1.0,
            inertia_factor: 0.4,
            radius: 1.0,
        };
        let (mut a, mut b) = (body(1.0), body(-1.0));
        assert!(collide(&*rule, true, [1.0, 0.0, 0.0], &mut a, &mut b, false, 0.0).is_some());
        for (after, side) in [(a, 1.0), (b, -1.0)] {
            assert_eq!((after.velocity[0], after.velocity[2]), (0.5 * side, 0.0));
            assert!(after.velocity[1].abs() <= slip, "no more slip than before: {:?}", after.velocity);
            assert_eq!(after.spin[1], 7.0 * side);
            assert!(after.spin[2].abs() <= 2.0 * slip, "{:?}", after.spin);
        }
    }
}

#[test]
fn two_bodies_that_part_do_not_collide() {
    let rule = rough(0.8, 0.2, 0.5);
    let body = |velocity| CollidingBody {
        velocity,
        spin: [0.0; 3],
        inverse_mass: 1.0,
        inertia_factor: 0.4,
        radius: 1.0,
    };
    let (mut a, mut b) = (body([1.0, 0.0, 0.0]), body([0.0; 3]));
    assert!(collide(&*rule, true, [1.0, 0.0, 0.0], &mut a, &mut b, false, 0.0).is_none());
    let (mut a, mut b) = (body([-1.0, 0.0, 0.0]), body([0.0; 3]));
    (a.inverse_mass, b.inverse_mass) = (0.0, 0.0);
    assert!(collide(&*rule, true, [1.0, 0.0, 0.0], &mut a, &mut b, false, 0.0).is_none());
}

#[test]
fn parameters_that_create_energy_are_refused() {
    for bad in [
        &[("restitution", 1.01)][..],
        &[("restitution", -0.1)],
        &[("restitution", 0.9), ("friction", -0.1)],
        &[("restitution", 0.9), ("friction", 0.1), ("tangential_restitution", 1.1)],
        &[("restitution", 0.9), ("friction", 0.1), ("tangential_restitution", -1.1)],
        &[("restitution", 0.9), ("tangential_restitution", 0.5)],
        &[("restitution", f64::NAN)],
    ] {
        assert!(compile::<HardSphere>(bad).is_err(), "{bad:?}");
    }
    assert!(!compile::<HardSphere>(&[("restitution", 0.9)]).unwrap().is_rough());
    assert!(!rough(1.0, 0.5, 0.5).is_inelastic());
}

#[test]
fn restitution_falls_with_the_speed() {
    let steel =
        compile::<SpeedDependentHardSphere>(&[("restitution", 0.95), ("transition_speed", 0.3)]).unwrap();
    assert_eq!(steel.restitution(0.3), 0.95);
    // The closed forms at a tenth and at ten times the transition speed; powers are good to one unit in the last place.
    assert!((steel.restitution(0.03) - (1.0 - 0.05 * 0.1f64.powf(0.2))).abs() < 1e-15);
    assert!((steel.restitution(3.0) - 0.95 * 10.0f64.powf(-0.25)).abs() < 1e-15);
    let mut last = 1.0;
    for k in -20..20 {
        let e = steel.restitution(0.3 * 2.0f64.powi(k));
        assert!(e < last && e > 0.0);
        last = e;
    }
    assert_eq!(steel.restitution(0.0), 1.0);
    let bizon = compile::<SpeedDependentHardSphere>(&[
        ("restitution", 0.7),
        ("transition_speed", 1.0),
        ("viscous_exponent", 0.75),
        ("plastic_exponent", 0.0),
    ])
    .unwrap();
    assert_eq!(bizon.restitution(7.0), 0.7);
}

#[test]
fn an_elastic_collision_and_a_least_rebound_replace_the_normal_restitution() {
    let rule = rough(0.5, 0.0, 0.0);
    let body = |velocity| CollidingBody {
        velocity,
        spin: [0.0; 3],
        inverse_mass: 1.0,
        inertia_factor: 0.4,
        radius: 1.0,
    };
    let after = |elastic, least| {
        let (mut a, mut b) = (body([-1.0, 0.0, 0.0]), body([0.0; 3]));
        collide(&*rule, false, [1.0, 0.0, 0.0], &mut a, &mut b, elastic, least);
        a.velocity[0] - b.velocity[0]
    };
    assert_eq!(after(false, 0.0), 0.5);
    assert_eq!(after(true, 0.0), 1.0);
    assert_eq!(after(false, 0.75), 0.75);
}

proptest! {
    #[test]
    fn momentum_is_conserved_and_energy_never_grows(
        v in prop::array::uniform2(prop::array::uniform3(-2.0f64..2.0)),
        w in prop::array::uniform2(prop::array::uniform3(-5.0f64..5.0)),
        direction in prop::array::uniform3(-1.0f64..1.0),
        mass in prop::array::uniform2(-3.0f64..3.0),
        radius in prop::array::uniform2(0.1f64..2.0),
        q in prop::array::uniform2(0.2f64..0.67),
        e in 0.0f64..=1.0, mu in 0.0f64..2.0, e_t0 in -1.0f64..=1.0,
    ) {
        prop_assume!(size(direction) > 0.1);
        let n = direction.map(|c| c / size(direction));
        let mass = mass.map(|m| 10.0f64.powf(m));
        let rule = rough(e, mu, e_t0);
        let body = |k: usize| CollidingBody {
            velocity: v[k], spin: w[k], inverse_mass: 1.0 / mass[k], inertia_factor: q[k], radius: radius[k],
        };
        let momentum = |b: &[CollidingBody; 2], axis: usize| {
            mass[0] * b[0].velocity[axis] + mass[1] * b[1].velocity[axis]
        };
        let angular = |b: &[CollidingBody; 2], axis: usize| {
            // About the centre of the second body.
            let arm = n.map(|c| c * (radius[0] + radius[1]));
            let spin: f64 = (0..2).map(|k| q[k] * mass[k] * radius[k] * radius[k] * b[k].spin[axis]).sum();
            spin + mass[0] * cross(arm, b[0].velocity)[axis]
        };
        let energy = |b: &[CollidingBody; 2]| -> f64 {
            (0..2).map(|k| {
                let inertia = q[k] * mass[k] * radius[k] * radius[k];
                0.5 * mass[k] * dot(b[k].velocity, b[k].velocity) + 0.5 * inertia * dot(b[k].spin, b[k].spin)
            }).sum()
        };
        let before = [body(0), body(1)];
        let mut after = before;
        let [first, second] = &mut after;
        if collide(&*rule, true, n, first, second, false, 0.0).is_some() {
            // Sums of a dozen terms of the size of momentum, angular momentum and energy.
            let scale = (mass[0] + mass[1]) * 20.0 * 4.0;
            for axis in 0..3 {
                prop_assert!((momentum(&after, axis) - momentum(&before, axis)).abs() < 1e-14 * scale);
                prop_assert!((angular(&after, axis) - angular(&before, axis)).abs() < 1e-14 * scale);
            }
            prop_assert!(energy(&after) <= energy(&before) * (1.0 + 1e-13));
        }
    }
}
