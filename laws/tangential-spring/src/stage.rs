//! The loop.

use granule_law_api::{
    ContactChunk, Conventions, CoulombCap, CoulombTest, HistoryUpdate, Real, Stage, VelocityRule, vectorised,
};

use crate::forms::{Damping, Model, Stiffness};

/// Contacts whose stiffness, damping and limit are worked out before the main loop runs over them: few enough to stay in
/// registers' reach, many enough to pay for the choice of formulas.
const BLOCK: usize = 32;
/// The same for chunks of a few contacts, whose arrays would take longer to clear than the loop takes.
const FEW: usize = 8;

const ROTATE: u8 = 0;
const ROTATE_IF_TILTED: u8 = 1;
const PROJECT: u8 = 2;
const SPRING_THEN_TOTAL: u8 = 0;
const TOTAL: u8 = 1;
const SPRING_ONLY: u8 = 2;

struct Spring<T, const UPDATE: u8, const TEST: u8, const DAMPED: bool> {
    stiffness: (Stiffness, T),
    damping: (Damping, T),
    friction: T,
    repulsive: bool,
    /// Share of the step by which the slip velocity winds the spring before the force is taken; the rest winds it after.
    /// With synchronised velocities half and half is the trapezoidal rule, which keeps the second order of the scheme;
    /// a velocity of the middle of the step winds it once.
    before: T,
}

pub(crate) fn compile<T: Real>(model: &Model, conventions: &Conventions) -> Box<dyn Stage<T>> {
    match conventions.history_update {
        HistoryUpdate::RotateThenIncrement => with_update::<T, ROTATE>(model, conventions),
        HistoryUpdate::RotateIfTiltedThenIncrement => with_update::<T, ROTATE_IF_TILTED>(model, conventions),
        HistoryUpdate::IncrementThenProject => with_update::<T, PROJECT>(model, conventions),
    }
}

fn with_update<T: Real, const UPDATE: u8>(model: &Model, conventions: &Conventions) -> Box<dyn Stage<T>> {
    match conventions.coulomb_test {
        CoulombTest::SpringThenTotal => with_test::<T, UPDATE, SPRING_THEN_TOTAL>(model, conventions),
        CoulombTest::Total => with_test::<T, UPDATE, TOTAL>(model, conventions),
        CoulombTest::SpringOnly => with_test::<T, UPDATE, SPRING_ONLY>(model, conventions),
    }
}

fn with_test<T: Real, const UPDATE: u8, const TEST: u8>(
    model: &Model,
    conventions: &Conventions,
) -> Box<dyn Stage<T>> {
    if model.damping == Damping::Zero {
        vectorised(Spring::<T, UPDATE, TEST, false>::new(model, conventions))
    } else {
        vectorised(Spring::<T, UPDATE, TEST, true>::new(model, conventions))
    }
}

impl<T: Real, const UPDATE: u8, const TEST: u8, const DAMPED: bool> Spring<T, UPDATE, TEST, DAMPED> {
    fn new(model: &Model, conventions: &Conventions) -> Self {
        let stiffness = match model.stiffness {
            Stiffness::Fixed(value)
            | Stiffness::Mass(value)
            | Stiffness::Normal(value)
            | Stiffness::ContactRadius(value) => value,
        };
        let damping = match model.damping {
            Damping::Zero => 0.0,
            Damping::Fixed(value)
            | Damping::Mass(value)
            | Damping::Normal(value)
            | Damping::MassContactRadius(value)
            | Damping::Critical(value) => value,
        };
        Self {
            stiffness: (model.stiffness, T::of(stiffness)),
            damping: (model.damping, T::of(damping)),
            friction: T::of(model.friction),
            repulsive: conventions.coulomb_cap == CoulombCap::Repulsive,
            before: match conventions.velocity {
                VelocityRule::Synchronised | VelocityRule::Extrapolated => T::of(0.5),
                VelocityRule::HalfStep => T::ONE,
            },
        }
    }

    /// Stiffness, damping and Coulomb limit of the contacts of one block.
    #[inline(always)]
    fn coefficients<const N: usize>(
        &self,
        chunk: &ContactChunk<'_, T>,
        start: usize,
        block: &mut Block<T, N>,
        n: usize,
    ) {
        let stiffness = &mut block.stiffness[..n];
        let damping = &mut block.damping[..n];
        let limit = &mut block.limit[..n];
        let overlap = &chunk.overlap[start..][..n];
        let (rule, factor) = self.stiffness;
        match rule {
            Stiffness::Fixed(_) => stiffness.fill(factor),
            Stiffness::Mass(_) => scale(stiffness, factor, &chunk.reduced_mass[start..][..n]),
            Stiffness::Normal(_) => scale(stiffness, factor, &chunk.normal_stiffness[start..][..n]),
            Stiffness::ContactRadius(_) => {
                let radius = &chunk.reduced_radius[start..][..n];
                for k in 0..n {
                    stiffness[k] = factor * (radius[k] * overlap[k].max(T::ZERO)).sqrt();
                }
            }
        }
        let (rule, factor) = self.damping;
        match rule {
            Damping::Zero => {}
            Damping::Fixed(_) => damping.fill(factor),
            Damping::Mass(_) => scale(damping, factor, &chunk.reduced_mass[start..][..n]),
            Damping::Normal(_) => scale(damping, factor, &chunk.normal_damping[start..][..n]),
            Damping::MassContactRadius(_) => {
                let mass = &chunk.reduced_mass[start..][..n];
                let radius = &chunk.reduced_radius[start..][..n];
                for k in 0..n {
                    damping[k] = factor * mass[k] * (radius[k] * overlap[k].max(T::ZERO)).sqrt();
                }
            }
            Damping::Critical(_) => {
                let mass = &chunk.reduced_mass[start..][..n];
                for k in 0..n {
                    damping[k] = factor * (stiffness[k] * mass[k]).sqrt();
                }
            }
        }
        let force = &chunk.normal_force[start..][..n];
        if self.friction == T::of(f64::INFINITY) {
            // Where the normal force ends the contact, nothing holds the spring any more.
            for k in 0..n {
                limit[k] = if force[k] == T::ZERO { T::ZERO } else { self.friction };
            }
        } else if self.repulsive {
            for k in 0..n {
                limit[k] = self.friction * force[k].max(T::ZERO);
            }
        } else {
            for k in 0..n {
                limit[k] = self.friction * force[k].abs();
            }
        }
    }

    /// Spring before and after the step's slip.
    #[inline(always)]
    fn advance(&self, spring: [T; 3], n: [T; 3], slip: [T; 3], threshold: T) -> ([T; 3], [T; 3]) {
        if UPDATE == PROJECT {
            return (spring, tangent(add(spring, slip), n));
        }
        let flat = tangent(spring, n);
        let (before, after) = (dot(spring, spring), dot(flat, flat));
        // Squares of very short springs underflow; they turn without their length being restored.
        let ratio = if after > T::ZERO { before / after } else { T::ONE };
        let turned = times(flat, ratio.sqrt());
        let turned = if UPDATE == ROTATE_IF_TILTED {
            let tilted = dot(spring, n).abs() > threshold;
            [
                if tilted { turned[0] } else { spring[0] },
                if tilted { turned[1] } else { spring[1] },
                if tilted { turned[2] } else { spring[2] },
            ]
        } else {
            turned
        };
        (turned, add(turned, slip))
    }

    /// Spring after the Coulomb test, force (opposite to that on i), share of the damper that acts, and whether the contact
    /// slides.
    #[inline(always)]
    fn hold(&self, spring: [T; 3], velocity: [T; 3], k: T, gamma: T, limit: T) -> Held<T> {
        let damper = if DAMPED { times(velocity, gamma) } else { [T::ZERO; 3] };
        if TEST == TOTAL {
            let trial = add(times(spring, k), damper);
            let (slides, cut) = cut(trial, limit);
            let empty = !self.repulsive && slides && dot(spring, spring) == T::ZERO;
            let force = times(trial, if empty { T::ZERO } else { cut });
            // What the damper leaves of the limit. A spring of next to no stiffness would be wound up beyond all numbers.
            let wound = ((T::ONE - cut) / k).min(T::ONE / T::EPSILON);
            let wound = wound.keep_if(k > T::ZERO && slides && !empty);
            let kept = times(spring, cut);
            let spring = if DAMPED { add(kept, times(damper, -wound)) } else { kept };
            return Held { spring, force, damper: if empty { T::ZERO } else { T::ONE }, slides };
        }
        let (slides, share) = cut(times(spring, k), limit);
        let spring = times(spring, share);
        let elastic = times(spring, k);
        if TEST == SPRING_ONLY {
            let damper_share = if slides { T::ZERO } else { T::ONE };
            let force = if DAMPED { add(elastic, times(damper, damper_share)) } else { elastic };
            return Held { spring, force, damper: damper_share, slides };
        }
        if !DAMPED {
            return Held { spring, force: elastic, damper: T::ZERO, slides };
        }
        let total = add(elastic, damper);
        let (over, share) = cut(total, limit);
        Held { spring, force: times(total, share), damper: share, slides: slides || over }
    }
}

struct Held<T> {
    spring: [T; 3],
    force: [T; 3],
    damper: T,
    slides: bool,
}

/// What is worked out for the contacts of one block before and in the main loop. The loop writes here and not to the columns
/// of the chunk: the compiler knows that these arrays overlap nothing else and turns the loop into vector code.
struct Block<T, const N: usize> {
    stiffness: [T; N],
    damping: [T; N],
    limit: [T; N],
    force: [[T; N]; 3],
    spring: [[T; N]; 3],
    /// Elastic energy, viscous and frictional power, energy lost by sliding.
    energy: [[T; N]; 4],
}

impl<T: Real, const UPDATE: u8, const TEST: u8, const DAMPED: bool> Stage<T>
    for Spring<T, UPDATE, TEST, DAMPED>
{
    #[inline(always)]
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        if chunk.len() > FEW { self.run_blocks::<BLOCK>(chunk) } else { self.run_blocks::<FEW>(chunk) }
    }
}

/// Copies the results of a block to the columns of the chunk.
#[inline(always)]
fn store<T: Real, const N: usize>(
    chunk: &mut ContactChunk<'_, T>,
    start: usize,
    block: &Block<T, N>,
    n: usize,
) {
    for (column, values) in chunk.tangential_force.iter_mut().zip(&block.force) {
        column[start..][..n].copy_from_slice(&values[..n]);
    }
    if chunk.time_step > T::ZERO {
        for (column, values) in chunk.history.iter_mut().zip(&block.spring) {
            column[start..][..n].copy_from_slice(&values[..n]);
        }
    }
    if let Some(energy) = &mut chunk.energy {
        energy.elastic[start..][..n].copy_from_slice(&block.energy[0][..n]);
        energy.viscous[start..][..n].copy_from_slice(&block.energy[1][..n]);
        energy.friction[start..][..n].copy_from_slice(&block.energy[2][..n]);
        energy.slipped[start..][..n].copy_from_slice(&block.energy[3][..n]);
    }
}

impl<T: Real, const UPDATE: u8, const TEST: u8, const DAMPED: bool> Spring<T, UPDATE, TEST, DAMPED> {
    #[inline(always)]
    fn run_blocks<const N: usize>(&self, chunk: &mut ContactChunk<'_, T>) {
        let zeros = [T::ZERO; N];
        let mut block = Block {
            stiffness: zeros,
            damping: zeros,
            limit: zeros,
            force: [zeros; 3],
            spring: [zeros; 3],
            energy: [zeros; 4],
        };
        let total = chunk.len();
        let mut start = 0;
        while start < total {
            let n = (total - start).min(N);
            self.coefficients(chunk, start, &mut block, n);
            if chunk.energy.is_some() {
                self.run_block::<true, N>(chunk, start, &mut block, n);
            } else {
                self.run_block::<false, N>(chunk, start, &mut block, n);
            }
            store(chunk, start, &block, n);
            start += n;
        }
    }

    #[inline(always)]
    fn run_block<const ENERGY: bool, const N: usize>(
        &self,
        chunk: &ContactChunk<'_, T>,
        start: usize,
        block: &mut Block<T, N>,
        n: usize,
    ) {
        let dt = chunk.time_step;
        let (dt_before, dt_after) = (self.before * dt, (T::ONE - self.before) * dt);
        let moves = dt > T::ZERO;
        let overlap = &chunk.overlap[start..][..n];
        let [sx, sy, sz] = &*chunk.history else {
            panic!("TangentialSpring has three history columns, not {}", chunk.history.len());
        };
        let (nx, ny, nz) = part(chunk.normal, start, n);
        let (vx, vy, vz) = part(chunk.tangential_velocity, start, n);
        let (sx, sy, sz) = part([sx, sy, sz], start, n);
        let (stiffness, damping, limits) = (&block.stiffness[..n], &block.damping[..n], &block.limit[..n]);
        let [fx, fy, fz] = &mut block.force;
        let (fx, fy, fz) = (&mut fx[..n], &mut fy[..n], &mut fz[..n]);
        let [kx, ky, kz] = &mut block.spring;
        let (kx, ky, kz) = (&mut kx[..n], &mut ky[..n], &mut kz[..n]);
        let [elastic, viscous, friction, slipped] = &mut block.energy;
        let (elastic, viscous) = (&mut elastic[..n], &mut viscous[..n]);
        let (friction, slipped) = (&mut friction[..n], &mut slipped[..n]);
        let normal_velocity = if ENERGY { &chunk.normal_velocity[start..][..n] } else { overlap };
        let stiffens = ENERGY && matches!(self.stiffness.0, Stiffness::ContactRadius(_));
        let radius = if stiffens { &chunk.reduced_radius[start..][..n] } else { overlap };
        for k in 0..n {
            let normal = [nx[k], ny[k], nz[k]];
            let velocity = [vx[k], vy[k], vz[k]];
            let spring = [sx[k], sy[k], sz[k]];
            let touches = overlap[k] > T::ZERO;
            let (kt, limit) = (stiffness[k], limits[k]);
            // LAMMPS turns the spring only if its force out of the tangent plane exceeds 1e-10 of the limit.
            let threshold = if self.friction < T::of(f64::INFINITY) { T::of(1e-10) * limit } else { T::ZERO };
            let threshold = if kt > T::ZERO { threshold / kt } else { T::ZERO };
            let (before, trial) = self.advance(spring, normal, times(velocity, dt_before), threshold);
            let held = self.hold(trial, velocity, kt, damping[k], limit);
            let kept = add(held.spring, times(velocity, dt_after));
            fx[k] = (-held.force[0]).keep_if(touches);
            fy[k] = (-held.force[1]).keep_if(touches);
            fz[k] = (-held.force[2]).keep_if(touches);
            kx[k] = kept[0].keep_if(touches);
            ky[k] = kept[1].keep_if(touches);
            kz[k] = kept[2].keep_if(touches);
            if ENERGY {
                let stored = times(held.spring, kt);
                let half = T::of(0.5);
                elastic[k] = (half * dot(stored, held.spring)).keep_if(touches);
                let damped =
                    if DAMPED { held.damper * damping[k] * dot(velocity, velocity) } else { T::ZERO };
                // What the step wound up and the limit took away again, at the mean of the forces of the spring before and
                // after: with it the account closes to second order, whatever the limit does meanwhile.
                let begun = add(before, times(velocity, -dt_after));
                let cut_off = add(trial, times(held.spring, -T::ONE));
                let mean = add(begun, held.spring);
                // A spring that was and stays empty is so to round-off.
                let noise = T::of(16.0) * T::EPSILON;
                let stretched = dot(mean, mean) > noise * noise * dot(trial, trial);
                let lost = half * kt * dot(mean, cut_off);
                slipped[k] = lost.keep_if(held.slides && touches && moves && stretched);
                // A force that the limit cuts below that of the spring takes up less than the spring gives.
                let beyond = if TEST == SPRING_THEN_TOTAL && DAMPED {
                    dot(held.force, velocity) - damped - dot(stored, velocity)
                } else {
                    T::ZERO
                };
                friction[k] = beyond.keep_if(held.slides && touches);
                // A stiffness that follows the contact radius changes the stored energy without work.
                let stiffening = if stiffens {
                    // Overlaps below the resolution of positions have no rate.
                    let resolved = overlap[k].max(T::EPSILON * radius[k]);
                    -(half * half) * dot(stored, held.spring) * normal_velocity[k] / resolved
                } else {
                    T::ZERO
                };
                viscous[k] = (damped + stiffening).keep_if(touches);
            }
        }
    }
}

/// `n` contacts from `start` of a vector column. Not `map`: the compiler would lose sight of the lengths.
#[inline(always)]
fn part<T>(columns: [&[T]; 3], start: usize, n: usize) -> (&[T], &[T], &[T]) {
    let [x, y, z] = columns;
    (&x[start..][..n], &y[start..][..n], &z[start..][..n])
}

#[inline(always)]
fn scale<T: Real>(out: &mut [T], factor: T, by: &[T]) {
    for (out, by) in out.iter_mut().zip(by) {
        *out = factor * *by;
    }
}

/// Whether a force exceeds the limit, and the factor that cuts it to the limit.
#[inline(always)]
fn cut<T: Real>(force: [T; 3], limit: T) -> (bool, T) {
    let size = dot(force, force).sqrt();
    let over = size > limit;
    (over, if over { limit / size } else { T::ONE })
}

#[inline(always)]
fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn add<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn times<T: Real>(a: [T; 3], factor: T) -> [T; 3] {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

/// Part of `a` in the plane normal to the unit vector `n`.
#[inline(always)]
fn tangent<T: Real>(a: [T; 3], n: [T; 3]) -> [T; 3] {
    add(a, times(n, -dot(a, n)))
}
