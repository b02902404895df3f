//! The state of an engine between two events, to be written down and taken up again with the same bits.
//!
//! Saved is what decides how the run goes on: where each body was at its local time, its next event as it was predicted,
//! shells, lists and grid in the order in which searches go through them, for bodies that meet at the same moment. A saved
//! state may come from a damaged or malicious file, so nothing of it is believed before it has been compared with the setup.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use crate::body::{Body, Identity, Shell};
use crate::cells::Cells;
use crate::engine::{AGAIN, EventEngine, SHELL, Target, WALLS};
use crate::look_ahead::Ahead;
use crate::neighbours::Neighbours;
use crate::report::Counts;
use crate::setup::{EventError, Setup};

/// Everything that decides how an [`EventEngine`] goes on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EventState<'a> {
    bodies: Cow<'a, [Body]>,
    identities: Cow<'a, [Identity]>,
    spins: Cow<'a, [[f64; 3]]>,
    shells: Cow<'a, [Shell]>,
    last: Cow<'a, [f64]>,
    events: Vec<(f64, Target)>,
    neighbours: Cow<'a, Neighbours>,
    cells: Cow<'a, Cells>,
    margin: f64,
    lead: f64,
    largest_reach: f64,
    uniform: bool,
    epoch: f64,
    now: f64,
    counts: Counts,
    since: u64,
    window: (f64, u64),
}

/// The error if something does not fit.
pub(crate) fn ensure(fits: bool, what: &'static str) -> Result<(), EventError> {
    if fits { Ok(()) } else { Err(EventError::Saved(what)) }
}

/// True if all numbers are finite.
pub(crate) fn finite<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> bool {
    numbers.into_iter().all(|number| number.is_finite())
}

/// True if all shells are balls.
pub(crate) fn shells_are_whole(shells: &[Shell]) -> bool {
    shells.iter().all(|shell| finite(&shell.centre) && shell.reach.is_finite())
}

/// Times of collisions that were: minus infinity for never.
pub(crate) fn passed(last: &[f64]) -> bool {
    last.iter().all(|time| !time.is_nan() && *time < f64::INFINITY)
}

/// Places of the bodies by identity.
pub(crate) fn by_id(ids: impl Iterator<Item = u32>) -> Vec<(u32, usize)> {
    let mut order: Vec<(u32, usize)> = ids.zip(0..).collect();
    order.sort_unstable();
    order
}

impl EventEngine {
    /// The state after the last event, for [`restore`](Self::restore).
    pub fn save(&self) -> EventState<'_> {
        EventState {
            bodies: Cow::Borrowed(&self.bodies),
            identities: Cow::Borrowed(&self.identities),
            spins: Cow::Borrowed(&self.spins),
            shells: Cow::Borrowed(&self.shells),
            last: Cow::Borrowed(&self.last),
            events: self.queue.events(),
            neighbours: Cow::Borrowed(&self.neighbours),
            cells: Cow::Borrowed(&self.cells),
            margin: self.margin,
            lead: self.lead,
            largest_reach: self.largest_reach,
            uniform: self.uniform,
            epoch: self.epoch,
            now: self.now,
            counts: self.counts,
            since: self.since,
            window: self.window,
        }
    }

    /// Goes on from a saved state with the bits of an engine that was never interrupted.
    ///
    /// # Errors
    /// [`EventError::Saved`] if the state does not fit the setup, and those of [`new`](Self::new).
    pub fn restore(setup: &Setup, state: EventState<'_>) -> Result<Self, EventError> {
        let mut engine = Self::new(setup)?;
        engine.check_state(&state)?;
        engine.bodies = state.bodies.into_owned();
        engine.identities = state.identities.into_owned();
        engine.spins = state.spins.into_owned();
        engine.shells = state.shells.into_owned();
        engine.last = state.last.into_owned();
        engine.queue.restore(&state.events);
        engine.neighbours = state.neighbours.into_owned();
        engine.cells = state.cells.into_owned();
        (engine.margin, engine.lead) = (state.margin, state.lead);
        (engine.largest_reach, engine.uniform) = (state.largest_reach, state.uniform);
        (engine.epoch, engine.now) = (state.epoch, state.now);
        (engine.counts, engine.since, engine.window) = (state.counts, state.since, state.window);
        engine.ahead = Ahead::default();
        Ok(engine)
    }

    fn check_state(&self, state: &EventState<'_>) -> Result<(), EventError> {
        let count = self.bodies.len();
        let lengths = [state.bodies.len(), state.identities.len(), state.shells.len(), state.events.len()];
        ensure(lengths.iter().all(|length| *length == count), "number of bodies")?;
        ensure(
            state.spins.len() == self.spins.len() && state.last.len() == self.last.len(),
            "number of bodies",
        )?;
        let whole = |body: &Body| {
            finite(&body.position) && finite(&body.velocity) && finite([&body.time, &body.radius])
        };
        ensure(
            state.bodies.iter().all(whole) && state.spins.iter().all(finite),
            "numbers that are not finite",
        )?;
        ensure(shells_are_whole(&state.shells) && passed(&state.last), "shells of the bodies")?;
        let ids = |identities: &[Identity]| by_id(identities.iter().map(|identity| identity.id));
        for ((id, here), (other, there)) in ids(&self.identities).into_iter().zip(ids(&state.identities)) {
            let constants = |identity: &Identity, body: &Body| {
                let numbers = [identity.inverse_mass, identity.inertia_factor, body.radius].map(f64::to_bits);
                (identity.material, numbers)
            };
            let before = constants(&self.identities[here], &self.bodies[here]);
            let after = constants(&state.identities[there], &state.bodies[there]);
            ensure(id == other && before == after, "identity, size or mass of a body")?;
        }
        let known = |(time, target): &(f64, Target)| {
            let partner = target.partner;
            let wall = partner >= WALLS && ((partner - WALLS) as usize) < self.walls.len();
            !time.is_nan() && (matches!(partner, SHELL | AGAIN) || wall || (partner as usize) < count)
        };
        ensure(state.events.iter().all(known), "events")?;
        ensure(state.neighbours.is_whole(count) && state.cells.is_whole(count), "lists of neighbours")?;
        let numbers = [state.margin, state.lead, state.largest_reach, state.epoch, state.now, state.window.0];
        ensure(finite(&numbers), "times")
    }
}
