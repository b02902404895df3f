//! Bodies at rest, bodies that hardly move, and time that goes on for long.

use crate::run::{advance, bodies, end, ensure, start};
use crate::scene::{Ball, ball, scene};
use crate::{Case, Lab};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "denormal-speeds",
        extreme: "speeds of 1e-310 m/s and spins of 1e-312 rad/s in a contact",
        expected: "nothing gets faster; no endless loop",
        slow: false,
        check: denormal_speeds,
    },
    Case {
        name: "nothing-acts",
        extreme: "9261 bodies at rest that do not touch, 1000 steps",
        expected: "the same bits",
        slow: false,
        check: nothing_acts,
    },
    Case {
        name: "column",
        extreme: "a column of 1000 spheres that carry each other, 2e4 steps",
        expected: "the floor carries 1000 m g, to 1e-9; the column stands straight to the bit",
        slow: false,
        check: |lab| column(lab, 20_000),
    },
    Case {
        name: "column-long",
        extreme: "the column of 1000 spheres for a million steps",
        expected: "the same",
        slow: true,
        check: |lab| column(lab, 1_000_000),
    },
    Case {
        name: "ten-billion-steps",
        extreme: "a run of 1e10 steps of 1e-7 s; of them 1e6 are done",
        expected: "time is the number of steps times the step, to the bit; a summed time is off by 1e-11",
        slow: false,
        check: ten_billion_steps,
    },
    Case {
        name: "more-steps-than-numbers",
        extreme: "a run of 1e20 steps",
        expected: "refused: more than can be counted",
        slow: false,
        check: more_steps_than_numbers,
    },
    Case {
        name: "one-body",
        extreme: "a single body that falls",
        expected: "x = v t and z = -g t^2/2 after 1000 steps, to 1e-12",
        slow: false,
        check: one_body,
    },
    Case {
        name: "one-body-hard",
        extreme: "a single hard body that nothing ever happens to",
        expected: "the run ends, x = v t, to 1e-12",
        slow: false,
        check: one_body_hard,
    },
];

fn denormal_speeds(lab: &Lab) -> Result<String, String> {
    let mut balls = [ball([0.0; 3], [1e-310, 3e-320, 0.0]), ball([0.02, 0.0, 0.0], [0.0; 3])];
    balls[0].spin = [0.0, 0.0, 1e-312];
    let mut fastest: f64 = 0.0;
    for law in ["TangentialSpring(stiffness: 3e3, friction: 0.3)", "Coulomb(friction: 0.3)"] {
        let end = lab.run(&scene(
            &balls,
            &format!("normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), tangential: {law}"),
            "allow_overlap: true, driver: TimeStep(), run: (duration: 1e-2)",
        ))?;
        for component in end.iter().flat_map(|body| body.velocity) {
            fastest = fastest.max(component.abs());
            ensure(component.abs() <= 1e-310, || format!("{law}: {end:?}"))?;
        }
    }
    Ok(format!("{fastest:.1e} m/s at most"))
}

fn nothing_acts(lab: &Lab) -> Result<String, String> {
    let text = r#"(version: 1, seed: 4, materials: { "a": (density: 1000) },
        bodies: [Lattice(material: "a", radius: 0.01, spacing: 0.021, lo: (0, 0, 0), hi: (0.42, 0.42, 0.42), jitter: 4e-4)],
        contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8),
            tangential: TangentialSpring(stiffness: 3e3, friction: 0.3))],
        driver: TimeStep(), run: (steps: 1000))"#;
    let plan = lab.plan(text)?.plan;
    let before = bodies(&start(&plan)?.view());
    ensure(before.len() == 9261, || format!("{} bodies", before.len()))?;
    ensure(before == end(&plan)?, || "something has moved".to_string())?;
    Ok("the same bits".to_string())
}

/// A column in equilibrium: sphere n from the top rests on an overlap of n m g/k.
fn column(lab: &Lab, steps: u64) -> Result<String, String> {
    const COUNT: usize = 1000;
    let (radius, mass, gravity, stiffness) = (0.01, 0.01, 9.81, 1e6);
    let mut height = 0.0;
    let mut balls: Vec<Ball> = Vec::with_capacity(COUNT);
    for index in 0..COUNT {
        let overlap = (COUNT - index) as f64 * mass * gravity / stiffness;
        height += if index == 0 { radius } else { 2.0 * radius } - overlap;
        balls.push(ball([0.0, 0.0, height], [0.0; 3]));
    }
    let text = scene(
        &balls,
        &format!(
            "normal: LinearSpringDashpot(stiffness: {stiffness:?}, restitution: 0.5), tangential: \
             TangentialSpring(stiffness: 3e5, friction: 0.5)"
        ),
        &format!(
            r#"gravity: (0, 0, -{gravity}), walls: {{ "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") }},
            driver: TimeStep(), run: (steps: {steps})"#
        ),
    );
    let plan = lab.plan(&text)?.plan;
    let mut driver = start(&plan)?;
    advance(&mut *driver, steps)?;
    let view = driver.view();
    let carried = -view.tally().wall_force[0][2] / (COUNT as f64 * mass * gravity);
    // The places of the start are rounded to an ulp of 20 m, 3.6e-15 m, of overlaps of 1e-5 m: 4e-10.
    ensure((carried.abs() - 1.0).abs() < 1e-9, || format!("the floor carries {carried} of the weight"))?;
    let straight = bodies(&view).iter().all(|body| body.position[..2] == [0.0; 2] && body.spin == [0.0; 3]);
    ensure(straight, || "the column leans".to_string())?;
    Ok(format!("the floor carries the weight to {:.0e}", (carried.abs() - 1.0).abs()))
}

fn ten_billion_steps(lab: &Lab) -> Result<String, String> {
    let step = 1e-7;
    let text = scene(
        &[ball([0.0; 3], [1.0, 0.0, 0.0])],
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
        &format!("driver: TimeStep(step: {step:e}), run: (duration: 1000)"),
    );
    let plan = lab.plan(&text)?.plan;
    ensure(plan.driver.steps == 10_000_000_000, || format!("{} steps", plan.driver.steps))?;
    let mut driver = start(&plan)?;
    advance(&mut *driver, 1_000_000)?;
    let (time, summed) = (driver.time(), (0..1_000_000).fold(0.0, |time: f64, _| time + step));
    ensure(time == 1e6 * step, || format!("time {time:e}"))?;
    let last = plan.driver.steps as f64 * plan.driver.step;
    ensure(last == 1000.0, || format!("the last time is {last:e} s"))?;
    // The place is a sum of a million rounded steps of 1e-7 m: 1e6 times half an ulp of 0.1 m at most.
    let place = bodies(&driver.view())[0].position[0];
    ensure((place - 0.1).abs() < 1e6 * 0.7e-17, || format!("x = {place}"))?;
    Ok(format!("the same bits; a summed time is off by {:.0e}", (summed / time - 1.0).abs()))
}

fn more_steps_than_numbers(lab: &Lab) -> Result<String, String> {
    let text = scene(
        &[ball([0.0; 3], [1.0, 0.0, 0.0])],
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
        "driver: TimeStep(step: 1e-10), run: (duration: 1e10)",
    );
    Ok(format!("refused: {}", lab.refusal(&text, "more than can be counted")?))
}

fn one_body(lab: &Lab) -> Result<String, String> {
    let end = lab.run(&scene(
        &[ball([0.0; 3], [1.0, 0.0, 0.0])],
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
        "gravity: (0, 0, -10), driver: TimeStep(step: 1e-3), run: (duration: 1)",
    ))?;
    let off = (end[0].position[0] - 1.0).abs().max((end[0].position[2] + 5.0).abs());
    ensure(off < 1e-12, || format!("{end:?}"))?;
    Ok(format!("off by {off:.0e} m"))
}

fn one_body_hard(lab: &Lab) -> Result<String, String> {
    let end = lab.run(&scene(
        &[ball([0.0; 3], [1.0, 0.0, 0.0])],
        "collision: HardSphere(restitution: 0.8)",
        "driver: Event(), run: (duration: 1)",
    ))?;
    let off = (end[0].position[0] - 1.0).abs();
    ensure(off < 1e-12, || format!("{end:?}"))?;
    Ok(format!("off by {off:.0e} m"))
}
