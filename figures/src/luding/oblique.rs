//! Figs. 4 and 7: oblique impacts.

use granule_reference::{Collision, HardLimitOutcome};
use granule_report::{Axis, Colour, Plot, Series};

use crate::simulate::{Run, plan};
use crate::{Error, Figure, spread};

const RESTITUTION: f64 = 0.9;
const STICKING: f64 = 0.5;
/// Normal speed \[m/s\].
const SPEED: f64 = 0.1;
/// 1 + 1/q of a solid sphere.
const INERTIA: f64 = 3.5;

pub(super) fn figures() -> Result<Vec<Figure>, Error> {
    Ok(vec![restitution_by_angle()?, impact_line()?, tangential_laws()?])
}

/// A sphere of 1 mm hits a wall under the given laws, with the slip psi times the normal speed.
fn scene(laws: &str, psi: f64, steps: Option<u32>) -> String {
    let driver =
        steps.map(|n| format!("driver: TimeStep(step: Auto(steps_per_contact: {n})),")).unwrap_or_default();
    format!(
        r#"(version: 1, materials: {{ "a": (density: 1000) }},
        bodies: [Sphere(material: "a", radius: 1e-3, position: (0, 0, 1.0000001e-3), velocity: ({}, 0, -{SPEED}))],
        walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), {laws})], {driver} run: (duration: 60e-6))"#,
        psi * SPEED
    )
}

/// The impact in the hard limit, to tight tolerance.
fn reference(laws: &str, psi: f64) -> Result<HardLimitOutcome, Error> {
    let plan = plan(&scene(laws, psi, None))?;
    let (collision, composition) = Collision::of_plan(&plan)?;
    Ok(collision.hard_limit().run(composition)?)
}

/// Ψ2 of a run of the engine, whose contact is short but not instantaneous.
fn engine(laws: &str, psi: f64) -> Result<f64, Error> {
    let body = Run::new(&scene(laws, psi, Some(400)))?.finish()?[0];
    Ok((body.velocity[0] - 1e-3 * body.spin[1]) / SPEED)
}

/// Luding 1998, Eq. (21): the three-parameter rule.
fn rule(friction: f64, psi: f64) -> f64 {
    let slides = psi - friction * (1.0 + RESTITUTION) * INERTIA;
    slides.max(-STICKING * psi)
}

fn spring(friction: f64) -> String {
    format!(
        "normal: LinearSpringDashpot(contact_duration: 20e-6, restitution: {RESTITUTION}), \
         tangential: TangentialSpring(tangential_restitution: {STICKING}, friction: {friction})"
    )
}

const FRICTIONS: [f64; 2] = [0.1, 0.3];

fn restitution_by_angle() -> Result<Figure, Error> {
    let mut plot = Plot::new(
        "Fig. 4(a): tangential restitution against the angle of impact",
        Axis::linear("γ [degrees]"),
        Axis::linear("e_t").with_range(-1.1, 0.8),
    );
    let psi = |angle: f64| -angle.to_radians().tan();
    let mut points = Vec::new();
    for (friction, colour) in FRICTIONS.into_iter().zip(Colour::PALETTE) {
        let angles = spread(90.5, 179.9, 400);
        let line = angles.iter().map(|angle| -rule(friction, psi(*angle)) / psi(*angle)).collect();
        plot = plot.with(
            Series::line(format!("three-parameter rule, μ = {friction}"), angles, line).with_colour(colour),
        );
        let angles = spread(92.0, 178.0, 22);
        let mut found = Vec::new();
        for angle in &angles {
            let outcome = reference(&spring(friction), psi(*angle))?;
            found.push(-outcome.tangential_speed / (psi(*angle) * SPEED));
        }
        points.push(
            Series::points(format!("spring with Coulomb limit, μ = {friction}"), angles, found)
                .with_colour(colour),
        );
    }
    for series in points {
        plot = plot.with(series);
    }
    Ok(Figure {
        name: "fig4a",
        plot: plot.with_size(760.0, 460.0),
        caption: format!(
            "Solid spheres on a wall, e_n = {RESTITUTION}, e_t0 = {STICKING}. Lines: Luding 1998, Eqs. (18)-(20), sliding for \
             small γ and sticking for large γ (erratum L-E3: the text of Sec. 7.4 has it the other way round). Markers: \
             LinearSpringDashpot with TangentialSpring, integrated to 1e-9. They leave the rule near the corner, where a real \
             contact sticks first and slides at its end (erratum L-E28)."
        ),
    })
}

fn impact_line() -> Result<Figure, Error> {
    let mut plot = Plot::new(
        "Fig. 4(b): velocity of the contact point after and before",
        Axis::linear("Ψ1").with_range(0.0, 5.0),
        Axis::linear("Ψ2").with_range(-1.2, 4.0),
    );
    let line = spread(0.0, 5.0, 501);
    let mut points = Vec::new();
    let mut farthest: f64 = 0.0;
    for (friction, colour) in FRICTIONS.into_iter().zip(Colour::PALETTE) {
        let exact = line.iter().map(|psi| rule(friction, *psi)).collect();
        plot = plot
            .with(Series::line(format!("Eq. (21), μ = {friction}"), line.clone(), exact).with_colour(colour));
        let samples = spread(0.1, 4.9, 25);
        let (mut tight, mut ran) = (Vec::new(), Vec::new());
        for psi in &samples {
            tight.push(reference(&spring(friction), *psi)?.tangential_speed / SPEED);
            ran.push(engine(&spring(friction), *psi)?);
        }
        for (tight, ran) in tight.iter().zip(&ran) {
            farthest = farthest.max((tight - ran).abs());
        }
        points.push(
            Series::line(format!("reference, spring, μ = {friction}"), samples.clone(), tight)
                .with_colour(Colour::PALETTE[2 + points.len()]),
        );
        points.push(
            Series::points(format!("engine, spring, μ = {friction}"), samples, ran).with_colour(colour),
        );
    }
    for series in points {
        plot = plot.with(series);
    }
    let plot =
        plot.with(Series::dashed("μ = 0", vec![0.0, 4.0], vec![0.0, 4.0]).with_colour(Colour::PALETTE[5]));
    Ok(Figure {
        name: "fig4b",
        plot: plot.with_size(760.0, 500.0),
        caption: format!(
            "e_n = {RESTITUTION}, e_t0 = {STICKING}, solid spheres on a wall. Piecewise straight: Luding 1998, Eq. (21). Smooth: \
             the spring with Coulomb limit, by the reference integrator in the hard limit. Markers: the same laws in the engine \
             at t_c = 20 µs and 400 steps a contact; largest difference to the reference {farthest:.1e}, which is the turning of \
             the normal and the step (erratum L-E20)."
        ),
    })
}

pub(super) fn tangential_laws() -> Result<Figure, Error> {
    const FRICTION: f64 = 0.3;
    let elastic = "normal: LinearSpringDashpot(contact_duration: 20e-6, restitution: 1)";
    let mass = 4.0 / 3.0 * std::f64::consts::PI * 1e-6;
    // Takes the sticking slip to a half: 2 η_t t_c = ln 2.
    let viscosity = 2.0_f64.ln() / 20e-6 * mass / INERTIA;
    let laws = [
        ("viscous, Eq. (48)", format!("{elastic}, tangential: ViscousTangential(damping: {viscosity:e})")),
        ("Coulomb, Eq. (51)", format!("{elastic}, tangential: Coulomb(friction: {FRICTION})")),
        (
            "spring, Eq. (53)",
            format!(
                "{elastic}, tangential: TangentialSpring(tangential_restitution: {STICKING}, friction: inf)"
            ),
        ),
        (
            "spring with Coulomb limit",
            format!(
                "{elastic}, tangential: TangentialSpring(tangential_restitution: {STICKING}, friction: {FRICTION})"
            ),
        ),
    ];
    let line = spread(0.0, 5.0, 501);
    let taken = FRICTION * 2.0 * INERTIA;
    let exact: [&dyn Fn(f64) -> f64; 3] =
        [&|psi| 0.5 * psi, &|psi| (psi - taken).max(0.0), &|psi| -STICKING * psi];
    let mut plot = Plot::new(
        "Fig. 7: tangential laws",
        Axis::linear("Ψ1").with_range(0.0, 5.0),
        Axis::linear("Ψ2").with_range(-2.6, 5.0),
    );
    let mut worst: f64 = 0.0;
    let mut points = Vec::new();
    for (index, (name, text)) in laws.iter().enumerate() {
        let colour = Colour::PALETTE[index];
        let samples = spread(0.1, 4.9, 25);
        let mut found = Vec::new();
        for psi in &samples {
            found.push(reference(text, *psi)?.tangential_speed / SPEED);
        }
        if let Some(exact) = exact.get(index) {
            for (psi, found) in samples.iter().zip(&found) {
                worst = worst.max((found - exact(*psi)).abs());
            }
            let values = line.iter().map(|psi| exact(*psi)).collect();
            plot = plot.with(Series::line(*name, line.clone(), values).with_colour(colour));
        } else {
            let values = line.iter().map(|psi| (psi - taken).max(-STICKING * psi)).collect();
            plot = plot.with(Series::line("Eq. (21)", line.clone(), values).with_colour(colour));
        }
        points.push(Series::points(format!("reference: {name}"), samples, found).with_colour(colour));
    }
    for series in points {
        plot = plot.with(series);
    }
    let printed = line.iter().map(|psi| psi + taken).collect();
    plot = plot
        .with(Series::dashed("Eq. (52) as printed", line, printed).with_colour(Colour::PALETTE[4]))
        .with(Series::dashed("μ = 0", vec![0.0, 5.0], vec![0.0, 5.0]).with_colour(Colour::PALETTE[5]))
        .with(
            Series::dashed("μ = ∞, e_t0 = 1", vec![0.0, 2.6], vec![0.0, -2.6])
                .with_colour(Colour::PALETTE[5]),
        );
    Ok(Figure {
        name: "fig7",
        plot: plot.with_size(760.0, 520.0),
        caption: format!(
            "e_n = 1, μ = {FRICTION}, e_t0 = {STICKING}, solid spheres on a wall. Each law alone lies on its closed form to \
             {worst:.0e} (Luding 1998, Eqs. (50), (52), (55)). Eq. (52) as printed speeds the slip up (erratum L-E4). Spring and \
             Coulomb limit together follow Eq. (21) far from its corner and round it (erratum L-E28)."
        ),
    })
}
