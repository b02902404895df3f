//! Runs of the engine for figures: from the text of a scene to what bodies do.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use granule_drivers::{Driver, TimeStepDriver};
use granule_law_api::Registry;
use granule_laws as _;
use granule_plan::Plan;

use crate::Error;

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

/// Plans a scene.
///
/// # Errors
/// The scene has errors; all are in the message.
pub fn plan(text: &str) -> Result<Arc<Plan>, Error> {
    owned_plan(text).map(Arc::new)
}

/// Plans a scene whose plan is then changed.
///
/// # Errors
/// As for [`plan`].
pub fn owned_plan(text: &str) -> Result<Plan, Error> {
    let parsed = granule_scene::parse(text);
    let registry = Registry::collect()?;
    let mut diagnostics = parsed.diagnostics;
    let plan = parsed.scene.and_then(|scene| {
        let (plan, problems) = granule_plan::build(&scene, &registry, Path::new("."));
        diagnostics.extend(problems);
        plan
    });
    let problems = || diagnostics.iter().map(|problem| problem.render("scene", text)).collect::<String>();
    plan.ok_or_else(|| problems().into())
}

/// A run on one thread.
pub struct Run {
    driver: TimeStepDriver,
}

impl Run {
    /// At the start of a scene.
    ///
    /// # Errors
    /// As for [`plan`], or the engine cannot be set up.
    pub fn new(text: &str) -> Result<Self, Error> {
        Self::of(plan(text)?)
    }

    /// At the start of a plan.
    ///
    /// # Errors
    /// The engine cannot be set up.
    pub fn of(plan: Arc<Plan>) -> Result<Self, Error> {
        Ok(Self { driver: TimeStepDriver::new(plan, Some(1))? })
    }

    /// Number of steps of the whole run.
    pub fn steps(&self) -> u64 {
        self.driver.engine().plan().driver.steps
    }

    /// Time now \[s\].
    pub fn time(&self) -> f64 {
        self.driver.time()
    }

    /// Number of contacts between bodies now.
    pub fn contacts(&self) -> u64 {
        self.driver.engine().tally().contacts
    }

    /// Advances to a step.
    ///
    /// # Errors
    /// A number is no longer finite.
    pub fn advance(&mut self, step: u64) -> Result<(), Error> {
        self.driver.advance(step, &AtomicBool::new(false))?;
        Ok(())
    }

    /// Advances to the end.
    ///
    /// # Errors
    /// As for [`advance`](Self::advance).
    pub fn finish(mut self) -> Result<Vec<Body>, Error> {
        self.advance(self.steps())?;
        Ok(self.bodies())
    }

    /// All bodies, in the order of their identities.
    pub fn bodies(&self) -> Vec<Body> {
        let view = self.driver.view();
        let rows = view.bodies();
        let state = |rank: usize| {
            let place = view.order()[rank] as usize;
            Body {
                position: rows.position[place].vector(),
                velocity: rows.velocity_of(place),
                spin: rows.spin_of(place),
                force: rows.force_of(place),
            }
        };
        (0..rows.len()).map(state).collect()
    }
}
