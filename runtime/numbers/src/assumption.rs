//! Conditions on parameters.

use core::fmt;

/// Condition that a declaration imposes on a parameter. It is checked when a state is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Assumption {
    /// Any finite number.
    Finite,
    /// `> 0`
    Positive,
    /// `>= 0`
    NonNegative,
    /// `!= 0`
    NonZero,
    /// `in [low, high]`, ends included.
    Within {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
}

impl Assumption {
    /// True if `value` is finite and satisfies the assumption.
    pub fn holds(&self, value: f64) -> bool {
        value.is_finite()
            && match *self {
                Self::Finite => true,
                Self::Positive => value > 0.0,
                Self::NonNegative => value >= 0.0,
                Self::NonZero => value != 0.0,
                Self::Within { low, high } => low <= value && value <= high,
            }
    }
}

impl fmt::Display for Assumption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Finite => write!(f, "finite"),
            Self::Positive => write!(f, "> 0"),
            Self::NonNegative => write!(f, ">= 0"),
            Self::NonZero => write!(f, "!= 0"),
            Self::Within { low, high } => write!(f, "in [{low}, {high}]"),
        }
    }
}
