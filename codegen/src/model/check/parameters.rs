//! Parameters: names, families, assumptions, defaults, limits.

use std::collections::BTreeSet;

use dalembert_expr::{Assumption as Known, ExprId, Rational, SymbolId};

use super::super::latex::latex;
use super::super::resolve::Resolver;
use super::super::symbols::{Meaning, member_name};
use super::super::{Assumption, Parameter};
use crate::spec::{self, PARAMETERS, ParameterDefault, Scalar, Supplied};

impl<'s> Resolver<'s> {
    /// All parameters, families expanded.
    pub(super) fn all_parameters(&mut self) {
        let spec = self.spec;
        for parameter in &spec.parameters {
            self.parameter_family(parameter);
        }
        for input in &spec.inputs {
            self.input_family(input);
        }
    }

    /// Inputs are stored as parameters with the value 0 until they are set.
    fn input_family(&mut self, written: &'s Supplied) {
        let first = self.symbols.parameters.len();
        let size = self.family_size(
            &written.declared,
            first,
            PARAMETERS,
            "parameters and inputs",
        );
        let meaning = size.map_or(Meaning::Parameter(first), |size| {
            Meaning::Parameters(first, size)
        });
        if !self.declare(&written.declared.name, meaning) {
            return;
        }
        for member in 0..size.unwrap_or(1) {
            let name = member_name(&written.declared.name.text, size.map(|_| member + 1));
            let symbol = self.pool.symbol(&name.display, &latex(&name), Known::None);
            self.symbols.parameters.push(Parameter {
                name,
                documentation: written.documentation.clone(),
                assumption: Assumption::Finite,
                default: Some(self.pool.zero()),
                is_input: true,
                symbol,
                item: written.item,
            });
        }
    }

    fn parameter_family(&mut self, written: &'s spec::Parameter) {
        let assumption = self.assumption(&written.assumption);
        let first = self.symbols.parameters.len();
        let size = self.family_size(&written.declared, first, PARAMETERS, "parameters");
        let defaults = self.defaults(written, size, &assumption);
        let meaning = size.map_or(Meaning::Parameter(first), |size| {
            Meaning::Parameters(first, size)
        });
        if !self.declare(&written.declared.name, meaning) {
            return;
        }
        for (offset, default) in defaults.into_iter().enumerate() {
            let name = member_name(&written.declared.name.text, size.map(|_| offset + 1));
            let symbol = self
                .pool
                .symbol(&name.display, &latex(&name), known(&assumption));
            self.symbols.parameters.push(Parameter {
                name,
                documentation: written.documentation.clone(),
                assumption: assumption.clone(),
                default,
                is_input: false,
                symbol,
                item: written.item,
            });
        }
    }

    /// One default for each member.
    fn defaults(
        &mut self,
        written: &spec::Parameter,
        size: Option<usize>,
        assumption: &Assumption,
    ) -> Vec<Option<ExprId>> {
        let count = size.unwrap_or(1);
        match &written.default {
            None => vec![None; count],
            Some(ParameterDefault::One(value)) => {
                vec![self.default(value, written, assumption); count]
            }
            Some(ParameterDefault::List(values, at)) => {
                if size.is_none() || values.len() != count {
                    let name = &written.declared.name.text;
                    let text = match size {
                        None => format!("a list of defaults, but `{name}` is not a family"),
                        Some(size) => {
                            format!("{} defaults for {size} members of `{name}`", values.len())
                        }
                    };
                    self.refuse::<()>(*at, text, "a single default holds for all members");
                    return vec![None; count];
                }
                values
                    .iter()
                    .map(|value| self.default(value, written, assumption))
                    .collect()
            }
        }
    }

    fn default(
        &mut self,
        written: &Scalar,
        parameter: &spec::Parameter,
        assumption: &Assumption,
    ) -> Option<ExprId> {
        let expr = self.constant_expression(written, "a default")?;
        let value = self.constant_value(expr);
        if !value.is_finite() {
            return self.refuse(
                written.at,
                format!("`{written}` is not a finite number"),
                "",
            );
        }
        if !holds(assumption, value) {
            let text = format!(
                "the default `{written}` violates `{}`",
                demand(&parameter.assumption)
            );
            return self.refuse(written.at, text, "change the default or the assumption");
        }
        Some(expr)
    }

    fn assumption(&mut self, written: &spec::Assumption) -> Assumption {
        match written {
            spec::Assumption::Finite => Assumption::Finite,
            spec::Assumption::Positive => Assumption::Positive,
            spec::Assumption::NonNegative => Assumption::NonNegative,
            spec::Assumption::NonZero => Assumption::NonZero,
            spec::Assumption::Within(ends) => {
                let [low, high] = ends.as_ref();
                let ends = (self.bound(low), self.bound(high));
                let (Some(low_value), Some(high_value)) = ends else {
                    return Assumption::Finite;
                };
                if low_value > high_value {
                    let at = low.at.to(high.at);
                    self.refuse::<()>(
                        at,
                        format!("the interval from `{low}` to `{high}` is empty"),
                        "write `[low, high]`",
                    );
                } else if low_value == high_value {
                    self.refuse::<()>(
                        low.at.to(high.at),
                        format!("the interval from `{low}` to `{high}` has one point"),
                        &format!("write `let .. = {low};` instead of a parameter"),
                    );
                }
                Assumption::Within {
                    low: low_value,
                    high: high_value,
                }
            }
        }
    }

    /// The end of an interval as a rational number: exact if it is one, else the shortest decimal of the nearest
    /// double.
    fn bound(&mut self, written: &Scalar) -> Option<Rational> {
        let expr = self.constant_expression(written, "the end of an interval")?;
        if let Some(number) = self.pool.as_number(expr) {
            return Some(number.clone());
        }
        let value = nearest_rational(self.constant_value(expr));
        value.or_else(|| {
            self.refuse(
                written.at,
                format!("`{written}` is not a finite number"),
                "",
            )
        })
    }
}

/// The shortest decimal that reads back as this number.
pub(super) fn nearest_rational(value: f64) -> Option<Rational> {
    let size = Rational::from_decimal(&format!("{:e}", value.abs()))?;
    Some(if value < 0.0 { -size } else { size })
}

fn known(assumption: &Assumption) -> Known {
    match assumption {
        Assumption::Finite => Known::None,
        Assumption::Positive => Known::Positive,
        Assumption::NonNegative => Known::NonNegative,
        Assumption::NonZero => Known::NonZero,
        Assumption::Within { low, .. } if low.is_positive() => Known::Positive,
        Assumption::Within { low, .. } if low.is_zero() => Known::NonNegative,
        Assumption::Within { high, .. } if high.is_negative() => Known::NonZero,
        Assumption::Within { .. } => Known::None,
    }
}

fn holds(assumption: &Assumption, value: f64) -> bool {
    match assumption {
        Assumption::Finite => true,
        Assumption::Positive => value > 0.0,
        Assumption::NonNegative => value >= 0.0,
        Assumption::NonZero => value != 0.0,
        Assumption::Within { low, high } => low.to_f64() <= value && value <= high.to_f64(),
    }
}

/// An assumption as it was written.
fn demand(assumption: &spec::Assumption) -> String {
    match assumption {
        spec::Assumption::Finite => "finite".to_owned(),
        spec::Assumption::Positive => "> 0".to_owned(),
        spec::Assumption::NonNegative => ">= 0".to_owned(),
        spec::Assumption::NonZero => "!= 0".to_owned(),
        spec::Assumption::Within(ends) => format!("in [{}, {}]", ends[0], ends[1]),
    }
}

/// Remarks on parameters that nothing uses.
pub(super) fn unused(resolver: &Resolver<'_>, used: &BTreeSet<SymbolId>) -> Vec<String> {
    let parameters = resolver.symbols.parameters.iter();
    let unused = parameters.filter(|parameter| !used.contains(&parameter.symbol));
    unused
        .map(|parameter| {
            let noun = match parameter.is_input {
                true => "input",
                false => "parameter",
            };
            format!("the {noun} `{}` is not used", parameter.name.display)
        })
        .collect()
}
