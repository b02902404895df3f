//! One pass of time integration over a tile: `cargo bench -p granule-integrators`.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use granule_integrators::{Tile, integrator};
use granule_state::{InstructionSet, Row};

fn main() {
    divan::main();
}

/// Bodies of a tile: its rows fit into the second level cache.
const BODIES: usize = 2048;

#[divan::bench(args = ["VelocityVerlet", "ClassicVelocityVerlet", "ContactResolved", "Leapfrog", "SymplecticEuler"])]
fn finish_and_begin(bencher: Bencher, name: &str) {
    let scheme = integrator(name).expect("a scheme of that name");
    let rows = |value: f64| vec![Row([value, -value, 0.5 * value, 1.0]); BODIES];
    let [mut position, mut velocity, mut spin] = [rows(1.0), rows(1e-3), rows(1e-2)];
    let [force, torque] = [rows(1e-6), rows(1e-6)];
    let remembered = if scheme.needs_previous() { BODIES } else { 0 };
    let mut previous = vec![Row([0.0; 4]); remembered];
    let mut previous_angular = previous.clone();
    let remembered = if scheme.needs_predicted() { BODIES } else { 0 };
    let mut predicted = vec![Row([0.0; 4]); remembered];
    let mut predicted_angular = predicted.clone();
    bencher.counter(ItemsCount::new(BODIES)).bench_local(|| {
        let mut tile = Tile {
            position: &mut position,
            velocity: &mut velocity,
            force: &force,
            spin: &mut spin,
            torque: &torque,
            previous: &mut previous,
            previous_angular: &mut previous_angular,
            predicted: &mut predicted,
            predicted_angular: &mut predicted_angular,
            planar_inverse_inertia: &[],
            planar: false,
            instructions: InstructionSet::detect(),
        };
        black_box(scheme.finish_begin(&mut tile, black_box(1e-9)))
    });
}
