//! A long run needs no more memory than a short one.
#![cfg(target_os = "linux")]

use std::path::Path;
use std::sync::atomic::AtomicBool;

use granule::prelude::*;

/// A shaken bed, with outputs and checkpoints.
fn scene(bodies: usize, steps: u64, often: u64) -> String {
    format!(
        r#"(version: 1, seed: 7, gravity: (0, 0, -9.81), materials: {{ "a": (density: 2500) }},
    cell: (lo: (0, 0, 0), hi: ("20 mm", "20 mm", inf), periodic: (true, true, false)),
    bodies: [Fill(material: "a", radius: Uniform(min: "0.4 mm", max: "0.6 mm"), count: {bodies},
        lo: (0, 0, 0), hi: ("20 mm", "20 mm", "60 mm"), velocity: (0, 0, -0.8), velocity_spread: 0.1)],
    walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a",
        motion: Sinusoidal(amplitude: (0, 0, "0.5 mm"), frequency: "60 Hz")) }},
    contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e3, restitution: 0.7),
        tangential: TangentialSpring(stiffness: 285, friction: 0.5))],
    driver: TimeStep(step: "4 us"), run: (steps: {steps}), checkpoint: (every: {often}),
    outputs: [
        Series(path: "series.csv", every: 100, columns: ["kinetic_energy", "contacts", "energy_residual"]),
        LammpsDump(path: "bed.dump", every: {often}),
        Vtk(path: "vtk/bed", every: {often}),
    ])"#
    )
}

/// Memory of this process now \[kB\].
fn memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches(" kB").parse().unwrap()
}

/// Memory by step.
#[derive(Default)]
struct Meter {
    seen: Vec<(u64, u64)>,
}

impl Progress for Meter {
    fn begin(&mut self, _: &Outlook<'_>) {}
    fn advance(&mut self, status: &Status) {
        self.seen.push((status.step, memory()));
    }
    fn end(&mut self, _: &Status) {}
}

/// Largest memory \[kB\] in the middle of a run, and afterwards.
fn largest(folder: &Path, bodies: usize, steps: u64) -> (u64, u64) {
    let path = folder.join("bed.ron");
    std::fs::write(&path, scene(bodies, steps, steps / 50)).unwrap();
    let (mut meter, never) = (Meter::default(), AtomicBool::new(false));
    let options = RunOptions {
        output_dir: Some(folder.join("out")),
        threads: None,
        force: false,
        progress: &mut meter,
        stop: &never,
        max_time: None,
    };
    let summary = granule::run(&path, options).unwrap();
    assert_eq!(summary.ending, Ending::Completed);
    let most = |from: u64, to: u64| {
        let within = meter.seen.iter().filter(|(step, _)| (from..to).contains(step));
        within.map(|(_, memory)| *memory).max().unwrap()
    };
    for tenth in 0..10 {
        let (from, to) = (tenth * steps / 10, (tenth + 1) * steps / 10);
        println!("steps {from} to {to}: at most {} kB", most(from, to));
    }
    println!(
        "{:.2e} particle-steps in {:.0} s, residual of the energy ledger {:.1e} of the energy turned over",
        bodies as f64 * steps as f64,
        summary.wall.as_secs_f64(),
        summary.energy_drift.unwrap().relative()
    );
    (most(2 * steps / 5, 3 * steps / 5), most(3 * steps / 5, steps + 1))
}

/// The bed is loose at first, and lists get room as it settles: memory is compared from the middle of the run on.
fn flat(bodies: usize, steps: u64) {
    let folder = tempfile::tempdir().unwrap();
    let (early, late) = largest(folder.path(), bodies, steps);
    // Lists follow the density by a few per cent, and the allocator keeps what it had.
    assert!(late as f64 <= 1.05 * early as f64, "{early} kB, then {late} kB");
}

#[test]
fn memory_is_flat() {
    flat(2000, 20_000);
}

#[test]
#[ignore = "slow: 10^9 particle-steps"]
fn memory_is_flat_over_a_billion_particle_steps() {
    flat(10_000, 100_000);
}
