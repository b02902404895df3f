//! Neighbours of each body: short lists in blocks of two cache lines.

use serde::{Deserialize, Serialize};

use crate::prefetch::prefetch;

/// Numbers in a block: a count, the next block, and the neighbours.
const WORDS: usize = 32;
const NEXT: usize = 1;
/// Place of the first neighbour.
const FIRST: usize = 2;
/// Neighbours that a block holds, and those of them that are in its first cache line.
const ROOM: usize = WORDS - FIRST;
const ROOM_OF_LINE: usize = WORDS / 2 - FIRST;
const NIL: u32 = u32::MAX;

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C, align(64))]
struct Block([u32; WORDS]);

/// Numbers compared at once.
const LANES: usize = 8;
/// Place of each entry; 0 for words that are none.
const PLACES: [u32; WORDS] = {
    let mut places = [0; WORDS];
    let mut k = FIRST;
    while k < WORDS {
        places[k] = k as u32;
        k += 1;
    }
    places
};

const EMPTY: Block = {
    let mut words = [NIL; WORDS];
    words[0] = 0;
    Block(words)
};

/// For each body the bodies that it may touch before it leaves its shell. Neighbours are mutual.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Neighbours {
    /// The first block of each body, then further ones.
    blocks: Vec<Block>,
    bodies: usize,
    /// Room for comparing lists.
    #[serde(skip)]
    old: Vec<u32>,
    #[serde(skip)]
    wanted: Vec<u32>,
}

/// The slices of a list.
pub struct Lists<'a> {
    blocks: &'a [Block],
    next: u32,
}

impl<'a> Iterator for Lists<'a> {
    type Item = &'a [u32];

    #[inline(always)]
    fn next(&mut self) -> Option<&'a [u32]> {
        if self.next == NIL {
            return None;
        }
        let Block(words) = &self.blocks[self.next as usize];
        self.next = words[NEXT];
        Some(&words[FIRST..FIRST + (words[0] as usize).min(ROOM)])
    }
}

/// True if a list, as long as some multiple of the lanes, holds a number.
#[inline]
fn contains(list: &[u32], number: u32) -> bool {
    let mut any = 0;
    for lanes in list.as_chunks::<LANES>().0 {
        for lane in lanes {
            any |= u32::from(*lane == number);
        }
    }
    any != 0
}

impl Neighbours {
    /// Empties all lists.
    pub fn reset(&mut self, bodies: usize) {
        self.blocks.clear();
        self.blocks.resize(bodies, EMPTY);
        self.bodies = bodies;
    }

    /// True if these are lists of `bodies` bodies, whatever file they come from.
    pub fn is_whole(&self, bodies: usize) -> bool {
        if self.bodies != bodies || self.blocks.len() < bodies || self.blocks.len() >= NIL as usize {
            return false;
        }
        let mut seen = vec![false; self.blocks.len()];
        for body in 0..bodies {
            let mut at = body;
            loop {
                let Block(words) = &self.blocks[at];
                let count = words[0] as usize;
                let known = |other: &u32| (*other as usize) < bodies && *other as usize != body;
                // Places that are not in use hold no body.
                let right = !std::mem::replace(&mut seen[at], true)
                    && count <= ROOM
                    && words[FIRST..FIRST + count].iter().all(known)
                    && words[FIRST + count..].iter().all(|word| *word == NIL);
                match words[NEXT] {
                    _ if !right => return false,
                    NIL => break,
                    next if (next as usize) < self.blocks.len() => at = next as usize,
                    _ => return false,
                }
            }
        }
        true
    }

    pub fn bytes(&self) -> usize {
        self.blocks.capacity() * size_of::<Block>()
    }

    /// The neighbours of a body, in one or more slices.
    #[inline(always)]
    pub fn lists(&self, body: u32) -> Lists<'_> {
        Lists { blocks: &self.blocks, next: body }
    }

    /// Calls `visit` for each neighbour.
    #[inline(always)]
    pub fn each(&self, body: u32, mut visit: impl FnMut(u32)) {
        for list in self.lists(body) {
            for &other in list {
                visit(other);
            }
        }
    }

    /// Asks for the second cache line of a list whose first one is there, if it is in use.
    #[inline]
    pub fn prefetch_rest(&self, body: u32) {
        let block = &self.blocks[body as usize].0;
        if block[0] as usize > ROOM_OF_LINE {
            prefetch(block, WORDS / 2);
        }
    }

    /// Asks for the first cache line of a list.
    #[inline]
    pub fn prefetch(&self, body: u32) {
        prefetch(&self.blocks, body as usize);
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
                words[FIRST + count] = other;
                return;
            }
            if words[NEXT] == NIL {
                words[NEXT] = further;
                if self.blocks.len() == self.blocks.capacity() {
                    self.blocks.reserve_exact(self.blocks.len() / 16 + 16);
                }
                self.blocks.push(EMPTY);
            }
            at = self.blocks[at].0[NEXT] as usize;
        }
    }

    /// Gives a body other neighbours. Most are the same as before, whose lists are not touched.
    pub fn replace(&mut self, body: u32, new: &[u32]) {
        let mut old = std::mem::take(&mut self.old);
        old.clear();
        self.each(body, |other| old.push(other));
        let mut wanted = std::mem::take(&mut self.wanted);
        wanted.clear();
        wanted.extend_from_slice(new);
        for list in [&mut old, &mut wanted] {
            list.resize(list.len().next_multiple_of(LANES), NIL);
        }
        for &other in &old {
            if other != NIL && !contains(&wanted, other) {
                self.remove(other, body);
            }
        }
        for &other in new {
            if !contains(&old, other) {
                self.add(other, body);
            }
        }
        self.write(body, new);
        (self.old, self.wanted) = (old, wanted);
    }

    /// Writes the list of a body, and nothing into those of the others.
    fn write(&mut self, body: u32, list: &[u32]) {
        let mut at = body as usize;
        let mut left = list;
        loop {
            let next = self.blocks[at].0[NEXT];
            let count = left.len().min(ROOM);
            let (now, later) = left.split_at(count);
            self.blocks[at] = EMPTY;
            let words = &mut self.blocks[at].0;
            words[0] = count as u32;
            words[FIRST..FIRST + count].copy_from_slice(now);
            words[NEXT] = next;
            left = later;
            if next == NIL {
                break;
            }
            at = next as usize;
        }
        for &other in left {
            self.add(body, other);
        }
    }

    fn remove(&mut self, body: u32, other: u32) {
        let mut at = body as usize;
        loop {
            let words = &mut self.blocks[at].0;
            // Without a branch for each entry; entries that are not in use are of no body.
            let mut found = 0;
            for (word, place) in words.iter().zip(PLACES) {
                found |= if *word == other { place } else { 0 };
            }
            if found != 0 {
                let last = FIRST + words[0] as usize - 1;
                words[found as usize] = words[last];
                words[last] = NIL;
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
        for (body, step) in [(5, 3), (60, 1), (89, 7), (12, 100)] {
            let new: Vec<u32> = (0..bodies as u32).step_by(step).filter(|other| *other != body).collect();
            lists.replace(body, &new);
            pairs.retain(|(a, b)| *a != body && *b != body);
            pairs.extend(new.iter().map(|other| (body.min(*other), body.max(*other))));
            check(&lists, &pairs);
        }
        lists.replace(5, &[]);
        pairs.retain(|(a, b)| *a != 5 && *b != 5);
        check(&lists, &pairs);
        lists.join(60, 5);
        pairs.insert((5, 60));
        check(&lists, &pairs);
    }
}
