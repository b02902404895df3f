//! "You are here": where the stiffest contact of a scene lies in the maps of the stability atlas.

use granule_law_api::Slot;

use crate::explain::scheme_name;
use crate::model::{Composition, Scheme};

/// Fewest steps in a contact that are taken without a warning: from so many on, every shipped normal law keeps its restitution
/// to 5 % of the impact speed, by the maps of single contacts.
pub const FEWEST_STEPS: f64 = 12.0;

/// Beginning of the names of the crates whose laws have maps.
pub(crate) const SHIPPED: &str = "granule-law-";

/// The map of a law and an integrator (as scenes name it): of a single contact, or of a dense packing.
pub fn map_name(law: &str, scheme: &str, crowded: bool) -> String {
    format!("{}-{law}-{scheme}", if crowded { "block" } else { "single" })
}

/// A contact in the maps over steps per contact and damping ratio.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Its normal law.
    pub law: &'static str,
    /// Duration of an impact \[s\].
    pub duration: f64,
    /// Damping over the critical one.
    pub damping_ratio: f64,
    scheme: &'static str,
    shipped: bool,
}

impl Place {
    /// The place of a composition, if it has a normal law.
    pub(crate) fn of(
        composition: &Composition,
        duration: f64,
        damping_ratio: f64,
        scheme: Scheme,
    ) -> Option<Self> {
        let law = composition.stages.iter().find(|stage| stage.slot == Slot::Normal)?.law;
        Some(Self {
            law: law.info.name,
            duration,
            damping_ratio,
            scheme: scheme_name(scheme),
            shipped: law.crate_name.starts_with(SHIPPED),
        })
    }

    /// Where a step is, and how many steps in a contact it would take.
    pub(crate) fn describe(&self, step: f64, needed: f64, crowded: bool) -> String {
        let map = if self.shipped {
            format!("docs/atlas.md, map {}", map_name(self.law, self.scheme, crowded))
        } else {
            format!("{} with {}", self.law, self.scheme)
        };
        format!(
            "you are here: {map}, {:.2} steps per contact at a damping ratio of {:.2}, where {needed:.2} are needed",
            self.duration / step,
            self.damping_ratio
        )
    }
}
