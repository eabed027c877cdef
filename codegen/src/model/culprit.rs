//! Search for the smallest written part of an expression that has the fault of the whole.

use dalembert_expr::{ExprId, Pool, SymbolId};

use super::resolve::{Resolver, Scope};
use crate::spec::{Scalar, ScalarKind};

impl Resolver<'_> {
    /// The smallest part of `scalar` whose value has the fault, given that the whole has it. Arguments of
    /// functions do not count as parts.
    pub(super) fn culprit<'a>(
        &mut self,
        scalar: &'a Scalar,
        scope: &Scope,
        has_fault: &dyn Fn(&mut Pool, ExprId) -> bool,
    ) -> &'a Scalar {
        let mut scope = scope.clone();
        let mut smallest = scalar;
        while let Some(part) = self.faulty_part(smallest, &mut scope, has_fault) {
            smallest = part;
        }
        smallest
    }

    fn faulty_part<'a>(
        &mut self,
        scalar: &'a Scalar,
        scope: &mut Scope,
        has_fault: &dyn Fn(&mut Pool, ExprId) -> bool,
    ) -> Option<&'a Scalar> {
        if let ScalarKind::SumOver(binder, body) = &scalar.kind {
            return self.faulty_body(binder, body, scope, has_fault);
        }
        let parts: Vec<&Scalar> = match &scalar.kind {
            ScalarKind::Negative(inner) => vec![inner],
            ScalarKind::Sum(terms) => terms.iter().map(|(_, term)| term).collect(),
            ScalarKind::Product(factors) => factors.iter().map(|(_, factor)| factor).collect(),
            ScalarKind::Power(base, _) => vec![base],
            _ => Vec::new(),
        };
        parts.into_iter().find(|part| {
            let value = self.expression(part, scope);
            value.is_some_and(|value| has_fault(&mut self.pool, value))
        })
    }

    /// The body of a sum at the first index where it has the fault. The index stays bound.
    fn faulty_body<'a>(
        &mut self,
        binder: &crate::spec::Binder,
        body: &'a Scalar,
        scope: &mut Scope,
        has_fault: &dyn Fn(&mut Pool, ExprId) -> bool,
    ) -> Option<&'a Scalar> {
        for index in self.range(binder, scope)? {
            let index = self.pool.int(index);
            scope.bind(&binder.name.text, index.into());
            let value = self.expression(body, scope)?;
            if has_fault(&mut self.pool, value) {
                return Some(body);
            }
            scope.unbind();
        }
        None
    }

    /// Refuses an expression that depends on one of `symbols`, at the part where it does.
    pub(super) fn forbid(
        &mut self,
        scalar: &Scalar,
        scope: &Scope,
        expr: ExprId,
        symbols: &[SymbolId],
        text: &str,
        help: &str,
    ) -> Option<()> {
        if !self.pool.depends_on_any(expr, symbols) {
            return Some(());
        }
        let part = self.culprit(scalar, scope, &|pool, expr| {
            pool.depends_on_any(expr, symbols)
        });
        self.refuse(part.at, format!("`{part}`: {text}"), help)
    }
}
