//! Remarks on constraints that are integrable but not declared as such.
//!
//! `omega = eta + eta_0 dt` on Q x R is closed if `d omega = 0`, and a single form is integrable if
//! `omega ^ d omega = 0` (Frobenius). Both only lead to remarks: a constraint is kept on position level only if it is
//! written as `d(f)` or as an equation of positions.

use dalembert_expr::{ExprId, Pool, SymbolId, Verdict};

use super::super::Constraint;
use super::super::degree::is_zero;
use super::super::resolve::Resolver;

/// Number of entries beyond which a form is not examined. The number of conditions grows with its cube.
const LARGEST_SUPPORT: usize = 12;

/// Remarks on all constraints without a level.
pub(super) fn notes(resolver: &Resolver<'_>, constraints: &[Constraint]) -> Vec<String> {
    let mut notes = Vec::new();
    // Derivatives are made in a copy: a remark adds nothing to the model.
    let mut pool = resolver.pool.clone();
    let mut variables = resolver.symbols.positions();
    variables.push(resolver.symbols.time);
    for constraint in constraints
        .iter()
        .filter(|constraint| constraint.level.is_none() && constraint.nonlinear.is_none())
    {
        let mut form = constraint.form.clone();
        form.push(constraint.affine);
        let name = &constraint.name.display;
        let curl = Curl::new(&mut pool, &form, &variables);
        if curl.is_zero(&pool) {
            notes.push(format!(
                "`{name}` is integrable: write it as `d(f) = 0` to keep it on position level"
            ));
        } else if curl.is_integrable(&mut pool, &form) {
            notes.push(format!(
                "`{name}` is integrable with a factor: find `f` with `d(f)` proportional to it and write `d(f) = 0` to keep it on position level"
            ));
        }
    }
    notes
}

/// `(d omega)_ij = d_i omega_j - d_j omega_i`, by rows.
struct Curl {
    entries: Vec<Vec<ExprId>>,
}

impl Curl {
    fn new(pool: &mut Pool, form: &[ExprId], variables: &[SymbolId]) -> Self {
        let mut entries = vec![vec![pool.zero(); form.len()]; form.len()];
        for i in 0..form.len() {
            for j in i + 1..form.len() {
                let forward = pool.diff(form[j], variables[i]);
                let backward = pool.diff(form[i], variables[j]);
                entries[i][j] = pool.sub(forward, backward);
                entries[j][i] = pool.neg(entries[i][j]);
            }
        }
        Self { entries }
    }

    fn is_zero(&self, pool: &Pool) -> bool {
        self.entries
            .iter()
            .flatten()
            .all(|entry| is_zero(pool, *entry))
    }

    /// True if every component of `omega ^ d omega` is zero.
    fn is_integrable(&self, pool: &mut Pool, form: &[ExprId]) -> bool {
        let involved = |index: usize| {
            !pool.is_syntactic_zero(form[index])
                || self.entries[index]
                    .iter()
                    .any(|entry| !pool.is_syntactic_zero(*entry))
        };
        let support: Vec<usize> = (0..form.len()).filter(|index| involved(*index)).collect();
        if support.len() > LARGEST_SUPPORT {
            return false;
        }
        for (a, i) in support.iter().enumerate() {
            for (b, j) in support.iter().enumerate().skip(a + 1) {
                for k in support.iter().skip(b + 1) {
                    let component = self.component(pool, form, [*i, *j, *k]);
                    if !pool.is_syntactic_zero(component)
                        && pool.zero_test(component) != Verdict::Proved
                    {
                        return false;
                    }
                }
            }
        }
        true
    }

    fn component(&self, pool: &mut Pool, form: &[ExprId], [i, j, k]: [usize; 3]) -> ExprId {
        let first = pool.mul(form[i], self.entries[j][k]);
        let second = pool.mul(form[j], self.entries[k][i]);
        let third = pool.mul(form[k], self.entries[i][j]);
        pool.sum(&[first, second, third])
    }
}
