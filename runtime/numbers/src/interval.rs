//! Closed intervals of doubles that contain every value of the quantity they enclose.
//!
//! Sums, products, quotients and square roots of doubles are correctly rounded, so that one unit in the last place
//! outwards encloses them. Elementary functions are those of `libm` on every machine. Their error is below two units in
//! the last place, and they are widened by four units. Ends may be infinite, and are never NaN: a quantity that may
//! have no value is [`Interval::WHOLE`].
//!
//! Reference: R. E. Moore, R. B. Kearfott, M. J. Cloud, *Introduction to Interval Analysis* (2009), chapters 2 and 5.

mod functions;

use core::f64::consts::PI;
use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::math;

/// Unit in the last place of 1. It bounds the unit in the last place of every normal number, relative to the number.
const ULP: f64 = f64::EPSILON;

/// Relative widening of an elementary function's value: at least four units in the last place.
const CALL: f64 = 4.0 * ULP;

/// For arguments beyond this magnitude, sines and cosines are enclosed by `[-1, 1]`.
const FAR: f64 = 1e9;

/// All numbers from `lo` to `hi`.
///
/// # Examples
///
/// ```
/// use dalembert_numbers::{Interval, Numbers};
///
/// let x = Interval::new(1.0, 2.0);
/// let product = x * x - Interval::point(5.0);
/// assert!(product.contains(Interval::new(-4.0, -1.0)) && product.excludes_zero());
/// assert!(x.sin().contains(Interval::point(1.5_f64.sin())));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub lo: f64,
    /// The upper end.
    pub hi: f64,
}

impl Interval {
    /// All real numbers; also the enclosure of a quantity that may have no value.
    pub const WHOLE: Self = Self {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
    };

    /// The interval from `lo` to `hi`. `lo` must not exceed `hi`.
    #[inline(always)]
    pub const fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    /// One number.
    #[inline(always)]
    pub const fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// The smallest interval that contains two numbers.
    #[inline(always)]
    pub fn between(a: f64, b: f64) -> Self {
        Self::new(a.min(b), a.max(b))
    }

    /// The smallest interval that contains both intervals.
    #[must_use]
    #[inline(always)]
    pub fn hull(self, other: Self) -> Self {
        Self::new(self.lo.min(other.lo), self.hi.max(other.hi))
    }

    /// The numbers that are in both intervals; `None` if there are none.
    #[must_use]
    #[inline(always)]
    pub fn intersection(self, other: Self) -> Option<Self> {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        (lo <= hi).then_some(Self::new(lo, hi))
    }

    /// True if 0 is not in the interval.
    #[inline(always)]
    pub fn excludes_zero(self) -> bool {
        self.lo > 0.0 || self.hi < 0.0
    }

    /// True if the interval is 0 alone.
    #[inline(always)]
    pub fn is_zero(self) -> bool {
        self.lo == 0.0 && self.hi == 0.0
    }

    /// True if all of `other` is in this interval.
    #[inline(always)]
    pub fn contains(self, other: Self) -> bool {
        self.lo <= other.lo && other.hi <= self.hi
    }

    /// The largest absolute value.
    #[inline(always)]
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The smallest absolute value.
    pub fn mignitude(self) -> f64 {
        match self.excludes_zero() {
            true => self.lo.abs().min(self.hi.abs()),
            false => 0.0,
        }
    }

    /// `hi - lo`, rounded.
    #[inline(always)]
    pub fn width(self) -> f64 {
        self.hi - self.lo
    }

    /// A number in the interval, the middle up to rounding; 0 or the end nearest to it if an end is infinite.
    #[inline(always)]
    pub fn middle(self) -> f64 {
        let middle = 0.5 * self.lo + 0.5 * self.hi;
        match middle.is_finite() {
            true => middle.clamp(self.lo, self.hi),
            false => 0.0_f64.clamp(self.lo, self.hi),
        }
    }

    /// All numbers with a distance of at most `radius` from the interval.
    #[must_use]
    #[inline(always)]
    pub fn widened(self, radius: f64) -> Self {
        self.widened_by(radius, radius)
    }

    /// All numbers that lie at most `down` below the interval and at most `up` above it.
    #[must_use]
    #[inline(always)]
    pub(crate) fn widened_by(self, down: f64, up: f64) -> Self {
        outwards(self.lo - down, self.hi + up, ULP)
    }

    /// An enclosure of pi.
    pub const fn pi() -> Self {
        Self::new(PI, PI.next_up())
    }

    /// An enclosure of the range of a non-decreasing function that `libm` computes.
    #[must_use]
    #[inline(always)]
    pub fn increasing(self, function: impl Fn(f64) -> f64) -> Self {
        widest(function(self.lo), function(self.hi), CALL)
    }

    /// Values of the interval that lie below `least`, raised to it.
    #[must_use]
    #[inline(always)]
    pub(crate) fn at_least(self, least: f64) -> Self {
        Self::new(self.lo.max(least), self.hi.max(least))
    }

    /// The intersection with `[lo, hi]`. It must not be empty.
    #[must_use]
    #[inline(always)]
    pub fn within(self, lo: f64, hi: f64) -> Self {
        Self::new(self.lo.clamp(lo, hi), self.hi.clamp(lo, hi))
    }

    /// True for [`Interval::WHOLE`]: all real numbers, or possibly no value.
    #[inline(always)]
    pub fn is_whole(self) -> bool {
        self.lo == f64::NEG_INFINITY && self.hi == f64::INFINITY
    }

    /// `1 / a`. With 0 as an end the result is infinite on one side; with 0 inside, and for 0 itself, it is
    /// [`Interval::WHOLE`].
    #[must_use]
    #[inline(always)]
    pub fn inverse(self) -> Self {
        if self.lo > 0.0 || self.hi < 0.0 {
            return widest(1.0 / self.hi, 1.0 / self.lo, ULP);
        }
        match (self.lo == 0.0, self.hi == 0.0) {
            (true, false) => Self::new(widest(1.0 / self.hi, 1.0 / self.hi, ULP).lo, f64::INFINITY),
            (false, true) => Self::new(
                f64::NEG_INFINITY,
                widest(1.0 / self.lo, 1.0 / self.lo, ULP).hi,
            ),
            _ => Self::WHOLE,
        }
    }

    /// An enclosure of the range of a sine or cosine with a maximum at `crest`.
    fn wave(self, function: fn(f64) -> f64, crest: f64) -> Self {
        // A longer interval contains both extreme values, or nearly so.
        let is_short = self.magnitude() <= FAR && self.hi - self.lo <= 6.2;
        if !is_short {
            return Self::new(-1.0, 1.0);
        }
        const MARGIN: f64 = 1e-6;
        const TURN: f64 = 2.0 * PI;
        let meets = |place: f64| {
            let turns = -math::floor((place - self.lo + MARGIN) / TURN);
            place + turns * TURN <= self.hi + MARGIN
        };
        let (a, b) = (function(self.lo), function(self.hi));
        let ends = widest(a.min(b), a.max(b), CALL);
        Self::new(
            if meets(crest + PI) {
                -1.0
            } else {
                ends.lo.max(-1.0)
            },
            if meets(crest) { 1.0 } else { ends.hi.min(1.0) },
        )
    }
}

/// The interval between two numbers, each moved outwards by the fraction `part` of its magnitude.
///
/// This suffices for sums, which are exact if they underflow.
#[inline(always)]
fn outwards(lo: f64, hi: f64, part: f64) -> Interval {
    let (lo, hi) = (lo - lo.abs() * part, hi + hi.abs() * part);
    // This comparison is false for NaN.
    match lo <= hi {
        true => Interval::new(lo, hi),
        false => Interval::WHOLE,
    }
}

/// Same as [`outwards`], plus the smallest normal number, which exceeds the error of a product that underflows.
#[inline(always)]
fn widest(lo: f64, hi: f64, part: f64) -> Interval {
    let (lo, hi) = (
        lo - (lo.abs() * part + f64::MIN_POSITIVE),
        hi + (hi.abs() * part + f64::MIN_POSITIVE),
    );
    match lo <= hi {
        true => Interval::new(lo, hi),
        false => Interval::WHOLE,
    }
}

impl Add for Interval {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        outwards(self.lo + other.lo, self.hi + other.hi, ULP)
    }
}

impl Sub for Interval {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        outwards(self.lo - other.hi, self.hi - other.lo, ULP)
    }
}

impl Neg for Interval {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.hi, -self.lo)
    }
}

impl Mul for Interval {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let ends = [
            self.lo * other.lo,
            self.lo * other.hi,
            self.hi * other.lo,
            self.hi * other.hi,
        ];
        // A NaN is found below.
        let least = |a: f64, b: f64| if a < b { a } else { b };
        let largest = |a: f64, b: f64| if a > b { a } else { b };
        let lo = least(least(ends[0], ends[1]), least(ends[2], ends[3]));
        let hi = largest(largest(ends[0], ends[1]), largest(ends[2], ends[3]));
        let is_finite = (ends[0] + ends[1] + ends[2] + ends[3]).abs() < f64::INFINITY;
        match is_finite {
            true => {
                // Products of non-negative numbers stay non-negative in spite of rounding.
                let product = widest(lo, hi, ULP);
                match self.lo >= 0.0 && other.lo >= 0.0 {
                    true => Self::new(product.lo.max(0.0), product.hi),
                    false => product,
                }
            }
            false => far_product(self, other),
        }
    }
}

/// A product with an infinite end. An infinite end stands for all large numbers, so that its product with 0 is 0. A
/// product with a quantity that may have no value is the whole line.
#[cold]
fn far_product(a: Interval, b: Interval) -> Interval {
    if a.is_whole() || b.is_whole() {
        return Interval::WHOLE;
    }
    let times = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
    let ends = [
        times(a.lo, b.lo),
        times(a.lo, b.hi),
        times(a.hi, b.lo),
        times(a.hi, b.hi),
    ];
    let lo = ends.into_iter().fold(f64::INFINITY, f64::min);
    let hi = ends.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let (lo, hi) = (
        if lo.is_finite() {
            widest(lo, lo, ULP).lo
        } else {
            lo
        },
        if hi.is_finite() {
            widest(hi, hi, ULP).hi
        } else {
            hi
        },
    );
    match lo == f64::INFINITY || hi == f64::NEG_INFINITY {
        // All end points overflow.
        true => Interval::new(lo.min(f64::MAX), hi.max(f64::MIN)),
        false => Interval::new(lo, hi),
    }
}

impl Div for Interval {
    type Output = Self;

    // The quotient is the product with the inverse.
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self * other.inverse()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::bent::Bent;
    use crate::complex_interval::ComplexInterval;
    use crate::everywhere::Everywhere;
    use crate::numbers::Numbers;
    use crate::rated::Rated;
    use crate::taylor_model::TaylorModel;

    pub(crate) use complex::Complex;

    mod complex;

    /// A function of the language, over doubles and over all kinds of enclosures.
    pub(crate) struct Enclosed {
        pub(crate) name: &'static str,
        pub(crate) plain: fn(f64) -> f64,
        pub(crate) interval: fn(Interval) -> Interval,
        pub(crate) everywhere: fn(Everywhere) -> Everywhere,
        pub(crate) rated: fn(Rated) -> Rated,
        pub(crate) model: fn(TaylorModel) -> TaylorModel,
        pub(crate) bent: fn(Bent) -> Bent,
        pub(crate) complex_interval: fn(ComplexInterval) -> ComplexInterval,
        pub(crate) complex: fn(Complex) -> Complex,
        /// Ends of the domain.
        domain: [f64; 2],
    }

    /// Start and end of a path.
    pub(crate) struct Sample {
        pub(crate) from: f64,
        pub(crate) to: f64,
    }

    impl Enclosed {
        /// Paths in its domain in both directions, from single points to the whole domain.
        pub(crate) fn stretches(&self) -> impl Iterator<Item = Sample> + '_ {
            let [lo, hi] = self.domain;
            (0..=24).flat_map(move |start| {
                [0.0, 1e-9, 0.01, 0.1, 0.3, 1.0]
                    .into_iter()
                    .flat_map(move |width| {
                        let from = lo + (hi - lo) * f64::from(start) / 24.0;
                        let to = (from + width * (hi - lo)).min(hi);
                        [Sample { from, to }, Sample { from: to, to: from }]
                    })
            })
        }
    }

    macro_rules! functions {
        ($($name:literal on $lo:expr, $hi:expr => |$x:ident| $value:expr;)*) => {
            /// Every function of the language, and a few compositions.
            pub(crate) const FUNCTIONS: &[Enclosed] = &[$(Enclosed {
                name: $name,
                plain: |$x: f64| $value,
                interval: |$x: Interval| $value,
                everywhere: |$x: Everywhere| $value,
                rated: |$x: Rated| $value,
                model: |$x: TaylorModel| $value,
                bent: |$x: Bent| $value,
                complex_interval: |$x: ComplexInterval| $value,
                complex: |$x: Complex| $value,
                domain: [$lo, $hi],
            }),*];
        };
    }

    /// A constant of the same type as the first argument.
    fn like<L: Numbers>(_: L, number: f64) -> L {
        L::of(number)
    }

    functions! {
        "sqrt" on 0.001, 9.0 => |x| Numbers::sqrt(x);
        "abs" on -2.0, 2.0 => |x| Numbers::abs(x);
        "square" on -3.0, 3.0 => |x| Numbers::square(x);
        "sin" on -9.0, 9.0 => |x| Numbers::sin(x);
        "cos" on -9.0, 9.0 => |x| Numbers::cos(x);
        "tan" on -1.5, 1.5 => |x| Numbers::tan(x);
        "asin" on -0.99, 0.99 => |x| Numbers::asin(x);
        "acos" on -0.99, 0.99 => |x| Numbers::acos(x);
        "atan" on -7.0, 7.0 => |x| Numbers::atan(x);
        "exp" on -5.0, 5.0 => |x| Numbers::exp(x);
        "ln" on 0.01, 9.0 => |x| Numbers::ln(x);
        "log1p" on -0.99, 9.0 => |x| Numbers::log1p(x);
        "sinh" on -4.0, 4.0 => |x| Numbers::sinh(x);
        "cosh" on -4.0, 4.0 => |x| Numbers::cosh(x);
        "tanh" on -4.0, 4.0 => |x| Numbers::tanh(x);
        "asinh" on -7.0, 7.0 => |x| Numbers::asinh(x);
        "powf" on 0.01, 5.0 => |x| Numbers::powf(x, 1.7);
        "inverse power" on 0.01, 5.0 => |x| Numbers::powf(x, -0.4);
        "power" on 0.01, 5.0 => |x| Numbers::power(x, like(x, 0.3));
        "atan2" on -2.0, 2.0 => |x| Numbers::atan2(x - like(x, 3.0), x * x + like(x, 0.5));
        "max" on -2.0, 2.0 => |x| Numbers::max(x, like(x, 0.3) - x);
        "turned" on -2.0, 2.0 => |x| Numbers::turned(x * x - like(x, 1.0), x);
        "bump" on -3.0, 3.0 => |x| Numbers::exp(-(x * x) / like(x, 0.01));
        "quotient" on -2.0, 2.0 => |x| (x - like(x, 0.1)) / (like(x, 1.2) + x * x);
        "fused" on -2.0, 2.0 => |x| Numbers::mul_add(x, x - like(x, 1.0), like(x, 0.2));
    }

    #[test]
    fn values_lie_in_their_intervals() {
        for function in FUNCTIONS {
            for Sample { from, to } in function.stretches() {
                let range = (function.interval)(Interval::between(from, to));
                for k in 0..=16 {
                    let x = (from + (to - from) * f64::from(k) / 16.0)
                        .clamp(from.min(to), from.max(to));
                    let value = (function.plain)(x);
                    assert!(
                        range.lo <= value && value <= range.hi,
                        "{} at {x}: {value} is not in {range:?}",
                        function.name
                    );
                }
            }
        }
    }

    #[test]
    fn every_function_of_one_number_is_tried() {
        macro_rules! assert_tried {
            ($($name:ident)+) => {$(
                let is_tried = FUNCTIONS.iter().any(|function| function.name == stringify!($name));
                assert!(is_tried, "write a line for {} above", stringify!($name));
            )+};
        }
        crate::functions_of_one_number!(assert_tried);
    }

    #[test]
    fn intervals_of_single_numbers_are_narrow() {
        for function in FUNCTIONS {
            for Sample { from, .. } in function.stretches() {
                let range = (function.interval)(Interval::point(from));
                let wide = 1e-12 * (1.0 + range.magnitude());
                assert!(
                    range.width() <= wide,
                    "{} at {from}: {range:?}",
                    function.name
                );
            }
        }
    }

    #[test]
    fn different_numbers_with_equal_ranges_are_not_taken_for_one() {
        let range = Interval::new(-1.0, 1.0);
        let path = TaylorModel::exact([0.0, 1.0, 0.0, 0.0]);
        let rated = Rated::steady(range);
        let bent = Bent::line(range, 2.0);
        // A number of -1 whose sign is that of 1 stays -1.
        let turned = [
            range.turned(range),
            rated.turned(rated).value,
            path.turned(path).range(),
            bent.turned(bent).value,
            ComplexInterval::steady(range)
                .turned(ComplexInterval::steady(range))
                .real,
        ];
        for (kind, turned) in turned.into_iter().enumerate() {
            assert!(turned.lo <= -1.0 && turned.hi >= 1.0, "{kind}: {turned:?}");
        }
        let absolute = [range.abs(), rated.abs().value, bent.abs().value];
        assert!(absolute.iter().all(|values| values.lo == 0.0));
    }

    #[test]
    fn extreme_values_are_met_inside() {
        let bump = Interval::new(1.0, 2.0).sin();
        assert!(bump.hi == 1.0 && bump.lo > 0.8);
        let dip = Interval::new(3.0, 4.0).cos();
        assert!(dip.lo == -1.0 && dip.hi < -0.6);
    }

    #[test]
    fn infinite_ends_are_carried() {
        let ray = Interval::new(2.0, f64::INFINITY);
        assert!((ray * Interval::ZERO).magnitude() <= f64::MIN_POSITIVE);
        let square = ray.square();
        assert!(square.lo > 3.99 && square.hi == f64::INFINITY);
        assert!(ray.inverse().lo <= 0.0 && ray.inverse().hi > 0.5);
        assert!(Interval::new(-1.0, 1.0).inverse().is_whole());
        assert!((Interval::WHOLE * Interval::ZERO).is_whole());
        let large = Interval::new(1e200, 1e201);
        assert!((large * large).hi == f64::INFINITY && (large * large).lo >= 1e308);
    }

    #[test]
    fn zero_is_kept_where_rounding_cannot_reach_it() {
        let sum = Interval::ZERO.square() + Interval::ZERO.square();
        assert!(sum.lo >= 0.0 && !sum.sqrt().is_whole());
    }
}
