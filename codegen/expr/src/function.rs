//! The functions of one argument: their table and their properties.
//!
//! A table names the functions. The matches below describe their properties, and the compiler requires an arm for each
//! function. Other number types have such matches too: residues (`modular.rs`), balls (`taylor/balls.rs`), Taylor
//! series (`taylor/expand.rs`).

use std::ops::Mul;

use crate::interval::Interval;
use crate::node::ExprId;
use crate::pool::Pool;
use crate::rational::Rational;
use crate::sign::Sign;

/// Passes the table of functions to a macro. A row has the meaning, the variant of [`Function`], and the name of the
/// method of all number types. A method that `f64` has under another name is in `Renamed`.
#[doc(hidden)]
#[macro_export]
macro_rules! with_functions {
    ($($then:tt)+) => {
        $($then)+! {
            "Sine." Sin sin
            "Cosine." Cos cos
            "Tangent." Tan tan
            "Inverse sine, in `[-pi/2, pi/2]`." Asin asin
            "Inverse cosine, in `[0, pi]`." Acos acos
            "Inverse tangent, in `(-pi/2, pi/2)`." Atan atan
            "Exponential." Exp exp
            "Natural logarithm." Ln ln
            "Natural logarithm of `1 + x`, exact for small `x`." Log1p log1p
            "Hyperbolic sine." Sinh sinh
            "Hyperbolic cosine." Cosh cosh
            "Hyperbolic tangent." Tanh tanh
            "Inverse hyperbolic sine." Asinh asinh
            "Absolute value." Abs abs
        }
    };
}

/// Functions that `f64` has under another name.
trait Renamed {
    fn log1p(self) -> Self;
}

impl Renamed for f64 {
    fn log1p(self) -> Self {
        self.ln_1p()
    }
}

macro_rules! functions {
    ($($meaning:literal $variant:ident $name:ident)*) => {
        /// The functions of one argument. The square root is the power 1/2.
        #[derive(Copy, Clone, Eq, PartialEq, Ord, PartialOrd, Hash, Debug)]
        pub enum Function {
            $(#[doc = $meaning] $variant,)*
        }

        impl Function {
            /// All functions, in the order of the enumeration.
            pub const ALL: [Self; [$($meaning),*].len()] = [$(Self::$variant),*];

            /// The name as written in expressions: `sin`, `ln`, ...
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => stringify!($name),)*
                }
            }

            /// The value in double precision; NaN or infinite outside of the domain.
            pub fn value(self, x: f64) -> f64 {
                match self {
                    $(Self::$variant => x.$name(),)*
                }
            }
        }
    };
}
with_functions!(functions);

/// LaTeX notation of a function.
pub(crate) enum Notation {
    /// A command before the argument.
    Command(&'static str),
    /// `e^x`
    PowerOfE,
    /// `|x|`
    Bars,
}

/// Symmetry under a change of sign of the argument.
#[derive(Copy, Clone, PartialEq, Eq)]
pub(crate) enum Parity {
    /// `f(-x) = -f(x)`
    Odd,
    /// `f(-x) = f(x)`
    Even,
    /// Neither odd nor even.
    Neither,
}

/// Domain of a function.
#[derive(Copy, Clone, PartialEq, Eq)]
pub(crate) enum Arguments {
    /// All numbers.
    All,
    /// All but the poles.
    OffPoles,
    /// `x > 0`
    Positive,
    /// `x > -1`
    AboveMinusOne,
    /// `-1 <= x <= 1`
    Unit,
}

/// Real arguments at which a function is not analytic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Singularity {
    /// None.
    None,
    /// The zeros of the argument plus `shift`, which is positive on the domain.
    Logarithm {
        /// 0 or 1.
        shift: u8,
    },
    /// Poles where the cosine of the argument is 0.
    Poles,
    /// Arguments -1 and 1, the ends of the domain, where the slope is infinite.
    Ends,
    /// Argument 0, where the slope jumps.
    Kink,
}

/// Monotonicity and bounds of a function over all real numbers.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub enum Course {
    /// Between -1 and 1.
    Wave,
    /// Increasing.
    Increasing,
    /// Even, and increasing with the absolute value of the argument.
    Valley,
    /// Undefined for some arguments.
    Partial,
}

/// Representation of a function modulo a prime; see `modular.rs`.
#[derive(Copy, Clone, PartialEq, Eq)]
pub(crate) enum Residue {
    /// A rational function of the half-angle tangents of base angles.
    Circular,
    /// A rational function of exponentials of base exponents.
    Exponential,
    /// One independent random residue (atom) for each value of the argument.
    Atom,
    /// The argument or its opposite.
    Branch,
}

impl Residue {
    /// True if the argument is split into multiples of base angles or exponents.
    pub(crate) fn has_base(self) -> bool {
        matches!(self, Self::Circular | Self::Exponential)
    }
}

impl Function {
    /// The function with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|function| function.name() == name)
    }

    /// The notation in LaTeX.
    pub(crate) fn notation(self) -> Notation {
        Notation::Command(match self {
            Self::Sin => r"\sin",
            Self::Cos => r"\cos",
            Self::Tan => r"\tan",
            Self::Asin => r"\arcsin",
            Self::Acos => r"\arccos",
            Self::Atan => r"\arctan",
            Self::Ln => r"\ln",
            Self::Log1p => r"\operatorname{log1p}",
            Self::Sinh => r"\sinh",
            Self::Cosh => r"\cosh",
            Self::Tanh => r"\tanh",
            Self::Asinh => r"\operatorname{arsinh}",
            Self::Exp => return Notation::PowerOfE,
            Self::Abs => return Notation::Bars,
        })
    }

    pub(crate) fn parity(self) -> Parity {
        match self {
            Self::Sin | Self::Tan | Self::Asin | Self::Atan => Parity::Odd,
            Self::Sinh | Self::Tanh | Self::Asinh => Parity::Odd,
            Self::Cos | Self::Cosh | Self::Abs => Parity::Even,
            Self::Acos | Self::Exp | Self::Ln | Self::Log1p => Parity::Neither,
        }
    }

    pub(crate) fn arguments(self) -> Arguments {
        match self {
            Self::Sin | Self::Cos | Self::Atan | Self::Asinh | Self::Abs => Arguments::All,
            Self::Exp | Self::Sinh | Self::Cosh | Self::Tanh => Arguments::All,
            Self::Tan => Arguments::OffPoles,
            Self::Ln => Arguments::Positive,
            Self::Log1p => Arguments::AboveMinusOne,
            Self::Asin | Self::Acos => Arguments::Unit,
        }
    }

    /// Monotonicity and bounds over all real numbers.
    pub fn course(self) -> Course {
        match self {
            Self::Sin | Self::Cos => Course::Wave,
            Self::Exp | Self::Sinh | Self::Tanh => Course::Increasing,
            Self::Atan | Self::Asinh => Course::Increasing,
            Self::Cosh | Self::Abs => Course::Valley,
            Self::Tan | Self::Asin | Self::Acos | Self::Ln | Self::Log1p => Course::Partial,
        }
    }

    /// The arguments at which the function is not analytic.
    pub fn singularity(self) -> Singularity {
        match self {
            Self::Sin | Self::Cos | Self::Atan | Self::Exp => Singularity::None,
            Self::Sinh | Self::Cosh | Self::Tanh | Self::Asinh => Singularity::None,
            Self::Ln => Singularity::Logarithm { shift: 0 },
            Self::Log1p => Singularity::Logarithm { shift: 1 },
            Self::Tan => Singularity::Poles,
            Self::Asin | Self::Acos => Singularity::Ends,
            Self::Abs => Singularity::Kink,
        }
    }

    pub(crate) fn residue(self) -> Residue {
        match self {
            Self::Sin | Self::Cos | Self::Tan => Residue::Circular,
            Self::Exp | Self::Sinh | Self::Cosh | Self::Tanh => Residue::Exponential,
            Self::Asin | Self::Acos | Self::Atan | Self::Asinh => Residue::Atom,
            Self::Ln | Self::Log1p => Residue::Atom,
            Self::Abs => Residue::Branch,
        }
    }

    /// True if the value is one of several real or complex solutions of an equation, such as the angles with a given
    /// sine.
    pub fn chooses_branch(self) -> bool {
        !self.residue().has_base()
    }

    /// The sign of the value at an argument with this sign.
    pub(crate) fn sign(self, argument: Sign) -> Sign {
        match self {
            Self::Exp | Self::Cosh => Sign::Positive,
            Self::Abs => Sign::known(argument.is_nonzero(), true, argument == Sign::Zero),
            // These functions are increasing and 0 at 0.
            Self::Sinh | Self::Tanh | Self::Asinh => argument,
            Self::Atan | Self::Asin | Self::Log1p => argument,
            Self::Acos => Sign::NonNegative,
            Self::Sin | Self::Cos | Self::Tan | Self::Ln => Sign::Unknown,
        }
    }

    /// Enclosure of all values on an interval; `None` if the function may be undefined somewhere in the interval.
    pub(crate) fn range(self, x: Interval) -> Option<Interval> {
        let has_values = match self.arguments() {
            Arguments::All | Arguments::OffPoles => true,
            Arguments::Positive => x.lo > 0.0,
            Arguments::AboveMinusOne => x.lo > -1.0,
            Arguments::Unit => x.lo >= -1.0 && x.hi <= 1.0,
        };
        if !has_values {
            return None;
        }
        Some(match self {
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.sin().mul(x.cos().inverse()?),
            Self::Exp => {
                let range = x.increasing(libm::exp);
                Interval::new(range.lo.max(0.0), range.hi)
            }
            Self::Sinh => x.increasing(libm::sinh),
            Self::Cosh => x.cosh(),
            Self::Tanh => x.increasing(libm::tanh).within(-1.0, 1.0),
            Self::Atan => x.increasing(libm::atan),
            Self::Asinh => x.increasing(libm::asinh),
            Self::Abs => x.abs(),
            Self::Ln => x.increasing(libm::log),
            Self::Log1p => x.increasing(libm::log1p),
            Self::Asin => x.increasing(libm::asin),
            Self::Acos => (-x).increasing(|x| libm::acos(-x)),
        })
    }

    /// The derivative, up to its sign.
    pub(crate) fn slope(self, x: f64) -> f64 {
        match self {
            Self::Sin => x.cos(),
            Self::Cos => x.sin(),
            Self::Tan => 1.0 + x.tan() * x.tan(),
            Self::Asin | Self::Acos => 1.0 / (1.0 - x * x).sqrt(),
            Self::Atan => 1.0 / (1.0 + x * x),
            Self::Exp => x.exp(),
            Self::Ln => 1.0 / x,
            Self::Log1p => 1.0 / (1.0 + x),
            Self::Sinh => x.cosh(),
            Self::Cosh => x.sinh(),
            Self::Tanh => 1.0 - x.tanh() * x.tanh(),
            Self::Asinh => 1.0 / (1.0 + x * x).sqrt(),
            Self::Abs => 1.0,
        }
    }

    /// `f'(argument)`; `value` is `f(argument)`.
    pub(crate) fn derivative(self, pool: &mut Pool, argument: ExprId, value: ExprId) -> ExprId {
        match self {
            Self::Sin => pool.call(Self::Cos, argument),
            Self::Cos => {
                let sine = pool.call(Self::Sin, argument);
                pool.neg(sine)
            }
            Self::Tan => one_plus_square(pool, Rational::ONE, value),
            Self::Tanh => one_plus_square(pool, Rational::MINUS_ONE, value),
            Self::Asin => inverse_cosine(pool, argument),
            Self::Acos => {
                let slope = inverse_cosine(pool, argument);
                pool.neg(slope)
            }
            Self::Atan => {
                let denominator = one_plus_square(pool, Rational::ONE, argument);
                pool.pow(denominator, Rational::MINUS_ONE)
            }
            Self::Asinh => {
                let radicand = one_plus_square(pool, Rational::ONE, argument);
                pool.pow(radicand, -Rational::HALF)
            }
            Self::Exp => value,
            Self::Ln => pool.pow(argument, Rational::MINUS_ONE),
            Self::Log1p => {
                let one = pool.one();
                let denominator = pool.add(one, argument);
                pool.pow(denominator, Rational::MINUS_ONE)
            }
            Self::Sinh => pool.call(Self::Cosh, argument),
            Self::Cosh => pool.call(Self::Sinh, argument),
            Self::Abs => pool.div(argument, value),
        }
    }
}

/// `1 + coefficient * base^2`
fn one_plus_square(pool: &mut Pool, coefficient: Rational, base: ExprId) -> ExprId {
    let (square, one) = (pool.pow(base, Rational::from(2)), pool.one());
    pool.combine(&[(Rational::ONE, one), (coefficient, square)])
}

/// `1 / sqrt(1 - sine^2)`
fn inverse_cosine(pool: &mut Pool, sine: ExprId) -> ExprId {
    let radicand = one_plus_square(pool, Rational::MINUS_ONE, sine);
    pool.pow(radicand, -Rational::HALF)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Arguments in the domain of every function.
    const COMMON: [f64; 3] = [0.1, 0.4, 0.9];

    #[test]
    fn slopes_are_derivatives() {
        for function in Function::ALL {
            for x in COMMON {
                let h = 1e-6;
                let difference = (function.value(x + h) - function.value(x - h)) / (2.0 * h);
                let slope = function.slope(x).abs();
                let error = (slope - difference.abs()).abs();
                assert!(
                    error < 1e-7 * (1.0 + slope),
                    "{} at {x}: {slope} for {difference}",
                    function.name()
                );
            }
        }
    }

    #[test]
    fn courses_are_those_of_the_values() {
        for function in Function::ALL {
            let at = |k: i32| function.value(f64::from(k));
            let holds = match function.course() {
                Course::Wave => (-20..20).all(|k| at(k).abs() <= 1.0),
                Course::Increasing => (-4..4).all(|k| at(k) < at(k + 1)),
                Course::Valley => (0..4).all(|k| at(k) < at(k + 1) && at(k) == at(-k)),
                Course::Partial => function.arguments() != Arguments::All,
            };
            assert!(holds, "{}", function.name());
        }
    }

    #[test]
    fn ranges_hold_the_values() {
        for function in Function::ALL {
            for (lo, hi) in [(0.1, 0.4), (0.4, 0.9), (0.1, 0.1)] {
                let range = function.range(Interval::new(lo, hi)).unwrap();
                for k in 0..=8 {
                    let value = function.value(lo + (hi - lo) * f64::from(k) / 8.0);
                    let slack = 1e-15 * value.abs();
                    let is_inside = range.lo - slack <= value && value <= range.hi + slack;
                    assert!(is_inside, "{}: {value} {range:?}", function.name());
                }
            }
            let is_partial = function.range(Interval::new(-3.0, 3.0)).is_none();
            assert_eq!(is_partial, function.course() == Course::Partial);
        }
    }
}
