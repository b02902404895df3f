//! Spins and friction.

use crate::run::{Body, ensure};
use crate::scene::{head_on, scene};
use crate::{Case, Lab};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "spin",
        extreme: "a surface that moves a million times as fast as the bodies approach, under three laws of friction",
        expected: "friction at its limit against the slip at every step; energy never grows beyond round-off",
        slow: false,
        check: spin,
    },
    Case {
        name: "drilling",
        extreme: "a spin of 1e6 rad/s about the line of centres",
        expected: "no friction at all: spins and velocities across stay the same bits",
        slow: false,
        check: drilling,
    },
    Case {
        name: "no-friction",
        extreme: "a friction coefficient of 0 between spinning bodies",
        expected: "spins stay the same bits",
        slow: false,
        check: no_friction,
    },
    Case {
        name: "infinite-friction",
        extreme: "a friction coefficient of infinity",
        expected: "the contact never slides: the result of mu = 1e6, to 1 %",
        slow: false,
        check: infinite_friction,
    },
    Case {
        name: "slip-threshold",
        extreme: "a plate whose acceleration is 1e-9 below and above 7/2 mu g, the limit of rolling",
        expected: "rolls, and slips; at most one onset of slip in half a period",
        slow: false,
        check: slip_threshold,
    },
];

fn energy(state: &[Body]) -> f64 {
    let square = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>();
    state.iter().map(|body| 0.5 * 0.01 * (square(body.velocity) + 0.4e-4 * square(body.spin))).sum()
}

fn spin(lab: &Lab) -> Result<String, String> {
    let mut balls = head_on(0.01, 0.01);
    balls[0].spin = [0.0, 0.0, 1e8];
    let mut worst: f64 = 0.0;
    for law in [
        "TangentialSpring(stiffness: 3e3, friction: 0.3)",
        "Coulomb(friction: 0.3)",
        "ViscousTangential(damping: 1, friction: 0.3)",
    ] {
        let text = scene(
            &balls,
            &format!("normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), tangential: {law}"),
            "driver: TimeStep(), run: (duration: 4e-3)",
        );
        let (mut before, mut slid) = (f64::INFINITY, false);
        lab.watch(&text, &mut |_, state| {
            // Components along the line of centres and at right angles to it, in the plane of the motion.
            let [x, y] = [0, 1].map(|k| state[1].position[k] - state[0].position[k]);
            let distance = (x * x + y * y).sqrt();
            let force = state[0].force;
            let normal = (force[0] * x + force[1] * y) / distance;
            let tangential = (force[1] * x - force[0] * y) / distance;
            let within = tangential.abs() <= 0.3 * normal.abs() * (1.0 + 1e-12) + 1e-300;
            ensure(within, || format!("{law}: friction {tangential} N at {normal} N"))?;
            // The spin about +z moves the contact point of the first body up; the force on it is down.
            ensure(tangential <= 0.0, || format!("{law}: friction {tangential} N along the slip"))?;
            slid |= tangential < 0.0;
            let after = energy(state);
            // The energy of the spin is 2e9 J, in which an ulp is 2e-7 J.
            ensure(after <= before * (1.0 + 8e-15), || format!("{law}: energy {before} J, then {after} J"))?;
            worst = worst.max(after / before - 1.0);
            before = after;
            Ok(())
        })?;
        ensure(slid, || format!("{law}: no friction"))?;
    }
    Ok(format!("friction at its limit; energy grows by at most {worst:.0e} of itself in a step"))
}

fn drilling(lab: &Lab) -> Result<String, String> {
    let mut balls = head_on(0.01, 0.01);
    balls[0].spin = [1e6, 0.0, 0.0];
    let end = lab.run(&scene(
        &balls,
        "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), tangential: TangentialSpring(stiffness: 3e3, \
         friction: 0.3)",
        "driver: TimeStep(), run: (duration: 4e-3)",
    ))?;
    ensure(end[0].velocity[0] < 0.2, || format!("they have not collided: {end:?}"))?;
    let same = end.iter().zip([1e6, 0.0]).all(|(body, spin)| {
        body.spin == [spin, 0.0, 0.0] && body.velocity[1] == 0.0 && body.velocity[2] == 0.0
    });
    ensure(same, || format!("{end:?}"))?;
    Ok("the same bits".to_string())
}

fn no_friction(lab: &Lab) -> Result<String, String> {
    let mut balls = head_on(0.01, 0.01);
    balls[0].spin = [1.0, 2.0, 3.0];
    balls[0].velocity[1] = 0.5;
    for (tangential, turns) in
        [("", false), (", tangential: TangentialSpring(stiffness: 3e3, friction: 0)", true)]
    {
        let text = scene(
            &balls,
            &format!("normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8){tangential}"),
            "driver: TimeStep(), run: (duration: 4e-3)",
        );
        let rotation = lab.plan(&text)?.plan.rotation;
        let end = lab.run(&text)?;
        ensure(end[0].velocity[0] < 0.3, || format!("they have not collided: {end:?}"))?;
        // Without a law that could turn bodies, their spins are not part of the state.
        let stored = !rotation || (end[0].spin == balls[0].spin && end[1].spin == [0.0; 3]);
        ensure(stored && (turns || !rotation), || format!("{end:?}"))?;
    }
    Ok("the same bits".to_string())
}

fn infinite_friction(lab: &Lab) -> Result<String, String> {
    let mut balls = head_on(0.01, 0.01);
    balls[0].velocity[1] = 0.5;
    let run = |friction: &str| {
        lab.run(&scene(
            &balls,
            &format!(
                "normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.8), tangential: TangentialSpring(stiffness: \
                 3e3, friction: {friction})"
            ),
            "driver: TimeStep(), run: (duration: 4e-3)",
        ))
    };
    let (large, infinite) = (run("1e6")?, run("inf")?);
    ensure(infinite[0].spin[2].abs() > 1.0, || format!("no friction: {infinite:?}"))?;
    let off = (large[0].spin[2] / infinite[0].spin[2] - 1.0).abs();
    ensure(off < 1e-2, || format!("spins {} and {}", large[0].spin[2], infinite[0].spin[2]))?;
    Ok(format!("spins differ by {off:.0e} of themselves"))
}

fn slip_threshold(lab: &Lab) -> Result<String, String> {
    let (omega, gravity, radius) = (100.0, 9.81, 0.002);
    let mut found = Vec::new();
    for (share, slips) in [(1.0 - 1e-9, false), (1.0 + 1e-9, true)] {
        let amplitude = share * 3.5 * 0.5 * gravity / (omega * omega);
        // At time 0 the plate has the velocity Aω, and the sphere rolls at 2/7 of it. The mean acceleration of a step is the
        // largest of the plate to (ω dt)²/24 = 4e-12, and stays within 1e-9 of it for nine steps.
        let velocity = 2.0 / 7.0 * amplitude * omega;
        let spin = -2.5 * velocity / radius;
        let text = format!(
            r#"(version: 1, gravity: (0, 0, -{gravity}), materials: {{ "a": (density: 7850) }},
            bodies: [Sphere(material: "a", radius: {radius}, position: (0, 0, {radius}),
                velocity: ({velocity:?}, 0, 0), spin: (0, {spin:?}, 0))],
            substrate: (laws: {{ "a": StickSlip(static_friction: 0.5, kinetic_friction: 0.1) }},
                motion: Sinusoidal(amplitude: ({amplitude:?}, 0, 0), angular_frequency: {omega})),
            driver: TimeStep(step: 1e-7), run: (steps: 300000))"#
        );
        let (mut sliding, mut onsets, mut first) = (false, 0, None);
        lab.watch(&text, &mut |view, _| {
            let now = view.substrate().sliding == 1;
            if now && !sliding {
                onsets += 1;
                first = first.or(Some(view.step()));
            }
            sliding = now;
            Ok(())
        })?;
        ensure((onsets > 0) == slips, || {
            format!("share {share:.10}: {onsets} onsets of slip, first at step {first:?}")
        })?;
        // The run takes 0.03 s, half a period 0.0314 s.
        ensure(onsets <= 1, || format!("share {share:.10}: {onsets} onsets of slip in half a period"))?;
        found.push(onsets.to_string());
    }
    Ok(format!("{} onsets of slip in half a period", found.join(" and ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_energy_is_that_of_translation_and_rotation() {
        let body =
            Body { position: [0.0; 3], velocity: [2.0, 0.0, 0.0], spin: [0.0, 0.0, 100.0], force: [0.0; 3] };
        assert!((energy(&[body]) - (0.02 + 0.5 * 0.4e-6 * 1e4)).abs() < 1e-15);
    }
}
