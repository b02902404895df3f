//! Dimensionless groups of a scene, from its laws and from what happens in it.

use granule_law_api::{Impact, Slot};
use granule_plan::{Composition, Plan, limits};

use super::probe::Probe;
use crate::single::{ends, restitutions, sizes};

/// Steps in the shortest contact of the impacts that are measured.
const STEPS: f64 = 1000.0;

/// One group with its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Name.
    pub name: &'static str,
    /// Symbol, as in the source.
    pub symbol: &'static str,
    /// Of which pair of materials; empty for the whole scene.
    pub of: String,
    /// Value; infinite where a denominator vanishes.
    pub value: f64,
    /// The value that separates two kinds of behaviour, if there is one.
    pub threshold: Option<f64>,
    /// What it means here.
    pub meaning: String,
    /// Where it is from.
    pub source: &'static str,
}

/// The groups of a probed plan.
pub(super) fn groups(plan: &Plan, probe: &Probe) -> Vec<Group> {
    let mut groups = Vec::new();
    let shortest = limits(plan).shortest_contact;
    for (at, composition) in plan.compositions.iter().enumerate() {
        if let Some(duration) = shortest {
            of_pair(plan, probe, at, composition, duration / STEPS, &mut groups);
        }
    }
    whole(plan, probe, shortest, &mut groups);
    if let Some(duration) = shortest {
        substrate(plan, probe, duration, &mut groups);
    }
    groups
}

fn name(plan: &Plan, composition: &Composition) -> String {
    let material = |index: u16| plan.materials[usize::from(index)].name.as_str();
    match composition.partner {
        granule_plan::Partner::Body(other) => {
            format!("{} on {}", material(composition.material), material(other))
        }
        granule_plan::Partner::Wall(wall) => {
            format!("{} on wall `{}`", material(composition.material), plan.walls[usize::from(wall)].name)
        }
    }
}

fn of_pair(
    plan: &Plan,
    probe: &Probe,
    at: usize,
    composition: &Composition,
    step: f64,
    groups: &mut Vec<Group>,
) {
    let of = name(plan, composition);
    let context = &composition.context;
    let size = sizes(context)[0];
    let impact = Impact { reduced_mass: size.0, reduced_radius: size.1, normal_speed: context.impact_speed };
    let Some(stage) = composition.stages.iter().find(|stage| stage.slot == Slot::Normal) else { return };
    if let Ok(Some(scale)) = (stage.law.time_scale)(&stage.params, context, &impact)
        && scale.stiffness > 0.0
    {
        let ratio = scale.damping / (2.0 * (scale.stiffness * size.0).sqrt());
        groups.push(Group {
            name: "damping ratio",
            symbol: "eta/omega_0",
            of: of.clone(),
            value: ratio,
            threshold: Some(1.0),
            meaning: if ratio < 1.0 { "contacts rebound" } else { "contacts creep apart" }.into(),
            source: "Luding 1998, Eqs. (27)-(32)",
        });
    }
    let impacts: Vec<_> = probe.impacts.iter().filter(|impact| impact.composition == at).collect();
    if impacts.is_empty() {
        return;
    }
    let q = ends(context.inertia_factor)[0];
    let friction = composition.stages.iter().find(|stage| stage.slot == Slot::Tangential).and_then(|stage| {
        let values = stage.params.values();
        values.iter().find(|(name, _)| *name == "friction").map(|(_, value)| *value)
    });
    let (Some(friction), Ok(realised)) = (friction, restitutions(plan, at, size, q, step)) else { return };
    let threshold = friction * (1.0 + realised.normal) * (1.0 + 1.0 / q) / (1.0 + realised.tangential);
    let ratios: Vec<f64> = impacts.iter().map(|impact| impact.slip / impact.normal).collect();
    let sliding = ratios.iter().filter(|ratio| **ratio > threshold).count() as f64 / ratios.len() as f64;
    let mut sorted = ratios;
    sorted.sort_by(f64::total_cmp);
    groups.push(Group {
        name: "tangential over normal velocity of an impact, median",
        symbol: "Psi_1 against Psi_1,0",
        of,
        value: sorted[sorted.len() / 2],
        threshold: Some(threshold),
        meaning: format!("{:.1} % of {} impacts slide throughout", 100.0 * sliding, sorted.len()),
        source: "Luding 1998, Eqs. (20)-(21)",
    });
}

fn whole(plan: &Plan, probe: &Probe, shortest: Option<f64>, groups: &mut Vec<Group>) {
    let mut push = |name, symbol, value: f64, threshold, meaning: String, source| {
        groups.push(Group { name, symbol, of: String::new(), value, threshold, meaning, source });
    };
    push(
        "largest overlap over radius",
        "delta/R",
        probe.deepest,
        Some(0.1),
        if probe.deepest < 0.1 { "contacts are small" } else { "laws of small overlaps are stretched" }
            .into(),
        "Luding 1998, Eq. (39)",
    );
    push(
        "coordination number",
        "Z",
        probe.coordination,
        None,
        if probe.coordination < 1.0 { "collisions rule" } else { "contacts last" }.into(),
        "contacts of a body",
    );
    let impacts = probe.impacts.len() as f64;
    if let Some(contact) = shortest {
        push(
            "time between impacts of a body over duration of a contact",
            "t_(k+1)/t_c",
            probe.free_time / contact,
            Some(1.0),
            format!(
                "{:.1} % of {impacts} impacts began while another contact lasted",
                if impacts > 0.0 { 100.0 * probe.crowded as f64 / impacts } else { 0.0 }
            ),
            "Luding 1998, text after Eq. (6)",
        );
        let g = plan.gravity.iter().map(|c| c * c).sum::<f64>().sqrt();
        let speed = probe.impacts.iter().map(|impact| impact.normal).sum::<f64>() / impacts;
        if g > 0.0 && impacts > 0.0 {
            push(
                "gravity during a contact",
                "g t_c/v",
                g * contact / speed,
                Some(1.0),
                "velocity that gravity gives in a contact, over that of the mean impact".into(),
                "Kondic 1999, Eq. (38)",
            );
        }
    }
    let pressure = pressure(plan, probe);
    if pressure > 0.0 && probe.coordination >= 1.0 {
        let mass: f64 = plan.bodies.mass.iter().sum();
        let count = plan.bodies.len() as f64;
        let radius = plan.bodies.radius.iter().sum::<f64>() / count;
        let density = mass
            / plan.bodies.radius.iter().map(|r| 4.0 / 3.0 * std::f64::consts::PI * r.powi(3)).sum::<f64>();
        push(
            "inertial number",
            "I = gamma d sqrt(rho/P)",
            probe.shear_rate * 2.0 * radius * (density / pressure).sqrt(),
            Some(1e-3),
            format!(
                "shear rate {:.2e} 1/s and contact pressure {pressure:.2e} Pa, by the overlaps",
                probe.shear_rate
            ),
            "GDR MiDi, Eur. Phys. J. E 14 (2004) 341",
        );
    }
}

/// Trace of the contact stress over three, with the elastic force that the tangent stiffness gives \[Pa\].
fn pressure(plan: &Plan, probe: &Probe) -> f64 {
    let mut sum = 0.0;
    for (composition, overlaps) in plan.compositions.iter().zip(&probe.overlaps) {
        let context = &composition.context;
        let (reduced_mass, reduced_radius) = sizes(context)[0];
        let impact = Impact { reduced_mass, reduced_radius, normal_speed: context.impact_speed };
        let stage = composition.stages.iter().find(|stage| stage.slot == Slot::Normal);
        if let Some(stage) = stage
            && let Ok(Some(scale)) = (stage.law.time_scale)(&stage.params, context, &impact)
        {
            sum += scale.stiffness * overlaps;
        }
    }
    if probe.volume > 0.0 { sum / (3.0 * probe.volume) } else { 0.0 }
}

/// Whether bodies slide on the substrate in collisions, and whether they roll again before the next one.
fn substrate(plan: &Plan, probe: &Probe, contact: f64, groups: &mut Vec<Group>) {
    let Some(substrate) = &plan.substrate else { return };
    let g = -plan.gravity[2];
    let q = plan.bodies.inertia_factor.first().copied().unwrap_or(0.4);
    let impacts = probe.impacts.len() as f64;
    for (index, material) in substrate.materials.iter().enumerate() {
        let Some(material) = material else { continue };
        let value = |name: &str| {
            material.params.values().iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
        };
        let friction = value("friction");
        let (Some(standing), Some(sliding)) =
            (value("static_friction").or(friction), value("kinetic_friction").or(friction))
        else {
            continue;
        };
        if impacts == 0.0 || g <= 0.0 {
            continue;
        }
        let of = plan.materials[index].name.clone();
        let speed = probe.impacts.iter().map(|impact| impact.normal).sum::<f64>() / impacts;
        let barrier = 2.0 * (1.0 + 1.0 / q) * standing * g * contact / std::f64::consts::PI;
        groups.push(Group {
            name: "impact speed over that at which bodies begin to slide on the substrate",
            symbol: "v/v^b",
            of: of.clone(),
            value: speed / barrier,
            threshold: Some(1.0),
            meaning: if speed > barrier {
                "collisions make bodies slide"
            } else {
                "bodies roll through collisions"
            }
            .into(),
            source: "Kondic 1999, Eq. (35), erratum K-E5",
        });
        // A body that stops and goes back with half the relative speed: its slip ends after (1 + e) v/((1 + 1/q) mu_k g).
        let restitution = plan
            .compositions
            .iter()
            .position(|composition| usize::from(composition.material) == index)
            .and_then(|at| {
                let size = sizes(&plan.compositions[at].context)[0];
                restitutions(plan, at, size, q, contact / STEPS).ok()
            })
            .map_or(1.0, |realised| realised.normal);
        let own = 0.5 * speed;
        let time = (1.0 + restitution) * own / ((1.0 + 1.0 / q) * sliding * g);
        let effective = (restitution / q - 1.0) / (1.0 + 1.0 / q);
        let distance = 0.5 * (restitution + effective).abs() * own * time;
        groups.push(Group {
            name: "mean free path over the distance of sliding after a collision",
            symbol: "l/s",
            of,
            value: probe.speed * probe.free_time / distance,
            threshold: Some(1.0),
            meaning: "far above 1, sliding may be part of an effective restitution".into(),
            source: "Kondic 1999, Eqs. (42)-(44) and (68)",
        });
    }
}
