//! Collisions a second of gases of hard spheres in a periodic cube, on one core: `cargo xtask bench event`, or one gas with
//! `cargo xtask bench event N PHI E COLLISIONS [NEIGHBOURS AHEAD EVERY] [--edmd FILE] [--dynamo FILE]`. All begin from the
//! equilibrium of the elastic fluid; E below 1 cools from there. The files hold that equilibrium for other programs.

#[path = "../tests/support/mod.rs"]
mod support;

use granule_events::{EventEngine, Setup, Tuning};
use support::{Plain, fluid};

fn main() {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let mut file = |option: &str| {
        let at = words.iter().position(|word| word == option)?;
        let rest = words.split_off(at);
        words.extend(rest.iter().skip(2).cloned());
        rest.into_iter().nth(1)
    };
    let (edmd, dynamo) = (file("--edmd"), file("--dynamo"));
    let given: Vec<f64> = words.iter().filter_map(|text| text.parse().ok()).collect();
    let [n, phi, e, collisions, ..] = given[..] else {
        eprintln!("four numbers are needed: spheres, volume fraction, restitution, collisions");
        std::process::exit(2);
    };
    let mut setup = fluid((n / 4.0).cbrt().round() as usize, phi, 1);
    for (file, text) in [(edmd, as_edmd as fn(&Setup, f64) -> String), (dynamo, as_dynamo)] {
        if let Some(path) = file {
            std::fs::write(path, text(&setup, e)).expect("a writable file");
        }
    }
    if e < 1.0 {
        setup.rules = vec![std::sync::Arc::new(Plain::smooth(e))];
        setup.contact_duration = 1e-7;
    }
    let tuning = match given[..] {
        [_, _, _, _, neighbours, ahead, renumber_every] => {
            Tuning { neighbours, ahead: Some(ahead), renumber_every }
        }
        _ => Tuning::default(),
    };
    measure(&setup, (phi, e), collisions, tuning);
}

fn measure(setup: &Setup, (phi, e): (f64, f64), collisions: f64, tuning: Tuning) {
    let bodies = setup.bodies.len() as f64;
    let held = resident();
    let mut engine = EventEngine::with_tuning(setup, tuning).expect("a gas");
    engine.advance_collisions((2.0 * bodies) as u64).expect("it runs");
    let before = *engine.counts();
    let time = engine.time();
    let begin = seconds();
    engine.advance_collisions(collisions as u64).expect("it runs");
    let spent = seconds() - begin;
    let counts = engine.counts();
    println!(
        "N {bodies} phi {phi} e {e}: {:.0} collisions/s; rate a body {:.3}; {:.1} neighbours, {:.2} shells and {:.2} void a collision, \
         {} renumberings; {:.0} bytes a body, {:.0} resident",
        collisions / spent,
        2.0 * collisions / bodies / (engine.time() - time),
        engine.mean_neighbours(),
        (counts.relisted - before.relisted) as f64 / collisions,
        (counts.void - before.void) as f64 / collisions,
        counts.renumbered - before.renumbered,
        engine.bytes() as f64 / bodies,
        (resident() - held) / bodies
    );
}

/// Resident bytes of this program; 0 where the system does not say.
fn resident() -> f64 {
    const PAGE: f64 = 4096.0;
    let pages = std::fs::read_to_string("/proc/self/statm")
        .ok()
        .and_then(|text| text.split_whitespace().nth(1)?.parse::<f64>().ok());
    PAGE * pages.unwrap_or(0.0)
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

/// As the lines of places and radii that EDMD reads.
fn as_edmd(setup: &Setup, _: f64) -> String {
    let side = setup.cell.period();
    let mut text = format!("{}\n{:.12} {:.12} {:.12}\n", setup.bodies.len(), side[0], side[1], side[2]);
    for body in &setup.bodies {
        let [x, y, z] = body.position;
        text.push_str(&format!("a {x:.14} {y:.14} {z:.14} {}\n", body.radius));
    }
    text
}

/// As a configuration of DynamO, whose box is centred; in units of the diameter.
fn as_dynamo(setup: &Setup, e: f64) -> String {
    let diameter = 2.0 * setup.bodies[0].radius;
    let [x, y, z] = setup.cell.period().map(|side| side / diameter);
    let mut text = format!(
        r#"<?xml version="1.0"?>
<DynamOconfig version="1.5.0"><Simulation><Scheduler Type="NeighbourList"><Sorter Type="BoundedPQMinMax3"/></Scheduler>
<SimulationSize x="{x:.14}" y="{y:.14}" z="{z:.14}"/>
<Genus><Species Mass="1" Name="Bulk" Type="Point"><IDRange Type="All"/></Species></Genus><BC Type="PBC"/><Topology/>
<Interactions><Interaction Type="HardSphere" Diameter="0.999999999999" Elasticity="{e}" Name="Bulk"><IDPairRange Type="All"/>
</Interaction></Interactions><Locals/><Globals/><SystemEvents/><Dynamics Type="Newtonian"/></Simulation><Properties/>
<ParticleData>
"#
    );
    let half = setup.cell.period().map(|side| 0.5 * side);
    for (id, body) in setup.bodies.iter().enumerate() {
        let [x, y, z]: [f64; 3] = std::array::from_fn(|k| (body.position[k] - half[k]) / diameter);
        let [u, v, w] = body.velocity;
        text.push_str(&format!(
            "<Pt ID=\"{id}\"><P x=\"{x:.15}\" y=\"{y:.15}\" z=\"{z:.15}\"/><V x=\"{u:.15}\" y=\"{v:.15}\" z=\"{w:.15}\"/></Pt>\n"
        ));
    }
    text.push_str("</ParticleData></DynamOconfig>\n");
    text
}
