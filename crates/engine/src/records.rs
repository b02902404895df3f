//! What each contact does, kept for whoever wants to see it.

use granule_state::Bodies;

use crate::chunk::Batch;
use crate::level::Arithmetic;
use crate::tally::{ContactForce, ContactPartner};

/// A contact of one tile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Record {
    /// Place of the body among all bodies.
    i: u32,
    /// Place of the other body, or the index of the wall.
    j: u32,
    is_wall: bool,
    overlap: f64,
    normal: [f64; 3],
    normal_force: f64,
    tangential_force: [f64; 3],
    torque: [f64; 3],
}

/// Which columns of a batch are written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Written {
    pub tangential: bool,
    pub torque: bool,
}

/// Adds the contacts of a batch whose bodies begin at place `first`.
pub(crate) fn keep<T: Arithmetic>(
    records: &mut Vec<Record>,
    batch: &Batch<T>,
    first: usize,
    is_wall: bool,
    written: Written,
) {
    records.extend((0..batch.len()).map(|k| {
        let vector = |columns: &[crate::chunk::Column<T>; 3], there: bool| {
            if there { [0, 1, 2].map(|axis: usize| columns[axis][k].wide()) } else { [0.0; 3] }
        };
        Record {
            i: first as u32 + batch.i[k],
            j: if is_wall { batch.to[k] } else { batch.j[k] },
            is_wall,
            overlap: batch.overlap[k].wide(),
            normal: vector(&batch.normal, true),
            normal_force: batch.normal_force[k].wide(),
            tangential_force: vector(&batch.tangential_force, written.tangential),
            torque: vector(&batch.contact_torque, written.torque),
        }
    }));
}

impl Record {
    /// The same with identities, seen from the body whose identity is smaller.
    pub fn told(&self, bodies: &Bodies) -> ContactForce {
        let id = bodies.id[self.i as usize];
        let partner = if self.is_wall {
            ContactPartner::Wall(self.j)
        } else {
            ContactPartner::Body(bodies.id[self.j as usize])
        };
        let told = ContactForce {
            id,
            partner,
            overlap: self.overlap,
            normal: self.normal,
            normal_force: self.normal_force,
            tangential_force: self.tangential_force,
            torque: self.torque,
        };
        match partner {
            ContactPartner::Body(other) if other < id => {
                let turned = |vector: [f64; 3]| vector.map(|component| 0.0 - component);
                ContactForce {
                    id: other,
                    partner: ContactPartner::Body(id),
                    normal: turned(told.normal),
                    tangential_force: turned(told.tangential_force),
                    torque: turned(told.torque),
                    ..told
                }
            }
            _ => told,
        }
    }
}
