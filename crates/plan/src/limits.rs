//! How large the time step may be: for one pair of bodies, and for a packing.
//!
//! **Scheme.** An oscillator `x'' = -K x - C v` (K in 1/s², C in 1/s) is stable under a step dt while
//! `dt² K + 2 c dt C < 4`, with c = 1 for schemes whose forces see velocities half a step behind or before the kick
//! (classic velocity Verlet, leapfrog, symplectic Euler), c = 2 for velocity Verlet with predicted velocities, and c = 4 where
//! the prediction extrapolates the acceleration of the last two steps (`ContactResolved`). (The characteristic polynomials are
//! `λ² - 2λ + 1 + dt²K λ + dt C (λ-1)`, `λ(λ-1)² + dt²K λ² + dt C (3λ² - 4λ + 1)/2` and
//! `λ²(λ-1)² + dt²K λ³ + dt C (λ-1)(4λ² - 3λ + 1)/2`; all first leave the unit circle at λ = -1.) Many bodies obey the same
//! rule with the Rayleigh quotients of stiffness and damping of any mode, hence with their largest values.
//!
//! **Pair.** K = k/m12, C = γ/m12 along the normal; in the tangent plane laws give k and γ as m12 feels them, spins
//! included.
//!
//! **Packing.** The energy of a contact is at most twice the sum of what each body would make alone,
//! `(a - b)² <= 2a² + 2b²`, so the largest K is at most that of a single body held by all its neighbours, times two. Held
//! by neighbours in directions n, a body feels `Σ k_n (n·u)² + k_t (1 - (n·u)²)` along u, `Σ k_t (1 - (n·u)²)/q` about u (as
//! rotation times radius), and a coupling `k_t |Σ n|/√q` of both. Neighbours at least as large as the smallest body cover
//! caps of half angle α, sin α = r/(R + r). In space the caps lie on a sphere with a density of at most π/√12, which bounds
//! their number: 13.5 for equal spheres. As all terms are positive, the sums are largest when neighbours are everywhere,
//! that is number times mean over all directions (1/3 and 2/3). The coupling is largest, at a third of the number, when
//! neighbours are on one side only; but then the other sums are halved.
//!
//! **Packing in the plane.** There the mean over all directions is no bound: neighbours may stand closer around u and leave
//! gaps across it. With angles θ from u, `Σ (n·u)² = N/2 + Σ cos(2θ)/2`. On either side of the line across u are m
//! neighbours, each at least 2α from the next. A gap between them that is wider can be closed by moving the chain on one side
//! of it towards u, which increases the sum as long as a chain of m spans less than half a turn (2mα < π; a longer one has no
//! positive sum). So the sum is largest for one chain with its middle on u, where it is `sin(2mα)/sin(2α)`, and
//! `Σ (n·u)² <= N/2 + (g(m) + g(N - m))/2` with `g(m) = max(0, sin(2mα)/sin(2α))`, largest at halves that are as equal as
//! possible because g is concave. Equality holds for two chains on opposite sides. For equal discs this is 3, as for a
//! mean over six neighbours; at α = 26° it is 3.516 of six neighbours, where the mean over 180°/26° neighbours is 3.462. The
//! coupling is at most `k_t sin(mα)/sin(α) <= k_t/sin(α)`, the chain of half a turn, and that at most a third of π/α because
//! α is at most 30° here.

use std::f64::consts::PI;

use granule_law_api::{Impact, PairContext, Slot, Span};

use crate::model::{Composition, Dimensions, Partner, Plan, Scheme};
use crate::place::Place;

/// Stiffness and damping of a contact, as masses feel them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Contact {
    /// Along the normal \[N/m\].
    stiffness: f64,
    /// Along the normal \[kg/s\].
    damping: f64,
    /// In the tangent plane, as m12 feels it, spins included \[N/m\].
    tangential_stiffness: f64,
    /// In the tangent plane, as m12 feels it, spins included \[kg/s\].
    tangential_damping: f64,
    /// Half a period of its fastest oscillation, or the duration of the contact \[s\].
    duration: Option<f64>,
    /// The duration by the normal law alone \[s\].
    normal_duration: Option<f64>,
}

/// Limits of the time step.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Largest stable step of one pair \[s\].
    pub pair: f64,
    /// Largest step that is stable whatever the packing \[s\].
    pub packing: f64,
    /// Some body may have several contacts at once, so that the packing counts.
    pub crowded: bool,
    /// Duration of the shortest contact \[s\].
    pub shortest_contact: Option<f64>,
    /// The contact that decides, in words.
    pub stiffest: String,
    /// Where it lies in the maps of stability.
    pub place: Option<Place>,
}

impl Limits {
    /// The limit that holds for the scene \[s\].
    pub fn step(&self) -> f64 {
        if self.crowded { self.packing.min(self.pair) } else { self.pair }
    }
}

/// The limits of a plan with its bodies, walls, compositions and scheme.
pub fn limits(plan: &Plan) -> Limits {
    let scheme = plan.driver.scheme;
    let mut limits = Limits {
        pair: f64::INFINITY,
        packing: f64::INFINITY,
        crowded: plan.bodies.len() + plan.walls.len() > 2,
        shortest_contact: None,
        stiffest: String::new(),
        place: None,
    };
    for composition in &plan.compositions {
        let context = &composition.context;
        for reduced_mass in ends(context.reduced_mass) {
            for reduced_radius in ends(context.reduced_radius) {
                let contact = evaluate(composition, reduced_mass, reduced_radius);
                let step = pair_limit(&contact, reduced_mass, scheme);
                if step < limits.pair {
                    limits.pair = step;
                    limits.stiffest = format!(
                        "{}: stiffness {:.3e} N/m, damping {:.3e} kg/s at a reduced mass of {reduced_mass:.3e} kg",
                        name(plan, composition),
                        contact.stiffness.max(contact.tangential_stiffness),
                        contact.damping.max(contact.tangential_damping),
                    );
                    limits.place = contact.normal_duration.and_then(|duration| {
                        let damping = 0.5 * contact.damping / (contact.stiffness * reduced_mass).sqrt();
                        Place::of(composition, duration, damping, scheme)
                    });
                }
                if let Some(duration) = contact.duration {
                    let shortest = limits.shortest_contact.map_or(duration, |least: f64| least.min(duration));
                    limits.shortest_contact = Some(shortest);
                }
            }
        }
    }
    if limits.crowded {
        limits.packing = packing_limit(plan);
    }
    limits
}

/// Names of both sides of a composition.
pub(crate) fn name(plan: &Plan, composition: &Composition) -> String {
    let material =
        |index: u16| plan.materials.get(usize::from(index)).map_or("?", |material| material.name.as_str());
    match composition.partner {
        Partner::Body(other) => format!("{} on {}", material(composition.material), material(other)),
        Partner::Wall(wall) => {
            let wall = plan.walls.get(usize::from(wall)).map_or("?", |wall| wall.name.as_str());
            format!("{} on wall `{wall}`", material(composition.material))
        }
    }
}

fn ends(span: Span) -> impl Iterator<Item = f64> {
    let second = (!span.is_single()).then_some(span.max);
    std::iter::once(span.min).chain(second)
}

/// Time scales of the laws for one reduced mass and radius at the largest impact speed.
fn evaluate(composition: &Composition, reduced_mass: f64, reduced_radius: f64) -> Contact {
    let context = &composition.context;
    let impact = Impact { reduced_mass, reduced_radius, normal_speed: context.impact_speed };
    let mut single = PairContext {
        reduced_mass: Span::of(reduced_mass),
        reduced_radius: Span::of(reduced_radius),
        normal: None,
        ..*context
    };
    let mut contact = Contact::default();
    for stage in &composition.stages {
        let scale = (stage.law.time_scale)(&stage.params, &single, &impact).ok().flatten();
        if stage.slot == Slot::Normal {
            single.normal = (stage.law.summary)(&stage.params, &single);
        }
        let Some(scale) = scale else { continue };
        let usable = |value: f64| if value.is_finite() { value.max(0.0) } else { 0.0 };
        let (stiffness, damping) = match stage.slot {
            Slot::Normal | Slot::Cohesion => (&mut contact.stiffness, &mut contact.damping),
            Slot::Tangential | Slot::Rolling | Slot::Torsion | Slot::Collision => {
                (&mut contact.tangential_stiffness, &mut contact.tangential_damping)
            }
        };
        *stiffness += usable(scale.stiffness);
        *damping += usable(scale.damping);
        // A dashpot alone has a time of decay, which the limits take care of, and no duration.
        if scale.stiffness > 0.0 && scale.duration > 0.0 && scale.duration.is_finite() {
            if stage.slot == Slot::Normal {
                contact.normal_duration = Some(scale.duration);
            }
            contact.duration =
                Some(contact.duration.map_or(scale.duration, |least| least.min(scale.duration)));
        }
    }
    contact
}

/// Largest stable step of `x'' = -stiffness x - damping v`, both per mass.
pub(crate) fn scheme_limit(stiffness: f64, damping: f64, scheme: Scheme) -> f64 {
    let factor = match scheme {
        Scheme::VelocityVerlet => 2.0,
        Scheme::ContactResolved => 4.0,
        Scheme::ClassicVelocityVerlet | Scheme::Leapfrog | Scheme::SymplecticEuler => 1.0,
    };
    let damped = factor * damping;
    // The positive root of dt² K + 2 c dt C = 4; infinite without stiffness and damping.
    4.0 / (damped + (damped * damped + 4.0 * stiffness).sqrt())
}

fn pair_limit(contact: &Contact, mass: f64, scheme: Scheme) -> f64 {
    let normal = scheme_limit(contact.stiffness / mass, contact.damping / mass, scheme);
    let tangential =
        scheme_limit(contact.tangential_stiffness / mass, contact.tangential_damping / mass, scheme);
    normal.min(tangential)
}

/// How many neighbours a body can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Neighbours {
    /// Largest number by the share of directions that each one takes; not a whole number.
    pub covered: f64,
    /// How many there are in the scene.
    pub available: f64,
    /// Half of the angle at which two of them may follow each other.
    half_angle: f64,
    dimensions: Dimensions,
}

impl Neighbours {
    /// Neighbours of radius `least` or more on a body of radius `radius`, of which there are `available`.
    pub fn around(radius: f64, least: f64, available: f64, dimensions: Dimensions) -> Self {
        let half_angle = (least / (radius + least)).min(0.5).asin();
        let covered = match dimensions {
            // 2 (π/√12)/(1 - cos α), written so that small angles keep their digits.
            Dimensions::Three => (PI / 12f64.sqrt()) / (0.5 * half_angle).sin().powi(2),
            Dimensions::Two => PI / half_angle,
        };
        Self { covered, available, half_angle, dimensions }
    }
}

/// Largest K (or C) of a body of this mass under the given normal and tangential coefficient.
pub(crate) fn body_bound(normal: f64, felt: f64, q: f64, mass: f64, around: &Neighbours) -> f64 {
    // Without spins: q/(1+q) of what m12 feels in the tangent plane.
    let tangential = felt * q / (1.0 + q);
    let (covered, available) = (around.covered, around.available);
    let (along, about) = match around.dimensions {
        Dimensions::Three => (covered * (normal + 2.0 * tangential) / 3.0, covered * 2.0 * tangential / 3.0),
        // All neighbours lie across the axis of the spin.
        Dimensions::Two => (held_in_the_plane(normal, tangential, around.half_angle), covered * tangential),
    };
    let along = along.min(available * normal.max(tangential));
    let about = about.min(available * tangential) / q;
    let coupling = (covered / 3.0).min(available) * tangential / q.sqrt();
    let around_all = along.max(about);
    // Few neighbours may all be on one side.
    let one_sided = if available < covered { around_all } else { 0.5 * around_all };
    2.0 * around_all.max(one_sided + coupling) / mass
}

/// Largest `Σ normal (n·u)² + tangential (1 - (n·u)²)` of neighbours at least `2 half_angle` apart on a circle.
fn held_in_the_plane(normal: f64, tangential: f64, half_angle: f64) -> f64 {
    let chain = |m: f64| ((2.0 * m * half_angle).sin() / (2.0 * half_angle).sin()).max(0.0);
    // A hair more, so that rounding does not lose the last neighbour.
    let most = (PI / half_angle * (1.0 + 1e-12)).floor();
    let sum = |number: f64| {
        let half = (0.5 * number).floor();
        let uneven = 0.5 * (chain(half) + chain(number - half));
        0.5 * number * (normal + tangential) + (normal - tangential).abs() * uneven
    };
    // One neighbour less costs half of the mean stiffness, and gains less than that unless chains are nearly half a turn
    // long: the largest sum has at most three neighbours less than there can be.
    (0..4).map(|less| sum((most - f64::from(less)).max(0.0))).fold(0.0, f64::max)
}

/// Bodies of one material and of similar mass: a wide distribution is judged in parts.
struct Class {
    material: u16,
    lightest: f64,
    heaviest: f64,
    smallest: f64,
    largest: f64,
    inertia_factor: f64,
}

fn classes(plan: &Plan) -> Vec<Class> {
    let bodies = &plan.bodies;
    let mut order: Vec<usize> = (0..bodies.len()).filter(|k| !bodies.frozen[*k]).collect();
    order.sort_by(|a, b| {
        bodies.material[*a].cmp(&bodies.material[*b]).then(bodies.mass[*a].total_cmp(&bodies.mass[*b]))
    });
    let mut classes: Vec<Class> = Vec::new();
    for k in order {
        let (mass, radius, q) = (bodies.mass[k], bodies.radius[k], bodies.inertia_factor[k]);
        match classes.last_mut() {
            Some(class) if class.material == bodies.material[k] && mass <= 1.1 * class.lightest => {
                class.heaviest = class.heaviest.max(mass);
                class.smallest = class.smallest.min(radius);
                class.largest = class.largest.max(radius);
                class.inertia_factor = class.inertia_factor.min(q);
            }
            _ => classes.push(Class {
                material: bodies.material[k],
                lightest: mass,
                heaviest: mass,
                smallest: radius,
                largest: radius,
                inertia_factor: q,
            }),
        }
    }
    classes
}

fn packing_limit(plan: &Plan) -> f64 {
    let bodies = &plan.bodies;
    let least = bodies.radius.iter().fold(f64::INFINITY, |a: f64, b| a.min(*b));
    let available = (bodies.len() + plan.walls.len()).saturating_sub(1) as f64;
    let extents = extents(plan);
    let mut limit = f64::INFINITY;
    for class in classes(plan) {
        let mut stiffest = Contact::default();
        for composition in &plan.compositions {
            let partner = match composition.partner {
                Partner::Wall(_) if composition.material == class.material => None,
                Partner::Body(other) if composition.material == class.material => Some(other),
                Partner::Body(other) if other == class.material => Some(composition.material),
                _ => continue,
            };
            for (mass, radius) in partners(&extents, &class, partner, composition) {
                let contact = evaluate(composition, mass, radius);
                stiffest.stiffness = stiffest.stiffness.max(contact.stiffness);
                stiffest.damping = stiffest.damping.max(contact.damping);
                stiffest.tangential_stiffness =
                    stiffest.tangential_stiffness.max(contact.tangential_stiffness);
                stiffest.tangential_damping = stiffest.tangential_damping.max(contact.tangential_damping);
            }
        }
        let around = Neighbours::around(class.largest, least, available, plan.dimensions);
        let (q, mass) = (class.inertia_factor, class.lightest);
        let stiffness = body_bound(stiffest.stiffness, stiffest.tangential_stiffness, q, mass, &around);
        let damping = body_bound(stiffest.damping, stiffest.tangential_damping, q, mass, &around);
        limit = limit.min(scheme_limit(stiffness, damping, plan.driver.scheme));
    }
    limit
}

/// Masses and radii of the bodies of a material; frozen ones are infinitely heavy.
#[derive(Clone, Copy)]
struct Extents {
    light: f64,
    heavy: f64,
    small: f64,
    large: f64,
}

fn extents(plan: &Plan) -> Vec<Extents> {
    let bodies = &plan.bodies;
    let none = Extents { light: f64::INFINITY, heavy: 0.0, small: f64::INFINITY, large: 0.0 };
    let mut extents = vec![none; plan.materials.len()];
    for k in 0..bodies.len() {
        let Some(of) = extents.get_mut(usize::from(bodies.material[k])) else { continue };
        let mass = if bodies.frozen[k] { f64::INFINITY } else { bodies.mass[k] };
        (of.light, of.heavy) = (of.light.min(mass), of.heavy.max(mass));
        (of.small, of.large) = (of.small.min(bodies.radius[k]), of.large.max(bodies.radius[k]));
    }
    extents
}

/// Reduced masses and radii of the contacts of a class with its lightest and heaviest partner of a material, or a wall.
fn partners(
    extents: &[Extents],
    class: &Class,
    material: Option<u16>,
    composition: &Composition,
) -> Vec<(f64, f64)> {
    let Some(material) = material else {
        let radius = composition.context.reduced_radius;
        return ends(radius).map(|radius| (class.heaviest, radius)).collect();
    };
    let Extents { light, heavy, small, large } = extents[usize::from(material)];
    let together = |a: f64, b: f64| 1.0 / (1.0 / a + 1.0 / b);
    vec![
        (together(class.lightest, light), together(class.smallest, small)),
        (together(class.heaviest, heavy), together(class.largest, large)),
    ]
}

#[cfg(test)]
mod tests;
