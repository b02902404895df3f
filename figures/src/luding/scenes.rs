//! Figs. 2 and 3 as scenes: a block on a plane, and two spheres before and after a collision.

use granule_report::{Axis, Colour, Plot, Series};

use crate::simulate::Run;
use crate::{Error, Figure, spread};

const FRICTION: f64 = 0.4;
const GRAVITY: f64 = 9.81;

pub(super) fn figures() -> Result<Vec<Figure>, Error> {
    Ok(vec![plane()?, collision()?])
}

/// Acceleration along a plane that is inclined by `angle` degrees, over g, of a round body with the inertia factor `inertia`.
fn acceleration(angle: f64, inertia: f64) -> Result<f64, Error> {
    let (sine, cosine) = angle.to_radians().sin_cos();
    // It starts at the depth at which the plane carries it.
    let (radius, duration) = (1e-2_f64, 0.2);
    let mass = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * 2500.0;
    let depth = mass * GRAVITY * cosine / 1e5;
    let run = Run::new(&format!(
        r#"(version: 1, gravity: ({}, 0, {}), materials: {{ "a": (density: 2500) }},
        bodies: [Body(material: "a", radius: {radius}, inertia_factor: {inertia}, position: (0, 0, {}))],
        walls: {{ "plane": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e5, restitution: 0.5),
            tangential: TangentialSpring(stiffness: 3e4, friction: {FRICTION}, damping: 1))],
        driver: TimeStep(step: 1e-5), run: (duration: {duration}))"#,
        GRAVITY * sine,
        -GRAVITY * cosine,
        radius - depth
    ))?;
    Ok(run.finish()?[0].velocity[0] / duration / GRAVITY)
}

fn plane() -> Result<Figure, Error> {
    let angles = spread(0.0, 80.0, 321);
    let slides = |angle: f64| angle.to_radians().sin() - FRICTION * angle.to_radians().cos();
    // A sphere rolls with 5/7 of the pull until that takes more friction than there is.
    let sphere = |angle: f64| (angle.to_radians().sin() / 1.4).max(slides(angle));
    let mut plot = Plot::new(
        "Fig. 2: a body on an inclined plane",
        Axis::linear("inclination [degrees]"),
        Axis::linear("acceleration / g").with_range(-0.02, 1.0),
    );
    let mut worst: f64 = 0.0;
    let samples = spread(2.0, 78.0, 20);
    let mut points = Vec::new();
    for (name, inertia, colour) in [
        ("solid sphere, q = 2/5", 0.4, Colour::PALETTE[0]),
        ("hardest to turn, q = 1", 1.0, Colour::PALETTE[1]),
    ] {
        let exact = |angle: f64| match inertia {
            1.0 => (angle.to_radians().sin() / 2.0).max(slides(angle)),
            _ => sphere(angle),
        };
        plot = plot.with(
            Series::line(name, angles.clone(), angles.iter().map(|angle| exact(*angle)).collect())
                .with_colour(colour),
        );
        let mut found = Vec::new();
        for angle in &samples {
            let value = acceleration(*angle, inertia)?;
            worst = worst.max((value - exact(*angle)).abs());
            found.push(value);
        }
        points.push(Series::points(format!("engine, {name}"), samples.clone(), found).with_colour(colour));
    }
    plot = plot.with(
        Series::dashed(
            "a block: at rest, then sliding",
            angles.clone(),
            angles.iter().map(|angle| slides(*angle).max(0.0)).collect(),
        )
        .with_colour(Colour::PALETTE[2]),
    );
    for series in points {
        plot = plot.with(series);
    }
    Ok(Figure {
        name: "fig2",
        plot: plot.with_size(760.0, 440.0),
        caption: format!(
            "Static, dynamic and rolling friction of Luding 1998, Fig. 2, with μ = {FRICTION}: a round body without rolling \
             friction rolls until the pull exceeds what μ f_N can turn, then it slides. Largest difference between engine and \
             lines: {worst:.1e} g."
        ),
    })
}

fn collision() -> Result<Figure, Error> {
    let mut run = Run::new(
        r#"(version: 1, materials: { "a": (density: 2500) },
        bodies: [
            Sphere(material: "a", radius: 0.010, position: (-0.030, -0.008, 0), velocity: (1, 0, 0)),
            Sphere(material: "a", radius: 0.008, position: (0.020, 0.002, 0), velocity: (-1, 0.1, 0), spin: (0, 0, 100)),
        ],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(restitution: 0.8, contact_duration: 2e-4),
            tangential: TangentialSpring(tangential_restitution: 0.4, friction: 0.3))],
        driver: TimeStep(step: 1e-6), run: (duration: 0.05))"#,
    )?;
    let mut paths = [(Vec::new(), Vec::new()), (Vec::new(), Vec::new())];
    let mut outlines = Vec::new();
    let start = run.bodies();
    for step in (0..=run.steps()).step_by(250) {
        run.advance(step)?;
        for (index, body) in run.bodies().iter().enumerate() {
            paths[index].0.push(100.0 * body.position[0]);
            paths[index].1.push(100.0 * body.position[1]);
            if step == 0 || step == run.steps() {
                let radius = [1.0, 0.8][index];
                let around = spread(0.0, 2.0 * std::f64::consts::PI, 73);
                let x = around.iter().map(|angle| 100.0 * body.position[0] + radius * angle.cos()).collect();
                let y = around.iter().map(|angle| 100.0 * body.position[1] + radius * angle.sin()).collect();
                outlines.push(Series::line("", x, y).with_colour(Colour::PALETTE[index]));
            }
        }
    }
    let end = run.bodies();
    let mass = |index: usize| [1.0_f64, 0.512][index];
    let momentum = |bodies: &[crate::simulate::Body], axis: usize| {
        (0..2).map(|index| mass(index) * bodies[index].velocity[axis]).sum::<f64>()
    };
    let lost = (0..2).map(|axis| (momentum(&end, axis) - momentum(&start, axis)).abs()).fold(0.0, f64::max);
    let mut plot = Plot::new(
        "Fig. 3: two spheres before and after a collision",
        Axis::linear("x [cm]"),
        Axis::linear("y [cm]"),
    );
    for (index, (x, y)) in paths.into_iter().enumerate() {
        let name = ["R = 1 cm, at rest in spin", "R = 0.8 cm, spinning"][index];
        plot = plot.with(Series::dashed(name, x, y).with_colour(Colour::PALETTE[index]));
    }
    for outline in outlines {
        plot = plot.with(outline);
    }
    Ok(Figure {
        name: "fig3",
        plot: plot.with_size(760.0, 460.0),
        caption: format!(
            "Paths of the centres, with the spheres at the first and the last moment. Spins before: {:.0} and {:.0} rad/s; after: \
             {:.1} and {:.1} rad/s. The sum of m v changes by {lost:.0e} of its unit (Luding 1998, Eq. (8)).",
            start[0].spin[2], start[1].spin[2], end[0].spin[2], end[1].spin[2]
        ),
    })
}
