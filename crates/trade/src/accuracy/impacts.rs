//! Errors of single impacts at every phase of the time step.

use granule_law_api::{ContactEnd, Impact, Slot};
use granule_plan::{Plan, SingleImpact};
use granule_reference::Collision;

use crate::single::{Motion, ends, run, sizes};

/// Phases of the step at which the contact begins.
const PHASES: u32 = 48;
/// The golden ratio, whose multiples cover an interval evenly, however many there are.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// A contact that begins just before the end of a step: where forces rise steeply from touch on, as with dampers that grow with
/// a root of the overlap, the next step misses most.
const LATE: f64 = 0.998;
/// Tangential over normal velocity of the oblique impacts.
const OBLIQUE: f64 = 1.0;

/// Which phases are tried.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Phases {
    /// Those of a prediction.
    First,
    /// As many others.
    Others,
}

/// Every kind of impact of a plan, with its exact result.
pub struct Impacts {
    cases: Vec<Case>,
}

struct Case {
    impact: SingleImpact,
    /// Velocities, and spins times radius, of both bodies after the impact \[m/s\].
    after: Motion,
    /// Time that the contact takes \[s\].
    duration: f64,
}

impl Impacts {
    /// The impacts of all compositions of a plan: the lightest and the heaviest pair, head-on and, where bodies turn,
    /// oblique, at the impact speed of the plan.
    ///
    /// # Errors
    /// A law has no result, for example because the contact never ends.
    pub fn of(plan: &Plan) -> Result<Self, String> {
        let mut cases = Vec::new();
        for (composition, laws) in plan.compositions.iter().enumerate() {
            if !laws.stages.iter().any(|stage| stage.slot == Slot::Normal) {
                continue;
            }
            let normal_speed = laws.context.impact_speed;
            for (reduced_mass, reduced_radius) in sizes(&laws.context) {
                for inertia_factor in ends(laws.context.inertia_factor) {
                    for tangential in if plan.rotation { vec![0.0, OBLIQUE] } else { vec![0.0] } {
                        let impact = SingleImpact {
                            composition,
                            impact: Impact { reduced_mass, reduced_radius, normal_speed },
                            inertia_factor,
                            tangential,
                            gap: 0.0,
                            step: 1.0,
                        };
                        cases.push(case(plan, impact)?);
                    }
                }
            }
        }
        if cases.is_empty() { Err("no law acts along the normal".into()) } else { Ok(Self { cases }) }
    }

    /// The worst error of a velocity after an impact, over the normal speed before it, with a step \[s\].
    pub(super) fn worst_error(&self, plan: &Plan, step: f64, phases: Phases) -> Result<f64, String> {
        let mut worst: f64 = 0.0;
        for case in &self.cases {
            let numbers = match phases {
                Phases::First => 0..PHASES,
                Phases::Others => PHASES..2 * PHASES,
            };
            for number in numbers {
                worst = worst.max(case.error(plan, step, (f64::from(number) * GOLDEN).fract())?);
            }
            worst = worst.max(case.error(plan, step, LATE)?);
        }
        Ok(worst)
    }
}

fn case(plan: &Plan, impact: SingleImpact) -> Result<Case, String> {
    let single = impact.plan(plan, 0);
    let result = Collision::of_plan(&single).and_then(|(collision, composition)| collision.run(composition));
    let outcome = result.map_err(|error| error.to_string())?;
    let duration = match single.compositions[0].contact_end {
        ContactEnd::Force => outcome.force_duration,
        ContactEnd::Overlap => outcome.duration,
    };
    let mut after = [0.0; 12];
    for (at, body) in outcome.bodies.iter().enumerate() {
        for axis in 0..3 {
            after[6 * at + axis] = body.velocity[axis];
            after[6 * at + 3 + axis] = body.radius * body.spin[axis];
        }
    }
    Ok(Case { impact, after, duration })
}

impl Case {
    fn error(&self, plan: &Plan, step: f64, phase: f64) -> Result<f64, String> {
        let speed = self.impact.impact.normal_speed;
        let impact = SingleImpact { gap: phase * speed * step, step, ..self.impact };
        // A coarse step may lengthen the contact.
        let steps = (1.5 * self.duration / step).ceil() as u64 + 10;
        let after = run(plan, &impact, steps)?;
        let worst = after.iter().zip(&self.after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        Ok(worst / speed)
    }
}
