//! The stage over one batch of contacts: `cargo bench -p granule-law-normal-power`.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use granule_law_api::testing::Contacts;
use granule_law_api::{Conventions, LawEntry, PairContext, Params, Registry};
use granule_law_normal_power as _;

fn main() {
    divan::main();
}

/// Contacts that the engine gathers before it runs the stages.
const BATCH: usize = 64;

/// Contacts of a resting packing: small overlaps, slow slip.
fn contacts(law: &LawEntry) -> Contacts<f64> {
    let mut contacts = Contacts::new(BATCH, law.info.history_width());
    contacts.overlap.fill(1e-7);
    contacts.normal_velocity.fill(1e-5);
    contacts.tangential_velocity[1].fill(1e-5);
    contacts.reduced_mass.fill(6.5e-7);
    contacts.reduced_radius.fill(2.5e-4);
    contacts.normal_force.fill(1e-4);
    contacts
}

fn run(bencher: Bencher, name: &str, given: &[(&str, f64)]) {
    let registry = Registry::collect().expect("one registry");
    let law = registry.get(name).expect("a law of this crate");
    let context = PairContext {
        conventions: Conventions::LAMMPS_CLASSIC,
        ..PairContext::single(6.5e-7, 2.5e-4, 0.4, 0.1)
    };
    let stage = Params::new(law.info, given).map(|params| (law.compile_f64)(&params, &context));
    let stage = stage.expect("valid parameters").expect("a stage");
    let mut contacts = contacts(law);
    bencher.counter(ItemsCount::new(BATCH)).bench_local(|| {
        contacts.run_with(black_box(stage.as_ref()), 2e-6, false, false);
        black_box(contacts.normal_force[0])
    });
}

#[divan::bench]
fn hertz(bencher: Bencher) {
    run(bencher, "Hertz", &[("stiffness_pressure", 7.1e7), ("damping_rate_per_length", 1.5e8)]);
}
