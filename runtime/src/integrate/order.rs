//! Order of the power series that needs the least work per unit of time.
//!
//! A step of order `p` takes `a + c p^2` multiplications and reaches `e^(-l / p)` of the radius of convergence, where
//! `l = 2.7 - ln(tol)`. Work per unit of time is least at
//!
//! ```text
//! 2 c p^3 = l (a + c p^2)
//! ```
//!
//! If `a` is unknown or small, this is the order of Jorba and Zou, `p = 1 - ln(tol) / 2` up to constants, with a step
//! of `e^-2` of the radius. The work `a`, which every step takes at any order, favours higher orders. Series that
//! terminate are computed to their last term.
//!
//! Reference: A. Jorba and M. Zou, Experimental Mathematics 14 (2005), sections 3.1 and 3.2.

use crate::jet::{LENGTH, Work};
use crate::math;

/// Lowest order. The step size depends on the last two coefficients, and neither may be the rate.
pub(super) const LEAST_ORDER: usize = 3;

/// Binary logarithm of `e^-2.7`, by which the tolerance is multiplied before the last coefficients give the step. The
/// part `e^-2` makes the step `e^-2` of the radius of convergence at the order of Jorba and Zou; the part `e^-0.7`
/// gives their safety factor `e^(-0.7 / (p - 1))`.
pub(super) const PART_OF_TOLERANCE: f64 = -3.895_276_610_400_201_5;

/// Work of a step apart from values and sums, in multiplications: step size, end of the step, and effects.
const BOOKKEEPING: f64 = 200.0;

/// Order for a tolerance.
pub(crate) fn order(tolerance: f64, work: Option<Work>) -> usize {
    let logarithm = -math::ln(tolerance);
    let length = logarithm - PART_OF_TOLERANCE * core::f64::consts::LN_2;
    let fixed = work.map_or(0.0, |work| {
        (BOOKKEEPING + f64::from(work.values)) / f64::from(work.sums.max(1))
    });
    let pays = |order: f64| 2.0 * order * order * order < length * (fixed + order * order);
    let mut order = (1.0 + 0.5 * logarithm).max(LEAST_ORDER as f64);
    while fixed > 0.0 && order < (LENGTH - 1) as f64 && pays(order) {
        order += 1.0;
    }
    // NOTE: the conversion saturates and drops the fraction. `+ 1` rounds up.
    let order = (order as usize + 1).clamp(LEAST_ORDER, LENGTH - 1);
    match work.and_then(|work| work.degree) {
        // At order `degree + 2`, the last two coefficients, which determine the step, vanish.
        Some(degree) => order.min((degree as usize + 2).max(LEAST_ORDER)),
        None => order,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_rise_with_accuracy_and_with_what_a_step_takes_at_any_order() {
        let orders = |work: Option<Work>| [1e-3, 1e-6, 1e-10, 1e-14].map(|tol| order(tol, work));
        let by_tolerance = orders(None);
        assert_eq!(by_tolerance, [5, 8, 13, 18]);
        let simple = orders(Some(Work {
            values: 100,
            sums: 1,
            degree: None,
        }));
        let rich = orders(Some(Work {
            values: 400,
            sums: 100,
            degree: None,
        }));
        for i in 0..4 {
            assert!(
                by_tolerance[i] <= rich[i] && rich[i] < simple[i],
                "{rich:?} {simple:?}"
            );
        }
        assert!(simple[3] < LENGTH);
        let ends = orders(Some(Work {
            values: 100,
            sums: 0,
            degree: Some(2),
        }));
        assert_eq!(ends, [4; 4]);
    }
}
