//! A law that lives outside of this project registers, conforms and runs without any edit to ours, and a law that
//! `cargo xtask new-law` writes into it compiles, registers and fails its conformance test until it is filled in.
//!
//! Both build the whole program again, in a build folder of their own: a shared one would be locked by the cargo that
//! runs this test.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use xtask::new_law::{FILL_IN, Names, inside, outside};
use xtask::{files, tidy};

/// cargo in a folder, without network. No optimisation: building dominates.
fn cargo(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(xtask::command::cargo());
    command
        .args(words)
        .arg("--offline")
        .current_dir(folder)
        .env("CARGO_TARGET_DIR", build_folder())
        .env("CARGO_PROFILE_DEV_OPT_LEVEL", "0")
        .env("CARGO_PROFILE_DEV_DEBUG", "false")
        .env_remove("RUSTFLAGS");
    command
}

fn build_folder() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("external-law")
}

fn output(command: &mut Command) -> Output {
    command.output().expect("cargo can be run")
}

/// Both streams of a command that must succeed.
fn succeed(command: &mut Command) -> String {
    let output = output(command);
    let text = text(&output);
    assert!(output.status.success(), "{command:?}\n{text}");
    text
}

fn text(output: &Output) -> String {
    format!("{}\n{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// The conformance test of a fresh law fails, for want of its closed form and for nothing else.
fn fails_for_want_of_an_oracle(command: &mut Command) {
    let output = output(command);
    let text = text(&output);
    assert!(!output.status.success(), "a law without its closed form must fail:\n{text}");
    let failures: Vec<&str> = text.lines().filter(|line| line.contains(": check `")).collect();
    assert!(!failures.is_empty(), "{text}");
    assert!(failures.iter().all(|line| line.contains("oracle missing")), "{text}");
}

#[test]
fn a_law_from_outside_runs_without_an_edit_to_ours() {
    let root = files::root();
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let names = Names::parse("normal/quadratic-spring").unwrap();
    outside(&root, here, &names).unwrap();
    fails_for_want_of_an_oracle(&mut cargo(here, &["test", "-p", "quadratic-spring"]));

    let given = root.join("tests/external");
    std::fs::copy(given.join("quadratic_spring.rs"), here.join("quadratic-spring/src/quadratic_spring.rs"))
        .unwrap();
    std::fs::copy(given.join("scene.ron"), here.join("scene.ron")).unwrap();
    succeed(&mut cargo(here, &["test", "-p", "quadratic-spring"]));

    let program = |words: &[&str]| {
        let mut command = cargo(here, &["run", "-p", "quadratic-spring-granule"]);
        succeed(command.arg("--").args(words))
    };
    let laws = program(&["laws"]);
    for law in ["QuadraticSpring", "LinearSpringDashpot"] {
        assert!(laws.contains(law), "{laws}");
    }
    program(&["run", "scene.ron", "--output", "out", "--quiet"]);

    let table = granule_formats::csv::read(here.join("out/series.csv")).unwrap();
    let column = |name| table.column(name).unwrap_or_else(|| panic!("no column {name}"));
    let (energy, momentum, contacts) = (column("kinetic_energy"), column("momentum_x"), column("contacts"));
    let (mass, speed, coefficient) = (8e-6, 0.4, 1e9);
    let deepest = column("maximum_overlap").iter().copied().fold(0.0, f64::max);
    let expected = (1.5_f64 * mass * speed * speed / coefficient).cbrt();
    // 200 steps a contact: the scheme errs by about (pi/200)^2/24 = 1e-5, and the deepest point lies up to half a step from
    // a written one, where the overlap is smaller by up to 4e-5.
    assert!((deepest / expected - 1.0).abs() < 1e-4, "{deepest} {expected}");
    let step = column("time")[1] - column("time")[0];
    let touching = contacts.iter().filter(|contacts| **contacts > 0.0).count() as f64 * step;
    let duration = 2.0 * 1.402_182_105_325_454 * expected / speed;
    // Beginning and end are each known to a step.
    assert!((touching - duration).abs() <= 2.0 * step, "{touching} {duration}");
    let (first, last) = (energy[0], energy[energy.len() - 1]);
    assert!((last / first - 1.0).abs() < 1e-6, "an elastic contact gives back what it took: {first} {last}");
    assert!(momentum.iter().all(|value| (value - momentum[0]).abs() < 1e-20), "momentum is kept");
    assert_eq!(contacts[contacts.len() - 1], 0.0, "the bodies part");
}

#[test]
#[ignore = "slow: builds a copy of the whole project"]
fn a_new_law_compiles_registers_and_has_its_page() {
    let root = files::root();
    // Always the same place, so that builds do not pile up.
    let here = &Path::new(env!("CARGO_TARGET_TMPDIR")).join("new-law-project");
    if here.exists() {
        std::fs::remove_dir_all(here).unwrap();
    }
    for path in files::project(&root).unwrap() {
        files::write(&here.join(&path), "").unwrap();
        std::fs::copy(root.join(&path), here.join(&path)).unwrap();
    }
    let names = Names::parse("tangential/my-law").unwrap();
    inside(here, &names).unwrap();
    assert!(inside(here, &names).unwrap_err().message.contains("exists"));
    succeed(&mut cargo(here, &["run", "-p", "granule-tests", "--bin", "pages"]));
    fails_for_want_of_an_oracle(&mut cargo(here, &["test", "-p", "granule-law-my-law"]));
    let mut laws = cargo(here, &["run", "-p", "granule-cli"]);
    let laws = succeed(laws.args(["--", "laws", "MyLaw"]));
    assert!(laws.contains("tangential law") && laws.contains("gamma_t"), "{laws}");
    assert!(here.join("docs/laws/MyLaw.md").is_file());
    // What is left to do is what the author has to fill in, and nothing else.
    let problems = tidy::problems(here).unwrap();
    assert!(!problems.is_empty() && problems.iter().all(|problem| problem.contains(FILL_IN)), "{problems:?}");
}
