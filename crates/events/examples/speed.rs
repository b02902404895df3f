//! Collisions a second of gases of hard spheres in a periodic cube, on one core: `cargo xtask bench event`, or one gas with
//! `cargo xtask bench event N PHI E COLLISIONS [NEIGHBOURS AHEAD EVERY] [--snapshot FILE]`. All begin from the equilibrium
//! of the elastic fluid; E below 1 cools from there. The snapshot holds that equilibrium for another program.

#[path = "../tests/support/mod.rs"]
mod support;

use granule_events::{EventEngine, Setup, Tuning};
use support::{Plain, fluid};

fn main() {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let snapshot = words.iter().position(|word| word == "--snapshot").map(|at| {
        let path = words.get(at + 1).cloned().unwrap_or_default();
        words.truncate(at);
        path
    });
    let given: Vec<f64> = words.iter().filter_map(|text| text.parse().ok()).collect();
    let [n, phi, e, collisions, ..] = given[..] else {
        for (phi, e) in [(0.3, 1.0), (0.49, 1.0), (0.05, 0.9)] {
            for n in [1e4, 1e5, 1e6] {
                measure(n, phi, e, 5.0 * n.min(4e5), None, None);
            }
        }
        return;
    };
    let tuning = match given[..] {
        [_, _, _, _, neighbours, ahead, renumber_every] => {
            Some(Tuning { neighbours, ahead: Some(ahead), renumber_every })
        }
        _ => None,
    };
    measure(n, phi, e, collisions, tuning, snapshot.as_deref());
}

fn measure(n: f64, phi: f64, e: f64, collisions: f64, tuning: Option<Tuning>, snapshot: Option<&str>) {
    let tuning = tuning.unwrap_or_default();
    let mut setup = fluid((n / 4.0).cbrt().round() as usize, phi, 1);
    if let Some(path) = snapshot {
        write(&setup, path);
    }
    let bodies = setup.bodies.len() as f64;
    if e < 1.0 {
        setup.rules = vec![std::sync::Arc::new(Plain::smooth(e))];
        setup.contact_duration = 1e-7;
    }
    let mut engine = EventEngine::with_tuning(&setup, tuning).expect("a gas");
    engine.advance_collisions((2.0 * bodies) as u64).expect("it runs");
    let before = *engine.counts();
    let time = engine.time();
    let begin = seconds();
    engine.advance_collisions(collisions as u64).expect("it runs");
    let spent = seconds() - begin;
    let counts = engine.counts();
    println!(
        "N {bodies} phi {phi} e {e}: {:.0} collisions/s; rate a body {:.3}; {:.1} neighbours, {:.2} shells and {:.2} void a collision, \
         {} renumberings, {:.0} bytes a body",
        collisions / spent,
        2.0 * collisions / bodies / (engine.time() - time),
        engine.mean_neighbours(),
        (counts.relisted - before.relisted) as f64 / collisions,
        (counts.void - before.void) as f64 / collisions,
        counts.renumbered - before.renumbered,
        engine.bytes() as f64 / bodies
    );
}

/// Time that this program has had a processor \[s\], or wall time where the system does not say.
fn seconds() -> f64 {
    let on_processor = std::fs::read_to_string("/proc/self/schedstat")
        .ok()
        .and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    on_processor.map_or_else(
        || {
            let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
            now.map_or(0.0, |since| since.as_secs_f64())
        },
        |nanoseconds| 1e-9 * nanoseconds,
    )
}

/// As the lines of places and radii that event-driven codes of the field read.
fn write(setup: &Setup, path: &str) {
    let side = setup.cell.period();
    let mut text = format!("{}\n{:.12} {:.12} {:.12}\n", setup.bodies.len(), side[0], side[1], side[2]);
    for body in &setup.bodies {
        let [x, y, z] = body.position;
        text.push_str(&format!("a {x:.14} {y:.14} {z:.14} {}\n", body.radius));
    }
    std::fs::write(path, text).expect("a writable snapshot");
}
