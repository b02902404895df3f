//! Size classes of bodies.

/// Most classes: the last one takes all that is smaller.
const MOST: usize = 40;
/// Candidates of a body among bodies of its own class that lie densely.
const OWN: f64 = 20.0;
/// What a coarser class with nobody near costs a body, in candidates.
const VISIT: f64 = 8.0;

/// Classes of bodies whose reaches, `2R + margin`, differ by less than a factor of two; neighbouring ones are joined
/// where bodies are so few that looking at too many of them costs less than one more grid does for all smaller bodies.
#[derive(Debug, Default)]
pub(super) struct Sizes {
    largest: f64,
    number: Vec<usize>,
    group: Vec<u8>,
    pub(super) groups: usize,
}

impl Sizes {
    pub(super) fn divide(&mut self, rows: &[[f64; 4]], margin: f64) {
        self.largest = rows.iter().fold(0.0, |most: f64, row| most.max(2.0 * row[3] + margin));
        self.number.clear();
        self.number.resize(MOST, 0);
        self.group.clear();
        for row in rows {
            let class = self.class(2.0 * row[3] + margin);
            self.number[class] += 1;
        }
        let mut finer = rows.len();
        let (mut groups, mut within, mut span) = (0usize, 0usize, 0);
        for class in 0..MOST {
            let here = self.number[class];
            finer -= here;
            if here == 0 {
                span += 1;
            } else {
                let together = (within + here) as f64 * OWN * 8f64.powi(span);
                if within == 0 || together > VISIT * (finer + here) as f64 {
                    (groups, within, span) = (groups + 1, 0, 0);
                }
                within += here;
                span += 1;
            }
            self.group.push(groups.saturating_sub(1) as u8);
        }
        self.groups = groups.max(1);
    }

    /// Size class of a reach, 0 for the largest; each is half of the one before.
    fn class(&self, reach: f64) -> usize {
        let ratio = self.largest / reach;
        if ratio >= 1.0 {
            // The exponent of a double is the whole part of its binary logarithm.
            ((ratio.to_bits() >> 52) as usize - 1023).min(MOST - 1)
        } else {
            // Nothing is larger; a reach that is negative or not a number meets larger bodies only.
            MOST - 1
        }
    }

    /// Group of a body, from the largest.
    pub(super) fn of(&self, reach: f64) -> usize {
        usize::from(self.group[self.class(reach)])
    }

    /// Whether all bodies are in one class.
    pub(super) fn alike(&self) -> bool {
        self.number.iter().filter(|number| **number > 0).count() <= 1
    }
}
