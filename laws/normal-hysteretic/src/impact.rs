//! A head-on impact in closed form.

use std::f64::consts::FRAC_PI_2;

use granule_law_api::{ContactEnd, Impact, ImpactOutcome};

use crate::model::Model;

/// Loading along k_1, and beyond δ_lim along the largest k_2; unloading along k_2(δ_max) to zero force; free flight from there to
/// zero overlap (Luding 1998, Eqs. (46), (47) and the text after Eq. (47)).
pub(crate) fn outcome(model: &Model, impact: &Impact, end: ContactEnd) -> ImpactOutcome {
    let (mass, speed) = (impact.reduced_mass, impact.normal_speed);
    let branches = model.at(mass, impact.reduced_radius);
    let loading_time = (mass / branches.loading).sqrt();
    let reach = speed * loading_time;
    let grows = branches.limit > 0.0;
    let (maximum_overlap, plastic_overlap, unloading, rise) = if !grows || reach <= branches.limit {
        let unloading = branches.unloading(reach);
        let plastic = (unloading - branches.loading) / unloading * reach;
        (reach, plastic, unloading, FRAC_PI_2 * loading_time)
    } else {
        // Along k_1 up to δ_lim, then an oscillation about the plastic overlap with k_2.
        let (limit, unloading) = (branches.limit, branches.largest);
        let plastic = (unloading - branches.loading) / unloading * limit;
        let time = (mass / unloading).sqrt();
        let elastic = limit - plastic;
        let square = speed * speed - branches.loading * limit * limit / mass;
        let amplitude = elastic.hypot(square.max(0.0).sqrt() * time);
        let rise = loading_time * (limit / reach).asin() + time * (elastic / amplitude).acos();
        (plastic + amplitude, plastic, unloading, rise)
    };
    let fall = (mass / unloading).sqrt();
    let restitution = (maximum_overlap - plastic_overlap) / fall / speed;
    let opening = match end {
        ContactEnd::Force => 0.0,
        ContactEnd::Overlap => plastic_overlap / (restitution * speed),
    };
    ImpactOutcome { duration: rise + FRAC_PI_2 * fall + opening, maximum_overlap, restitution }
}
