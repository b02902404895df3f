//! A sphere and planes.

use super::recipe::{Recipe, Which};
use super::{Case, CaseLaw};
use crate::peers::{Axis, PeerBody, PeerWall, Side};

/// Radius of the marble (m).
const RADIUS: f64 = 5e-3;

fn marble(height: f64, velocity: [f64; 3], angular_velocity: [f64; 3]) -> PeerBody {
    PeerBody {
        id: 1,
        kind: 1,
        diameter: 2.0 * RADIUS,
        density: 2500.0,
        position: [0.001, -0.002, height],
        velocity,
        angular_velocity,
    }
}

fn floor(velocity: [f64; 3]) -> PeerWall {
    PeerWall { axis: Axis::Z, position: 0.0, side: Side::Above, velocity, kind: 1 }
}

/// A marble above a floor at z = 0 under gravity.
fn case(slug: &'static str, title: &'static str, body: PeerBody, laws: Vec<CaseLaw>) -> Case {
    Case {
        slug,
        title,
        bodies: vec![body],
        frozen: Vec::new(),
        half_box: 0.1,
        periodic: [false; 3],
        gravity: [0.0, 0.0, -9.81],
        walls: vec![floor([0.0; 3])],
        time_step: 2e-5,
        steps: 400,
        dump_every: 10,
        laws,
    }
}

pub fn cases() -> Vec<Case> {
    let marble_law = Recipe::MARBLE;
    // Between first touch and rest, so that neither law lifts off.
    let resting = RADIUS - 8e-6;
    let mut cases = vec![
        Case {
            steps: 1200,
            dump_every: 30,
            ..case(
                "wall-bounce",
                "a marble bounces twice, the second time lower",
                marble(RADIUS + 1e-5, [0.0, 0.0, -0.05], [0.0; 3]),
                marble_law.laws(&Which::HISTORY),
            )
        },
        case(
            "wall-oblique",
            "oblique hit of a spinning marble on a wall",
            marble(RADIUS + 1e-5, [0.12, 0.04, -0.1], [10.0, -20.0, 30.0]),
            marble_law.laws(&Which::HISTORY),
        ),
        case(
            "wall-spinning",
            "a marble drops without sideways velocity but with spin, and is thrown sideways",
            marble(RADIUS + 1e-5, [0.0, 0.0, -0.1], [0.0, 60.0, 25.0]),
            Recipe { friction: 0.2, ..marble_law }.laws(&Which::HISTORY),
        ),
        Case {
            steps: 2400,
            dump_every: 60,
            ..case(
                "wall-slide-to-roll",
                "a sliding marble is braked by friction until it rolls",
                marble(resting, [0.3, 0.0, 0.0], [0.0; 3]),
                Recipe { friction: 0.3, ..marble_law }.laws(&Which::HISTORY),
            )
        },
        Case {
            walls: vec![floor([0.0, 0.2, 0.0])],
            steps: 2000,
            dump_every: 50,
            ..case(
                "wall-belt",
                "a marble laid on a running belt is carried along until it rolls",
                marble(resting, [0.0; 3], [0.0; 3]),
                Recipe { friction: 0.3, ..marble_law }.laws(&[
                    Which::LammpsHookeHistory,
                    Which::GranularHooke,
                    Which::LiggghtsHookeStiffness,
                    Which::LiggghtsHertz,
                ]),
            )
        },
        Case {
            walls: vec![
                floor([0.0; 3]),
                PeerWall {
                    axis: Axis::X,
                    position: 0.001 + RADIUS + 2e-5,
                    side: Side::Below,
                    velocity: [0.0; 3],
                    kind: 1,
                },
            ],
            steps: 450,
            dump_every: 15,
            ..case(
                "wall-corner",
                "a marble flies into the corner of floor and side wall",
                marble(RADIUS + 1e-5, [0.1, 0.05, -0.12], [-10.0, 15.0, 5.0]),
                marble_law.laws(&[
                    Which::LammpsHookeHistory,
                    Which::GranularHooke,
                    Which::LiggghtsHookeStiffness,
                    Which::LiggghtsHertz,
                ]),
            )
        },
    ];
    cases.sort_by_key(|case| case.slug);
    cases
}
