//! Runs that are interrupted in every way and continued: files and result are those of a run that never was.
#![cfg(unix)]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

/// A pile that forms between a shaken floor and periodic sides, with every kind of output, for `steps` steps.
fn scene(steps: u64, checkpoint: &str) -> String {
    format!(
        r#"(version: 1, seed: 7, gravity: (0, 0, -9.81), materials: {{ "a": (density: 2500) }},
    cell: (lo: (0, 0, 0), hi: ("6 mm", "6 mm", "40 mm"), periodic: (true, true, false)),
    bodies: [Fill(material: "a", radius: Uniform(min: "0.4 mm", max: "0.6 mm"), count: 200,
        lo: (0, 0, 0), hi: ("6 mm", "6 mm", "16 mm"), velocity: (0, 0, -0.5), velocity_spread: 0.2)],
    walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a",
        motion: Sinusoidal(amplitude: (0, 0, "0.2 mm"), frequency: "200 Hz")) }},
    contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e3, restitution: 0.7),
        tangential: TangentialSpring(stiffness: 285, friction: 0.5, damping: 1e-3))],
    driver: TimeStep(step: "5 us", threads: 1), run: (steps: {steps}), {checkpoint}
    outputs: [
        Series(path: "series.csv", columns: ["kinetic_energy", "energy_residual", "contacts"], every: 37),
        Bodies(path: "deep/bodies.csv", ids: [2, 77], every: 101),
        LammpsDump(path: "pile.dump", every: 500),
        Vtk(path: "vtk/pile", every: 1000),
        LammpsData(path: "last.data"),
        Layer(path: "layer.csv", every: 400),
        PairCorrelation(path: "pairs.csv", range: "2 mm", bins: 20, every: 900),
        Impacts(path: "impacts.csv", reach: "1 mm", every: 10),
    ])"#
    )
}

/// Hard spheres that fly, for `steps` steps.
fn hard(steps: u64, checkpoint: &str) -> String {
    format!(
        r#"(version: 1, seed: 7, materials: {{ "a": (density: 2500) }},
    cell: (lo: (0, 0, 0), hi: ("12 mm", "12 mm", "12 mm"), periodic: (true, true, true)),
    bodies: [Lattice(material: "a", radius: "0.4 mm", spacing: "1 mm", lo: (0, 0, 0), hi: ("11.9 mm", "11.9 mm", "11.9 mm"),
        velocity_spread: 0.2)],
    contacts: [(between: ("a", "a"), collision: HardSphere(restitution: 1))],
    driver: Event(step: "0.1 ms"), run: (steps: {steps}), {checkpoint}
    outputs: [
        Series(path: "series.csv", columns: ["kinetic_energy", "collisions", "momentum_x"], every: 10),
        Bodies(path: "bodies.csv", ids: [2, 77], every: 11),
        LammpsDump(path: "gas.dump", every: 1000),
    ])"#
    )
}

/// Checkpoints after every 500 steps and after every 20 ms of the clock.
const OFTEN: &str = r#"checkpoint: (every: 500, wall: "20 ms"),"#;

struct Case {
    folder: tempfile::TempDir,
}

impl Case {
    fn new(steps: u64, checkpoint: &str) -> Self {
        let case = Self { folder: tempfile::tempdir().unwrap() };
        std::fs::write(case.path("pile.ron"), scene(steps, checkpoint)).unwrap();
        case
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The program, with a fixed moment in its files.
    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_granule"));
        command.args(arguments).current_dir(self.folder.path()).env("SOURCE_DATE_EPOCH", "1764000000");
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn granule(&self, arguments: &[&str]) -> Done {
        Done::of(self.command(arguments).output().unwrap())
    }

    fn spawn(&self, arguments: &[&str]) -> Child {
        self.command(arguments).spawn().unwrap()
    }
}

struct Done {
    code: Option<i32>,
    out: String,
    err: String,
}

impl Done {
    fn of(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }

    fn exits(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{}{}", self.out, self.err);
        self
    }

    /// The lines of the summary that tell results: hash and energy drift.
    fn result(&self) -> Vec<&str> {
        let lines = self.out.lines();
        lines.filter(|line| line.starts_with("result hash") || line.starts_with("energy drift")).collect()
    }
}

fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

/// All files below a folder but the manifest, with their content, by path.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name().unwrap() != "manifest.json" {
                found.push((path.strip_prefix(folder).unwrap().to_path_buf(), std::fs::read(&path).unwrap()));
            }
        }
    }
    found.sort();
    found
}

fn same(found: &Path, wanted: &Path) {
    let (found, wanted) = (files(found), files(wanted));
    let names = |files: &[(PathBuf, Vec<u8>)]| files.iter().map(|file| file.0.clone()).collect::<Vec<_>>();
    assert_eq!(names(&found), names(&wanted));
    for ((name, found), (_, wanted)) in found.iter().zip(&wanted) {
        assert!(found == wanted, "{} differs", name.display());
    }
}

/// Does the manifest there say that the run came to its end?
fn complete(folder: &Path) -> bool {
    let manifest = std::fs::read_to_string(folder.join("manifest.json")).unwrap_or_default();
    manifest.contains(r#""outcome": "completed""#)
}

fn checkpoints(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut found: Vec<PathBuf> =
        paths.filter(|path| path.extension().is_some_and(|e| e == "granule")).collect();
    found.sort();
    found
}

/// Kills a run at random moments until it has been killed so often, and continues it each time. Whatever a killed run has
/// written into files that grow is the beginning of what an uninterrupted run writes.
fn kill_loop(text: &str, kills: u32, longest: u64) {
    let case = Case::new(1, "");
    std::fs::write(case.path("pile.ron"), text).unwrap();
    let whole = case.granule(&["run", "pile.ron", "-o", "whole"]).exits(0);
    let reference = files(&case.path("whole"));
    let folder = case.path("part");
    let (mut killed, mut resumed, mut completed, mut step) = (0, 0, 0, String::new());
    let mut random = 0x9E37_79B9_7F4A_7C15_u64;
    while killed < kills || completed == 0 {
        let fresh = checkpoints(&folder).is_empty();
        let mut child = if fresh {
            step.clear();
            case.spawn(&["run", "pile.ron", "-o", "part", "--force"])
        } else {
            resumed += 1;
            case.spawn(&["resume", "part", "--threads", if killed % 2 == 0 { "1" } else { "2" }])
        };
        if killed < kills {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            std::thread::sleep(Duration::from_millis((random >> 33) % longest));
        }
        let ended = child.try_wait().unwrap().is_some();
        if killed < kills && !ended {
            signal(&child, "-KILL");
            child.wait().unwrap();
            killed += 1;
            // The moment may lie between the end of the run, which its manifest tells, and that of the process.
            if complete(&folder) {
                checkpoints(&folder).iter().for_each(|path| std::fs::remove_file(path).unwrap());
                same(&folder, &case.path("whole"));
                completed += 1;
                std::fs::remove_dir_all(&folder).unwrap();
                continue;
            }
        } else {
            let done = Done::of(child.wait_with_output().unwrap()).exits(0);
            assert_eq!(done.result(), whole.result());
            same(&folder, &case.path("whole"));
            completed += 1;
            std::fs::remove_dir_all(&folder).unwrap();
            continue;
        }
        let latest = checkpoints(&folder).pop().map_or(String::new(), |path| path.display().to_string());
        assert!(latest >= step, "a killed run loses no checkpoint: {latest} after {step}");
        step = latest;
        let grows = |path: &Path| {
            let name = path.to_str().unwrap();
            (name.ends_with(".csv") || name.ends_with(".dump")) && name != "impacts.csv"
        };
        for (name, all) in reference.iter().filter(|(path, _)| grows(path)) {
            let Ok(written) = std::fs::read(folder.join(name)) else { continue };
            assert!(all.starts_with(&written), "{} after {killed} kills", name.display());
        }
    }
    println!(
        "{killed} kills, {resumed} continuations, {completed} runs completed with the files of an uninterrupted one"
    );
}

#[test]
fn killed_at_random_moments() {
    kill_loop(&scene(12_000, OFTEN), 8, 300);
}

#[test]
fn hard_spheres_killed_at_random_moments() {
    kill_loop(&hard(6000, OFTEN), 5, 700);
}

#[test]
#[ignore = "slow: 200 runs of up to a second"]
fn killed_two_hundred_times_at_random_moments() {
    kill_loop(&scene(40_000, OFTEN), 150, 500);
    kill_loop(&hard(20_000, OFTEN), 50, 1000);
}

/// Signals and the end of `--max-time` keep the state; outputs have an entry of that moment, which the continued run takes
/// back.
#[test]
fn stopped_and_continued() {
    let case = Case::new(60_000, "");
    let whole = case.granule(&["run", "pile.ron", "-o", "whole"]).exits(0);
    for name in ["-INT", "-TERM"] {
        let folder = case.path("part");
        let child = case.spawn(&["run", "pile.ron", "-o", "part"]);
        while !folder.join("deep/bodies.csv").exists() {
            std::thread::sleep(Duration::from_millis(5));
        }
        std::thread::sleep(Duration::from_millis(100));
        signal(&child, name);
        let done = Done::of(child.wait_with_output().unwrap()).exits(130);
        assert!(done.err.contains("`granule resume part` continues the run"), "{}", done.err);
        assert_eq!(checkpoints(&folder).len(), 1);
        // Nobody begins anew by accident.
        let done = case.granule(&["run", "pile.ron", "-o", "part"]).exits(3);
        assert!(
            done.err.contains("holds a run that was interrupted: continue it with `granule resume part`"),
            "{}",
            done.err
        );
        let done = case.granule(&["resume", "part", "--max-time", "0.05"]).exits(4);
        assert!(
            done.err.contains("continued at step") && done.err.contains("the time is over"),
            "{}",
            done.err
        );
        let done = case.granule(&["resume", "part", "--threads", "3"]).exits(0);
        assert_eq!(done.result(), whole.result());
        same(&folder, &case.path("whole"));
        let done = case.granule(&["resume", "part"]).exits(1);
        assert!(
            done.err.contains("no checkpoint to continue from; its manifest says: completed"),
            "{}",
            done.err
        );
        std::fs::remove_dir_all(&folder).unwrap();
    }
    assert!(case.granule(&["resume", "nowhere"]).exits(3).err.contains("nowhere"));
    std::fs::create_dir(case.path("empty")).unwrap();
    assert!(case.granule(&["resume", "empty"]).exits(1).err.contains("no run was begun there"));
}

/// Checkpoints and outputs change no bit.
#[test]
fn the_same_result_with_and_without_checkpoints_and_outputs() {
    let hash = |text: &str| {
        let case = Case::new(1, "");
        std::fs::write(case.path("pile.ron"), text).unwrap();
        let done = case.granule(&["run", "pile.ron", "-o", "out"]).exits(0);
        done.result().iter().find(|line| line.starts_with("result hash")).unwrap().to_string()
    };
    let often = scene(6000, r#"checkpoint: (every: 7),"#);
    let alone = often[..often.find("outputs").unwrap()].to_string() + ")";
    let never = scene(6000, "checkpoint: Never,");
    assert_eq!(hash(&often), hash(&never));
    assert_eq!(hash(&alone), hash(&never));
}

/// What a stopped run leaves, to be damaged.
fn stopped(case: &Case) -> (PathBuf, Vec<PathBuf>) {
    case.granule(&["run", "pile.ron", "-o", "part", "--max-time", "0.25"]).exits(4);
    let folder = case.path("part");
    // A machine that is busy with other things gets no further than the first.
    while checkpoints(&folder).len() < 2 {
        case.granule(&["resume", "part", "--max-time", "0.25"]).exits(4);
    }
    let all = checkpoints(&folder);
    assert_eq!(all.len(), 2, "two are kept");
    (folder, all)
}

#[test]
fn a_damaged_checkpoint_is_passed_over_or_refused() {
    let case = Case::new(60_000, r#"checkpoint: (every: 500),"#);
    let whole = case.granule(&["run", "pile.ron", "-o", "whole"]).exits(0);
    let (folder, all) = stopped(&case);
    let good = std::fs::read(&all[1]).unwrap();
    let older = std::fs::read(&all[0]).unwrap();
    let flipped = |bytes: &[u8]| {
        let mut bytes = bytes.to_vec();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        bytes
    };
    let mut other = good.clone();
    other[12] = 99;
    for (content, reason) in [
        (&good[..good.len() / 2], "cut short or damaged"),
        (&flipped(&good), "its checksum is wrong"),
        (b"step,time\n", "it is no checkpoint of granule"),
        (b"", "it is empty"),
        (&other, "it has layout 99"),
    ] {
        std::fs::write(&all[0], flipped(&older)).unwrap();
        std::fs::write(&all[1], content).unwrap();
        let done = case.granule(&["resume", "part"]).exits(1);
        assert!(done.err.contains(reason), "{}", done.err);
        assert_eq!(done.err.matches("cannot be used").count(), 2, "both are named: {}", done.err);
    }
    std::fs::write(&all[0], &older).unwrap();
    let done = case.granule(&["resume", "part"]).exits(0);
    assert!(
        done.err.contains("it has layout 99") && done.err.contains("the checkpoint before is taken"),
        "{}",
        done.err
    );
    assert_eq!(done.result(), whole.result());
    same(&folder, &case.path("whole"));
}

#[test]
fn outputs_that_are_not_as_they_were_are_refused() {
    let case = Case::new(60_000, r#"checkpoint: (every: 500),"#);
    let (folder, _) = stopped(&case);
    let series = std::fs::read(folder.join("series.csv")).unwrap();
    std::fs::write(folder.join("series.csv"), &series[..200]).unwrap();
    let done = case.granule(&["resume", "part"]).exits(1);
    assert!(
        done.err.contains("series.csv` cannot be used: it is not what this run has written"),
        "{}",
        done.err
    );
    std::fs::write(folder.join("series.csv"), &series).unwrap();
    std::fs::remove_file(folder.join("vtk/pile_000001.vtp")).unwrap();
    let done = case.granule(&["resume", "part"]).exits(1);
    assert!(done.err.contains("pile.pvd` cannot be used"), "{}", done.err);
}

/// A second run waits for nobody and destroys nothing.
#[test]
fn one_run_a_folder() {
    let case = Case::new(10_000_000, OFTEN);
    let mut child = case.spawn(&["run", "pile.ron", "-o", "part"]);
    while checkpoints(&case.path("part")).is_empty() {
        std::thread::sleep(Duration::from_millis(5));
    }
    let done = case.granule(&["resume", "part"]).exits(3);
    assert!(done.err.contains("another run is writing into part"), "{}", done.err);
    let done = case.granule(&["run", "pile.ron", "-o", "part", "--force"]).exits(3);
    assert!(done.err.contains("another run is writing into part"), "{}", done.err);
    signal(&child, "-KILL");
    child.wait().unwrap();
}

/// True if files may be made in a folder that forbids it, as for the superuser.
fn rules_are_void(folder: &Path) -> bool {
    std::fs::write(folder.join("try"), "").is_ok_and(|()| std::fs::remove_file(folder.join("try")).is_ok())
}

#[test]
fn a_folder_that_may_not_be_written() {
    use std::os::unix::fs::PermissionsExt;
    let case = Case::new(60_000, r#"checkpoint: (every: 500),"#);
    let (folder, all) = stopped(&case);
    let mode =
        |path: &Path, mode| std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode)).unwrap();
    mode(&folder, 0o555);
    let command = case.command(&["resume", "part"]);
    let command = if rules_are_void(&folder) {
        // The superuser may write everywhere: somebody else tries.
        mode(case.folder.path(), 0o755);
        let mut other = Command::new("setpriv");
        other.args(["--reuid=65534", "--clear-groups"]).arg(command.get_program()).args(command.get_args());
        other.current_dir(case.folder.path()).stdin(Stdio::null());
        other
    } else {
        command
    };
    let before = files(&folder);
    let mut command = command;
    let Ok(output) = command.output() else {
        println!("not tried: there is no setpriv, and the superuser may write everywhere");
        return;
    };
    let done = Done::of(output);
    assert!(matches!(done.code, Some(1 | 3)) && done.err.contains("ermission denied"), "{}", done.err);
    assert!(files(&folder) == before, "nothing has changed");
    mode(&folder, 0o755);
    assert_eq!(checkpoints(&folder), all);
    case.granule(&["resume", "part"]).exits(0);
}

/// A disk that is full ends the run with a message; when there is room again it goes on.
#[test]
fn a_full_disk() {
    let case = Case::new(20_000, OFTEN);
    let whole = case.granule(&["run", "pile.ron", "-o", "whole"]).exits(0);
    std::fs::create_dir(case.path("disk")).unwrap();
    let script = r#"mount -t tmpfs -o size=400k tmpfs disk || exit 77
        "$0" run pile.ron -o disk/part; echo "code $?"; ls disk/part/*.granule | wc -l
        mount -o remount,size=64m disk || exit 77
        "$0" resume disk/part; echo "code $?"; cp -r disk/part part"#;
    let mut command = Command::new("unshare");
    command.args(["--mount", "--user", "--map-root-user", "sh", "-c", script, env!("CARGO_BIN_EXE_granule")]);
    command.current_dir(case.folder.path()).env("SOURCE_DATE_EPOCH", "1764000000").stdin(Stdio::null());
    let output = command.output();
    let done = match output {
        Ok(output) if !matches!(output.status.code(), Some(1 | 77)) => Done::of(output).exits(0),
        _ => {
            println!("not tried: this machine mounts nothing for its users");
            return;
        }
    };
    assert!(done.out.starts_with("code 3\n"), "{}{}", done.out, done.err);
    assert!(done.err.contains("No space left on device"), "{}", done.err);
    assert!(done.out.ends_with("code 0\n"), "{}{}", done.out, done.err);
    assert_eq!(done.result(), whole.result());
    same(&case.path("part"), &case.path("whole"));
}
