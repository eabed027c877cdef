//! Structure constants of a group of fields.

use dalembert_expr::{ExprId, Pool, SymbolId, Verdict};

use super::NoReduction;
use crate::mechanics::bracket::{commutator, settled};
use crate::mechanics::inverse::{Matrix, dot, independent_minor, inverse};

/// `C_ab^c` of fields that are independent and closed under brackets. They are constant in `q` and in the time `t`.
pub(super) fn structure(
    pool: &mut Pool,
    (q, t): (&[SymbolId], SymbolId),
    fields: &[Vec<ExprId>],
) -> Result<Vec<Matrix>, NoReduction> {
    let (rows, columns) = independent_minor(pool, fields)?;
    if rows.len() < fields.len() {
        return Err(NoReduction::Dependent);
    }
    let chosen = |field: &Vec<ExprId>| columns.iter().map(|j| field[*j]).collect();
    let minor: Matrix = fields.iter().map(chosen).collect();
    let inverse = inverse(pool, &minor).ok_or(NoReduction::TooLarge)?;
    let size = fields.len();
    let arguments = [q, &[t]].concat();
    let mut constants = vec![vec![vec![pool.zero(); size]; size]; size];
    for a in 0..size {
        for b in 0..a {
            let bracket = commutator(pool, q, [&fields[a], &fields[b]]);
            let known: Vec<ExprId> = columns.iter().map(|j| bracket[*j]).collect();
            let factors = (0..size).map(|c| {
                let column: Vec<ExprId> = inverse.iter().map(|row| row[c]).collect();
                let factor = dot(pool, &known, &column);
                settled(pool, factor)
            });
            let factors: Vec<ExprId> = factors.collect();
            match combination(pool, &arguments, &bracket, (&factors, fields)) {
                Verdict::Proved => {}
                Verdict::Refuted => return Err(NoReduction::NotClosed(b, a)),
                Verdict::Undecided => return Err(NoReduction::Undecided(b, a)),
            }
            constants[b][a] = factors.iter().map(|factor| pool.neg(*factor)).collect();
            constants[a][b] = factors;
        }
    }
    Ok(constants)
}

/// The verdict on a field being the combination of others with these factors, and on the factors being constant.
fn combination(
    pool: &mut Pool,
    arguments: &[SymbolId],
    field: &[ExprId],
    (factors, fields): (&[ExprId], &[Vec<ExprId>]),
) -> Verdict {
    let mut rests = Vec::new();
    for factor in factors {
        rests.extend(arguments.iter().map(|symbol| pool.diff(*factor, *symbol)));
    }
    for (k, entry) in field.iter().enumerate() {
        let column: Vec<ExprId> = fields.iter().map(|field| field[k]).collect();
        let sum = dot(pool, factors, &column);
        rests.push(pool.sub(*entry, sum));
    }
    let verdicts: Vec<Verdict> = rests.into_iter().map(|rest| pool.zero_test(rest)).collect();
    let any = |verdict| verdicts.contains(&verdict);
    match (any(Verdict::Refuted), any(Verdict::Undecided)) {
        (true, _) => Verdict::Refuted,
        (false, true) => Verdict::Undecided,
        (false, false) => Verdict::Proved,
    }
}
