//! `cargo xtask bench event`: collisions a second of hard spheres, ours beside EDMD and DynamO.

mod peers;
mod table;

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::command::{Error, cargo, run};
use peers::Peer;

/// Runs of each program; they take turns, and the fastest of each counts, which other programs disturbed least. 10^6 spheres
/// run once: their fluid takes minutes to prepare.
const TURNS: usize = 3;
/// Volume fraction and restitution. EDMD knows elastic spheres only.
const GASES: [(f64, f64); 4] = [(0.3, 1.0), (0.49, 1.0), (0.05, 1.0), (0.05, 0.9)];
/// Numbers of spheres asked for; the nearest that fill a face-centred cube are taken.
const SIZES: [f64; 3] = [1e4, 1e5, 1e6];

/// What the words after `bench event` ask for.
#[derive(Debug, Default, PartialEq)]
pub struct Options {
    /// Folder of the sources of EDMD, <https://github.com/FSmallenburg/EDMD>.
    edmd: Option<PathBuf>,
    /// Folder of the programs of DynamO, <https://github.com/toastedcrumpets/DynamO>.
    dynamo: Option<PathBuf>,
    /// One turn, and no more than 10^5 spheres.
    quick: bool,
    /// One gas, passed to the example of granule-events.
    one: Vec<String>,
}

impl Options {
    /// Reads the words.
    ///
    /// # Errors
    /// An option is unknown or lacks its folder.
    pub fn parse(words: &[String]) -> Result<Self, Error> {
        let mut options = Self::default();
        let mut words = words.iter();
        while let Some(word) = words.next() {
            let mut folder = |what: &str| {
                let next = words.next().map(PathBuf::from);
                next.ok_or_else(|| Error::usage(format!("{word} takes the folder with {what}")))
            };
            match word.as_str() {
                "--quick" => options.quick = true,
                "--edmd" => options.edmd = Some(folder("the sources of EDMD (Single, Cell)")?),
                "--dynamo" => options.dynamo = Some(folder("the program dynarun")?),
                number if number.parse::<f64>().is_ok() => options.one.push(number.to_string()),
                other => {
                    return Err(Error::usage(format!(
                        "bench event does not know `{other}`; it takes --quick, --edmd FOLDER, --dynamo FOLDER, or the numbers \
                         of one gas: spheres, volume fraction, restitution, collisions"
                    )));
                }
            }
        }
        Ok(options)
    }
}

/// What was measured of one gas.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Number of spheres asked for, and in the box.
    pub spheres: (f64, f64),
    /// Volume fraction.
    pub phi: f64,
    /// Restitution.
    pub restitution: f64,
    /// Collisions a second of each turn.
    pub ours: Vec<f64>,
    /// State, queue and lists \[bytes a sphere\].
    pub bytes: f64,
    /// What the program grew by, as the system counts \[bytes a sphere\].
    pub resident: f64,
    /// Name of another program and its collisions a second of each turn; none where it does not know the gas.
    pub peers: Vec<(&'static str, Vec<f64>)>,
}

impl Row {
    /// The fastest turn.
    pub fn best(&self) -> f64 {
        fastest(&self.ours)
    }
}

/// The fastest turn.
pub fn fastest(turns: &[f64]) -> f64 {
    turns.iter().copied().fold(0.0, f64::max)
}

/// Runs the benchmark; prints a table, which `target/bench/events.md` keeps, with `target/bench/events.json`.
///
/// # Errors
/// Something does not build or run.
pub fn bench_event(root: &Path, words: &[String]) -> Result<(), Error> {
    let options = Options::parse(words)?;
    let example = ["--quiet", "--release", "--package", "granule-events", "--example", "speed"];
    if !options.one.is_empty() {
        let mut command = Command::new(cargo());
        return run(command.arg("run").args(example).arg("--").args(&options.one).current_dir(root));
    }
    run(Command::new(cargo()).arg("build").args(example).current_dir(root))?;
    let folder = root.join("target/bench/events");
    std::fs::create_dir_all(&folder).map_err(|error| Error::file(&folder, &error))?;
    let ours = target(root).join("release/examples/speed");
    let mut peers = Vec::new();
    if let Some(sources) = &options.edmd {
        peers.extend(peers::edmd(sources, &folder)?);
    }
    if let Some(programs) = &options.dynamo {
        peers.push(peers::dynamo(programs)?);
    }
    let (turns, sizes) = if options.quick { (1, &SIZES[..2]) } else { (TURNS, &SIZES[..]) };
    let mut rows = Vec::new();
    for (phi, restitution) in GASES {
        for &n in sizes {
            let turns = if n > SIZES[1] { 1 } else { turns };
            let row = measure(&ours, &peers, &folder, n, (phi, restitution), turns)?;
            println!("{}", table::line(&row));
            rows.push(row);
        }
    }
    let text = table::text(&rows);
    for (name, content) in [("events.md", &text), ("events.json", &table::json(&rows, &processor()))] {
        let file = root.join("target/bench").join(name);
        std::fs::write(&file, content).map_err(|error| Error::file(&file, &error))?;
    }
    println!("\n{text}\ntarget/bench/events.md, target/bench/events.json");
    Ok(())
}

/// Where cargo puts what it builds.
fn target(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from)
}

/// What the system calls the processor.
fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    name.map_or_else(|| "unknown".into(), |(_, name)| name.trim().to_string())
}

/// One gas by all programs.
fn measure(
    ours: &Path,
    peers: &[Peer],
    folder: &Path,
    n: f64,
    (phi, restitution): (f64, f64),
    turns: usize,
) -> Result<Row, Error> {
    let collisions = (3.0 * n).max(5e5).min(2e6);
    let (edmd, dynamo) = (folder.join("fluid.sph"), folder.join("fluid.xml"));
    let mut row = Row { spheres: (n, n), phi, restitution, ..Row::default() };
    row.peers = peers.iter().map(|peer| (peer.name, Vec::new())).collect();
    for turn in 0..turns {
        let words = [n, phi, restitution, collisions].map(|number| number.to_string());
        let mut command = Command::new(ours);
        command.args(&words);
        if turn == 0 && !peers.is_empty() {
            command.arg("--edmd").arg(&edmd).arg("--dynamo").arg(&dynamo);
        }
        let text = output(&mut command)?;
        row.ours.push(number(&text, "", " collisions/s")?);
        row.bytes = number(&text, "", " bytes a body")?;
        row.resident = number(&text, "", " resident")?;
        row.spheres.1 = number(&text, "N ", " phi")?;
        let duration = 2.0 * collisions / (row.spheres.1 * number(&text, "rate a body ", ";")?);
        for (peer, (_, speeds)) in peers.iter().zip(&mut row.peers) {
            if peer.knows(n, restitution) {
                speeds.push(peer.run(&edmd, &dynamo, collisions, duration)?);
            }
        }
    }
    Ok(row)
}

/// What a program writes.
fn output(command: &mut Command) -> Result<String, Error> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.output().map_err(|error| Error::new(format!("cannot run `{name}`: {error}")))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err(Error::new(format!("`{name}` failed: {said}")));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The number that comes between `before` and `after`, or, without `before`, the word in front of `after`.
fn number(text: &str, before: &str, after: &str) -> Result<f64, Error> {
    let found = if before.is_empty() {
        text.find(after).and_then(|end| text[..end].split_whitespace().last())
    } else {
        text.find(before).map(|at| &text[at + before.len()..]).and_then(|rest| rest.split(after).next())
    };
    found
        .and_then(|word| word.trim().parse().ok())
        .ok_or_else(|| Error::new(format!("no number between `{before}` and `{after}` in: {text}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_are_read() {
        let text =
            "N 10976 phi 0.3 e 1: 266067 collisions/s; rate a body 10.121; 321 bytes a body, 330 resident\n";
        assert_eq!(number(text, "", " collisions/s"), Ok(266_067.0));
        assert_eq!(number(text, "rate a body ", ";"), Ok(10.121));
        assert_eq!(number(text, "N ", " phi"), Ok(10_976.0));
        assert_eq!(number(text, "", " resident"), Ok(330.0));
        assert!(number(text, "seconds ", "\n").is_err());
    }

    #[test]
    fn words_are_read() {
        let words = |line: &str| line.split(' ').map(str::to_string).collect::<Vec<_>>();
        let options = Options::parse(&words("--edmd EDMD --quick --dynamo build")).unwrap();
        assert_eq!((options.edmd, options.quick), (Some(PathBuf::from("EDMD")), true));
        assert_eq!(options.dynamo, Some(PathBuf::from("build")));
        assert_eq!(Options::parse(&words("1e4 0.3 1 1e5")).unwrap().one.len(), 4);
        assert!(Options::parse(&words("--edmd")).is_err());
        assert!(Options::parse(&words("--fast")).is_err());
    }
}
