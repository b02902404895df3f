//! Who can meet whom, and what masses, radii and shapes then occur.

use granule_law_api::Span;

use super::Setting;
use crate::model::Partner;

/// Two sides that can meet.
pub(super) struct Meeting {
    pub material: u16,
    pub other: u16,
    pub partner: Partner,
    /// Who, in words.
    pub example: String,
    pub reduced_mass: Span,
    pub reduced_radius: Span,
    pub inertia_factor: Span,
}

/// What the bodies of one material span.
#[derive(Clone, Copy)]
struct Extent {
    count: usize,
    movable: usize,
    /// Inverse mass, zero where frozen.
    inverse_mass: Span,
    radius: Span,
    inertia_factor: Span,
}

fn extents(setting: &Setting<'_>) -> Vec<Option<Extent>> {
    let mut extents: Vec<Option<Extent>> = vec![None; setting.materials.len()];
    for body in setting.bodies {
        let inverse = if body.frozen { 0.0 } else { 1.0 / body.mass };
        let Some(slot) = extents.get_mut(usize::from(body.material)) else { continue };
        let extent = slot.get_or_insert(Extent {
            count: 0,
            movable: 0,
            inverse_mass: Span::of(inverse),
            radius: Span::of(body.radius),
            inertia_factor: Span::of(body.inertia_factor),
        });
        extent.count += 1;
        extent.movable += usize::from(!body.frozen);
        extent.inverse_mass = widen(extent.inverse_mass, inverse);
        extent.radius = widen(extent.radius, body.radius);
        extent.inertia_factor = widen(extent.inertia_factor, body.inertia_factor);
    }
    extents
}

fn widen(span: Span, value: f64) -> Span {
    Span { min: span.min.min(value), max: span.max.max(value) }
}

pub(super) fn meetings(setting: &Setting<'_>) -> Vec<Meeting> {
    let extents = extents(setting);
    let mut meetings = Vec::new();
    let name = |index: usize| setting.materials[index].name.as_str();
    for (a, one) in extents.iter().enumerate() {
        let Some(one) = one else { continue };
        for (b, other) in extents.iter().enumerate().skip(a) {
            let Some(other) = other else { continue };
            let enough = if a == b { one.count >= 2 } else { true };
            if !enough || one.movable + other.movable == 0 {
                continue;
            }
            // Two frozen bodies never interact, so at least one inverse mass is not zero.
            let lightest = one.inverse_mass.max + other.inverse_mass.max;
            let least = smallest_sum(one, other);
            meetings.push(Meeting {
                material: a as u16,
                other: b as u16,
                partner: Partner::Body(b as u16),
                example: format!("bodies of `{}` and bodies of `{}`", name(a), name(b)),
                reduced_mass: Span { min: 1.0 / lightest, max: 1.0 / least },
                reduced_radius: Span {
                    min: reduced(one.radius.min, other.radius.min),
                    max: reduced(one.radius.max, other.radius.max),
                },
                inertia_factor: widen(
                    widen(one.inertia_factor, other.inertia_factor.min),
                    other.inertia_factor.max,
                ),
            });
        }
        if one.movable == 0 {
            continue;
        }
        let mut mass: Option<Span> = None;
        let mut radius: Option<Span> = None;
        let mut inertia: Option<Span> = None;
        for body in setting.bodies.iter().filter(|body| usize::from(body.material) == a && !body.frozen) {
            mass = Some(mass.map_or(Span::of(body.mass), |span| widen(span, body.mass)));
            radius = Some(radius.map_or(Span::of(body.radius), |span| widen(span, body.radius)));
            inertia =
                Some(inertia.map_or(Span::of(body.inertia_factor), |span| widen(span, body.inertia_factor)));
        }
        let (Some(mass), Some(radius), Some(inertia)) = (mass, radius, inertia) else { continue };
        for (index, wall) in setting.walls.iter().enumerate() {
            let surface = wall.wall.surface_at(0.0);
            let curvature = surface.contact(nalgebra::Vector3::zeros()).curvature_radius;
            let at_wall = |radius: f64| 1.0 / (1.0 / radius + 1.0 / curvature);
            meetings.push(Meeting {
                material: a as u16,
                other: wall.material,
                partner: Partner::Wall(index as u16),
                example: format!("bodies of `{}` and wall `{}`", name(a), wall.name),
                reduced_mass: mass,
                reduced_radius: Span { min: at_wall(radius.min), max: at_wall(radius.max) },
                inertia_factor: inertia,
            });
        }
    }
    meetings
}

/// Smallest sum of inverse masses of a pair that interacts.
fn smallest_sum(one: &Extent, other: &Extent) -> f64 {
    let sum = one.inverse_mass.min + other.inverse_mass.min;
    if sum > 0.0 {
        return sum;
    }
    // The heaviest of both are frozen: the heaviest movable body against a frozen one.
    let movable = |extent: &Extent| extent.heaviest_movable();
    movable(one).min(movable(other))
}

impl Extent {
    /// Inverse mass of the heaviest movable body, infinite if none moves. A lower bound is enough: the span of reduced
    /// masses is what laws may have to cope with.
    fn heaviest_movable(&self) -> f64 {
        if self.movable == 0 {
            f64::INFINITY
        } else if self.inverse_mass.min > 0.0 {
            self.inverse_mass.min
        } else {
            self.inverse_mass.max
        }
    }
}

fn reduced(a: f64, b: f64) -> f64 {
    a * b / (a + b)
}
