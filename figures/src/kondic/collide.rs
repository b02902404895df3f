//! Two rolling spheres that collide on a surface, by the engine.

use granule_closed_forms::kondic::Spheres;

use crate::Error;
use crate::simulate::Run;

/// Steel spheres on a surface, Kondic 1999, Appendices B and C.
pub(super) const STEEL: Spheres =
    Spheres { inertia_number: 2.5, radius: 2e-3, gravity: 9.81, static_friction: 0.5, kinetic_friction: 0.1 };

/// Duration of a Hertz collision of two of them at a relative speed \[s\]: 1.931563e-5 s at 0.1 m/s, as v^(-1/5).
pub(super) fn duration(speed: f64) -> f64 {
    1.931_562_560e-5 * (speed / 0.1).powf(-0.2)
}

/// ω0 of the linear model with this duration and restitution \[1/s\].
pub(super) fn omega(speed: f64, restitution: f64) -> f64 {
    std::f64::consts::PI.hypot(restitution.ln()) / duration(speed)
}

/// γ_N of that model \[1/s\].
pub(super) fn rate(speed: f64, restitution: f64) -> f64 {
    -2.0 * restitution.ln() / duration(speed)
}

/// A collision to run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Collision {
    /// Velocities of the sphere ahead and of the one behind \[m/s\].
    pub velocities: [f64; 2],
    /// Restitution.
    pub restitution: f64,
    /// γ_S between the spheres \[1/s\].
    pub shear_rate: f64,
    /// Steps in the duration of the collision.
    pub steps: f64,
}

impl Collision {
    pub fn speed(&self) -> f64 {
        self.velocities[1] - self.velocities[0]
    }

    pub fn step(&self) -> f64 {
        duration(self.speed()) / self.steps
    }

    pub fn run(&self) -> Result<Run, Error> {
        let Spheres { radius, gravity, static_friction, kinetic_friction, .. } = STEEL;
        let body = |x: f64, v: f64| {
            format!(
                r#"Sphere(material: "steel", radius: {radius}, position: ({x}, 0, {radius}), velocity: ({v}, 0, 0),
                    spin: (0, {}, 0))"#,
                v / radius
            )
        };
        let friction = if self.shear_rate > 0.0 {
            let rate = self.shear_rate;
            format!(
                ", tangential: KondicFriction(damping_rate: {rate}, shear_friction: 0.5, vertical_friction: 0.5)"
            )
        } else {
            String::new()
        };
        let (speed, restitution) = (self.speed(), self.restitution);
        Run::new(&format!(
            r#"(version: 1, gravity: (0, 0, -{gravity}), materials: {{ "steel": (density: 7850) }},
            bodies: [{}, {}],
            substrate: (laws: {{
                "steel": StickSlip(static_friction: {static_friction}, kinetic_friction: {kinetic_friction}) }}),
            contacts: [(between: ("steel", "steel"), contact_end: Overlap,
                normal: KondicNormal(young_modulus: 2.06e11, poisson_ratio: 0.28, reference_speed: {speed},
                                     restitution: {restitution}){friction})],
            driver: TimeStep(step: {:e}), run: (duration: 100))"#,
            body(radius + 1e-12, self.velocities[0]),
            body(-radius, self.velocities[1]),
            self.step()
        ))
    }

    /// Largest compression, overlap over diameter.
    pub fn largest_compression(&self) -> Result<f64, Error> {
        let mut run = self.run()?;
        let mut largest: f64 = 0.0;
        for step in 1..(3.0 * self.steps) as u64 {
            run.advance(step)?;
            let bodies = run.bodies();
            let distance = bodies[0].position[0] - bodies[1].position[0];
            largest = largest.max(1.0 - distance / (2.0 * STEEL.radius));
        }
        Ok(largest)
    }

    /// Compression at which the spheres begin to slip.
    pub fn slip_compression(&self) -> Result<f64, Error> {
        let mut run = self.run()?;
        for step in 1..(3.0 * self.steps) as u64 {
            run.advance(step)?;
            let bodies = run.bodies();
            if (bodies[0].velocity[0] - STEEL.radius * bodies[0].spin[1]).abs() > 1e-12 {
                return Ok(1.0 - (bodies[0].position[0] - bodies[1].position[0]) / (2.0 * STEEL.radius));
            }
        }
        Ok(f64::NAN)
    }

    /// What the sphere ahead does from the end of the collision until it rolls.
    pub fn slide(&self) -> Result<Slid, Error> {
        let mut run = self.run()?;
        let mut step = 0;
        let mut touched = false;
        loop {
            step += 1;
            run.advance(step)?;
            let touches = run.contacts() > 0;
            if touched && !touches {
                break;
            }
            touched |= touches;
            if step as f64 > 100.0 * self.steps {
                return Err("the spheres do not collide".into());
            }
        }
        let (begin, start) = (run.time(), run.bodies()[0]);
        let every = (self.steps / 2.0) as u64;
        loop {
            step += every;
            run.advance(step)?;
            let body = run.bodies()[0];
            if (body.velocity[0] - STEEL.radius * body.spin[1]).abs() < 1e-12 {
                return Ok(Slid {
                    velocity: start.velocity[0],
                    final_velocity: body.velocity[0],
                    duration: run.time() - begin,
                    distance: body.position[0] - start.position[0],
                });
            }
            if run.time() > 10.0 {
                return Err("a sphere does not stop slipping".into());
            }
        }
    }
}

/// Slip of the sphere ahead.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slid {
    pub velocity: f64,
    pub final_velocity: f64,
    pub duration: f64,
    pub distance: f64,
}

#[cfg(test)]
mod tests {
    use granule_closed_forms::kondic::{after, during};

    use super::*;

    #[test]
    fn figures_of_the_engine_lie_on_the_closed_forms() {
        let collision =
            Collision { velocities: [-0.05, 0.05], restitution: 0.9, shear_rate: 0.0, steps: 100.0 };
        let largest = collision.largest_compression().unwrap();
        let expected = during::largest_compression_damped(&STEEL, 0.1, omega(0.1, 0.9), rate(0.1, 0.9));
        // The integration is of second order: (ω0 dt)² = 1e-3.
        assert!((largest / expected - 1.0).abs() < 2e-3, "{largest} {expected}");
        let slid = collision.slide().unwrap();
        // The friction during the collision, which the closed forms leave out, and the step.
        assert!((slid.duration / after::duration(&STEEL, 0.1, 0.9) - 1.0).abs() < 5e-3, "{slid:?}");
        assert!((slid.distance / after::distance(&STEEL, 0.1, 0.9) - 1.0).abs() < 5e-3, "{slid:?}");
        let steps = 100.0 * duration(0.1) / during::slip_time(&STEEL, 0.1, omega(0.1, 1.0)).unwrap();
        let begins = Collision { restitution: 1.0, steps, ..collision }.slip_compression().unwrap();
        // A hundredth of the time until slip begins.
        assert!((begins / during::slip_compression(&STEEL, omega(0.1, 1.0)) - 1.0).abs() < 0.03, "{begins}");
    }
}
