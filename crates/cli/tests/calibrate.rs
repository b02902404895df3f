//! `granule calibrate` from outside.

use std::fmt::Write as _;
use std::process::{Command, Output};

/// Runs the program on a file of that text.
fn calibrate(text: &str) -> Output {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("impacts.csv"), text).unwrap();
    Command::new(env!("CARGO_BIN_EXE_granule"))
        .current_dir(folder.path())
        .args(["calibrate", "impacts.csv"])
        .output()
        .unwrap()
}

fn line<'a>(output: &'a str, name: &str) -> &'a str {
    output.lines().find(|line| line.trim_start().starts_with(name)).expect(name)
}

/// The printed numbers of a line: value, error, lower and upper end of the interval.
fn numbers(output: &str, name: &str) -> [f64; 4] {
    let line = line(output, name);
    let (value, rest) = line.split_once(" +- ").expect(line);
    let (error, rest) = rest.split_once(' ').expect(line);
    let (_, interval) = rest.split_once(": ").expect(line);
    let (low, high) = interval.split_once(" to ").expect(line);
    let last = value.split_whitespace().last().expect(line);
    [last, error, low, high].map(|number| number.trim().parse().expect(line))
}

/// Normal, tangential and rebound velocities of solid spheres with e_n = 0.85, μ = 0.25 and e_t0 = 0.4 (Luding 1998, Eq. (21)), with
/// a scatter of a tenth of a percent that is the same in every run.
fn measured() -> String {
    let mut text = String::from(
        "normal_speed,tangential_velocity,rebound_normal_speed,rebound_tangential_velocity,radius,spin,rebound_spin\n",
    );
    for index in 0..40 {
        let (normal, psi) = (0.5 + 0.03 * f64::from(index % 7), 0.1 * f64::from(index + 1));
        let scatter = |k: i32| 1.0 + 2e-3 * ((f64::from(index * 3 + k) * 0.618_034).fract() - 0.5);
        let slip = psi * normal;
        let loss = 0.25 * 1.85 * 3.5 * normal;
        let after = (slip - loss).max(-0.4 * slip) * scatter(1);
        // 2/7 of the change of slip lie in the velocity of the centre, 5/7 in the spin.
        let velocity = slip + 2.0 / 7.0 * (after - slip);
        let spin = 5.0 / 7.0 * (after - slip) / 1e-3;
        writeln!(text, "{normal},{slip},{},{velocity},1e-3,0,{spin}", 0.85 * normal * scatter(2)).unwrap();
    }
    text
}

#[test]
fn parameters_of_measured_impacts_are_printed_with_their_intervals() {
    let output = calibrate(&measured());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}");
    assert!(text.starts_with("40 impacts: "), "{text}");
    for (name, truth) in [("restitution", 0.85), ("friction", 0.25), ("tangential_restitution", 0.4)] {
        let [value, error, low, high] = numbers(&text, name);
        assert!(low <= truth && truth <= high, "{name}: {text}");
        // The mean of 40 impacts with a scatter of at most 1e-3.
        assert!((value - truth).abs() < 3e-3 && error < 2e-3, "{name}: {text}");
    }
}

#[test]
fn what_the_impacts_do_not_determine_is_named() {
    let sliding = "psi1,psi2,restitution\n2,1.3,0.9\n3,2.31,0.9\n4,3.3,0.91\n5,4.3,0.9\n";
    let output = calibrate(sliding);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}");
    let found = line(&text, "tangential_restitution");
    assert!(found.contains("not determined") && found.contains("every impact slid"), "{text}");
    // 0.7 = μ 1.9 · 3.5.
    assert!((numbers(&text, "friction")[0] - 0.105).abs() < 1e-3, "{text}");
    let sticking = "psi1,psi2,restitution\n0.1,-0.05,0.9\n0.2,-0.1,0.9\n0.3,-0.151,0.91\n0.4,-0.2,0.9\n";
    let text = String::from_utf8(calibrate(sticking).stdout).unwrap();
    assert!(line(&text, "friction").contains("not determined"), "{text}");
    assert!((numbers(&text, "tangential_restitution")[0] - 0.5).abs() < 5e-3, "{text}");
}

#[test]
fn what_is_wrong_with_a_file_is_said_with_its_place() {
    for (text, message) in [
        ("psi1,psi2\n0.1,-0.05\n0.5,x7\n", "impacts.csv:3:5: found `x7`"),
        ("psi1,psi2\n# a remark\n0.1,-0.05\n0.5\n", "impacts.csv:4"),
        ("psi1,psi2\n0.1,-0.05\n-0.5,1\n", "impacts.csv: row 2 of the data: psi1 is -0.5"),
        ("psi1,speed\n0.1,-0.05\n", "column `speed`"),
    ] {
        let output = calibrate(text);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains(message), "{said}");
        assert!(output.stdout.is_empty());
    }
}
