//! The Hilbert curve through a grid: neighbours on it are neighbours in space.

/// Place of a cell along the Hilbert curve that fills a square (2 directions) or cube (3) of `2^bits` cells a side.
///
/// The algorithm is Skilling's (AIP Conf. Proc. 707, 381, 2004). One direction is the line itself. `bits` times the
/// number of directions must not exceed 63.
pub(super) fn hilbert_index<const N: usize>(mut x: [u32; N], bits: u32) -> u64 {
    if bits == 0 {
        return 0;
    }
    for level in (1..bits).rev() {
        let bit = 1 << level;
        let lower = bit - 1;
        for k in 0..N {
            if x[k] & bit != 0 {
                x[0] ^= lower;
            } else {
                let differ = (x[0] ^ x[k]) & lower;
                x[0] ^= differ;
                x[k] ^= differ;
            }
        }
    }
    for k in 1..N {
        x[k] ^= x[k - 1];
    }
    let mut flip = 0;
    for level in (1..bits).rev() {
        if x[N - 1] & (1 << level) != 0 {
            flip ^= (1 << level) - 1;
        }
    }
    let mut index = 0;
    for level in (0..bits).rev() {
        for k in 0..N {
            index = index << 1 | u64::from((x[k] ^ flip) >> level & 1);
        }
    }
    index
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every cell is visited once and each step goes to a cell that shares a face.
    fn walk<const N: usize>(bits: u32) {
        let side = 1u32 << bits;
        let cells = (side as usize).pow(N as u32);
        let mut path = vec![None; cells];
        for cell in 0..cells {
            let mut rest = cell as u32;
            let x: [u32; N] = std::array::from_fn(|_| {
                let coordinate = rest % side;
                rest /= side;
                coordinate
            });
            let at = hilbert_index(x, bits) as usize;
            assert!(path[at].replace(x).is_none(), "{at} is visited twice");
        }
        for pair in path.windows(2) {
            let (a, b) = (pair[0].unwrap(), pair[1].unwrap());
            let step: u32 = (0..N).map(|k| a[k].abs_diff(b[k])).sum();
            assert_eq!(step, 1, "from {a:?} to {b:?}");
        }
    }

    #[test]
    fn the_curve_is_connected_and_complete() {
        for bits in 1..=4 {
            walk::<1>(bits);
            walk::<2>(bits);
            walk::<3>(bits);
        }
        walk::<2>(7);
        assert_eq!(hilbert_index([0u32; 3], 0), 0);
    }

    #[test]
    fn the_largest_cube_fits() {
        let top = (1 << 21) - 1;
        let corners = [[0, 0, 0], [top, top, top], [top, 0, 0], [0, 0, top]];
        let mut places: Vec<u64> = corners.iter().map(|&x| hilbert_index(x, 21)).collect();
        assert!(places.iter().all(|&p| p < 1 << 63));
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), 4);
    }
}
