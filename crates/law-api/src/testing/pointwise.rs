//! Checks of a stage as a function: `finite`, `chunk`, `reads`, `writes`, `history`, `symmetry`, `precision`.

use super::{Case, Contacts, Report};
use crate::{CHUNK, Columns, Parity, Real, Slot, Stage};

/// A step in the order of a hundredth of a contact.
pub(super) const STEP: f64 = 1e-6;

/// All checks in one precision.
pub(super) fn check<T: Real>(case: &Case<'_>, stage: &dyn Stage<T>, report: &mut Report) {
    let width = case.law.info.history_width();
    let corners = grown(&corners::<T>(width), stage);
    let ordinary = grown(&ordinary::<T>(width), stage);
    finite(&corners, stage, report);
    for contacts in [&corners, &ordinary] {
        alone_and_together(contacts, stage, report);
    }
    undeclared_reads(case, &ordinary, stage, report);
    declared_writes(case, &ordinary, stage, report);
    frozen_history(&ordinary, stage, report);
    mirrored(&ordinary, stage, report);
    turned(&ordinary, stage, report);
    swapped(case, &ordinary, stage, report);
}

/// Single against double precision.
pub(super) fn compare(
    case: &Case<'_>,
    double: &dyn Stage<f64>,
    single: &dyn Stage<f32>,
    report: &mut Report,
) {
    let width = case.law.info.history_width();
    let mut wide = grown(&ordinary::<f64>(width), double);
    let mut narrow = grown(&ordinary::<f32>(width), single);
    wide.run(double, STEP);
    narrow.run(single, STEP);
    for ((name, _, a), (_, _, b)) in wide.outputs().iter().zip(narrow.outputs()) {
        let scale = largest(a);
        for k in 0..a.len() {
            // A few dozen roundings of 6e-8, and sums in which a digit or two cancel.
            if (a[k] - f64::from(b[k])).abs() > 3e-4 * scale {
                return report.fail(
                    "precision",
                    format!(
                        "{name} is {} in double and {} in single precision for {}",
                        a[k],
                        b[k],
                        wide.describe(k)
                    ),
                );
            }
        }
    }
}

fn finite<T: Real>(contacts: &Contacts<T>, stage: &dyn Stage<T>, report: &mut Report) {
    for time_step in [STEP, 0.0] {
        let mut after = contacts.clone();
        after.run(stage, time_step);
        for (name, _, column) in after.outputs() {
            if let Some(k) = column.iter().position(|value| !value.wide().is_finite()) {
                report.fail("finite", format!("{name} becomes {:?} for {}", column[k], contacts.describe(k)));
                return;
            }
        }
    }
}

fn alone_and_together<T: Real>(contacts: &Contacts<T>, stage: &dyn Stage<T>, report: &mut Report) {
    let mut together = contacts.clone();
    together.run(stage, STEP);
    let places: Vec<usize> = (0..contacts.len()).collect();
    let backwards: Vec<usize> = places.iter().rev().copied().collect();
    let mut groups: Vec<Vec<usize>> = places.iter().map(|&k| vec![k]).collect();
    groups.push(backwards);
    // Lengths around the widths of vector registers.
    for length in [2, 3, 5, 7, 8, 9, 15, 17, 31, 33, 63, 65, 127] {
        groups.push(places.iter().copied().skip(length).take(length).collect());
    }
    for group in groups {
        let mut part = contacts.select(&group);
        part.run(stage, STEP);
        let expected = together.select(&group);
        if let Some((name, k)) = difference(&part, &expected, identical) {
            report.fail(
                "chunk",
                format!(
                    "{name} depends on the company: it differs in a chunk of {} from a chunk of {} for {}",
                    group.len(),
                    contacts.len(),
                    contacts.select(&group).describe(k)
                ),
            );
            return;
        }
    }
}

fn undeclared_reads<T: Real>(
    case: &Case<'_>,
    contacts: &Contacts<T>,
    stage: &dyn Stage<T>,
    report: &mut Report,
) {
    let declared = (case.law.reads)(case.params);
    let mut plain = contacts.clone();
    plain.run(stage, STEP);
    let mut masked = contacts.clone();
    let nan = T::of(f64::NAN);
    let hide = |column: Columns, values: &mut [&mut Vec<T>]| {
        if !declared.contains(column) {
            for values in values {
                values.fill(nan);
            }
        }
    };
    let [vx, vy, vz] = &mut masked.tangential_velocity;
    hide(Columns::TANGENTIAL_VELOCITY, &mut [vx, vy, vz]);
    let [wx, wy, wz] = &mut masked.relative_spin;
    hide(Columns::RELATIVE_SPIN, &mut [wx, wy, wz]);
    hide(Columns::REDUCED_MASS, &mut [&mut masked.reduced_mass]);
    hide(Columns::REDUCED_RADIUS, &mut [&mut masked.reduced_radius]);
    hide(Columns::NORMAL_VELOCITY, &mut [&mut masked.normal_velocity]);
    // A cohesion law adds to the normal force that it finds.
    let written = case.law.info.writes;
    if !written.contains(Columns::NORMAL_FORCE) {
        hide(Columns::NORMAL_FORCE, &mut [&mut masked.normal_force]);
    }
    if !written.contains(Columns::NORMAL_STIFFNESS) {
        hide(Columns::NORMAL_STIFFNESS, &mut [&mut masked.normal_stiffness]);
    }
    if !written.contains(Columns::NORMAL_DAMPING) {
        hide(Columns::NORMAL_DAMPING, &mut [&mut masked.normal_damping]);
    }
    masked.run(stage, STEP);
    for ((name, set, found), (_, _, expected)) in masked.outputs().iter().zip(plain.outputs()) {
        if set.is_some_and(|set| !written.contains(set)) {
            continue;
        }
        if let Some(k) = (0..found.len()).find(|&k| !identical(found[k], expected[k])) {
            report.fail(
                "reads",
                format!(
                    "{name} changes when columns other than {:?} change, for {}",
                    declared.names(),
                    contacts.describe(k)
                ),
            );
            return;
        }
    }
}

fn declared_writes<T: Real>(
    case: &Case<'_>,
    contacts: &Contacts<T>,
    stage: &dyn Stage<T>,
    report: &mut Report,
) {
    let info = case.law.info;
    let adds = matches!(info.slot, Slot::Cohesion | Slot::Rolling | Slot::Torsion);
    let run = |mark: f64| {
        let mark = T::of(mark);
        let mut marked = contacts.clone();
        for (set, column) in [
            (Columns::NORMAL_FORCE, &mut marked.normal_force),
            (Columns::NORMAL_STIFFNESS, &mut marked.normal_stiffness),
            (Columns::NORMAL_DAMPING, &mut marked.normal_damping),
        ] {
            // What a law reads stays; what it writes alone starts from the mark.
            if info.writes.contains(set) && !adds {
                column.fill(mark);
            }
        }
        for axis in 0..3 {
            if !adds {
                marked.torque[axis].fill(mark);
            }
            marked.tangential_force[axis].fill(mark);
        }
        for column in [&mut marked.elastic, &mut marked.viscous, &mut marked.friction] {
            column.fill(mark);
        }
        let before = marked.clone();
        marked.run(stage, STEP);
        (before, marked)
    };
    let (before, first) = run(12345.0);
    let (_, second) = run(-54321.0);
    let columns = before.outputs().into_iter().zip(first.outputs()).zip(second.outputs());
    for (((name, set, before), (_, _, first)), (_, _, second)) in columns {
        let may = set.is_none_or(|set| info.writes.contains(set));
        for k in 0..before.len() {
            if !may && !identical(before[k], first[k]) {
                report.fail(
                    "writes",
                    format!("{name} is written but not declared, for {}", contacts.describe(k)),
                );
                return;
            }
            if may && !identical(first[k], second[k]) {
                report.fail(
                    "writes",
                    format!("{name} depends on what was in the column before, for {}", contacts.describe(k)),
                );
                return;
            }
        }
    }
    // Without the optional columns and the energy account the rest is the same.
    let mut bare = contacts.clone();
    bare.run_with(stage, STEP, !info.writes.contains(Columns::NORMAL_STIFFNESS), false);
    let mut full = contacts.clone();
    full.run(stage, STEP);
    bare.normal_stiffness.clone_from(&full.normal_stiffness);
    bare.normal_damping.clone_from(&full.normal_damping);
    bare.elastic.clone_from(&full.elastic);
    bare.viscous.clone_from(&full.viscous);
    bare.friction.clone_from(&full.friction);
    bare.slipped.clone_from(&full.slipped);
    if let Some((name, k)) = difference(&bare, &full, identical) {
        report.fail(
            "writes",
            format!("{name} depends on whether optional columns are there, for {}", contacts.describe(k)),
        );
    }
}

fn frozen_history<T: Real>(contacts: &Contacts<T>, stage: &dyn Stage<T>, report: &mut Report) {
    let mut after = contacts.clone();
    after.run(stage, 0.0);
    for (index, (before, after)) in contacts.history.iter().zip(&after.history).enumerate() {
        if let Some(k) = (0..before.len()).find(|&k| !identical(before[k], after[k])) {
            report.fail(
                "history",
                format!(
                    "history column {index} goes from {:?} to {:?} in a step of no time, for {}",
                    before[k],
                    after[k],
                    contacts.describe(k)
                ),
            );
            return;
        }
    }
}

/// Sign changes of the axes commute with every operation: outputs must follow exactly.
fn mirrored<T: Real>(contacts: &Contacts<T>, stage: &dyn Stage<T>, report: &mut Report) {
    let mut plain = contacts.clone();
    plain.run(stage, STEP);
    for signs in [[-1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, -1.0], [-1.0, -1.0, 1.0], [-1.0, -1.0, -1.0]]
    {
        let map = |contacts: &Contacts<T>| mapped(contacts, [0, 1, 2], signs);
        let mut mirror = map(contacts);
        mirror.run(stage, STEP);
        let expected = map(&plain);
        if let Some((name, k)) = difference(&mirror, &expected, |a, b| a == b) {
            report.fail(
                "symmetry",
                format!(
                    "{name} does not follow a frame whose axes have the signs {signs:?}, for {}",
                    contacts.describe(k)
                ),
            );
            return;
        }
    }
}

/// Exchanging axes changes the order of additions, so round-off is allowed.
fn turned<T: Real>(contacts: &Contacts<T>, stage: &dyn Stage<T>, report: &mut Report) {
    let mut plain = contacts.clone();
    plain.run(stage, STEP);
    for order in [[1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]] {
        let map = |contacts: &Contacts<T>| mapped(contacts, order, [1.0; 3]);
        let mut turn = map(contacts);
        turn.run(stage, STEP);
        let expected = map(&plain);
        for ((name, _, a), (_, _, b)) in turn.outputs().iter().zip(expected.outputs()) {
            // Sums of a few terms of either sign: some hundred ulps of the largest value in the column.
            let allowed = 500.0 * T::EPSILON.wide() * largest(b);
            if let Some(k) = (0..a.len()).find(|&k| (a[k].wide() - b[k].wide()).abs() > allowed) {
                report.fail(
                    "symmetry",
                    format!(
                        "{name} does not follow a frame with the axes {order:?}, for {}",
                        contacts.describe(k)
                    ),
                );
                return;
            }
        }
    }
}

fn swapped<T: Real>(case: &Case<'_>, contacts: &Contacts<T>, stage: &dyn Stage<T>, report: &mut Report) {
    let swap = |contacts: &Contacts<T>| {
        let mut other = contacts.clone();
        for vectors in [
            &mut other.normal,
            &mut other.tangential_velocity,
            &mut other.relative_spin,
            &mut other.tangential_force,
            &mut other.torque,
        ] {
            for column in vectors {
                negate(column);
            }
        }
        let parities = case
            .law
            .info
            .history
            .iter()
            .flat_map(|column| std::iter::repeat_n(column.parity, column.components));
        for (column, parity) in other.history.iter_mut().zip(parities) {
            if parity == Parity::Odd {
                negate(column);
            }
        }
        other
    };
    let mut plain = contacts.clone();
    plain.run(stage, STEP);
    let mut other = swap(contacts);
    other.run(stage, STEP);
    if let Some((name, k)) = difference(&other, &swap(&plain), |a, b| a == b) {
        report.fail(
            "symmetry",
            format!(
                "{name} is not opposite and equal when i and j are swapped, for {}",
                contacts.describe(k)
            ),
        );
    }
}

fn negate<T: Real>(column: &mut [T]) {
    for value in column {
        *value = -*value;
    }
}

/// The contacts in a frame whose axis `a` is axis `order[a]` of the old one, times `signs[a]`. Spin and torque are axial
/// vectors. Vector history columns are turned with the frame.
fn mapped<T: Real>(contacts: &Contacts<T>, order: [usize; 3], signs: [f64; 3]) -> Contacts<T> {
    let even = matches!(order, [0, 1, 2] | [1, 2, 0] | [2, 0, 1]);
    let handedness = signs.iter().product::<f64>() * if even { 1.0 } else { -1.0 };
    let turn = |vectors: &[Vec<T>; 3], axial: bool| -> [Vec<T>; 3] {
        std::array::from_fn(|axis| {
            let sign = T::of(signs[axis] * if axial { handedness } else { 1.0 });
            vectors[order[axis]].iter().map(|value| *value * sign).collect()
        })
    };
    let mut out = contacts.clone();
    out.normal = turn(&contacts.normal, false);
    out.tangential_velocity = turn(&contacts.tangential_velocity, false);
    out.relative_spin = turn(&contacts.relative_spin, true);
    out.tangential_force = turn(&contacts.tangential_force, false);
    out.torque = turn(&contacts.torque, true);
    if let [x, y, z] = &contacts.history[..] {
        out.history = turn(&[x.clone(), y.clone(), z.clone()], false).to_vec();
    }
    out
}

fn identical<T: Real>(a: T, b: T) -> bool {
    a.wide().to_bits() == b.wide().to_bits()
}

fn difference<T: Real>(
    a: &Contacts<T>,
    b: &Contacts<T>,
    equal: impl Fn(T, T) -> bool,
) -> Option<(String, usize)> {
    let (a, b) = (a.outputs(), b.outputs());
    a.iter().zip(&b).find_map(|((name, _, a), (_, _, b))| {
        (0..a.len()).find(|&k| !equal(a[k], b[k])).map(|k| (name.clone(), k))
    })
}

fn largest<T: Real>(column: &[T]) -> f64 {
    column.iter().fold(0.0, |largest: f64, value| largest.max(value.wide().abs()))
}

/// The contacts after a few steps: with a history that the law itself has written.
fn grown<T: Real>(contacts: &Contacts<T>, stage: &dyn Stage<T>) -> Contacts<T> {
    let mut run = contacts.clone();
    for _ in 0..3 {
        // Inputs that the stage may also write are given anew in every step.
        run.normal_force.clone_from(&contacts.normal_force);
        run.torque.clone_from(&contacts.torque);
        run.run(stage, STEP);
    }
    let mut grown = contacts.clone();
    grown.history = run.history;
    grown
}

/// A sequence of numbers in [-1, 1) without pattern, the same in every run.
pub(super) struct Sequence(u64);

impl Sequence {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(super) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64) / (1u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> [f64; 3] {
        [self.next(), self.next(), self.next()]
    }
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let size = dot(v, v).sqrt();
    v.map(|component| component / size)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Fills the kinematics of contact `k`: a normal, and slip and spin of the given sizes.
fn place<T: Real>(contacts: &mut Contacts<T>, k: usize, random: &mut Sequence, slip: f64, spin: f64) {
    let normal = match k % 5 {
        0 => [0.0, 0.0, 1.0],
        1 => [-1.0, 0.0, 0.0],
        _ => unit(random.vector()),
    };
    let any = random.vector();
    let along = dot(any, normal);
    let tangent = unit([0, 1, 2].map(|axis| any[axis] - along * normal[axis]));
    let axis_of_spin = unit(random.vector());
    for axis in 0..3 {
        contacts.normal[axis][k] = T::of(normal[axis]);
        contacts.tangential_velocity[axis][k] = T::of(tangent[axis] * slip);
        contacts.relative_spin[axis][k] = T::of(axis_of_spin[axis] * spin);
    }
}

/// Contacts of everyday size.
fn ordinary<T: Real>(history_width: usize) -> Contacts<T> {
    let mut contacts = Contacts::new(CHUNK, history_width);
    let mut random = Sequence::new(1);
    for k in 0..CHUNK {
        let slip = 0.5 * random.next().abs();
        place(&mut contacts, k, &mut random, slip, 100.0);
        contacts.overlap[k] = T::of(super::IMPACT.reduced_radius * (1e-4 + 0.01 * random.next().abs()));
        contacts.normal_velocity[k] = T::of(0.5 * random.next());
        contacts.reduced_mass[k] = T::of(super::IMPACT.reduced_mass * (1.0 + 0.5 * random.next()));
        contacts.reduced_radius[k] = T::of(super::IMPACT.reduced_radius * (1.0 + 0.5 * random.next()));
        contacts.normal_force[k] = T::of(1.0 + 2.0 * random.next());
        contacts.normal_stiffness[k] = T::of(super::NORMAL_STIFFNESS * (1.0 + 0.5 * random.next()));
        contacts.normal_damping[k] = T::of(0.5 * (1.0 + random.next()));
    }
    contacts
}

/// Contacts of every size from denormal to huge, with numbers that occur in single precision too.
pub(super) fn corners<T: Real>(history_width: usize) -> Contacts<T> {
    const OVERLAP: [f64; 7] = [5e-324, 1e-310, 1e-45, 1e-38, 1e-12, 1e-5, 1.0];
    const SPEED: [f64; 11] = [0.0, -0.0, 5e-324, 1e-45, -1e-38, 1e-20, -1e-9, 1.0, -1.0, 1e6, -1e6];
    const FACTOR: [f64; 5] = [1e-6, 1e-3, 1.0, 1e3, 1e6];
    let mut contacts = Contacts::new(CHUNK, history_width);
    let mut random = Sequence::new(2);
    for k in 0..CHUNK {
        let slip = SPEED[(k / 7 + k / 77) % 11];
        place(&mut contacts, k, &mut random, slip, 1e3 * SPEED[(k / 3) % 11]);
        contacts.overlap[k] = T::of(OVERLAP[k % 7]);
        contacts.normal_velocity[k] = T::of(SPEED[k % 11]);
        contacts.reduced_mass[k] = T::of(super::IMPACT.reduced_mass * FACTOR[(k / 5) % 5]);
        contacts.reduced_radius[k] = T::of(super::IMPACT.reduced_radius * FACTOR[k % 5]);
        contacts.normal_force[k] = T::of([0.0, -0.0, 1e-45, 1.0, -1.0, 1e9][k % 6]);
        contacts.normal_stiffness[k] = T::of([0.0, 1e-3, 1e5, 1e10][k % 4]);
        contacts.normal_damping[k] = T::of([0.0, 1e-9, 1.0, 1e3][(k / 4) % 4]);
    }
    contacts
}
