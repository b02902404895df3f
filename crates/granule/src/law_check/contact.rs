//! A single contact under compiled stages, history included.

use std::f64::consts::PI;

use granule_law_api::testing::Contacts;
use granule_law_api::{Columns, ContactEnd, Impact, Slot, VelocityRule};
use granule_plan::{Composition, Plan};

use super::Figures;

/// Slip over normal speed: so small that the contact sticks until its very end.
const SLIP: f64 = 1e-6;
/// Steps of the first integration within the shortest time of the contact.
const STEPS: f64 = 1000.0;
/// Two integrations agree when nothing differs by more than this.
const AGREEMENT: f64 = 5e-7;
/// Halvings of the step, at most.
const HALVINGS: usize = 7;
/// How many durations a contact may take before it counts as endless.
const PATIENCE: f64 = 50.0;

/// What comes out of one integration.
#[derive(Clone, Copy)]
struct Outcome {
    restitution: f64,
    tangential: f64,
    duration: f64,
    overlap: f64,
}

impl Outcome {
    fn values(self) -> [f64; 4] {
        [self.restitution, self.tangential, self.duration, self.overlap]
    }
}

/// Integrates with ever smaller steps; the error of a step of half the length is a quarter or a half, so that extrapolated
/// values are compared.
pub(super) fn realised(plan: &Plan, composition: &Composition, impact: Impact, q: f64) -> Figures {
    let Some((duration, shortest)) = times(composition, &impact) else {
        return Figures {
            restitution: None,
            tangential_restitution: None,
            duration: None,
            maximum_overlap: None,
        };
    };
    let run = |finer: f64| integrate(plan, composition, impact, q, duration, shortest / (STEPS * finer));
    let mut finer = 1.0;
    let mut last = run(finer);
    for _ in 0..HALVINGS {
        finer *= 2.0;
        let next = run(finer);
        let agree = last.values().iter().zip(next.values()).all(|(a, b)| {
            (a.is_infinite() && b.is_infinite())
                || (a - b).abs() <= AGREEMENT * a.abs().max(b.abs()).max(1e-300)
        });
        last = next;
        if agree {
            break;
        }
    }
    Figures {
        restitution: Some(last.restitution),
        tangential_restitution: Some(last.tangential),
        duration: Some(last.duration),
        maximum_overlap: Some(last.overlap),
    }
}

/// Duration of the contact and its shortest time.
fn times(composition: &Composition, impact: &Impact) -> Option<(f64, f64)> {
    let mut duration = None;
    let mut shortest = f64::INFINITY;
    for stage in &composition.stages {
        let Some(scale) = (stage.law.time_scale)(&stage.params, &composition.context, impact).ok().flatten()
        else {
            continue;
        };
        if stage.slot == Slot::Normal {
            duration = Some(scale.duration).filter(|duration| duration.is_finite() && *duration > 0.0);
        }
        for time in [
            scale.duration,
            PI * (impact.reduced_mass / scale.stiffness).sqrt(),
            impact.reduced_mass / scale.damping,
        ] {
            if time > 0.0 {
                shortest = shortest.min(time);
            }
        }
    }
    duration.filter(|_| shortest.is_finite()).map(|duration| (duration, shortest))
}

/// Velocity Verlet in the hard limit (Luding 1998, Eqs. (24) and (25)), with forces that see the velocity at the time of the
/// positions, or half a step earlier if that is the convention of the run.
fn integrate(
    plan: &Plan,
    composition: &Composition,
    impact: Impact,
    q: f64,
    duration: f64,
    step: f64,
) -> Outcome {
    let mass = [impact.reduced_mass, impact.reduced_mass * q / (1.0 + q)];
    let lag = match plan.conventions.velocity {
        VelocityRule::Synchronised | VelocityRule::Extrapolated => 0.5,
        VelocityRule::HalfStep => 0.0,
    };
    let mut contact = Contact::new(composition, impact);
    let mut time = 0.0;
    let mut overlap = f64::MIN_POSITIVE;
    let mut velocity = [impact.normal_speed, SLIP * impact.normal_speed];
    let mut acceleration = contact.accelerations(overlap, velocity, mass, 0.0);
    let mut outcome = Outcome { restitution: 0.0, tangential: 0.0, duration: f64::INFINITY, overlap: 0.0 };
    while time < PATIENCE * duration {
        let before = (overlap, velocity, acceleration);
        let half = [0, 1].map(|k| velocity[k] + 0.5 * step * acceleration[k]);
        overlap += step * half[0];
        let seen = [0, 1].map(|k| half[k] + lag * step * acceleration[k]);
        let memory = contact.columns.history.clone();
        acceleration = contact.accelerations(overlap, seen, mass, step);
        velocity = [0, 1].map(|k| half[k] + 0.5 * step * acceleration[k]);
        time += step;
        if before.1[0] > 0.0 && velocity[0] <= 0.0 {
            let turn = step * before.1[0] / (before.1[0] - velocity[0]);
            outcome.overlap = before.0 + 0.5 * before.1[0] * turn;
        }
        let ended = match composition.contact_end {
            ContactEnd::Force => velocity[0] < 0.0 && acceleration[0] >= 0.0,
            ContactEnd::Overlap => overlap <= 0.0,
        };
        // A plastic contact pushes no more before its overlap ends, and what it held tangentially is let go.
        let by_overlap = composition.contact_end == ContactEnd::Overlap;
        let released = by_overlap && velocity[0] < 0.0 && before.2[0] < 0.0 && acceleration[0] == 0.0;
        if ended || released {
            // Where in the step: by the state before, with the accelerations and the memory that it had.
            let at = |share: f64| {
                let part = share * step;
                let velocity = [0, 1].map(|k| before.1[k] + part * before.2[k]);
                (before.0 + part * before.1[0] + 0.5 * part * part * before.2[0], velocity)
            };
            let (mut low, mut high) = (0.0, 1.0);
            contact.columns.history = memory;
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                let (overlap, velocity) = at(middle);
                let acts = overlap > 0.0
                    && (by_overlap && !released
                        || contact.accelerations(overlap, velocity, mass, 0.0)[0] < 0.0);
                if acts { low = middle } else { high = middle }
            }
            (overlap, velocity) = at(high);
            time -= (1.0 - high) * step;
            if !released {
                outcome.duration = time;
                outcome.restitution = -velocity[0] / impact.normal_speed;
                outcome.tangential = -velocity[1] / (SLIP * impact.normal_speed);
                break;
            }
            acceleration = contact.accelerations(overlap, velocity, mass, 0.0);
        }
    }
    outcome
}

/// The columns of one contact, and what its stages say.
struct Contact<'a> {
    composition: &'a Composition,
    columns: Contacts<f64>,
}

impl<'a> Contact<'a> {
    fn new(composition: &'a Composition, impact: Impact) -> Self {
        let mut columns = Contacts::new(1, composition.history_width);
        columns.reduced_mass[0] = impact.reduced_mass;
        columns.reduced_radius[0] = impact.reduced_radius;
        Self { composition, columns }
    }

    /// Normal and tangential acceleration at an overlap, a normal velocity and a slip, after a step.
    fn accelerations(&mut self, overlap: f64, velocity: [f64; 2], mass: [f64; 2], step: f64) -> [f64; 2] {
        // Normal along x, slip along y.
        self.columns.overlap[0] = overlap;
        self.columns.normal_velocity[0] = velocity[0];
        self.columns.tangential_velocity[1][0] = velocity[1];
        self.columns.normal_force[0] = 0.0;
        self.columns.tangential_force[1][0] = 0.0;
        let mut history = std::mem::take(&mut self.columns.history);
        for stage in &self.composition.stages {
            let own = stage.history_offset..stage.history_offset + stage.history_width;
            self.columns.history = history[own.clone()].to_vec();
            self.columns.run_with(&*stage.double, step, true, false);
            history[own].clone_from_slice(&self.columns.history);
        }
        self.columns.history = history;
        let tangential = if self.composition.writes.contains(Columns::TANGENTIAL_FORCE) {
            self.columns.tangential_force[1][0]
        } else {
            0.0
        };
        [-self.columns.normal_force[0] / mass[0], tangential / mass[1]]
    }
}
