//! Models, emitted or loaded, as functions of slices, so that one test can use any of them. Nothing here uses the
//! generator.

use std::collections::BTreeMap;

use dalembert::describe::{Description, Report};
use dalembert::law::{Contact, Law};
use dalembert::{Instance, StateVector, System, VectorField};

/// Quantities of a state.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Time.
    pub t: f64,
    /// Positions.
    pub q: Vec<f64>,
    /// Velocities.
    pub qdot: Vec<f64>,
    /// Momenta.
    pub p: Vec<f64>,
    /// Kinetic plus potential energy.
    pub energy: f64,
}

/// Everything that is derived at a state, by the names of `dalembert eval`.
#[derive(Debug, Clone, Default)]
pub struct Reported(pub BTreeMap<String, Vec<f64>>);

impl Report for Reported {
    fn scalar(&mut self, name: &str, value: f64) {
        self.0.insert(name.to_owned(), vec![value]);
    }

    fn vector(&mut self, name: &str, values: &[f64]) {
        self.0.insert(name.to_owned(), values.to_vec());
    }

    fn matrix(&mut self, name: &str, _: usize, _: usize, values: &[f64]) {
        self.0.insert(name.to_owned(), values.to_vec());
    }
}

impl Reported {
    /// A reported number.
    ///
    /// # Panics
    /// If there is no number of this name.
    pub fn number(&self, name: &str) -> f64 {
        self.0[name][0]
    }
}

/// A model, emitted or loaded, behind one type. States are those of its global form: positions and momenta.
///
/// # Panics
/// All functions panic where the model has no value.
pub trait Numeric {
    /// The description.
    fn description(&self) -> &Description;

    /// Sets a parameter by name. True if there is one.
    fn set(&mut self, name: &str, value: f64) -> bool;

    /// The value of a parameter by index.
    fn get(&self, index: usize) -> f64;

    /// The state with these positions and velocities, on the constraints or not.
    fn state(&self, t: f64, q: &[f64], qdot: &[f64]) -> Vec<f64>;

    /// Same as [`Numeric::state`], with the velocities projected on D.
    fn projected(&self, t: f64, q: &[f64], qdot: &[f64]) -> Vec<f64>;

    /// The rate of a state.
    fn rate(&self, t: f64, state: &[f64]) -> Vec<f64>;

    /// Quantities of a state.
    fn snapshot(&self, t: f64, state: &[f64]) -> Snapshot;

    /// Everything derived at a state.
    fn report(&self, t: f64, state: &[f64]) -> Reported;

    /// The state after an impact by a law on a surface, given by name.
    fn impact(&self, surface: &str, law: Law, t: f64, state: &[f64]) -> Vec<f64>;
}

impl<S: Instance> Numeric for S {
    fn description(&self) -> &Description {
        Instance::description(self)
    }

    fn set(&mut self, name: &str, value: f64) -> bool {
        let parameters = Instance::description(self).parameters.iter();
        match parameters
            .map(|parameter| parameter.name)
            .position(|parameter| parameter == name)
        {
            Some(index) => {
                self.set_parameter(index, value);
                true
            }
            None => false,
        }
    }

    fn get(&self, index: usize) -> f64 {
        self.parameter(index)
    }

    fn state(&self, t: f64, q: &[f64], qdot: &[f64]) -> Vec<f64> {
        let global = self.global().expect("the global form");
        let state = global.state_unchecked(t, &vector(q), &vector(qdot));
        state.expect("a state").as_slice().to_vec()
    }

    fn projected(&self, t: f64, q: &[f64], qdot: &[f64]) -> Vec<f64> {
        let global = self.global().expect("the global form");
        let state = global.state_projected(t, &vector(q), &vector(qdot));
        state.expect("a state").as_slice().to_vec()
    }

    fn rate(&self, t: f64, state: &[f64]) -> Vec<f64> {
        let global = self.global().expect("the global form");
        let mut rate = global.zero_state();
        VectorField::rate(&global, t, &vector(state), &mut rate).expect("a rate");
        rate.as_slice().to_vec()
    }

    fn snapshot(&self, t: f64, state: &[f64]) -> Snapshot {
        let (global, state) = (self.global().expect("the global form"), vector(state));
        let list = |vector: S::Vector| vector.as_slice().to_vec();
        Snapshot {
            t,
            q: list(global.position(&state)),
            qdot: list(global.velocity(t, &state).expect("a velocity")),
            p: list(global.momentum(t, &state).expect("a momentum")),
            energy: global.energy(t, &state).expect("an energy"),
        }
    }

    fn report(&self, t: f64, state: &[f64]) -> Reported {
        let mut reported = Reported::default();
        self.global()
            .expect("the global form")
            .inspect(t, &vector(state), &mut reported)
            .expect("a report");
        reported
    }

    fn impact(&self, surface: &str, law: Law, t: f64, state: &[f64]) -> Vec<f64> {
        let report = Numeric::report(self, t, state);
        let of = |name: &str| report.number(&format!("impacts.{surface}.{name}"));
        let global = self.global().expect("the global form");
        let contact = Contact::<<S::Global as System>::Impulse> {
            gap_rate: of("gap_rate"),
            constrained_rate: of("constrained_rate"),
            surface_rate: of("surface_rate"),
            constrained_compliance: of("constrained_compliance"),
            free_compliance: of("free_compliance"),
            direction: vector(&report.0[&format!("impacts.{surface}.direction")]),
        };
        let mut after: <S::Global as VectorField>::State = vector(state);
        global.kick(&mut after, contact.impulse(law), &contact.direction);
        after.as_slice().to_vec()
    }
}

fn vector<V: StateVector>(values: &[f64]) -> V {
    V::of(values)
}

/// Step of the stencil of [`slope`]. The truncation error is `STEP^6/140` times the seventh derivative, the rounding
/// error about `1e-15/STEP` times the size of the values.
const STEP: f64 = 3e-3;

/// The derivative of `f` at 0, by central differences of sixth order.
pub fn slope(f: &mut dyn FnMut(f64) -> f64) -> f64 {
    let mut pair = |k: f64| f(k * STEP) - f(-k * STEP);
    (45.0 * pair(1.0) - 9.0 * pair(2.0) + pair(3.0)) / (60.0 * STEP)
}

/// Same as [`slope`], for all components of a vector.
pub fn slopes(f: &dyn Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let pair = |k: f64| moved(&f(k * STEP), -1.0, &f(-k * STEP));
    let [first, second, third] = [1.0, 2.0, 3.0].map(pair);
    let sum = (0..first.len()).map(|i| 45.0 * first[i] - 9.0 * second[i] + third[i]);
    sum.map(|sum| sum / (60.0 * STEP)).collect()
}

/// `state + s * direction`
pub fn moved(state: &[f64], s: f64, direction: &[f64]) -> Vec<f64> {
    state
        .iter()
        .zip(direction)
        .map(|(component, slope)| component + s * slope)
        .collect()
}

/// Asserts that every number differs from the right one by at most `bound`.
///
/// # Panics
/// If one differs by more.
#[track_caller]
pub fn assert_near(label: &str, found: &[f64], right: &[f64], bound: f64) {
    assert_eq!(found.len(), right.len(), "{label}");
    for (found, right) in found.iter().zip(right) {
        assert!(
            (found - right).abs() <= bound,
            "{label}: {found} for {right}, bound {bound:e}"
        );
    }
}
