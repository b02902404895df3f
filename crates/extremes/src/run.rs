//! From the text of a scene to what became of it.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use granule_drivers::{Driver, View, driver};
use granule_law_api::{Registry, RegistryError};
use granule_plan::Plan;
use granule_scene::Severity;

/// State of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Centre \[m\].
    pub position: [f64; 3],
    /// Velocity \[m/s\].
    pub velocity: [f64; 3],
    /// Spin \[rad/s\].
    pub spin: [f64; 3],
    /// Force \[N\].
    pub force: [f64; 3],
}

impl Body {
    /// Speed \[m/s\].
    pub fn speed(&self) -> f64 {
        self.velocity.iter().map(|v| v * v).sum::<f64>().sqrt()
    }
}

/// What is done at each step of a run; an error ends it.
pub(crate) type Look<'a> = &'a mut dyn FnMut(&View<'_>, &[Body]) -> Result<(), String>;

/// A planned scene and the warnings that it gave.
pub(crate) struct Planned {
    pub plan: Arc<Plan>,
    pub warnings: Vec<String>,
}

/// The laws with which scenes are planned.
pub struct Lab {
    registry: Registry,
}

impl Lab {
    /// With all laws that the program links.
    ///
    /// # Errors
    /// The laws do not fit together.
    pub fn new() -> Result<Self, RegistryError> {
        Ok(Self { registry: Registry::collect()? })
    }

    /// Plans a scene.
    ///
    /// # Errors
    /// All errors of the scene.
    pub(crate) fn plan(&self, text: &str) -> Result<Planned, String> {
        let parsed = granule_scene::parse(text);
        let mut diagnostics = parsed.diagnostics;
        let plan = parsed.scene.and_then(|scene| {
            let (plan, problems) = granule_plan::build(&scene, &self.registry, Path::new("."));
            diagnostics.extend(problems);
            plan
        });
        let of = |severity: Severity| -> Vec<String> {
            let chosen = diagnostics.iter().filter(|problem| problem.severity == severity);
            chosen.map(|problem| problem.message.clone()).collect()
        };
        match plan {
            Some(plan) => Ok(Planned { plan: Arc::new(plan), warnings: of(Severity::Warning) }),
            None => Err(of(Severity::Error).join("; ")),
        }
    }

    /// Bodies at the end of a scene's run, in the order of their identities.
    ///
    /// # Errors
    /// The scene is refused, or its run stops.
    pub(crate) fn run(&self, text: &str) -> Result<Vec<Body>, String> {
        let Planned { plan, .. } = self.plan(text)?;
        end(&plan)
    }

    /// Runs a scene and looks at every step, that of the start included.
    ///
    /// # Errors
    /// The scene is refused, its run stops, or `look` is not content.
    pub(crate) fn watch(&self, text: &str, look: Look<'_>) -> Result<Vec<Body>, String> {
        let Planned { plan, .. } = self.plan(text)?;
        let steps = plan.driver.steps;
        let mut driver = start(&plan)?;
        for step in 0..=steps {
            advance(&mut *driver, step)?;
            let view = driver.view();
            look(&view, &bodies(&view))?;
        }
        Ok(bodies(&driver.view()))
    }

    /// The errors of a scene that must be refused before its first step.
    ///
    /// # Errors
    /// It is not refused, or with other words.
    pub(crate) fn refusal(&self, text: &str, word: &str) -> Result<String, String> {
        match self.plan(text) {
            Ok(_) => Err(format!("it is not refused, though it must be for `{word}`")),
            Err(errors) if errors.contains(word) => Ok(errors),
            Err(errors) => Err(format!("refused, but not for `{word}`: {errors}")),
        }
    }

    /// The warning that has this word.
    ///
    /// # Errors
    /// The scene is refused, or does not warn so.
    pub(crate) fn warning(&self, text: &str, word: &str) -> Result<String, String> {
        let warnings = self.plan(text)?.warnings;
        let found = warnings.iter().find(|warning| warning.contains(word));
        found.cloned().ok_or_else(|| format!("no warning of `{word}` in {warnings:?}"))
    }
}

/// A driver at the start of a plan, on one thread.
pub(crate) fn start(plan: &Arc<Plan>) -> Result<Box<dyn Driver>, String> {
    driver(Arc::clone(plan), Some(1)).map_err(|error| error.to_string())
}

/// Advances to a step.
pub(crate) fn advance(driver: &mut dyn Driver, step: u64) -> Result<(), String> {
    driver.advance(step, &AtomicBool::new(false)).map(|_| ()).map_err(|error| error.to_string())
}

/// Runs a plan to its end.
pub(crate) fn end(plan: &Arc<Plan>) -> Result<Vec<Body>, String> {
    let mut driver = start(plan)?;
    advance(&mut *driver, plan.driver.steps)?;
    Ok(bodies(&driver.view()))
}

/// All bodies, in the order of their identities.
pub(crate) fn bodies(view: &View<'_>) -> Vec<Body> {
    let rows = view.bodies();
    let state = |place: usize| Body {
        position: rows.position[place].vector(),
        velocity: rows.velocity_of(place),
        spin: rows.spin_of(place),
        force: rows.force_of(place),
    };
    view.order().iter().map(|&place| state(place as usize)).collect()
}

/// An error unless the condition holds.
pub(crate) fn ensure(condition: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if condition { Ok(()) } else { Err(what()) }
}
