//! The state of an engine of rolling bodies between two events.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::account::RollingWork;
use super::engine::{AGAIN, Aim, Fixed, PIECE, Path, Piece, RollingEngine, SHELL, WALLS};
use super::setup::RollingSetup;
use crate::body::Shell;
use crate::cells::Cells;
use crate::neighbours::Neighbours;
use crate::report::Counts;
use crate::saved::{by_id, ensure, finite, passed, shells_are_whole};
use crate::setup::EventError;

/// Everything that decides how a [`RollingEngine`] goes on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RollingState<'a> {
    paths: Cow<'a, [Path]>,
    pieces: Cow<'a, [Piece]>,
    fixed: Cow<'a, [Fixed]>,
    shells: Cow<'a, [Shell]>,
    last: Cow<'a, [f64]>,
    events: Vec<(f64, Aim)>,
    neighbours: Cow<'a, Neighbours>,
    cells: Cow<'a, Cells>,
    largest_reach: f64,
    now: f64,
    counts: Counts,
    work: RollingWork,
    pieces_begun: u64,
    window: (f64, u64),
}

impl RollingEngine {
    /// The state after the last event, for [`restore`](Self::restore).
    pub fn save(&self) -> RollingState<'_> {
        RollingState {
            paths: Cow::Borrowed(&self.paths),
            pieces: Cow::Borrowed(&self.pieces),
            fixed: Cow::Borrowed(&self.fixed),
            shells: Cow::Borrowed(&self.shells),
            last: Cow::Borrowed(&self.last),
            events: self.queue.events(),
            neighbours: Cow::Borrowed(&self.neighbours),
            cells: Cow::Borrowed(&self.cells),
            largest_reach: self.largest_reach,
            now: self.now,
            counts: self.counts,
            work: self.work,
            pieces_begun: self.pieces_begun,
            window: self.window,
        }
    }

    /// Goes on from a saved state with the bits of an engine that was never interrupted.
    ///
    /// # Errors
    /// [`EventError::Saved`] if the state does not fit the setup, and those of [`new`](Self::new).
    pub fn restore(setup: &RollingSetup, state: RollingState<'_>) -> Result<Self, EventError> {
        let mut engine = Self::new(setup)?;
        engine.check_state(&state)?;
        engine.paths = state.paths.into_owned();
        engine.pieces = state.pieces.into_owned();
        engine.fixed = state.fixed.into_owned();
        engine.shells = state.shells.into_owned();
        engine.last = state.last.into_owned();
        engine.queue.restore(&state.events);
        engine.neighbours = state.neighbours.into_owned();
        engine.cells = state.cells.into_owned();
        (engine.largest_reach, engine.now) = (state.largest_reach, state.now);
        (engine.counts, engine.work) = (state.counts, state.work);
        (engine.pieces_begun, engine.window) = (state.pieces_begun, state.window);
        Ok(engine)
    }

    fn check_state(&self, state: &RollingState<'_>) -> Result<(), EventError> {
        let count = self.fixed.len();
        let lengths = [
            state.paths.len(),
            state.pieces.len(),
            state.fixed.len(),
            state.shells.len(),
            state.last.len(),
            state.events.len(),
        ];
        ensure(lengths.iter().all(|length| *length == count), "number of bodies")?;
        let whole = |path: &Path| {
            let vectors = [path.place, path.velocity, path.acceleration];
            finite(vectors.as_flattened()) && finite([&path.time, &path.share])
        };
        let moves = |piece: &Piece| {
            let vectors = [piece.spin, piece.spin_rate, piece.friction];
            finite(vectors.as_flattened())
                && finite([&piece.upright, &piece.upright_rate])
                && !piece.end.is_nan()
        };
        ensure(
            state.paths.iter().all(whole) && state.pieces.iter().all(moves),
            "numbers that are not finite",
        )?;
        ensure(shells_are_whole(&state.shells) && passed(&state.last), "shells of the bodies")?;
        let ids = |fixed: &[Fixed]| by_id(fixed.iter().map(|fixed| fixed.id));
        for ((id, here), (other, there)) in ids(&self.fixed).into_iter().zip(ids(&state.fixed)) {
            let constants = |fixed: &Fixed| {
                let Fixed { id: _, material, radius, height, mass, inverse_mass, inertia_number, image: _ } =
                    *fixed;
                (material, [radius, height, mass, inverse_mass, inertia_number].map(f64::to_bits))
            };
            let same = constants(&self.fixed[here]) == constants(&state.fixed[there]);
            ensure(id == other && same, "identity, size or mass of a body")?;
        }
        let known = |(time, aim): &(f64, Aim)| {
            let partner = aim.partner;
            let wall = partner >= WALLS && ((partner - WALLS) as usize) < self.walls.len();
            !time.is_nan() && (matches!(partner, PIECE | SHELL | AGAIN) || wall || (partner as usize) < count)
        };
        ensure(state.events.iter().all(known), "events")?;
        ensure(state.neighbours.is_whole(count) && state.cells.is_whole(count), "lists of neighbours")?;
        ensure(finite(&[state.largest_reach, state.now, state.window.0]), "times")
    }
}
