//! Texts of scenes.

use std::fmt::Write as _;

/// One sphere.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// Radius \[m\].
    pub radius: f64,
    /// Mass \[kg\].
    pub mass: f64,
    /// Centre \[m\].
    pub position: [f64; 3],
    /// Velocity \[m/s\].
    pub velocity: [f64; 3],
    /// Spin \[rad/s\].
    pub spin: [f64; 3],
    /// It never moves.
    pub frozen: bool,
}

/// A sphere of 10 mm and 10 g.
pub fn ball(position: [f64; 3], velocity: [f64; 3]) -> Ball {
    Ball { radius: 0.01, mass: 0.01, position, velocity, spin: [0.0; 3], frozen: false }
}

/// Two spheres that meet head on with 1 m/s after a hundredth of a radius.
pub fn head_on(mass: f64, partner: f64) -> [Ball; 2] {
    [
        Ball { mass, ..ball([0.0; 3], [1.0, 0.0, 0.0]) },
        Ball { mass: partner, ..ball([0.0201, 0.0, 0.0], [0.0; 3]) },
    ]
}

/// A scene of these spheres; `laws` goes into the contact block, `more` beside it.
pub fn scene(balls: &[Ball], laws: &str, more: &str) -> String {
    let mut list = String::new();
    for ball in balls {
        let ([x, y, z], [u, v, w], [p, q, r]) = (ball.position, ball.velocity, ball.spin);
        // Writing to a string cannot fail.
        let _ = writeln!(
            list,
            "Sphere(material: \"a\", radius: {:?}, mass: {:?}, position: ({x:?}, {y:?}, {z:?}), velocity: ({u:?}, {v:?}, \
             {w:?}), spin: ({p:?}, {q:?}, {r:?}), frozen: {}),",
            ball.radius, ball.mass, ball.frozen
        );
    }
    format!(
        r#"(version: 1, materials: {{ "a": () }}, bodies: [{list}], contacts: [(between: ("a", "a"), {laws})], {more})"#
    )
}
