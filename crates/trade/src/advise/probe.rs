//! What happens in a run: impacts, contacts, free flights.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use granule_drivers::{Advance, ContactPartner, Driver, TimeStepDriver};
use granule_plan::{Partner, Plan};

use crate::TradeError;

/// Windows of a run in which every step is looked at.
const WINDOWS: u64 = 40;
/// Time of the clock for looking at steps.
const PATIENCE: Duration = Duration::from_secs(20);
/// Up to this many bodies times steps, every step of the run is looked at.
const FEW: u64 = 20_000_000;

/// Who touches whom: identity, and identity or wall.
type Key = (u32, bool, u32);

/// What was seen.
#[derive(Clone, Debug, Default)]
pub(super) struct Probe {
    /// Impacts that began in the windows, by composition.
    pub impacts: Vec<Impact>,
    /// Impacts that began while one of the two had another contact.
    pub crowded: u64,
    /// Time that the windows cover \[s\].
    pub watched: f64,
    /// Mean contacts of a body, with bodies and walls.
    pub coordination: f64,
    /// Largest overlap over the smaller radius.
    pub deepest: f64,
    /// Mean speed of the bodies that can move \[m/s\].
    pub speed: f64,
    /// Mean time between two impacts of a body \[s\]; infinite without impacts.
    pub free_time: f64,
    /// Largest slope of a velocity component over another coordinate \[1/s\].
    pub shear_rate: f64,
    /// Sum over contacts of overlap and distance of the centres, mean over the looks, by composition \[m²\].
    pub overlaps: Vec<f64>,
    /// Volume around the bodies \[m³\].
    pub volume: f64,
    /// The windows are the whole run.
    pub whole: bool,
}

/// The beginning of a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Impact {
    pub composition: usize,
    /// Normal speed \[m/s\].
    pub normal: f64,
    /// Slip of the surfaces \[m/s\].
    pub slip: f64,
}

/// Runs a plan and looks at windows of a few contact durations. `contact` is the duration of the shortest contact \[s\].
pub(super) fn probe(plan: &Arc<Plan>, contact: f64, stop: &AtomicBool) -> Result<Probe, TradeError> {
    let failed = |error: granule_drivers::EngineError| TradeError::Run {
        setting: "the scene as it is".into(),
        reason: error.to_string(),
    };
    let mut driver = TimeStepDriver::new(plan.clone(), None).map_err(failed)?;
    let steps = plan.driver.steps;
    let movable = plan.bodies.frozen.iter().filter(|frozen| !**frozen).count().max(1) as f64;
    let whole = steps.saturating_mul(plan.bodies.len() as u64) <= FEW;
    let window = if whole { steps } else { (3.0 * contact / plan.driver.step).ceil().max(2.0) as u64 };
    let windows = if whole { 1 } else { WINDOWS };
    let mut seen = Probe { whole, overlaps: vec![0.0; plan.compositions.len()], ..Probe::default() };
    let mut looks = 0.0;
    let mut spent = Duration::ZERO;
    for number in 0..windows {
        let begin = if whole { 0 } else { (number + 1) * steps / (windows + 1) };
        if driver.advance(begin, stop).map_err(failed)? == Advance::Stopped {
            return Err(TradeError::Stopped);
        }
        let clock = Instant::now();
        let mut before = contacts(&driver);
        let mut watched = 0;
        while watched < window && driver.step() < steps && spent + clock.elapsed() < PATIENCE {
            if driver.advance(driver.step() + 1, stop).map_err(failed)? == Advance::Stopped {
                return Err(TradeError::Stopped);
            }
            let now = contacts(&driver);
            begun(&driver, plan, &before, &now, &mut seen);
            before = now;
            watched += 1;
        }
        spent += clock.elapsed();
        seen.watched += watched as f64 * plan.driver.step;
        look(&driver, plan, &before, &mut seen);
        looks += 1.0;
    }
    seen.coordination /= looks;
    seen.speed /= looks;
    seen.shear_rate /= looks;
    seen.overlaps.iter_mut().for_each(|sum| *sum /= looks);
    let each = seen.impacts.len() as f64 * 2.0 / movable;
    seen.free_time = seen.watched / each;
    Ok(seen)
}

struct Touch {
    normal: [f64; 3],
    overlap: f64,
}

fn contacts(driver: &TimeStepDriver) -> BTreeMap<Key, Touch> {
    let records = driver.view().contacts();
    records
        .into_iter()
        .map(|record| {
            let key = match record.partner {
                ContactPartner::Body(other) => (record.id, false, other),
                ContactPartner::Wall(wall) => (record.id, true, wall),
            };
            (key, Touch { normal: record.normal, overlap: record.overlap })
        })
        .collect()
}

/// Index into the tables of the plan of an identity; they are in the order of the identities.
fn index(plan: &Plan, id: u32) -> usize {
    plan.bodies.id.binary_search(&id).unwrap_or(0)
}

fn composition(plan: &Plan, (id, wall, other): Key) -> Option<usize> {
    let material = plan.bodies.material[index(plan, id)];
    let partner = if wall {
        Partner::Wall(u16::try_from(other).ok()?)
    } else {
        Partner::Body(plan.bodies.material[index(plan, other)])
    };
    plan.composition(material, partner)
}

/// Velocity of the surface of body `id` where `normal` points away from it.
fn surface(driver: &TimeStepDriver, plan: &Plan, id: u32, outward: [f64; 3]) -> [f64; 3] {
    let view = driver.view();
    let at = index(plan, id);
    let place = view.order().get(at).map_or(0, |place| *place as usize);
    let velocity = view.bodies().velocity_of(place);
    if !plan.rotation {
        return velocity;
    }
    let (spin, radius) = (view.bodies().spin_of(place), plan.bodies.radius[at]);
    let turn = [
        spin[1] * outward[2] - spin[2] * outward[1],
        spin[2] * outward[0] - spin[0] * outward[2],
        spin[0] * outward[1] - spin[1] * outward[0],
    ];
    std::array::from_fn(|axis| velocity[axis] + radius * turn[axis])
}

fn begun(
    driver: &TimeStepDriver,
    plan: &Plan,
    before: &BTreeMap<Key, Touch>,
    now: &BTreeMap<Key, Touch>,
    seen: &mut Probe,
) {
    for (key, touch) in now {
        let least = |id: u32| plan.bodies.radius[index(plan, id)];
        let radius = if key.1 { least(key.0) } else { least(key.0).min(least(key.2)) };
        seen.deepest = seen.deepest.max(touch.overlap / radius);
        if before.contains_key(key) {
            continue;
        }
        let Some(composition) = composition(plan, *key) else { continue };
        let own = surface(driver, plan, key.0, touch.normal.map(|component| -component));
        let other = if key.1 {
            let wall = &plan.walls[key.2 as usize].wall;
            let view = driver.view();
            let place = view.order().get(index(plan, key.0)).map_or(0, |place| *place as usize);
            let centre = view.bodies().position[place].vector();
            let velocity = wall.velocity_at(centre.into(), driver.time());
            [velocity.x, velocity.y, velocity.z]
        } else {
            surface(driver, plan, key.2, touch.normal)
        };
        let relative: [f64; 3] = std::array::from_fn(|axis| own[axis] - other[axis]);
        let normal = -(0..3).map(|axis| relative[axis] * touch.normal[axis]).sum::<f64>();
        let slip: f64 =
            (0..3).map(|axis| (relative[axis] + normal * touch.normal[axis]).powi(2)).sum::<f64>().sqrt();
        seen.impacts.push(Impact { composition, normal: normal.abs(), slip });
        let touches =
            |id: u32| now.keys().any(|other| other != key && (other.0 == id || (!other.1 && other.2 == id)));
        if touches(key.0) || (!key.1 && touches(key.2)) {
            seen.crowded += 1;
        }
    }
}

/// Quantities of a moment.
fn look(driver: &TimeStepDriver, plan: &Plan, now: &BTreeMap<Key, Touch>, seen: &mut Probe) {
    let view = driver.view();
    let places: Vec<usize> = (view.order().iter().zip(&plan.bodies.frozen))
        .filter(|(_, frozen)| !**frozen)
        .map(|(place, _)| *place as usize)
        .collect();
    let count = places.len().max(1) as f64;
    seen.coordination += now.keys().map(|key| if key.1 { 1.0 } else { 2.0 }).sum::<f64>() / count;
    for (key, touch) in now {
        let Some(composition) = composition(plan, *key) else { continue };
        let radius = |id: u32| plan.bodies.radius[index(plan, id)];
        let distance = if key.1 { radius(key.0) } else { radius(key.0) + radius(key.2) };
        seen.overlaps[composition] += touch.overlap * distance;
    }
    let positions: Vec<[f64; 3]> =
        places.iter().map(|place| std::array::from_fn(|axis| view.bodies().position[*place][axis])).collect();
    let velocities: Vec<[f64; 3]> = places.iter().map(|place| view.bodies().velocity_of(*place)).collect();
    let norm = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    seen.speed += velocities.iter().map(norm).sum::<f64>() / count;
    let mean = |of: &[[f64; 3]], axis: usize| of.iter().map(|v| v[axis]).sum::<f64>() / count;
    let largest = plan.bodies.radius.iter().fold(0.0, |a: f64, b| a.max(*b));
    let mut volume = 1.0;
    for axis in 0..3 {
        let (low, high) = positions
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[axis]), high.max(p[axis])));
        let period = plan.cell.period()[axis];
        volume *= if period > 0.0 { period } else { high - low + 2.0 * largest };
    }
    seen.volume = volume;
    let mut steepest: f64 = 0.0;
    for across in 0..3 {
        let centre = mean(&positions, across);
        let spread: f64 = positions.iter().map(|p| (p[across] - centre).powi(2)).sum();
        if spread <= 0.0 {
            continue;
        }
        for along in (0..3).filter(|along| *along != across) {
            let drift = mean(&velocities, along);
            let both = positions.iter().zip(&velocities);
            let slope = both.map(|(p, v)| (p[across] - centre) * (v[along] - drift)).sum::<f64>() / spread;
            steepest = steepest.max(slope.abs());
        }
    }
    seen.shear_rate += steepest;
}
