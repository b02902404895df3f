//! The surface that bodies roll and slide on.

use std::sync::Arc;

use granule_geometry::{Cell, Motion};
use granule_law_api::{RegistryError, SubstrateContext};
use granule_scene::{Diagnostic, LawBlock, SubstrateBlock, suggestion};

use crate::bodies::Draft;
use crate::build::Builder;
use crate::laws::check::{given_parameters, law_error};
use crate::model::{Dimensions, Plan, Scheme, SubstrateMaterial, SubstratePlan};
use crate::{explain, walls};

/// A body may be this share of its radius above or below the surface that it starts on.
const CLEARANCE: f64 = 1e-6;

/// Gravity in the frame of a tilted substrate.
pub(crate) fn tilted(builder: &mut Builder<'_>, gravity: [f64; 3]) -> Option<[f64; 3]> {
    let Some(angle) = builder.scene.substrate.as_ref().and_then(|block| block.inclination.as_ref()) else {
        return Some(gravity);
    };
    if gravity[0] != 0.0 || gravity[1] != 0.0 {
        builder.error_help(
            angle.span.clone(),
            "an `inclination` needs gravity along -z",
            "or leave it out and give gravity as the tilted surface sees it",
        );
        return None;
    }
    Some([0.0, gravity[2] * libm::sin(angle.value), gravity[2] * libm::cos(angle.value)])
}

/// The substrate of the scene, if it has one.
pub(crate) fn substrate(
    builder: &mut Builder<'_>,
    drafts: &[Draft],
    cell: &Cell,
    gravity: [f64; 3],
    scheme: Scheme,
) -> Option<SubstratePlan> {
    let scene = builder.scene;
    let block = scene.substrate.as_ref()?;
    if builder.dimensions == Dimensions::Two {
        builder.error_help(
            block.span.clone(),
            "a substrate needs 3 dimensions",
            "bodies that roll spin about axes in the plane of the surface",
        );
        return None;
    }
    if !matches!(scheme, Scheme::VelocityVerlet | Scheme::ClassicVelocityVerlet) {
        let message = format!("a substrate cannot be used with {}", explain::scheme_name(scheme));
        builder.error_help(block.span.clone(), message, "use VelocityVerlet or ClassicVelocityVerlet");
    }
    if gravity[2] > 0.0 {
        builder.error(block.span.clone(), "gravity must press bodies onto the substrate, along -z");
    }
    if let Some(restitution) = &block.restitution
        && block.confined
    {
        let message = "`restitution` has no effect on bodies that never leave the surface";
        builder.error_help(restitution.span.clone(), message, "set `confined: false`");
    }
    let motion = motion(builder, block, cell);
    let height = block.height.as_ref().map_or(0.0, |height| height.value);
    places(builder, block, drafts, height);
    let materials = materials(builder, block, drafts);
    Some(SubstratePlan {
        height,
        motion: motion?,
        confined: block.confined,
        restitution: block.restitution.as_ref().map_or(0.0, |restitution| restitution.value),
        materials,
    })
}

/// Motion of the surface, which must keep its height.
fn motion(builder: &mut Builder<'_>, block: &SubstrateBlock, cell: &Cell) -> Option<Motion> {
    let Some(choice) = &block.motion else { return Some(Motion::fixed()) };
    let motion = walls::motion(builder, choice)?;
    if let Some((_, axis, _)) = motion.rotation_at(0.0) {
        if axis.x != 0.0 || axis.y != 0.0 {
            builder.error(choice.span.clone(), "a substrate can turn about z only");
            return None;
        }
        if cell.is_periodic() {
            builder.error(choice.span.clone(), "a substrate that turns cannot be periodic");
            return None;
        }
    }
    if motion.leaves_plane() {
        builder.error_help(
            choice.span.clone(),
            "a substrate moves in its own plane, along x and y",
            "a wall can move in any direction",
        );
        return None;
    }
    Some(motion)
}

/// Bodies start on the surface, or above it if they may leave it.
fn places(builder: &mut Builder<'_>, block: &SubstrateBlock, drafts: &[Draft], height: f64) {
    for draft in drafts.iter().filter(|draft| !draft.frozen) {
        let gap = draft.position[2] - draft.radius - height;
        let slack = CLEARANCE * draft.radius;
        let wrong = if block.confined { gap.abs() > slack || draft.velocity[2] != 0.0 } else { gap < -slack };
        if wrong {
            let message = format!(
                "body {} at z = {} m with v_z = {} m/s is not on the substrate at z = {height} m",
                draft.id, draft.position[2], draft.velocity[2]
            );
            let help = format!("its centre belongs at z = {} m", height + draft.radius);
            builder.error_help(draft.span.clone(), message, help);
            return;
        }
    }
}

fn materials(
    builder: &mut Builder<'_>,
    block: &SubstrateBlock,
    drafts: &[Draft],
) -> Vec<Option<SubstrateMaterial>> {
    let mut materials: Vec<Option<SubstrateMaterial>> = Vec::new();
    materials.resize_with(builder.scene.materials.items.len(), || None);
    for (name, _) in &block.rolling_friction {
        if !block.laws.iter().any(|(other, _)| other.value == name.value) {
            builder.error(name.span.clone(), format!("`laws` has no law for material `{}`", name.value));
        }
    }
    let before = builder.errors();
    for (name, law) in &block.laws {
        let index = builder.material(name);
        let rows = block.rolling_friction.iter().find(|(other, _)| other.value == name.value);
        let rolling_friction = rows.map_or(Vec::new(), |(_, rows)| {
            rows.iter().map(|(speed, friction)| (speed.value, friction.value)).collect()
        });
        let used = |index| drafts.iter().any(|draft| draft.material == index && !draft.frozen);
        if let (Some(index), Some(material)) = (index, compile(builder, law, rolling_friction))
            && used(index)
        {
            materials[usize::from(index)] = Some(material);
        }
    }
    if builder.errors() == before {
        let missing = drafts.iter().find(|draft| {
            !draft.frozen && materials.get(usize::from(draft.material)).is_some_and(Option::is_none)
        });
        if let Some(draft) = missing {
            let name = builder.scene.materials.items[usize::from(draft.material)].name.value.clone();
            builder.error_help(
                block.span.clone(),
                format!("no substrate law for material `{name}`, of which body {} is made", draft.id),
                format!("add \"{name}\": StickSlip(..) to `laws`"),
            );
        }
    }
    materials
}

fn compile(
    builder: &mut Builder<'_>,
    block: &LawBlock,
    rolling_friction: Vec<(f64, f64)>,
) -> Option<SubstrateMaterial> {
    let law = match builder.registry.substrate(&block.name.value) {
        Ok(law) => law,
        Err(RegistryError::Unknown { name, known, .. }) => {
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            let help = suggestion("substrate laws", &name, &known);
            let message = format!("there is no substrate law `{name}`");
            builder.diagnostics.push(Diagnostic::error(block.name.span.clone(), message).help(help));
            return None;
        }
        Err(error) => {
            builder.error(block.name.span.clone(), error.to_string());
            return None;
        }
    };
    let given = given_parameters(builder, block, law.info.name, law.info.parameters)?;
    let params = match law.info.params(&given) {
        Ok(params) => params,
        Err(errors) => {
            for error in errors {
                law_error(builder, block, law.info.name, &error);
            }
            return None;
        }
    };
    let stage = (law.compile)(&params, &SubstrateContext { rolling_friction: &rolling_friction });
    match stage {
        Ok(stage) => Some(SubstrateMaterial { law, params, rolling_friction, stage: Arc::from(stage) }),
        Err(error) => {
            law_error(builder, block, law.info.name, &error);
            None
        }
    }
}

/// Says whether there is a substrate, and how bodies roll on it.
pub(crate) fn decide(builder: &mut Builder<'_>, plan: &Plan) {
    let Some(substrate) = &plan.substrate else {
        builder.decide_one("substrate", false, "the scene has none".to_string());
        return;
    };
    let bodies = if substrate.confined { "bodies never leave it" } else { "bodies may leave it" };
    let moves = if substrate.motion.is_fixed() { "fixed" } else { "moving" };
    let laws: Vec<String> = plan
        .materials
        .iter()
        .zip(&substrate.materials)
        .filter_map(|(material, law)| {
            let law = law.as_ref()?;
            let mut values: Vec<String> =
                law.params.values().iter().map(|(name, value)| format!("{name} {value}")).collect();
            if !law.rolling_friction.is_empty() {
                values.retain(|value| !value.starts_with("rolling_friction"));
                values.push(format!("rolling_friction from a table of {} rows", law.rolling_friction.len()));
            }
            Some(format!("{} {}({})", material.name, law.law.info.name, values.join(", ")))
        })
        .collect();
    let why = format!("at z = {} m, {moves}, {bodies}; {}", substrate.height, laws.join("; "));
    builder.decide_one("substrate", true, why);
}
