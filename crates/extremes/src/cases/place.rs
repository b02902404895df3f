//! Where bodies are: far away, on top of each other, beside each other, around the period.

use crate::run::{Body, advance, bodies, ensure, start};
use crate::scene::{ball, head_on, scene};
use crate::{Case, Lab};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "far-from-the-origin",
        extreme: "an impact 1e9 radii from the origin, where positions are multiples of 1e-7 radii",
        expected: "the result near the origin to 1e-3 (the overlap has 1e6 such multiples)",
        slow: false,
        check: far_from_the_origin,
    },
    Case {
        name: "beyond-resolution",
        extreme: "a stiff impact 1e9 radii from the origin: the overlap has fewer than 100 multiples of the spacing",
        expected: "a warning before the run with the spacing of positions and the overlap",
        slow: false,
        check: beyond_resolution,
    },
    Case {
        name: "beyond-size",
        extreme: "bodies 1e14 radii from the origin: positions are multiples of 1.6 % of a radius",
        expected: "refused, with the spacing of positions",
        slow: false,
        check: beyond_size,
    },
    Case {
        name: "coincident-centres",
        extreme: "centres in one place, or 5e-324 to 1e-20 m apart, in a frictional contact",
        expected: "finite, equal and opposite forces that drive them apart",
        slow: false,
        check: coincident_centres,
    },
    Case {
        name: "huge-overlap",
        extreme: "an overlap of 1.9 radii at the start",
        expected: "refused; with `allow_overlap: true` the stored energy k d^2/2 becomes motion, to 1e-3",
        slow: false,
        check: huge_overlap,
    },
    Case {
        name: "grazing",
        extreme: "a pass that overlaps by 1e-12 diameters, and one that misses by as much",
        expected: "a contact of 5 to 6 steps, and none; the course does not change by more than 1e-6",
        slow: false,
        check: grazing,
    },
    Case {
        name: "many-boxes-in-a-step",
        extreme: "a body that crosses the periodic cell 3.7 times a step, over 1000 steps",
        expected: "its place in the cell to 1e-10 m",
        slow: false,
        check: many_boxes,
    },
    Case {
        name: "countless-boxes",
        extreme: "a body that crosses the periodic cell 1e12 times in a step",
        expected: "the run stops with the body: its place in the cell means nothing any more",
        slow: false,
        check: countless_boxes,
    },
    Case {
        name: "small-cell",
        extreme: "a periodic cell smaller than two diameters",
        expected: "refused: a pair would meet in two images",
        slow: false,
        check: small_cell,
    },
    Case {
        name: "tunnelling",
        extreme: "bodies that move by five radii in a step",
        expected: "a warning before the run with the step that is needed",
        slow: false,
        check: tunnelling,
    },
    Case {
        name: "tunnelling-hard",
        extreme: "the same speeds from collision to collision",
        expected: "the exact velocities after the impact",
        slow: false,
        check: tunnelling_hard,
    },
    Case {
        name: "wedge",
        extreme: "a sphere in a wedge of 60 degrees, dissipative, under gravity",
        expected: "it rests in the middle with the overlaps W/k, to 1e-3",
        slow: false,
        check: wedge,
    },
];

/// An impact at 1 m/s of bodies of 1 m and 1 kg around `origin`.
fn impact_at(origin: f64, stiffness: f64, step: f64) -> String {
    let mut balls = head_on(1.0, 1.0);
    for ball in &mut balls {
        ball.radius = 1.0;
        ball.position[0] = origin + 102.0 * ball.position[0];
    }
    scene(
        &balls,
        &format!("normal: LinearSpringDashpot(stiffness: {stiffness:?}, restitution: 0.8)"),
        &format!("driver: TimeStep(step: {step:?}), run: (duration: 1)"),
    )
}

fn far_from_the_origin(lab: &Lab) -> Result<String, String> {
    let near = lab.run(&impact_at(0.0, 50.0, 1e-3))?;
    let far = lab.run(&impact_at(1e9, 50.0, 1e-3))?;
    ensure(near[0].velocity[0] < 0.2, || format!("they have not collided: {near:?}"))?;
    let mut worst: f64 = 0.0;
    for (a, b) in near.iter().zip(&far) {
        worst = worst.max((a.velocity[0] - b.velocity[0]).abs());
    }
    // Steps of 1e-3 m are rounded to multiples of 1.2e-7 m: 1e-4 of every step, at random in sign.
    ensure(worst < 1e-3, || format!("velocities differ by {worst:e}"))?;
    Ok(format!("velocities differ by {worst:.0e} m/s"))
}

fn beyond_resolution(lab: &Lab) -> Result<String, String> {
    Ok(format!("warning: {}", lab.warning(&impact_at(1e9, 1e12, 1e-8), "multiples of")?))
}

fn beyond_size(lab: &Lab) -> Result<String, String> {
    Ok(format!("refused: {}", lab.refusal(&impact_at(1e14, 50.0, 1e-3), "multiples of")?))
}

fn coincident_centres(lab: &Lab) -> Result<String, String> {
    let mut weakest = f64::INFINITY;
    for offset in [0.0, 5e-324, 1e-300, 1e-160, 1e-20] {
        let balls = [ball([0.0; 3], [0.0; 3]), ball([offset, 0.0, 0.0], [0.0; 3])];
        let text = scene(
            &balls,
            "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), tangential: TangentialSpring(stiffness: 3e3, \
             friction: 0.5)",
            "allow_overlap: true, driver: TimeStep(), run: (steps: 10)",
        );
        lab.watch(&text, &mut |_, state| {
            let opposite = (0..3).all(|axis| {
                state[0].force[axis].is_finite() && state[0].force[axis] == -state[1].force[axis]
            });
            ensure(opposite, || format!("{offset:e} m apart: {state:?}"))?;
            weakest = weakest.min(state[0].force.iter().map(|f| f * f).sum::<f64>().sqrt());
            Ok(())
        })?;
    }
    ensure(weakest > 10.0, || format!("forces of only {weakest} N"))?;
    Ok(format!("forces of {weakest:.0} N and more, equal and opposite"))
}

fn huge_overlap(lab: &Lab) -> Result<String, String> {
    let balls = [ball([0.0; 3], [0.0; 3]), ball([0.001, 0.0, 0.0], [0.0; 3])];
    let text = |more: &str| {
        scene(
            &balls,
            "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 1)",
            &format!("{more} driver: TimeStep(step: Auto(steps_per_contact: 500)), run: (duration: 4e-3)"),
        )
    };
    let refusal = lab.refusal(&text(""), "overlap by")?;
    let end = lab.run(&text("allow_overlap: true,"))?;
    // k δ²/2 = m12 v²/2.
    let expected = 0.019 * (1e4 / 0.005f64).sqrt();
    let speed = end[1].velocity[0] - end[0].velocity[0];
    ensure((speed / expected - 1.0).abs() < 1e-3, || format!("they part with {speed}, not {expected} m/s"))?;
    Ok(format!("refused: {refusal}; allowed: they part with {:.5} of the speed", speed / expected))
}

fn grazing(lab: &Lab) -> Result<String, String> {
    let mut counts = Vec::new();
    for (gap, range) in [(-1e-12, 5..=6), (1e-12, 0..=0)] {
        let balls = [ball([0.0; 3], [1.0, 0.0, 0.0]), ball([3e-7, 0.02 * (1.0 + gap), 0.0], [0.0; 3])];
        let text = scene(
            &balls,
            "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
            "driver: TimeStep(step: 1e-8), run: (steps: 60)",
        );
        let mut touched = 0;
        let end = lab.watch(&text, &mut |view, _| {
            touched += view.tally().contacts;
            Ok(())
        })?;
        // The chord of the pass is 2 d sqrt(2e-12) = 5.7e-8 m, which takes 5 to 6 steps.
        ensure(range.contains(&touched), || format!("gap {gap:e} d: {touched} steps of contact"))?;
        let turned = (end[0].velocity[0] - 1.0).abs().max(end[0].velocity[1].abs());
        ensure(turned < 1e-6, || format!("gap {gap:e} d: the course changed by {turned:e}"))?;
        counts.push(touched.to_string());
    }
    Ok(format!("{} steps of contact", counts.join(" and ")))
}

fn many_boxes(lab: &Lab) -> Result<String, String> {
    let balls = [ball([0.01, 0.05, 0.05], [3.7e4, 0.0, 0.0]), ball([0.05, 0.05, 0.02], [3.7e4, 0.0, 0.0])];
    let text = scene(
        &balls,
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
        "cell: (lo: (0, 0, 0), hi: (0.1, 0.1, 0.1), periodic: (true, true, true)), driver: TimeStep(step: 1e-5), run: \
         (steps: 1000)",
    );
    let plan = lab.plan(&text)?.plan;
    let mut driver = start(&plan)?;
    advance(&mut *driver, 1000)?;
    let mut worst: f64 = 0.0;
    for (body, begin) in bodies(&driver.view()).iter().zip(&balls) {
        let place = plan.cell.wrap(body.position).0[0];
        let expected = (begin.position[0] + 3.7e4 * 1e-5 * 1000.0).rem_euclid(0.1);
        ensure((0.0..0.1).contains(&place), || format!("x = {place} is outside the cell"))?;
        worst = worst.max((place - expected).abs());
    }
    // The position is a sum of a thousand steps of 0.37 m, at up to 370 m: 1000 ulps of 6e-14 m.
    ensure(worst < 1e-10, || format!("places off by {worst:e} m"))?;
    Ok(format!("places off by {worst:.0e} m"))
}

fn countless_boxes(lab: &Lab) -> Result<String, String> {
    let text = scene(
        &[ball([0.01, 0.05, 0.05], [1e16, 0.0, 0.0]), ball([0.05, 0.05, 0.02], [0.0; 3])],
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
        "cell: (lo: (0, 0, 0), hi: (0.1, 0.1, 0.1), periodic: (true, true, true)), driver: TimeStep(step: 1e-5), run: \
         (steps: 1000)",
    );
    match lab.run(&text) {
        Err(why) if why.contains("body 1 has crossed the periodic cell") => Ok(format!("stopped: {why}")),
        other => Err(format!("{other:?}")),
    }
}

fn small_cell(lab: &Lab) -> Result<String, String> {
    let text = scene(
        &[ball([0.01; 3], [0.0; 3]), ball([0.02, 0.02, 0.035], [0.0; 3])],
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
        "allow_overlap: true, cell: (lo: (0, 0, 0), hi: (0.039, 1, 1), periodic: (true, false, false)), driver: \
         TimeStep(), run: (steps: 10)",
    );
    Ok(format!("refused: {}", lab.refusal(&text, "periodic length")?))
}

fn fast(driver: &str, laws: &str) -> String {
    scene(
        &[ball([0.0; 3], [5e3, 0.0, 0.0]), ball([0.1, 0.0, 0.0], [0.0; 3])],
        laws,
        &format!("driver: {driver}, run: (duration: 1e-4)"),
    )
}

fn tunnelling(lab: &Lab) -> Result<String, String> {
    let text = fast("TimeStep(step: 1e-5)", "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)");
    Ok(format!("warning: {}", lab.warning(&text, "jumped over")?))
}

fn tunnelling_hard(lab: &Lab) -> Result<String, String> {
    let end = lab.run(&fast("Event(step: 1e-5)", "collision: HardSphere(restitution: 0.8)"))?;
    let velocities: Vec<f64> = end.iter().map(|body: &Body| body.velocity[0]).collect();
    let off = (velocities[0] - 500.0).abs().max((velocities[1] - 4500.0).abs());
    ensure(off < 1e-11 * 5e3, || format!("velocities {velocities:?}"))?;
    Ok(format!("velocities {} and {} m/s", velocities[0], velocities[1]))
}

fn wedge(lab: &Lab) -> Result<String, String> {
    let text = r#"(version: 1, gravity: (0, 0, -9.81), materials: { "a": (density: 2500) },
        bodies: [Sphere(material: "a", radius: 0.01, position: (0, 0, 0.0201))],
        walls: { "left": Plane(point: (0, 0, 0), normal: (0.8660254037844386, 0, 0.5), material: "a"),
                 "right": Plane(point: (0, 0, 0), normal: (-0.8660254037844386, 0, 0.5), material: "a") },
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.3))],
        driver: TimeStep(), run: (duration: 1))"#;
    let end = lab.run(text)?;
    let weight = 4.0 / 3.0 * std::f64::consts::PI * 1e-6 * 2500.0 * 9.81;
    // Two springs at 30 degrees above the horizontal carry N = W / (2 sin 30°) = W each, an overlap of W/k, which lets the
    // sphere down by twice that.
    let overlap = 0.5 * (0.02 - end[0].position[2]) * 1e4 / weight;
    ensure((overlap - 1.0).abs() < 1e-3, || format!("overlap of {overlap} W/k"))?;
    ensure(end[0].position[0].abs() < 1e-15 && end[0].velocity[2].abs() < 1e-9, || format!("{:?}", end[0]))?;
    Ok(format!("overlaps of {overlap:.5} W/k, {:.0e} m off the middle", end[0].position[0].abs()))
}
