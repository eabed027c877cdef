//! Work of integrators in multiplications: counted in a run, or predicted.
//!
//! Both adaptive integrators of high order cover a part of the radius of convergence of the motion in a step. With work
//! in multiplications, the work to cover the whole radius is
//!
//! ```text
//! Taylor series of order p:  (values + B + m sums p^2 / 2) e^(l / p)            l = 2.7 - ln(tol)
//! Dop853:                    (12 (values + A) + B) / (2.3 (tol / 50)^(1/8))
//! ```
//!
//! A step evaluates the series once, or the rate twelve times. At the same tolerance, errors of Dop853 are about 50 times
//! as large, so that the formula compares work at equal errors. `A` is the work with the state vectors of an evaluation,
//! `B` that of a step. Series that do not fit into the cache of the first level cost up to `m = 2` times the
//! multiplications.
//!
//! The constants are fitted to runs of 36 models at tolerances from 1e-3 to 1e-13, timed with measured errors. At
//! tolerances of at most 1e-8, the predicted integrator took at most 1.02 times as long as the better one on average.
//! At 1e-3 it took 1.21 times as long, for one model 2.7 times.

use super::order::order;
use super::stats::Counters;
use super::tolerance::Tolerance;
use crate::jet::Work;
use crate::math;

/// Work with the state vectors of an evaluation of the rate.
const EVALUATION: f64 = 60.0;

/// Work of a step apart from evaluations and sums.
const STEP: f64 = 400.0;

/// Evaluations of the rate in a step of Dop853.
const STAGES: f64 = 12.0;

/// Part of the radius of convergence that a step of Dop853 covers at a tolerance of 1.
const PART_OF_RADIUS: f64 = 2.3;

/// Error of Dop853 over that of Taylor series at the same tolerance.
const ERROR: f64 = 50.0;

/// Number of coefficients that a cache of the first level holds.
const NEAR: f64 = 4096.0;

/// Time of a multiplication with far coefficients, in multiplications with near ones.
const FAR: f64 = 2.0;

/// Predicted work of [`Taylor`](super::Taylor) over that of [`Dop853`](super::Dop853) at the same error. It is 0 if the
/// motion is a polynomial of time for all values of the parameters, which a series of finite order gives exactly.
///
/// `work` is that of the system ([`TaylorField::work`](crate::TaylorField::work)).
///
/// # Examples
///
/// ```
/// use dalembert::integrate::{Tolerance, taylor_to_dop853};
/// use dalembert::TaylorField;
///
/// dalembert::model! {
///     pub Pendulum {
///         coordinates { theta: angle; }
///         lagrangian = dot(theta)^2/2 + cos(theta);
///     }
/// }
///
/// let work = Pendulum {}.work().ok_or("the work of this system is not known")?;
/// assert!(taylor_to_dop853(Tolerance::new(1e-10)?, work) < 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn taylor_to_dop853(tolerance: Tolerance, work: Work) -> f64 {
    if work.degree.is_some() {
        return 0.0;
    }
    let tolerance = tolerance.relative();
    let [values, sums] = [work.values, work.sums].map(f64::from);
    let order = order(tolerance, Some(work)) as f64;
    let distance = (values * order / NEAR).clamp(1.0, FAR);
    let expansion = values + STEP + 0.5 * distance * sums * order * order;
    let taylor = expansion * math::exp((2.7 - math::ln(tolerance)) / order);
    let step = STAGES * (values + EVALUATION) + STEP;
    let dop853 = step / PART_OF_RADIUS * math::exp(-0.125 * math::ln(tolerance / ERROR));
    taylor / dop853
}

/// Counted work of a run, in multiplications, without the search for impacts. `work` is that of the system
/// ([`TaylorField::work`](crate::TaylorField::work)).
pub fn counted_work(counters: &Counters, work: Work) -> f64 {
    let [values, sums] = [work.values, work.sums].map(f64::from);
    let evaluations = counters.rate_evaluations as f64 * (values + EVALUATION);
    let steps = (counters.accepted + counters.rejected) as f64 * STEP;
    // All expansions of a run have the same order.
    let orders = counters.coefficients as f64;
    let products = 0.5 * sums * orders * orders / (counters.expansions.max(1) as f64);
    evaluations + steps + products
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ratio(tolerance: f64, values: u32, sums: u32, degree: Option<u32>) -> f64 {
        let work = Work {
            values,
            sums,
            degree,
        };
        taylor_to_dop853(Tolerance::new(tolerance).expect("in range"), work)
    }

    #[test]
    fn series_pay_for_high_accuracy_and_few_products() {
        let disk = [1e-3, 1e-6, 1e-10, 1e-13].map(|tolerance| ratio(tolerance, 69, 2, None));
        assert!(disk.is_sorted_by(|a, b| a > b), "{disk:?}");
        assert!(disk[0] < 1.0);
        // A chain of eight pendulums has many products, and its series do not stay in the cache.
        assert!(ratio(1e-10, 1019, 368, None) > 1.0);
        assert_eq!(ratio(1e-3, 1019, 368, Some(2)), 0.0);
    }
}
