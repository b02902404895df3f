//! A plan in words: what is included, what is left out, and why.

use std::fmt::Write as _;

use granule_law_api::{ContactEnd, Impact, Oracle, Slot};
use granule_state::Layout;

use crate::limits;
use crate::model::{
    CollisionPlan, Composition, Dimensions, EventPlan, OutputKind, Partner, Plan, Precision, Scheme, Search,
    Slides,
};

/// What runs, line by line. Everything that the scene left to a default is shown with its value.
pub fn explain(plan: &Plan) -> String {
    let mut out = String::new();
    let title = if plan.title.is_empty() { "untitled scene" } else { plan.title.as_str() };
    line(&mut out, format_args!("{title}"));
    line(&mut out, format_args!("fingerprint: {}", plan.fingerprint));
    decisions(&mut out, plan);
    settings(&mut out, plan);
    bodies(&mut out, plan);
    line(&mut out, format_args!("\nContacts"));
    if plan.compositions.is_empty() && plan.event.is_none() {
        line(&mut out, format_args!("  none: no law acts"));
    }
    for collision in plan.event.iter().flat_map(|event| &event.collisions) {
        rule(&mut out, plan, collision);
    }
    for composition in &plan.compositions {
        contact(&mut out, plan, composition);
    }
    memory(&mut out, plan);
    outputs(&mut out, plan);
    out
}

fn line(out: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(out, "{text}");
}

fn decisions(out: &mut String, plan: &Plan) {
    for (heading, included, sign) in [("Included", true, '+'), ("Left out", false, '-')] {
        line(out, format_args!("\n{heading}"));
        for decision in plan.decisions.iter().filter(|decision| decision.included == included) {
            line(out, format_args!("  {sign} {}: {}", decision.topic, decision.why));
        }
    }
}

/// Time of a number of steps, without the digits that their multiplication leaves.
fn steps_in_seconds(steps: u64, step: f64) -> f64 {
    let product = steps as f64 * step;
    format!("{product:.14e}").parse().unwrap_or(product)
}

fn settings(out: &mut String, plan: &Plan) {
    let driver = &plan.driver;
    line(out, format_args!("\nSettings"));
    if let Some(event) = &plan.event {
        event_settings(out, plan, event);
        return;
    }
    line(out, format_args!("  integrator: {}", scheme_name(driver.scheme)));
    line(
        out,
        format_args!(
            "  steps: {} of {:e} s, {:e} s in all",
            driver.steps,
            driver.step,
            steps_in_seconds(driver.steps, driver.step)
        ),
    );
    if driver.step_limit.is_finite() {
        line(
            out,
            format_args!(
                "  largest stable step: {:.3e} s; the step is {:.1} % of it",
                driver.step_limit,
                100.0 * driver.step / driver.step_limit
            ),
        );
    } else {
        line(out, format_args!("  largest stable step: no limit, as no law has a stiffness or damping"));
    }
    let precision = match plan.precision {
        Precision::Double => "double",
        Precision::Single => "single in the laws, on relative positions and velocities; double in the state",
    };
    line(out, format_args!("  precision: {precision}"));
    match driver.search {
        Search::Grid => line(out, format_args!("  skin: {:e} m", driver.skin)),
        Search::AllPairs | Search::None => {}
    }
    match driver.threads {
        Some(threads) => line(out, format_args!("  threads: {threads}")),
        None => line(out, format_args!("  threads: as many as the machine has")),
    }
    let c = &plan.conventions;
    line(
        out,
        format_args!(
            "  conventions between bodies: torque arm {:?}, slip arm {:?}; at walls: torque arm {:?}, slip arm {:?}",
            c.pair_torque_arm, c.pair_slip_arm, c.wall_torque_arm, c.wall_slip_arm
        ),
    );
    line(
        out,
        format_args!(
            "  conventions of friction: history {:?}, Coulomb test {:?}, Coulomb limit {:?}; velocities in forces {:?}",
            c.history_update, c.coulomb_test, c.coulomb_cap, c.velocity
        ),
    );
    periods(out, plan);
}

fn periods(out: &mut String, plan: &Plan) {
    if plan.cell.is_periodic() {
        let (lo, hi, periodic) = (plan.cell.lo(), plan.cell.hi(), plan.cell.periodic());
        for axis in (0..3).filter(|axis| periodic[*axis]) {
            line(out, format_args!("  period in {}: {} to {} m", ["x", "y", "z"][axis], lo[axis], hi[axis]));
        }
    }
}

fn event_settings(out: &mut String, plan: &Plan, event: &EventPlan) {
    let driver = &plan.driver;
    let motion = match event.slides {
        None => "fly freely",
        Some(Slides::Arcs { .. }) => "slide and roll along arcs",
        Some(Slides::EffectiveRestitution) => "roll without friction",
    };
    line(out, format_args!("  event-driven: bodies {motion} from collision to collision"));
    line(
        out,
        format_args!(
            "  steps, at which the run can be looked at: {} of {:e} s, {:e} s in all",
            driver.steps,
            driver.step,
            steps_in_seconds(driver.steps, driver.step)
        ),
    );
    if event.contact_duration > 0.0 {
        line(out, format_args!("  contact duration: {:e} s", event.contact_duration));
    } else {
        line(out, format_args!("  contact duration: none; no collision loses energy along the normal"));
    }
    periods(out, plan);
}

/// Name of a scheme in scenes.
pub(crate) fn scheme_name(scheme: Scheme) -> &'static str {
    match scheme {
        Scheme::VelocityVerlet => "VelocityVerlet",
        Scheme::ClassicVelocityVerlet => "ClassicVelocityVerlet",
        Scheme::ContactResolved => "ContactResolved",
        Scheme::Leapfrog => "Leapfrog",
        Scheme::SymplecticEuler => "SymplecticEuler",
    }
}

fn bodies(out: &mut String, plan: &Plan) {
    let table = &plan.bodies;
    line(out, format_args!("\nBodies"));
    for (index, material) in plan.materials.iter().enumerate() {
        let of: Vec<usize> = (0..table.len()).filter(|k| usize::from(table.material[*k]) == index).collect();
        if of.is_empty() {
            continue;
        }
        let range = |values: &[f64], unit: &str| {
            let least = of.iter().fold(f64::INFINITY, |a: f64, k| a.min(values[*k]));
            let most = of.iter().fold(f64::NEG_INFINITY, |a: f64, k| a.max(values[*k]));
            if least == most {
                format!("{least:.6e}{unit}")
            } else {
                format!("{least:.6e} to {most:.6e}{unit}")
            }
        };
        let frozen = of.iter().filter(|k| table.frozen[**k]).count();
        let frozen = if frozen > 0 { format!(", {frozen} frozen") } else { String::new() };
        line(
            out,
            format_args!(
                "  {} of {}: radius {}, mass {}, inertia factor {}{frozen}",
                of.len(),
                material.name,
                range(&table.radius, " m"),
                range(&table.mass, " kg"),
                range(&table.inertia_factor, "")
            ),
        );
    }
    for wall in &plan.walls {
        let material =
            plan.materials.get(usize::from(wall.material)).map_or("?", |material| material.name.as_str());
        let motion = if wall.wall.motion().is_fixed() { "fixed" } else { "moving" };
        line(out, format_args!("  wall `{}` of {material}, {motion}", wall.name));
    }
}

fn rule(out: &mut String, plan: &Plan, collision: &CollisionPlan) {
    let name =
        |index: u16| plan.materials.get(usize::from(index)).map_or("?", |material| material.name.as_str());
    let partner = match collision.partner {
        Partner::Body(other) => format!("bodies of {}", name(other)),
        Partner::Wall(wall) => plan
            .walls
            .get(usize::from(wall))
            .map_or("a wall".to_string(), |wall| format!("wall `{}`", wall.name)),
    };
    let values: Vec<String> =
        collision.params.values().iter().map(|(name, value)| format!("{name} = {value}")).collect();
    line(
        out,
        format_args!(
            "  bodies of {} and {partner}: {}, {}",
            name(collision.material),
            collision.law.info.name,
            values.join(", ")
        ),
    );
}

fn contact(out: &mut String, plan: &Plan, composition: &Composition) {
    let end = match composition.contact_end {
        ContactEnd::Force => "when the normal force has fallen to zero",
        ContactEnd::Overlap => "when the overlap has vanished",
    };
    line(out, format_args!("  {}: ends {end}", limits::name(plan, composition)));
    for stage in &composition.stages {
        let info = stage.law.info;
        let values: Vec<String> = stage
            .params
            .values()
            .iter()
            .map(|(name, value)| {
                let spec = info.parameters.iter().find(|spec| spec.name == *name);
                match spec.filter(|spec| !spec.dimension.is_dimensionless()) {
                    Some(spec) => format!("{name} {value:e} {}", spec.dimension),
                    None => format!("{name} {value}"),
                }
            })
            .collect();
        line(out, format_args!("    {}: {}, {}", info.slot.name(), info.name, values.join(", ")));
        if info.slot == Slot::Normal {
            impact(out, composition, stage);
        }
    }
}

/// What a head-on impact at the expected speed does, by the closed form of the law.
fn impact(out: &mut String, composition: &Composition, stage: &crate::model::StagePlan) {
    let context = &composition.context;
    let Oracle::Normal(outcome) = (stage.law.oracle)(&stage.params, context) else { return };
    let masses = if context.reduced_mass.is_single() {
        vec![context.reduced_mass.min]
    } else {
        vec![context.reduced_mass.min, context.reduced_mass.max]
    };
    for (index, reduced_mass) in masses.into_iter().enumerate() {
        let reduced_radius = if index == 0 { context.reduced_radius.min } else { context.reduced_radius.max };
        let impact = Impact { reduced_mass, reduced_radius, normal_speed: context.impact_speed };
        let result = outcome(&impact);
        line(
            out,
            format_args!(
                "      at {:.3e} m/s and a reduced mass of {reduced_mass:.3e} kg: duration {:.6e} s, restitution {:.6}, \
                 largest overlap {:.3e} m",
                context.impact_speed, result.duration, result.restitution, result.maximum_overlap
            ),
        );
    }
}

fn memory(out: &mut String, plan: &Plan) {
    let layout = Layout {
        planar: plan.dimensions == Dimensions::Two,
        rotation: plan.rotation,
        previous_acceleration: matches!(plan.driver.scheme, Scheme::VelocityVerlet | Scheme::ContactResolved),
        predicted_acceleration: plan.driver.scheme == Scheme::ContactResolved,
        surface: plan.substrate.is_some(),
    };
    let width = plan.compositions.iter().map(|composition| composition.history_width).max().unwrap_or(0);
    line(out, format_args!("\nMemory"));
    if plan.event.is_some() {
        line(out, format_args!("  about 400 bytes per body, with its event and neighbours"));
        return;
    }
    line(out, format_args!("  {} bytes per body", layout.bytes_per_body()));
    if width > 0 {
        // A stamp says in which step a pair last touched.
        line(
            out,
            format_args!("  {} bytes of history per listed pair: {width} numbers and a stamp", 8 * width + 4),
        );
    } else {
        line(out, format_args!("  0 bytes of history per contact"));
    }
}

fn outputs(out: &mut String, plan: &Plan) {
    line(out, format_args!("\nOutputs"));
    if plan.outputs.is_empty() {
        line(out, format_args!("  none"));
    }
    for output in &plan.outputs {
        let kind = match &output.kind {
            OutputKind::Series(columns) => format!("series of {}", columns.join(", ")),
            OutputKind::BodySeries(ids) => {
                let ids: Vec<String> = ids.iter().map(u32::to_string).collect();
                format!("series of bodies {}", ids.join(", "))
            }
            OutputKind::LammpsDump => "LAMMPS dump".to_string(),
            OutputKind::Vtk { compressed: true } => "VTK, compressed".to_string(),
            OutputKind::Vtk { compressed: false } => "VTK, not compressed".to_string(),
            OutputKind::LammpsData => "LAMMPS data file of the last state".to_string(),
            OutputKind::Layer { gap, neighbours } => {
                format!("layer, clusters by gaps below {gap:e} m, neighbours below {neighbours:e} m")
            }
            OutputKind::PairCorrelation { range, bins } => {
                format!("pair correlation up to {range:e} m in {bins} intervals")
            }
            OutputKind::Contacts => "what each contact does".to_string(),
            OutputKind::Impacts { reach } => {
                format!("table of impacts, density within {reach:e} m; looks")
            }
        };
        match output.kind {
            OutputKind::LammpsData => line(out, format_args!("  {}: {kind}", output.path.display())),
            _ => line(
                out,
                format_args!(
                    "  {}: {kind}; every {}, {:e} s",
                    output.path.display(),
                    if output.every == 1 { "step".to_string() } else { format!("{} steps", output.every) },
                    steps_in_seconds(output.every, plan.driver.step)
                ),
            ),
        }
    }
}
