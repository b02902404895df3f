//! Timing one scene: ours and each installed peer in turn.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use granule_drivers::{Driver, TimeStepDriver};
use granule_plan::Plan;

use super::{Options, Row};
use crate::ours::SceneFile;
use crate::peers::{self, PeerScene, RunOptions};
use crate::translate::{Target, translate};

/// What one of our runs shows.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// 10^6 particle-steps a second.
    pub mps: f64,
    /// Bytes of state, lists and histories a particle.
    pub bytes_per_particle: f64,
    /// Bytes that a step must move a particle.
    pub bytes_moved: f64,
}

/// Compares our engine with each installed peer on `cores` cores.
///
/// # Errors
/// The scene cannot be planned, a peer fails, or a run of ours stops.
pub fn measure(
    scene: &Path,
    case: &str,
    cores: usize,
    bandwidth: f64,
    options: &Options,
) -> Result<Vec<Row>, String> {
    let plan = SceneFile::read(scene)?.plan()?;
    let n = plan.bodies.len();
    let mut rows = Vec::new();
    for target in [Target::LammpsClassic, Target::Liggghts] {
        let mut peer = translate(&plan, target).map_err(|error| error.to_string())?;
        peer.steps = options.steps;
        peer.warm_up = options.warm_up;
        peer.dump_every = 0;
        let engine = peer.check().map_err(|error| error.to_string())?;
        if peers::find_binary(engine).is_none() {
            println!("{} is not installed: not compared", engine.name());
            continue;
        }
        let (mut mine, mut theirs, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
        let (mut version, mut last) = (String::new(), None);
        for _ in 0..options.pairs {
            let measured = ours(&plan, cores, options)?;
            let (speed, banner) = peer_speed(&peer, cores)?;
            ratios.push(measured.mps / speed);
            mine.push(measured.mps);
            theirs.push(speed);
            version = banner;
            last = Some(measured);
        }
        let Some(last) = last else { return Err("no pairs to run".into()) };
        let row = Row {
            case: case.to_string(),
            n,
            cores,
            ours_mps: median(&mine)?,
            peer: engine.name().to_string(),
            peer_version: version,
            peer_mps: median(&theirs)?,
            ratio_min: ratios.iter().copied().fold(f64::INFINITY, f64::min),
            ratio_median: median(&ratios)?,
            bytes_per_particle: last.bytes_per_particle,
            roofline_fraction: 0.0,
        };
        let moved = last.bytes_moved * row.ours_mps * 1e6;
        println!(
            "{:<20} {:>2} core(s): ours {:>7.2}, {} {:>7.2} Mparticle-steps/s; ratio min {:.2}, median {:.2}",
            row.case, row.cores, row.ours_mps, row.peer, row.peer_mps, row.ratio_min, row.ratio_median
        );
        rows.push(Row { roofline_fraction: moved / bandwidth, ..row });
    }
    Ok(rows)
}

fn ours(plan: &Arc<Plan>, cores: usize, options: &Options) -> Result<Measured, String> {
    let mut driver = TimeStepDriver::new(plan.clone(), Some(cores)).map_err(|error| error.to_string())?;
    let stop = AtomicBool::new(false);
    driver.advance(options.warm_up, &stop).map_err(|error| error.to_string())?;
    let begin = Instant::now();
    driver.advance(options.warm_up + options.steps, &stop).map_err(|error| error.to_string())?;
    let seconds = begin.elapsed().as_secs_f64();
    let n = plan.bodies.len() as f64;
    let engine = driver.engine();
    let state = engine.bodies().layout().bytes_per_body() as f64;
    let contacts = (engine.tally().contacts + engine.tally().wall_contacts) as f64 / n;
    let width =
        plan.compositions.iter().map(|composition| composition.history_width).max().unwrap_or(0) as f64;
    Ok(Measured {
        mps: n * options.steps as f64 / seconds / 1e6,
        bytes_per_particle: state + engine.list_bytes() as f64 / n,
        // Every row is read and written once, every contact's pair is read, its history read and written.
        bytes_moved: 2.0 * 32.0 * (3.0 + 2.0 * f64::from(u8::from(plan.rotation)))
            + contacts * (8.0 + 2.0 * (8.0 * width + 4.0 * f64::from(u8::from(width > 0.0)))),
    })
}

fn peer_speed(scene: &PeerScene, cores: usize) -> Result<(f64, String), String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let options = RunOptions { ranks: cores, ..RunOptions::default() };
    let run = peers::run(scene, folder.path(), &options).map_err(|error| error.to_string())?;
    Ok((scene.bodies.len() as f64 * scene.steps as f64 / run.loop_seconds / 1e6, run.version))
}

fn median(values: &[f64]) -> Result<f64, String> {
    granule_report::statistics::median(values).map_err(|error| error.to_string())
}
