//! Indices: integers known while building, their ranges, and the members of families that they name.

use dalembert_expr::{ExprId, Rational};

use super::resolve::{Resolver, Scope, Value};
use super::symbols::Meaning;
use crate::diagnostics::Diagnostics;
use crate::spec::{Binder, Declared, FAMILY, Indices, STEPS, Scalar, ScalarKind, Spec, Word};

/// Resolution of the indices of families of modes while they are read.
pub const INDICES: Indices = Indices { members, value };

fn members(spec: &Spec, declared: &Declared) -> Result<Vec<usize>, Diagnostics> {
    let mut resolver = with_constants(spec);
    let members = resolver.members(declared).into_iter();
    let members = members.filter_map(|(name, _)| name.member).collect();
    resolver.diagnostics.finish(members)
}

fn value(spec: &Spec, index: &Scalar) -> Result<i64, Diagnostics> {
    let mut resolver = with_constants(spec);
    let value = resolver.integer(index, &mut Scope::default());
    value.ok_or(resolver.diagnostics)
}

/// A resolver that knows only constants.
fn with_constants(spec: &Spec) -> Resolver<'_> {
    let mut resolver = Resolver::new(spec, STEPS);
    resolver.constants();
    resolver
}

impl Resolver<'_> {
    /// `a % b` of indices, in `0..b`.
    pub(super) fn remainder(
        &mut self,
        left: Value,
        right: Value,
        divisor: &Scalar,
    ) -> Option<Value> {
        match (self.as_integer(left.expr), self.as_integer(right.expr)) {
            (Some(left), Some(right)) if right > 0 => {
                Some(self.pool.int(left.rem_euclid(right)).into())
            }
            (Some(_), Some(_)) => self.refuse(divisor.at, "`%` needs a positive divisor", ""),
            _ => self.refuse(
                divisor.at,
                "`%` is defined for indices only",
                "both sides are integers known while building",
            ),
        }
    }

    fn as_integer(&self, expr: ExprId) -> Option<i64> {
        self.pool.as_number(expr).and_then(Rational::to_i64)
    }

    /// The value of an index.
    pub(super) fn integer(&mut self, scalar: &Scalar, scope: &mut Scope) -> Option<i64> {
        let help = "indices are made of integers, constants and indices of families";
        self.integer_or(scalar, scope, help)
    }

    /// An integer, or an error with this help.
    pub(super) fn integer_or(
        &mut self,
        scalar: &Scalar,
        scope: &mut Scope,
        help: &str,
    ) -> Option<i64> {
        if let Some(name) = self.undeclared_size(scalar, scope) {
            let help = format!("a size is declared with `const {name} = 8;`");
            return self.refuse(scalar.at, format!("unknown name `{name}`"), &help);
        }
        let value = self.expression(scalar, scope)?;
        let integer = self.as_integer(value);
        integer.or_else(|| {
            let text = format!("`{scalar}` is not an integer known while building");
            self.refuse(scalar.at, text, help)
        })
    }

    /// An undeclared name of capital letters, as is usual for sizes.
    fn undeclared_size<'a>(&self, scalar: &'a Scalar, scope: &Scope) -> Option<&'a str> {
        let ScalarKind::Name(name) = &scalar.kind else {
            return None;
        };
        let is_capital = name.chars().all(char::is_uppercase);
        let is_known = scope.get(name).is_some() || self.symbols.names.contains_key(name);
        let is_declared = self.not_yet_known(name).is_some();
        (is_capital && !is_known && !is_declared).then_some(name)
    }

    /// The values an index takes; none if the last one is before the first.
    pub(super) fn range(
        &mut self,
        binder: &Binder,
        scope: &mut Scope,
    ) -> Option<std::ops::RangeInclusive<i64>> {
        let low = self.integer(&binder.low, scope);
        let high = self.integer(&binder.high, scope);
        let (low, high) = (low?, high?);
        if high.saturating_sub(low) >= FAMILY {
            let text = format!("`{binder}` takes more than {FAMILY} values");
            return self.refuse(binder.low.at.to(binder.high.at), text, "");
        }
        Some(low..=high)
    }

    pub(super) fn member(
        &mut self,
        name: &Word,
        index: &Scalar,
        scope: &mut Scope,
    ) -> Option<Value> {
        let member = self.integer(index, scope);
        let Some((meaning, _)) = self.symbols.names.get(&name.text).copied() else {
            return self.unknown_name(&name.text, name.at, scope);
        };
        let member = member?;
        match meaning {
            Meaning::Coordinates(first, size) => {
                let offset = self.offset(name, index, member, size)?;
                Some(
                    self.pool
                        .variable(self.symbols.coordinates[first + offset].q)
                        .into(),
                )
            }
            Meaning::Parameters(first, size) => {
                let offset = self.offset(name, index, member, size)?;
                Some(
                    self.pool
                        .variable(self.symbols.parameters[first + offset].symbol)
                        .into(),
                )
            }
            Meaning::Definition => self.defined_member(name, index, member),
            _ => {
                let text = format!("`{}` is not a family", name.text);
                self.refuse(name.at, text, &format!("write `{}`", name.text))
            }
        }
    }

    /// The offset of a 1-based member in its family.
    pub(super) fn offset(
        &mut self,
        name: &Word,
        index: &Scalar,
        member: i64,
        size: usize,
    ) -> Option<usize> {
        match usize::try_from(member) {
            Ok(member) if (1..=size).contains(&member) => Some(member - 1),
            _ => {
                let text = format!("`{}[{member}]` does not exist", name.text);
                self.refuse(
                    index.at,
                    text,
                    &format!("`{}` has the members 1 to {size}", name.text),
                )
            }
        }
    }
}
