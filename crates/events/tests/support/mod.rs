//! Gases and rules for the tests.
#![allow(dead_code)]

use std::sync::Arc;

use granule_events::{BodyInput, BodyState, EventEngine, Setup, WallInput};
use granule_geometry::{Cell, Motion, Plane, Wall};
use granule_law_api::{CollidingBody, Collision, CollisionImpulse, CollisionRule, collide};
use nalgebra::Vector3;

/// Constant restitution with friction, written down here once more: the shipped rule lies above this crate.
#[derive(Clone, Copy, Debug)]
pub struct Plain {
    pub restitution: f64,
    pub friction: f64,
    pub tangential_restitution: f64,
}

impl Plain {
    pub fn smooth(restitution: f64) -> Self {
        Self { restitution, friction: 0.0, tangential_restitution: -1.0 }
    }
}

impl CollisionRule for Plain {
    fn impulse(&self, c: &Collision) -> CollisionImpulse {
        let e = if c.elastic { 1.0 } else { self.restitution };
        let normal = (1.0 + e) * c.reduced_mass * c.normal_speed;
        let t = c.tangential_velocity;
        let slip = (t[0] * t[0] + t[1] * t[1] + t[2] * t[2]).sqrt();
        if slip == 0.0 || self.friction == 0.0 {
            return CollisionImpulse { normal, tangential: [0.0; 3] };
        }
        let size =
            (self.friction * normal).min((1.0 + self.tangential_restitution) * c.tangential_mass * slip);
        CollisionImpulse { normal, tangential: t.map(|x| -size * x / slip) }
    }
    fn restitution(&self, _normal_speed: f64) -> f64 {
        self.restitution
    }
    fn is_rough(&self) -> bool {
        self.friction > 0.0 && self.tangential_restitution > -1.0
    }
    fn is_inelastic(&self) -> bool {
        self.restitution < 1.0
    }
}

/// Numbers that look random, always the same.
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let x = self.0 ^ (self.0 >> 33);
        let x = x.wrapping_mul(0xff51_afd7_ed55_8ccd);
        ((x ^ (x >> 33)) >> 11) as f64 / (1u64 << 53) as f64
    }
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.unit(), self.unit());
        (-2.0 * u.ln()).sqrt() * (2.0 * std::f64::consts::PI * v).cos()
    }
}

/// Unit spheres (σ = 1, m = 1, T = 1) on a face-centred lattice in a periodic cube: 4 n³ of them at volume fraction `phi`.
pub fn gas(n: usize, phi: f64, rule: Plain, contact_duration: f64, seed: u64) -> Setup {
    let count = 4 * n * n * n;
    let side = (count as f64 * std::f64::consts::PI / (6.0 * phi)).cbrt();
    let a = side / n as f64;
    let mut random = Random(seed);
    let mut bodies = Vec::with_capacity(count);
    for cell in 0..n * n * n {
        let corner = [cell % n, cell / n % n, cell / (n * n)].map(|c| c as f64);
        for offset in [[0.25, 0.25, 0.25], [0.75, 0.75, 0.25], [0.75, 0.25, 0.75], [0.25, 0.75, 0.75]] {
            bodies.push(BodyInput {
                id: bodies.len() as u32 + 1,
                material: 0,
                radius: 0.5,
                mass: 1.0,
                inertia_factor: 0.4,
                position: std::array::from_fn(|k| a * (corner[k] + offset[k])),
                velocity: std::array::from_fn(|_| random.normal()),
                spin: [0.0; 3],
                frozen: false,
            });
        }
    }
    let mean: [f64; 3] =
        std::array::from_fn(|k| bodies.iter().map(|b| b.velocity[k]).sum::<f64>() / count as f64);
    for body in &mut bodies {
        body.velocity = std::array::from_fn(|k| body.velocity[k] - mean[k]);
    }
    let square: f64 = bodies.iter().flat_map(|b| b.velocity).map(|v| v * v).sum();
    let scale = (3.0 * count as f64 / square).sqrt();
    for body in &mut bodies {
        body.velocity = body.velocity.map(|v| v * scale);
    }
    Setup {
        bodies,
        walls: Vec::new(),
        rules: vec![Arc::new(rule)],
        pairs: vec![Some(0)],
        materials: 1,
        cell: Cell::new([0.0; 3], [side; 3], [true; 3]).unwrap(),
        gravity: [0.0; 3],
        contact_duration,
    }
}

/// A body of unit mass and diameter.
pub fn ball(id: u32, position: [f64; 3], velocity: [f64; 3]) -> BodyInput {
    BodyInput {
        id,
        material: 0,
        radius: 0.5,
        mass: 1.0,
        inertia_factor: 0.4,
        position,
        velocity,
        spin: [0.0; 3],
        frozen: false,
    }
}

/// A plane with the only rule.
pub fn plane(point: [f64; 3], normal: [f64; 3], motion: Motion) -> WallInput {
    let plane = Plane::new(Vector3::from(point), Vector3::from(normal)).unwrap();
    WallInput { wall: Wall::new(plane, motion), rules: vec![Some(0)] }
}

/// Bodies of one material between walls, under gravity along -z.
pub fn world(bodies: Vec<BodyInput>, walls: Vec<WallInput>, rule: Plain, g: f64, t_c: f64) -> Setup {
    Setup {
        bodies,
        walls,
        rules: vec![Arc::new(rule)],
        pairs: vec![Some(0)],
        materials: 1,
        cell: Cell::unbounded(),
        gravity: [0.0, 0.0, -g],
        contact_duration: t_c,
    }
}

/// The plane z = 0, bodies above it.
pub fn floor() -> WallInput {
    plane([0.0; 3], [0.0, 0.0, 1.0], Motion::fixed())
}

/// Contact value of the pair correlation (Carnahan and Starling 1969).
pub fn carnahan_starling(phi: f64) -> f64 {
    (1.0 - 0.5 * phi) / (1.0 - phi).powi(3)
}

pub fn engine(setup: &Setup) -> EventEngine {
    EventEngine::new(setup).unwrap()
}

/// Simulates without queue, lists or local times: looks at every pair after every collision.
pub struct Brute {
    pub bodies: Vec<BodyInput>,
    pub time: f64,
    rule: Plain,
    side: f64,
}

impl Brute {
    pub fn new(setup: &Setup, rule: Plain) -> Self {
        Self { bodies: setup.bodies.clone(), time: 0.0, rule, side: setup.cell.period()[0] }
    }

    fn separation(&self, i: usize, j: usize) -> [f64; 3] {
        std::array::from_fn(|k| {
            let d = self.bodies[i].position[k] - self.bodies[j].position[k];
            if self.side > 0.0 { d - self.side * (d / self.side).round() } else { d }
        })
    }

    /// The next collision: time from now, and who.
    fn next(&self) -> Option<(f64, usize, usize)> {
        let mut best: Option<(f64, usize, usize)> = None;
        for i in 0..self.bodies.len() {
            for j in 0..i {
                let near = self.separation(i, j);
                let w: [f64; 3] =
                    std::array::from_fn(|k| self.bodies[i].velocity[k] - self.bodies[j].velocity[k]);
                for image in 0..27 {
                    let shift = [image % 3, image / 3 % 3, image / 9].map(|s| (s as f64 - 1.0) * self.side);
                    let r: [f64; 3] = std::array::from_fn(|k| near[k] + shift[k]);
                    let sigma = self.bodies[i].radius + self.bodies[j].radius;
                    let b: f64 = (0..3).map(|k| r[k] * w[k]).sum();
                    let ww: f64 = w.iter().map(|c| c * c).sum();
                    let c: f64 = r.iter().map(|c| c * c).sum::<f64>() - sigma * sigma;
                    let d = b * b - ww * c;
                    if b < 0.0 && d >= 0.0 {
                        let t = (c / (d.sqrt() - b)).max(0.0);
                        if best.is_none_or(|(least, _, _)| t < least) {
                            best = Some((t, i, j));
                        }
                    }
                    if self.side == 0.0 {
                        break;
                    }
                }
            }
        }
        best
    }

    fn drift(&mut self, dt: f64) {
        for body in &mut self.bodies {
            for k in 0..3 {
                body.position[k] += dt * body.velocity[k];
            }
        }
        self.time += dt;
    }

    /// One collision; false if there is none.
    pub fn collide(&mut self) -> bool {
        let Some((t, i, j)) = self.next() else { return false };
        self.drift(t);
        let r = self.separation(i, j);
        let d = r.iter().map(|c| c * c).sum::<f64>().sqrt();
        let side = |b: &BodyInput| CollidingBody {
            velocity: b.velocity,
            spin: b.spin,
            inverse_mass: 1.0 / b.mass,
            inertia_factor: b.inertia_factor,
            radius: b.radius,
        };
        let (mut a, mut b) = (side(&self.bodies[i]), side(&self.bodies[j]));
        let n = r.map(|c| c / d);
        collide(&self.rule, self.rule.is_rough(), n, &mut a, &mut b, false, 0.0);
        for (index, after) in [(i, a), (j, b)] {
            self.bodies[index].velocity = after.velocity;
            self.bodies[index].spin = after.spin;
        }
        true
    }

    pub fn advance(&mut self, until: f64) -> u64 {
        let mut collisions = 0;
        while let Some((t, _, _)) = self.next() {
            if self.time + t > until {
                break;
            }
            self.collide();
            collisions += 1;
        }
        let left = until - self.time;
        self.drift(left);
        collisions
    }
}

/// The elastic fluid of 4 n³ unit spheres in equilibrium. Dense ones are grown: the crystal that they would start from does
/// not melt by itself.
pub fn fluid(n: usize, phi: f64, seed: u64) -> Setup {
    const MELTS: f64 = 0.3;
    let mut setup = gas(n, phi.min(MELTS), Plain::smooth(1.0), 0.0, seed);
    run(&mut setup, 15.0);
    if phi > MELTS {
        let shrink = (MELTS / phi).cbrt();
        let side = setup.cell.period()[0] * shrink;
        setup.cell = Cell::new([0.0; 3], [side; 3], [true; 3]).unwrap();
        for body in &mut setup.bodies {
            body.position = body.position.map(|x| x * shrink);
            body.radius *= shrink * (1.0 - 1e-12);
        }
        // Each grows as far as the others let it, and moves on.
        while grow(&mut setup, 0.5) {
            run(&mut setup, 1.0);
        }
        run(&mut setup, 15.0);
    }
    setup
}

/// Advances by that many collisions a body.
fn run(setup: &mut Setup, per_body: f64) {
    let mut engine = engine(setup);
    engine.advance_collisions((0.5 * per_body * setup.bodies.len() as f64) as u64).unwrap();
    for (body, state) in setup.bodies.iter_mut().zip(engine.states(engine.time())) {
        (body.position, body.velocity) = (state.position, state.velocity);
    }
}

/// Bodies of a periodic cube by cells that are at least `width` wide.
struct Grid {
    cells: usize,
    side: f64,
    members: Vec<Vec<usize>>,
}

impl Grid {
    fn new(positions: &[[f64; 3]], side: f64, width: f64) -> Self {
        let cells = (side / width).floor() as usize;
        assert!(cells >= 3);
        let mut grid = Self { cells, side, members: vec![Vec::new(); cells.pow(3)] };
        for (body, position) in positions.iter().enumerate() {
            let at = grid.index(grid.cell(*position));
            grid.members[at].push(body);
        }
        grid
    }

    fn cell(&self, position: [f64; 3]) -> [usize; 3] {
        position.map(|x| ((x / self.side * self.cells as f64) as usize).min(self.cells - 1))
    }

    fn index(&self, cell: [usize; 3]) -> usize {
        (cell[2] * self.cells + cell[1]) * self.cells + cell[0]
    }

    /// Those in the cells about a place.
    fn around(&self, position: [f64; 3]) -> impl Iterator<Item = usize> {
        let home = self.cell(position);
        (0..27).flat_map(move |near: usize| {
            let offset = [near % 3, near / 3 % 3, near / 9];
            let there = std::array::from_fn(|k| (home[k] + offset[k] + self.cells - 1) % self.cells);
            self.members[self.index(there)].iter().copied()
        })
    }

    fn distance(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let along = |k: usize| {
            let d = a[k] - b[k];
            d - self.side * (d / self.side).round()
        };
        (0..3).map(|k| along(k).powi(2)).sum::<f64>().sqrt()
    }
}

/// The least distance of two bodies, if it is below 1.
pub fn closest(states: &[BodyState], side: f64) -> f64 {
    let positions: Vec<_> = states.iter().map(|state| state.position).collect();
    let grid = Grid::new(&positions, side, 1.0);
    let mut least = f64::INFINITY;
    for (body, &at) in positions.iter().enumerate() {
        for other in grid.around(at).filter(|other| *other < body) {
            least = least.min(grid.distance(at, positions[other]));
        }
    }
    least
}

/// Radii as large as there is room, `radius` at most. True if some are still smaller.
fn grow(setup: &mut Setup, radius: f64) -> bool {
    let positions: Vec<_> = setup.bodies.iter().map(|body| body.position).collect();
    let grid = Grid::new(&positions, setup.cell.period()[0], 2.0 * radius);
    let mut small = false;
    for (body, &at) in positions.iter().enumerate() {
        let mut room = radius;
        for other in grid.around(at).filter(|other| *other != body) {
            let distance = grid.distance(at, positions[other]);
            room = room.min((distance - setup.bodies[other].radius) * (1.0 - 1e-12));
        }
        let grown = room.max(setup.bodies[body].radius);
        setup.bodies[body].radius = grown;
        small |= grown < radius;
    }
    small
}
