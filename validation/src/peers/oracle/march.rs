//! The time step of the engines (velocity Verlet, forces with half-step velocities) and its synchronised sibling.

use std::collections::BTreeMap;

use super::coefficients::{Pairing, coefficients};
use super::contact::{Action, Contact, Partner, act};
use super::vector::{Vector, ZERO, add, norm, scale, sub};
use super::{ConventionSet, Velocity};
use crate::peers::{Axis, Frame, PeerError, PeerLaw, PeerScene, PeerWall, Quantity, Side};

/// A scene run with the engine's own conventions.
///
/// # Errors
/// [`PeerError::Scene`] if the scene is wrong.
pub fn march(scene: &PeerScene) -> Result<Vec<Frame>, PeerError> {
    march_with(scene, &ConventionSet::of)
}

/// A scene run with conventions chosen per law. Frames hold all quantities at every `dump_every` steps.
///
/// # Errors
/// [`PeerError::Scene`] if the scene is wrong.
pub fn march_with(
    scene: &PeerScene,
    conventions: &dyn Fn(&PeerLaw) -> ConventionSet,
) -> Result<Vec<Frame>, PeerError> {
    let mut world = World::new(scene, conventions)?;
    let mut frames = Vec::new();
    world.forces(None)?;
    for step in 0..=scene.steps {
        if step > 0 {
            world.begin();
            world.forces(Some(scene.time_step))?;
            world.finish();
        }
        if scene.dump_every > 0 && step.is_multiple_of(scene.dump_every) {
            frames.push(world.frame(step));
        }
    }
    Ok(frames)
}

/// LAMMPS and LIGGGHTS spell the inertia factor of a sphere so.
const INERTIA: f64 = 0.4;

struct Body {
    id: u64,
    kind: usize,
    radius: f64,
    mass: f64,
    frozen: bool,
    position: Vector,
    velocity: Vector,
    spin: Vector,
    force: Vector,
    torque: Vector,
    /// Force and torque of the last step, for the synchronised scheme.
    previous: [Vector; 2],
}

struct World<'a> {
    scene: &'a PeerScene,
    bodies: Vec<Body>,
    conventions: &'a dyn Fn(&PeerLaw) -> ConventionSet,
    velocity: Velocity,
    /// Springs by indices of the two bodies, or of a body and (after the bodies) a wall.
    springs: BTreeMap<(usize, usize), Vector>,
    /// Largest overlaps, by the same indices.
    overlaps: BTreeMap<(usize, usize), f64>,
}

impl<'a> World<'a> {
    fn new(
        scene: &'a PeerScene,
        conventions: &'a dyn Fn(&PeerLaw) -> ConventionSet,
    ) -> Result<Self, PeerError> {
        scene.check()?;
        let mut rules = scene.laws.values().map(|law| conventions(law).velocity);
        let velocity = rules.next().unwrap_or(Velocity::HalfStep);
        if rules.any(|other| other != velocity) {
            return Err(PeerError::Scene("one run has one rule for the velocities in forces".into()));
        }
        let mut bodies: Vec<Body> = scene
            .bodies
            .iter()
            .map(|body| Body {
                id: body.id,
                kind: body.kind,
                radius: body.radius(),
                mass: body.mass(),
                frozen: scene.frozen.contains(&body.id),
                position: body.position,
                velocity: body.velocity,
                spin: body.angular_velocity,
                force: ZERO,
                torque: ZERO,
                previous: [ZERO; 2],
            })
            .collect();
        bodies.sort_by_key(|body| body.id);
        Ok(Self { scene, bodies, conventions, velocity, springs: BTreeMap::new(), overlaps: BTreeMap::new() })
    }

    /// Factors of force and torque for half a kick, divided in the engines' order.
    fn half_kick(body: &Body, dt: f64) -> (f64, f64) {
        let half = 0.5 * dt;
        (half / body.mass, half / INERTIA / (body.radius * body.radius * body.mass))
    }

    fn begin(&mut self) {
        let dt = self.scene.time_step;
        for body in self.bodies.iter_mut().filter(|body| !body.frozen) {
            let (push, twist) = Self::half_kick(body, dt);
            match self.velocity {
                Velocity::HalfStep => {
                    body.velocity = add(body.velocity, scale(push, body.force));
                    body.position = add(body.position, scale(dt, body.velocity));
                    body.spin = add(body.spin, scale(twist, body.torque));
                }
                Velocity::Synchronised => {
                    let half = add(body.velocity, scale(push, body.force));
                    body.position = add(body.position, scale(dt, half));
                    body.velocity = add(body.velocity, scale(2.0 * push, body.force));
                    body.spin = add(body.spin, scale(2.0 * twist, body.torque));
                    body.previous = [body.force, body.torque];
                }
            }
        }
    }

    fn finish(&mut self) {
        let dt = self.scene.time_step;
        for body in self.bodies.iter_mut().filter(|body| !body.frozen) {
            let (push, twist) = Self::half_kick(body, dt);
            let (force, torque) = match self.velocity {
                Velocity::HalfStep => (body.force, body.torque),
                Velocity::Synchronised => {
                    (sub(body.force, body.previous[0]), sub(body.torque, body.previous[1]))
                }
            };
            body.velocity = add(body.velocity, scale(push, force));
            body.spin = add(body.spin, scale(twist, torque));
        }
    }

    /// Forces at the present state; `dt` advances history.
    fn forces(&mut self, dt: Option<f64>) -> Result<(), PeerError> {
        for body in &mut self.bodies {
            (body.force, body.torque) = (ZERO, ZERO);
        }
        for i in 0..self.bodies.len() {
            for j in i + 1..self.bodies.len() {
                let action = self.pair(i, j, dt)?;
                if let Some(Action { force, torques }) = action {
                    self.bodies[i].force = add(self.bodies[i].force, force);
                    self.bodies[j].force = sub(self.bodies[j].force, force);
                    self.bodies[i].torque = add(self.bodies[i].torque, torques[0]);
                    self.bodies[j].torque = add(self.bodies[j].torque, torques[1]);
                }
            }
        }
        for i in 0..self.bodies.len() {
            for (index, wall) in self.scene.walls.iter().enumerate() {
                let action = self.at_wall(i, index, wall, dt)?;
                if let Some(Action { force, torques }) = action {
                    self.bodies[i].force = add(self.bodies[i].force, force);
                    self.bodies[i].torque = add(self.bodies[i].torque, torques[0]);
                }
            }
        }
        for body in &mut self.bodies {
            body.force = add(body.force, scale(body.mass, self.scene.gravity));
            if body.frozen {
                (body.force, body.torque) = (ZERO, ZERO);
            }
        }
        Ok(())
    }

    fn law(&self, i: usize, j: usize) -> Result<&'a PeerLaw, PeerError> {
        let law = self.scene.law(i, j);
        law.ok_or_else(|| PeerError::Scene(format!("types {i} and {j} meet but have no law")))
    }

    fn pair(&mut self, i: usize, j: usize, dt: Option<f64>) -> Result<Option<Action>, PeerError> {
        let (a, b) = (&self.bodies[i], &self.bodies[j]);
        let mut apart = sub(a.position, b.position);
        for k in 0..3 {
            if self.scene.periodic[k] {
                let length = self.scene.upper[k] - self.scene.lower[k];
                apart[k] -= length * (apart[k] / length).round();
            }
        }
        let (distance, sum) = (norm(apart), a.radius + b.radius);
        if distance >= sum {
            self.springs.remove(&(i, j));
            self.overlaps.remove(&(i, j));
            return Ok(None);
        }
        let mass = match (a.frozen, b.frozen) {
            (false, false) => a.mass * b.mass / (a.mass + b.mass),
            (true, false) => b.mass,
            (false, true) => a.mass,
            (true, true) => return Ok(None),
        };
        let law = self.law(a.kind, b.kind)?;
        let overlap = sum - distance;
        let material = |kind: usize| self.scene.materials[kind - 1];
        let pairing = Pairing {
            overlap,
            radius: a.radius * b.radius / sum,
            mass,
            materials: [material(a.kind), material(b.kind)],
        };
        let contact = Contact {
            normal: scale(1.0 / distance, apart),
            overlap,
            first: Partner { radius: a.radius, velocity: a.velocity, spin: a.spin },
            second: Partner { radius: b.radius, velocity: b.velocity, spin: b.spin },
            wall: false,
        };
        let memory = self.overlaps.entry((i, j)).or_insert(0.0);
        let coefficients = coefficients(law, &pairing, memory)?;
        let spring = self.springs.entry((i, j)).or_insert(ZERO);
        Ok(Some(act(&contact, &coefficients, &(self.conventions)(law), spring, dt)))
    }

    fn at_wall(
        &mut self,
        i: usize,
        index: usize,
        wall: &PeerWall,
        dt: Option<f64>,
    ) -> Result<Option<Action>, PeerError> {
        let body = &self.bodies[i];
        let axis = Axis::index(wall.axis);
        let height = body.position[axis] - wall.position;
        let (height, sign) = match wall.side {
            Side::Above => (height, 1.0),
            Side::Below => (-height, -1.0),
        };
        let key = (i, self.bodies.len() + index);
        if height >= body.radius {
            self.springs.remove(&key);
            self.overlaps.remove(&key);
            return Ok(None);
        }
        let law = self.law(body.kind, wall.kind)?;
        let overlap = body.radius - height;
        let material = |kind: usize| self.scene.materials[kind - 1];
        let pairing = Pairing {
            overlap,
            radius: body.radius,
            mass: body.mass,
            materials: [material(body.kind), material(wall.kind)],
        };
        let mut normal = ZERO;
        normal[axis] = sign;
        let contact = Contact {
            normal,
            overlap,
            first: Partner { radius: body.radius, velocity: body.velocity, spin: body.spin },
            second: Partner { radius: 0.0, velocity: wall.velocity, spin: ZERO },
            wall: true,
        };
        let memory = self.overlaps.entry(key).or_insert(0.0);
        let coefficients = coefficients(law, &pairing, memory)?;
        let spring = self.springs.entry(key).or_insert(ZERO);
        Ok(Some(act(&contact, &coefficients, &(self.conventions)(law), spring, dt)))
    }

    fn frame(&self, step: u64) -> Frame {
        let mut frame = Frame { step, ..Frame::default() };
        for body in &self.bodies {
            frame.ids.push(body.id);
            for (quantity, value) in [
                (Quantity::Position, body.position),
                (Quantity::Velocity, body.velocity),
                (Quantity::AngularVelocity, body.spin),
                (Quantity::Force, body.force),
                (Quantity::Torque, body.torque),
            ] {
                frame.column_mut(quantity).push(value);
            }
        }
        frame
    }
}
