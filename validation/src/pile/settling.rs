//! The settling pile of 500 spheres: agreement step by step until contacts make it chaotic, then distributions over seeds.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use granule_formats::lammps_data::{self, Atom};
use granule_plan::Plan;
use granule_report::verdict::{Case as Verdict, Figure, Horizon};
use granule_report::{Axis, Colour, Plot, Series};
use rayon::prelude::*;

use super::reference::{Reference, hashes};
use super::samples::{Answers, distributions};
use crate::ours::{SceneFile, frames, frames_until};
use crate::peers::compare::{Comparison, Scales, compare};
use crate::peers::{Frame, PeerScene, Quantity, RunOptions, find_binary, run};
use crate::translate::{Target, translate};

const NAME: &str = "pile-500";
/// Seeds of each engine. With 5 against 5 the least p-value is 2/252, so four questions (Holm) cannot be judged at less than
/// 4 * 2/252 = 0.032.
const SEEDS: u64 = 5;
/// Agreement step by step, in diameters of the largest body.
const AGREEMENT: f64 = 1e-9;
/// Steps of the comparison step by step, and steps between two comparisons.
const COMPARED: (u64, u64) = (10_000, 400);
/// Runs of ours whose initial coordinates are moved by round-off. They say up to which step round-off decides nothing: a
/// difference that a peer shows before is one of the programs and not of the arithmetic.
const TWINS: u64 = 4;
/// Difference among them from which on they are no measure any more, a hundredth of [`AGREEMENT`].
const SENSITIVE: f64 = 1e-11;
/// Dumped states of a settling run.
const STATES: u64 = 150;
/// Bulk of the pile, between two heights \[m\]: above the ordered layers on the floor, below the free surface.
const BULK: (f64, f64) = (1.0e-3, 4.5e-3);

/// What is asked of a settled pile.
const QUESTIONS: [&str; 4] = [
    "mean height of the centres [m]",
    "packing fraction between 1 mm and 4.5 mm",
    "coordination number (bodies only)",
    "time until the kinetic energy is below 1e-3 of its largest [s]",
];

/// Runs the case.
///
/// # Errors
/// A run fails, or a recorded reference is missing or stale.
pub fn check(folder: &Path, record: bool) -> Result<Vec<Verdict>, String> {
    let source = crate::cases::root().join(NAME);
    let scene = SceneFile::read(&source.join("scene.ron"))?;
    let seeds: Vec<SceneFile> = (0..SEEDS)
        .map(|seed| changed(&source, &folder.join(format!("seed{seed}")), pushed(seed)))
        .collect::<Result<_, _>>()?;
    let twins: Vec<SceneFile> = (0..TWINS)
        .map(|seed| changed(&source, &folder.join(format!("twin{seed}")), rounded(seed)))
        .collect::<Result<_, _>>()?;
    let physical = settled(&seeds, "physical")?;
    let mut verdicts = Vec::new();
    for target in [Target::LammpsClassic, Target::Liggghts] {
        let plan = scene.plan_under(target.preset(), &[])?;
        let mut first = told(&plan, target, COMPARED, &[Quantity::Position])?;
        // Else a pair that parts and meets again between two rebuilds keeps its spring in LIGGGHTS, as at step 2421 here.
        first.tuning.always_anew = target == Target::Liggghts;
        let engine = first.check().map_err(|why| why.to_string())?;
        let plans: Vec<Arc<Plan>> =
            seeds.iter().map(|seed| seed.plan_under(target.preset(), &[])).collect::<Result<_, _>>()?;
        let mut peers = vec![first];
        for plan in &plans {
            let steps = plan.driver.steps;
            peers.push(told(
                plan,
                target,
                (steps, steps / STATES),
                &[Quantity::Position, Quantity::Velocity],
            )?);
        }
        let live = find_binary(engine).is_some();
        let path = source.join(format!("reference-{}.json", target.name()));
        let reference = if live {
            let reference = answer(&plans, &peers, &folder.join(target.name()))?;
            if record {
                reference.save(&path, &peers)?;
            }
            reference
        } else {
            Reference::load(&path, &peers)?
        };
        let named = |verdict: Verdict| {
            verdict.with_engine(crate::two_bodies::title(engine), &reference.version, live)
        };
        verdicts.push(named(step_by_step((&plan, &twins), target, &peers[0], &reference)?));
        for (preset, ours) in
            [(target.preset(), settled(&seeds, target.preset())?), ("physical", physical.clone())]
        {
            let mut verdict = distributions(NAME, &QUESTIONS, (target, preset), &ours, &reference.settled)?;
            verdict.extras.description =
                "The settled pile after 0.15 s, over seeds of the initial velocities.".into();
            verdicts.push(named(verdict));
        }
    }
    Ok(verdicts)
}

fn told(
    plan: &Plan,
    target: Target,
    (steps, every): (u64, u64),
    quantities: &[Quantity],
) -> Result<PeerScene, String> {
    let mut peer = translate(plan, target).map_err(|why| why.to_string())?;
    (peer.steps, peer.dump_every) = (steps, every);
    peer.quantities = quantities.to_vec();
    Ok(peer)
}

/// Runs the comparison step by step (the first peer) and all seeds.
fn answer(plans: &[Arc<Plan>], peers: &[PeerScene], folder: &Path) -> Result<Reference, String> {
    let options = RunOptions { timeout: Duration::from_secs(900), ..RunOptions::default() };
    let runs = peers.par_iter().enumerate().map(|(place, peer)| {
        let run = run(peer, &folder.join(format!("run{place}")), &options).map_err(|why| why.to_string())?;
        let settled = place.checked_sub(1).map(|seed| answers(&plans[seed], &run.frames));
        Ok((run.version, if settled.is_none() { run.frames } else { Vec::new() }, settled))
    });
    let runs: Vec<(String, Vec<Frame>, Option<Answers>)> = runs.collect::<Result<_, String>>()?;
    let mut reference = Reference {
        version: String::new(),
        recorded: Reference::day(),
        inputs: hashes(peers)?,
        positions: Vec::new(),
        settled: Vec::new(),
        profiles: Vec::new(),
    };
    for (version, frames, settled) in runs {
        reference.version = version;
        match settled {
            Some(answers) => reference.settled.push(answers),
            None => reference.positions = frames,
        }
    }
    Ok(reference)
}

/// Velocities that differ from seed to seed: each component is pushed by up to 0.05 m/s.
fn pushed(seed: u64) -> impl FnMut(&mut Atom) {
    let mut state = seed;
    move |atom| {
        for component in &mut atom.velocity {
            *component += 0.1 * (unit(&mut state) - 0.5);
        }
    }
}

/// Positions moved by round-off: each coordinate becomes one of its two neighbours among the floating-point numbers.
fn rounded(seed: u64) -> impl FnMut(&mut Atom) {
    let mut state = seed;
    move |atom| {
        for x in &mut atom.position {
            *x = if unit(&mut state) < 0.5 { x.next_down() } else { x.next_up() };
        }
    }
}

/// The scene in a folder of its own, with bodies that are changed one by one.
fn changed(source: &Path, folder: &Path, change: impl FnMut(&mut Atom)) -> Result<SceneFile, String> {
    let file = |path: PathBuf, error: std::io::Error| format!("{}: {error}", path.display());
    std::fs::create_dir_all(folder).map_err(|error| file(folder.to_path_buf(), error))?;
    let mut data = lammps_data::read(source.join("bodies.data")).map_err(|error| error.to_string())?;
    data.atoms.iter_mut().for_each(change);
    let provenance = granule_formats::Provenance::new(env!("CARGO_PKG_VERSION"), "none", 0)?;
    lammps_data::write(folder.join("bodies.data"), &data, &provenance).map_err(|error| error.to_string())?;
    let path = folder.join("scene.ron");
    std::fs::copy(source.join("scene.ron"), &path).map_err(|error| file(path.clone(), error))?;
    SceneFile::read(&path)
}

/// Next number of SplitMix64, between 0 and 1: enough to make seeds differ, and the same on every machine.
fn unit(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

fn settled(seeds: &[SceneFile], preset: &str) -> Result<Vec<Answers>, String> {
    let settle = |scene: &SceneFile| {
        let plan = scene.plan_under(preset, &[])?;
        Ok(answers(&plan, &frames(&plan, plan.driver.steps / STATES, 1)?))
    };
    seeds.par_iter().map(settle).collect()
}

/// What is asked, of the last frame and of the decay of the kinetic energy.
fn answers(plan: &Plan, frames: &[Frame]) -> Answers {
    let table = &plan.bodies;
    let square = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>();
    let kinetic: Vec<f64> = frames
        .iter()
        .map(|frame| frame.velocity.iter().zip(&table.mass).map(|(v, m)| 0.5 * m * square(v)).sum())
        .collect();
    let largest = kinetic.iter().copied().fold(0.0, f64::max);
    let quiet = kinetic.iter().rposition(|energy| *energy > 1e-3 * largest).map_or(0, |last| last + 1);
    let decay = frames.get(quiet).map_or(f64::INFINITY, |frame| frame.step as f64 * plan.driver.step);
    let Some(last) = frames.last() else { return vec![f64::NAN; QUESTIONS.len()] };
    let count = last.position.len();
    let height = last.position.iter().map(|x| x[2]).sum::<f64>() / count as f64;
    let volume = |r: f64| 4.0 / 3.0 * std::f64::consts::PI * r * r * r;
    let inside = (0..count).filter(|&i| (BULK.0..BULK.1).contains(&last.position[i][2]));
    let solid: f64 = inside.map(|i| volume(table.radius[i])).sum();
    let (lo, hi) = (plan.cell.lo(), plan.cell.hi());
    let fraction = solid / ((hi[0] - lo[0]) * (hi[1] - lo[1]) * (BULK.1 - BULK.0));
    let touches = |i: usize, j: usize| {
        let (a, b) = (last.position[i], last.position[j]);
        let (d, _) = plan.cell.minimum_image([a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
        square(&d).sqrt() < table.radius[i] + table.radius[j]
    };
    let contacts = (0..count).map(|i| (i + 1..count).filter(|&j| touches(i, j)).count()).sum::<usize>();
    vec![height, fraction, 2.0 * contacts as f64 / count as f64, decay]
}

/// Agreement of the positions as long as round-off has not decided anything.
fn step_by_step(
    (plan, twins): (&Arc<Plan>, &[SceneFile]),
    target: Target,
    peer: &PeerScene,
    reference: &Reference,
) -> Result<Verdict, String> {
    let ours = first_steps(plan)?;
    let scales = Scales::of(peer, &reference.positions);
    let compared = |theirs: &[Frame], ours: &[Frame]| {
        compare(peer, theirs, ours, &scales, &[Quantity::Position]).map_err(|error| error.to_string())
    };
    let comparison = compared(&reference.positions, &ours)?;
    let twins: Vec<Comparison> = twins
        .par_iter()
        .map(|twin| compared(&ours, &first_steps(&twin.plan_under(target.preset(), &[])?)?))
        .collect::<Result<_, String>>()?;
    let required = agreeing(&twins, SENSITIVE);
    let horizon = agreeing(std::slice::from_ref(&comparison), AGREEMENT);
    let until = comparison.rows.iter().flatten().filter(|entry| entry.step <= required);
    let difference = until.map(|entry| entry.scaled).fold(0.0, f64::max);
    let mut verdict = Verdict::judged(
        format!("{NAME} step by step ({})", target.name()),
        "position",
        difference,
        AGREEMENT,
    )
    .because(format!(
        "in units of the largest diameter, up to step {required}: until then {TWINS} runs of ours, whose initial coordinates \
         are moved to the next floating-point number, follow our own run within {SENSITIVE:e}"
    ));
    let time = |step: u64| step as f64 * plan.driver.step;
    verdict.extras.description = format!(
        "500 spheres fall and settle; our run with `{}` against the peer. Agreement is demanded up to step {required} and lasts \
         up to step {horizon} of {}.",
        target.preset(),
        COMPARED.0
    );
    verdict.extras.horizon = Some(Horizon {
        step: horizon,
        time_s: time(horizon),
        threshold: AGREEMENT,
        explanation: if horizon == COMPARED.0 {
            "the end of the comparison".into()
        } else {
            "contacts amplify round-off; from here on only distributions can be compared".into()
        },
    });
    let line = |comparison: &Comparison| {
        let entries = comparison.rows.iter().flatten();
        // A logarithmic axis has no place for zero.
        entries.map(|entry| (time(entry.step), entry.scaled.max(1e-17))).unzip::<f64, f64, Vec<_>, Vec<_>>()
    };
    let mut plot = Plot::new(
        "growth of the difference",
        Axis::linear("time [s]"),
        Axis::log("largest difference / diameter"),
    );
    let (t, y) = line(&comparison);
    plot = plot.with(Series::line(format!("granule to {}", target.name()), t, y));
    for (place, twin) in twins.iter().enumerate() {
        let (t, y) = line(twin);
        let name = if place == 0 { "granule to itself, moved by round-off" } else { "" };
        plot = plot.with(Series::line(name, t, y).with_colour(Colour::PALETTE[1]));
    }
    plot = plot.with(Series::dashed("tolerance", vec![0.0, time(COMPARED.0)], vec![AGREEMENT; 2]));
    let svg = plot.with_size(640.0, 320.0).to_svg().map_err(|error| error.to_string())?;
    let caption = "Largest difference of a position.".into();
    verdict.extras.plots.push(Figure { svg, caption, file: None });
    Ok(verdict)
}

/// Our run over the steps that are compared one by one.
fn first_steps(plan: &Arc<Plan>) -> Result<Vec<Frame>, String> {
    frames_until(plan, COMPARED.0, COMPARED.1, 1)
}

/// Last step up to which all comparisons stay within a bound.
fn agreeing(comparisons: &[Comparison], bound: f64) -> u64 {
    let first = comparisons.iter().filter_map(|comparison| comparison.horizon(bound)).min();
    let steps = comparisons.iter().flat_map(|comparison| &comparison.rows).flatten().map(|entry| entry.step);
    steps.filter(|step| first.is_none_or(|first| *step < first)).max().unwrap_or(0)
}
