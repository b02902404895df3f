//! The hard driver: from collision to collision.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use granule_engine::{EngineError, SubstrateTally, Tally, Work};
use granule_events::{
    BodyInput, BodyState, Counts, EventEngine, EventError, EventState, RuleFault, Setup, WallInput,
};
use granule_plan::{Dimensions, Partner, Plan};
use granule_state::{Bodies, Layout};

use crate::view::Snapshot;
use crate::{Advance, Driver, DriverState, Moment, Timings, View};

/// Events between two looks at the stop flag: some milliseconds.
const STRIDE: u64 = 10_000;

/// Advances an [`EventEngine`]. Its steps are the times at which the run can be looked at.
pub struct EventDriver {
    engine: EventEngine,
    plan: Arc<Plan>,
    step: u64,
    time: f64,
    spent: Duration,
}

impl EventDriver {
    /// Sets up the bodies of a plan.
    ///
    /// # Errors
    /// [`EngineError::Events`]: bodies overlap, or the plan is for the other driver.
    pub fn new(plan: Arc<Plan>) -> Result<Self, EngineError> {
        let engine = EventEngine::new(&setup(&plan)?).map_err(refused)?;
        Ok(Self { engine, plan, step: 0, time: 0.0, spent: Duration::ZERO })
    }

    /// Goes on from a saved state.
    ///
    /// # Errors
    /// The state does not fit the plan.
    pub fn restore(plan: Arc<Plan>, at: Moment, state: EventState<'_>) -> Result<Self, EngineError> {
        at.check(&plan)?;
        let engine = EventEngine::restore(&setup(&plan)?, state).map_err(refused)?;
        Ok(Self { engine, plan, step: at.step, time: at.time, spent: Duration::ZERO })
    }

    /// The engine, for tests and benchmarks.
    pub fn engine(&self) -> &EventEngine {
        &self.engine
    }

    /// Collisions since the start.
    pub fn counts(&self) -> &Counts {
        self.engine.counts()
    }

    fn snapshot(&self) -> Snapshot {
        let plan = &self.plan;
        let states = self.engine.states(self.time);
        let bodies = bodies(plan, &states);
        let counts = *self.engine.counts();
        let work = work(plan, &counts);
        let tally = Tally { wall_force: vec![[0.0; 3]; plan.walls.len()], ..Tally::default() };
        Snapshot { bodies, tally, work, substrate: SubstrateTally::default(), counts }
    }
}

impl Driver for EventDriver {
    fn step(&self) -> u64 {
        self.step
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn advance(&mut self, until: u64, stop: &AtomicBool) -> Result<Advance, EngineError> {
        let begin = Instant::now();
        let result = loop {
            if self.step >= until {
                break Ok(Advance::Reached);
            }
            if stop.load(Ordering::Relaxed) {
                break Ok(Advance::Stopped);
            }
            let target = (self.step + 1) as f64 * self.plan.driver.step;
            match self.engine.advance(target, STRIDE) {
                Ok(true) => (self.step, self.time) = (self.step + 1, target),
                Ok(false) => self.time = self.engine.time(),
                Err(error) => {
                    self.time = self.engine.time();
                    break Err(failed(&self.plan, self.step, error));
                }
            }
        };
        self.spent += begin.elapsed();
        result
    }

    fn view(&self) -> View<'_> {
        View::of_events(&self.plan, self.step, self.time, self.snapshot())
    }

    fn save(&self) -> DriverState<'_> {
        DriverState::Events(Moment { step: self.step, time: self.time }, self.engine.save())
    }

    fn timings(&self) -> Timings {
        Timings { forces: self.spent, ..Timings::default() }
    }

    fn threads(&self) -> usize {
        1
    }
}

/// Rows of hard bodies.
pub(crate) fn bodies(plan: &Plan, states: &[BodyState]) -> Bodies {
    let layout = Layout {
        planar: plan.dimensions == Dimensions::Two,
        rotation: plan.rotation,
        previous_acceleration: false,
        predicted_acceleration: false,
        surface: false,
    };
    let table = &plan.bodies;
    // Both are in the order of the identities.
    let inputs = states.iter().enumerate().map(|(k, state)| granule_state::BodyInput {
        id: state.id,
        material: table.material[k],
        radius: table.radius[k],
        mass: table.mass[k],
        inertia_factor: table.inertia_factor[k],
        position: state.position,
        velocity: state.velocity,
        spin: state.spin,
        frozen: table.frozen[k],
    });
    let mut bodies = Bodies::new(layout, inputs);
    bodies.image = states.iter().map(|state| state.image).collect();
    bodies
}

/// What collisions did to the energy; nothing without the ledger.
pub(crate) fn work(plan: &Plan, counts: &Counts) -> Work {
    let mut work = Work::default();
    if plan.ledger {
        // The slots of normal and tangential laws.
        work.viscous[0] = counts.lost_normal;
        work.friction[2] = counts.lost_tangential;
        work.walls = counts.wall_work;
    }
    work
}

/// The error of a start.
pub(crate) fn refused(error: EventError) -> EngineError {
    EngineError::Events(error.to_string())
}

/// The error of a run, at a step.
pub(crate) fn failed(plan: &Plan, step: u64, error: EventError) -> EngineError {
    let reason = error.to_string();
    match error {
        EventError::Stalled { id, .. } | EventError::NotFinite { id, .. } => {
            EngineError::Crushed { id, reason }
        }
        EventError::Rule { rule, fault, seen, id, other, time } => {
            let law = plan.event.as_ref().map_or("", |event| event.collisions[rule].law.info.name);
            match fault {
                RuleFault::Panicked(message) => {
                    let among = [id].into_iter().chain(other.ok()).collect();
                    EngineError::LawPanicked { law, message, among, step, time }
                }
                RuleFault::NotFinite => {
                    let other = match other {
                        Ok(id) => format!("body {id}"),
                        Err(wall) => format!("wall {}", plan.walls[wall].name),
                    };
                    let [x, y, z] = seen.tangential_velocity;
                    let slip = x.hypot(y).hypot(z);
                    let contact =
                        format!("approaching at {:e} m/s, slipping at {slip:e} m/s", seen.normal_speed);
                    let between = format!("body {id} and {other}");
                    EngineError::LawNotFinite { law, quantity: "impulse", between, contact, step, time }
                }
            }
        }
        _ => EngineError::Events(reason),
    }
}

/// What the engine needs of a plan.
pub(crate) fn setup(plan: &Plan) -> Result<Setup, EngineError> {
    let Some(event) = &plan.event else {
        return Err(EngineError::Events("this plan is for the time-stepped driver".to_string()));
    };
    let materials = plan.materials.len();
    let mut pairs = vec![None; materials * materials];
    let mut walls: Vec<WallInput> = plan
        .walls
        .iter()
        .map(|wall| WallInput { wall: wall.wall.clone(), rules: vec![None; materials] })
        .collect();
    let mut rules = Vec::with_capacity(event.collisions.len());
    for (index, collision) in event.collisions.iter().enumerate() {
        rules.push(Arc::clone(&collision.rule));
        let material = usize::from(collision.material);
        match collision.partner {
            Partner::Body(other) => {
                pairs[material * materials + usize::from(other)] = Some(index);
                pairs[usize::from(other) * materials + material] = Some(index);
            }
            Partner::Wall(wall) => walls[usize::from(wall)].rules[material] = Some(index),
        }
    }
    let table = &plan.bodies;
    let bodies = (0..table.len())
        .map(|k| BodyInput {
            id: table.id[k],
            material: table.material[k],
            radius: table.radius[k],
            mass: table.mass[k],
            inertia_factor: table.inertia_factor[k],
            position: table.position[k],
            velocity: table.velocity[k],
            spin: table.spin[k],
            frozen: table.frozen[k],
        })
        .collect();
    Ok(Setup {
        bodies,
        walls,
        rules,
        pairs,
        materials,
        cell: plan.cell,
        gravity: plan.gravity,
        contact_duration: event.contact_duration,
    })
}
