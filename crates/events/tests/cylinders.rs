//! Hard bodies in drums.

mod support;

use granule_events::{EventEngine, WallInput};
use granule_geometry::{Cylinder, Motion, Wall};
use nalgebra::Vector3;
use support::{Plain, ball, world};

fn drum(radius: f64, motion: Motion) -> WallInput {
    let drum = Cylinder::new(Vector3::zeros(), Vector3::y(), radius, true).unwrap();
    WallInput { wall: Wall::new(drum, motion), rules: vec![Some(0)] }
}

/// Without gravity an elastic ball runs along a polygon: chords of 2 s cos α that it flies in the same time for ever.
#[test]
fn a_ball_in_a_drum_runs_along_a_polygon() {
    let (start, v) = ([0.6, 0.0, 0.0], [1.0, 0.25, 2.0]);
    let setup =
        world(vec![ball(1, start, v)], vec![drum(2.0, Motion::fixed())], Plain::smooth(1.0), 0.0, 1e-9);
    let mut engine = EventEngine::new(&setup).unwrap();
    engine.advance_collisions(1).unwrap();
    let first = engine.time();
    let speed = 5f64.sqrt();
    // Angular momentum about the axis gives the angle at which it meets the wall, at 1.5 from the axis.
    let sine = 0.6 * 2.0 / (1.5 * speed);
    let chord = 2.0 * 1.5 * (1.0 - sine * sine).sqrt() / speed;
    for bounces in [10.0, 1000.0] {
        engine.advance_collisions(1 + bounces as u64 - engine.counts().all()).unwrap();
        // A hundred roundings of 1e-16 to the square root of their number, in relative terms.
        assert!((engine.time() - first - bounces * chord).abs() < 1e-12 * bounces);
        let state = engine.states(engine.time())[0];
        assert!((state.velocity[0].hypot(state.velocity[2]) - speed).abs() < 1e-12);
        assert!((state.position[0].hypot(state.position[2]) - 1.5).abs() < 1e-12);
    }
    assert_eq!(engine.counts().overlapping, 0);
}

/// Under gravity elastic balls keep their energy in a drum, and stay inside.
#[test]
fn elastic_balls_in_a_drum_keep_their_energy() {
    let bodies = vec![ball(1, [0.7, 0.0, 1.0], [0.4, 0.0, 0.0]), ball(2, [-0.5, 0.0, -0.6], [0.0; 3])];
    let setup = world(bodies, vec![drum(2.5, Motion::fixed())], Plain::smooth(1.0), 9.81, 1e-5);
    let mut engine = EventEngine::new(&setup).unwrap();
    let energy = |engine: &EventEngine, t: f64| {
        engine.kinetic_energy(t).0 + engine.states(t).iter().map(|s| 9.81 * s.position[2]).sum::<f64>()
    };
    let before = energy(&engine, 0.0);
    for step in 1..=200 {
        let t = 0.3 * f64::from(step);
        engine.advance(t, u64::MAX).unwrap();
        for state in engine.states(t) {
            let gap = 2.0 - state.position[0].hypot(state.position[2]);
            assert!(gap > -1e-11, "outside by {gap:e} at {t}");
        }
    }
    assert!(engine.counts().wall_collisions > 100);
    // Each of some hundred collisions rounds to 1e-16, and their times to the root of it where they graze.
    assert!((energy(&engine, 60.0) / before - 1.0).abs() < 1e-9);
}

/// A smooth ball that touches a hollow slides along it as a pendulum of the length from axis to centre, in bounces of
/// about the contact duration: it comes back after 4 sqrt(s/g) K(sin 30°) from 60°, with K(1/2) = 1.685750354812596.
#[test]
fn a_ball_swings_in_a_drum_as_a_pendulum() {
    let (sine, cosine) = 60f64.to_radians().sin_cos();
    let start = [1.5 * sine, 0.0, -1.5 * cosine];
    let late = |t_c: f64| {
        let setup = world(
            vec![ball(1, start, [0.0; 3])],
            vec![drum(2.0, Motion::fixed())],
            Plain::smooth(0.6),
            9.81,
            t_c,
        );
        let mut engine = EventEngine::new(&setup).unwrap();
        let period = 4.0 * (1.5f64 / 9.81).sqrt() * 1.685_750_354_812_596;
        let bottom = 0.75 * period;
        engine.advance(bottom, u64::MAX).unwrap();
        let [state] = engine.states(bottom)[..] else { panic!("one ball") };
        let speed = (2.0 * 9.81 * 1.5 * (1.0 - cosine)).sqrt();
        assert!((state.velocity[0] / speed - 1.0).abs() < 1e-6 && engine.counts().resting > 0, "{state:?}");
        state.position[0].abs() / 1.5
    };
    // The path of bounces is off by their height, g t_c²/8, and so is the time: second order.
    let (coarse, fine) = (late(1e-3), late(1e-4));
    assert!(coarse < 1e-5 && fine < 1e-7, "{coarse:e} {fine:e}");
    assert!((coarse / fine / 100.0 - 1.0).abs() < 0.05, "{coarse:e} {fine:e}");
}

/// A turning drum takes a rough ball along: it begins to spin, which a smooth one never does.
#[test]
fn a_turning_drum_takes_a_rough_ball_along() {
    let motion = Motion::rotation(Vector3::zeros(), Vector3::y(), 2.0).unwrap();
    let rule = Plain { restitution: 0.5, friction: 0.5, tangential_restitution: 0.0 };
    let setup = world(vec![ball(1, [0.0, 0.0, -1.4], [0.0; 3])], vec![drum(2.0, motion)], rule, 9.81, 1e-5);
    let mut engine = EventEngine::new(&setup).unwrap();
    engine.advance(1.0, u64::MAX).unwrap();
    let state = engine.states(1.0)[0];
    // It rolls on the wall, whose material moves by 4 m/s at the contact: both turn the same way.
    assert!(state.spin[1] > 1.0, "{state:?}");
    assert!((state.position[0].hypot(state.position[2]) - 1.5).abs() < 1e-3);
    assert!(engine.counts().wall_work > 0.0);
}
