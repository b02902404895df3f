//! Reads the text dumps of both engines (`dump custom`, orthogonal box, sorted by id).

use super::{Frame, Quantity};

/// All frames of a dump, in file order. Unknown columns are ignored.
pub fn frames(text: &str) -> Result<Vec<Frame>, String> {
    let mut lines = text.lines().enumerate();
    let mut frames = Vec::new();
    while let Some((number, line)) = lines.next() {
        if line.trim() != "ITEM: TIMESTEP" {
            return Err(format!("line {}: expected `ITEM: TIMESTEP`", number + 1));
        }
        let mut next = || lines.next().ok_or("the dump ends in the middle of a frame");
        let step = integer(next()?)?;
        let (_, count_head) = next()?;
        if count_head.trim() != "ITEM: NUMBER OF ATOMS" {
            return Err(format!("step {step}: expected `ITEM: NUMBER OF ATOMS`"));
        }
        let count = integer(next()?)?;
        for _ in 0..4 {
            next()?;
        }
        let (_, head) = next()?;
        let names: Vec<&str> =
            head.strip_prefix("ITEM: ATOMS").ok_or("expected `ITEM: ATOMS`")?.split_whitespace().collect();
        let columns = Columns::find(&names)?;
        let mut frame = Frame { step, ..Frame::default() };
        for _ in 0..count {
            let (number, line) = next()?;
            columns.read(line, &mut frame).map_err(|what| format!("line {}: {what}", number + 1))?;
        }
        if !frame.ids.is_sorted() {
            return Err(format!("step {step}: bodies are not sorted by id"));
        }
        frames.push(frame);
    }
    Ok(frames)
}

fn integer((number, line): (usize, &str)) -> Result<u64, String> {
    line.trim().parse().map_err(|_| format!("line {}: expected an integer", number + 1))
}

struct Columns {
    id: usize,
    vectors: Vec<(Quantity, [usize; 3])>,
}

impl Columns {
    fn find(names: &[&str]) -> Result<Self, String> {
        let at = |name: &str| names.iter().position(|column| *column == name);
        let mut vectors = Vec::new();
        for quantity in Quantity::ALL {
            if let [Some(x), Some(y), Some(z)] = quantity.columns().map(at) {
                vectors.push((quantity, [x, y, z]));
            }
        }
        Ok(Self { id: at("id").ok_or("the dump has no column `id`")?, vectors })
    }

    fn read(&self, line: &str, frame: &mut Frame) -> Result<(), String> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let word = |index: usize| words.get(index).copied().ok_or("too few columns");
        frame.ids.push(word(self.id)?.parse().map_err(|_| "an id is not an integer")?);
        for (quantity, indices) in &self.vectors {
            let mut value = [0.0; 3];
            for (component, index) in value.iter_mut().zip(indices) {
                let text = word(*index)?;
                *component = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
            }
            frame.column_mut(*quantity).push(value);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str =
        "ITEM: TIMESTEP\n10\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff ff\n-1 1\n-1 1\n-1 1\n";

    #[test]
    fn reads_17_digits_and_trailing_blanks() {
        let text = format!("{HEAD}ITEM: ATOMS id x y z \n1 0.10000000000000001 -2e-300 0 \n7 1 2 3 \n");
        let read = frames(&text).unwrap();
        assert_eq!(read.len(), 1);
        assert_eq!(read[0].step, 10);
        assert_eq!(read[0].ids, [1, 7]);
        assert_eq!(read[0].position[0], [0.1, -2e-300, 0.0]);
        assert!(read[0].velocity.is_empty());
    }

    #[test]
    fn refuses_what_is_cut_unsorted_or_no_number() {
        for rows in ["1 0 0 0\n", "7 0 0 0\n1 0 0 0\n", "1 0 0 zero\n2 0 0 0\n", "1 0 0\n2 0 0 0\n"] {
            assert!(frames(&format!("{HEAD}ITEM: ATOMS id x y z\n{rows}")).is_err(), "{rows}");
        }
        assert!(frames("ITEM: ATOMS id\n").is_err());
    }
}
