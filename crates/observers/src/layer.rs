//! Many bodies in a layer or a volume at one moment, as pure functions: how far from random they lie, which of them hang
//! together, how hot each kind is, and whether the kinds have parted.

mod clusters;
mod correlation;
mod impacts;
mod outputs;
mod segregation;

pub use clusters::{Clusters, clusters};
pub use correlation::{CorrelationBin, pair_correlation};
pub use impacts::{ImpactBin, ImpactMeter, Touch};
pub use outputs::{ImpactTable, LayerSeries, PairCorrelation};
pub use segregation::segregation_index;

use std::collections::BTreeMap;

use granule_drivers::View;
use granule_geometry::{Cell, NeighbourGrid};
use granule_plan::Dimensions;

/// Bodies at one moment, as far as these functions look at them. Frozen bodies are part of the boundary and left out.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Centre inside the cell and radius \[m\], in the order of identities. In a plane layer z is 0.
    pub rows: Vec<[f64; 4]>,
    /// Velocity \[m/s\].
    pub velocity: Vec<[f64; 3]>,
    /// Kind of the body: its material.
    pub kind: Vec<u16>,
    /// The cell.
    pub cell: Cell,
    /// The bodies lie in a plane: on a substrate, or in two dimensions. Distances are then those in the plane.
    pub plane: bool,
}

impl Layer {
    /// The layer of a view.
    pub fn of(view: &View<'_>) -> Self {
        let (plan, bodies) = (view.plan(), view.bodies());
        let plane = plan.dimensions == Dimensions::Two || plan.substrate.is_some();
        let mut layer =
            Self { rows: Vec::new(), velocity: Vec::new(), kind: Vec::new(), cell: plan.cell, plane };
        for (rank, &place) in view.order().iter().enumerate() {
            let place = place as usize;
            if bodies.is_frozen(place) {
                continue;
            }
            let [x, y, z] = view.position(rank);
            layer.rows.push([x, y, if plane { 0.0 } else { z }, bodies.position[place][3]]);
            layer.velocity.push(bodies.velocity_of(place));
            layer.kind.push(bodies.material[place]);
        }
        layer
    }

    /// Number of dimensions in which the bodies move about: 2 in a plane layer.
    pub fn dimensions(&self) -> usize {
        if self.plane { 2 } else { 3 }
    }

    /// Sides of the region that the centres fill \[m\], and whether it goes on periodically. Where it does not, it is the
    /// extent of the centres times (N + 1)/(N - 1), which for bodies at random is unbiased.
    pub fn region(&self) -> ([f64; 3], [bool; 3]) {
        let (periodic, period) = (self.cell.periodic(), self.cell.period());
        let count = self.rows.len() as f64;
        let wider = if count > 1.0 { (count + 1.0) / (count - 1.0) } else { 1.0 };
        let side = |axis: usize| {
            if periodic[axis] {
                return period[axis];
            }
            let low = self.rows.iter().map(|row| row[axis]).fold(f64::INFINITY, f64::min);
            let high = self.rows.iter().map(|row| row[axis]).fold(f64::NEG_INFINITY, f64::max);
            (high - low).max(0.0) * wider
        };
        (std::array::from_fn(side), periodic)
    }

    /// Share of the region that the bodies cover (plane) or fill; 0 without bodies. The region is that of the centres,
    /// widened by the mean radius on each side that is not periodic.
    pub fn density(&self) -> f64 {
        if self.rows.is_empty() {
            return 0.0;
        }
        let (sides, periodic) = self.region();
        let mean = self.rows.iter().map(|row| row[3]).sum::<f64>() / self.rows.len() as f64;
        let measure: f64 = (0..self.dimensions())
            .map(|axis| if periodic[axis] { sides[axis] } else { sides[axis] + 2.0 * mean })
            .product();
        let pi = std::f64::consts::PI;
        let own = |r: f64| if self.plane { pi * r * r } else { 4.0 / 3.0 * pi * r * r * r };
        self.rows.iter().map(|row| own(row[3])).sum::<f64>() / measure
    }

    /// Granular temperature of the bodies of a kind, or of all: `T = <(v - <v>)²>/D` \[m²/s²\], with the mean velocity of the
    /// same bodies. Spins do not count, nor in a plane layer velocities across it. 0 without such bodies.
    pub fn granular_temperature(&self, kind: Option<u16>) -> f64 {
        let dimensions = self.dimensions();
        let chosen = |k: &usize| kind.is_none_or(|kind| self.kind[*k] == kind);
        let count = (0..self.rows.len()).filter(chosen).count() as f64;
        if count == 0.0 {
            return 0.0;
        }
        let mean: [f64; 3] = std::array::from_fn(|axis| {
            (0..self.rows.len()).filter(chosen).map(|k| self.velocity[k][axis]).sum::<f64>() / count
        });
        let square = |k: usize| -> f64 {
            (0..dimensions).map(|axis| (self.velocity[k][axis] - mean[axis]).powi(2)).sum()
        };
        (0..self.rows.len()).filter(chosen).map(square).sum::<f64>() / (count * dimensions as f64)
    }

    /// Kinds of bodies that exist, ascending, with their numbers.
    pub fn kinds(&self) -> BTreeMap<u16, usize> {
        let mut kinds = BTreeMap::new();
        for kind in &self.kind {
            *kinds.entry(*kind).or_insert(0) += 1;
        }
        kinds
    }

    /// Pairs of bodies whose surfaces are nearer than `gap` \[m\], each once, in ascending order.
    pub fn near(&self, gap: f64) -> Vec<(usize, usize)> {
        pairs(&self.rows, &self.cell, gap)
    }

    /// Distance of two bodies through their nearest images \[m\].
    pub fn distance(&self, i: usize, j: usize) -> f64 {
        let period = self.cell.period();
        let square = |axis: usize| {
            let d = self.rows[i][axis] - self.rows[j][axis];
            let image = if period[axis] > 0.0 { d - (d / period[axis]).round() * period[axis] } else { d };
            image * image
        };
        (square(0) + square(1) + square(2)).sqrt()
    }
}

/// Pairs nearer than the sum of their radii and `margin`.
fn pairs(rows: &[[f64; 4]], cell: &Cell, margin: f64) -> Vec<(usize, usize)> {
    let (mut start, mut partner, mut image) = (Vec::new(), Vec::new(), Vec::new());
    NeighbourGrid::new().half_pairs(rows, cell, margin, &mut start, &mut partner, &mut image);
    let range = |i: usize| start[i] as usize..start[i + 1] as usize;
    (0..rows.len()).flat_map(|i| partner[range(i)].iter().map(move |j| (i, *j as usize))).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Points at random in the box, always the same (SplitMix64).
    pub fn sequence(count: usize, sides: [f64; 3]) -> Vec<[f64; 3]> {
        let mut state = 0_u64;
        let mut next = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..count).map(|_| sides.map(|side| side * next())).collect()
    }

    pub fn layer(points: &[[f64; 3]], radius: f64, cell: Cell, plane: bool) -> Layer {
        Layer {
            rows: points.iter().map(|p| [p[0], p[1], if plane { 0.0 } else { p[2] }, radius]).collect(),
            velocity: vec![[0.0; 3]; points.len()],
            kind: vec![0; points.len()],
            cell,
            plane,
        }
    }

    #[test]
    fn temperature_of_each_kind_is_about_its_own_mean() {
        let points = sequence(6, [1.0; 3]);
        let mut layer = layer(&points, 0.01, Cell::unbounded(), true);
        layer.kind = vec![0, 0, 0, 0, 3, 3];
        // Kind 0 moves with (1, 2) and is scattered by 1 along x and by 2 along y; z does not count.
        layer.velocity = vec![
            [2.0, 2.0, 9.0],
            [0.0, 2.0, 0.0],
            [1.0, 4.0, 0.0],
            [1.0, 0.0, 0.0],
            [5.0, 5.0, 0.0],
            [5.0, 5.0, 1.0],
        ];
        assert_eq!(layer.granular_temperature(Some(0)), (2.0 + 8.0) / (4.0 * 2.0));
        assert_eq!(layer.granular_temperature(Some(3)), 0.0);
        assert_eq!(layer.granular_temperature(Some(7)), 0.0);
        // All: mean (14/6, 18/6).
        let x = [2.0, 0.0, 1.0, 1.0, 5.0, 5.0].map(|v: f64| (v - 14.0 / 6.0).powi(2)).iter().sum::<f64>();
        let y = [2.0, 2.0, 4.0, 0.0, 5.0, 5.0].map(|v: f64| (v - 3.0).powi(2)).iter().sum::<f64>();
        assert!((layer.granular_temperature(None) - (x + y) / 12.0).abs() < 1e-14);
        layer.plane = false;
        assert!(layer.granular_temperature(Some(3)) > 0.0);
        assert_eq!(layer.kinds(), BTreeMap::from([(0, 4), (3, 2)]));
    }

    #[test]
    fn density_is_covered_over_all() {
        // Four discs of radius 1 on a square of 4 by 4: the square of side 2 on which the centres lie is widened by
        // (N + 1)/(N - 1).
        let points = [[1.0, 1.0, 0.0], [3.0, 1.0, 0.0], [1.0, 3.0, 0.0], [3.0, 3.0, 0.0]];
        let open = layer(&points, 1.0, Cell::unbounded(), true);
        let side = 2.0 * 5.0 / 3.0 + 2.0;
        assert!((open.density() - 4.0 * std::f64::consts::PI / (side * side)).abs() < 1e-14);
        let cell = Cell::new([0.0; 3], [4.0; 3], [true; 3]).unwrap();
        let closed = layer(&points, 1.0, cell, true);
        assert!((closed.density() - std::f64::consts::PI / 4.0).abs() < 1e-14);
        assert_eq!(layer(&[], 1.0, cell, true).density(), 0.0);
    }

    #[test]
    fn near_pairs_are_those_of_brute_force() {
        let cell = Cell::new([0.0; 3], [1.0; 3], [true, false, false]).unwrap();
        let layer = layer(&sequence(300, [1.0, 1.0, 0.0]), 0.02, cell, true);
        let mut expected = Vec::new();
        for i in 0..300 {
            for j in i + 1..300 {
                if layer.distance(i, j) < 0.04 + 0.03 {
                    expected.push((i, j));
                }
            }
        }
        assert!(expected.len() > 100);
        assert_eq!(layer.near(0.03), expected);
    }
}
