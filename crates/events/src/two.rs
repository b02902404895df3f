//! Two numbers at once: what every processor of the x86-64 family has, and plain arithmetic elsewhere, with the same bits.

#[cfg(target_arch = "x86_64")]
mod form {
    #![expect(
        unsafe_code,
        reason = "intrinsics of an instruction set that every processor of this family has"
    )]

    /// Uses intrinsics of SSE2.
    macro_rules! sse2 {
        ($what:expr) => {
            // SAFETY: SSE2 is part of x86-64, and none of these reads memory.
            unsafe { $what }
        };
    }

    use std::arch::x86_64::{
        __m128d, _mm_add_pd, _mm_and_pd, _mm_cmpgt_pd, _mm_cmplt_pd, _mm_cmplt_ps, _mm_movemask_pd,
        _mm_movemask_ps, _mm_mul_pd, _mm_set_pd, _mm_set_ps, _mm_set1_pd, _mm_set1_ps, _mm_sub_pd,
        _mm_unpackhi_pd, _mm_unpacklo_pd,
    };

    #[derive(Clone, Copy, Debug)]
    pub struct Two(__m128d);

    impl Two {
        #[inline(always)]
        pub fn new(first: f64, second: f64) -> Self {
            sse2!(Self(_mm_set_pd(second, first)))
        }
        #[inline(always)]
        pub fn both(value: f64) -> Self {
            sse2!(Self(_mm_set1_pd(value)))
        }
        /// The first numbers of two, and their second ones.
        #[inline(always)]
        pub fn zip(self, other: Self) -> (Self, Self) {
            sse2!((Self(_mm_unpacklo_pd(self.0, other.0)), Self(_mm_unpackhi_pd(self.0, other.0))))
        }
        /// `self` where it is within `half`, else brought nearer by `length`.
        #[inline(always)]
        pub fn nearest(self, half: f64, length: f64) -> Self {
            sse2!({
                let length = _mm_set1_pd(length);
                let above = _mm_and_pd(_mm_cmpgt_pd(self.0, _mm_set1_pd(half)), length);
                let below = _mm_and_pd(_mm_cmplt_pd(self.0, _mm_set1_pd(-half)), length);
                Self(_mm_add_pd(_mm_sub_pd(self.0, above), below))
            })
        }
        /// Bit `k` is set where number `k` is greater than that of `other`.
        #[inline(always)]
        pub fn greater(self, other: Self) -> u32 {
            sse2!(_mm_movemask_pd(_mm_cmpgt_pd(self.0, other.0)) as u32)
        }
    }

    /// Bit `k` is set where number `k` is below the limit.
    #[inline(always)]
    pub fn below(numbers: &[f32; 8], limit: f32) -> u32 {
        let [a, b, c, d, e, f, g, h] = *numbers;
        sse2!({
            let limit = _mm_set1_ps(limit);
            let low = _mm_movemask_ps(_mm_cmplt_ps(_mm_set_ps(d, c, b, a), limit));
            let high = _mm_movemask_ps(_mm_cmplt_ps(_mm_set_ps(h, g, f, e), limit));
            (low | high << 4) as u32
        })
    }

    impl std::ops::Add for Two {
        type Output = Self;
        #[inline(always)]
        fn add(self, other: Self) -> Self {
            sse2!(Self(_mm_add_pd(self.0, other.0)))
        }
    }
    impl std::ops::Sub for Two {
        type Output = Self;
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            sse2!(Self(_mm_sub_pd(self.0, other.0)))
        }
    }
    impl std::ops::Mul for Two {
        type Output = Self;
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            sse2!(Self(_mm_mul_pd(self.0, other.0)))
        }
    }
}

#[cfg(not(target_arch = "x86_64"))]
mod form {
    #[derive(Clone, Copy, Debug)]
    pub struct Two([f64; 2]);

    impl Two {
        pub fn new(first: f64, second: f64) -> Self {
            Self([first, second])
        }
        pub fn both(value: f64) -> Self {
            Self([value; 2])
        }
        pub fn zip(self, other: Self) -> (Self, Self) {
            (Self([self.0[0], other.0[0]]), Self([self.0[1], other.0[1]]))
        }
        pub fn nearest(self, half: f64, length: f64) -> Self {
            Self(self.0.map(|d| {
                let above = if d > half { length } else { 0.0 };
                let below = if d < -half { length } else { 0.0 };
                d - above + below
            }))
        }
        pub fn greater(self, other: Self) -> u32 {
            u32::from(self.0[0] > other.0[0]) | u32::from(self.0[1] > other.0[1]) << 1
        }
    }

    pub fn below(numbers: &[f32; 8], limit: f32) -> u32 {
        (0..8).fold(0, |bits, lane| bits | u32::from(numbers[lane] < limit) << lane)
    }

    impl std::ops::Add for Two {
        type Output = Self;
        fn add(self, other: Self) -> Self {
            Self([self.0[0] + other.0[0], self.0[1] + other.0[1]])
        }
    }
    impl std::ops::Sub for Two {
        type Output = Self;
        fn sub(self, other: Self) -> Self {
            Self([self.0[0] - other.0[0], self.0[1] - other.0[1]])
        }
    }
    impl std::ops::Mul for Two {
        type Output = Self;
        fn mul(self, other: Self) -> Self {
            Self([self.0[0] * other.0[0], self.0[1] * other.0[1]])
        }
    }
}

pub use form::{Two, below};
