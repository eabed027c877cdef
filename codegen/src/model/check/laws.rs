//! Impact laws: names, coefficients, and remarks on their limits.

use dalembert_expr::{ExprId, Rational, SymbolId};

use super::super::range::range;
use super::super::resolve::{Resolver, Scope};
use super::super::{Constraint, Law, Parameter, Surface};
use crate::diagnostics::{listed, nearest};
use crate::spec::{self, LAWS, Scalar, Word};

impl Resolver<'_> {
    /// The law of a surface; elastic if none is written.
    pub(super) fn law(&mut self, law: Option<&spec::Law>, scope: &mut Scope) -> Option<Law> {
        let Some(law) = law else {
            return Some(Law::Elastic);
        };
        let name = law.name.text.as_str();
        let Some((_, count)) = LAWS.into_iter().find(|(known, _)| *known == name) else {
            return self.unknown_law(&law.name);
        };
        if law.arguments.len() != count {
            let (text, help) = match count {
                0 => (
                    format!("`{name}` takes no coefficient"),
                    format!("write `{name}`"),
                ),
                _ => (
                    format!("`{name}` takes one coefficient"),
                    format!("write `{name}(0.8)`"),
                ),
            };
            return self.refuse(law.name.at, text, &help);
        }
        let coefficient = match law.arguments.first() {
            Some(written) => Some(self.coefficient(name, written, scope)?),
            None => None,
        };
        Law::named(name, coefficient).or_else(|| self.unknown_law(&law.name))
    }

    fn unknown_law(&mut self, name: &Word) -> Option<Law> {
        let laws = LAWS.map(|(known, _)| known);
        let ending = format!("_{}", name.text);
        let longer: Vec<String> = (laws.iter())
            .filter(|law| law.ends_with(&ending))
            .map(|law| format!("`{law}`"))
            .collect();
        let near = match nearest(&name.text, laws) {
            _ if !longer.is_empty() => format!("did you mean {}? ", longer.join(" or ")),
            Some(near) => format!("did you mean `{near}`? "),
            None => String::new(),
        };
        let help = format!("{near}the laws are {}", listed(laws));
        self.refuse(name.at, format!("unknown law `{}`", name.text), &help)
    }

    /// A coefficient of restitution. A constant must lie in `[0, 1]`, an expression of parameters must do so at their
    /// defaults.
    fn coefficient(&mut self, law: &str, written: &Scalar, scope: &mut Scope) -> Option<ExprId> {
        const HELP: &str = "the coefficient lies in [0, 1]";
        let expr = self.parameter_expression(written, scope, "the coefficient of a law")?;
        let symbols = self.pool.symbols(expr);
        let value = self.value_at_defaults(expr);
        let below = value < 0.0;
        let above = match self.pool.as_number(expr) {
            Some(exact) => *exact > Rational::from(1),
            None => value > 1.0,
        };
        if !below && !above {
            return Some(expr);
        }
        if !symbols.is_empty() {
            let names = self.names_of(&symbols);
            let defaults = if symbols.len() == 1 {
                "default"
            } else {
                "defaults"
            };
            let text = format!("`{written}` is {value} at the {defaults} of {names}");
            let help = format!("{HELP}; change it or the {defaults}");
            return self.refuse(written.at, text, &help);
        }
        if above {
            let help = format!("{HELP}; `elastic` keeps the energy");
            return self.refuse(written.at, format!("{law} {written} adds energy"), &help);
        }
        let text = format!("{law} {written} goes on into the wall");
        self.refuse(written.at, text, HELP)
    }

    /// Value of an expression of the parameters at their defaults; NaN if one of its parameters has none.
    fn value_at_defaults(&self, expr: ExprId) -> f64 {
        let default = |symbol: SymbolId| {
            let parameter = self
                .symbols
                .parameters
                .iter()
                .find(|parameter| parameter.symbol == symbol);
            parameter
                .and_then(|parameter| parameter.default)
                .map_or(f64::NAN, |default| self.constant_value(default))
        };
        self.pool
            .eval(&[expr], &default)
            .first()
            .copied()
            .unwrap_or(f64::NAN)
    }

    fn names_of(&self, symbols: &[SymbolId]) -> String {
        listed(symbols.iter().map(|symbol| self.pool.symbol_name(*symbol)))
    }
}

/// Remarks on properties that the laws of a model do not guarantee.
pub(super) fn notes(
    resolver: &Resolver<'_>,
    surfaces: &[Surface],
    constraints: &[Constraint],
) -> Vec<String> {
    let mut notes = Vec::new();
    let all = |surface: &'_ Surface| -> Vec<ExprId> {
        let constraints = constraints.iter().chain(&surface.instantaneous);
        constraints.map(|constraint| constraint.affine).collect()
    };
    let constrained = surfaces.iter().filter(|surface| !all(surface).is_empty());
    notes.extend(constrained.filter_map(plastic_note));
    let is_affine = |surface: &&Surface| {
        let mut parts = all(surface).into_iter();
        parts.any(|part| !resolver.pool.is_syntactic_zero(part))
    };
    notes.extend(surfaces.iter().filter(is_affine).filter_map(affine_note));
    notes.extend(coefficient_notes(resolver, surfaces));
    notes
}

/// `rho = dh(pi_D grad h)/dh(grad h)` lies in `[0, 1]`. After a law that multiplies the gap rate by a positive number,
/// the state still approaches the surface.
fn plastic_note(surface: &Surface) -> Option<String> {
    let (factor, approaches) = match surface.law {
        Law::NonholonomicPlastic => ("1 - 2 rho", "rho < 1/2"),
        Law::TotallyPlastic => ("1 - rho", "rho < 1"),
        Law::Elastic
        | Law::Restitution(_)
        | Law::Newton(_)
        | Law::ImpactPlastic
        | Law::Reset
        | Law::Stop
        | Law::Transition => {
            return None;
        }
    };
    let (law, name) = (surface.law.name(), &surface.name.display);
    Some(format!(
        "`{law}` multiplies the gap rate of `{name}` by {factor}, rho = dh(pi_D grad h)/dh(grad h): where {approaches} the state still approaches and the run ends; `impact_plastic` never does"
    ))
}

fn affine_note(surface: &Surface) -> Option<String> {
    let name = &surface.name.display;
    let text = format!(
        "`{name}` need not reverse the gap rate where constraints are affine; `newton` does"
    );
    matches!(surface.law, Law::Elastic | Law::Restitution(_)).then_some(text)
}

/// Remarks on coefficients that may leave `[0, 1]` under the assumptions of the parameters, one for each declaration.
fn coefficient_notes(resolver: &Resolver<'_>, surfaces: &[Surface]) -> Vec<String> {
    let mut notes: Vec<String> = Vec::new();
    for members in surfaces.chunk_by(|a, b| a.item == b.item) {
        let open = members.iter().find_map(|surface| {
            let coefficient = surface.law.coefficient()?;
            let range = range(&resolver.pool, coefficient, &resolver.symbols.parameters);
            (!range.is_within(0.0, 1.0)).then_some((surface, coefficient))
        });
        notes.extend(open.map(|(surface, coefficient)| {
            let name = &surface.name.display;
            let text = resolver.pool.text(coefficient);
            let help = parameter_of(resolver, coefficient).map_or(String::new(), |parameter| {
                format!("; declare `{} in [0, 1]`", parameter.name.field)
            });
            format!("the coefficient `{text}` of `{name}` is not known to lie in [0, 1] and checked when a state is made{help}")
        }));
    }
    notes
}

/// The parameter that is the whole expression; `None` for any other expression.
fn parameter_of<'r>(resolver: &'r Resolver<'_>, expr: ExprId) -> Option<&'r Parameter> {
    let is_it = |parameter: &&Parameter| match resolver.pool.node(expr) {
        dalembert_expr::Node::Symbol(symbol) => parameter.symbol == *symbol,
        _ => false,
    };
    resolver.symbols.parameters.iter().find(is_it)
}
