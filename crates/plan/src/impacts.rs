//! Warnings of impacts that a soft contact does not survive: too deep, or jumped over in one step.

use granule_law_api::{Impact, Oracle, Slot};

use crate::build::Builder;
use crate::limits;
use crate::model::{Composition, Partner, Plan};

/// Share of the smaller radius that an impact may overlap, or that bodies may approach in a step, without a warning:
/// contact laws hold for small overlaps, and at twice a radius bodies pass through each other.
const DEEPEST: f64 = 0.5;

/// Warns of the worst impact of the scene of each kind.
pub(crate) fn warn(builder: &mut Builder<'_>, plan: &Plan) {
    let radii = smallest_radii(plan);
    let radius = |composition: &Composition| {
        let of = |material: u16| radii.get(usize::from(material)).copied().unwrap_or(f64::INFINITY);
        match composition.partner {
            Partner::Body(other) => of(composition.material).min(of(other)),
            Partner::Wall(_) => of(composition.material),
        }
    };
    let worst = |measure: &dyn Fn(&Composition) -> f64| {
        plan.compositions
            .iter()
            .map(|composition| (measure(composition) / radius(composition), composition))
            .filter(|(share, _)| *share > DEEPEST)
            .max_by(|a, b| a.0.total_cmp(&b.0))
    };
    if let Some((share, composition)) =
        worst(&|composition| composition.context.impact_speed * plan.driver.step)
    {
        let speed = composition.context.impact_speed;
        builder.warning(
            builder.scene.driver.step.span.clone(),
            format!(
                "at {speed:.3e} m/s, {} approach by {share:.2} of the smaller radius in a step of {:e} s: contacts begin \
                 deep or are jumped over",
                limits::name(plan, composition),
                plan.driver.step
            ),
            format!(
                "a step of {:.3e} s or less, or `impact_speed` if nothing meets at that speed",
                0.1 * radius(composition) / speed
            ),
        );
    }
    if let Some((share, composition)) = worst(&largest_overlap) {
        builder.warning(
            builder.scene.contacts.span.clone(),
            format!(
                "an impact of {} at {:.3e} m/s overlaps by {share:.2} of the smaller radius",
                limits::name(plan, composition),
                composition.context.impact_speed
            ),
            "a stiffer contact, or `impact_speed` if nothing meets at that speed",
        );
    }
}

/// Smallest radius of the bodies of each material \[m\].
fn smallest_radii(plan: &Plan) -> Vec<f64> {
    let mut radii = vec![f64::INFINITY; plan.materials.len()];
    for (material, radius) in plan.bodies.material.iter().zip(&plan.bodies.radius) {
        if let Some(smallest) = radii.get_mut(usize::from(*material)) {
            *smallest = smallest.min(*radius);
        }
    }
    radii
}

/// Largest overlap of a head-on impact at the expected speed, by the closed form of the law \[m\].
fn largest_overlap(composition: &Composition) -> f64 {
    let context = &composition.context;
    let of = |reduced_mass, reduced_radius| {
        overlap(composition, &Impact { reduced_mass, reduced_radius, normal_speed: context.impact_speed })
            .unwrap_or(0.0)
    };
    of(context.reduced_mass.min, context.reduced_radius.min)
        .max(of(context.reduced_mass.max, context.reduced_radius.max))
}

/// Largest overlap of an impact by the closed form of the law, if it has one \[m\].
pub(crate) fn overlap(composition: &Composition, impact: &Impact) -> Option<f64> {
    let stage = composition.stages.iter().find(|stage| stage.slot == Slot::Normal)?;
    let Oracle::Normal(outcome) = (stage.law.oracle)(&stage.params, &composition.context) else {
        return None;
    };
    Some(outcome(impact).maximum_overlap)
}
