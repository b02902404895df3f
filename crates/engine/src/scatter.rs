//! From columns of forces to rows of bodies, four contacts at a time.
#![expect(unsafe_code, reason = "rows are written without comparing each index with the number of rows")]

use granule_state::{Lanes, Row};

use crate::chunk::Batch;
use crate::level::Arithmetic;
use crate::space::Space;
use crate::tile::Outgoing;

/// What acts on the two bodies of four contacts.
pub(crate) struct Wrenches<L> {
    /// Force on i: one row a contact; in the plane the third number is the torque on i.
    pub force: [L; 4],
    /// Force on j in the plane; in space that on i is subtracted.
    pub force_j: [L; 4],
    /// Torques on i and j.
    pub torque: [[L; 4]; 2],
}

/// Forces and torques of group `g` of a batch. `tangential`: there are tangential forces; `rolls`: there are torques of
/// the laws; `alike`: both lever arms are the same numbers.
#[inline(always)]
pub(crate) fn wrenches<S: Space, T: Arithmetic, L: Lanes>(
    batch: &Batch<T>,
    g: usize,
    tangential: bool,
    rolls: bool,
    alike: bool,
) -> Wrenches<L> {
    let zero = L::splat(0.0);
    let size: L = T::load(batch.normal_force.four(g));
    let n: [L; 3] = vector(&batch.normal, g);
    let mut force = [size * n[0], size * n[1], size * n[2]];
    let (mut on_i, mut on_j) = ([zero; 3], [zero; 3]);
    if tangential {
        let f: [L; 3] = vector(&batch.tangential_force, g);
        for axis in 0..3 {
            force[axis] = force[axis] + f[axis];
        }
        if S::ROTATION {
            let turning = [n[1] * f[2] - n[2] * f[1], n[2] * f[0] - n[0] * f[2], n[0] * f[1] - n[1] * f[0]];
            let arm_i = zero - L::load(batch.arm[0].four(g));
            let arm_j = zero - L::load(batch.arm[1].four(g));
            for axis in 0..3 {
                on_i[axis] = arm_i * turning[axis];
                on_j[axis] = arm_j * turning[axis];
            }
        }
    }
    if S::ROTATION && rolls {
        let torque: [L; 3] = vector(&batch.contact_torque, g);
        for axis in 0..3 {
            on_i[axis] = on_i[axis] + torque[axis];
            on_j[axis] = on_j[axis] - torque[axis];
        }
    }
    if S::PLANAR {
        let [on_i, on_j] = if S::ROTATION { [on_i[2], on_j[2]] } else { [zero; 2] };
        return Wrenches {
            force: L::transpose([force[0], force[1], on_i, zero]),
            force_j: L::transpose([zero - force[0], zero - force[1], on_j, zero]),
            torque: [[zero; 4]; 2],
        };
    }
    let force = L::transpose([force[0], force[1], force[2], zero]);
    let mut torque = [[zero; 4]; 2];
    if S::ROTATION {
        torque[0] = L::transpose([on_i[0], on_i[1], on_i[2], zero]);
        torque[1] = if alike && !rolls { torque[0] } else { L::transpose([on_j[0], on_j[1], on_j[2], zero]) };
    }
    Wrenches { force, force_j: [zero; 4], torque }
}

#[inline(always)]
fn vector<T: Arithmetic, L: Lanes>(columns: &[crate::chunk::Column<T>; 3], g: usize) -> [L; 3] {
    [T::load(columns[0].four(g)), T::load(columns[1].four(g)), T::load(columns[2].four(g))]
}

/// Rows that the contacts of a tile add to.
pub(crate) struct Sums<'a> {
    /// Forces on the bodies of the tile.
    pub force: &'a mut [Row],
    /// Torques on the bodies of the tile.
    pub torque: &'a mut [Row],
    /// What acts on bodies of other tiles.
    pub outbox: &'a mut [Outgoing],
}

/// Adds to a row.
///
/// # Safety
/// `place` is less than the number of rows.
#[inline(always)]
unsafe fn add<L: Lanes>(rows: &mut [Row], place: usize, value: L) {
    // SAFETY: that is what the caller promises. Builds with debug assertions check it.
    let to = unsafe { rows.get_unchecked_mut(place) };
    (L::load(&to.0) + value).store(&mut to.0);
}

/// Adds the forces of a batch to the bodies.
#[inline(always)]
pub(crate) fn scatter<S: Space, T: Arithmetic, L: Lanes>(
    batch: &Batch<T>,
    sums: &mut Sums<'_>,
    tangential: bool,
    rolls: bool,
    alike: bool,
) {
    let count = batch.len();
    let zero = L::splat(0.0);
    let spinning = S::ROTATION && !S::PLANAR;
    let Sums { force, torque, outbox } = sums;
    let own = force.len();
    assert!((batch.largest(&batch.i) as usize) < own, "a batch has bodies of the tile");
    assert!((batch.largest(&batch.to) as usize) < own + outbox.len(), "a batch has targets of the tile");
    assert!(!spinning || torque.len() == own, "rotation has torques");
    for g in 0..batch.groups() {
        let wrenches = wrenches::<S, T, L>(batch, g, tangential, rolls, alike);
        let (i, to) = (batch.i.four(g), batch.to.four(g));
        let rest = count - 4 * g;
        // Written out: in a loop the rows would go through memory.
        macro_rules! lane {
            ($lane:literal) => {
                if rest > $lane {
                    let (i, to) = (i[$lane] as usize, to[$lane] as usize);
                    let f = wrenches.force[$lane];
                    let on_j = if S::PLANAR { wrenches.force_j[$lane] } else { zero - f };
                    // SAFETY: all i and all targets of the batch were compared above with the rows and slots that exist.
                    unsafe {
                        add(force, i, f);
                        if spinning {
                            add(torque, i, wrenches.torque[0][$lane]);
                        }
                        if to < own {
                            add(force, to, on_j);
                            if spinning {
                                add(torque, to, wrenches.torque[1][$lane]);
                            }
                        } else {
                            let out = outbox.get_unchecked_mut(to - own);
                            on_j.store(&mut out.force.0);
                            if spinning {
                                wrenches.torque[1][$lane].store(&mut out.torque.0);
                            }
                        }
                    }
                }
            };
        }
        lane!(0);
        lane!(1);
        lane!(2);
        lane!(3);
    }
}
