//! `granule trade`: what it states holds, and it goes on where it stopped.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use granule_law_api::Registry;
use granule_laws as _;
use granule_scene::{IntegratorChoice, PrecisionChoice};
use granule_trade::{Omission, Options, Setting, Study, TradeError, Watch, chosen_scene, trade};

const OBLIQUE: &str = r#"(
    version: 1,
    title: "an oblique hit",
    materials: { "a": (density: 2500) },
    bodies: [
        Sphere(material: "a", radius: "0.5 mm", position: (0, 0, 0), velocity: (0.4, 0.2, 0), spin: (0, 0, 100)),
        Sphere(material: "a", radius: "0.6 mm", position: ("1.12 mm", "0.1 mm", 0)),
    ],
    contacts: [(
        between: ("a", "a"),
        normal: LinearSpringDashpot(stiffness: 1e3, restitution: 0.7),
        tangential: TangentialSpring(stiffness: 285, friction: 0.4),
    )],
    run: (duration: "0.4 ms"),
)"#;

/// Counts runs.
#[derive(Default)]
struct Count(usize);

impl Watch for Count {
    fn progress(&mut self, _: usize, _: usize, _: &str) {
        self.0 += 1;
    }
}

fn options(folder: &Path) -> Options {
    Options { directory: folder.to_path_buf(), observe: Vec::new(), realisations: 5, target: 0.01 }
}

fn run(text: &str, options: &Options) -> Result<Study, TradeError> {
    let registry = Registry::collect().unwrap();
    trade(text, Path::new("."), &registry, options, &mut Count::default(), &AtomicBool::new(false))
}

/// The worst of runs at steps that were not used before errs by no more than was stated with its bar, for 19
/// of 20 settings and observables; of thirteen realisations six are new.
#[test]
fn what_is_stated_holds_when_it_is_run_again() {
    let folder = tempfile::tempdir().unwrap();
    let seven = Options { realisations: 7, ..options(folder.path()) };
    let study = run(OBLIQUE, &seven).unwrap();
    assert!(study.paths && !study.seeds && study.settings.len() > 20);
    let again = Options { realisations: 13, ..options(folder.path()) };
    let again = run(OBLIQUE, &again).unwrap();
    let (mut all, mut outside) = (0, Vec::new());
    for scored in &study.settings {
        let same = again.settings.iter().find(|other| other.setting == scored.setting).unwrap();
        for observable in 0..scored.errors.len() {
            let stated = scored.errors[observable] + scored.bars[observable];
            let error = same.errors[observable];
            all += 1;
            if error > stated {
                outside.push(format!("{}: {error} of {stated}", scored.setting.label()));
            }
        }
    }
    assert!(20 * outside.len() <= all, "{} of {all}: {outside:?}", outside.len());
}

/// More steps cost more and err less, over the whole ladder; leaving friction out of a scene that has it is wrong.
#[test]
fn the_ladder_is_a_trade() {
    let folder = tempfile::tempdir().unwrap();
    let study = run(OBLIQUE, &options(folder.path())).unwrap();
    let find = |steps: f64, without: Omission| {
        let wanted = Setting {
            integrator: IntegratorChoice::VelocityVerlet,
            steps_per_contact: steps,
            precision: PrecisionChoice::Double,
            stiffness: 1.0,
            without,
        };
        study.settings.iter().find(|scored| scored.setting == wanted).unwrap()
    };
    let (coarse, fine) = (find(10.0, Omission::None), find(320.0, Omission::None));
    // First order: 32 times the steps, a thirty-second of the error; a third of that is asked for.
    assert!(fine.error < 0.1 * coarse.error, "{} {}", coarse.error, fine.error);
    assert!((fine.steps_per_second / coarse.steps_per_second / 32.0 - 1.0).abs() < 0.1);
    assert!(find(40.0, Omission::Friction).error > 0.1);
    let chosen = &study.settings[study.chosen.unwrap()];
    assert!(chosen.reliable_error() <= 0.01 && chosen.setting.without == Omission::None);
    let text = chosen_scene(OBLIQUE, &chosen.setting, &Registry::collect().unwrap(), Path::new(".")).unwrap();
    let parsed = granule_scene::parse(&text).scene.unwrap();
    let (plan, _) = granule_plan::build(&parsed, &Registry::collect().unwrap(), Path::new("."));
    assert!(
        (plan.unwrap().driver.step / chosen.step - 1.0).abs() < 1e-12,
        "the scene runs with the chosen step"
    );
}

/// The second time nothing is run, and the result is the same.
#[test]
fn a_trade_goes_on_where_it_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let stopped = trade(
        OBLIQUE,
        Path::new("."),
        &Registry::collect().unwrap(),
        &options(folder.path()),
        &mut Count::default(),
        &AtomicBool::new(true),
    );
    assert!(matches!(stopped, Err(TradeError::Stopped)));
    let first = run(OBLIQUE, &options(folder.path())).unwrap();
    let size = |folder: &Path| std::fs::metadata(folder.join("runs.jsonl")).unwrap().len();
    let before = size(folder.path());
    let second = run(OBLIQUE, &options(folder.path())).unwrap();
    assert_eq!(size(folder.path()), before);
    assert!(first.settings == second.settings, "what was kept is what was measured, to the bit");
}

/// Twelve bouncing spheres in a box do not have paths after a while, and the trade says so.
#[test]
fn a_scene_without_a_reference_says_so() {
    let mut list = String::new();
    for i in 0..12 {
        let (x, y) = (f64::from(i % 4) * 2.5 + 1.3, f64::from(i / 4) * 3.0 + 1.7);
        let turn = f64::from(i) * 2.4;
        list += &format!(
            "Sphere(material: \"a\", radius: \"1 mm\", position: (\"{x} mm\", \"{y} mm\", \"5 mm\"), velocity: ({:?}, {:?}, \
             0)),",
            turn.cos(),
            turn.sin()
        );
    }
    let scene = format!(
        r#"(version: 1, materials: {{ "a": (density: 2500) }}, bodies: [{list}],
        walls: {{ "box": Box(lo: (0, 0, 0), hi: ("10.2 mm", "10.2 mm", "10 mm"), material: "a") }},
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e3, restitution: 1))],
        run: (duration: "30 ms"))"#
    );
    let folder = tempfile::tempdir().unwrap();
    let three = Options { realisations: 3, ..options(folder.path()) };
    let error = run(&scene, &three).err().expect("chaotic").to_string();
    assert!(error.starts_with("no reference: velocities") && error.contains("chaotic"), "{error}");
}

#[test]
fn unknown_quantities_are_refused_with_the_known_ones() {
    let folder = tempfile::tempdir().unwrap();
    let wrong = Options { observe: vec!["energy".into()], ..options(folder.path()) };
    let error = run(OBLIQUE, &wrong).err().unwrap().to_string();
    assert!(error.contains("`energy`; known are velocities, spins, kinetic_energy"), "{error}");
}
