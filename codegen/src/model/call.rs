//! Powers and calls: elementary functions, `dot`, `d`, derived quantities, defined functions.

use dalembert_expr::{ExprId, Function, Node, Rational, SymbolId};

use super::definitions::Definition;
use super::resolve::{DerivedNames, FEWER_DIGITS, Resolver, Scope, Value, too_long};
use super::symbols::Meaning;
use crate::diagnostics::{Location, listed, nearest};
use crate::spec::{
    EXPONENT, EXPONENT_DENOMINATOR_BITS, INTEGRAL, NUMBER_BITS, Scalar, ScalarKind, Word,
};

impl<'s> Resolver<'s> {
    pub(super) fn power(
        &mut self,
        whole: &Scalar,
        base: &Scalar,
        exponent: &Scalar,
        scope: &mut Scope,
    ) -> Option<Value> {
        let value = self.expression(base, scope);
        let power = self.expression(exponent, scope)?;
        let Some(power) = self.pool.as_number(power).cloned() else {
            let text = format!("the exponent `{exponent}` is not a constant rational number");
            return self.refuse(
                exponent.at,
                text,
                &format!("write `exp({exponent}*ln({base}))`"),
            );
        };
        if power.abs() > Rational::from(EXPONENT) {
            let text = format!("the exponent `{exponent}` is too large; the limit is {EXPONENT}");
            return self.refuse(exponent.at, text, "");
        }
        if power.denom().bits() > EXPONENT_DENOMINATOR_BITS {
            let limit = (1 << EXPONENT_DENOMINATOR_BITS) - 1;
            let text = format!(
                "the denominator of the exponent `{exponent}` is too large; the limit is {limit}"
            );
            return self.refuse(
                exponent.at,
                text,
                "choose a smaller denominator; one third is `(1/3)`, not a decimal",
            );
        }
        let value = value?;
        if let Some(number) = self.pool.as_number(value).cloned() {
            self.check_constant_power(whole, &number, &power)?;
        }
        Some(self.pool.pow(value, power).into())
    }

    /// Refuses powers of numbers that are undefined or not real, and exact numbers that are too long.
    fn check_constant_power(
        &mut self,
        whole: &Scalar,
        base: &Rational,
        power: &Rational,
    ) -> Option<()> {
        if base.is_zero() && power.is_negative() {
            return self.refuse(whole.at, "division by zero", "");
        }
        if base.is_zero() && power.is_zero() {
            return self.refuse(whole.at, format!("`{whole}` is not defined"), "");
        }
        if base.is_negative() && !power.is_integer() {
            return self.refuse(whole.at, format!("`{whole}` is not a real number"), "");
        }
        let size = power.abs().to_f64() * base.bits() as f64;
        if size > NUMBER_BITS as f64 && power.is_integer() {
            return self.refuse(whole.at, too_long(), FEWER_DIGITS);
        }
        Some(())
    }

    pub(super) fn call(
        &mut self,
        at: Location,
        name: &Word,
        arguments: &[Scalar],
        scope: &mut Scope,
    ) -> Option<Value> {
        match name.text.as_str() {
            "dot" | "d" => self.derivative(at, name, arguments, scope),
            INTEGRAL => {
                let text = "an integral along a run must be the whole output";
                let help = "write `outputs { S: integral(..); }`, with one expression";
                self.refuse(name.at, text, help)
            }
            "momentum" | "multiplier" => self.derived_quantity(name, arguments, scope),
            "partial" => self.partial(name, arguments, scope),
            "sqrt" | "atan2" => self.elementary(at, name, None, arguments, scope),
            text => match Function::from_name(text) {
                Some(function) => self.elementary(at, name, Some(function), arguments, scope),
                None => self.defined_call(name, arguments, scope),
            },
        }
    }

    /// The values of all arguments, if there are as many as expected.
    fn arguments(
        &mut self,
        name: &Word,
        arguments: &[Scalar],
        count: usize,
        scope: &mut Scope,
    ) -> Option<Vec<Value>> {
        let values: Vec<Option<Value>> = arguments
            .iter()
            .map(|argument| self.resolve(argument, scope))
            .collect();
        if values.len() != count {
            let plural = if count == 1 { "" } else { "s" };
            let text = format!(
                "`{}` takes {count} argument{plural}, found {}",
                name.text,
                values.len()
            );
            let is_angle_of_point = name.text == "atan" && values.len() == 2;
            let help = if is_angle_of_point {
                "the angle of a point is written `atan2(y, x)`"
            } else {
                ""
            };
            return self.refuse(name.at, text, help);
        }
        values.into_iter().collect()
    }

    /// A function of numbers. `None` stands for `sqrt` and `atan2`, which are not a [`Function`].
    fn elementary(
        &mut self,
        at: Location,
        name: &Word,
        function: Option<Function>,
        arguments: &[Scalar],
        scope: &mut Scope,
    ) -> Option<Value> {
        let count = if name.text == "atan2" { 2 } else { 1 };
        let values = self.arguments(name, arguments, count, scope)?;
        let expr = match (function, values.as_slice()) {
            (Some(function), [argument]) => self.pool.call(function, argument.expr),
            (_, [y, x]) => self.pool.atan2(y.expr, x.expr),
            (_, [argument]) => self.pool.sqrt(argument.expr),
            _ => return None,
        };
        if self.pool.is_undefined_constant(expr)
            && !values
                .iter()
                .any(|value| self.pool.is_undefined_constant(value.expr))
        {
            let arguments: Vec<String> = arguments.iter().map(ToString::to_string).collect();
            let text = format!(
                "`{}({})` is not a real number",
                name.text,
                arguments.join(", ")
            );
            return self.refuse(at, text, "");
        }
        Some(expr.into())
    }

    /// `dot(e)` or `d(e)`.
    fn derivative(
        &mut self,
        at: Location,
        name: &Word,
        arguments: &[Scalar],
        scope: &mut Scope,
    ) -> Option<Value> {
        let values = self.arguments(name, arguments, 1, scope)?;
        let expr = values.first()?.expr;
        let mut rates = self.symbols.velocities();
        rates.extend(self.symbols.all_differentials());
        if self.pool.depends_on_any(expr, &rates) {
            let text = format!(
                "`{}` of an expression that contains a velocity or a differential",
                name.text
            );
            return self.refuse(
                at,
                text,
                &format!("`{}` takes an expression of the coordinates", name.text),
            );
        }
        let directions = self.directions(&name.text, expr);
        if let (true, [argument]) = (directions.is_empty(), arguments)
            && !self.mentions_local(argument, scope)
        {
            let text = format!(
                "`{}` of `{argument}`, which depends neither on coordinates nor on `t`",
                name.text
            );
            return self.refuse(at, text, "parameters, inputs and numbers have no rate");
        }
        let rate = self.pool.derivative_along(expr, &directions);
        Some(Value {
            expr: rate,
            level: Some(expr),
        })
    }

    /// True if an expression contains a name that may stand for different values in different uses. It may then be
    /// constant in one use and depend on coordinates in another.
    fn mentions_local(&self, scalar: &Scalar, scope: &Scope) -> bool {
        let within = |part: &Scalar| self.mentions_local(part, scope);
        match &scalar.kind {
            ScalarKind::Number(..) => false,
            // A definition may stand for a constant or for a moving point.
            ScalarKind::Name(name) => {
                let meaning = self.symbols.names.get(name);
                scope.get(name).is_some() || matches!(meaning, Some((Meaning::Definition, _)))
            }
            ScalarKind::Member(family, index) => {
                let meaning = self.symbols.names.get(&family.text);
                !matches!(meaning, Some((Meaning::Parameters(..), _))) && within(index)
            }
            ScalarKind::Negative(inner) | ScalarKind::SumOver(_, inner) => within(inner),
            ScalarKind::Sum(terms) => terms.iter().any(|(_, term)| within(term)),
            ScalarKind::Product(factors) => factors.iter().any(|(_, factor)| within(factor)),
            ScalarKind::Power(base, _) => within(base),
            ScalarKind::Call(name, arguments) => {
                let meaning = self.symbols.names.get(&name.text);
                matches!(meaning, Some((Meaning::Definition, _))) || arguments.iter().any(within)
            }
        }
    }

    /// The symbols that `expr` depends on and that change, each with its rate or differential.
    fn directions(&mut self, operation: &str, expr: ExprId) -> Vec<(SymbolId, ExprId)> {
        let mut directions = Vec::new();
        for symbol in self.pool.symbols(expr) {
            let index = self.symbols.coordinate_of(symbol);
            let rate = match index {
                Some(index) if operation == "dot" => {
                    self.pool.variable(self.symbols.coordinates[index].qdot)
                }
                Some(index) => self.pool.variable(self.symbols.differentials[index]),
                None if symbol != self.symbols.time => continue,
                None if operation == "dot" => self.pool.one(),
                None => self.pool.variable(self.symbols.time_differential),
            };
            directions.push((symbol, rate));
        }
        directions
    }

    /// `momentum(x)` or `multiplier(a)`.
    fn derived_quantity(
        &mut self,
        name: &Word,
        arguments: &[Scalar],
        scope: &mut Scope,
    ) -> Option<Value> {
        if self.spec.field.is_some() {
            return self.refuse_without_mechanics(name.at, &name.text);
        }
        let is_momentum = name.text == "momentum";
        let help = match self.derived_names {
            DerivedNames::Nowhere if is_momentum => "it may be used in `outputs` and `claims`",
            DerivedNames::Nowhere | DerivedNames::Claims if !is_momentum => {
                "it may be used in `outputs`"
            }
            _ => "",
        };
        if !help.is_empty() {
            let text = format!("`{}` is derived and not known here", name.text);
            return self.refuse(name.at, text, help);
        }
        let [argument] = arguments else {
            return self.refuse(
                name.at,
                format!(
                    "`{}` takes 1 argument, found {}",
                    name.text,
                    arguments.len()
                ),
                "",
            );
        };
        let symbol = if is_momentum {
            let index = self.coordinate(argument, scope)?;
            self.symbols.derived.momenta[index]
        } else {
            let display = self.display_name(argument, scope)?;
            let Some(symbol) = self.multipliers.get(&display) else {
                let help = known_constraints(self.multipliers.keys());
                return self.refuse(
                    argument.at,
                    format!("`{argument}` is not a constraint"),
                    &help,
                );
            };
            *symbol
        };
        Some(self.pool.variable(symbol).into())
    }

    /// `partial(x)`, in a claim of symmetry.
    fn partial(&mut self, name: &Word, arguments: &[Scalar], scope: &mut Scope) -> Option<Value> {
        if self.partials.is_empty() {
            let help = "write `symmetry: partial(theta);` in `claims`";
            return self.refuse(name.at, "`partial` is not known here", help);
        }
        let [argument] = arguments else {
            let text = format!("`partial` takes 1 argument, found {}", arguments.len());
            return self.refuse(name.at, text, "");
        };
        let index = self.coordinate(argument, scope)?;
        Some(self.pool.variable(self.partials[index]).into())
    }

    /// The index of the coordinate that an expression stands for.
    pub(super) fn coordinate(&mut self, scalar: &Scalar, scope: &mut Scope) -> Option<usize> {
        if let ScalarKind::Name(name) = &scalar.kind
            && scope.get(name).is_none()
            && !self.symbols.names.contains_key(name.as_str())
        {
            return self.no_coordinate(scalar);
        }
        let expr = self.expression(scalar, scope)?;
        let index = self.coordinate_index(expr);
        index.or_else(|| self.no_coordinate(scalar))
    }

    fn no_coordinate(&mut self, scalar: &Scalar) -> Option<usize> {
        let text = format!("`{scalar}` is not a coordinate");
        let coordinates = self.symbols.coordinates.iter();
        let mut names: Vec<&str> = coordinates
            .map(|coordinate| coordinate.name.field.as_str())
            .collect();
        names.dedup();
        let help = match nearest(&scalar.to_string(), names.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("the coordinates are {}", listed(names)),
        };
        self.refuse(scalar.at, text, &help)
    }

    /// The index of a coordinate, if the resolved expression is just this coordinate.
    pub(super) fn coordinate_index(&self, expr: ExprId) -> Option<usize> {
        match self.pool.node(expr) {
            Node::Symbol(symbol) => self.symbols.coordinate_of(*symbol),
            _ => None,
        }
    }

    /// The display name `a` or `a.3` of a name that was written `a` or `a[3]`.
    fn display_name(&mut self, scalar: &Scalar, scope: &mut Scope) -> Option<String> {
        match &scalar.kind {
            ScalarKind::Name(name) => Some(name.clone()),
            ScalarKind::Member(name, index) => {
                let member = self.integer(index, scope)?;
                Some(format!("{}.{member}", name.text))
            }
            _ => self.refuse(scalar.at, format!("`{scalar}` is not a name"), ""),
        }
    }

    /// A call of a function that was introduced by `let`.
    fn defined_call(
        &mut self,
        name: &Word,
        arguments: &[Scalar],
        scope: &mut Scope,
    ) -> Option<Value> {
        let definition = self.definitions.get_key_value(name.text.as_str());
        let Some((
            key,
            Definition::Function {
                arguments: names,
                body,
            },
        )) = definition
        else {
            return self.not_a_function(name, arguments, scope);
        };
        let (key, names, body) = (*key, *names, *body);
        let values = self.arguments(name, arguments, names.len(), scope)?;
        let memo = (key, values.iter().map(|value| value.expr).collect());
        if let Some(value) = self.calls.get(&memo) {
            return *value;
        }
        let mut inner = Scope::default();
        for (name, value) in names.iter().zip(&values) {
            inner.bind(&name.text, *value);
        }
        let value = self.resolve(body, &mut inner);
        self.calls.insert(memo, value);
        value
    }

    fn not_a_function(
        &mut self,
        name: &Word,
        arguments: &[Scalar],
        scope: &mut Scope,
    ) -> Option<Value> {
        if matches!(
            self.definitions.get(name.text.as_str()),
            Some(Definition::Faulty)
        ) {
            return None;
        }
        let meaning = self
            .symbols
            .names
            .get(&name.text)
            .map(|(meaning, _)| *meaning);
        let noun = match meaning {
            Some(Meaning::Definition) => "not a function",
            Some(meaning) => meaning.noun(),
            None if scope.get(&name.text).is_some() => "not a function",
            None if matches!(name.text.as_str(), "t" | "pi" | "energy") => "not a function",
            None => return self.unknown_function(name),
        };
        if let (Some(Meaning::Coordinates(..) | Meaning::Parameters(..)), [member]) =
            (meaning, arguments)
        {
            let text = format!("`{}` is a family, not a function", name.text);
            return self.refuse(name.at, text, &format!("write `{}[{member}]`", name.text));
        }
        let text = match noun {
            "not a function" => format!("`{}` is not a function", name.text),
            noun => format!("`{}` is a {noun}, not a function", name.text),
        };
        let arguments: Vec<String> = arguments.iter().map(ToString::to_string).collect();
        let help = match arguments.as_slice() {
            [] => format!("write `{}`", name.text),
            _ => format!(
                "a product is written `{}*({})`",
                name.text,
                arguments.join(", ")
            ),
        };
        self.refuse(name.at, text, &help)
    }
}

fn known_constraints<'a>(names: impl Iterator<Item = &'a String>) -> String {
    let names: Vec<&str> = names.map(String::as_str).collect();
    if names.is_empty() {
        "the model declares no constraints".to_owned()
    } else {
        format!("the constraints are {}", listed(names))
    }
}
