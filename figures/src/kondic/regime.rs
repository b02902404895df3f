//! Where slides matter: a cooling layer of rolling beads with and without them, by the ratio of the mean free path to the
//! distance of slip (Kondic 1999, Secs. IV B 2 and V).

use std::sync::atomic::AtomicBool;

use granule_closed_forms::kondic::after;
use granule_drivers::driver;
use granule_report::{Axis, Plot, Series};

use super::collide::STEEL;
use crate::simulate::plan;
use crate::{Error, Figure};

/// Restitution between the beads.
const RESTITUTION: f64 = 0.9;
/// Beads along a side of the layer.
const SIDE: usize = 24;
/// Layers of each kind, with other velocities.
const LAYERS: u64 = 3;
/// Collisions of each bead before the comparison begins, without loss, so that the layer forgets how it was laid.
const MIXING: f64 = 10.0;
/// Collisions of each bead in the comparison.
const COMPARED: f64 = 2.0;
/// Share of the lost energy by which models may differ.
const ALLOWED: f64 = 0.1;

/// Place and velocity of a bead.
type Bead = ([f64; 2], [f64; 2]);

/// One layer in both models.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// Mean free path over the distance of slip.
    ratio: f64,
    /// Energy that the model without slides loses over what the other one loses, less 1.
    difference: f64,
}

pub(super) fn figures() -> Result<Vec<Figure>, Error> {
    let mut plot = Plot::new(
        "Mean free path against distance of slip: where collisions may end at once",
        Axis::log("mean free path / distance of slip, l/s"),
        Axis::log("difference of the energy lost"),
    );
    let mut all: Vec<Point> = Vec::new();
    for packing in [0.05, 0.2, 0.5] {
        let mut points = Vec::new();
        for speed in [0.01, 0.02, 0.04, 0.08, 0.16, 0.32] {
            points.push(compare(packing, speed)?);
        }
        let ratios = points.iter().map(|point| point.ratio).collect();
        let differences = points.iter().map(|point| point.difference.abs()).collect();
        plot = plot.with(Series::points(format!("packing fraction {packing}"), ratios, differences));
        all.extend(points);
    }
    all.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
    let from = all.iter().rposition(|point| point.difference.abs() > ALLOWED);
    let boundary = match from {
        Some(last) => all.get(last + 1).map_or(f64::INFINITY, |point| point.ratio),
        None => all[0].ratio,
    };
    let span = vec![all[0].ratio, all[all.len() - 1].ratio];
    let plot = plot.with(Series::dashed("10 %", span, vec![ALLOWED; 2]));
    Ok(vec![Figure {
        name: "regimes",
        plot: plot.with_size(720.0, 460.0),
        caption: format!(
            "Layers of {} rolling spheres cool down from six speeds at three densities, e_n = {RESTITUTION}: translational energy \
             lost in {COMPARED} collisions of each by `slides: EffectiveRestitution`, Eq. (68), against `slides: Arcs()`, means \
             over {LAYERS} layers. l is measured, s is Eq. (44) at the mean normal speed of impact. The cheap model is within \
             10 % from l/s = {boundary:.0} on.",
            SIDE * SIDE
        ),
    }])
}

/// A layer with a packing fraction and a root mean square of each component of the velocities \[m/s\].
fn compare(packing: f64, speed: f64) -> Result<Point, Error> {
    let (mut path, mut lost) = (0.0, [0.0; 2]);
    for seed in 0..LAYERS {
        let (beads, free_path) = layer(packing, speed, seed)?;
        path += free_path / LAYERS as f64;
        // Mean speed of a Maxwellian in the plane.
        let time = COMPARED * free_path / (speed * std::f64::consts::FRAC_PI_2.sqrt());
        let start = energy(&beads);
        for (lost, slides) in lost.iter_mut().zip(["Arcs()", "EffectiveRestitution"]) {
            let (after, _) = run(&beads, packing, time, Some(slides))?;
            *lost += start - energy(&after);
        }
    }
    // Mean normal speed of the impacts of a Maxwellian.
    let impact = speed * std::f64::consts::PI.sqrt();
    let slip = after::distance(&STEEL, impact, RESTITUTION);
    Ok(Point { ratio: path / slip, difference: lost[1] / lost[0] - 1.0 })
}

/// Translational energy over the mass of a bead.
fn energy(beads: &[Bead]) -> f64 {
    beads.iter().map(|(_, v)| 0.5 * (v[0] * v[0] + v[1] * v[1])).sum()
}

/// Beads in equilibrium, and their mean free path \[m\].
fn layer(packing: f64, speed: f64, seed: u64) -> Result<(Vec<Bead>, f64), Error> {
    let spacing = width(packing) / SIDE as f64;
    let mut beads: Vec<Bead> = (0..SIDE * SIDE)
        .map(|k| {
            let place = [(k % SIDE) as f64, (k / SIDE) as f64].map(|n| (n + 0.5) * spacing);
            // Points that fill the square evenly, and from them two normal deviates.
            let n = (k as u64 + 1 + seed * 7919) as f64;
            let (a, b) = ((n * 0.754_877_666_246_693).fract(), (n * 0.569_840_290_998_053_3).fract());
            let (size, turn) = ((-2.0 * (1.0 - a).ln()).sqrt(), std::f64::consts::TAU * b);
            (place, [speed * size * turn.cos(), speed * size * turn.sin()])
        })
        .collect();
    let mean: [f64; 2] =
        [0, 1].map(|axis| beads.iter().map(|(_, v)| v[axis]).sum::<f64>() / beads.len() as f64);
    for (_, v) in &mut beads {
        *v = [v[0] - mean[0], v[1] - mean[1]];
    }
    let scale = speed * (beads.len() as f64 / energy(&beads)).sqrt();
    for (_, v) in &mut beads {
        *v = v.map(|c| c * scale);
    }
    let mean_speed = speed * std::f64::consts::FRAC_PI_2.sqrt();
    // Of discs, with their pair distribution at contact by Henderson.
    let contact = (1.0 - 7.0 / 16.0 * packing) / (1.0 - packing).powi(2);
    let expected = std::f64::consts::PI * STEEL.radius / (4.0 * 2.0_f64.sqrt() * packing * contact);
    let time = MIXING * expected / mean_speed;
    let (after, collisions) = run(&beads, packing, time, None)?;
    let free_path = mean_speed * time * beads.len() as f64 / (2.0 * collisions as f64);
    Ok((after, free_path))
}

/// Width of the layer \[m\].
fn width(packing: f64) -> f64 {
    SIDE as f64 * STEEL.radius * (std::f64::consts::PI / packing).sqrt()
}

/// Beads after a time, and how often they collided; without a substrate they fly, and lose nothing.
fn run(beads: &[Bead], packing: f64, time: f64, slides: Option<&str>) -> Result<(Vec<Bead>, u64), Error> {
    let r = STEEL.radius;
    let bodies: String = beads
        .iter()
        .map(|([x, y], [u, v])| {
            format!(
                "Sphere(material: \"steel\", radius: {r}, position: ({x:e}, {y:e}, {r}), velocity: ({u:e}, {v:e}, 0), \
                 spin: ({:e}, {:e}, 0)),",
                -v / r,
                u / r
            )
        })
        .collect();
    let (surface, restitution, slides) = match slides {
        Some(slides) => (
            format!(
                "gravity: (0, 0, -{}), substrate: (laws: {{ \"steel\": StickSlip(static_friction: {}, kinetic_friction: {}) }}),",
                STEEL.gravity, STEEL.static_friction, STEEL.kinetic_friction
            ),
            RESTITUTION,
            format!(", slides: {slides}"),
        ),
        None => (String::new(), 1.0, String::new()),
    };
    let width = width(packing);
    let text = format!(
        "(version: 1, materials: {{ \"steel\": (density: 7850) }}, {surface} bodies: [{bodies}],
          cell: (lo: (0, 0, 0), hi: ({width:e}, {width:e}, {}), periodic: (true, true, false)),
          contacts: [(between: (\"steel\", \"steel\"), collision: HardSphere(restitution: {restitution}))],
          driver: Event(step: {time:e}{slides}), run: (duration: {time:e}))",
        4.0 * r
    );
    let mut driver = driver(plan(&text)?, Some(1))?;
    driver.advance(1, &AtomicBool::new(false))?;
    let view = driver.view();
    let rows = view.bodies();
    let beads = view
        .order()
        .iter()
        .map(|place| {
            let (x, v) = (rows.position[*place as usize].vector(), rows.velocity_of(*place as usize));
            ([x[0], x[1]], [v[0], v[1]])
        })
        .collect();
    Ok((beads, view.events().map_or(0, |counts| counts.all())))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean free path is that of discs, and slides do not matter where it is much longer than they are.
    #[test]
    fn slides_matter_where_the_free_path_is_not_longer_than_they_are() {
        let (_, path) = layer(0.05, 0.02, 1).unwrap();
        let contact = (1.0 - 7.0 / 16.0 * 0.05) / 0.95_f64.powi(2);
        let theory = std::f64::consts::PI * STEEL.radius / (4.0 * 2.0_f64.sqrt() * 0.05 * contact);
        // 5760 collisions: 1.3 %, and the first ones of a lattice.
        assert!((path / theory - 1.0).abs() < 0.06, "{path} {theory}");
        let sparse = compare(0.05, 0.01).unwrap();
        let dense = compare(0.5, 0.32).unwrap();
        assert!(sparse.ratio > 300.0 && dense.ratio < 0.1, "{sparse:?} {dense:?}");
        // 1700 collisions in each model: 3 %.
        assert!(sparse.difference.abs() < 0.06 && dense.difference.abs() > 0.5, "{sparse:?} {dense:?}");
    }
}
