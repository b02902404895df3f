//! What the laws of a plan do in a single contact, beside what was asked of them.

mod contact;

use granule_law_api::{ContactEnd, Impact, PairContext, Params, Slot, Span};
use granule_plan::{Composition, Partner, Plan};

/// What a contact is asked to do, or does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Restitution e_n of a head-on impact.
    pub restitution: Option<f64>,
    /// Tangential restitution e_t0 of an impact that sticks, that is for a small slip; -1 without tangential law.
    pub tangential_restitution: Option<f64>,
    /// Duration t_c under the end of contact in use \[s\]; infinite if the contact never ends.
    pub duration: Option<f64>,
    /// Largest overlap \[m\].
    pub maximum_overlap: Option<f64>,
}

/// One pair of materials at one reduced mass, reduced radius and inertia factor.
#[derive(Clone, Debug, PartialEq)]
pub struct LawCheck {
    /// Names of both sides.
    pub pair: String,
    /// Names of the laws, in the order of their slots.
    pub laws: Vec<&'static str>,
    /// When the contact ends.
    pub contact_end: ContactEnd,
    /// The impact.
    pub impact: Impact,
    /// Inertia factor q = I/(m R²) of the bodies.
    pub inertia_factor: f64,
    /// Friction coefficient of the tangential law, if it has one.
    pub friction: Option<f64>,
    /// What the parameters ask for at this speed. A restitution that is asked for at another speed is not in here.
    pub requested: Figures,
    /// Speed at which the parameters ask for a restitution, if they name one \[m/s\].
    pub requested_at: Option<f64>,
    /// What the compiled laws do in the hard limit (the normal does not turn), integrated until a further halving of the step
    /// changes nothing in the sixth digit.
    pub realised: Figures,
}

/// Checks every composition of a plan that has a normal law, at its smallest and largest reduced mass, radius and inertia
/// factor. `speed` is the normal speed of impact \[m/s\]; without one it is that of the scene.
pub fn law_check(plan: &Plan, speed: Option<f64>) -> Vec<LawCheck> {
    let mut checks = Vec::new();
    for composition in &plan.compositions {
        if !composition.stages.iter().any(|stage| stage.slot == Slot::Normal) {
            continue;
        }
        let context = &composition.context;
        let normal_speed = speed.unwrap_or(context.impact_speed);
        if normal_speed <= 0.0 || !normal_speed.is_finite() {
            continue;
        }
        for (reduced_mass, reduced_radius) in sizes(context) {
            for inertia_factor in ends(context.inertia_factor) {
                let impact = Impact { reduced_mass, reduced_radius, normal_speed };
                checks.push(check(plan, composition, impact, inertia_factor));
            }
        }
    }
    checks
}

fn ends(span: Span) -> Vec<f64> {
    if span.is_single() { vec![span.max] } else { vec![span.min, span.max] }
}

/// The lightest with the smallest, the heaviest with the largest.
fn sizes(context: &PairContext) -> Vec<(f64, f64)> {
    let (mass, radius) = (context.reduced_mass, context.reduced_radius);
    if mass.is_single() && radius.is_single() {
        vec![(mass.max, radius.max)]
    } else {
        vec![(mass.min, radius.min), (mass.max, radius.max)]
    }
}

fn check(plan: &Plan, composition: &Composition, impact: Impact, inertia_factor: f64) -> LawCheck {
    let asked = |name: &str| {
        composition.stages.iter().find_map(|stage| {
            let found = stage.params.values().iter().find(|(known, _)| *known == name);
            found.map(|(_, value)| *value)
        })
    };
    let normal = |name: &str| {
        let stage = composition.stages.iter().find(|stage| stage.slot == Slot::Normal)?;
        value(&stage.params, name)
    };
    let requested_at = normal("restitution").and(normal("reference_speed"));
    let here = requested_at.is_none_or(|speed| (speed - impact.normal_speed).abs() <= 1e-12 * speed);
    LawCheck {
        pair: name(plan, composition),
        laws: composition.stages.iter().map(|stage| stage.law.info.name).collect(),
        contact_end: composition.contact_end,
        impact,
        inertia_factor,
        friction: asked("friction"),
        requested: Figures {
            restitution: normal("restitution").filter(|_| here),
            tangential_restitution: asked("tangential_restitution"),
            duration: normal("contact_duration"),
            maximum_overlap: None,
        },
        requested_at,
        realised: contact::realised(plan, composition, impact, inertia_factor),
    }
}

fn value(params: &Params, name: &str) -> Option<f64> {
    params.values().iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

fn name(plan: &Plan, composition: &Composition) -> String {
    let material =
        |index: u16| plan.materials.get(usize::from(index)).map_or("?", |material| material.name.as_str());
    match composition.partner {
        Partner::Body(other) => format!("{} on {}", material(composition.material), material(other)),
        Partner::Wall(wall) => {
            let wall = plan.walls.get(usize::from(wall)).map_or("?", |wall| wall.name.as_str());
            format!("{} on wall `{wall}`", material(composition.material))
        }
    }
}

#[cfg(test)]
mod tests;
