//! Four numbers in one 256-bit register.
#![expect(unsafe_code, reason = "intrinsics of an instruction set that the compiler does not assume")]
// SAFETY, for every call of an intrinsic in this file: its instruction set is present, because values of `Avx2` are only
// made by code that `InstructionSet::Avx2` has selected, and that is what `InstructionSet::detect` says after it has found
// the instruction set on this machine. Memory is reached through references to arrays of exactly the width that is
// loaded or stored, with instructions that do not ask for alignment.

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

use crate::lanes::{Lanes, Number, PACKED};

/// Four numbers in a 256-bit register. Use it in functions with `#[target_feature(enable = "avx2")]` alone, called where
/// [`InstructionSet::Avx2`](crate::InstructionSet::Avx2) was detected.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(__m256d);

macro_rules! lanewise {
    ($trait:ident, $method:ident, $intrinsic:ident) => {
        impl $trait for Avx2 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: see the head of the file.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}
lanewise!(Add, add, _mm256_add_pd);
lanewise!(Sub, sub, _mm256_sub_pd);
lanewise!(Mul, mul, _mm256_mul_pd);
lanewise!(Div, div, _mm256_div_pd);

impl Number for Avx2 {}

/// The table of packed lanes as indices of 32-bit numbers: of the halves of four doubles, and of four indices.
static CHOICES: [([i32; 8], [i32; 4]); 16] = choices();

const fn choices() -> [([i32; 8], [i32; 4]); 16] {
    let mut table = [([0; 8], [0; 4]); 16];
    let mut mask = 0;
    while mask < 16 {
        let mut at = 0;
        while at < 4 {
            let lane = PACKED[mask][at] as i32;
            table[mask].0[2 * at] = 2 * lane;
            table[mask].0[2 * at + 1] = 2 * lane + 1;
            table[mask].1[at] = lane;
            at += 1;
        }
        mask += 1;
    }
    table
}

impl Lanes for Avx2 {
    type Packing = (__m256i, __m128i);

    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_set1_pd(value) })
    }
    #[inline(always)]
    fn load(values: &[f64; 4]) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_loadu_pd(values.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f64; 4]) {
        // SAFETY: see the head of the file.
        unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn load_single(values: &[f32; 4]) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_cvtps_pd(_mm_loadu_ps(values.as_ptr())) })
    }
    #[inline(always)]
    fn store_single(self, to: &mut [f32; 4]) {
        // SAFETY: see the head of the file.
        unsafe { _mm_storeu_ps(to.as_mut_ptr(), _mm256_cvtpd_ps(self.0)) }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn if_equal(self, other: Self, then: Self, otherwise: Self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe {
            let equal = _mm256_cmp_pd::<_CMP_EQ_OQ>(self.0, other.0);
            _mm256_blendv_pd(otherwise.0, then.0, equal)
        })
    }
    #[inline(always)]
    fn less(self, other: Self) -> usize {
        // SAFETY: see the head of the file.
        unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0)) as usize }
    }
    #[inline(always)]
    fn flip_last(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set_pd(-0.0, 0.0, 0.0, 0.0)) })
    }
    #[inline(always)]
    fn spread_last(self) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_permute4x64_pd::<0b11_11_11_11>(self.0) })
    }
    #[inline(always)]
    fn transpose([a, b, c, d]: [Self; 4]) -> [Self; 4] {
        // SAFETY: see the head of the file.
        unsafe {
            let low_ab = _mm256_unpacklo_pd(a.0, b.0);
            let high_ab = _mm256_unpackhi_pd(a.0, b.0);
            let low_cd = _mm256_unpacklo_pd(c.0, d.0);
            let high_cd = _mm256_unpackhi_pd(c.0, d.0);
            [
                Self(_mm256_permute2f128_pd::<0x20>(low_ab, low_cd)),
                Self(_mm256_permute2f128_pd::<0x20>(high_ab, high_cd)),
                Self(_mm256_permute2f128_pd::<0x31>(low_ab, low_cd)),
                Self(_mm256_permute2f128_pd::<0x31>(high_ab, high_cd)),
            ]
        }
    }
    #[inline(always)]
    fn packing(mask: usize) -> (__m256i, __m128i) {
        let (doubles, indices) = &CHOICES[mask & 15];
        // SAFETY: see the head of the file; the registers are loaded from arrays of eight and four.
        unsafe { (_mm256_loadu_si256(doubles.as_ptr().cast()), _mm_loadu_si128(indices.as_ptr().cast())) }
    }
    #[inline(always)]
    fn pack(self, (doubles, _): (__m256i, __m128i)) -> Self {
        // SAFETY: see the head of the file.
        Self(unsafe { _mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps(self.0), doubles)) })
    }
    #[inline(always)]
    fn pack_indices(indices: &[u32; 4], (_, choice): (__m256i, __m128i)) -> [u32; 4] {
        let mut packed = [0; 4];
        // SAFETY: see the head of the file.
        unsafe {
            let numbers = _mm_castsi128_ps(_mm_loadu_si128(indices.as_ptr().cast()));
            let chosen = _mm_castps_si128(_mm_permutevar_ps(numbers, choice));
            _mm_storeu_si128(packed.as_mut_ptr().cast(), chosen);
        }
        packed
    }
}
