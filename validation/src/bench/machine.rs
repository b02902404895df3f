//! What the machine can do.

use std::time::Instant;

/// Bytes a second that `threads` threads can copy between arrays larger than any cache, read and written bytes both
/// counted; the best of five.
pub fn copy_bandwidth(threads: usize) -> f64 {
    const WORDS: usize = 16 << 20;
    let mut pairs: Vec<(Vec<u64>, Vec<u64>)> =
        (0..threads).map(|_| (vec![1; WORDS], vec![0; WORDS])).collect();
    let mut best: f64 = 0.0;
    for _ in 0..5 {
        let begin = Instant::now();
        std::thread::scope(|scope| {
            for (from, to) in &mut pairs {
                scope.spawn(|| to.copy_from_slice(std::hint::black_box(from)));
            }
        });
        let moved = (2 * 8 * WORDS * threads) as f64;
        best = best.max(moved / begin.elapsed().as_secs_f64());
    }
    best
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_machine_copies_something() {
        assert!(super::copy_bandwidth(1) > 1e6);
    }
}
