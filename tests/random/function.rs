//! Random functions of position, parameters and time, smooth and bounded by a few units on the unit box.

use proptest::prelude::*;

/// A sum of terms.
#[derive(Debug, Clone)]
pub struct Function(Vec<Term>);

#[derive(Debug, Clone)]
struct Term {
    quarters: i8,
    factors: Vec<Factor>,
}

/// A factor of a term. Numbers of coordinates are reduced to the allowed range when the function is written.
#[derive(Debug, Clone)]
enum Factor {
    Coordinate(usize),
    Sine(usize),
    CosineOfDifference(usize, usize),
    Bell(usize),
    Root(usize),
    Hyperbolic(usize),
    Direction(usize, usize),
    Parameter(usize),
    Time,
}

/// The names that a function may use.
#[derive(Debug, Clone, Copy)]
pub struct Names<'a> {
    /// True for coordinates that are angles.
    pub angles: &'a [bool],
    /// The first coordinate that may occur.
    pub first: usize,
    /// The coordinate after the last one that may occur.
    pub end: usize,
}

/// The parameters of every random model, as declared.
pub const PARAMETERS: &str = "a > 0 = 3/2; b = -5/4; c in [0, 1] = 1/3;";
const PARAMETER_NAMES: [&str; 3] = ["a", "b", "c"];

impl Names<'_> {
    /// The coordinate with this number, or its sine if it is an angle.
    fn coordinate(self, number: usize) -> Option<String> {
        let index = self.index(number)?;
        Some(if self.angles[index] {
            format!("sin(x{index})")
        } else {
            format!("x{index}")
        })
    }

    fn index(self, number: usize) -> Option<usize> {
        (self.first < self.end).then(|| self.first + number % (self.end - self.first))
    }
}

impl Function {
    /// A random function with up to three terms.
    pub fn any() -> impl Strategy<Value = Self> {
        prop::collection::vec(Term::any(), 0..=3).prop_map(Self)
    }

    /// The function in the notation of the language; `0` without terms.
    pub fn written(&self, names: Names<'_>) -> String {
        if self.0.is_empty() {
            return "0".to_owned();
        }
        let terms: Vec<String> = self.0.iter().map(|term| term.written(names)).collect();
        terms.join(" + ")
    }
}

impl Term {
    fn any() -> impl Strategy<Value = Self> {
        let quarters = prop_oneof![-6_i8..=-1, 1_i8..=6];
        let factors = prop::collection::vec(Factor::any(), 0..=2);
        (quarters, factors).prop_map(|(quarters, factors)| Self { quarters, factors })
    }

    fn written(&self, names: Names<'_>) -> String {
        let factors = self
            .factors
            .iter()
            .filter_map(|factor| factor.written(names));
        factors.fold(format!("({}/4)", self.quarters), |product, factor| {
            format!("{product}*{factor}")
        })
    }
}

impl Factor {
    fn any() -> impl Strategy<Value = Self> {
        let number = || 0_usize..8;
        prop_oneof![
            number().prop_map(Self::Coordinate),
            number().prop_map(Self::Sine),
            (number(), number()).prop_map(|(i, j)| Self::CosineOfDifference(i, j)),
            number().prop_map(Self::Bell),
            number().prop_map(Self::Root),
            number().prop_map(Self::Hyperbolic),
            (number(), number()).prop_map(|(i, j)| Self::Direction(i, j)),
            number().prop_map(Self::Parameter),
            Just(Self::Time),
        ]
    }

    /// The factor in the notation of the language; `None` if it needs a coordinate and none may occur.
    fn written(&self, names: Names<'_>) -> Option<String> {
        let coordinate = |number| names.coordinate(number);
        Some(match *self {
            Self::Coordinate(i) => coordinate(i)?,
            Self::Sine(i) => format!("sin(2*x{})", names.index(i)?),
            Self::CosineOfDifference(i, j) => {
                format!("cos(x{} - x{})", names.index(i)?, names.index(j)?)
            }
            Self::Bell(i) => format!("exp(-{}^2)", coordinate(i)?),
            Self::Root(i) => format!("sqrt(1 + {}^2)", coordinate(i)?),
            Self::Hyperbolic(i) => format!("tanh({})", coordinate(i)?),
            Self::Direction(i, j) => format!("atan2({}, 2 + {}^2)", coordinate(i)?, coordinate(j)?),
            Self::Parameter(k) => PARAMETER_NAMES[k % PARAMETER_NAMES.len()].to_owned(),
            Self::Time => "t".to_owned(),
        })
    }
}
