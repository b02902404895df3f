use granule_integrators as schemes;
use nalgebra::{DMatrix, Vector3};

use super::*;

/// Largest amplitude of a damped oscillator after many steps, from a unit displacement.
fn amplitude<S: schemes::Scheme>(stiffness: f64, damping: f64, step: f64) -> f64 {
    let force = |x: f64, v: f64| -stiffness * x - damping * v;
    let (mut x, mut v) = (1.0, 0.0);
    let mut a = force(x, v);
    let mut memory = schemes::Memory { previous: a, predicted: a };
    for _ in 0..4000 {
        S::begin(&mut x, &mut v, a, &mut memory, schemes::Step::of(step));
        a = force(x, v);
        S::finish(&mut x, &mut v, a, memory, schemes::Step::of(step));
        if x.abs() + v.abs() * step >= 1e6 {
            return f64::INFINITY;
        }
    }
    x.abs() + v.abs() * step
}

fn check<S: schemes::Scheme>(scheme: Scheme) {
    for (stiffness, ratio) in [(1.0, 0.0), (4.0, 0.05), (1.0, 0.5), (9.0, 1.0), (1.0, 3.0)] {
        let damping = 2.0 * ratio * f64::sqrt(stiffness);
        let limit = scheme_limit(stiffness, damping, scheme);
        // Beyond, the root grows with the distance from the limit: far more than 1e4 in 4000 steps. Before it, the motion
        // is bounded by a few hundred initial amplitudes, the distance of two roots that nearly meet.
        assert!(amplitude::<S>(stiffness, damping, 0.99 * limit) < 1e4, "{} {ratio}", S::NAME);
        assert!(amplitude::<S>(stiffness, damping, 1.01 * limit) > 1e4, "{} {ratio}", S::NAME);
    }
}

#[test]
fn the_limit_is_where_each_scheme_becomes_unstable() {
    check::<schemes::VelocityVerlet>(Scheme::VelocityVerlet);
    check::<schemes::ClassicVelocityVerlet>(Scheme::ClassicVelocityVerlet);
    check::<schemes::ContactResolved>(Scheme::ContactResolved);
    check::<schemes::Leapfrog>(Scheme::Leapfrog);
    check::<schemes::SymplecticEuler>(Scheme::SymplecticEuler);
    assert_eq!(scheme_limit(0.0, 0.0, Scheme::VelocityVerlet), f64::INFINITY);
}

/// Bodies with linear springs between neighbours that touch.
struct Cluster {
    position: Vec<Vector3<f64>>,
    radius: Vec<f64>,
    planar: bool,
}

impl Cluster {
    /// Largest K over all modes, from the whole stiffness matrix.
    fn largest(&self, normal: f64, tangential: f64, q: f64) -> f64 {
        let n = self.position.len();
        let mass: Vec<f64> =
            self.radius.iter().map(|r| if self.planar { r * r } else { r * r * r }).collect();
        // Unknowns: displacement and rotation times radius of each body, scaled to unit mass.
        let mut matrix = DMatrix::<f64>::zeros(6 * n, 6 * n);
        for i in 0..n {
            for j in 0..i {
                let apart = self.position[i] - self.position[j];
                if apart.norm() > (self.radius[i] + self.radius[j]) * (1.0 + 1e-6) {
                    continue;
                }
                let normal_direction = apart.normalize();
                for (direction, stiffness) in axes(normal_direction)
                    .into_iter()
                    .map(|axis| (axis, tangential))
                    .chain([(normal_direction, normal)])
                {
                    let mut row = vec![0.0; 6 * n];
                    for (body, sign) in [(i, 1.0), (j, -1.0)] {
                        let (m, inertia) = (mass[body].sqrt(), (q * mass[body]).sqrt());
                        // The contact point of i moves by u_i - φ_i × n, that of j by u_j + φ_j × n.
                        let turning = normal_direction.cross(&direction);
                        for axis in 0..3 {
                            row[6 * body + axis] += sign * direction[axis] / m;
                            row[6 * body + 3 + axis] += -turning[axis] / inertia;
                        }
                        if self.planar {
                            row[6 * body + 2] = 0.0;
                            row[6 * body + 3] = 0.0;
                            row[6 * body + 4] = 0.0;
                        }
                    }
                    let row = nalgebra::DVector::from_vec(row);
                    matrix += stiffness * &row * row.transpose();
                }
            }
        }
        matrix.symmetric_eigenvalues().max()
    }

    /// The bound for the same bodies.
    fn bound(&self, normal: f64, tangential: f64, q: f64) -> f64 {
        let least = self.radius.iter().fold(f64::INFINITY, |a: f64, b| a.min(*b));
        let dimensions = if self.planar { Dimensions::Two } else { Dimensions::Three };
        let felt = tangential * (1.0 + 1.0 / q);
        self.radius
            .iter()
            .map(|r| {
                let mass = if self.planar { r * r } else { r * r * r };
                let around = Neighbours::around(*r, least, self.radius.len() as f64 - 1.0, dimensions);
                body_bound(normal, felt, q, mass, &around)
            })
            .fold(0.0, f64::max)
    }
}

fn axes(n: Vector3<f64>) -> [Vector3<f64>; 2] {
    let other = if n.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let first = n.cross(&other).normalize();
    [first, n.cross(&first)]
}

fn clusters() -> Vec<Cluster> {
    let mut clusters = Vec::new();
    // A triangular lattice of 37 discs.
    let mut position = Vec::new();
    for a in -3i32..=3 {
        for b in -3i32..=3 {
            if (a + b).abs() <= 3 {
                position.push(Vector3::new(
                    f64::from(a) + 0.5 * f64::from(b),
                    0.75f64.sqrt() * f64::from(b),
                    0.0,
                ));
            }
        }
    }
    clusters.push(Cluster { radius: vec![0.5; position.len()], position, planar: true });
    // A face-centred cube.
    let mut position = Vec::new();
    for x in -2..=2i32 {
        for y in -2..=2i32 {
            for z in -2..=2i32 {
                if (x + y + z) % 2 == 0 {
                    position.push(Vector3::new(f64::from(x), f64::from(y), f64::from(z)) / 2f64.sqrt());
                }
            }
        }
    }
    clusters.push(Cluster { radius: vec![0.5; position.len()], position, planar: false });
    // Both poles of a sphere, and five neighbours at 60 degrees around each.
    let mut position = vec![Vector3::zeros(), Vector3::z(), -Vector3::z()];
    for k in 0..5 {
        let angle = 2.0 * PI * f64::from(k) / 5.0;
        for side in [0.5, -0.5] {
            position.push(Vector3::new(0.75f64.sqrt() * angle.cos(), 0.75f64.sqrt() * angle.sin(), side));
        }
    }
    clusters.push(Cluster { radius: vec![0.5; position.len()], position, planar: false });
    // A large sphere covered by small ones, and a large disc.
    for (ratio, planar) in [(2.0, true), (5.0, true), (2.0, false), (4.0, false)] {
        let (mut position, mut radius) = (vec![Vector3::zeros()], vec![ratio * 0.5]);
        let distance = 0.5 * (ratio + 1.0);
        for k in 0..4000 {
            // A spiral over the sphere, or around the circle; each place that is free is taken.
            let turn = 2.399_963 * f64::from(k);
            let height = 1.0 - 2.0 * (f64::from(k) + 0.5) / 4000.0;
            let place = if planar {
                let turn = 2.0 * PI * f64::from(k) / 4000.0;
                distance * Vector3::new(turn.cos(), turn.sin(), 0.0)
            } else {
                let across = (1.0 - height * height).sqrt();
                distance * Vector3::new(across * turn.cos(), across * turn.sin(), height)
            };
            if position[1..].iter().all(|other| (place - other).norm() >= 1.0) {
                position.push(place);
                radius.push(0.5);
            }
        }
        clusters.push(Cluster { position, radius, planar });
    }
    clusters
}

#[test]
fn no_packing_is_stiffer_than_the_bound() {
    for (index, cluster) in clusters().iter().enumerate() {
        for (tangential, q) in [(0.0, 0.4), (2.0 / 7.0, 0.4), (1.0, 0.5), (2.0, 2.0 / 3.0)] {
            let (largest, bound) = (cluster.largest(1.0, tangential, q), cluster.bound(1.0, tangential, q));
            // Nor is the bound idle: 2.5 is a factor 1.6 in the step, for clusters of equal bodies.
            assert!(largest <= bound, "cluster {index}, k_t {tangential}: {largest} > {bound}");
            assert!(
                bound < 2.5 * largest || index > 2,
                "cluster {index}, k_t {tangential}: {largest} << {bound}"
            );
        }
    }
}

/// Directions on a circle at least `least` apart that maximise `Σ normal cos²θ + tangential sin²θ`: from random places, each
/// is moved to the best place between its neighbours again and again.
fn search(number: usize, least: f64, normal: f64, tangential: f64, next: &mut impl FnMut() -> f64) -> f64 {
    let slack = 2.0 * PI - number as f64 * least;
    let mut cuts: Vec<f64> = (0..number).map(|_| next()).collect();
    cuts.sort_unstable_by(f64::total_cmp);
    let turn = 2.0 * PI * next();
    let mut angle: Vec<f64> =
        cuts.iter().enumerate().map(|(k, cut)| turn + cut * slack + k as f64 * least).collect();
    let one = |angle: f64| normal * angle.cos().powi(2) + tangential * angle.sin().powi(2);
    for _ in 0..200 {
        for k in 0..number {
            let low = if k > 0 { angle[k - 1] } else { angle[number - 1] - 2.0 * PI } + least;
            let high = if k + 1 < number { angle[k + 1] } else { angle[0] + 2.0 * PI } - least;
            // The largest value of a cosine between two ends is at an end or at a quarter of a turn.
            let quarters = (low / (PI / 2.0)).ceil() as i64..=(high / (PI / 2.0)).floor() as i64;
            let places = quarters.map(|quarter| quarter as f64 * PI / 2.0).chain([low, high]);
            angle[k] = places.max_by(|a, b| one(*a).total_cmp(&one(*b))).unwrap_or(angle[k]);
        }
    }
    angle.iter().map(|angle| one(*angle)).sum()
}

#[test]
fn no_neighbours_in_the_plane_hold_a_disc_stiffer_than_the_bound() {
    let mut seed = 1u64;
    let mut next = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut tightest = f64::INFINITY;
    let mut above_the_mean = 0.0f64;
    for step in 0..60 {
        // Radii from that of the smallest disc to about eight times it.
        let radius = 1.0 + 0.002 * f64::from(step * step);
        let around = Neighbours::around(radius, 1.0, 1e9, Dimensions::Two);
        let least = 2.0 * (1.0 / (1.0 + radius)).asin();
        let most = (2.0 * PI / least * (1.0 + 1e-12)) as usize;
        for (normal, tangential) in [(1.0, 0.0), (1.0, 0.3), (0.5, 1.0)] {
            let mut largest = 0.0f64;
            for number in most.saturating_sub(2)..=most {
                // Two chains on opposite sides of the direction.
                let chain = |m: usize, middle: f64| {
                    (0..m).map(move |k| middle + (k as f64 - 0.5 * (m as f64 - 1.0)) * least)
                };
                let one = |t: f64| normal * t.cos().powi(2) + tangential * t.sin().powi(2);
                if tangential < normal {
                    let chains = chain(number / 2, PI).chain(chain(number - number / 2, 0.0));
                    largest = largest.max(chains.map(one).sum());
                }
                for _ in 0..20 {
                    largest = largest.max(search(number, least, normal, tangential, &mut next));
                }
            }
            // Without the factor 2 of bodies that move against each other. Sums of some ten cosines.
            let bound = held_in_the_plane(normal, tangential, around.half_angle);
            assert!(largest <= bound * (1.0 + 1e-12), "radius {radius}: {largest} > {bound}");
            tightest = tightest.min(bound / largest);
            above_the_mean = above_the_mean.max(largest / (0.5 * around.covered * (normal + tangential)));
            if tangential == 0.0 {
                assert_eq!(body_bound(normal, 0.0, 0.5, 1.0, &around), 2.0 * bound);
            }
        }
    }
    assert!(tightest < 1.0 + 1e-9, "the bound is reached: {tightest}");
    // The mean over all directions is exceeded: here by the 1.6 % of six neighbours at 52 degrees.
    assert!(above_the_mean > 1.015, "{above_the_mean}");
}

#[test]
fn numbers_of_neighbours() {
    let spheres = Neighbours::around(1.0, 1.0, 1e9, Dimensions::Three);
    // 12 is the true number, and Σ (n·u)² of the arrangement around both poles is 4.5.
    assert!(spheres.covered > 13.5 && spheres.covered < 13.6);
    assert!(spheres.covered / 3.0 >= 4.5);
    let discs = Neighbours::around(1.0, 1.0, 1e9, Dimensions::Two);
    assert!((discs.covered - 6.0).abs() < 1e-14);
    // Far fewer bodies than could find a place.
    let few = Neighbours::around(1.0, 1.0, 2.0, Dimensions::Three);
    assert_eq!(body_bound(1.0, 0.0, 0.4, 1.0, &few), 4.0);
}
