//! Speed: our engine and the installed peers on the same initial data, in turn, in one run.

mod machine;
mod measure;
mod page;

use std::path::{Path, PathBuf};

use serde::Serialize;

pub use machine::copy_bandwidth;
pub use measure::{Measured, measure};

/// What to run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where `bench.json` and `bench.html` go.
    pub out: PathBuf,
    /// Pairs of runs (ours, peer) a case.
    pub pairs: usize,
    /// Steps that are timed in each run.
    pub steps: u64,
    /// Steps before them that are not.
    pub warm_up: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self { out: PathBuf::from("target/bench"), pairs: 5, steps: 2000, warm_up: 500 }
    }
}

/// One comparison with one peer on one number of cores.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Scene.
    pub case: String,
    /// Bodies.
    pub n: usize,
    /// Cores used by both.
    pub cores: usize,
    /// Our median of 10^6 particle-steps a second.
    pub ours_mps: f64,
    /// The peer; "none" where no peer runs.
    pub peer: String,
    /// Its version, as its banner says it.
    pub peer_version: String,
    /// Its median of 10^6 particle-steps a second.
    pub peer_mps: f64,
    /// Smallest ratio (ours / peer) of all pairs.
    pub ratio_min: f64,
    /// Median ratio of all pairs.
    pub ratio_median: f64,
    /// Bytes of state, lists and histories a particle.
    pub bytes_per_particle: f64,
    /// Bytes that a step must move, over what the machine can copy in the same time.
    pub roofline_fraction: f64,
}

/// All comparisons of one run.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Processor, cores and memory.
    pub machine: String,
    /// Copy bandwidth measured in the same run on all cores \[GB/s\].
    pub copy_bandwidth_gb_s: f64,
    /// The comparisons.
    pub cases: Vec<Row>,
}

/// Runs all cases, prints a table, and writes `bench.json` and `bench.html`.
///
/// # Errors
/// A scene cannot be planned, a peer fails, or a file cannot be written; the text says which.
pub fn bench(options: &Options) -> Result<Report, String> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("bench/settled-10k/scene.ron");
    let bandwidth = copy_bandwidth(cores);
    let mut rows = Vec::new();
    let mut counts = vec![1];
    counts.extend((cores > 1).then_some(cores));
    for cores in counts {
        rows.extend(measure(&scene, "settled-10k-hooke", cores, bandwidth, options)?);
    }
    let report = Report {
        machine: granule_report::Machine::detect().summary(),
        copy_bandwidth_gb_s: bandwidth / 1e9,
        cases: rows,
    };
    page::write(&report, &options.out)?;
    Ok(report)
}
