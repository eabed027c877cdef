//! Numbers that count their operations as the generator does.

use core::cell::Cell;
use core::ops::{Add, Div, Mul, Neg, Sub};

use super::number::Number;

thread_local! {
    static OPERATIONS: Cell<usize> = const { Cell::new(0) };
}

/// A number; each operation on it is counted.
#[derive(Debug, Clone, Copy)]
pub struct Counted(f64);

/// Number of operations that `work` does with `N` numbers.
pub fn operations<const N: usize, R>(work: impl FnOnce([Counted; N]) -> R) -> usize {
    OPERATIONS.set(0);
    work(core::array::from_fn(|k| Counted(0.3 + 0.1 * k as f64)));
    OPERATIONS.get()
}

fn counted(count: usize, value: f64) -> Counted {
    OPERATIONS.set(OPERATIONS.get() + count);
    Counted(value)
}

macro_rules! binary {
    ($($operation:ident $method:ident;)*) => {$(
        impl $operation for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                counted(1, self.0.$method(other.0))
            }
        }
    )*};
}

binary! { Add add; Sub sub; Mul mul; Div div; }

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        counted(1, -self.0)
    }
}

impl Number for Counted {
    fn of(value: f64) -> Self {
        Self(value)
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0.sin_cos();
        (counted(1, sin), counted(1, cos))
    }
}
