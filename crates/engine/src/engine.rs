//! The engine: steps a plan's bodies forward.

use std::borrow::Cow;
use std::sync::Arc;

use granule_integrators::{Integrator, Pass, integrator};
use granule_plan::{Dimensions, Plan, Scheme};
use granule_state::{Bodies, BodyInput, InstructionSet, Layout};
use nalgebra::Vector3;

use crate::blame;
use crate::error::EngineError;
use crate::guards::Watch;
use crate::level::Level;
use crate::lists::Lists;
use crate::resolve::StepRows;
use crate::saved::EngineState;
use crate::slices::{Rows, sweep, visit};
use crate::substrate::{self, SubstrateTally};
use crate::tally::{ContactForce, ContactPartner, ContactRecord, Tally, Work};
use crate::tile::{Evaluation, shared, tile_size};
use crate::walls::MovedWall;

/// What the engine is about to do: for timing by whoever drives it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Candidate lists.
    Lists,
    /// Contacts, laws and forces.
    Forces,
    /// Time integration.
    Integration,
}

/// Which part of the integration a sweep over the bodies does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sweep {
    /// Only adds the forces of other tiles.
    Receive,
    Begin,
    Finish,
    FinishBegin,
}

/// Bodies in motion under a plan.
pub struct Engine {
    plan: Arc<Plan>,
    bodies: Bodies,
    integrator: Box<dyn Integrator>,
    level: Level,
    lists: Lists,
    pool: Option<Arc<rayon::ThreadPool>>,
    step: u64,
    /// Number of the next force evaluation; starts at 2 so that no stamp of a fresh list looks recent.
    evaluation: u32,
    /// Time at which forces were evaluated last \[s\].
    force_time: f64,
    /// Bound of what any distance has changed since the last force evaluation \[m\].
    moved: f64,
    /// The radius of all bodies, if they have the same bits.
    radius: Option<f64>,
    /// Walls at the time of the last force evaluation.
    walls: Vec<MovedWall>,
    tally: Tally,
    work: Work,
    substrate: SubstrateTally,
    pub(crate) watch: Watch,
}

impl Engine {
    /// Sets the bodies of the plan up and evaluates the forces on them. `threads` is the number of worker threads; the
    /// results do not depend on it.
    ///
    /// # Errors
    /// See [`EngineError`].
    pub fn new(plan: Arc<Plan>, threads: usize) -> Result<Self, EngineError> {
        Self::with_instructions(plan, threads, InstructionSet::detect())
    }

    /// The same with the loops that are compiled for `instructions`: the results are the same bits with all of them.
    ///
    /// # Errors
    /// See [`EngineError`].
    pub fn with_instructions(
        plan: Arc<Plan>,
        threads: usize,
        instructions: InstructionSet,
    ) -> Result<Self, EngineError> {
        let mut engine = Self::before_forces(plan, threads, instructions)?;
        engine.check_finite(0.0)?;
        engine.update_lists(0.0)?;
        blame::caught(|| engine.evaluate(0.0, 0.0, true)).map_err(|blame| engine.blamed(*blame))?;
        engine.sweep(Sweep::Receive);
        if engine.plan.substrate.is_some() {
            engine.settle(0.0);
        }
        engine.bodies.remember_accelerations();
        engine.check_finite(f64::NAN)?;
        Ok(engine)
    }

    /// Goes on from a saved state, as if there had been no pause: the bits are those of the engine that was saved. The plan
    /// must be the one that the state was saved under; the number of threads is free.
    ///
    /// # Errors
    /// [`EngineError::Saved`]: the state does not fit the plan.
    pub fn restore(plan: Arc<Plan>, threads: usize, state: EngineState<'_>) -> Result<Self, EngineError> {
        let mut engine = Self::before_forces(plan, threads, InstructionSet::detect())?;
        crate::saved::check_bodies(&engine.bodies, &state.bodies)?;
        state.check(&engine.plan)?;
        let last = state.evaluation.wrapping_sub(1);
        engine.lists.restore(&engine.plan, engine.bodies.len(), &state.lists, last)?;
        engine.bodies = state.bodies.into_owned();
        engine.step = state.step;
        engine.evaluation = state.evaluation;
        engine.force_time = state.force_time;
        engine.moved = state.moved;
        engine.tally = state.tally;
        engine.work = state.work;
        engine.substrate = state.substrate;
        move_walls(&mut engine.walls, &engine.plan, engine.force_time);
        Ok(engine)
    }

    /// The state after the last step, for [`restore`](Self::restore).
    pub fn save(&self) -> EngineState<'_> {
        EngineState {
            bodies: Cow::Borrowed(&self.bodies),
            lists: self.lists.save(self.evaluation.wrapping_sub(1)),
            step: self.step,
            evaluation: self.evaluation,
            force_time: self.force_time,
            moved: self.moved,
            tally: self.tally.clone(),
            work: self.work.clone(),
            substrate: self.substrate,
        }
    }

    /// Bodies at the start, without lists and forces.
    fn before_forces(
        plan: Arc<Plan>,
        threads: usize,
        instructions: InstructionSet,
    ) -> Result<Self, EngineError> {
        let integrator = scheme(plan.driver.scheme);
        let planar = plan.dimensions == Dimensions::Two;
        let layout = Layout {
            planar,
            rotation: plan.rotation,
            previous_acceleration: integrator.needs_previous(),
            predicted_acceleration: integrator.needs_predicted(),
            surface: plan.substrate.is_some(),
        };
        let bodies = Bodies::new(layout, inputs(&plan));
        let first = bodies.position.first().map(|row| row[3]);
        let radius = first.filter(|radius| bodies.position.iter().all(|row| row[3] == *radius));
        let size = tile_size(bodies.len());
        let threads = threads.clamp(1, bodies.len().div_ceil(size).max(1));
        let pool = if threads > 1 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            Some(Arc::new(pool.map_err(|error| EngineError::Threads(error.to_string()))?))
        } else {
            None
        };
        Ok(Self {
            level: Level::new(&plan, planar, threads, instructions)?,
            lists: Lists::new(&plan, &bodies, size),
            tally: Tally::new(plan.walls.len()),
            watch: Watch::new(&plan),
            plan,
            bodies,
            integrator,
            pool,
            step: 0,
            evaluation: 2,
            force_time: 0.0,
            moved: 0.0,
            radius,
            walls: Vec::new(),
            work: Work::default(),
            substrate: SubstrateTally::default(),
        })
    }

    /// The plan that runs.
    pub fn plan(&self) -> &Arc<Plan> {
        &self.plan
    }

    /// Bodies in memory order, with velocities and forces of the current time.
    pub fn bodies(&self) -> &Bodies {
        &self.bodies
    }

    /// Steps done.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Simulated time \[s\].
    pub fn time(&self) -> f64 {
        self.step as f64 * self.plan.driver.step
    }

    /// Sums over the contacts of the last force evaluation.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Work and dissipation since the start; zero without the energy ledger.
    pub fn work(&self) -> &Work {
        &self.work
    }

    /// What bodies do on the substrate, and its work and dissipation since the start.
    pub fn substrate(&self) -> &SubstrateTally {
        &self.substrate
    }

    /// Worker threads in use.
    pub fn threads(&self) -> usize {
        self.pool.as_ref().map_or(1, |pool| pool.current_num_threads())
    }

    /// How often candidate lists were rebuilt and pruned.
    pub fn list_updates(&self) -> (u64, u64) {
        (self.lists.rebuilds, self.lists.prunes)
    }

    /// Bytes of lists and contact histories now allocated.
    pub fn list_bytes(&self) -> usize {
        self.lists.bytes()
    }

    /// Does `steps` steps. `watch` is told each phase before it begins.
    ///
    /// # Errors
    /// A number is no longer finite, a limit is passed, a law panics, or lists cannot be made. The state is then that of the failing step.
    pub fn advance(&mut self, steps: u64, watch: &mut (dyn FnMut(Phase) + Send)) -> Result<(), EngineError> {
        // All steps run inside the pool, so that its threads stay awake between the phases of a step.
        let pool = self.pool.clone();
        let result = blame::caught(|| match &pool {
            Some(pool) => pool.install(|| self.advance_here(steps, watch)),
            None => self.advance_here(steps, watch),
        });
        result.unwrap_or_else(|blame| Err(self.blamed(*blame)))
    }

    /// The error of a law at fault.
    fn blamed(&self, blame: blame::Blame) -> EngineError {
        let wall =
            |index: u16| self.plan.walls.get(usize::from(index)).map_or("", |wall| &wall.name).to_string();
        blame.at(self.step, self.time(), |place| self.bodies.id[place as usize], wall)
    }

    fn advance_here(&mut self, steps: u64, watch: &mut (dyn FnMut(Phase) + Send)) -> Result<(), EngineError> {
        let dt = self.plan.driver.step;
        for done in 0..steps {
            let last = done + 1 == steps;
            if done == 0 {
                watch(Phase::Integration);
                self.integrate(Sweep::Begin)?;
            }
            watch(Phase::Lists);
            let time = (self.step as f64 + self.integrator.force_time()) * dt;
            self.update_lists(time)?;
            watch(Phase::Forces);
            let watched = self.watch.looks(self.step + 1);
            self.evaluate(time, dt, last || watched);
            if watched {
                self.watch_overlap()?;
            }
            watch(Phase::Integration);
            self.integrate(if last { Sweep::Finish } else { Sweep::FinishBegin })?;
            self.step += 1;
        }
        Ok(())
    }

    /// All contacts at the current positions, ordered by identities; histories are those of the last force evaluation.
    pub fn contacts(&self) -> Vec<ContactRecord> {
        let mut contacts = Vec::new();
        let last = self.evaluation.wrapping_sub(1);
        for tile in &self.lists.tiles {
            for (index, pair) in tile.inner.iter().enumerate() {
                let i = tile.first + (pair.i_image >> 5) as usize;
                let j = pair.j as usize;
                let shift = self.lists.shifts[(pair.i_image & 31) as usize];
                let (a, b) = (self.bodies.position[i], self.bodies.position[j]);
                let d = Vector3::new(a[0] - b[0] - shift[0], a[1] - b[1] - shift[1], a[2] - b[2] - shift[2]);
                let overlap = a[3] + b[3] - d.norm();
                if overlap > 0.0 {
                    let history = tile.history.get(index, last).unwrap_or(&[]).to_vec();
                    let normal = d.try_normalize(0.0).unwrap_or_else(Vector3::x).into();
                    contacts.push(ContactRecord {
                        id: self.bodies.id[i],
                        partner: ContactPartner::Body(self.bodies.id[j]),
                        overlap,
                        normal,
                        history,
                    });
                }
            }
            for (index, pair) in tile.walls.pairs.iter().enumerate() {
                let i = tile.first + pair.body as usize;
                let row = self.bodies.position[i];
                let wall = &self.plan.walls[pair.wall as usize].wall;
                let contact = wall.surface_at(self.force_time).contact(Vector3::new(row[0], row[1], row[2]));
                let overlap = row[3] - contact.distance;
                if overlap > 0.0 {
                    contacts.push(ContactRecord {
                        id: self.bodies.id[i],
                        partner: ContactPartner::Wall(pair.wall),
                        overlap,
                        normal: contact.normal.into(),
                        history: tile.walls.history.get(index, last).unwrap_or(&[]).to_vec(),
                    });
                }
            }
        }
        contacts.sort_by_key(|contact| (contact.id, contact.partner));
        contacts
    }

    /// What each contact did in the last force evaluation, ordered by identities: there if an output of the plan shows it, and
    /// after the last step of an advance.
    pub fn contact_forces(&self) -> Vec<ContactForce> {
        let records = self.lists.tiles.iter().flat_map(|tile| &tile.records);
        let mut forces: Vec<ContactForce> = records.map(|record| record.told(&self.bodies)).collect();
        forces.sort_by_key(|contact| (contact.id, contact.partner));
        forces
    }

    fn integrate(&mut self, kind: Sweep) -> Result<(), EngineError> {
        if self.plan.substrate.is_some() && kind != Sweep::Begin {
            // The surface answers to the motion at the end of the step, before the next one begins.
            self.pass(Sweep::Finish)?;
            self.settle(self.plan.driver.step);
            return if kind == Sweep::FinishBegin { self.pass(Sweep::Begin) } else { Ok(()) };
        }
        if kind == Sweep::FinishBegin && self.integrator.force_time() < 1.0 {
            // Bodies move at both ends of a step. How far they have moved since the lists were made must not depend on
            // whether somebody looks in between.
            self.pass(Sweep::Finish)?;
            return self.pass(Sweep::Begin);
        }
        self.pass(kind)
    }

    /// Lets the substrate act over the step that has been integrated without it; zero for the state at the start.
    fn settle(&mut self, time_step: f64) {
        let time = if time_step > 0.0 { (self.step + 1) as f64 * time_step } else { 0.0 };
        let Self { bodies, lists, plan, pool, substrate, .. } = self;
        let Some(surface) = &plan.substrate else { return };
        let mut act =
            |parallel| substrate::settle(surface, bodies, time, time_step, plan.gravity[2], parallel);
        let tally = match pool {
            Some(pool) => pool.install(|| act(true)),
            None => act(false),
        };
        lists.travel(tally.displacement);
        substrate.add(tally);
    }

    fn pass(&mut self, kind: Sweep) -> Result<(), EngineError> {
        let pass = self.sweep(kind);
        self.check_finite(pass.poison)?;
        let travelled = pass.maximum_displacement_squared.sqrt();
        self.lists.travel(travelled);
        self.moved += 2.0 * travelled;
        self.watch_travel(travelled)
    }

    fn sweep(&mut self, kind: Sweep) -> Pass {
        let Self { bodies, lists, level, integrator, plan, pool, .. } = self;
        let dt = plan.driver.step;
        let size = lists.tile_size;
        let tiles = &lists.tiles;
        let rows = Rows::of(bodies);
        let work =
            |tile: usize, rows: Rows<'_>| sweep(tile, rows, tiles, level, integrator.as_ref(), kind, dt);
        let first = Pass::default();
        match pool {
            Some(pool) => pool.install(|| visit(0, tiles.len(), rows, size, true, &work)).unwrap_or(first),
            None => visit(0, tiles.len(), rows, size, false, &work).unwrap_or(first),
        }
    }

    fn update_lists(&mut self, time: f64) -> Result<(), EngineError> {
        let walls_moved = self.wall_travel(time);
        self.lists.count_step();
        let Self { bodies, lists, plan, pool, evaluation, walls, moved, .. } = self;
        lists.travel(walls_moved);
        *moved += walls_moved;
        let last = evaluation.wrapping_sub(1);
        let parallel = pool.is_some();
        let mut update = || -> Result<(), EngineError> {
            if lists.outer_expired() {
                move_walls(walls, plan, time);
                lists.rebuild(plan, bodies, walls, last, parallel)?;
                lists.prune(bodies, last, parallel);
            } else if lists.inner_expired() {
                lists.prune(bodies, last, parallel);
            }
            Ok(())
        };
        match pool {
            Some(pool) => pool.install(update),
            None => update(),
        }
    }

    /// Bound of what any wall has moved towards any body since the last force evaluation \[m\].
    fn wall_travel(&self, time: f64) -> f64 {
        let mut largest: f64 = 0.0;
        for wall in self.plan.walls.iter().map(|plan| &plan.wall).filter(|wall| !wall.keeps_its_place()) {
            let moved = match wall.motion().rotation_at(time) {
                Some((centre, _, _)) => {
                    let far = self.bodies.position.iter().fold(0.0, |far: f64, row| {
                        far.max((Vector3::new(row[0], row[1], row[2]) - centre).norm() + row[3])
                    });
                    wall.motion().angular_velocity().norm() * (time - self.force_time).abs() * far
                }
                None => {
                    (wall.motion().displacement(time) - wall.motion().displacement(self.force_time)).norm()
                }
            };
            largest = largest.max(moved);
        }
        largest
    }

    fn evaluate(&mut self, time: f64, time_step: f64, observe: bool) {
        let Self { bodies, lists, level, plan, pool, evaluation, tally, work, radius, walls, moved, .. } =
            self;
        move_walls(walls, plan, time);
        let size = lists.tile_size;
        let resolves = plan.driver.scheme == Scheme::ContactResolved && time_step > 0.0;
        let mut force = std::mem::take(&mut bodies.force);
        let mut torque = std::mem::take(&mut bodies.torque);
        let at = Evaluation {
            bodies: &shared(bodies),
            compositions: &plan.compositions,
            shifts: &lists.shift_rows,
            walls,
            wall_plans: &plan.walls,
            gravity: plan.gravity,
            radius: *radius,
            time_step,
            now: *evaluation,
            ledger: plan.ledger,
            overlap: observe,
            records: observe && plan.shows_contacts(),
            resolved: resolves.then_some(StepRows {
                previous: &bodies.previous_acceleration,
                previous_angular: &bodies.previous_angular_acceleration,
                predicted: &bodies.predicted_acceleration,
                predicted_angular: &bodies.predicted_angular_acceleration,
                margin: *moved,
            }),
            marks: plan.driver.scheme == Scheme::ContactResolved,
            inquest: false,
        };
        let mut run = |parallel| {
            crate::slices::forces(&mut lists.tiles, &mut force, &mut torque, size, parallel, level, &at);
        };
        match pool {
            Some(pool) => pool.install(|| run(true)),
            None => run(false),
        }
        bodies.force = force;
        bodies.torque = torque;
        *moved = 0.0;
        for impulse in lists.tiles.iter().flat_map(|tile| &tile.impulses) {
            impulse.act(bodies);
        }
        let before = tally.powers();
        tally.reset();
        for tile in &lists.tiles {
            tally.add(&tile.tally);
        }
        if plan.ledger {
            work.accumulate(&before, &tally.powers(), time_step);
        }
        *evaluation = evaluation.wrapping_add(1);
        self.force_time = time;
    }

    /// Looks for the body at fault if `poison` is not a number.
    fn check_finite(&self, poison: f64) -> Result<(), EngineError> {
        if poison == 0.0 && self.step > 0 {
            return Ok(());
        }
        let bad = |vector: [f64; 3]| vector.iter().any(|component| !component.is_finite());
        let culprits = (0..self.bodies.len()).filter_map(|place| {
            let columns = [
                ("force", self.bodies.force_of(place)),
                ("torque", self.bodies.torque_of(place)),
                ("velocity", self.bodies.velocity_of(place)),
                ("spin", self.bodies.spin_of(place)),
                ("position", self.bodies.position[place].vector()),
            ];
            columns.into_iter().find(|(_, vector)| bad(*vector)).map(|(name, _)| (place, name))
        });
        let culprit = culprits.min_by_key(|(place, _)| self.bodies.id[*place]);
        match culprit {
            Some((place, quantity)) => Err(EngineError::NotFinite {
                id: self.bodies.id[place],
                quantity,
                step: self.step,
                time: self.time(),
            }),
            None => Ok(()),
        }
    }
}

/// Brings the walls to a time.
fn move_walls(walls: &mut Vec<MovedWall>, plan: &Plan, time: f64) {
    walls.clear();
    walls.extend(plan.walls.iter().map(|plan| MovedWall { surface: plan.wall.surface_at(time), time }));
}

fn scheme(scheme: Scheme) -> Box<dyn Integrator> {
    let name = match scheme {
        Scheme::VelocityVerlet => "VelocityVerlet",
        Scheme::ClassicVelocityVerlet => "ClassicVelocityVerlet",
        Scheme::ContactResolved => "ContactResolved",
        Scheme::Leapfrog => "Leapfrog",
        Scheme::SymplecticEuler => "SymplecticEuler",
    };
    integrator(name).unwrap_or_else(|| Box::new(granule_integrators::VelocityVerlet))
}

fn inputs(plan: &Plan) -> impl Iterator<Item = BodyInput> + '_ {
    let table = &plan.bodies;
    (0..table.len()).map(move |index| BodyInput {
        id: table.id[index],
        material: table.material[index],
        radius: table.radius[index],
        mass: table.mass[index],
        inertia_factor: table.inertia_factor[index],
        position: table.position[index],
        velocity: table.velocity[index],
        spin: table.spin[index],
        frozen: table.frozen[index],
    })
}
