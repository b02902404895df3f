//! The smallest scene in which a run fails as it has: it fails when it is run.

mod support;

use std::path::Path;
use std::sync::atomic::AtomicBool;

use granule::parts::law_api::{
    Collision, CollisionImpulse, CollisionLaw, CollisionRule, Form, LawError, LawInfo, Params, Real, Slot,
    register_collision_law, register_law,
};
use granule::prelude::{EngineError, RunError, RunOptions, Silent};
use support::{Fault, Faulty};

/// f_n = k δ up to 0.02 mm, and no number beyond.
struct Cracking;

register_law!(Faulty<Cracking>);

impl Fault for Cracking {
    const NAME: &'static str = "Cracking";

    fn force<T: Real>(stiffness: T, overlap: T, _: T) -> T {
        if overlap < T::of(2e-5) { stiffness * overlap } else { T::of(f64::NAN) }
    }
}

/// f_n = k δ up to 0.02 mm, and a panic beyond.
struct Fussy;

register_law!(Faulty<Fussy>);

impl Fault for Fussy {
    const NAME: &'static str = "Fussy";

    fn force<T: Real>(stiffness: T, overlap: T, _: T) -> T {
        assert!(overlap < T::of(2e-5), "an overlap that I do not like");
        stiffness * overlap
    }
}

/// An elastic rule that knows no speeds beyond 0.7 m/s.
struct Slow;

register_collision_law!(Slow);

impl CollisionLaw for Slow {
    const INFO: LawInfo = LawInfo {
        slot: Slot::Collision,
        parameters: &[],
        forms: &[Form { doc: "", required: &[], optional: &[] }],
        ..support::spring("Slow")
    };

    fn compile(_: &Params) -> Result<Box<dyn CollisionRule>, LawError> {
        Ok(Box::new(Slow))
    }
}

impl std::fmt::Debug for Slow {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Slow")
    }
}

impl CollisionRule for Slow {
    fn impulse(&self, collision: &Collision) -> CollisionImpulse {
        assert!(collision.normal_speed < 0.7, "a speed that I do not know");
        CollisionImpulse {
            normal: 2.0 * collision.reduced_mass * collision.normal_speed,
            tangential: [0.0; 3],
        }
    }

    fn restitution(&self, _: f64) -> f64 {
        1.0
    }

    fn is_rough(&self) -> bool {
        false
    }

    fn is_inelastic(&self) -> bool {
        false
    }
}

fn run(scene: &Path, folder: &Path) -> RunError {
    let (mut silent, stop) = (Silent, AtomicBool::new(false));
    let options = RunOptions {
        output_dir: Some(folder.to_path_buf()),
        threads: Some(2),
        force: false,
        progress: &mut silent,
        stop: &stop,
        max_time: None,
    };
    granule::run(scene, options).expect_err("the law ends")
}

/// Runs a scene, and the one that it leaves, which must have few bodies. What both say, `words` in it, and the error of the
/// second.
fn twice(text: &str, bodies: usize, words: &[&str]) -> EngineError {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.ron");
    std::fs::write(&path, text).unwrap();
    let error = run(&path, &folder.path().join("out"));
    let told = error.to_string();
    assert!(words.iter().all(|words| told.contains(words)), "{told}");
    let RunError::Engine { aftermath, .. } = &error else { panic!("{told}") };
    let capsule = aftermath.capsule.as_ref().unwrap_or_else(|| panic!("a scene is left: {told}"));
    assert!(told.contains("the same happens in a scene of ") && told.contains("crash.ron"), "{told}");
    let scene = std::fs::read_to_string(capsule).unwrap();
    let left = scene.matches("Body(id:").count();
    assert!((1..=bodies).contains(&left), "{scene}");
    let again = run(capsule, &folder.path().join("again"));
    let RunError::Engine { error, .. } = again else { panic!("{again}") };
    error
}

/// A gas of a thousand spheres in which, after a while, two meet too fast.
fn gas(contact: &str, driver: &str) -> String {
    format!(
        r#"(version: 1, seed: 5, materials: {{ "a": (density: 2500) }},
    cell: (lo: (0, 0, 0), hi: ("30 mm", "30 mm", "30 mm"), periodic: (true, true, true)),
    bodies: [
        Lattice(kind: Cubic, material: "a", radius: "1 mm", spacing: "3 mm", lo: (0, 0, 0), hi: ("29 mm", "29 mm", "29 mm"),
            velocity_spread: 0.2),
    ],
    contacts: [(between: ("a", "a"), {contact})],
    {driver}, // a comment
    outputs: [Series(path: "series.csv", columns: ["kinetic_energy"], every: 10)])"#
    )
}

const STEPS: &str = r#"driver: TimeStep(step: "2 us"), run: (steps: 100000)"#;

#[test]
fn a_number_that_is_not_finite_leaves_the_pair_that_made_it() {
    let scene = gas("normal: Cracking(stiffness: 1e3)", STEPS);
    let error = twice(&scene, 2, &["the law Cracking gave", "likely cause", "touches"]);
    assert!(matches!(error, EngineError::LawNotFinite { law: "Cracking", .. }), "{error}");
}

#[test]
fn a_law_that_panics_leaves_the_pair_that_it_panics_about() {
    let scene = gas("normal: Fussy(stiffness: 1e3)", STEPS);
    let error = twice(&scene, 2, &["the law Fussy panicked at step", "an overlap that I do not like"]);
    assert!(matches!(error, EngineError::LawPanicked { law: "Fussy", .. }), "{error}");
}

#[test]
fn a_collision_rule_that_panics_leaves_the_pair_that_it_panics_about() {
    let scene = gas("collision: Slow()", r#"driver: Event(step: "1 ms"), run: (duration: "1 s")"#);
    let error = twice(&scene, 2, &["the law Slow panicked at step", "a speed that I do not know", "body "]);
    assert!(matches!(error, EngineError::LawPanicked { law: "Slow", .. }), "{error}");
}

/// Twenty hard spheres between walls that close.
#[test]
fn crushed_hard_bodies_leave_the_smallest_scene_that_is_crushed() {
    let scene = r#"(version: 1, seed: 3, materials: { "a": (density: 2500) },
    bodies: [Lattice(kind: Cubic, material: "a", radius: "1 mm", spacing: "2.5 mm", lo: ("2 mm", 0, 0),
        hi: ("4 mm", "10 mm", "10 mm"), velocity_spread: 0.05)],
    walls: {
        "left": Plane(point: (0, 0, 0), normal: (1, 0, 0), material: "a"),
        "right": Plane(point: ("6 mm", 0, 0), normal: (-1, 0, 0), material: "a",
            motion: Constant(velocity: (-0.1, 0, 0))),
    },
    contacts: [(between: ("a", "a"), collision: HardSphere(restitution: 0.9))],
    driver: Event(step: "1 ms"), run: (duration: "1 s"))"#;
    let error = twice(scene, 1, &["likely cause: walls that close", "remedy"]);
    assert!(matches!(error, EngineError::Crushed { .. }), "{error}");
}
