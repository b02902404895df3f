//! From rows to columns, and the two levels of arithmetic.

use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard};

use granule_law_api::{Columns, Real, Stage};
use granule_plan::{Composition, Plan, Precision, StagePlan};
use granule_state::Row;

use crate::chunk::{BATCH, Batch, OWN, share};
use crate::error::EngineError;
use crate::prefetch::prefetch;
use crate::space::{PlaneRotating, PlaneSmooth, Space, SpaceRotating, SpaceSmooth};
use crate::tile::{Evaluation, Pair, Shared, Tile};

/// Scalar type with its stages in a plan.
pub(crate) trait Arithmetic: Real {
    /// The compiled stage of this type.
    fn stage(plan: &StagePlan) -> Option<Arc<dyn Stage<Self>>>;
}

impl Arithmetic for f64 {
    fn stage(plan: &StagePlan) -> Option<Arc<dyn Stage<Self>>> {
        Some(plan.double.clone())
    }
}

impl Arithmetic for f32 {
    fn stage(plan: &StagePlan) -> Option<Arc<dyn Stage<Self>>> {
        plan.single.clone()
    }
}

/// Stages of all compositions and one batch a thread.
pub(crate) struct Arena<T> {
    pub stages: Vec<Vec<Arc<dyn Stage<T>>>>,
    batches: Vec<Mutex<Box<Batch<T>>>>,
}

impl<T: Arithmetic> Arena<T> {
    fn new(plan: &Plan, threads: usize) -> Result<Self, EngineError> {
        let stages = plan
            .compositions
            .iter()
            .map(|composition| {
                composition
                    .stages
                    .iter()
                    .map(|stage| {
                        T::stage(stage).ok_or_else(|| {
                            EngineError::Search(format!(
                                "{} was not compiled for the precision of the plan",
                                stage.law.info.name
                            ))
                        })
                    })
                    .collect()
            })
            .collect::<Result<_, _>>()?;
        let width = history_width(plan);
        let batches = (0..threads).map(|_| Mutex::new(Box::new(Batch::new(width)))).collect();
        Ok(Self { stages, batches })
    }

    /// The batch of the current thread. A panic in a law poisons the lock of a batch, whose contents do not matter.
    pub fn batch(&self) -> MutexGuard<'_, Box<Batch<T>>> {
        let thread = rayon::current_thread_index().unwrap_or(0) % self.batches.len();
        self.batches[thread].lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// Arithmetic and layout of a run.
pub(crate) struct Level {
    arithmetic: LevelArithmetic,
    planar: bool,
    rotation: bool,
}

enum LevelArithmetic {
    Double(Arena<f64>),
    Single(Arena<f32>),
}

impl Level {
    pub fn new(plan: &Plan, planar: bool, threads: usize) -> Result<Self, EngineError> {
        let arithmetic = match plan.precision {
            Precision::Double => LevelArithmetic::Double(Arena::new(plan, threads)?),
            Precision::Single => LevelArithmetic::Single(Arena::new(plan, threads)?),
        };
        Ok(Self { arithmetic, planar, rotation: plan.rotation })
    }

    pub fn evaluate(&self, tile: &mut Tile, at: &Evaluation<'_>, force: &mut [Row], torque: &mut [Row]) {
        match &self.arithmetic {
            LevelArithmetic::Double(arena) => self.evaluate_with(tile, arena, at, force, torque),
            LevelArithmetic::Single(arena) => self.evaluate_with(tile, arena, at, force, torque),
        }
    }

    fn evaluate_with<T: Arithmetic>(
        &self,
        tile: &mut Tile,
        arena: &Arena<T>,
        at: &Evaluation<'_>,
        force: &mut [Row],
        torque: &mut [Row],
    ) {
        match (self.planar, self.rotation) {
            (false, true) => crate::dispatch::evaluate::<SpaceRotating, T>(tile, arena, at, force, torque),
            (false, false) => crate::dispatch::evaluate::<SpaceSmooth, T>(tile, arena, at, force, torque),
            (true, true) => crate::dispatch::evaluate::<PlaneRotating, T>(tile, arena, at, force, torque),
            (true, false) => crate::dispatch::evaluate::<PlaneSmooth, T>(tile, arena, at, force, torque),
        }
    }

    pub fn receive(&self, tile: usize, tiles: &[Tile], force: &mut [Row], torque: &mut [Row]) {
        let inbox = &tiles[tile].inbox;
        match (self.planar, self.rotation) {
            (false, true) => Tile::receive::<SpaceRotating>(inbox, tiles, force, torque),
            (false, false) => Tile::receive::<SpaceSmooth>(inbox, tiles, force, torque),
            (true, true) => Tile::receive::<PlaneRotating>(inbox, tiles, force, torque),
            (true, false) => Tile::receive::<PlaneSmooth>(inbox, tiles, force, torque),
        }
    }
}

/// Widest history of all compositions.
pub(crate) fn history_width(plan: &Plan) -> usize {
    plan.compositions.iter().map(|composition| composition.history_width).max().unwrap_or(0)
}

/// How many pairs ahead the position of a second body is fetched.
const AHEAD: usize = 24;

/// Fills a batch with pairs of `range` that touch; returns where to go on.
#[inline(always)]
pub(crate) fn gather_pairs<T: Real>(
    batch: &mut Batch<T>,
    pairs: &[Pair],
    range: Range<usize>,
    own: &Range<usize>,
    outgoing: &mut u32,
    at: &Evaluation<'_>,
    reach: f64,
) -> usize {
    let position = at.bodies.position;
    let own_position = &position[own.clone()];
    let mut count = 0;
    let mut index = range.start;
    for pair in &pairs[range] {
        if let Some(ahead) = pairs.get(index + AHEAD) {
            prefetch(position, ahead.j as usize);
        }
        prefetch(at.bodies.velocity, pair.j as usize);
        prefetch(at.bodies.spin, pair.j as usize);
        let (i, image) = (pair.i_image >> 5, (pair.i_image & 31) as usize);
        let a = &own_position[i as usize].0;
        let b = &position[pair.j as usize].0;
        let shift = &at.shifts[image];
        let d = [a[0] - b[0] - shift[0], a[1] - b[1] - shift[1], a[2] - b[2] - shift[2]];
        let squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        let touching = a[3] + b[3];
        let cross = !own.contains(&(pair.j as usize));
        // Written for every candidate and kept only for those that touch: no branch to mispredict. The mask tells the
        // compiler that no column is left.
        let k = count & (BATCH - 1);
        batch.separation[0][k] = d[0];
        batch.separation[1][k] = d[1];
        batch.separation[2][k] = d[2];
        batch.distance_squared[k] = squared;
        batch.touching_distance[k] = touching;
        batch.arm[0][k] = a[3];
        batch.arm[1][k] = b[3];
        batch.pair[k] = index as u32;
        batch.i[k] = i;
        batch.j[k] = pair.j;
        batch.outgoing[k] = if cross { *outgoing } else { OWN };
        *outgoing += u32::from(cross);
        let limit = touching + reach;
        count += usize::from(squared < limit * limit);
        index += 1;
        if count == BATCH {
            break;
        }
    }
    batch.count = count;
    index
}

/// Gathers velocities, masses and radii of a batch of pairs; turns radii into lever arms.
#[inline(always)]
pub(crate) fn gather_kinematics<S: Space, T: Real>(
    batch: &mut Batch<T>,
    own: &Range<usize>,
    bodies: &Shared<'_>,
    composition: &Composition,
) {
    let slips = composition.reads.contains(Columns::TANGENTIAL_VELOCITY);
    let spins = composition.reads.contains(Columns::RELATIVE_SPIN);
    let count = batch.len();
    let own_velocity = &bodies.velocity[own.clone()];
    for k in 0..count {
        let (a, b) = (&own_velocity[batch.i[k] as usize], &bodies.velocity[batch.j[k] as usize]);
        for axis in 0..S::COMPONENTS {
            batch.velocity[axis][k] = a[axis] - b[axis];
        }
        batch.inverse_mass[k] = a[3] + b[3];
    }
    let context = &composition.context;
    if context.reduced_mass.is_single() {
        batch.reduced_mass[..count].fill(T::of(context.reduced_mass.max));
    } else {
        for k in 0..count {
            batch.reduced_mass[k] = T::of(1.0 / batch.inverse_mass[k]);
        }
    }
    if composition.reads.contains(Columns::REDUCED_RADIUS) {
        if context.reduced_radius.is_single() {
            batch.reduced_radius[..count].fill(T::of(context.reduced_radius.max));
        } else {
            let [a, b] = &batch.arm;
            for k in 0..count {
                batch.reduced_radius[k] = T::of(a[k] * b[k] / (a[k] + b[k]));
            }
        }
    }
    if S::ROTATION && (slips || spins) {
        let conventions = &context.conventions;
        let (slip, torque) = (share(conventions.pair_slip_arm), share(conventions.pair_torque_arm));
        for k in 0..count {
            let (i, j) = (own.start + batch.i[k] as usize, batch.j[k] as usize);
            let (wi, wj) = (bodies.spin::<S>(i), bodies.spin::<S>(j));
            let shortening = slip * batch.depth[k];
            let (arm_i, arm_j) = (batch.arm[0][k] - shortening, batch.arm[1][k] - shortening);
            for axis in 0..3 {
                batch.surface_velocity[axis][k] = arm_i * wi[axis] + arm_j * wj[axis];
            }
            if spins {
                for axis in 0..3 {
                    batch.relative_spin[axis][k] = T::of(wi[axis] - wj[axis]);
                }
            }
        }
        for k in 0..count {
            batch.arm[0][k] -= torque * batch.depth[k];
            batch.arm[1][k] -= torque * batch.depth[k];
        }
    }
}
