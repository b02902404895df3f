//! Sec. 8: contacts of many bodies at once. A column of beads that falls on a plate, and one on a vibrating plate.

use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;

use granule_drivers::driver;
use granule_report::{Axis, Colour, Plot, Series};

use crate::simulate::plan;
use crate::{Error, Figure};

const RESTITUTION: f64 = 0.9;
const RADIUS: f64 = 1e-3;
/// Impact speed \[m/s\].
const SPEED: f64 = 0.2;
/// Duration of a contact of two beads at the impact speed \[s\].
const CONTACT: f64 = 5e-5;

/// Models that are compared.
const MODELS: [&str; 4] = ["LinearSpringDashpot", "Hertz", "WaltonBraun", "hard with TC"];

/// The same restitution of a pair, and the same duration at the impact speed, by three laws, and by hard collisions that lose
/// nothing within that duration after another one.
pub(super) fn laws() -> [String; 4] {
    let mass = 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3) * 2500.0;
    // Luding 1998, Eqs. (39)-(40), for α = 1/2 and m12 = m/2, R* = R/2: t_c = 2.943275 δ_max/v.
    let largest = CONTACT * SPEED / 2.943_275;
    let stiffness = 1.25 * (0.5 * mass) * SPEED * SPEED / largest.powf(2.5);
    let modulus = stiffness * 0.75 / (0.5 * RADIUS).sqrt();
    [
        format!("normal: LinearSpringDashpot(restitution: {RESTITUTION}, contact_duration: {CONTACT})"),
        format!("normal: Hertz(effective_modulus: {modulus:e}, restitution: {RESTITUTION})"),
        format!("normal: WaltonBraun(restitution: {RESTITUTION}, contact_duration: {CONTACT})"),
        format!("collision: HardSphere(restitution: {RESTITUTION})"),
    ]
}

/// The driver of a law, with so many steps in a contact.
fn stepped(law: &str, steps: f64) -> String {
    if law.starts_with("collision") {
        format!("driver: Event(step: 5e-4, contact_duration: {CONTACT})")
    } else {
        format!("driver: TimeStep(step: {:e})", CONTACT / steps)
    }
}

/// A column of `count` beads above a plate, with `gap` below each, that moves down with `speed`.
fn scene(law: &str, count: usize, more: &str, speed: f64, gap: f64) -> String {
    let mut bodies = String::new();
    for index in 0..count {
        let height = RADIUS + gap + (2.0 * RADIUS + gap) * index as f64;
        let _ = write!(
            bodies,
            "Sphere(material: \"a\", radius: {RADIUS}, position: (0, 0, {height}), velocity: (0, 0, -{speed})), "
        );
    }
    format!(
        r#"(version: 1, materials: {{ "a": (density: 2500) }}, bodies: [{bodies}],
        contacts: [(between: ("a", "a"), {law})], {more})"#
    )
}

/// Part of the energy, by its root, that a column has after it fell on a plate and came apart.
pub(super) fn drop(law: &str, count: usize, gap: f64) -> Result<f64, Error> {
    let more = format!(
        r#"walls: {{ "plate": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        {}, run: (duration: {})"#,
        stepped(law, 100.0),
        0.01 + 0.01 * count as f64
    );
    let mut driver = driver(plan(&scene(law, count, &more, SPEED, gap))?, Some(1))?;
    let steps = driver.view().plan().driver.steps;
    driver.advance(steps, &AtomicBool::new(false))?;
    let (view, square) = (driver.view(), |v: [f64; 3]| v[2] * v[2]);
    let energy: f64 = (0..count).map(|place| square(view.bodies().velocity_of(place))).sum();
    Ok((energy / (count as f64 * SPEED * SPEED)).sqrt())
}

/// Mean height of the centre of mass over that at rest, over (A ω)²/g, of a column on a plate that vibrates with 3.5 g.
fn vibrate(law: &str, count: usize) -> Result<f64, Error> {
    const GRAVITY: f64 = 9.81;
    let frequency = 50.0;
    let omega = 2.0 * std::f64::consts::PI * frequency;
    let amplitude = 3.5 * GRAVITY / (omega * omega);
    let more = format!(
        r#"gravity: (0, 0, -{GRAVITY}),
        walls: {{ "plate": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a",
            motion: Sinusoidal(amplitude: (0, 0, {amplitude}), frequency: {frequency})) }},
        {}, run: (duration: 2)"#,
        stepped(law, 25.0)
    );
    let mut driver = driver(plan(&scene(law, count, &more, 0.0, 1e-6))?, Some(1))?;
    let (steps, mut sum, mut samples) = (driver.view().plan().driver.steps, 0.0, 0.0);
    let every = (steps / 4000).max(1);
    let rest = RADIUS * count as f64;
    for step in (0..=steps).step_by(usize::try_from(every)?) {
        driver.advance(step, &AtomicBool::new(false))?;
        // The first half second forgets the start.
        if driver.time() > 0.5 {
            let mean = driver.view().bodies().position.iter().map(|row| row[2]).sum::<f64>() / count as f64;
            sum += mean - rest;
            samples += 1.0;
        }
    }
    let speed = amplitude * omega;
    Ok(sum / samples / (speed * speed / GRAVITY))
}

pub(super) fn figures() -> Result<Vec<Figure>, Error> {
    let counts = [1, 2, 3, 4, 5, 7, 10, 14, 20];
    let numbers: Vec<f64> = counts.iter().map(|count| *count as f64).collect();
    let mut plot = Plot::new(
        "Sec. 8: a column of N beads falls on a plate",
        Axis::linear("N"),
        Axis::linear("sqrt(E after / E before)").with_range(0.0, 1.0),
    );
    let mut table = format!("| N | gaps | {} |\n|---|---|---|---|---|---|\n", MODELS.join(" | "));
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (gap, style) in [(0.0, "touching"), (1e-3, "1 mm apart")] {
        for (index, (name, law)) in MODELS.iter().zip(laws()).enumerate() {
            let mut values = Vec::new();
            for count in counts {
                values.push(drop(&law, count, gap)?);
            }
            let name = format!("{name}, {style}");
            let colour = Colour::PALETTE[index];
            let points = if gap == 0.0 {
                Series::line(name, numbers.clone(), values.clone())
            } else {
                Series::dashed(name, numbers.clone(), values.clone())
            };
            plot = plot.with(points.with_colour(colour));
            rows.push(values);
        }
    }
    for (block, style) in [(0, "touching"), (4, "1 mm")] {
        for (place, count) in counts.iter().enumerate() {
            let value = |law: usize| rows[block + law][place];
            let _ = writeln!(
                table,
                "| {count} | {style} | {:.4} | {:.4} | {:.4} | {:.4} |",
                value(0),
                value(1),
                value(2),
                value(3)
            );
        }
    }
    let spread_at = |block: usize| {
        let place = counts.len() - 1;
        let values = [0, 1, 2, 3].map(|law: usize| rows[block + law][place]);
        values.into_iter().fold(f64::NEG_INFINITY, f64::max)
            - values.into_iter().fold(f64::INFINITY, f64::min)
    };
    let dropped = Figure {
        name: "column-drop",
        plot: plot.with_size(760.0, 460.0),
        caption: format!(
            "Every pair has e_n = {RESTITUTION} by each law, and the same contact duration of 50 µs at {SPEED} m/s; hard beads lose nothing in a \
             collision within 50 µs of another one of the same bead. Of one bead all \
             keep 0.9. At N = {} the laws differ by {:.3} if the beads touch from the start, where contacts overlap in time, and \
             by {:.3} if they are 1 mm apart, where most are pairs. The choice of the law matters in dense systems, as the \
             summary of Luding 1998 says.\n\n{table}",
            counts[counts.len() - 1],
            spread_at(0),
            spread_at(4)
        ),
    };
    Ok(vec![dropped, vibration()?])
}

fn vibration() -> Result<Figure, Error> {
    let counts = [1, 2, 3, 5, 10];
    let numbers: Vec<f64> = counts.iter().map(|count| *count as f64).collect();
    let mut plot = Plot::new(
        "Sec. 8: a column of N beads on a vibrating plate",
        Axis::linear("N"),
        Axis::linear("rise of the centre of mass / ((A ω)²/g)"),
    );
    let mut table = format!("| N | {} |\n|---|---|---|---|---|\n", MODELS.join(" | "));
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (index, (name, law)) in MODELS.iter().zip(laws()).enumerate() {
        let mut values = Vec::new();
        for count in counts {
            values.push(vibrate(&law, count)?);
        }
        plot = plot
            .with(Series::line("", numbers.clone(), values.clone()).with_colour(Colour::PALETTE[index]))
            .with(Series::points(*name, numbers.clone(), values.clone()).with_colour(Colour::PALETTE[index]));
        rows.push(values);
    }
    for (place, count) in counts.iter().enumerate() {
        let _ = writeln!(
            table,
            "| {count} | {:.3} | {:.3} | {:.3} | {:.3} |",
            rows[0][place], rows[1][place], rows[2][place], rows[3][place]
        );
    }
    Ok(Figure {
        name: "column-vibrated",
        plot: plot.with_size(760.0, 420.0),
        caption: format!(
            "A plate vibrates with 50 Hz and 3.5 g; e_n = {RESTITUTION} of every pair, averaged from 0.5 to 2 s (one realisation, \
             which a single bead makes chaotic; differences of some per cent between laws at N = 1 are its scatter).\n\n{table}"
        ),
    })
}
