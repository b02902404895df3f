//! The single precision level: laws in single precision on relative positions and velocities, everything else in double.

use granule_tests::{advance, bodies, driver};

/// Two spheres meet obliquely, far from the origin; `precision` is a field of the scene.
fn impact(precision: &str) -> String {
    format!(
        r#"(version: 1, {precision} materials: {{ "a": (density: 2500) }},
        bodies: [
            Sphere(material: "a", radius: "1 mm", position: (100, 0, 0), velocity: (1, 0.3, 0)),
            Sphere(material: "a", radius: "1 mm", position: (100.0021, 0.0004, 0), velocity: (-1, 0, 0.2)),
        ],
        contacts: [(between: ("a", "a"),
            normal: LinearSpringDashpot(restitution: 0.8, contact_duration: "1e-4 s"),
            tangential: TangentialSpring(stiffness: 1e5, friction: 0.3))],
        driver: TimeStep(step: "1 us"), run: (steps: 400))"#
    )
}

/// Largest difference of two runs in velocity \[m/s\] and in spin times radius \[m/s\].
fn difference(steps: u64) -> f64 {
    let run = |precision: &str| {
        let mut driver = driver(&impact(precision));
        advance(&mut driver, steps);
        bodies(&driver)
    };
    let (double, single) = (run(""), run("precision: Single,"));
    let mut largest: f64 = 0.0;
    for (a, b) in double.iter().zip(&single) {
        for axis in 0..3 {
            largest = largest.max((a.velocity[axis] - b.velocity[axis]).abs());
            largest = largest.max(1e-3 * (a.spin[axis] - b.spin[axis]).abs());
        }
    }
    assert!(double[0].velocity[0] < 0.0, "the spheres have met and part");
    largest
}

/// An impact takes about a hundred steps. Each force is rounded a few times to 2^-24 = 6e-8 of itself, mostly at random, and
/// the forces of the impact add up to a change of 2 m/s: 2 m/s * 6e-8 * a few / sqrt(100) at best, 2 m/s * 6e-8 * a few at
/// worst. The distance of 100 m from the origin would cost 100 m * 6e-8 = 6 um, more than the overlap, if positions were
/// rounded before they are subtracted.
#[test]
fn an_impact_differs_by_the_rounding_of_its_forces() {
    let difference = difference(400);
    assert!(difference < 1e-6, "single precision differs by {difference} m/s");
    assert!(difference > 1e-12, "the level is single precision: {difference} m/s");
}

/// Forces act on both bodies with the same bits, so momentum does not depend on the precision of the laws.
#[test]
fn momentum_is_kept_to_double_precision() {
    let mut driver = driver(&impact("precision: Single,"));
    advance(&mut driver, 400);
    let after = bodies(&driver);
    let before = [0.0, 0.3, 0.2];
    for axis in 0..3 {
        let sum = after[0].velocity[axis] + after[1].velocity[axis];
        // A few hundred roundings of velocities of order one to 1.1e-16.
        assert!((sum - before[axis]).abs() < 1e-13, "axis {axis}: {sum}");
    }
}

/// The level is part of the plan's identity.
#[test]
fn the_fingerprint_tells_the_levels_apart() {
    let (double, single) = (driver(&impact("")), driver(&impact("precision: Single,")));
    assert_ne!(double.engine().plan().fingerprint, single.engine().plan().fingerprint);
}
