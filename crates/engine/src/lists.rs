//! Candidate lists: the outer list with the Verlet skin, the inner list pruned from it, and where forces between tiles go.

use std::sync::Mutex;

use granule_geometry::{IMAGE_CODES, NO_IMAGE};
use granule_plan::{Plan, Scheme, Search};
use granule_state::{Bodies, Row};
use rayon::prelude::*;

use crate::error::EngineError;
use crate::history::PairHistory;
use crate::rebuild::{Reach, Rebuild};
use crate::tile::{Incoming, Outgoing, Range, Tile};
use crate::walls::MovedWall;

/// Lists, and how far bodies have moved since they were made.
pub(crate) struct Lists {
    pub tiles: Vec<Tile>,
    pub tile_size: usize,
    pub shifts: [[f64; 3]; IMAGE_CODES],
    /// The same as rows, as many as codes could be written in their bits.
    pub shift_rows: [Row; 32],
    pub(crate) rebuild: Rebuild,
    /// Part of the skin for which a periodic cell must have room.
    margin: f64,
    pub(crate) skin: f64,
    pub(crate) inner_skin: f64,
    /// Bound of what any body (or wall) has moved since the outer list was made \[m\].
    pub(crate) travelled_outer: f64,
    /// The same since the inner list was pruned \[m\].
    pub(crate) travelled_inner: f64,
    pub(crate) steps_since_prune: u32,
    largest_radius: f64,
    /// Largest distance beyond touching at which a law acts \[m\].
    reach: f64,
    pub(crate) history_width: usize,
    spares: Vec<Mutex<Spare>>,
    /// Candidates of the tile that has most.
    most: usize,
    /// How often lists were made and pruned.
    pub rebuilds: u64,
    pub prunes: u64,
}

impl Lists {
    pub fn new(plan: &Plan, bodies: &Bodies, tile_size: usize) -> Self {
        let largest_radius = bodies.position.iter().fold(0.0, |largest: f64, row| largest.max(row[3]));
        let reach =
            plan.compositions.iter().fold(0.0, |reach: f64, composition| reach.max(composition.reach));
        let skin = match plan.driver.search {
            Search::Grid => plan.driver.skin,
            // All pairs are listed anyway. They stay the right ones until the nearest image of a pair may change.
            Search::AllPairs | Search::None => nearest_period(plan) / 2.0 - 2.0 * largest_radius - reach,
        };
        let shifts = plan.cell.shift_table();
        Self {
            tiles: Vec::new(),
            tile_size,
            shifts,
            shift_rows: std::array::from_fn(|code| {
                shifts.get(code).map_or(Row::ZERO, |shift| Row::new(*shift, 0.0))
            }),
            rebuild: Rebuild::new(plan),
            margin: if plan.driver.search == Search::Grid { skin } else { 0.0 },
            skin,
            inner_skin: skin / 16.0,
            travelled_outer: f64::INFINITY,
            travelled_inner: f64::INFINITY,
            steps_since_prune: 0,
            largest_radius,
            reach,
            history_width: crate::level::history_width(plan),
            spares: Vec::new(),
            most: 0,
            rebuilds: 0,
            prunes: 0,
        }
    }

    /// Accounts for a step in which no body or wall moved further than `distance`.
    pub fn travel(&mut self, distance: f64) {
        // A little more than what was measured, so that rounding never hides a contact.
        let distance = distance * (1.0 + 1e-9);
        self.travelled_outer += distance;
        self.travelled_inner += distance;
    }

    /// Counts a step towards the choice of the inner skin. Once a step, however the integration is split into passes: the
    /// choice must not depend on who looks at the run.
    pub fn count_step(&mut self) {
        self.steps_since_prune += 1;
    }

    /// True if bodies may have come closer than the outer list knows.
    pub fn outer_expired(&self) -> bool {
        // Before the first list, and after a motion that is not a number, nothing is known.
        !self.travelled_outer.is_finite() || 2.0 * self.travelled_outer > self.skin
    }

    /// True if bodies may have come closer than the inner list knows.
    pub fn inner_expired(&self) -> bool {
        !self.travelled_inner.is_finite() || 2.0 * self.travelled_inner > self.inner_skin
    }

    /// Sorts the bodies and makes all lists anew. Histories of contacts are carried over.
    pub fn rebuild(
        &mut self,
        plan: &Plan,
        bodies: &mut Bodies,
        walls: &[MovedWall],
        last: u32,
        parallel: bool,
    ) -> Result<(), EngineError> {
        plan.cell
            .check_minimum_length(self.largest_radius, self.margin + self.reach)
            .map_err(|error| EngineError::Search(error.to_string()))?;
        Rebuild::wrap(plan, bodies, parallel)?;
        let carried = (self.history_width > 0 && !self.tiles.is_empty()).then_some(last);
        if carried.is_some() {
            self.rebuild.carry(&self.tiles, self.history_width, last, parallel);
        }
        if plan.driver.search == Search::Grid {
            self.rebuild.sort(plan, bodies, self.skin + self.reach, self.travelled_outer, parallel);
        }
        let reach = Reach {
            outer: self.skin + self.reach,
            inner: self.inner_skin + self.reach,
            skin: self.skin,
            tile_size: self.tile_size,
            history_width: self.history_width,
        };
        let what = (plan, &*bodies, walls);
        self.rebuild.fill(&mut self.tiles, what, &self.shifts, &reach, carried, parallel);
        // Tiles and threads exchange buffers when they prune: with room for the most candidates in each, no pruning until
        // the next rebuild allocates.
        self.make_room(plan);
        self.travelled_outer = 0.0;
        self.rebuilds += 1;
        Ok(())
    }

    pub(crate) fn make_room(&mut self, plan: &Plan) {
        self.most = self.tiles.iter().map(|tile| tile.outer.len()).max().unwrap_or(0);
        for tile in &mut self.tiles {
            tile.inner.reserve(self.most.saturating_sub(tile.inner.len()));
            tile.inner_outer.reserve(self.most.saturating_sub(tile.inner_outer.len()));
            tile.history.reserve(self.most);
            if plan.driver.scheme == Scheme::ContactResolved {
                tile.marks.reserve(self.most);
                // A quarter of the bodies that meet or part in one step is more than is ever seen at ten steps in a contact.
                tile.impulses.reserve((tile.len / 4).saturating_sub(tile.impulses.len()));
            }
        }
    }

    /// Makes the inner lists from the outer ones, and the routes of forces between tiles.
    pub fn prune(&mut self, bodies: &Bodies, last: u32, parallel: bool) {
        self.adapt_inner_skin();
        let (margin, shifts) = (self.inner_skin, &self.shifts);
        let reach = self.reach;
        let threads = if parallel { rayon::current_num_threads() } else { 1 };
        self.spares.resize_with(threads.max(self.spares.len()), Default::default);
        for spare in &mut self.spares {
            let spare = spare.get_mut().unwrap_or_else(std::sync::PoisonError::into_inner);
            spare.inner_outer.reserve(self.most.saturating_sub(spare.inner_outer.len()));
            spare.history.width = self.history_width;
            spare.history.reserve(self.most);
        }
        let spares = &self.spares;
        each_tile(&mut self.tiles, parallel, |_, tile| {
            let thread = rayon::current_thread_index().unwrap_or(0) % spares.len();
            // A panic elsewhere poisons a lock on buffers whose contents do not matter.
            let mut spare = spares[thread].lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            prune_tile(tile, &mut spare, bodies, shifts, reach + margin, last);
        });
        self.route(bodies.len());
        self.travelled_inner = 0.0;
        self.steps_since_prune = 0;
        self.prunes += 1;
    }

    /// Lists as the force loop reads them, and the routes of forces between tiles.
    pub(crate) fn route(&mut self, bodies: usize) {
        let size = self.tile_size;
        for index in 0..self.tiles.len() {
            self.tiles[index].inbox.clear();
        }
        for index in 0..self.tiles.len() {
            let (first, len) = (self.tiles[index].first, self.tiles[index].len);
            let mut slot = 0;
            self.tiles[index].list.clear(first, len, bodies);
            for at in 0..self.tiles[index].inner.len() {
                let pair = self.tiles[index].inner[at];
                let j = pair.j as usize;
                let to = if (first..first + len).contains(&j) {
                    j - first
                } else {
                    let to = j / size;
                    self.tiles[to].inbox.push(Incoming {
                        body: (j - to * size) as u32,
                        tile: index as u32,
                        slot: slot as u32,
                    });
                    slot += 1;
                    len + slot - 1
                };
                self.tiles[index].list.push(pair, to);
            }
            self.tiles[index].list.finish(slot);
            let outbox = &mut self.tiles[index].outbox;
            if outbox.capacity() < slot {
                // Room for the bodies that drift between tiles until the next sort.
                outbox.reserve_exact(slot + slot / 4 - outbox.len());
            }
            outbox.resize(slot, Outgoing::default());
        }
    }

    /// A thin inner skin makes short lists, a thick one rare pruning. The choice depends on the motion alone, so it is
    /// the same for any number of threads.
    fn adapt_inner_skin(&mut self) {
        if self.travelled_inner.is_finite() {
            if self.steps_since_prune < 5 {
                self.inner_skin = (self.inner_skin * 2.0).min(self.skin);
            } else if self.steps_since_prune > 40 {
                self.inner_skin = (self.inner_skin * 0.5).max(self.skin / 64.0);
            }
        }
    }

    /// Heap bytes of lists and histories.
    pub fn bytes(&self) -> usize {
        self.rebuild.bytes() + self.tiles.iter().map(Tile::bytes).sum::<usize>()
    }
}

/// Shortest period of the cell \[m\]; infinite without periodic directions.
fn nearest_period(plan: &Plan) -> f64 {
    let (period, periodic) = (plan.cell.period(), plan.cell.periodic());
    (0..3).filter(|axis| periodic[*axis]).map(|axis| period[axis]).fold(f64::INFINITY, f64::min)
}

/// Works on all tiles.
pub(crate) fn each_tile(tiles: &mut [Tile], parallel: bool, work: impl Fn(usize, &mut Tile) + Sync + Send) {
    if parallel {
        tiles.par_iter_mut().enumerate().for_each(|(index, tile)| work(index, tile));
    } else {
        tiles.iter_mut().enumerate().for_each(|(index, tile)| work(index, tile));
    }
}

/// Notes a range unless it is empty.
pub(crate) fn push_range(ranges: &mut Vec<Range>, composition: u32, start: u32, end: u32) {
    if end > start {
        ranges.push(Range { composition, start, end });
    }
}

/// Buffers of a thread that change places with those of a tile whose inner list is made anew, so that pruning does not
/// allocate.
#[derive(Debug, Default)]
struct Spare {
    inner_outer: Vec<u32>,
    history: PairHistory,
}

fn prune_tile(
    tile: &mut Tile,
    old: &mut Spare,
    bodies: &Bodies,
    shifts: &[[f64; 3]; IMAGE_CODES],
    margin: f64,
    last: u32,
) {
    std::mem::swap(&mut tile.inner_outer, &mut old.inner_outer);
    std::mem::swap(&mut tile.history, &mut old.history);
    let mut known = 0;
    tile.marks.forget();
    tile.inner.clear();
    tile.inner_ranges.clear();
    tile.inner_outer.clear();
    tile.history.width = old.history.width;
    for range in &tile.outer_ranges {
        let begin = tile.inner.len() as u32;
        for at in range.start..range.end {
            let pair = tile.outer[at as usize];
            let a = bodies.position[tile.first + (pair.i_image >> 5) as usize];
            let b = bodies.position[pair.j as usize];
            let shift = shifts[(pair.i_image & 31) as usize];
            let limit = a[3] + b[3] + margin;
            let squared: f64 = (0..3).map(|k| a[k] - b[k] - shift[k]).map(|d| d * d).sum();
            if squared < limit * limit {
                tile.inner.push(pair);
                tile.inner_outer.push(at);
            }
        }
        push_range(&mut tile.inner_ranges, range.composition, begin, tile.inner.len() as u32);
    }
    if old.history.width > 0 {
        tile.history.resize(tile.inner.len());
        let old_outer = &old.inner_outer;
        for (at, outer) in tile.inner_outer.iter().enumerate() {
            while known < old_outer.len() && old_outer[known] < *outer {
                known += 1;
            }
            if known < old_outer.len()
                && old_outer[known] == *outer
                && let Some(history) = old.history.get(known, last)
            {
                tile.history.set(at, last, history);
            }
        }
    }
}

const _: () = assert!(NO_IMAGE < 32);
