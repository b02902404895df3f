//! The command line.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Parser, Subcommand};
use granule::{Allowance, DataFiles};

const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    the scene has errors or cannot be read, or there is no such law
  2    the command line is wrong
  3    the run failed: a number is no longer finite, an output cannot be written, or a self-test fails
  4    --max-time is over; what was written is whole
  130  stopped by Ctrl-C or a termination signal; what was written is whole";

/// Granular matter, simulated grain by grain.
#[derive(Debug, Parser)]
#[command(name = "granule", version, about, after_help = EXIT_CODES, max_term_width = 100)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// What scenes may use.
    #[command(flatten)]
    pub bounds: Bounds,
}

/// Bounds for scenes that somebody else wrote.
#[derive(Debug, clap::Args)]
pub struct Bounds {
    /// Refuse scenes whose plan and run are estimated to need more memory, as in 2GiB or 500MB
    #[arg(long, value_name = "SIZE", global = true, value_parser = memory, help_heading = "Bounds")]
    pub max_memory: Option<u64>,
    /// Let scenes read data files outside of their own folder
    #[arg(long, global = true, help_heading = "Bounds")]
    pub data_anywhere: bool,
}

impl Bounds {
    /// What planning may use.
    pub fn allowance(&self) -> Allowance {
        Allowance {
            memory: self.max_memory.unwrap_or(u64::MAX),
            files: if self.data_anywhere { DataFiles::Anywhere } else { DataFiles::BesideScene },
        }
    }
}

/// Bytes, with a decimal or binary prefix.
fn memory(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, f64); 10] = [
        ("KiB", 1024.0),
        ("MiB", 1_048_576.0),
        ("GiB", 1_073_741_824.0),
        ("TiB", 1_099_511_627_776.0),
        ("kB", 1e3),
        ("MB", 1e6),
        ("GB", 1e9),
        ("TB", 1e12),
        ("B", 1.0),
        ("", 1.0),
    ];
    let text = text.trim();
    let unit = UNITS.iter().find(|(name, _)| text.ends_with(name));
    let value = unit.and_then(|(name, size)| {
        let number: f64 = text[..text.len() - name.len()].trim().parse().ok()?;
        Some(number * size)
    });
    match value {
        Some(bytes) if bytes >= 1.0 && bytes < u64::MAX as f64 => Ok(bytes as u64),
        _ => Err("a size is a number of bytes, as 2e9, 500MB or 2GiB".to_string()),
    }
}

/// A time with its unit, or a number of seconds.
fn time(text: &str) -> Result<Duration, String> {
    let seconds = text.trim().parse::<f64>().map_err(|_| ()).or_else(|()| {
        granule::parts::units::parse_as(text, granule::parts::units::Dimension::TIME)
            .map_err(|error| error.to_string())
    })?;
    match Duration::try_from_secs_f64(seconds) {
        Ok(time) if !time.is_zero() => Ok(time),
        _ => Err("a time is a positive number, as 90, \"90 s\" or \"2 h\"".to_string()),
    }
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scene and write its outputs
    Run(RunArguments),
    /// Continue a run that was stopped, killed or has failed, from its last checkpoint
    Resume(ResumeArguments),
    /// Say what a run would include, what it leaves out, and why
    Explain {
        /// Scene file
        scene: PathBuf,
    },
    /// Report all problems of scenes at once
    Check {
        /// Scene files
        #[arg(required = true)]
        scenes: Vec<PathBuf>,
    },
    /// Measure what speed costs in accuracy for a scene, and write the choice back as a scene
    Trade(TradeArguments),
    /// Say what happens in a scene, which of its physics acts, and what could be left out
    Advise(AdviseArguments),
    /// Run bodies on a substrate in time steps, with contacts with a plane, and hard, and tell what each costs
    CompareModels(CompareModelsArguments),
    /// What the laws of a scene do in a single contact
    Law {
        /// What to do.
        #[command(subcommand)]
        command: LawCommand,
    },
    /// List the contact laws, or show one with its parameters, formula and sources
    Laws {
        /// Name of a law, as in scenes
        name: Option<String>,
        /// Print only a scene that uses the law
        #[arg(long, requires = "name")]
        example: bool,
    },
    /// Fit restitution, friction and tangential restitution to measured impacts
    Calibrate(CalibrateArguments),
    /// Run scenes at the extremes of their parameters and check the answers
    Selftest(SelftestArguments),
    /// Print a completion script for a shell
    Completions {
        /// Shell
        shell: clap_complete::Shell,
    },
}

/// `granule law`.
#[derive(Debug, Subcommand)]
pub enum LawCommand {
    /// Print requested and realised restitutions, duration and largest overlap for each pair of materials
    Check {
        /// Scene file
        scene: PathBuf,
        /// Normal speed of impact in m/s [default: the largest that the scene expects]
        #[arg(long, value_name = "SPEED", value_parser = positive)]
        speed: Option<f64>,
    },
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("a speed is a positive number of metres per second".to_string()),
    }
}

/// `granule calibrate`.
#[derive(Debug, clap::Args)]
#[command(after_help = CALIBRATE_HELP)]
pub struct CalibrateArguments {
    /// CSV file with one measured impact a row
    pub data: PathBuf,
    /// Inertia factor q = I/(m R^2) of the bodies
    #[arg(long, default_value_t = 0.4)]
    pub inertia_factor: f64,
    /// Normal restitution, for data without it
    #[arg(long)]
    pub restitution: Option<f64>,
    /// Probability with which the intervals hold the true values
    #[arg(long, default_value_t = 0.95)]
    pub confidence: f64,
}

const CALIBRATE_HELP: &str = "\
Columns: psi1 and psi2, the tangential velocities of the contact point before and after over the normal
speed before, with restitution if it was measured; or normal_speed, tangential_velocity,
rebound_normal_speed and rebound_tangential_velocity of the centres, with radius, spin and rebound_spin
where bodies spin (R times spin adds to the tangential velocity).";

/// `granule run`.
#[derive(Debug, clap::Args)]
pub struct RunArguments {
    /// Scene file
    pub scene: PathBuf,
    /// Folder for the outputs [default: out/<name of the scene>]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Worker threads; results do not depend on it [default: what the scene says, else all cores]
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// Show no progress and no summary
    #[arg(short, long)]
    pub quiet: bool,
    /// Replace outputs of another scene in the output folder
    #[arg(long)]
    pub force: bool,
    /// End the run after so much time on the clock, as in "90 s" or "2 h": its outputs are then whole up to there
    #[arg(long, value_name = "TIME", value_parser = time, help_heading = "Bounds")]
    pub max_time: Option<Duration>,
}

/// `granule resume`.
#[derive(Debug, clap::Args)]
#[command(after_help = RESUME_HELP)]
pub struct ResumeArguments {
    /// Output folder of the run
    pub directory: PathBuf,
    /// Worker threads; results do not depend on it [default: what the scene says, else all cores]
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// Show no progress and no summary
    #[arg(short, long)]
    pub quiet: bool,
    /// End the run after so much time on the clock, as in "90 s" or "2 h": it can then be continued again
    #[arg(long, value_name = "TIME", value_parser = time, help_heading = "Bounds")]
    pub max_time: Option<Duration>,
}

const RESUME_HELP: &str = "\
Outputs go on where the checkpoint was made; what was written later is replaced. Files and result hash are in the end those
of a run that was never interrupted, byte for byte. A checkpoint that is damaged is passed over for the one before.";

/// `granule selftest`.
#[derive(Debug, clap::Args)]
pub struct SelftestArguments {
    /// Only these extremes
    pub names: Vec<String>,
    /// Those that take minutes, too
    #[arg(long, conflicts_with = "names")]
    pub all: bool,
    /// Name the extremes and run none
    #[arg(long)]
    pub list: bool,
}

/// `granule trade`.
#[derive(Debug, clap::Args)]
pub struct TradeArguments {
    /// Scene file
    pub scene: PathBuf,
    /// Folder for the results; an interrupted trade goes on with what it finds there [default: trade/<name of the scene>]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Quantities whose errors count, separated by commas: velocities, spins, or columns of a time series [default: those in
    /// the time series of the scene, else the usual ones]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub observe: Vec<String>,
    /// Runs of every setting
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u64).range(3..=1000))]
    pub runs: u64,
    /// Relative error that the choice may have
    #[arg(long, value_name = "SHARE", default_value_t = 0.01)]
    pub error: f64,
    /// Show no progress and no summary
    #[arg(short, long)]
    pub quiet: bool,
}

/// `granule advise`.
#[derive(Debug, clap::Args)]
pub struct AdviseArguments {
    /// Scene file
    pub scene: PathBuf,
    /// Folder for the results; interrupted advice goes on with what it finds there [default: advice/<name of the scene>]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Quantities that must not change, separated by commas: velocities, spins, or columns of a time series [default: those in
    /// the time series of the scene, else the usual ones]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub observe: Vec<String>,
    /// Runs with and without each piece of physics
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u64).range(3..=1000))]
    pub runs: u64,
    /// Relative change that is allowed
    #[arg(long, value_name = "SHARE", default_value_t = 0.01, value_parser = share)]
    pub error: f64,
    /// Write the scene with the change that saves most
    #[arg(long, value_name = "FILE")]
    pub write: Option<PathBuf>,
    /// Show no progress and no summary
    #[arg(short, long)]
    pub quiet: bool,
}

/// `granule compare-models`.
#[derive(Debug, clap::Args)]
#[command(after_help = COMPARE_MODELS_HELP)]
pub struct CompareModelsArguments {
    /// Scene file with a `substrate`
    pub scene: PathBuf,
    /// Simulated time of every run in s [default: that of the scene]
    #[arg(long, value_name = "SECONDS", value_parser = share)]
    pub duration: Option<f64>,
    /// Runs of each model; scenes of at most 16 bodies are run once
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u64).range(2..=1000))]
    pub runs: u64,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Show no progress
    #[arg(short, long)]
    pub quiet: bool,
}

const COMPARE_MODELS_HELP: &str = "\
(a) time steps on the substrate            needs laws of contact
(b) time steps on a plane wall             needs laws of contact; the reference, where it can be run
(c) hard bodies along arcs                 rules of collision, or those that the laws of contact amount to
(d) hard bodies, effective restitution     the same; slides are over at once";

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("this must be a positive number".to_string()),
    }
}
