//! Figs. 8 to 11: slip after collisions of any two velocities, as cuts through the surfaces of the paper.

use std::f64::consts::PI;

use granule_closed_forms::kondic::after::{self, Slide};
use granule_closed_forms::kondic::printed;
use granule_report::{Axis, Colour, Plot, Series};

use super::collide::{Collision, STEEL, Slid, omega};
use crate::{Error, Figure, spread};

const RESTITUTION: f64 = 0.9;
/// C of the paper; the engine gets the rate with which (1 - exp(-2 C'))/2 is this (erratum K-E31).
const SHARE: f64 = 0.13;
/// Relative speeds |v_m| of the cuts \[m/s\].
const CUTS: [f64; 3] = [0.05, 0.1, 0.2];

/// One of the four figures.
struct Kind {
    name: &'static str,
    title: &'static str,
    axis: &'static str,
    of_line: fn(&Slide) -> f64,
    of_run: fn(&Slid) -> f64,
    caption: &'static str,
}

const KINDS: [Kind; 4] = [
    Kind {
        name: "fig8",
        title: "Fig. 8: time of slip of the sphere ahead",
        axis: "t_s [s]",
        of_line: |slide| slide.duration,
        of_run: |slid| slid.duration,
        caption: "Eq. (59).",
    },
    Kind {
        name: "fig9",
        title: "Fig. 9: distance of slip of the sphere ahead",
        axis: "|s| [cm]",
        of_line: |slide| 100.0 * slide.distance.abs(),
        of_run: |slid| 100.0 * slid.distance.abs(),
        caption: "From Eqs. (A7), (59) and (60). The distance vanishes where v_i = -4.76 v_j (Eq. (61) with erratum K-E24); the \
                  printed ratio of -9.06 is dashed.",
    },
    Kind {
        name: "fig10",
        title: "Fig. 10: translational energy lost by slip of the sphere ahead",
        axis: "v_f² - v_s² [cm²/s²]",
        of_line: |slide| 1e4 * slide.energy_loss(),
        of_run: |slid| 1e4 * (slid.velocity * slid.velocity - slid.final_velocity * slid.final_velocity),
        caption: "From Eqs. (A7) and (60). Below zero the sphere gains translational energy from its spin.",
    },
    Kind {
        name: "fig11",
        title: "Fig. 11: momentum lost by slip of the sphere ahead",
        axis: "v_f - v_s [cm/s]",
        of_line: |slide| 100.0 * slide.momentum_loss(),
        of_run: |slid| 100.0 * (slid.velocity - slid.final_velocity),
        caption: "From Eqs. (A7) and (60).",
    },
];

/// Velocities of both from their sum and the size of their difference.
fn velocities(sum: f64, speed: f64) -> [f64; 2] {
    [0.5 * (sum - speed), 0.5 * (sum + speed)]
}

pub(super) fn figures() -> Result<Vec<Figure>, Error> {
    let at = spread(-0.15, 0.15, 7);
    let mut runs = Vec::new();
    for speed in CUTS {
        let exponent = -0.5 * (1.0 - 2.0 * SHARE).ln();
        let shear_rate = 2.0 * exponent * omega(speed, 1.0) / (PI * STEEL.inertia_number);
        let cut: Result<Vec<Slid>, Error> = at
            .iter()
            .map(|sum| {
                let velocities = velocities(*sum, speed);
                Collision { velocities, restitution: RESTITUTION, shear_rate, steps: 100.0 }.slide()
            })
            .collect();
        runs.push(cut?);
    }
    Ok(KINDS.iter().map(|kind| figure(kind, &at, &runs)).collect())
}

fn figure(kind: &Kind, at: &[f64], runs: &[Vec<Slid>]) -> Figure {
    let sums = spread(-0.2, 0.2, 201);
    let in_cm = |sums: &[f64]| sums.iter().map(|sum| 100.0 * sum).collect::<Vec<_>>();
    let mut plot = Plot::new(kind.title, Axis::linear("v_p = v_i + v_j [cm/s]"), Axis::linear(kind.axis));
    let (mut worst, mut largest, mut top) = (0.0_f64, 0.0_f64, 0.0_f64);
    for ((speed, runs), colour) in CUTS.into_iter().zip(runs).zip(Colour::PALETTE) {
        let value = |sum: f64| {
            let [i, j] = velocities(sum, speed);
            (kind.of_line)(&after::slides(&STEEL, i, j, RESTITUTION, SHARE)[0])
        };
        let line: Vec<f64> = sums.iter().map(|sum| value(*sum)).collect();
        top = line.iter().fold(top, |top, value| top.max(*value));
        let found: Vec<f64> = runs.iter().map(kind.of_run).collect();
        for (found, sum) in found.iter().zip(at) {
            worst = worst.max((found - value(*sum)).abs());
            largest = largest.max(found.abs());
        }
        let marker = if speed == CUTS[0] { "engine" } else { "" };
        plot = plot
            .with(
                Series::line(format!("|v_m| = {} cm/s", 100.0 * speed), in_cm(&sums), line)
                    .with_colour(colour),
            )
            .with(Series::points(marker, in_cm(at), found).with_colour(colour));
    }
    if kind.name == "fig9" {
        // v_p/v_m of the printed ratio v_i/v_j, at the middle cut.
        let ratio = printed::no_distance_ratio(STEEL.inertia_number, RESTITUTION, SHARE);
        let sum = -CUTS[1] * (ratio + 1.0) / (ratio - 1.0);
        let name = "no distance as printed, |v_m| = 10 cm/s";
        plot = plot.with(
            Series::dashed(name, in_cm(&[sum, sum]), vec![0.0, 0.3 * top]).with_colour(Colour::PALETTE[1]),
        );
    }
    Figure {
        name: kind.name,
        plot: plot.with_size(720.0, 460.0),
        caption: format!(
            "{} e_n = {RESTITUTION}, C = {SHARE}. Largest difference of engine and lines: {:.1} % of the largest value. It is the \
             friction during the collision, which the paper leaves out: the force across the surface presses one sphere with \
             twenty times its weight.",
            kind.caption,
            100.0 * worst / largest
        ),
    }
}
