//! The same scene with hard bodies: collision rules that do what the laws of contact do.

use std::path::Path;

use granule_law_api::{Registry, Slot};
use granule_plan::{Composition, Partner, Plan, limits};
use granule_scene::{
    Diagnostic, EventBlock, IntegratorChoice, LawBlock, ParameterValue, PrecisionChoice, Scene, Severity,
    Spanned, StepChoice, remove_field, replace_all, set_field,
};

use crate::single::{ends, restitutions, sizes};

/// Steps in the shortest contact of the impacts that are measured: the scheme of second order errs by less than 1e-3.
const STEPS: f64 = 1000.0;
/// Restitutions of one pair of materials that differ by more than this, by mass or shape, are not one collision rule.
const SAME: f64 = 0.01;
/// Looks at a run of hard bodies.
const LOOKS: f64 = 1000.0;

/// What a pair of materials does in a collision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rule {
    pub restitution: f64,
    /// Friction and tangential restitution, where the surfaces are rough.
    pub surface: Option<(f64, f64)>,
}

impl Rule {
    /// As in scenes.
    pub fn text(&self) -> String {
        match self.surface {
            None => format!("HardSphere(restitution: {:?})", self.restitution),
            Some((friction, tangential)) => format!(
                "HardSphere(restitution: {:?}, friction: {}, tangential_restitution: {tangential:?})",
                self.restitution,
                if friction.is_finite() { format!("{friction:?}") } else { "inf".into() },
            ),
        }
    }

    fn law(&self, span: std::ops::Range<usize>) -> LawBlock {
        let mut parameters = vec![("restitution", self.restitution)];
        if let Some((friction, tangential)) = self.surface {
            parameters.extend([("friction", friction), ("tangential_restitution", tangential)]);
        }
        let spanned = |name: &str| Spanned::new(name.to_string(), span.clone());
        LawBlock {
            name: spanned("HardSphere"),
            parameters: parameters
                .into_iter()
                .map(|(name, value)| {
                    (spanned(name), Spanned::new(ParameterValue::Number(value), span.clone()))
                })
                .collect(),
            span,
        }
    }
}

/// Rules of all contact blocks of a scene, and the duration of its shortest contact \[s\].
pub(crate) struct Rules {
    /// `None` for a block whose materials never meet, or that has a rule already.
    pub of_blocks: Vec<Option<Rule>>,
    pub contact_duration: f64,
}

/// Measures the rules of a scene whose driver is the time-stepped one.
pub(crate) fn rules(scene: &Scene, registry: &Registry, folder: &Path) -> Result<Rules, String> {
    let mut scene = scene.clone();
    let span = scene.driver.step.span.clone();
    scene.accuracy = None;
    scene.precision = PrecisionChoice::Double;
    scene.driver.integrator = Some(Spanned::new(IntegratorChoice::VelocityVerlet, span.clone()));
    scene.driver.step = Spanned::new(StepChoice::Auto { steps_per_contact: STEPS }, span);
    let (plan, problems) = granule_plan::build(&scene, registry, folder);
    let plan = plan.ok_or_else(|| {
        let errors = problems.iter().filter(|problem| problem.severity == Severity::Error);
        errors.map(|problem| problem.message.clone()).collect::<Vec<_>>().join("; ")
    })?;
    let contact_duration = limits(&plan).shortest_contact.ok_or("no law of it has a contact duration")?;
    let index = |name: &str| scene.materials.items.iter().position(|item| item.name.value == name);
    let of_blocks = scene
        .contacts
        .items
        .iter()
        .map(|block| {
            if block.collision.is_some() {
                return Ok(None);
            }
            let pair = (index(&block.between.0.value), index(&block.between.1.value));
            let (Some(a), Some(b)) = pair else { return Ok(None) };
            rule(&plan, (a.min(b), a.max(b)), contact_duration / STEPS)
        })
        .collect::<Result<_, String>>()?;
    Ok(Rules { of_blocks, contact_duration })
}

fn rule(plan: &Plan, pair: (usize, usize), step: f64) -> Result<Option<Rule>, String> {
    let mut found: Option<Rule> = None;
    for (at, composition) in plan.compositions.iter().enumerate() {
        let normal = composition.stages.iter().any(|stage| stage.slot == Slot::Normal);
        if !normal || materials(plan, composition) != pair {
            continue;
        }
        if composition.stages.iter().any(|stage| !matches!(stage.slot, Slot::Normal | Slot::Tangential)) {
            return Err("cohesion, rolling and torsion have no rule of hard bodies".into());
        }
        let friction = composition.stages.iter().find(|stage| stage.slot == Slot::Tangential).map(|stage| {
            let value =
                stage.params.values().iter().find(|(name, _)| ["friction", "shear_friction"].contains(name));
            value.map_or(f64::INFINITY, |(_, value)| *value)
        });
        for size in sizes(&composition.context) {
            for q in ends(composition.context.inertia_factor) {
                let measured = restitutions(plan, at, size, q, step)?;
                let rule = Rule {
                    restitution: measured.normal.max(0.0).min(1.0),
                    surface: friction.map(|friction| (friction, measured.tangential.max(-1.0).min(1.0))),
                };
                match found {
                    None => found = Some(rule),
                    Some(other) if near(&other, &rule) => {}
                    Some(_) => {
                        return Err("restitution differs with the masses or shapes that meet".into());
                    }
                }
            }
        }
    }
    Ok(found)
}

fn near(a: &Rule, b: &Rule) -> bool {
    let tangential = |rule: &Rule| rule.surface.map_or(0.0, |(_, tangential)| tangential);
    (a.restitution - b.restitution).abs() <= SAME && (tangential(a) - tangential(b)).abs() <= SAME
}

fn materials(plan: &Plan, composition: &Composition) -> (usize, usize) {
    let one = usize::from(composition.material);
    let other = usize::from(match composition.partner {
        Partner::Body(material) => material,
        Partner::Wall(wall) => plan.walls[usize::from(wall)].material,
    });
    (one.min(other), one.max(other))
}

/// The text of a scene with the collision rules and the event-driven driver written into it.
pub(crate) fn write(
    text: &str,
    scene: &Scene,
    registry: &Registry,
    folder: &Path,
) -> Result<String, Vec<Diagnostic>> {
    let one = |problem| vec![problem];
    let rules = rules(scene, registry, folder)
        .map_err(|reason| vec![Diagnostic::error(scene.contacts.span.clone(), reason)])?;
    let blocks = scene.contacts.items.iter().zip(&rules.of_blocks);
    let changes = blocks
        .filter_map(|(block, rule)| {
            let at = block.span.start + 1;
            Some((at..at, format!("collision: {}, ", rule.as_ref()?.text())))
        })
        .collect();
    let mut text = replace_all(text, changes);
    if scene.precision == PrecisionChoice::Single {
        text = remove_field(&text, "precision").map_err(one)?;
    }
    text = remove_field(&text, "ledger").map_err(one)?;
    let driver = format!("Event(contact_duration: {:e})", rules.contact_duration);
    set_field(&text, None, "driver", &driver).map_err(one)
}

/// Makes the bodies of a scene hard.
pub(crate) fn harden(
    scene: &mut Scene,
    registry: &Registry,
    folder: &Path,
    duration: f64,
) -> Result<(), String> {
    let rules = rules(scene, registry, folder)?;
    for (block, rule) in scene.contacts.items.iter_mut().zip(&rules.of_blocks) {
        if let Some(rule) = rule {
            block.collision = Some(rule.law(block.span.clone()));
        }
    }
    let span = scene.driver.step.span.clone();
    scene.precision = PrecisionChoice::Double;
    scene.ledger = false;
    scene.event = Some(EventBlock {
        step: Some(Spanned::new(duration / LOOKS, span.clone())),
        contact_duration: Some(Spanned::new(rules.contact_duration, span.clone())),
        slides: None,
        span,
    });
    Ok(())
}
