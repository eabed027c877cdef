//! One-forms: `eta = eta_i d(q_i) + eta_0 d(t)`, written with `d(..)` or as an equation in velocities with `dot(..)`.

use dalembert_expr::{ExprId, Pool, SymbolId};

use super::degree::{
    at_zero, coefficients, degree_bound, has_degree, is_defined_with, is_zero, without_hidden_zero,
};
use super::resolve::{Resolver, Scope, Value};
use crate::spec::{Equation, Quantity, Scalar, ScalarKind};

/// The parts of a one-form.
#[derive(Debug)]
pub(super) struct OneForm {
    /// `eta_i`, one for each coordinate.
    pub(super) form: Vec<ExprId>,
    /// `eta_0`
    pub(super) affine: ExprId,
    /// `f` with `df = eta + eta_0 dt`, where known.
    pub(super) level: Option<ExprId>,
    /// Function `phi` of a constraint `phi = 0` that is not linear in the velocities. `form` is then `dphi/dqdot`.
    pub(super) nonlinear: Option<ExprId>,
    /// True if the declaration is the equation `level = 0` in positions.
    pub(super) is_of_positions: bool,
}

/// Admitted dependence of a constraint on velocities.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Dependence {
    /// Linear or affine. The text is the noun for the constraint in messages.
    Linear(&'static str),
    /// Any dependence.
    Any,
}

impl Resolver<'_> {
    /// The one-form of the constraint `left = right`, as written.
    pub(super) fn constraint_form(
        &mut self,
        equation: &Equation,
        scope: &mut Scope,
        dependence: Dependence,
    ) -> Option<OneForm> {
        let left = self.resolve(&equation.left, scope);
        let right = self.resolve(&equation.right, scope);
        let (left, right) = (left?, right?);
        let minus_one = self.pool.int(-1);
        let minus_right = self.times(right, minus_one);
        let value = self.add(&[left, minus_right]);
        let differentials = self.symbols.all_differentials();
        let velocities = self.symbols.velocities();
        let sides = [(&equation.left, left.expr), (&equation.right, right.expr)];
        let uses = |resolver: &Self, symbols: &[SymbolId]| {
            sides
                .iter()
                .any(|(_, expr)| resolver.pool.depends_on_any(*expr, symbols))
        };
        match (uses(self, &differentials), uses(self, &velocities)) {
            (true, true) => self.refuse_mixture(&sides, &differentials, &velocities, scope),
            (true, false) => self.differential_form(&sides, value, &differentials, scope),
            (false, true) => self.velocity_form(&sides, value, &velocities, scope, dependence),
            (false, false) => match dependence {
                Dependence::Any => self.position_form(equation, value.expr),
                Dependence::Linear(what) => self.refuse_positions(equation, what),
            },
        }
    }

    fn differential_form(
        &mut self,
        sides: &[(&Scalar, ExprId)],
        value: Value,
        differentials: &[SymbolId],
        scope: &Scope,
    ) -> Option<OneForm> {
        self.check_linear(sides, differentials, scope, "constraints")?;
        for (side, expr) in sides {
            self.check_every_term(side, *expr, differentials, scope)?;
        }
        let mut form = coefficients(&mut self.pool, value.expr, differentials);
        let affine = form.pop()?;
        self.nonzero_form(
            OneForm {
                form,
                affine,
                level: value.level,
                nonlinear: None,
                is_of_positions: false,
            },
            sides,
        )
    }

    fn velocity_form(
        &mut self,
        sides: &[(&Scalar, ExprId)],
        value: Value,
        velocities: &[SymbolId],
        scope: &Scope,
        dependence: Dependence,
    ) -> Option<OneForm> {
        let linear =
            (sides.iter()).all(|(_, expr)| has_degree(&mut self.pool, *expr, velocities, 1));
        match dependence {
            Dependence::Any if !linear => {
                let form = self.chetaev_form(value.expr, velocities);
                return self.nonzero_form(form, sides);
            }
            Dependence::Any => {}
            Dependence::Linear(what) => self.check_linear(sides, velocities, scope, what)?,
        }
        let form = coefficients(&mut self.pool, value.expr, velocities);
        let affine = at_zero(&mut self.pool, value.expr, velocities);
        let affine = without_hidden_zero(&self.pool, affine);
        // An affine part that vanishes wherever the coefficients have values is dropped.
        let affine = match is_defined_with(&self.pool, affine, &form) && is_zero(&self.pool, affine)
        {
            true => self.pool.zero(),
            false => affine,
        };
        self.nonzero_form(
            OneForm {
                form,
                affine,
                level: value.level,
                nonlinear: None,
                is_of_positions: false,
            },
            sides,
        )
    }

    /// The one-form `df` of a holonomic constraint `f = 0`.
    fn position_form(&mut self, equation: &Equation, f: ExprId) -> Option<OneForm> {
        let at = equation.left.at.to(equation.right.at);
        if mentions_rate(&equation.left) || mentions_rate(&equation.right) {
            let help = "a constraint restricts the velocities";
            return self.refuse(at, "this form is zero", help);
        }
        let positions = self.symbols.positions();
        let form = (positions.iter())
            .map(|position| self.pool.diff(f, *position))
            .collect::<Vec<_>>();
        if form.iter().all(|entry| is_zero(&self.pool, *entry)) {
            let text = "this equation has no coordinates";
            let help = "a constraint restricts positions, `x^2 + y^2 = l^2`, or velocities, `dot(x) = R*dot(theta)`";
            return self.refuse(at, text, help);
        }
        Some(OneForm {
            form,
            affine: self.pool.diff(f, self.symbols.time),
            level: Some(f),
            nonlinear: None,
            is_of_positions: true,
        })
    }

    /// Refuses an equation of positions where an equation of velocities is needed.
    fn refuse_positions<T>(&mut self, equation: &Equation, what: &str) -> Option<T> {
        let at = equation.left.at.to(equation.right.at);
        let text = format!("{what} restrict velocities, and this equation has none");
        self.refuse(at, text, "write `dot(x) = R*dot(theta)`")
    }

    /// The one-form of `phi = 0` by Chetaev's rule, `eta = dphi/dqdot`, with `eta_0 = phi - eta(qdot)`.
    fn chetaev_form(&mut self, phi: ExprId, velocities: &[SymbolId]) -> OneForm {
        let pool = &mut self.pool;
        let form: Vec<ExprId> = (velocities.iter())
            .map(|velocity| {
                let slope = pool.diff(phi, *velocity);
                without_hidden_zero(pool, slope)
            })
            .collect();
        let mut terms = vec![phi];
        for (entry, velocity) in form.iter().zip(velocities) {
            let velocity = pool.variable(*velocity);
            let along = pool.mul(*entry, velocity);
            terms.push(pool.neg(along));
        }
        OneForm {
            affine: pool.sum(&terms),
            form,
            level: None,
            nonlinear: Some(phi),
            is_of_positions: false,
        }
    }

    fn nonzero_form(&mut self, form: OneForm, sides: &[(&Scalar, ExprId)]) -> Option<OneForm> {
        if !form.form.iter().all(|entry| is_zero(&self.pool, *entry)) {
            return Some(form);
        }
        let (first, last) = (sides.first()?.0, sides.last()?.0);
        self.refuse(
            first.at.to(last.at),
            "this form is zero",
            "a constraint restricts the velocities",
        )
    }

    fn check_linear(
        &mut self,
        sides: &[(&Scalar, ExprId)],
        symbols: &[SymbolId],
        scope: &Scope,
        what: &str,
    ) -> Option<()> {
        for (side, expr) in sides {
            if has_degree(&mut self.pool, *expr, symbols, 1) {
                continue;
            }
            let nonlinear = |pool: &mut Pool, expr: ExprId| {
                degree_bound(pool, expr, symbols).is_none_or(|degree| degree > 1)
            };
            let part = self.culprit(side, scope, &nonlinear);
            let text = format!("`{part}`: {what} are linear in velocities");
            return self.refuse(
                part.at,
                text,
                "write `d(x) - R*d(theta) = 0` or `dot(x) = R*dot(theta)`",
            );
        }
        Some(())
    }

    /// Refuses a one-form with a term that has no differential.
    fn check_every_term(
        &mut self,
        side: &Scalar,
        expr: ExprId,
        differentials: &[SymbolId],
        scope: &Scope,
    ) -> Option<()> {
        let rest = at_zero(&mut self.pool, expr, differentials);
        if is_zero(&self.pool, rest) {
            return Some(());
        }
        let part = self.bare_term(side, differentials, scope);
        let help = format!("an affine part is marked with `d(t)`: `({part})*d(t)`");
        self.refuse(
            part.at,
            format!("`{part}` has no differential; every term of a one-form has one"),
            &help,
        )
    }

    /// The first term without any differential.
    fn bare_term<'a>(
        &mut self,
        side: &'a Scalar,
        differentials: &[SymbolId],
        scope: &Scope,
    ) -> &'a Scalar {
        let ScalarKind::Sum(terms) = &side.kind else {
            return side;
        };
        let mut scope = scope.clone();
        let bare = terms.iter().map(|(_, term)| term).find(|term| {
            let expr = self.expression(term, &mut scope);
            expr.is_some_and(|expr| !self.pool.depends_on_any(expr, differentials))
        });
        bare.unwrap_or(side)
    }

    fn refuse_mixture<T>(
        &mut self,
        sides: &[(&Scalar, ExprId)],
        differentials: &[SymbolId],
        velocities: &[SymbolId],
        scope: &Scope,
    ) -> Option<T> {
        let part_with = |resolver: &mut Self, symbols: &[SymbolId]| {
            let (side, _) = sides
                .iter()
                .find(|(_, expr)| resolver.pool.depends_on_any(*expr, symbols))?;
            Some(resolver.culprit(side, scope, &|pool, expr| {
                pool.depends_on_any(expr, symbols)
            }))
        };
        let differential = part_with(self, differentials)?;
        let velocity = part_with(self, velocities)?;
        let text = format!("`{velocity}` and `{differential}` in one equation");
        self.refuse(
            velocity.at,
            text,
            "use either `d(..)` or `dot(..)` throughout",
        )
    }

    /// The one-form of a force: linear in differentials, without `d(t)`.
    pub(super) fn force_form(
        &mut self,
        force: &Quantity,
        scope: &mut Scope,
    ) -> Option<Vec<ExprId>> {
        const HELP: &str = "write `-c*dot(x)*d(x)`";
        let expr = self.expression(&force.value, scope)?;
        let time = [self.symbols.time_differential];
        self.forbid(
            &force.value,
            scope,
            expr,
            &time,
            "a force does no work along `t`",
            HELP,
        )?;
        let differentials = self.symbols.differentials.clone();
        if is_zero(&self.pool, expr) {
            return self.refuse(force.value.at, "this force is zero", "leave it out");
        }
        if !self.pool.depends_on_any(expr, &differentials) {
            return self.refuse(force.value.at, "a force is a one-form", HELP);
        }
        if !has_degree(&mut self.pool, expr, &differentials, 1) {
            let nonlinear = |pool: &mut Pool, expr: ExprId| {
                degree_bound(pool, expr, &differentials).is_none_or(|degree| degree > 1)
            };
            let part = self.culprit(&force.value, scope, &nonlinear);
            return self.refuse(
                part.at,
                format!("`{part}`: forces are linear in differentials"),
                HELP,
            );
        }
        self.check_every_term_of_force(&force.value, expr, &differentials, scope)?;
        Some(coefficients(&mut self.pool, expr, &differentials))
    }

    fn check_every_term_of_force(
        &mut self,
        written: &Scalar,
        expr: ExprId,
        differentials: &[SymbolId],
        scope: &Scope,
    ) -> Option<()> {
        let rest = at_zero(&mut self.pool, expr, differentials);
        if is_zero(&self.pool, rest) {
            return Some(());
        }
        let part = self.bare_term(written, differentials, scope);
        let text = format!("`{part}` has no differential; every term of a force has one");
        self.refuse(
            part.at,
            text,
            &format!("write `({part})*d(x)` for a force along `x`"),
        )
    }
}

/// True if an expression contains `d(..)` or `dot(..)`.
fn mentions_rate(scalar: &Scalar) -> bool {
    match &scalar.kind {
        ScalarKind::Number(..) | ScalarKind::Name(_) | ScalarKind::Member(..) => false,
        ScalarKind::Negative(inner) | ScalarKind::SumOver(_, inner) => mentions_rate(inner),
        ScalarKind::Sum(terms) => terms.iter().any(|(_, term)| mentions_rate(term)),
        ScalarKind::Product(factors) => factors.iter().any(|(_, factor)| mentions_rate(factor)),
        ScalarKind::Power(base, _) => mentions_rate(base),
        ScalarKind::Call(function, arguments) => {
            matches!(function.text.as_str(), "d" | "dot") || arguments.iter().any(mentions_rate)
        }
    }
}
