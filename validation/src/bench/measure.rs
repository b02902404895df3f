//! Timing one case: ours and each installed peer in turn, round by round.

use serde::Serialize;

use super::cases::Case;
use super::child::{self, Job, Measured};
use super::states;
use super::{Options, Row, Scratch};
use crate::peers::{self, Engine, InputFiles, PeerScene, RunOptions, Timed, Tuning, inputs};
use crate::translate::{Target, translate};

/// Everything that was measured on a case with one number of cores.
#[derive(Clone, Debug, Serialize)]
pub struct Detail {
    /// Case.
    pub case: String,
    /// Bodies.
    pub n: usize,
    /// Cores.
    pub cores: usize,
    /// Steps that were timed in each run.
    pub steps: u64,
    /// Our 10^6 particle-steps a second, round by round; on one core, a second of the processor.
    pub ours_mps: Vec<f64>,
    /// The last of our runs.
    pub ours: Measured,
    /// The peers.
    pub peers: Vec<PeerDetail>,
}

/// Everything that was measured of a peer.
#[derive(Clone, Debug, Serialize)]
pub struct PeerDetail {
    /// Engine.
    pub peer: String,
    /// Its version, as its banner says it.
    pub version: String,
    /// How it was told to work: ranks along each direction, search.
    pub tuning: String,
    /// Its 10^6 particle-steps a second, round by round; on one core, a second of the processor.
    pub mps: Vec<f64>,
    /// Its largest resident memory; of one rank only if there are several \[bytes\].
    pub peak_bytes: Option<u64>,
}

impl Detail {
    /// The rows of the report: one a peer, or one without a peer.
    ///
    /// # Errors
    /// There is no measurement.
    pub fn rows(&self, bandwidth: f64) -> Result<Vec<Row>, String> {
        let ours = median(&self.ours_mps)?;
        let peak = self.ours.peak_bytes.map_or(self.ours.working_bytes, |bytes| bytes as f64);
        let row = Row {
            case: self.case.clone(),
            n: self.n,
            cores: self.cores,
            ours_mps: ours,
            peer: "none".into(),
            peer_version: String::new(),
            peer_mps: None,
            ratio_min: None,
            ratio_median: None,
            bytes_per_particle: peak / self.n as f64,
            roofline_fraction: self.ours.moved_per_body * ours * 1e6 / bandwidth,
        };
        if self.peers.is_empty() {
            return Ok(vec![row]);
        }
        let with = |peer: &PeerDetail| {
            let ratios: Vec<f64> =
                self.ours_mps.iter().zip(&peer.mps).map(|(ours, peer)| ours / peer).collect();
            Ok(Row {
                peer: peer.peer.clone(),
                peer_version: peer.version.clone(),
                peer_mps: Some(median(&peer.mps)?),
                ratio_min: Some(ratios.iter().copied().fold(f64::INFINITY, f64::min)),
                ratio_median: Some(median(&ratios)?),
                ..row.clone()
            })
        };
        self.peers.iter().map(with).collect()
    }
}

/// A peer with its inputs on disk.
struct Ready {
    engine: Engine,
    tuning: String,
    files: InputFiles,
    folder: tempfile::TempDir,
    runs: Vec<Timed>,
}

/// Measures a case on `cores` cores.
///
/// # Errors
/// The scene cannot be planned, a peer fails, or a run of ours stops.
pub fn measure(case: &Case, cores: usize, options: &Options, scratch: &Scratch) -> Result<Detail, String> {
    let base = states::prepare(case.recipe, case.copies, &scratch.states)?;
    let mut job = Job {
        scene: states::scenes().join(case.scene).join("scene.ron"),
        base,
        copies: case.copies,
        single: options.single,
        cores,
        warm_up: 0,
        steps: 0,
        vtp: false,
    };
    let plan = job.scene()?.plan()?;
    let n = plan.bodies.len();
    job.steps = options.steps.unwrap_or_else(|| steps(n, cores));
    job.warm_up = (job.steps / 4).max(WARM_UP);
    let mut ready = Vec::new();
    for target in if case.peers { &[Target::LammpsClassic, Target::Liggghts][..] } else { &[] } {
        let mut peer = translate(&plan, *target).map_err(|error| error.to_string())?;
        (peer.warm_up, peer.dump_every) = (job.warm_up, 0);
        let engine = peer.check().map_err(|error| error.to_string())?;
        if peers::find_binary(engine).is_none() {
            println!("{} is not installed: not compared", engine.name());
            continue;
        }
        ready.push(best(engine, peer, case, &job)?);
    }
    drop(plan);
    let mut measured = Vec::new();
    // Round by round: each peer's run lies beside one of ours, so that what else the machine does meets both.
    for round in 1..=options.pairs {
        job.vtp = n >= MANY && round == options.pairs;
        let mut halves = ready.iter_mut();
        if let Some(first) = halves.next() {
            first.run(cores)?;
        }
        measured.push(child::measure(&scratch.program, &job)?);
        for other in halves {
            other.run(cores)?;
        }
    }
    let Some(ours) = measured.last().cloned() else { return Err("no pairs to run".into()) };
    let speed = |timed: &Timed| {
        n as f64 * job.steps as f64 / timed.processor_seconds.unwrap_or(timed.loop_seconds) / 1e6
    };
    Ok(Detail {
        case: if options.single { format!("{}-single", case.name) } else { case.name.to_string() },
        n,
        cores,
        steps: job.steps,
        ours_mps: measured.iter().map(|run| run.mps(&job)).collect(),
        ours,
        peers: ready
            .iter()
            .map(|ready| PeerDetail {
                peer: ready.engine.name().to_string(),
                version: ready.runs.first().map(|run| run.version.clone()).unwrap_or_default(),
                tuning: ready.tuning.clone(),
                mps: ready.runs.iter().map(speed).collect(),
                peak_bytes: ready.runs.iter().filter_map(|run| run.peak_bytes).max(),
            })
            .collect(),
    })
}

/// Bodies from which on the time of an output counts.
const MANY: usize = 500_000;

/// Fewest steps of a warm-up: lists, caches and the branch predictor have settled, and forces of a state without contact
/// histories too.
const WARM_UP: u64 = 200;

/// Steps that are timed: some seconds of a peer, but enough steps that rebuilding lists is in proportion.
fn steps(n: usize, cores: usize) -> u64 {
    const PARTICLE_STEPS: u64 = 20_000_000;
    const FEWEST: u64 = 100;
    (PARTICLE_STEPS * cores as u64 / n as u64).max(FEWEST)
}

impl Ready {
    fn new(engine: Engine, scene: &PeerScene, tuning: String) -> Result<Self, String> {
        let files = inputs(scene).map_err(|error| error.to_string())?;
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        files.write(folder.path()).map_err(|error| error.to_string())?;
        Ok(Self { engine, tuning, files, folder, runs: Vec::new() })
    }

    fn run(&mut self, ranks: usize) -> Result<f64, String> {
        let options = RunOptions { ranks, timeout: std::time::Duration::from_secs(1800) };
        let timed =
            peers::time(&self.files, self.folder.path(), &options).map_err(|error| error.to_string())?;
        let seconds = timed.loop_seconds;
        self.runs.push(timed);
        Ok(seconds)
    }
}

/// The peer's inputs with the fastest of the sensible ways to work, each tried once with a quarter of the steps.
fn best(engine: Engine, mut scene: PeerScene, case: &Case, job: &Job) -> Result<Ready, String> {
    let mut ways: Vec<Tuning> =
        grids(job.cores).into_iter().map(|ranks| Tuning { ranks, ..Tuning::default() }).collect();
    if engine == Engine::Lammps && !case.size_classes.is_empty() {
        let separate = |way: &Tuning| Tuning { size_classes: case.size_classes.to_vec(), ..way.clone() };
        ways.extend(ways.clone().iter().map(separate));
    }
    let mut fastest: Option<(f64, Tuning)> = None;
    if ways.len() > 1 {
        for way in &ways {
            scene.steps = (job.steps / 4).max(1);
            scene.tuning = way.clone();
            // A way that this engine or this scene does not allow is not the best one.
            let Ok(seconds) = Ready::new(engine, &scene, String::new())?.run(job.cores) else { continue };
            if fastest.as_ref().is_none_or(|(least, _)| seconds < *least) {
                fastest = Some((seconds, way.clone()));
            }
        }
    }
    scene.steps = job.steps;
    scene.tuning = fastest.map(|(_, way)| way).unwrap_or_default();
    let ranks = scene.tuning.ranks.map_or("1".to_string(), |[x, y, z]| format!("{x}x{y}x{z}"));
    let search = if scene.tuning.size_classes.is_empty() { "bin" } else { "multi" };
    Ready::new(engine, &scene, format!("ranks {ranks}, search {search}"))
}

/// Grids of so many ranks that make sense: all factorisations over x and y, and with two layers along z.
fn grids(ranks: usize) -> Vec<Option<[usize; 3]>> {
    if ranks == 1 {
        return vec![None];
    }
    let mut grids = Vec::new();
    for layers in [1, 2] {
        for x in 1..=ranks {
            let rest = ranks / (x * layers).max(1);
            if x * rest * layers == ranks {
                grids.push(Some([x, rest, layers]));
            }
        }
    }
    grids
}

fn median(values: &[f64]) -> Result<f64, String> {
    granule_report::statistics::median(values).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_are_the_factorisations() {
        assert_eq!(grids(1), [None]);
        let four = grids(4);
        for grid in [[4, 1, 1], [2, 2, 1], [1, 4, 1], [2, 1, 2], [1, 2, 2]] {
            assert!(four.contains(&Some(grid)), "{grid:?}");
        }
        assert_eq!(four.len(), 5);
        assert!(grids(6).iter().flatten().all(|[x, y, z]| x * y * z == 6));
    }

    #[test]
    fn more_bodies_mean_fewer_steps() {
        assert_eq!(steps(10_000, 1), 2000);
        assert_eq!(steps(10_000, 4), 8000);
        assert_eq!(steps(10_000_000, 1), 100);
    }
}
