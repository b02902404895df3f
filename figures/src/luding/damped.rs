//! Fig. 5: the damped linear contact.

use std::f64::consts::PI;

use granule_law_api::{ContactEnd, oscillator};
use granule_report::{Axis, Colour, Plot, Series};

use crate::simulate::Run;
use crate::{Error, Figure, spread};

/// Steps in π/ω0.
const STEPS: f64 = 4000.0;
/// Impact speed \[m/s\].
const SPEED: f64 = 0.1;

pub(super) fn figures() -> Result<Vec<Figure>, Error> {
    Ok(vec![forces()?, outcome()?])
}

/// One impact on a wall, in units of its own: time in 1/ω0, force in k v_0/ω0.
struct Impact {
    time: Vec<f64>,
    force: Vec<f64>,
    /// Duration until the force vanishes, times ω0.
    duration: f64,
    restitution: f64,
}

/// A sphere of mass 4π/3 mg and stiffness 1e4 N/m hits a wall. `ratio` is η/ω.
fn impact(ratio: f64, end: ContactEnd) -> Result<Impact, Error> {
    let (mass, stiffness): (f64, f64) = (4.0 / 3.0 * PI * 1e-6, 1e4);
    let natural = (stiffness / mass).sqrt();
    let damping_ratio = ratio / f64::hypot(1.0, ratio);
    let damping = 2.0 * damping_ratio * (stiffness * mass).sqrt();
    let step = PI / natural / STEPS;
    let longest = 1.5 * oscillator::duration(damping_ratio, end) / natural;
    let mut run = Run::new(&format!(
        r#"(version: 1, materials: {{ "a": (density: 1000) }},
        bodies: [Sphere(material: "a", radius: 1e-3, position: (0, 0, 1e-3), velocity: (0, 0, -{SPEED}))],
        walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), contact_end: {end:?},
            normal: LinearSpringDashpot(stiffness: {stiffness}, damping: {damping}))],
        driver: TimeStep(step: {step:e}), run: (duration: {longest}))"#
    ))?;
    let unit = stiffness * SPEED / natural;
    // At touch the engine may see no overlap yet; the damper acts at once.
    let (mut time, mut force) = (vec![0.0], vec![2.0 * damping_ratio]);
    let mut duration = f64::NAN;
    for index in 1..=run.steps() {
        run.advance(index)?;
        let body = run.bodies()[0];
        let (now, pushes) = (run.time() * natural, body.force[2] / unit);
        let over = match end {
            ContactEnd::Force => pushes <= 0.0 && body.velocity[2] > 0.0,
            ContactEnd::Overlap => body.position[2] >= 1e-3,
        };
        if over {
            // The last force and the one before lead to the zero between the steps.
            let [before, last] = [force[force.len() - 2], force[force.len() - 1]];
            let ahead = if before > last && end == ContactEnd::Force { last / (before - last) } else { 0.5 };
            duration = time[time.len() - 1] + ahead.min(1.0) * PI / STEPS;
            break;
        }
        time.push(now);
        force.push(pushes);
    }
    let velocity = run.bodies()[0].velocity[2];
    Ok(Impact { time, force, duration, restitution: velocity / SPEED })
}

fn forces() -> Result<Figure, Error> {
    let mut plot = Plot::new(
        "Fig. 5(a): force during a damped contact",
        Axis::linear("t / t_c"),
        Axis::linear("f / (k v_0 / ω_0)"),
    );
    let mut worst: f64 = 0.0;
    let mut markers = Vec::new();
    for (ratio, colour) in [0.0, 0.1, 0.5, 1.0, 2.0].into_iter().zip(Colour::PALETTE) {
        let beta = ratio / f64::hypot(1.0, ratio);
        let omega = ((1.0 - beta) * (1.0 + beta)).sqrt();
        // f/(k v_0/ω0) with time in 1/ω0: δ = exp(-βt) sin(ωt)/ω, Luding 1998, Eqs. (29)-(30).
        let force = |t: f64| {
            let decay = (-beta * t).exp();
            let overlap = decay * (omega * t).sin() / omega;
            let rate = decay * ((omega * t).cos() - beta / omega * (omega * t).sin());
            overlap + 2.0 * beta * rate
        };
        let times = spread(0.0, PI / omega, 240);
        let in_units = |times: &[f64]| times.iter().map(|t| t * omega / PI).collect::<Vec<_>>();
        let line = times.iter().map(|t| force(*t)).collect();
        plot = plot.with(Series::line(format!("η/ω = {ratio}"), in_units(&times), line).with_colour(colour));
        let run = impact(ratio, ContactEnd::Force)?;
        for (t, f) in run.time.iter().zip(&run.force).skip(1) {
            worst = worst.max((f - force(*t)).abs());
        }
        let every = run.time.len() / 14 + 1;
        let pick = |values: &[f64]| values.iter().copied().step_by(every).collect::<Vec<_>>();
        let name = if ratio == 0.0 { "engine" } else { "" };
        markers.push(Series::points(name, in_units(&pick(&run.time)), pick(&run.force)).with_colour(colour));
    }
    for series in markers {
        plot = plot.with(series);
    }
    Ok(Figure {
        name: "fig5a",
        plot: plot.with_size(720.0, 460.0),
        caption: format!(
            "Lines: Luding 1998, Eqs. (29)-(30), up to the end of the overlap at t_c = π/ω. Markers: the engine with \
             `contact_end: Force`, which ends the contact where the force would begin to attract. Largest difference of all \
             {STEPS} steps in a contact: {worst:.1e} of k v_0/ω_0."
        ),
    })
}

fn outcome() -> Result<Figure, Error> {
    let ratios = spread(0.0, 3.0, 241);
    let on = |of: &dyn Fn(f64) -> f64| ratios.iter().map(|ratio| of(*ratio)).collect::<Vec<_>>();
    let beta = |ratio: f64| ratio / f64::hypot(1.0, ratio);
    let exact = |ratio: f64, end| oscillator::restitution(beta(ratio), end);
    let tau = |ratio: f64| 1.0 - 2.0 * ratio.atan() / PI;
    // The principal value jumps at η = ω; there the line breaks.
    let printed = |ratio: f64| match ratio {
        1.0 => f64::NAN,
        ratio => 1.0 - (2.0 * ratio / (1.0 - ratio * ratio)).atan() / PI,
    };
    let mut plot = Plot::new(
        "Fig. 5(b): duration and restitution of a damped contact",
        Axis::linear("η/ω"),
        Axis::linear("τ_f = t_c^f/t_c, e_n, e_n^f").with_range(0.0, 1.55),
    )
    .with(Series::line("τ_f, Eq. (36), second form", ratios.clone(), on(&tau)))
    .with(Series::line("e_n, Eq. (32)", ratios.clone(), on(&|ratio| exact(ratio, ContactEnd::Overlap))))
    .with(Series::line("e_n^f, corrected", ratios.clone(), on(&|ratio| exact(ratio, ContactEnd::Force))))
    .with(Series::dashed("τ_f, Eq. (36), first form as printed", ratios.clone(), on(&printed)));
    let samples = spread(0.0, 3.0, 16);
    let (mut durations, mut force_ended, mut overlap_ended) = (Vec::new(), Vec::new(), Vec::new());
    let mut worst: f64 = 0.0;
    for &ratio in &samples {
        let omega = 1.0 / f64::hypot(1.0, ratio);
        let by_force = impact(ratio, ContactEnd::Force)?;
        let by_overlap = impact(ratio, ContactEnd::Overlap)?;
        durations.push(by_force.duration * omega / PI);
        force_ended.push(by_force.restitution);
        overlap_ended.push(by_overlap.restitution);
        worst = worst
            .max((by_force.restitution - exact(ratio, ContactEnd::Force)).abs())
            .max((by_overlap.restitution - exact(ratio, ContactEnd::Overlap)).abs())
            .max((by_force.duration * omega / PI - tau(ratio)).abs());
    }
    plot = plot
        .with(Series::points("τ_f, engine", samples.clone(), durations))
        .with(Series::points("e_n, engine, contact_end: Overlap", samples.clone(), overlap_ended))
        .with(Series::points("e_n^f, engine, contact_end: Force", samples, force_ended));
    Ok(Figure {
        name: "fig5b",
        plot: plot.with_size(720.0, 460.0),
        caption: format!(
            "A contact that ends when the force vanishes is shorter and bounces more than Eq. (32) says (erratum L-E7). The \
             first form of Eq. (36) is wrong beyond η = ω (erratum L-E8): the dashed line leaves the runs there. Largest \
             difference between engine and corrected lines: {worst:.1e}."
        ),
    })
}
