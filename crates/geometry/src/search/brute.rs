//! The oracle of the neighbour search: every pair is looked at.

use super::Images;
use crate::Cell;

/// The half list of [`crate::NeighbourGrid::half_pairs`], found by looking at every pair.
///
/// Slow (N^2/2) and plain on purpose: tests compare the grid with it.
///
/// # Panics
/// When there are 2^32 pairs or more.
pub fn brute_force_pairs(
    position_radius: &[[f64; 4]],
    cell: &Cell,
    margin: f64,
    start: &mut Vec<u32>,
    partner: &mut Vec<u32>,
    image: &mut Vec<u8>,
) {
    start.clear();
    partner.clear();
    image.clear();
    start.push(0);
    let images = Images::new(cell);
    for (i, a) in position_radius.iter().enumerate() {
        for (j, b) in position_radius.iter().enumerate().skip(i + 1) {
            let (squared, code) = images.nearest(a, b);
            let reach = a[3] + b[3] + margin;
            if squared < reach * reach && reach > 0.0 {
                partner.push(j as u32);
                image.push(code);
            }
        }
        start.push(u32::try_from(partner.len()).expect("fewer than 2^32 pairs"));
    }
}
