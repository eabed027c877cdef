//! The density form as explicit expressions, for small models: inverses by minors, products of sums multiplied out.

use dalembert_expr::{ExprId, Pool, Verdict};

use crate::mechanics::{Derivation, Entry};
use crate::model::Model;

type Matrix = Vec<Vec<ExprId>>;

/// Larger blocks of a matrix are not inverted by minors.
const LARGEST_BLOCK: usize = 4;

/// `theta_k = m_ab [ W^{a,j} d_j eta^b_k + W^{b,j} d_k eta^a_j - W^b.(d_k g) W^a ]`, N components; `None` for a model
/// that is too large to be written out, and for constraints that are not linear in the velocities, which have none.
pub fn density_form(model: &mut Model, derivation: &Derivation) -> Option<Vec<ExprId>> {
    if model.is_nonlinear() {
        return None;
    }
    let metric = model.lagrangian.metric.clone();
    let pool = &mut model.pool;
    let cometric = inverse(pool, &metric)?;
    let forms: Matrix = derivation
        .constraints
        .iter()
        .map(|constraint| constraint.form.clone())
        .collect();
    let duals: Matrix = forms
        .iter()
        .map(|form| cometric.iter().map(|row| dot(pool, row, form)).collect())
        .collect();
    let mass: Matrix = forms
        .iter()
        .map(|form| duals.iter().map(|dual| dot(pool, form, dual)).collect())
        .collect();
    let inverse_mass = inverse(pool, &mass)?;
    let columns: Matrix = (0..metric.len())
        .map(|j| duals.iter().map(|dual| dual[j]).collect())
        .collect();
    // m_ab W^b
    let inverse_duals: Matrix = inverse_mass
        .iter()
        .map(|row| {
            columns
                .iter()
                .map(|column| dot(pool, row, column))
                .collect()
        })
        .collect();
    let mut terms = vec![Vec::new(); metric.len()];
    for (a, field) in inverse_duals.iter().enumerate() {
        for &Entry {
            index: [j, k],
            value,
        } in &derivation.constraints[a].form_gradient
        {
            terms[j].push(pool.mul(field[k], value));
            terms[k].push(pool.mul(field[j], value));
        }
        for &Entry {
            index: [i, j, k],
            value,
        } in &derivation.density.metric.by_coordinate
        {
            let first = pool.product(&[duals[a][i], field[j], value]);
            let second = pool.product(&[duals[a][j], field[i], value]);
            terms[k].push(pool.neg(first));
            if i != j {
                terms[k].push(pool.neg(second));
            }
        }
    }
    let sums: Vec<_> = terms.iter().map(|term| pool.sum(term)).collect();
    let written = |expr: ExprId| match pool.zero_test(expr) {
        Verdict::Proved => pool.zero(),
        Verdict::Refuted | Verdict::Undecided => tidy(pool, expr),
    };
    Some(sums.into_iter().map(written).collect())
}

fn tidy(pool: &mut Pool, expression: ExprId) -> ExprId {
    let flat = pool.multiply_out(expression);
    pool.simplify(flat)
}

fn dot(pool: &mut Pool, a: &[ExprId], b: &[ExprId]) -> ExprId {
    let products: Vec<_> = a.iter().zip(b).map(|(a, b)| pool.mul(*a, *b)).collect();
    let sum = pool.sum(&products);
    tidy(pool, sum)
}

/// The inverse of a symmetric matrix, block by block; `None` if a block is too large.
fn inverse(pool: &mut Pool, matrix: &Matrix) -> Option<Matrix> {
    let zero = pool.zero();
    let mut inverse = vec![vec![zero; matrix.len()]; matrix.len()];
    for block in blocks(pool, matrix) {
        if block.len() > LARGEST_BLOCK {
            return None;
        }
        let determinant = minor(pool, matrix, &block, &block);
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
                inverse[*row][*column] = pool.div(signed, determinant);
            }
        }
    }
    Some(inverse)
}

/// The indices that are connected by entries that are not 0.
fn blocks(pool: &Pool, matrix: &Matrix) -> Vec<Vec<usize>> {
    let mut left: Vec<usize> = (0..matrix.len()).collect();
    let mut blocks = Vec::new();
    while let Some(first) = left.first().copied() {
        let mut block = vec![first];
        let mut visited = 0;
        left.retain(|index| *index != first);
        while let Some(row) = block.get(visited).copied() {
            visited += 1;
            let (connected, rest): (Vec<usize>, Vec<usize>) = left
                .iter()
                .copied()
                .partition(|j| !pool.is_syntactic_zero(matrix[row][*j]));
            block.extend(connected);
            left = rest;
        }
        block.sort_unstable();
        blocks.push(block);
    }
    blocks
}

/// The determinant of some rows and columns, by the first row.
fn minor(pool: &mut Pool, matrix: &Matrix, rows: &[usize], columns: &[usize]) -> ExprId {
    let Some((row, rest)) = rows.split_first() else {
        return pool.one();
    };
    let mut terms = Vec::new();
    for (position, column) in columns.iter().enumerate() {
        if pool.is_syntactic_zero(matrix[*row][*column]) {
            continue;
        }
        let others: Vec<usize> = columns
            .iter()
            .copied()
            .filter(|other| other != column)
            .collect();
        let below = minor(pool, matrix, rest, &others);
        let product = pool.mul(matrix[*row][*column], below);
        terms.push(match position % 2 {
            0 => product,
            _ => pool.neg(product),
        });
    }
    let sum = pool.sum(&terms);
    tidy(pool, sum)
}
