//! The command line.

use std::path::PathBuf;

use clap::{Parser, Subcommand};

const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    the scene has errors or cannot be read, or there is no such law
  2    the command line is wrong
  3    the run failed: a number is no longer finite, an output cannot be written, or a self-test fails
  130  stopped by Ctrl-C or a termination signal; what was written is whole";

/// Granular matter, simulated grain by grain.
#[derive(Debug, Parser)]
#[command(name = "granule", version, about, after_help = EXIT_CODES, max_term_width = 100)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scene and write its outputs
    Run(RunArguments),
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
}

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
