//! Two spheres (and three in a row).

use super::recipe::{Recipe, Which, case_law};
use super::{Case, CaseLaw};
use crate::peers::{PeerBody, PeerMaterial};

/// An orthonormal frame in general position, so that no component vanishes by symmetry: the normal from body 2 to body 1,
/// and two tangents.
const NORMAL: [f64; 3] = [2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0];
const TANGENT: [f64; 3] = [1.0 / 3.0, 2.0 / 3.0, -2.0 / 3.0];
const OTHER_TANGENT: [f64; 3] = [2.0 / 3.0, -2.0 / 3.0, -1.0 / 3.0];

/// Two spheres about to hit.
struct Hit {
    diameters: [f64; 2],
    densities: [f64; 2],
    /// Speed of approach (m/s).
    closing: f64,
    /// Tangential velocity of body 1 against body 2 (m/s).
    passing: f64,
    /// Spins in the frame of normal and tangents (rad/s).
    spins: [[f64; 3]; 2],
    /// Common velocity (m/s).
    drift: [f64; 3],
}

impl Hit {
    /// Equal millimetre grains.
    const GRAINS: Self = Self {
        diameters: [1e-3; 2],
        densities: [2500.0; 2],
        closing: 0.1,
        passing: 0.0,
        spins: [[0.0; 3]; 2],
        drift: [0.01, -0.02, 0.005],
    };

    fn bodies(&self) -> Vec<PeerBody> {
        // 2 µm apart: 20 steps of free flight at 0.1 m/s.
        let distance = 0.5 * (self.diameters[0] + self.diameters[1]) + 2e-6;
        let along = |n: f64, t: f64, u: f64| -> [f64; 3] {
            std::array::from_fn(|k| n * NORMAL[k] + t * TANGENT[k] + u * OTHER_TANGENT[k])
        };
        let relative = along(-self.closing, self.passing, 0.0);
        let body = |index: usize, place: f64, share: f64| PeerBody {
            id: index as u64 + 1,
            kind: 1,
            diameter: self.diameters[index],
            density: self.densities[index],
            position: along(place * distance, 0.0, 0.0),
            velocity: std::array::from_fn(|k| self.drift[k] + share * relative[k]),
            angular_velocity: along(self.spins[index][0], self.spins[index][1], self.spins[index][2]),
        };
        vec![body(0, 0.5, 0.5), body(1, -0.5, -0.5)]
    }
}

/// A hit in an open box without gravity: 80 µs of linear contact, then free flight.
fn case(slug: &'static str, title: &'static str, hit: &Hit, laws: Vec<CaseLaw>) -> Case {
    Case {
        slug,
        title,
        bodies: hit.bodies(),
        frozen: Vec::new(),
        half_box: 0.01,
        periodic: [false; 3],
        gravity: [0.0; 3],
        walls: Vec::new(),
        time_step: 1e-6,
        steps: 160,
        dump_every: 5,
        laws,
    }
}

pub fn cases() -> Vec<Case> {
    let grain = Recipe::GRAIN;
    let damped = Recipe { gamma_n: 3e4, ..grain };
    let spins = [[40.0, 60.0, -150.0], [-30.0, 20.0, -90.0]];
    let mut cases = vec![
        case(
            "head-on-lsd-overlap",
            "head-on hit, strong linear damping, contact ends with the overlap and attracts before",
            &Hit::GRAINS,
            damped.laws(&Which::LINEAR),
        ),
        case(
            "head-on-lsd-force",
            "head-on hit, strong linear damping, contact ends when it would attract",
            &Hit::GRAINS,
            Recipe { limit: true, ..damped }.laws(&Which::LINEAR),
        ),
        Case {
            steps: 240,
            ..case("head-on-hertz", "head-on hit, Hertz contact", &Hit::GRAINS, grain.laws(&Which::HERTZ))
        },
        Case {
            steps: 240,
            ..case(
                "oblique-spin",
                "oblique hit of unequal spinning spheres that stick and slide, every law",
                &Hit { diameters: [1e-3, 1.2e-3], closing: 0.2, passing: 0.46, spins, ..Hit::GRAINS },
                grain.laws(&Which::ALL),
            )
        },
        Case {
            steps: 240,
            ..case(
                "oblique-sticking",
                "oblique hit that sticks until the end of the contact, large friction",
                &Hit { passing: 0.02, spins: [[10.0, 5.0, -20.0], [0.0; 3]], ..Hit::GRAINS },
                Recipe { friction: 0.9, ..grain }.laws(&Which::HISTORY),
            )
        },
        Case {
            steps: 240,
            ..case(
                "oblique-sliding",
                "oblique hit that slides throughout, small friction",
                &Hit { passing: 0.4, ..Hit::GRAINS },
                Recipe { friction: 0.1, ..grain }.laws(&Which::HISTORY),
            )
        },
        Case {
            steps: 300,
            ..case(
                "grazing",
                "grazing hit: 84 degrees from the normal, small overlap",
                &Hit { closing: 0.02, passing: 0.2, ..Hit::GRAINS },
                Recipe { friction: 0.3, ..grain }.laws(&Which::HISTORY),
            )
        },
        case(
            "counter-spin",
            "head-on hit of spinning spheres, slip from spin alone, tangential spring without damper",
            &Hit { spins: [[0.0, 0.0, 200.0], [30.0, 0.0, 200.0]], ..Hit::GRAINS },
            Recipe { tangential_damping: false, ..grain }.laws(&Which::LINEAR),
        ),
        Case {
            steps: 300,
            ..case(
                "unequal",
                "a small light grain hits a large heavy one obliquely: radii 1:3, masses 1:140",
                &Hit {
                    diameters: [1e-3, 3e-3],
                    densities: [1500.0, 7800.0],
                    passing: 0.1,
                    spins,
                    ..Hit::GRAINS
                },
                grain.laws(&Which::HISTORY),
            )
        },
        case(
            "oblique-viscous",
            "oblique hit with viscous friction cut at the Coulomb limit, no tangential spring",
            &Hit { passing: 0.15, spins, ..Hit::GRAINS },
            grain.laws(&[Which::LammpsHooke, Which::GranularNoHistory, Which::LiggghtsNoHistory]),
        ),
        frozen_partner(),
        periodic_pair(),
        two_materials(),
    ];
    cases.sort_by_key(|case| case.slug);
    cases
}

/// The moving body's mass counts as the reduced mass.
fn frozen_partner() -> Case {
    let hit = Hit { passing: 0.08, spins: [[0.0, 0.0, 100.0], [0.0; 3]], drift: [0.0; 3], ..Hit::GRAINS };
    let mut bodies = hit.bodies();
    bodies[1].velocity = [0.0; 3];
    Case {
        bodies,
        frozen: vec![2],
        steps: 240,
        ..case(
            "frozen-partner",
            "oblique hit on a frozen sphere",
            &hit,
            Recipe::GRAIN.laws(&[
                Which::LammpsHookeHistory,
                Which::LammpsHertzHistory,
                Which::LiggghtsHookeStiffness,
                Which::LiggghtsHertz,
            ]),
        )
    }
}

/// The contact lies across the boundary in x and y.
fn periodic_pair() -> Case {
    // A small box and a fast hit: the last digit of coordinates near the boundary, times the stiffness, is round-off of
    // the force.
    let half_box = 1.5e-3;
    let hit = Hit { closing: 0.3, passing: 0.3, ..Hit::GRAINS };
    let mut bodies = hit.bodies();
    for body in &mut bodies {
        for k in 0..2 {
            body.position[k] += half_box;
            if body.position[k] >= half_box {
                body.position[k] -= 2.0 * half_box;
            }
        }
    }
    Case {
        bodies,
        half_box,
        periodic: [true, true, false],
        ..case(
            "periodic-pair",
            "oblique hit across two periodic boundaries",
            &hit,
            Recipe::GRAIN.laws(&Which::LINEAR),
        )
    }
}

/// Three spheres of two types in a row, each pair of types with its own law.
fn two_materials() -> Case {
    let hit = Hit { passing: 0.05, ..Hit::GRAINS };
    let mut bodies = hit.bodies();
    let mut third = bodies[1].clone();
    third.id = 3;
    for k in 0..3 {
        // 1 µm behind the second body, and moving with it.
        third.position[k] -= (1e-3 + 1e-6) * NORMAL[k];
    }
    bodies.push(third);
    for body in &mut bodies[1..] {
        body.kind = 2;
    }
    let hard = Recipe::GRAIN;
    let soft = Recipe {
        kn: 400.0,
        gamma_n: 6000.0,
        restitution: 0.6,
        friction: 0.2,
        material: PeerMaterial { youngs_modulus: 3e7, poisson_ratio: 0.3 },
        ..hard
    };
    let mixed = Recipe { kn: 600.0, gamma_n: 4000.0, restitution: 0.75, friction: 0.35, ..hard };
    let laws = [Which::GranularHooke, Which::LiggghtsHookeStiffness, Which::LiggghtsHertz]
        .into_iter()
        .map(|which| {
            let recipes = [((1, 1), &hard), ((1, 2), &mixed), ((2, 2), &soft)];
            case_law(which, &[hard.material, soft.material], &recipes)
        })
        .collect();
    Case {
        bodies,
        steps: 400,
        dump_every: 10,
        ..case(
            "two-materials",
            "three spheres of two materials in a row, a law for each pair of types",
            &hit,
            laws,
        )
    }
}
