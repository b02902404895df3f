//! The contact of Luding 1998, Eqs. (24) and (25): the normal does not turn.

use std::ops::Range;

use granule_plan::Composition;

use crate::contact::{Contact, Kinematics, Response};
use crate::path::{Accuracy, End, Event, Mechanics, integrate};
use crate::{ReferenceError, Vector, length};

/// An impact in the hard limit: the normal stays where it is, and the lever arms are the radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HardLimit {
    /// Reduced mass m12 \[kg\].
    pub reduced_mass: f64,
    /// Tangential mass m_t, 1/m_t = (1 + 1/q1)/m1 + (1 + 1/q2)/m2 \[kg\] (erratum L-E18).
    pub tangential_mass: f64,
    /// Reduced radius R* \[m\].
    pub reduced_radius: f64,
    /// Normal speed on approach \[m/s\].
    pub normal_speed: f64,
    /// Tangential speed of the contact point \[m/s\].
    pub tangential_speed: f64,
}

/// What comes out of an impact in the hard limit.
#[derive(Clone, Debug)]
pub struct HardLimitOutcome {
    /// Time until the overlap has vanished \[s\].
    pub duration: f64,
    /// Time until the normal force has vanished for good \[s\].
    pub force_duration: f64,
    /// Largest overlap \[m\].
    pub maximum_overlap: f64,
    /// e_n.
    pub restitution: f64,
    /// Tangential speed of the contact point after the impact, negative if it is reversed \[m/s\].
    pub tangential_speed: f64,
    /// Energy dissipated by damping \[J\].
    pub viscous: f64,
    /// Energy dissipated by sliding \[J\].
    pub friction: f64,
    /// What happened, in order.
    pub events: Vec<Event>,
    /// Time \[s\], overlap \[m\] and normal force \[N\] at the end of each step of the integration.
    pub samples: Vec<(f64, f64, f64)>,
    /// Estimated error of both speeds, relative to the impact speed.
    pub error: f64,
}

impl HardLimit {
    /// Integrates the impact. Slip is along x, the normal along z.
    ///
    /// # Errors
    /// A number is not allowed, or the contact does not end.
    pub fn run(&self, composition: &Composition) -> Result<HardLimitOutcome, ReferenceError> {
        let positive = [self.reduced_mass, self.tangential_mass, self.reduced_radius, self.normal_speed];
        if positive.iter().any(|value| !(value.is_finite() && *value > 0.0))
            || !self.tangential_speed.is_finite()
        {
            return Err(ReferenceError::Problem(format!("a number of the impact is not allowed: {self:?}")));
        }
        let contact = Contact::new(composition, self.reduced_mass, self.reduced_radius)?;
        let start = [self.normal_speed, self.tangential_speed, 0.0, 0.0];
        let speed = f64::hypot(self.normal_speed, self.tangential_speed);
        let unit = (
            crate::collision::time_scale(
                composition,
                self.reduced_mass,
                self.reduced_radius,
                self.normal_speed,
            ),
            0.5 * self.reduced_mass * speed * speed,
            speed,
        );
        let run = |accuracy| integrate(self, &contact, &start, accuracy, unit);
        let end = run(FINE)?;
        let coarse = run(COARSE)?;
        let difference = end
            .velocities
            .iter()
            .zip(&coarse.velocities)
            .fold(0.0, |worst: f64, (fine, coarse)| worst.max((fine - coarse).abs()));
        Ok(HardLimitOutcome {
            duration: end.time,
            force_duration: end.force_duration(),
            maximum_overlap: end.maximum_overlap,
            restitution: -end.velocities[0] / self.normal_speed,
            tangential_speed: end.velocities[1],
            viscous: end.viscous,
            friction: end.friction,
            samples: end.samples,
            events: end.events,
            error: difference / speed + FINE.tolerance,
        })
    }
}

/// The result.
pub(crate) const FINE: Accuracy = Accuracy { tolerance: 1e-12, order: 8 };
/// What it is compared with.
pub(crate) const COARSE: Accuracy = Accuracy { tolerance: 1e-10, order: 6 };

impl End {
    /// Time of the last moment at which the normal force pushed \[s\].
    pub(crate) fn force_duration(&self) -> f64 {
        use crate::EventKind::PushesNoMore;
        let last = self.events.iter().rev().find(|event| event.kind == PushesNoMore);
        last.map_or(self.time, |event| event.time)
    }
}

impl Mechanics for HardLimit {
    const SIZE: (usize, usize) = (1, 4);

    fn kinematics(&self, positions: &[f64], velocities: &[f64]) -> Kinematics {
        let tangential: Vector = [velocities[1], velocities[2], velocities[3]];
        Kinematics {
            overlap: positions[0],
            normal: [0.0, 0.0, 1.0],
            normal_velocity: velocities[0],
            tangential_velocity: [tangential[0], tangential[1], 0.0],
            relative_spin: [0.0; 3],
        }
    }

    fn accelerations(&self, _: &Kinematics, response: &Response, out: &mut [f64]) {
        out[0] = -response.normal / self.reduced_mass;
        for axis in 0..2 {
            out[1 + axis] = response.tangential[axis] / self.tangential_mass;
        }
        out[3] = 0.0;
    }

    fn groups(&self) -> Vec<(Range<usize>, f64)> {
        let speed = length([self.normal_speed, self.tangential_speed, 0.0]);
        vec![(0..1, 0.0), (1..5, speed)]
    }
}
