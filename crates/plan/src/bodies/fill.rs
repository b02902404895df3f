//! Bodies at random places: random sequential addition, largest first.

use granule_geometry::{Cell, Surface};
use granule_scene::{FillAmount, FillBlock, RadiusChoice};
use nalgebra::Vector3;

use super::random::{self, Purpose, Random};
use super::{Common, Draft, MOST, Occupancy, common};
use crate::build::Builder;
use crate::model::Dimensions;
use crate::model::WallPlan;

/// Places tried for one body before the fill gives up. At the densities that the method reaches at all, a body finds its
/// place after some hundred trials.
const TRIALS: u32 = 20_000;
/// Comparisons of a trial with cells, bodies and walls that a whole fill may take, and those for each of its bodies: far more
/// than fills take that succeed, which is less than 10 000 a body where walls are few.
const LOOKS: u64 = 100_000_000;
const LOOKS_A_BODY: u64 = 100_000;

/// The bodies of one block, clear of each other, of the bodies so far, and of the walls.
pub fn bodies(
    builder: &mut Builder<'_>,
    block: &FillBlock,
    index: usize,
    cell: &Cell,
    walls: &[WallPlan],
    before: &[Draft],
) -> Vec<Draft> {
    let velocity = block.velocity.as_ref();
    let common = common(builder, block.shape.as_ref(), &block.material, velocity, false, index, &block.span);
    let (lo, hi) = (builder.vector(&block.lo, "lo"), builder.vector(&block.hi, "hi"));
    let (Some(common), Some(lo), Some(hi)) = (common, lo, hi) else { return Vec::new() };
    let planar = builder.dimensions == Dimensions::Two;
    let axes = if planar { 2 } else { 3 };
    if (0..axes).any(|axis| lo[axis] >= hi[axis]) {
        builder.error(block.hi.span.clone(), "`hi` must be above `lo` in each direction");
        return Vec::new();
    }
    let periodic = cell.periodic();
    let (least, most) = (cell.lo(), cell.hi());
    if (0..axes).any(|axis| periodic[axis] && (lo[axis] < least[axis] || hi[axis] > most[axis])) {
        builder.error(block.span.clone(), "the region must lie in the cell in its periodic directions");
        return Vec::new();
    }
    let Some(radii) = radii(builder, block, index, lo, hi, axes) else { return Vec::new() };
    let region = Region::new(lo, hi, axes, cell);
    let requested = radii.len();
    let (placed, end, _) = place(builder.scene.seed, index, &radii, &region, cell, walls, before);
    if placed.len() < requested {
        let share = radii.iter().map(|r| size(*r, axes)).sum::<f64>() / region.size();
        builder.error_help(
            block.span.clone(),
            match end {
                End::Trials => {
                    format!("{} of {requested} bodies found a place after {TRIALS} trials each", placed.len())
                }
                End::Looks(looks) => format!(
                    "{} of {requested} bodies found a place after {looks} comparisons with bodies and walls",
                    placed.len()
                ),
            },
            format!(
                "they would take {:.1} % of the region; random placing reaches about {} %: a larger region, or a lattice, or \
                 bodies that settle from a larger region",
                100.0 * share,
                if planar { 54 } else { 38 },
            ),
        );
        return Vec::new();
    }
    let spread = block.velocity_spread.as_ref().map_or(0.0, |spread| spread.value);
    builder.decide_one("random fill", true, format!("{requested} bodies requested, {} placed", placed.len()));
    finish(builder.scene.seed, index, &common, placed, spread, random::axes(builder))
}

fn finish(
    seed: u64,
    index: usize,
    common: &Common,
    placed: Vec<([f64; 3], f64)>,
    spread: f64,
    axes: usize,
) -> Vec<Draft> {
    let mut thermal = Random::new(seed, index, Purpose::Velocities);
    placed
        .into_iter()
        .map(|(position, radius)| {
            let mut body = common.body(radius, position);
            thermal.spread(&mut body.velocity, spread, axes);
            body
        })
        .collect()
}

/// Volume of a sphere, or area of a disc.
fn size(radius: f64, axes: usize) -> f64 {
    use std::f64::consts::PI;
    if axes == 2 { PI * radius * radius } else { 4.0 / 3.0 * PI * radius * radius * radius }
}

/// Radii, the largest first. Refuses what cannot fit before anything is drawn.
fn radii(
    builder: &mut Builder<'_>,
    block: &FillBlock,
    index: usize,
    lo: [f64; 3],
    hi: [f64; 3],
    axes: usize,
) -> Option<Vec<f64>> {
    let region: f64 = (0..axes).map(|axis| hi[axis] - lo[axis]).product();
    let (least, most) = match &block.radius {
        RadiusChoice::Fixed(radius) => (radius.value, radius.value),
        RadiusChoice::Uniform { min, max } => (min.value, max.value),
        RadiusChoice::Normal { mean, standard_deviation } => {
            (mean.value - 3.0 * standard_deviation.value, mean.value + 3.0 * standard_deviation.value)
        }
        RadiusChoice::Mixture(parts) => {
            parts.iter().fold((f64::INFINITY, 0.0), |(low, high), (radius, _)| {
                (radius.value.min(low), radius.value.max(high))
            })
        }
    };
    let smallest = size(least, axes);
    // Even the smallest bodies packed without a gap need this much.
    let fits = region / smallest;
    let (count, span) = match &block.amount {
        FillAmount::Count(count) => (f64::from(count.value), &count.span),
        FillAmount::VolumeFraction(fraction) => (fraction.value * fits, &fraction.span),
    };
    if count > fits {
        let message = format!(
            "{count} bodies of radius {least} m or more do not fit into a region of {region:e} m^{axes}"
        );
        builder.error_help(span.clone(), message, format!("there is room for less than {fits:.0}"));
        return None;
    }
    if count.is_nan() || count > MOST as f64 {
        builder
            .error(span.clone(), format!("a fill of up to {count:.1e} bodies; at most {MOST} are possible"));
        return None;
    }
    if !builder.affords(count, span) {
        return None;
    }
    if (0..axes).any(|axis| hi[axis] - lo[axis] < 2.0 * most) {
        builder.error(block.span.clone(), format!("the region is narrower than a body of radius {most} m"));
        return None;
    }
    let mut random = Random::new(builder.scene.seed, index, Purpose::Radii);
    let mut draw = || match &block.radius {
        RadiusChoice::Fixed(radius) => radius.value,
        RadiusChoice::Uniform { min, max } => random.between(min.value, max.value),
        RadiusChoice::Normal { mean, standard_deviation } => {
            mean.value + standard_deviation.value * random.normal()
        }
        RadiusChoice::Mixture(parts) => {
            let mut at = random.unit() * parts.iter().map(|(_, share)| share.value).sum::<f64>();
            let chosen = parts.iter().find(|(_, share)| {
                at -= share.value;
                at < 0.0
            });
            chosen.or(parts.last()).map_or(most, |(radius, _)| radius.value)
        }
    };
    let mut radii: Vec<f64> = match &block.amount {
        FillAmount::Count(count) => (0..count.value).map(|_| draw()).collect(),
        FillAmount::VolumeFraction(fraction) => {
            let target = fraction.value * region;
            let (mut radii, mut total) = (Vec::new(), 0.0);
            loop {
                let radius = draw();
                let next = total + size(radius, axes);
                // The last body is taken if it brings the total nearer to the target.
                if next - target > target - total || radii.len() > MOST {
                    break radii;
                }
                radii.push(radius);
                total = next;
            }
        }
    };
    if radii.is_empty() {
        builder.error(span.clone(), "less than half a body would fill this share of the region");
        return None;
    }
    radii.sort_by(|a, b| b.total_cmp(a));
    Some(radii)
}

/// Where centres may be.
struct Region {
    lo: [f64; 3],
    hi: [f64; 3],
    axes: usize,
    /// The region spans the whole period.
    spans: [bool; 3],
}

impl Region {
    fn new(lo: [f64; 3], hi: [f64; 3], axes: usize, cell: &Cell) -> Self {
        let (periodic, period) = (cell.periodic(), cell.period());
        let spans =
            std::array::from_fn(|axis| periodic[axis] && hi[axis] - lo[axis] >= period[axis] * (1.0 - 1e-9));
        Self { lo, hi, axes, spans }
    }

    fn size(&self) -> f64 {
        (0..self.axes).map(|axis| self.hi[axis] - self.lo[axis]).product()
    }

    fn draw(&self, random: &mut Random, radius: f64) -> [f64; 3] {
        let mut position = [0.0; 3];
        for axis in 0..self.axes {
            let inset = if self.spans[axis] { 0.0 } else { radius };
            position[axis] = random.between(self.lo[axis] + inset, self.hi[axis] - inset);
        }
        position
    }
}

/// Why no more places are tried.
enum End {
    /// All bodies have one, or the last one found none in [`TRIALS`].
    Trials,
    /// So many comparisons are enough.
    Looks(u64),
}

fn place(
    seed: u64,
    index: usize,
    radii: &[f64],
    region: &Region,
    cell: &Cell,
    walls: &[WallPlan],
    before: &[Draft],
) -> (Vec<([f64; 3], f64)>, End, u64) {
    let surfaces: Vec<Surface> = walls.iter().map(|wall| wall.wall.surface_at(0.0)).collect();
    let largest =
        radii.iter().chain(before.iter().map(|draft| &draft.radius)).fold(0.0, |a: f64, b| a.max(*b));
    let mut taken = Occupancy::new(cell, region.lo, region.hi, largest);
    for draft in before {
        taken.insert(cell.wrap(draft.position).0, draft.radius);
    }
    let most = LOOKS + LOOKS_A_BODY * radii.len() as u64;
    let mut looks = 0u64;
    let mut random = Random::new(seed, index, Purpose::Places);
    let mut placed = Vec::with_capacity(radii.len());
    for radius in radii {
        let mut place = None;
        for _ in 0..TRIALS {
            if looks > most {
                break;
            }
            let position = region.draw(&mut random, *radius);
            let at = Vector3::from(position);
            let clear = surfaces.iter().all(|surface| {
                looks += 1;
                surface.contact(at).distance >= *radius
            });
            if clear && taken.free(position, *radius, &mut looks) {
                place = Some(position);
                break;
            }
        }
        let Some(position) = place else { break };
        taken.insert(position, *radius);
        placed.push((position, *radius));
    }
    let end = if looks > most { End::Looks(most) } else { End::Trials };
    (placed, end, looks)
}

#[cfg(test)]
mod tests {
    use granule_geometry::{Motion, Plane, Wall};

    use super::*;

    fn cube(radii: &[f64], edge: f64, walls: &[WallPlan]) -> (usize, End, u64) {
        let cell = Cell::unbounded();
        let region = Region::new([0.0; 3], [edge; 3], 3, &cell);
        let (placed, end, looks) = place(1, 0, radii, &region, &cell, walls, &[]);
        (placed.len(), end, looks)
    }

    #[test]
    fn what_succeeds_stays_far_below_the_bound() {
        // Centres fill 9^3 of 10^3: 560 spheres are 0.367 of the region, 0.40 of the room of centres, where random
        // addition without end reaches 0.38 far from walls.
        let (placed, end, looks) = cube(&[0.5; 560], 10.0, &[]);
        assert!(placed == 560 && matches!(end, End::Trials));
        assert!(looks < (LOOKS + 560 * LOOKS_A_BODY) / 50, "{looks}");
    }

    #[test]
    fn a_fill_among_many_walls_ends() {
        // All centres are behind the last of the walls: 20000 trials of 20000 comparisons, were they not bounded.
        let wall = |height: f64| {
            let plane = Plane::new([0.0, 0.0, height].into(), [0.0, 0.0, 1.0].into()).unwrap();
            WallPlan { name: "w".into(), wall: Wall::new(plane, Motion::fixed()), material: 0 }
        };
        let mut walls: Vec<WallPlan> = (0..20_000).map(|_| wall(-10.0)).collect();
        walls.push(wall(20.0));
        let (placed, end, looks) = cube(&[0.5; 10], 10.0, &walls);
        let most = LOOKS + 10 * LOOKS_A_BODY;
        assert!(placed == 0 && matches!(end, End::Looks(bound) if bound == most));
        assert!(looks < most + 30_000, "{looks}");
    }

    #[test]
    fn a_wide_ratio_of_sizes_costs_no_more_than_one_size() {
        let mut radii = vec![2.0];
        radii.extend([0.02; 4000]);
        let (placed, _, looks) = cube(&radii, 10.0, &[]);
        assert_eq!(placed, 4001);
        assert!(looks < 4000 * 100, "{looks}");
    }
}
