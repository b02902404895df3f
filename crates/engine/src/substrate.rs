//! Bodies on a surface that rolls with them: the last to act in a step, because its friction depends on the sum of all
//! other forces.
//!
//! The step is integrated with the mean force that the surface had in the step before. Then that force is taken out again,
//! the law is asked for the impulses of this step, and these are put in. So a body that does not slip has no slip to
//! round-off, friction never reverses a motion, and what the surface does to the energy is exact.

use granule_geometry::Motion;
use granule_law_api::{Footing, SubstrateContact};
use granule_plan::SubstratePlan;
use granule_state::{Bodies, Row, SurfaceRow};
use nalgebra::Vector3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::blame;

/// Bodies that a thread works on at a time; it must not depend on the number of threads.
const PART: usize = 512;
/// Bodies for which laws are asked at once.
const BLOCK: usize = 64;
/// A body starts in the air if it is farther above the surface than this share of its radius.
const CLEARANCE: f64 = 1e-6;

/// Work and dissipation of the substrate since the start \[J\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SubstrateWork {
    /// Dissipated by slip.
    pub sliding: f64,
    /// Dissipated by rolling friction.
    pub rolling: f64,
    /// Dissipated by friction about the normal.
    pub drilling: f64,
    /// Dissipated in landings.
    pub impact: f64,
    /// Work of the moving surface on the bodies.
    pub plate: f64,
}

impl SubstrateWork {
    fn add(&mut self, other: &Self) {
        self.sliding += other.sliding;
        self.rolling += other.rolling;
        self.drilling += other.drilling;
        self.impact += other.impact;
        self.plate += other.plate;
    }
}

/// What the bodies do on the substrate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SubstrateTally {
    /// Bodies that slip now.
    pub sliding: u64,
    /// Bodies that roll without slip now.
    pub rolling: u64,
    /// Bodies at rest relative to the surface now.
    pub resting: u64,
    /// Bodies above the surface now.
    pub airborne: u64,
    /// Work and dissipation since the start.
    pub work: SubstrateWork,
    /// Largest distance by which a body was put onto the surface in the last step \[m\].
    pub(crate) displacement: f64,
}

impl SubstrateTally {
    /// Takes over the counts of a step and adds its work.
    pub(crate) fn add(&mut self, step: Self) {
        let mut work = self.work;
        work.add(&step.work);
        *self = Self { work, ..step };
    }

    fn join(mut self, other: &Self) -> Self {
        self.sliding += other.sliding;
        self.rolling += other.rolling;
        self.resting += other.resting;
        self.airborne += other.airborne;
        self.work.add(&other.work);
        self.displacement = self.displacement.max(other.displacement);
        self
    }

    fn count(&mut self, footing: Footing) {
        match footing {
            Footing::Unknown => {}
            Footing::Airborne => self.airborne += 1,
            Footing::Sliding => self.sliding += 1,
            Footing::Rolling => self.rolling += 1,
            Footing::Resting => self.resting += 1,
        }
    }
}

const fn code(footing: Footing) -> u64 {
    match footing {
        Footing::Unknown => 0,
        Footing::Airborne => 1,
        Footing::Sliding => 2,
        Footing::Rolling => 3,
        Footing::Resting => 4,
    }
}

const fn footing(code: u64) -> Footing {
    match code {
        1 => Footing::Airborne,
        2 => Footing::Sliding,
        3 => Footing::Rolling,
        4 => Footing::Resting,
        _ => Footing::Unknown,
    }
}

/// True if a body with this motion on a surface slips.
pub fn slips(row: &SurfaceRow) -> bool {
    footing(row.footing) == Footing::Sliding
}

/// What all bodies of a step share.
struct Step<'a> {
    plan: &'a SubstratePlan,
    time: f64,
    time_step: f64,
    /// Gravity onto the surface \[m/s²\].
    gravity: f64,
    /// Velocity of a surface that does not turn.
    plate: Option<Vector3<f64>>,
}

/// Rows of consecutive bodies.
struct Part<'a> {
    /// Place of its first body.
    first: usize,
    position: &'a mut [Row],
    velocity: &'a mut [Row],
    force: &'a mut [Row],
    spin: &'a mut [Row],
    torque: &'a mut [Row],
    surface: &'a mut [SurfaceRow],
    mass: &'a [f64],
    material: &'a [u16],
}

/// Lets the surface act on bodies whose step of length `time_step` ended at `time`. With a step of zero only their motion on
/// the surface is taken down.
pub(crate) fn settle(
    plan: &SubstratePlan,
    bodies: &mut Bodies,
    time: f64,
    time_step: f64,
    gravity_z: f64,
    parallel: bool,
) -> SubstrateTally {
    let plate = velocity_everywhere(&plan.motion, time);
    let step = Step { plan, time, time_step, gravity: -gravity_z, plate };
    let mut parts: Vec<Part<'_>> =
        bodies
            .position
            .chunks_mut(PART)
            .zip(bodies.velocity.chunks_mut(PART))
            .zip(bodies.force.chunks_mut(PART))
            .zip(bodies.spin.chunks_mut(PART))
            .zip(bodies.torque.chunks_mut(PART))
            .zip(bodies.surface.chunks_mut(PART))
            .zip(bodies.mass.chunks(PART))
            .zip(bodies.material.chunks(PART))
            .enumerate()
            .map(|(index, (((((((position, velocity), force), spin), torque), surface), mass), material))| {
                Part { first: index * PART, position, velocity, force, spin, torque, surface, mass, material }
            })
            .collect();
    let tallies: Vec<SubstrateTally> = if parallel {
        parts.par_iter_mut().map(|part| step.part(part)).collect()
    } else {
        parts.iter_mut().map(|part| step.part(part)).collect()
    };
    tallies.iter().fold(SubstrateTally::default(), SubstrateTally::join)
}

fn velocity_everywhere(motion: &Motion, time: f64) -> Option<Vector3<f64>> {
    motion.rotation_at(time).is_none().then(|| motion.velocity(time))
}

/// What is known of a body between the question to the law and its answer.
#[derive(Clone, Copy, Default)]
struct Pending {
    /// The body takes part.
    active: bool,
    velocity: [f64; 3],
    spin: [f64; 3],
    plate: [f64; 2],
    /// Force of the surface along its normal that the next step starts from \[N\].
    normal_force: f64,
    /// It has landed in this step.
    landed: bool,
    /// It is above the surface at the end of the step.
    airborne: bool,
}

impl Step<'_> {
    fn part(&self, part: &mut Part<'_>) -> SubstrateTally {
        let mut tally = SubstrateTally::default();
        let mut contacts = [SubstrateContact::default(); BLOCK];
        let mut pending = [Pending::default(); BLOCK];
        let mut first = 0;
        while first < part.position.len() {
            let count = BLOCK.min(part.position.len() - first);
            for k in 0..count {
                (contacts[k], pending[k]) = self.ask(part, first + k, &mut tally);
            }
            if self.time_step > 0.0 {
                let place = part.first + first;
                self.answer(&mut contacts[..count], &part.material[first..first + count], place);
            }
            for k in 0..count {
                if pending[k].active {
                    self.apply(part, first + k, &contacts[k], &pending[k], &mut tally);
                }
            }
            first += count;
        }
        tally
    }

    /// Motion at the end of the step without the surface, except that it carries the body.
    fn ask(&self, part: &mut Part<'_>, k: usize, tally: &mut SubstrateTally) -> (SubstrateContact, Pending) {
        let inverse_mass = part.velocity[k][3];
        if inverse_mass == 0.0 {
            return Default::default();
        }
        let (mass, radius, inverse_inertia) = (part.mass[k], part.position[k][3], part.spin[k][3]);
        let row = part.surface[k];
        let half = 0.5 * self.time_step;
        let mut velocity = part.velocity[k].vector();
        let mut spin = part.spin[k].vector();
        for axis in 0..3 {
            velocity[axis] -= half * row.force[axis] * inverse_mass;
            spin[axis] -= half * row.torque[axis] * inverse_inertia;
        }
        let place = self.plan.height + radius;
        let mut state = footing(row.footing);
        if self.time_step == 0.0 && !self.plan.confined && part.position[k][2] > place + CLEARANCE * radius {
            state = Footing::Airborne;
        }
        let mut normal_impulse = 0.0;
        let mut normal_force = 0.0;
        let mut landed = false;
        let height = part.position[k][2];
        if self.time_step > 0.0 {
            if state != Footing::Airborne {
                if self.plan.confined || velocity[2] <= 0.0 {
                    normal_impulse = -mass * velocity[2];
                    normal_force = normal_impulse / self.time_step;
                    velocity[2] = 0.0;
                    part.position[k][2] = place;
                } else {
                    state = Footing::Airborne;
                }
            } else if height <= place && velocity[2] < 0.0 {
                // The speed with which it passed the surface: that of its energy there.
                let squared = velocity[2] * velocity[2] - 2.0 * self.gravity * (place - height);
                let impact = squared.max(0.0).sqrt();
                let rebound = self.plan.restitution * impact;
                let rebound = if rebound > 2.0 * self.gravity * self.time_step { rebound } else { 0.0 };
                normal_impulse = mass * (impact + rebound);
                tally.work.impact += 0.5 * mass * (impact * impact - rebound * rebound);
                velocity[2] = rebound;
                part.position[k][2] = place;
                landed = true;
            }
        }
        tally.displacement = tally.displacement.max((part.position[k][2] - height).abs());
        let [x, y, z] = part.position[k].vector();
        let plate = self
            .plate
            .unwrap_or_else(|| self.plan.motion.velocity_at(Vector3::new(x, y, z - radius), self.time));
        let rolling = [velocity[0] - plate.x, velocity[1] - plate.y];
        let contact = SubstrateContact {
            mass,
            radius,
            inertia_number: mass * radius * radius * inverse_inertia,
            normal_impulse: normal_impulse.max(0.0),
            slip_before: row.slip,
            slip: [rolling[0] - radius * spin[1], rolling[1] + radius * spin[0]],
            rolling_before: row.rolling,
            rolling,
            drilling: spin[2],
            footing: state,
            ..SubstrateContact::default()
        };
        let airborne = if landed { velocity[2] > 0.0 } else { state == Footing::Airborne };
        let plate = [plate.x, plate.y];
        let pending = Pending { active: true, velocity, spin, plate, normal_force, landed, airborne };
        (contact, pending)
    }

    /// Asks the laws, once for each run of bodies of one material; `place` is that of the first body.
    fn answer(&self, contacts: &mut [SubstrateContact], materials: &[u16], place: usize) {
        let mut first = 0;
        while first < contacts.len() {
            let material = materials[first];
            let same = materials[first..].iter().take_while(|other| **other == material).count();
            if let Some(Some(material)) = self.plan.materials.get(usize::from(material)) {
                let (law, stage) = (material.law.info.name, material.stage.as_ref());
                blame::run_substrate(law, stage, &mut contacts[first..first + same], place + first);
            }
            first += same;
        }
    }

    /// Puts the impulses in and takes the motion on the surface down.
    fn apply(
        &self,
        part: &mut Part<'_>,
        k: usize,
        contact: &SubstrateContact,
        pending: &Pending,
        tally: &mut SubstrateTally,
    ) {
        let (inverse_mass, inverse_inertia) = (part.velocity[k][3], part.spin[k][3]);
        let (j, p, radius) = (contact.impulse, contact.couple, contact.radius);
        let turning = [radius * (j[1] + p[1]), -radius * (j[0] + p[0]), contact.drilling_impulse];
        let mut velocity = pending.velocity;
        let mut spin = pending.spin;
        for axis in 0..2 {
            velocity[axis] += j[axis] * inverse_mass;
        }
        for axis in 0..3 {
            spin[axis] += turning[axis] * inverse_inertia;
            part.velocity[k][axis] = velocity[axis];
            part.spin[k][axis] = spin[axis];
        }
        let plate = pending.plate;
        let rolling = [velocity[0] - plate[0], velocity[1] - plate[1]];
        let turned = [-radius * spin[1], radius * spin[0]];
        let slip = [rolling[0] + turned[0], rolling[1] + turned[1]];
        let before = part.surface[k];
        for axis in 0..2 {
            let turned_before = before.slip[axis] - before.rolling[axis];
            tally.work.sliding -= 0.5 * j[axis] * (before.slip[axis] + slip[axis]);
            tally.work.rolling -= 0.5 * p[axis] * (turned_before + turned[axis]);
            tally.work.plate += 0.5 * j[axis] * (before.plate[axis] + plate[axis]);
        }
        tally.work.drilling -= 0.5 * contact.drilling_impulse * (before.drilling + spin[2]);
        let state = if pending.airborne { Footing::Airborne } else { contact.footing };
        tally.count(state);
        let row = &mut part.surface[k];
        *row = SurfaceRow {
            slip,
            rolling,
            plate,
            drilling: spin[2],
            footing: code(state),
            ..SurfaceRow::default()
        };
        if self.time_step > 0.0 && !pending.landed && state != Footing::Airborne {
            row.force = [j[0] / self.time_step, j[1] / self.time_step, pending.normal_force];
            row.torque = turning.map(|turning| turning / self.time_step);
            for axis in 0..3 {
                part.force[k][axis] += row.force[axis];
                part.torque[k][axis] += row.torque[axis];
            }
        }
    }
}
