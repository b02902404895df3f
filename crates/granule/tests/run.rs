//! The facade as a library: loading, running, telling, failing.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use granule::parts::formats::csv;
use granule::prelude::*;

const SCENE: &str = "(
    version: 1,
    title: \"ball on a floor\",
    gravity: (0, 0, -9.81),
    materials: { \"glass\": (density: \"2500 kg/m^3\") },
    bodies: [
        Sphere(material: \"glass\", radius: \"1 mm\", position: (0, 0, \"3 mm\"), velocity: (\"0.2 m/s\", 0, 0)),
        Sphere(material: \"glass\", radius: \"1 mm\", position: (\"5 mm\", 0, \"2 mm\")),
    ],
    walls: { \"floor\": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: \"glass\") },
    contacts: [
        (
            between: (\"glass\", \"glass\"),
            normal: LinearSpringDashpot(contact_duration: \"0.2 ms\", restitution: 0.8),
        ),
    ],
    run: (duration: \"50 ms\"),
    outputs: [Series(path: \"series.csv\", columns: [\"energy_residual\", \"kinetic_energy\", \"mean_height\"])],
)
";

fn scene_in(folder: &Path, text: &str) -> std::path::PathBuf {
    let path = folder.join("ball.ron");
    std::fs::write(&path, text).unwrap();
    path
}

fn options<'a>(folder: &Path, progress: &'a mut dyn Progress, stop: &'a AtomicBool) -> RunOptions<'a> {
    RunOptions {
        output_dir: Some(folder.join("out")),
        threads: Some(1),
        force: false,
        progress,
        stop,
        max_time: None,
    }
}

/// Remembers what it was told; asks to stop after `patience` reports.
struct Listener<'a> {
    begun: u64,
    statuses: Vec<Status>,
    ended: Option<Status>,
    stop: &'a AtomicBool,
    patience: usize,
}

impl<'a> Listener<'a> {
    fn new(stop: &'a AtomicBool, patience: usize) -> Self {
        Self { begun: 0, statuses: Vec::new(), ended: None, stop, patience }
    }
}

impl Progress for Listener<'_> {
    fn begin(&mut self, outlook: &Outlook<'_>) {
        assert_eq!((outlook.title, outlook.bodies), ("ball on a floor", 2));
        self.begun = outlook.steps;
    }

    fn advance(&mut self, status: &Status) {
        self.statuses.push(*status);
        if self.statuses.len() >= self.patience {
            self.stop.store(true, Ordering::Relaxed);
        }
    }

    fn end(&mut self, status: &Status) {
        self.ended = Some(*status);
    }
}

#[test]
fn a_run_tells_how_far_it_is_and_what_it_did() {
    let folder = tempfile::tempdir().unwrap();
    let stop = AtomicBool::new(false);
    let mut listener = Listener::new(&stop, usize::MAX);
    let path = scene_in(folder.path(), SCENE);
    let summary = granule::run(&path, options(folder.path(), &mut listener, &stop)).unwrap();
    assert_eq!(summary.ending, Ending::Completed);
    assert_eq!(summary.steps, listener.begun);
    assert!((summary.time - 0.05).abs() < 1e-12);
    assert!(listener.statuses.windows(2).all(|pair| pair[0].step < pair[1].step));
    let end = listener.ended.unwrap();
    assert_eq!((end.step, end.left), (summary.steps, Some(std::time::Duration::ZERO)));
    assert_eq!(summary.outputs.len(), 2);
    // Second order with 50 steps in a contact: (omega dt)^2 = (pi/50)^2.
    let drift = summary.energy_drift.unwrap();
    assert!(drift.relative().abs() < 4e-3, "{drift:?}");
    let series = csv::read(folder.path().join("out/series.csv")).unwrap();
    assert_eq!(*series.column("energy_residual").unwrap().last().unwrap(), drift.residual);
}

#[test]
fn a_stopped_run_is_the_beginning_of_the_whole_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_in(folder.path(), SCENE);
    let stop = AtomicBool::new(false);
    let mut listener = Listener::new(&stop, 3);
    let stopped = granule::run(&path, options(folder.path(), &mut listener, &stop)).unwrap();
    assert_eq!(stopped.ending, Ending::Stopped);
    assert!(stopped.steps < listener.begun);
    let rows = |name: &str| csv::read(folder.path().join(name).join("series.csv")).unwrap().values;
    let short = rows("out");
    let never = AtomicBool::new(false);
    let mut silent = Silent;
    let again = RunOptions {
        output_dir: Some(folder.path().join("whole")),
        ..options(folder.path(), &mut silent, &never)
    };
    granule::run(&path, again).unwrap();
    for (short, whole) in short.iter().zip(rows("whole")) {
        let rows = short.len() - 1;
        assert!(rows >= 1);
        assert_eq!(
            short[..rows],
            whole[..rows],
            "all rows but the last, which is written where the run stopped"
        );
    }
}

#[test]
fn warnings_do_not_stop_a_scene_and_errors_are_all_there() {
    let good = granule::load_text(Path::new("a.ron"), SCENE.to_string()).unwrap();
    assert_eq!(good.warnings, []);
    let bad = SCENE
        .replace("restitution: 0.8", "restitution: 1.8")
        .replace("\"1 mm\", position: (0,", "\"1 kg\", position: (0,");
    let Err(LoadError::Scene { diagnostics, .. }) = granule::load_text(Path::new("a.ron"), bad) else {
        panic!("a bad scene loads")
    };
    let errors: Vec<&str> = diagnostics
        .iter()
        .filter(|diagnostic| diagnostic.severity == Severity::Error)
        .map(|diagnostic| diagnostic.message.as_str())
        .collect();
    assert!(errors.iter().any(|message| message.contains("1.8")), "{errors:?}");
    assert!(errors.iter().any(|message| message.contains("kg")), "{errors:?}");
}

/// Every piece of a scene is left out, doubled, or replaced by something odd: there may be errors, but never a panic.
#[test]
fn no_scene_makes_it_panic() {
    let friction = "restitution: 0.8),\n tangential: TangentialSpring(stiffness: 1e3, friction: 0.4),";
    let short = SCENE.replace("50 ms", "0.1 ms").replace("restitution: 0.8),", friction);
    let words: Vec<&str> = short.split_inclusive([' ', '\n', ',', '(', ')', ':']).collect();
    let odd = [
        "",
        "NaN",
        "inf",
        "-1",
        "\"\"",
        "1e999",
        "(",
        "]",
        "\"1 mm",
        "\u{fffd}",
        "18446744073709551616",
        "Box",
    ];
    let folder = tempfile::tempdir().unwrap();
    let never = AtomicBool::new(false);
    let mut sound = 0;
    for index in 0..words.len() {
        for replacement in odd.iter().copied().chain([words[index].repeat(2).as_str()]) {
            let mut text: String = words[..index].concat();
            text.push_str(replacement);
            text.push_str(&words[index + 1..].concat());
            let Ok(loaded) = granule::load_text(Path::new("a.ron"), text) else { continue };
            // A scene that happens to be sound must run, or say why not.
            if loaded.plan.driver.steps < 1000 {
                sound += 1;
                let mut silent = Silent;
                let options = RunOptions { force: true, ..options(folder.path(), &mut silent, &never) };
                let result = granule::run_plan(loaded.plan, Some(&loaded.source), folder.path(), options);
                if let Err(error) = result {
                    assert!(!error.to_string().is_empty());
                }
            }
        }
    }
    assert!(sound > 10, "{sound}");
}

#[test]
fn numbers_beyond_all_bounds_end_a_run_with_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let fast = SCENE
        .replace("gravity: (0, 0, -9.81)", "gravity: (0, 0, -1e300)")
        .replace("run: (duration: \"50 ms\")", "driver: TimeStep(step: 1e-6), run: (steps: 100)");
    let path = scene_in(folder.path(), &fast);
    let stop = AtomicBool::new(false);
    let message = granule::run(&path, options(folder.path(), &mut Silent, &stop)).unwrap_err().to_string();
    assert!(message.contains("energy_residual") || message.contains("not finite"), "{message}");
}
