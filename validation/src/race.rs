//! What an accuracy costs: ours and the installed peers, each at the largest step that keeps it.

mod contests;
mod page;
mod runner;
mod schemes;

use std::path::PathBuf;

use serde::Serialize;

use self::contests::{CONTESTS, Contest};
use self::runner::{Racer, racers};
pub use self::schemes::schemes;

/// Steps in a contact: factors of √2.
const FEWEST: f64 = 10.0;
/// Errors to reach.
pub const TARGETS: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// What to run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where `race.json`, `race.md` and the figures go.
    pub out: PathBuf,
    /// Parts of names of contests; empty for all.
    pub words: Vec<String>,
}

/// One setting of one engine.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// Stiffness of the contacts.
    pub stiffness: f64,
    /// Steps in a contact; zero for hard bodies.
    pub steps_per_contact: f64,
    /// Largest error.
    pub error: f64,
    /// Time of the steps on one core \[s\].
    pub seconds: f64,
}

/// All settings of one engine in one contest.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    /// Who.
    pub name: String,
    /// Version of a peer, as its banner says it.
    pub version: String,
    /// Its settings, the coarsest first.
    pub points: Vec<Point>,
    /// Time to reach each of [`TARGETS`] \[s\], if it is reached.
    pub time_to: Vec<Option<f64>>,
}

/// One contest.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// Name.
    pub contest: String,
    /// What is measured.
    pub what: String,
    /// Who took part.
    pub entries: Vec<Entry>,
}

/// Runs the contests, prints what comes out and writes it.
///
/// # Errors
/// There is no such contest, a scene cannot be planned, a run fails, or a file cannot be written.
pub fn race(options: &Options) -> Result<Vec<Outcome>, String> {
    let wanted = |contest: &&Contest| {
        options.words.is_empty() || options.words.iter().any(|word| contest.name.contains(word.as_str()))
    };
    let contests: Vec<&Contest> = CONTESTS.iter().filter(wanted).collect();
    if contests.is_empty() {
        let names: Vec<&str> = CONTESTS.iter().map(|contest| contest.name).collect();
        return Err(format!("no contest has such a name; there are {}", names.join(", ")));
    }
    let mut outcomes = Vec::new();
    for contest in contests {
        println!("{}: {}", contest.name, contest.what);
        let mut entries = Vec::new();
        for racer in racers(contest) {
            let entry = run(contest, &racer)?;
            println!("  {}", page::line(&entry));
            entries.push(entry);
        }
        outcomes.push(Outcome { contest: contest.name.into(), what: contest.what.into(), entries });
        page::write(&outcomes, &options.out)?;
    }
    Ok(outcomes)
}

/// One engine, at each stiffness from coarse to fine steps until the finest target is reached.
fn run(contest: &Contest, racer: &Racer) -> Result<Entry, String> {
    let mut entry =
        Entry { name: racer.name().into(), version: String::new(), points: Vec::new(), time_to: Vec::new() };
    let stiffnesses = if racer.is_hard() { &contest.stiffnesses[..1] } else { contest.stiffnesses };
    let mut times: Vec<Vec<Option<f64>>> = Vec::new();
    for stiffness in stiffnesses {
        let points = ladder(contest, racer, *stiffness, &mut entry.version)?;
        times.push(TARGETS.iter().map(|target| time_to(&points, *target)).collect());
        entry.points.extend(points);
    }
    entry.time_to = (0..TARGETS.len())
        .map(|target| times.iter().filter_map(|times| times[target]).min_by(f64::total_cmp))
        .collect();
    Ok(entry)
}

fn ladder(
    contest: &Contest,
    racer: &Racer,
    stiffness: f64,
    version: &mut String,
) -> Result<Vec<Point>, String> {
    let scenes = (contest.scenes)(stiffness);
    let right = scenes.iter().map(|scene| racer.right(scene, contest)).collect::<Result<Vec<_>, _>>()?;
    let mut points = Vec::new();
    let mut steps = FEWEST;
    loop {
        let mut runs = Vec::new();
        let mut seconds = 0.0;
        for scene in &scenes {
            let done = racer.run(scene, steps, contest.frames)?;
            seconds += done.seconds;
            *version = done.version;
            runs.push(done.run);
        }
        let error = (contest.error)(&runs, &right);
        let steps_per_contact = if racer.is_hard() { 0.0 } else { steps };
        points.push(Point { stiffness, steps_per_contact, error, seconds });
        if racer.is_hard() || error <= 0.5 * TARGETS[TARGETS.len() - 1] || steps >= contest.most {
            return Ok(points);
        }
        steps = (steps * std::f64::consts::SQRT_2).round();
    }
}

/// Time of the first setting from which on all finer ones keep the error, moved along the line (in logarithms) to the one
/// before it.
fn time_to(points: &[Point], target: f64) -> Option<f64> {
    let last_bad = points.iter().rposition(|point| point.error > target);
    let Some(bad) = last_bad else { return points.first().map(|point| point.seconds) };
    let (bad, good) = (&points[bad], points.get(bad + 1)?);
    let part = (bad.error / target).ln() / (bad.error / good.error).ln();
    Some((bad.seconds.ln() + part * (good.seconds.ln() - bad.seconds.ln())).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_of_the_first_setting_that_is_good_for_good() {
        let point =
            |error: f64, seconds: f64| Point { stiffness: 1.0, steps_per_contact: 10.0, error, seconds };
        let points = [point(0.1, 1.0), point(0.01, 2.0), point(0.02, 3.0), point(0.005, 6.0)];
        // Between 0.02 at 3 s and 0.005 at 6 s, half way in logarithms.
        let time = time_to(&points, 0.01).unwrap();
        assert!((time - 18.0_f64.sqrt()).abs() < 1e-12, "{time}");
        assert_eq!(time_to(&points, 0.2), Some(1.0));
        assert_eq!(time_to(&points, 1e-3), None);
    }
}
