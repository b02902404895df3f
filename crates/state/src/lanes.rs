//! Four numbers at once: a row of a body, or one column of four contacts.
//!
//! [`Lanes`] has two implementations with the same bits: [`Portable`] is plain Rust, [`Avx2`] is one 256-bit register.
//! Code is written once over `L: Lanes` and called with the one that [`InstructionSet::detect`] names. Left to itself the
//! compiler makes scalar code of loops over rows: the rows are gathered one number at a time.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Sub};

#[cfg(target_arch = "x86_64")]
pub use crate::lanes_avx2::Avx2;

/// What the processor can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionSet {
    /// What every processor of the target has.
    Baseline,
    /// 256-bit vectors. Only [`InstructionSet::detect`] says this.
    #[cfg(target_arch = "x86_64")]
    Avx2,
}

impl InstructionSet {
    /// The widest instruction set of this machine that is of use.
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            return Self::Avx2;
        }
        Self::Baseline
    }
}

/// What an integration scheme needs of a number, or of several at once.
pub trait Number:
    Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + 'static
{
}

impl Number for f64 {}

/// Four double precision numbers. No operation is fused; every implementation gives the same bits.
pub trait Lanes: Number + Div<Output = Self> {
    /// A choice of lanes.
    type Packing: Copy;
    /// Four times the same number.
    fn splat(value: f64) -> Self;
    /// From memory.
    fn load(values: &[f64; 4]) -> Self;
    /// To memory.
    fn store(self, to: &mut [f64; 4]);
    /// From single precision.
    fn load_single(values: &[f32; 4]) -> Self;
    /// To single precision, rounded to nearest.
    fn store_single(self, to: &mut [f32; 4]);
    /// Square roots.
    fn sqrt(self) -> Self;
    /// The larger of each two; `other` where one is not a number.
    fn max(self, other: Self) -> Self;
    /// Lanes of `then` where `self` equals `other`, lanes of `otherwise` elsewhere.
    fn if_equal(self, other: Self, then: Self, otherwise: Self) -> Self;
    /// Bit `k` is set where lane `k` is less than that of `other`.
    fn less(self, other: Self) -> usize;
    /// The sign of the last lane flipped.
    fn flip_last(self) -> Self;
    /// The last lane in all four.
    fn spread_last(self) -> Self;
    /// Lane `k` of result `l` is lane `l` of row `k`.
    fn transpose(rows: [Self; 4]) -> [Self; 4];
    /// The choice of the lanes whose bit is set in `mask`, below 16.
    fn packing(mask: usize) -> Self::Packing;
    /// The chosen lanes, moved to the front in their order; what comes after them is arbitrary.
    fn pack(self, packing: Self::Packing) -> Self;
    /// The same with four indices.
    fn pack_indices(indices: &[u32; 4], packing: Self::Packing) -> [u32; 4];
}

/// Lanes that [`Lanes::pack`] moves to the front, by mask.
pub const PACKED: [[u8; 4]; 16] = packed();

const fn packed() -> [[u8; 4]; 16] {
    let mut table = [[0; 4]; 16];
    let mut mask = 0;
    while mask < 16 {
        let (mut lane, mut at) = (0, 0);
        while lane < 4 {
            if mask >> lane & 1 == 1 {
                table[mask][at] = lane as u8;
                at += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
}

/// Four numbers in plain Rust.
#[derive(Clone, Copy, Debug)]
pub struct Portable([f64; 4]);

macro_rules! lanewise {
    ($trait:ident, $method:ident) => {
        impl $trait for Portable {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(std::array::from_fn(|k| $trait::$method(self.0[k], other.0[k])))
            }
        }
    };
}
lanewise!(Add, add);
lanewise!(Sub, sub);
lanewise!(Mul, mul);
lanewise!(Div, div);

impl Number for Portable {}

impl Lanes for Portable {
    type Packing = [u8; 4];
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self([value; 4])
    }
    #[inline(always)]
    fn load(values: &[f64; 4]) -> Self {
        Self(*values)
    }
    #[inline(always)]
    fn store(self, to: &mut [f64; 4]) {
        *to = self.0;
    }
    #[inline(always)]
    fn load_single(values: &[f32; 4]) -> Self {
        Self(values.map(f64::from))
    }
    #[inline(always)]
    fn store_single(self, to: &mut [f32; 4]) {
        *to = self.0.map(|value| value as f32);
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| if self.0[k] > other.0[k] { self.0[k] } else { other.0[k] }))
    }
    #[inline(always)]
    fn if_equal(self, other: Self, then: Self, otherwise: Self) -> Self {
        Self(std::array::from_fn(|k| if self.0[k] == other.0[k] { then.0[k] } else { otherwise.0[k] }))
    }
    #[inline(always)]
    fn less(self, other: Self) -> usize {
        (0..4).map(|k| usize::from(self.0[k] < other.0[k]) << k).sum()
    }
    #[inline(always)]
    fn flip_last(self) -> Self {
        Self([self.0[0], self.0[1], self.0[2], -self.0[3]])
    }
    #[inline(always)]
    fn spread_last(self) -> Self {
        Self([self.0[3]; 4])
    }
    #[inline(always)]
    fn transpose(rows: [Self; 4]) -> [Self; 4] {
        std::array::from_fn(|l| Self(std::array::from_fn(|k| rows[k].0[l])))
    }
    #[inline(always)]
    fn packing(mask: usize) -> [u8; 4] {
        PACKED[mask & 15]
    }
    #[inline(always)]
    fn pack(self, packing: [u8; 4]) -> Self {
        Self(packing.map(|lane| self.0[usize::from(lane)]))
    }
    #[inline(always)]
    fn pack_indices(indices: &[u32; 4], packing: [u8; 4]) -> [u32; 4] {
        packing.map(|lane| indices[usize::from(lane)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: [[f64; 4]; 4] = [
        [1.5, -2.0, 0.0, 1e300],
        [-0.0, f64::INFINITY, 1e-310, 3.0],
        [f64::NAN, 7.25, -1.0 / 3.0, -0.0],
        [0.1, 0.2, 0.3, 0.4],
    ];

    fn bits<L: Lanes>(value: L) -> [u64; 4] {
        let mut numbers = [0.0; 4];
        value.store(&mut numbers);
        // The sign and payload of a result that is not a number are not promised.
        numbers.map(|number: f64| if number.is_nan() { u64::MAX } else { number.to_bits() })
    }

    /// Everything that an implementation computes from the samples.
    fn everything<L: Lanes>() -> Vec<[u64; 4]> {
        let rows = SAMPLES.map(|row| L::load(&row));
        let mut out: Vec<L> = L::transpose(rows).to_vec();
        let mut masks = Vec::new();
        for a in rows {
            out.extend([a.sqrt(), a.flip_last(), a.spread_last(), L::splat(-3.5)]);
            let mut single = [0.0; 4];
            a.store_single(&mut single);
            out.push(L::load_single(&single));
            for b in rows {
                out.extend([a + b, a - b, a * b, a / b, a.max(b), a.if_equal(b, a, L::splat(9.0))]);
                masks.push([a.less(b) as u64; 4]);
            }
        }
        masks.extend(out.into_iter().map(bits));
        for mask in 0..16 {
            let count = (mask as u32).count_ones() as usize;
            let mut packed = bits(rows[3].pack(L::packing(mask)));
            packed[count..].fill(0);
            masks.push(packed);
            let mut indices = L::pack_indices(&[7, 5, 3, 1], L::packing(mask)).map(u64::from);
            indices[count..].fill(0);
            masks.push(indices);
        }
        masks
    }

    #[test]
    fn portable_lanes_do_what_they_say() {
        let row = Portable::load(&SAMPLES[3]);
        assert_eq!(row.pack(PACKED[0b1010]).0[..2], [0.2, 0.4]);
        assert_eq!(row.pack(PACKED[0b1111]).0, SAMPLES[3]);
        assert_eq!(row.flip_last().0, [0.1, 0.2, 0.3, -0.4]);
        assert_eq!(row.spread_last().0, [0.4; 4]);
        assert_eq!(row.less(Portable::splat(0.25)), 0b0011);
        let columns = Portable::transpose(SAMPLES.map(|row| Portable::load(&row)));
        assert_eq!(columns[3].0, [1e300, 3.0, -0.0, 0.4]);
        assert_eq!(row.if_equal(Portable::splat(0.3), Portable::splat(1.0), row).0, [0.1, 0.2, 1.0, 0.4]);
    }

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn registers_give_the_same_bits() {
        if InstructionSet::detect() == InstructionSet::Avx2 {
            assert_eq!(everything::<Avx2>(), everything::<Portable>());
        }
    }
}
