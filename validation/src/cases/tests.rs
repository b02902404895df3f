//! Each case shows what its title says, by the engines' own recorded frames.

use super::*;
use crate::peers::{Engine, Frame, Record, inputs};

/// Recorded frames of each target of a case.
fn frames(slug: &str) -> Vec<(&'static str, PeerScene, Vec<Frame>)> {
    let case = find(slug).unwrap();
    let load = |target: &Target| {
        let scene = case.peer(*target).unwrap();
        let record = Record::load(&case.record(*target), &inputs(&scene).unwrap());
        (target.name(), scene, record.unwrap_or_else(|error| panic!("{error}")).frames)
    };
    case.targets.iter().map(load).collect()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Normal (positive: repulsive) and tangential force on body 1 of a pair.
fn split(frame: &Frame) -> (f64, f64) {
    let apart: [f64; 3] = std::array::from_fn(|k| frame.position[0][k] - frame.position[1][k]);
    let distance = dot(apart, apart).sqrt();
    let normal = dot(frame.force[0], apart) / distance;
    (normal, (dot(frame.force[0], frame.force[0]) - normal * normal).max(0.0).sqrt())
}

/// Frames in contact.
fn touching(frames: &[Frame]) -> impl Iterator<Item = &Frame> {
    frames.iter().filter(|frame| dot(frame.force[0], frame.force[0]) > 0.0)
}

/// Whoever has the laws of a case is compared, and nobody else.
#[test]
fn every_engine_has_enough_cases() {
    let cases = all().unwrap();
    for engine in [Engine::Lammps, Engine::Liggghts] {
        let told = |case: &&Case| {
            case.targets.iter().any(|target| case.peer(*target).unwrap().check().unwrap() == engine)
        };
        let count = cases.iter().filter(told).count();
        assert!(count >= 12, "{} has {count} cases", engine.name());
    }
    for case in &cases {
        for target in Target::ALL {
            let translated = case.peer(target);
            assert_eq!(case.targets.contains(&target), translated.is_ok(), "{} {target:?}", case.slug);
        }
        assert!(case.tolerance <= 1e-12 && !case.reason.is_empty(), "{}", case.slug);
        assert!(case.folder.join("README.md").is_file(), "{} has no README.md", case.slug);
    }
}

#[test]
fn pairs_touch_and_part() {
    for case in all().unwrap().iter().filter(|case| !case.slug.starts_with("wall-")) {
        for (law, _, frames) in frames(&case.slug) {
            let contact = touching(&frames).count();
            assert!(contact >= 10, "{} {law}: {contact} frames in contact", case.slug);
            let ends = [&frames[0], &frames[frames.len() - 1]];
            let free = |frame: &&Frame| frame.force.iter().all(|force| *force == [0.0; 3]);
            assert!(ends.iter().all(free), "{} {law} begins or ends in contact", case.slug);
        }
    }
}

#[test]
fn attraction_only_where_the_contact_ends_with_the_overlap() {
    let lowest = |slug| {
        let runs = frames(slug);
        runs.iter().map(|(_, _, frames)| frames.iter().map(|f| split(f).0).fold(0.0, f64::min)).collect()
    };
    let overlap: Vec<f64> = lowest("head-on-lsd-overlap");
    let force: Vec<f64> = lowest("head-on-lsd-force");
    assert!(overlap.iter().all(|lowest| *lowest < -1e-4), "{overlap:?}");
    assert!(force.iter().all(|lowest| *lowest == 0.0), "{force:?}");
}

#[test]
fn sticking_sticks_and_sliding_slides() {
    for (law, _, frames) in ["oblique-sticking", "oblique-sticking-hertz"].map(frames).concat() {
        let below = touching(&frames).filter(|frame| split(frame).1 < 0.89 * split(frame).0.abs()).count();
        // All but the last touches, where the normal force passes zero.
        assert!(below + 2 >= touching(&frames).count() && below > 10, "{law}: {below} stick");
    }
    for (slug, friction) in [
        ("oblique-sliding", 0.1),
        ("oblique-sliding-hertz-material", 0.1),
        ("grazing", 0.3),
        ("grazing-hertz", 0.3),
    ] {
        for (law, _, frames) in frames(slug) {
            for frame in touching(&frames) {
                let (normal, tangential) = split(frame);
                // The Coulomb limit is met to round-off of the split.
                assert!((tangential / normal.abs() - friction).abs() < 1e-9, "{slug} {law} {}", frame.step);
            }
        }
    }
}

#[test]
fn grazing_overlaps_little() {
    for (law, scene, frames) in frames("grazing") {
        let deepest = frames.iter().map(|frame| {
            let apart: [f64; 3] = std::array::from_fn(|k| frame.position[0][k] - frame.position[1][k]);
            scene.bodies[0].diameter - dot(apart, apart).sqrt()
        });
        let deepest = deepest.fold(0.0, f64::max) / scene.bodies[0].diameter;
        assert!(deepest > 1e-4 && deepest < 2e-3, "{law}: {deepest}");
    }
}

#[test]
fn the_oblique_hit_sticks_and_slides() {
    for (law, _, frames) in
        ["two-sphere-oblique", "two-sphere-oblique-hertz", "two-sphere-oblique-hertz-material"]
            .map(frames)
            .concat()
    {
        let ratios = || touching(&frames).map(split).map(|(normal, tangential)| tangential / normal.abs());
        let slides = ratios().filter(|ratio| (ratio - 0.5).abs() < 1e-9).count();
        let sticks = ratios().filter(|ratio| *ratio < 0.49).count();
        assert!(slides >= 2 && sticks >= 2, "{law}: {slides} slide, {sticks} stick");
    }
}

#[test]
fn counter_spin_brakes_the_spin_and_throws_sideways() {
    for (law, _, frames) in frames("counter-spin") {
        let (first, last) = (&frames[0], &frames[frames.len() - 1]);
        let spin = |frame: &Frame| dot(frame.angular_velocity[0], frame.angular_velocity[0]).sqrt();
        assert!(spin(last) < 0.95 * spin(first), "{law}");
    }
}

#[test]
fn the_frozen_partner_stays_and_the_light_one_is_thrown() {
    for (law, scene, frames) in frames("frozen-partner") {
        assert!(frames.iter().all(|frame| frame.position[1] == scene.bodies[1].position), "{law}");
    }
    for (law, scene, frames) in frames("unequal") {
        let ratio = scene.bodies[1].mass() / scene.bodies[0].mass();
        assert!((140.0..141.0).contains(&ratio), "{law}: masses 1:{ratio}");
        let last = &frames[frames.len() - 1];
        let change = |k: usize| {
            let d: [f64; 3] = std::array::from_fn(|c| last.velocity[k][c] - scene.bodies[k].velocity[c]);
            dot(d, d).sqrt()
        };
        assert!(change(0) > 100.0 * change(1) && change(0) > 0.1, "{law}");
    }
}

#[test]
fn the_periodic_pair_starts_on_opposite_sides() {
    for (law, scene, _) in frames("periodic-pair") {
        let [a, b] = [scene.bodies[0].position, scene.bodies[1].position];
        assert!(a[0] * b[0] < 0.0 && a[1] * b[1] < 0.0, "{law}");
    }
}

#[test]
fn the_third_sphere_takes_over() {
    for (law, scene, frames) in frames("two-materials") {
        let last = &frames[frames.len() - 1];
        let gain: [f64; 3] = std::array::from_fn(|k| last.velocity[2][k] - scene.bodies[2].velocity[k]);
        assert!(dot(gain, gain).sqrt() > 0.03, "{law}: {gain:?}");
    }
}

#[test]
fn marbles_bounce_roll_and_hit_the_corner() {
    let radius = 5e-3;
    for (law, _, frames) in frames("wall-bounce") {
        let touch: Vec<bool> = frames.iter().map(|frame| frame.position[0][2] < radius).collect();
        let bounces = touch.windows(2).filter(|pair| pair[0] && !pair[1]).count();
        assert_eq!(bounces, 2, "{law}");
    }
    for (law, _, frames) in frames("wall-spinning") {
        let last = &frames[frames.len() - 1];
        assert!(last.velocity[0][0] > 0.02 && last.velocity[0][2] > 0.03, "{law}: {:?}", last.velocity[0]);
        // No torsion between sphere and plane.
        assert!((last.angular_velocity[0][2] - 25.0).abs() < 1e-9, "{law}");
    }
    for (law, _, frames) in frames("wall-slide-to-roll") {
        let last = &frames[frames.len() - 1];
        // 5/7 of the sliding speed (Coulomb). The tangential spring, loaded with μ m g, swings on about it: the speed by
        // μ g / ω = 3.4e-3 m/s and the slip by 7/2 of that, decaying with 20 ms.
        let (speed, spin) = (last.velocity[0][0], last.angular_velocity[0][1]);
        assert!((speed - 0.3 * 5.0 / 7.0).abs() < 3.4e-3, "{law}: {speed}");
        assert!((speed - radius * spin).abs() < 1.2e-2, "{law}: {speed} {spin}");
        let early = &frames[5];
        assert!(early.velocity[0][0] > 1.2 * early.angular_velocity[0][1] * radius, "{law} does not slide");
    }
    for (law, _, frames) in frames("wall-belt") {
        let last = &frames[frames.len() - 1];
        // Rolling on a belt of speed V from rest: 2/7 V, with the same swing.
        assert!((last.velocity[0][1] - 0.2 * 2.0 / 7.0).abs() < 3.4e-3, "{law}: {:?}", last.velocity[0]);
    }
    for (law, _, frames) in frames("wall-corner") {
        let last = &frames[frames.len() - 1];
        let both = frames.iter().any(|frame| frame.force[0][0] < 0.0 && frame.force[0][2] > 0.05);
        assert!(
            both && last.velocity[0][0] < 0.0 && last.velocity[0][2] > 0.0,
            "{law}: {:?}",
            last.velocity[0]
        );
    }
}
