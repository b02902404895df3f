//! Fig. 1: the bouncing ball.

use granule_report::{Axis, Colour, Plot, Series};

use crate::simulate::Run;
use crate::{Error, Figure, spread};

const SPEED: f64 = 6.3;
const RESTITUTION: f64 = 0.9;
const GRAVITY: f64 = 9.81;
/// Duration of a contact in the engine \[s\].
const CONTACT: f64 = 1e-3;
const RADIUS: f64 = 1e-2;

pub(super) fn figure() -> Result<Figure, Error> {
    let drop = SPEED * SPEED / (2.0 * GRAVITY);
    let fall = SPEED / GRAVITY;
    // Luding 1998, Eq. (4), counts from the first impact (erratum L-E24).
    let collapse = fall + 2.0 * SPEED * RESTITUTION / (GRAVITY * (1.0 - RESTITUTION));
    let height = |time: f64| {
        let (mut begin, mut speed) = (fall, SPEED);
        if time < begin {
            return drop - 0.5 * GRAVITY * time * time;
        }
        loop {
            speed *= RESTITUTION;
            let flight = 2.0 * speed / GRAVITY;
            if time < begin + flight {
                return speed * (time - begin) - 0.5 * GRAVITY * (time - begin) * (time - begin);
            }
            begin += flight;
            if flight < 1e-9 {
                return 0.0;
            }
        }
    };
    let mut run = Run::new(&format!(
        r#"(version: 1, gravity: (0, 0, -{GRAVITY}), materials: {{ "a": (density: 1000) }},
        bodies: [Sphere(material: "a", radius: {RADIUS}, position: (0, 0, {}))],
        walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(restitution: {RESTITUTION}, contact_duration: {CONTACT}))],
        driver: TimeStep(step: 2e-5), run: (duration: 13))"#,
        RADIUS + drop
    ))?;
    let (mut times, mut heights) = (Vec::new(), Vec::new());
    let every = run.steps() / 160;
    for index in (0..=run.steps()).step_by(usize::try_from(every.max(1))?) {
        run.advance(index)?;
        times.push(run.time());
        heights.push(run.bodies()[0].position[2] - RADIUS);
    }
    let first = times.iter().zip(&heights).filter(|(time, _)| **time < 6.0);
    let worst = first.fold(0.0, |worst: f64, (time, found)| worst.max((found - height(*time)).abs()));
    let line = spread(0.0, 13.0, 2601);
    let exact = line.iter().map(|time| height(*time)).collect();
    // Luding 1998, text after Eq. (4): impacts until the next follows within a contact.
    let impacts = (GRAVITY * CONTACT / (2.0 * SPEED)).ln() / RESTITUTION.ln();
    let plot = Plot::new(
        "Fig. 1: height of a bouncing ball",
        Axis::linear("t [s]").with_range(0.0, 13.0),
        Axis::linear("height [m]").with_range(-0.05, 2.1),
    )
    .with(Series::line("instantaneous impacts", line, exact).with_colour(Colour::PALETTE[5]))
    .with(Series::points("engine, t_c = 1 ms", times, heights).with_colour(Colour::PALETTE[0]))
    .with(
        Series::dashed("all impacts are over", vec![collapse; 2], vec![0.0, 2.0])
            .with_colour(Colour::PALETTE[1]),
    );
    Ok(Figure {
        name: "fig1",
        plot: plot.with_size(860.0, 400.0),
        caption: format!(
            "v_0 = {SPEED} m/s, e_n = {RESTITUTION}, g = {GRAVITY} m/s². With instantaneous impacts there are infinitely many \
             until t = {collapse:.3} s: t_b = {:.3} s of Luding 1998, Eq. (4), counts from the first impact (erratum L-E24). \
             A contact that lasts t_c = 1 ms ends this after {impacts:.0} impacts. Largest difference during the first six \
             seconds: {worst:.1e} m, because each soft contact takes 1 ms.",
            collapse - fall
        ),
    })
}
