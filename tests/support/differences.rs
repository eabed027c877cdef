//! Comparison of derivatives of runs with differences of runs.

use core::ops::ControlFlow;

use dalembert::math::larger;
use dalembert::numbers::Row;
use dalembert::{Hold, Observer, StateVector, System, Tangent};
use dalembert_cli::Integrator;
use dalembert_stability::course::Course;
use dalembert_stability::varied::Varied;

/// Bound on the difference between a derivative and a difference of runs, relative to the largest entry of the column,
/// or to 1 if that is larger.
const DIFFERENCE: f64 = 2e-9;

/// The derivative of `f` at 0, by central differences over one, two and four steps, extrapolated to order 6.
pub fn difference<V: StateVector>(step: f64, f: impl Fn(f64) -> V) -> V {
    let central = |h: f64| {
        let (ahead, behind) = (f(h), f(-h));
        let mut slope = ahead.zeroed();
        for (i, entry) in slope.as_mut_slice().iter_mut().enumerate() {
            *entry = (ahead.as_slice()[i] - behind.as_slice()[i]) / (2.0 * h);
        }
        slope
    };
    let [one, two, four] = [1.0, 2.0, 4.0].map(|factor| central(factor * step));
    let mut slope = one.zeroed();
    for (i, entry) in slope.as_mut_slice().iter_mut().enumerate() {
        let [one, two, four] = [&one, &two, &four].map(|values| values.as_slice()[i]);
        *entry = (64.0 * one - 20.0 * two + four) / 45.0;
    }
    slope
}

/// Compares derivatives of the end of a run with differences of runs. The derivatives are taken with respect to the
/// first `used` components of the start and to all parameters; all runs have the same number of impacts. Returns that
/// number.
///
/// # Panics
/// If they differ, or if a run does not reach its end.
pub fn check_differences<M: Varied>(
    system: &M,
    start: M::State,
    used: usize,
    course: impl for<'a> Fn(&'a M, M::State) -> Course<'a, M>,
) -> u64 {
    let name = system.description().name;
    let parameters = system.description().parameters.len();
    let mut columns: Vec<Tangent<M>> = (0..used).map(Tangent::of_component).collect();
    columns.extend((0..parameters).map(Tangent::of_parameter));
    let directions = columns.clone();
    let (run, derived) = course(system, start).vary(Integrator::Taylor, &mut columns);
    assert!(run.outcome.is_done(), "{name}: {}", run.outcome);
    derived.expect("derivatives");
    let impacts = run.counters.impacts;
    for (direction, column) in directions.iter().zip(&columns) {
        let expected = difference(3e-4, |h| {
            let (mut system, mut start) = (system.clone(), start);
            for k in 0..parameters {
                let along = direction.parameters.as_slice()[k];
                system.set_parameter(k, system.parameter(k) + h * along);
            }
            let parts = start.as_mut_slice().iter_mut();
            for (entry, component) in parts.zip(direction.state.as_slice()) {
                *entry += h * component;
            }
            let run = course(&system, start).observed(Integrator::Taylor, &mut ());
            assert!(run.outcome.is_done(), "{name}: {}", run.outcome);
            assert_eq!(run.counters.impacts, impacts, "{name}");
            run.state
        });
        let (found, expected) = (column.state.as_slice(), expected.as_slice());
        assert!(found.len() >= expected.len());
        let size = expected
            .iter()
            .fold(1.0, |size: f64, value| larger(size, value.abs()));
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() <= DIFFERENCE * size,
                "{name}: {column:?} along {direction:?}: {found} instead of {expected}",
            );
        }
    }
    impacts
}

/// Numbers of contacts that begin to hold the motion, and of contacts that release it.
#[derive(Default)]
pub struct Turns(pub [usize; 2]);

impl<Sys: System> Observer<Sys> for Turns {
    fn hold(&mut self, hold: &Hold<Sys::State>) -> ControlFlow<()> {
        self.0[usize::from(!hold.begins)] += 1;
        ControlFlow::Continue(())
    }
}
