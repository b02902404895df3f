//! Laws tried out before they are used: do they keep to numbers, and to their promise never to create energy?
//!
//! The conformance kit ([`testing`](crate::testing)) tries the examples of a law; here it is tried with the parameters and
//! bodies of a scene. A contact is pressed, released and rubbed along closed curves. What comes out of it in the end, or out of
//! a friction at any moment, it must have taken before.

use std::f64::consts::TAU;

use crate::testing::Contacts;
use crate::{Collision, CollisionRule, Impact, LawEntry, PairContext, Params, Slot, Stage, TimeScale};

/// Steps of the coarser of two integrations.
const STEPS: u32 = 2000;
/// Share of the work that is no error of the steps.
const SMALL: f64 = 1e-4;

/// What is wrong with a law.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// It makes a number that is not finite of numbers that are.
    NotFinite {
        /// What is not finite.
        quantity: &'static str,
        /// What it was given, in words.
        given: String,
    },
    /// It promises never to create energy, and does.
    CreatesEnergy {
        /// What it created, over all work that it took and gave.
        share: f64,
        /// What was done to it, in words.
        given: String,
    },
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFinite { quantity, given } => {
                write!(f, "gives a {quantity} that is not finite for {given}")
            }
            Self::CreatesEnergy { share, given } => write!(
                f,
                "creates energy, which it promises not to do: {share:.1e} of the work comes out on top after {given}"
            ),
        }
    }
}

/// Tries a normal, cohesive or tangential law with the smallest bodies that it is compiled for, at the impact speed. Laws of
/// other slots, and those of which no time scale is known, are passed over.
///
/// # Errors
/// The fault that was found.
pub fn try_out(law: &LawEntry, params: &Params, pair: &PairContext) -> Result<(), Fault> {
    let impact = Impact {
        reduced_mass: pair.reduced_mass.min,
        reduced_radius: pair.reduced_radius.min,
        normal_speed: pair.impact_speed,
    };
    let scale = match law.info.slot {
        Slot::Normal => (law.time_scale)(params, pair, &impact).ok().flatten(),
        Slot::Cohesion | Slot::Tangential => pair.normal.and_then(|normal| normal.scale),
        Slot::Rolling | Slot::Torsion | Slot::Collision => None,
    };
    let usable =
        |scale: &TimeScale| [scale.duration, scale.overlap].iter().all(|x| x.is_finite() && *x > 0.0);
    let (Some(scale), Ok(stage)) = (scale.filter(usable), (law.compile_f64)(params, pair)) else {
        return Ok(());
    };
    if !(impact.normal_speed.is_finite() && impact.normal_speed > 0.0) {
        return Ok(());
    }
    let probe = Probe { law, params, pair, stage: stage.as_ref(), impact, scale };
    let slips: &[f64] = if law.info.slot == Slot::Tangential { &[0.1, 1.0, 10.0] } else { &[0.0] };
    slips.iter().try_for_each(|slip| probe.check(*slip))
}

struct Probe<'a> {
    law: &'a LawEntry,
    params: &'a Params,
    pair: &'a PairContext,
    stage: &'a dyn Stage<f64>,
    impact: Impact,
    scale: TimeScale,
}

impl Probe<'_> {
    fn check(&self, slip: f64) -> Result<(), Fault> {
        let coarse = self.drive(slip, STEPS)?;
        let fine = self.drive(slip, 2 * STEPS)?;
        if !(self.law.dissipative)(self.params) {
            return Ok(());
        }
        let error = 3.0 * ((fine.0 - coarse.0).abs() + (fine.1 - coarse.1).abs()) + SMALL * fine.1;
        if fine.0 <= error {
            return Ok(());
        }
        let what = match self.law.info.slot {
            Slot::Tangential => {
                format!("a slip of up to {:e} m/s along a closed curve", slip * self.impact.normal_speed)
            }
            _ => format!("overlaps of up to {:e} m that come and go", self.scale.overlap),
        };
        Err(Fault::CreatesEnergy { share: fine.0 / fine.1, given: what })
    }

    /// What the law gave beyond what it had taken, and all that it took or gave \[J\].
    fn drive(&self, slip: f64, steps: u32) -> Result<(f64, f64), Fault> {
        let slot = self.law.info.slot;
        let duration = 4.0 * self.scale.duration;
        let step = duration / f64::from(steps);
        let speed = slip * self.impact.normal_speed;
        let reach = (self.law.reach)(self.params, self.pair);
        let mut contact = Contacts::<f64>::new(1, self.law.info.history_width());
        contact.reduced_mass[0] = self.impact.reduced_mass;
        contact.reduced_radius[0] = self.impact.reduced_radius;
        let stiffness = if self.scale.stiffness.is_finite() { self.scale.stiffness } else { 0.0 };
        contact.normal_stiffness[0] = stiffness;
        let (mut out, mut most, mut turnover) = (0.0, 0.0_f64, 0.0);
        let mut last: Option<f64> = None;
        for index in 0..=steps {
            let phase = TAU * f64::from(index) / f64::from(steps);
            // Four presses of different depth, from just touching and back.
            let envelope = 0.6 - 0.4 * phase.cos();
            let press = 0.5 * (1.0 - (4.0 * phase).cos()) * envelope;
            let rate = 2.0 * (4.0 * phase).sin() * envelope + 0.2 * (1.0 - (4.0 * phase).cos()) * phase.sin();
            let depth = self.scale.overlap + reach;
            let overlap = (press * depth - reach).max(if reach > 0.0 { -reach } else { f64::MIN_POSITIVE });
            let approach = rate * depth * TAU / duration;
            let base = if slot == Slot::Normal { 0.0 } else { stiffness * overlap.max(0.0) };
            contact.overlap[0] = overlap;
            contact.normal_velocity[0] = approach;
            contact.normal_force[0] = base;
            contact.tangential_velocity[1][0] = speed * (5.0 * phase).cos();
            contact.tangential_velocity[2][0] = speed * (8.0 * phase).sin();
            contact.run(self.stage, if index == 0 { 0.0 } else { step });
            self.finite(&contact)?;
            let power = if slot == Slot::Tangential {
                [1, 2]
                    .map(|axis| contact.tangential_force[axis][0] * contact.tangential_velocity[axis][0])
                    .iter()
                    .sum()
            } else {
                -(contact.normal_force[0] - base) * approach
            };
            if let Some(last) = last {
                let work: f64 = 0.5 * step * (power + last);
                out += work;
                turnover += work.abs();
                most = most.max(out);
            }
            last = Some(power);
        }
        // A cohesive contact gives energy before it takes it back: only the whole curve counts.
        Ok((if slot == Slot::Tangential { most } else { out }, turnover))
    }

    fn finite(&self, contact: &Contacts<f64>) -> Result<(), Fault> {
        let writes = |columns: crate::Columns| self.law.info.writes.contains(columns);
        let bad = |vector: &[Vec<f64>; 3]| vector.iter().any(|column| !column[0].is_finite());
        let quantity = if !contact.normal_force[0].is_finite() {
            "normal force"
        } else if writes(crate::Columns::TANGENTIAL_FORCE) && bad(&contact.tangential_force) {
            "tangential force"
        } else if writes(crate::Columns::TORQUE) && bad(&contact.torque) {
            "torque"
        } else {
            return Ok(());
        };
        let slip = contact.tangential_velocity[1][0].hypot(contact.tangential_velocity[2][0]);
        let given = format!(
            "an overlap of {:e} m, closing at {:e} m/s, slipping at {slip:e} m/s",
            contact.overlap[0], contact.normal_velocity[0]
        );
        Err(Fault::NotFinite { quantity, given })
    }
}

/// Tries a rule of collisions at speeds from 1e-6 to 1e3 m/s and slips from none to a thousand times as much; `dissipative` if
/// it promises never to create energy.
///
/// # Errors
/// The fault that was found: an impulse that is not finite, or more energy after a collision than before.
pub fn try_collisions(rule: &dyn CollisionRule, dissipative: bool) -> Result<(), Fault> {
    for normal_speed in [1e-6, 1e-3, 1.0, 1e3] {
        for slip in [0.0, 0.1, 1.0, 10.0, 1e3] {
            let collision = Collision {
                normal_speed,
                tangential_velocity: [0.0, 0.8 * slip * normal_speed, -0.6 * slip * normal_speed],
                reduced_mass: 1.0,
                // Of a homogeneous sphere on another one.
                tangential_mass: 2.0 / 7.0,
                elastic: false,
            };
            let impulse = rule.impulse(&collision);
            let given =
                format!("a collision at {normal_speed:e} m/s with a slip of {:e} m/s", slip * normal_speed);
            let [_, y, z] = impulse.tangential;
            if [impulse.normal, impulse.tangential[0], y, z].iter().any(|number| !number.is_finite()) {
                return Err(Fault::NotFinite { quantity: "impulse", given });
            }
            let [_, u, v] = collision.tangential_velocity;
            let across = if rule.is_rough() {
                y * u + z * v + 0.5 * (y * y + z * z) / collision.tangential_mass
            } else {
                0.0
            };
            let along = impulse.normal * (0.5 * impulse.normal / collision.reduced_mass - normal_speed);
            let before =
                0.5 * normal_speed * normal_speed + 0.5 * collision.tangential_mass * (u * u + v * v);
            let share = (along + across) / before;
            if dissipative && share > 1e-9 {
                return Err(Fault::CreatesEnergy { share, given });
            }
        }
    }
    Ok(())
}
