//! The program from outside: commands, exit codes, messages, files.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use granule::parts::formats::{csv, lammps_data, lammps_dump};
use granule::parts::report::Manifest;

/// Two glass spheres that meet; `run` and `outputs` are filled in.
fn scene(run: &str, outputs: &str) -> String {
    format!(
        "(
    version: 1,
    title: \"two spheres\",
    materials: {{ \"glass\": (density: \"2500 kg/m^3\") }},
    bodies: [
        Sphere(material: \"glass\", radius: \"1 mm\", position: (0, 0, 0), velocity: (\"0.1 m/s\", 0, 0)),
        Sphere(material: \"glass\", radius: \"1 mm\", position: (\"2.01 mm\", \"0.5 mm\", 0)),
    ],
    contacts: [
        (
            between: (\"glass\", \"glass\"),
            normal: LinearSpringDashpot(contact_duration: \"0.1 ms\", restitution: 0.8),
            tangential: TangentialSpring(tangential_restitution: 0.5, friction: 0.4),
        ),
    ],
    run: {run},
    outputs: {outputs},
)
"
    )
}

const OUTPUTS: &str = "[
        Series(path: \"series.csv\", columns: [\"kinetic_energy\", \"rotational_energy\", \"momentum_x\", \
                       \"energy_residual\"], every: 10),
        Bodies(path: \"bodies.csv\", ids: [2], every: 10),
        LammpsDump(path: \"spheres.dump\", every: 50),
        Vtk(path: \"vtk/spheres\", every: 100),
        LammpsData(path: \"last.data\"),
    ]";

struct Case {
    folder: tempfile::TempDir,
}

impl Case {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) -> &Self {
        std::fs::write(self.path(name), text).unwrap();
        self
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_granule"));
        command.current_dir(self.folder.path()).args(arguments).stdin(Stdio::null());
        command
    }

    fn granule(&self, arguments: &[&str]) -> Done {
        Done::of(self.command(arguments).output().unwrap())
    }
}

/// A finished program.
struct Done {
    code: Option<i32>,
    out: String,
    err: String,
}

impl Done {
    fn of(output: Output) -> Self {
        let done = Self {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        };
        assert!(!done.err.contains("panicked"), "{}", done.err);
        assert!(!done.err.contains('\u{1b}') && !done.out.contains('\u{1b}'), "colours without a terminal");
        done
    }

    #[track_caller]
    fn exits(&self, code: i32) -> &Self {
        assert_eq!(self.code, Some(code), "\n{}\n{}", self.out, self.err);
        self
    }
}

fn manifest(folder: &Path) -> Manifest {
    Manifest::from_json(&std::fs::read_to_string(folder.join("manifest.json")).unwrap()).unwrap()
}

#[test]
fn a_run_writes_what_the_scene_asks_for() {
    let case = Case::new();
    case.write("pair.ron", &scene("(duration: \"1 ms\")", OUTPUTS));
    let done = case.granule(&["run", "pair.ron"]);
    done.exits(0);
    let folder = case.path("out/pair");
    let manifest = manifest(&folder);
    assert_eq!(manifest.outcome, "completed");
    assert!(done.out.contains(manifest.result_hash.as_deref().unwrap()), "{}", done.out);
    assert_eq!(manifest.counts.bodies, 2);
    let names: Vec<&str> = manifest.outputs.iter().map(|file| file.path.as_str()).collect();
    assert_eq!(names, ["series.csv", "bodies.csv", "spheres.dump", "vtk/spheres.pvd", "last.data"]);
    for file in &manifest.outputs {
        let text = std::fs::read(folder.join(&file.path)).unwrap();
        assert_eq!(text.len() as u64, file.bytes, "{}", file.path);
        let text = String::from_utf8_lossy(&text);
        assert!(text.contains(&manifest.plan_fingerprint), "{} lacks the plan", file.path);
        assert!(
            text.contains(concat!("granule ", env!("CARGO_PKG_VERSION"))),
            "{} lacks the version",
            file.path
        );
        assert!(done.out.contains(&file.path), "{}", done.out);
    }
    let series = csv::read(folder.join("series.csv")).unwrap();
    let kinetic = series.column("kinetic_energy").unwrap();
    // One sphere of 4/3 π 1e-9 m³ · 2500 kg/m³ at 0.1 m/s; a handful of roundings.
    let start = 0.5 * (4.0 / 3.0 * std::f64::consts::PI * 1e-9 * 2500.0) * 0.01;
    assert!((kinetic[0] - start).abs() < 1e-14 * start);
    assert!(kinetic[kinetic.len() - 1] < 0.95 * start, "the impact dissipates");
    assert!(series.column("rotational_energy").unwrap().last().unwrap() > &0.0, "friction spins the spheres");
    let steps = series.column("step").unwrap();
    assert_eq!(steps[1], 10.0);
    assert_eq!(steps[steps.len() - 1] as u64, manifest.counts.steps);
    let frames = lammps_dump::read(folder.join("spheres.dump")).unwrap();
    let data = lammps_data::read(folder.join("last.data")).unwrap();
    let bodies = csv::read(folder.join("bodies.csv")).unwrap();
    let last = frames.last().unwrap();
    assert_eq!(last.step, manifest.counts.steps);
    assert_eq!(last.positions().unwrap()[1], data.atoms[1].position);
    assert_eq!(bodies.column("x").unwrap().last(), Some(&data.atoms[1].position[0]));
}

#[test]
fn the_same_bits_on_any_number_of_threads_and_without_outputs() {
    let case = Case::new();
    case.write("a.ron", &scene("(duration: \"1 ms\")", OUTPUTS));
    case.write("b.ron", &scene("(duration: \"1 ms\")", "[]"));
    let hash = |arguments: &[&str]| {
        let done = case.granule(arguments);
        done.exits(0);
        done.out
            .lines()
            .find_map(|line| line.strip_prefix("result hash").map(|hash| hash.trim().to_string()))
            .unwrap()
    };
    let first = hash(&["run", "a.ron"]);
    assert_eq!(first, hash(&["run", "a.ron", "--threads", "2", "--output", "two"]));
    assert_eq!(first, hash(&["run", "b.ron", "--threads", "1"]));
    assert_ne!(first, {
        case.write("c.ron", &scene("(duration: \"1.1 ms\")", "[]"));
        hash(&["run", "c.ron"])
    });
}

#[test]
fn all_problems_are_shown_with_their_places() {
    let case = Case::new();
    let bad = scene("(duration: \"1 ms\")", "[]")
        .replace("radius: \"1 mm\", position: (0,", "radios: \"1 mm\", position: (0,")
        .replace("contact_duration: \"0.1 ms\"", "contact_duration: \"0.1 m\"");
    case.write("bad.ron", &bad).write("good.ron", &scene("(duration: \"1 ms\")", "[]"));
    let done = case.granule(&["check", "bad.ron", "good.ron", "none.ron"]);
    done.exits(1);
    let line = |text: &str| bad.lines().position(|line| line.contains(text)).unwrap() + 1;
    let column = |text: &str| bad.lines().find_map(|line| line.find(text)).unwrap() + 1;
    let place = format!("bad.ron:{}:{}: error: ", line("radios"), column("radios"));
    assert!(done.err.contains(&place), "{place} not in\n{}", done.err);
    assert!(done.err.contains(&format!("bad.ron:{}:", line("\"0.1 m\""))), "{}", done.err);
    let mark = done.err.lines().find(|line| line.contains("^^^^^^")).unwrap();
    let source = done.err.lines().find(|line| line.contains("radios:")).unwrap();
    assert_eq!(mark.find('^'), source.find("radios"), "{}", done.err);
    assert!(done.err.contains("none.ron: No such file"));
    assert!(done.out.contains("good.ron: ok: 2 bodies"));
    case.granule(&["check", "good.ron"]).exits(0);
    let run = case.granule(&["run", "bad.ron"]);
    assert!(run.exits(1).err.contains(&place));
    assert!(!case.path("out").exists(), "a bad scene writes nothing");
    assert!(case.granule(&["explain", "bad.ron"]).exits(1).err.contains(&place));
}

#[test]
fn what_is_no_scene_is_refused() {
    let case = Case::new();
    std::fs::write(case.path("latin1.ron"), b"(title: \"K\xf6rner\")").unwrap();
    case.write("empty.ron", "").write("noise.ron", "\u{0}\u{1}(((((");
    for (name, words) in [
        ("none.ron", "No such file"),
        (".", "is a folder"),
        ("latin1.ron", "not UTF-8 text (byte 10)"),
        ("empty.ron", "empty.ron:1:1: error"),
        ("noise.ron", "noise.ron:1:1: error"),
    ] {
        for command in ["run", "check", "explain"] {
            let done = case.granule(&[command, name]);
            assert!(done.exits(1).err.contains(words), "{command} {name}: {}", done.err);
        }
    }
    case.granule(&["run"]).exits(2);
    case.granule(&["fly", "a.ron"]).exits(2);
    case.granule(&["run", "a.ron", "--threads", "0"]).exits(2);
    case.granule(&["--help"]).exits(0);
    assert!(case.granule(&["--version"]).exits(0).out.contains(env!("CARGO_PKG_VERSION")));
}

#[test]
fn extremes_are_run_by_name() {
    let case = Case::new();
    let done = case.granule(&["selftest", "no-bodies", "plastic-hard"]);
    done.exits(0);
    assert!(done.out.contains("2 right, 0 wrong") && done.out.contains("at least one body"), "{}", done.out);
    let names = case.granule(&["selftest", "--list"]).exits(0).out.clone();
    assert!(names.lines().count() > 40 && names.contains("column-long (--all, or by name)"), "{names}");
    assert!(case.granule(&["selftest", "flying"]).exits(1).err.contains("`flying`"));
}

#[test]
fn outputs_that_cannot_be_written_are_said_so() {
    let case = Case::new();
    case.write("pair.ron", &scene("(duration: \"1 ms\")", "[Series(path: \"deep/series.csv\")]"));
    case.write("file", "");
    let done = case.granule(&["run", "pair.ron", "--output", "file"]);
    assert!(done.exits(3).err.contains("file"), "{}", done.err);
    std::fs::create_dir_all(case.path("taken/deep/series.csv")).unwrap();
    let done = case.granule(&["run", "pair.ron", "--output", "taken"]);
    assert!(done.exits(3).err.contains("--force"), "{}", done.err);
    let done = case.granule(&["run", "pair.ron", "--output", "taken", "--force"]);
    assert!(done.exits(3).err.contains("series.csv"), "{}", done.err);
    assert_eq!(manifest(&case.path("taken")).outcome.split(':').next(), Some("failed"));
}

#[test]
fn outputs_of_another_scene_are_kept() {
    let case = Case::new();
    case.write("a.ron", &scene("(duration: \"1 ms\")", "[Series(path: \"s.csv\")]"));
    let softer = scene("(duration: \"1 ms\")", "[Series(path: \"s.csv\")]")
        .replace("restitution: 0.8", "restitution: 0.7");
    case.write("b.ron", &softer);
    case.granule(&["run", "a.ron", "--output", "here"]).exits(0);
    case.granule(&["run", "a.ron", "--output", "here"]).exits(0);
    let before = std::fs::read(case.path("here/s.csv")).unwrap();
    let done = case.granule(&["run", "b.ron", "--output", "here"]);
    assert!(done.exits(3).err.contains("outputs of another scene"), "{}", done.err);
    assert_eq!(std::fs::read(case.path("here/s.csv")).unwrap(), before);
    case.granule(&["run", "b.ron", "--output", "here", "--force"]).exits(0);
    assert_ne!(std::fs::read(case.path("here/s.csv")).unwrap(), before);
    // Files of somebody else are kept too.
    std::fs::create_dir(case.path("mine")).unwrap();
    case.write("mine/s.csv", "precious");
    assert!(case.granule(&["run", "a.ron", "--output", "mine"]).exits(3).err.contains("s.csv"));
    assert_eq!(std::fs::read_to_string(case.path("mine/s.csv")).unwrap(), "precious");
}

#[test]
fn laws_are_listed_and_shown() {
    let case = Case::new();
    let table = case.granule(&["laws"]);
    for law in ["LinearSpringDashpot", "Hertz", "TangentialSpring", "Coulomb"] {
        assert!(table.exits(0).out.contains(law), "{}", table.out);
        let page = case.granule(&["laws", law]);
        assert!(page.exits(0).out.contains("Sources"), "{}", page.out);
        let example = case.granule(&["laws", law, "--example"]);
        case.write("example.ron", &example.exits(0).out);
        case.granule(&["run", "example.ron", "--quiet", "--force"]).exits(0);
    }
    let done = case.granule(&["laws", "Herz"]);
    assert!(done.exits(1).err.contains("did you mean `Hertz`?"), "{}", done.err);
}

#[test]
fn a_plan_is_explained() {
    let case = Case::new();
    case.write("pair.ron", &scene("(duration: \"1 ms\")", OUTPUTS));
    let done = case.granule(&["explain", "pair.ron"]);
    for words in ["LinearSpringDashpot", "TangentialSpring", "rotation", "energy ledger"] {
        assert!(done.exits(0).out.contains(words), "{words} not in\n{}", done.out);
    }
}

#[test]
fn laws_of_a_scene_are_checked_in_a_single_contact() {
    let case = Case::new();
    case.write("pair.ron", &scene("(duration: \"1 ms\")", OUTPUTS));
    for arguments in [&["law", "check", "pair.ron"][..], &["law", "check", "pair.ron", "--speed", "0.01"]] {
        let done = case.granule(arguments);
        for words in ["requested", "realised", "restitution e_n", "contact duration t_c", "maximum overlap"] {
            assert!(done.exits(0).out.contains(words), "{words} not in\n{}", done.out);
        }
    }
    assert!(case.granule(&["law", "check", "pair.ron", "--speed", "0.01"]).out.contains("at 0.01 m/s"));
    case.granule(&["law", "check", "pair.ron", "--speed", "0"]).exits(2);
    case.granule(&["law", "check", "none.ron"]).exits(1);
}

/// Two rolling beads that meet head on: the effective restitution of Kondic 1999, Eq. (68), is (0.9 · 2.5 - 1)/3.5.
#[test]
fn models_of_beads_on_a_substrate_are_compared() {
    let case = Case::new();
    let bead = |x: f64, v: f64| {
        format!(
            "Sphere(material: \"steel\", radius: 0.002, position: ({x}, 0, 0.002), velocity: ({v}, 0, 0), spin: (0, {}, 0))",
            v / 0.002
        )
    };
    let text = |contact: &str, driver: &str| {
        format!(
            "(version: 1, gravity: (0, 0, -9.81), materials: {{ \"steel\": (density: 7850) }}, bodies: [{}, {}],
              substrate: (laws: {{ \"steel\": StickSlip(friction: 0.1) }}),
              contacts: [(between: (\"steel\", \"steel\"), {contact})], {driver} run: (duration: \"40 ms\"))",
            bead(0.0021, -0.05),
            bead(-0.0021, 0.05)
        )
    };
    let soft =
        "contact_end: Overlap, normal: LinearSpringDashpot(restitution: 0.9, contact_duration: \"2e-5 s\")";
    case.write("soft.ron", &text(soft, ""));
    case.write(
        "hard.ron",
        &text("collision: HardSphere(restitution: 0.9)", "driver: Event(contact_duration: 2e-5),"),
    );
    case.write("pair.ron", &scene("(duration: \"1 ms\")", "[]"));
    for name in ["soft.ron", "hard.ron"] {
        let done = case.granule(&["compare-models", name, "--quiet"]);
        done.exits(0);
        for words in [
            "(a) substrate",
            "(b) contacts",
            "(c) hard bodies along arcs",
            "(d) hard bodies",
            "differences from (b)",
        ] {
            assert!(done.out.contains(words), "{words} not in\n{}", done.out);
        }
        let json: serde_json::Value =
            serde_json::from_str(&case.granule(&["compare-models", name, "--quiet", "--json"]).out).unwrap();
        assert_eq!(json["reference"], "contact");
        let models = json["models"].as_array().unwrap();
        assert_eq!(models.len(), 4);
        for model in models {
            let velocity = model["differences"][1]["value"].as_f64().unwrap();
            // Friction of the plane during a soft contact, of 2e-5 s and more, is left out: half a per cent of the speed.
            assert!((velocity - 0.05 * 1.25 / 3.5).abs() < 0.005 * 0.05, "{model}");
            assert!(model["seconds_per_simulated_second"].as_f64().unwrap() > 0.0);
        }
        // Arcs keep the way of the slide, a collision without one does not.
        let way = |index: usize| models[index]["differences"][0]["difference"].as_f64().unwrap();
        assert!(way(1) < 0.02 && way(2) < 0.02 && way(3) > 0.2, "{json}");
    }
    let done = case.granule(&["compare-models", "pair.ron"]);
    done.exits(1);
    assert!(done.err.contains("substrate"), "{}", done.err);
    case.granule(&["compare-models", "soft.ron", "--duration", "0"]).exits(2);
}

#[test]
fn quiet_is_quiet() {
    let case = Case::new();
    case.write("pair.ron", &scene("(duration: \"1 ms\")", OUTPUTS));
    let done = case.granule(&["run", "pair.ron", "--quiet"]);
    assert_eq!((done.exits(0).out.as_str(), done.err.as_str()), ("", ""));
}

#[cfg(unix)]
mod signals {
    use super::*;

    /// A run that would take days, until `rows` rows of its series are there.
    fn long_run(case: &Case, rows: usize) -> std::process::Child {
        let outputs = "[
        Series(path: \"series.csv\", columns: [\"kinetic_energy\"], every: 1000),
        LammpsDump(path: \"spheres.dump\", every: 1000),
        LammpsData(path: \"last.data\"),
    ]";
        case.write("long.ron", &scene("(steps: 1000000000000)", outputs));
        let child = case
            .command(&["run", "long.ron", "--output", "long"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let deadline = Instant::now() + Duration::from_secs(60);
        let lines =
            || std::fs::read_to_string(case.path("long/series.csv")).map_or(0, |text| text.lines().count());
        while lines() < rows {
            assert!(Instant::now() < deadline, "no rows after a minute");
            std::thread::sleep(Duration::from_millis(20));
        }
        child
    }

    fn signal(child: &std::process::Child, name: &str) {
        let status = Command::new("kill").args([name, &child.id().to_string()]).status().unwrap();
        assert!(status.success());
    }

    #[test]
    fn ctrl_c_and_termination_end_a_run_cleanly() {
        for name in ["-INT", "-TERM"] {
            let case = Case::new();
            let child = long_run(&case, 20);
            signal(&child, name);
            let done = Done::of(child.wait_with_output().unwrap());
            let folder = case.path("long");
            let manifest = manifest(&folder);
            assert_eq!(manifest.outcome, "stopped by the user");
            let place = format!("stopped at step {} of 1000000000000", manifest.counts.steps);
            assert!(done.exits(130).err.contains(&place), "{}", done.err);
            assert!(done.err.contains("outputs in long are whole"), "{}", done.err);
            let series = csv::read(folder.join("series.csv")).unwrap();
            assert_eq!(*series.column("step").unwrap().last().unwrap() as u64, manifest.counts.steps);
            let frames = lammps_dump::read(folder.join("spheres.dump")).unwrap();
            assert_eq!(frames.last().unwrap().step, manifest.counts.steps);
            assert_eq!(lammps_data::read(folder.join("last.data")).unwrap().atoms.len(), 2);
        }
    }

    #[test]
    fn what_a_killed_run_has_written_can_be_read() {
        let case = Case::new();
        let mut child = long_run(&case, 20);
        signal(&child, "-KILL");
        child.wait().unwrap();
        let folder = case.path("long");
        assert_eq!(manifest(&folder).outcome, "running");
        let series = csv::read(folder.join("series.csv")).unwrap();
        assert!(series.rows() >= 19);
        assert!(
            series.column("step").unwrap().iter().enumerate().all(|(row, step)| *step == 1000.0 * row as f64)
        );
        let frames = lammps_dump::read(folder.join("spheres.dump")).unwrap();
        assert!(frames.len() >= 18);
        assert_eq!(lammps_data::read(folder.join("last.data")).unwrap().atoms.len(), 2);
        // The same scene may go into the same folder again.
        let mut again = case.command(&["run", "long.ron", "--output", "long", "--quiet"]);
        let child = again.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(500));
        signal(&child, "-INT");
        let done = Done::of(child.wait_with_output().unwrap());
        done.exits(130);
    }

    #[test]
    fn advice_tells_what_acts_and_what_does_not() {
        let case = Case::new();
        let oblique = scene("(duration: \"30 ms\")", "[]");
        let central = oblique.replace("\"0.5 mm\"", "0");
        case.write("oblique.ron", &oblique).write("central.ron", &central);
        let verdicts = |name: &str| {
            let done =
                case.granule(&["advise", name, "--output", &format!("{name}-advice"), "--error", "0.02"]);
            done.exits(0);
            let line = |physics: &str| {
                let line = done.out.lines().find(|line| line.trim_start().starts_with(physics));
                line.unwrap_or_else(|| panic!("no {physics} in {}", done.out)).to_string()
            };
            [line("friction"), line("soft contacts")]
        };
        let [friction, soft] = verdicts("central.ron");
        assert!(friction.contains("never acts"), "{friction}");
        assert!(soft.contains("can go"), "{soft}");
        let [friction, _] = verdicts("oblique.ron");
        assert!(friction.contains("is needed"), "{friction}");
        let json = std::fs::read_to_string(case.path("oblique.ron-advice/advice.json")).unwrap();
        assert!(json.contains("Psi_1") && json.contains("\"verdict\": \"is needed\""), "{json}");
        // The change that saves most is a scene, and is right.
        let arguments = [
            "advise",
            "central.ron",
            "--output",
            "central.ron-advice",
            "--error",
            "0.02",
            "--write",
            "hard.ron",
        ];
        case.granule(&arguments).exits(0);
        let text = std::fs::read_to_string(case.path("hard.ron")).unwrap();
        assert!(
            text.contains("collision: HardSphere(restitution: 0.8")
                || text.contains("HardSphere(restitution: 0.79"),
            "{text}"
        );
        case.granule(&["check", "hard.ron"]).exits(0);
        let done = case.granule(&["advise", "hard.ron"]);
        done.exits(1);
        assert!(done.err.contains("hard bodies already"), "{}", done.err);
    }

    #[test]
    fn a_scene_asks_for_an_accuracy() {
        let case = Case::new();
        let text = scene("(duration: \"1 ms\"), accuracy: (restitution: 0.01)", "[]");
        case.write("wish.ron", &text);
        let done = case.granule(&["explain", "wish.ron"]);
        done.exits(0);
        assert!(
            done.out.contains("+ accuracy: ") && done.out.contains("- measured: error of VelocityVerlet"),
            "{}",
            done.out
        );
        let done = case.granule(&["run", "wish.ron"]);
        done.exits(0);
        let line = done.out.lines().find(|line| line.starts_with("accuracy")).unwrap();
        let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        assert!(numbers.len() == 2 && numbers[0] <= 0.01 && numbers[1] <= numbers[0], "{line}");
        case.write("time.ron", &text.replace("accuracy: (restitution: 0.01)", "budget: (seconds: 30)"));
        let done = case.granule(&["run", "time.ron"]);
        done.exits(0);
        assert!(done.out.contains("s expected, "), "{}", done.out);
    }

    #[test]
    fn nobody_reading_is_no_error() {
        let case = Case::new();
        let mut child = case
            .command(&["laws", "TangentialSpring"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        Done::of(child.wait_with_output().unwrap()).exits(0);
    }
}
