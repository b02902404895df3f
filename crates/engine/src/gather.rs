//! From rows of bodies to columns of contacts, four contacts at a time.
#![expect(unsafe_code, reason = "rows are read without comparing each index with the number of rows")]

use granule_law_api::Columns;
use granule_plan::Composition;
use granule_state::{Lanes, Row};

use crate::chunk::{BATCH, Batch, Parted, share};
use crate::level::Arithmetic;
use crate::list::View;
use crate::prefetch::prefetch;
use crate::resolve::RangeMarks;
use crate::space::Space;
use crate::tile::Evaluation;

/// Number of bits of a mask of four.
const BITS: [u8; 16] = [0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4];

/// One row.
///
/// # Safety
/// `place` is less than the number of rows.
#[inline(always)]
unsafe fn row<L: Lanes>(rows: &[Row], place: usize) -> L {
    // SAFETY: the caller keeps the index below the length. Builds with debug assertions check it.
    L::load(unsafe { &rows.get_unchecked(place).0 })
}

/// What a scheme that resolves contacts wants to know of a range of pairs.
pub(crate) struct Changes<'a> {
    /// The first pair of the range.
    pub start: usize,
    pub marks: RangeMarks<'a>,
    /// Bound of what any distance has changed in the step \[m\].
    pub margin: f64,
}

/// Fills a batch with those pairs from `next` up to `end` that touch; returns where to go on. With `CHANGES`, it also notes
/// which of them may not have touched before, and which pairs that do not touch may have.
#[inline(always)]
pub(crate) fn find_contacts<T: Arithmetic, L: Lanes, const CHANGES: bool>(
    batch: &mut Batch<T>,
    list: &View<'_>,
    (next, end): (usize, usize),
    at: &Evaluation<'_>,
    reach: f64,
    mut changes: Option<Changes<'_>>,
) -> usize {
    let reach = L::splat(reach);
    batch.begun.clear();
    batch.parted.clear();
    let mut count = 0;
    let mut index = next;
    while count <= BATCH - 4 && index < end {
        let Some(four) = list.four_from(index) else { break };
        for j in four.ahead {
            prefetch(list.position.all, *j as usize);
        }
        for j in four.j {
            prefetch(list.velocity.all, *j as usize);
            prefetch(list.spin.all, *j as usize);
        }
        let separation = |lane: usize| -> L {
            let (i_image, j) = (four.i_image[lane] as usize, four.j[lane] as usize);
            // SAFETY: the rows of a list have its i and j.
            let (a, b): (L, L) = unsafe { (row(list.position.own, i_image >> 5), row(list.position.all, j)) };
            a - b.flip_last() - L::load(&at.shifts[i_image & 31].0)
        };
        // Separations of the centres, with the sums of the radii behind them.
        let rows = [separation(0), separation(1), separation(2), separation(3)];
        let [x, y, z, touching] = L::transpose(rows);
        let squared = x * x + y * y + z * z;
        let limit = touching + reach;
        let listed = if end - index < 4 { (1 << (end - index)) - 1 } else { 15 };
        let mask = squared.less(limit * limit) & listed;
        if CHANGES && let Some(changes) = &mut changes {
            let group = (index - changes.start) / 4;
            let (begun, parted) = match changes.marks.before {
                Some(before) => {
                    let before = usize::from(before[group]);
                    (mask & !before, before & !mask)
                }
                None => {
                    let margin = L::splat(changes.margin);
                    let (wide, narrow) = (limit + margin, L::splat(0.0).max(limit - margin));
                    (mask & !squared.less(narrow * narrow), squared.less(wide * wide) & listed & !mask)
                }
            };
            changes.marks.now[group] = mask as u8;
            if begun | parted != 0 {
                for lane in 0..4 {
                    if begun >> lane & 1 == 1 {
                        batch.begun.push((count + usize::from(BITS[mask & ((1 << lane) - 1)])) as u32);
                    }
                    if parted >> lane & 1 == 1 {
                        let mut separation = [0.0; 4];
                        rows[lane].store(&mut separation);
                        let (i, j) = (four.i_image[lane] >> 5, four.j[lane]);
                        let [x, y, z, _] = separation;
                        batch.parted.push(Parted {
                            pair: (index + lane) as u32,
                            i,
                            j,
                            separation: [x, y, z],
                        });
                    }
                }
            }
        }
        // Those that touch are packed to the front and the rest is overwritten by the next group: no branch to mispredict.
        let packing = L::packing(mask);
        x.pack(packing).store(batch.separation[0].four_at(count));
        y.pack(packing).store(batch.separation[1].four_at(count));
        z.pack(packing).store(batch.separation[2].four_at(count));
        squared.pack(packing).store(batch.distance_squared.four_at(count));
        touching.pack(packing).store(batch.touching_distance.four_at(count));
        let number = index as u32;
        let numbers = [number, number + 1, number + 2, number + 3];
        *batch.pair.four_at(count) = L::pack_indices(&numbers, packing);
        *batch.i.four_at(count) = L::pack_indices(four.i_image, packing).map(|code| code >> 5);
        *batch.j.four_at(count) = L::pack_indices(four.j, packing);
        *batch.to.four_at(count) = L::pack_indices(four.to, packing);
        count += usize::from(BITS[mask]);
        index += 4;
    }
    batch.close(count);
    index.min(end)
}

/// Normals, overlaps, relative velocities, masses, radii and lever arms of the contacts of a batch.
#[inline(always)]
pub(crate) fn gather_kinematics<S: Space, T: Arithmetic, L: Lanes>(
    batch: &mut Batch<T>,
    list: &View<'_>,
    at: &Evaluation<'_>,
    composition: &Composition,
) {
    let context = &composition.context;
    let conventions = &context.conventions;
    let slips = composition.reads.contains(Columns::TANGENTIAL_VELOCITY);
    let spins = composition.reads.contains(Columns::RELATIVE_SPIN);
    let with_radius = composition.reads.contains(Columns::REDUCED_RADIUS);
    let (slip_arm, torque_arm) =
        (L::splat(share(conventions.pair_slip_arm)), L::splat(share(conventions.pair_torque_arm)));
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let same_mass = context.reduced_mass.is_single().then(|| L::splat(context.reduced_mass.max));
    let same_radius = context.reduced_radius.is_single().then(|| L::splat(context.reduced_radius.max));
    assert!((batch.largest(&batch.i) as usize) < list.position.own.len(), "a batch has bodies of the tile");
    assert!((batch.largest(&batch.j) as usize) < list.position.all.len(), "a batch has bodies of the run");
    for g in 0..batch.groups() {
        let (i, j) = (batch.i.four(g).map(|i| i as usize), batch.j.four(g).map(|j| j as usize));
        // Coincident centres get the x direction as normal: any choice is as good, and this one keeps action and
        // reaction opposite and the run reproducible.
        let squared = L::load(batch.distance_squared.four(g));
        let distance = squared.sqrt();
        let inverse = one / squared.if_equal(zero, one, distance);
        let x = L::load(batch.separation[0].four(g)) * inverse;
        let n = [
            squared.if_equal(zero, one, x),
            L::load(batch.separation[1].four(g)) * inverse,
            L::load(batch.separation[2].four(g)) * inverse,
        ];
        let depth = L::load(batch.touching_distance.four(g)) - distance;
        T::store(depth, batch.overlap.four_mut(g));
        for axis in 0..3 {
            T::store(n[axis], batch.normal[axis].four_mut(g));
        }

        // SAFETY: all i and j were compared above with the number of rows, which is the same for all columns of a list.
        let relative =
            |i, j| unsafe { row::<L>(list.velocity.own, i) - row::<L>(list.velocity.all, j).flip_last() };
        let rows = [relative(i[0], j[0]), relative(i[1], j[1]), relative(i[2], j[2]), relative(i[3], j[3])];
        let [vx, vy, third, inverse_mass] = L::transpose(rows);
        let v = [vx, vy, if S::PLANAR { zero } else { third }];
        let along = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
        T::store(zero - along, batch.normal_velocity.four_mut(g));
        let mass = match same_mass {
            Some(mass) => mass,
            None => one / inverse_mass,
        };
        T::store(mass, batch.reduced_mass.four_mut(g));
        if !S::ROTATION && !slips && !with_radius {
            continue;
        }

        let (radius_i, radius_j) = match at.radius {
            Some(radius) => (L::splat(radius), L::splat(radius)),
            None => (nth_of::<L, 3>(list.position.own, i), nth_of::<L, 3>(list.position.all, j)),
        };
        if with_radius {
            let radius = match same_radius {
                Some(radius) => radius,
                None => radius_i * radius_j / (radius_i + radius_j),
            };
            T::store(radius, batch.reduced_radius.four_mut(g));
        }
        let mut surface = [zero; 3];
        if S::ROTATION {
            let shortening = torque_arm * depth;
            (radius_i - shortening).store(batch.arm[0].four_mut(g));
            (radius_j - shortening).store(batch.arm[1].four_mut(g));
            if slips || spins {
                let shortening = slip_arm * depth;
                let (arm_i, arm_j) = (radius_i - shortening, radius_j - shortening);
                let relative_spin;
                (surface, relative_spin) = if S::PLANAR {
                    let (wi, wj) =
                        (nth_of::<L, 2>(list.velocity.own, i), nth_of::<L, 2>(list.velocity.all, j));
                    ([zero, zero, arm_i * wi + arm_j * wj], [zero, zero, wi - wj])
                } else {
                    // Three-dimensional rotation has spin rows.
                    assert_eq!(list.spin.all.len(), list.position.all.len());
                    // SAFETY: as for the velocities.
                    let (wi, wj) = unsafe { (four::<L>(list.spin.own, i), four::<L>(list.spin.all, j)) };
                    surface_and_spin(wi, wj, arm_i, arm_j, spins)
                };
                if spins {
                    for axis in 0..3 {
                        T::store(relative_spin[axis], batch.relative_spin[axis].four_mut(g));
                    }
                }
            }
        }
        if slips {
            let [sx, sy, sz] = surface;
            let t = [
                v[0] - along * n[0] + (n[1] * sz - n[2] * sy),
                v[1] - along * n[1] + (n[2] * sx - n[0] * sz),
                v[2] - along * n[2] + (n[0] * sy - n[1] * sx),
            ];
            for axis in 0..3 {
                T::store(t[axis], batch.tangential_velocity[axis].four_mut(g));
            }
        }
    }
}

/// Four rows.
///
/// # Safety
/// All of `at` are less than the number of rows.
#[inline(always)]
unsafe fn four<L: Lanes>(rows: &[Row], at: [usize; 4]) -> [L; 4] {
    // SAFETY: that is what the caller promises.
    unsafe { [row(rows, at[0]), row(rows, at[1]), row(rows, at[2]), row(rows, at[3])] }
}

/// Numbers of the same place in four rows.
#[inline(always)]
fn nth_of<L: Lanes, const N: usize>(rows: &[Row], at: [usize; 4]) -> L {
    L::load(&[rows[at[0]][N], rows[at[1]][N], rows[at[2]][N], rows[at[3]][N]])
}

/// a_i ω_i + a_j ω_j, and ω_i - ω_j if wanted. The sum is made of rows: one transposition instead of two.
#[inline(always)]
fn surface_and_spin<L: Lanes>(a: [L; 4], b: [L; 4], arm_i: L, arm_j: L, spins: bool) -> ([L; 3], [L; 3]) {
    let (mut arms_i, mut arms_j) = ([0.0; 4], [0.0; 4]);
    arm_i.store(&mut arms_i);
    arm_j.store(&mut arms_j);
    let [x, y, z, _] = L::transpose([
        L::splat(arms_i[0]) * a[0] + L::splat(arms_j[0]) * b[0],
        L::splat(arms_i[1]) * a[1] + L::splat(arms_j[1]) * b[1],
        L::splat(arms_i[2]) * a[2] + L::splat(arms_j[2]) * b[2],
        L::splat(arms_i[3]) * a[3] + L::splat(arms_j[3]) * b[3],
    ]);
    let relative = if spins {
        let [x, y, z, _] = L::transpose([a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]);
        [x, y, z]
    } else {
        [L::splat(0.0); 3]
    };
    ([x, y, z], relative)
}
