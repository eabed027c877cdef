//! Comparison of emitted code with the interpreted program that it was emitted from.

use dalembert::{Instance, StateVector, System, VectorField};
use dalembert_codegen::program::{Function, Input, Program, interpret::interpret};

use crate::numeric::Reported;
use crate::sampling::states;

/// The arguments of a function at a state of a system.
///
/// # Panics
/// At a state without a velocity.
pub fn input<'a, S: Instance>(
    system: &'a S,
    t: f64,
    state: &'a S::State,
) -> impl Fn(Input) -> f64 + 'a {
    let n = system.coordinate_count();
    let qdot = system.velocity(t, state).expect("a velocity");
    move |input| match input {
        Input::Time => t,
        Input::Velocity(i) => qdot.as_slice()[i],
        Input::Parameter(k) => system.parameter(k),
        other => other.component(n).map_or(f64::NAN, |i| state.as_slice()[i]),
    }
}

/// Asserts that rate, energy and velocity equal those of the interpreter, to the bit. Returns the number of states.
///
/// # Panics
/// If they differ.
pub fn compare_motion<S: Instance>(system: &S, program: &Program) -> usize {
    let (name, t) = (system.description().name, 0.25);
    let states = states(system, 5, 1);
    for state in &states {
        let at = input(system, t, state);
        let run = |function: &Function| interpret(function, &at).expect("a value");
        let mut rate = system.zero_state();
        VectorField::rate(system, t, state, &mut rate).expect("a rate");
        assert_eq!(rate.as_slice(), run(&program.rate), "{name}: rate");
        let energy = System::energy(system, t, state).expect("an energy");
        assert_eq!(energy, run(&program.energy)[0], "{name}: energy");
        let qdot = System::velocity(system, t, state).expect("a velocity");
        assert_eq!(qdot.as_slice(), run(&program.velocity), "{name}: velocity");
    }
    states.len()
}

/// Same as [`compare_motion`], for all quantities that `inspect` reports.
///
/// # Panics
/// If they differ.
pub fn compare_report<S: Instance>(system: &S, program: &Program) {
    let (name, t) = (system.description().name, 0.25);
    for state in states(system, 5, 2) {
        let mut report = Reported::default();
        system.inspect(t, &state, &mut report).expect("a report");
        let values = interpret(&program.geometry.function, &input(system, t, &state));
        let mut values = values.expect("a value").into_iter();
        for group in &program.geometry.groups {
            let expected: Vec<f64> = values.by_ref().take(group.shape.count()).collect();
            let emitted = report.0.get(&group.name);
            assert_eq!(emitted, Some(&expected), "{name}: {}", group.name);
        }
    }
}
