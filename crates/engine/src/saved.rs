//! The state of an engine between two steps, to be written down and taken up again with the same bits.
//!
//! Saved is what decides how the run goes on: the rows of the bodies in their order in memory, the candidate lists with how
//! far bodies have moved since they were made, the histories of the contacts that touch, and the sums since the start.
//! Whatever follows from these and from the plan is made anew. A saved state may come from a damaged or malicious file, so
//! nothing of it is believed before it has been compared with the plan.

use std::borrow::Cow;

use granule_geometry::IMAGE_CODES;
use granule_plan::{Partner, Plan, Scheme};
use granule_state::Bodies;
use serde::{Deserialize, Serialize};

use crate::error::EngineError;
use crate::history::PairHistory;
use crate::lists::{Lists, push_range};
use crate::substrate::SubstrateTally;
use crate::tally::{Tally, Work};
use crate::tile::{Pair, Range, Tile};
use crate::walls::WallPair;

/// Everything that decides how an [`Engine`](crate::Engine) goes on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EngineState<'a> {
    pub(crate) bodies: Cow<'a, Bodies>,
    pub(crate) lists: ListsState,
    pub(crate) step: u64,
    pub(crate) evaluation: u32,
    pub(crate) force_time: f64,
    pub(crate) moved: f64,
    pub(crate) tally: Tally,
    pub(crate) work: Work,
    pub(crate) substrate: SubstrateTally,
}

impl EngineState<'_> {
    /// Steps done.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Compares the numbers that are no lists and no rows with the plan.
    pub(crate) fn check(&self, plan: &Plan) -> Result<(), EngineError> {
        let Tally { elastic, viscous, friction, slipped, lacking, wall_power, wall_force, .. } = &self.tally;
        let sums = [elastic, viscous, friction, slipped, &lacking.viscous, &lacking.friction];
        let work = [&self.work.viscous, &self.work.friction];
        let finite = sums.into_iter().chain(work).flatten().all(|sum| sum.is_finite())
            && wall_force.iter().flatten().all(|force| force.is_finite())
            && [*wall_power, self.work.walls, self.force_time].iter().all(|number| number.is_finite());
        ensure(finite && wall_force.len() == plan.walls.len(), "sums over contacts")?;
        ensure(self.moved >= 0.0 && self.moved.is_finite(), "distances")?;
        ensure(self.step <= plan.driver.steps, "step")?;
        Ok(())
    }
}

/// Candidate lists.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ListsState {
    tiles: Vec<TileState>,
    inner_skin: f64,
    travelled_outer: f64,
    travelled_inner: f64,
    travelled_since_sort: f64,
    steps_since_prune: u32,
    rebuilds: u64,
    prunes: u64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct TileState {
    /// Place of i with the image code, and place of j.
    outer: Vec<(u32, u32)>,
    /// Composition, start, end.
    outer_ranges: Vec<(u32, u32, u32)>,
    /// Indices in `outer`.
    inner: Vec<u32>,
    history: HistoryState,
    /// Body and wall.
    walls: Vec<(u32, u32)>,
    wall_ranges: Vec<(u32, u32, u32)>,
    wall_history: HistoryState,
    /// Touching and clipped pairs of the last evaluation; nothing unless the scheme resolves contacts.
    marks: (Vec<u8>, Vec<u64>),
}

/// Histories of the pairs that touched in the last evaluation, in the order of the pairs.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct HistoryState {
    pairs: Vec<u32>,
    values: Vec<f64>,
}

impl HistoryState {
    fn of(history: &PairHistory, pairs: usize, last: u32) -> Self {
        let mut state = Self { pairs: Vec::new(), values: Vec::new() };
        for pair in 0..pairs {
            if let Some(values) = history.get(pair, last) {
                state.pairs.push(pair as u32);
                state.values.extend_from_slice(values);
            }
        }
        state
    }

    fn restore(
        &self,
        history: &mut PairHistory,
        pairs: usize,
        width: usize,
        last: u32,
    ) -> Result<(), Misfit> {
        let rising = self.pairs.windows(2).all(|two| two[0] < two[1]);
        let known = self.pairs.last().is_none_or(|last| (*last as usize) < pairs);
        ensure(rising && known && self.values.len() == self.pairs.len() * width, "contact histories")?;
        ensure(self.values.iter().all(|value| value.is_finite()), "contact histories")?;
        history.width = width;
        history.resize(pairs);
        for (pair, values) in self.pairs.iter().zip(self.values.chunks_exact(width.max(1))) {
            history.set(*pair as usize, last, values);
        }
        Ok(())
    }
}

/// What of a saved state does not fit the plan.
struct Misfit(&'static str);

impl From<Misfit> for EngineError {
    fn from(misfit: Misfit) -> Self {
        Self::Saved(misfit.0)
    }
}

fn ensure(fits: bool, what: &'static str) -> Result<(), Misfit> {
    if fits { Ok(()) } else { Err(Misfit(what)) }
}

/// Compares saved bodies with those that the plan begins with: identities and everything that never changes must be the
/// same.
pub(crate) fn check_bodies(fresh: &Bodies, saved: &Bodies) -> Result<(), EngineError> {
    ensure(saved.is_whole(fresh.layout()) && saved.len() == fresh.len(), "number of bodies or their rows")?;
    ensure(saved.is_finite(), "numbers that are not finite")?;
    let (mut before, mut after) = (fresh.order_by_id(), places_by_id(saved));
    ensure(before.len() == after.len(), "identities of the bodies")?;
    for (a, b) in before.drain(..).zip(after.drain(..)) {
        let same = fresh.same_body(a as usize, saved, b as usize);
        ensure(same, "identity, size or mass of a body")?;
    }
    Ok(())
}

/// Like `order_by_id`, for identities of which nothing is known.
fn places_by_id(bodies: &Bodies) -> Vec<u32> {
    let mut order: Vec<u32> = (0..bodies.len() as u32).collect();
    order.sort_unstable_by_key(|&place| bodies.id[place as usize]);
    order
}

impl Lists {
    /// The state of the lists after evaluation `last`.
    pub(crate) fn save(&self, last: u32) -> ListsState {
        let ranges = |ranges: &[Range]| ranges.iter().map(|r| (r.composition, r.start, r.end)).collect();
        let tile = |tile: &Tile| TileState {
            outer: tile.outer.iter().map(|pair| (pair.i_image, pair.j)).collect(),
            outer_ranges: ranges(&tile.outer_ranges),
            inner: tile.inner_outer.clone(),
            history: HistoryState::of(&tile.history, tile.inner.len(), last),
            walls: tile.walls.pairs.iter().map(|pair| (pair.body, pair.wall)).collect(),
            wall_ranges: ranges(&tile.walls.ranges),
            wall_history: HistoryState::of(&tile.walls.history, tile.walls.pairs.len(), last),
            marks: (tile.marks.last().0.to_vec(), tile.marks.last().1.to_vec()),
        };
        ListsState {
            tiles: self.tiles.iter().map(tile).collect(),
            inner_skin: self.inner_skin,
            travelled_outer: self.travelled_outer,
            travelled_inner: self.travelled_inner,
            travelled_since_sort: self.rebuild.travelled,
            steps_since_prune: self.steps_since_prune,
            rebuilds: self.rebuilds,
            prunes: self.prunes,
        }
    }

    /// Takes saved lists of `bodies` bodies over.
    pub(crate) fn restore(
        &mut self,
        plan: &Plan,
        bodies: usize,
        saved: &ListsState,
        last: u32,
    ) -> Result<(), EngineError> {
        ensure(saved.tiles.len() == bodies.div_ceil(self.tile_size), "number of tiles")?;
        let travelled = [saved.travelled_outer, saved.travelled_inner, saved.inner_skin];
        ensure(travelled.iter().all(|length| *length >= 0.0) && saved.inner_skin <= self.skin, "distances")?;
        self.tiles.clear();
        for (index, from) in saved.tiles.iter().enumerate() {
            let first = index * self.tile_size;
            let len = self.tile_size.min(bodies - first);
            self.tiles.push(tile(plan, bodies, (first, len), from, self.history_width, last)?);
        }
        self.inner_skin = saved.inner_skin;
        self.travelled_outer = saved.travelled_outer;
        self.travelled_inner = saved.travelled_inner;
        self.rebuild.travelled = saved.travelled_since_sort;
        self.steps_since_prune = saved.steps_since_prune;
        self.rebuilds = saved.rebuilds;
        self.prunes = saved.prunes;
        self.make_room(plan);
        self.route(bodies);
        Ok(())
    }
}

fn tile(
    plan: &Plan,
    bodies: usize,
    (first, len): (usize, usize),
    from: &TileState,
    width: usize,
    last: u32,
) -> Result<Tile, Misfit> {
    let pairs_known = from.outer.iter().all(|(i_image, j)| {
        let (image, place) = (i_image & 31, (i_image >> 5) as usize);
        (image as usize) < IMAGE_CODES
            && place < len
            && (*j as usize) < bodies
            && *j as usize != first + place
    });
    ensure(pairs_known, "pairs")?;
    let partner = |composition: u32| plan.compositions.get(composition as usize).map(|c| c.partner);
    let outer_ranges = ranges(&from.outer_ranges, from.outer.len())?;
    let of_bodies = |range: &Range| matches!(partner(range.composition), Some(Partner::Body(_)));
    ensure(outer_ranges.iter().all(of_bodies), "pairs")?;
    let rising = from.inner.windows(2).all(|two| two[0] < two[1]);
    ensure(rising && from.inner.last().is_none_or(|at| (*at as usize) < from.outer.len()), "pairs")?;
    let wall_ranges = ranges(&from.wall_ranges, from.walls.len())?;
    let of_its_wall = |range: &Range| {
        let Some(Partner::Wall(wall)) = partner(range.composition) else { return false };
        from.walls[range.start as usize..range.end as usize].iter().all(|pair| pair.1 == u32::from(wall))
    };
    let walls_known =
        from.walls.iter().all(|pair| (pair.0 as usize) < len && (pair.1 as usize) < plan.walls.len());
    ensure(walls_known && wall_ranges.iter().all(of_its_wall), "contacts with walls")?;

    let mut tile = Tile { first, len, tally: Tally::new(plan.walls.len()), ..Tile::default() };
    tile.outer = from.outer.iter().map(|(i_image, j)| Pair { i_image: *i_image, j: *j }).collect();
    tile.inner = from.inner.iter().map(|at| tile.outer[*at as usize]).collect();
    tile.inner_outer = from.inner.clone();
    let mut begin = 0;
    for range in &outer_ranges {
        let end = from.inner.partition_point(|at| *at < range.end);
        push_range(&mut tile.inner_ranges, range.composition, begin as u32, end as u32);
        begin = end;
    }
    tile.outer_ranges = outer_ranges;
    tile.walls.pairs = from.walls.iter().map(|(body, wall)| WallPair { body: *body, wall: *wall }).collect();
    tile.walls.ranges = wall_ranges;
    tile.marks.forget();
    from.history.restore(&mut tile.history, from.inner.len(), width, last)?;
    from.wall_history.restore(&mut tile.walls.history, from.walls.len(), width, last)?;
    if plan.driver.scheme == Scheme::ContactResolved {
        let (touching, clipped) = &from.marks;
        let (pairs, ranges) = (tile.inner.len(), tile.inner_ranges.len());
        ensure(tile.marks.restore(pairs, ranges, touching, clipped), "marks of touching pairs")?;
    }
    Ok(tile)
}

/// Ranges that follow one another and cover `count` pairs.
fn ranges(from: &[(u32, u32, u32)], count: usize) -> Result<Vec<Range>, Misfit> {
    let mut next = 0;
    for (_, start, end) in from {
        ensure(*start == next && end > start, "ranges of pairs")?;
        next = *end;
    }
    ensure(next as usize == count, "ranges of pairs")?;
    Ok(from
        .iter()
        .map(|(composition, start, end)| Range { composition: *composition, start: *start, end: *end })
        .collect())
}
