//! Resolution of syntax to expressions: names, indices, families, sums, definitions, `dot` and `d`.
//!
//! `dot(e) = d_i e qdot^i + d_t e` and `d(e) = d_i e dq^i + d_t e dt`. The differentials `dq^i`, `dt` are symbols until
//! the equation that contains them is split into components. A value has a *level* next to its expression: the function
//! `f(t, q)` with `expr = dot(f)` or `expr = d(f)`, if its form as written shows that there is one.

use std::collections::BTreeMap;

use dalembert_expr::{ExprId, Node, Pool, Rational, SymbolId};

use super::definitions::Definition;
use super::symbols::{Meaning, Symbols};
use super::transition::Peer;
use crate::diagnostics::{Diagnostics, Location};
use crate::spec::{
    Binder, EXPONENT, EXPRESSIONS, LAGRANGIAN, NUMBER_BITS, Operator, RESOLVED_DEPTH,
    RESOLVED_PARTS, Scalar, ScalarKind, Spec,
};

/// A resolved expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Value {
    /// The expression.
    pub(super) expr: ExprId,
    /// The level: `f` with `expr = dot(f)` or `expr = d(f)`, if known.
    pub(super) level: Option<ExprId>,
}

impl From<ExprId> for Value {
    fn from(expr: ExprId) -> Self {
        Self { expr, level: None }
    }
}

/// Names that are known only inside an expression: indices and arguments.
#[derive(Debug, Clone, Default)]
pub(super) struct Scope {
    locals: Vec<(String, Value)>,
}

impl Scope {
    /// Binds `name` to a value.
    pub(super) fn bind(&mut self, name: &str, value: Value) {
        self.locals.push((name.to_owned(), value));
    }

    /// Removes the binding added last.
    pub(super) fn unbind(&mut self) {
        self.locals.pop();
    }

    /// The value of `name` in this scope. The binding added last takes precedence.
    pub(super) fn get(&self, name: &str) -> Option<Value> {
        self.locals
            .iter()
            .rev()
            .find(|(local, _)| local == name)
            .map(|(_, value)| *value)
    }

    /// The names bound in this scope.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.locals.iter().map(|(name, _)| name.as_str())
    }
}

/// Section of an expression. It decides which derived quantities may be named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DerivedNames {
    /// None.
    Nowhere,
    /// In `outputs`: all of them.
    Outputs,
    /// In `claims`: `energy` and `momentum`.
    Claims,
}

/// Resolves expressions as written to expressions of the pool. Where this fails, an error is recorded and the result is
/// `None`, so that all independent mistakes are found.
pub(super) struct Resolver<'s> {
    pub(super) spec: &'s Spec,
    /// All modes of the model, if the declaration is a mode.
    pub(super) modes: &'s [Peer],
    pub(super) pool: Pool,
    pub(super) symbols: Symbols,
    pub(super) diagnostics: Diagnostics,
    pub(super) definitions: BTreeMap<&'s str, Definition<'s>>,
    /// Results of calls of defined functions, so that equal calls share their expressions.
    pub(super) calls: BTreeMap<(&'s str, Vec<ExprId>), Option<Value>>,
    /// Symbols of multipliers, by the display name of the constraint.
    pub(super) multipliers: BTreeMap<String, SymbolId>,
    /// Derived quantities that may be named in the present section.
    pub(super) derived_names: DerivedNames,
    /// The coordinate vector fields `partial(x)` while a claim of symmetry is resolved; otherwise empty.
    pub(super) partials: Vec<SymbolId>,
    /// The Lagrangian, once resolved.
    pub(super) lagrangian: Option<ExprId>,
    parts: usize,
    depth: usize,
    /// Place at which the pool's budget was exceeded.
    pub(super) exhausted: Option<Location>,
}

/// Number of terms that are added before the size of numbers is checked.
const TERMS_AT_ONCE: usize = 64;

pub(super) const FEWER_DIGITS: &str =
    "write it with fewer digits, or choose units in which it is smaller";
const FEWER_LEVELS: &str = "write it with fewer levels";

pub(super) fn too_long() -> String {
    format!("an exact number of more than {NUMBER_BITS} bits")
}

fn too_deep() -> String {
    format!(
        "the expression is nested more than {RESOLVED_DEPTH} deep once its definitions are expanded"
    )
}

impl<'s> Resolver<'s> {
    /// A resolver without names. `steps` is the budget of its algebra.
    pub(super) fn new(spec: &'s Spec, steps: u64) -> Self {
        let mut pool = Pool::with_budget(steps);
        pool.set_seed(spec.seed);
        let symbols = Symbols::new(&mut pool);
        Self {
            spec,
            modes: &[],
            pool,
            symbols,
            diagnostics: Diagnostics::new(),
            definitions: BTreeMap::new(),
            calls: BTreeMap::new(),
            multipliers: BTreeMap::new(),
            derived_names: DerivedNames::Nowhere,
            partials: Vec::new(),
            lagrangian: None,
            parts: 0,
            depth: 0,
            exhausted: None,
        }
    }

    /// Resolves an expression to its value.
    pub(super) fn resolve(&mut self, scalar: &Scalar, scope: &mut Scope) -> Option<Value> {
        self.parts += 1;
        if self.parts > RESOLVED_PARTS {
            let text = format!(
                "the model has more than {RESOLVED_PARTS} parts once its sums and definitions are expanded"
            );
            return self.refuse(scalar.at, text, "use `let` to name a part that is repeated");
        }
        if self.depth >= RESOLVED_DEPTH {
            return self.refuse(scalar.at, too_deep(), FEWER_LEVELS);
        }
        self.depth += 1;
        let value = self.resolve_kind(scalar, scope);
        self.depth -= 1;
        let value = value?;
        self.within_limits(scalar, value.expr).then_some(value)
    }

    /// Resolves an expression, without its level.
    pub(super) fn expression(&mut self, scalar: &Scalar, scope: &mut Scope) -> Option<ExprId> {
        self.resolve(scalar, scope).map(|value| value.expr)
    }

    fn resolve_kind(&mut self, scalar: &Scalar, scope: &mut Scope) -> Option<Value> {
        match &scalar.kind {
            ScalarKind::Number(value, _) => Some(self.pool.number(value.clone()).into()),
            ScalarKind::Name(name) => self.name(name, scalar.at, scope),
            ScalarKind::Member(name, index) => self.member(name, index, scope),
            ScalarKind::Negative(inner) => {
                let value = self.resolve(inner, scope)?;
                Some(self.scaled(value, -1))
            }
            ScalarKind::Sum(terms) => self.sum(scalar.at, terms, scope),
            ScalarKind::Product(factors) => self.product(factors, scope),
            ScalarKind::Power(base, exponent) => self.power(scalar, base, exponent, scope),
            ScalarKind::Call(function, arguments) => {
                self.call(scalar.at, function, arguments, scope)
            }
            ScalarKind::SumOver(binder, body) => self.sum_over(scalar.at, binder, body, scope),
        }
    }

    /// Records an error, unless it was recorded before. Returns `None`.
    pub(super) fn refuse<T>(
        &mut self,
        at: Location,
        text: impl Into<String>,
        help: &str,
    ) -> Option<T> {
        self.diagnostics.error_once(at, text, help);
        None
    }

    fn within_limits(&mut self, scalar: &Scalar, expr: ExprId) -> bool {
        let refused = self.beyond_limits(scalar, expr);
        if let Some((text, help)) = refused {
            self.diagnostics.error_once(scalar.at, text, help);
            return false;
        }
        self.within_budget(scalar.at)
    }

    /// The limit that an expression exceeds and a help text, if it exceeds one.
    fn beyond_limits(&self, scalar: &Scalar, expr: ExprId) -> Option<(String, &'static str)> {
        if self.pool.number_bits(expr) > NUMBER_BITS {
            return Some((too_long(), FEWER_DIGITS));
        }
        if let Node::Product(factors) = self.pool.node(expr) {
            let limit = Rational::from(EXPONENT);
            let large = factors.iter().find(|(_, power)| power.abs() > limit);
            if let Some((_, power)) = large {
                let text = format!("`{scalar}` has the exponent {power}; the limit is {EXPONENT}");
                return Some((text, "use smaller powers"));
            }
        }
        if self.pool.depth(expr) > RESOLVED_DEPTH {
            return Some((too_deep(), FEWER_LEVELS));
        }
        (self.pool.len() > EXPRESSIONS).then(|| {
            let text = format!("more than {EXPRESSIONS} expressions in one model");
            (text, "split the model")
        })
    }

    /// True if the budget of the algebra is not exceeded. Otherwise stores the first place at which it was exceeded.
    pub(super) fn within_budget(&mut self, at: Location) -> bool {
        if self.pool.is_exhausted() && self.exhausted.is_none() {
            self.exhausted = Some(at);
        }
        self.exhausted.is_none()
    }

    fn scaled(&mut self, value: Value, factor: i64) -> Value {
        let factor = self.pool.int(factor);
        self.times(value, factor)
    }

    /// The product of a value and a factor that is constant in time.
    pub(super) fn times(&mut self, value: Value, factor: ExprId) -> Value {
        let level = value.level.map(|level| self.pool.mul(level, factor));
        Value {
            expr: self.pool.mul(value.expr, factor),
            level,
        }
    }

    fn sum(&mut self, at: Location, terms: &[(bool, Scalar)], scope: &mut Scope) -> Option<Value> {
        let mut values = Vec::with_capacity(terms.len());
        for (negative, term) in terms {
            let value = self.resolve(term, scope);
            values.push(value.map(|value| {
                if *negative {
                    self.scaled(value, -1)
                } else {
                    value
                }
            }));
        }
        let values: Option<Vec<Value>> = values.into_iter().collect();
        self.add_bounded(at, &values?)
    }

    /// The sum of values, as by [`Resolver::add`]. If its numbers may become long, the terms are added in portions, up
    /// to the first number that is too long.
    fn add_bounded(&mut self, at: Location, values: &[Value]) -> Option<Value> {
        let bits = values.iter().map(|value| self.pool.number_bits(value.expr));
        if bits.sum::<u64>() <= NUMBER_BITS {
            return Some(self.add(values));
        }
        let mut total = Value::from(self.pool.zero());
        for part in values.chunks(TERMS_AT_ONCE) {
            let part = self.add(part);
            total = self.add(&[total, part]);
            self.short_numbers(at, total.expr)?;
        }
        // The level is computed from all terms at once, as in [`Resolver::add`].
        let level = self.sum_level(values);
        Some(Value { level, ..total })
    }

    fn short_numbers(&mut self, at: Location, expr: ExprId) -> Option<()> {
        if self.pool.number_bits(expr) > NUMBER_BITS {
            return self.refuse(at, too_long(), FEWER_DIGITS);
        }
        Some(())
    }

    /// The sum of values. Its level is the sum of the levels, if all are known; the level of a constant term `c` is
    /// `c*t`.
    pub(super) fn add(&mut self, values: &[Value]) -> Value {
        let exprs: Vec<ExprId> = values.iter().map(|value| value.expr).collect();
        Value {
            expr: self.pool.sum(&exprs),
            level: self.sum_level(values),
        }
    }

    fn sum_level(&mut self, values: &[Value]) -> Option<ExprId> {
        if values.iter().all(|value| value.level.is_none()) {
            return None;
        }
        let mut levels = Vec::with_capacity(values.len());
        for value in values {
            levels.push(match value.level {
                Some(level) => level,
                None if self.is_constant(value.expr) => {
                    let time = self.pool.variable(self.symbols.time);
                    self.pool.mul(value.expr, time)
                }
                None => return None,
            });
        }
        Some(self.pool.sum(&levels))
    }

    /// True if an expression contains only numbers and parameters.
    pub(super) fn is_constant(&self, expr: ExprId) -> bool {
        !self.pool.depends_on_any(expr, &self.symbols.moving())
    }

    fn product(&mut self, factors: &[(Operator, Scalar)], scope: &mut Scope) -> Option<Value> {
        let mut values = Vec::with_capacity(factors.len());
        for (operator, factor) in factors {
            values.push(
                self.resolve(factor, scope)
                    .map(|value| (*operator, factor, value)),
            );
        }
        let values: Option<Vec<(Operator, &Scalar, Value)>> = values.into_iter().collect();
        let mut product = Value::from(self.pool.one());
        for (operator, factor, value) in values? {
            product = match operator {
                Operator::Times => self.multiplied(product, value),
                Operator::Over => self.divided(product, value, factor)?,
                Operator::Modulo => self.remainder(product, value, factor)?,
            };
            self.short_numbers(factor.at, product.expr)?;
        }
        Some(product)
    }

    fn multiplied(&mut self, left: Value, right: Value) -> Value {
        match (left.level, right.level) {
            (Some(_), None) if self.is_constant(right.expr) => self.times(left, right.expr),
            (None, Some(_)) if self.is_constant(left.expr) => self.times(right, left.expr),
            _ => self.pool.mul(left.expr, right.expr).into(),
        }
    }

    fn divided(&mut self, left: Value, right: Value, divisor: &Scalar) -> Option<Value> {
        if self.pool.is_syntactic_zero(right.expr) {
            return self.refuse(divisor.at, "division by zero", "");
        }
        if left.level.is_some() && self.is_constant(right.expr) {
            let reciprocal = self.pool.pow(right.expr, Rational::from(-1));
            return Some(self.times(left, reciprocal));
        }
        Some(self.pool.div(left.expr, right.expr).into())
    }

    fn sum_over(
        &mut self,
        at: Location,
        binder: &Binder,
        body: &Scalar,
        scope: &mut Scope,
    ) -> Option<Value> {
        let mut terms = Vec::new();
        for index in self.range(binder, scope)? {
            let index = self.pool.int(index);
            scope.bind(&binder.name.text, index.into());
            let term = self.resolve(body, scope);
            scope.unbind();
            terms.push(term?);
        }
        self.add_bounded(at, &terms)
    }

    fn name(&mut self, name: &str, at: Location, scope: &Scope) -> Option<Value> {
        if let Some(value) = scope.get(name) {
            return Some(value);
        }
        match name {
            "t" => return Some(self.pool.variable(self.symbols.time).into()),
            "pi" => return Some(self.pool.pi().into()),
            "energy" => return self.energy(at),
            LAGRANGIAN => return self.lagrangian(at),
            _ => {}
        }
        let Some((meaning, _)) = self.symbols.names.get(name).copied() else {
            return self.unknown_name(name, at, scope);
        };
        match meaning {
            Meaning::Constant(value) => Some(self.pool.int(value).into()),
            Meaning::Coordinate(index) => {
                Some(self.pool.variable(self.symbols.coordinates[index].q).into())
            }
            Meaning::Parameter(index) => Some(
                self.pool
                    .variable(self.symbols.parameters[index].symbol)
                    .into(),
            ),
            Meaning::Coordinates(_, size) | Meaning::Parameters(_, size) => {
                let text = format!("`{name}` is a family of {size}");
                self.refuse(at, text, &format!("write `{name}[1]`"))
            }
            Meaning::Definition => self.definition(name, at),
        }
    }

    fn lagrangian(&mut self, at: Location) -> Option<Value> {
        if self.spec.field.is_some() {
            return self.refuse_without_mechanics(at, LAGRANGIAN);
        }
        if self.derived_names != DerivedNames::Outputs {
            let text = "the Lagrangian is not known here";
            return self.refuse(at, text, "it may be used in `outputs`");
        }
        // A mistake in the Lagrangian is reported at its declaration.
        self.lagrangian.map(Value::from)
    }

    fn energy(&mut self, at: Location) -> Option<Value> {
        if self.spec.field.is_some() {
            return self.refuse_without_mechanics(at, "energy");
        }
        if self.derived_names == DerivedNames::Nowhere {
            return self.refuse(
                at,
                "`energy` is derived and not known here",
                "it may be used in `outputs` and `claims`",
            );
        }
        Some(self.pool.variable(self.symbols.derived.energy).into())
    }
}
