//! The numbers of kernels and Taylor series: one number, or several in SIMD lanes.
//!
//! Generated series are written once, over [`Numbers`]. With `f64` they are the series of one motion. With several
//! lanes they are the series of one motion in each lane. Every lane has the same bits as a computation over `f64`,
//! independent of the other lanes.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::math;

pub use crate::bent::Bent;
pub use crate::complex_interval::ComplexInterval;
pub use crate::everywhere::Everywhere;
pub use crate::interval::Interval;
pub use crate::rated::Rated;
pub use crate::taylor_model::TaylorModel;

/// Pi in four parts, for [`Numbers::constant`].
pub const PI: [f64; 4] = [
    core::f64::consts::PI,
    1.2246467991473532e-16,
    -2.9947698097183397e-33,
    1.1124542208633653e-49,
];

/// Number of coefficients of a series: orders 0 to 32.
pub const LENGTH: usize = 33;

/// `1 / k` for each `k`; 0 for `k = 0`.
pub const INVERSES: [f64; LENGTH] = {
    let mut inverses = [0.0; LENGTH];
    let mut k = 1;
    while k < LENGTH {
        inverses[k] = 1.0 / k as f64;
        k += 1;
    }
    inverses
};

/// One number, or one number in each of several lanes.
///
/// # Examples
///
/// ```
/// use dalembert_numbers::{Extended, Interval, Numbers};
///
/// /// `x^2 - 2`, over any kind of number.
/// fn gap<L: Numbers>(x: L) -> L {
///     x * x - L::of(2.0)
/// }
///
/// assert_eq!(gap(1.5), 0.25);
/// assert!(gap(Interval::new(1.0, 1.25)).excludes_zero());
/// assert_eq!(gap(Extended::<2>::from(1.5)).nearest(), 0.25);
/// ```
pub trait Numbers:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Number of lanes.
    const LANES: usize;

    /// Zero in every lane.
    const ZERO: Self;

    /// The same number in every lane.
    fn of(number: f64) -> Self;

    /// The sum of `parts` as a constant. Each part must be the double nearest to the sum of itself and all later parts.
    /// Number types of double precision use the first part only.
    #[inline(always)]
    fn constant(parts: [f64; 4]) -> Self {
        Self::of(parts[0])
    }

    /// `1 / k`, for `k` up to 32.
    #[inline(always)]
    fn inverse(k: usize) -> Self {
        Self::of(INVERSES[k])
    }

    /// The number with the value `of_lane(lane)` in each lane.
    fn gathered(of_lane: impl FnMut(usize) -> f64) -> Self;

    /// The value in a lane.
    fn lane(&self, lane: usize) -> f64;

    /// True if the number is below 0, false if it is not; `None` if lanes differ, or if the sign is uncertain.
    fn is_below_zero(&self) -> Option<bool>;

    /// `self b + c`, rounded as [`math::mul_add`] does.
    #[must_use]
    fn mul_add(self, b: Self, c: Self) -> Self;

    /// The square root.
    #[must_use]
    fn sqrt(self) -> Self;

    /// `|x|`
    #[must_use]
    fn abs(self) -> Self;

    /// The larger of two numbers.
    #[must_use]
    fn max(self, other: Self) -> Self;

    /// Sine and cosine.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }

    /// The square. The square of an interval is never negative; `self * self` may be.
    #[must_use]
    #[inline(always)]
    fn square(self) -> Self {
        self * self
    }

    /// `self`, negated where `sign` is negative.
    #[must_use]
    fn turned(self, sign: Self) -> Self;

    /// The polar angle of the point `(x, self)`.
    #[must_use]
    fn atan2(self, x: Self) -> Self;

    /// The power with a constant exponent.
    #[must_use]
    fn powf(self, exponent: f64) -> Self;

    /// The power with a constant exponent that is not a double.
    #[must_use]
    fn power(self, exponent: Self) -> Self;

    /// Sine.
    #[must_use]
    fn sin(self) -> Self;

    /// Cosine.
    #[must_use]
    fn cos(self) -> Self;

    /// Tangent.
    #[must_use]
    fn tan(self) -> Self;

    /// Arc sine.
    #[must_use]
    fn asin(self) -> Self;

    /// Arc cosine.
    #[must_use]
    fn acos(self) -> Self;

    /// Arc tangent.
    #[must_use]
    fn atan(self) -> Self;

    /// The exponential.
    #[must_use]
    fn exp(self) -> Self;

    /// The natural logarithm.
    #[must_use]
    fn ln(self) -> Self;

    /// The natural logarithm of `1 + self`, without loss of digits for small numbers.
    #[must_use]
    fn log1p(self) -> Self;

    /// Hyperbolic sine.
    #[must_use]
    fn sinh(self) -> Self;

    /// Hyperbolic cosine.
    #[must_use]
    fn cosh(self) -> Self;

    /// Hyperbolic tangent.
    #[must_use]
    fn tanh(self) -> Self;

    /// Inverse hyperbolic sine.
    #[must_use]
    fn asinh(self) -> Self;
}

/// Passes the names of the functions of one number to a macro, as in [`Numbers`]. Kinds of numbers that define all of
/// them by one rule use this macro.
#[doc(hidden)]
#[macro_export]
macro_rules! functions_of_one_number {
    ($($then:tt)+) => {
        $($then)+! { sin cos tan asin acos atan exp ln log1p sinh cosh tanh asinh }
    };
}

/// The functions of [`Numbers`] applied lane by lane, for numbers whose lanes are doubles.
// NOTE: these are not defaults of the trait. With defaults, a number type that lacks one of them would silently compute
// it in double precision.
macro_rules! functions_of_lanes {
    () => {
        #[inline(always)]
        fn turned(self, sign: Self) -> Self {
            Self::gathered(|lane| match sign.lane(lane) < 0.0 {
                true => -self.lane(lane),
                false => self.lane(lane),
            })
        }

        #[inline(always)]
        fn atan2(self, x: Self) -> Self {
            Self::gathered(|lane| $crate::math::atan2(self.lane(lane), x.lane(lane)))
        }

        #[inline(always)]
        fn powf(self, exponent: f64) -> Self {
            Self::gathered(|lane| $crate::math::powf(self.lane(lane), exponent))
        }

        #[inline(always)]
        fn power(self, exponent: Self) -> Self {
            <Self as $crate::Numbers>::powf(self, exponent.lane(0))
        }

        $crate::functions_of_one_number!($crate::numbers::functions_of_lanes);
    };
    ($($name:ident)+) => {$(
        #[inline(always)]
        fn $name(self) -> Self {
            Self::gathered(|lane| $crate::math::$name(self.lane(lane)))
        }
    )+};
}
pub(crate) use functions_of_lanes;

/// Functions of [`Numbers`] for number types whose constants are intervals. `steady(interval)` makes a constant.
macro_rules! constants_of_intervals {
    () => {
        #[inline(always)]
        fn of(number: f64) -> Self {
            Self::steady($crate::interval::Interval::of(number))
        }

        #[inline(always)]
        fn constant(parts: [f64; 4]) -> Self {
            Self::steady(<$crate::interval::Interval as Numbers>::constant(parts))
        }

        #[inline(always)]
        fn inverse(k: usize) -> Self {
            Self::steady(<$crate::interval::Interval as Numbers>::inverse(k))
        }

        #[inline(always)]
        fn gathered(of_lane: impl FnMut(usize) -> f64) -> Self {
            Self::steady($crate::interval::Interval::gathered(of_lane))
        }
    };
}
pub(crate) use constants_of_intervals;

/// True if a number is below 0; `None` for NaN.
#[inline(always)]
pub fn sign_of(number: f64) -> Option<bool> {
    number.partial_cmp(&0.0).map(core::cmp::Ordering::is_lt)
}

impl Numbers for f64 {
    const LANES: usize = 1;
    const ZERO: Self = 0.0;

    #[inline(always)]
    fn of(number: f64) -> Self {
        number
    }

    #[inline(always)]
    fn gathered(mut of_lane: impl FnMut(usize) -> f64) -> Self {
        of_lane(0)
    }

    #[inline(always)]
    fn lane(&self, _: usize) -> f64 {
        *self
    }

    #[inline(always)]
    fn is_below_zero(&self) -> Option<bool> {
        sign_of(*self)
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        math::mul_add(self, b, c)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        math::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        math::abs(self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        f64::max(self, other)
    }

    functions_of_lanes!();
}

/// A fixed or variable number of [`Numbers`] on the stack. Arrays implement it; their length is part of the type.
///
/// # Examples
///
/// ```
/// use dalembert_numbers::numbers::Row;
///
/// let row: [f64; 3] = Row::zeros(3);
/// assert_eq!(Row::<f64>::as_slice(&row), [0.0; 3]);
/// ```
pub trait Row<L>: Copy + Debug + Send + Sync + 'static {
    /// Largest number of entries. For a row of fixed length, the number of entries.
    const CAPACITY: usize;

    /// A row of `count` zeros. If the type fixes the length, `count` is ignored.
    fn zeros(count: usize) -> Self;

    /// A row of zeros with the same length.
    #[must_use]
    #[inline(always)]
    fn zeroed(&self) -> Self {
        Self::zeros(self.as_slice().len())
    }

    /// All entries, in order.
    fn as_slice(&self) -> &[L];

    /// All entries, in order, for writing.
    fn as_mut_slice(&mut self) -> &mut [L];

    /// All entries within the capacity: those in use, then zeros. Their number is known at compile time. Linear
    /// combinations keep the zeros ([`Row::for_each_place`]).
    #[inline(always)]
    fn padded(&self) -> &[L] {
        self.as_slice()
    }

    /// Mutable form of [`Row::padded`]. The entries after those in use must stay 0.
    #[inline(always)]
    fn padded_mut(&mut self) -> &mut [L] {
        self.as_mut_slice()
    }

    /// Calls `at` with the indices of the entries, and of those that fill their last block ([`Row::padded`]).
    #[inline(always)]
    fn for_each_place(&self, mut at: impl FnMut(usize)) {
        for i in 0..self.padded().len() {
            at(i);
        }
    }
}

impl<L: Numbers, const D: usize> Row<L> for [L; D] {
    const CAPACITY: usize = D;

    #[inline(always)]
    fn zeros(_: usize) -> Self {
        [L::ZERO; D]
    }

    #[inline(always)]
    fn as_slice(&self) -> &[L] {
        self
    }

    #[inline(always)]
    fn as_mut_slice(&mut self) -> &mut [L] {
        self
    }
}
