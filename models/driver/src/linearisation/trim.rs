//! Search for an equilibrium near a state, by the Levenberg-Marquardt method with exact derivatives.

use std::f64::consts::TAU;

use dalembert::Instance;
use dalembert::contract::Variational;
use dalembert::describe::Topology;
use dalembert::math::larger;

use super::sample::{Plant, Sample};
use super::{Unlinear, largest};
use crate::least_squares::{damped, solve};
use crate::linear::norm;

/// Maximum number of steps.
const STEPS: u32 = 200;

/// Residual at which the search stops, in units of [`Walk::unit`].
const SETTLED: f64 = 1e-12;

/// Largest accepted residual of an equilibrium, in the same unit.
const SOLVED: f64 = 1e-9;

/// Maximum number of steps after the search, and the ratio of two successive steps above which they do not lead to a root.
const LAST_STEPS: u32 = 100;
const SHRINKS: f64 = 0.96;

/// Damping of these steps where the equations are singular, in units of the length of a column.
const FAINT: f64 = 1e-12;

/// Length of such a step that is a rounding error, relative to the values.
const ROUNDED: f64 = 1e-15;

/// Largest length of a step that rounding forbids, relative to the values or to 1.
pub(super) const NEAR: f64 = 1e-4;

/// Residual that is a rounding error, in units of the largest derivative times the largest value.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// Largest damping of a step, as a multiple of the smaller one of two numbers: the norm of the residuals and the largest
/// derivative.
const DAMPED: f64 = 1e8;

/// Smallest damping, in the same unit.
const LEAST: f64 = 1e-6;

/// Search for an equilibrium from a state.
#[derive(Debug, Clone, Default)]
pub struct Trim {
    /// Indices of the variables that the search changes, among the components of the state followed by the inputs. If
    /// it is empty, the search changes all of them.
    pub free: Vec<usize>,
    /// Indices of components whose rates need not vanish, for example coordinates that move steadily.
    pub moving: Vec<usize>,
}

/// The equations of an equilibrium.
struct Equations<'a> {
    trim: &'a Trim,
    /// The values of the levels at the start.
    levels: Vec<f64>,
}

impl Equations<'_> {
    /// Residuals, each with the index of its component; `None` for levels.
    fn residuals(&self, sample: &Sample) -> Vec<(Option<usize>, f64)> {
        let rates = sample.rates.iter().enumerate();
        let rates = rates.filter(|(index, _)| !self.trim.moving.contains(index));
        let levels = sample.levels.iter().zip(&self.levels);
        rates
            .map(|(index, rate)| (Some(index), *rate))
            .chain(levels.map(|(level, start)| (None, level - start)))
            .collect()
    }

    /// Derivatives of the residuals with respect to the free variables, one column per variable.
    fn columns(&self, sample: &Sample, free: &[usize]) -> Vec<Vec<f64>> {
        let rates = sample.by_rates.iter().enumerate();
        let rates = rates.filter(|(index, _)| !self.trim.moving.contains(index));
        let rows: Vec<&Vec<f64>> = rates.map(|(_, row)| row).chain(&sample.by_levels).collect();
        free.iter()
            .map(|&j| rows.iter().map(|row| row[j]).collect())
            .collect()
    }
}

/// State of the search.
struct Walk<'a, S: Instance + Variational> {
    plant: &'a Plant<'a, S>,
    equations: Equations<'a>,
    free: Vec<usize>,
    /// Number of components of the state.
    count: usize,
    /// The state, then the inputs.
    values: Vec<f64>,
    sample: Sample,
    /// Damping of the next step, in the unit of [`DAMPED`].
    factor: f64,
}

/// Moves state and inputs to an equilibrium near them, and returns the number of steps.
///
/// # Errors
/// [`Unlinear::NoEquilibrium`] or [`Unlinear::OffLevel`] if the search fails; [`Unlinear::Fault`] or
/// [`Unlinear::NotFinite`] if the equations have no derivative at the start.
pub(super) fn settle<S: Instance + Variational>(
    plant: &Plant<'_, S>,
    trim: &Trim,
    state: &mut [f64],
    inputs: &mut [f64],
) -> Result<u32, Unlinear> {
    let values: Vec<f64> = [&*state, &*inputs].concat();
    let sample = plant.at(state, inputs)?;
    let mut walk = Walk {
        plant,
        equations: Equations {
            trim,
            levels: sample.levels.clone(),
        },
        free: match trim.free.is_empty() {
            true => (0..values.len()).collect(),
            false => trim.free.clone(),
        },
        count: state.len(),
        values,
        sample,
        factor: 1.0,
    };
    let mut steps = 0;
    while steps < STEPS && walk.size(&walk.sample) > SETTLED * walk.unit() && walk.step() {
        steps += 1;
    }
    let converged = walk.converge();
    walk.check()?;
    steps += converged?;
    walk.unwind(state);
    state.copy_from_slice(&walk.values[..walk.count]);
    inputs.copy_from_slice(&walk.values[walk.count..]);
    Ok(steps)
}

impl<S: Instance + Variational> Walk<'_, S> {
    /// The norm of the residuals of a sample.
    fn size(&self, sample: &Sample) -> f64 {
        let residuals = self.equations.residuals(sample);
        norm(&residuals.iter().map(|it| it.1).collect::<Vec<_>>())
    }

    /// The unit of the residuals: the largest derivative times the largest value, each at least 1.
    fn unit(&self) -> f64 {
        let columns = self.equations.columns(&self.sample, &self.free);
        larger(largest(columns.iter().flatten()), 1.0) * larger(largest(self.values.iter()), 1.0)
    }

    /// The linear equations of a step: derivatives by column, and residuals.
    fn linear(&self) -> (Vec<Vec<f64>>, Vec<f64>) {
        let residuals = self.equations.residuals(&self.sample).into_iter();
        let columns = self.equations.columns(&self.sample, &self.free);
        (columns, residuals.map(|it| it.1).collect())
    }

    /// Makes a step that reduces the residuals. Returns false if no step does.
    fn step(&mut self) -> bool {
        let (columns, residuals) = self.linear();
        let slope = largest(columns.iter().flatten());
        let size = norm(&residuals);
        while self.factor <= DAMPED {
            let change = damped(&columns, &residuals, self.factor * size.min(slope));
            if change.is_some_and(|change| self.improve(&change, size)) {
                self.factor = (self.factor / 4.0).max(LEAST);
                return true;
            }
            self.factor *= 8.0;
        }
        false
    }

    /// Newton steps from a state with small residuals to the root. Residuals also become small where there is no root: those of
    /// `exp(-x)` do far away, and those of a slow motion are small everywhere. The steps do not become shorter there. At a
    /// multiple root each is shorter than the one before by a constant factor.
    fn converge(&mut self) -> Result<u32, Unlinear> {
        let mut before = f64::INFINITY;
        for made in 0..LAST_STEPS {
            let (columns, residuals) = self.linear();
            let Some(change) = newton(&columns, &residuals) else {
                return Ok(made);
            };
            let length = norm(&change);
            let terms = largest(columns.iter().flatten()) * largest(self.values.iter());
            let is_constant = norm(&residuals) > ROUNDINGS * terms + f64::MIN_POSITIVE;
            if is_constant && is_unchanged(&columns, &residuals, &change) {
                return Err(self.failure());
            }
            if length <= ROUNDED * norm(&self.values) {
                return Ok(made);
            }
            let shrinks = length <= SHRINKS * before;
            if !shrinks || !self.improve(&change, norm(&residuals)) {
                let is_near = length <= NEAR * larger(norm(&self.values), 1.0);
                let is_rounding = norm(&residuals) <= ROUNDINGS * self.unit();
                return match is_near && is_rounding {
                    true => Ok(made),
                    false => Err(self.failure()),
                };
            }
            before = length;
        }
        Ok(LAST_STEPS)
    }

    /// Subtracts a change if this reduces the residuals and the model allows the state.
    fn improve(&mut self, change: &[f64], size: f64) -> bool {
        let mut next = self.values.clone();
        for (&place, change) in self.free.iter().zip(change) {
            next[place] -= change;
        }
        let (state, inputs) = next.split_at(self.count);
        match self.plant.at(state, inputs) {
            Ok(sample) if self.size(&sample) < size && self.plant.is_allowed(state, inputs) => {
                (self.values, self.sample) = (next, sample);
                true
            }
            _ => false,
        }
    }

    /// Changes angles by whole turns to the values nearest to the start.
    fn unwind(&mut self, start: &[f64]) {
        let coordinates = self.plant.system.description().coordinates.iter();
        for (index, coordinate) in coordinates.enumerate() {
            if coordinate.topology == Topology::Circle {
                let turns = ((self.values[index] - start[index]) / TAU).round();
                self.values[index] -= TAU * turns;
            }
        }
    }

    /// Refuses residuals above [`SOLVED`].
    fn check(&self) -> Result<(), Unlinear> {
        let worst = self.worst();
        match worst.is_some_and(|(_, rate)| rate.abs() > SOLVED * self.unit()) {
            true => Err(self.failure()),
            false => Ok(()),
        }
    }

    /// The largest residual.
    fn worst(&self) -> Option<(Option<usize>, f64)> {
        let residuals = self.equations.residuals(&self.sample).into_iter();
        residuals.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }

    /// The search has failed.
    fn failure(&self) -> Unlinear {
        match self.worst() {
            Some((Some(component), rate)) => Unlinear::NoEquilibrium { component, rate },
            Some((None, excess)) => Unlinear::OffLevel { excess },
            None => Unlinear::NoEquilibrium {
                component: 0,
                rate: 0.0,
            },
        }
    }
}

/// The Newton step from residuals, with derivatives by column; it is to be subtracted. Columns are scaled to the length 1, so
/// that a variable whose derivatives vanish at the root counts like others.
pub(super) fn newton(columns: &[Vec<f64>], residuals: &[f64]) -> Option<Vec<f64>> {
    let lengths = columns.iter().map(|column| norm(column));
    let units: Vec<f64> = lengths
        .map(|length| if length > 0.0 { length } else { 1.0 })
        .collect();
    let scaled = columns.iter().zip(&units);
    let scaled: Vec<Vec<f64>> = scaled
        .map(|(column, unit)| column.iter().map(|slope| slope / unit).collect())
        .collect();
    let mut change = solve(&scaled, residuals).or_else(|| damped(&scaled, residuals, FAINT))?;
    for (change, unit) in change.iter_mut().zip(&units) {
        *change /= unit;
    }
    Some(change)
}

/// True if a change hardly reduces the residuals of the linear equations, because they are singular along its direction.
fn is_unchanged(columns: &[Vec<f64>], residuals: &[f64], change: &[f64]) -> bool {
    let mut left = residuals.to_vec();
    for (column, change) in columns.iter().zip(change) {
        for (left, slope) in left.iter_mut().zip(column) {
            *left -= slope * change;
        }
    }
    norm(&left) > 0.5 * norm(residuals)
}
