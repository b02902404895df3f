use super::*;
use granule_law_api::testing::{Contacts, conformance};
use granule_law_api::{Conventions, NormalSummary, Span, Stage};

#[test]
fn conforms() {
    conformance::<ViscousTangential>();
}

fn force(values: &[(&str, f64)], conventions: Conventions, v: [f64; 3], normal_force: f64) -> [f64; 3] {
    let params = Params::new(&ViscousTangential::INFO, values).unwrap();
    let pair = PairContext { conventions, ..PairContext::single(2e-6, 1e-3, 0.4, 0.5) };
    let stage: Box<dyn Stage<f64>> = ViscousTangential::compile(&params, &pair).unwrap();
    let mut contact = Contacts::<f64>::new(1, 0);
    contact.overlap[0] = 1e-5;
    contact.normal[0][0] = 0.0;
    contact.normal[2][0] = 1.0;
    contact.reduced_mass[0] = 2e-6;
    contact.normal_damping[0] = 0.01;
    contact.normal_force[0] = normal_force;
    for axis in 0..3 {
        contact.tangential_velocity[axis][0] = v[axis];
    }
    contact.run(&*stage, 1e-6);
    contact.tangential_force.each_ref().map(|column| column[0])
}

/// LAMMPS gran/hooke: -min(μ |F_n|, m12 γ_t |v|) v/|v|; LIGGGHTS no_history: -min(m12 γ_t, μ |F_n|/|v|) v.
#[test]
fn lammps_and_liggghts_forms() {
    for conventions in [Conventions::LAMMPS_CLASSIC, Conventions::LIGGGHTS] {
        for (v, normal_force) in
            [([0.3, -0.4, 0.0], 1e-3), ([3e-4, 4e-4, 0.0], 1e-3), ([0.3, 0.4, 0.0], -1e-3)]
        {
            let found = force(&[("damping_rate", 1310.0), ("friction", 0.5)], conventions, v, normal_force);
            let speed = f64::hypot(v[0], v[1]);
            let size = (0.5 * f64::abs(normal_force)).min(2e-6 * 1310.0 * speed);
            for axis in 0..3 {
                approx::assert_relative_eq!(found[axis], -size * v[axis] / speed, max_relative = 1e-15);
            }
        }
    }
    let attracted =
        force(&[("damping", 1.0), ("friction", 0.5)], Conventions::PHYSICAL, [0.1, 0.0, 0.0], -1.0);
    assert_eq!(attracted[0], 0.0);
}

#[test]
fn damping_is_a_share_of_the_normal_one() {
    let found = force(&[("damping_ratio", 0.5)], Conventions::PHYSICAL, [0.1, 0.0, 0.0], 1.0);
    approx::assert_relative_eq!(found[0], -0.5 * 0.01 * 0.1, max_relative = 1e-15);
}

/// Luding 1998, Eq. (49): v_t' = v_t exp(-2 η_t t_c) with η_t = (1 + 1/q) ν_t/(2 m12).
#[test]
fn slip_decays_exponentially() {
    let (damping, mass, q, duration): (f64, f64, f64, f64) = (0.02, 2e-6, 0.4, 1e-4);
    let params = Params::new(&ViscousTangential::INFO, &[("damping", damping)]).unwrap();
    let pair = PairContext::single(mass, 1e-3, q, 0.5);
    let Oracle::Tangential(oracle) = ViscousTangential::oracle(&params, &pair) else { panic!("no oracle") };
    let impact = ObliqueImpact {
        impact: Impact { reduced_mass: mass, reduced_radius: 1e-3, normal_speed: 0.5 },
        normal_stiffness: 1e4,
        duration,
        tangential_speed: 0.7,
        tangential_mass: mass / (1.0 + 1.0 / q),
    };
    let eta = (1.0 + 1.0 / q) * damping / (2.0 * mass);
    approx::assert_relative_eq!(
        oracle(&impact).unwrap(),
        0.7 * (-2.0 * eta * duration).exp(),
        max_relative = 1e-14
    );
}

/// exp(-2 η_t t_c) = -e_t0 (Luding 1998, Eq. (50)), for both ways in which a normal law gives its duration and any inertia
/// factor.
#[test]
fn tangential_restitution_is_the_one_asked_for() {
    let (mass, stiffness): (f64, f64) = (3e-6, 2e4);
    let factor = 2.7;
    let duration = factor * (mass / stiffness).sqrt();
    for rule in [DurationRule::Constant(duration), DurationRule::Oscillator(factor)] {
        for (q, wanted) in [(0.4, -0.3), (0.5, -0.9), (2.0 / 3.0, -1.0)] {
            let pair = PairContext {
                normal: Some(NormalSummary { duration: rule, scale: None }),
                ..PairContext::single(mass, 1e-3, q, 0.5)
            };
            let params =
                Params::new(&ViscousTangential::INFO, &[("tangential_restitution", wanted)]).unwrap();
            let coefficient = damping(&params, &pair).unwrap().at(mass, 0.0, stiffness);
            let eta = (1.0 + 1.0 / q) * coefficient / (2.0 * mass);
            approx::assert_relative_eq!(-(-2.0 * eta * duration).exp(), wanted, max_relative = 1e-14);
        }
    }
    let params = Params::new(&ViscousTangential::INFO, &[("tangential_restitution", -0.5)]).unwrap();
    let mixed = PairContext {
        inertia_factor: Span { min: 0.4, max: 0.5 },
        ..PairContext::single(mass, 1e-3, 0.4, 0.5)
    };
    assert!(damping(&params, &mixed).unwrap_err().to_string().contains("the bodies have 0.4 to 0.5"));
}
