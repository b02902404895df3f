//! Which pairs of a list touched, and where the law had cut the force to zero: one bit a pair.

/// Bits of this evaluation and of the one before it, from which it follows that nothing has to be resolved in all but a
/// few contacts, without a look at their motion. Touching pairs are kept as the force loop finds them: four pairs a byte, from
/// the first pair of a range on.
#[derive(Clone, Debug, Default)]
pub(crate) struct Marks {
    touching: [Vec<u8>; 2],
    clipped: [Vec<u64>; 2],
    /// The bits of the evaluation before are those of this list.
    known: bool,
    /// The list has been made anew since the last evaluation.
    renewed: bool,
}

/// Touching pairs of one range.
pub(crate) struct RangeMarks<'a> {
    /// Those of the evaluation before; `None` if the list is a new one.
    pub before: Option<&'a [u8]>,
    pub now: &'a mut [u8],
}

impl Marks {
    /// The list is another one.
    pub fn forget(&mut self) {
        self.renewed = true;
    }

    /// Makes room for a list of `pairs` pairs.
    pub fn reserve(&mut self, pairs: usize) {
        for bytes in &mut self.touching {
            bytes.reserve((pairs / 4 + RANGES).saturating_sub(bytes.len()));
        }
        for bits in &mut self.clipped {
            bits.reserve(pairs.div_ceil(64).saturating_sub(bits.len()));
        }
    }

    /// Begins an evaluation of a list of `pairs` pairs in `ranges` ranges.
    pub fn begin(&mut self, pairs: usize, ranges: usize) {
        self.touching.swap(0, 1);
        self.touching[0].resize(length(pairs, ranges), 0);
        self.clipped.swap(0, 1);
        self.clipped[0].clear();
        self.clipped[0].resize(pairs.div_ceil(64), 0);
        self.known = !self.renewed;
        self.renewed = false;
    }

    /// The bytes of the range number `range`, which has the pairs from `start` on: they begin behind those of the ranges before.
    pub fn of_range(&mut self, range: usize, start: usize) -> RangeMarks<'_> {
        let [now, before] = &mut self.touching;
        let first = start / 4 + range;
        RangeMarks { before: self.known.then(|| &before[first..]), now: &mut now[first..] }
    }

    /// Notes that the law has cut the force of a pair to zero.
    #[inline(always)]
    pub fn clip(&mut self, pair: u32) {
        self.clipped[0][(pair >> 6) as usize] |= 1 << (pair & 63);
    }

    /// True if the force of the pair is known to have been cut to zero in the evaluation before.
    #[inline(always)]
    pub fn was_clipped(&self, pair: u32) -> bool {
        self.known && self.clipped[1][(pair >> 6) as usize] >> (pair & 63) & 1 == 1
    }

    /// The bits of the last evaluation: touching pairs, and those whose force was cut.
    pub fn last(&self) -> (&[u8], &[u64]) {
        (&self.touching[0], &self.clipped[0])
    }

    /// Takes over the bits of the last evaluation, of a list of `pairs` pairs in `ranges` ranges; false if they are not as
    /// many as that.
    pub fn restore(&mut self, pairs: usize, ranges: usize, touching: &[u8], clipped: &[u64]) -> bool {
        if touching.len() != length(pairs, ranges) || clipped.len() != pairs.div_ceil(64) {
            return false;
        }
        // Four pairs a byte, whatever a file says.
        self.touching[0] = touching.iter().map(|byte| byte & 15).collect();
        self.clipped[0] = clipped.to_vec();
        self.renewed = false;
        true
    }

    /// Heap bytes.
    pub fn bytes(&self) -> usize {
        let bytes: usize = self.touching.iter().map(Vec::capacity).sum();
        let words: usize = self.clipped.iter().map(Vec::capacity).sum();
        bytes + 8 * words
    }
}

/// Bytes for the touching pairs of a list.
fn length(pairs: usize, ranges: usize) -> usize {
    pairs / 4 + ranges + 1
}

/// Ranges of a list for which room is made: pairs of materials that meet in one tile.
const RANGES: usize = 16;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_those_of_the_evaluation_before() {
        let mut marks = Marks::default();
        marks.forget();
        marks.begin(11, 2);
        // Ranges of 5 and 6 pairs: two bytes each, the second range behind the first.
        let first = marks.of_range(0, 0);
        assert!(first.before.is_none());
        first.now[..2].copy_from_slice(&[1, 2]);
        let second = marks.of_range(1, 5);
        second.now[..2].copy_from_slice(&[3, 4]);
        marks.clip(10);
        marks.begin(11, 2);
        assert_eq!(marks.of_range(0, 0).before.unwrap()[..2], [1, 2]);
        assert_eq!(marks.of_range(1, 5).before.unwrap()[..2], [3, 4]);
        assert!(marks.was_clipped(10) && !marks.was_clipped(9));
        marks.forget();
        marks.begin(3, 1);
        assert!(marks.of_range(0, 0).before.is_none() && !marks.was_clipped(1));
    }
}
