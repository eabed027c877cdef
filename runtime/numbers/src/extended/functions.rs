//! Elementary functions in 6 doubles, more than any result has after rounding.
//!
//! Exponentials and sines are sums of their series after argument reduction. Their inverses follow by Newton's method
//! or a similar method of third order. Infinite values, NaN and jumps agree with those of `f64`, except for angles
//! beyond `2^50`.

use core::f64::consts;

use super::number::Extended;
use crate::math;

/// The numbers in which functions are computed.
pub(super) type Wide = Extended<6>;

/// Half of pi.
const HALF_PI: Wide = Wide::constant_of([
    consts::FRAC_PI_2,
    6.123233995736766e-17,
    -1.4973849048591698e-33,
    5.562271104316826e-50,
    2.836115989820158e-66,
    8.724931080676243e-84,
]);

/// The natural logarithm of 2.
const LN_2: Wide = Wide::constant_of([
    consts::LN_2,
    2.3190468138462996e-17,
    5.707708438416212e-34,
    -3.5824322106018114e-50,
    -1.352169675798863e-66,
    6.080638740240814e-83,
]);

const ONE: Wide = Wide::plain(1.0);

/// Largest angle that is reduced, `2^50`. Sine and cosine of larger angles are NaN.
const LARGEST_ANGLE: f64 = (1_u64 << 50) as f64;

/// Number of halvings of the argument of an exponential before its series is summed.
const HALVINGS: u32 = 8;

/// Below this magnitude, hyperbolic functions follow from `e^x - 1`.
const SMALL: f64 = 0.25;

/// Number of steps of a method of third order. Its start is a double: 53 bits become 159, then 477.
const STEPS: u32 = 2;

/// The nearest integer of a number below `2^51`.
fn rounded(x: f64) -> f64 {
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    (x + SHIFT) - SHIFT
}

/// `2^exponent`, for exponents of normal numbers.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + i64::from(exponent)) as u64) << 52)
}

/// The exponent of a positive finite number.
fn exponent_of(x: f64) -> i32 {
    let exponent = |x: f64| ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    match x < f64::MIN_POSITIVE {
        true => exponent(x * power_of_two(54)) - 54,
        false => exponent(x),
    }
}

/// A number times `2^exponent`, over the whole range.
fn shifted(x: Wide, exponent: i32) -> Wide {
    let half = exponent / 2;
    x.scaled(power_of_two(half))
        .scaled(power_of_two(exponent - half))
}

/// Sum of a series to the last digit. Term `k` is the term before it times `factor / divisor(k)`; term 0 is `first`.
fn series(first: Wide, factor: Wide, mut divisor: impl FnMut(u32) -> f64) -> Wide {
    let (mut sum, mut term) = (first, first);
    for k in 1.. {
        term = term * factor / Wide::plain(divisor(k));
        if term.nearest().abs() <= Wide::ROUNDING * sum.nearest().abs() {
            break;
        }
        sum = sum + term;
    }
    sum
}

/// `e^x - 1` for `|x| < 1`.
fn exp_less_one(x: Wide) -> Wide {
    if x.nearest() == 0.0 {
        return x;
    }
    let part = x.scaled(power_of_two(-(HALVINGS as i32)));
    let mut power = series(part, part, |k| f64::from(k + 1));
    for _ in 0..HALVINGS {
        power = power.fused(power, power.scaled(2.0));
    }
    power
}

pub(super) fn exp(x: Wide) -> Wide {
    /// Beyond this magnitude, `e^x` is infinite or 0.
    const RANGE: f64 = 750.0;
    let leading = x.nearest();
    if leading.is_nan() || leading.abs() > RANGE {
        return Wide::plain(math::exp(leading));
    }
    let twos = rounded(leading * consts::LOG2_E);
    let rest = LN_2.fused(Wide::plain(-twos), x);
    shifted(exp_less_one(rest) + ONE, twos as i32)
}

pub(super) fn ln(x: Wide) -> Wide {
    let leading = x.nearest();
    if !(leading > 0.0 && leading.is_finite()) {
        return Wide::plain(math::ln(leading));
    }
    let mut twos = exponent_of(leading);
    let mut mantissa = shifted(x, -twos);
    if mantissa.nearest() > consts::SQRT_2 {
        twos += 1;
        mantissa = mantissa.scaled(0.5);
    }
    let mut logarithm = Wide::plain(math::ln(mantissa.nearest()));
    for _ in 0..STEPS {
        let power = exp(logarithm);
        logarithm = logarithm + (mantissa - power).scaled(2.0) / (mantissa + power);
    }
    LN_2.fused(Wide::plain(f64::from(twos)), logarithm)
}

/// `ln(1 + x)`. For a small argument it takes steps of third order, because a sum with 1 would lose the last digits.
pub(super) fn log1p(x: Wide) -> Wide {
    /// Below this magnitude, the square of the argument is negligible relative to it: `2^-400`.
    const NEGLIGIBLE: f64 = f64::from_bits((1023 - 400) << 52);
    let size = x.nearest().abs();
    if size < NEGLIGIBLE {
        return x;
    }
    // NOTE: NaN is not small either.
    let is_small = size < SMALL;
    if !is_small {
        return ln(ONE + x);
    }
    let mut logarithm = Wide::plain(math::log1p(x.nearest()));
    for _ in 0..STEPS {
        let power = exp_less_one(logarithm);
        logarithm = logarithm + (x - power).scaled(2.0) / (x + power + Wide::plain(2.0));
    }
    logarithm
}

/// Least size from which every double is an even integer: `2^53`.
const EVEN: f64 = 9_007_199_254_740_992.0;

/// The power. It agrees with `f64` if base or exponent is 0 or not finite. A negative base with a fractional exponent
/// gives NaN.
pub(super) fn power(base: Wide, exponent: Wide) -> Wide {
    let (x, e) = (base.nearest(), exponent.nearest());
    if x == 0.0 || e == 0.0 || !x.is_finite() || !e.is_finite() {
        return Wide::plain(math::powf(x, e));
    }
    if x > 0.0 {
        return exp(exponent * ln(base));
    }
    // Doubles from 2^53 on are even; the others fit into an integer.
    let is_large = e.abs() >= EVEN;
    let is_whole = is_large || (e as i64) as f64 == e;
    if !is_whole || exponent != Wide::plain(e) {
        return Wide::plain(f64::NAN);
    }
    let size = exp(exponent * ln(-base));
    match is_large || (e as i64) % 2 == 0 {
        true => size,
        false => -size,
    }
}

pub(super) fn sin_cos(x: Wide) -> (Wide, Wide) {
    let leading = x.nearest();
    // This comparison is false for NaN.
    let is_reduced = leading.abs() <= LARGEST_ANGLE;
    if !is_reduced {
        return (Wide::plain(f64::NAN), Wide::plain(f64::NAN));
    }
    let quarters = rounded(leading * consts::FRAC_2_PI);
    let rest = HALF_PI.fused(Wide::plain(-quarters), x);
    let square = -(rest * rest);
    let sine = match rest.nearest() == 0.0 {
        true => rest,
        false => series(rest, square, |k| f64::from(2 * k * (2 * k + 1))),
    };
    let cosine = series(ONE, square, |k| f64::from((2 * k - 1) * 2 * k));
    // NOTE: `quarters` is an integer, so that the conversion is exact.
    match (quarters as i64).rem_euclid(4) {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

pub(super) fn sin(x: Wide) -> Wide {
    sin_cos(x).0
}

pub(super) fn cos(x: Wide) -> Wide {
    sin_cos(x).1
}

pub(super) fn tan(x: Wide) -> Wide {
    let (sine, cosine) = sin_cos(x);
    sine / cosine
}

pub(super) fn atan2(y: Wide, x: Wide) -> Wide {
    let [b, a] = [y.nearest(), x.nearest()];
    if b.is_nan() || a.is_nan() {
        return Wide::plain(f64::NAN);
    }
    let is_regular = |number: f64| number != 0.0 && number.is_finite();
    if !(is_regular(b) && is_regular(a)) {
        // The angle is a multiple of an eighth of a turn.
        let eighths = rounded(math::atan2(b, a) * (2.0 * consts::FRAC_2_PI));
        return match eighths == 0.0 {
            true => Wide::plain(math::atan2(b, a)),
            false => HALF_PI * Wide::plain(0.5 * eighths),
        };
    }
    let twos = -exponent_of(b.abs().max(a.abs()));
    let [y, x] = [shifted(y, twos), shifted(x, twos)];
    let radius = (x * x + y * y).root();
    let [sine, cosine] = [y / radius, x / radius];
    let mut angle = Wide::plain(math::atan2(b, a));
    for _ in 0..STEPS {
        let (s, c) = sin_cos(angle);
        // Sine of the difference between the angle and its approximation.
        angle = angle + (sine * c - cosine * s);
    }
    angle
}

pub(super) fn atan(x: Wide) -> Wide {
    // A zero keeps its sign.
    if x.nearest() == 0.0 {
        return x;
    }
    atan2(x, ONE)
}

pub(super) fn asin(x: Wide) -> Wide {
    atan2(x, cosine_of_asin(x))
}

pub(super) fn acos(x: Wide) -> Wide {
    atan2(cosine_of_asin(x), x)
}

fn cosine_of_asin(x: Wide) -> Wide {
    ((ONE - x) * (ONE + x)).root()
}

/// `e^x / 2`, which may be finite where `e^x` is not, and `e^-x / 2`.
fn halves(x: Wide) -> [Wide; 2] {
    let root = exp(x.scaled(0.5));
    let half = root.scaled(0.5) * root;
    [half, Wide::plain(0.25) / half]
}

/// Value of an odd function, given for positive arguments.
fn odd(x: Wide, function: impl Fn(Wide) -> Wide) -> Wide {
    match x.is_negative() {
        true => -function(-x),
        false => function(x),
    }
}

pub(super) fn sinh(x: Wide) -> Wide {
    if x.nearest().abs() < SMALL {
        let power = exp_less_one(x);
        return (power + power / (power + ONE)).scaled(0.5);
    }
    odd(x, |x| {
        let [half, inverse] = halves(x);
        half - inverse
    })
}

pub(super) fn cosh(x: Wide) -> Wide {
    let x = if x.is_negative() { -x } else { x };
    let [half, inverse] = halves(x);
    half + inverse
}

pub(super) fn tanh(x: Wide) -> Wide {
    if x.nearest().abs() < SMALL {
        let power = exp_less_one(x.scaled(2.0));
        return power / (power + Wide::plain(2.0));
    }
    odd(x, |x| {
        let power = exp(x.scaled(-2.0));
        (ONE - power) / (ONE + power)
    })
}

pub(super) fn asinh(x: Wide) -> Wide {
    /// Squares of larger arguments may overflow. For them, 1 is negligible relative to the square.
    const LARGE: f64 = 1e150;
    odd(x, |x| match x.nearest() {
        leading if leading < SMALL => small_asinh(x),
        leading if leading > LARGE => ln(x) + LN_2,
        _ => ln(x + (x * x + ONE).root()),
    })
}

/// Inverse hyperbolic sine of a small argument, by steps of third order. A sum with 1 would lose the last digits.
fn small_asinh(x: Wide) -> Wide {
    let mut argument = Wide::plain(math::asinh(x.nearest()));
    for _ in 0..STEPS {
        let (sine, slope) = (sinh(argument), cosh(argument));
        let missing = (x - sine) / slope;
        // asinh(sine + d) = argument + d/slope - sine (d/slope)^2 / (2 slope) + ..
        argument = argument + (missing - (sine / slope).scaled(0.5) * missing * missing);
    }
    argument
}
