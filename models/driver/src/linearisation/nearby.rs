//! Eigenvalues at the states that rounding does not tell from an equilibrium. At a multiple root they differ from each other
//! as much as from 0.

use dalembert::Instance;
use dalembert::contract::Variational;
use dalembert::math::larger;

use super::sample::{Plant, Sample};
use super::spectrum::spectrum;
use super::{ROUNDED, sizes, split, trim};

/// Distance between an equilibrium and the neighbours at which its stability is compared, in Newton steps. At a double
/// root, one Newton step covers half of the distance to the root.
const BEYOND: f64 = 4.0;

/// Distances of states at which the rounding of the rates shows, relative to a component.
const APART: [f64; 3] = [4e-8, 1e-6, 1e-5];

/// A component that may be the rounding error of 0.
const SMALL: f64 = 1e-13;

/// Distance to which a double root is known.
const AROUND: f64 = 4e-8;

/// The eigenvalues at states that may be the equilibrium instead; none where the equations are not defined. They are
/// [`BEYOND`] Newton steps away in both directions; at 0 for a component that may be a rounding error of 0; and at the distance
/// [`AROUND`] where the rates are still rounding errors.
pub(super) fn nearby<S: Instance + Variational>(
    plant: &Plant<'_, S>,
    sample: &Sample,
    (state, inputs): (&[f64], &[f64]),
    moving: &[usize],
) -> Vec<Vec<[f64; 2]>> {
    let Some(step) = largest_step(plant, sample, (state, inputs), moving) else {
        return Vec::new();
    };
    let spectrum_of = |sample: &Sample| spectrum::<S>(&split(&sample.by_rates, state.len())[0]);
    let beside = [-BEYOND, BEYOND].map(|factor| -> Vec<f64> {
        let moved = state.iter().zip(&step).map(|(value, step)| {
            let most = trim::NEAR * value.abs().max(1.0);
            value + factor * step.clamp(-most, most)
        });
        moved.collect()
    });
    let axes = 0..state.len();
    let small = axes
        .clone()
        .filter(|&axis| state[axis] != 0.0 && state[axis].abs() < SMALL);
    let at_zero = small.map(|axis| with(state, axis, 0.0));
    // Beyond the edge of the domain of the equations, nothing is known of the eigenvalues.
    let known = beside.into_iter().chain(at_zero).map(|moved| {
        let sample = plant.at(&moved, inputs).ok();
        sample
            .and_then(|sample| spectrum_of(&sample))
            .unwrap_or_default()
    });
    let around = axes.flat_map(|axis| {
        [-AROUND, AROUND].map(|distance| with(state, axis, state[axis] + distance))
    });
    let at_rest = around.filter_map(|moved| {
        let sample = plant.at(&moved, inputs).ok()?;
        let rates = sample.rates.iter().enumerate();
        let mut rates = rates.filter(|(index, _)| !moving.contains(index));
        let is_at_rest = rates.all(|(_, rate)| rate.abs() <= ROUNDED);
        spectrum_of(&sample).filter(|_| is_at_rest)
    });
    known.chain(at_rest).collect()
}

/// The Newton step for rates that are at least as large as their rounding.
fn largest_step<S: Instance + Variational>(
    plant: &Plant<'_, S>,
    sample: &Sample,
    (state, inputs): (&[f64], &[f64]),
    moving: &[usize],
) -> Option<Vec<f64>> {
    let sizes = sizes(sample, state, inputs);
    let noises = noises(plant, sample, (state, inputs));
    let residual = |index: usize| {
        let rounding = larger(f64::EPSILON * sizes[index], noises[index]);
        let rate = sample.rates[index];
        match moving.contains(&index) {
            true => 0.0,
            false => larger(rate.abs(), rounding).copysign(rate),
        }
    };
    let residuals: Vec<f64> = (0..state.len()).map(residual).collect();
    let column = |j: usize| sample.by_rates.iter().map(|row| row[j]).collect();
    let columns: Vec<Vec<f64>> = (0..state.len()).map(column).collect();
    trim::newton(&columns, &residuals)
}

/// A state with another value of one component.
fn with(state: &[f64], axis: usize, value: f64) -> Vec<f64> {
    let mut changed = state.to_vec();
    changed[axis] = value;
    changed
}

/// The rounding of each rate: half the difference of its deviations from the linear equations at two states, one on each side.
/// The curvature of the rate is the same on both sides, and drops out.
fn noises<S: Instance + Variational>(
    plant: &Plant<'_, S>,
    sample: &Sample,
    (state, inputs): (&[f64], &[f64]),
) -> Vec<f64> {
    let mut noises = vec![0.0; sample.rates.len()];
    let places = (0..state.len()).flat_map(|axis| APART.map(|distance| (axis, distance)));
    for (axis, distance) in places {
        let rates = [-distance, distance].map(|distance| {
            let moved = with(state, axis, state[axis] + distance * state[axis].abs());
            let change = moved[axis] - state[axis];
            plant.at(&moved, inputs).map(|there| (change, there.rates))
        });
        let [Ok((back, before)), Ok((ahead, after))] = rates else {
            continue;
        };
        for (row, noise) in noises.iter_mut().enumerate() {
            let linear = sample.by_rates[row][axis] * (ahead - back);
            let deviation = 0.5 * (after[row] - before[row] - linear);
            *noise = larger(*noise, deviation.abs());
        }
    }
    noises
}
