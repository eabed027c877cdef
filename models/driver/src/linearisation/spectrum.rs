//! Eigenvalues of a linearisation, and how far rounding may move them.

use dalembert::contract::Variational;
use dalembert::math::larger;
use dalembert::state::StateVector;
use dalembert::variations::eigenvalues;

use super::largest;
use crate::ensemble::random::uniform;

/// Errors by which entries of A and eigenvalues may be wrong: relative to the entry, and to the largest entry.
const OF_ENTRY: f64 = 64.0 * f64::EPSILON;
const OF_LARGEST: f64 = 2.0 * f64::EPSILON;

/// Largest real part that counts as 0, as a multiple of the change of the eigenvalue under such errors.
const NEUTRAL: f64 = 8.0;

/// Number of errors that are tried.
const TRIALS: u64 = 4;

/// Maximum number of passes over rows and columns that make a matrix balanced.
const BALANCINGS: u32 = 32;

/// The eigenvalues of a square matrix, given by rows.
pub(super) fn spectrum<S: Variational>(rows: &[Vec<f64>]) -> Option<Vec<[f64; 2]>> {
    spectrum_of_balanced::<S>(&balanced(rows))
}

fn spectrum_of_balanced<S: Variational>(rows: &[Vec<f64>]) -> Option<Vec<[f64; 2]>> {
    let mut columns = S::columns();
    for (j, column) in columns.as_mut().iter_mut().enumerate().take(rows.len()) {
        let entries = column.as_mut_slice().iter_mut();
        entries.zip(rows).for_each(|(entry, row)| *entry = row[j]);
    }
    let found = eigenvalues(columns.as_mut(), rows.len())?;
    Some(found.iter().collect())
}

/// A matrix with the same eigenvalues whose rows and columns are about equally large: units of the components are changed
/// by powers of two (Osborne's balancing).
fn balanced(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut rows = rows.to_vec();
    let n = rows.len();
    for _ in 0..BALANCINGS {
        let mut is_balanced = true;
        for i in 0..n {
            let others = (0..n).filter(|j| *j != i);
            let row: f64 = others.clone().map(|j| rows[i][j].abs()).sum();
            let column: f64 = others.map(|j| rows[j][i].abs()).sum();
            let factor = (0.5 * (row / column).log2()).round().exp2();
            if row > 0.0 && column > 0.0 && factor.is_normal() && factor != 1.0 {
                is_balanced = false;
                (0..n).for_each(|j| rows[i][j] /= factor);
                rows.iter_mut().for_each(|row| row[i] *= factor);
            }
        }
        if is_balanced {
            break;
        }
    }
    rows
}

/// The largest real part of each eigenvalue that counts as 0: a multiple of the change of its real part under errors of the
/// entries and of the iteration. For a matrix near one with fewer eigenvectors, it is far above the rounding.
pub(super) fn margins<S: Variational>(rows: &[Vec<f64>], eigenvalues: &[[f64; 2]]) -> Vec<f64> {
    let rows = balanced(rows);
    let size = OF_LARGEST * largest(rows.iter().flatten());
    let mut margins = vec![0.0; eigenvalues.len()];
    for trial in 0..TRIALS {
        let mut changed = rows.clone();
        for (place, entry) in (0..).zip(changed.iter_mut().flatten()) {
            let sign = |which: u32| match uniform(trial, place, which) < 0.5 {
                true => -1.0,
                false => 1.0,
            };
            *entry += sign(0) * OF_ENTRY * *entry + sign(1) * size;
        }
        let others = spectrum_of_balanced::<S>(&changed);
        for (margin, [re, im]) in margins.iter_mut().zip(eigenvalues) {
            let apart = |other: &&[f64; 2]| (other[0] - re).hypot(other[1] - im);
            let nearest = others.iter().flatten();
            let nearest = nearest.min_by(|one, other| apart(one).total_cmp(&apart(other)));
            let change = nearest.map_or(f64::INFINITY, |nearest| (nearest[0] - re).abs());
            *margin = larger(*margin, NEUTRAL * change);
        }
    }
    margins
}
