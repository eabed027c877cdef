//! Linearisation of the equations of motion at a state, or at an equilibrium near it.
//!
//! ```text
//! d/dt y = A y + B u,   z = C y + D u       for small deviations y of the state, u of the inputs, z of the outputs
//! ```
//!
//! The state consists of `(q, qdot)` without constraints, of positions and quasi-velocities with constraints, and of
//! the coordinates of a first-order system. All derivatives are exact to rounding.
//!
//! | file | job |
//! |---|---|
//! | `sample.rs` | the rates and the outputs at a state, with their derivatives |
//! | `kinks.rs` | places where the derivatives of the rates jump |
//! | `spectrum.rs` | eigenvalues, and how far rounding may move them |
//! | `trim.rs` | an equilibrium near a state |
//! | `sampled.rs` | the motion from one sample to the next, across impacts |

mod kinks;
mod sample;
mod sampled;
mod spectrum;
mod trim;

use dalembert::contract::Variational;
use dalembert::describe::{Description, VariationalVisitor};
use dalembert::math::larger;
use dalembert::{Fault, Instance, Outcome, Scene, Undefined};
use thiserror::Error;

use crate::least_squares::damped;
use crate::names;
use crate::refusal::Refusal;
use kinks::kinks;
use sample::{Plant, Sample};
pub use sampled::{Sampling, Stride};
use spectrum::{margins, spectrum};
pub use trim::Trim;

/// Largest rate at an equilibrium, as a fraction of its largest term.
const AT_REST: f64 = 1e-9;

/// Distance between an equilibrium and the neighbours at which its stability is compared, in Newton steps. At a double
/// root, one Newton step covers half of the distance to the root.
const BEYOND: f64 = 4.0;

/// Linearisation of a model at a state.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearisation {
    /// The time.
    pub t: f64,
    /// The names of the components of the state, see [`components`].
    pub components: Vec<String>,
    /// The state.
    pub state: Vec<f64>,
    /// The values of the inputs.
    pub inputs: Vec<f64>,
    /// The rates of the state.
    pub rates: Vec<f64>,
    /// The names of the outputs. Outputs that are integrals along a run have no value at a state and are left out.
    pub output_names: Vec<&'static str>,
    /// The values of the outputs.
    pub outputs: Vec<f64>,
    /// `A`, row by row: derivatives of the rates with respect to the state.
    pub a: Vec<Vec<f64>>,
    /// `B`, row by row: derivatives of the rates with respect to the inputs.
    pub b: Vec<Vec<f64>>,
    /// `C`, row by row: derivatives of the outputs with respect to the state.
    pub c: Vec<Vec<f64>>,
    /// `D`, row by row: derivatives of the outputs with respect to the inputs.
    pub d: Vec<Vec<f64>>,
    /// The eigenvalues of `A`, as real and imaginary parts; `None` if they are not found.
    pub eigenvalues: Option<Vec<[f64; 2]>>,
    /// The eigenvalues at states on both sides of this one, several Newton steps away. Where two equilibria meet,
    /// rounding leaves the equilibrium uncertain, and its stability differs between these states.
    pub(crate) nearby: Vec<Vec<[f64; 2]>>,
    /// Largest real part of each eigenvalue that counts as 0.
    pub(crate) margins: Vec<f64>,
    /// Indices of the components across whose values the derivatives of the rates jump.
    pub kinks: Vec<usize>,
    /// Indices of the components whose rates are not 0 up to rounding, except [`Trim::moving`].
    pub unsteady: Vec<usize>,
    /// Number of levels that the constraints conserve. Each level makes one eigenvalue 0, which belongs to a direction
    /// off the constraints.
    pub levels: usize,
    /// Number of steps to the equilibrium; `None` without a search.
    pub steps: Option<u32>,
    /// The sampled motion from this state on.
    pub strides: Vec<Stride>,
}

/// Stability of an equilibrium by its linearisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tendency {
    /// All eigenvalues have negative real parts: small deviations decay.
    Stable,
    /// This many eigenvalues have positive real parts: some deviations grow.
    Unstable(usize),
    /// No eigenvalue has a positive real part, and this many have the real part 0 up to rounding: the linearisation
    /// does not decide the stability.
    Neutral(usize),
    /// The derivatives of the rates jump here: there is no linearisation.
    Kinked,
}

impl Linearisation {
    /// The stability by the eigenvalues; `None` if the state is not an equilibrium, or if the eigenvalues are unknown.
    pub fn tendency(&self) -> Option<Tendency> {
        let eigenvalues = self
            .eigenvalues
            .as_ref()
            .filter(|_| self.unsteady.is_empty())?;
        if !self.kinks.is_empty() {
            return Some(Tendency::Kinked);
        }
        // The least number of eigenvalues with this sign of the real part, over the states that may be the equilibrium.
        let least = |sign: f64| {
            let others = self.nearby.iter().map(|spectrum| {
                let signs = spectrum.iter().filter(|[re, _]| sign * re > 0.0);
                signs.count()
            });
            let pairs = eigenvalues.iter().zip(&self.margins);
            let counted = pairs.filter(|([re, _], margin)| sign * re > **margin);
            others.fold(counted.count(), usize::min)
        };
        let (growing, decaying) = (least(1.0), least(-1.0));
        // The eigenvalues of directions off the constraints are 0 and belong to no motion.
        let moving = eigenvalues.len().saturating_sub(self.levels);
        let neutral = moving.saturating_sub(growing + decaying);
        Some(match (growing, neutral) {
            (0, 0) => Tendency::Stable,
            (0, neutral) => Tendency::Neutral(neutral),
            (growing, _) => Tendency::Unstable(growing),
        })
    }
}

/// Request for a linearisation.
#[derive(Debug, Clone, Default)]
pub struct Place {
    /// The time, for equations that depend on it.
    pub t: f64,
    /// The search for an equilibrium from the given state; `None` to linearise at that state.
    pub trim: Option<Trim>,
    /// The sampled motion from the state or equilibrium on, if requested.
    pub sampling: Option<Sampling>,
}

/// Reasons why there is no linearisation.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Unlinear {
    /// The model has modes.
    #[error("a model with modes has no linearisation here")]
    Modes,
    /// The model has constraints and no reduced form.
    #[error("the motion is not reduced to its constraints, so there are no independent velocities")]
    Unreduced,
    /// A rate, an output or a derivative does not exist.
    #[error("the equations have no derivative at this state")]
    Fault(Fault),
    /// A rate, an output or a derivative is not finite.
    #[error("the equations are not finite at this state")]
    NotFinite,
    /// The sampled motion ends early.
    #[error("the motion ends at t = {t}: {outcome}")]
    Ended {
        /// The time.
        t: f64,
        /// The outcome.
        outcome: Outcome,
    },
    /// The sampled motion has no derivative.
    #[error(transparent)]
    Undefined(#[from] Undefined),
    /// No equilibrium was found.
    #[error("no equilibrium was found: the rate of component {component} stays at {rate:.3e}")]
    NoEquilibrium {
        /// The component with the largest rate.
        component: usize,
        /// Its rate in the best state that was found.
        rate: f64,
    },
    /// No equilibrium on the constraints was found.
    #[error("no equilibrium was found on the constraints: a level is off by {excess:.3e}")]
    OffLevel {
        /// The difference of a level from its value at the start, in the best state that was found.
        excess: f64,
    },
}

impl Unlinear {
    /// The class in snake case, as documents write it.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Modes => "modes",
            Self::Unreduced => "unreduced",
            Self::Fault(_) => "fault",
            Self::NotFinite => "not_finite",
            Self::Ended { .. } => "ended",
            Self::Undefined(undefined) => undefined.kind(),
            Self::NoEquilibrium { .. } | Self::OffLevel { .. } => "no_equilibrium",
        }
    }
}

impl From<Fault> for Unlinear {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

/// The names of the components of a linearised state: coordinates, then velocities or, with constraints,
/// quasi-velocities.
pub fn components(description: &Description) -> Vec<String> {
    let coordinates = names::coordinates(description);
    let motion: Vec<String> = match description.is_first_order {
        true => Vec::new(),
        false if description.constraints.is_empty() => {
            coordinates.clone().map(names::velocity).collect()
        }
        false => {
            let quasi = description.quasi_velocities.iter();
            quasi.map(|name| (*name).to_owned()).collect()
        }
    };
    coordinates.map(str::to_owned).chain(motion).collect()
}

/// Visitor that linearises a system of any type.
pub(crate) struct Lineariser<'a> {
    /// Positions and velocities.
    pub given: [&'a [f64]; 2],
    pub place: &'a Place,
}

impl VariationalVisitor for Lineariser<'_> {
    /// The inner error says why there is no linearisation, the outer one why the state is refused.
    type Output = Result<Result<Linearisation, Unlinear>, Refusal>;

    fn visit<S: Instance + Scene + Variational>(self, system: &S) -> Self::Output {
        let description = system.description();
        if !description.modes.is_empty() {
            return Ok(Err(Unlinear::Modes));
        }
        let is_free = description.constraints.is_empty();
        if !is_free && description.quasi_velocities.is_empty() {
            return Ok(Err(Unlinear::Unreduced));
        }
        let state = sample::start(system, self.place.t, self.given)?;
        Ok(linearise(system, self.place, state))
    }
}

/// The linearisation at the requested equilibrium, or at the state itself.
fn linearise<S: Instance + Scene + Variational>(
    system: &S,
    place: &Place,
    mut state: Vec<f64>,
) -> Result<Linearisation, Unlinear> {
    let plant = Plant::new(system, place.t);
    let mut inputs = plant.inputs();
    let mut steps = None;
    if let Some(trim) = &place.trim {
        steps = Some(trim::settle(&plant, trim, &mut state, &mut inputs)?);
    }
    let sample = plant.at(&state, &inputs)?;
    let moving = place.trim.as_ref().map_or(&[][..], |trim| &trim.moving);
    let unsteady = unsteady(&sample, &state, &inputs, moving);
    let nearby = match unsteady.is_empty() {
        true => nearby(&plant, &sample, (&state, &inputs), moving),
        false => Vec::new(),
    };
    let kinks = kinks(&plant, (&state, &inputs));
    let description = system.description();
    let n = state.len();
    let [a, b] = split(&sample.by_rates, n);
    let is_value = |index: &usize| !description.integrals.contains(index);
    let values: Vec<usize> = (0..sample.outputs.len()).filter(is_value).collect();
    let by_outputs: Vec<Vec<f64>> = (values.iter())
        .map(|&index| sample.by_outputs[index].clone())
        .collect();
    let [c, d] = split(&by_outputs, n);
    let strides = match &place.sampling {
        Some(sampling) => sampled::strides(&plant, sampling, &state, &inputs)?,
        None => Vec::new(),
    };
    let eigenvalues = spectrum::<S>(&a);
    let margins = match &eigenvalues {
        Some(eigenvalues) => margins::<S>(&a, eigenvalues),
        None => Vec::new(),
    };
    Ok(Linearisation {
        t: place.t,
        components: components(description),
        eigenvalues,
        margins,
        a,
        b,
        c,
        d,
        nearby,
        kinks,
        unsteady,
        levels: sample.levels.len(),
        rates: sample.rates,
        output_names: values
            .iter()
            .map(|&index| description.outputs[index])
            .collect(),
        outputs: values.iter().map(|&index| sample.outputs[index]).collect(),
        state,
        inputs,
        steps,
        strides,
    })
}

/// Splits the rows of a matrix after its first `columns` entries.
fn split(rows: &[Vec<f64>], columns: usize) -> [Vec<Vec<f64>>; 2] {
    let pairs = rows.iter().map(|row| row.split_at(columns));
    let (left, right) = pairs
        .map(|(left, right)| (left.to_vec(), right.to_vec()))
        .unzip();
    [left, right]
}

/// Components whose rates are not 0 up to the rounding of their terms.
fn unsteady(sample: &Sample, state: &[f64], inputs: &[f64], moving: &[usize]) -> Vec<usize> {
    let sizes = sizes(sample, state, inputs);
    let rates = sample.rates.iter().zip(&sizes).enumerate();
    rates
        .filter(|(index, (rate, size))| {
            !moving.contains(index) && rate.abs() > AT_REST * size.max(1.0)
        })
        .map(|(index, _)| index)
        .collect()
}

/// The largest term of each rate.
fn sizes(sample: &Sample, state: &[f64], inputs: &[f64]) -> Vec<f64> {
    let values: Vec<f64> = state.iter().chain(inputs).copied().collect();
    let size = |slopes: &Vec<f64>| {
        let terms = slopes.iter().zip(&values);
        let terms = terms.map(|(slope, value)| slope * value.abs().max(1.0));
        terms.fold(0.0, |most, term: f64| larger(most, term.abs()))
    };
    sample.by_rates.iter().map(size).collect()
}

/// The eigenvalues at the states [`BEYOND`] Newton steps away in both directions, where the equations are defined. The
/// residual of a Newton step is at least the rounding of the rate's terms.
fn nearby<S: Instance + Variational>(
    plant: &Plant<'_, S>,
    sample: &Sample,
    (state, inputs): (&[f64], &[f64]),
    moving: &[usize],
) -> Vec<Vec<[f64; 2]>> {
    let n = state.len();
    let sizes = sizes(sample, state, inputs);
    let rates = sample.rates.iter().zip(&sizes).enumerate();
    let residuals: Vec<f64> = rates
        .map(|(index, (rate, size))| match moving.contains(&index) {
            true => 0.0,
            false => rate.abs().max(f64::EPSILON * size).copysign(*rate),
        })
        .collect();
    let columns: Vec<Vec<f64>> = (0..n)
        .map(|j| sample.by_rates.iter().map(|row| row[j]).collect())
        .collect();
    let damping = f64::EPSILON.sqrt() * largest(columns.iter().flatten());
    let Some(step) = damped(&columns, &residuals, damping) else {
        return Vec::new();
    };
    let beside = |factor: f64| {
        let moved = state.iter().zip(&step);
        let moved: Vec<f64> = moved.map(|(value, step)| value + factor * step).collect();
        let sample = plant.at(&moved, inputs).ok()?;
        spectrum::<S>(&split(&sample.by_rates, n)[0])
    };
    [-BEYOND, BEYOND].into_iter().filter_map(beside).collect()
}

/// The largest absolute value.
fn largest<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    values.fold(0.0, |most, value| larger(most, value.abs()))
}
