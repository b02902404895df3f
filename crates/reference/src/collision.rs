//! The exact contact of two spheres, or of a sphere and a plane.

use std::ops::Range;

use granule_law_api::{Arm, Impact};
use granule_plan::{Composition, Partner, Plan};

use crate::contact::{Contact, Kinematics, Response};
use crate::hard_limit::{COARSE, FINE};
use crate::path::{Event, Mechanics, integrate};
use crate::{ReferenceError, Vector, add, cross, dot, length, three};

/// A body at the moment of touch. A plane wall is a body of infinite radius and mass that may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Mass \[kg\], greater than zero; infinite for walls and frozen bodies.
    pub mass: f64,
    /// Radius \[m\], greater than zero; infinite for a plane wall.
    pub radius: f64,
    /// q = I/(m R²), greater than zero.
    pub inertia_factor: f64,
    /// Velocity \[m/s\].
    pub velocity: Vector,
    /// Spin \[rad/s\]; zero for a plane wall.
    pub spin: Vector,
}

/// Two bodies at the moment of touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// Body i and body j. Only j may be a plane wall.
    pub bodies: [Body; 2],
    /// Unit normal from j to i.
    pub normal: Vector,
}

/// What comes out of a collision.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Time until the overlap has vanished \[s\].
    pub duration: f64,
    /// Time until the normal force has vanished for good \[s\].
    pub force_duration: f64,
    /// Largest overlap \[m\].
    pub maximum_overlap: f64,
    /// Both bodies after the contact.
    pub bodies: [Body; 2],
    /// Energy dissipated by damping \[J\].
    pub viscous: f64,
    /// Energy dissipated by sliding \[J\].
    pub friction: f64,
    /// What happened, in order.
    pub events: Vec<Event>,
    /// Estimated error of velocities and surface velocities, relative to the impact speed.
    pub error: f64,
}

/// Duration of a contact as its normal law tells it, or a guess \[s\]: a unit of time only.
pub(crate) fn time_scale(composition: &Composition, mass: f64, radius: f64, speed: f64) -> f64 {
    let impact = Impact { reduced_mass: mass, reduced_radius: radius, normal_speed: speed };
    composition
        .stages
        .iter()
        .filter_map(|stage| {
            (stage.law.time_scale)(&stage.params, &composition.context, &impact).ok().flatten()
        })
        .map(|scale| scale.duration)
        .find(|duration| duration.is_finite() && *duration > 0.0)
        .unwrap_or(1e-3 * radius / speed)
}

impl Collision {
    /// The collision of a plan with two bodies, or with one body and one plane wall at rest or in steady motion, and the
    /// laws that act. The bodies fly straight until they touch.
    ///
    /// # Errors
    /// The plan holds something else, the bodies overlap already, miss each other, or fall.
    pub fn of_plan(plan: &Plan) -> Result<(Self, &Composition), ReferenceError> {
        let problem = |what: &str| ReferenceError::Problem(what.to_string());
        if plan.gravity != [0.0; 3] {
            return Err(problem("a single collision has no gravity"));
        }
        let table = &plan.bodies;
        let body = |index: usize| Body {
            mass: if table.frozen[index] { f64::INFINITY } else { table.mass[index] },
            radius: table.radius[index],
            inertia_factor: table.inertia_factor[index],
            velocity: table.velocity[index],
            spin: table.spin[index],
        };
        let laws = |partner| {
            let index = plan.composition(table.material[0], partner);
            index.map(|index| &plan.compositions[index]).ok_or_else(|| problem("no laws act"))
        };
        match (table.len(), plan.walls.len()) {
            (2, 0) => {
                let (i, j) = (body(0), body(1));
                let composition = laws(Partner::Body(table.material[1]))?;
                let separation = add(table.position[0], -1.0, table.position[1]);
                let velocity = add(i.velocity, -1.0, j.velocity);
                let reach = i.radius + j.radius + composition.reach;
                // |r + v t| = reach: the smaller root.
                let (a, b) = (dot(velocity, velocity), dot(separation, velocity));
                let c = dot(separation, separation) - reach * reach;
                // A start at touch may overlap by the rounding of its positions.
                if c < -1e-12 * reach * reach {
                    return Err(problem("the bodies overlap at the start"));
                }
                let root = b * b - a * c;
                if b >= 0.0 || root < 0.0 {
                    return Err(problem("the bodies miss each other"));
                }
                let time = c.max(0.0) / (-b + root.sqrt());
                let at_touch = add(separation, time, velocity);
                let normal = at_touch.map(|component| component / length(at_touch));
                Ok((Self { bodies: [i, j], normal }, composition))
            }
            (1, 1) => {
                let i = body(0);
                let wall = &plan.walls[0].wall;
                let steady = wall.motion().steady_velocity();
                let velocity: Vector = match steady {
                    Some(velocity) => [velocity.x, velocity.y, velocity.z],
                    None if wall.motion().is_fixed() => [0.0; 3],
                    None => return Err(problem("the wall must rest or move steadily")),
                };
                let contact = wall.contact(table.position[0].into(), 0.0);
                if contact.curvature_radius != f64::INFINITY {
                    return Err(problem("the wall must be a plane"));
                }
                let normal = [contact.normal.x, contact.normal.y, contact.normal.z];
                if contact.distance < i.radius * (1.0 - 1e-12) {
                    return Err(problem("the body overlaps the wall at the start"));
                }
                if dot(add(i.velocity, -1.0, velocity), normal) >= 0.0 {
                    return Err(problem("the body does not approach the wall"));
                }
                Ok((Self { bodies: [i, Body::wall(velocity)], normal }, laws(Partner::Wall(0))?))
            }
            _ => Err(problem("a single collision has two bodies, or one body and one wall")),
        }
    }

    /// m12 \[kg\].
    pub fn reduced_mass(&self) -> f64 {
        1.0 / self.bodies.iter().map(|body| 1.0 / body.mass).sum::<f64>()
    }

    /// Tangential mass m_t, 1/m_t = (1 + 1/q1)/m1 + (1 + 1/q2)/m2 \[kg\] (erratum L-E18).
    pub fn tangential_mass(&self) -> f64 {
        1.0 / self.bodies.iter().map(|body| (1.0 + 1.0 / body.inertia_factor) / body.mass).sum::<f64>()
    }

    /// R* \[m\].
    pub fn reduced_radius(&self) -> f64 {
        1.0 / self.bodies.iter().map(|body| 1.0 / body.radius).sum::<f64>()
    }

    /// Velocity of i against j at the contact point: the normal part, positive on approach, and the tangential part
    /// (Luding 1998, Eq. (7)) \[m/s\].
    pub fn contact_velocity(&self, bodies: &[Body; 2]) -> (f64, Vector) {
        let relative = add(bodies[0].velocity, -1.0, bodies[1].velocity);
        let approach = -dot(relative, self.normal);
        let surface = bodies.iter().fold([0.0; 3], |sum, body| match body.radius.is_finite() {
            true => add(sum, body.radius, body.spin),
            false => sum,
        });
        (approach, add(add(relative, approach, self.normal), 1.0, cross(self.normal, surface)))
    }

    /// The same impact in the hard limit.
    pub fn hard_limit(&self) -> crate::HardLimit {
        let (normal_speed, slip) = self.contact_velocity(&self.bodies);
        crate::HardLimit {
            reduced_mass: self.reduced_mass(),
            tangential_mass: self.tangential_mass(),
            reduced_radius: self.reduced_radius(),
            normal_speed,
            tangential_speed: length(slip),
        }
    }

    /// Integrates the collision.
    ///
    /// # Errors
    /// A number is not allowed, the bodies do not approach, or the contact does not end.
    pub fn run(&self, composition: &Composition) -> Result<Outcome, ReferenceError> {
        let pair = Pair::new(self, composition)?;
        let [mass, radius] = [self.reduced_mass(), self.reduced_radius()];
        let contact = Contact::new(composition, mass, radius)?;
        let [i, j] = self.bodies;
        let relative = add(i.velocity, -1.0, j.velocity);
        let mut start = relative.to_vec();
        start.extend(i.spin);
        start.extend(j.spin);
        let speed = pair.speed;
        let scale = time_scale(composition, mass, radius, -dot(relative, self.normal));
        let unit = (scale, 0.5 * mass * speed * speed, speed);
        let end = integrate(&pair, &contact, &start, FINE, unit)?;
        let coarse = integrate(&pair, &contact, &start, COARSE, unit)?;
        let mut difference: f64 = 0.0;
        for (index, (fine, coarse)) in end.velocities.iter().zip(&coarse.velocities).enumerate() {
            let radius = match index {
                0..3 => 1.0,
                3..6 => i.radius,
                _ if j.radius.is_finite() => j.radius,
                _ => 0.0,
            };
            difference = difference.max((fine - coarse).abs() * radius);
        }
        // The centre of mass keeps its velocity.
        let share = [pair.inverse_mass[0] / pair.total(), pair.inverse_mass[1] / pair.total()];
        let change = add(three(&end.velocities), -1.0, relative);
        let after = [
            Body { velocity: add(i.velocity, share[0], change), spin: three(&end.velocities[3..]), ..i },
            Body { velocity: add(j.velocity, -share[1], change), spin: three(&end.velocities[6..]), ..j },
        ];
        Ok(Outcome {
            duration: end.time,
            force_duration: end.force_duration(),
            maximum_overlap: end.maximum_overlap,
            bodies: after,
            viscous: end.viscous,
            friction: end.friction,
            events: end.events,
            error: difference / speed + FINE.tolerance,
        })
    }
}

impl Body {
    /// A plane wall that moves steadily.
    pub fn wall(velocity: Vector) -> Self {
        Self { mass: f64::INFINITY, radius: f64::INFINITY, inertia_factor: 1.0, velocity, spin: [0.0; 3] }
    }

    /// 1/I, zero for a wall.
    fn inverse_inertia(&self) -> f64 {
        if self.mass.is_finite() {
            1.0 / (self.inertia_factor * self.mass * self.radius * self.radius)
        } else {
            0.0
        }
    }
}

/// Mechanics of a pair. Positions: displacement of i against j since touch. Velocities: relative velocity and both spins.
struct Pair {
    normal: Vector,
    /// Sum of the radii \[m\]; infinite at a plane.
    touching: f64,
    /// Separation at which the contact begins \[m\].
    reach: f64,
    radius: [f64; 2],
    inverse_mass: [f64; 2],
    inverse_inertia: [f64; 2],
    /// Shares of the overlap that the arms of torque and slip lack.
    shares: [f64; 2],
    speed: f64,
}

/// Share of the overlap by which an arm is shorter than the radius.
fn share(arm: Arm) -> f64 {
    match arm {
        Arm::Radius => 0.0,
        Arm::HalfOverlap => 0.5,
        Arm::FullOverlap => 1.0,
    }
}

impl Pair {
    fn new(collision: &Collision, composition: &Composition) -> Result<Self, ReferenceError> {
        let [i, j] = collision.bodies;
        let positive = |value: f64| value > 0.0;
        let whole = collision.bodies.iter().all(|body| {
            positive(body.mass)
                && positive(body.radius)
                && positive(body.inertia_factor)
                && body.velocity.iter().chain(&body.spin).all(|value| value.is_finite())
        });
        let approach = collision.contact_velocity(&collision.bodies).0;
        let unit = (length(collision.normal) - 1.0).abs() < 1e-9;
        if !(whole && unit && approach > 0.0 && i.radius.is_finite() && collision.reduced_mass().is_finite())
        {
            return Err(ReferenceError::Problem(format!("this is no collision: {collision:?}")));
        }
        let conventions = &composition.context.conventions;
        let arms = if j.radius.is_finite() {
            [conventions.pair_torque_arm, conventions.pair_slip_arm]
        } else {
            [conventions.wall_torque_arm, conventions.wall_slip_arm]
        };
        let slip = length(collision.contact_velocity(&collision.bodies).1);
        Ok(Self {
            normal: collision.normal,
            touching: i.radius + j.radius,
            reach: composition.reach,
            radius: [i.radius, j.radius],
            inverse_mass: [1.0 / i.mass, 1.0 / j.mass],
            inverse_inertia: [i.inverse_inertia(), j.inverse_inertia()],
            shares: arms.map(share),
            speed: f64::hypot(approach, slip),
        })
    }

    fn total(&self) -> f64 {
        self.inverse_mass[0] + self.inverse_mass[1]
    }

    /// Arms of both bodies; none at a plane.
    fn arms(&self, which: usize, overlap: f64) -> [f64; 2] {
        self.radius.map(|radius| if radius.is_finite() { radius - self.shares[which] * overlap } else { 0.0 })
    }
}

impl Mechanics for Pair {
    const SIZE: (usize, usize) = (3, 9);

    fn kinematics(&self, positions: &[f64], velocities: &[f64]) -> Kinematics {
        let moved = three(positions);
        let along = dot(moved, self.normal);
        let (overlap, normal) = if self.touching.is_finite() {
            // The overlap as a difference of squares: no digits are lost to the radii.
            let begin = self.touching + self.reach;
            let separation = add(moved, begin, self.normal);
            let distance = length(separation);
            let closer = -(2.0 * begin * along + dot(moved, moved)) / (distance + begin);
            (closer - self.reach, separation.map(|component| component / distance))
        } else {
            (-along - self.reach, self.normal)
        };
        let (velocity, spins) = (three(velocities), [three(&velocities[3..]), three(&velocities[6..])]);
        let approach = -dot(velocity, normal);
        let [a, b] = self.arms(1, overlap);
        let surface = add(spins[0].map(|component| a * component), b, spins[1]);
        Kinematics {
            overlap,
            normal,
            normal_velocity: approach,
            tangential_velocity: add(add(velocity, approach, normal), 1.0, cross(normal, surface)),
            relative_spin: add(spins[0], -1.0, spins[1]),
        }
    }

    fn accelerations(&self, at: &Kinematics, response: &Response, out: &mut [f64]) {
        let force = add(response.tangential, response.normal, at.normal);
        let turning = cross(at.normal, response.tangential);
        let arms = self.arms(0, at.overlap);
        for axis in 0..3 {
            out[axis] = force[axis] * self.total();
            out[3 + axis] = (response.torque[axis] - arms[0] * turning[axis]) * self.inverse_inertia[0];
            out[6 + axis] = (-response.torque[axis] - arms[1] * turning[axis]) * self.inverse_inertia[1];
        }
    }

    fn groups(&self) -> Vec<(Range<usize>, f64)> {
        let spin = |radius: f64| if radius.is_finite() { self.speed / radius } else { 0.0 };
        vec![(0..3, 0.0), (3..6, self.speed), (6..9, spin(self.radius[0])), (9..12, spin(self.radius[1]))]
    }
}
