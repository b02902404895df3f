//! The two levels of arithmetic, and what a thread works with.

use std::sync::{Arc, Mutex, MutexGuard};

use granule_law_api::{Real, Stage};
use granule_plan::{Plan, Precision, Scheme, StagePlan};
use granule_state::{InstructionSet, Lanes, Row};

use crate::chunk::Batch;
use crate::error::EngineError;
use crate::space::{PlaneRotating, PlaneSmooth, SpaceRotating, SpaceSmooth};
use crate::tile::{Evaluation, Tile};

/// Scalar type with its stages in a plan, and its way between memory and lanes.
pub(crate) trait Arithmetic: Real {
    /// The compiled stage of this type.
    fn stage(plan: &StagePlan) -> Option<Arc<dyn Stage<Self>>>;
    /// Four numbers of a column.
    fn load<L: Lanes>(values: &[Self; 4]) -> L;
    /// Four numbers to a column, rounded to this type.
    fn store<L: Lanes>(lanes: L, to: &mut [Self; 4]);
}

impl Arithmetic for f64 {
    fn stage(plan: &StagePlan) -> Option<Arc<dyn Stage<Self>>> {
        Some(plan.double.clone())
    }
    #[inline(always)]
    fn load<L: Lanes>(values: &[Self; 4]) -> L {
        L::load(values)
    }
    #[inline(always)]
    fn store<L: Lanes>(lanes: L, to: &mut [Self; 4]) {
        lanes.store(to);
    }
}

impl Arithmetic for f32 {
    fn stage(plan: &StagePlan) -> Option<Arc<dyn Stage<Self>>> {
        plan.single.clone()
    }
    #[inline(always)]
    fn load<L: Lanes>(values: &[Self; 4]) -> L {
        L::load_single(values)
    }
    #[inline(always)]
    fn store<L: Lanes>(lanes: L, to: &mut [Self; 4]) {
        lanes.store_single(to);
    }
}

/// Stages of all compositions and one batch a thread.
pub(crate) struct Arena<T> {
    pub stages: Vec<Vec<Arc<dyn Stage<T>>>>,
    batches: Vec<Mutex<Box<Batch<T>>>>,
    /// For contacts that are looked at one by one.
    singles: Vec<Mutex<Box<Batch<T>>>>,
}

impl<T: Arithmetic> Arena<T> {
    fn new(plan: &Plan, threads: usize) -> Result<Self, EngineError> {
        let compiled = |stage: &StagePlan| {
            T::stage(stage).ok_or_else(|| {
                EngineError::Search(format!(
                    "{} was not compiled for the precision of the plan",
                    stage.law.info.name
                ))
            })
        };
        let stages = plan
            .compositions
            .iter()
            .map(|composition| composition.stages.iter().map(compiled).collect())
            .collect::<Result<_, _>>()?;
        let width = history_width(plan);
        let batches = |count: usize| (0..count).map(|_| Mutex::new(Box::new(Batch::new(width)))).collect();
        let singles = if plan.driver.scheme == Scheme::ContactResolved { threads } else { 0 };
        Ok(Self { stages, batches: batches(threads), singles: batches(singles) })
    }

    /// The batch of the current thread. A panic in a law poisons the lock of a batch, whose contents do not matter.
    pub fn batch(&self) -> MutexGuard<'_, Box<Batch<T>>> {
        of_thread(&self.batches)
    }

    /// A batch of the current thread for one contact; only a scheme that resolves contacts has it.
    pub fn single(&self) -> MutexGuard<'_, Box<Batch<T>>> {
        of_thread(&self.singles)
    }
}

fn of_thread<T>(batches: &[Mutex<Box<Batch<T>>>]) -> MutexGuard<'_, Box<Batch<T>>> {
    let thread = rayon::current_thread_index().unwrap_or(0) % batches.len();
    batches[thread].lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Arithmetic and layout of a run.
pub(crate) struct Level {
    arithmetic: LevelArithmetic,
    planar: bool,
    rotation: bool,
    pub instructions: InstructionSet,
}

enum LevelArithmetic {
    Double(Arena<f64>),
    Single(Arena<f32>),
}

impl Level {
    pub fn new(
        plan: &Plan,
        planar: bool,
        threads: usize,
        instructions: InstructionSet,
    ) -> Result<Self, EngineError> {
        let arithmetic = match plan.precision {
            Precision::Double => LevelArithmetic::Double(Arena::new(plan, threads)?),
            Precision::Single => LevelArithmetic::Single(Arena::new(plan, threads)?),
        };
        Ok(Self { arithmetic, planar, rotation: plan.rotation, instructions })
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
        let set = self.instructions;
        match (self.planar, self.rotation) {
            (false, true) => {
                crate::dispatch::evaluate::<SpaceRotating, T>(set, tile, arena, at, force, torque)
            }
            (false, false) => {
                crate::dispatch::evaluate::<SpaceSmooth, T>(set, tile, arena, at, force, torque)
            }
            (true, true) => {
                crate::dispatch::evaluate::<PlaneRotating, T>(set, tile, arena, at, force, torque)
            }
            (true, false) => crate::dispatch::evaluate::<PlaneSmooth, T>(set, tile, arena, at, force, torque),
        }
    }
}

/// Widest history of all compositions.
pub(crate) fn history_width(plan: &Plan) -> usize {
    plan.compositions.iter().map(|composition| composition.history_width).max().unwrap_or(0)
}
