//! Values and derivatives of the functions of one number, each written once for all numbers that carry derivatives:
//! [`crate::Rated`], [`crate::Bent`] and the dual numbers of variations.

use crate::interval::Interval;
use crate::numbers::Numbers;

/// A number at which functions are differentiated: a double, or an interval that holds all arguments.
///
/// # Examples
///
/// ```
/// use dalembert_numbers::Interval;
/// use dalembert_numbers::smooth::Smooth;
///
/// assert_eq!(Smooth::reciprocal(4.0), 0.25);
/// assert!(Smooth::reciprocal(Interval::new(2.0, 4.0)).contains(Interval::new(0.25, 0.5)));
/// ```
pub trait Smooth: Numbers {
    /// `1 / x`
    #[must_use]
    fn reciprocal(self) -> Self;

    /// The intersection of an interval with `[lo, hi]`. A double is unchanged.
    #[must_use]
    fn within(self, lo: f64, hi: f64) -> Self;
}

impl Smooth for f64 {
    #[inline(always)]
    fn reciprocal(self) -> Self {
        1.0 / self
    }

    #[inline(always)]
    fn within(self, _: f64, _: f64) -> Self {
        self
    }
}

impl Smooth for Interval {
    #[inline(always)]
    fn reciprocal(self) -> Self {
        self.inverse()
    }

    #[inline(always)]
    fn within(self, lo: f64, hi: f64) -> Self {
        Interval::within(self, lo, hi)
    }
}

/// Functions that give the value, the first derivative, and the second on request.
macro_rules! smooth {
    ($($(#[$doc:meta])* $name:ident($x:ident) $body:block)*) => {$(
        $(#[$doc])*
        #[inline(always)]
        pub fn $name<S: Smooth>($x: S) -> (S, S, impl FnOnce() -> S) $body
    )*};
}

smooth! {
    /// `sin' = cos`
    sin(x) {
        let (sine, cosine) = x.sin_cos();
        (sine, cosine, move || -sine)
    }

    /// `cos' = -sin`
    cos(x) {
        let (sine, cosine) = x.sin_cos();
        (cosine, -sine, move || -cosine)
    }

    /// `tan' = 1 + tan^2`
    tan(x) {
        let tangent = x.tan();
        let first = S::of(1.0) + tangent.square();
        (tangent, first, move || twice(tangent * first))
    }

    /// `asin' = 1 / sqrt(1 - x^2)`
    asin(x) {
        let squared = (S::of(1.0) - x) * (S::of(1.0) + x);
        let first = squared.sqrt().reciprocal();
        (x.asin(), first, move || x * first * squared.reciprocal())
    }

    /// `acos' = -1 / sqrt(1 - x^2)`
    acos(x) {
        let squared = (S::of(1.0) - x) * (S::of(1.0) + x);
        let first = squared.sqrt().reciprocal();
        (x.acos(), -first, move || -(x * first * squared.reciprocal()))
    }

    /// `atan' = 1 / (1 + x^2)`
    atan(x) {
        let first = (S::of(1.0) + x.square()).reciprocal();
        (x.atan(), first, move || -twice(x * first.square()))
    }

    /// `asinh' = 1 / sqrt(1 + x^2)`
    asinh(x) {
        let squared = S::of(1.0) + x.square();
        let first = squared.sqrt().reciprocal();
        (x.asinh(), first, move || -(x * first * squared.reciprocal()))
    }

    /// `exp' = exp`
    exp(x) {
        let power = x.exp();
        (power, power, move || power)
    }

    /// `ln' = 1 / x`
    ln(x) {
        let first = x.reciprocal();
        (x.ln(), first, move || -first.square())
    }

    /// `log1p' = 1 / (1 + x)`
    log1p(x) {
        let first = (S::of(1.0) + x).reciprocal();
        (x.log1p(), first, move || -first.square())
    }

    /// `sinh' = cosh`
    sinh(x) {
        let (sine, cosine) = (x.sinh(), x.cosh());
        (sine, cosine, move || sine)
    }

    /// `cosh' = sinh`
    cosh(x) {
        let (sine, cosine) = (x.sinh(), x.cosh());
        (cosine, sine, move || cosine)
    }

    /// `tanh' = 1 - tanh^2`
    tanh(x) {
        let tangent = x.tanh();
        let first = ((S::of(1.0) - tangent) * (S::of(1.0) + tangent)).within(0.0, 1.0);
        (tangent, first, move || -twice(tangent * first))
    }
}

#[inline(always)]
fn twice<S: Numbers>(x: S) -> S {
    x + x
}

/// The functions of one number for a type with one derivative, from its `value` and `chain(value, first)`.
#[doc(hidden)]
#[macro_export]
macro_rules! functions_by_first_derivatives {
    ($($name:ident)+) => {$(
        #[inline]
        fn $name(self) -> Self {
            let (value, first, _) = $crate::smooth::$name(self.value);
            self.chain(value, first)
        }
    )+};
}

/// The functions of one number for a type with two derivatives, from its `value` and `chain(value, first, second)`.
#[doc(hidden)]
#[macro_export]
macro_rules! functions_by_derivatives {
    ($($name:ident)+) => {$(
        #[inline]
        fn $name(self) -> Self {
            let (value, first, second) = $crate::smooth::$name(self.value);
            self.chain(value, first, second)
        }
    )+};
}
