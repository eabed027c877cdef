//! The generic rank of a matrix of expressions, by elimination modulo primes at random points.
//!
//! The rank at a point never exceeds the generic rank, so the largest rank at a few points is taken. At one point the
//! rank is too small with probability `d/p` at most, where `d` is the degree of a nonzero minor of the generic rank.

use crate::field::Modulus;
use crate::node::ExprId;
use crate::pool::Pool;
use crate::zero::{CLEAR, SamplePoints};

/// The result of [`Pool::rank`].
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RankReport {
    /// The generic rank.
    pub rank: usize,
    /// The rows that do not depend on earlier rows, in order.
    pub independent_rows: Vec<usize>,
    /// Every other row, with the earlier independent rows that it is a combination of; a row of zeros has none.
    pub dependencies: Vec<(usize, Vec<usize>)>,
    /// Pivot column of each independent row, in the same order: the first column in which the row is not 0 after the
    /// earlier independent rows were eliminated from it.
    pub pivot_columns: Vec<usize>,
    /// True if the independence is certain. It is uncertain if the entries could not be evaluated. If they contain
    /// roots, absolute values, or functions whose relations are hidden from residues, it is certain only if values in
    /// double precision confirm the rank.
    pub decided: bool,
}

/// Numbers of points, without and with roots in the entries. The sign of a root at a point is arbitrary and may make
/// rows dependent there, so roots need more points.
const SAMPLES: (usize, usize) = (3, 24);
const REAL_SAMPLES: u64 = 12;

impl Pool {
    /// The generic rank of a matrix given by rows of equal length.
    pub fn rank(&self, rows: &[Vec<ExprId>]) -> RankReport {
        let roots: Vec<ExprId> = rows.iter().flatten().copied().collect();
        let order = self.reachable(&roots);
        let profile = self.profile(&order);
        let mut best: Option<RankReport> = None;
        let mut samples = SamplePoints::new(self, &order, &profile, 0);
        let count = if profile.branches {
            SAMPLES.1
        } else {
            SAMPLES.0
        };
        for _ in 0..count {
            let report = samples.as_mut().and_then(|samples| {
                samples.find(self, |point| {
                    let values = self.modular_eval_ordered(&order, &roots, point).ok()?;
                    Some(eliminate(point.modulus(), rows, values))
                })
            });
            best = better(best, report);
            if best.as_ref().is_some_and(|best| best.rank == rows.len()) {
                break;
            }
        }
        let Some(mut report) = best else {
            return undecided();
        };
        report.decided = profile.is_exact() || self.has_real_rank(rows, &roots, report.rank);
        report
    }

    /// True if the matrix clearly has at least this rank at some real point.
    fn has_real_rank(&self, rows: &[Vec<ExprId>], roots: &[ExprId], rank: usize) -> bool {
        rank == 0
            || (0..REAL_SAMPLES).any(|seed| {
                let values = self.eval(roots, &|symbol| self.real_sample(symbol, seed));
                real_rank(rows, values) >= rank
            })
    }
}

/// The report of higher rank. Of two reports of equal rank, the one whose dependencies contain more rows: at one point,
/// the coefficient of a row may vanish by chance.
fn better(a: Option<RankReport>, b: Option<RankReport>) -> Option<RankReport> {
    let weight = |report: &RankReport| {
        let named: usize = report.dependencies.iter().map(|(_, rows)| rows.len()).sum();
        (report.rank, named)
    };
    match (a, b) {
        (Some(a), Some(b)) => Some(if weight(&b) > weight(&a) { b } else { a }),
        (a, b) => a.or(b),
    }
}

fn undecided() -> RankReport {
    RankReport {
        rank: 0,
        independent_rows: Vec::new(),
        dependencies: Vec::new(),
        pivot_columns: Vec::new(),
        decided: false,
    }
}

/// An echelon row: its entries, and its coefficients in the original rows.
struct EchelonRow {
    pivot: usize,
    entries: Vec<u64>,
    combination: Vec<u64>,
}

/// Gaussian elimination, row by row. The remainder of a row is 0 or independent of the rows before it.
fn eliminate(field: Modulus, rows: &[Vec<ExprId>], values: Vec<u64>) -> RankReport {
    let mut report = undecided();
    let mut echelon: Vec<EchelonRow> = Vec::new();
    let mut values = values.into_iter();
    for (position, row) in rows.iter().enumerate() {
        let mut entries: Vec<u64> = values.by_ref().take(row.len()).collect();
        let mut combination = vec![0; rows.len()];
        combination[position] = 1;
        for known in &echelon {
            let factor = entries[known.pivot];
            subtract(field, &mut entries, factor, &known.entries);
            subtract(field, &mut combination, factor, &known.combination);
        }
        let pivot = entries.iter().position(|entry| *entry != 0);
        match pivot.and_then(|pivot| Some((pivot, field.inv(entries[pivot])?))) {
            Some((pivot, inverse)) => {
                scale(field, &mut entries, inverse);
                scale(field, &mut combination, inverse);
                echelon.push(EchelonRow {
                    pivot,
                    entries,
                    combination,
                });
                report.independent_rows.push(position);
                report.pivot_columns.push(pivot);
            }
            None => {
                let earlier = (0..position).filter(|row| combination[*row] != 0).collect();
                report.dependencies.push((position, earlier));
            }
        }
    }
    report.rank = report.independent_rows.len();
    report
}

fn subtract(field: Modulus, row: &mut [u64], factor: u64, other: &[u64]) {
    if factor != 0 {
        for (entry, other) in row.iter_mut().zip(other) {
            *entry = field.sub(*entry, field.mul(factor, *other));
        }
    }
}

fn scale(field: Modulus, row: &mut [u64], factor: u64) {
    row.iter_mut()
        .for_each(|entry| *entry = field.mul(*entry, factor));
}

/// The number of pivots that are clearly not 0, by elimination with complete pivoting; 0 if an entry is not finite.
fn real_rank(rows: &[Vec<ExprId>], values: Vec<f64>) -> usize {
    if values.iter().any(|value| !value.is_finite()) {
        return 0;
    }
    let mut values = values.into_iter();
    let mut matrix: Vec<Vec<f64>> = rows
        .iter()
        .map(|row| values.by_ref().take(row.len()).collect())
        .collect();
    let mut largest = 0.0;
    for rank in 0..rows.len() {
        let Some((row, column)) = largest_entry(&matrix) else {
            return rank;
        };
        let pivot_row = matrix.swap_remove(row);
        let pivot = pivot_row[column];
        largest = f64::max(largest, pivot.abs());
        if pivot.abs() <= CLEAR * largest {
            return rank;
        }
        for other in &mut matrix {
            let factor = other[column] / pivot;
            other
                .iter_mut()
                .zip(&pivot_row)
                .for_each(|(entry, p)| *entry -= factor * p);
        }
    }
    rows.len()
}

/// Position of the entry of largest size; `None` if all are 0.
fn largest_entry(matrix: &[Vec<f64>]) -> Option<(usize, usize)> {
    let mut best = (0.0, None);
    for (i, row) in matrix.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            if entry.abs() > best.0 {
                best = (entry.abs(), Some((i, j)));
            }
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;

    fn rank<const N: usize>(rows: &[[&str; N]]) -> RankReport {
        let mut fixture = Fixture::new();
        let rows: Vec<Vec<ExprId>> = rows
            .iter()
            .map(|row| fixture.read_all(*row).to_vec())
            .collect();
        fixture.pool.rank(&rows)
    }

    #[test]
    fn a_dependent_row_names_the_rows_it_depends_on() {
        let report = rank(&[
            ["sin(x)", "-cos(x)", "0"],
            ["0", "0", "1"],
            ["sin(x)*y", "-cos(x)*y", "0"],
            ["cos(x)", "sin(x)", "z"],
            ["1", "0", "0"],
            ["0", "0", "0"],
        ]);
        assert_eq!(report.rank, 3);
        assert_eq!(report.independent_rows, [0, 1, 3]);
        assert_eq!(report.pivot_columns, [0, 2, 1]);
        assert_eq!(
            report.dependencies,
            [(2, vec![0]), (4, vec![0, 1, 3]), (5, vec![])]
        );
        assert!(report.decided);
    }

    #[test]
    fn rank_is_generic() {
        assert_eq!(rank(&[["x", "y"], ["x^2", "x*y"]]).rank, 1);
        assert_eq!(rank(&[["x", "y"], ["y", "x"]]).rank, 2);
        assert_eq!(rank(&[["cos(x)^2", "1 - sin(x)^2", "y"]]).rank, 1);
        assert_eq!(rank::<1>(&[]).rank, 0);
    }

    #[test]
    fn rank_with_hidden_relations_is_confirmed_by_real_values_or_undecided() {
        let sure = rank(&[["ln(m)", "1"], ["1", "ln(l)"]]);
        assert_eq!((sure.rank, sure.decided), (2, true));
        let hidden = rank(&[["ln(m) + ln(l)", "1"], ["ln(m*l)", "1"]]);
        assert_eq!((hidden.rank, hidden.decided), (2, false));
        let undefined = rank(&[["1/(x - x)"]]);
        assert_eq!((undefined.rank, undefined.decided), (0, false));
    }
}
