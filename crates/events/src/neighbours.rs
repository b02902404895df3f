//! Neighbours of each body: short lists in blocks of two cache lines.

/// Numbers in a block: a count, the neighbours, and the next block.
const WORDS: usize = 32;
/// Neighbours that a block holds.
const ROOM: usize = WORDS - 2;
const NEXT: usize = WORDS - 1;
const NIL: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Block([u32; WORDS]);

const EMPTY: Block = {
    let mut words = [0; WORDS];
    words[NEXT] = NIL;
    Block(words)
};

/// For each body the bodies that it may touch before it leaves its shell. Neighbours are mutual.
#[derive(Clone, Debug, Default)]
pub struct Neighbours {
    /// The first block of each body, then further ones.
    blocks: Vec<Block>,
    bodies: usize,
}

impl Neighbours {
    /// Empties all lists.
    pub fn reset(&mut self, bodies: usize) {
        self.blocks.clear();
        self.blocks.resize(bodies, EMPTY);
        self.bodies = bodies;
    }

    pub fn bytes(&self) -> usize {
        self.blocks.capacity() * size_of::<Block>()
    }

    /// Calls `visit` for each neighbour.
    #[inline(always)]
    pub fn each(&self, body: u32, mut visit: impl FnMut(u32)) {
        let mut at = body;
        loop {
            let Block(words) = &self.blocks[at as usize];
            let count = words[0] as usize;
            for &other in &words[1..=count.min(ROOM)] {
                visit(other);
            }
            at = words[NEXT];
            if at == NIL {
                return;
            }
        }
    }

    /// Number of neighbours.
    #[cfg(test)]
    pub fn count(&self, body: u32) -> usize {
        let mut count = 0;
        self.each(body, |_| count += 1);
        count
    }

    /// Makes two bodies neighbours of each other.
    #[inline]
    pub fn join(&mut self, a: u32, b: u32) {
        self.add(a, b);
        self.add(b, a);
    }

    fn add(&mut self, body: u32, other: u32) {
        let mut at = body as usize;
        loop {
            let further = self.blocks.len() as u32;
            let words = &mut self.blocks[at].0;
            let count = words[0] as usize;
            if count < ROOM {
                words[0] += 1;
                words[count + 1] = other;
                return;
            }
            if words[NEXT] == NIL {
                words[NEXT] = further;
                self.blocks.push(EMPTY);
            }
            at = self.blocks[at].0[NEXT] as usize;
        }
    }

    /// Takes a body out of the lists of all its neighbours, and empties its own.
    pub fn isolate(&mut self, body: u32) {
        let mut at = body as usize;
        loop {
            let count = self.blocks[at].0[0] as usize;
            for k in 1..=count {
                let other = self.blocks[at].0[k];
                self.remove(other, body);
            }
            self.blocks[at].0[0] = 0;
            let next = self.blocks[at].0[NEXT];
            if next == NIL {
                return;
            }
            at = next as usize;
        }
    }

    fn remove(&mut self, body: u32, other: u32) {
        let mut at = body as usize;
        loop {
            let words = &mut self.blocks[at].0;
            let count = words[0] as usize;
            if let Some(k) = words[1..=count].iter().position(|entry| *entry == other) {
                words[k + 1] = words[count];
                words[0] -= 1;
                return;
            }
            let next = words[NEXT];
            if next == NIL {
                return;
            }
            at = next as usize;
        }
    }

    /// Mean number of neighbours.
    pub fn mean(&self) -> f64 {
        let total: u64 = self.blocks.iter().map(|block| u64::from(block.0[0])).sum();
        total as f64 / self.bodies.max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn lists_are_mutual_sets_of_any_length() {
        let bodies = 90;
        let mut lists = Neighbours::default();
        lists.reset(bodies);
        let mut pairs = BTreeSet::new();
        for a in 0..bodies as u32 {
            for b in 0..a {
                if (a * 7 + b * 13) % 3 != 0 {
                    lists.join(a, b);
                    pairs.insert((b, a));
                }
            }
        }
        let check = |lists: &Neighbours, pairs: &BTreeSet<(u32, u32)>| {
            for a in 0..bodies as u32 {
                let mut found = BTreeSet::new();
                lists.each(a, |b| assert!(found.insert((a.min(b), a.max(b)))));
                let wanted: BTreeSet<_> = pairs.iter().copied().filter(|(i, j)| *i == a || *j == a).collect();
                assert_eq!(found, wanted);
                assert_eq!(lists.count(a), wanted.len());
            }
        };
        check(&lists, &pairs);
        for body in [5, 60, 89] {
            lists.isolate(body);
            pairs.retain(|(a, b)| *a != body && *b != body);
            check(&lists, &pairs);
        }
        lists.join(60, 5);
        pairs.insert((5, 60));
        check(&lists, &pairs);
    }
}
