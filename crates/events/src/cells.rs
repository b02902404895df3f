//! A grid of the shells, to find new neighbours.

use serde::{Deserialize, Serialize};

use crate::prefetch::prefetch;
use crate::two::below;

const NIL: u32 = u32::MAX;
/// Bodies that a bucket holds.
const ROOM: usize = 7;
/// Lanes of a bucket; the last one of `body` is the next bucket of the same cell.
const LANES: usize = 8;

/// Bodies of a cell with the centres of their shells, relative to the corner of the grid; not a number in empty lanes.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C, align(64))]
struct Bucket {
    body: [u32; LANES],
    x: [f32; LANES],
    y: [f32; LANES],
    z: [f32; LANES],
}

const EMPTY: Bucket =
    Bucket { body: [NIL; LANES], x: [f32::NAN; LANES], y: [f32::NAN; LANES], z: [f32::NAN; LANES] };

/// Bodies by the cell that their shell is centred in.
///
/// Centres are kept in single precision and within the box, which brings none of them farther apart than they are, so that
/// a search finds a few bodies too many and never one too few.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Cells {
    lo: [f64; 3],
    length: [f64; 3],
    inverse_width: [f64; 3],
    count: [usize; 3],
    periodic: [bool; 3],
    /// What single precision may be wrong by \[m\].
    slack: f64,
    /// One for each cell, then further ones.
    buckets: Vec<Bucket>,
    /// Bucket and lane of each body.
    slots: Vec<u32>,
}

impl Cells {
    /// An empty grid over a box, with cells at least `width` wide. Bodies beyond the box count to the cells at its rim.
    pub fn reset(&mut self, lo: [f64; 3], hi: [f64; 3], periodic: [bool; 3], width: f64, bodies: usize) {
        self.lo = lo;
        self.periodic = periodic;
        self.length = std::array::from_fn(|axis| hi[axis] - lo[axis]);
        let longest = self.length.iter().fold(0.0, |l: f64, length| l.max(*length));
        self.slack = 8.0 * f64::from(f32::EPSILON) * longest;
        // Many more cells than bodies cost memory and find nothing sooner.
        let mut width = width;
        loop {
            for axis in 0..3 {
                let length = self.length[axis];
                let cells = (length / width).floor().max(1.0).min(1e6);
                self.count[axis] = cells as usize;
                self.inverse_width[axis] = if length > 0.0 { cells / length } else { 0.0 };
            }
            let total = self.count.iter().map(|n| *n as f64).product::<f64>();
            if total <= (bodies / 2).max(64) as f64 {
                break;
            }
            width *= 1.1;
        }
        self.buckets.clear();
        self.buckets.resize(self.count[0] * self.count[1] * self.count[2], EMPTY);
        self.slots.clear();
        self.slots.resize(bodies, NIL);
    }

    /// True if this is a grid of `bodies` bodies, whatever file it comes from.
    pub fn is_whole(&self, bodies: usize) -> bool {
        let numbers = [self.lo, self.length, self.inverse_width];
        let cells = self.count.iter().try_fold(1, |cells: usize, count| cells.checked_mul(*count));
        let shaped = numbers.as_flattened().iter().all(|number| number.is_finite())
            && self.slack.is_finite()
            && cells.is_some_and(|cells| (1..=self.buckets.len()).contains(&cells))
            && self.slots.len() == bodies;
        let Some(cells) = cells.filter(|_| shaped) else { return false };
        // No bucket follows two others, or itself.
        let mut seen = vec![false; self.buckets.len()];
        for cell in 0..cells {
            let mut at = cell;
            while !std::mem::replace(&mut seen[at], true) {
                match self.buckets[at].body[ROOM] {
                    NIL => break,
                    next if (next as usize) < self.buckets.len() && !seen[next as usize] => {
                        at = next as usize
                    }
                    _ => return false,
                }
            }
        }
        let lane = |bucket: &Bucket, lane: usize| {
            let body = bucket.body[lane];
            // A search takes whatever lies near: only bodies may.
            if lane == ROOM || body == NIL { bucket.x[lane].is_nan() } else { (body as usize) < bodies }
        };
        let placed = |(body, slot): (usize, &u32)| {
            let (bucket, lane) = (*slot as usize / LANES, *slot as usize % LANES);
            self.buckets.get(bucket).is_some_and(|bucket| bucket.body[lane] as usize == body && lane < ROOM)
        };
        self.buckets.iter().all(|bucket| (0..LANES).all(|at| lane(bucket, at)))
            && self.slots.iter().enumerate().all(placed)
    }

    pub fn bytes(&self) -> usize {
        self.buckets.capacity() * size_of::<Bucket>() + self.slots.capacity() * size_of::<u32>()
    }

    #[inline]
    fn coordinate(&self, place: f64, axis: usize) -> usize {
        // Saturates below at 0.
        let cell = ((place - self.lo[axis]) * self.inverse_width[axis]) as usize;
        cell.min(self.count[axis] - 1)
    }

    /// Coordinates of the cell of a place, in the box or beyond it.
    #[inline]
    fn coordinates(&self, place: [f64; 3]) -> [usize; 3] {
        std::array::from_fn(|axis| self.coordinate(place[axis], axis))
    }

    #[inline]
    fn index(&self, at: [usize; 3]) -> usize {
        (at[2] * self.count[1] + at[1]) * self.count[0] + at[0]
    }

    /// As the lanes hold it.
    #[inline]
    fn within(&self, place: [f64; 3]) -> [f32; 3] {
        std::array::from_fn(|axis| (place[axis] - self.lo[axis]).min(self.length[axis]).max(0.0) as f32)
    }

    /// Puts a body into the cell of a place.
    pub fn insert(&mut self, body: u32, place: [f64; 3]) {
        let mut at = self.index(self.coordinates(place));
        let [x, y, z] = self.within(place);
        loop {
            let bucket = &mut self.buckets[at];
            if let Some(lane) = bucket.body[..ROOM].iter().position(|other| *other == NIL) {
                bucket.body[lane] = body;
                (bucket.x[lane], bucket.y[lane], bucket.z[lane]) = (x, y, z);
                self.slots[body as usize] = (at * LANES + lane) as u32;
                return;
            }
            if bucket.body[ROOM] == NIL {
                let further = self.buckets.len() as u32;
                self.buckets[at].body[ROOM] = further;
                if self.buckets.len() == self.buckets.capacity() {
                    self.buckets.reserve_exact(self.buckets.len() / 16 + 16);
                }
                self.buckets.push(EMPTY);
            }
            at = self.buckets[at].body[ROOM] as usize;
        }
    }

    /// Takes a body out.
    pub fn remove(&mut self, body: u32) {
        let slot = self.slots[body as usize] as usize;
        let (bucket, lane) = (&mut self.buckets[slot / LANES], slot % LANES);
        bucket.body[lane] = NIL;
        (bucket.x[lane], bucket.y[lane], bucket.z[lane]) = (f32::NAN, f32::NAN, f32::NAN);
    }

    /// Collects the bodies whose centres are within `reach` of a place, which is at most the width of a cell, and few beyond.
    pub fn around(&self, place: [f64; 3], reach: f64, found: &mut Vec<u32>) {
        found.clear();
        // A cell beside itself, or beside another on both sides, holds bodies of more than one image.
        if (0..3).any(|axis| self.periodic[axis] && self.count[axis] < 3) {
            self.collect::<true>(place, reach, found);
        } else {
            self.collect::<false>(place, reach, found);
        }
    }

    #[inline(always)]
    fn collect<const IMAGES: bool>(&self, place: [f64; 3], reach: f64, found: &mut Vec<u32>) {
        let at = self.coordinates(place);
        let [x, y, z] = self.within(place);
        let limit = (reach + self.slack) as f32;
        let limit = limit * limit;
        let period: [f32; 3] =
            std::array::from_fn(|k| if self.periodic[k] { self.length[k] as f32 } else { f32::INFINITY });
        let (xs, nx) = self.span(at[0], 0);
        let (ys, ny) = self.span(at[1], 1);
        let (zs, nz) = self.span(at[2], 2);
        for &(c_z, shift_z) in &zs[..nz] {
            for &(c_y, shift_y) in &ys[..ny] {
                for &(c_x, shift_x) in &xs[..nx] {
                    let here = [x + shift_x, y + shift_y, z + shift_z];
                    let mut next = self.index([c_x, c_y, c_z]);
                    loop {
                        let bucket = &self.buckets[next];
                        let mut near = below(&distances::<IMAGES>(bucket, here, period), limit);
                        while near != 0 {
                            found.push(bucket.body[near.trailing_zeros() as usize & 7]);
                            near &= near - 1;
                        }
                        if bucket.body[ROOM] == NIL {
                            break;
                        }
                        next = bucket.body[ROOM] as usize;
                    }
                }
            }
        }
    }

    /// Asks for the cells that a search about a place will read.
    #[inline]
    pub fn prefetch(&self, place: [f64; 3]) {
        let at = self.coordinates(place);
        let (xs, nx) = self.span(at[0], 0);
        let (ys, ny) = self.span(at[1], 1);
        let (zs, nz) = self.span(at[2], 2);
        for &(z, _) in &zs[..nz] {
            for &(y, _) in &ys[..ny] {
                for &(x, _) in &xs[..nx] {
                    // Two cache lines.
                    prefetch(&self.buckets, self.index([x, y, z]));
                    prefetch(&self.buckets[self.index([x, y, z])].y, 0);
                }
            }
        }
    }

    /// Asks for the record that says where a body is.
    #[inline]
    pub fn prefetch_slot(&self, body: u32) {
        prefetch(&self.slots, body as usize);
    }

    /// The cell and those beside it along one axis, each once, with what brings a place into the image of the cell.
    #[inline]
    fn span(&self, at: usize, axis: usize) -> ([(usize, f32); 3], usize) {
        let n = self.count[axis];
        let mut cells = [(at, 0.0); 3];
        let mut count = 1;
        if n == 1 {
            return (cells, 1);
        }
        let around = self.periodic[axis] && n > 2;
        let period = if around { self.length[axis] as f32 } else { 0.0 };
        if at > 0 || around {
            cells[count] = if at > 0 { (at - 1, 0.0) } else { (n - 1, period) };
            count += 1;
        }
        if at + 1 < n || around {
            cells[count] = if at + 1 < n { (at + 1, 0.0) } else { (0, -period) };
            count += 1;
        }
        (cells, count)
    }
}

/// Squares of the distances of the bodies in a bucket; of their nearest images if asked for.
#[inline(always)]
fn distances<const IMAGES: bool>(bucket: &Bucket, here: [f32; 3], period: [f32; 3]) -> [f32; LANES] {
    let along = |axis: usize, there: f32| {
        let d = here[axis] - there;
        if !IMAGES {
            return d;
        }
        let (d, around) = (d.abs(), period[axis] - d.abs());
        if around < d { around } else { d }
    };
    let mut squared = [0.0; LANES];
    for lane in 0..LANES {
        let (x, y, z) = (along(0, bucket.x[lane]), along(1, bucket.y[lane]), along(2, bucket.z[lane]));
        squared[lane] = x * x + y * y + z * z;
    }
    squared
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn whoever_is_within_a_width_is_found_once(
            places in prop::collection::vec(prop::array::uniform3(-0.5f64..2.5), 1..60),
            periodic in prop::array::uniform3(any::<bool>()), width in 0.2f64..1.1,
        ) {
            let mut cells = Cells::default();
            let (lo, hi) = ([0.0; 3], [2.0, 2.0, 2.0]);
            cells.reset(lo, hi, periodic, width, places.len());
            // Periodic directions hold places inside; others may hold places beyond the box.
            let places: Vec<[f64; 3]> = places
                .iter()
                .map(|p| std::array::from_fn(|k| if periodic[k] { p[k].rem_euclid(2.0) } else { p[k] }))
                .collect();
            for (body, place) in places.iter().enumerate() {
                cells.insert(body as u32, *place);
            }
            cells.remove(0);
            for place in &places {
                let mut found = Vec::new();
                cells.around(*place, width, &mut found);
                found.sort_unstable();
                let unique = found.len();
                found.dedup();
                prop_assert_eq!(unique, found.len());
                for (body, other) in places.iter().enumerate().skip(1) {
                    let squared: f64 = (0..3)
                        .map(|k| {
                            let d = (place[k] - other[k]).abs();
                            (if periodic[k] { d.min(2.0 - d) } else { d }).powi(2)
                        })
                        .sum();
                    let near = squared.sqrt() < width;
                    prop_assert!(!near || found.contains(&(body as u32)));
                }
            }
        }
    }
}
