//! What is watched during a run, what is said where a limit is passed, and what is left to reproduce it.

use std::path::Path;
use std::process::{Command, Stdio};

/// Exit code, and what was said on standard error.
fn run(folder: &Path, text: &str, arguments: &[&str]) -> (Option<i32>, String) {
    std::fs::write(folder.join("scene.ron"), text).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_granule"));
    command.args(["run", "scene.ron", "--force"]).args(arguments).current_dir(folder).stdin(Stdio::null());
    let done = command.output().unwrap();
    (done.status.code(), String::from_utf8(done.stderr).unwrap())
}

/// A fast sphere that meets another one, and 50 more that have nothing to do with it.
fn impact(speed: f64, stiffness: f64, more: &str) -> String {
    let others: String = (0..50)
        .map(|k| {
            format!("Sphere(material: \"a\", radius: 1e-3, position: ({}, 0.02, 0)),", 0.0025 * f64::from(k))
        })
        .collect();
    format!(
        r#"(version: 1, materials: {{ "a": (density: 2500) }}, impact_speed: 0.1,
    bodies: [Sphere(material: "a", radius: 1e-3, position: (0, 0, 0), velocity: ({speed}, 0, 0)),
        Sphere(material: "a", radius: 1e-3, position: (0.0025, 0, 0)), {others}],
    contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: {stiffness}, restitution: 1))],
    {more})"#
    )
}

#[test]
fn an_overlap_beyond_its_limit_stops_the_run_or_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let more = "driver: TimeStep(step: 1e-6), run: (steps: 5000)";
    // δ = v √(m*/k) = 2 · √(5.2e-6/20) = 1.0e-3: as large as the radius.
    let (code, err) = run(folder.path(), &impact(2.1, 20.0, more), &[]);
    assert_eq!(code, Some(3), "{err}");
    for part in [
        "body 2 and body 1 overlap by 1.0",
        "of the smaller radius, more than 1, at step ",
        "body 1: position (",
        "touches body 2 (overlap 1.0",
        "likely cause: contacts too soft",
        "remedy: a larger stiffness",
        "the same happens in a scene of 2 bodies: out/scene/crash.ron",
    ] {
        assert!(err.contains(part), "{part}: {err}");
    }
    let capsule = std::fs::read_to_string(folder.path().join("out/scene/crash.ron")).unwrap();
    let (code, again) = run(folder.path(), &capsule, &["-o", "again"]);
    assert!(code == Some(3) && again.contains("overlap by 1.0"), "{again}");
    let with = |guards: &str| format!("{more}, guards: ({guards})");
    let (code, err) = run(folder.path(), &impact(2.1, 20.0, &with("overlap: Warn(0.5)")), &[]);
    assert_eq!(
        (code, err.matches("warning: body 2 and body 1 overlap by 0.5").count()),
        (Some(0), 1),
        "{err}"
    );
    let (code, err) = run(folder.path(), &impact(2.1, 20.0, &with("overlap: Off")), &[]);
    assert!(code == Some(0) && !err.contains("overlap"), "{err}");
    // Nothing is said about what is within its limit.
    let (code, err) = run(folder.path(), &impact(0.9, 20.0, &with("overlap: Stop(0.5)")), &[]);
    assert!(code == Some(0) && !err.contains("overlap"), "{err}");
}

#[test]
fn bodies_that_jump_are_lost_or_gain_energy_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let more = "driver: TimeStep(step: 1e-5), run: (steps: 3000), cell: (lo: (-0.1, -0.1, -0.1), hi: (0.2, 0.1, 0.1))";
    let (code, err) =
        run(folder.path(), &impact(-150.0, 1e3, &format!("{more}, guards: (travel: Stop(1))")), &[]);
    assert!(
        code == Some(3) && err.contains("body 1 moves 1.500 of the smallest radius in one step, more than 1"),
        "{err}"
    );
    // 0.3 m/s for 1024 steps of 1e-3 s.
    let slow = more.replace("1e-5", "1e-3").replace("3000", "1500");
    let (code, err) = run(folder.path(), &impact(-0.3, 1.0, &slow), &[]);
    assert!(
        code == Some(0) && err.contains("warning: the centre of body 1 is 207.200 radii outside of the cell"),
        "{err}"
    );
    let (code, err) =
        run(folder.path(), &impact(-0.3, 1.0, &format!("{slow}, guards: (lost: Stop(10))")), &[]);
    assert!(
        code == Some(3) && err.contains("radii outside of the cell, more than 10, at step 1024"),
        "{err}"
    );
    assert!(err.contains("likely cause: a gap between walls"), "{err}");
    // A contact of four steps: symplectic Euler is stable and wrong.
    let coarse = "driver: TimeStep(integrator: SymplecticEuler, step: 5e-5, packing_limit: false), run: (steps: 2000), \
                  guards: (energy: Stop(1e-4), overlap: Off)";
    let bodies = r#"Sphere(material: "a", radius: 1e-3, position: (0, 0, 0), frozen: true), Sphere(material: "a", radius: 1e-3, position: (0, 0, 2.1e-3))"#;
    let text = format!(
        r#"(version: 1, gravity: (0, 0, -9.81), materials: {{ "a": (density: 2500) }}, impact_speed: 0.1, bodies: [{bodies}],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e3, restitution: 1))], {coarse})"#
    );
    let (code, err) = run(folder.path(), &text, &[]);
    assert!(
        code == Some(3) && err.contains("the energy ledger misses") && err.contains("at step 1024"),
        "{err}"
    );
}

#[test]
fn wrong_guards_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let more = |guards: &str| format!("driver: TimeStep(step: 1e-6), run: (steps: 10), guards: ({guards})");
    for (guards, message) in [
        ("overlap: Stop", "`Stop` takes a limit"),
        ("overlap: Off(1)", "`Off` takes nothing"),
        ("overlap: Stop(0)", "greater than 0"),
        ("overlap: Halt(1)", "Halt"),
        ("overlaps: Off", "unknown field `overlaps`"),
        ("lost: Warn(1, 2)", "`Warn` takes one number"),
    ] {
        let (code, err) = run(folder.path(), &impact(0.1, 1e3, &more(guards)), &[]);
        assert!(code == Some(1) && err.contains(message), "{guards}: {err}");
    }
}
