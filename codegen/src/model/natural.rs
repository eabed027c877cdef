//! Splits the Lagrangian `L = 1/2 qdot^T g qdot + A.qdot - V`: `g = d^2L/dqdot^2`, `A = dL/dqdot` and `V = -L` at
//! `qdot = 0`. Any other Lagrangian is refused, with the term at fault.

use dalembert_expr::{ExprId, Pool, Sign, SymbolId};

use super::Lagrangian;
use super::degree::{at_zero, degree_bound, has_degree, is_zero, without_hidden_zero};
use super::resolve::{Resolver, Scope};
use crate::spec::{ItemId, Scalar, ScalarKind};

/// The parts of a resolved Lagrangian; `None` if it is not natural.
pub(super) fn split(
    resolver: &mut Resolver<'_>,
    written: &Scalar,
    whole: ExprId,
    item: ItemId,
) -> Option<Lagrangian> {
    let velocities = resolver.symbols.velocities();
    if !resolver.pool.depends_on_any(whole, &velocities) {
        let help = "a particle has `m/2*dot(x)^2`";
        return resolver.refuse(written.at, "no kinetic term: the metric is zero", help);
    }
    if !has_degree(&mut resolver.pool, whole, &velocities, 2) {
        return refuse_term(resolver, written, whole, &velocities);
    }
    let pool = &mut resolver.pool;
    let slopes: Vec<ExprId> = velocities
        .iter()
        .map(|velocity| pool.diff(whole, *velocity))
        .collect();
    let metric = metric(pool, &slopes, &velocities);
    let linear = slopes
        .iter()
        .map(|slope| {
            let entry = at_zero(pool, *slope, &velocities);
            without_hidden_zero(pool, entry)
        })
        .collect();
    let rest = at_zero(pool, whole, &velocities);
    let potential = pool.neg(rest);
    let potential = without_hidden_zero(pool, potential);
    Some(Lagrangian {
        whole,
        metric,
        linear,
        potential,
        item,
    })
}

fn metric(pool: &mut Pool, slopes: &[ExprId], velocities: &[SymbolId]) -> Vec<Vec<ExprId>> {
    let size = velocities.len();
    let mut metric = vec![vec![pool.zero(); size]; size];
    for i in 0..size {
        for j in i..size {
            let second = pool.diff(slopes[i], velocities[j]);
            let entry = at_zero(pool, second, velocities);
            // A diagonal entry is a sum of squares, in which `cos^2 + sin^2` is collected. Often a constant is left,
            // with a known sign and a pivot that needs no check.
            let entry = if i == j { pool.simplify(entry) } else { entry };
            let entry = without_hidden_zero(pool, entry);
            metric[i][j] = entry;
            metric[j][i] = entry;
        }
    }
    metric
}

fn refuse_term<T>(
    resolver: &mut Resolver<'_>,
    written: &Scalar,
    whole: ExprId,
    velocities: &[SymbolId],
) -> Option<T> {
    let is_polynomial = degree_bound(&resolver.pool, whole, velocities).is_some();
    let is_cause = |pool: &mut Pool, expr: ExprId| match degree_bound(pool, expr, velocities) {
        None => true,
        Some(degree) => is_polynomial && degree > 2,
    };
    let term = resolver.culprit(written, &Scope::default(), &is_cause);
    let text = if is_polynomial {
        format!("not natural: `{term}`")
    } else {
        format!("not natural: `{term}` is no polynomial in the velocities")
    };
    let help = "a Lagrangian is natural: terms quadratic, linear and constant in the velocities";
    resolver.refuse(term.at, text, help)
}

/// Refuses a metric that is singular, or not positive for any values of the parameters.
pub(super) fn check_metric(resolver: &mut Resolver<'_>, written: &Scalar, lagrangian: &Lagrangian) {
    let before = resolver.diagnostics.len();
    check_velocities(resolver, lagrangian);
    check_diagonal(resolver, written, lagrangian);
    if resolver.diagnostics.len() > before {
        return;
    }
    let report = resolver.pool.rank(&lagrangian.metric);
    let size = lagrangian.metric.len();
    let Some((row, _)) = report.dependencies.first() else {
        return;
    };
    let name = resolver.symbols.coordinates[*row].name.display.clone();
    let text = format!("the metric is singular: rank {} of {size}", report.rank);
    let help = format!("the motion of `{name}` is not determined; add its kinetic term");
    resolver.refuse::<()>(written.at, text, &help);
}

/// Refuses coordinates whose velocity does not appear; one error for each family.
fn check_velocities(resolver: &mut Resolver<'_>, lagrangian: &Lagrangian) {
    let mut refused: Vec<ItemId> = Vec::new();
    for (index, row) in lagrangian.metric.iter().enumerate() {
        let coordinate = &resolver.symbols.coordinates[index];
        let item = coordinate.item;
        let is_zero = |entry: &ExprId| resolver.pool.is_syntactic_zero(*entry);
        if !row.iter().all(is_zero) || refused.contains(&item) {
            continue;
        }
        refused.push(item);
        let name = &coordinate.name.display;
        let how = if !is_zero(&lagrangian.linear[index]) {
            "appears only linearly"
        } else if resolver.pool.depends_on(lagrangian.whole, coordinate.qdot) {
            "cancels"
        } else {
            "does not appear"
        };
        let text = format!("the metric is singular: `dot({name})` {how}");
        let help = format!("make `{name}` a parameter, or add its kinetic term");
        resolver.refuse::<()>(resolver.spec.location(item), text, &help);
    }
}

/// Refuses diagonal entries that are known not to be positive.
fn check_diagonal(resolver: &mut Resolver<'_>, written: &Scalar, lagrangian: &Lagrangian) {
    for (index, row) in lagrangian.metric.iter().enumerate() {
        let entry = row[index];
        let is_zero_row = row
            .iter()
            .all(|entry| resolver.pool.is_syntactic_zero(*entry));
        if is_zero_row || !resolver.pool.sign(entry).is_nonpositive() {
            continue;
        }
        let velocity = resolver.symbols.coordinates[index].qdot;
        let name = resolver.symbols.coordinates[index].name.display.clone();
        let value = resolver.pool.text(entry);
        let term = negative_term(resolver, written, velocity);
        let text = format!("the metric is not positive: entry ({name}, {name}) = {value}");
        resolver.refuse::<()>(term.at, text, "kinetic energy is positive");
    }
}

/// The term of the Lagrangian with a negative coefficient of the square of a velocity.
fn negative_term<'a>(
    resolver: &mut Resolver<'_>,
    written: &'a Scalar,
    velocity: SymbolId,
) -> &'a Scalar {
    let ScalarKind::Sum(terms) = &written.kind else {
        return written;
    };
    let cause = terms.iter().find(|(subtracted, term)| {
        let Some(expr) = resolver.expression(term, &mut Scope::default()) else {
            return false;
        };
        let slope = resolver.pool.diff(expr, velocity);
        let second = resolver.pool.diff(slope, velocity);
        let sign = resolver.pool.sign(second);
        if *subtracted {
            sign == Sign::Positive
        } else {
            sign == Sign::Negative
        }
    });
    cause.map_or(written, |(_, term)| term)
}

/// Remarks on the parts of a Lagrangian.
pub(super) fn notes(resolver: &Resolver<'_>, lagrangian: &Lagrangian) -> Vec<String> {
    let mut notes = Vec::new();
    let linear: Vec<&str> = lagrangian
        .linear
        .iter()
        .zip(&resolver.symbols.coordinates)
        .filter(|(entry, _)| !is_zero(&resolver.pool, **entry))
        .map(|(_, coordinate)| coordinate.name.display.as_str())
        .collect();
    if !linear.is_empty() {
        notes.push(format!(
            "the Lagrangian has terms linear in the velocities of {}",
            crate::diagnostics::listed(linear)
        ));
    }
    for (index, row) in lagrangian.metric.iter().enumerate() {
        if resolver.pool.sign(row[index]) == Sign::Positive {
            continue;
        }
        let name = &resolver.symbols.coordinates[index].name.display;
        let value = resolver.pool.text(row[index]);
        notes.push(format!("the metric is positive only where `{value} > 0` (entry ({name}, {name})); checked at run time"));
    }
    notes
}
