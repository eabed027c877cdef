//! Constraints: one-forms that are independent and leave some motion.

use dalembert_expr::{Assumption as Known, ExprId, Rational};

use super::super::Constraint;
use super::super::form::{Dependence, OneForm};
use super::super::resolve::{Resolver, Scope};
use super::names::Names;
use crate::diagnostics::{Location, listed};
use crate::spec::Equation;

/// All constraints, families expanded. Also makes the symbols of their multipliers.
pub(super) fn resolve(resolver: &mut Resolver<'_>) -> Vec<Constraint> {
    let spec = resolver.spec;
    let mut constraints: Vec<Constraint> = Vec::new();
    let mut names = Names::new(resolver, "constraint");
    for equation in &spec.constraints {
        let members = resolver.members(&equation.declared);
        for (name, _) in &members {
            names.add(resolver, name, &equation.declared.name);
            resolver.multiplier_symbol(&name.display);
        }
        for (name, mut scope) in members {
            let Some(parts) = resolver.constraint_form(equation, &mut scope, Dependence::Any)
            else {
                break;
            };
            resolver.check_coefficients(equation, &parts, &scope);
            resolver.within_budget(equation.left.at.to(equation.right.at));
            let OneForm {
                form,
                affine,
                level,
                nonlinear,
                is_of_positions,
            } = parts;
            constraints.push(Constraint {
                name,
                documentation: equation.documentation.clone(),
                form,
                affine,
                level,
                nonlinear,
                is_of_positions,
                item: equation.item,
            });
        }
    }
    names.check_families(resolver);
    constraints
}

impl Resolver<'_> {
    /// A symbol for the multiplier of a constraint.
    fn multiplier_symbol(&mut self, name: &str) {
        let latex = format!(r"\lambda_{{\mathrm{{{}}}}}", name.replace('_', r"\_"));
        let symbol = self
            .pool
            .symbol(&format!("multiplier({name})"), &latex, Known::None);
        self.symbols.derived.multipliers.push(symbol);
        self.multipliers.insert(name.to_owned(), symbol);
    }

    /// Checks that the coefficients of a constraint are periodic in angles and differentiable.
    pub(super) fn check_coefficients(
        &mut self,
        equation: &Equation,
        parts: &OneForm,
        scope: &Scope,
    ) {
        let sides = [&equation.left, &equation.right];
        if let (true, Some(level)) = (parts.is_of_positions, parts.level) {
            self.check_periodic(&sides, scope, level);
        }
        for coefficient in parts.form.iter().chain([&parts.affine]) {
            self.check_periodic(&sides, scope, *coefficient);
        }
        for side in sides {
            let value = self.expression(side, &mut scope.clone());
            value.and_then(|value| {
                self.forbid_inputs(side, scope, value)?;
                self.forbid_abs(side, scope, value, "`constraints`")
            });
        }
    }
}

/// Refuses constraints that follow from those before them, and constraints that leave no motion.
pub(super) fn check_independent(resolver: &mut Resolver<'_>, constraints: &[Constraint]) {
    let rows: Vec<Vec<ExprId>> = constraints
        .iter()
        .map(|constraint| constraint.form.clone())
        .collect();
    if rows.is_empty() {
        return;
    }
    let size = resolver.symbols.coordinates.len();
    let report = resolver.pool.rank(&rows);
    for (row, others) in &report.dependencies {
        refuse_dependent(resolver, constraints, *row, others);
    }
    if report.dependencies.is_empty() && report.rank >= size {
        let last = &constraints[constraints.len() - 1];
        let at = resolver.spec.location(last.item);
        let text = format!("no motion is left: rank {} of {size}", report.rank);
        resolver.refuse::<()>(at, text, "leave a constraint out, or add coordinates");
    }
}

/// An error at a constraint that is a combination of others, and at each of those.
pub(super) fn refuse_dependent(
    resolver: &mut Resolver<'_>,
    constraints: &[Constraint],
    row: usize,
    others: &[usize],
) {
    let name = &constraints[row].name.display;
    let names: Vec<&str> = others
        .iter()
        .map(|other| constraints[*other].name.display.as_str())
        .collect();
    let relation = match others {
        [] => "`0`".to_owned(),
        [other] => match ratio(resolver, &constraints[row].form, &constraints[*other].form) {
            Some(ratio) => format!("`{}`: it is {ratio} times that form", names[0]),
            None => listed(names),
        },
        _ => listed(names),
    };
    let at = resolver.spec.location(constraints[row].item);
    let places: Vec<Location> = others
        .iter()
        .map(|other| resolver.spec.location(constraints[*other].item))
        .collect();
    let error = resolver
        .diagnostics
        .error(at, format!("`{name}` is dependent on {relation}"));
    error.help("leave one of them out");
    for place in places {
        error.also(place, format!("`{name}` is dependent on this one"));
    }
}

/// The quotient of two proportional forms, if it is a number.
fn ratio(resolver: &mut Resolver<'_>, form: &[ExprId], other: &[ExprId]) -> Option<Rational> {
    let pool = &mut resolver.pool;
    let column = other
        .iter()
        .position(|entry| !pool.is_syntactic_zero(*entry))?;
    let quotient = pool.div(form[column], other[column]);
    pool.as_number(quotient).cloned()
}
