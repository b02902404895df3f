//! Schemes applied to tiles of body rows.

use granule_state::{InstructionSet, Row};

use crate::pass::pass;
use crate::schemes::{
    ClassicVelocityVerlet, ContactResolved, Leapfrog, Scheme, SymplecticEuler, VelocityVerlet,
};

/// Rows of consecutive bodies. Columns that the layout does not have are empty.
pub struct Tile<'a> {
    /// Centre and radius.
    pub position: &'a mut [Row],
    /// Velocity and inverse mass; in the plane the third number is the spin.
    pub velocity: &'a mut [Row],
    /// Force; in the plane the third number is the torque.
    pub force: &'a [Row],
    /// Spin and inverse inertia.
    pub spin: &'a mut [Row],
    /// Torque.
    pub torque: &'a [Row],
    /// Accelerations of the last step.
    pub previous: &'a mut [Row],
    /// Angular accelerations of the last step.
    pub previous_angular: &'a mut [Row],
    /// Accelerations of the prediction.
    pub predicted: &'a mut [Row],
    /// Angular accelerations of the prediction.
    pub predicted_angular: &'a mut [Row],
    /// Inverse inertia in the plane; empty in space and for smooth discs.
    pub planar_inverse_inertia: &'a [f64],
    /// Plane motion.
    pub planar: bool,
    /// What the processor can do; the results are the same bits with all of them.
    pub instructions: InstructionSet,
}

/// What one pass over a tile reports.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pass {
    /// Square of the largest distance that a body moved in the pass \[m²\].
    pub maximum_displacement_squared: f64,
    /// Zero if every number is finite, else not a number.
    pub poison: f64,
}

/// A time integration scheme over tiles.
pub trait Integrator: Send + Sync {
    /// Name in scenes.
    fn name(&self) -> &'static str;
    /// Order of convergence for smooth forces, damping included.
    fn order(&self) -> u32;
    /// Order of convergence for smooth conservative forces.
    fn conservative_order(&self) -> u32;
    /// True if forces see velocities of the time of the positions.
    fn synchronised(&self) -> bool;
    /// True if it remembers the accelerations of the last step.
    fn needs_previous(&self) -> bool;
    /// True if it remembers the accelerations of its prediction.
    fn needs_predicted(&self) -> bool;
    /// Largest ω dt for an undamped oscillator.
    fn stability(&self) -> f64;
    /// Time of the force evaluation, as a fraction of the step.
    fn force_time(&self) -> f64;
    /// Up to the force evaluation.
    fn begin(&self, tile: &mut Tile<'_>, dt: f64) -> Pass;
    /// From the force evaluation to the end of the step.
    fn finish(&self, tile: &mut Tile<'_>, dt: f64) -> Pass;
    /// `finish` and the `begin` of the next step in one pass.
    fn finish_begin(&self, tile: &mut Tile<'_>, dt: f64) -> Pass;
}

/// The integrator of that name.
pub fn integrator(name: &str) -> Option<Box<dyn Integrator>> {
    match name {
        VelocityVerlet::NAME => Some(Box::new(VelocityVerlet)),
        ClassicVelocityVerlet::NAME => Some(Box::new(ClassicVelocityVerlet)),
        ContactResolved::NAME => Some(Box::new(ContactResolved)),
        Leapfrog::NAME => Some(Box::new(Leapfrog)),
        SymplecticEuler::NAME => Some(Box::new(SymplecticEuler)),
        _ => None,
    }
}

impl<S: Scheme> Integrator for S {
    fn name(&self) -> &'static str {
        S::NAME
    }
    fn order(&self) -> u32 {
        S::ORDER
    }
    fn conservative_order(&self) -> u32 {
        S::CONSERVATIVE_ORDER
    }
    fn synchronised(&self) -> bool {
        S::SYNCHRONISED
    }
    fn needs_previous(&self) -> bool {
        S::PREVIOUS
    }
    fn needs_predicted(&self) -> bool {
        S::PREDICTED
    }
    fn stability(&self) -> f64 {
        S::STABILITY
    }
    fn force_time(&self) -> f64 {
        S::FORCE_TIME
    }
    fn begin(&self, tile: &mut Tile<'_>, dt: f64) -> Pass {
        pass::<S, false, true>(tile, dt)
    }
    fn finish(&self, tile: &mut Tile<'_>, dt: f64) -> Pass {
        pass::<S, true, false>(tile, dt)
    }
    fn finish_begin(&self, tile: &mut Tile<'_>, dt: f64) -> Pass {
        pass::<S, true, true>(tile, dt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [&str; 5] = [
        VelocityVerlet::NAME,
        ClassicVelocityVerlet::NAME,
        ContactResolved::NAME,
        Leapfrog::NAME,
        SymplecticEuler::NAME,
    ];

    /// One body of unit mass; returns position and velocity after `steps` steps of force f(x, v).
    fn run(name: &str, steps: usize, time: f64, force: fn(f64, f64) -> f64, fused: bool) -> (f64, f64) {
        let scheme = integrator(name).unwrap();
        let dt = time / steps as f64;
        let mut position = [Row::new([1.0, 0.0, 0.0], 0.1)];
        let mut velocity = [Row::new([0.5, 0.0, 0.0], 1.0)];
        let mut forces = [Row::new([force(1.0, 0.5), 0.0, 0.0], 0.0)];
        let (mut previous, mut predicted) = (forces, [Row::ZERO]);
        macro_rules! tile {
            () => {
                Tile {
                    position: &mut position,
                    velocity: &mut velocity,
                    force: &forces,
                    spin: &mut [],
                    torque: &[],
                    previous: &mut previous,
                    previous_angular: &mut [],
                    predicted: &mut predicted,
                    predicted_angular: &mut [],
                    planar_inverse_inertia: &[],
                    planar: false,
                    instructions: InstructionSet::detect(),
                }
            };
        }
        scheme.begin(&mut tile!(), dt);
        for step in 0..steps {
            forces[0][0] = force(position[0][0], velocity[0][0]);
            if step + 1 == steps {
                scheme.finish(&mut tile!(), dt);
            } else if fused {
                scheme.finish_begin(&mut tile!(), dt);
            } else {
                scheme.finish(&mut tile!(), dt);
                scheme.begin(&mut tile!(), dt);
            }
        }
        (position[0][0], velocity[0][0])
    }

    /// Measured order of convergence from the differences of three successive halvings of the step.
    fn measured_order(name: &str, force: fn(f64, f64) -> f64) -> f64 {
        let at = |steps| {
            let (x, v) = run(name, steps, 2.0, force, true);
            [x, v]
        };
        let (coarse, middle, fine) = (at(400), at(800), at(1600));
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        (distance(coarse, middle) / distance(middle, fine)).log2()
    }

    #[test]
    fn each_scheme_has_the_order_that_it_states() {
        for name in NAMES {
            let scheme = integrator(name).unwrap();
            let damped = measured_order(name, |x, v| -x - 0.4 * v);
            let conservative = measured_order(name, |x, _| -x);
            // The next term of the error expansion is smaller by ω dt = 1/200.
            assert!(
                (damped - f64::from(scheme.order())).abs() < 0.05,
                "{name}: measured {damped} with damping"
            );
            assert!(
                (conservative - f64::from(scheme.conservative_order())).abs() < 0.05,
                "{name}: measured {conservative} without damping"
            );
        }
    }

    #[test]
    fn fusing_two_steps_changes_no_bit() {
        for name in NAMES {
            let separate = run(name, 137, 3.0, |x, v| -x - 0.4 * v, false);
            let fused = run(name, 137, 3.0, |x, v| -x - 0.4 * v, true);
            assert_eq!(separate.0.to_bits(), fused.0.to_bits(), "{name}");
            assert_eq!(separate.1.to_bits(), fused.1.to_bits(), "{name}");
        }
    }

    /// Rows with all kinds of numbers after a pass of each kind.
    fn rows_after(name: &str, instructions: InstructionSet) -> (Vec<Row>, Pass) {
        let mut state = 12345u32;
        let mut number = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 23) - 1.0
        };
        let mut rows = || -> Vec<Row> {
            // An odd number of bodies, one of them frozen.
            (0..7).map(|body| Row::new([number(), number(), number()], f64::from(body))).collect()
        };
        let [mut position, mut velocity, mut spin, mut previous, mut previous_angular, mut force, mut torque] =
            std::array::from_fn(|_| rows());
        let (mut predicted, mut predicted_angular) = (vec![Row::ZERO; 7], vec![Row::ZERO; 7]);
        for row in force.iter_mut().chain(&mut torque).chain(&mut previous).chain(&mut previous_angular) {
            row[3] = 0.0;
        }
        let scheme = integrator(name).unwrap();
        let mut tile = Tile {
            position: &mut position,
            velocity: &mut velocity,
            force: &force,
            spin: &mut spin,
            torque: &torque,
            previous: &mut previous,
            previous_angular: &mut previous_angular,
            predicted: &mut predicted,
            predicted_angular: &mut predicted_angular,
            planar_inverse_inertia: &[],
            planar: false,
            instructions,
        };
        scheme.begin(&mut tile, 0.01);
        let pass = scheme.finish_begin(&mut tile, 0.01);
        scheme.finish(&mut tile, 0.01);
        ([position, velocity, spin, previous, previous_angular, predicted, predicted_angular].concat(), pass)
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        for name in NAMES {
            let (rows, pass) = rows_after(name, InstructionSet::Baseline);
            assert_eq!((rows.clone(), pass), rows_after(name, InstructionSet::detect()), "{name}");
            assert!(pass.maximum_displacement_squared > 0.0 && pass.poison == 0.0);
            for (body, row) in rows[..7].iter().enumerate() {
                assert_eq!(row[3], body as f64, "the radius is no coordinate");
            }
        }
    }

    #[test]
    fn the_stability_limit_is_where_it_is_stated() {
        for name in NAMES {
            let limit = integrator(name).unwrap().stability();
            let amplitude = |dt: f64| run(name, 1000, 1000.0 * dt, |x, _| -x, true).0.abs();
            assert!(amplitude(0.99 * limit) < 1e3, "{name} grows below its limit");
            assert!(amplitude(1.01 * limit) > 1e10, "{name} stays bounded above its limit");
        }
    }

    #[test]
    fn non_finite_numbers_poison_the_pass() {
        let scheme = integrator("VelocityVerlet").unwrap();
        let forces = [Row::ZERO, Row::new([0.0, f64::NAN, 0.0], 0.0)];
        let pass = scheme.begin(
            &mut Tile {
                position: &mut [Row::ZERO; 2],
                velocity: &mut [Row::new([0.0; 3], 1.0); 2],
                force: &forces,
                spin: &mut [],
                torque: &[],
                previous: &mut [Row::ZERO; 2],
                previous_angular: &mut [],
                predicted: &mut [],
                predicted_angular: &mut [],
                planar_inverse_inertia: &[],
                planar: false,
                instructions: InstructionSet::detect(),
            },
            1.0,
        );
        assert!(pass.poison.is_nan());
    }
}
