//! Checks `oracle`, `energy` and `time scale` of normal laws: a head-on impact.

use super::{Case, Contacts, IMPACT, NORMAL_STIFFNESS, Report};
use crate::{ContactEnd, Impact, ImpactOutcome, Oracle, Slot, Stage, TimeScale};

/// Steps of the coarsest of three integrations.
const STEPS: f64 = 8000.0;

pub(super) fn check(case: &Case<'_>, stage: &dyn Stage<f64>, report: &mut Report) {
    let oracle = match (case.law.oracle)(case.params, case.pair) {
        Oracle::Normal(oracle) => oracle,
        Oracle::Missing => {
            return report
                .fail("oracle", "oracle missing: give ContactLaw::oracle a closed form".to_string());
        }
        Oracle::Tangential(_) => {
            return report.fail("oracle", "a tangential oracle cannot describe a head-on impact".to_string());
        }
    };
    for speed in [1.0, 0.1] {
        let impact = Impact { normal_speed: speed * IMPACT.normal_speed, ..IMPACT };
        let expected = oracle(&impact);
        match (case.law.time_scale)(case.params, case.pair, &impact) {
            Ok(Some(scale)) => {
                time_scale(&scale, &expected, report);
                collide(case, stage, &impact, &expected, &scale, report);
            }
            Ok(None) => report.fail("time scale", "a normal law has a time scale".to_string()),
            Err(error) => report.fail("time scale", error.to_string()),
        }
    }
}

fn time_scale(scale: &TimeScale, expected: &ImpactOutcome, report: &mut Report) {
    let near = |told: f64, true_value: f64| told >= 0.5 * true_value && told <= 2.0 * true_value;
    let duration = if expected.duration.is_finite() {
        near(scale.duration, expected.duration)
    } else {
        scale.duration > 0.0
    };
    if !duration || !scale.duration.is_finite() {
        report.fail(
            "time scale",
            format!("the duration is {} s, the oracle's {} s", scale.duration, expected.duration),
        );
    }
    if !near(scale.overlap, expected.maximum_overlap) {
        report.fail(
            "time scale",
            format!("the overlap is {} m, the oracle's {} m", scale.overlap, expected.maximum_overlap),
        );
    }
    if !(scale.stiffness > 0.0 && scale.stiffness.is_finite() && scale.damping >= 0.0) {
        report.fail("time scale", format!("the stiffness or damping is not sensible: {scale:?}"));
    }
}

/// Impact by time steps. All energies are in units of the energy of the impact.
struct Measured {
    outcome: ImpactOutcome,
    /// Largest gain of kinetic and stored energy together.
    gain: f64,
    /// What the account misses at the end.
    missing: f64,
}

fn collide(
    case: &Case<'_>,
    stage: &dyn Stage<f64>,
    impact: &Impact,
    expected: &ImpactOutcome,
    scale: &TimeScale,
    report: &mut Report,
) {
    // Strong dampers and stiff branches act faster than the contact lasts.
    let damper = impact.reduced_mass / scale.damping.max(f64::MIN_POSITIVE);
    let spring = std::f64::consts::PI * (impact.reduced_mass / scale.stiffness).sqrt();
    let shortest = scale.duration.min(damper).min(spring);
    // A law that remembers may change its branch within a step: the share of a step at which it does so leaves an error of
    // up to (2 π/32000)² that does not shrink regularly.
    let irregular = if case.law.info.history_width() > 0 { 4e-8 } else { 1e-9 };
    let runs: [Measured; 3] = [1.0, 2.0, 4.0]
        .map(|finer| integrate(case, stage, impact, scale.duration, shortest / (STEPS * finer)));
    let mut compare = |name: &str, of: &dyn Fn(&ImpactOutcome) -> f64| {
        let [a, b, c] = [0, 1, 2].map(|run: usize| of(&runs[run].outcome));
        let wanted = of(expected);
        if wanted.is_infinite() && a.is_infinite() && b.is_infinite() && c.is_infinite() {
            return;
        }
        // The scheme is of second order, or of order 5/4 where the force starts with a root: what is left of the error of
        // the finest run is at most the last difference.
        let error = 3.0 * (c - b).abs() + irregular * wanted.abs();
        if error.is_nan() || error > 1e-5 * wanted.abs().max(c.abs()) {
            report.fail("oracle", format!("{name} does not converge: {a}, {b}, {c} with steps 1, 1/2, 1/4"));
        } else if (c - wanted).abs() > error {
            report.fail(
                "oracle",
                format!(
                    "{name} at {} m/s is {c} with a step error of {error:.1e}, but the oracle says {wanted}",
                    impact.normal_speed
                ),
            );
        }
    };
    compare("the duration", &|outcome| outcome.duration);
    compare("the largest overlap", &|outcome| outcome.maximum_overlap);
    if expected.duration.is_finite() {
        compare("the restitution", &|outcome| outcome.restitution);
    }
    let [_, b, c] = &runs;
    let gain_error = 3.0 * (c.gain - b.gain).abs() + 1e-9;
    if (case.law.dissipative)(case.params) && c.gain > gain_error {
        report.fail(
            "energy",
            format!("an impact at {} m/s gains {:e} of its energy", impact.normal_speed, c.gain),
        );
    }
    let missing_error = 3.0 * (c.missing - b.missing).abs() + 1e-8;
    if c.missing.abs() > missing_error {
        report.fail(
            "energy",
            format!(
                "elastic and dissipated energy miss {:e} of the work done in an impact at {} m/s (step error {missing_error:.1e})",
                c.missing, impact.normal_speed
            ),
        );
    }
}

fn integrate(case: &Case<'_>, stage: &dyn Stage<f64>, impact: &Impact, duration: f64, step: f64) -> Measured {
    let mass = impact.reduced_mass;
    let cohesion = case.law.info.slot == Slot::Cohesion;
    let mut contact = Contacts::<f64>::new(1, case.law.info.history_width());
    contact.reduced_mass[0] = mass;
    contact.reduced_radius[0] = impact.reduced_radius;
    contact.normal_stiffness[0] = NORMAL_STIFFNESS;
    // Force, stored energy and dissipated power of the law, and of the elastic spring under a cohesion law.
    let evaluate = |contact: &mut Contacts<f64>, overlap: f64, velocity: f64, step: f64| {
        contact.overlap[0] = overlap;
        contact.normal_velocity[0] = velocity;
        contact.normal_force[0] = if cohesion { NORMAL_STIFFNESS * overlap } else { 0.0 };
        contact.run_with(stage, step, !cohesion, true);
        let spring = if cohesion { 0.5 * NORMAL_STIFFNESS * overlap * overlap } else { 0.0 };
        (contact.normal_force[0], contact.elastic[0] + spring, contact.viscous[0] + contact.friction[0])
    };
    let unit = 0.5 * mass * impact.normal_speed * impact.normal_speed;
    let (mut time, mut overlap, mut velocity) = (0.0, f64::MIN_POSITIVE, impact.normal_speed);
    let (mut force, _, mut power) = evaluate(&mut contact, overlap, velocity, 0.0);
    let mut outcome = ImpactOutcome { duration: f64::INFINITY, maximum_overlap: 0.0, restitution: 0.0 };
    let (mut gain, mut missing, mut dissipated) = (f64::NEG_INFINITY, 0.0, 0.0);
    let mut earlier = force;
    let mut memory = contact.history.clone();
    // Velocity Verlet whose forces see the velocity predicted to the time of the positions.
    while time < 20.0 * duration {
        let before = (overlap, velocity);
        let half = velocity - 0.5 * step * force / mass;
        overlap += step * half;
        for (kept, column) in memory.iter_mut().zip(&contact.history) {
            kept.copy_from_slice(column);
        }
        let new = evaluate(&mut contact, overlap, half - 0.5 * step * force / mass, step);
        velocity = half - 0.5 * step * new.0 / mass;
        dissipated += 0.5 * step * (power + new.2) + contact.slipped[0];
        time += step;
        if before.1 > 0.0 && velocity <= 0.0 {
            // Top of the parabola through the state before.
            let turn = step * before.1 / (before.1 - velocity);
            outcome.maximum_overlap = before.0 + 0.5 * before.1 * turn;
        }
        let ended = match case.pair.contact_end {
            ContactEnd::Force => velocity < 0.0 && new.0 <= 0.0,
            ContactEnd::Overlap => overlap <= 0.0,
        };
        if ended {
            // Inside the step the force goes on with the slope of the step before; the end is found by bisection, with what
            // the contact remembered when the step began.
            contact.history = memory;
            let at = |share: f64| {
                let part = share * step;
                let mean = force + 0.5 * share * (force - earlier);
                (before.0 + part * before.1 - 0.5 * part * part * force / mass, before.1 - part * mean / mass)
            };
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                let (overlap, velocity) = at(middle);
                let acts = match case.pair.contact_end {
                    ContactEnd::Force => evaluate(&mut contact, overlap, velocity, 0.0).0 > 0.0,
                    ContactEnd::Overlap => overlap > 0.0,
                };
                if acts { low = middle } else { high = middle }
            }
            outcome.duration = time - step + step * high;
            outcome.restitution = -at(high).1 / impact.normal_speed;
            break;
        }
        (earlier, force, power) = (force, new.0, new.2);
        let kept = (0.5 * mass * velocity * velocity + new.1) / unit - 1.0;
        gain = gain.max(kept);
        missing = kept + dissipated / unit;
    }
    Measured { outcome, gain, missing }
}
