//! Laws at fault: which one panicked or gave a number that is not finite, from the thread where it happened to the error that
//! ends the run.

use std::any::Any;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;

use granule_law_api::{Columns, ContactChunk, Real, Stage, SubstrateContact, SubstrateStage};
use granule_plan::{Composition, Partner};

use crate::chunk::{Batch, Column};
use crate::error::EngineError;

/// What unwinds from a law at fault.
pub(crate) enum Blame {
    /// It panicked. `places` are bodies among which those are that it was asked about.
    Panic { law: &'static str, message: String, places: Range<usize> },
    /// It made a number that is not finite of numbers that are.
    NotFinite {
        law: &'static str,
        quantity: &'static str,
        /// Places of the bodies.
        places: [Option<u32>; 2],
        /// What else is in it.
        wall: Surface,
        contact: String,
    },
}

/// What a body touches besides bodies.
#[derive(Clone, Copy)]
pub(crate) enum Surface {
    None,
    Wall(u16),
    Substrate,
}

/// Runs a stage. If it panics, its law is named to [`caught`], across threads. Costs nothing as long as it does not.
#[inline]
pub(crate) fn run<T: Real>(law: &'static str, stage: &dyn Stage<T>, chunk: &mut ContactChunk<'_, T>) {
    guard(law, 0..0, || stage.run(chunk));
}

/// Runs a law of the substrate, and blames it if it panics or answers with a number that is not finite. `place` is that of the
/// first body.
pub(crate) fn run_substrate(
    law: &'static str,
    stage: &dyn SubstrateStage,
    contacts: &mut [SubstrateContact],
    place: usize,
) {
    let places = place..place + contacts.len();
    guard(law, places, || stage.run(contacts));
    for (k, contact) in contacts.iter().enumerate() {
        let answer = [contact.impulse, contact.couple, [contact.drilling_impulse, 0.0]];
        let given = [
            contact.slip,
            contact.slip_before,
            contact.rolling,
            contact.rolling_before,
            [contact.drilling, contact.normal_impulse],
        ];
        if answer.as_flattened().iter().all(|number| number.is_finite())
            || given.as_flattened().iter().any(|number| !number.is_finite())
        {
            continue;
        }
        let size = |[x, y]: [f64; 2]| x.hypot(y);
        let contact = format!(
            "normal impulse {:e} N s, slipping at {:e} m/s, rolling at {:e} m/s",
            contact.normal_impulse,
            size(contact.slip),
            size(contact.rolling)
        );
        let places = [Some((place + k) as u32), None];
        let blame = Blame::NotFinite { law, quantity: "impulse", places, wall: Surface::Substrate, contact };
        resume_unwind(Box::new(blame));
    }
}

#[inline]
fn guard(law: &'static str, places: Range<usize>, work: impl FnOnce()) {
    // The columns of a chunk are numbers whatever happened to them, and nobody reads them after a panic.
    if let Err(payload) = catch_unwind(AssertUnwindSafe(work)) {
        let message = message(payload.as_ref());
        resume_unwind(Box::new(Blame::Panic { law, message, places }));
    }
}

/// Works on the bodies of some places, among which those are that a law panics about.
pub(crate) fn among<R>(bodies: Range<usize>, work: impl FnOnce() -> R) -> R {
    caught(work).unwrap_or_else(|mut blame| {
        if let Blame::Panic { places, .. } = blame.as_mut() {
            *places = bodies;
        }
        resume_unwind(blame)
    })
}

/// Does what may meet a law at fault. Every other panic goes on.
pub(crate) fn caught<R>(work: impl FnOnce() -> R) -> Result<R, Box<Blame>> {
    catch_unwind(AssertUnwindSafe(work))
        .map_err(|payload| payload.downcast::<Blame>().unwrap_or_else(|other| resume_unwind(other)))
}

/// Looks through a batch that has been run for a contact whose force is not finite although what the laws got is, and
/// blames the first law that makes it so. `places` tells the bodies of a contact.
pub(crate) fn inquire<T: Real>(
    batch: &mut Batch<T>,
    composition: &Composition,
    stages: &[Arc<dyn Stage<T>>],
    time_step: f64,
    places: impl Fn(&Batch<T>, usize) -> [Option<u32>; 2],
) {
    let culprit = |batch: &Batch<T>| {
        (0..batch.count).find(|&k| given(batch, composition, k) && answer(batch, composition, k).is_some())
    };
    if culprit(batch).is_none() {
        return;
    }
    for count in 1..=stages.len() {
        batch.tangential_force = [Column::filled(T::ZERO); 3];
        batch.run(composition, &stages[..count], time_step, None);
        let Some(k) = culprit(batch) else { continue };
        let places = places(batch, k);
        let quantity = answer(batch, composition, k).unwrap_or("force");
        let slip = [0, 1, 2].map(|axis| batch.tangential_velocity[axis][k].wide());
        let mut contact = format!(
            "overlap {:e} m, closing at {:e} m/s",
            batch.overlap[k].wide(),
            batch.normal_velocity[k].wide()
        );
        if composition.reads.contains(Columns::TANGENTIAL_VELOCITY) {
            contact += &format!(", slipping at {:e} m/s", slip.iter().map(|v| v * v).sum::<f64>().sqrt());
        }
        let wall = match composition.partner {
            Partner::Wall(wall) => Surface::Wall(wall),
            Partner::Body(_) => Surface::None,
        };
        let law = composition.stages[count - 1].law.info.name;
        resume_unwind(Box::new(Blame::NotFinite { law, quantity, places, wall, contact }));
    }
}

/// What the laws got for contact `k` is finite.
fn given<T: Real>(batch: &Batch<T>, composition: &Composition, k: usize) -> bool {
    let scalars = [&batch.overlap, &batch.normal_velocity, &batch.reduced_mass, &batch.reduced_radius];
    let read = |column: Columns, vector: &[Column<T>; 3]| {
        !composition.reads.contains(column) || vector.iter().all(|column| column[k].wide().is_finite())
    };
    scalars.iter().all(|column| column[k].wide().is_finite())
        && batch.normal.iter().all(|column| column[k].wide().is_finite())
        && read(Columns::TANGENTIAL_VELOCITY, &batch.tangential_velocity)
        && read(Columns::RELATIVE_SPIN, &batch.relative_spin)
}

/// What of the answer for contact `k` is not finite.
fn answer<T: Real>(batch: &Batch<T>, composition: &Composition, k: usize) -> Option<&'static str> {
    let bad = |vector: &[Column<T>; 3]| vector.iter().any(|column| !column[k].wide().is_finite());
    if !batch.normal_force[k].wide().is_finite() {
        Some("normal force")
    } else if composition.writes.contains(Columns::TANGENTIAL_FORCE) && bad(&batch.tangential_force) {
        Some("tangential force")
    } else if composition.writes.contains(Columns::TORQUE) && bad(&batch.contact_torque) {
        Some("torque")
    } else {
        None
    }
}

impl Blame {
    /// The error of a run. `id` is that of a body at a place, `wall` the name of a wall.
    pub fn at(
        self,
        step: u64,
        time: f64,
        id: impl Fn(u32) -> u32,
        wall: impl Fn(u16) -> String,
    ) -> EngineError {
        match self {
            Self::Panic { law, message, places } => {
                let among = places.map(|place| id(place as u32)).collect();
                EngineError::LawPanicked { law, message, among, step, time }
            }
            Self::NotFinite { law, quantity, places, wall: at, contact } => {
                let mut bodies: Vec<String> =
                    places.into_iter().flatten().map(|place| format!("body {}", id(place))).collect();
                match at {
                    Surface::None => {}
                    Surface::Wall(index) => bodies.push(format!("wall {}", wall(index))),
                    Surface::Substrate => bodies.push("the substrate".to_string()),
                }
                EngineError::LawNotFinite {
                    law,
                    quantity,
                    between: bodies.join(" and "),
                    contact,
                    step,
                    time,
                }
            }
        }
    }
}

fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| text.to_string());
    text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_string())
}
