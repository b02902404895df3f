//! The oracle against the engines, against closed forms, and against itself with conventions turned.

use super::vector::{Vector, add, cross, norm, scale, sub};
use super::*;
use crate::cases;
use crate::peers::compare::{Scales, compare};
use crate::peers::{Frame, PeerLaw, PeerScene, Quantity, Record, inputs};
use crate::translate::Target;

/// Every case and target against the recorded answer of the engine: every compared step, body and quantity.
///
/// Both follow the same equations in the same order of steps, so the difference is round-off: 1e-16 per operation, carried
/// on by the contact. It grows to 1e-13 where coordinates are large against overlaps (5e-3 m against 1e-5 m at rest on a
/// wall: 1e-16 · 500 per step in the force), at the end of Hertz contacts (a damping that goes with the root of the overlap
/// is infinitely steep at zero), and in `pair granular`, which turns its spring only if that changes the force by more than
/// 1e-10 of the Coulomb limit: round-off decides whether it does.
#[test]
fn follows_the_engines() {
    let mut compared = 0;
    for case in cases::all().unwrap() {
        for &target in &case.targets {
            let scene = case.peer(target).unwrap();
            let ours = march(&scene).unwrap();
            let record = Record::load(&case.record(target), &inputs(&scene).unwrap()).unwrap();
            let scales = Scales::of(&scene, &record.frames);
            let comparison = compare(&scene, &record.frames, &ours, &scales, &Quantity::ALL).unwrap();
            let worst = comparison.worst().unwrap();
            assert!(worst.scaled <= 5e-13, "{} {}: {worst:?}", case.slug, target.name());
            compared += 1;
        }
    }
    assert!(compared >= 40, "{compared} comparisons");
}

fn scene(slug: &str, target: Target) -> PeerScene {
    cases::find(slug).unwrap().peer(target).unwrap()
}

/// Restitution of body 1 against body 2 in a head-on hit.
fn restitution(frames: &[Frame]) -> f64 {
    let speed = |frame: &Frame| norm(sub(frame.velocity[0], frame.velocity[1]));
    speed(&frames[frames.len() - 1]) / speed(&frames[0])
}

/// exp(-η π / ω) when the contact ends with the overlap and exp(-2 (η / ω) atan(ω / η)) when it ends with the force, with
/// η = gamma_n / 2 and ω² = kn / m - η² (Luding 1998, Eqs. (32) and (36); erratum L-E7).
#[test]
fn both_ends_of_a_damped_linear_contact() {
    let mass = 0.5 * scene("head-on-lsd-force", Target::LammpsClassic).bodies[0].mass();
    let (eta, omega0) = (1.5e4, (1000.0 / mass).sqrt());
    let omega = (omega0 * omega0 - eta * eta).sqrt();
    let overlap = (-std::f64::consts::PI * eta / omega).exp();
    let force = (-2.0 * eta / omega * (omega / eta).atan()).exp();
    for (slug, expected) in [("head-on-lsd-overlap", overlap), ("head-on-lsd-force", force)] {
        for target in Target::ALL {
            let mut scene = scene(slug, target);
            let mut errors = [0.0; 2];
            for error in &mut errors {
                *error = (restitution(&march(&scene).unwrap()) - expected).abs();
                scene.time_step *= 0.1;
                scene.steps *= 10;
                scene.dump_every *= 10;
            }
            // Half-step velocities make the scheme first order with damping: 3e-2 at 80 steps per contact, a tenth of it
            // at 800; the time of first touch within a step adds as much.
            assert!(errors[0] < 3e-2 && errors[1] < 3e-3, "{slug}: {errors:?}");
        }
    }
}

fn momentum(scene: &PeerScene, frame: &Frame) -> (Vector, Vector) {
    let (mut linear, mut angular) = ([0.0; 3], [0.0; 3]);
    for (k, id) in frame.ids.iter().enumerate() {
        let body = scene.bodies.iter().find(|body| body.id == *id).unwrap();
        let push = scale(body.mass(), frame.velocity[k]);
        let inertia = 0.4 * body.mass() * body.radius() * body.radius();
        linear = add(linear, push);
        angular =
            add(angular, add(cross(frame.position[k], push), scale(inertia, frame.angular_velocity[k])));
    }
    (linear, angular)
}

/// Shortened arms add up to the distance of the centres, so the torques balance the moment of the forces; full radii do
/// not. The bound is round-off of 240 steps; the excess with full radii is the overlap against the radius, 1e-2.
#[test]
fn angular_momentum_is_kept_by_shortened_arms_only() {
    let scene = scene("two-sphere-oblique", Target::LammpsClassic);
    let drift = |frames: &[Frame]| {
        let (first, last) = (momentum(&scene, &frames[0]), momentum(&scene, &frames[frames.len() - 1]));
        (norm(sub(last.0, first.0)) / norm(first.0), norm(sub(last.1, first.1)) / norm(first.1))
    };
    let physical = drift(&march_with(&scene, &|_| ConventionSet::PHYSICAL).unwrap());
    assert!(physical.0 < 1e-13 && physical.1 < 1e-13, "{physical:?}");
    let classic = drift(&march(&scene).unwrap());
    assert!(classic.0 < 1e-13, "{classic:?}");
    assert!(classic.1 > 1e-5, "{classic:?}");
}

/// Each engine's own conventions are a point in the space of switches: one law run with the other engine's set gives the
/// other engine's run. `hooke/stiffness` of LIGGGHTS and `gran/hooke/history` of LAMMPS have the same coefficients.
#[test]
fn conventions_are_the_whole_difference_between_engines() {
    let lammps = scene("two-sphere-oblique", Target::LammpsClassic);
    let liggghts = scene("two-sphere-oblique", Target::Liggghts);
    let set = |scene: &PeerScene| ConventionSet::of(scene.laws.values().next().unwrap());
    let reference = march(&liggghts).unwrap();
    let scales = Scales::of(&liggghts, &reference);
    let apart = |frames: &[Frame]| {
        compare(&liggghts, &reference, frames, &scales, &Quantity::ALL).unwrap().worst().unwrap().scaled
    };
    assert!(apart(&march(&lammps).unwrap()) > 1e-4);
    let turned = set(&liggghts);
    // Same equations, products in another order.
    assert!(apart(&march_with(&lammps, &|_: &PeerLaw| turned).unwrap()) < 1e-13);
}
