//! Which pairs of a list touched, and where the law had cut the force to zero: one bit a pair.

/// Bits of one evaluation.
#[derive(Clone, Debug, Default)]
struct Bits(Vec<u64>);

impl Bits {
    fn clear(&mut self, pairs: usize) {
        self.0.clear();
        self.0.resize(pairs.div_ceil(64), 0);
    }

    #[inline(always)]
    fn set(&mut self, pair: u32) {
        self.0[(pair >> 6) as usize] |= 1 << (pair & 63);
    }

    #[inline(always)]
    fn has(&self, pair: u32) -> bool {
        self.0[(pair >> 6) as usize] >> (pair & 63) & 1 == 1
    }
}

/// Bits of this evaluation and of the one before it, from which it follows that nothing has to be resolved in all but a
/// few contacts, without a look at their motion.
#[derive(Clone, Debug, Default)]
pub(crate) struct Marks {
    touching: [Bits; 2],
    clipped: [Bits; 2],
    /// The bits of the evaluation before are those of this list.
    known: bool,
    /// The list has been made anew since the last evaluation.
    renewed: bool,
}

impl Marks {
    /// The list is another one.
    pub fn forget(&mut self) {
        self.renewed = true;
    }

    /// Makes room for `pairs` pairs.
    pub fn reserve(&mut self, pairs: usize) {
        for bits in self.touching.iter_mut().chain(&mut self.clipped) {
            bits.0.reserve(pairs.div_ceil(64).saturating_sub(bits.0.len()));
        }
    }

    /// Begins an evaluation of a list of `pairs` pairs.
    pub fn begin(&mut self, pairs: usize) {
        for bits in [&mut self.touching, &mut self.clipped] {
            bits.swap(0, 1);
            bits[0].clear(pairs);
        }
        self.known = !self.renewed;
        self.renewed = false;
    }

    /// Notes that a pair touches.
    #[inline(always)]
    pub fn touches(&mut self, pair: u32) {
        self.touching[0].set(pair);
    }

    /// Notes that the law has cut the force of a pair to zero.
    #[inline(always)]
    pub fn is_clipped(&mut self, pair: u32) {
        self.clipped[0].set(pair);
    }

    /// Whether the pair touched in the evaluation before, if that is known.
    #[inline(always)]
    pub fn touched(&self, pair: u32) -> Option<bool> {
        self.known.then(|| self.touching[1].has(pair))
    }

    /// True if the force of the pair is known to have been cut to zero in the evaluation before.
    #[inline(always)]
    pub fn was_clipped(&self, pair: u32) -> bool {
        self.known && self.clipped[1].has(pair)
    }

    /// Heap bytes.
    pub fn bytes(&self) -> usize {
        self.touching.iter().chain(&self.clipped).map(|bits| bits.0.capacity() * 8).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_those_of_the_evaluation_before() {
        let mut marks = Marks::default();
        marks.forget();
        marks.begin(100);
        assert_eq!(marks.touched(70), None);
        marks.touches(70);
        marks.is_clipped(64);
        marks.begin(100);
        assert_eq!((marks.touched(70), marks.touched(71)), (Some(true), Some(false)));
        assert!(marks.was_clipped(64) && !marks.was_clipped(70));
        marks.forget();
        marks.begin(3);
        assert_eq!(marks.touched(1), None);
        assert!(!marks.was_clipped(1));
    }
}
