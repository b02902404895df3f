//! Walls, gravity, and the contact-duration model.

mod support;

use granule_events::{EventEngine, EventError, Setup, Tuning};
use granule_geometry::Motion;
use nalgebra::Vector3;
use support::{Plain, Random, ball, floor, plane, world};

/// The bouncing ball of Luding 1998, Sec. 2.1: v0 = 6.3 m/s, e = 0.9, g = 9.81 m/s².
#[test]
fn a_bouncing_ball_comes_to_rest_when_it_should() {
    let (v0, e, g, t_c) = (6.3, 0.9, 9.81, 1e-6);
    let setup =
        world(vec![ball(1, [0.0, 0.0, 0.5], [0.0, 0.0, v0])], vec![floor()], Plain::smooth(e), g, t_c);
    let mut engine = EventEngine::new(&setup).unwrap();
    let mut speed = v0;
    let mut at = 0.0;
    let mut path = 0.0;
    // The first impact is after 2 v0/g; each flight is e times as long as the one before (Luding 1998, Eq. (3)).
    for bounce in 1..=120 {
        at += 2.0 * speed / g;
        speed *= e;
        engine.advance_collisions(1).unwrap();
        // Sums of a hundred flights, each rounded at the size of the whole time.
        assert!((engine.time() - at).abs() < 1e-12 * at, "{bounce}: {} {at}", engine.time());
        let v = engine.states(engine.time())[0].velocity[2];
        assert!((v / speed - 1.0).abs() < 1e-9, "{bounce}: {v} {speed}");
        path += v * v / g;
        if bounce == 80 {
            assert!((v / v0 / 0.9f64.powi(80) - 1.0).abs() < 1e-9);
        }
    }
    // Eq. (4) and the way back and forth count from the first impact (erratum L-E24).
    let end = 2.0 * v0 / (g * (1.0 - e));
    assert!((e * end - 11.559_633_028).abs() < 1e-9);
    // What is missing after 120 bounces is e^240, 1e-11 of the whole.
    assert!((path - 17.248_2).abs() < 1e-4, "{path}");
    engine.advance(1.02 * end, u64::MAX).unwrap();
    let counts = *engine.counts();
    // k_max = log(g t_c/(2 v0))/log(e) = 133.5: from the 134th impact on contacts overlap.
    let lossy = counts.wall_collisions - counts.overlapping;
    assert_eq!(lossy, 134, "{counts:?}");
    let first = counts.first_overlapping.unwrap();
    assert!((first - end).abs() < 1e-4 * end, "{first} {end}");
    assert!(counts.leaves_the_hard_sphere_world());
    // Bounces of at most the contact duration: about one event in that time, and never far from the floor.
    assert!(counts.wall_collisions < (0.02 * end / (0.9 * t_c)) as u64 + 1000);
    let height = engine.states(1.02 * end)[0].position[2] - 0.5;
    assert!((-1e-12..1.3 * g * t_c * t_c / 8.0 + 1e-12).contains(&height), "{height:e}");
}

#[test]
fn a_ball_that_lies_on_the_floor_stays_there() {
    for e in [0.0, 0.5, 1.0] {
        let setup = world(
            vec![ball(1, [0.0, 0.0, 0.5], [0.3, 0.0, 0.0])],
            vec![floor()],
            Plain::smooth(e),
            9.81,
            1e-4,
        );
        let mut engine = EventEngine::new(&setup).unwrap();
        engine.advance(1.0, u64::MAX).unwrap();
        let state = engine.states(1.0)[0];
        assert!((state.position[0] - 0.3).abs() < 1e-12);
        assert!((state.position[2] - 0.5).abs() < 9.81 * 1e-8 / 8.0 + 1e-12, "{state:?}");
        assert!(engine.counts().wall_collisions < 12_000, "{:?}", engine.counts());
        assert!(engine.counts().resting > 0);
    }
}

#[test]
fn a_shaken_floor_gives_the_energy_of_its_work() {
    let motion = Motion::sinusoidal(Vector3::z() * 0.1, 30.0, 0.4).unwrap();
    let bodies = (0..5).map(|k| ball(k + 1, [0.3, 0.0, 2.0 + 1.5 * f64::from(k)], [0.0; 3])).collect();
    let setup = world(bodies, vec![plane([0.0; 3], [0.0, 0.0, 1.0], motion)], Plain::smooth(0.8), 9.81, 1e-5);
    let mut engine = EventEngine::new(&setup).unwrap();
    let energy = |engine: &EventEngine, t: f64| {
        let potential: f64 = engine.states(t).iter().map(|s| 9.81 * s.position[2]).sum();
        engine.kinetic_energy(t).0 + potential
    };
    let start = energy(&engine, 0.0);
    for step in 1..=50 {
        let t = 0.1 * f64::from(step);
        engine.advance(t, u64::MAX).unwrap();
        let counts = engine.counts();
        let balance = start + counts.wall_work - counts.lost_normal;
        let scale = start + counts.wall_work.abs() + counts.lost_normal;
        assert!((energy(&engine, t) - balance).abs() < 1e-10 * scale, "{t}");
        for state in engine.states(t) {
            let place = 0.1 * (30.0 * t + 0.4).sin();
            assert!(state.position[2] - 0.5 - place > -1e-12, "{t}: {state:?}");
        }
    }
    assert!(engine.counts().wall_work > 1.0 && engine.counts().wall_collisions > 10);
}

#[test]
fn a_box_with_a_piston_heats_the_gas_adiabatically() {
    // One dimension of one ball between a wall and a slow piston: v L is an adiabatic invariant.
    let walls = vec![
        plane([0.0; 3], [1.0, 0.0, 0.0], Motion::fixed()),
        plane([11.0, 0.0, 0.0], [-1.0, 0.0, 0.0], Motion::constant_velocity(-Vector3::x() * 0.001).unwrap()),
    ];
    let setup = world(vec![ball(1, [0.5, 0.0, 0.0], [1.0, 0.0, 0.0])], walls, Plain::smooth(1.0), 0.0, 1e-9);
    let mut engine = EventEngine::new(&setup).unwrap();
    engine.advance(5000.0, u64::MAX).unwrap();
    let v = engine.states(5000.0)[0].velocity[0].abs();
    // Half of the room is left; the invariant holds to the share of the piston's speed.
    assert!((v - 2.0).abs() < 0.01, "{v}");
}

#[test]
fn a_ball_falls_on_a_frozen_one_on_a_curve() {
    let mut still = ball(2, [0.0; 3], [0.0; 3]);
    still.frozen = true;
    let setup = world(
        vec![ball(1, [0.3, 0.0, 3.0], [0.1, 0.0, 0.0]), still],
        Vec::new(),
        Plain::smooth(0.7),
        9.81,
        1e-6,
    );
    let mut engine = EventEngine::new(&setup).unwrap();
    engine.advance_collisions(1).unwrap();
    let t = engine.time();
    let place = [0.3 + 0.1 * t, 3.0 - 0.5 * 9.81 * t * t];
    assert!((place[0].hypot(place[1]) - 1.0).abs() < 1e-12);
    engine.advance(t + 0.1, u64::MAX).unwrap();
    assert_eq!(engine.states(t + 0.1)[1].velocity, [0.0; 3]);
    // It rests on the very top and bounces there, where g points to the other.
    let mut still = ball(2, [0.0; 3], [0.0; 3]);
    still.frozen = true;
    let setup =
        world(vec![ball(1, [0.0, 0.0, 1.0], [0.0; 3]), still], Vec::new(), Plain::smooth(0.5), 9.81, 1e-4);
    let mut engine = EventEngine::new(&setup).unwrap();
    engine.advance(0.5, u64::MAX).unwrap();
    assert!((engine.states(0.5)[0].position[2] - 1.0).abs() < 1e-7);
    assert!(engine.counts().collisions < 20_000);
}

/// Three balls on a line, in distances instead of places, which round-off does not end: times of the collisions until the
/// balls part or the speeds are below 1e-250.
fn collapse(r: f64, mut gaps: [f64; 2], mut closing: [f64; 2]) -> Vec<f64> {
    let (mut time, mut times) = (0.0, Vec::new());
    loop {
        let after: [f64; 2] =
            std::array::from_fn(|k| if closing[k] > 0.0 { gaps[k] / closing[k] } else { f64::INFINITY });
        let pair = usize::from(after[1] < after[0]);
        if after[pair] == f64::INFINITY || closing[pair] < 1e-250 {
            return times;
        }
        time += after[pair];
        times.push(time);
        gaps = std::array::from_fn(|k| (gaps[k] - closing[k] * after[pair]).max(0.0));
        gaps[pair] = 0.0;
        closing[1 - pair] += 0.5 * (1.0 + r) * closing[pair];
        closing[pair] *= -r;
    }
}

/// Three balls on a line collapse for r below 7 - 4 sqrt 3 (Constantin, Grossman and Mungan 1995). The speeds of approach
/// before successive collisions obey u' = (1 + r)/2 u - r u_before, which turns by θ with cos θ = (1 + r)/(4 sqrt r) above
/// that restitution: then there are π/θ collisions, rounded up. Below it the contact-duration model ends the series.
#[test]
fn three_balls_collapse_below_the_critical_restitution() {
    let (gaps, closing) = ([0.001, 0.1], [0.1, 1.0]);
    let run = |r: f64, t_c: f64| {
        let bodies = vec![
            ball(1, [-1.0 - gaps[0], 0.0, 0.0], [closing[0], 0.0, 0.0]),
            ball(2, [0.0; 3], [0.0; 3]),
            ball(3, [1.0 + gaps[1], 0.0, 0.0], [-closing[1], 0.0, 0.0]),
        ];
        let mut engine = EventEngine::new(&world(bodies, Vec::new(), Plain::smooth(r), 0.0, t_c)).unwrap();
        engine.advance(1000.0, 1_000_000).unwrap();
        *engine.counts()
    };
    let critical = 7.0 - 4.0 * 3f64.sqrt();
    assert!((critical - 0.071_796_8).abs() < 1e-7);
    let finite = |r: f64| (std::f64::consts::PI / ((1.0 + r) / (4.0 * r.sqrt())).acos()).ceil() as usize;
    assert_eq!(finite(0.072), 64);
    // In places, the last gaps of more than 17 collisions are below round-off.
    for (r, collisions) in [(0.5, 4), (0.2, 4), (0.09, 8), (0.08, 11), (0.075, 17)] {
        assert_eq!((finite(r), collapse(r, gaps, closing).len()), (collisions, collisions), "r = {r}");
        let counts = run(r, 1e-30);
        assert_eq!((counts.collisions, counts.overlapping), (collisions as u64, 0), "r = {r}: {counts:?}");
    }
    assert_eq!(collapse(0.072, gaps, closing).len(), 64);
    for r in [0.0715, 0.05] {
        let times = collapse(r, gaps, closing);
        // Each collision takes the larger root of λ² - (1 + r)/2 λ + r of the speed.
        let a = 0.5 * (1.0 + r);
        let share = 0.5 * (a + (a * a - 4.0 * r).sqrt());
        let expected = (1e-250f64).ln() / share.ln();
        assert!((times.len() as f64 - expected).abs() < 0.05 * expected, "{} {expected}", times.len());
        let t_c = 1e-4;
        let counts = run(r, t_c);
        // The detector speaks at the first collision that is less than the contact duration after the one before.
        let (first, _) =
            times.windows(2).map(|w| (w[1], w[1] - w[0])).find(|(_, since)| *since < t_c).unwrap();
        let found = counts.first_overlapping.unwrap();
        assert!((found - first).abs() < 1e-12, "r = {r}: {found} {first}");
        assert!(counts.leaves_the_hard_sphere_world());
        assert!(counts.collisions < 100, "{counts:?}");
    }
}

/// A column of beads dropped on a plate: the event-driven model lets it bounce as a loose train, and after that it rests.
#[test]
fn a_column_that_falls_on_a_plate_comes_to_rest_without_stalling() {
    let count = 10;
    let bodies = (0..count).map(|k| ball(k + 1, [0.0, 0.0, 1.5 + 1.001 * f64::from(k)], [0.0; 3])).collect();
    let setup = world(bodies, vec![floor()], Plain::smooth(0.8), 9.81, 1e-4);
    let mut engine = EventEngine::new(&setup).unwrap();
    engine.advance(0.6, u64::MAX).unwrap();
    assert!(engine.counts().collisions > 10);
    engine.advance(8.0, u64::MAX).unwrap();
    let states = engine.states(8.0);
    for (k, state) in states.iter().enumerate() {
        let expected = 0.5 + k as f64;
        assert!((state.position[2] - expected).abs() < 1e-3 * (1.0 + k as f64), "{k}: {state:?}");
    }
    // Each bead about once a contact duration at most, on average.
    let most = f64::from(count) * 8.0 / 1e-4 * 3.0;
    assert!((engine.counts().all() as f64) < most, "{:?}", engine.counts());
}

#[test]
fn a_heap_in_a_box_settles() {
    let mut random = Random(5);
    let mut bodies = Vec::new();
    for k in 0..60u32 {
        let (x, y, z) = (k % 3, k / 3 % 3, k / 9);
        let place = [x, y, z].map(|c| 0.7 + 1.1 * f64::from(c));
        bodies.push(ball(k + 1, place, std::array::from_fn(|_| random.normal())));
    }
    let mut walls = vec![floor()];
    for (point, normal) in [
        ([0.0; 3], [1.0, 0.0, 0.0]),
        ([4.0, 0.0, 0.0], [-1.0, 0.0, 0.0]),
        ([0.0; 3], [0.0, 1.0, 0.0]),
        ([0.0, 4.0, 0.0], [0.0, -1.0, 0.0]),
    ] {
        walls.push(plane(point, normal, Motion::fixed()));
    }
    let rule = Plain { restitution: 0.6, friction: 0.4, tangential_restitution: 0.0 };
    let setup = world(bodies, walls, rule, 9.81, 3e-3);
    let mut engine = EventEngine::new(&setup).unwrap();
    engine.advance(6.0, u64::MAX).unwrap();
    let states = engine.states(6.0);
    for (i, a) in states.iter().enumerate() {
        assert!(a.position[2] > 0.5 - 1e-10 && a.position[2] < 6.0, "{a:?}");
        assert!(a.velocity.iter().all(|v| v.abs() < 0.3), "{a:?}");
        for b in &states[..i] {
            let d: f64 = (0..3).map(|k| (a.position[k] - b.position[k]).powi(2)).sum::<f64>().sqrt();
            assert!(d > 1.0 - 1e-10, "overlap {:e}", 1.0 - d);
        }
    }
    assert!(engine.counts().overlapping_share() > 0.5, "lasting contacts: {:?}", engine.counts());
}

/// Times are relative to an epoch that moves along: three balls above each other that bounce elastically for 10^5 s keep
/// their energy, and do so as well if bodies are renumbered at other times.
#[test]
fn late_events_are_as_exact_as_early_ones() {
    for renumber_every in [100.0, 1e5] {
        let bodies = (0..3).map(|k| ball(k + 1, [0.0, 0.0, 1.5 + 2.3 * f64::from(k)], [0.0; 3])).collect();
        let setup = world(bodies, vec![floor()], Plain::smooth(1.0), 9.81, 1e-9);
        let tuning = Tuning { renumber_every, ..Tuning::default() };
        let mut engine = EventEngine::with_tuning(&setup, tuning).unwrap();
        while engine.time() < 1e5 {
            engine.advance_collisions(1000).unwrap();
            let time = engine.time();
            let potential: f64 = engine.states(time).iter().map(|s| 9.81 * s.position[2]).sum();
            let energy = engine.kinetic_energy(time).0 + potential;
            // Round-off of 1e-16 for each of some 1e6 flights, as a random walk.
            assert!((energy / (9.81 * 11.4) - 1.0).abs() < 1e-12, "{time}");
        }
        assert!(engine.counts().all() > 100_000 && engine.counts().renumbered > 0);
    }
}

/// Six balls hit one in the middle from all sides at the same moment, and eight pairs elsewhere collide then, too: any number
/// of equal times, in the order of the bodies, gives the same bits each time and conserves what is conserved.
#[test]
fn simultaneous_events_happen_in_the_order_of_the_bodies() {
    let bodies = || {
        let mut bodies = vec![ball(1, [0.0; 3], [0.0; 3])];
        for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
            let (mut place, mut speed) = ([0.0; 3], [0.0; 3]);
            (place[axis], speed[axis]) = (2.0 * sign, -sign);
            bodies.push(ball(bodies.len() as u32 + 1, place, speed));
        }
        for pair in 0..8 {
            let y = 10.0 + 4.0 * f64::from(pair);
            for x in [-1.5, 1.5] {
                bodies.push(ball(bodies.len() as u32 + 1, [x, y, 0.0], [-x / 1.5, 0.0, 0.0]));
            }
        }
        bodies
    };
    let run = || {
        let setup = world(bodies(), Vec::new(), Plain::smooth(1.0), 0.0, 0.0);
        let mut engine = EventEngine::new(&setup).unwrap();
        engine.advance(0.999, u64::MAX).unwrap();
        assert_eq!(engine.counts().collisions, 0);
        engine.advance(1.0, u64::MAX).unwrap();
        assert!(engine.counts().collisions >= 8 + 6, "all at once: {:?}", engine.counts());
        engine.advance(5.0, u64::MAX).unwrap();
        (engine.states(5.0), *engine.counts())
    };
    let (states, counts) = run();
    assert_eq!((states.clone(), counts), run());
    for (a, b) in states[7..].iter().step_by(2).zip(states[8..].iter().step_by(2)) {
        assert_eq!((a.velocity[0], b.velocity[0]), (-1.0, 1.0));
    }
    let energy: f64 = states.iter().flat_map(|s| s.velocity).map(|v| 0.5 * v * v).sum();
    assert!((energy - 11.0).abs() < 1e-12, "{energy}");
    for k in 0..3 {
        assert!(states.iter().map(|s| s.velocity[k]).sum::<f64>().abs() < 1e-14);
    }
}

/// A piston that a table moves gives a resting ball twice its speed, stops, and lets it go.
#[test]
fn a_piston_by_table_hits_once() {
    let rows = vec![(0.5, Vector3::zeros()), (1.5, Vector3::x() * 2.0)];
    let piston = plane([0.0; 3], [1.0, 0.0, 0.0], Motion::table(rows).unwrap());
    let setup = world(vec![ball(1, [1.5, 0.0, 0.0], [0.0; 3])], vec![piston], Plain::smooth(1.0), 0.0, 1e-9);
    let mut engine = EventEngine::new(&setup).unwrap();
    engine.advance(3.0, u64::MAX).unwrap();
    assert_eq!(engine.counts().all(), 1);
    let state = engine.states(3.0)[0];
    assert!((state.velocity[0] - 4.0).abs() < 1e-13, "{state:?}");
    // Met at 1.0 s after half a second on a way of 1 m.
    assert!((state.position[0] - (1.5 + 4.0 * 2.0)).abs() < 1e-12, "{state:?}");
}

#[test]
fn crushed_bodies_end_the_run_with_a_reason() {
    let walls = vec![
        plane([0.0; 3], [1.0, 0.0, 0.0], Motion::fixed()),
        plane([1.5, 0.0, 0.0], [-1.0, 0.0, 0.0], Motion::constant_velocity(-Vector3::x()).unwrap()),
    ];
    let setup = world(vec![ball(1, [0.6, 0.0, 0.0], [1.0, 0.0, 0.0])], walls, Plain::smooth(1.0), 0.0, 1e-3);
    let mut engine = EventEngine::new(&setup).unwrap();
    let error = engine.advance(1.0, u64::MAX).unwrap_err();
    assert!(matches!(error, EventError::Stalled { .. } | EventError::NotFinite { .. }), "{error}");
    assert!(error.to_string().contains('1'));
}

#[test]
fn what_no_hard_scene_may_have_is_refused() {
    let good =
        || world(vec![ball(1, [0.0, 0.0, 2.0], [0.0; 3])], vec![floor()], Plain::smooth(0.9), 9.81, 1e-5);
    assert!(EventEngine::new(&good()).is_ok());
    let no_duration = Setup { contact_duration: 0.0, ..good() };
    assert!(matches!(EventEngine::new(&no_duration), Err(EventError::Input(_))));
    let overlapping = Setup { bodies: vec![ball(1, [0.0, 0.0, 0.4], [0.0; 3])], ..good() };
    assert!(matches!(EventEngine::new(&overlapping), Err(EventError::Overlap { other: Err(0), .. })));
    let pair = vec![ball(1, [0.0, 0.0, 2.0], [0.0; 3]), ball(2, [0.0, 0.0, 2.9], [0.0; 3])];
    let overlapping = Setup { bodies: pair, ..good() };
    assert!(matches!(EventEngine::new(&overlapping), Err(EventError::Overlap { other: Ok(_), .. })));
    let nan = Setup { bodies: vec![ball(1, [0.0, 0.0, f64::NAN], [0.0; 3])], ..good() };
    assert!(matches!(EventEngine::new(&nan), Err(EventError::NotFinite { id: 1, .. })));
    let mut light = good();
    light.bodies[0].mass = 0.0;
    assert!(EventEngine::new(&light).is_err());
}
