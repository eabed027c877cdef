//! The declared frame: one-forms that complete the constraints to a coframe.

use dalembert_expr::{ExprId, Pool};

use super::super::QuasiForm;
use super::super::degree::{at_zero, coefficients, degree_bound, has_degree, is_zero};
use super::super::resolve::{Resolver, Scope};
use super::super::{Constraint, Name};
use super::names::Names;
use crate::diagnostics::listed;
use crate::spec::Quantity;

const HELP: &str = "write `v: cos(theta)*d(x) + sin(theta)*d(y);`";

/// All quasi-velocities, families expanded.
pub(super) fn resolve(resolver: &mut Resolver<'_>) -> Vec<QuasiForm> {
    let spec = resolver.spec;
    let mut frame = Vec::new();
    let mut names = Names::new(resolver, "quasi-velocity");
    for entry in &spec.frame {
        for (name, mut scope) in resolver.members(&entry.declared) {
            names.add(resolver, &name, &entry.declared.name);
            resolver.check_not_a_velocity(entry, &name);
            let Some(form) = resolver.quasi_form(entry, &mut scope) else {
                continue;
            };
            for coefficient in &form {
                resolver.check_periodic(&[&entry.value], &scope, *coefficient);
            }
            frame.push(QuasiForm {
                name,
                documentation: entry.documentation.clone(),
                form,
                item: entry.item,
            });
        }
    }
    names.check_families(resolver);
    frame
}

impl Resolver<'_> {
    /// Refuses a quasi-velocity with the name of a coordinate.
    fn check_not_a_velocity(&mut self, entry: &Quantity, name: &Name) {
        let coordinates = &self.symbols.coordinates;
        if coordinates
            .iter()
            .any(|coordinate| coordinate.name.field == name.field)
        {
            let text = format!("`{}` is a coordinate", name.field);
            let help = "choose another name for the quasi-velocity";
            self.refuse::<()>(entry.declared.name.at, text, help);
        }
    }

    /// The one-form of a quasi-velocity: linear in differentials, or in velocities, with coefficients of `(t, q)`.
    fn quasi_form(&mut self, entry: &Quantity, scope: &mut Scope) -> Option<Vec<ExprId>> {
        let expr = self.expression(&entry.value, scope)?;
        self.forbid_inputs(&entry.value, scope, expr)?;
        let time = [self.symbols.time_differential];
        let text = "a quasi-velocity has no part along `t`: affine parts belong to constraints";
        self.forbid(&entry.value, scope, expr, &time, text, HELP)?;
        let (differentials, velocities) = (
            self.symbols.differentials.clone(),
            self.symbols.velocities(),
        );
        let has = |resolver: &Self, symbols: &[_]| resolver.pool.depends_on_any(expr, symbols);
        let by = match (has(self, &differentials), has(self, &velocities)) {
            (true, true) => {
                let help = "use either `d(..)` or `dot(..)` throughout";
                return self.refuse(entry.value.at, "`d(..)` and `dot(..)` in one form", help);
            }
            (true, false) => differentials,
            (false, true) => velocities,
            (false, false) => {
                return self.refuse(entry.value.at, "a quasi-velocity is a one-form", HELP);
            }
        };
        let is_linear = |pool: &mut Pool, expr: ExprId| has_degree(pool, expr, &by, 1);
        let rest = at_zero(&mut self.pool, expr, &by);
        if !is_linear(&mut self.pool, expr) || !is_zero(&self.pool, rest) {
            let nonlinear = |pool: &mut Pool, expr: ExprId| {
                degree_bound(pool, expr, &by).is_none_or(|degree| degree > 1)
            };
            let part = self.culprit(&entry.value, scope, &nonlinear);
            let text = format!("`{part}`: quasi-velocities are linear in velocities");
            return self.refuse(part.at, text, HELP);
        }
        self.forbid_abs(&entry.value, scope, expr, "`frame`")?;
        Some(coefficients(&mut self.pool, expr, &by))
    }
}

/// Refuses a frame that does not complete the constraints to a coframe.
pub(super) fn check_coframe(
    resolver: &mut Resolver<'_>,
    frame: &[QuasiForm],
    constraints: &[Constraint],
) {
    let Some(last) = frame.last() else { return };
    // Forms that were refused are missing from the count.
    if !resolver.diagnostics.is_empty() {
        return;
    }
    let (size, wanted) = (
        resolver.symbols.coordinates.len(),
        resolver.symbols.coordinates.len() - constraints.len(),
    );
    if frame.len() != wanted {
        let at = resolver.spec.location(last.item);
        let text = format!(
            "a frame of this model has {wanted} quasi-velocities, one for each of the {size} velocities that the {} \
             constraints leave; {} are declared",
            constraints.len(),
            frame.len()
        );
        let help = if frame.len() < wanted {
            "declare the others, or leave the frame out"
        } else {
            "leave some of them out"
        };
        resolver.refuse::<()>(at, text, help);
        return;
    }
    let constraint_rows = constraints.iter().map(|constraint| constraint.form.clone());
    let rows: Vec<Vec<ExprId>> = constraint_rows
        .chain(frame.iter().map(|entry| entry.form.clone()))
        .collect();
    let report = resolver.pool.rank(&rows);
    for (row, others) in &report.dependencies {
        let Some(entry) = row.checked_sub(constraints.len()).map(|i| &frame[i]) else {
            continue;
        };
        let named = others
            .iter()
            .map(|&other| match other.checked_sub(constraints.len()) {
                Some(i) => frame[i].name.display.as_str(),
                None => constraints[other].name.display.as_str(),
            });
        let text = match others.is_empty() {
            true => format!("the form of `{}` is zero", entry.name.display),
            false => format!(
                "`{}` is not independent: with the constraints it follows from {}",
                entry.name.display,
                listed(named)
            ),
        };
        let at = resolver.spec.location(entry.item);
        resolver.refuse::<()>(
            at,
            text,
            "declare a form that is independent of the constraints and of the others",
        );
    }
}
