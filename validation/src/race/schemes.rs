//! One damped contact under other schemes than ours: sub-steps, where and while contacts need them, and higher order.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;

use super::contests::CONTESTS;
use super::runner::Racer;

/// Phases of the step against the contact.
const PHASES: usize = 200;
/// Evaluations of the force law in a contact.
const EVALUATIONS: [f64; 6] = [20.0, 40.0, 80.0, 160.0, 320.0, 640.0];

/// What the number of steps in a contact is off a whole one.
const OFF: f64 = 0.381_966;

/// Spring and dashpot of unit mass and stiffness that act while the bodies overlap.
struct Oscillator {
    damping: f64,
}

impl Oscillator {
    fn with_restitution(restitution: f64) -> Self {
        let log = restitution.ln();
        Self { damping: -2.0 * log / PI.hypot(log) }
    }

    fn contact(&self) -> f64 {
        PI / (1.0 - 0.25 * self.damping * self.damping).sqrt()
    }

    fn acceleration(&self, [overlap, speed]: [f64; 2]) -> f64 {
        if overlap > 0.0 { -overlap - self.damping * speed } else { 0.0 }
    }

    /// Velocity Verlet with synchronised velocities, as ours: the damper sees the velocity predicted with the last force.
    fn verlet(&self, [x, v]: [f64; 2], h: f64, last: &mut f64) -> [f64; 2] {
        let half = v + 0.5 * h * *last;
        let x = x + h * half;
        *last = self.acceleration([x, half + 0.5 * h * *last]);
        [x, half + 0.5 * h * *last]
    }

    /// Classical Runge-Kutta of order 4.
    fn runge_kutta(&self, y: [f64; 2], h: f64) -> [f64; 2] {
        let rate = |y: [f64; 2]| [y[1], self.acceleration(y)];
        let at = |k: [f64; 2], part: f64| [y[0] + part * h * k[0], y[1] + part * h * k[1]];
        let k1 = rate(y);
        let k2 = rate(at(k1, 0.5));
        let k3 = rate(at(k2, 0.5));
        let k4 = rate(at(k3, 1.0));
        let sum = |i: usize| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        [sum(0), sum(1)]
    }

    /// Forest and Ruth, 1990: three steps of drift, kick and drift, of order 4. A damper is kicked implicitly with its own half.
    fn forest_ruth(&self, [mut x, mut v]: [f64; 2], h: f64) -> [f64; 2] {
        let outer = 1.0 / (2.0 - 2.0_f64.cbrt());
        for part in [outer, 1.0 - 2.0 * outer, outer] {
            let h = part * h;
            x += 0.5 * h * v;
            if x > 0.0 {
                let damped = 0.5 * h * self.damping;
                v = (v * (1.0 - damped) - h * x) / (1.0 + damped);
            }
            x += 0.5 * h * v;
        }
        [x, v]
    }
}

/// A scheme, and the evaluations of the force law that a step in a contact takes.
#[derive(Clone, Copy, PartialEq)]
enum Scheme {
    Verlet,
    /// Every step with contact is divided by so much.
    SubSteps(u32),
    /// Only steps in which a contact begins or ends are.
    SubStepsAtEnds(u32),
    ForestRuth,
    RungeKutta,
}

impl Scheme {
    const ALL: [(Self, &'static str); 5] = [
        (Self::Verlet, "velocity Verlet"),
        (Self::SubSteps(4), "velocity Verlet, contacts in 4 sub-steps"),
        (Self::SubStepsAtEnds(8), "velocity Verlet, first and last step of contacts in 8 sub-steps"),
        (Self::ForestRuth, "Forest and Ruth, order 4"),
        (Self::RungeKutta, "Runge and Kutta, order 4"),
    ];

    /// Steps in a contact for so many evaluations.
    fn steps(self, evaluations: f64) -> f64 {
        match self {
            Self::Verlet => evaluations,
            Self::SubSteps(parts) => evaluations / f64::from(parts),
            Self::SubStepsAtEnds(parts) => evaluations - 2.0 * f64::from(parts - 1),
            Self::ForestRuth => evaluations / 3.0,
            Self::RungeKutta => evaluations / 4.0,
        }
    }

    /// Rebound speed at a phase of the step, between 0 and 1.
    fn rebound(self, contact: &Oscillator, steps: f64, phase: f64) -> f64 {
        // No whole number of steps in a contact: else the errors of its beginning and end would cancel.
        let h = contact.contact() / (steps + OFF);
        let mut y = [-phase * h, 1.0];
        let mut last = 0.0;
        for _ in 0..(20.0 * steps) as u32 {
            let parts = |count: u32, last: &mut f64| {
                (0..count).fold(y, |y, _| contact.verlet(y, h / f64::from(count), last))
            };
            let next = match self {
                Self::Verlet => contact.verlet(y, h, &mut last),
                Self::SubSteps(count) | Self::SubStepsAtEnds(count) => {
                    let mut plain = last;
                    let whole = contact.verlet(y, h, &mut plain);
                    let changes = (y[0] > 0.0) != (whole[0] > 0.0);
                    let throughout = matches!(self, Self::SubSteps(_)) && y[0] > 0.0;
                    if changes || throughout {
                        parts(count, &mut last)
                    } else {
                        last = plain;
                        whole
                    }
                }
                Self::ForestRuth => contact.forest_ruth(y, h),
                Self::RungeKutta => contact.runge_kutta(y, h),
            };
            y = next;
            if y[0] <= 0.0 && y[1] < 0.0 {
                // A force that Verlet still has half of.
                return -(y[1] + 0.5 * h * last);
            }
        }
        f64::NAN
    }

    fn worst(self, contact: &Oscillator, restitution: f64, evaluations: f64) -> f64 {
        let steps = self.steps(evaluations);
        (0..PHASES)
            .map(|phase| (phase as f64 + 0.5) / PHASES as f64)
            .map(|phase| (self.rebound(contact, steps, phase) - restitution).abs())
            .fold(0.0, f64::max)
    }
}

/// Prints and writes the table of largest errors of e_n.
///
/// # Errors
/// A run of ours fails, or the file cannot be written.
pub fn schemes(out: &Path) -> Result<(), String> {
    let mut text = String::new();
    let heads = EVALUATIONS.map(|count| format!("{count}")).join(" | ");
    let restitution = super::contests::RESTITUTION;
    // Writing to a string cannot fail.
    let _ = writeln!(text, "| evaluations of the law in a contact, e_n = {restitution} | {heads} |");
    let _ = writeln!(text, "|---|{}", "---:|".repeat(EVALUATIONS.len()));
    let contact = Oscillator::with_restitution(restitution);
    for (scheme, name) in Scheme::ALL {
        let errors = EVALUATIONS.map(|count| match scheme.steps(count) {
            steps if steps < 4.0 => "-".to_string(),
            _ => format!("{:.1e}", scheme.worst(&contact, restitution, count)),
        });
        let _ = writeln!(text, "| {name} | {} |", errors.join(" | "));
    }
    let contest = CONTESTS.iter().find(|contest| contest.name == "restitution").ok_or("no such contest")?;
    let scenes = (contest.scenes)(contest.stiffnesses[0]);
    let mut errors = Vec::new();
    for count in EVALUATIONS {
        // About eight evaluations more where a contact begins, and as many where it ends.
        let steps = count - 16.0;
        if steps < 10.0 {
            errors.push("-".to_string());
            continue;
        }
        let run = Racer::Ours("ContactResolved").run(&scenes[0], steps, contest.frames)?.run;
        let last = run.last().ok_or("no state")?;
        let worst = last
            .velocity
            .chunks(2)
            .map(|pair| (pair[1][0] - pair[0][0] - restitution).abs())
            .fold(0.0, f64::max);
        errors.push(format!("{worst:.1e}"));
    }
    let _ = writeln!(text, "| `ContactResolved` | {} |", errors.join(" | "));
    println!("{text}");
    std::fs::create_dir_all(out).map_err(|error| error.to_string())?;
    granule_formats::atomic::write(out.join("schemes.md"), text.as_bytes()).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Schemes converge to e_n, and where nothing jumps the ones of order 4 do so with order 4: an elastic spring from its largest
    /// overlap on.
    #[test]
    fn schemes_have_their_order() {
        let contact = Oscillator { damping: 0.0 };
        let error = |steps: u32, step: &dyn Fn([f64; 2], f64) -> [f64; 2]| {
            let y = (0..steps).fold([1.0, 0.0], |y, _| step(y, 1.0 / f64::from(steps)));
            (y[0] - 1.0_f64.cos()).hypot(y[1] + 1.0_f64.sin())
        };
        for step in [&(|y, h| contact.forest_ruth(y, h)) as &dyn Fn([f64; 2], f64) -> [f64; 2], &|y, h| {
            contact.runge_kutta(y, h)
        }] {
            let ratio = error(20, step) / error(40, step);
            // The next term is smaller by the square of a step of 1/20.
            assert!((ratio / 16.0 - 1.0).abs() < 0.1, "{ratio}");
        }
        for (scheme, name) in Scheme::ALL {
            let damped = Oscillator::with_restitution(0.9);
            let (coarse, fine) = (scheme.worst(&damped, 0.9, 320.0), scheme.worst(&damped, 0.9, 1280.0));
            assert!(fine < 0.5 * coarse && fine < 2e-3, "{name}: {coarse} {fine}");
        }
    }
}
