//! The set-ups that every engine runs: what happens, with which numbers, under which laws.

mod pairs;
mod recipe;
mod walls;

use std::collections::BTreeMap;

use crate::peers::{PeerBody, PeerLaw, PeerMaterial, PeerScene, PeerWall, Quantity};

/// Laws of a case in the words of one engine.
#[derive(Clone, Debug)]
pub struct CaseLaw {
    /// Engine and law, as in `lammps-hooke-history`; names the recorded reference.
    pub slug: String,
    /// Laws by pair of types.
    pub laws: BTreeMap<(usize, usize), PeerLaw>,
    /// Materials by type.
    pub materials: Vec<Option<PeerMaterial>>,
}

/// One set-up and the laws to run it with.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name of its folder.
    pub slug: &'static str,
    /// What it shows, in one line.
    pub title: &'static str,
    /// Bodies in their initial state.
    pub bodies: Vec<PeerBody>,
    /// Ids of bodies that never move.
    pub frozen: Vec<u64>,
    /// Half the edge of the cubic box about the origin (m).
    pub half_box: f64,
    /// Periodic directions.
    pub periodic: [bool; 3],
    /// Acceleration of gravity (m/s²).
    pub gravity: [f64; 3],
    /// Plane walls.
    pub walls: Vec<PeerWall>,
    /// Time step (s).
    pub time_step: f64,
    /// Number of steps.
    pub steps: u64,
    /// Steps between dumps.
    pub dump_every: u64,
    /// Each is one run of one engine.
    pub laws: Vec<CaseLaw>,
}

impl Case {
    /// One scene per law, with the law's name.
    pub fn scenes(&self) -> Vec<(String, PeerScene)> {
        self.laws.iter().map(|law| (law.slug.clone(), self.scene(law))).collect()
    }

    fn scene(&self, law: &CaseLaw) -> PeerScene {
        let largest = self.bodies.iter().map(|body| body.diameter).fold(0.0, f64::max);
        PeerScene {
            title: format!("{}, {}", self.slug, law.slug),
            bodies: self.bodies.clone(),
            frozen: self.frozen.clone(),
            lower: [-self.half_box; 3],
            upper: [self.half_box; 3],
            periodic: self.periodic,
            gravity: self.gravity,
            materials: law.materials.clone(),
            laws: law.laws.clone(),
            walls: self.walls.clone(),
            time_step: self.time_step,
            steps: self.steps,
            warm_up: 0,
            dump_every: self.dump_every,
            quantities: Quantity::ALL.to_vec(),
            skin: 0.2 * largest,
        }
    }
}

/// All cases.
pub fn all() -> Vec<Case> {
    let mut cases = pairs::cases();
    cases.extend(walls::cases());
    cases
}

#[cfg(test)]
mod tests;
