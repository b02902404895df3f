//! From rows of bodies to columns of contacts, four contacts at a time.

use granule_law_api::Columns;
use granule_plan::Composition;
use granule_state::{Lanes, PACKED, Row};

use crate::chunk::{BATCH, Batch, share};
use crate::level::Arithmetic;
use crate::prefetch::prefetch;
use crate::space::Space;
use crate::tile::{Evaluation, Pair};

/// How many pairs ahead the position of a second body is fetched.
const AHEAD: usize = 24;

/// Number of bits of a mask of four.
const BITS: [u8; 16] = [0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4];

/// Fills a batch with those of `pairs` from `next` on that touch; returns where to go on. `own` are the positions of the
/// bodies i.
#[inline(always)]
pub(crate) fn find_contacts<T: Arithmetic, L: Lanes>(
    batch: &mut Batch<T>,
    pairs: &[Pair],
    next: usize,
    own: &[Row],
    at: &Evaluation<'_>,
    reach: f64,
) -> usize {
    let position = at.bodies.position;
    let reach = L::splat(reach);
    let mut count = 0;
    let mut index = next;
    while count <= BATCH - 4 && index < pairs.len() {
        let rest = &pairs[index..];
        let mut group = [rest[0]; 4];
        let listed = match rest.first_chunk::<4>() {
            Some(four) => {
                group = *four;
                15
            }
            None => {
                group[..rest.len()].copy_from_slice(rest);
                (1 << rest.len()) - 1
            }
        };
        if let Some(ahead) = rest.get(AHEAD..AHEAD + 4) {
            for pair in ahead {
                prefetch(position, pair.j as usize);
            }
        }
        for pair in &group {
            prefetch(at.bodies.velocity, pair.j as usize);
            prefetch(at.bodies.spin, pair.j as usize);
        }
        let rows = [
            separation::<L>(&group[0], own, at),
            separation(&group[1], own, at),
            separation(&group[2], own, at),
            separation(&group[3], own, at),
        ];
        let [x, y, z, touching] = L::transpose(rows);
        let squared = x * x + y * y + z * z;
        let limit = touching + reach;
        let mask = squared.less(limit * limit) & listed;
        // Those that touch are packed to the front and the rest is overwritten by the next group: no branch to mispredict.
        x.pack(mask).store(batch.separation[0].four_at(count));
        y.pack(mask).store(batch.separation[1].four_at(count));
        z.pack(mask).store(batch.separation[2].four_at(count));
        squared.pack(mask).store(batch.distance_squared.four_at(count));
        touching.pack(mask).store(batch.touching_distance.four_at(count));
        *batch.pair.four_at(count) = PACKED[mask].map(|lane| index as u32 + u32::from(lane));
        count += usize::from(BITS[mask]);
        index += 4;
    }
    batch.close(count);
    index.min(pairs.len())
}

/// Separation of the centres, and the sum of the radii behind it.
#[inline(always)]
fn separation<L: Lanes>(pair: &Pair, own: &[Row], at: &Evaluation<'_>) -> L {
    let a = L::load(&own[pair.place()].0);
    let b = L::load(&at.bodies.position[pair.j as usize].0);
    a - b.flip_last() - L::load(&at.shifts[pair.image()].0)
}

/// Normals, overlaps, relative velocities, masses, radii and lever arms of the contacts of a batch.
#[inline(always)]
pub(crate) fn gather_kinematics<S: Space, T: Arithmetic, L: Lanes>(
    batch: &mut Batch<T>,
    pairs: &[Pair],
    targets: &[u32],
    own: std::ops::Range<usize>,
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
    let bodies = at.bodies;
    let own_velocity = &bodies.velocity[own.clone()];
    let own_position = &bodies.position[own.clone()];
    for g in 0..batch.groups() {
        let numbers = batch.pair.four(g);
        let group = [
            pairs[numbers[0] as usize],
            pairs[numbers[1] as usize],
            pairs[numbers[2] as usize],
            pairs[numbers[3] as usize],
        ];
        let to = [
            targets[numbers[0] as usize],
            targets[numbers[1] as usize],
            targets[numbers[2] as usize],
            targets[numbers[3] as usize],
        ];
        let i = group.map(|pair| pair.place());
        let j = group.map(|pair| pair.j as usize);
        *batch.i.four_mut(g) = i.map(|place| place as u32);
        *batch.to.four_mut(g) = to;

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

        let rows = [
            relative::<L>(&own_velocity[i[0]], &bodies.velocity[j[0]]),
            relative(&own_velocity[i[1]], &bodies.velocity[j[1]]),
            relative(&own_velocity[i[2]], &bodies.velocity[j[2]]),
            relative(&own_velocity[i[3]], &bodies.velocity[j[3]]),
        ];
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
            None => (last_of::<L>(own_position, i), last_of::<L>(bodies.position, j)),
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
                    let (wi, wj) = (third_of::<L>(own_velocity, i), third_of::<L>(bodies.velocity, j));
                    ([zero, zero, arm_i * wi + arm_j * wj], [zero, zero, wi - wj])
                } else {
                    let own_spin = &bodies.spin[own.clone()];
                    surface_and_spin(own_spin, bodies.spin, i, j, arm_i, arm_j, spins)
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

/// Difference of two vectors, and the sum of the numbers behind them.
#[inline(always)]
fn relative<L: Lanes>(a: &Row, b: &Row) -> L {
    L::load(&a.0) - L::load(&b.0).flip_last()
}

/// Last numbers of four rows.
#[inline(always)]
fn last_of<L: Lanes>(rows: &[Row], at: [usize; 4]) -> L {
    L::load(&[rows[at[0]][3], rows[at[1]][3], rows[at[2]][3], rows[at[3]][3]])
}

/// Third numbers of four rows.
#[inline(always)]
fn third_of<L: Lanes>(rows: &[Row], at: [usize; 4]) -> L {
    L::load(&[rows[at[0]][2], rows[at[1]][2], rows[at[2]][2], rows[at[3]][2]])
}

/// a_i ω_i + a_j ω_j, and ω_i - ω_j if wanted. The sum is made of rows: one transposition instead of two.
#[inline(always)]
fn surface_and_spin<L: Lanes>(
    own_spin: &[Row],
    spin: &[Row],
    i: [usize; 4],
    j: [usize; 4],
    arm_i: L,
    arm_j: L,
    spins: bool,
) -> ([L; 3], [L; 3]) {
    let (mut arms_i, mut arms_j) = ([0.0; 4], [0.0; 4]);
    arm_i.store(&mut arms_i);
    arm_j.store(&mut arms_j);
    let [a0, a1, a2, a3] = [
        L::load(&own_spin[i[0]].0),
        L::load(&own_spin[i[1]].0),
        L::load(&own_spin[i[2]].0),
        L::load(&own_spin[i[3]].0),
    ];
    let [b0, b1, b2, b3] =
        [L::load(&spin[j[0]].0), L::load(&spin[j[1]].0), L::load(&spin[j[2]].0), L::load(&spin[j[3]].0)];
    let [x, y, z, _] = L::transpose([
        L::splat(arms_i[0]) * a0 + L::splat(arms_j[0]) * b0,
        L::splat(arms_i[1]) * a1 + L::splat(arms_j[1]) * b1,
        L::splat(arms_i[2]) * a2 + L::splat(arms_j[2]) * b2,
        L::splat(arms_i[3]) * a3 + L::splat(arms_j[3]) * b3,
    ]);
    let relative = if spins {
        let [x, y, z, _] = L::transpose([a0 - b0, a1 - b1, a2 - b2, a3 - b3]);
        [x, y, z]
    } else {
        [L::splat(0.0); 3]
    };
    ([x, y, z], relative)
}
