//! Test that constraint forms are independent on a stretch of motion: all pivots of their Gram matrix are certainly
//! positive.

use super::part::{has_modes, number_of};
use super::system::over_numbers;
use super::{At, Declared, Kernels, Part};
use crate::contract::{Along, VectorField};
use crate::numbers::{Numbers, Row, TaylorModel};

/// True if the forms are certainly independent along the whole stretch.
pub(super) fn keeps_rank<S: Declared>(system: &S, (t, component): Along<'_>) -> bool {
    let number = match has_modes(system) {
        true => number_of(Some(&component(system.state_len() - 1))),
        false => 0,
    };
    let part = Part::numbered(system, number);
    let (n, m) = (part.lengths()[0], part.tables.dimensions.constraints);
    let arguments: S::Arguments<TaylorModel> = over_numbers(system);
    let mut q = S::Positions::<TaylorModel>::zeros(n);
    for (i, entry) in q.as_mut_slice().iter_mut().enumerate() {
        *entry = component(i);
    }
    let at_rest = S::Positions::<TaylorModel>::zeros(n);
    let at = At {
        parameters: arguments.as_slice(),
        t,
        first: q.as_slice(),
        second: at_rest.as_slice(),
    };
    let mut forms = S::Room::<TaylorModel>::zeros(n * m + m);
    let written = part
        .kernels
        .forms(at, &mut forms.as_mut_slice()[..n * m + m]);
    let mut gram = S::Room::<TaylorModel>::zeros(m * m);
    let gram = &mut gram.as_mut_slice()[..m * m];
    let form = |a: usize| &forms.as_slice()[a * n..(a + 1) * n];
    for a in 0..m {
        for b in 0..=a {
            let products = form(a).iter().zip(form(b)).map(|(x, y)| *x * *y);
            gram[a * m + b] = products.fold(TaylorModel::ZERO, |sum, product| sum + product);
        }
    }
    written.is_ok() && has_pivots(gram, m)
}

/// True if elimination finds positive pivots only. The symmetric matrix is given by its lower half.
fn has_pivots(matrix: &mut [TaylorModel], m: usize) -> bool {
    (0..m).all(|k| {
        let pivot = matrix[k * m + k];
        if !is_positive(pivot) {
            return false;
        }
        for a in k + 1..m {
            let factor = matrix[a * m + k] / pivot;
            for b in k + 1..=a {
                matrix[a * m + b] = matrix[a * m + b] - factor * matrix[b * m + k];
            }
        }
        true
    })
}

fn is_positive(pivot: TaylorModel) -> bool {
    let range = pivot.range();
    range.lo > 0.0 && range.hi < f64::INFINITY
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::Interval;

    /// True if a 2 by 2 matrix, with a range as its off-diagonal entry, has positive pivots.
    fn has_two(first: f64, second: f64, between: [f64; 2]) -> bool {
        let between = TaylorModel::steady(Interval::new(between[0], between[1]));
        let [first, second] = [first, second].map(TaylorModel::of);
        has_pivots(&mut [first, TaylorModel::ZERO, between, second], 2)
    }

    #[test]
    fn pivots_are_positive_where_no_value_makes_rows_dependent() {
        assert!(has_two(1.0, 1.0, [-0.5, 0.5]));
        assert!(!has_two(1.0, 1.0, [0.5, 1.0]));
        assert!(!has_two(0.0, 1.0, [0.0, 0.0]));
        assert!(!has_two(1.0, f64::NAN, [0.0, 0.0]));
    }
}
