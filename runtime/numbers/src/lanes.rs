//! SIMD vectors as numbers: each of eight lanes holds a number of one motion.

use wide::f64x8;

use crate::numbers::{Numbers, functions_of_lanes, sign_of};

impl Numbers for f64x8 {
    const LANES: usize = 8;
    const ZERO: Self = Self::ZERO;

    #[inline(always)]
    fn of(number: f64) -> Self {
        Self::splat(number)
    }

    #[inline(always)]
    fn gathered(of_lane: impl FnMut(usize) -> f64) -> Self {
        Self::new(core::array::from_fn(of_lane))
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        self.as_array()[lane]
    }

    #[inline(always)]
    fn is_below_zero(&self) -> Option<bool> {
        let first = sign_of(self.lane(0));
        let agree = (1..Self::LANES).all(|lane| sign_of(self.lane(lane)) == first);
        first.filter(|_| agree)
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        #[cfg(all(target_feature = "fma", feature = "std", not(feature = "strict")))]
        {
            Self::mul_add(self, b, c)
        }
        #[cfg(not(all(target_feature = "fma", feature = "std", not(feature = "strict"))))]
        {
            self * b + c
        }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self::abs(self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::fast_max(self, other)
    }

    functions_of_lanes!();
}
