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
//! | `nearby.rs` | eigenvalues at the states that rounding does not tell from an equilibrium |
//! | `kinks.rs` | places where the derivatives of the rates may jump |
//! | `spectrum.rs` | eigenvalues, and how far rounding may move them |
//! | `trim.rs` | an equilibrium near a state |
//! | `sampled.rs` | the motion from one sample to the next, across impacts |

mod kinks;
mod nearby;
mod sample;
mod sampled;
mod spectrum;
mod trim;

use dalembert::contract::Variational;
use dalembert::describe::{Description, VariationalVisitor};
use dalembert::math::larger;
use dalembert::{Fault, Instance, Outcome, Scene, Undefined};
use thiserror::Error;

use crate::names;
use crate::refusal::Refusal;
use kinks::kinks;
use nearby::nearby;
use sample::{Plant, Sample};
pub use sampled::{Sampling, Stride};
use spectrum::{margins, spectrum};
pub use trim::Trim;

/// Largest rate at an equilibrium, as a fraction of its largest term.
const AT_REST: f64 = 1e-9;

/// Rounding error of a component that is far smaller than the largest one, relative to that; and of a rate, relative to 1.
const ROUNDED: f64 = 64.0 * f64::EPSILON;

/// Times after that of the linearisation at which an equilibrium of equations that depend on time has to be at rest, too.
const LATER: [f64; 5] = [0.1, 0.37, 1.0, 2.9, 7.3];

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
    /// Indices of the components across whose values the derivatives of the rates jump, or are not shown to be continuous.
    pub kinks: Vec<usize>,
    /// Indices of the components whose rates are not 0 up to rounding, except [`Trim::moving`]. None after a search.
    pub unsteady: Vec<usize>,
    /// True if the equations depend on time: then eigenvalues at one time do not decide the stability.
    pub depends_on_time: bool,
    /// A later time at which the rates are not 0, if they are 0 at `t`.
    pub unsteady_at: Option<f64>,
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
    /// The derivatives of the rates jump here, or are not shown to be continuous: a linearisation may not exist.
    Kinked,
    /// The equations depend on time: eigenvalues at one time do not decide the stability.
    OfOneTime,
}

impl Linearisation {
    /// True if the state is at rest, up to rounding.
    pub fn is_equilibrium(&self) -> bool {
        self.unsteady.is_empty() && self.unsteady_at.is_none()
    }

    /// For each eigenvalue, the largest difference of its real part from that at the states nearby, in order of size. At a
    /// multiple root it is as large as the eigenvalue, which vanishes at the root.
    fn spreads(&self, eigenvalues: &[[f64; 2]]) -> Vec<f64> {
        let order = |spectrum: &[[f64; 2]]| {
            let mut order: Vec<usize> = (0..spectrum.len()).collect();
            order.sort_by(|&i, &j| spectrum[i][0].total_cmp(&spectrum[j][0]));
            order
        };
        let mut spreads = vec![0.0; eigenvalues.len()];
        let here = order(eigenvalues);
        for spectrum in &self.nearby {
            for (&i, &j) in here.iter().zip(&order(spectrum)) {
                let difference = eigenvalues[i][0] - spectrum[j][0];
                spreads[i] = larger(spreads[i], difference.abs());
            }
        }
        spreads
    }

    /// The stability by the eigenvalues; `None` if the state is not an equilibrium, or if the eigenvalues are unknown.
    pub fn tendency(&self) -> Option<Tendency> {
        let eigenvalues = self
            .eigenvalues
            .as_ref()
            .filter(|_| self.is_equilibrium())?;
        if self.depends_on_time {
            return Some(Tendency::OfOneTime);
        }
        if !self.kinks.is_empty() {
            return Some(Tendency::Kinked);
        }
        let spreads = self.spreads(eigenvalues);
        // The least number of eigenvalues with this sign of the real part, over the states that may be the equilibrium.
        let least = |sign: f64| {
            let others = self.nearby.iter().map(|spectrum| {
                let signs = spectrum.iter().filter(|[re, _]| sign * re > 0.0);
                signs.count()
            });
            let bounds = self.margins.iter().zip(&spreads);
            let pairs = eigenvalues.iter().zip(bounds);
            let counted =
                pairs.filter(|([re, _], (margin, spread))| sign * re > margin.max(2.0 * *spread));
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
    /// A rate or its derivative is not finite.
    #[error("the equations are not finite at this state")]
    NotFinite,
    /// An output or its derivative is not finite.
    #[error("the output `{name}`, or its derivative, is not finite at this state")]
    OutputNotFinite {
        /// The output.
        name: &'static str,
    },
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
            Self::NotFinite | Self::OutputNotFinite { .. } => "not_finite",
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
    let unsteady = match steps {
        Some(_) => Vec::new(),
        None => unsteady(&sample, &state, &inputs, moving, largest(state.iter())),
    };
    let depends_on_time = system.depends_on_time();
    let later = LATER.into_iter().filter(|_| depends_on_time);
    let mut later = later.map(|after| place.t + after);
    let unsteady_at = later.find(|&t| {
        let then = Plant::new(system, t).at(&state, &inputs);
        unsteady.is_empty()
            && then.is_ok_and(|sample| {
                let unit = larger(largest(state.iter()), 1.0);
                !self::unsteady(&sample, &state, &inputs, moving, unit).is_empty()
            })
    });
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
        depends_on_time,
        unsteady_at,
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

/// Components whose rates are not 0: they exceed a fraction of their largest term, and what rounding errors of a component of
/// the size `unit` make of them.
fn unsteady(
    sample: &Sample,
    state: &[f64],
    inputs: &[f64],
    moving: &[usize],
    unit: f64,
) -> Vec<usize> {
    let sizes = sizes(sample, state, inputs);
    let rates = sample.rates.iter().zip(&sizes).enumerate();
    let is_unsteady = |index: usize, rate: f64, size: f64| {
        let rounding = ROUNDED * unit * largest(sample.by_rates[index].iter());
        !moving.contains(&index) && rate.abs() > AT_REST * size + rounding
    };
    rates
        .filter(|(index, (rate, size))| is_unsteady(*index, **rate, **size))
        .map(|(index, _)| index)
        .collect()
}

/// The largest term of each rate.
fn sizes(sample: &Sample, state: &[f64], inputs: &[f64]) -> Vec<f64> {
    let values: Vec<f64> = state.iter().chain(inputs).copied().collect();
    let size = |slopes: &Vec<f64>| {
        let terms = slopes.iter().zip(&values);
        let terms = terms.map(|(slope, value)| slope * value);
        terms.fold(0.0, |most, term: f64| larger(most, term.abs()))
    };
    sample.by_rates.iter().map(size).collect()
}

/// The largest absolute value.
fn largest<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    values.fold(0.0, |most, value| larger(most, value.abs()))
}
