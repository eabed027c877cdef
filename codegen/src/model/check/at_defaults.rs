//! A metric and constraints that are regular for indeterminate parameters must be regular at the declared defaults,
//! too.

use dalembert_expr::{ExprId, Pool, SymbolId};

use super::super::resolve::Resolver;
use super::super::{Constraint, Lagrangian};

/// Position of a parameter, with its symbol and its default.
type Default = (usize, (SymbolId, ExprId));

/// Refuses defaults that make the metric singular or the constraints dependent, unless they are so for indeterminate
/// parameters, too.
pub(super) fn check(
    resolver: &mut Resolver<'_>,
    lagrangian: &Lagrangian,
    constraints: &[Constraint],
) {
    let forms: Vec<Vec<ExprId>> = constraints
        .iter()
        .map(|constraint| constraint.form.clone())
        .collect();
    refuse_singular(resolver, &lagrangian.metric, "the metric is singular");
    refuse_singular(resolver, &forms, "the constraints are dependent");
}

fn refuse_singular(resolver: &mut Resolver<'_>, rows: &[Vec<ExprId>], what: &str) {
    let defaults = defaults(resolver, rows);
    if defaults.is_empty() {
        return;
    }
    // The substitution works on a copy of the pool, so that the check adds nothing to the model.
    let mut pool = resolver.pool.clone();
    if pool.rank(rows).rank < rows.len() || !is_singular(&mut pool, rows, &defaults) {
        return;
    }
    // The message leaves out defaults without which the rows stay dependent.
    let mut guilty = defaults.clone();
    for default in &defaults {
        let others: Vec<Default> = guilty
            .iter()
            .filter(|other| *other != default)
            .copied()
            .collect();
        if is_singular(&mut pool, rows, &others) {
            guilty = others;
        }
    }
    let parameters = &resolver.symbols.parameters;
    let texts: Vec<String> = guilty
        .iter()
        .map(|(position, (_, value))| {
            let name = &parameters[*position].name.display;
            format!("`{name} = {}`", pool.text(*value))
        })
        .collect();
    let Some((last, _)) = guilty.last() else {
        return;
    };
    let at = resolver.spec.location(parameters[*last].item);
    let text = format!("with {} {what} everywhere", texts.join(" and "));
    let help = "change the default, or leave out the terms that have no effect then";
    resolver.refuse::<()>(at, text, help);
}

/// The defaults of the parameters in the rows.
fn defaults(resolver: &Resolver<'_>, rows: &[Vec<ExprId>]) -> Vec<Default> {
    let occurs = |symbol: SymbolId| {
        let mut entries = rows.iter().flatten();
        entries.any(|entry| resolver.pool.depends_on(*entry, symbol))
    };
    let parameters = resolver.symbols.parameters.iter().enumerate();
    parameters
        .filter(|(_, parameter)| occurs(parameter.symbol))
        .filter_map(|(position, parameter)| {
            Some((position, (parameter.symbol, parameter.default?)))
        })
        .collect()
}

/// True if the rows are proved to be dependent with these defaults.
fn is_singular(pool: &mut Pool, rows: &[Vec<ExprId>], defaults: &[Default]) -> bool {
    let replacements: Vec<(SymbolId, ExprId)> =
        defaults.iter().map(|(_, default)| *default).collect();
    let replaced: Vec<Vec<ExprId>> = rows
        .iter()
        .map(|row| pool.substitute_all(row, &replacements))
        .collect();
    let report = pool.rank(&replaced);
    report.decided && report.rank < rows.len()
}
