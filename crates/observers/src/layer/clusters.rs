//! Which bodies hang together.

use super::Layer;

/// Sizes of clusters: sets of bodies that are connected by gaps below a distance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clusters {
    /// Number of bodies of each, the largest first; a body alone is a cluster of 1.
    pub sizes: Vec<usize>,
}

impl Clusters {
    /// Bodies in the largest cluster; 0 without bodies.
    pub fn largest(&self) -> usize {
        self.sizes.first().copied().unwrap_or(0)
    }

    /// Number of bodies in the cluster of a body, mean over the bodies, Σ s²/Σ s; 0 without bodies.
    pub fn mean_size(&self) -> f64 {
        let bodies: usize = self.sizes.iter().sum();
        let squares: f64 = self.sizes.iter().map(|size| (size * size) as f64).sum();
        if bodies == 0 { 0.0 } else { squares / bodies as f64 }
    }
}

/// Clusters of bodies whose surfaces are nearer than `gap` \[m\]; a gap of 0 asks for contact.
pub fn clusters(layer: &Layer, gap: f64) -> Clusters {
    let mut parent: Vec<usize> = (0..layer.rows.len()).collect();
    for (i, j) in layer.near(gap) {
        let (a, b) = (root(&mut parent, i), root(&mut parent, j));
        parent[a.max(b)] = a.min(b);
    }
    let mut size = vec![0; parent.len()];
    for k in 0..parent.len() {
        size[root(&mut parent, k)] += 1;
    }
    size.retain(|size| *size > 0);
    size.sort_unstable_by(|a, b| b.cmp(a));
    Clusters { sizes: size }
}

/// The least member known of the set of a body; halves the way to it.
fn root(parent: &mut [usize], mut body: usize) -> usize {
    while parent[body] != body {
        parent[body] = parent[parent[body]];
        body = parent[body];
    }
    body
}

#[cfg(test)]
mod tests {
    use granule_geometry::Cell;

    use super::super::tests::{layer, sequence};
    use super::*;

    #[test]
    fn a_chain_a_pair_and_one_alone() {
        // Gaps of 0.1 along a chain of three, a pair through the periodic boundary, and one alone.
        let x = [2.0, 4.1, 6.2, 0.4, 19.5, 11.0];
        let points: Vec<[f64; 3]> = x.iter().map(|x| [*x, 0.0, 0.0]).collect();
        let cell = Cell::new([0.0, -1.0, -1.0], [21.0, 1.0, 1.0], [true, false, false]).unwrap();
        let layer = layer(&points, 1.0, cell, true);
        assert_eq!(clusters(&layer, 0.11).sizes, [5, 1]);
        assert_eq!(clusters(&layer, 0.05).sizes, [3, 1, 1, 1]);
        assert_eq!(clusters(&layer, 0.0).largest(), 3);
        assert_eq!(clusters(&layer, 0.05).mean_size(), (9.0 + 3.0) / 6.0);
        assert_eq!(Clusters::default().mean_size(), 0.0);
    }

    #[test]
    fn clusters_are_those_of_a_flood_fill() {
        let layer = layer(&sequence(400, [1.0, 1.0, 0.0]), 0.01, Cell::unbounded(), true);
        for gap in [0.0, 0.01, 0.02, 0.04] {
            let mut seen = vec![false; 400];
            let mut sizes = Vec::new();
            for start in 0..400 {
                if seen[start] {
                    continue;
                }
                seen[start] = true;
                let (mut open, mut size) = (vec![start], 0);
                while let Some(i) = open.pop() {
                    size += 1;
                    for j in 0..400 {
                        if !seen[j] && layer.distance(i, j) < 0.02 + gap {
                            seen[j] = true;
                            open.push(j);
                        }
                    }
                }
                sizes.push(size);
            }
            sizes.sort_unstable_by(|a: &usize, b| b.cmp(a));
            assert_eq!(clusters(&layer, gap).sizes, sizes);
        }
    }
}
