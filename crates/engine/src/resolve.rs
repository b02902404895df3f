//! Contacts that begin or end within a step.
//!
//! Velocity Verlet takes the impulse of a contact in a step as half of its force at the beginning plus half of that at the
//! end. Where a contact begins or ends in between, or where the law clips its force to zero, that is wrong by as much as
//! the force changes. For such a contact alone the law is evaluated at some moments of the part of the step in which it
//! acts, and what the trapezoid lacks is given to both bodies as an impulse, so that momentum is conserved. Springs are
//! wound from the moment of touch on. Who has touched before is found from the motion in the step, which the rows of
//! accelerations tell exactly, so that nothing is kept for contacts that go on.

mod marks;
mod path;

use granule_law_api::{Columns, ContactEnd, Slot, Stage};
use granule_plan::Composition;
use granule_state::Bodies;
use nalgebra::{Matrix3x2, Vector3};
use std::sync::Arc;

pub(crate) use marks::{Marks, RangeMarks};
pub(crate) use path::{Path, StepRows};

use self::path::Kinematics;
use crate::chunk::Batch;
use crate::history::PairHistory;
use crate::level::{Arena, Arithmetic};
use crate::tally::Tally;
use crate::tile::Evaluation;

/// Two points at which the mean of a cubic is exact, as a law is smooth from touch on.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_13, 0.788_675_134_594_812_9];
/// Moments of a part in which the law may clip its force: a kink between two of them does little harm.
const MIDDLES: [f64; 4] = [0.125, 0.375, 0.625, 0.875];

/// Force and torque of the laws on i: the columns.
type Wrench = Matrix3x2<f64>;

/// An impulse on two bodies of the run, or on one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Impulse {
    pub i: u32,
    /// None at a wall.
    pub j: Option<u32>,
    /// Impulse on i \[N s\]; body j gets its opposite.
    pub linear: Vector3<f64>,
    /// Angular impulses on i and j \[N m s\].
    pub angular: [Vector3<f64>; 2],
}

impl Impulse {
    /// Acts on the bodies.
    pub fn act(&self, bodies: &mut Bodies) {
        bodies.give(self.i as usize, self.linear.into(), self.angular[0].into());
        if let Some(j) = self.j {
            bodies.give(j as usize, (-self.linear).into(), self.angular[1].into());
        }
    }
}

/// Energies that a contact loses \[J\] beyond what the trapezoid says, by slot.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Losses {
    /// By viscous (or plastic) dissipation.
    pub viscous: [f64; Slot::ALL.len()],
    /// By friction.
    pub friction: [f64; Slot::ALL.len()],
}

/// Powers of one evaluation of the law, as the columns of a matrix of slots.
#[derive(Clone, Copy, Default)]
struct Answer {
    wrench: Wrench,
    viscous: [f64; Slot::ALL.len()],
    friction: [f64; Slot::ALL.len()],
}

impl Answer {
    fn add(&mut self, other: &Self, weight: f64) {
        self.wrench += other.wrench * weight;
        for slot in 0..Slot::ALL.len() {
            self.viscous[slot] += weight * other.viscous[slot];
            self.friction[slot] += weight * other.friction[slot];
        }
    }
}

/// The laws of one composition for one contact at a time.
pub(crate) struct Resolver<'a, T> {
    /// One contact.
    pub single: &'a mut Batch<T>,
    pub composition: &'a Composition,
    pub stages: &'a [Arc<dyn Stage<T>>],
    pub time_step: f64,
    pub ledger: bool,
    pub impulses: &'a mut Vec<Impulse>,
    pub tally: &'a mut Tally,
}

impl<'a, T: Arithmetic> Resolver<'a, T> {
    pub fn new(
        single: &'a mut Batch<T>,
        arena: &'a Arena<T>,
        index: usize,
        at: &Evaluation<'a>,
        impulses: &'a mut Vec<Impulse>,
        tally: &'a mut Tally,
    ) -> Self {
        Self {
            single,
            composition: &at.compositions[index],
            stages: &arena.stages[index],
            time_step: at.time_step,
            ledger: at.ledger,
            impulses,
            tally,
        }
    }

    /// A pair that touched at the beginning of the step and does not at its end.
    pub fn ended(&mut self, path: &Path, history: Option<&[f64]>, bodies: (u32, Option<u32>)) {
        let reach = self.composition.reach;
        let [first, last] = path.overlaps().map(|overlap| overlap + reach);
        if first <= 0.0 {
            return;
        }
        let part = first / (first - last);
        let first = self.law(path, 0.0, 0.0, history);
        let points: &[f64] = match self.composition.contact_end {
            // Without force, only what the contact still stores is lost.
            ContactEnd::Force if first.wrench == Wrench::zeros() && !self.ledger => return,
            ContactEnd::Force => &MIDDLES,
            ContactEnd::Overlap => &GAUSS,
        };
        let mut lacking = Answer::default();
        lacking.add(&first, -0.5);
        for point in points {
            let answer = self.law(path, point * part, self.after_middle(point * part), history);
            lacking.add(&answer, part / points.len() as f64);
        }
        self.give(&lacking, path, bodies);
    }

    /// Looks whether contact `k` of a batch, which touches at the end of the step, has begun in it or has come to its end of
    /// force. `history` is that of the beginning of the step.
    pub fn touching(
        &mut self,
        batch: &mut Batch<T>,
        k: usize,
        path: &Path,
        history: Option<&[f64]>,
        bodies: (u32, Option<u32>),
    ) {
        let reach = self.composition.reach;
        let [first, last] = path.overlaps().map(|overlap| overlap + reach);
        if first <= 0.0 && last > 0.0 {
            self.begun(batch, k, path, -first / (last - first), bodies);
        } else if first > 0.0 && self.composition.contact_end == ContactEnd::Force && batch.is_clipped(k) {
            let first = self.law(path, 0.0, 0.0, history);
            if first.wrench == Wrench::zeros() {
                return;
            }
            let mut lacking = Answer::default();
            lacking.add(&first, -0.5);
            if self.ledger {
                // The force of the end is none, but the law loses there what the contact still stores.
                let last = self.law(path, 1.0, self.after_middle(1.0), history);
                lacking.add(&last, -0.5);
            }
            for middle in MIDDLES {
                let answer = self.law(path, middle, self.after_middle(middle), history);
                lacking.add(&answer, 1.0 / MIDDLES.len() as f64);
            }
            self.give(&lacking, path, bodies);
        }
    }

    /// Springs are stored as wound up to the middle of the step: time by which they are wound on from there, twice, as half
    /// of it follows the force.
    fn after_middle(&self, q: f64) -> f64 {
        2.0 * (q - 0.5).max(0.0) * self.time_step
    }

    /// A contact that has begun after a part `from` of the step. Row `k` gets the forces and the history that it has then.
    fn begun(&mut self, batch: &mut Batch<T>, k: usize, path: &Path, from: f64, bodies: (u32, Option<u32>)) {
        let part = 1.0 - from;
        let mut lacking = Answer::default();
        for point in GAUSS {
            let answer = self.law(path, from + part * point, 2.0 * part * point * self.time_step, None);
            lacking.add(&answer, 0.5 * part);
        }
        if self.ledger {
            // The row as it was computed with a spring wound over the whole step is taken back.
            let mut taken = Tally::default();
            self.run(path, 1.0, self.time_step, None, Some(&mut taken));
            self.tally.add_energies(&taken, -1.0);
        }
        let mut new = Tally::default();
        let ledger = self.ledger.then_some(&mut new);
        let wound = part * self.time_step;
        let half = 0.5 * self.time_step;
        // Half of the time of a call winds springs before the force is taken, half of it afterwards.
        let end = if self.composition.history_width == 0 {
            self.run(path, 1.0, self.time_step, None, ledger)
        } else if wound > half {
            self.run(path, 1.0, wound - half, None, None);
            self.keep(batch, k);
            self.run_on(path, batch, k, self.time_step, ledger)
        } else {
            self.run(path, 1.0, 2.0 * wound, None, ledger)
        };
        batch.normal_force[k] = self.single.normal_force[0];
        for axis in 0..3 {
            batch.tangential_force[axis][k] = self.single.tangential_force[axis][0];
            batch.contact_torque[axis][k] = self.single.contact_torque[axis][0];
        }
        self.keep(batch, k);
        if self.composition.history_width > 0 && wound < half {
            self.run_on(path, batch, k, half - wound, None);
            self.keep(batch, k);
        }
        if self.ledger {
            self.tally.add_energies(&new, 1.0);
        }
        let last = Answer { wrench: end, viscous: new.viscous, friction: new.friction };
        lacking.add(&last, -0.5);
        self.give(&lacking, path, bodies);
    }

    /// Copies the history of the single contact to row `k`.
    fn keep(&self, batch: &mut Batch<T>, k: usize) {
        for (to, from) in batch.history.iter_mut().zip(&self.single.history) {
            to[k] = from[0];
        }
    }

    /// The law at the end of the step with the history of row `k`.
    fn run_on(
        &mut self,
        path: &Path,
        batch: &Batch<T>,
        k: usize,
        time_step: f64,
        tally: Option<&mut Tally>,
    ) -> Wrench {
        for (to, from) in self.single.history.iter_mut().zip(&batch.history) {
            to[0] = from[k];
        }
        self.evaluate(path, 1.0, time_step, tally)
    }

    /// The law after a part `q` of the step, with powers; `wound` is the time by which springs are wound. Without a spring a law
    /// uses the step to bound its force: friction that stops at rest would not be bounded by no time.
    fn law(&mut self, path: &Path, q: f64, wound: f64, history: Option<&[f64]>) -> Answer {
        let time_step = if self.composition.history_width == 0 { self.time_step } else { wound };
        if !self.ledger {
            return Answer { wrench: self.run(path, q, time_step, history, None), ..Answer::default() };
        }
        let mut tally = Tally::default();
        let wrench = self.run(path, q, time_step, history, Some(&mut tally));
        Answer { wrench, viscous: tally.viscous, friction: tally.friction }
    }

    fn run(
        &mut self,
        path: &Path,
        q: f64,
        time_step: f64,
        history: Option<&[f64]>,
        tally: Option<&mut Tally>,
    ) -> Wrench {
        for (column, to) in self.single.history.iter_mut().enumerate() {
            to[0] =
                history.map_or(T::ZERO, |values| values.get(column).map_or(T::ZERO, |value| T::of(*value)));
        }
        self.evaluate(path, q, time_step, tally)
    }

    fn evaluate(&mut self, path: &Path, q: f64, time_step: f64, tally: Option<&mut Tally>) -> Wrench {
        let state = path.at(q);
        let single = &mut *self.single;
        single.count = 1;
        single.overlap[0] = T::of(state.overlap);
        single.normal_velocity[0] = T::of(state.normal_velocity);
        single.reduced_mass[0] = T::of(path.reduced_mass);
        single.reduced_radius[0] = T::of(path.reduced_radius);
        for axis in 0..3 {
            single.normal[axis][0] = T::of(state.normal[axis]);
            single.tangential_velocity[axis][0] = T::of(state.tangential_velocity[axis]);
            single.relative_spin[axis][0] = T::of(state.relative_spin[axis]);
        }
        single.run(self.composition, self.stages, time_step, tally);
        self.wrench(&state)
    }

    fn wrench(&self, state: &Kinematics) -> Wrench {
        let writes = self.composition.writes;
        let single = &*self.single;
        let vector = |column: Columns, values: &[crate::chunk::Column<T>; 3]| {
            if writes.contains(column) {
                Vector3::new(values[0][0].wide(), values[1][0].wide(), values[2][0].wide())
            } else {
                Vector3::zeros()
            }
        };
        let tangential = vector(Columns::TANGENTIAL_FORCE, &single.tangential_force);
        let torque = vector(Columns::TORQUE, &single.contact_torque);
        Wrench::from_columns(&[state.normal * single.normal_force[0].wide() + tangential, torque])
    }

    fn give(&mut self, lacking: &Answer, path: &Path, (i, j): (u32, Option<u32>)) {
        let impulse = lacking.wrench * self.time_step;
        let (linear, torque) = (impulse.column(0).into_owned(), impulse.column(1).into_owned());
        // With the arms of the end of the step, where the impulse acts, the angular momentum of a pair is conserved.
        let end = path.at(1.0);
        let turning = end.normal.cross(&linear);
        let angular = [torque - turning * end.arms[0], -torque - turning * end.arms[1]];
        self.impulses.push(Impulse { i, j, linear, angular });
        if self.ledger {
            for slot in 0..Slot::ALL.len() {
                self.tally.lacking.viscous[slot] += lacking.viscous[slot] * self.time_step;
                self.tally.lacking.friction[slot] += lacking.friction[slot] * self.time_step;
            }
        }
    }
}

/// History of pair `pair` of a list at the beginning of the step.
pub(crate) fn history_before(history: &PairHistory, pair: u32, now: u32) -> Option<&[f64]> {
    history.get(pair as usize, now.wrapping_sub(1))
}
