//! The scene of each model.

use std::ops::Range;
use std::path::Path;

use granule_law_api::{Registry, SurfaceFriction};
use granule_plan::{Plan, limits};
use granule_scene::{
    ContactBlock, EventBlock, LawBlock, MaterialBlock, MotionChoice, ParameterValue, PrecisionChoice,
    RunBlock, Scene, Severity, SlidesChoice, Spanned, Vector, WallBlock, WallShape,
};

use super::Model;
use crate::hard;

/// Bodies sink into the plane by this share of the smallest radius.
const SINK: f64 = 1e-5;
/// Restitution at the plane, where the scene does not tell one.
const LANDING: f64 = 0.5;

/// A scene in one way, and what it does otherwise than the scene says.
pub(super) struct Way {
    pub scene: Scene,
    pub notes: Vec<String>,
}

/// What all ways share.
pub(super) struct Ways<'a> {
    pub scene: &'a Scene,
    pub registry: &'a Registry,
    pub folder: &'a Path,
    /// Simulated time \[s\].
    pub duration: f64,
    pub looks: u64,
}

impl Ways<'_> {
    /// The scene of a model, or why there is none.
    pub fn scene_of(&self, model: Model) -> Result<Way, String> {
        match model {
            Model::Contact => self.contact(),
            Model::Substrate => self.soft(),
            Model::Arcs => self.hard(SlidesChoice::Arcs { error: self.arc_error() }),
            Model::EffectiveRestitution => {
                let mut way = self.hard(SlidesChoice::EffectiveRestitution)?;
                way.notes.push("bodies roll without friction".to_string());
                Ok(way)
            }
        }
    }

    /// In time steps on the substrate.
    fn substrate(&self) -> Scene {
        let mut scene = self.scene.clone();
        scene.outputs.items.clear();
        scene.ledger = false;
        scene.accuracy = None;
        scene.precision = PrecisionChoice::Double;
        scene.run = Some(RunBlock::Duration(Spanned::new(self.duration, 0..0)));
        scene.event = None;
        scene
    }

    /// The same, with soft contacts where the scene has rules of collision alone.
    fn soft(&self) -> Result<Way, String> {
        let mut scene = self.substrate();
        let mut notes = Vec::new();
        let bare = scene.contacts.items.iter().any(|block| block.laws.is_empty());
        let (Some(event), true) = (&self.scene.event, bare) else { return Ok(Way { scene, notes }) };
        let duration = match &event.contact_duration {
            Some(duration) => duration.value,
            None => {
                let plan = self.plan(self.scene)?;
                plan.event.as_ref().map_or(0.0, |event| event.contact_duration)
            }
        };
        for block in scene.contacts.items.iter_mut().filter(|block| block.laws.is_empty()) {
            let (a, b) = (block.between.0.value.clone(), block.between.1.value.clone());
            let Some(rule) = block.collision.take().filter(|rule| rule.name.value == "HardSphere") else {
                return Err(format!("{a} and {b} have no `normal` law, and no collision of `HardSphere`"));
            };
            let span = block.span.clone();
            let given = |name: &str| rule.parameters.iter().find(|(known, _)| known.value == name).cloned();
            let mut normal = law("LinearSpringDashpot", &[("contact_duration", duration)], &span);
            normal.parameters.extend(given("restitution"));
            block.laws.push(("normal", normal));
            if let Some(friction) = given("friction") {
                let mut tangential = law("TangentialSpring", &[], &span);
                let restitution = given("tangential_restitution").unwrap_or((
                    Spanned::new("tangential_restitution".to_string(), span.clone()),
                    Spanned::new(ParameterValue::Number(0.0), span.clone()),
                ));
                tangential.parameters.extend([friction, restitution]);
                block.laws.push(("tangential", tangential));
            }
            notes.push(format!(
                "{a} and {b}: linear contacts of {duration:.2e} s that do what the collision does"
            ));
        }
        Ok(Way { scene, notes })
    }

    fn plan(&self, scene: &Scene) -> Result<Plan, String> {
        let (plan, diagnostics) = granule_plan::build(scene, self.registry, self.folder);
        plan.ok_or_else(|| {
            let errors = diagnostics.iter().filter(|problem| problem.severity == Severity::Error);
            errors.map(|problem| problem.message.clone()).collect::<Vec<_>>().join("; ")
        })
    }

    /// In time steps with soft contacts between the bodies and a plane wall.
    fn contact(&self) -> Result<Way, String> {
        let Way { mut scene, mut notes } = self.soft()?;
        let plan = self.plan(&scene)?;
        let (Some(block), Some(substrate)) = (scene.substrate.take(), &plan.substrate) else {
            return Err("there is no substrate".to_string());
        };
        let weight = -plan.gravity[2];
        if weight <= 0.0 {
            return Err("nothing presses bodies onto the plane".to_string());
        }
        let span = block.span.clone();
        let smallest = plan.bodies.radius.iter().fold(f64::INFINITY, |r: f64, radius| r.min(*radius));
        let restitution = block.restitution.as_ref().map_or(LANDING, |restitution| restitution.value);
        let restitution = restitution.max(0.01);
        // Under its weight a body sinks in by g/ω0² = g t²/(π² + ln² e): so far that contacts of other bodies are not longer.
        let turns = std::f64::consts::PI.powi(2) + restitution.ln().powi(2);
        let shortest = limits(&plan).shortest_contact.unwrap_or(0.0);
        let duration = (SINK * smallest * turns / weight).sqrt().max(shortest);
        let sunk = weight * duration * duration / turns;
        let mut plate = "plate".to_string();
        while scene.materials.items.iter().any(|item| item.name.value == plate)
            || scene.walls.items.iter().any(|item| item.name.value == plate)
        {
            plate.push('_');
        }
        notes.push(format!("contacts with the plane last {duration:.2e} s"));
        let names: Vec<String> = scene.materials.items.iter().map(|item| item.name.value.clone()).collect();
        for (material, name) in substrate.materials.iter().zip(&names) {
            let Some(material) = material else { continue };
            let friction = material
                .stage
                .friction()
                .ok_or_else(|| format!("{} is not the friction of a contact", material.law.info.name))?;
            if friction.kinetic_friction == f64::INFINITY {
                notes.push(format!("{name}: never slips"));
            }
            notes.extend(missing(name, friction));
            let spring = [("stiffness_ratio", 2.0 / 7.0), ("friction", friction.kinetic_friction)];
            let dashpot = [("restitution", restitution), ("contact_duration", duration)];
            scene.contacts.items.push(ContactBlock {
                between: (
                    Spanned::new(name.clone(), span.clone()),
                    Spanned::new(plate.clone(), span.clone()),
                ),
                laws: vec![
                    ("normal", law("LinearSpringDashpot", &dashpot, &span)),
                    ("tangential", law("TangentialSpring", &spring, &span)),
                ],
                collision: None,
                contact_end: None,
                span: span.clone(),
            });
        }
        scene
            .materials
            .items
            .push(MaterialBlock { name: Spanned::new(plate.clone(), span.clone()), density: None });
        let vector = |v: [f64; 3]| Vector {
            components: v.iter().map(|c| Spanned::new(*c, span.clone())).collect(),
            span: span.clone(),
        };
        // Bodies start where they rest.
        let point = vector([0.0, 0.0, substrate.height + sunk]);
        scene.walls.items.push(WallBlock {
            name: Spanned::new(plate.clone(), span.clone()),
            material: Spanned::new(plate, span.clone()),
            shape: WallShape::Plane { point, normal: vector([0.0, 0.0, 1.0]) },
            motion: block.motion.clone().unwrap_or(Spanned::new(MotionChoice::Static, span.clone())),
            span: span.clone(),
        });
        scene.gravity = Some(vector(plan.gravity));
        scene.allow_overlap = true;
        Ok(Way { scene, notes })
    }

    /// From collision to collision.
    fn hard(&self, slides: SlidesChoice) -> Result<Way, String> {
        let mut scene = self.substrate();
        let mut notes = Vec::new();
        let span = self.scene.driver.step.span.clone();
        let given = self.scene.event.as_ref();
        let mut contact_duration = given.and_then(|event| event.contact_duration.clone());
        if given.is_none() && scene.contacts.items.iter().any(|block| block.collision.is_none()) {
            let soft = scene.clone();
            hard::harden(&mut scene, self.registry, self.folder, self.duration)?;
            for (block, before) in scene.contacts.items.iter().zip(&soft.contacts.items) {
                if let (Some(rule), None) = (&block.collision, &before.collision) {
                    let (a, b) = &block.between;
                    let values = rule.parameters.iter().map(|(name, value)| match &value.value {
                        ParameterValue::Number(value) => format!("{} {value:.4}", name.value),
                        ParameterValue::Text(text) => format!("{} {text}", name.value),
                    });
                    let values: Vec<String> = values.collect();
                    notes.push(format!("{} and {}: {}", a.value, b.value, values.join(", ")));
                }
            }
            contact_duration = scene.event.as_ref().and_then(|event| event.contact_duration.clone());
        }
        if let Some(substrate) = &mut scene.substrate
            && !substrate.confined
        {
            (substrate.confined, substrate.restitution) = (true, None);
            notes.push("bodies never leave the substrate".to_string());
        }
        scene.event = Some(EventBlock {
            step: Some(Spanned::new(self.duration / self.looks as f64, span.clone())),
            contact_duration,
            slides: Some(Spanned::new(slides, span.clone())),
            span,
        });
        Ok(Way { scene, notes })
    }

    fn arc_error(&self) -> Option<f64> {
        let slides = self.scene.event.as_ref().and_then(|event| event.slides.as_ref());
        match slides.map(|slides| &slides.value) {
            Some(SlidesChoice::Arcs { error }) => *error,
            _ => None,
        }
    }
}

/// What contacts with a plane do not have.
fn missing(name: &str, friction: &SurfaceFriction) -> Vec<String> {
    let mut notes = Vec::new();
    if friction.static_friction != friction.kinetic_friction {
        notes.push(format!("{name}: static friction is the kinetic one"));
    }
    if friction.rolling.iter().any(|(_, friction)| *friction > 0.0) {
        notes.push(format!("{name}: no rolling friction"));
    }
    if friction.drilling > 0.0 {
        notes.push(format!("{name}: no friction about the normal"));
    }
    notes
}

fn law(name: &str, parameters: &[(&str, f64)], span: &Range<usize>) -> LawBlock {
    let spanned = |name: &str| Spanned::new(name.to_string(), span.clone());
    LawBlock {
        name: spanned(name),
        parameters: parameters
            .iter()
            .map(|(name, value)| (spanned(name), Spanned::new(ParameterValue::Number(*value), span.clone())))
            .collect(),
        span: span.clone(),
    }
}
