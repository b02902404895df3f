//! Integration of a contact from its beginning to its end.

use std::ops::Range;

use crate::ReferenceError;
use crate::contact::{Contact, Kinematics, Response};

/// More changes of state than these are chatter.
pub(crate) const MOST_EVENTS: usize = 10_000;
/// More steps than these are taken for no contact: at most some hundred are needed.
const MOST_STEPS: usize = 200_000;

/// Part of the contact's duration in which it is asked whether it slides: long against the error of its spring.
const PROBE: f64 = 1e-7;
/// Part of the mean force of an impact below which there is none.
const FORCE: f64 = 1e-10;
/// Part of the impact speed below which slip is rest.
const REST: f64 = 1e-6;

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
    let mut path =
        Path { mechanics, contact, accuracy, groups, speed, scale, force: 2.0 * energy / (speed * scale) };
    path.learn(&state);
    path.run(state)
}

impl<M: Mechanics> Path<'_, M> {
    fn run(&mut self, mut state: Vec<f64>) -> Result<End, ReferenceError> {
        let scale = self.scale;
        let (shortest, latest) = (1e-9 * scale, 1e4 * scale);
        let mut time = 1e-9 * scale;
        let first = self.extrapolate(&state, time);
        let mut flags = first.flags;
        state = first.state;
        let mut step = time;
        let (mut events, mut samples) = (Vec::new(), vec![sample(time, &first.at, &first.response)]);
        let mut largest: f64 = first.at.overlap;
        for _ in 0..MOST_STEPS {
            step = step.max(shortest);
            let mut trial = self.extrapolate(&state, step);
            if trial.state.iter().any(|value| !value.is_finite()) {
                return Err(ReferenceError::NotFinite(time));
            }
            let order = self.accuracy.order as f64;
            let factor = 0.9 * trial.error.max(1e-30).powf(-1.0 / order);
            if trial.error > 1.0 && step > shortest {
                step = (step * factor.max(0.1).min(0.7)).max(shortest);
                continue;
            }
            let mut taken = step;
            // A kink was crossed in the shortest step; beyond it the path is smooth again.
            step *= if trial.error > 1.0 { 4.0 } else { factor.max(0.2).min(4.0) };
            if trial.flags != flags {
                (trial, taken) = self.locate(&state, flags, trial, taken, time + scale);
                step = 1e-2 * taken;
            }
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
                    events,
                    samples,
                });
            }
            if events.len() > MOST_EVENTS {
                return Err(ReferenceError::Chatter);
            }
            if time > latest {
                break;
            }
        }
        Err(ReferenceError::NoEnd(time))
    }

    /// The shortest step that leads to another state of the contact, to round-off.
    fn locate(&self, state: &[f64], flags: Flags, trial: Trial, step: f64, unit: f64) -> (Trial, f64) {
        let (mut low, mut high, mut best) = (0.0, step, trial);
        while high - low > 4.0 * f64::EPSILON * unit {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            let trial = self.extrapolate(state, middle);
            if trial.flags == flags {
                low = middle;
            } else {
                (high, best) = (middle, trial);
            }
        }
        (best, high)
    }

    /// Remembers the largest values seen.
    fn learn(&mut self, state: &[f64]) {
        for (range, size) in &mut self.groups {
            *size = state[range.clone()].iter().fold(*size, |size, value| size.max(value.abs()));
        }
    }

    /// One step: 1, 2, 3, ... substeps, extrapolated to substeps of length zero.
    fn extrapolate(&self, start: &[f64], step: f64) -> Trial {
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let mut substeps = 1;
        loop {
            let mut value = self.substeps(start, step, substeps);
            let mut error = f64::INFINITY;
            // Row j of the tableau from row j - 1, in place.
            for (column, row) in rows.iter_mut().enumerate() {
                let ratio = substeps as f64 / (substeps - 1 - column) as f64 - 1.0;
                let mut better = value.clone();
                for (better, (now, before)) in better.iter_mut().zip(value.iter().zip(row.iter())) {
                    *better = now + (now - before) / ratio;
                }
                if column + 2 == substeps {
                    error = self.error(&better, &value);
                }
                *row = std::mem::replace(&mut value, better);
            }
            rows.push(value);
            if substeps == self.accuracy.order {
                let state = rows.swap_remove(substeps - 1);
                let (at, response) = self.look(&state, PROBE * self.scale);
                let flags = self.flags(&at, &response);
                return Trial { state, flags, at, response, error };
            }
            substeps += 1;
        }
    }

    /// Largest difference over the tolerance.
    fn error(&self, better: &[f64], worse: &[f64]) -> f64 {
        let mut worst: f64 = 0.0;
        for (range, size) in &self.groups {
            let largest = better[range.clone()].iter().fold(*size, |size, value| size.max(value.abs()));
            if largest > 0.0 {
                for index in range.clone() {
                    worst = worst.max((better[index] - worse[index]).abs() / largest);
                }
            }
        }
        worst / self.accuracy.tolerance
    }

    /// `count` substeps of the symplectic Euler scheme.
    fn substeps(&self, start: &[f64], step: f64, count: usize) -> Vec<f64> {
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
            response = self.contact.respond(&at, &mut state[history.clone()], h);
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
            slides: response.friction > REST * force * self.speed,
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
