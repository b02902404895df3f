//! Which places are taken: bodies in a grid of cells, one after the other.

use granule_geometry::Cell;

/// Bodies so far, with their periodic images near the region.
pub(crate) struct Occupancy<'a> {
    cell: &'a Cell,
    lo: [f64; 3],
    hi: [f64; 3],
    size: [f64; 3],
    count: [usize; 3],
    largest: f64,
    /// First entry of each grid cell.
    head: Vec<u32>,
    entries: Vec<Entry>,
}

struct Entry {
    position: [f64; 3],
    radius: f64,
    body: u32,
    next: u32,
}

const END: u32 = u32::MAX;

impl<'a> Occupancy<'a> {
    /// An empty region from `lo` to `hi` for about `bodies` bodies of radius up to `largest`.
    pub fn new(cell: &'a Cell, lo: [f64; 3], hi: [f64; 3], largest: f64, bodies: usize) -> Self {
        // No more grid cells than bodies: the size grows until they fit.
        let most = 2.0 * bodies as f64 + 64.0;
        let extent: [f64; 3] = std::array::from_fn(|axis| (hi[axis] - lo[axis]).max(0.0));
        let mut size = (2.0 * largest).max(f64::MIN_POSITIVE);
        let number = |size: f64| extent.map(|extent| (extent / size).floor().max(1.0).min(1e9));
        let mut counts = number(size);
        // Ends: a size beyond the extents makes one cell.
        for _ in 0..2048 {
            if counts[0] * counts[1] * counts[2] <= most {
                break;
            }
            size *= 1.5;
            counts = number(size);
        }
        let count = counts.map(|count| count as usize);
        let size = std::array::from_fn(|axis| extent[axis] / counts[axis]);
        let cells = count[0] * count[1] * count[2];
        Self {
            cell,
            lo,
            hi,
            size,
            count,
            largest,
            head: vec![END; cells],
            entries: Vec::with_capacity(bodies),
        }
    }

    /// The region that holds all positions.
    #[cfg(test)]
    pub fn around(cell: &'a Cell, positions: impl Iterator<Item = ([f64; 3], f64)> + Clone) -> Self {
        let (mut lo, mut hi, mut largest, mut bodies) =
            ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3], 0.0f64, 0);
        for (position, radius) in positions {
            for axis in 0..3 {
                lo[axis] = lo[axis].min(position[axis]);
                hi[axis] = hi[axis].max(position[axis]);
            }
            largest = largest.max(radius);
            bodies += 1;
        }
        Self::new(cell, lo, hi, largest, bodies)
    }

    fn index(&self, axis: usize, x: f64) -> usize {
        // A quotient that is negative or not a number becomes 0.
        (((x - self.lo[axis]) / self.size[axis]) as usize).min(self.count[axis] - 1)
    }

    /// Adds a body and those of its periodic images that could touch something in the region.
    pub fn insert(&mut self, position: [f64; 3], radius: f64, body: u32) {
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
                        self.put(image, radius, body);
                    }
                }
            }
        }
    }

    fn put(&mut self, position: [f64; 3], radius: f64, body: u32) {
        let [x, y, z] = std::array::from_fn(|axis| self.index(axis, position[axis]));
        let cell = (z * self.count[1] + y) * self.count[0] + x;
        let Ok(at) = u32::try_from(self.entries.len()) else { return };
        self.entries.push(Entry { position, radius, body, next: self.head[cell] });
        self.head[cell] = at;
    }

    /// A body nearer than touching less `allowance` of the smaller radius, and the overlap; the first one found.
    pub fn overlap(&self, position: [f64; 3], radius: f64, allowance: f64) -> Option<(u32, f64)> {
        let reach = radius + self.largest;
        let low: [usize; 3] = std::array::from_fn(|axis| self.index(axis, position[axis] - reach));
        let high: [usize; 3] = std::array::from_fn(|axis| self.index(axis, position[axis] + reach));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    let mut at = self.head[(z * self.count[1] + y) * self.count[0] + x];
                    while at != END {
                        let entry = &self.entries[at as usize];
                        let squared: f64 =
                            (0..3).map(|axis| (position[axis] - entry.position[axis]).powi(2)).sum();
                        let least = radius + entry.radius - allowance * radius.min(entry.radius);
                        if squared < least * least {
                            return Some((entry.body, radius + entry.radius - squared.sqrt()));
                        }
                        at = entry.next;
                    }
                }
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn finds_what_looking_at_every_pair_finds(
            bodies in prop::collection::vec((prop::array::uniform3(0.0f64..1.0), 0.01f64..0.12), 1..60),
        ) {
            for periodic in [[false; 3], [true, false, true], [true; 3]] {
                let cell = Cell::new([0.0; 3], [1.0; 3], periodic).unwrap();
                let mut grid = Occupancy::around(&cell, bodies.iter().copied());
                for (k, (position, radius)) in bodies.iter().enumerate() {
                    let touched = bodies[..k].iter().any(|(other, r)| {
                        let d: [f64; 3] = std::array::from_fn(|axis| position[axis] - other[axis]);
                        let (image, _) = cell.minimum_image(d);
                        image.iter().map(|c| c * c).sum::<f64>().sqrt() < radius + r
                    });
                    prop_assert_eq!(grid.overlap(*position, *radius, 0.0).is_some(), touched);
                    grid.insert(*position, *radius, k as u32);
                }
            }
        }
    }

    #[test]
    fn extreme_extents_do_not_exhaust_anything() {
        let cell = Cell::unbounded();
        for far in [0.0, 1e-300, 1e300, f64::MAX] {
            let mut grid = Occupancy::new(&cell, [-far; 3], [far; 3], 1e-3, 10);
            grid.insert([0.0; 3], 1e-3, 1);
            assert!(grid.overlap([1e-4, 0.0, 0.0], 1e-3, 0.0).is_some());
            assert!(grid.overlap([3e-3, 0.0, 0.0], 1e-3, 0.0).is_none());
        }
    }
}
