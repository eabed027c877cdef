//! Elementary functions as generated code calls them: the platform's with `std`, pure Rust otherwise.

macro_rules! elementary {
    ($($name:ident $libm:ident)*) => {$(
        #[doc = concat!("`", stringify!($name), "` of the configured source.")]
        #[inline(always)]
        pub fn $name(x: f64) -> f64 {
            #[cfg(all(feature = "std", not(feature = "strict")))]
            { x.$name() }
            #[cfg(any(not(feature = "std"), feature = "strict"))]
            { libm::$libm(x) }
        }
    )*};
}

elementary! {
    sqrt sqrt
    sin sin cos cos tan tan
    asin asin acos acos atan atan
    exp exp ln log
    sinh sinh cosh cosh tanh tanh
    cbrt cbrt
}

/// `|x|`.
#[inline(always)]
pub fn abs(x: f64) -> f64 {
    f64::abs(x)
}

/// Sine and cosine of one angle.
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    (sin(x), cos(x))
}

/// The angle of the point `(x, y)`, in (-pi, pi].
#[inline(always)]
pub fn atan2(y: f64, x: f64) -> f64 {
    #[cfg(all(feature = "std", not(feature = "strict")))]
    {
        y.atan2(x)
    }
    #[cfg(any(not(feature = "std"), feature = "strict"))]
    {
        libm::atan2(y, x)
    }
}

/// `x^e` for an exponent that is neither an integer nor a half.
#[inline(always)]
pub fn powf(x: f64, e: f64) -> f64 {
    #[cfg(all(feature = "std", not(feature = "strict")))]
    {
        x.powf(e)
    }
    #[cfg(any(not(feature = "std"), feature = "strict"))]
    {
        libm::pow(x, e)
    }
}
