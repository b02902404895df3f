//! Records of bodies, compact and aligned to cache lines.

use serde::{Deserialize, Serialize};

use crate::two::Two;

/// What every prediction reads: one cache line.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C, align(64))]
pub struct Body {
    /// Centre at the local time \[m\]; in the cell or near it.
    pub position: [f64; 3],
    /// Local time, relative to the epoch \[s\].
    pub time: f64,
    /// Velocity at the local time \[m/s\].
    pub velocity: [f64; 3],
    /// Radius \[m\].
    pub radius: f64,
}

/// Two bodies side by side.
#[derive(Clone, Copy, Debug)]
pub struct Twins {
    pub position: [Two; 3],
    pub time: Two,
    pub velocity: [Two; 3],
    pub radius: Two,
}

impl Twins {
    #[inline(always)]
    pub fn new(a: &Body, b: &Body) -> Self {
        let zip = |first: [f64; 2], second: [f64; 2]| {
            Two::new(first[0], first[1]).zip(Two::new(second[0], second[1]))
        };
        let (p, q, v, w) = (a.position, b.position, a.velocity, b.velocity);
        let (x, y) = zip([p[0], p[1]], [q[0], q[1]]);
        let (z, time) = zip([p[2], a.time], [q[2], b.time]);
        let (u, v_y) = zip([v[0], v[1]], [w[0], w[1]]);
        let (v_z, radius) = zip([v[2], a.radius], [w[2], b.radius]);
        Self { position: [x, y, z], time, velocity: [u, v_y, v_z], radius }
    }
}

/// What only collisions and outputs read.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Identity {
    /// 1/m \[1/kg\]; 0 for a frozen body.
    pub inverse_mass: f64,
    /// q = I/(m R²).
    pub inertia_factor: f64,
    /// Stable identity.
    pub id: u32,
    /// Material.
    pub material: u16,
    /// How often the body has crossed each periodic boundary.
    pub image: [i32; 3],
}

/// A sphere that the body does not leave before its next look at the neighbourhood.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[repr(C, align(32))]
pub struct Shell {
    /// Centre \[m\].
    pub centre: [f64; 3],
    /// Radius of the shell plus that of the body \[m\]: bodies whose reaches do not meet cannot touch.
    pub reach: f64,
}

#[inline(always)]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Lengths of the periods and how separations are brought to the nearest image.
#[derive(Clone, Copy, Debug)]
pub struct Period {
    length: [f64; 3],
    half: [f64; 3],
}

impl Period {
    pub fn new(length: [f64; 3]) -> Self {
        Self { length, half: length.map(|l| if l > 0.0 { 0.5 * l } else { f64::INFINITY }) }
    }

    /// [`nearest`](Self::nearest) of two separations.
    #[inline(always)]
    pub fn nearest_of_two(&self, d: [Two; 3]) -> [Two; 3] {
        std::array::from_fn(|axis| d[axis].nearest(self.half[axis], self.length[axis]))
    }

    pub fn length(&self) -> [f64; 3] {
        self.length
    }

    /// The nearest image of a separation of at most one and a half periods.
    #[inline(always)]
    pub fn nearest(&self, d: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let (half, length, d) = (self.half[axis], self.length[axis], d[axis]);
            // Most pairs are in one image: the branches are foreseen.
            if d > half {
                d - length
            } else if d < -half {
                d + length
            } else {
                d
            }
        })
    }
}
