//! Collisions a second of gases of hard spheres in a periodic cube, on one core: `cargo xtask bench event`, or one gas with
//! `cargo xtask bench event N PHI E COLLISIONS [NEIGHBOURS AHEAD EVERY]`. E below 1 cools from the melted elastic gas.

#[path = "../tests/support/mod.rs"]
mod support;

use granule_events::{EventEngine, Tuning};
use support::{Plain, gas};

fn main() {
    let given: Vec<f64> = std::env::args().skip(1).filter_map(|text| text.parse().ok()).collect();
    let [n, phi, e, collisions, ..] = given[..] else {
        for (phi, e) in [(0.3, 1.0), (0.49, 1.0), (0.05, 0.9)] {
            for n in [1e4, 1e5, 1e6] {
                measure(n, phi, e, 2e6, Tuning::default());
            }
        }
        return;
    };
    let mut tuning = Tuning::default();
    if let [_, _, _, _, neighbours, ahead, every] = given[..] {
        tuning = Tuning { neighbours, ahead, renumber_every: every };
    }
    measure(n, phi, e, collisions, tuning);
}

fn measure(n: f64, phi: f64, e: f64, collisions: f64, tuning: Tuning) {
    let cells = (n / 4.0).cbrt().round() as usize;
    let mut setup = gas(cells, phi, Plain::smooth(1.0), 0.0, 1);
    let bodies = setup.bodies.len() as f64;
    let mut engine = EventEngine::with_tuning(&setup, tuning).expect("a gas");
    engine.advance_collisions((20.0 * bodies) as u64).expect("it melts");
    if e < 1.0 {
        for (body, state) in setup.bodies.iter_mut().zip(engine.states(engine.time())) {
            (body.position, body.velocity) = (state.position, state.velocity);
        }
        setup.rules = vec![std::sync::Arc::new(Plain::smooth(e))];
        setup.contact_duration = 1e-7;
        engine = EventEngine::with_tuning(&setup, tuning).expect("a gas");
    }
    let before = *engine.counts();
    let time = engine.time();
    let begin = std::time::Instant::now();
    engine.advance_collisions(collisions as u64).expect("it runs");
    let wall = begin.elapsed().as_secs_f64();
    let counts = engine.counts();
    println!(
        "N {bodies} phi {phi} e {e}: {:.0} collisions/s; rate a body {:.3}; {:.1} neighbours, {:.2} shells and {:.2} void a collision, \
         {} renumberings, {:.0} bytes a body",
        collisions / wall,
        2.0 * collisions / bodies / (engine.time() - time),
        engine.mean_neighbours(),
        (counts.relisted - before.relisted) as f64 / collisions,
        (counts.void - before.void) as f64 / collisions,
        counts.renumbered - before.renumbered,
        engine.bytes() as f64 / bodies
    );
}
