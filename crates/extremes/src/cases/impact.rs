//! Single impacts: masses, stiffness, damping, restitution.

use crate::run::ensure;
use crate::scene::{Ball, ball, head_on, scene};
use crate::{Case, Lab};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "mass-ratio",
        extreme: "mass ratios 1e6 and 1e12",
        expected: "the light one comes back with -e v, to 2e-6 at 2e5 steps a contact; momentum is kept",
        slow: false,
        check: mass_ratio,
    },
    Case {
        name: "infinite-mass",
        extreme: "a partner of infinite mass (frozen), and one of 1e300 kg",
        expected: "both reflect with -e v, to 1e-3 at 500 steps a contact; the frozen one does not move",
        slow: false,
        check: infinite_mass,
    },
    Case {
        name: "elastic",
        extreme: "restitution of exactly 1",
        expected: "the speeds are exchanged, to 1e-6 at 2000 steps a contact; energy is kept",
        slow: false,
        check: elastic,
    },
    Case {
        name: "critical-damping",
        extreme: "damping of exactly the critical value, eta = w0",
        expected: "e = exp(-2) = 0.135335 and no force after w0 t = 2, to 1e-4 at 2e4 steps",
        slow: false,
        check: critical_damping,
    },
    Case {
        name: "overdamped",
        extreme: "damping of 10, 1e3 and 1e6 times the critical value",
        expected: "the bodies stop each other: they part with less than exp(-2) of the speed, momentum is kept",
        slow: false,
        check: overdamped,
    },
    Case {
        name: "stiffness",
        extreme: "stiffness from 1 to 1e14 N/m, below 1e3 N/m at 1 mm/s",
        expected: "the same restitution to 1e-3; the overlap goes with k^(-1/2), exponent to 1e-3",
        slow: false,
        check: stiffness,
    },
    Case {
        name: "too-soft",
        extreme: "stiffness of 1 N/m: the overlap would be larger than the bodies",
        expected: "a warning before the run with the overlap",
        slow: false,
        check: too_soft,
    },
    Case {
        name: "hertz-modulus",
        extreme: "Young's moduli from 1e4 to 1e14 Pa",
        expected: "the same restitution to 1e-3; the overlap goes with E^(-2/5), exponent to 1e-3",
        slow: false,
        check: hertz_modulus,
    },
    Case {
        name: "impact-speed",
        extreme: "speeds from 1e-8 to 1e3 m/s on a linear contact",
        expected: "the same restitution to 1e-3",
        slow: false,
        check: impact_speed,
    },
];

fn mass_ratio(lab: &Lab) -> Result<String, String> {
    let mut worst: (f64, f64) = (0.0, 0.0);
    for partner in [1e4, 1e10] {
        let end = lab.run(&scene(
            &head_on(0.01, partner),
            "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
            "driver: TimeStep(step: Auto(steps_per_contact: 200000)), run: (duration: 4e-3)",
        ))?;
        let expected = 1.0 - 1.8 * partner / (0.01 + partner);
        let off = (end[0].velocity[0] - expected).abs();
        let gained = 0.01 * (end[0].velocity[0] - 1.0) + partner * end[1].velocity[0];
        // The heavy one takes up velocity in rounded parts: an ulp of its momentum in each of its steps.
        let momentum = (gained / 0.018).abs();
        // The force of the step in which the contact begins is up to half a step off: with 2 η/ω = 0.14 that is up to 0.16 of
        // a step's share, and 2e5 steps leave 1e-6.
        ensure(off < 2e-6, || format!("ratio {:e}: velocity off by {off:e}", partner / 0.01))?;
        ensure(momentum < 1e-11, || format!("ratio {:e}: momentum off by {momentum:e}", partner / 0.01))?;
        worst = (worst.0.max(off), worst.1.max(momentum));
    }
    Ok(format!("velocity off by {:.1e} m/s, momentum by {:.0e}", worst.0, worst.1))
}

fn infinite_mass(lab: &Lab) -> Result<String, String> {
    let mut balls = head_on(0.01, 1.0);
    let run = |balls: &[Ball]| {
        lab.run(&scene(
            balls,
            "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8)",
            "driver: TimeStep(step: Auto(steps_per_contact: 500)), run: (duration: 8e-3)",
        ))
    };
    balls[1].frozen = true;
    let frozen = run(&balls)?;
    balls[1] = Ball { mass: 1e300, frozen: false, ..balls[1] };
    let heavy = run(&balls)?;
    for end in [&frozen, &heavy] {
        let velocity = end[0].velocity[0];
        ensure((velocity + 0.8).abs() < 1e-3, || format!("velocity {velocity}"))?;
    }
    ensure(frozen[1].position == balls[1].position, || "the frozen one has moved".to_string())?;
    Ok(format!("velocities {:.5} and {:.5} m/s", frozen[0].velocity[0], heavy[0].velocity[0]))
}

fn elastic(lab: &Lab) -> Result<String, String> {
    let end = lab.run(&scene(
        &head_on(0.01, 0.01),
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 1)",
        "driver: TimeStep(step: Auto(steps_per_contact: 2000)), run: (duration: 4e-3)",
    ))?;
    let (left, right) = (end[0].velocity[0], end[1].velocity[0]);
    // Second order in the step: (π/2000)²/24 = 1e-7, and the parts of a step at both ends of the contact.
    ensure(left.abs() < 1e-6 && (right - 1.0).abs() < 1e-6, || format!("velocities {left} {right}"))?;
    let energy = left * left + right * right;
    ensure((energy - 1.0).abs() < 2e-6, || format!("energy {energy}"))?;
    Ok(format!("e = {:.7}", right - left))
}

fn critical_damping(lab: &Lab) -> Result<String, String> {
    let (stiffness, reduced) = (1e4_f64, 0.005_f64);
    let step = 1.0 / ((stiffness / reduced).sqrt() * 20_000.0);
    let text = scene(
        &head_on(0.01, 0.01),
        &format!(
            "normal: LinearSpringDashpot(stiffness: {stiffness:?}, damping: {:?})",
            2.0 * (stiffness * reduced).sqrt()
        ),
        &format!("driver: TimeStep(step: {step:?}), run: (duration: 2e-3)"),
    );
    let mut steps = 0_u64;
    let end = lab.watch(&text, &mut |_, state| {
        steps += u64::from(state[0].force[0] != 0.0);
        Ok(())
    })?;
    let restitution = end[1].velocity[0] - end[0].velocity[0];
    let duration = steps as f64 / 20_000.0;
    // First order in the step; and a step at either end of the contact.
    ensure((restitution - (-2.0f64).exp()).abs() < 1e-4, || format!("e = {restitution}"))?;
    ensure((duration - 2.0).abs() < 2e-4, || format!("the force lasts until w0 t = {duration}"))?;
    Ok(format!("e = {restitution:.6}, w0 t = {duration:.4}"))
}

fn overdamped(lab: &Lab) -> Result<String, String> {
    let critical = 2.0 * (1e4_f64 * 0.005).sqrt();
    let mut parts = Vec::new();
    for factor in [10.0, 1e3, 1e6] {
        let end = lab.run(&scene(
            &head_on(0.01, 0.01),
            &format!("normal: LinearSpringDashpot(stiffness: 1e4, damping: {:?})", critical * factor),
            "driver: TimeStep(), run: (duration: 5e-4)",
        ))?;
        let parting = end[1].velocity[0] - end[0].velocity[0];
        let momentum = end[0].velocity[0] + end[1].velocity[0] - 1.0;
        ensure(parting.abs() < 0.135_34, || format!("{factor:e}: they part with {parting}"))?;
        ensure(momentum.abs() < 1e-10, || format!("{factor:e}: momentum off by {momentum:e}"))?;
        parts.push(format!("{parting:.0e}"));
    }
    Ok(format!("they part with {} m/s", parts.join(", ")))
}

/// Restitution and largest overlap of two bodies that meet head on.
fn meet(lab: &Lab, normal: &str, speed: f64, duration: f64) -> Result<(f64, f64), String> {
    let mut balls = head_on(0.01, 0.01);
    balls[0].velocity[0] = speed;
    // The way to the contact takes a few steps.
    balls[1].position[0] = 0.02 + 0.1 * speed * duration;
    let text = scene(
        &balls,
        &format!("normal: {normal}"),
        &format!(
            "driver: TimeStep(step: Auto(steps_per_contact: 500)), run: (duration: {:?})",
            1.2 * duration
        ),
    );
    let mut deepest: f64 = 0.0;
    let end = lab.watch(&text, &mut |view, _| {
        deepest = deepest.max(view.tally().maximum_overlap);
        Ok(())
    })?;
    Ok(((end[1].velocity[0] - end[0].velocity[0]) / speed, deepest))
}

/// Impacts over decades of a stiffness: worst error of the restitution 0.8, and of the exponent of the overlap.
fn decades(
    lab: &Lab,
    values: &[f64],
    exponent: f64,
    normal: impl Fn(f64) -> String,
    duration: impl Fn(f64) -> f64,
) -> Result<String, String> {
    let (_, reference) = meet(lab, &normal(1e4), 1.0, duration(1e4))?;
    let (mut worst, mut worst_exponent): (f64, f64) = (0.0, 0.0);
    for value in values {
        let (restitution, deepest) = meet(lab, &normal(*value), 1.0, duration(*value))?;
        let found = (deepest / reference).ln() / (value / 1e4).ln();
        // First order in the step: 4e-4 at 500 steps a contact.
        ensure((restitution - 0.8).abs() < 1e-3, || format!("{value:e}: e = {restitution}"))?;
        ensure((found - exponent).abs() < 1e-3, || format!("{value:e}: exponent {found}"))?;
        worst = worst.max((restitution - 0.8).abs());
        worst_exponent = worst_exponent.max((found - exponent).abs());
    }
    Ok(format!("e = 0.8 to {worst:.0e}, exponent {exponent} to {worst_exponent:.0e}"))
}

fn stiffness(lab: &Lab) -> Result<String, String> {
    // At 1 m/s the bodies would pass through each other: the case `too-soft`.
    for k in [1.0, 10.0, 100.0] {
        let balls = [ball([0.0; 3], [1e-3, 0.0, 0.0]), ball([0.020001, 0.0, 0.0], [0.0; 3])];
        let time = 1e-3 + 1.2 * std::f64::consts::PI * (0.005f64 / k).sqrt();
        let end = lab.run(&scene(
            &balls,
            &format!("normal: LinearSpringDashpot(stiffness: {k:?}, restitution: 0.8)"),
            &format!("driver: TimeStep(step: Auto(steps_per_contact: 2000)), run: (duration: {time:?})"),
        ))?;
        let restitution = (end[1].velocity[0] - end[0].velocity[0]) / 1e-3;
        ensure((restitution - 0.8).abs() < 1e-3, || format!("e = {restitution} at {k} N/m"))?;
    }
    decades(
        lab,
        &[1e3, 1e6, 1e9, 1e12, 1e14],
        -0.5,
        |k| format!("LinearSpringDashpot(stiffness: {k:?}, restitution: 0.8)"),
        |k| 1.2 * std::f64::consts::PI * (0.005 / k).sqrt(),
    )
}

fn hertz_modulus(lab: &Lab) -> Result<String, String> {
    decades(
        lab,
        &[1e5, 1e7, 1e9, 1e12, 1e14],
        -0.4,
        |modulus| format!("Hertz(youngs_modulus: {modulus:?}, poisson_ratio: 0.3, restitution: 0.8)"),
        |modulus| {
            // Duration of the elastic impact, 2.94 δ/v; damping lengthens it by less than a half.
            let stiffness = 4.0 / 3.0 * (modulus / (2.0 * 0.91)) * 0.005f64.sqrt();
            4.5 * (1.25 * 0.005 / stiffness).powf(0.4)
        },
    )
}

fn too_soft(lab: &Lab) -> Result<String, String> {
    let text = scene(
        &head_on(0.01, 0.01),
        "normal: LinearSpringDashpot(stiffness: 1, restitution: 0.8)",
        "driver: TimeStep(), run: (duration: 1)",
    );
    Ok(format!("warning: {}", lab.warning(&text, "of the smaller radius")?))
}

fn impact_speed(lab: &Lab) -> Result<String, String> {
    let mut worst: f64 = 0.0;
    for speed in [1e-8, 1e-4, 1.0, 1e3] {
        // The gap takes as long as the contact, so that steps are the same.
        let mut balls = [ball([0.0; 3], [speed, 0.0, 0.0]), ball([0.02, 0.0, 0.0], [0.0; 3])];
        balls[1].position[0] += 1e-4 * speed.min(1.0);
        let end = lab.run(&scene(
            &balls,
            "normal: LinearSpringDashpot(stiffness: 1e9, restitution: 0.8)",
            "driver: TimeStep(step: Auto(steps_per_contact: 500)), run: (duration: 2e-4)",
        ))?;
        let restitution = (end[1].velocity[0] - end[0].velocity[0]) / speed;
        worst = worst.max((restitution - 0.8).abs());
        // First order in the step; at 1e-8 m/s the overlap is 2e-14 m, 6000 spacings of positions.
        ensure((restitution - 0.8).abs() < 1e-3, || format!("{speed:e} m/s: e = {restitution}"))?;
    }
    Ok(format!("e = 0.8 to {worst:.0e}"))
}
