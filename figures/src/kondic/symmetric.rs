//! Figs. 6 and 7: slip after a collision with opposite velocities.

use granule_closed_forms::kondic::{after, printed};
use granule_report::{Axis, Colour, Plot, Series};

use super::collide::{Collision, STEEL, Slid};
use crate::{Error, Figure, spread};

pub(super) fn figures() -> Result<Vec<Figure>, Error> {
    let [time, distance] = by_speed()?;
    let [losses, ratios] = by_restitution()?;
    Ok(vec![time, distance, losses, ratios])
}

fn slid(speed: f64, restitution: f64) -> Result<Slid, Error> {
    let velocities = [-0.5 * speed, 0.5 * speed];
    Collision { velocities, restitution, shear_rate: 0.0, steps: 100.0 }.slide()
}

fn by_speed() -> Result<[Figure; 2], Error> {
    let speeds = spread(0.0, 0.5, 101);
    let in_cm = |speeds: &[f64]| speeds.iter().map(|speed| 100.0 * speed).collect::<Vec<_>>();
    let axis = || Axis::linear("relative speed v [cm/s]");
    let mut time = Plot::new("Fig. 6: time of slip after a collision", axis(), Axis::linear("t_s [s]"));
    let mut distance =
        Plot::new("Fig. 6: distance of slip after a collision", axis(), Axis::linear("s [cm]"));
    let (mut worst_time, mut worst_distance) = (0.0_f64, 0.0_f64);
    for (e, colour) in [1.0, 0.9, 0.7].into_iter().zip(Colour::PALETTE) {
        let (mut durations, mut ways) = (Vec::new(), Vec::new());
        let at = spread(0.05, 0.5, 7);
        for v in &at {
            let slid = slid(*v, e)?;
            worst_time = worst_time.max((slid.duration / after::duration(&STEEL, *v, e) - 1.0).abs());
            worst_distance = worst_distance.max((slid.distance / after::distance(&STEEL, *v, e) - 1.0).abs());
            durations.push(slid.duration);
            ways.push(100.0 * slid.distance);
        }
        let name = format!("e_n = {e}");
        let marker = if e == 1.0 { "engine" } else { "" };
        let line = speeds.iter().map(|v| after::duration(&STEEL, *v, e)).collect();
        time = time
            .with(Series::line(name.clone(), in_cm(&speeds), line).with_colour(colour))
            .with(Series::points(marker, in_cm(&at), durations).with_colour(colour));
        let line = speeds.iter().map(|v| 100.0 * after::distance(&STEEL, *v, e)).collect();
        distance = distance
            .with(Series::line(name, in_cm(&speeds), line).with_colour(colour))
            .with(Series::points(marker, in_cm(&at), ways).with_colour(colour));
    }
    let wrong = speeds.iter().map(|v| 100.0 * printed::distance(&STEEL, *v, 0.9)).collect();
    distance = distance.with(Series::dashed("Eq. (44), printed, e_n = 0.9", in_cm(&speeds), wrong));
    Ok([
        Figure {
            name: "fig6-time",
            plot: time.with_size(720.0, 460.0),
            caption: format!(
                "Eq. (42). Largest relative difference of engine and lines: {worst_time:.1e}; the formula leaves out the friction \
                 during the collision, Q μ_k g t_col."
            ),
        },
        Figure {
            name: "fig6-distance",
            plot: distance.with_size(720.0, 460.0),
            caption: format!(
                "Eq. (44), in which 1 + e_n belongs into the numerator (erratum K-E23). Largest relative difference of engine and \
                 corrected lines: {worst_distance:.1e}."
            ),
        },
    ])
}

fn by_restitution() -> Result<[Figure; 2], Error> {
    let restitutions = spread(0.4, 1.0, 121);
    let on = |of: &dyn Fn(f64) -> f64| restitutions.iter().map(|e| of(*e)).collect::<Vec<_>>();
    let at = spread(0.4, 1.0, 7);
    let (mut energies, mut momenta, mut energy_ratios, mut momentum_ratios) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut worst: f64 = 0.0;
    for e in &at {
        let speed = 0.1;
        let slid = slid(speed, *e)?;
        let initial = 0.5 * speed;
        let energy =
            (slid.velocity * slid.velocity - slid.final_velocity * slid.final_velocity) / (initial * initial);
        let momentum = (slid.velocity - slid.final_velocity) / initial;
        let lost = 1.0 - slid.velocity * slid.velocity / (initial * initial);
        worst = worst
            .max((energy - after::energy_share(2.5, *e)).abs())
            .max((momentum - after::momentum_share(2.5, *e)).abs());
        energies.push(energy);
        momenta.push(momentum);
        energy_ratios.push(lost / energy);
        momentum_ratios.push((1.0 - slid.velocity / initial) / momentum);
    }
    let losses = Plot::new(
        "Fig. 7(a): losses by slip after a collision",
        Axis::linear("restitution e_n"),
        Axis::linear("share of energy, of momentum"),
    )
    .with(Series::line("ΔE_slip, Eq. (46)", restitutions.clone(), on(&|e| after::energy_share(2.5, e))))
    .with(Series::line("Δp_slip, Eq. (48)", restitutions.clone(), on(&|e| after::momentum_share(2.5, e))))
    .with(Series::points("ΔE_slip, engine", at.clone(), energies))
    .with(Series::points("Δp_slip, engine", at.clone(), momenta));
    let ratios = Plot::new(
        "Fig. 7(b): losses in the collision over those by slip",
        Axis::linear("restitution e_n"),
        Axis::linear("ratio"),
    )
    .with(Series::line(
        "ΔE_col/ΔE_slip, Eq. (47)",
        restitutions.clone(),
        on(&|e| after::energy_ratio(2.5, e)),
    ))
    .with(Series::line(
        "Δp_col/Δp_slip, Eq. (49)",
        restitutions.clone(),
        on(&|e| after::momentum_ratio(2.5, e)),
    ))
    .with(Series::points("ΔE_col/ΔE_slip, engine", at.clone(), energy_ratios))
    .with(Series::points("Δp_col/Δp_slip, engine", at, momentum_ratios));
    Ok([
        Figure {
            name: "fig7a",
            plot: losses.with_size(720.0, 460.0),
            caption: format!(
                "At v = 10 cm/s; the shares do not depend on it. Largest difference of engine and lines: {worst:.1e}."
            ),
        },
        Figure {
            name: "fig7b",
            plot: ratios.with_size(720.0, 460.0),
            caption: "Where collisions are nearly elastic, slip takes most of the energy and the momentum."
                .to_string(),
        },
    ])
}
