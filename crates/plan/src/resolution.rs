//! Whether positions are finer than what happens at them: doubles far from the origin are multiples of a coarse spacing.

use granule_law_api::Impact;

use crate::build::Builder;
use crate::impacts;
use crate::limits;
use crate::model::Plan;

/// Spacing of positions over the smallest radius at which no contact has a meaning any more.
const COARSEST: f64 = 1e-3;
/// Spacings in the largest overlap of an impact, and in the way of a step, that are taken without a warning. An overlap is then
/// known to a hundredth, and so is the force of it.
const FEWEST: f64 = 100.0;
/// Spacings in the way of a step: it is rounded to them, up or down.
const FEWEST_A_STEP: f64 = 4.0;

/// Refuses bodies that are smaller than the spacing of positions would need, and warns of impacts that it blurs.
pub(crate) fn check(builder: &mut Builder<'_>, plan: &Plan) {
    let furthest = plan
        .bodies
        .position
        .iter()
        .flatten()
        .fold(0.0, |furthest: f64, component| furthest.max(component.abs()));
    let spacing = furthest.next_up() - furthest;
    let smallest = plan.bodies.radius.iter().fold(f64::INFINITY, |a: f64, b| a.min(*b));
    let span = builder.scene.bodies.span.clone();
    let help = "put the origin nearer to the bodies";
    if spacing > COARSEST * smallest {
        builder.error_help(
            span,
            format!(
                "positions of {furthest:.3e} m are multiples of {spacing:.1e} m, too coarse for a radius of {smallest:e} m"
            ),
            help,
        );
        return;
    }
    if plan.event.is_some() {
        return;
    }
    // The finest of what each composition needs, with the overlap of its impacts if the law knows it.
    let worst = plan
        .compositions
        .iter()
        .map(|composition| {
            let context = &composition.context;
            let impact = Impact {
                reduced_mass: context.reduced_mass.min,
                reduced_radius: context.reduced_radius.min,
                normal_speed: context.impact_speed,
            };
            let overlap = impacts::overlap(composition, &impact).filter(|overlap| *overlap > 0.0);
            let way = context.impact_speed * plan.driver.step;
            let finest = overlap.unwrap_or(f64::INFINITY).min(way * FEWEST / FEWEST_A_STEP);
            (finest, overlap, way, composition)
        })
        .filter(|(finest, ..)| *finest > 0.0 && *finest < FEWEST * spacing)
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, overlap, way, composition)) = worst else { return };
    let deep = overlap.map(|overlap| {
        format!(
            "overlap by {overlap:.1e} m, of which {:.0e} is round-off, and ",
            (spacing / overlap).min(1.0)
        )
    });
    builder.warning(
        span,
        format!(
            "positions of {furthest:.3e} m are multiples of {spacing:.1e} m: at {:.3e} m/s, {} {}move by {way:.1e} m in a step",
            composition.context.impact_speed,
            limits::name(plan, composition),
            deep.unwrap_or_default()
        ),
        help,
    );
}
