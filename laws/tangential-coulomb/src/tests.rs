use super::*;
use granule_law_api::testing::{Contacts, conformance};
use granule_law_api::{Conventions, ObliqueImpact, Stage};

#[test]
fn conforms() {
    conformance::<Coulomb>();
}

const MASS: f64 = 2e-6;
const INERTIA: f64 = 0.4;
const FRICTION: f64 = 0.5;
const NORMAL_FORCE: f64 = 1e-3;
/// m12/(1 + 1/q).
const TANGENTIAL_MASS: f64 = MASS / 3.5;

/// Slip of a body that is braked from `speed` by Coulomb friction at constant normal force, after each of 400 steps.
/// With `printed` the force is that of Luding 1998, Eq. (51), without the bound at rest.
fn brake(velocity: VelocityRule, speed: f64, step: f64, printed: bool) -> Vec<f64> {
    let params = Params::new(&Coulomb::INFO, &[("friction", FRICTION)]).unwrap();
    let conventions = Conventions { velocity, ..Conventions::PHYSICAL };
    let pair = PairContext { conventions, ..PairContext::single(MASS, 1e-3, INERTIA, 0.5) };
    let stage: Box<dyn Stage<f64>> = Coulomb::compile(&params, &pair).unwrap();
    let mut contact = Contacts::<f64>::new(1, 0);
    contact.overlap[0] = 1e-5;
    contact.reduced_mass[0] = MASS;
    contact.normal_force[0] = NORMAL_FORCE;
    let mut force = |slip: f64| {
        contact.tangential_velocity[1][0] = slip;
        // Without a step the stage gives the printed force.
        contact.run(&*stage, if printed { 0.0 } else { step });
        contact.tangential_force[1][0]
    };
    let (mut slip, mut acceleration, mut before) = (speed, 0.0, 0.0);
    (0..400)
        .map(|_| {
            let half = slip + 0.5 * step * acceleration;
            let seen = match velocity {
                VelocityRule::HalfStep => half,
                VelocityRule::Synchronised => half + 0.5 * step * acceleration,
                VelocityRule::Extrapolated => half + 0.5 * step * (2.0 * acceleration - before),
            };
            before = acceleration;
            acceleration = force(seen) / TANGENTIAL_MASS;
            slip = half + 0.5 * step * acceleration;
            slip
        })
        .collect()
}

/// The printed law oscillates about zero with an amplitude in proportion to the step; the bounded one comes to rest.
#[test]
fn slip_stops_without_chatter() {
    for velocity in [VelocityRule::HalfStep, VelocityRule::Synchronised, VelocityRule::Extrapolated] {
        for step in [1e-6, 1e-7] {
            let speed = 0.5 * FRICTION * NORMAL_FORCE / TANGENTIAL_MASS * 200.0 * step;
            let rest = |slips: &[f64]| slips[300..].iter().fold(0.0_f64, |most, slip| most.max(slip.abs()));
            let change = FRICTION * NORMAL_FORCE / TANGENTIAL_MASS * step;
            let printed = rest(&brake(velocity, speed, step, true));
            let held = rest(&brake(velocity, speed, step, false));
            assert!(
                printed > 0.2 * change && printed < 2.0 * change,
                "{velocity:?} {step} {printed} {change}"
            );
            // 200 steps after the stop at a decay of 1/sqrt(3) or 1/sqrt(2) a step: 1e-47 or 1e-30 of one step's change.
            assert!(held < 1e-28 * change, "{velocity:?} {step} {held}");
        }
    }
}

#[test]
fn braking_is_that_of_constant_friction() {
    let step = 1e-7;
    let change = FRICTION * NORMAL_FORCE / TANGENTIAL_MASS * step;
    for velocity in [VelocityRule::HalfStep, VelocityRule::Synchronised, VelocityRule::Extrapolated] {
        let slips = brake(velocity, 150.0 * change, step, false);
        // The first step has half a kick. 100 additions of round-off.
        approx::assert_relative_eq!(slips[99], (150.0 - 99.5) * change, max_relative = 1e-12);
    }
}

#[test]
fn without_a_step_the_force_is_the_printed_one_and_zero_at_rest() {
    let params = Params::new(&Coulomb::INFO, &[("friction", FRICTION)]).unwrap();
    let stage: Box<dyn Stage<f64>> =
        Coulomb::compile(&params, &PairContext::single(MASS, 1e-3, INERTIA, 0.5)).unwrap();
    let mut contact = Contacts::<f64>::new(2, 0);
    contact.overlap = vec![1e-5; 2];
    contact.normal_force = vec![NORMAL_FORCE; 2];
    contact.tangential_velocity[1] = vec![0.3e-9, 0.0];
    contact.tangential_velocity[2] = vec![-0.4e-9, 0.0];
    contact.run(&*stage, 0.0);
    approx::assert_relative_eq!(
        contact.tangential_force[1][0],
        -0.6 * FRICTION * NORMAL_FORCE,
        max_relative = 1e-15
    );
    approx::assert_relative_eq!(
        contact.tangential_force[2][0],
        0.8 * FRICTION * NORMAL_FORCE,
        max_relative = 1e-15
    );
    assert_eq!(contact.tangential_force[1][1], 0.0);
}

/// Erratum L-E4: friction takes μ (1 + 1/q) (1 + e) v_n off the slip; Luding 1998, Eq. (52) as printed adds it.
#[test]
fn impact_slows_the_slip() {
    let params = Params::new(&Coulomb::INFO, &[("friction", 0.1)]).unwrap();
    let Oracle::Tangential(oracle) = Coulomb::oracle(&params, &PairContext::single(MASS, 1e-3, INERTIA, 0.5))
    else {
        panic!("no oracle")
    };
    let impact = ObliqueImpact {
        impact: Impact { reduced_mass: MASS, reduced_radius: 1e-3, normal_speed: 0.5 },
        normal_stiffness: 1e4,
        duration: std::f64::consts::PI * (MASS / 1e4).sqrt(),
        tangential_speed: 1.0,
        tangential_mass: TANGENTIAL_MASS,
    };
    let step = impact.duration / 2000.0;
    let stage: Box<dyn Stage<f64>> =
        Coulomb::compile(&params, &PairContext::single(MASS, 1e-3, INERTIA, 0.5)).unwrap();
    let mut contact = Contacts::<f64>::new(1, 0);
    contact.reduced_mass[0] = MASS;
    let mut slip = 1.0;
    for index in 0..2000 {
        let phase = std::f64::consts::PI * (f64::from(index) + 0.5) / 2000.0;
        contact.overlap[0] = 0.5 * (MASS / 1e4).sqrt() * phase.sin();
        contact.normal_force[0] = 1e4 * contact.overlap[0];
        contact.tangential_velocity[1][0] = slip;
        contact.run(&*stage, step);
        slip += step * contact.tangential_force[1][0] / TANGENTIAL_MASS;
    }
    let taken = 0.1 * 3.5 * 2.0 * 0.5;
    // The midpoint rule on half a sine: (π/2000)²/24 of the change.
    assert!((slip - (1.0 - taken)).abs() < 1e-6 * taken, "{slip}");
    assert!((slip - (1.0 + taken)).abs() > 0.5, "the printed sign");
    approx::assert_relative_eq!(oracle(&impact).unwrap(), 1.0 - taken, max_relative = 1e-14);
}
