//! Proofs that the constraint forms are linearly independent at every state.
//!
//! Each step of the proof leaves fewer forms. They are independent at every state iff the forms before the step are. A
//! form is removed if, in the columns in which all other forms are 0, its entries never vanish together. A form with an
//! entry that is never zero is eliminated from the others. For the remaining forms the squares of all minors are added:
//! the forms are independent where the sum is positive (Cauchy and Binet).
//!
//! A form that is the differential of a function may vanish at states that no motion reaches; see [`keeps_off`].

use dalembert_expr::{ExprId, Pool, Rational, SymbolId};

use super::ConstraintForm;
use super::constraint::{never_zero, regular_minor};
use super::inverse::{Matrix, determinant};

/// Largest number of forms for which all minors are tested.
const MINORS: usize = 3;

/// Largest number of entries for which forms are eliminated and minors are formed.
const ENTRIES: usize = 256;

/// A remaining form.
struct Row {
    entries: Vec<ExprId>,
    /// The function whose differential the form is. Known only for forms that were not changed by elimination.
    level: Option<ExprId>,
}

/// True if it is proved that no motion leads from a state with independent forms to one with dependent forms. The pool
/// is left unchanged.
pub(super) fn is_constant(pool: &Pool, q: &[SymbolId], constraints: &[ConstraintForm]) -> bool {
    if regular_minor(pool, constraints).is_some() {
        return true;
    }
    let mut pool = pool.clone();
    let rows = constraints.iter().map(|constraint| Row {
        entries: constraint.form.clone(),
        level: constraint
            .level
            .or_else(|| quadratic_level(&mut pool, q, constraint)),
    });
    let mut rows: Vec<Row> = rows.collect();
    while !rows.is_empty() {
        let is_small = rows.iter().map(|row| row.entries.len()).sum::<usize>() <= ENTRIES;
        if let Some(alone) = (0..rows.len()).find(|&a| stands_alone(&mut pool, q, &rows, a)) {
            rows.remove(alone);
        } else if let Some(pivot) = pivot(&pool, &rows).filter(|_| is_small) {
            eliminate(&mut pool, &mut rows, pivot);
        } else {
            return rows.len() <= MINORS && is_small && has_a_minor(&mut pool, &rows);
        }
    }
    true
}

/// True if the entries of form `a` in columns where all other forms are 0 never vanish together, at least along a
/// motion.
fn stands_alone(pool: &mut Pool, q: &[SymbolId], rows: &[Row], a: usize) -> bool {
    let is_alone = |j: &usize| {
        let mut rows = rows.iter().enumerate();
        rows.all(|(b, row)| (b == a) != pool.is_syntactic_zero(row.entries[*j]))
    };
    let columns = (0..rows[a].entries.len()).filter(is_alone);
    let columns: Vec<usize> = columns.collect();
    let entries: Vec<ExprId> = columns.iter().map(|&j| rows[a].entries[j]).collect();
    if never_vanish_together(pool, &entries) {
        return true;
    }
    // The columns are the coordinates, because a form with a level has seen no elimination.
    rows[a].level.is_some_and(|level| {
        let along: Vec<SymbolId> = columns.iter().map(|&j| q[j]).collect();
        keeps_off(pool, &along, level)
    })
}

/// The function `sum_j q^j eta_j / 2`, if the form is its differential.
fn quadratic_level(pool: &mut Pool, q: &[SymbolId], constraint: &ConstraintForm) -> Option<ExprId> {
    if !pool.is_syntactic_zero(constraint.affine) {
        return None;
    }
    let mut terms = Vec::new();
    for (&symbol, &entry) in q.iter().zip(&constraint.form) {
        let place = pool.variable(symbol);
        let term = pool.mul(place, entry);
        terms.push(pool.scale(&Rational::HALF, term));
    }
    let sum = pool.sum(&terms);
    let level = pool.multiply_out(sum);
    let is_level = q.iter().zip(&constraint.form).all(|(&symbol, &entry)| {
        let slope = pool.diff(level, symbol);
        let difference = pool.sub(slope, entry);
        let difference = pool.multiply_out(difference);
        pool.is_syntactic_zero(difference)
    });
    is_level.then_some(level)
}

/// True if the derivatives of a function with respect to the coordinates `along` cannot begin to vanish together along
/// a motion that conserves the function. This holds for `c + sum_j c_j l_j^2` with all `c_j` of one sign, and with
/// derivatives proportional to the `l_j`: the derivatives vanish together exactly where the function equals `c`.
fn keeps_off(pool: &mut Pool, along: &[SymbolId], level: ExprId) -> bool {
    let (_, terms) = pool.linear_form(level);
    let varying = pool.combine(&terms);
    let mut rest = vec![varying];
    let mut signs = Vec::new();
    for &q in along {
        let slope = pool.diff(varying, q);
        let second = pool.diff(slope, q);
        let is_constant = along.iter().all(|&q| !pool.depends_on(second, q));
        if !is_constant || !never_zero(pool, second) {
            return false;
        }
        signs.push(pool.sign(second).is_nonnegative());
        let square = pool.mul(slope, slope);
        let part = pool.div(square, second);
        rest.push(pool.scale(&-&Rational::HALF, part));
    }
    let rest = pool.sum(&rest);
    let rest = pool.multiply_out(rest);
    let is_definite = signs.windows(2).all(|pair| pair[0] == pair[1]);
    is_definite && !signs.is_empty() && pool.is_syntactic_zero(rest)
}

/// True if the sum of the squares of the entries is proved to be positive.
fn never_vanish_together(pool: &mut Pool, entries: &[ExprId]) -> bool {
    let squares: Vec<ExprId> = entries
        .iter()
        .map(|&entry| pool.mul(entry, entry))
        .collect();
    let sum = pool.sum(&squares);
    let simple = pool.simplify(sum);
    never_zero(pool, sum) || never_zero(pool, simple)
}

/// A form and a column whose entry is never zero.
fn pivot(pool: &Pool, rows: &[Row]) -> Option<(usize, usize)> {
    let entries = |a: usize| (0..rows[a].entries.len()).map(move |j| (a, j));
    let mut places = (0..rows.len()).flat_map(entries);
    places.find(|&(a, j)| never_zero(pool, rows[a].entries[j]))
}

/// Eliminates form `a` from the others, then removes it and the column of its pivot.
fn eliminate(pool: &mut Pool, rows: &mut Vec<Row>, (a, column): (usize, usize)) {
    let pivot_row = rows.remove(a).entries;
    for Row {
        entries: row,
        level,
    } in rows.iter_mut()
    {
        *level = None;
        let factor = pool.div(row[column], pivot_row[column]);
        for (entry, &taken) in row.iter_mut().zip(&pivot_row) {
            let product = pool.mul(factor, taken);
            let rest = pool.sub(*entry, product);
            *entry = pool.simplify(rest);
        }
        row.remove(column);
    }
}

/// True if the minors of the forms never vanish together.
fn has_a_minor(pool: &mut Pool, rows: &[Row]) -> bool {
    let rows: Matrix = rows.iter().map(|row| row.entries.clone()).collect();
    let columns = rows.first().map_or(0, Vec::len);
    let mut minors = Vec::new();
    let mut chosen = Vec::new();
    collect_minors(pool, &rows, columns, &mut chosen, &mut minors);
    never_vanish_together(pool, &minors)
}

fn collect_minors(
    pool: &mut Pool,
    rows: &[Vec<ExprId>],
    columns: usize,
    chosen: &mut Vec<usize>,
    minors: &mut Vec<ExprId>,
) {
    if chosen.len() == rows.len() {
        let minor = determinant(pool, rows, chosen);
        minors.push(pool.simplify(minor));
        return;
    }
    for column in chosen.last().map_or(0, |last| last + 1)..columns {
        chosen.push(column);
        collect_minors(pool, rows, columns, chosen, minors);
        chosen.pop();
    }
}
