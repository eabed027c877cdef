//! Elementary functions as generated code calls them: correctly rounded with `strict`, the platform's with `std`, pure
//! Rust otherwise.
//!
//! All other operations of a run are additions, multiplications, divisions and square roots, which are correctly
//! rounded by definition. Rust executes them in the order in which they are written and never contracts them;
//! [`mul_add`] contracts only without `strict`. With `strict` a run therefore has the same bits on every machine.

macro_rules! elementary {
    ($($visible:vis $name:ident($($argument:ident),+) = $platform:ident, $rust:ident, $rounded:ident;)*) => {$(
        #[doc = concat!("`", stringify!($name), "` of the configured source.")]
        #[inline(always)]
        $visible fn $name($($argument: f64),+) -> f64 {
            #[cfg(feature = "strict")]
            { core_math::$rounded($($argument),+) }
            #[cfg(all(feature = "std", not(feature = "strict")))]
            { f64::$platform($($argument),+) }
            #[cfg(not(any(feature = "std", feature = "strict")))]
            { libm::$rust($($argument),+) }
        }
    )*};
}

elementary! {
    pub sin(x) = sin, sin, sin;
    pub cos(x) = cos, cos, cos;
    pub tan(x) = tan, tan, tan;
    pub asin(x) = asin, asin, asin;
    pub acos(x) = acos, acos, acos;
    pub atan(x) = atan, atan, atan;
    angle(y, x) = atan2, atan2, atan2;
    pub exp(x) = exp, exp, exp;
    pub ln(x) = ln, log, log;
    pub log1p(x) = ln_1p, log1p, log1p;
    pub sinh(x) = sinh, sinh, sinh;
    pub cosh(x) = cosh, cosh, cosh;
    pub tanh(x) = tanh, tanh, tanh;
    pub asinh(x) = asinh, asinh, asinh;
    pub cbrt(x) = cbrt, cbrt, cbrt;
    pub powf(x, e) = powf, pow, pow;
}

/// The angle of the point `(x, y)`, in `(-pi, pi]`. A zero of either sign counts as 0, so that the angle on the cut is `pi`.
#[inline(always)]
pub fn atan2(y: f64, x: f64) -> f64 {
    angle(y + 0.0, x + 0.0)
}

/// The square root, which is correctly rounded everywhere.
#[inline(always)]
pub fn sqrt(x: f64) -> f64 {
    #[cfg(feature = "std")]
    {
        x.sqrt()
    }
    #[cfg(not(feature = "std"))]
    {
        libm::sqrt(x)
    }
}

/// `a b + c`. It is rounded once if the processor has a fused instruction and `strict` is off, else twice.
#[inline(always)]
pub fn mul_add(a: f64, b: f64, c: f64) -> f64 {
    #[cfg(all(target_feature = "fma", feature = "std", not(feature = "strict")))]
    {
        a.mul_add(b, c)
    }
    #[cfg(not(all(target_feature = "fma", feature = "std", not(feature = "strict"))))]
    {
        a * b + c
    }
}

/// The largest integer not above a number.
#[inline(always)]
pub fn floor(x: f64) -> f64 {
    #[cfg(feature = "std")]
    {
        x.floor()
    }
    #[cfg(not(feature = "std"))]
    {
        libm::floor(x)
    }
}

/// `|x|`.
#[inline(always)]
pub fn abs(x: f64) -> f64 {
    f64::abs(x)
}

/// The larger of two numbers; NaN if one of them is NaN. (`f64::max` drops NaN: the largest of several errors would
/// hide an undefined one.)
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// Sine and cosine of one angle.
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    (sin(x), cos(x))
}
