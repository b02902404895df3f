//! Whether kinds of bodies have parted.

use super::Layer;

/// Index of segregation: (p - p0)/(1 - p0), where p is the share of pairs of neighbours that are of one kind and p0 that share
/// among all pairs. 0 for kinds that are mixed at random, 1 where no two neighbours differ, below 0 where kinds avoid
/// themselves. Neighbours are bodies whose surfaces are nearer than `gap` \[m\]. 0 without neighbours or with one kind.
pub fn segregation_index(layer: &Layer, gap: f64) -> f64 {
    let near = layer.near(gap);
    let half = |n: usize| 0.5 * n as f64 * (n as f64 - 1.0);
    let all = half(layer.rows.len());
    let random = layer.kinds().values().map(|n| half(*n)).sum::<f64>() / all;
    if near.is_empty() || random >= 1.0 {
        return 0.0;
    }
    let like = near.iter().filter(|(i, j)| layer.kind[*i] == layer.kind[*j]).count();
    (like as f64 / near.len() as f64 - random) / (1.0 - random)
}

#[cfg(test)]
mod tests {
    use granule_geometry::Cell;

    use super::super::tests::{layer, sequence};
    use super::*;

    #[test]
    fn parted_mixed_and_alternating() {
        let mut points = Vec::new();
        for row in 0..20 {
            for column in 0..20 {
                points.push([f64::from(column), f64::from(row), 0.0]);
            }
        }
        let cell = Cell::new([0.0; 3], [20.0, 20.0, 1.0], [true, true, false]).unwrap();
        let mut layer = layer(&points, 0.45, cell, true);
        assert_eq!(segregation_index(&layer, 0.2), 0.0);
        // Halves: of 800 pairs of neighbours 40 lie across the two borders.
        layer.kind = (0..400).map(|k| u16::from(k >= 200)).collect();
        let random = 2.0 * 200.0 * 199.0 / (400.0 * 399.0);
        let expected = (760.0 / 800.0 - random) / (1.0 - random);
        assert!((segregation_index(&layer, 0.2) - expected).abs() < 1e-14);
        // A chess board: no neighbours alike.
        layer.kind = (0..400).map(|k| ((k + k / 20) % 2) as u16).collect();
        assert!((segregation_index(&layer, 0.2) + random / (1.0 - random)).abs() < 1e-14);
        // At random: the error of a share of 800 pairs is 0.02, over 1 - p0.
        layer.kind = sequence(400, [1.0; 3]).iter().map(|p| u16::from(p[0] < 0.5)).collect();
        assert!(segregation_index(&layer, 0.2).abs() < 0.12);
        assert_eq!(segregation_index(&layer, 0.01), 0.0);
    }
}
