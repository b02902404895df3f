//! Step by step against scalar transcriptions of the peers' sources, under their conventions.

use granule_law_api::testing::Contacts;
use granule_law_api::{ContactLaw, Conventions, PairContext, Params, Stage};

use crate::TangentialSpring;

const MU: f64 = 0.3;
const STEP: f64 = 1e-6;

/// What a peer's tangential law sees of a contact. The normal force is positive when it repels.
struct Seen {
    n: [f64; 3],
    v: [f64; 3],
    kt: f64,
    gamma: f64,
    normal_force: f64,
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn size(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// LAMMPS pair gran/hooke/history and gran/hertz/history, `compute`.
fn lammps_classic(seen: &Seen, xi: &mut [f64; 3]) -> [f64; 3] {
    for i in 0..3 {
        xi[i] += seen.v[i] * STEP;
    }
    let shrmag = size(*xi);
    let along = dot(*xi, seen.n);
    for i in 0..3 {
        xi[i] -= along * seen.n[i];
    }
    sliding_total(seen, xi, shrmag)
}

/// LAMMPS pair granular, linear_history and mindlin.
fn lammps_granular(seen: &Seen, xi: &mut [f64; 3]) -> [f64; 3] {
    let along = dot(*xi, seen.n);
    if along.abs() * seen.kt > 1e-10 * MU * seen.normal_force.abs() {
        let before = size(*xi);
        for i in 0..3 {
            xi[i] -= along * seen.n[i];
        }
        let after = size(*xi);
        let scale = if after > 0.0 { before / after } else { 0.0 };
        for x in xi.iter_mut() {
            *x *= scale;
        }
    }
    for i in 0..3 {
        xi[i] += seen.v[i] * STEP;
    }
    let shrmag = size(*xi);
    sliding_total(seen, xi, shrmag)
}

fn sliding_total(seen: &Seen, xi: &mut [f64; 3], shrmag: f64) -> [f64; 3] {
    let mut f = [0, 1, 2].map(|i| -(seen.kt * xi[i] + seen.gamma * seen.v[i]));
    let (fs, fmax) = (size(f), MU * seen.normal_force.abs());
    if fs > fmax {
        if shrmag != 0.0 {
            for i in 0..3 {
                let damper = seen.gamma * seen.v[i] / seen.kt;
                xi[i] = fmax / fs * (xi[i] + damper) - damper;
                f[i] *= fmax / fs;
            }
        } else {
            f = [0.0; 3];
        }
    }
    f
}

/// LIGGGHTS tangential history.
fn liggghts(seen: &Seen, xi: &mut [f64; 3]) -> [f64; 3] {
    for i in 0..3 {
        xi[i] += seen.v[i] * STEP;
    }
    let along = dot(*xi, seen.n);
    for i in 0..3 {
        xi[i] -= along * seen.n[i];
    }
    let (spring, limit) = (seen.kt * size(*xi), MU * seen.normal_force.abs());
    let mut f = [0, 1, 2].map(|i| -seen.kt * xi[i]);
    if spring > limit {
        for i in 0..3 {
            f[i] *= limit / spring;
            xi[i] = -f[i] / seen.kt;
        }
    } else {
        for i in 0..3 {
            f[i] -= seen.gamma * seen.v[i];
        }
    }
    f
}

type Peer = fn(&Seen, &mut [f64; 3]) -> [f64; 3];
/// k_t and γ_t of a contact.
type Coefficients = fn(&Contacts<f64>) -> (f64, f64);

fn follow(conventions: Conventions, values: &[(&str, f64)], peer: Peer, coefficients: Coefficients) {
    let params = Params::new(&TangentialSpring::INFO, values).unwrap();
    let pair = PairContext { conventions, ..PairContext::single(2e-6, 2.7e-4, 0.4, 0.2) };
    let stage: Box<dyn Stage<f64>> = TangentialSpring::compile(&params, &pair).unwrap();
    let mut contact = Contacts::<f64>::new(1, 3);
    contact.reduced_mass[0] = 2e-6;
    contact.reduced_radius[0] = 2.7e-4;
    let mut xi = [0.0; 3];
    let (mut slid, mut stuck) = (0, 0);
    for step in 0..600 {
        let t = f64::from(step) * STEP;
        // The contact turns and swells, the slip goes around and the normal force even attracts for a while.
        let (a, b) = (300.0 * t, 1.0 + 200.0 * t);
        let n = [a.cos() * b.sin(), a.sin() * b.sin(), b.cos()];
        let w = [0.3 * (8e3 * t).cos(), 0.2 * (9e3 * t).sin(), 0.1];
        let along = dot(w, n);
        let v = [0, 1, 2].map(|i| w[i] - along * n[i]);
        contact.overlap[0] = 1e-5 * (1.1 + (7e3 * t).sin());
        contact.normal_force[0] = 0.02 * (0.9 + (7e3 * t).sin());
        contact.normal_stiffness[0] = 1000.0;
        contact.normal_damping[0] = 0.02;
        for i in 0..3 {
            contact.normal[i][0] = n[i];
            contact.tangential_velocity[i][0] = v[i];
        }
        let (kt, gamma) = coefficients(&contact);
        let seen = Seen { n, v, kt, gamma, normal_force: contact.normal_force[0] };
        let expected = peer(&seen, &mut xi);
        contact.run(&*stage, STEP);
        let found = contact.tangential_force.each_ref().map(|column| column[0]);
        let spring = [0, 1, 2].map(|i| contact.history[i][0]);
        // Round-off of a few operations a step, carried along by the spring for 600 steps; the scales are the largest
        // limit and the spring at that limit.
        let force_scale = MU * 0.04;
        for i in 0..3 {
            assert!(
                (found[i] - expected[i]).abs() < 1e-14 * force_scale * 10.0,
                "{step}: {found:?} {expected:?}"
            );
            assert!(
                (spring[i] - xi[i]).abs() < 1e-14 * 10.0 * force_scale / 285.0,
                "{step}: {spring:?} {xi:?}"
            );
        }
        if size(expected) < (1.0 - 1e-9) * MU * seen.normal_force.abs() { stuck += 1 } else { slid += 1 }
    }
    assert!(slid > 50 && stuck > 50, "both branches are needed: slid {slid}, stuck {stuck}");
}

fn contact_radius(contact: &Contacts<f64>) -> f64 {
    (contact.overlap[0] * contact.reduced_radius[0]).sqrt()
}

#[test]
fn lammps_gran_hooke_history() {
    follow(
        Conventions::LAMMPS_CLASSIC,
        &[("stiffness", 285.0), ("damping_rate", 1310.0), ("friction", MU)],
        lammps_classic,
        |contact| (285.0, contact.reduced_mass[0] * 1310.0),
    );
}

#[test]
fn lammps_gran_hertz_history() {
    follow(
        Conventions::LAMMPS_CLASSIC,
        &[("stiffness_pressure", 9.14e6), ("damping_rate_per_length", 1.5e7), ("friction", MU)],
        lammps_classic,
        |contact| {
            let a = contact_radius(contact);
            (a * 9.14e6, a * contact.reduced_mass[0] * 1.5e7)
        },
    );
}

#[test]
fn lammps_granular_linear_history() {
    follow(
        Conventions::LAMMPS_GRANULAR,
        &[("stiffness", 285.0), ("damping_ratio", 0.5), ("friction", MU)],
        lammps_granular,
        |contact| (285.0, 0.5 * contact.normal_damping[0]),
    );
}

#[test]
fn lammps_granular_mindlin() {
    follow(
        Conventions::LAMMPS_GRANULAR,
        &[("effective_shear_modulus", 2e6), ("damping_ratio", 0.5), ("friction", MU)],
        lammps_granular,
        |contact| (8.0 * 2e6 * contact_radius(contact), 0.5 * contact.normal_damping[0]),
    );
}

#[test]
fn liggghts_hooke_stiffness_history() {
    follow(
        Conventions::LIGGGHTS,
        &[("stiffness", 285.0), ("damping_rate", 1310.0), ("friction", MU)],
        liggghts,
        |contact| (285.0, contact.reduced_mass[0] * 1310.0),
    );
}

#[test]
fn liggghts_hertz_history() {
    follow(
        Conventions::LIGGGHTS,
        &[("effective_shear_modulus", 2e6), ("damping_coefficient", 0.06), ("friction", MU)],
        liggghts,
        |contact| {
            let kt = 8.0 * 2e6 * contact_radius(contact);
            (kt, 0.06 * (kt * contact.reduced_mass[0]).sqrt())
        },
    );
}

/// At the start of a LAMMPS run no spring has been stretched yet: a contact whose damper alone exceeds the limit carries no
/// tangential force. The physical conventions let it slide.
#[test]
fn unstretched_springs_at_the_start_of_a_run() {
    for (conventions, expected) in [(Conventions::LAMMPS_CLASSIC, 0.0), (Conventions::PHYSICAL, -MU)] {
        let values = [("stiffness", 285.0), ("damping", 50.0), ("friction", MU)];
        let params = Params::new(&TangentialSpring::INFO, &values).unwrap();
        let pair = PairContext { conventions, ..PairContext::single(2e-6, 2.7e-4, 0.4, 0.2) };
        let stage: Box<dyn Stage<f64>> = TangentialSpring::compile(&params, &pair).unwrap();
        let mut contact = Contacts::<f64>::new(1, 3);
        contact.overlap[0] = 1e-5;
        contact.normal_force[0] = 1.0;
        contact.tangential_velocity[1][0] = 0.5;
        contact.run(&*stage, 0.0);
        assert!((contact.tangential_force[1][0] - expected).abs() < 1e-15);
    }
}
