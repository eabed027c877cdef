//! A frame that is regular at every configuration, found from the coefficients of the constraint forms.
//!
//! A velocity can be made dependent if it occurs in only one of the constraints still to be solved, with a coefficient
//! that is never zero. Otherwise a pair of velocities that occur in only one constraint is used, if the sum of the
//! squares of their coefficients is never zero: a knife edge `-sin(theta) dx + cos(theta) dy` leaves the velocity along
//! it, `cos(theta) dx + sin(theta) dy`.

use dalembert_expr::{ExprId, Pool};

use super::{Chosen, Unreduced};
use crate::mechanics::ConstraintForm;
use crate::model::Model;

/// Velocities that a constraint makes dependent.
enum Dependent {
    /// One velocity follows from the others.
    One(usize),
    /// One combination of these two velocities stays independent: the velocity along the constraint.
    Pair(usize, usize),
}

/// Quasi-velocities: the velocities of coordinates that stay independent, and for each pair the velocity along its
/// constraint.
pub(super) fn choose(
    model: &mut Model,
    constraints: &[ConstraintForm],
) -> Result<Vec<Chosen>, Unreduced> {
    let mut rows: Vec<usize> = (0..constraints.len()).collect();
    let mut taken: Vec<(usize, Dependent)> = Vec::with_capacity(rows.len());
    while !rows.is_empty() {
        let Some((a, dependent)) = removable(&mut model.pool, constraints, &rows) else {
            return Err(Unreduced::NoRegularFrame(rows));
        };
        rows.retain(|&row| row != a);
        taken.push((a, dependent));
    }
    Ok(quasi_velocities(model, constraints, &taken))
}

/// A constraint that can be solved for velocities that no other constraint of `rows` contains.
fn removable(
    pool: &mut Pool,
    constraints: &[ConstraintForm],
    rows: &[usize],
) -> Option<(usize, Dependent)> {
    let alone = |pool: &Pool, a: usize| -> Vec<usize> {
        let holds = |b: usize, j: usize| !pool.is_syntactic_zero(constraints[b].form[j]);
        let columns = 0..constraints[a].form.len();
        let lone = columns.filter(|&j| holds(a, j) && rows.iter().all(|&b| b == a || !holds(b, j)));
        lone.collect()
    };
    for &a in rows {
        let columns = alone(pool, a);
        let is_regular = |&&j: &&usize| pool.sign(constraints[a].form[j]).is_nonzero();
        // The simplest divisor is the best: a number before a parameter, and a parameter before a function.
        let regular = columns.iter().filter(is_regular);
        if let Some(&j) = regular.min_by_key(|&&j| complexity(pool, constraints[a].form[j])) {
            return Some((a, Dependent::One(j)));
        }
    }
    for &a in rows {
        let columns = alone(pool, a);
        for (index, &i) in columns.iter().enumerate() {
            for &j in &columns[index + 1..] {
                let form = &constraints[a].form;
                let squared = squared_norm(pool, &[form[i], form[j]]);
                if pool.sign(squared).is_nonzero() {
                    return Some((a, Dependent::Pair(i, j)));
                }
            }
        }
    }
    None
}

fn complexity(pool: &Pool, entry: ExprId) -> usize {
    match pool.as_number(entry) {
        Some(number) if number.abs().is_one() => 0,
        Some(_) => 1,
        None => 1 + pool.reachable(&[entry]).len(),
    }
}

/// The sum of squares, simplified.
pub(super) fn squared_norm(pool: &mut Pool, entries: &[ExprId]) -> ExprId {
    let squares: Vec<ExprId> = entries
        .iter()
        .map(|&entry| pool.mul(entry, entry))
        .collect();
    let sum = pool.sum(&squares);
    pool.simplify(sum)
}

fn quasi_velocities(
    model: &mut Model,
    constraints: &[ConstraintForm],
    taken: &[(usize, Dependent)],
) -> Vec<Chosen> {
    let n = model.coordinates.len();
    let zero = model.pool.zero();
    let mut chosen = Vec::with_capacity(n - taken.len());
    for i in 0..n {
        let along = taken.iter().find_map(|(a, dependent)| match dependent {
            Dependent::One(j) => (*j == i).then_some(None),
            Dependent::Pair(first, second) if *first == i => Some(Some((*a, *first, *second))),
            Dependent::Pair(_, second) => (*second == i).then_some(None),
        });
        let mut form = vec![zero; n];
        match along {
            Some(None) => continue,
            Some(Some((a, first, second))) => {
                form[first] = constraints[a].form[second];
                form[second] = model.pool.neg(constraints[a].form[first]);
                chosen.push(Chosen {
                    name: format!("along_{}", model.constraints[a].name.display),
                    coordinate: None,
                    form,
                });
            }
            None => {
                form[i] = model.pool.one();
                chosen.push(Chosen {
                    name: model.coordinates[i].name.velocity(),
                    coordinate: Some(i),
                    form,
                });
            }
        }
    }
    chosen
}
