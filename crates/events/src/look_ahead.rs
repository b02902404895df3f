//! Asks for the records of coming events, so that they are in the cache when the events happen. Changes no result.

use crate::engine::{EventEngine, SHELL, WALLS};
use crate::prefetch::prefetch;

/// How many buckets before an event its record, its bodies and their neighbours are asked for.
const LEADS: [u64; 3] = [8, 5, 2];

/// Numbers of the buckets for which that is done.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ahead([u64; 3]);

impl EventEngine {
    /// To be called at every event.
    #[inline]
    pub(crate) fn look_ahead(&mut self) {
        let now = self.queue.bucket();
        let mut done = self.ahead.0;
        // After a jump, or when buckets are counted anew, what was passed is of no use.
        let begin = |done: u64, lead: u64| if done < now || done > now + lead { now } else { done };
        for stage in 0..3 {
            done[stage] = begin(done[stage], LEADS[stage]);
        }
        while done[0] < now + LEADS[0] {
            done[0] += 1;
            self.queue.prefetch_bucket(done[0]);
        }
        while done[1] < now + LEADS[1] {
            done[1] += 1;
            self.queue.each_of(done[1], |body, _, target| {
                self.ask_for(body);
                if target.partner < WALLS {
                    self.ask_for(target.partner);
                    self.queue.prefetch(target.partner);
                }
                prefetch(&self.shells, body as usize);
                self.cells.prefetch_slot(body);
            });
        }
        while done[2] < now + LEADS[2] {
            done[2] += 1;
            self.queue.each_of(done[2], |body, time, target| {
                self.ask_for_neighbours(body);
                if target.partner < WALLS {
                    self.ask_for_neighbours(target.partner);
                } else if target.partner == SHELL {
                    self.neighbours.each(body, |other| self.neighbours.prefetch(other));
                    self.cells.prefetch(self.at(body, time).0);
                }
            });
        }
        self.ahead.0 = done;
    }

    #[inline]
    fn ask_for_neighbours(&self, body: u32) {
        self.neighbours.prefetch_rest(body);
        self.neighbours.each(body, |other| prefetch(&self.bodies, other as usize));
    }

    #[inline]
    fn ask_for(&self, body: u32) {
        prefetch(&self.bodies, body as usize);
        prefetch(&self.identities, body as usize);
        prefetch(&self.shells, body as usize);
        self.neighbours.prefetch(body);
    }
}
