//! What happened, in numbers.

use serde::{Deserialize, Serialize};

/// Counts and sums since the start of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counts {
    /// Collisions of two bodies.
    pub collisions: u64,
    /// Collisions of a body and a wall.
    pub wall_collisions: u64,
    /// Collisions less than the contact duration after an earlier one of the same body: in the world of real, lasting
    /// contacts both would have been in contact at once. They lose no energy along the normal.
    pub overlapping: u64,
    /// Simulated time of the first of them \[s\].
    pub first_overlapping: Option<f64>,
    /// Collisions after which a body was held up at the least rebound of a resting contact.
    pub resting: u64,
    /// Predictions that had become void when their time came.
    pub void: u64,
    /// Looks at the neighbourhood of a body.
    pub relisted: u64,
    /// Times that all bodies were brought into a new order of memory.
    pub renumbered: u64,
    /// Σ J_n |r| over collisions of two bodies \[J s\]: the virial, which gives the pressure.
    pub virial: f64,
    /// Energy lost along the normal \[J\]; energy that resting contacts gain counts negative.
    pub lost_normal: f64,
    /// Energy lost by friction \[J\].
    pub lost_tangential: f64,
    /// Work of moving walls on the bodies \[J\].
    pub wall_work: f64,
}

/// Share of overlapping collisions above which a scene has left the world of hard bodies.
pub const HARD_LIMIT: f64 = 0.01;

impl Counts {
    /// All collisions.
    pub fn all(&self) -> u64 {
        self.collisions + self.wall_collisions
    }

    /// Share of collisions that overlap others in time.
    pub fn overlapping_share(&self) -> f64 {
        if self.all() == 0 { 0.0 } else { self.overlapping as f64 / self.all() as f64 }
    }

    /// True if so many contacts last longer than the time to the next that instantaneous collisions are no model of them
    /// (Luding 1998, Sec. 2.1).
    pub fn leaves_the_hard_sphere_world(&self) -> bool {
        self.overlapping_share() > HARD_LIMIT
    }
}
