//! The event-driven driver: rules of collisions for all that can meet, contact duration, steps.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use granule_geometry::{Surface, Wall};
use granule_law_api::{CollisionEntry, CollisionRule, Params, RegistryError, probe};
use granule_scene::{
    ContactBlock, EventBlock, LawBlock, PrecisionChoice, RunBlock, SlidesChoice, suggestion,
};

use crate::build::Builder;
use crate::laws::Setting;
use crate::laws::check::{given_parameters, law_error, misbehaves};
use crate::laws::meeting::{Meeting, meetings};
use crate::model::{CollisionPlan, EventPlan, Plan, Slides, SubstratePlan};
use crate::place::SHIPPED;
use crate::schedule::{MOST_STEPS, shortest_interval, whole};

/// Default contact duration as a share of the shortest time in which a body moves by its diameter.
const CONTACT_SHARE: f64 = 1e-4;
/// The same on a substrate, where friction presses bodies against each other all the time: as long as soft contacts last.
/// They bounce by the square of this, 1e-5 of a diameter.
const CONTACT_SHARE_ON_SUBSTRATE: f64 = 1e-2;
/// Default error of a piece of an arc as a share of the smallest radius.
const ARC_ERROR: f64 = 1e-3;
/// Steps of a run that says nothing about them.
const STEPS: f64 = 100.0;

/// A rule of a block with its parameters.
struct Chosen<'s> {
    pair: (u16, u16),
    block: &'s ContactBlock,
    law: Option<(&'static CollisionEntry, Params, &'s LawBlock)>,
}

/// The plan of the event-driven driver; `None` if the scene has the other one. Rules are checked in either case.
pub(crate) fn event(builder: &mut Builder<'_>, setting: &Setting<'_>) -> Option<EventPlan> {
    let scene = builder.scene;
    let mut chosen = Vec::new();
    for block in &scene.contacts.items {
        let law = match &block.collision {
            None => None,
            Some(law) => {
                let Some((entry, params)) = choose(builder, law) else { continue };
                Some((entry, params, law))
            }
        };
        let index = |name: &str| scene.materials.items.iter().position(|item| item.name.value == name);
        // Unknown names are reported where the other laws are looked up.
        let (Some(a), Some(b)) = (index(&block.between.0.value), index(&block.between.1.value)) else {
            continue;
        };
        chosen.push(Chosen { pair: (a.min(b) as u16, a.max(b) as u16), block, law });
    }
    let rules = chosen.iter().filter(|chosen| chosen.law.is_some()).count();
    let Some(block) = &scene.event else {
        if rules > 0 {
            builder.decide_one("collision rules", false, "the driver is TimeStep: the laws of contact act");
        }
        return None;
    };
    let slides = slides(builder, setting, block);
    if scene.precision == PrecisionChoice::Single {
        builder.error_help(
            block.span.clone(),
            "`precision: Single` does not exist in the driver `Event`",
            "leave it out",
        );
    }
    if scene.conventions.preset.is_some() || !scene.conventions.changes.is_empty() {
        builder.warning(block.span.clone(), "`conventions` have no effect on hard bodies", "leave them out");
    }
    if scene.allow_overlap {
        builder.error_help(
            block.span.clone(),
            "hard bodies cannot overlap, which `allow_overlap` permits",
            "leave `allow_overlap` out",
        );
    }
    walls(builder, setting);
    let soft = scene.contacts.items.iter().any(|block| !block.laws.is_empty());
    if soft {
        builder.decide_one("laws of contact", false, "the driver is Event: the collision rules act");
    }
    let collisions = if setting.whole { collisions(builder, setting, &chosen) } else { Vec::new() };
    let contact_duration = contact_duration(builder, setting, block, &collisions);
    Some(EventPlan { contact_duration, collisions, slides })
}

/// What bodies on the substrate do between collisions, if there is one.
fn slides(builder: &mut Builder<'_>, setting: &Setting<'_>, block: &EventBlock) -> Option<Slides> {
    let scene = builder.scene;
    let Some(substrate) = &scene.substrate else {
        if let Some(slides) = &block.slides {
            builder.error_help(
                slides.span.clone(),
                "`slides` are those of bodies on a substrate, which the scene does not have",
                "leave `slides` out",
            );
        }
        return None;
    };
    if !substrate.confined {
        builder.error_help(
            substrate.span.clone(),
            "hard bodies never leave a substrate",
            "leave `confined: false` out, or choose `driver: TimeStep()`",
        );
    }
    if let Some(cell) = &scene.cell
        && cell.periodic.value.get(2) == Some(&true)
    {
        builder.error(cell.periodic.span.clone(), "a cell on a substrate cannot be periodic along z");
    }
    for (index, plan) in setting.walls.iter().enumerate() {
        let upright = matches!(plan.wall.surface(), Surface::Plane(plane) if plane.normal().z == 0.0);
        if !upright {
            let span =
                scene.walls.items.get(index).map_or(scene.walls.span.clone(), |wall| wall.span.clone());
            builder.error_help(
                span,
                format!(
                    "wall `{}` is not an upright plane, as hard bodies on a substrate need it",
                    plan.name
                ),
                "make it a plane whose normal lies along x and y, or choose `driver: TimeStep()`",
            );
        }
    }
    let smallest = setting.bodies.iter().fold(f64::INFINITY, |r: f64, body| r.min(body.radius));
    Some(match block.slides.as_ref().map(|slides| &slides.value) {
        Some(SlidesChoice::EffectiveRestitution) => {
            let why = "slides are over at once, with the effective restitution; bodies roll without friction";
            builder.decide_one("slides", false, why);
            Slides::EffectiveRestitution
        }
        Some(SlidesChoice::Arcs { error: Some(error) }) => {
            builder.decide_one("slides", true, format!("arcs, in pieces with an error of {error:e} m"));
            Slides::Arcs { error: *error }
        }
        Some(SlidesChoice::Arcs { error: None }) | None => {
            let error = if smallest.is_finite() { ARC_ERROR * smallest } else { ARC_ERROR };
            let why =
                format!("arcs, in pieces with an error of {error:e} m, {ARC_ERROR} of the smallest radius");
            builder.decide_one("slides", true, why);
            Slides::Arcs { error }
        }
    })
}

/// Refuses what arcs on a substrate cannot follow.
pub(crate) fn check_substrate(builder: &mut Builder<'_>, substrate: &SubstratePlan) {
    let scene = builder.scene;
    let (Some(block), Some(_)) = (&scene.substrate, &scene.event) else { return };
    if let Some(motion) = &block.motion
        && substrate.motion.rotation_at(0.0).is_some()
    {
        builder.error_help(
            motion.span.clone(),
            "arcs of hard bodies on a substrate that turns are not known",
            "it may be fixed, move with a constant velocity, oscillate, or follow a table; or choose `driver: TimeStep()`",
        );
    }
    for (name, law) in &block.laws {
        let index = scene.materials.items.iter().position(|item| item.name.value == name.value);
        let material = index.and_then(|index| substrate.materials.get(index)).and_then(Option::as_ref);
        if let Some(material) = material
            && material.stage.friction().is_none()
        {
            builder.error_help(
                law.name.span.clone(),
                format!("the arcs of hard bodies under {} are not known", material.law.info.name),
                "choose `driver: TimeStep()`",
            );
        }
    }
}

fn choose(builder: &mut Builder<'_>, law: &LawBlock) -> Option<(&'static CollisionEntry, Params)> {
    let entry = match builder.registry.collision(&law.name.value) {
        Ok(entry) => entry,
        Err(RegistryError::Unknown { name, known, .. }) => {
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            let help = suggestion("collision laws", &name, &known);
            builder.error_help(law.name.span.clone(), format!("there is no collision law `{name}`"), help);
            return None;
        }
        Err(error) => {
            builder.error(law.name.span.clone(), error.to_string());
            return None;
        }
    };
    let info = entry.info;
    let given = given_parameters(builder, law, info.name, info.parameters)?;
    match Params::new(info, &given) {
        Ok(params) => Some((entry, params)),
        Err(errors) => {
            for error in errors {
                law_error(builder, law, info.name, &error);
            }
            None
        }
    }
}

/// The rule, after one of somebody else was tried: one that gives no numbers or creates energy is an error before the run.
fn trusted(
    builder: &mut Builder<'_>,
    law: &LawBlock,
    entry: &CollisionEntry,
    rule: Box<dyn CollisionRule>,
) -> Arc<dyn CollisionRule> {
    if !entry.crate_name.starts_with(SHIPPED) {
        let tried = catch_unwind(AssertUnwindSafe(|| probe::try_collisions(&*rule, entry.info.dissipative)));
        if let Ok(Err(fault)) = tried {
            misbehaves(builder, law, entry.info.name, &fault);
        }
    }
    Arc::from(rule)
}

/// Refuses walls that flights are not known for.
fn walls(builder: &mut Builder<'_>, setting: &Setting<'_>) {
    for (index, plan) in setting.walls.iter().enumerate() {
        if plan.wall.keeps_its_place() || plan.wall.motion().rotation_at(0.0).is_none() {
            continue;
        }
        let scene = builder.scene;
        let span = scene.walls.items.get(index).map_or(scene.walls.span.clone(), |wall| wall.span.clone());
        builder.error_help(
            span,
            format!("wall `{}` turns out of its place, which the driver `Event` does not know", plan.name),
            "it knows walls that are fixed, move without turning, or turn in their own place",
        );
    }
}

fn collisions(builder: &mut Builder<'_>, setting: &Setting<'_>, chosen: &[Chosen<'_>]) -> Vec<CollisionPlan> {
    let mut collisions = Vec::new();
    let mut missing: Vec<(u16, u16)> = Vec::new();
    for Meeting { material, other, partner, example, .. } in meetings(setting) {
        let pair = (material.min(other), material.max(other));
        let [a, b] = [pair.0, pair.1].map(|index| setting.materials[usize::from(index)].name.clone());
        let found = chosen.iter().find(|chosen| chosen.pair == pair);
        match found.map(|chosen| (chosen.block, &chosen.law)) {
            Some((_, Some((entry, params, law)))) => match (entry.compile)(params) {
                Ok(rule) => collisions.push(CollisionPlan {
                    material,
                    partner,
                    law: entry,
                    params: params.clone(),
                    rule: trusted(builder, law, entry, rule),
                }),
                Err(error) => law_error(builder, law, entry.info.name, &error),
            },
            Some((block, None)) if block.laws.is_empty() => {
                let why = format!("{a} and {b} have no rule: they pass through each other ({example})");
                builder.decide_one("collision", false, why);
            }
            _ if missing.contains(&pair) || !builder.scene.contacts.complete => {}
            found => {
                missing.push(pair);
                let span = found.map_or(builder.scene.contacts.span.clone(), |(block, _)| block.span.clone());
                builder.error_help(
                    span,
                    format!("no collision rule between `{a}` and `{b}`, which can meet: {example}"),
                    format!("add `collision: HardSphere(restitution: ..)` to the contact between \"{a}\" and \"{b}\""),
                );
            }
        }
    }
    collisions
}

fn contact_duration(
    builder: &mut Builder<'_>,
    setting: &Setting<'_>,
    block: &EventBlock,
    collisions: &[CollisionPlan],
) -> f64 {
    let inelastic = collisions.iter().any(|collision| collision.rule.is_inelastic());
    let g = setting.gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    let hollow = |wall: &Wall| matches!(wall.surface(), Surface::Cylinder(cylinder) if cylinder.inside());
    let shaken = builder.scene.substrate.as_ref().is_some_and(|substrate| substrate.motion.is_some());
    let moving =
        shaken || setting.walls.iter().any(|wall| !wall.wall.keeps_its_place() || hollow(&wall.wall));
    let topic = "contact duration";
    if let Some(given) = &block.contact_duration {
        builder.decide_one(topic, true, format!("{:e} s, given by the scene", given.value));
        return given.value;
    }
    if !(inelastic || g > 0.0 || moving) {
        builder.decide_one(
            topic,
            false,
            "no collision loses energy along the normal, and nothing accelerates",
        );
        return 0.0;
    }
    let diameter = setting.bodies.iter().fold(f64::INFINITY, |d: f64, body| d.min(2.0 * body.radius));
    let (speed, _) = setting.impact_speed(builder);
    let crossing = diameter / speed;
    let falling = if g > 0.0 { (diameter / g).sqrt() } else { f64::INFINITY };
    let share = if builder.scene.substrate.is_some() { CONTACT_SHARE_ON_SUBSTRATE } else { CONTACT_SHARE };
    let duration = share * crossing.min(falling);
    if !(duration > 0.0 && duration.is_finite()) {
        if setting.whole && !setting.bodies.is_empty() {
            builder.error_help(
                block.span.clone(),
                "the contact duration cannot be chosen for these speeds and sizes",
                "give `contact_duration`",
            );
        }
        return 0.0;
    }
    let why = format!(
        "{duration:.3e} s, {share} of the time in which the smallest body moves by its diameter; sooner collisions \
         lose no energy along the normal"
    );
    builder.decide_one(topic, true, why);
    duration
}

/// Times at which the run can be looked at.
pub(crate) fn schedule(builder: &mut Builder<'_>, plan: &mut Plan, block: &EventBlock) -> Option<()> {
    let run = builder.scene.run.clone()?;
    let interval = shortest_interval(builder);
    let (step, why) = match (&block.step, interval, &run) {
        (Some(step), _, _) => (step.value, "given by the scene"),
        (None, Some(interval), _) => (interval, "the shortest interval of an output"),
        (None, None, RunBlock::Duration(duration)) => (duration.value / STEPS, "a hundredth of the duration"),
        (None, None, RunBlock::Steps(steps)) => {
            builder.error_help(
                steps.span.clone(),
                "hard bodies need no steps: how long is one?",
                "give `duration` instead, or `driver: Event(step: ..)`",
            );
            return None;
        }
    };
    let (steps, span) = match &run {
        RunBlock::Steps(steps) => (steps.value as f64, steps.span.clone()),
        RunBlock::Duration(duration) if duration.value == 0.0 => (0.0, duration.span.clone()),
        RunBlock::Duration(duration) => {
            let exact = duration.value / step;
            let (steps, fits) = whole(exact);
            if !fits {
                builder.warning(
                    duration.span.clone(),
                    format!("the duration is {exact:.3} steps of {step:e} s; the run takes {steps} steps"),
                    "choose a step that divides the duration",
                );
            }
            (steps, duration.span.clone())
        }
    };
    let step = if steps == 0.0 && step <= 0.0 { 1.0 } else { step };
    if !(steps <= MOST_STEPS && step > 0.0 && step.is_finite()) {
        builder.error(span, format!("{steps:e} steps are more than can be counted"));
        return None;
    }
    plan.driver.step = step;
    plan.driver.steps = steps as u64;
    let motion = if plan.substrate.is_some() { "move over the substrate" } else { "fly freely" };
    builder.decide_one(
        "event-driven",
        true,
        format!("bodies {motion} from collision to collision; looked at every {step:.6e} s, {why}"),
    );
    let largest = plan.bodies.radius.iter().fold(0.0, |a: f64, b| a.max(*b));
    if let Some(cell) = &builder.scene.cell
        && let Err(error) = plan.cell.check_minimum_length(largest, 0.04 * largest)
    {
        builder.error_help(cell.span.clone(), error.to_string(), "a larger cell");
    }
    Some(())
}
