//! `invariant: FORM`: resolves the written form.
//!
//! The two sides of `^` decide its meaning: a power of functions, or a wedge product of forms. Every mistake is
//! reported at the smallest part that is wrong.

use dalembert_expr::ExprId;

use super::super::ExteriorForm;
use super::super::resolve::{Resolver, Scope};
use crate::diagnostics::Location;
use crate::spec::{Binder, Operator, Scalar, ScalarKind};

/// Largest number of products of a form that is multiplied out.
const TERMS: usize = 1024;
const WEDGE: &str = "a wedge product is written `d(x)^d(y)`";

/// True if an expression contains a differential.
fn has_differential(written: &Scalar) -> bool {
    match &written.kind {
        ScalarKind::Number(..) | ScalarKind::Name(_) | ScalarKind::Member(..) => false,
        ScalarKind::Negative(inner) | ScalarKind::SumOver(_, inner) => has_differential(inner),
        ScalarKind::Sum(terms) => terms.iter().any(|(_, term)| has_differential(term)),
        ScalarKind::Product(factors) => factors.iter().any(|(_, factor)| has_differential(factor)),
        ScalarKind::Power(base, exponent) => has_differential(base) || has_differential(exponent),
        ScalarKind::Call(name, arguments) => {
            name.text == "d" || arguments.iter().any(has_differential)
        }
    }
}

impl Resolver<'_> {
    /// A form of degree 1 or more. A form that is 0 by its shape is refused.
    pub(super) fn invariant_form(&mut self, written: &Scalar) -> Option<ExteriorForm> {
        let form = self.form(written, &mut Scope::default())?;
        if form.degree == 0 {
            let text = format!("`{written}` is a function and no form");
            let help = format!("write `conserved: {written};`, or a form such as `d(x)^d(dot(x))`");
            return self.refuse(written.at, text, &help);
        }
        if form.terms.is_empty() {
            return self.refuse(written.at, format!("`{written}` is 0"), "leave it out");
        }
        let coordinates = self.symbols.coordinates.len();
        let dimension = match self.spec.field {
            Some(_) => coordinates,
            None => 2 * coordinates,
        };
        if form.degree > dimension {
            let text = format!(
                "`{written}` is of degree {}, and states have {dimension} dimensions: it is 0",
                form.degree
            );
            return self.refuse(written.at, text, "leave it out");
        }
        Some(form)
    }

    fn form(&mut self, written: &Scalar, scope: &mut Scope) -> Option<ExteriorForm> {
        if !has_differential(written) {
            let value = self.form_coefficient(written, scope)?;
            return Some(ExteriorForm::function(&self.pool, value));
        }
        let form = match &written.kind {
            ScalarKind::Negative(inner) => {
                let form = self.form(inner, scope)?;
                let minus = self.pool.int(-1);
                form.times(&mut self.pool, minus)
            }
            ScalarKind::Sum(terms) => self.form_sum(terms, scope)?,
            ScalarKind::Product(factors) => self.form_product(factors, scope)?,
            ScalarKind::Power(base, exponent) => self.wedge(base, exponent, scope)?,
            ScalarKind::SumOver(binder, body) => self.form_sum_over(binder, body, scope)?,
            ScalarKind::Call(name, arguments) => match (name.text.as_str(), arguments.as_slice()) {
                ("d", [argument]) => self.differential(written.at, argument, scope)?,
                ("d", _) => {
                    let text = format!("`d` takes 1 argument, found {}", arguments.len());
                    return self.refuse(name.at, text, "");
                }
                (function, _) => {
                    let inner = arguments
                        .iter()
                        .find(|argument| has_differential(argument))?;
                    let text = format!("`{inner}` is a form, and `{function}` takes functions");
                    return self.refuse(
                        inner.at,
                        text,
                        "forms are added, multiplied by functions and by `^`",
                    );
                }
            },
            ScalarKind::Number(..) | ScalarKind::Name(_) | ScalarKind::Member(..) => return None,
        };
        if form.terms.len() > TERMS {
            let text =
                format!("`{written}` has more than {TERMS} products when it is multiplied out");
            return self.refuse(written.at, text, "use fewer terms");
        }
        Some(form)
    }

    /// A function that stands before a differential.
    fn form_coefficient(&mut self, written: &Scalar, scope: &mut Scope) -> Option<ExprId> {
        let value = self.form_function(written, scope)?;
        self.check_periodic(&[written], scope, value);
        Some(value)
    }

    fn form_function(&mut self, written: &Scalar, scope: &mut Scope) -> Option<ExprId> {
        let value = self.expression(written, scope)?;
        self.forbid_inputs(written, scope, value)?;
        let differentials = self.symbols.all_differentials();
        let text = "a definition that contains differentials";
        let help = "write the differentials in the claim";
        self.forbid(written, scope, value, &differentials, text, help)?;
        Some(value)
    }

    /// `d(f)` of a function or of a form.
    fn differential(
        &mut self,
        at: Location,
        argument: &Scalar,
        scope: &mut Scope,
    ) -> Option<ExteriorForm> {
        if has_differential(argument) {
            let form = self.form(argument, scope)?;
            return Some(form.exterior(&mut self.pool));
        }
        let value = self.form_function(argument, scope)?;
        let mut moving = self.symbols.positions();
        moving.extend(self.symbols.velocities());
        let symbols = moving.clone();
        moving.extend(&self.symbols.derived.momenta);
        moving.push(self.symbols.derived.energy);
        if !self.pool.depends_on_any(value, &moving) {
            let text = format!(
                "`d` of `{argument}`, which depends neither on positions nor on velocities"
            );
            let help = "a form compares states of one time: parameters, numbers and `t` have no differential";
            return self.refuse(at, text, help);
        }
        self.check_periodic_derivatives(&[argument], scope, value, &symbols);
        Some(ExteriorForm::differential(&self.pool, value))
    }

    fn form_sum(&mut self, terms: &[(bool, Scalar)], scope: &mut Scope) -> Option<ExteriorForm> {
        let mut sum: Option<ExteriorForm> = None;
        for (is_negative, term) in terms {
            let mut form = self.form(term, scope)?;
            if *is_negative {
                let minus = self.pool.int(-1);
                form = form.times(&mut self.pool, minus);
            }
            sum = Some(match sum {
                None => form,
                Some(before) if before.degree == form.degree => before.plus(&mut self.pool, form),
                Some(before) => {
                    let text = format!(
                        "`{term}` is of degree {}, and the terms before it are of degree {}",
                        form.degree, before.degree
                    );
                    return self.refuse(term.at, text, "the terms of a form have one degree");
                }
            });
        }
        sum
    }

    fn form_sum_over(
        &mut self,
        binder: &Binder,
        body: &Scalar,
        scope: &mut Scope,
    ) -> Option<ExteriorForm> {
        let mut sum: Option<ExteriorForm> = None;
        for index in self.range(binder, scope)? {
            let index = self.pool.int(index);
            scope.bind(&binder.name.text, index.into());
            let term = self.form(body, scope);
            scope.unbind();
            let term = term?;
            sum = Some(match sum {
                Some(before) => before.plus(&mut self.pool, term),
                None => term,
            });
        }
        if sum.is_none() {
            let text = format!("a sum of no forms: `{binder}` takes no values");
            return self.refuse(body.at, text, "leave it out");
        }
        sum
    }

    fn form_product(
        &mut self,
        factors: &[(Operator, Scalar)],
        scope: &mut Scope,
    ) -> Option<ExteriorForm> {
        let one = self.pool.one();
        let mut product = ExteriorForm::function(&self.pool, one);
        for (operator, factor) in factors {
            let form = self.form(factor, scope)?;
            let function = match (form.degree, form.terms.first()) {
                (0, Some(term)) => Some(term.coefficient),
                (0, None) => Some(self.pool.zero()),
                _ => None,
            };
            product = match (operator, function) {
                (Operator::Times, Some(function)) => product.times(&mut self.pool, function),
                (Operator::Times, None) if product.degree == 0 => {
                    product.wedge(&mut self.pool, &form)
                }
                (Operator::Times, None) => {
                    let text = format!("`{factor}` is a form, and so is the factor before it");
                    return self.refuse(factor.at, text, WEDGE);
                }
                (Operator::Over, Some(function)) => {
                    if self.pool.is_syntactic_zero(function) {
                        return self.refuse(factor.at, "division by zero", "");
                    }
                    let inverse = self.pool.div(one, function);
                    product.times(&mut self.pool, inverse)
                }
                (Operator::Over, None) => {
                    let text = format!("division by `{factor}`, which is a form");
                    return self.refuse(factor.at, text, "forms are divided by functions");
                }
                (Operator::Modulo, _) => {
                    return self.refuse(factor.at, "forms have no remainder", "leave it out");
                }
            };
        }
        Some(product)
    }

    /// `left ^ right`, one of which is a form.
    fn wedge(&mut self, left: &Scalar, right: &Scalar, scope: &mut Scope) -> Option<ExteriorForm> {
        let forms = [self.form(left, scope)?, self.form(right, scope)?];
        match forms.each_ref().map(|form| form.degree) {
            [0, _] => {
                let text = format!("`{left}` is a function, and `^` stands between it and a form");
                self.refuse(left.at, text, &format!("write `{left}*{right}`"))
            }
            [_, 0] => {
                let text = format!("`{right}` is a function, and a form has no powers");
                self.refuse(right.at, text, WEDGE)
            }
            _ => Some(forms[0].wedge(&mut self.pool, &forms[1])),
        }
    }
}
