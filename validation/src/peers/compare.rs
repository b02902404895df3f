//! Frame-by-frame comparison of two runs: every dumped step, every body, every quantity.

use super::vector::{norm, sub};
use super::{Frame, PeerScene, Quantity};

/// What differences are divided by; each is of the size that the quantity reaches in the case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Diameter of the largest body (m).
    pub position: f64,
    /// Speed (m/s).
    pub velocity: f64,
    /// Angular speed (rad/s).
    pub angular_velocity: f64,
    /// Force (N).
    pub force: f64,
    /// Torque (N m).
    pub torque: f64,
}

impl Scales {
    /// Largest values of the reference run. A quantity that is absent there (below 1e-9 of what the others imply:
    /// a head-on hit has torques of round-off only) gets the implied scale: speed / radius, mass · speed² / diameter,
    /// force · radius.
    pub fn of(scene: &PeerScene, reference: &[Frame]) -> Self {
        let largest = |quantity: Quantity| {
            let values = reference.iter().flat_map(|frame| frame.column(quantity));
            values.map(|value| norm(*value)).fold(0.0, f64::max)
        };
        let present = |value: f64, implied: f64| {
            let value = if value > 1e-9 * implied { value } else { implied };
            if value > 0.0 { value } else { 1.0 }
        };
        let diameter = scene.bodies.iter().map(|body| body.diameter).fold(0.0, f64::max);
        let mass = scene.bodies.iter().map(|body| body.mass()).fold(0.0, f64::max);
        let fall = (norm(scene.gravity) * diameter).sqrt();
        let velocity = present(largest(Quantity::Velocity), fall);
        let force = present(largest(Quantity::Force), mass * velocity * velocity / diameter);
        Self {
            position: diameter,
            velocity,
            angular_velocity: present(largest(Quantity::AngularVelocity), 2.0 * velocity / diameter),
            force,
            torque: present(largest(Quantity::Torque), 0.5 * diameter * force),
        }
    }

    /// The scale of a quantity.
    pub fn get(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Position => self.position,
            Quantity::Velocity => self.velocity,
            Quantity::AngularVelocity => self.angular_velocity,
            Quantity::Force => self.force,
            Quantity::Torque => self.torque,
        }
    }
}

/// Why two runs cannot be compared at all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CompareError {
    /// The dumped steps differ, or there are none.
    Steps,
    /// The bodies differ at this step.
    Bodies(u64),
    /// A quantity is missing at this step in one of the runs.
    Missing(Quantity, u64),
}

impl std::fmt::Display for CompareError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Steps => write!(f, "the runs have different dumped steps, or none"),
            Self::Bodies(step) => write!(f, "the runs have different bodies at step {step}"),
            Self::Missing(quantity, step) => {
                write!(f, "a run has no {} at step {step}", quantity.name())
            }
        }
    }
}

impl std::error::Error for CompareError {}

/// Largest scaled difference of one quantity at one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Which quantity.
    pub quantity: Quantity,
    /// Euclidean norm of the difference over the scale; infinite if a number is not finite.
    pub scaled: f64,
    /// Where: step.
    pub step: u64,
    /// Where: id of the body.
    pub body: u64,
}

/// Differences of two runs, step by step.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// One row per dumped step; each row has one entry per quantity asked for.
    pub rows: Vec<Vec<Difference>>,
}

impl Comparison {
    /// The largest difference of each quantity over all steps.
    pub fn largest(&self) -> Vec<Difference> {
        let mut largest: Vec<Difference> = self.rows.first().cloned().unwrap_or_default();
        for row in &self.rows {
            for (best, entry) in largest.iter_mut().zip(row) {
                if entry.scaled > best.scaled {
                    *best = *entry;
                }
            }
        }
        largest
    }

    /// The largest difference of all.
    pub fn worst(&self) -> Option<Difference> {
        self.largest().into_iter().max_by(|a, b| a.scaled.total_cmp(&b.scaled))
    }

    /// The horizon: the first dumped step at which any quantity differs by more than the bound.
    pub fn horizon(&self, bound: f64) -> Option<u64> {
        self.rows.iter().flatten().find(|entry| entry.scaled > bound).map(|entry| entry.step)
    }
}

/// Compares two runs of a scene. Positions along periodic directions are compared across the boundary.
///
/// # Errors
/// [`CompareError`] if the runs do not hold the same steps, bodies and quantities: nothing is skipped in silence.
pub fn compare(
    scene: &PeerScene,
    reference: &[Frame],
    candidate: &[Frame],
    scales: &Scales,
    quantities: &[Quantity],
) -> Result<Comparison, CompareError> {
    let steps = |frames: &[Frame]| frames.iter().map(|frame| frame.step).collect::<Vec<u64>>();
    if reference.is_empty() || quantities.is_empty() || steps(reference) != steps(candidate) {
        return Err(CompareError::Steps);
    }
    let mut rows = Vec::with_capacity(reference.len());
    for (ours, theirs) in candidate.iter().zip(reference) {
        let step = theirs.step;
        if ours.ids != theirs.ids || ours.ids.is_empty() {
            return Err(CompareError::Bodies(step));
        }
        let mut row = Vec::with_capacity(quantities.len());
        for quantity in quantities {
            let (a, b) = (ours.column(*quantity), theirs.column(*quantity));
            if a.len() != ours.ids.len() || b.len() != ours.ids.len() {
                return Err(CompareError::Missing(*quantity, step));
            }
            let mut worst = Difference { quantity: *quantity, scaled: -1.0, step, body: theirs.ids[0] };
            for ((a, b), body) in a.iter().zip(b).zip(&theirs.ids) {
                let mut difference = sub(*a, *b);
                if *quantity == Quantity::Position {
                    across(scene, &mut difference);
                }
                let scaled = norm(difference) / scales.get(*quantity);
                // Any comparison with NaN is false; as infinity it cannot hide.
                let scaled = if scaled.is_nan() { f64::INFINITY } else { scaled };
                if scaled > worst.scaled {
                    worst = Difference { scaled, body: *body, ..worst };
                }
            }
            row.push(worst);
        }
        rows.push(row);
    }
    Ok(Comparison { rows })
}

/// How far one body of the second run is from where it is in the first, at one step and in one quantity; zero if a run does
/// not have it.
pub fn displacement(scene: &PeerScene, from: &[Frame], to: &[Frame], place: &Difference) -> [f64; 3] {
    let value = |frames: &[Frame]| {
        let frame = frames.iter().find(|frame| frame.step == place.step)?;
        let rank = frame.ids.iter().position(|id| *id == place.body)?;
        frame.column(place.quantity).get(rank).copied()
    };
    let (Some(from), Some(to)) = (value(from), value(to)) else { return [0.0; 3] };
    let mut difference = sub(to, from);
    if place.quantity == Quantity::Position {
        across(scene, &mut difference);
    }
    difference
}

/// Shortest image of a difference of positions.
fn across(scene: &PeerScene, difference: &mut [f64; 3]) {
    for k in 0..3 {
        if scene.periodic[k] {
            let length = scene.upper[k] - scene.lower[k];
            difference[k] -= length * (difference[k] / length).round();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases;
    use crate::translate::Target;

    fn frame(step: u64, x: f64) -> Frame {
        Frame { step, ids: vec![1], position: vec![[x, 0.0, 0.0]], ..Frame::default() }
    }

    fn scene() -> PeerScene {
        cases::find("periodic-pair").unwrap().peer(Target::LammpsClassic).unwrap()
    }

    const SCALES: Scales =
        Scales { position: 2.0, velocity: 1.0, angular_velocity: 1.0, force: 1.0, torque: 1.0 };

    #[test]
    fn finds_the_worst_step_and_the_horizon() {
        let reference = [frame(0, 0.0), frame(10, 0.0), frame(20, 0.0)];
        let ours = [frame(0, 0.0), frame(10, 2e-6), frame(20, -1e-6)];
        let comparison = compare(&scene(), &reference, &ours, &SCALES, &[Quantity::Position]).unwrap();
        let worst = comparison.worst().unwrap();
        assert_eq!((worst.step, worst.body, worst.scaled), (10, 1, 1e-6));
        assert_eq!(comparison.horizon(1e-5), None);
        assert_eq!(comparison.horizon(1e-7), Some(10));
    }

    #[test]
    fn periodic_images_are_the_same_place() {
        let scene = scene();
        let length = scene.upper[0] - scene.lower[0];
        let (a, b) = ([frame(0, 0.25 * length)], [frame(0, 1.25 * length)]);
        let comparison = compare(&scene, &a, &b, &SCALES, &[Quantity::Position]).unwrap();
        assert!(comparison.worst().unwrap().scaled < 1e-15 * length);
    }

    #[test]
    fn nothing_is_skipped() {
        let scene = scene();
        let reference = [frame(0, 0.0), frame(10, 0.0)];
        let compare = |ours: &[Frame], quantity| compare(&scene, &reference, ours, &SCALES, &[quantity]);
        assert_eq!(compare(&reference[..1], Quantity::Position), Err(CompareError::Steps));
        assert_eq!(compare(&reference, Quantity::Torque), Err(CompareError::Missing(Quantity::Torque, 0)));
        let mut other = reference.clone();
        other[1].ids = vec![2];
        assert_eq!(compare(&other, Quantity::Position), Err(CompareError::Bodies(10)));
        let nan = [frame(0, 0.0), frame(10, f64::NAN)];
        let worst = compare(&nan, Quantity::Position).unwrap().worst().unwrap();
        assert_eq!((worst.scaled, worst.step), (f64::INFINITY, 10));
    }
}
