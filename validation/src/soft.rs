//! How soft is soft enough: packing fraction and flow rate against the stiffness.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use granule_drivers::{View, driver};
use rayon::prelude::*;
use serde::Serialize;

use crate::ours::SceneFile;

/// Stiffnesses in units of m g/d; the first is what the others are held against.
const STIFFNESSES: [f64; 5] = [1e5, 1e4, 1e3, 300.0, 100.0];
/// Initial states of each stiffness.
const SEEDS: u64 = 4;

/// One observable: its scene and how it is read off.
struct Case {
    name: &'static str,
    what: &'static str,
    scene: fn() -> String,
    /// Time of the run, and from when on the quantity is averaged.
    times: (f64, f64),
    measure: fn(&View<'_>) -> f64,
}

/// Lengths in diameters, masses in those of a sphere, gravity is 1.
const CASES: [Case; 2] = [
    Case {
        name: "packing fraction",
        what: "400 spheres poured on a floor between periodic sides: their volume over twice the volume below their mean height",
        scene: settling,
        times: (25.0, 22.0),
        measure: |view| {
            let volume = loose(view).len() as f64 * std::f64::consts::PI / 6.0;
            let height = loose(view).iter().map(|x| x[2]).sum::<f64>() / loose(view).len() as f64;
            volume / (36.0 * 2.0 * height)
        },
    },
    Case {
        name: "flow rate",
        what: "300 spheres on a rough incline of 25 degrees, in motion: mean velocity along it from time 12 to 15",
        scene: incline,
        times: (15.0, 12.0),
        measure: |view| {
            let bodies = view.bodies();
            let moving: Vec<f64> = (0..bodies.len())
                .filter(|place| bodies.velocity[*place][3] > 0.0)
                .map(|place| bodies.velocity_of(place)[0])
                .collect();
            moving.iter().sum::<f64>() / moving.len() as f64
        },
    },
];

/// Centres of the bodies that may move.
fn loose(view: &View<'_>) -> Vec<[f64; 3]> {
    let bodies = view.bodies();
    (0..bodies.len())
        .filter(|place| bodies.velocity[*place][3] > 0.0)
        .map(|place| bodies.position[place].vector())
        .collect()
}

const LAWS: &str = "materials: { \"a\": (density: 1.909859317102744) }, contacts: [(between: (\"a\", \"a\"), \
    normal: LinearSpringDashpot(stiffness: STIFFNESS, restitution: 0.5), \
    tangential: TangentialSpring(stiffness_ratio: 0.2857142857142857, friction: 0.5, damping_ratio: 0.5))], \
    driver: TimeStep(step: Auto(steps_per_contact: 20)), seed: SEED,";

fn settling() -> String {
    format!(
        "(version: 1, gravity: (0, 0, -1), {LAWS} \
         cell: (lo: (0, 0, 0), hi: (6, 6, inf), periodic: (true, true, false)), \
         bodies: [Fill(material: \"a\", radius: 0.5, count: 400, lo: (0, 0, 0), hi: (6, 6, 24), velocity_spread: 0.3)], \
         walls: {{ \"floor\": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: \"a\") }}, run: (duration: TIME))"
    )
}

fn incline() -> String {
    let (sine, cosine) = 25.0_f64.to_radians().sin_cos();
    format!(
        "(version: 1, gravity: ({sine:?}, 0, {:?}), {LAWS} \
         cell: (lo: (0, 0, -1), hi: (10, 5, inf), periodic: (true, true, false)), bodies: [\
         Lattice(material: \"a\", radius: 0.5, spacing: 1, lo: (0, 0, 0), hi: (9.5, 4.5, 0), frozen: true), \
         Fill(material: \"a\", radius: 0.5, count: 300, lo: (0, 0, 1), hi: (10, 5, 14), velocity_spread: 0.3)], \
         run: (duration: TIME))",
        -cosine
    )
}

/// What a stiffness gives.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Observable.
    pub observable: String,
    /// k in units of m g/d.
    pub stiffness: f64,
    /// Mean over the initial states.
    pub mean: f64,
    /// Standard error of the mean.
    pub error: f64,
    /// Steps of a run.
    pub steps: u64,
    /// Mean time of the steps of a run on one core \[s\].
    pub seconds: f64,
}

/// Value, steps and seconds of one run.
fn run(case: &Case, stiffness: f64, seed: u64) -> Result<(f64, u64, f64), String> {
    let (time, from) = case.times;
    let text = (case.scene)()
        .replace("STIFFNESS", &format!("{stiffness:?}"))
        .replace("SEED", &seed.to_string())
        .replace("TIME", &format!("{time:?}"));
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let path = folder.path().join("scene.ron");
    std::fs::write(&path, text).map_err(|error| error.to_string())?;
    let plan = SceneFile::read(&path)?.plan()?;
    let steps = plan.driver.steps;
    let mut driver = driver(plan, Some(1)).map_err(|error| error.to_string())?;
    let never = AtomicBool::new(false);
    let (mut sum, mut count, mut seconds) = (0.0, 0, 0.0);
    const FRAMES: u64 = 20;
    let first = (steps as f64 * from / time) as u64;
    for frame in 0..=FRAMES {
        let clock = Instant::now();
        let to = first + (steps - first) * frame / FRAMES;
        driver.advance(to, &never).map_err(|error| error.to_string())?;
        seconds += clock.elapsed().as_secs_f64();
        sum += (case.measure)(&driver.view());
        count += 1;
    }
    Ok((sum / f64::from(count), steps, seconds))
}

/// Runs all observables at all stiffnesses, prints a table, and writes `soft.json` and `soft.md` to a folder.
///
/// # Errors
/// A scene cannot be planned, a run fails, or a file cannot be written.
pub fn soft(out: &Path) -> Result<Vec<Row>, String> {
    let mut rows = Vec::new();
    let mut text = String::new();
    for case in &CASES {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "**{}**: {}\n", case.name, case.what);
        let _ = writeln!(
            text,
            "| k d/(m g) | k/k0 | value | difference to k0 | steps | s on a core | speed-up |"
        );
        let _ = writeln!(text, "|---:|---:|---:|---:|---:|---:|---:|");
        let mut first: Option<Row> = None;
        for stiffness in STIFFNESSES {
            let runs = (1..=SEEDS)
                .into_par_iter()
                .map(|seed| run(case, stiffness, seed))
                .collect::<Result<Vec<_>, _>>()
                .map_err(|error| format!("{}: {error}", case.name))?;
            let count = runs.len() as f64;
            let mean = runs.iter().map(|run| run.0).sum::<f64>() / count;
            let variance = runs.iter().map(|run| (run.0 - mean).powi(2)).sum::<f64>() / (count - 1.0);
            let row = Row {
                observable: case.name.into(),
                stiffness,
                mean,
                error: (variance / count).sqrt(),
                steps: runs[0].1,
                seconds: runs.iter().map(|run| run.2).sum::<f64>() / count,
            };
            let reference = first.get_or_insert_with(|| row.clone());
            let change = 100.0 * (row.mean / reference.mean - 1.0);
            let uncertain = 100.0 * f64::hypot(row.error, reference.error) / reference.mean;
            let difference = if stiffness == STIFFNESSES[0] {
                "-".into()
            } else {
                format!("{change:+.1} ± {uncertain:.1} %")
            };
            let _ = writeln!(
                text,
                "| {stiffness:e} | {:e} | {:.4} ± {:.4} | {difference} | {} | {:.2} | {:.1} |",
                stiffness / STIFFNESSES[0],
                row.mean,
                row.error,
                row.steps,
                row.seconds,
                reference.seconds / row.seconds
            );
            println!("{}: k d/(m g) = {stiffness:e}: {:.4} ± {:.4}", case.name, row.mean, row.error);
            rows.push(row);
        }
        text.push('\n');
    }
    std::fs::create_dir_all(out).map_err(|error| error.to_string())?;
    let json = serde_json::to_string_pretty(&rows).map_err(|error| error.to_string())?;
    for (name, content) in [("soft.json", &json), ("soft.md", &text)] {
        granule_formats::atomic::write(out.join(name), content.as_bytes())
            .map_err(|error| error.to_string())?;
    }
    println!("{text}");
    Ok(rows)
}
