//! Derivatives of runs against differences of runs.

use core::ops::ControlFlow;

use dalembert::contract::Variational;
use dalembert::numbers::Row;
use dalembert::{Described, Hold, Observer, StateVector, System, Tangent, Variations};

/// The largest difference between a derivative and a difference of runs, in units of the largest entry of its column.
const DIFFERENCE: f64 = 2e-9;

/// The derivative at 0 of what `f` gives, by differences over four steps and their halves.
pub fn difference<V: StateVector>(step: f64, f: impl Fn(f64) -> V) -> V {
    let central = |h: f64| {
        let (ahead, behind) = (f(h), f(-h));
        let mut slope = V::zeros(V::CAPACITY);
        for i in 0..V::CAPACITY {
            slope.as_mut_slice()[i] = (ahead.as_slice()[i] - behind.as_slice()[i]) / (2.0 * h);
        }
        slope
    };
    let [one, two, four] = [1.0, 2.0, 4.0].map(|factor| central(factor * step));
    let mut slope = V::zeros(V::CAPACITY);
    for i in 0..V::CAPACITY {
        let [one, two, four] = [&one, &two, &four].map(|own| own.as_slice()[i]);
        slope.as_mut_slice()[i] = (64.0 * one - 20.0 * two + four) / 45.0;
    }
    slope
}

/// Derivatives of the end of a run with respect to the first `used` components of its start and to all parameters, against
/// differences of runs with as many impacts. `run` gives the end, and how many there were; so does this.
pub fn check_differences<S>(
    system: S,
    start: S::State,
    used: usize,
    run: impl Fn(&S, &S::State, &mut dyn Observer<S>) -> (S::State, u64),
) -> u64
where
    S: Described + Variational,
{
    let name = S::DESCRIPTION.name;
    let parameters = S::DESCRIPTION.parameters.len();
    let mut columns: Vec<Tangent<S>> = (0..used).map(Tangent::of_component).collect();
    columns.extend((0..parameters).map(Tangent::of_parameter));
    let directions = columns.clone();
    let mut variations = Variations::new(&system, &mut columns);
    let (_, impacts) = run(&system, &start, &mut variations);
    variations.tangents().expect("derivatives");
    for (direction, column) in directions.iter().zip(&columns) {
        let expected = difference(3e-4, |h| {
            let (mut system, mut start) = (system.clone(), start);
            for (k, own) in direction.parameters.as_slice().iter().enumerate() {
                system.set_parameter(k, system.parameter(k) + h * own);
            }
            let parts = start.as_mut_slice().iter_mut();
            for (entry, own) in parts.zip(direction.state.as_slice()) {
                *entry += h * own;
            }
            let (state, seen) = run(&system, &start, &mut ());
            assert_eq!(seen, impacts, "{name}");
            state
        });
        let parts = expected.as_slice().iter();
        let size = parts.fold(1.0, |size: f64, own| size.max(own.abs()));
        for (found, expected) in column.state.as_slice().iter().zip(expected.as_slice()) {
            assert!(
                (found - expected).abs() <= DIFFERENCE * size,
                "{name}: {column:?} along {direction:?}: {found} for {expected}",
            );
        }
    }
    impacts
}

/// How often motion begins to be held, and ceases to be.
#[derive(Default)]
pub struct Turns(pub [usize; 2]);

impl<Sys: System> Observer<Sys> for Turns {
    fn hold(&mut self, hold: &Hold<Sys::State>) -> ControlFlow<()> {
        self.0[usize::from(!hold.begins)] += 1;
        ControlFlow::Continue(())
    }
}
