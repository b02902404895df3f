//! Contacts that share their bodies: how the largest stable step falls with the coordination.
//!
//! A pair of equal bodies of mass m with springs k has ω² = k/m12 = 2k/m. The fastest mode of an endless chain is that in which
//! neighbours move against each other: each body feels two springs, each compressed by twice its displacement, ω² = 4k/m; that
//! of the face-centred lattice is the longitudinal one at the edge of the zone, where eight of the twelve neighbours move
//! against the body at 45 degrees: ω² = 8 · 2k/m · 1/2 = 8k/m. So the largest step of a chain is 1/√2 and that of a block 1/2
//! of that of a pair, without friction and damping.

use std::sync::Arc;

use granule_law_api::{Impact, Oracle, Slot};
use granule_plan::{Plan, limits, map_name};
use serde_json::{Value, json};

use super::impact::{DAMPING, duration, restitution, rows};
use super::{Class, Map, NormalLaw, planned};
use crate::Error;
use crate::simulate::Run;

/// How many contacts a body has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordination {
    /// A periodic chain: two.
    Chain,
    /// A periodic face-centred block: twelve.
    Block,
}

impl Coordination {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Chain, Self::Block];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Chain => "chain",
            Self::Block => "fcc block",
        }
    }
}

/// Largest stable step of a coordination, measured and as the plan has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Law.
    pub law: &'static str,
    /// Integrator.
    pub scheme: &'static str,
    /// Damping ratio of a pair.
    pub damping: f64,
    /// Coordination.
    pub coordination: Coordination,
    /// Fewest steps in a contact of a pair with which the block stays at rest, to 1 %.
    pub measured: f64,
    /// Fewest steps that the plan allows for a packing.
    pub packing: f64,
    /// Fewest steps that the plan allows for a pair.
    pub pair: f64,
}

impl Limit {
    pub(super) fn json(&self) -> Value {
        json!({
            "law": self.law, "integrator": self.scheme, "damping_ratio": self.damping,
            "coordination": self.coordination.name(), "measured_steps_per_contact": self.measured,
            "plan_packing": self.packing, "plan_pair": self.pair,
        })
    }
}

/// Radius of the bodies \[m\].
const RADIUS: f64 = 0.01;
/// Cells of the block along each edge, and bodies of the chain.
const CELLS: usize = 3;
const CHAIN: usize = 12;

/// A packing whose contacts all have this overlap, disturbed by a millionth of it.
fn scene(block: &str, scheme: &str, overlap: f64, coordination: Coordination) -> String {
    let distance = 2.0 * RADIUS - overlap;
    let speed = 1e-6 * overlap;
    let (cell, bodies) = match coordination {
        Coordination::Chain => {
            let length = distance * CHAIN as f64;
            let sphere = |k: usize| {
                // Only along the chain: across it, a pressed chain buckles, and rightly so.
                let velocity = speed * ((k as f64 * 0.618_033_988_749_895).fract() - 0.5);
                format!(
                    "Sphere(material: \"a\", radius: {RADIUS:?}, position: ({:?}, 0, 0), velocity: ({velocity:?}, 0, 0)),",
                    k as f64 * distance
                )
            };
            let cell = format!("lo: (0, -1, -1), hi: ({length:?}, 1, 1), periodic: (true, false, false)");
            (cell, (0..CHAIN).map(sphere).collect::<String>())
        }
        Coordination::Block => {
            let length = distance * 2f64.sqrt() * CELLS as f64;
            let corner = format!("lo: (0, 0, 0), hi: ({length:?}, {length:?}, {length:?})");
            let lattice = format!(
                "Lattice(material: \"a\", radius: {RADIUS:?}, kind: FaceCentred, spacing: {distance:?}, {corner}, \
                 velocity_spread: {speed:?})"
            );
            (format!("{corner}, periodic: (true, true, true)"), lattice)
        }
    };
    // The density makes masses of 10 g.
    format!(
        r#"(version: 1, seed: 7, materials: {{ "a": (density: 2387.3241463784303) }}, impact_speed: 1, allow_overlap: true,
        cell: ({cell}), bodies: [{bodies}], contacts: [(between: ("a", "a"), {block})],
        driver: TimeStep(integrator: {scheme}), run: (steps: 1))"#
    )
}

/// Largest overlap of the impact that the plan expects \[m\]: the packing is pressed as much, so that its contacts have the
/// stiffness that the plan reckons with.
fn overlap(plan: &Plan) -> Result<f64, Error> {
    let composition = &plan.compositions[0];
    let context = &composition.context;
    let impact = Impact {
        reduced_mass: context.reduced_mass.min,
        reduced_radius: context.reduced_radius.min,
        normal_speed: context.impact_speed,
    };
    let normal = composition.stages.iter().find(|stage| stage.slot == Slot::Normal);
    match normal.map(|stage| (stage.law.oracle)(&stage.params, context)) {
        Some(Oracle::Normal(outcome)) => Ok(outcome(&impact).maximum_overlap),
        _ => Err("the law has no closed form".into()),
    }
}

/// Time scales of a law in a packing.
struct Scales {
    overlap: f64,
    duration: f64,
    pair: f64,
    packing: f64,
}

fn scales(block: &str, scheme: &str, coordination: Coordination) -> Result<Scales, Error> {
    let plan = planned(&scene(block, scheme, 1e-3 * RADIUS, coordination), |plan| plan.driver.step)?;
    let limits = limits(&plan);
    Ok(Scales {
        overlap: overlap(&plan)?,
        duration: duration(&plan)?,
        pair: limits.pair,
        packing: limits.packing,
    })
}

/// What becomes of a pressed packing under a step: whether a disturbance grows.
fn fate(
    block: &str,
    scheme: &str,
    scales: &Scales,
    coordination: Coordination,
    step: f64,
) -> Result<Class, Error> {
    let text = scene(block, scheme, scales.overlap, coordination);
    let plan = planned(&text, |_| step)?;
    let mut run = Run::of(Arc::new(plan))?;
    let fastest = |run: &Run| {
        let speeds = run.bodies().into_iter().map(|body| body.velocity.iter().map(|v| v * v).sum::<f64>());
        speeds.fold(0.0, |a: f64, b| if b.is_nan() { f64::NAN } else { a.max(b) }).sqrt()
    };
    let begin = fastest(&run);
    for at in (25..=500).step_by(25) {
        if run.advance(at).is_err() {
            return Ok(Class::NotFinite);
        }
        let speed = fastest(&run);
        if !speed.is_finite() {
            return Ok(Class::NotFinite);
        }
        // Beyond its limit a mode grows by a factor of its own in each step; below, the modes only add up.
        if speed > 1e3 * begin {
            return Ok(Class::EnergyGained);
        }
    }
    Ok(Class::Stable)
}

/// Measures the largest stable step of a pressed packing.
///
/// # Errors
/// A scene cannot be planned, or it is unstable at half of the step that the plan allows.
pub fn limit(
    law: &'static NormalLaw,
    scheme: &'static str,
    damping: f64,
    coordination: Coordination,
) -> Result<Limit, Error> {
    let block = (law.block)(1.0, restitution(damping));
    let scales = scales(&block, scheme, coordination)?;
    let (mut low, mut high) = (0.5 * scales.packing, 4.0 * scales.packing);
    if fate(&block, scheme, &scales, coordination, low)? != Class::Stable {
        return Err(
            format!("{} {scheme} {}: unstable at half of the limit", law.name, coordination.name()).into()
        );
    }
    while high > 1.01 * low {
        let middle = (low * high).sqrt();
        if fate(&block, scheme, &scales, coordination, middle)? == Class::Stable {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(Limit {
        law: law.name,
        scheme,
        damping,
        coordination,
        measured: scales.duration / low,
        packing: scales.duration / scales.packing,
        pair: scales.duration / scales.pair,
    })
}

/// Face-centred block: steps in the contact of a pair and damping ratio.
pub(super) fn steps_and_damping(law: &NormalLaw, scheme: &str, quick: bool) -> Result<Map, Error> {
    let damping = rows(&DAMPING, quick);
    let steps = super::impact::STEPS;
    let (mut cells, mut pair, mut packing) = (Vec::new(), Vec::new(), Vec::new());
    for ratio in &damping {
        let block = (law.block)(1.0, restitution(*ratio));
        let scales = scales(&block, scheme, Coordination::Block)?;
        let row: Result<Vec<Class>, Error> = steps
            .iter()
            .map(|steps| fate(&block, scheme, &scales, Coordination::Block, scales.duration / steps))
            .collect();
        cells.push(row?);
        pair.push(Some(scales.duration / scales.pair));
        packing.push(Some(scales.duration / scales.packing));
    }
    Ok(Map {
        name: map_name(law.name, scheme, true),
        title: format!("{}, a face-centred block, {scheme}", law.name),
        x: ("steps per contact", steps.to_vec()),
        y: ("damping ratio", damping),
        cells,
        lines: vec![("limit of a packing", packing), ("limit of a pair", pair)],
    })
}
