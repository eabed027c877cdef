//! The cost that optimal inputs minimise. It must be quadratic and strictly convex in the inputs: the optimal input is
//! then unique at every state and costate.

use dalembert_expr::{ExprId, Sign, Verdict};

use super::super::Cost;
use super::super::resolve::{Resolver, Scope};
use crate::diagnostics::listed;
use crate::spec::{Scalar, Spec};

/// The declared cost.
pub(super) fn resolve(resolver: &mut Resolver<'_>) -> Option<Cost> {
    let spec: &Spec = resolver.spec;
    let cost = spec.cost.as_ref()?;
    let at = spec.location(cost.item);
    if spec.inputs.is_empty() {
        let help = "declare the inputs that are chosen: `inputs { u; }`";
        return resolver.refuse(at, "a `cost` needs `inputs`", help);
    }
    let Some(written) = &cost.running else {
        let help =
            "write `running = u^2/2;`: a cost that does not grow with the inputs has no best input";
        return resolver.refuse(at, "a `cost` needs `running = ..;`", help);
    };
    let running = resolver.cost_expression(written);
    let terminal = match &cost.terminal {
        Some(terminal) => resolver.terminal(terminal),
        None => Some(resolver.pool.zero()),
    };
    let running = running?;
    resolver.check_convex(written, running)?;
    Some(Cost {
        running,
        terminal: terminal?,
        item: cost.item,
    })
}

impl Resolver<'_> {
    /// A function of time, state and inputs.
    fn cost_expression(&mut self, written: &Scalar) -> Option<ExprId> {
        let scope = Scope::default();
        let expr = self.expression(written, &mut scope.clone())?;
        let differentials = self.symbols.all_differentials();
        let text = "a cost contains no differentials";
        let help = "velocities are written `dot(x)`";
        self.forbid(written, &scope, expr, &differentials, text, help)?;
        if self.spec.field.is_some() {
            let rates = self.symbols.velocities();
            let text = "the cost of a first-order system depends on coordinates and inputs";
            self.forbid(written, &scope, expr, &rates, text, "write the rate out")?;
        }
        self.forbid_abs(written, &scope, expr, "`cost`")?;
        self.within_budget(written.at).then_some(expr)
    }

    /// A function of time and state.
    fn terminal(&mut self, written: &Scalar) -> Option<ExprId> {
        let expr = self.cost_expression(written)?;
        let inputs = self.symbols.inputs();
        let text = "the terminal cost depends on the state at the end alone";
        let help = "an input belongs in `running`";
        self.forbid(written, &Scope::default(), expr, &inputs, text, help)?;
        Some(expr)
    }

    /// Refuses a running cost without a best input.
    fn check_convex(&mut self, written: &Scalar, running: ExprId) -> Option<()> {
        let inputs = self.symbols.inputs();
        let names = listed(inputs.iter().map(|input| self.pool.symbol_name(*input)));
        let rows = second_derivatives(self, running);
        let is_curved = rows.iter().flatten().any(|entry| {
            self.pool.depends_on_any(*entry, &inputs)
                && self.pool.zero_test(*entry) != Verdict::Proved
        });
        if is_curved {
            let text = format!("the running cost is not quadratic in {names}");
            let help = "write `u^2/2`: the optimal input is solved for in closed form";
            return self.refuse(written.at, text, help);
        }
        let rank = self.pool.rank(&rows);
        let diagonal = (0..rows.len()).map(|index| self.pool.sign(rows[index][index]));
        let diagonal: Vec<Sign> = diagonal.collect();
        let is_flat = diagonal
            .iter()
            .any(|sign| matches!(sign, Sign::Zero | Sign::NonPositive));
        let falls = diagonal.contains(&Sign::Negative) || self.has_negative_minor(&rows);
        let text = match (falls, is_flat) {
            (true, _) => format!("the running cost is not convex in {names}"),
            (false, false) if rank.rank == rows.len() || !rank.decided => {
                return Some(());
            }
            (false, _) => {
                format!("the running cost does not grow with every combination of {names}")
            }
        };
        let help = "add a positive multiple of the square of each input, such as `u^2/2`";
        self.refuse(written.at, text, help)
    }

    /// True if the second derivatives with respect to a pair of inputs have a determinant that is known to be negative:
    /// the cost is then concave along a combination of both. Larger determinants, and signs that depend on parameters,
    /// are checked when a control begins.
    fn has_negative_minor(&mut self, rows: &[Vec<ExprId>]) -> bool {
        let pairs = (0..rows.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
        let pool = &mut self.pool;
        pairs.into_iter().any(|(i, j)| {
            let product = pool.mul(rows[i][i], rows[j][j]);
            let mixed = pool.mul(rows[i][j], rows[j][i]);
            let minor = pool.sub(product, mixed);
            pool.sign(minor) == Sign::Negative
        })
    }
}

/// The second derivatives with respect to the inputs.
fn second_derivatives(resolver: &mut Resolver<'_>, running: ExprId) -> Vec<Vec<ExprId>> {
    let inputs = resolver.symbols.inputs();
    let pool = &mut resolver.pool;
    let firsts: Vec<ExprId> = inputs.iter().map(|u| pool.diff(running, *u)).collect();
    let row = |first: &ExprId| inputs.iter().map(|u| pool.diff(*first, *u)).collect();
    firsts.iter().map(row).collect()
}
