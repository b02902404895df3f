//! A law of somebody else at fault is named: before the run if it creates energy, else in the error that ends the run with whole
//! files.

mod support;

use std::path::Path;
use std::sync::atomic::AtomicBool;

use granule::parts::law_api::{
    Collision, CollisionEntry, CollisionImpulse, CollisionLaw, CollisionRule, Form, Impact, LawEntry,
    LawError, LawInfo, Params, Real, Slot, TimeScale, probe,
};
use granule::prelude::{RunError, RunOptions, Silent};
use support::{Fault, Faulty};

/// f_n = k δ, with a panic at overlaps over a thousandth of a millimetre.
struct Fussy;

static FUSSY: LawEntry = LawEntry::of::<Faulty<Fussy>>("test", "0.0.0");

impl Fault for Fussy {
    const NAME: &'static str = "Fussy";

    fn force<T: Real>(stiffness: T, overlap: T, _: T) -> T {
        assert!(overlap < T::of(1e-6), "an overlap that I do not like");
        stiffness * overlap
    }
}

/// f_n = k δ, and no number at overlaps over a thousandth of a millimetre.
struct Blank;

static BLANK: LawEntry = LawEntry::of::<Faulty<Blank>>("test", "0.0.0");

impl Fault for Blank {
    const NAME: &'static str = "Blank";

    fn force<T: Real>(stiffness: T, overlap: T, _: T) -> T {
        // A root of what becomes negative: a mistake that is easily made.
        stiffness * overlap + T::ZERO * (T::of(1e-6) - overlap).sqrt()
    }
}

/// A spring that pushes back a tenth harder than it is pressed, and promises never to create energy.
struct Generous;

static GENEROUS: LawEntry = LawEntry::of::<Faulty<Generous>>("test", "0.0.0");

impl Fault for Generous {
    const NAME: &'static str = "Generous";

    fn force<T: Real>(stiffness: T, overlap: T, normal_velocity: T) -> T {
        let more = if normal_velocity < T::ZERO { T::of(1.1) } else { T::ONE };
        more * stiffness * overlap
    }

    fn time_scale(stiffness: f64, impact: &Impact) -> Option<TimeScale> {
        let root = (impact.reduced_mass / stiffness).sqrt();
        let (duration, overlap) = (std::f64::consts::PI * root, impact.normal_speed * root);
        Some(TimeScale { duration, stiffness, damping: 0.0, overlap })
    }
}

/// A rule that gives more than all of the speed back.
struct Trampoline;

static TRAMPOLINE: CollisionEntry = CollisionEntry::of::<Trampoline>("test", "0.0.0");

impl CollisionLaw for Trampoline {
    const INFO: LawInfo = LawInfo {
        slot: Slot::Collision,
        parameters: &[],
        forms: &[Form { doc: "", required: &[], optional: &[] }],
        ..support::spring("Trampoline")
    };

    fn compile(_: &Params) -> Result<Box<dyn CollisionRule>, LawError> {
        Ok(Box::new(Rebound))
    }
}

#[derive(Debug)]
struct Rebound;

impl CollisionRule for Rebound {
    fn impulse(&self, collision: &Collision) -> CollisionImpulse {
        let normal = 2.1 * collision.reduced_mass * collision.normal_speed;
        CollisionImpulse { normal, tangential: [0.0; 3] }
    }

    fn restitution(&self, _: f64) -> f64 {
        1.1
    }

    fn is_rough(&self) -> bool {
        false
    }

    fn is_inelastic(&self) -> bool {
        false
    }
}

/// Spheres on a lattice that fly about until two of them meet, or that overlap from the start.
fn scene(law: &str, spacing: &str) -> String {
    format!(
        r#"(version: 1, materials: {{ "a": (density: 2500) }},
    cell: (lo: (0, 0, 0), hi: ("48 mm", "48 mm", "48 mm"), periodic: (true, true, true)),
    bodies: [Lattice(kind: Cubic, material: "a", radius: "1 mm", spacing: "{spacing}", lo: (0, 0, 0),
        hi: ("47 mm", "47 mm", "47 mm"), velocity_spread: 1)],
    contacts: [(between: ("a", "a"), normal: {law}(stiffness: 1e4))],
    driver: TimeStep(step: "1 us"), run: (steps: 5000), allow_overlap: true,
    outputs: [Series(path: "series.csv", columns: ["kinetic_energy"], every: 10)])"#
    )
}

#[test]
fn a_law_at_fault_is_named_and_files_are_whole() {
    let laws = granule::laws().unwrap();
    let entries = laws.entries().iter().copied().chain([&FUSSY, &BLANK]);
    let laws = granule::parts::law_api::Registry::from_entries(entries).unwrap();
    let panic = ["the law Fussy panicked at step", "an overlap that I do not like"];
    let number = ["the law Blank gave a normal force that is not finite between body", " and body "];
    for (law, told) in [("Fussy", panic), ("Blank", number)] {
        for (spacing, threads, begins) in [("3 mm", 1, true), ("3 mm", 4, true), ("1.99 mm", 4, false)] {
            let parsed = granule::parts::scene::parse(&scene(law, spacing));
            let (plan, problems) = granule::parts::plan::build(&parsed.scene.unwrap(), &laws, Path::new("."));
            let plan = plan.unwrap_or_else(|| panic!("{:?} {problems:?}", parsed.diagnostics));
            let folder = tempfile::tempdir().unwrap();
            let (mut silent, stop) = (Silent, AtomicBool::new(false));
            let options = RunOptions {
                output_dir: None,
                threads: Some(threads),
                force: false,
                progress: &mut silent,
                stop: &stop,
                max_time: None,
            };
            let error = granule::run_plan(plan, None, folder.path(), options).unwrap_err();
            let message = error.to_string();
            assert!(matches!(error, RunError::Engine { .. }), "{message}");
            assert!(told.iter().all(|words| message.contains(words)), "{message}");
            assert_eq!(message.contains("at step 0 "), !begins, "{message}");
            if begins {
                let manifest = std::fs::read_to_string(folder.path().join("manifest.json")).unwrap();
                assert!(manifest.contains(&format!("failed: the law {law} ")), "{manifest}");
                let series = granule::parts::formats::csv::read(folder.path().join("series.csv")).unwrap();
                assert!(!series.column("step").unwrap().is_empty());
            }
        }
    }
}

#[test]
fn a_law_that_creates_energy_is_refused_by_name() {
    let laws = granule::laws().unwrap();
    let entries = laws.entries().iter().copied().chain([&GENEROUS]);
    let laws = granule::parts::law_api::Registry::from_entries(entries).unwrap();
    let parsed = granule::parts::scene::parse(&scene("Generous", "3 mm"));
    let (plan, problems) = granule::parts::plan::build(&parsed.scene.unwrap(), &laws, Path::new("."));
    assert!(plan.is_none());
    // Pressed and released by turns, a spring that gives 1.1 for 1 gives 0.1 of the 2.1 that it takes and gives.
    let told =
        "the law Generous creates energy, which it promises not to do: 4.8e-2 of the work comes out on top";
    assert!(problems.iter().any(|problem| problem.message.contains(told)), "{problems:?}");
}

#[test]
fn a_rule_that_creates_energy_is_named() {
    let rule = (TRAMPOLINE.compile)(&Params::new(&Trampoline::INFO, &[]).unwrap()).unwrap();
    let fault = probe::try_collisions(&*rule, true).unwrap_err();
    // 1.1 squared.
    assert!(
        matches!(fault, probe::Fault::CreatesEnergy { share, .. } if (share - 0.21).abs() < 1e-12),
        "{fault}"
    );
    assert_eq!(probe::try_collisions(&*rule, false), Ok(()));
}
