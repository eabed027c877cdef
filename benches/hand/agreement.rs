//! Asserts that two implementations of a function of the state agree up to rounding.

use dalembert::{Described, StateVector};
use dalembert_tests::sampling;

use crate::State;

/// Largest allowed difference, relative to the largest component: fifty times the largest difference that occurs.
const ROUNDING: f64 = 1e-13;

/// Random states that satisfy the constraints.
fn states<S: Described>(system: &S) -> Vec<State<S>> {
    sampling::states(system, 200, 1)
}

/// The largest absolute value of a component in its unit.
fn largest(components: &[f64], units: &[f64]) -> f64 {
    let measured = components
        .iter()
        .zip(units)
        .map(|(value, unit)| (value / unit).abs());
    measured.fold(0.0, f64::max)
}

/// Asserts that two functions from states to states agree.
pub fn assert_states_agree<S: Described>(
    system: &S,
    expected: impl Fn(&S, &State<S>) -> State<S>,
    actual: impl Fn(&S, &State<S>) -> State<S>,
) {
    for state in states(system) {
        let units = system.scale(0.0, &state);
        let (expected, actual) = (expected(system, &state), actual(system, &state));
        let mut difference = actual;
        for (difference, expected) in difference
            .as_mut_slice()
            .iter_mut()
            .zip(expected.as_slice())
        {
            *difference -= expected;
        }
        let size = largest(expected.as_slice(), units.as_slice());
        let error = largest(difference.as_slice(), units.as_slice()) / size;
        assert!(
            error < ROUNDING,
            "{actual:?} instead of {expected:?}: {error:.1e}"
        );
    }
}

/// Asserts that two functions from states to numbers agree.
pub fn assert_numbers_agree<S: Described>(
    system: &S,
    expected: impl Fn(&S, &State<S>) -> f64,
    actual: impl Fn(&S, &State<S>) -> f64,
) {
    for state in states(system) {
        let (expected, actual) = (expected(system, &state), actual(system, &state));
        let error = (actual - expected).abs() / expected.abs();
        assert!(
            error < ROUNDING,
            "{actual} instead of {expected}: {error:.1e}"
        );
    }
}
