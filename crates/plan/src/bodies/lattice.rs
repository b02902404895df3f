//! Bodies on a lattice.

use granule_geometry::Cell;
use granule_scene::{LatticeBlock, LatticeKind};

use super::random::{Purpose, Random, axes};
use super::{Draft, MOST, common};
use crate::build::Builder;
use crate::model::Dimensions;

/// The bodies of one block.
pub fn bodies(
    builder: &mut Builder<'_>,
    block: &LatticeBlock,
    index: usize,
    cell: Option<&Cell>,
) -> Vec<Draft> {
    let common = common(
        builder,
        block.shape.as_ref(),
        &block.material,
        block.velocity.as_ref(),
        block.frozen,
        index,
        &block.span,
    );
    let (lo, hi) = (builder.vector(&block.lo, "lo"), builder.vector(&block.hi, "hi"));
    let planar = builder.dimensions == Dimensions::Two;
    let (misplaced, need) = match block.kind.value {
        LatticeKind::FaceCentred => (planar, "3"),
        LatticeKind::Hexagonal => (!planar, "2"),
        LatticeKind::Cubic => (false, ""),
    };
    if misplaced {
        builder.error_help(
            block.kind.span.clone(),
            format!("this lattice needs `dimensions: {need}`"),
            "`Cubic` exists in both; the densest packings are FaceCentred in 3 and Hexagonal in 2 dimensions",
        );
        return Vec::new();
    }
    let (Some(common), Some(lo), Some(hi)) = (common, lo, hi) else { return Vec::new() };
    if (0..3).any(|axis| lo[axis] > hi[axis]) {
        builder.error(block.hi.span.clone(), "`hi` must not be below `lo`");
        return Vec::new();
    }
    let moves = common.velocity != [0.0; 3]
        || block.velocity_spread.as_ref().is_some_and(|spread| spread.value > 0.0);
    if block.frozen && moves {
        builder.error(block.span.clone(), "frozen bodies have no velocity");
        return Vec::new();
    }
    let places = Places::new(block.kind.value, block.spacing.value, lo, hi, cell, planar);
    let estimate = places.estimate();
    if estimate > MOST as f64 {
        let message = format!("a lattice of about {estimate:.1e} bodies; at most {MOST} are possible");
        builder.error(block.spacing.span.clone(), message);
        return Vec::new();
    }
    if !builder.affords(estimate, &block.spacing.span) {
        return Vec::new();
    }
    let axes = axes(builder);
    let mut jitter = Random::new(builder.scene.seed, index, Purpose::Places);
    let mut thermal = Random::new(builder.scene.seed, index, Purpose::Velocities);
    let amount = |quantity: &Option<granule_scene::Spanned<f64>>| quantity.as_ref().map_or(0.0, |q| q.value);
    let points = places.all();
    if points.is_empty() {
        builder.error(block.span.clone(), "no point of the lattice lies in this region");
    }
    points
        .into_iter()
        .map(|mut position| {
            jitter.spread(&mut position, amount(&block.jitter), axes);
            let mut body = common.body(block.radius.value, position);
            thermal.spread(&mut body.velocity, amount(&block.velocity_spread), axes);
            body
        })
        .collect()
}

/// Points of a lattice in a box: a rectangular grid of unit cells with a few points each.
struct Places {
    lo: [f64; 3],
    hi: [f64; 3],
    /// Edges of the unit cell.
    edge: [f64; 3],
    /// Points of the unit cell as fractions of its edges.
    basis: &'static [[f64; 3]],
    /// The upper end is the image of the lower one.
    wraps: [bool; 3],
}

impl Places {
    fn new(
        kind: LatticeKind,
        spacing: f64,
        lo: [f64; 3],
        hi: [f64; 3],
        cell: Option<&Cell>,
        planar: bool,
    ) -> Self {
        let edge = match kind {
            LatticeKind::Cubic => [spacing; 3],
            LatticeKind::FaceCentred => [spacing * std::f64::consts::SQRT_2; 3],
            LatticeKind::Hexagonal => [spacing, spacing * 3f64.sqrt(), spacing],
        };
        let basis: &[[f64; 3]] = match kind {
            LatticeKind::Cubic => &[[0.0; 3]],
            LatticeKind::FaceCentred => &[[0.0; 3], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]],
            LatticeKind::Hexagonal => &[[0.0; 3], [0.5, 0.5, 0.0]],
        };
        let wraps = std::array::from_fn(|axis| {
            cell.is_some_and(|cell| {
                let length = cell.period()[axis];
                cell.periodic()[axis] && hi[axis] - lo[axis] >= length * (1.0 - 1e-9)
            }) && !(planar && axis == 2)
        });
        Self { lo, hi, edge, basis, wraps }
    }

    /// Number of unit cells along an axis.
    fn cells(&self, axis: usize) -> f64 {
        let extent = self.hi[axis] - self.lo[axis];
        // Round-off of the corners must not lose the last layer.
        (extent / self.edge[axis] * (1.0 + 1e-9) + 1e-9).floor() + 1.0
    }

    fn estimate(&self) -> f64 {
        (0..3).map(|axis| self.cells(axis)).product::<f64>() * self.basis.len() as f64
    }

    /// The points, those of a layer after those of the layer below.
    fn all(&self) -> Vec<[f64; 3]> {
        let [nx, ny, nz] = std::array::from_fn(|axis| self.cells(axis) as u64);
        let mut points = Vec::new();
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    for offset in self.basis {
                        let at = [x as f64 + offset[0], y as f64 + offset[1], z as f64 + offset[2]];
                        let point: [f64; 3] =
                            std::array::from_fn(|axis| self.lo[axis] + at[axis] * self.edge[axis]);
                        if (0..3).all(|axis| self.inside(axis, point[axis])) {
                            points.push(point);
                        }
                    }
                }
            }
        }
        points
    }

    fn inside(&self, axis: usize, x: f64) -> bool {
        let tolerance = 1e-9 * self.edge[axis];
        if self.wraps[axis] {
            // The nearest image of the first layer is one period up: keep half an edge away from it.
            let layers = if self.basis.len() > 1 { 0.5 } else { 1.0 };
            x <= self.hi[axis] - layers * self.edge[axis] + tolerance
        } else {
            x <= self.hi[axis] + tolerance
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_holds_both_ends() {
        let cubic = Places::new(LatticeKind::Cubic, 0.1, [0.0; 3], [0.3, 0.2, 0.0], None, false).all();
        assert_eq!(cubic.len(), 4 * 3);
        let nearest = |points: &[[f64; 3]]| {
            let mut least = f64::INFINITY;
            for (k, a) in points.iter().enumerate() {
                for b in &points[..k] {
                    least = least.min((0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt());
                }
            }
            least
        };
        for kind in [LatticeKind::FaceCentred, LatticeKind::Hexagonal] {
            let points = Places::new(kind, 0.1, [0.0; 3], [0.5, 0.5, 0.0], None, false).all();
            assert!((nearest(&points) - 0.1).abs() < 1e-15);
        }
    }

    #[test]
    fn a_periodic_direction_has_no_doubled_layer() {
        let cell = Cell::new([0.0; 3], [1.0; 3], [true, true, true]).unwrap();
        let cubic = Places::new(LatticeKind::Cubic, 0.1, [0.0; 3], [1.0; 3], Some(&cell), false).all();
        assert_eq!(cubic.len(), 1000);
        let spacing = 0.1 / std::f64::consts::SQRT_2;
        let dense =
            Places::new(LatticeKind::FaceCentred, spacing, [0.0; 3], [1.0; 3], Some(&cell), false).all();
        assert_eq!(dense.len(), 4000);
    }
}
