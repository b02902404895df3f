//! Pair correlation.

use super::{Layer, pairs};

/// One interval of distances of a pair correlation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrelationBin {
    /// Middle of the interval \[m\].
    pub distance: f64,
    /// g(r) of all pairs: 1 where bodies lie at random.
    pub all: f64,
    /// g(r) of pairs of one kind; 0 without such pairs.
    pub like: f64,
    /// g(r) of pairs of different kinds; 0 without such pairs.
    pub unlike: f64,
}

/// The pair correlation up to `range` \[m\] in `bins` intervals: pairs at that distance over those that the same number of
/// points would have at random in the same [region](Layer::region).
///
/// The pairs at random are exact for a rectangle or box with edges, by its set covariance averaged over directions; in a
/// plane 1 - 2r/π (1/a + 1/b) + r²/(π a b). That holds up to the shortest side, in periodic directions up to half of it:
/// intervals beyond are left out.
pub fn pair_correlation(layer: &Layer, range: f64, bins: usize) -> Vec<CorrelationBin> {
    let count = layer.rows.len();
    let (sides, periodic) = layer.region();
    let axes = layer.dimensions();
    let reach = (0..axes)
        .map(|axis| if periodic[axis] { 0.5 * sides[axis] } else { sides[axis] })
        .fold(f64::INFINITY, f64::min);
    let usable = range > 0.0 && range.is_finite() && reach > 0.0 && count > 1;
    if !usable {
        return Vec::new();
    }
    let width = range / bins as f64;
    // Rounding must not take the last interval of a range that is the reach.
    let bins = (0..bins).take_while(|bin| (bin + 1) as f64 * width <= reach * (1.0 + 1e-12)).count();
    let mut found = vec![[0_u64; 2]; bins];
    // Points: distances of centres count, not of surfaces.
    let points: Vec<[f64; 4]> = layer.rows.iter().map(|row| [row[0], row[1], row[2], 0.0]).collect();
    for (i, j) in pairs(&points, &layer.cell, bins as f64 * width) {
        let bin = (layer.distance(i, j) / width) as usize;
        if let Some(found) = found.get_mut(bin) {
            found[usize::from(layer.kind[i] != layer.kind[j])] += 1;
        }
    }
    let half = |n: usize| 0.5 * n as f64 * (n as f64 - 1.0);
    let all = half(count);
    let like: f64 = layer.kinds().values().map(|n| half(*n)).sum();
    let inverse: [f64; 3] =
        std::array::from_fn(|axis| if axis < axes && !periodic[axis] { 1.0 / sides[axis] } else { 0.0 });
    let measure: f64 = sides[..axes].iter().product();
    let ratio = |found: u64, pairs: f64, share: f64| {
        let expected = pairs * share;
        if expected > 0.0 { found as f64 / expected } else { 0.0 }
    };
    found
        .iter()
        .enumerate()
        .map(|(bin, [same, other])| {
            let (low, high) = (bin as f64 * width, (bin + 1) as f64 * width);
            let share = shell(layer.plane, low, high, inverse) / measure;
            CorrelationBin {
                distance: 0.5 * (low + high),
                all: ratio(same + other, all, share),
                like: ratio(*same, like, share),
                unlike: ratio(*other, all - like, share),
            }
        })
        .collect()
}

/// Integral of the ring or shell between two radii times the set covariance of the region. `inverse` holds the inverse sides
/// that have edges.
fn shell(plane: bool, low: f64, high: f64, inverse: [f64; 3]) -> f64 {
    let pi = std::f64::consts::PI;
    let power = |n: i32| high.powi(n) - low.powi(n);
    let [a, b, c] = inverse;
    if plane {
        return pi * power(2) - 4.0 / 3.0 * (a + b) * power(3) + 0.5 * a * b * power(4);
    }
    let (one, two, three) = (a + b + c, a * b + b * c + c * a, a * b * c);
    4.0 / 3.0 * pi * power(3) - 0.5 * pi * one * power(4) + 8.0 / 15.0 * two * power(5)
        - three / 6.0 * power(6)
}

#[cfg(test)]
mod tests {
    use granule_geometry::Cell;

    use super::super::tests::{layer, sequence};
    use super::*;

    #[test]
    fn points_at_random_have_a_correlation_of_one_right_to_the_edges() {
        for (plane, periodic) in [(true, [false; 3]), (true, [true, false, true]), (false, [false; 3])] {
            let sides = [1.0, 0.7, 0.8];
            let cell = Cell::new([0.0; 3], sides, periodic).unwrap();
            let layer = layer(&sequence(3000, sides), 1e-3, cell, plane);
            let reach = if periodic[0] { 0.5 } else { 0.7 };
            let bins = pair_correlation(&layer, reach * 0.999, 10);
            assert_eq!(bins.len(), 10);
            for bin in &bins[1..] {
                // 5e4 and more pairs an interval; with the scatter of the extents 0.5 %.
                assert!((bin.all - 1.0).abs() < 0.02, "{plane} {periodic:?} {bin:?}");
                assert_eq!(bin.all, bin.like);
                assert_eq!(bin.unlike, 0.0);
            }
        }
    }

    #[test]
    fn all_pairs_are_counted_by_the_set_covariance() {
        // Integrated over all distances up to the shortest side the covariance of a square is the probability that two
        // random points are nearer than it: π - 8/3 + 1/2 (square line picking).
        let share = shell(true, 0.0, 1.0, [1.0, 1.0, 0.0]);
        assert!((share - (std::f64::consts::PI - 8.0 / 3.0 + 0.5)).abs() < 1e-14);
        // Cube: 4π/3 - 3π/2 + 8/5 - 1/6 (cube line picking).
        let share = shell(false, 0.0, 1.0, [1.0; 3]);
        let pi = std::f64::consts::PI;
        assert!((share - (4.0 / 3.0 * pi - 1.5 * pi + 1.6 - 1.0 / 6.0)).abs() < 1e-14);
    }

    #[test]
    fn a_periodic_lattice_has_its_neighbours_where_they_are() {
        // A triangular lattice, 20 by 10 cells of two points, spacing 1; kinds alternate along y.
        let height = 3.0_f64.sqrt();
        let mut points = Vec::new();
        for row in 0..10 {
            for column in 0..20 {
                points.push([f64::from(column), height * f64::from(row), 0.0]);
                points.push([f64::from(column) + 0.5, height * (f64::from(row) + 0.5), 0.0]);
            }
        }
        let cell = Cell::new([0.0; 3], [20.0, 10.0 * height, 1.0], [true, true, false]).unwrap();
        let mut layer = layer(&points, 0.4, cell, true);
        for k in 0..layer.kind.len() {
            layer.kind[k] = (k % 2) as u16;
        }
        // Intervals of 0.2 about 0.9, 1.1, ...: 6 neighbours at 1, of which 2 are like; 6 at √3 (2 like).
        let bins = pair_correlation(&layer, 2.1, 10);
        let area = 20.0 * 10.0 * height;
        let (low, high) = (4.0 * 0.21, 5.0 * 0.21);
        let ring = std::f64::consts::PI * (high * high - low * low) / area;
        let n = 400.0;
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * b, "{a} {b}");
        close(bins[4].all, 6.0 * n / 2.0 / (ring * n * (n - 1.0) / 2.0));
        close(bins[4].like, 2.0 * n / 2.0 / (ring * 2.0 * 200.0 * 199.0 / 2.0));
        close(bins[4].unlike, 4.0 * n / 2.0 / (ring * 200.0 * 200.0));
        assert!(bins[..4].iter().chain(&bins[5..8]).all(|bin| bin.all == 0.0));
        assert!(bins[8].all > 0.0);
    }

    #[test]
    fn nothing_is_told_beyond_the_shortest_side() {
        let layer = layer(&sequence(100, [1.0, 0.5, 0.0]), 1e-3, Cell::unbounded(), true);
        let bins = pair_correlation(&layer, 1.0, 10);
        assert!(bins.len() == 4 || bins.len() == 5, "{}", bins.len());
        assert!(pair_correlation(&layer, 0.0, 10).is_empty());
    }
}
