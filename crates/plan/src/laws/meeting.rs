//! Who can meet whom, and what masses, radii and shapes then occur.

use granule_geometry::Surface;
use granule_law_api::Span;
use nalgebra::Vector3;

use super::{MOST_MEETINGS, Setting};
use crate::bodies::Draft;
use crate::model::Partner;

/// Up to this many pairs, each one is looked at: few bodies have exact spans.
const FEW_PAIRS: usize = 4096;

/// Two sides that can meet.
pub(crate) struct Meeting {
    pub material: u16,
    pub other: u16,
    pub partner: Partner,
    /// Who, in words.
    pub example: String,
    pub reduced_mass: Span,
    pub reduced_radius: Span,
    pub inertia_factor: Span,
}

/// All meetings: bodies with bodies by material, then bodies with walls.
pub(crate) fn meetings(setting: &Setting<'_>) -> Vec<Meeting> {
    let mut groups: Vec<Vec<&Draft>> = vec![Vec::new(); setting.materials.len()];
    for body in setting.bodies {
        if let Some(group) = groups.get_mut(usize::from(body.material)) {
            group.push(body);
        }
    }
    let mut meetings = Vec::new();
    let used: Vec<usize> = (0..groups.len()).filter(|group| !groups[*group].is_empty()).collect();
    for (at, &a) in used.iter().enumerate() {
        let one = &groups[a];
        for &b in &used[at..] {
            // The caller refuses more.
            if meetings.len() > MOST_MEETINGS {
                return meetings;
            }
            meetings.extend(bodies_meet(setting, a, b, one, &groups[b]));
        }
        let movable: Vec<&Draft> = one.iter().copied().filter(|body| !body.frozen).collect();
        if movable.is_empty() {
            continue;
        }
        let of = |value: fn(&Draft) -> f64| span(movable.iter().map(|body| value(body)));
        let none = Span::of(0.0);
        let mass = of(|body| body.mass).unwrap_or(none);
        let radius = of(|body| body.radius).unwrap_or(none);
        let inertia_factor = of(|body| body.inertia_factor).unwrap_or(none);
        for wall in 0..setting.walls.len() {
            meetings.push(wall_meets(setting, a, wall, [mass, radius, inertia_factor]));
        }
    }
    meetings
}

fn span(values: impl Iterator<Item = f64>) -> Option<Span> {
    values.fold(None, |span: Option<Span>, value| {
        Some(span.map_or(Span::of(value), |span| Span { min: span.min.min(value), max: span.max.max(value) }))
    })
}

/// Zero for a frozen body, which counts as infinitely heavy.
fn inverse_mass(body: &Draft) -> f64 {
    if body.frozen { 0.0 } else { 1.0 / body.mass }
}

fn reduced(a: f64, b: f64) -> f64 {
    a * b / (a + b)
}

fn bodies_meet(
    setting: &Setting<'_>,
    a: usize,
    b: usize,
    one: &[&Draft],
    other: &[&Draft],
) -> Option<Meeting> {
    let (inverse, reduced_radius) = if one.len() * other.len() <= FEW_PAIRS {
        let pairs = || {
            let skip = |i: usize| if a == b { i + 1 } else { 0 };
            one.iter()
                .enumerate()
                .flat_map(move |(i, first)| other.iter().skip(skip(i)).map(move |second| (*first, *second)))
                .filter(|(first, second)| !(first.frozen && second.frozen))
        };
        let inverse = span(pairs().map(|(first, second)| inverse_mass(first) + inverse_mass(second)))?;
        (inverse, span(pairs().map(|(first, second)| reduced(first.radius, second.radius)))?)
    } else {
        many(one, other)?
    };
    let name = |index: usize| setting.materials[index].name.as_str();
    Some(Meeting {
        material: a as u16,
        other: b as u16,
        partner: Partner::Body(b as u16),
        example: format!("bodies of `{}` and bodies of `{}`", name(a), name(b)),
        reduced_mass: Span { min: 1.0 / inverse.max, max: 1.0 / inverse.min },
        reduced_radius,
        inertia_factor: span(one.iter().chain(other).map(|body| body.inertia_factor))?,
    })
}

/// Bounds of the sum of inverse masses and of the reduced radius, without looking at each pair.
fn many(one: &[&Draft], other: &[&Draft]) -> Option<(Span, Span)> {
    let movable =
        |group: &[&Draft]| span(group.iter().filter(|body| !body.frozen).map(|body| 1.0 / body.mass));
    let frozen = |group: &[&Draft]| group.iter().any(|body| body.frozen);
    let (first, second) = (movable(one), movable(other));
    let both = first.zip(second).map(|(a, b)| Span { min: a.min + b.min, max: a.max + b.max });
    let kinds = [both, first.filter(|_| frozen(other)), second.filter(|_| frozen(one))];
    let inverse = span(kinds.into_iter().flatten().flat_map(|span| [span.min, span.max]))?;
    let (a, b) = (span(one.iter().map(|body| body.radius))?, span(other.iter().map(|body| body.radius))?);
    Some((inverse, Span { min: reduced(a.min, b.min), max: reduced(a.max, b.max) }))
}

/// A wall and the bodies of a material, whose masses, radii and inertia factors are known.
fn wall_meets(
    setting: &Setting<'_>,
    material: usize,
    index: usize,
    [mass, radius, inertia_factor]: [Span; 3],
) -> Meeting {
    let wall = &setting.walls[index];
    // The same everywhere on a plane or a cylinder.
    let curvature = match wall.wall.surface() {
        Surface::Plane(_) => f64::INFINITY,
        surface @ Surface::Cylinder(_) => surface.contact(Vector3::zeros()).curvature_radius,
    };
    let at_wall = |radius: f64| 1.0 / (1.0 / radius + 1.0 / curvature);
    Meeting {
        material: material as u16,
        other: wall.material,
        partner: Partner::Wall(index as u16),
        example: format!("bodies of `{}` and wall `{}`", setting.materials[material].name, wall.name),
        reduced_mass: mass,
        reduced_radius: Span { min: at_wall(radius.min), max: at_wall(radius.max) },
        inertia_factor,
    }
}
