//! Making the lists anew: bodies into their order in memory, pairs into tiles, histories from the old lists to the new.
//!
//! Every part runs tile by tile on all threads. What a tile gets depends on the bodies alone, so that the lists are the
//! same for any number of threads.

use std::ops::Range;
use std::sync::Mutex;

use granule_geometry::{BodyOrder, IMAGE_CODES, NeighbourGrid, PairScratch, image_code};
use granule_plan::{Partner, Plan, Search};
use granule_state::{Bodies, Row};
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::error::EngineError;
use crate::history::{Carried, swap};
use crate::lists::{each_tile, push_range};
use crate::tile::{Pair, Tile};
use crate::walls::{MovedWall, WallPair};

/// Rows that one thread wraps at a time.
const CHUNK: usize = 1 << 12;

/// What a rebuild needs besides the tiles; buffers are kept.
pub(crate) struct Rebuild {
    grid: NeighbourGrid,
    sorter: BodyOrder,
    /// Where the bodies were when the old lists were made, by their place now; empty if they have not been moved.
    order: Vec<u32>,
    /// Bound of what any body has moved since the bodies were sorted \[m\].
    pub(crate) travelled: f64,
    /// Composition of two materials, by `i * materials + j`.
    pair_class: Vec<Option<u32>>,
    /// Composition of a material with a wall, by `material * walls + wall`.
    wall_class: Vec<Option<u32>>,
    /// Histories of the old lists, tile by tile: of pairs and of contacts with walls.
    carried: Vec<[Carried; 2]>,
    /// One for each thread.
    scratch: Vec<Mutex<Scratch>>,
}

#[derive(Default)]
struct Scratch {
    near: PairScratch,
    pairs: Vec<Pair>,
    turned: Vec<f64>,
}

/// Numbers that a rebuild works with.
pub(crate) struct Reach {
    /// Pairs nearer than this beyond touching are candidates \[m\].
    pub outer: f64,
    /// Those that may touch soon \[m\].
    pub inner: f64,
    pub skin: f64,
    pub tile_size: usize,
    pub history_width: usize,
}

impl Rebuild {
    pub fn new(plan: &Plan) -> Self {
        let (materials, walls) = (plan.materials.len() as u16, plan.walls.len() as u16);
        let class = |material, partner| plan.composition(material, partner).map(|index| index as u32);
        let pairs = (0..materials).flat_map(|i| (0..materials).map(move |j| (i, j)));
        let with_walls = (0..materials).flat_map(|i| (0..walls).map(move |wall| (i, wall)));
        Self {
            grid: NeighbourGrid::new(),
            sorter: BodyOrder::new(),
            order: Vec::new(),
            travelled: f64::INFINITY,
            pair_class: pairs.map(|(i, j)| class(i, Partner::Body(j))).collect(),
            wall_class: with_walls.map(|(i, wall)| class(i, Partner::Wall(wall))).collect(),
            carried: Vec::new(),
            scratch: Vec::new(),
        }
    }

    /// Brings positions back into the cell.
    ///
    /// # Errors
    /// A body has crossed it more often than can be counted: its place in it means nothing any more.
    pub fn wrap(plan: &Plan, bodies: &mut Bodies, parallel: bool) -> Result<(), EngineError> {
        if !plan.cell.is_periodic() {
            return Ok(());
        }
        let wrap = |(rows, images): (&mut [Row], &mut [[i32; 3]])| {
            let mut lost = false;
            for (row, image) in rows.iter_mut().zip(images) {
                let (wrapped, crossed) = plan.cell.wrap(row.vector());
                *row = Row::new(wrapped, row[3]);
                for axis in 0..3 {
                    image[axis] = image[axis].saturating_add(crossed[axis]);
                    lost |= matches!(image[axis], i32::MIN | i32::MAX);
                }
            }
            lost
        };
        let lost = if parallel {
            let images = bodies.image.par_chunks_mut(CHUNK);
            bodies.position.par_chunks_mut(CHUNK).zip(images).map(wrap).reduce(|| false, |a, b| a || b)
        } else {
            wrap((&mut bodies.position, &mut bodies.image))
        };
        let uncounted = |image: &[i32; 3]| image.iter().any(|count| matches!(count, &i32::MIN | &i32::MAX));
        match bodies.image.iter().position(uncounted).filter(|_| lost) {
            Some(place) => Err(EngineError::Search(format!(
                "body {} has crossed the periodic cell more than {} times: the time step is too large for the forces on it",
                bodies.id[place],
                i32::MAX
            ))),
            None => Ok(()),
        }
    }

    /// Keeps the histories of touching pairs before the bodies are moved.
    pub fn carry(&mut self, tiles: &[Tile], width: usize, last: u32, parallel: bool) {
        self.carried.resize_with(tiles.len(), Default::default);
        let carry = |([pairs, walls], tile): (&mut [Carried; 2], &Tile)| {
            pairs.collect(
                tile.len,
                width,
                tile.inner.iter().enumerate().filter_map(|(index, pair)| {
                    Some((pair.i_image >> 5, pair.j, tile.history.get(index, last)?))
                }),
            );
            walls.collect(
                tile.len,
                width,
                tile.walls.pairs.iter().enumerate().filter_map(|(index, pair)| {
                    Some((pair.body, pair.wall, tile.walls.history.get(index, last)?))
                }),
            );
        };
        if parallel {
            self.carried.par_iter_mut().zip(tiles).for_each(carry);
        } else {
            self.carried.iter_mut().zip(tiles).for_each(carry);
        }
    }

    /// Sorts the bodies, unless they have hardly moved against each other since they were sorted last: neighbours in
    /// space stay near in memory for some cells of motion, and a sort moves every row.
    pub fn sort(&mut self, plan: &Plan, bodies: &mut Bodies, margin: f64, travelled: f64, parallel: bool) {
        self.travelled += travelled;
        self.order.clear();
        let count = bodies.len();
        let mean = bodies.position.iter().map(|row| row[3]).sum::<f64>() / count.max(1) as f64;
        let size = 2.0 * mean + margin;
        // Also where the motion is not a number.
        if self.travelled.is_nan() || self.travelled > size {
            let positions = Row::as_arrays(&bodies.position);
            self.sorter.sort(positions, &plan.cell, size, parallel, &mut self.order);
            bodies.permute(&self.order);
            self.travelled = 0.0;
        }
    }

    /// Finds the candidates of every tile, and gives the pairs that may touch their histories, if `carried`.
    pub fn fill(
        &mut self,
        tiles: &mut Vec<Tile>,
        (plan, bodies, walls): (&Plan, &Bodies, &[MovedWall]),
        shifts: &[[f64; 3]; IMAGE_CODES],
        reach: &Reach,
        carried: Option<u32>,
        parallel: bool,
    ) {
        let count = bodies.len();
        if plan.driver.search == Search::Grid {
            self.grid.build(Row::as_arrays(&bodies.position), &plan.cell, reach.outer, parallel);
        }
        tiles.resize_with(count.div_ceil(reach.tile_size), Tile::default);
        self.scratch.resize_with(if parallel { rayon::current_num_threads() } else { 1 }, Mutex::default);
        let this = &*self;
        each_tile(tiles, parallel, |index, tile| {
            let thread = rayon::current_thread_index().unwrap_or(0) % this.scratch.len();
            // A scratch is left behind by no panic that goes on.
            let mut scratch = this.scratch[thread].lock().unwrap_or_else(|poisoned| poisoned.into_inner());
            tile.first = index * reach.tile_size;
            tile.len = reach.tile_size.min(count - tile.first);
            tile.tally = crate::tally::Tally::new(plan.walls.len());
            this.outer(tile, plan, bodies, &mut scratch);
            inner(tile, bodies, shifts, reach);
            this.walls(tile, plan, bodies, walls, reach);
            if let Some(last) = carried {
                this.restore(tile, plan, reach.tile_size, last, &mut scratch.turned);
            }
        });
    }

    /// Candidates of a tile, sorted by their composition.
    fn outer(&self, tile: &mut Tile, plan: &Plan, bodies: &Bodies, scratch: &mut Scratch) {
        let materials = plan.materials.len();
        let class = |i: usize, j: usize| {
            self.pair_class[usize::from(bodies.material[i]) * materials + usize::from(bodies.material[j])]
        };
        let Scratch { near, pairs, .. } = scratch;
        pairs.clear();
        self.each_pair(tile.first..tile.first + tile.len, plan, bodies, near, |i, j, image| {
            let fixed = bodies.is_frozen(i as usize) && bodies.is_frozen(j as usize);
            if !fixed && class(i as usize, j as usize).is_some() {
                pairs.push(Pair { i_image: (i - tile.first as u32) << 5 | u32::from(image), j });
            }
        });
        tile.outer.clear();
        if tile.outer.capacity() < pairs.len() {
            // Room for fluctuations, but less than by doubling: these lists are a large part of all memory.
            tile.outer.reserve_exact(pairs.len() + pairs.len() / 8);
        }
        tile.outer_ranges.clear();
        let with_bodies = || {
            (0..plan.compositions.len() as u32)
                .filter(|at| matches!(plan.compositions[*at as usize].partner, Partner::Body(_)))
        };
        if with_bodies().count() == 1 {
            tile.outer.extend_from_slice(pairs);
            with_bodies().for_each(|only| push_range(&mut tile.outer_ranges, only, 0, pairs.len() as u32));
            return;
        }
        for composition in with_bodies() {
            let begin = tile.outer.len() as u32;
            let own = pairs
                .iter()
                .filter(|pair| class(tile.first + pair.place(), pair.j as usize) == Some(composition));
            tile.outer.extend(own);
            push_range(&mut tile.outer_ranges, composition, begin, tile.outer.len() as u32);
        }
    }

    /// Pairs that a range of bodies owns.
    fn each_pair(
        &self,
        own: Range<usize>,
        plan: &Plan,
        bodies: &Bodies,
        near: &mut PairScratch,
        mut found: impl FnMut(u32, u32, u8),
    ) {
        match plan.driver.search {
            Search::None => {}
            Search::AllPairs => {
                for i in own {
                    let a = bodies.position[i];
                    for j in i + 1..bodies.len() {
                        let b = bodies.position[j];
                        let (_, shift) = plan.cell.minimum_image([a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
                        found(i as u32, j as u32, image_code(shift));
                    }
                }
            }
            Search::Grid => self.grid.pairs_of(own, near, found),
        }
    }

    fn walls(&self, tile: &mut Tile, plan: &Plan, bodies: &Bodies, walls: &[MovedWall], reach: &Reach) {
        tile.walls.pairs.clear();
        tile.walls.ranges.clear();
        for (composition, with) in plan.compositions.iter().enumerate() {
            let Partner::Wall(wall) = with.partner else { continue };
            let begin = tile.walls.pairs.len() as u32;
            let moved = &walls[usize::from(wall)];
            for body in 0..tile.len {
                let place = tile.first + body;
                let class = usize::from(bodies.material[place]) * plan.walls.len() + usize::from(wall);
                let row = bodies.position[place];
                let near = || moved.surface.contact(Vector3::new(row[0], row[1], row[2])).distance;
                if self.wall_class[class] == Some(composition as u32)
                    && !bodies.is_frozen(place)
                    && near() < row[3] + with.reach + reach.skin
                {
                    tile.walls.pairs.push(WallPair { body: body as u32, wall: u32::from(wall) });
                }
            }
            push_range(&mut tile.walls.ranges, composition as u32, begin, tile.walls.pairs.len() as u32);
        }
        tile.walls.history.width = reach.history_width;
        tile.walls.history.resize(tile.walls.pairs.len());
    }

    /// Gives the pairs of a new list the histories that they had in the old one.
    fn restore(&self, tile: &mut Tile, plan: &Plan, tile_size: usize, last: u32, turned: &mut Vec<f64>) {
        let before = |place: usize| self.order.get(place).map_or(place, |before| *before as usize);
        let get =
            |kind: usize, i: usize, j: u32| self.carried[i / tile_size][kind].get((i % tile_size) as u32, j);
        for range in &tile.inner_ranges {
            let composition = &plan.compositions[range.composition as usize];
            for at in range.start as usize..range.end as usize {
                let pair = tile.inner[at];
                let (i, j) = (before(tile.first + pair.place()), before(pair.j as usize));
                if let Some(history) = get(0, i, j as u32) {
                    tile.history.set(at, last, history);
                } else if let Some(history) = get(0, j, i as u32) {
                    turned.clear();
                    turned.extend_from_slice(history);
                    swap(composition, turned);
                    tile.history.set(at, last, turned);
                }
            }
        }
        for (at, pair) in tile.walls.pairs.iter().enumerate() {
            if let Some(history) = get(1, before(tile.first + pair.body as usize), pair.wall) {
                tile.walls.history.set(at, last, history);
            }
        }
    }

    /// Heap bytes of the buffers.
    pub fn bytes(&self) -> usize {
        self.grid.bytes()
            + self.sorter.bytes()
            + 4 * self.order.capacity()
            + self.carried.iter().flatten().map(Carried::bytes).sum::<usize>()
    }
}

/// The candidates that may touch soon, without history.
fn inner(tile: &mut Tile, bodies: &Bodies, shifts: &[[f64; 3]; IMAGE_CODES], reach: &Reach) {
    tile.inner.clear();
    tile.inner_outer.clear();
    tile.inner_ranges.clear();
    for range in &tile.outer_ranges {
        let begin = tile.inner.len() as u32;
        for at in range.start..range.end {
            let pair = tile.outer[at as usize];
            let (a, b) = (bodies.position[tile.first + pair.place()], bodies.position[pair.j as usize]);
            let shift = shifts[(pair.i_image & 31) as usize];
            let limit = a[3] + b[3] + reach.inner;
            let squared: f64 = (0..3).map(|k| a[k] - b[k] - shift[k]).map(|d| d * d).sum();
            if squared < limit * limit {
                tile.inner.push(pair);
                tile.inner_outer.push(at);
            }
        }
        push_range(&mut tile.inner_ranges, range.composition, begin, tile.inner.len() as u32);
    }
    tile.history.width = reach.history_width;
    tile.history.resize(tile.inner.len());
}
