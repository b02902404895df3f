//! Integration of a contact from its beginning to its end.

use std::ops::Range;

use crate::ReferenceError;
use crate::contact::{Contact, Kinematics, Response};

/// More steps than these are taken for no contact: at most some hundred are needed.
const MOST_STEPS: usize = 200_000;

/// Part of the contact's duration: moments at which its state changes are known this well. Forces may jump there.
const SHORTEST: f64 = 1e-9;
/// Part of the contact's duration in which it is asked whether it slides: long against the error of its spring.
const PROBE: f64 = 1e-7;
/// Part of the mean force of an impact below which there is none.
const FORCE: f64 = 1e-10;
/// Part of the impact speed below which slip is rest.
const REST: f64 = 1e-6;

/// Relative error of rounding of overlap and velocity.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Part of the contact's duration below which a state of the contact is an error of rounding and not told: a force about zero,
/// a spring at its limit, slip about rest.
const BRIEF: f64 = 1e-6;
/// So many steps are made shorter to find when a state changes, in the next part of the contact's duration. Changes that are of
/// no moment to the motion come in thousands.
const CHASES: usize = 100;
/// Part of the contact's duration.
const RARE: f64 = 1e-3;

/// What happens during a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// The contact point begins to slide.
    Slides,
    /// It sticks again.
    Sticks,
    /// The normal force has begun to push.
    Pushes,
    /// The normal force no longer pushes: it has vanished or attracts.
    PushesNoMore,
    /// The bodies begin to separate.
    Turns,
    /// The bodies approach again.
    Approaches,
    /// The contact ends.
    Ends,
}

impl EventKind {
    /// Which state it changes.
    fn pair(self) -> u8 {
        match self {
            Self::Slides | Self::Sticks => 0,
            Self::Pushes | Self::PushesNoMore => 1,
            Self::Turns | Self::Approaches => 2,
            Self::Ends => 3,
        }
    }
}

/// An event and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Time since the contact began \[s\].
    pub time: f64,
    /// What happens.
    pub kind: EventKind,
}

/// How bodies move: positions `P`, whose rates are the first velocities, and velocities `V`.
pub(crate) trait Mechanics {
    /// Number of positions and of velocities.
    const SIZE: (usize, usize);
    /// What the laws see.
    fn kinematics(&self, positions: &[f64], velocities: &[f64]) -> Kinematics;
    /// Rates of the velocities.
    fn accelerations(&self, at: &Kinematics, response: &Response, out: &mut [f64]);
    /// Groups of positions and velocities of one unit, with the least size against which errors count.
    fn groups(&self) -> Vec<(Range<usize>, f64)>;
}

/// How tight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accuracy {
    /// Error of a step, relative to the largest value of each group.
    pub tolerance: f64,
    /// Most substeps, which is the order.
    pub order: usize,
}

/// Where a contact leads.
#[derive(Clone, Debug)]
pub(crate) struct End {
    pub time: f64,
    pub velocities: Vec<f64>,
    pub maximum_overlap: f64,
    pub viscous: f64,
    pub friction: f64,
    pub events: Vec<Event>,
    /// Time, overlap and normal force at the end of every step.
    pub samples: Vec<(f64, f64, f64)>,
}

/// State of a contact that only changes at events.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Flags {
    slides: bool,
    pushes: bool,
    separates: bool,
    ended: bool,
}

struct Path<'a, M> {
    mechanics: &'a M,
    contact: &'a Contact<'a>,
    accuracy: Accuracy,
    groups: Vec<(Range<usize>, f64)>,
    /// Speed against which slip counts as rest \[m/s\].
    speed: f64,
    /// A time in the order of the contact's duration \[s\].
    scale: f64,
    /// A force in the order of the contact's \[N\].
    force: f64,
    /// By how much extrapolation magnifies errors of rounding.
    magnified: f64,
}

struct Trial {
    state: Vec<f64>,
    flags: Flags,
    at: Kinematics,
    response: Response,
    /// Error over tolerance.
    error: f64,
}

/// Integrates from touch with the given velocities. `scale` is a time in the order of the duration \[s\], `energy` the
/// kinetic energy that is in play \[J\], `speed` the impact speed \[m/s\].
pub(crate) fn integrate<M: Mechanics>(
    mechanics: &M,
    contact: &Contact<'_>,
    velocities: &[f64],
    accuracy: Accuracy,
    (scale, energy, speed): (f64, f64, f64),
) -> Result<End, ReferenceError> {
    let (positions, _) = M::SIZE;
    let width = contact.composition.history_width;
    let mut state = vec![0.0; positions];
    state.extend_from_slice(velocities);
    let history = state.len();
    state.resize(history + width + 2, 0.0);
    let mut groups = mechanics.groups();
    for stage in &contact.composition.stages {
        let mut next = history + stage.history_offset;
        for column in stage.law.info.history {
            groups.push((next..next + column.components, 0.0));
            next += column.components;
        }
    }
    groups.push((state.len() - 2..state.len(), energy));
    let force = 2.0 * energy / (speed * scale);
    let magnified = magnification(accuracy.order);
    let mut path = Path { mechanics, contact, accuracy, groups, speed, scale, force, magnified };
    path.learn(&state);
    path.run(state)
}

/// Substeps of row `index` of the extrapolation. Six at least: a law that stops slip knows the inertia of the bodies only up to
/// the overlap, so that a substep leaves a small share of the slip, and substeps a power of it, which is not the polynomial
/// that extrapolation stands on.
fn substeps_of(index: usize) -> usize {
    2 * index + 6
}

/// Sum of the absolute weights of the results with different numbers of substeps in the extrapolated one.
fn magnification(order: usize) -> f64 {
    let of = |index| substeps_of(index) as f64;
    let others = |j: usize| (0..order).filter(move |&i| i != j);
    (0..order).map(|j| others(j).map(|i| of(j) / (of(j) - of(i)).abs()).product::<f64>()).sum()
}

impl<M: Mechanics> Path<'_, M> {
    fn run(&mut self, mut state: Vec<f64>) -> Result<End, ReferenceError> {
        let scale = self.scale;
        let (shortest, latest) = (SHORTEST * scale, 1e4 * scale);
        let mut time = 1e-9 * scale;
        let first = self.extrapolate(&state, time);
        let mut flags = first.flags;
        state = first.state;
        let mut step = time;
        let (mut events, mut samples) = (Vec::new(), vec![sample(time, &first.at, &first.response)]);
        let mut largest: f64 = first.at.overlap;
        // Since when and how often changes of state were looked for.
        let (mut chase, mut rejected) = ((f64::NEG_INFINITY, 0), false);
        for _ in 0..MOST_STEPS {
            step = step.max(shortest);
            let mut trial = self.extrapolate(&state, step);
            if trial.state.iter().any(|value| !value.is_finite()) {
                return Err(ReferenceError::NotFinite(time));
            }
            let order = self.accuracy.order as f64;
            let factor = 0.9 * trial.error.max(1e-30).powf(-1.0 / order);
            if time > chase.0 + RARE * scale {
                chase = (time, 0);
            }
            let changed = trial.flags != flags && (trial.flags.ended || chase.1 < CHASES);
            if step > shortest && (changed || trial.error > 1.0) {
                chase.1 += usize::from(changed);
                step *= if changed { 0.25 } else { factor.max(0.1).min(0.7) };
                rejected = true;
                continue;
            }
            let taken = step;
            // A jump lies in the shortest step; beyond it the path is smooth again.
            if trial.error > 1.0 {
                trial = self.plain(&state, taken);
            }
            step *= match (changed || trial.error > 1.0, rejected) {
                (true, _) => 4.0,
                (false, true) => factor.max(0.2).min(1.0),
                (false, false) => factor.max(0.2).min(4.0),
            };
            rejected = false;
            time += taken;
            state = trial.state;
            self.learn(&state);
            largest = largest.max(trial.at.overlap);
            record(&mut events, time, flags, trial.flags);
            samples.push(sample(time, &trial.at, &trial.response));
            flags = trial.flags;
            if flags.ended {
                let (positions, velocities) = M::SIZE;
                return Ok(End {
                    time,
                    velocities: state[positions..positions + velocities].to_vec(),
                    maximum_overlap: largest,
                    viscous: state[state.len() - 2],
                    friction: state[state.len() - 1],
                    events: without_flutter(events, BRIEF * scale),
                    samples,
                });
            }
            if time > latest {
                break;
            }
        }
        Err(ReferenceError::NoEnd(time))
    }

    /// Remembers the largest values seen.
    fn learn(&mut self, state: &[f64]) {
        for (range, size) in &mut self.groups {
            *size = state[range.clone()].iter().fold(*size, |size, value| size.max(value.abs()));
        }
    }

    /// One step with ever more substeps, extrapolated to substeps of length zero.
    fn extrapolate(&self, start: &[f64], step: f64) -> Trial {
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let mut rounding = Vec::new();
        let mut error = f64::INFINITY;
        for index in 0..self.accuracy.order {
            let substeps = substeps_of(index);
            let last = index + 1 == self.accuracy.order;
            if last {
                rounding = vec![0.0; start.len()];
            }
            let mut value = self.substeps(start, step, substeps, &mut rounding);
            // The next row of the tableau from this one, in place.
            for (column, row) in rows.iter_mut().enumerate() {
                let ratio = substeps as f64 / substeps_of(index - 1 - column) as f64 - 1.0;
                let mut better = value.clone();
                for (better, (now, before)) in better.iter_mut().zip(value.iter().zip(row.iter())) {
                    *better = now + (now - before) / ratio;
                }
                if last && column + 1 == index {
                    error = self.error(&better, &value, &rounding);
                }
                *row = std::mem::replace(&mut value, better);
            }
            rows.push(value);
        }
        let state = rows.pop().unwrap_or_else(|| start.to_vec());
        self.trial(state, error)
    }

    /// One step with as many substeps as the finest row, and no extrapolation, which makes nonsense of jumps.
    fn plain(&self, start: &[f64], step: f64) -> Trial {
        let state = self.substeps(start, step, substeps_of(self.accuracy.order - 1), &mut []);
        self.trial(state, f64::INFINITY)
    }

    fn trial(&self, state: Vec<f64>, error: f64) -> Trial {
        let (at, response) = self.look(&state, PROBE * self.scale);
        let flags = self.flags(&at, &response);
        Trial { state, flags, at, response, error }
    }

    /// What errors of rounding do to the history after a substep, magnified by extrapolation: `before` the substep, `after` it.
    /// Where springs are cut to a share of a normal force that is the small difference of an elastic and a viscous part, no
    /// step is short enough to make less of it.
    fn rounding(&self, at: &Kinematics, before: &[f64], after: &[f64], step: f64, worst: &mut [f64]) {
        let rounded = Kinematics {
            overlap: at.overlap + ROUNDING * self.groups[0].1,
            normal_velocity: at.normal_velocity - ROUNDING * self.speed,
            ..*at
        };
        let mut other = before.to_vec();
        self.contact.respond(&rounded, &mut other, step);
        for (worst, (one, other)) in worst.iter_mut().zip(after.iter().zip(other)) {
            *worst = worst.max(self.magnified * (one - other).abs());
        }
    }

    /// Largest difference over the tolerance, rounding aside.
    fn error(&self, better: &[f64], worse: &[f64], rounding: &[f64]) -> f64 {
        let mut worst: f64 = 0.0;
        let rounding = |index| rounding.get(index).copied().unwrap_or(0.0);
        for (range, size) in &self.groups {
            let largest = better[range.clone()].iter().fold(*size, |size, value| size.max(value.abs()));
            if largest > 0.0 {
                for index in range.clone() {
                    let rounded = rounding(index) + self.magnified * f64::EPSILON * largest;
                    worst = worst.max(((better[index] - worse[index]).abs() - rounded) / largest);
                }
            }
        }
        worst / self.accuracy.tolerance
    }

    /// `count` substeps of the symplectic Euler scheme. Errors of rounding in the history go to `rounding`, if it is not empty.
    fn substeps(&self, start: &[f64], step: f64, count: usize, rounding: &mut [f64]) -> Vec<f64> {
        let (positions, velocities) = M::SIZE;
        let history = positions + velocities..start.len() - 2;
        let h = step / count as f64;
        let mut state = start.to_vec();
        let mut rates = vec![0.0; velocities];
        // The force at the beginning, as the law gives it in a step of this length; no time has passed yet.
        let (mut at, mut response) = self.look(start, h);
        for _ in 0..count {
            self.mechanics.accelerations(&at, &response, &mut rates);
            for (index, rate) in rates.iter().enumerate() {
                state[positions + index] += h * rate;
            }
            for index in 0..positions {
                state[index] += h * state[positions + index];
            }
            at = self.mechanics.kinematics(&state[..positions], &state[positions..history.start]);
            let before = state[history.clone()].to_vec();
            response = self.contact.respond(&at, &mut state[history.clone()], h);
            if !rounding.is_empty() {
                self.rounding(&at, &before, &state[history.clone()], h, &mut rounding[history.clone()]);
            }
            state[history.end] += h * response.viscous;
            state[history.end + 1] += h * response.friction;
        }
        state
    }

    /// What the laws answer in a step of this length, without changing the state.
    fn look(&self, state: &[f64], step: f64) -> (Kinematics, Response) {
        let (positions, velocities) = M::SIZE;
        let history = positions + velocities;
        let at = self.mechanics.kinematics(&state[..positions], &state[positions..history]);
        let response = self.contact.respond(&at, &mut state[history..state.len() - 2].to_vec(), step);
        (at, response)
    }

    fn flags(&self, at: &Kinematics, response: &Response) -> Flags {
        let force = crate::length(response.tangential);
        Flags {
            slides: force > FORCE * self.force && response.friction > REST * force * self.speed,
            pushes: response.normal > FORCE * self.force,
            separates: at.normal_velocity <= 0.0,
            ended: at.overlap <= -self.contact.composition.reach,
        }
    }
}

fn sample(time: f64, at: &Kinematics, response: &Response) -> (f64, f64, f64) {
    (time, at.overlap, response.normal)
}

fn record(events: &mut Vec<Event>, time: f64, before: Flags, after: Flags) {
    let mut change = |was: bool, is: bool, begins: EventKind, ends: EventKind| {
        if was != is {
            events.push(Event { time, kind: if is { begins } else { ends } });
        }
    };
    change(before.slides, after.slides, EventKind::Slides, EventKind::Sticks);
    change(before.separates, after.separates, EventKind::Turns, EventKind::Approaches);
    change(before.pushes, after.pushes, EventKind::Pushes, EventKind::PushesNoMore);
    change(before.ended, after.ended, EventKind::Ends, EventKind::Ends);
}

/// Events without those that the opposite follows at once.
fn without_flutter(events: Vec<Event>, brief: f64) -> Vec<Event> {
    let mut kept: Vec<Event> = Vec::new();
    for event in events {
        let opposite = kept.iter().rposition(|other| other.kind.pair() == event.kind.pair());
        match opposite {
            Some(index) if kept[index].kind != event.kind && event.time - kept[index].time < brief => {
                kept.remove(index);
            }
            _ => kept.push(event),
        }
    }
    kept
}
