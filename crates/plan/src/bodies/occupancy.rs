//! Which places are taken: bodies in grids of cells, one after the other.
//!
//! Bodies of similar size share a grid whose cells are as wide as they are, so that a small body that looks for a place meets
//! few others, whatever the ratio of sizes. A grid is a table of chains over hashed cells: its memory follows the number of
//! bodies, wherever they are.

use granule_geometry::Cell;

/// Bodies so far, with their periodic images near the region.
pub(crate) struct Occupancy<'a> {
    cell: &'a Cell,
    lo: [f64; 3],
    hi: [f64; 3],
    /// Largest radius so far, or to come.
    largest: f64,
    /// One grid an octave of radii, the first octave that was met first.
    grids: Vec<Grid>,
}

impl<'a> Occupancy<'a> {
    /// Nothing is taken. Places from `lo` to `hi` will be asked for, for bodies of radius up to `largest`.
    pub fn new(cell: &'a Cell, lo: [f64; 3], hi: [f64; 3], largest: f64) -> Self {
        Self { cell, lo, hi, largest, grids: Vec::new() }
    }

    /// Adds a body and those of its periodic images that could touch something in the region.
    pub fn insert(&mut self, position: [f64; 3], radius: f64) {
        self.largest = self.largest.max(radius);
        let period = self.cell.period();
        let shifts = period.map(|length| if length > 0.0 { -1..=1 } else { 0..=0 });
        for sx in shifts[0].clone() {
            for sy in shifts[1].clone() {
                for sz in shifts[2].clone() {
                    let shift = [sx, sy, sz];
                    let image: [f64; 3] =
                        std::array::from_fn(|axis| position[axis] + f64::from(shift[axis]) * period[axis]);
                    let margin = radius + self.largest;
                    let near = (0..3).all(|axis| {
                        image[axis] >= self.lo[axis] - margin && image[axis] <= self.hi[axis] + margin
                    });
                    if shift == [0, 0, 0] || near {
                        self.put(image, radius);
                    }
                }
            }
        }
    }

    fn put(&mut self, position: [f64; 3], radius: f64) {
        let octave = octave(radius);
        let at = match self.grids.iter().position(|grid| grid.octave == octave) {
            Some(at) => at,
            None => {
                self.grids.push(Grid::new(octave, radius));
                self.grids.len() - 1
            }
        };
        self.grids[at].insert(position, radius);
    }

    /// Whether a body at `position` would overlap none. Adds the number of cells and bodies that were looked at to `looks`.
    pub fn free(&self, position: [f64; 3], radius: f64, looks: &mut u64) -> bool {
        self.grids.iter().all(|grid| grid.free(position, radius, looks))
    }
}

/// Power of two below a radius, as the exponent's bits.
fn octave(radius: f64) -> u64 {
    radius.to_bits() >> 52
}

/// Bodies of one octave of radii.
struct Grid {
    octave: u64,
    /// Edge of a cell.
    edge: f64,
    largest: f64,
    /// First entry of each chain; a power of two of them.
    head: Vec<u32>,
    entries: Vec<Entry>,
}

struct Entry {
    position: [f64; 3],
    radius: f64,
    cell: [i64; 3],
    next: u32,
}

const END: u32 = u32::MAX;

impl Grid {
    fn new(octave: u64, radius: f64) -> Self {
        let edge = (2.0 * radius).max(f64::MIN_POSITIVE);
        Self { octave, edge, largest: 0.0, head: vec![END; 16], entries: Vec::new() }
    }

    /// Cell of a place; those beyond the range of integers share the last one.
    fn cell(&self, position: [f64; 3]) -> [i64; 3] {
        position.map(|x| (x / self.edge).floor() as i64)
    }

    fn chain(&self, cell: [i64; 3]) -> usize {
        // Odd multipliers of the golden ratio's family spread neighbouring cells over the high bits.
        let [x, y, z] = cell.map(|c| c as u64);
        let mixed = x
            .wrapping_mul(0x9E37_79B9_7F4A_7C15)
            .wrapping_add(y.wrapping_mul(0xC2B2_AE3D_27D4_EB4F))
            .wrapping_add(z.wrapping_mul(0x1656_67B1_9E37_79F9));
        let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        (mixed >> 32) as usize & (self.head.len() - 1)
    }

    fn insert(&mut self, position: [f64; 3], radius: f64) {
        if self.entries.len() >= self.head.len() {
            self.grow();
        }
        let Ok(at) = u32::try_from(self.entries.len()) else { return };
        let cell = self.cell(position);
        let chain = self.chain(cell);
        self.largest = self.largest.max(radius);
        self.entries.push(Entry { position, radius, cell, next: self.head[chain] });
        self.head[chain] = at;
    }

    fn grow(&mut self) {
        self.head = vec![END; 2 * self.head.len()];
        for at in 0..self.entries.len() {
            let chain = self.chain(self.entries[at].cell);
            self.entries[at].next = self.head[chain];
            self.head[chain] = at as u32;
        }
    }

    fn free(&self, position: [f64; 3], radius: f64, looks: &mut u64) -> bool {
        // A little more than the reach, so that round-off of the cells loses nothing.
        let reach = (radius + self.largest) * (1.0 + 1e-9);
        let low = self.cell(position.map(|x| x - reach));
        let high = self.cell(position.map(|x| x + reach));
        let cells: f64 = (0..3).map(|axis| high[axis] as f64 - low[axis] as f64 + 1.0).product();
        if cells > self.entries.len() as f64 {
            *looks += self.entries.len() as u64;
            return !self.entries.iter().any(|entry| entry.touches(position, radius));
        }
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    *looks += 1;
                    let mut at = self.head[self.chain([x, y, z])];
                    while at != END {
                        let entry = &self.entries[at as usize];
                        *looks += 1;
                        if entry.touches(position, radius) {
                            return false;
                        }
                        at = entry.next;
                    }
                }
            }
        }
        true
    }
}

impl Entry {
    fn touches(&self, position: [f64; 3], radius: f64) -> bool {
        let squared: f64 = (0..3).map(|axis| (position[axis] - self.position[axis]).powi(2)).sum();
        let least = radius + self.radius;
        squared < least * least
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn finds_what_looking_at_every_pair_finds(
            bodies in prop::collection::vec((prop::array::uniform3(0.0f64..1.0), 0.001f64..0.12), 1..60),
            power in 1i32..4,
        ) {
            for periodic in [[false; 3], [true, false, true], [true; 3]] {
                let cell = Cell::new([0.0; 3], [1.0; 3], periodic).unwrap();
                let mut taken = Occupancy::new(&cell, [0.0; 3], [1.0; 3], 0.12);
                // Powers make wide ratios of sizes.
                let size = |r: f64| 0.12 * (r / 0.12).powi(power);
                for (k, (position, radius)) in bodies.iter().enumerate() {
                    let radius = size(*radius);
                    let touched = bodies[..k].iter().any(|(other, r)| {
                        let d: [f64; 3] = std::array::from_fn(|axis| position[axis] - other[axis]);
                        let (image, _) = cell.minimum_image(d);
                        image.iter().map(|c| c * c).sum::<f64>().sqrt() < radius + size(*r)
                    });
                    prop_assert_eq!(taken.free(*position, radius, &mut 0), !touched);
                    taken.insert(*position, radius);
                }
            }
        }
    }

    #[test]
    fn extreme_extents_do_not_exhaust_anything() {
        let cell = Cell::unbounded();
        for far in [0.0, 1e-300, 1e300, f64::MAX] {
            let mut taken = Occupancy::new(&cell, [-far; 3], [far; 3], 1e-3);
            taken.insert([0.0; 3], 1e-3);
            assert!(!taken.free([1e-4, 0.0, 0.0], 1e-3, &mut 0));
            assert!(taken.free([3e-3, 0.0, 0.0], 1e-3, &mut 0));
            assert!(taken.free([far.max(1.0); 3], 1e-3, &mut 0));
        }
    }

    #[test]
    fn a_small_body_looks_at_few_others_whatever_their_sizes() {
        let cell = Cell::unbounded();
        let mut taken = Occupancy::new(&cell, [0.0; 3], [1.0; 3], 0.2);
        taken.insert([0.5; 3], 0.2);
        for k in 0..20_000 {
            let (x, y) = (f64::from(k % 200) * 5e-3, f64::from(k / 200) * 5e-3);
            taken.insert([x, y, 0.0], 2e-3);
        }
        let mut looks = 0;
        assert!(taken.free([0.3, 0.1, 0.004_1], 2e-3, &mut looks));
        assert!(looks < 150, "{looks}");
    }
}
