//! Which bodies are near each other.

mod bins;
mod brute;
mod cells;
mod curve;
mod grid;
mod near;
mod order;
mod pairs;
mod sizes;
#[cfg(test)]
mod tests;

pub use brute::brute_force_pairs;
pub use grid::NeighbourGrid;
pub use order::BodyOrder;
pub use pairs::PairScratch;

use crate::{Cell, IMAGE_CODES, image_shift};

/// Periods and their inverses, 0 where a direction is not periodic.
#[derive(Clone, Copy, Debug, Default)]
struct Images {
    period: [f64; 3],
    inverse: [f64; 3],
}

impl Images {
    fn new(cell: &Cell) -> Self {
        let period = cell.period();
        Self { period, inverse: period.map(|length| if length > 0.0 { 1.0 / length } else { 0.0 }) }
    }

    /// The shift s*L of every image code.
    fn shifts(&self) -> [[f64; 3]; IMAGE_CODES] {
        std::array::from_fn(|code| {
            let shift = image_shift(code as u8);
            std::array::from_fn(|axis| f64::from(shift[axis]) * self.period[axis])
        })
    }

    /// Squared distance of the nearest image, and its code. Both searches use this one expression, so that their
    /// lists agree to the last pair.
    fn nearest(&self, a: &[f64; 4], b: &[f64; 4]) -> (f64, u8) {
        let (mut squared, mut code, mut weight) = (0.0, 0, 1);
        for axis in 0..3 {
            let d = a[axis] - b[axis];
            let s = (d * self.inverse[axis]).round().max(-1.0).min(1.0);
            let image = d - s * self.period[axis];
            squared += image * image;
            code += weight * (s + 1.0) as u8;
            weight *= 3;
        }
        (squared, code)
    }
}
