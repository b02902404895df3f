//! Speed: our engine and the installed peers on the same initial data, in turn, in one run.

mod cases;
mod child;
mod machine;
mod measure;
mod page;
mod parts;
mod plugin;
mod states;

use std::path::{Path, PathBuf};

use serde::Serialize;

pub use cases::{CASES, Case, selected};
pub use child::{Job, Measured, run};
pub use machine::copy_bandwidth;
pub use measure::{Detail, PeerDetail, measure};
pub use parts::parts;
pub use plugin::{PlugIn, plug_in};
pub use states::{Recipe, prepare};

/// What to run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where `bench.json`, `details.json`, `bench.html` and the initial states go.
    pub out: PathBuf,
    /// Parts of names of cases; empty for the quick ones.
    pub words: Vec<String>,
    /// All cases.
    pub all: bool,
    /// Numbers of cores; empty for one and all.
    pub cores: Vec<usize>,
    /// Rounds a case: a run of ours and one of each peer.
    pub pairs: usize,
    /// Steps that are timed in each run; a number that suits the case if absent.
    pub steps: Option<u64>,
    /// Our laws in single precision.
    pub single: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            out: PathBuf::from("target/bench"),
            words: Vec::new(),
            all: false,
            cores: Vec::new(),
            pairs: 5,
            steps: None,
            single: false,
        }
    }
}

/// Places that a benchmark works with.
#[derive(Clone, Debug)]
pub struct Scratch {
    /// The program whose `bench-ours` runs a job.
    pub program: PathBuf,
    /// Initial states.
    pub states: PathBuf,
}

impl Scratch {
    /// This program, and `states` in a folder.
    ///
    /// # Errors
    /// The system does not tell where this program lies.
    pub fn of(out: &Path) -> Result<Self, String> {
        let program = std::env::current_exe().map_err(|error| error.to_string())?;
        Ok(Self { program, states: out.join("states") })
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
    pub peer_mps: Option<f64>,
    /// Smallest ratio (ours / peer) of all pairs.
    pub ratio_min: Option<f64>,
    /// Median ratio of all pairs.
    pub ratio_median: Option<f64>,
    /// Largest resident memory of our process over the number of bodies; for few bodies mostly the program itself.
    pub bytes_per_particle: f64,
    /// Bytes that a step must move, over what the machine can copy in the same time with as many cores.
    pub roofline_fraction: f64,
}

/// All comparisons of one run.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Processor, cores and memory.
    pub machine: String,
    /// The comparisons.
    pub cases: Vec<Row>,
}

/// What `details.json` holds beside the report.
#[derive(Clone, Debug, Serialize)]
pub struct Details {
    /// Processor, cores and memory.
    pub machine: String,
    /// Copy bandwidth measured in the same run, by number of cores \[bytes/s\].
    pub copy_bandwidth: Vec<(usize, f64)>,
    /// Every run of every case.
    pub cases: Vec<Detail>,
}

/// Runs the cases, prints each as it ends, and writes `bench.json`, `details.json` and `bench.html` after each, so that an
/// interrupted run leaves what it has measured.
///
/// # Errors
/// There is no such case, a scene cannot be planned, a peer fails, or a file cannot be written; the text says which.
pub fn bench(options: &Options) -> Result<Report, String> {
    let available = std::thread::available_parallelism().map_or(1, usize::from);
    let cases = selected(&options.words, options.all);
    if cases.is_empty() {
        let names: Vec<&str> = CASES.iter().map(|case| case.name).collect();
        return Err(format!(
            "no case has `{}` in its name; there are {}",
            options.words.join("` or `"),
            names.join(", ")
        ));
    }
    let mut counts = options.cores.clone();
    if counts.is_empty() {
        counts.push(1);
        counts.extend((available > 1).then_some(available));
    }
    let scratch = Scratch::of(&options.out)?;
    let machine = granule_report::Machine::detect().summary();
    let copy_bandwidth: Vec<(usize, f64)> =
        counts.iter().map(|&cores| (cores, copy_bandwidth(cores))).collect();
    println!("{machine}");
    for (cores, bytes) in &copy_bandwidth {
        println!("copy bandwidth on {cores} core(s): {:.1} GB/s", bytes / 1e9);
    }
    let mut report = Report { machine: machine.clone(), cases: Vec::new() };
    let mut details = Details { machine, copy_bandwidth: copy_bandwidth.clone(), cases: Vec::new() };
    for case in &cases {
        for (cores, bandwidth) in &copy_bandwidth {
            let detail = measure(case, *cores, options, &scratch)?;
            for row in detail.rows(*bandwidth)? {
                println!("{}", line(&row));
                report.cases.push(row);
            }
            details.cases.push(detail);
            page::write(&report, &details, &options.out)?;
        }
    }
    Ok(report)
}

/// Measures what it costs that laws are crates, prints it, and writes `plugin.json`.
///
/// # Errors
/// The scene cannot be planned, a run stops, or a file cannot be written.
pub fn plug_in_cost(options: &Options) -> Result<PlugIn, String> {
    let result = plug_in(options, &Scratch::of(&options.out)?)?;
    println!(
        "{}: a step with the shipped law crates takes {:.3} (median; least {:.3}) of one with the law fused by hand; bits {}",
        result.case,
        result.ratio[1],
        result.ratio[0],
        if result.same_bits { "equal" } else { "DIFFER" }
    );
    page::save_json(&options.out, "plugin.json", &result)?;
    Ok(result)
}

fn line(row: &Row) -> String {
    let mut text = format!("{:<26} {:>2} core(s): ours {:>7.2}", row.case, row.cores, row.ours_mps);
    if let (Some(speed), Some(least), Some(median)) = (row.peer_mps, row.ratio_min, row.ratio_median) {
        text += &format!(
            ", {:<8} {speed:>7.2} Mparticle-steps/s; ratio min {least:.2}, median {median:.2}",
            row.peer
        );
    } else {
        text += " Mparticle-steps/s";
    }
    text + &format!(
        "; {:.0} B/particle, {:.2} of copy bandwidth",
        row.bytes_per_particle, row.roofline_fraction
    )
}
