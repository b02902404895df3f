mod errata;
mod memory;
mod published;

use granule_law_api::testing::{Contacts, conformance};
use granule_law_api::{ContactEnd, ContactLaw, Impact, ImpactOutcome, Oracle, PairContext, Params, Stage};

use crate::WaltonBraun;

#[test]
fn conforms() {
    conformance::<WaltonBraun>();
}

fn context(end: ContactEnd, mass: f64) -> PairContext {
    PairContext { contact_end: end, ..PairContext::single(mass, 1e-2, 0.4, 1.0) }
}

fn compiled(values: &[(&str, f64)], mass: f64) -> Box<dyn Stage<f64>> {
    let params = Params::new(&WaltonBraun::INFO, values).unwrap();
    WaltonBraun::compile::<f64>(&params, &context(ContactEnd::Force, mass)).unwrap()
}

fn closed_form(values: &[(&str, f64)], end: ContactEnd, impact: &Impact) -> ImpactOutcome {
    let params = Params::new(&WaltonBraun::INFO, values).unwrap();
    let Oracle::Normal(oracle) = WaltonBraun::oracle(&params, &context(end, impact.reduced_mass)) else {
        panic!("no oracle")
    };
    oracle(impact)
}

/// One contact that is led through overlaps.
struct Led {
    stage: Box<dyn Stage<f64>>,
    contact: Contacts<f64>,
}

impl Led {
    fn new(values: &[(&str, f64)]) -> Self {
        let mut contact = Contacts::new(1, 1);
        contact.reduced_mass[0] = 1e-3;
        contact.reduced_radius[0] = 1e-2;
        Self { stage: compiled(values, 1e-3), contact }
    }

    /// Force after a step of 1 s that ends at this overlap and has come with this speed.
    fn force(&mut self, overlap: f64, velocity: f64) -> f64 {
        self.contact.overlap[0] = overlap;
        self.contact.normal_velocity[0] = velocity;
        self.contact.run(&*self.stage, 1.0);
        self.contact.normal_force[0]
    }
}
