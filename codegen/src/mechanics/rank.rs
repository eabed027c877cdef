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

#[cfg(test)]
mod tests {
    use crate::compile;

    /// True if the rank of these constraints is proved to be constant.
    fn is_constant(constraints: &str) -> bool {
        let source = format!(
            "pub Model {{
                coordinates {{ x; y; z; w; theta: angle; }}
                parameters {{ a > 0 = 1; b = 1; c != 0 = 1; }}
                lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2 + dot(w)^2 + dot(theta)^2)/2;
                constraints {{ {constraints} }}
            }}"
        );
        let compiled = compile(source.parse().expect("tokens")).expect("a model");
        !compiled.derivation.can_lose_rank
    }

    #[test]
    fn constant_ranks_are_proved() {
        for constraints in [
            "k: d(x) - y*d(z) = 0;",
            "k: sin(theta)*d(x) - cos(theta)*d(y) = 0;",
            "k: (1 + x^2)*d(x) + y*d(z) = 0;",
            "k: x*d(y) + y*d(z) + a*d(w) = 0;",
            "k: d(z) - y*d(x) = 0; l: d(z) - y*d(x) + c*(d(w) - x*d(y)) = 0;",
            "k: a*sin(theta)*d(x) - a*cos(theta)*d(y) = 0; l: cos(theta)*d(x) + sin(theta)*d(y) - b*d(z) = 0;",
            "k: d(x^2/a + y^2 - 1) = 0;",
            "k: d(x^2 + y^2) = 0; l: d(z) - w*d(w) - x*d(theta) = 0;",
            "k: d(x^2 + y^2) = 0; l: d((x - z)^2 + w^2) = 0;",
            "k: x*d(x) + y*d(y) = 0; l: (z - x)*(d(z) - d(x)) + (w - y)*(d(w) - d(y)) = 0;",
            "k: (a + exp(t))*(sin(theta)*d(x) - cos(theta)*d(y)) = 0;",
        ] {
            assert!(is_constant(constraints), "{constraints}");
        }
    }

    #[test]
    fn ranks_that_can_drop_are_not_proved_constant() {
        for constraints in [
            "k: d(x) = 0; l: d(x) + y*d(z) = 0;",
            "k: d(x) = 0; l: d(x) + y^2*d(z) = 0;",
            "k: d(x) = 0; l: d(x) + cos(theta)*d(z) = 0;",
            "k: y*d(x) = 0;",
            "k: x*d(y) + y*d(x) = 0;",
            "k: d(x^2 + y^4) = 0;",
            "k: d(x^2 - y^2) = 0;",
            "k: d((x - y)^2 + (x + y)^3) = 0;",
            "k: x*d(z) + y*d(w) = 0;",
            "k: d(x) - t*d(y) = 0; l: d(x) - d(y) = 0;",
            "k: d(x) + y*d(z) = 0; l: y*d(x) + d(z) = 0;",
            "k: x*d(x) + y*d(y) + z*d(t) = 0;",
            "k: b*d(x) + y*d(z) = 0;",
        ] {
            assert!(!is_constant(constraints), "{constraints}");
        }
    }
}
