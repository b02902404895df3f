//! Scenes that somebody else wrote: what they may read, hold and take is bounded.

use std::path::Path;
use std::process::{Command, Stdio};

/// A gas of `count` spheres for `steps` steps.
fn gas(count: usize, steps: u64) -> String {
    format!(
        r#"(version: 1, materials: {{ "a": (density: 2500) }},
    cell: (lo: (0, 0, 0), hi: ("100 mm", "100 mm", "100 mm"), periodic: (true, true, true)),
    bodies: [Fill(material: "a", radius: "0.2 mm", count: {count}, lo: (0, 0, 0), hi: ("100 mm", "100 mm", "100 mm"),
        velocity_spread: 0.1)],
    contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e3, restitution: 0.9))],
    driver: TimeStep(step: "1 us"), run: (steps: {steps}),
    outputs: [Series(path: "series.csv", columns: ["kinetic_energy"], every: 100)])"#
    )
}

/// Exit code and what was said.
fn granule(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_granule"));
    let done = command.current_dir(folder).args(arguments).stdin(Stdio::null()).output().unwrap();
    (done.status.code(), String::from_utf8(done.stderr).unwrap())
}

#[test]
fn too_many_bodies_for_the_memory_are_refused_before_they_are_made() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("gas.ron"), gas(5_000_000, 10)).unwrap();
    for command in ["run", "check", "explain", "trade", "advise"] {
        let (code, err) = granule(folder.path(), &[command, "gas.ron", "--max-memory", "1GiB"]);
        assert_eq!(code, Some(1), "{command}: {err}");
        // 16 MiB and 950 bytes a body.
        assert!(
            err.contains("5000000 bodies need about 4.4 GiB of memory, more than the 1 GiB that are allowed"),
            "{err}"
        );
    }
    std::fs::write(folder.path().join("gas.ron"), gas(1000, 10)).unwrap();
    assert_eq!(granule(folder.path(), &["run", "gas.ron", "--max-memory", "20MB"]).0, Some(0));
    let (code, err) = granule(folder.path(), &["run", "gas.ron", "--max-memory", "20 apples"]);
    assert!(code == Some(2) && err.contains("a size is a number of bytes"), "{err}");
}

#[test]
fn a_run_ends_when_its_time_is_over_and_its_outputs_are_whole() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("gas.ron"), gas(1000, 1_000_000_000)).unwrap();
    let (code, err) = granule(folder.path(), &["run", "gas.ron", "--max-time", "1.5 s"]);
    assert!(code == Some(4) && err.contains("the time is over at step"), "{err}");
    let manifest = std::fs::read_to_string(folder.path().join("out/gas/manifest.json")).unwrap();
    assert!(manifest.contains("stopped when its time was over"), "{manifest}");
    let series = granule::parts::formats::csv::read(folder.path().join("out/gas/series.csv")).unwrap();
    let steps = series.column("step").unwrap();
    assert!(steps.len() >= 2 && steps.windows(2).all(|pair| pair[0] < pair[1]), "{steps:?}");
    // A run that is done in time does not notice.
    std::fs::write(folder.path().join("short.ron"), gas(10, 100)).unwrap();
    assert_eq!(granule(folder.path(), &["run", "short.ron", "--max-time", "1 h"]).0, Some(0));
    for wrong in ["0", "-1", "soon", "5 m"] {
        assert_eq!(granule(folder.path(), &["run", "short.ron", "--max-time", wrong]).0, Some(2), "{wrong}");
    }
}

#[test]
fn data_files_lie_beside_the_scene_unless_they_may_lie_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let data = "x\n\n1 atoms\n1 atom types\n0 1 xlo xhi\n0 1 ylo yhi\n0 1 zlo zhi\n\nAtoms\n\n1 1 0.1 2500 0.5 0.5 0.5\n";
    std::fs::write(folder.path().join("one.data"), data).unwrap();
    std::fs::create_dir_all(folder.path().join("mine/below")).unwrap();
    std::fs::write(folder.path().join("mine/below/one.data"), data).unwrap();
    let write = |file: &str| {
        let text = format!(
            r#"(version: 1, materials: {{ "a": (density: 2500) }},
    bodies: [Import(file: "{file}", format: LammpsData, materials: {{ 1: "a" }})],
    contacts: [], driver: TimeStep(step: "1 us"), run: (steps: 2))"#
        );
        std::fs::write(folder.path().join("mine/scene.ron"), text).unwrap();
    };
    let outside = folder.path().join("one.data");
    write("below/one.data");
    let (code, err) = granule(folder.path(), &["run", "mine/scene.ron"]);
    assert_eq!(code, Some(0), "{err}");
    for file in
        ["../one.data", "below/../../one.data", outside.to_str().unwrap(), "/etc/hostname", "/dev/zero"]
    {
        write(file);
        for command in ["run", "check", "advise"] {
            let (code, err) = granule(folder.path(), &[command, "mine/scene.ron"]);
            assert_eq!(code, Some(1), "{file}");
            assert!(err.contains("is outside of the folder of the scene"), "{err}");
        }
    }
    write("../one.data");
    assert_eq!(granule(folder.path(), &["run", "mine/scene.ron", "--data-anywhere"]).0, Some(0));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&outside, folder.path().join("mine/link.data")).unwrap();
        write("link.data");
        let (code, err) = granule(folder.path(), &["check", "mine/scene.ron"]);
        assert!(code == Some(1) && err.contains("outside of the folder"), "{err}");
        // A pipe that nobody writes to would be read for ever.
        let made = Command::new("mkfifo").arg(folder.path().join("mine/pipe")).status().unwrap();
        assert!(made.success());
        write("pipe");
        let (code, err) = granule(folder.path(), &["check", "mine/scene.ron"]);
        assert!(code == Some(1) && err.contains("is no regular file"), "{err}");
    }
}
