//! Candidate lists: the outer list with the Verlet skin, the inner list pruned from it, and where forces between tiles go.

use std::sync::Mutex;

use granule_geometry::{IMAGE_CODES, NO_IMAGE, NeighbourGrid};
use granule_plan::{Partner, Plan, Search};
use granule_state::{Bodies, Row};
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::error::EngineError;
use crate::history::{Carried, PairHistory, swap};
use crate::tile::{Incoming, Outgoing, Pair, Range, Tile};
use crate::walls::{MovedWall, WallPair};

/// Lists, and how far bodies have moved since they were made.
pub(crate) struct Lists {
    pub tiles: Vec<Tile>,
    pub tile_size: usize,
    pub shifts: [[f64; 3]; IMAGE_CODES],
    /// The same as rows, as many as codes could be written in their bits.
    pub shift_rows: [Row; 32],
    grid: NeighbourGrid,
    /// Part of the skin for which a periodic cell must have room.
    margin: f64,
    skin: f64,
    inner_skin: f64,
    /// Bound of what any body (or wall) has moved since the outer list was made \[m\].
    travelled_outer: f64,
    /// The same since the inner list was pruned \[m\].
    travelled_inner: f64,
    steps_since_prune: u32,
    /// Composition of two materials, by `i * materials + j`.
    pair_class: Vec<Option<u32>>,
    /// Composition of a material with a wall, by `material * walls + wall`.
    wall_class: Vec<Option<u32>>,
    largest_radius: f64,
    /// Largest distance beyond touching at which a law acts \[m\].
    reach: f64,
    history_width: usize,
    order: Vec<u32>,
    start: Vec<u32>,
    partner: Vec<u32>,
    image: Vec<u8>,
    scratch: Vec<Row>,
    spares: Vec<Mutex<Spare>>,
    /// How often lists were made and pruned.
    pub rebuilds: u64,
    pub prunes: u64,
}

impl Lists {
    pub fn new(plan: &Plan, bodies: &Bodies, tile_size: usize) -> Self {
        let (materials, walls) = (plan.materials.len() as u16, plan.walls.len() as u16);
        let class = |material, partner| plan.composition(material, partner).map(|index| index as u32);
        let pairs = (0..materials).flat_map(|i| (0..materials).map(move |j| (i, j)));
        let with_walls = (0..materials).flat_map(|i| (0..walls).map(move |wall| (i, wall)));
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
            grid: NeighbourGrid::new(),
            margin: if plan.driver.search == Search::Grid { skin } else { 0.0 },
            skin,
            inner_skin: skin / 16.0,
            travelled_outer: f64::INFINITY,
            travelled_inner: f64::INFINITY,
            steps_since_prune: 0,
            pair_class: pairs.map(|(i, j)| class(i, Partner::Body(j))).collect(),
            wall_class: with_walls.map(|(i, wall)| class(i, Partner::Wall(wall))).collect(),
            largest_radius,
            reach,
            history_width: crate::level::history_width(plan),
            order: Vec::new(),
            start: Vec::new(),
            partner: Vec::new(),
            image: Vec::new(),
            scratch: Vec::new(),
            spares: Vec::new(),
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
        let count = bodies.len();
        plan.cell
            .check_minimum_length(self.largest_radius, self.margin + self.reach)
            .map_err(|error| EngineError::Search(error.to_string()))?;
        for (row, image) in bodies.position.iter_mut().zip(&mut bodies.image) {
            let (wrapped, crossed) = plan.cell.wrap(row.vector());
            *row = Row::new(wrapped, row[3]);
            for axis in 0..3 {
                image[axis] += crossed[axis];
            }
        }
        let carried =
            (self.history_width > 0 && !self.tiles.is_empty()).then(|| self.carry(count, plan, last));
        if plan.driver.search == Search::Grid {
            let size = 2.0 * self.largest_radius + self.skin + self.reach;
            self.grid.cell_order(Row::as_arrays(&bodies.position), &plan.cell, size, &mut self.order);
            bodies.permute(&self.order, &mut self.scratch);
        } else {
            self.order.clear();
            self.order.extend(0..count as u32);
        }
        self.find_pairs(plan, bodies);
        self.fill_tiles(plan, bodies, walls, carried.as_ref(), last, parallel);
        self.travelled_outer = 0.0;
        self.rebuilds += 1;
        Ok(())
    }

    fn find_pairs(&mut self, plan: &Plan, bodies: &Bodies) {
        let count = bodies.len();
        match plan.driver.search {
            Search::None => {
                self.start.clear();
                self.start.resize(count + 1, 0);
                self.partner.clear();
                self.image.clear();
            }
            Search::AllPairs => {
                self.start.clear();
                self.partner.clear();
                self.image.clear();
                self.start.push(0);
                for i in 0..count {
                    let a = bodies.position[i];
                    for j in i + 1..count {
                        let b = bodies.position[j];
                        let (_, shift) = plan.cell.minimum_image([a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
                        self.partner.push(j as u32);
                        self.image.push(granule_geometry::image_code(shift));
                    }
                    self.start.push(self.partner.len() as u32);
                }
            }
            Search::Grid => self.grid.half_pairs(
                Row::as_arrays(&bodies.position),
                &plan.cell,
                self.skin + self.reach,
                &mut self.start,
                &mut self.partner,
                &mut self.image,
            ),
        }
    }

    /// Histories of touching pairs under the places that bodies have now, before they are sorted.
    fn carry(&self, count: usize, plan: &Plan, last: u32) -> (Carried, Carried) {
        let pairs = self.tiles.iter().flat_map(move |tile| {
            tile.inner.iter().enumerate().filter_map(move |(index, pair)| {
                let history = tile.history.get(index, last)?;
                Some((tile.first as u32 + (pair.i_image >> 5), pair.j, history))
            })
        });
        let walls = self.tiles.iter().flat_map(move |tile| {
            tile.walls.pairs.iter().enumerate().filter_map(move |(index, pair)| {
                let history = tile.walls.history.get(index, last)?;
                Some((tile.first as u32 + pair.body, pair.wall, history))
            })
        });
        let walls = if plan.walls.is_empty() {
            Carried::collect(count, self.history_width, std::iter::empty())
        } else {
            Carried::collect(count, self.history_width, walls)
        };
        (Carried::collect(count, self.history_width, pairs), walls)
    }

    fn fill_tiles(
        &mut self,
        plan: &Plan,
        bodies: &Bodies,
        walls: &[MovedWall],
        carried: Option<&(Carried, Carried)>,
        last: u32,
        parallel: bool,
    ) {
        let count = bodies.len();
        let tiles = count.div_ceil(self.tile_size);
        self.tiles.resize_with(tiles, Tile::default);
        let (size, width, skin) = (self.tile_size, self.history_width, self.skin);
        let materials = plan.materials.len();
        let (start, partner, image) = (&self.start, &self.partner, &self.image);
        let (pair_class, wall_class, order) = (&self.pair_class, &self.wall_class, &self.order);
        each_tile(&mut self.tiles, parallel, |index, tile| {
            tile.first = index * size;
            tile.len = size.min(count - tile.first);
            tile.tally = crate::tally::Tally::new(plan.walls.len());
            let class = |i: usize, j: usize| {
                pair_class[usize::from(bodies.material[i]) * materials + usize::from(bodies.material[j])]
            };
            tile.outer.clear();
            tile.outer_ranges.clear();
            for composition in 0..plan.compositions.len() as u32 {
                if matches!(plan.compositions[composition as usize].partner, Partner::Wall(_)) {
                    continue;
                }
                let begin = tile.outer.len() as u32;
                for i in tile.first..tile.first + tile.len {
                    for at in start[i] as usize..start[i + 1] as usize {
                        let j = partner[at] as usize;
                        let fixed = bodies.is_frozen(i) && bodies.is_frozen(j);
                        if !fixed && class(i, j) == Some(composition) {
                            let i_image = ((i - tile.first) as u32) << 5 | u32::from(image[at]);
                            tile.outer.push(Pair { i_image, j: j as u32 });
                        }
                    }
                }
                push_range(&mut tile.outer_ranges, composition, begin, tile.outer.len() as u32);
            }
            tile.inner.clear();
            tile.inner.extend_from_slice(&tile.outer);
            tile.inner_ranges.clone_from(&tile.outer_ranges);
            tile.inner_outer.clear();
            tile.inner_outer.extend(0..tile.outer.len() as u32);
            tile.history.width = width;
            tile.history.resize(tile.inner.len());
            fill_wall_list(tile, plan, bodies, walls, wall_class, skin, width);
            if let Some((pairs, with_walls)) = carried {
                restore(tile, plan, order, pairs, with_walls, last);
            }
        });
    }

    /// Makes the inner lists from the outer ones, and the routes of forces between tiles.
    pub fn prune(&mut self, bodies: &Bodies, last: u32, parallel: bool) {
        self.adapt_inner_skin();
        let (margin, shifts, size) = (self.inner_skin, &self.shifts, self.tile_size);
        let reach = self.reach;
        let threads = if parallel { rayon::current_num_threads() } else { 1 };
        self.spares.resize_with(threads.max(self.spares.len()), Default::default);
        let spares = &self.spares;
        each_tile(&mut self.tiles, parallel, |_, tile| {
            let thread = rayon::current_thread_index().unwrap_or(0) % spares.len();
            // A panic elsewhere poisons a lock on buffers whose contents do not matter.
            let mut spare = spares[thread].lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            prune_tile(tile, &mut spare, bodies, shifts, reach + margin, last);
        });
        for index in 0..self.tiles.len() {
            self.tiles[index].inbox.clear();
        }
        for index in 0..self.tiles.len() {
            let (first, len) = (self.tiles[index].first, self.tiles[index].len);
            let mut slot = 0;
            self.tiles[index].list.clear(first, len, bodies.len());
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
            self.tiles[index].outbox.resize(slot, Outgoing::default());
        }
        self.travelled_inner = 0.0;
        self.steps_since_prune = 0;
        self.prunes += 1;
    }

    /// A thin inner skin makes short lists, a thick one rare pruning. The choice depends on the motion alone, so it is
    /// the same for any number of threads.
    fn adapt_inner_skin(&mut self) {
        if self.travelled_inner.is_finite() {
            if self.steps_since_prune < 10 {
                self.inner_skin = (self.inner_skin * 2.0).min(self.skin);
            } else if self.steps_since_prune > 80 {
                self.inner_skin = (self.inner_skin * 0.5).max(self.skin / 64.0);
            }
        }
    }

    /// Heap bytes of lists and histories.
    pub fn bytes(&self) -> usize {
        let buffers = self.order.capacity() * 4
            + self.start.capacity() * 4
            + self.partner.capacity() * 4
            + self.image.capacity()
            + self.scratch.capacity() * size_of::<Row>();
        buffers + self.tiles.iter().map(Tile::bytes).sum::<usize>()
    }
}

/// Shortest period of the cell \[m\]; infinite without periodic directions.
fn nearest_period(plan: &Plan) -> f64 {
    let (period, periodic) = (plan.cell.period(), plan.cell.periodic());
    (0..3).filter(|axis| periodic[*axis]).map(|axis| period[axis]).fold(f64::INFINITY, f64::min)
}

fn each_tile(tiles: &mut [Tile], parallel: bool, work: impl Fn(usize, &mut Tile) + Sync + Send) {
    if parallel {
        tiles.par_iter_mut().enumerate().for_each(|(index, tile)| work(index, tile));
    } else {
        tiles.iter_mut().enumerate().for_each(|(index, tile)| work(index, tile));
    }
}

fn push_range(ranges: &mut Vec<Range>, composition: u32, start: u32, end: u32) {
    if end > start {
        ranges.push(Range { composition, start, end });
    }
}

fn fill_wall_list(
    tile: &mut Tile,
    plan: &Plan,
    bodies: &Bodies,
    walls: &[MovedWall],
    wall_class: &[Option<u32>],
    skin: f64,
    width: usize,
) {
    tile.walls.pairs.clear();
    tile.walls.ranges.clear();
    for (composition, with) in plan.compositions.iter().enumerate() {
        let Partner::Wall(wall) = with.partner else { continue };
        let begin = tile.walls.pairs.len() as u32;
        let moved = &walls[usize::from(wall)];
        for body in 0..tile.len {
            let place = tile.first + body;
            let class =
                wall_class[usize::from(bodies.material[place]) * plan.walls.len() + usize::from(wall)];
            let row = bodies.position[place];
            let near = || moved.surface.contact(Vector3::new(row[0], row[1], row[2])).distance;
            if class == Some(composition as u32)
                && !bodies.is_frozen(place)
                && near() < row[3] + with.reach + skin
            {
                tile.walls.pairs.push(WallPair { body: body as u32, wall: u32::from(wall) });
            }
        }
        push_range(&mut tile.walls.ranges, composition as u32, begin, tile.walls.pairs.len() as u32);
    }
    tile.walls.history = PairHistory::new(width);
    tile.walls.history.resize(tile.walls.pairs.len());
}

/// Gives the pairs of a new list the histories that they had in the old one.
fn restore(tile: &mut Tile, plan: &Plan, order: &[u32], pairs: &Carried, walls: &Carried, last: u32) {
    let mut turned = Vec::new();
    for range in &tile.inner_ranges {
        let composition = &plan.compositions[range.composition as usize];
        for at in range.start as usize..range.end as usize {
            let pair = tile.inner[at];
            let i = order[tile.first + (pair.i_image >> 5) as usize];
            let j = order[pair.j as usize];
            if let Some(history) = pairs.get(i, j) {
                tile.history.set(at, last, history);
            } else if let Some(history) = pairs.get(j, i) {
                turned.clear();
                turned.extend_from_slice(history);
                swap(composition, &mut turned);
                tile.history.set(at, last, &turned);
            }
        }
    }
    for (at, pair) in tile.walls.pairs.iter().enumerate() {
        if let Some(history) = walls.get(order[tile.first + pair.body as usize], pair.wall) {
            tile.walls.history.set(at, last, history);
        }
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
