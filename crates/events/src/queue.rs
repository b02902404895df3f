//! The event queue: one event a body, in a calendar of buckets (after Paul 2007).
//!
//! A bucket holds the events of a short span of time as a linked list; only the current bucket is ordered, in a small heap.
//! Events beyond the last bucket wait in an overflow list that is looked through once a turn of the calendar. Insertion and
//! removal cost the same for any number of bodies, as long as the span of a bucket fits the rate of events; it is adjusted
//! while the queue runs. Equal times are ordered by body, so the order of events is always the same.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::prefetch::prefetch;

const NIL: u32 = u32::MAX;
/// In no list: no event, or in the heap of the current bucket.
const LOOSE: u32 = u32::MAX;
/// Wanted number of events a bucket.
const FILL: f64 = 1.0;

/// The event of one body.
#[derive(Clone, Copy, Debug)]
struct Node<P> {
    time: f64,
    next: u32,
    previous: u32,
    bucket: u32,
    payload: P,
}

/// An entry of the heap; valid while its time is that of the body's event.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Entry {
    time: f64,
    body: u32,
}

impl Eq for Entry {}

impl Ord for Entry {
    /// The earliest is the greatest.
    fn cmp(&self, other: &Self) -> Ordering {
        other.time.total_cmp(&self.time).then(other.body.cmp(&self.body))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// One event a body with a payload. Times are finite, or infinite for a body without an event.
#[derive(Clone, Debug)]
pub struct Calendar<P> {
    nodes: Vec<Node<P>>,
    /// First body of each bucket; the last one is the overflow.
    heads: Vec<u32>,
    mask: u64,
    heap: BinaryHeap<Entry>,
    /// Start of bucket 0 and the inverse of the span of a bucket.
    origin: f64,
    inverse_width: f64,
    /// Number of the bucket that is in the heap, counted from the origin.
    current: u64,
    /// Events taken and buckets passed since the last look at the width.
    taken: u64,
    passed: u64,
    rebuilds: u64,
}

impl<P: Copy> Calendar<P> {
    /// A calendar for `bodies` bodies without events.
    pub fn new(bodies: usize, payload: P) -> Self {
        let buckets = (2 * bodies).next_power_of_two().max(16);
        Self {
            nodes: vec![
                Node { time: f64::INFINITY, next: NIL, previous: NIL, bucket: LOOSE, payload };
                bodies
            ],
            heads: vec![NIL; buckets + 1],
            mask: buckets as u64 - 1,
            heap: BinaryHeap::new(),
            origin: 0.0,
            inverse_width: 0.0,
            current: 0,
            taken: 0,
            passed: 0,
            rebuilds: 0,
        }
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node<P>>()
            + self.heads.capacity() * size_of::<u32>()
            + self.heap.capacity() * size_of::<Entry>()
    }

    /// The event of a body: its time, infinite for none, and payload.
    #[inline]
    pub fn event(&self, body: u32) -> (f64, P) {
        let node = &self.nodes[body as usize];
        (node.time, node.payload)
    }

    /// All events, by body.
    pub fn events(&self) -> Vec<(f64, P)> {
        self.nodes.iter().map(|node| (node.time, node.payload)).collect()
    }

    /// Takes over all events, by body. Their order in time is the same however they lie in buckets.
    pub fn restore(&mut self, events: &[(f64, P)]) {
        for (node, (_, payload)) in self.nodes.iter_mut().zip(events) {
            node.payload = *payload;
        }
        self.fill(&events.iter().map(|(time, _)| *time).collect::<Vec<f64>>());
    }

    /// Payload of a body, to be changed in place.
    #[inline]
    pub fn payload_mut(&mut self, body: u32) -> &mut P {
        &mut self.nodes[body as usize].payload
    }

    /// Sets all events at once, as at the start: `time[body]` may be infinite.
    pub fn fill(&mut self, times: &[f64]) {
        for (node, time) in self.nodes.iter_mut().zip(times) {
            node.time = *time;
        }
        // Half of the events within the median: their number in that time is the rate.
        let mut finite: Vec<f64> = times.iter().copied().filter(|time| time.is_finite()).collect();
        let least = finite.iter().copied().fold(f64::INFINITY, f64::min);
        let half = finite.len() / 2;
        let span = if finite.is_empty() {
            0.0
        } else {
            *finite.select_nth_unstable_by(half, f64::total_cmp).1 - least
        };
        let width = span / (half.max(1) as f64) * FILL;
        self.spread(if least.is_finite() { least } else { 0.0 }, width);
    }

    /// Gives a body its next event.
    #[inline]
    pub fn schedule(&mut self, body: u32, time: f64) {
        self.unlink(body);
        self.nodes[body as usize].time = time;
        self.link(body);
    }

    fn number(&self, time: f64) -> u64 {
        // Saturates: times before the origin are in bucket 0, which is never after the current one.
        ((time - self.origin) * self.inverse_width) as u64
    }

    #[inline]
    fn link(&mut self, body: u32) {
        let time = self.nodes[body as usize].time;
        if time == f64::INFINITY {
            return;
        }
        let number = self.number(time);
        if number <= self.current {
            self.heap.push(Entry { time, body });
            return;
        }
        let beyond = number - self.current > self.mask;
        let bucket = if beyond { self.mask as usize + 1 } else { (number & self.mask) as usize };
        let first = self.heads[bucket];
        self.heads[bucket] = body;
        let node = &mut self.nodes[body as usize];
        (node.next, node.previous, node.bucket) = (first, NIL, bucket as u32);
        if first != NIL {
            self.nodes[first as usize].previous = body;
        }
    }

    #[inline]
    fn unlink(&mut self, body: u32) {
        let Node { next, previous, bucket, .. } = self.nodes[body as usize];
        if bucket == LOOSE {
            return;
        }
        if previous == NIL {
            self.heads[bucket as usize] = next;
        } else {
            self.nodes[previous as usize].next = next;
        }
        if next != NIL {
            self.nodes[next as usize].previous = previous;
        }
        self.nodes[body as usize].bucket = LOOSE;
    }

    /// The earliest event, which stays in the queue: time and body. `None` if no body has one.
    #[inline]
    pub fn first(&mut self) -> Option<(f64, u32)> {
        loop {
            while let Some(&Entry { time, body }) = self.heap.peek() {
                let node = &self.nodes[body as usize];
                if node.time == time && node.bucket == LOOSE {
                    return Some((time, body));
                }
                self.heap.pop();
            }
            if !self.turn() {
                return None;
            }
        }
    }

    /// Number of the bucket whose events are next.
    #[inline]
    pub fn bucket(&self) -> u64 {
        self.current
    }

    /// Asks for the first event of a bucket that comes later.
    #[inline]
    pub fn prefetch_bucket(&self, number: u64) {
        let body = self.heads[(number & self.mask) as usize];
        if body != NIL {
            prefetch(&self.nodes, body as usize);
        }
    }

    /// Asks for the event of a body.
    #[inline]
    pub fn prefetch(&self, body: u32) {
        prefetch(&self.nodes, body as usize);
    }

    /// Calls `visit` with body, time and payload of the events in a bucket that comes later.
    #[inline]
    pub fn each_of(&self, number: u64, mut visit: impl FnMut(u32, f64, P)) {
        let mut body = self.heads[(number & self.mask) as usize];
        while body != NIL {
            let node = &self.nodes[body as usize];
            visit(body, node.time, node.payload);
            body = node.next;
        }
    }

    /// Takes the earliest event out; the body has none until the next [`schedule`](Self::schedule).
    #[inline]
    pub fn pop(&mut self) -> Option<(f64, u32, P)> {
        let (time, body) = self.first()?;
        self.heap.pop();
        let node = &mut self.nodes[body as usize];
        node.time = f64::INFINITY;
        self.taken += 1;
        Some((time, body, node.payload))
    }

    /// Goes to the next bucket that holds an event. False if there is no event at all.
    fn turn(&mut self) -> bool {
        let buckets = self.mask + 1;
        let mut empty = 0;
        loop {
            self.current += 1;
            self.passed += 1;
            if self.current & self.mask == 0 {
                self.overflow();
                if self.taken + self.passed > 4 * buckets {
                    return self.adjust();
                }
            }
            let bucket = (self.current & self.mask) as usize;
            let mut body = std::mem::replace(&mut self.heads[bucket], NIL);
            if body != NIL {
                while body != NIL {
                    let node = &mut self.nodes[body as usize];
                    node.bucket = LOOSE;
                    self.heap.push(Entry { time: node.time, body });
                    body = node.next;
                }
            }
            // The overflow may have filled the heap as well.
            if !self.heap.is_empty() {
                return true;
            }
            empty += 1;
            if empty > buckets {
                return self.adjust();
            }
        }
    }

    /// Moves what has come within reach from the overflow into buckets.
    fn overflow(&mut self) {
        let last = self.mask as usize + 1;
        let mut body = std::mem::replace(&mut self.heads[last], NIL);
        while body != NIL {
            let next = self.nodes[body as usize].next;
            self.nodes[body as usize].bucket = LOOSE;
            self.link(body);
            body = next;
        }
    }

    /// Fits the span of the buckets to the rate of the events. False if there is no event.
    fn adjust(&mut self) -> bool {
        let least = self.nodes.iter().map(|node| node.time).fold(f64::INFINITY, f64::min);
        if !least.is_finite() {
            return false;
        }
        let width = 1.0 / self.inverse_width;
        let rate = self.taken as f64 / self.passed.max(1) as f64;
        let good = self.inverse_width > 0.0 && (0.25 * FILL..4.0 * FILL).contains(&rate);
        let measured = if rate > 0.0 { width * FILL / rate } else { 0.0 };
        (self.taken, self.passed) = (0, 0);
        if good {
            self.spread(least, width);
        } else if measured.is_finite() && measured > 0.0 && rate > 1e-3 {
            self.spread(least, measured);
        } else {
            let times: Vec<f64> = self.nodes.iter().map(|node| node.time).collect();
            self.fill(&times);
        }
        true
    }

    /// Puts all events into buckets of the given width from `origin` on.
    fn spread(&mut self, origin: f64, width: f64) {
        self.heads.fill(NIL);
        self.heap.clear();
        self.origin = origin;
        // Without a usable width everything is in the heap, which is slower but right.
        let inverse = 1.0 / width;
        self.inverse_width = if width > 0.0 && inverse.is_finite() { inverse } else { 0.0 };
        self.current = 0;
        self.rebuilds += 1;
        for body in 0..self.nodes.len() as u32 {
            self.nodes[body as usize].bucket = LOOSE;
            self.link(body);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The reference: looks at every body.
    struct Brute(Vec<f64>);

    impl Brute {
        fn first(&self) -> Option<(f64, u32)> {
            let (body, time) = self.0.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1))?;
            time.is_finite().then_some((*time, body as u32))
        }
    }

    fn number(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 11) as f64 / (1u64 << 53) as f64
    }

    fn agree(bodies: usize, seed: u64, events: usize, spread: i32, ties: bool) {
        let mut state = seed;
        let lead = |state: &mut u64, rate: f64| {
            let u = number(state);
            let lead =
                if u < 0.05 { 0.0 } else { -(u.ln()) * 10.0f64.powf(number(state) * f64::from(spread)) };
            let lead = lead / rate;
            if ties { (lead * 4.0).round() / 4.0 } else { lead }
        };
        let mut queue = Calendar::new(bodies, ());
        let mut brute = Brute((0..bodies).map(|_| lead(&mut state, 1.0)).collect());
        queue.fill(&brute.0);
        let mut now = 0.0;
        for event in 0..events {
            assert_eq!(queue.first(), brute.first(), "event {event}");
            let Some((time, body, ())) = queue.pop() else { break };
            assert!(time >= now);
            now = time;
            // The rate falls by a factor of a million while the queue runs.
            let rate = 10.0f64.powf(-6.0 * event as f64 / events as f64);
            let next = now + lead(&mut state, rate);
            brute.0[body as usize] = next;
            queue.schedule(body, next);
            // Others are given new events, or none.
            for _ in 0..2 {
                let other = (number(&mut state) * bodies as f64) as usize;
                let next =
                    if number(&mut state) < 0.1 { f64::INFINITY } else { now + lead(&mut state, rate) };
                brute.0[other] = next;
                queue.schedule(other as u32, next);
            }
        }
    }

    proptest! {
        #[test]
        fn the_calendar_is_the_brute_force_queue(seed: u64, bodies in 1usize..60, spread in 0i32..6, ties: bool) {
            agree(bodies, seed, 600, spread, ties);
        }
    }

    #[test]
    fn many_bodies_and_many_turns() {
        agree(700, 7, 40_000, 2, false);
        agree(700, 8, 20_000, 1, true);
    }

    #[test]
    fn the_width_follows_the_rate() {
        let bodies = 1000;
        let mut queue = Calendar::new(bodies, ());
        let mut state = 3;
        queue.fill(&(0..bodies).map(|_| number(&mut state)).collect::<Vec<_>>());
        let mut buckets = 0;
        for scale in [1.0, 1e6] {
            for _ in 0..100_000 {
                let (time, body, ()) = queue.pop().unwrap();
                queue.schedule(body, time - number(&mut state).ln() * scale);
            }
            buckets = queue.passed;
        }
        // Less than a few passed buckets an event since the last adjustment.
        assert!(buckets < 40_000, "{buckets}");
    }

    #[test]
    fn no_event_at_all() {
        let mut queue = Calendar::new(3, ());
        assert_eq!(queue.first(), None);
        queue.fill(&[f64::INFINITY; 3]);
        assert_eq!(queue.first(), None);
        queue.schedule(1, 2.0);
        assert_eq!(queue.first(), Some((2.0, 1)));
        queue.schedule(2, 1.0);
        assert_eq!(queue.pop().map(|event| event.1), Some(2));
        queue.schedule(1, f64::INFINITY);
        assert_eq!(queue.first(), None);
    }
}
