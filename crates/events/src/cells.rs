//! A grid of the shells, to find new neighbours.

const NIL: u32 = u32::MAX;

/// Bodies by the cell that their shell is centred in, as linked lists.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    lo: [f64; 3],
    inverse_width: [f64; 3],
    count: [usize; 3],
    periodic: [bool; 3],
    heads: Vec<u32>,
    links: Vec<Link>,
}

#[derive(Clone, Copy, Debug)]
struct Link {
    next: u32,
    previous: u32,
    cell: u32,
}

impl Cells {
    /// An empty grid over a box, with cells at least `width` wide. Bodies beyond the box count to the cells at its rim.
    pub fn reset(&mut self, lo: [f64; 3], hi: [f64; 3], periodic: [bool; 3], width: f64, bodies: usize) {
        self.lo = lo;
        self.periodic = periodic;
        // More cells than bodies cost memory and find nothing sooner.
        let mut width = width;
        loop {
            for axis in 0..3 {
                let length = hi[axis] - lo[axis];
                let cells = (length / width).floor().max(1.0).min(1e6);
                self.count[axis] = cells as usize;
                self.inverse_width[axis] = if length > 0.0 { cells / length } else { 0.0 };
            }
            let total = self.count.iter().map(|n| *n as f64).product::<f64>();
            if total <= (2 * bodies).max(64) as f64 {
                break;
            }
            width *= 1.1;
        }
        self.heads.clear();
        self.heads.resize(self.count[0] * self.count[1] * self.count[2], NIL);
        self.links.clear();
        self.links.resize(bodies, Link { next: NIL, previous: NIL, cell: NIL });
    }

    pub fn bytes(&self) -> usize {
        self.heads.capacity() * size_of::<u32>() + self.links.capacity() * size_of::<Link>()
    }

    #[inline]
    fn coordinate(&self, place: f64, axis: usize) -> usize {
        // Saturates below at 0.
        let cell = ((place - self.lo[axis]) * self.inverse_width[axis]) as usize;
        cell.min(self.count[axis] - 1)
    }

    /// Coordinates of the cell of a place, in the box or beyond it.
    #[inline]
    pub fn coordinates(&self, place: [f64; 3]) -> [usize; 3] {
        std::array::from_fn(|axis| self.coordinate(place[axis], axis))
    }

    #[inline]
    fn index(&self, at: [usize; 3]) -> usize {
        (at[2] * self.count[1] + at[1]) * self.count[0] + at[0]
    }

    /// Puts a body into the cell of a place.
    pub fn insert(&mut self, body: u32, place: [f64; 3]) {
        let cell = self.index(self.coordinates(place));
        let first = std::mem::replace(&mut self.heads[cell], body);
        self.links[body as usize] = Link { next: first, previous: NIL, cell: cell as u32 };
        if first != NIL {
            self.links[first as usize].previous = body;
        }
    }

    /// Takes a body out.
    pub fn remove(&mut self, body: u32) {
        let Link { next, previous, cell } = self.links[body as usize];
        if previous == NIL {
            self.heads[cell as usize] = next;
        } else {
            self.links[previous as usize].next = next;
        }
        if next != NIL {
            self.links[next as usize].previous = previous;
        }
    }

    /// Calls `visit` for each body in the cells about a place that are no farther than one cell.
    #[inline(always)]
    pub fn around(&self, place: [f64; 3], mut visit: impl FnMut(u32)) {
        let at = self.coordinates(place);
        let (xs, nx) = self.span(at[0], 0);
        let (ys, ny) = self.span(at[1], 1);
        let (zs, nz) = self.span(at[2], 2);
        for &z in &zs[..nz] {
            for &y in &ys[..ny] {
                for &x in &xs[..nx] {
                    let mut body = self.heads[self.index([x, y, z])];
                    while body != NIL {
                        visit(body);
                        body = self.links[body as usize].next;
                    }
                }
            }
        }
    }

    /// The cell and those beside it along one axis, each once.
    #[inline]
    fn span(&self, at: usize, axis: usize) -> ([usize; 3], usize) {
        let n = self.count[axis];
        let mut cells = [at, 0, 0];
        let mut count = 1;
        if n == 1 {
            return (cells, 1);
        }
        let periodic = self.periodic[axis];
        if at > 0 || (periodic && n > 2) {
            cells[count] = if at > 0 { at - 1 } else { n - 1 };
            count += 1;
        }
        if at + 1 < n || (periodic && n > 2) {
            cells[count] = if at + 1 < n { at + 1 } else { 0 };
            count += 1;
        }
        (cells, count)
    }
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
                cells.around(*place, |body| found.push(body));
                found.sort_unstable();
                let unique = found.len();
                found.dedup();
                prop_assert_eq!(unique, found.len());
                for (body, other) in places.iter().enumerate().skip(1) {
                    let near = (0..3).all(|k| {
                        let d = (place[k] - other[k]).abs();
                        (if periodic[k] { d.min(2.0 - d) } else { d }) < width
                    });
                    prop_assert!(!near || found.contains(&(body as u32)));
                }
            }
        }
    }
}
