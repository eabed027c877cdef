//! Functions called from machine code.

use dalembert_expr::Function as Elementary;
use dalembert_numbers::math;

use super::assembly::convention;

/// A function of one or two doubles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OfNumbers {
    Elementary(Elementary),
    Atan2,
    Power,
}

macro_rules! functions_of_one_number {
    ($($meaning:literal $variant:ident $name:ident)*) => {
        $(
            convention! {
                fn $name(x: f64) -> f64 {
                    math::$name(x)
                }
            }
        )*

        /// Address of a function of one number.
        fn address_of(function: Elementary) -> usize {
            let function: convention!(fn(f64) -> f64) = match function {
                $(Elementary::$variant => $name,)*
            };
            function as usize
        }
    };
}
dalembert_expr::with_functions!(functions_of_one_number);

convention! {
    fn atan2(y: f64, x: f64) -> f64 {
        math::atan2(y, x)
    }
}

convention! {
    fn powf(x: f64, e: f64) -> f64 {
        math::powf(x, e)
    }
}

impl OfNumbers {
    /// Address of the function.
    pub(super) fn address(self) -> usize {
        match self {
            Self::Elementary(function) => address_of(function),
            Self::Atan2 => atan2 as *const () as usize,
            Self::Power => powf as *const () as usize,
        }
    }
}

/// Address of [`sine_and_cosine`].
pub(super) fn address_of_sine_and_cosine() -> usize {
    sine_and_cosine as *const () as usize
}

convention! {
    /// Writes sine and cosine of `x` to `both`.
    fn sine_and_cosine(x: f64, both: *mut [f64; 2]) {
        // SAFETY: the caller passes the address of room for two numbers in its own frame.
        unsafe { *both = [math::sin(x), math::cos(x)] }
    }
}
