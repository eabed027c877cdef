//! The rates and the outputs at a state, with their derivatives with respect to state and inputs.

use dalembert::contract::Variational;
use dalembert::numbers::{Numbers, Row};
use dalembert::state::StateVector;
use dalembert::variations::{DIRECTIONS, Dual, Tangent, rates};
use dalembert::{Instance, StateError};

use super::Unlinear;
use crate::domain;
use crate::typed::vector;
use crate::variation::constant;

/// Meaning of the components of a linearised state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Positions and velocities, for a system whose state contains momenta.
    Velocities,
    /// The state of the system itself.
    State,
}

/// A system with its inputs and outputs.
pub(super) struct Plant<'a, S: Instance + Variational> {
    pub system: &'a S,
    pub t: f64,
    kind: Kind,
    /// Index of the first input among the parameters, and the number of inputs.
    inputs: [usize; 2],
    outputs: usize,
    levels: usize,
}

/// Values at a state, and their derivatives: one row per value, with one entry per component of the state, then one per
/// input.
#[derive(Debug, Clone, Default)]
pub(super) struct Sample {
    pub rates: Vec<f64>,
    pub by_rates: Vec<Vec<f64>>,
    pub outputs: Vec<f64>,
    pub by_outputs: Vec<Vec<f64>>,
    /// Functions of the positions that the constraints conserve.
    pub levels: Vec<f64>,
    pub by_levels: Vec<Vec<f64>>,
}

/// The index of the first value that is not finite, or has a derivative that is not.
fn not_finite(values: &[f64], slopes: &[Vec<f64>]) -> Option<usize> {
    let are_finite = |(value, slopes): (&f64, &Vec<f64>)| {
        core::iter::once(value)
            .chain(slopes)
            .all(|it| it.is_finite())
    };
    values.iter().zip(slopes).position(|pair| !are_finite(pair))
}

/// The components of the state with these positions and velocities.
///
/// # Errors
/// [`StateError`] if the system has no such state.
pub(super) fn start<S: Instance + Variational>(
    system: &S,
    t: f64,
    [q, qdot]: [&[f64]; 2],
) -> Result<Vec<f64>, StateError> {
    match kind(system) {
        Kind::Velocities => Ok([q, qdot].concat()),
        Kind::State => {
            let zero = system.zero_vector();
            let state = system.state_unchecked(t, &vector(&zero, q), &vector(&zero, qdot))?;
            Ok(state.as_slice().to_vec())
        }
    }
}

fn kind<S: Instance>(system: &S) -> Kind {
    let description = system.description();
    match description.is_first_order || !description.constraints.is_empty() {
        true => Kind::State,
        false => Kind::Velocities,
    }
}

impl<'a, S: Instance + Variational> Plant<'a, S> {
    pub fn new(system: &'a S, t: f64) -> Self {
        let description = system.description();
        let constraints = description.constraints.iter();
        Self {
            system,
            t,
            kind: kind(system),
            inputs: [description.parameters.len(), system.inputs().len()],
            outputs: description.outputs.len(),
            levels: constraints.filter(|it| it.level.is_some()).count(),
        }
    }

    /// The values of the inputs.
    pub fn inputs(&self) -> Vec<f64> {
        let [first, count] = self.inputs;
        self.system.parameters().as_slice()[first..first + count].to_vec()
    }

    /// The values at a state, with all derivatives.
    ///
    /// # Errors
    /// [`Unlinear::Fault`], [`Unlinear::NotFinite`] and [`Unlinear::OutputNotFinite`].
    pub fn at(&self, state: &[f64], inputs: &[f64]) -> Result<Sample, Unlinear> {
        let all = state.len() + inputs.len();
        let mut sample = Sample::default();
        for first in (0..all).step_by(DIRECTIONS) {
            let [rates, outputs, levels] = self.along(state, inputs, first)?;
            let parts = [
                (rates, &mut sample.rates, &mut sample.by_rates),
                (outputs, &mut sample.outputs, &mut sample.by_outputs),
                (levels, &mut sample.levels, &mut sample.by_levels),
            ];
            for (found, values, slopes) in parts {
                *values = found.iter().map(|dual| dual.value).collect();
                slopes.resize(found.len(), Vec::new());
                for (row, dual) in slopes.iter_mut().zip(&found) {
                    row.extend(&dual.slopes()[..DIRECTIONS.min(all - first)]);
                }
            }
        }
        if not_finite(&sample.rates, &sample.by_rates).is_some() {
            return Err(Unlinear::NotFinite);
        }
        match not_finite(&sample.outputs, &sample.by_outputs) {
            Some(index) => Err(Unlinear::OutputNotFinite {
                name: self.system.description().outputs[index],
            }),
            None => Ok(sample),
        }
    }

    /// The state of the system with these components; `None` if there is none.
    fn whole(&self, state: &[f64], inputs: &[f64]) -> Option<S::State> {
        let seeded = self.seeded(self.t, state, inputs, 0).ok()?;
        let mut whole = self.system.zero_state();
        let entries = whole.as_mut_slice().iter_mut();
        for (entry, dual) in entries.zip(seeded.row.as_slice()) {
            *entry = dual.value;
        }
        Some(whole)
    }

    /// The system with these inputs, and its state with these components; `None` if there is none.
    pub fn with_inputs(&self, state: &[f64], inputs: &[f64]) -> Option<(S, S::State)> {
        let whole = self.whole(state, inputs)?;
        let mut system = self.system.clone();
        for (k, &value) in inputs.iter().enumerate() {
            system.set_parameter(self.inputs[0] + k, value);
        }
        Some((system, whole))
    }

    /// True if a state lies inside its charts and not behind a wall.
    pub fn is_allowed(&self, state: &[f64], inputs: &[f64]) -> bool {
        let Some(whole) = self.whole(state, inputs) else {
            return false;
        };
        self.system.outside_chart(&whole).is_none()
            && domain::is_behind_wall(self.system, self.t, &whole, domain::size(state)) == Ok(false)
    }

    /// Parameters and state as dual numbers, with derivatives with respect to [`DIRECTIONS`] variables from `first` on.
    fn seeded(
        &self,
        t: f64,
        state: &[f64],
        inputs: &[f64],
        first: usize,
    ) -> Result<Seeded<S>, Unlinear> {
        let seed = |index: usize, value: f64| {
            let mut slopes = [0.0; DIRECTIONS];
            if let Some(slope) = index.checked_sub(first).and_then(|k| slopes.get_mut(k)) {
                *slope = 1.0;
            }
            Dual::new(value, slopes)
        };
        let values = self.system.parameters();
        let mut parameters = constant::<S::Parameters<Dual>>(values.as_slice());
        let places = parameters.as_mut_slice()[self.inputs[0]..].iter_mut();
        for (index, (place, value)) in places.zip(inputs).enumerate() {
            *place = seed(state.len() + index, *value);
        }
        let seeds = state.iter().enumerate();
        let seeds: Vec<Dual> = seeds.map(|(index, value)| seed(index, *value)).collect();
        let row = match self.kind {
            Kind::State => filled::<S::Row<Dual>>(&seeds),
            Kind::Velocities => {
                let (q, qdot) = seeds.split_at(state.len() / 2);
                let (q, qdot) = (filled(q), filled(qdot));
                self.system.composed(&parameters, Dual::of(t), &q, &qdot)?
            }
        };
        Ok(Seeded {
            parameters,
            row,
            seeds,
        })
    }

    /// Rates, outputs and levels, with derivatives with respect to [`DIRECTIONS`] variables from `first` on.
    fn along(
        &self,
        state: &[f64],
        inputs: &[f64],
        first: usize,
    ) -> Result<[Vec<Dual>; 3], Unlinear> {
        let (system, t) = (self.system, Dual::of(self.t));
        let Seeded {
            parameters,
            row,
            seeds,
        } = self.seeded(self.t, state, inputs, first)?;
        let [once, twice] = rates(system, &parameters, t, &row)?;
        let rates = match self.kind {
            Kind::State => once.as_slice()[..state.len()].to_vec(),
            Kind::Velocities => {
                let n = state.len() / 2;
                [&seeds[n..], &twice.as_slice()[..n]].concat()
            }
        };
        let mut outputs = vec![Dual::of(0.0); self.outputs];
        if self.outputs > 0 {
            system.declared_outputs(&parameters, t, &row, &mut outputs)?;
        }
        let deviations = system.deviations(&parameters, t, &row)?;
        let levels = deviations.as_slice()[..self.levels].to_vec();
        Ok([rates, outputs, levels])
    }

    /// The state of the system with these components, and its variations with respect to each component, then to each
    /// input.
    ///
    /// # Errors
    /// [`Unlinear::Fault`] if there is no such state.
    pub fn varied(
        &self,
        t: f64,
        state: &[f64],
        inputs: &[f64],
    ) -> Result<(S::State, Vec<Tangent<S>>), Unlinear> {
        let mut start = self.system.zero_state();
        let mut tangents = Vec::new();
        for first in (0..state.len() + inputs.len()).step_by(DIRECTIONS) {
            let seeded = self.seeded(t, state, inputs, first)?;
            let count = (state.len() + inputs.len() - first).min(DIRECTIONS);
            let entries = start.as_mut_slice().iter_mut();
            for (entry, dual) in entries.zip(seeded.row.as_slice()) {
                *entry = dual.value;
            }
            tangents.extend((0..count).map(|k| {
                let mut tangent = Tangent::<S>::zero();
                take(tangent.state.as_mut_slice(), seeded.row.as_slice(), k);
                let parameters = tangent.parameters.as_mut_slice();
                take(parameters, seeded.parameters.as_slice(), k);
                tangent
            }));
        }
        Ok((start, tangents))
    }

    /// The components of a state of the system, and for each component a row of derivatives along all tangents.
    ///
    /// # Errors
    /// [`Unlinear::Fault`] if the velocities do not exist.
    pub fn components(
        &self,
        t: f64,
        state: &S::State,
        tangents: &[Tangent<S>],
    ) -> Result<(Vec<f64>, Vec<Vec<f64>>), Unlinear> {
        let (mut values, mut slopes) = (Vec::new(), Vec::new());
        for some in tangents.chunks(DIRECTIONS) {
            let values_of = self.system.parameters();
            let along = |value: f64, of: &dyn Fn(&Tangent<S>) -> f64| {
                let mut slopes = [0.0; DIRECTIONS];
                for (slope, tangent) in slopes.iter_mut().zip(some) {
                    *slope = of(tangent);
                }
                Dual::new(value, slopes)
            };
            let parameters = values_of.as_slice().iter().enumerate();
            let parameters: Vec<Dual> = parameters
                .map(|(k, value)| along(*value, &|it| it.parameters.as_slice()[k]))
                .collect();
            let row = state.as_slice().iter().enumerate();
            let row: Vec<Dual> = row
                .map(|(k, value)| along(*value, &|it| it.state.as_slice()[k]))
                .collect();
            let found = match self.kind {
                Kind::State => row,
                Kind::Velocities => {
                    let n = self.system.coordinate_count();
                    let parameters = filled::<S::Parameters<Dual>>(&parameters);
                    let whole = filled::<S::Row<Dual>>(&row);
                    let velocities = self.system.velocities(&parameters, Dual::of(t), &whole)?;
                    [&row[..n], &velocities.as_slice()[..n]].concat()
                }
            };
            values = found.iter().map(|dual| dual.value).collect();
            slopes.resize(found.len(), Vec::new());
            for (row, dual) in slopes.iter_mut().zip(&found) {
                row.extend(&dual.slopes()[..some.len()]);
            }
        }
        Ok((values, slopes))
    }
}

/// Parameters, state and the components of the state as dual numbers.
struct Seeded<S: Variational> {
    parameters: S::Parameters<Dual>,
    row: S::Row<Dual>,
    seeds: Vec<Dual>,
}

/// Copies the derivatives of a row with respect to variable `k`.
fn take(entries: &mut [f64], row: &[Dual], k: usize) {
    for (entry, dual) in entries.iter_mut().zip(row) {
        *entry = dual.slopes()[k];
    }
}

/// A row with these numbers.
fn filled<R: Row<Dual>>(values: &[Dual]) -> R {
    let mut row = R::zeros(values.len());
    row.as_mut_slice().copy_from_slice(values);
    row
}
