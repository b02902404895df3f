//! The quantities whose errors count.

use granule_drivers::View;
use granule_observers::{Compute, Energy, compute};
use granule_plan::{Plan, SERIES};
use granule_scene::{OutputChoice, Scene};

use crate::TradeError;

/// Up to this many bodies, paths are compared; beyond it, means.
const FEW: usize = 16;

/// Quantities of the ledger, which a plan has only if somebody asks.
const LEDGER: [&str; 5] =
    ["elastic_energy", "dissipated_viscous", "dissipated_friction", "wall_work", "energy_residual"];

/// Quantities that hard bodies do not have.
const CONTACTS: [&str; 3] = ["contacts", "coordination_number", "maximum_overlap"];

/// What is measured of a run.
#[derive(Clone, Copy)]
pub(crate) enum Observable {
    /// Velocities of all bodies at the end \[m/s\].
    Velocities,
    /// Spins of all bodies at the end \[rad/s\].
    Spins,
    /// A quantity of the whole system by its name.
    Quantity {
        /// Name in [`SERIES`].
        name: &'static str,
        /// Its unit.
        unit: &'static str,
        /// How it is computed.
        compute: Compute,
    },
}

impl Observable {
    pub fn name(&self) -> &'static str {
        match self {
            Self::Velocities => "velocities",
            Self::Spins => "spins",
            Self::Quantity { name, .. } => name,
        }
    }

    pub fn unit(&self) -> &'static str {
        match self {
            Self::Velocities => "m/s",
            Self::Spins => "rad/s",
            Self::Quantity { unit, .. } => unit,
        }
    }

    /// It is a property of contacts that last.
    pub fn needs_contacts(&self) -> bool {
        CONTACTS.contains(&self.name()) || LEDGER.contains(&self.name())
    }

    /// Its components at one moment.
    pub fn measure(&self, view: &View<'_>, now: &Energy, start: &Energy) -> Vec<f64> {
        let each = |of: &dyn Fn(usize) -> [f64; 3]| {
            view.order().iter().flat_map(|place| of(*place as usize)).collect()
        };
        match self {
            Self::Velocities => each(&|place| view.bodies().velocity_of(place)),
            Self::Spins => each(&|place| view.bodies().spin_of(place)),
            Self::Quantity { compute, .. } => vec![compute(view, now, start)],
        }
    }
}

/// How the runs of a scene are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Run by run, at the end.
    Paths,
    /// Means over the last fifth of the time and over runs.
    Means,
}

pub(crate) fn kind(plan: &Plan) -> Kind {
    if plan.bodies.len() <= FEW { Kind::Paths } else { Kind::Means }
}

/// The quantities that were asked for, else those in the time series of the scene, else the usual ones of its kind.
pub(crate) fn observables(
    asked: &[String],
    scene: &Scene,
    plan: &Plan,
) -> Result<Vec<Observable>, TradeError> {
    let series = scene.outputs.items.iter().filter_map(|output| match &output.what {
        OutputChoice::Series { columns: Some(columns) } => Some(columns),
        _ => None,
    });
    let named: Vec<String> = if asked.is_empty() {
        series.flatten().map(|name| name.value.clone()).collect()
    } else {
        asked.to_vec()
    };
    let usual: &[&str] = match kind(plan) {
        Kind::Paths if plan.rotation => &["velocities", "spins"],
        Kind::Paths => &["velocities"],
        Kind::Means if plan.gravity == [0.0; 3] => &["kinetic_energy", "contacts"],
        Kind::Means => &["mean_height", "coordination_number", "kinetic_energy"],
    };
    let mut names: Vec<&str> =
        if named.is_empty() { usual.to_vec() } else { named.iter().map(String::as_str).collect() };
    let mut seen = std::collections::BTreeSet::new();
    names.retain(|name| seen.insert(name.to_string()));
    names.into_iter().map(observable).collect()
}

pub(crate) fn observable(name: &str) -> Result<Observable, TradeError> {
    match name {
        "velocities" => return Ok(Observable::Velocities),
        "spins" => return Ok(Observable::Spins),
        _ => {}
    }
    let known = SERIES.iter().find(|(known, _, _)| *known == name).zip(compute(name));
    known.map(|((name, unit, _), compute)| Observable::Quantity { name, unit, compute }).ok_or_else(|| {
        TradeError::UnknownQuantity {
            name: name.to_string(),
            known: ["velocities", "spins"]
                .into_iter()
                .chain(SERIES.iter().map(|(name, _, _)| *name))
                .map(String::from)
                .collect(),
        }
    })
}

/// The ledger has to be kept for these.
pub(crate) fn need_ledger(observables: &[Observable]) -> bool {
    observables.iter().any(|observable| LEDGER.contains(&observable.name()))
}
