//! The simulation cell and its periodic images.

use crate::GeometryError;

/// Number of image codes: three shifts in each of three directions.
pub const IMAGE_CODES: usize = 27;
/// The image code of a pair that is not shifted.
pub const NO_IMAGE: u8 = 13;

/// Code of an image shift: `(sx+1) + 3*(sy+1) + 9*(sz+1)` with s in {-1, 0, 1}.
///
/// The separation of a pair is `x_i - x_j - s*L`. Shifts beyond one period are cut to one.
pub fn image_code(shift: [i32; 3]) -> u8 {
    let digit = |s: i32| (s.clamp(-1, 1) + 1) as u8;
    digit(shift[0]) + 3 * digit(shift[1]) + 9 * digit(shift[2])
}

/// The image shift of a code; the inverse of [`image_code`] for codes below [`IMAGE_CODES`].
pub fn image_shift(code: u8) -> [i32; 3] {
    let code = i32::from(code);
    [code % 3 - 1, code / 3 % 3 - 1, code / 9 % 3 - 1]
}

/// The code of the same pair with i and j exchanged; `code` below [`IMAGE_CODES`].
pub fn opposite_image(code: u8) -> u8 {
    26 - code
}

/// The box in which bodies live: bounds, and which directions are periodic.
///
/// In a direction that is not periodic the bounds confine nothing (walls do that) and may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    lo: [f64; 3],
    hi: [f64; 3],
    periodic: [bool; 3],
}

impl Cell {
    /// A cell from `lo` to `hi` (m).
    ///
    /// # Errors
    /// [`GeometryError::EmptyExtent`] unless `lo < hi` in each direction (`lo == hi` is allowed where not periodic:
    /// a plane problem), [`GeometryError::UnboundedPeriod`] for an infinite period, or one that is not representable,
    /// [`GeometryError::NotFinite`] for NaN.
    pub fn new(lo: [f64; 3], hi: [f64; 3], periodic: [bool; 3]) -> Result<Self, GeometryError> {
        for axis in 0..3 {
            let (l, h) = (lo[axis], hi[axis]);
            if l.is_nan() || h.is_nan() {
                return Err(GeometryError::NotFinite { what: "cell bound" });
            }
            if l > h || (periodic[axis] && l == h) {
                return Err(GeometryError::EmptyExtent { axis, lo: l, hi: h });
            }
            if periodic[axis] && !(h - l).is_finite() {
                return Err(GeometryError::UnboundedPeriod { axis });
            }
        }
        Ok(Self { lo, hi, periodic })
    }

    /// All of space, without periodic directions.
    pub const fn unbounded() -> Self {
        Self { lo: [f64::NEG_INFINITY; 3], hi: [f64::INFINITY; 3], periodic: [false; 3] }
    }

    /// Lower bounds, m.
    pub const fn lo(&self) -> [f64; 3] {
        self.lo
    }

    /// Upper bounds, m.
    pub const fn hi(&self) -> [f64; 3] {
        self.hi
    }

    /// Which directions are periodic.
    pub const fn periodic(&self) -> [bool; 3] {
        self.periodic
    }

    /// True when at least one direction is periodic.
    pub fn is_periodic(&self) -> bool {
        self.periodic.contains(&true)
    }

    /// Length of the period in each direction, m; 0 where the direction is not periodic.
    pub fn period(&self) -> [f64; 3] {
        let mut period = [0.0; 3];
        for axis in 0..3 {
            if self.periodic[axis] {
                period[axis] = self.hi[axis] - self.lo[axis];
            }
        }
        period
    }

    /// Moves a position into `lo <= x < hi` in the periodic directions, from any number of boxes away.
    ///
    /// Returns the position and the number n of periods that were taken off: `x_wrapped = x - n*L`. A coordinate that
    /// is not finite is returned as it is, with n = 0; n saturates at the range of `i32`.
    pub fn wrap(&self, position: [f64; 3]) -> ([f64; 3], [i32; 3]) {
        let (mut wrapped, mut count) = (position, [0; 3]);
        for axis in 0..3 {
            let (lo, hi, x) = (self.lo[axis], self.hi[axis], position[axis]);
            if !self.periodic[axis] || !x.is_finite() || (x >= lo && x < hi) {
                continue;
            }
            let length = hi - lo;
            let mut n = ((x - lo) / length).floor();
            let mut y = x - n * length;
            // Rounding may leave y one step off either end: x = lo - 1e-30 becomes hi.
            if y < lo {
                y += length;
                n -= 1.0;
            }
            if y >= hi {
                y -= length;
                n += 1.0;
            }
            wrapped[axis] = if y >= lo && y < hi { y } else { lo };
            count[axis] = n as i32;
        }
        (wrapped, count)
    }

    /// The shortest image of a separation and the shift s that leads to it: `image = separation - s*L`.
    pub fn minimum_image(&self, separation: [f64; 3]) -> ([f64; 3], [i32; 3]) {
        let (mut image, mut shift) = (separation, [0; 3]);
        let period = self.period();
        for axis in 0..3 {
            if self.periodic[axis] && separation[axis].is_finite() {
                let s = (separation[axis] / period[axis]).round();
                image[axis] = separation[axis] - s * period[axis];
                shift[axis] = s as i32;
            }
        }
        (image, shift)
    }

    /// The vector s*L of an image code (m), to be subtracted from `x_i - x_j`; 0 where not periodic.
    pub fn shift_vector(&self, code: u8) -> [f64; 3] {
        let (shift, period) = (image_shift(code), self.period());
        std::array::from_fn(|axis| f64::from(shift[axis]) * period[axis])
    }

    /// [`Self::shift_vector`] of every code.
    pub fn shift_table(&self) -> [[f64; 3]; IMAGE_CODES] {
        std::array::from_fn(|code| self.shift_vector(code as u8))
    }

    /// Checks that two bodies of radius up to `max_radius`, seen as neighbours up to the distance
    /// `2*max_radius + margin` of their centres, can be so through one image only: a period must be at least twice
    /// that distance.
    ///
    /// # Errors
    /// [`GeometryError::PeriodTooShort`] for the first direction that is too short.
    pub fn check_minimum_length(&self, max_radius: f64, margin: f64) -> Result<(), GeometryError> {
        let minimum = 2.0 * (2.0 * max_radius + margin);
        let period = self.period();
        for axis in 0..3 {
            // Written so that a NaN bound is refused.
            let enough = period[axis] >= minimum;
            if self.periodic[axis] && !enough {
                return Err(GeometryError::PeriodTooShort { axis, length: period[axis], minimum });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn cell() -> Cell {
        Cell::new([-1.0, 0.0, 2.0], [2.0, 0.7, 5.0], [true, true, false]).unwrap()
    }

    #[test]
    fn bad_cells_are_refused() {
        let lo = [0.0; 3];
        assert!(matches!(
            Cell::new(lo, [1.0, -1.0, 1.0], [false; 3]),
            Err(GeometryError::EmptyExtent { axis: 1, .. })
        ));
        assert!(matches!(
            Cell::new(lo, [1.0, 1.0, 0.0], [true; 3]),
            Err(GeometryError::EmptyExtent { axis: 2, .. })
        ));
        assert!(matches!(
            Cell::new(lo, [f64::INFINITY, 1.0, 1.0], [true; 3]),
            Err(GeometryError::UnboundedPeriod { axis: 0 })
        ));
        assert!(matches!(
            Cell::new([-1.7e308; 3], [1.7e308; 3], [true; 3]),
            Err(GeometryError::UnboundedPeriod { axis: 0 })
        ));
        assert!(Cell::new([f64::NAN; 3], [1.0; 3], [false; 3]).is_err());
        assert!(Cell::new([0.0; 3], [1.0, 1.0, 0.0], [true, true, false]).is_ok());
    }

    #[test]
    fn codes_and_shifts() {
        let mut seen = [false; IMAGE_CODES];
        for code in 0..27 {
            let shift = image_shift(code);
            assert_eq!(image_code(shift), code);
            assert_eq!(image_shift(opposite_image(code)), shift.map(|s| -s));
            seen[usize::from(code)] = true;
        }
        assert!(seen.iter().all(|s| *s));
        assert_eq!(image_shift(NO_IMAGE), [0; 3]);
        assert_eq!(cell().shift_vector(image_code([1, -1, 1])), [3.0, -0.7, 0.0]);
        assert_eq!(cell().shift_table()[usize::from(NO_IMAGE)], [0.0; 3]);
    }

    #[test]
    fn wrap_at_the_edges() {
        let cell = cell();
        assert_eq!(cell.wrap([-1.0, 0.0, 9.0]), ([-1.0, 0.0, 9.0], [0; 3]));
        assert_eq!(cell.wrap([2.0, 0.7, 9.0]), ([-1.0, 0.0, 9.0], [1, 1, 0]));
        // Too close below the lower bound to be told apart from the upper bound, which is outside.
        let (x, n) = cell.wrap([-1.0 - 2e-16, -1e-300, 0.0]);
        assert_eq!((x[1], n[1]), (0.0, 0));
        assert!(x[0] >= -1.0 && x[0] < 2.0);
        assert_eq!(cell.wrap([1e300, 0.1, 0.0]).1[0], i32::MAX);
        assert!(cell.wrap([f64::NAN, 0.1, 0.0]).0[0].is_nan());
        assert_eq!(cell.wrap([f64::INFINITY, 0.1, 0.0]).0[0], f64::INFINITY);
    }

    #[test]
    fn minimum_length() {
        let cell = cell();
        // The shorter period is 0.7.
        assert!(cell.check_minimum_length(0.17, 0.009).is_ok());
        assert!(matches!(
            cell.check_minimum_length(0.17, 0.02),
            Err(GeometryError::PeriodTooShort { axis: 1, .. })
        ));
        assert!(cell.check_minimum_length(f64::NAN, 0.0).is_err());
        assert!(Cell::unbounded().check_minimum_length(1e9, 1.0).is_ok());
    }

    proptest! {
        #[test]
        fn wrapped_positions_are_inside_and_differ_by_whole_periods(
            x in -1e6f64..1e6, y in -1e6f64..1e6, z in -1e6f64..1e6,
        ) {
            let cell = cell();
            let (p, n) = cell.wrap([x, y, z]);
            let period = cell.period();
            for axis in 0..2 {
                prop_assert!(p[axis] >= cell.lo()[axis] && p[axis] < cell.hi()[axis]);
                let back = p[axis] + f64::from(n[axis]) * period[axis];
                // The product and the sum round once each at the size of x, below 1e6 here.
                prop_assert!((back - [x, y][axis]).abs() <= 2.0 * 1e6 * f64::EPSILON);
            }
            prop_assert_eq!(p[2], z);
            prop_assert_eq!(n[2], 0);
            prop_assert_eq!(cell.wrap(p), (p, [0; 3]));
        }

        #[test]
        fn no_image_is_shorter_than_the_minimum_image(d in prop::array::uniform3(-3.0f64..3.0)) {
            let cell = cell();
            let (image, _) = cell.minimum_image(d);
            let length = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
            for code in 0..27 {
                let s = cell.shift_vector(code);
                let other = [image[0] - s[0], image[1] - s[1], image[2] - s[2]];
                // Equal lengths at half a period may differ by the rounding of a few operations of size 3.
                prop_assert!(length(image) <= length(other) + 1e-14);
            }
        }
    }
}
