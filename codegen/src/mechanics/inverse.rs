//! Inverses and determinants of small matrices as explicit expressions. They are computed from minors, in which
//! products of sums are multiplied out.

use dalembert_expr::{ExprId, Pool, Verdict};

use super::common_factor::factored;

/// Rows of expressions.
pub(crate) type Matrix = Vec<Vec<ExprId>>;

/// Largest size of a block that is inverted by minors.
const LARGEST_BLOCK: usize = 4;

/// An expression multiplied out and simplified. It has the same value at almost all states.
pub(crate) fn tidy(pool: &mut Pool, expression: ExprId) -> ExprId {
    /// Rounds of simplification, each of which may let powers merge.
    const ROUNDS: usize = 3;
    let flat = pool.multiply_out(expression);
    let mut tidy = pool.generic(flat);
    for _ in 0..ROUNDS {
        let simple = pool.simplify(tidy);
        let next = pool.generic(simple);
        if next == tidy {
            break;
        }
        tidy = next;
    }
    tidy
}

/// `a.b`, tidied. Products with 0 are left out, whatever the other factor is.
pub(crate) fn dot(pool: &mut Pool, a: &[ExprId], b: &[ExprId]) -> ExprId {
    let mut products = Vec::new();
    for (a, b) in a.iter().zip(b) {
        if ![a, b].iter().any(|factor| pool.is_syntactic_zero(**factor)) {
            products.push(pool.mul(*a, *b));
        }
    }
    let sum = pool.sum(&products);
    tidy(pool, sum)
}

/// The inverse of a matrix, block by block; `None` if a block is too large.
pub(crate) fn inverse(pool: &mut Pool, matrix: &[Vec<ExprId>]) -> Option<Matrix> {
    inverse_by(pool, matrix, |_, determinant| determinant)
}

/// The inverse with determinants that have the common factors of their terms taken out. Factors that are never zero
/// cancel.
pub(crate) fn inverse_in_factors(pool: &mut Pool, matrix: &[Vec<ExprId>]) -> Option<Matrix> {
    inverse_by(pool, matrix, factored)
}

fn inverse_by(
    pool: &mut Pool,
    matrix: &[Vec<ExprId>],
    arranged: fn(&mut Pool, ExprId) -> ExprId,
) -> Option<Matrix> {
    let zero = pool.zero();
    let mut inverse = vec![vec![zero; matrix.len()]; matrix.len()];
    for block in blocks(pool, matrix) {
        if block.len() > LARGEST_BLOCK {
            return None;
        }
        let determinant = minor(pool, matrix, &block, &block);
        let determinant = arranged(pool, determinant);
        for (i, row) in block.iter().enumerate() {
            for (j, column) in block.iter().enumerate() {
                let without = |omitted: usize| -> Vec<usize> {
                    block
                        .iter()
                        .copied()
                        .filter(|index| *index != omitted)
                        .collect()
                };
                let cofactor = minor(pool, matrix, &without(*column), &without(*row));
                let signed = match (i + j) % 2 {
                    0 => cofactor,
                    _ => pool.neg(cofactor),
                };
                if !pool.is_syntactic_zero(signed) {
                    inverse[*row][*column] = pool.div(signed, determinant);
                }
            }
        }
    }
    Some(inverse)
}

/// Sets of indices that are connected by nonzero entries.
fn blocks(pool: &Pool, matrix: &[Vec<ExprId>]) -> Vec<Vec<usize>> {
    let mut left: Vec<usize> = (0..matrix.len()).collect();
    let mut blocks = Vec::new();
    while let Some(first) = left.first().copied() {
        let mut block = vec![first];
        let mut visited = 0;
        left.retain(|index| *index != first);
        while let Some(row) = block.get(visited).copied() {
            visited += 1;
            let (connected, rest): (Vec<usize>, Vec<usize>) =
                left.iter().copied().partition(|&j| {
                    [matrix[row][j], matrix[j][row]]
                        .iter()
                        .any(|entry| !pool.is_syntactic_zero(*entry))
                });
            block.extend(connected);
            left = rest;
        }
        block.sort_unstable();
        blocks.push(block);
    }
    blocks
}

/// The determinant of some rows and columns, every step of it tidied.
pub(crate) fn minor(
    pool: &mut Pool,
    matrix: &[Vec<ExprId>],
    rows: &[usize],
    columns: &[usize],
) -> ExprId {
    by_first_row(pool, matrix, rows, columns, tidy)
}

/// The determinant of the first rows and these columns, not simplified. Without columns it is 1.
pub(crate) fn determinant(pool: &mut Pool, matrix: &[Vec<ExprId>], columns: &[usize]) -> ExprId {
    let rows: Vec<usize> = (0..columns.len()).collect();
    by_first_row(pool, matrix, &rows, columns, |_, sum| sum)
}

/// The determinant of some rows and columns, expanded by the first row; `finish` is applied to every sum.
fn by_first_row(
    pool: &mut Pool,
    matrix: &[Vec<ExprId>],
    rows: &[usize],
    columns: &[usize],
    finish: fn(&mut Pool, ExprId) -> ExprId,
) -> ExprId {
    let Some((row, rest)) = rows.split_first() else {
        return pool.one();
    };
    let mut terms = Vec::new();
    for (place, &column) in columns.iter().enumerate() {
        let entry = matrix[*row][column];
        if pool.is_syntactic_zero(entry) {
            continue;
        }
        let others: Vec<usize> = columns.iter().copied().filter(|j| *j != column).collect();
        let below = by_first_row(pool, matrix, rest, &others, finish);
        let product = pool.mul(entry, below);
        terms.push(match place % 2 {
            0 => product,
            _ => pool.neg(product),
        });
    }
    let sum = pool.sum(&terms);
    finish(pool, sum)
}

/// Reason for which no minor of independent rows is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NoMinor {
    /// Determinants that are too large to be written out.
    TooLarge,
    /// A determinant that is neither proved to be 0 nor proved to be nonzero.
    Undecided,
}

/// A largest set of independent rows, and columns in which their determinant is not identically 0. Columns with a
/// determinant that is 0 nowhere are preferred.
///
/// # Errors
/// [`NoMinor`].
pub(crate) fn independent_minor(
    pool: &mut Pool,
    rows: &[Vec<ExprId>],
) -> Result<(Vec<usize>, Vec<usize>), NoMinor> {
    /// Largest number of independent rows.
    const LARGEST: usize = 6;
    let (mut chosen, mut columns) = (Vec::new(), Vec::new());
    let width = rows.first().map_or(0, Vec::len);
    for row in 0..rows.len() {
        let above = [&*chosen, &[row]].concat();
        let (mut found, mut is_decided) = (None, true);
        for column in (0..width).rev().filter(|j| !columns.contains(j)) {
            let together = [&*columns, &[column]].concat();
            let determinant = minor(pool, rows, &above, &together);
            if pool.sign(determinant).is_nonzero() {
                found = Some(column);
                break;
            }
            match pool.zero_test(determinant) {
                Verdict::Proved => {}
                Verdict::Refuted => found = found.or(Some(column)),
                Verdict::Undecided => is_decided = false,
            }
        }
        if found.is_none() && !is_decided {
            return Err(NoMinor::Undecided);
        }
        if let Some(column) = found {
            (chosen, columns) = (above, [&*columns, &[column]].concat());
        }
        if chosen.len() > LARGEST {
            return Err(NoMinor::TooLarge);
        }
    }
    Ok((chosen, columns))
}
