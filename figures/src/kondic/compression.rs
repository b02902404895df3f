//! Fig. 5: compression, and where slip begins.

use granule_closed_forms::kondic::{during, printed};
use granule_report::{Axis, Colour, Plot, Series};

use super::collide::{Collision, STEEL, omega, rate};
use crate::{Error, Figure, spread};

pub(super) fn figures() -> Result<Vec<Figure>, Error> {
    Ok(vec![largest()?, slip()?])
}

const SPEED: &str = "relative speed [cm/s]";

fn in_cm(speeds: &[f64]) -> Vec<f64> {
    speeds.iter().map(|speed| 100.0 * speed).collect()
}

/// The duration that the paper works with is 2^(2/5) times that of Hertz.
fn too_long() -> f64 {
    2.0f64.powf(0.4)
}

fn largest() -> Result<Figure, Error> {
    let speeds = spread(0.005, 1.0, 200);
    let mut plot = Plot::new(
        "Fig. 5(a): largest compression",
        Axis::linear(SPEED),
        Axis::linear("largest overlap / diameter [1e-4]"),
    );
    let mut worst: f64 = 0.0;
    let mut markers = Vec::new();
    for (e, colour) in [1.0, 0.9, 0.7].into_iter().zip(Colour::PALETTE) {
        let exact = |v: f64| during::largest_compression_damped(&STEEL, v, omega(v, e), rate(v, e));
        let line = speeds.iter().map(|v| 1e4 * exact(*v)).collect();
        plot = plot.with(Series::line(format!("e_n = {e}"), in_cm(&speeds), line).with_colour(colour));
        let at = spread(0.05, 1.0, 9);
        let mut found = Vec::new();
        for v in &at {
            let collision =
                Collision { velocities: [-0.5 * v, 0.5 * v], restitution: e, shear_rate: 0.0, steps: 400.0 };
            let value = collision.largest_compression()?;
            worst = worst.max((value / exact(*v) - 1.0).abs());
            found.push(1e4 * value);
        }
        let name = if e == 1.0 { "engine" } else { "" };
        markers.push(Series::points(name, in_cm(&at), found).with_colour(colour));
    }
    let wrong = |v: f64| {
        let w = std::f64::consts::PI / (too_long() * super::collide::duration(v));
        1e4 * printed::largest_compression(&STEEL, v, w, during::damping_of_restitution(0.9) * w)
    };
    plot = plot.with(Series::dashed(
        "printed, e_n = 0.9",
        in_cm(&speeds),
        speeds.iter().map(|v| wrong(*v)).collect(),
    ));
    for series in markers {
        plot = plot.with(series);
    }
    Ok(Figure {
        name: "fig5a",
        plot: plot.with_size(720.0, 460.0),
        caption: format!(
            "Lines: Eqs. (A2) and (A4), with ω_0 from the Hertz duration at each speed, so that the compression goes with \
             v^(4/5). Dashed: Eq. (39) as printed, with 1 - πε/2 instead of 1 - πε/4 (erratum K-E19) and the duration of the paper, \
             which is 2^(2/5) too long (erratum K-E33). Largest relative difference of engine and lines: {worst:.1e}, the friction \
             with the surface (Eq. (D4)) and the step."
        ),
    })
}

fn slip() -> Result<Figure, Error> {
    let speeds = spread(0.01, 1.0, 200);
    let right = |v: f64| 1e7 * during::slip_compression(&STEEL, omega(v, 1.0));
    let wrong = |v: f64| 1e7 * printed::slip_compression(&STEEL, omega(v, 1.0) / too_long());
    let at = spread(0.02, 1.0, 12);
    let (mut found, mut worst) = (Vec::new(), 0.0_f64);
    for v in &at {
        // A hundred steps until slip begins.
        let begin = during::slip_time(&STEEL, *v, omega(*v, 1.0)).unwrap_or(f64::NAN);
        let steps = 100.0 * super::collide::duration(*v) / begin;
        let collision =
            Collision { velocities: [-0.5 * v, 0.5 * v], restitution: 1.0, shear_rate: 0.0, steps };
        let value = 1e7 * collision.slip_compression()?;
        worst = worst.max((value / right(*v) - 1.0).abs());
        found.push(value);
    }
    let plot = Plot::new(
        "Fig. 5(b): compression at which slip begins",
        Axis::linear(SPEED),
        Axis::linear("overlap / diameter [1e-7]"),
    )
    .with(Series::line("Eq. (33), corrected", in_cm(&speeds), speeds.iter().map(|v| right(*v)).collect()))
    .with(Series::dashed("Eq. (33), printed", in_cm(&speeds), speeds.iter().map(|v| wrong(*v)).collect()))
    .with(Series::points("engine", in_cm(&at), found));
    Ok(Figure {
        name: "fig5b",
        plot: plot.with_size(720.0, 460.0),
        caption: format!(
            "Elastic collisions. Eq. (33) lacks a factor 2 (erratum K-E3); the dashed line has the duration of the paper, too, \
             whose square makes up for 1.74 of it. Largest relative difference of engine and corrected line: {worst:.1e}; slip \
             begins within a step, of which there are a hundred before."
        ),
    })
}
