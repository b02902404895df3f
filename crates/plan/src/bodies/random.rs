//! Random numbers of the initial state: ChaCha, one stream per block and purpose, the same bits everywhere.

use rand::Rng;
use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;

use crate::build::Builder;
use crate::model::Dimensions;

/// What a stream is for.
#[derive(Clone, Copy, Debug)]
pub enum Purpose {
    /// Radii of a fill.
    Radii,
    /// Places.
    Places,
    /// Velocities.
    Velocities,
}

/// Axes along which bodies are displaced and sped up at random: all of space, but those of a surface that they never leave.
pub fn axes(builder: &Builder<'_>) -> usize {
    let confined = builder.scene.substrate.as_ref().is_some_and(|substrate| substrate.confined);
    if builder.dimensions == Dimensions::Two || confined { 2 } else { 3 }
}

/// A stream of random numbers.
pub struct Random(ChaCha12Rng);

impl Random {
    /// The stream of a block of bodies for a purpose.
    pub fn new(seed: u64, block: usize, purpose: Purpose) -> Self {
        let mut generator = ChaCha12Rng::seed_from_u64(seed);
        let lane = match purpose {
            Purpose::Radii => 0,
            Purpose::Places => 1,
            Purpose::Velocities => 2,
        };
        generator.set_stream(4 * block as u64 + lane);
        Self(generator)
    }

    /// Evenly distributed in [0, 1), a multiple of 2^-53.
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Evenly distributed between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Standard normal distribution cut at ±3, by rejection. `libm` has the same bits on every platform.
    pub fn normal(&mut self) -> f64 {
        loop {
            let x = self.between(-3.0, 3.0);
            if self.unit() < libm::exp(-0.5 * x * x) {
                return x;
            }
        }
    }

    /// Adds an even spread to each of the first `axes` components.
    pub fn spread(&mut self, vector: &mut [f64; 3], spread: f64, axes: usize) {
        if spread > 0.0 {
            for component in &mut vector[..axes] {
                *component += self.between(-spread, spread);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_differ_and_repeat() {
        let draw = |block, purpose| {
            let mut random = Random::new(7, block, purpose);
            [random.unit(), random.unit()]
        };
        assert_eq!(draw(0, Purpose::Radii), draw(0, Purpose::Radii));
        assert_ne!(draw(0, Purpose::Radii), draw(0, Purpose::Places));
        assert_ne!(draw(0, Purpose::Radii), draw(1, Purpose::Radii));
    }

    #[test]
    fn moments_of_the_cut_normal_distribution() {
        let mut random = Random::new(1, 0, Purpose::Radii);
        let count = 200_000;
        let draws: Vec<f64> = (0..count).map(|_| random.normal()).collect();
        let mean = draws.iter().sum::<f64>() / f64::from(count);
        let variance = draws.iter().map(|x| x * x).sum::<f64>() / f64::from(count);
        // Cut at 3: variance 1 - 2*3*phi(3)/(2*Phi(3)-1) = 0.97334; five standard errors of 200000 draws.
        assert!(mean.abs() < 5.0 * (0.97334f64 / f64::from(count)).sqrt(), "{mean}");
        assert!((variance - 0.97334).abs() < 5.0 * (2.0 / f64::from(count)).sqrt(), "{variance}");
    }
}
