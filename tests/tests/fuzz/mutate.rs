//! Inputs from bytes: what the fuzzer changes is a list of changes to something valid, so that most inputs get past the first
//! check.

/// Bytes as a stream of choices; zeros after the end.
pub struct Choices<'a>(&'a [u8]);

impl<'a> Choices<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    /// A number below `count`, or 0 if there is none.
    pub fn below(&mut self, count: usize) -> usize {
        let wide = usize::from(self.byte()) << 16 | usize::from(self.byte()) << 8 | usize::from(self.byte());
        wide.checked_rem(count).unwrap_or(0)
    }

    pub fn of<'b, T: ?Sized>(&mut self, choices: &[&'b T]) -> &'b T {
        choices[self.below(choices.len())]
    }

    /// A number from 0 to 1.
    pub fn share(&mut self) -> f64 {
        self.below(1 << 24) as f64 / f64::from(1 << 24)
    }

    /// A number of any size, often one at which something begins or ends.
    pub fn number(&mut self) -> f64 {
        const EDGES: [f64; 20] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.5,
            1e-3,
            f64::MIN_POSITIVE,
            5e-324,
            1e-200,
            1e12,
            -1e12,
            1e200,
            f64::MAX,
            f64::MIN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
            f64::EPSILON,
            4_294_967_296.0,
            1e-9,
        ];
        match self.byte() {
            kind if kind < 128 => self.share(),
            kind if kind < 176 => 2.0 * self.share() - 1.0,
            kind if kind < 224 => EDGES[self.below(EDGES.len())],
            _ => f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| self.byte()))),
        }
    }
}

/// Pieces of a text: words, numbers, quoted texts, single signs, and blanks.
pub fn tokens(text: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '+');
        let end = if first == '"' {
            rest[1..].find('"').map_or(rest.len(), |at| at + 2)
        } else if first.is_alphanumeric() {
            rest.find(|c: char| !word(c)).unwrap_or(rest.len())
        } else {
            first.len_utf8()
        };
        let (token, more) = rest.split_at(end);
        tokens.push(token);
        rest = more;
    }
    tokens
}

/// A text after changes of its pieces: removed, inserted, replaced, swapped, copied, or a run of them repeated.
pub fn mutated(text: &str, spice: &[&str], choices: &mut Choices<'_>) -> String {
    let mut tokens = tokens(text);
    let changes = 1 + choices.below(8);
    for _ in 0..changes {
        if tokens.is_empty() || choices.is_empty() {
            break;
        }
        let at = choices.below(tokens.len());
        match choices.byte() % 7 {
            0 => drop(tokens.remove(at)),
            1 => tokens.insert(at, choices.of(spice)),
            2 | 3 => tokens[at] = choices.of(spice),
            4 => {
                let with = choices.below(tokens.len());
                tokens.swap(at, with);
            }
            5 => {
                let copied = tokens[choices.below(tokens.len())];
                tokens.insert(at, copied);
            }
            _ => {
                let end = (at + 1 + choices.below(24)).min(tokens.len());
                let run = tokens[at..end].to_vec();
                for _ in 0..1 + choices.below(6) {
                    tokens.splice(at..at, run.iter().copied());
                }
            }
        }
    }
    tokens.concat()
}
