//! A hash of everything that determines the results of a run.

use granule_geometry::Surface;
use granule_law_api::Conventions;
use nalgebra::Vector3;
use xxhash_rust::xxh3::Xxh3;

use crate::model::{Dimensions, Partner, Plan, Precision, Scheme, Search, Slides};

/// Layout of the hashed bytes; a change makes all fingerprints differ.
const LAYOUT: u64 = 1;

/// The fingerprint: 32 hexadecimal digits.
///
/// Hashed are bodies, walls, compositions with laws, parameters and versions, conventions, scheme, step, skin, precision
/// and all other settings that the state after a step depends on. Title, outputs, the energy ledger, the number of steps
/// and the number of threads do not change a trajectory and do not enter.
pub fn fingerprint(plan: &Plan) -> String {
    let mut hash = Bytes(Xxh3::new());
    hash.word(LAYOUT);
    hash.word(match plan.dimensions {
        Dimensions::Two => 2,
        Dimensions::Three => 3,
    });
    hash.flag(plan.rotation);
    hash.word(match plan.precision {
        Precision::Double => 64,
        Precision::Single => 32,
    });
    conventions(&mut hash, &plan.conventions);
    hash.numbers(&plan.gravity);
    hash.numbers(&plan.cell.lo());
    hash.numbers(&plan.cell.hi());
    plan.cell.periodic().into_iter().for_each(|periodic| hash.flag(periodic));
    bodies(&mut hash, plan);
    walls(&mut hash, plan);
    substrate(&mut hash, plan);
    compositions(&mut hash, plan);
    event(&mut hash, plan);
    hash.word(match plan.driver.scheme {
        Scheme::VelocityVerlet => 0,
        Scheme::ClassicVelocityVerlet => 1,
        Scheme::Leapfrog => 2,
        Scheme::SymplecticEuler => 3,
        Scheme::ContactResolved => 4,
    });
    hash.number(plan.driver.step);
    hash.word(match plan.driver.search {
        Search::None => 0,
        Search::AllPairs => 1,
        Search::Grid => 2,
    });
    hash.number(plan.driver.skin);
    format!("{:032x}", hash.0.digest128())
}

/// Fixed-width little-endian bytes, texts with their length.
struct Bytes(Xxh3);

impl Bytes {
    fn word(&mut self, word: u64) {
        self.0.update(&word.to_le_bytes());
    }

    fn flag(&mut self, flag: bool) {
        self.word(u64::from(flag));
    }

    fn number(&mut self, number: f64) {
        self.word(number.to_bits());
    }

    fn numbers(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|number| self.number(*number));
    }

    fn vector(&mut self, vector: Vector3<f64>) {
        self.numbers(vector.as_slice());
    }

    fn text(&mut self, text: &str) {
        self.word(text.len() as u64);
        self.0.update(text.as_bytes());
    }
}

fn conventions(hash: &mut Bytes, conventions: &Conventions) {
    // Names, not positions in an enumeration: a reordering must not change fingerprints. All fields are listed, so that a
    // new one cannot be forgotten.
    let Conventions {
        pair_torque_arm,
        pair_slip_arm,
        wall_torque_arm,
        wall_slip_arm,
        history_update,
        coulomb_test,
        coulomb_cap,
        velocity,
    } = conventions;
    for arm in [pair_torque_arm, pair_slip_arm, wall_torque_arm, wall_slip_arm] {
        hash.text(&format!("{arm:?}"));
    }
    hash.text(&format!("{history_update:?} {coulomb_test:?} {coulomb_cap:?} {velocity:?}"));
}

fn bodies(hash: &mut Bytes, plan: &Plan) {
    let bodies = &plan.bodies;
    hash.word(bodies.len() as u64);
    for k in 0..bodies.len() {
        let ([x, y, z], [vx, vy, vz]) = (bodies.position[k], bodies.velocity[k]);
        let [wx, wy, wz] = bodies.spin[k];
        let (radius, mass, q) = (bodies.radius[k], bodies.mass[k], bodies.inertia_factor[k]);
        let numbers = [radius, mass, q, x, y, z, vx, vy, vz, wx, wy, wz];
        // One call a body: a call a word takes four times as long.
        let mut bytes = [0; 8 * 15];
        let words = [u64::from(bodies.id[k]), u64::from(bodies.material[k])]
            .into_iter()
            .chain(numbers.map(f64::to_bits))
            .chain([u64::from(bodies.frozen[k])]);
        for (to, word) in bytes.chunks_exact_mut(8).zip(words) {
            to.copy_from_slice(&word.to_le_bytes());
        }
        hash.0.update(&bytes);
    }
}

fn walls(hash: &mut Bytes, plan: &Plan) {
    hash.word(plan.walls.len() as u64);
    for wall in &plan.walls {
        hash.word(u64::from(wall.material));
        match wall.wall.surface() {
            Surface::Plane(plane) => {
                hash.word(1);
                hash.vector(plane.point());
                hash.vector(plane.normal());
            }
            Surface::Cylinder(cylinder) => {
                hash.word(2);
                hash.vector(cylinder.point());
                hash.vector(cylinder.axis());
                hash.number(cylinder.radius());
                hash.flag(cylinder.inside());
            }
        }
        // The debug text of numbers is the shortest that reads back to the same bits.
        hash.text(&format!("{:?}", wall.wall.motion()));
    }
}

/// Adds nothing to plans of the time-stepped driver.
fn event(hash: &mut Bytes, plan: &Plan) {
    let Some(event) = &plan.event else { return };
    hash.text("event");
    hash.number(event.contact_duration);
    match event.slides {
        None => {}
        Some(Slides::Arcs { error }) => {
            hash.text("arcs");
            hash.number(error);
        }
        Some(Slides::EffectiveRestitution) => hash.text("effective restitution"),
    }
    hash.word(event.collisions.len() as u64);
    for collision in &event.collisions {
        hash.word(u64::from(collision.material));
        match collision.partner {
            Partner::Body(material) => hash.text(&format!("body {material}")),
            Partner::Wall(wall) => hash.text(&format!("wall {wall}")),
        }
        hash.text(collision.law.info.name);
        hash.text(collision.law.crate_name);
        hash.text(collision.law.crate_version);
        hash.word(collision.params.form() as u64);
        for (name, value) in collision.params.values() {
            hash.text(name);
            hash.number(*value);
        }
    }
}

/// Adds nothing to plans without a substrate.
fn substrate(hash: &mut Bytes, plan: &Plan) {
    let Some(substrate) = &plan.substrate else { return };
    hash.text("substrate");
    hash.number(substrate.height);
    hash.text(&format!("{:?}", substrate.motion));
    hash.flag(substrate.confined);
    hash.number(substrate.restitution);
    for (index, material) in substrate.materials.iter().enumerate() {
        let Some(material) = material else { continue };
        hash.word(index as u64);
        hash.text(material.law.info.name);
        hash.text(material.law.crate_name);
        hash.text(material.law.crate_version);
        hash.word(material.params.form() as u64);
        for (name, value) in material.params.values() {
            hash.text(name);
            hash.number(*value);
        }
        for (speed, friction) in &material.rolling_friction {
            hash.numbers(&[*speed, *friction]);
        }
    }
}

fn compositions(hash: &mut Bytes, plan: &Plan) {
    hash.word(plan.compositions.len() as u64);
    for composition in &plan.compositions {
        hash.word(u64::from(composition.material));
        match composition.partner {
            Partner::Body(material) => hash.text(&format!("body {material}")),
            Partner::Wall(wall) => hash.text(&format!("wall {wall}")),
        }
        hash.text(&format!("{:?}", composition.contact_end));
        // Laws may fold any number of their context into constants.
        let context = &composition.context;
        for span in [context.reduced_mass, context.reduced_radius, context.inertia_factor] {
            hash.numbers(&[span.min, span.max]);
        }
        hash.number(context.impact_speed);
        hash.word(composition.stages.len() as u64);
        for stage in &composition.stages {
            hash.text(stage.law.info.name);
            hash.text(stage.law.crate_name);
            hash.text(stage.law.crate_version);
            hash.word(stage.params.form() as u64);
            for (name, value) in stage.params.values() {
                hash.text(name);
                hash.number(*value);
            }
        }
    }
}
