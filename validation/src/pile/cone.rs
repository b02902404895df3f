//! Spheres poured onto a rough bed leave a cone: its angle of repose and radius, ours against both engines, over seeds.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use granule_plan::Plan;
use granule_report::statistics::{mean, standard_deviation};
use granule_report::verdict::{Case as Verdict, Figure};
use granule_report::{Axis, Colour, Plot, ScenePicture, Series, View};
use rayon::prelude::*;

use super::reference::{Reference, hashes};
use super::repose::{Heap, heap};
use super::samples::{Answers, distributions};
use crate::ours::{SceneFile, frames};
use crate::peers::{Frame, PeerScene, Quantity, RunOptions, find_binary, run};
use crate::translate::{Target, translate};

const NAME: &str = "cone-600";
/// Seeds of each engine. With 6 against 6 the least p-value is 2/924, so that four questions can be judged at 0.05.
const SEEDS: u64 = 6;

/// What is asked of a heap.
const QUESTIONS: [&str; 4] = [
    "angle of repose [degrees]",
    "radius of the base [mm]",
    "mean height of the centres [mm]",
    "mean distance from the axis [mm]",
];

/// Runs the case.
///
/// # Errors
/// A run fails, leaves no cone, or a recorded reference is missing or stale.
pub fn check(folder: &Path, record: bool) -> Result<Vec<Verdict>, String> {
    let source = crate::cases::root().join(NAME);
    let scene = SceneFile::read(&source.join("scene.ron"))?;
    let plans = |preset: &str| -> Result<Vec<Arc<Plan>>, String> {
        (1..=SEEDS).map(|seed| scene.with_seed(seed).plan_under(preset, &[])).collect()
    };
    let physical = plans("physical")?;
    let (heaps, pictured) = ours(&physical)?;
    let picture = picture(&physical[0], &pictured, &heaps[0], folder)?;
    let mut verdicts = Vec::new();
    for target in [Target::LammpsClassic, Target::Liggghts] {
        let plans = plans(target.preset())?;
        let peers: Vec<PeerScene> = plans.iter().map(|plan| told(plan, target)).collect::<Result<_, _>>()?;
        let engine = peers[0].check().map_err(|why| why.to_string())?;
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
        let own = ours(&plans)?.0;
        for (preset, sample) in [(target.preset(), &own), ("physical", &heaps)] {
            let answers: Vec<Answers> = sample.iter().map(answers).collect();
            let mut verdict =
                distributions(NAME, &QUESTIONS, (target, preset), &answers, &reference.settled)?.with_engine(
                    crate::two_bodies::title(engine),
                    &reference.version,
                    live,
                );
            verdict.extras.description = format!(
                "600 spheres are poured onto a rough bed of frozen ones and leave a cone, with {SEEDS} seeds of the column and \
                 of the bed. The same initial states in both programs."
            );
            let mine: Vec<Vec<[f64; 2]>> = sample.iter().map(|heap| heap.profile.clone()).collect();
            verdict.extras.plots.push(profiles(target, &mine, &reference.profiles)?);
            if preset == "physical" && target == Target::LammpsClassic {
                verdict.extras.plots.push(picture.clone());
            }
            verdicts.push(verdict);
        }
    }
    Ok(verdicts)
}

fn told(plan: &Plan, target: Target) -> Result<PeerScene, String> {
    let mut peer = translate(plan, target).map_err(|why| why.to_string())?;
    peer.dump_every = peer.steps;
    peer.quantities = vec![Quantity::Position];
    Ok(peer)
}

/// Heaps of our own runs, and the end state of the first.
fn ours(plans: &[Arc<Plan>]) -> Result<(Vec<Heap>, Frame), String> {
    let last = |plan: &Arc<Plan>| {
        frames(plan, plan.driver.steps, 1)?.pop().ok_or_else(|| "the run has no end state".to_string())
    };
    let ends: Vec<Frame> = plans.par_iter().map(last).collect::<Result<_, String>>()?;
    let heaps = plans.iter().zip(&ends).map(|(plan, end)| measured(plan, end)).collect::<Result<_, _>>()?;
    Ok((heaps, ends.into_iter().next().unwrap_or_default()))
}

fn answer(plans: &[Arc<Plan>], peers: &[PeerScene], folder: &Path) -> Result<Reference, String> {
    let options = RunOptions { timeout: Duration::from_secs(900), ..RunOptions::default() };
    let one = |(seed, (plan, peer)): (usize, (&Arc<Plan>, &PeerScene))| {
        let run =
            run(peer, &folder.join(format!("seed{}", seed + 1)), &options).map_err(|why| why.to_string())?;
        let end = run.frames.last().ok_or("the run has no end state")?;
        Ok((run.version, measured(plan, end)?))
    };
    let runs: Vec<(String, Heap)> =
        plans.par_iter().zip(peers).enumerate().map(one).collect::<Result<_, String>>()?;
    Ok(Reference {
        version: runs.first().map(|(version, _)| version.clone()).unwrap_or_default(),
        recorded: Reference::day(),
        inputs: hashes(peers)?,
        positions: Vec::new(),
        settled: runs.iter().map(|(_, heap)| answers(heap)).collect(),
        profiles: runs.into_iter().map(|(_, heap)| heap.profile).collect(),
    })
}

/// Height of the tops of the frozen bodies \[m\]: the base of the heap.
fn base(plan: &Plan) -> f64 {
    let table = &plan.bodies;
    let tops = (0..table.len()).filter(|&i| table.frozen[i]).map(|i| table.position[i][2] + table.radius[i]);
    tops.fold(f64::NEG_INFINITY, f64::max)
}

/// Centre of the cell, where the column is, and the nearest image of a position to it.
fn near(plan: &Plan, position: [f64; 3]) -> [f64; 3] {
    let (lo, hi) = (plan.cell.lo(), plan.cell.hi());
    let centre = [0.5 * (lo[0] + hi[0]), 0.5 * (lo[1] + hi[1]), 0.0];
    let (image, _) = plan.cell.minimum_image([position[0] - centre[0], position[1] - centre[1], position[2]]);
    [image[0] + centre[0], image[1] + centre[1], image[2]]
}

fn measured(plan: &Plan, end: &Frame) -> Result<Heap, String> {
    let table = &plan.bodies;
    let mobile = (0..table.len()).filter(|&i| !table.frozen[i]);
    let (centres, radii): (Vec<_>, Vec<_>) =
        mobile.map(|i| (near(plan, end.position[i]), table.radius[i])).unzip();
    heap(&centres, &radii, base(plan))
}

fn answers(heap: &Heap) -> Answers {
    vec![heap.angle.to_degrees(), 1e3 * heap.radius, 1e3 * heap.mean_height, 1e3 * heap.mean_distance]
}

/// Height against distance from the axis: means over seeds with their standard deviations.
fn profiles(target: Target, ours: &[Vec<[f64; 2]>], theirs: &[Vec<[f64; 2]>]) -> Result<Figure, String> {
    let mut plot = Plot::new(
        "profile of the heap, mean over seeds",
        Axis::linear("distance from the axis [mm]"),
        Axis::linear("height above the bed [mm]"),
    )
    .with_size(640.0, 320.0);
    for (name, sample, colour) in [
        ("granule".to_string(), ours, Colour::PALETTE[0]),
        (target.name().to_string(), theirs, Colour::PALETTE[1]),
    ] {
        let longest = sample.iter().max_by_key(|profile| profile.len()).cloned().unwrap_or_default();
        let (mut r, mut h, mut spread) = (Vec::new(), Vec::new(), Vec::new());
        for (ring, point) in longest.iter().enumerate() {
            // Beyond the last grain the height is zero.
            let heights: Vec<f64> =
                sample.iter().map(|profile| 1e3 * profile.get(ring).map_or(0.0, |point| point[1])).collect();
            r.push(1e3 * point[0]);
            h.push(mean(&heights).map_err(|error| error.to_string())?);
            spread.push(standard_deviation(&heights).map_err(|error| error.to_string())?);
        }
        // The two samples side by side, so that no bar hides another.
        let shift = if name == "granule" { -0.06 } else { 0.06 };
        let r = r.iter().map(|r| r + shift).collect();
        plot = plot.with(Series::line(name, r, h).with_error(spread).with_colour(colour));
    }
    let svg = plot.to_svg().map_err(|error| error.to_string())?;
    let caption = "Bars: standard deviation over seeds.".to_string();
    Ok(Figure { svg, caption, file: None })
}

/// The heap of the first seed, also written as `heap.svg`.
fn picture(plan: &Plan, end: &Frame, heap: &Heap, folder: &Path) -> Result<Figure, String> {
    let table = &plan.bodies;
    let positions: Vec<[f64; 3]> = end.position.iter().map(|x| near(plan, *x)).collect();
    let level = base(plan);
    let heights: Vec<f64> = positions.iter().map(|x| 1e3 * (x[2] - level)).collect();
    let svg =
        ScenePicture::new(&positions, &table.radius, &heights, "height of the centre above the bed [mm]")
            .with_view(View::Angles { azimuth: 30.0, elevation: 22.0 })
            .to_svg()
            .map_err(|error| error.to_string())?;
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let path = folder.join("heap.svg");
    std::fs::write(&path, &svg).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(Figure {
        svg,
        caption: format!(
            "Our heap of seed 1 with `physical`: angle of repose {:.1} degrees, radius {:.1} mm.",
            heap.angle.to_degrees(),
            1e3 * heap.radius
        ),
        file: Some(format!("engines/{NAME}/heap.svg")),
    })
}
