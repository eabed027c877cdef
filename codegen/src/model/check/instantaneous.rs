//! Instantaneous constraints hold at an impact and during the contact after it. Their one-forms must be independent of
//! the permanent constraints and of the differential of the gap.

use dalembert_expr::ExprId;

use super::super::form::{Dependence, OneForm};
use super::super::resolve::{Resolver, Scope};
use super::super::{Constraint, Surface};
use super::constraints::refuse_dependent;
use super::names::Names;
use crate::spec;

impl Resolver<'_> {
    /// The instantaneous constraints of a surface, families expanded; `None` if one was refused.
    pub(super) fn instantaneous(
        &mut self,
        surface: &spec::Surface,
        scope: &Scope,
    ) -> Option<Vec<Constraint>> {
        let errors = self.diagnostics.len();
        let mut constraints = Vec::new();
        let mut names = Names::new(self, "instantaneous constraint");
        for equation in &surface.instantaneous {
            let members = self.members_within(&equation.declared, scope);
            for (name, mut scope) in members {
                names.add(self, &name, &equation.declared.name);
                let dependence = Dependence::Linear("instantaneous constraints");
                let parts = self.constraint_form(equation, &mut scope, dependence)?;
                self.check_coefficients(equation, &parts, &scope);
                self.within_budget(equation.left.at.to(equation.right.at));
                let OneForm { form, affine, .. } = parts;
                constraints.push(Constraint {
                    name,
                    documentation: equation.documentation.clone(),
                    form,
                    affine,
                    level: None,
                    nonlinear: None,
                    is_of_positions: false,
                    item: equation.item,
                });
            }
        }
        names.check_families(self);
        (self.diagnostics.len() == errors).then_some(constraints)
    }
}

/// Refuses instantaneous constraints that follow from others, and those that determine the gap rate.
pub(super) fn check_independent(
    resolver: &mut Resolver<'_>,
    surfaces: &[Surface],
    constraints: &[Constraint],
) {
    let positions = resolver.symbols.positions();
    for surface in surfaces {
        if surface.instantaneous.is_empty() {
            continue;
        }
        let all: Vec<Constraint> = constraints
            .iter()
            .chain(&surface.instantaneous)
            .cloned()
            .collect();
        let mut rows: Vec<Vec<ExprId>> = all
            .iter()
            .map(|constraint| constraint.form.clone())
            .collect();
        let gradient = positions
            .iter()
            .map(|position| resolver.pool.diff(surface.gap, *position));
        rows.push(gradient.collect());
        let report = resolver.pool.rank(&rows);
        for (row, others) in &report.dependencies {
            let of_surface = |row: usize| row >= constraints.len();
            if *row < all.len() && of_surface(*row) {
                refuse_dependent(resolver, &all, *row, others);
            } else if let Some(last) = others.iter().rev().find(|other| of_surface(**other)) {
                refuse_blocking(resolver, surface, &all[*last]);
            }
        }
    }
}

/// An error at an instantaneous constraint that determines the gap rate.
fn refuse_blocking(resolver: &mut Resolver<'_>, surface: &Surface, constraint: &Constraint) {
    let (name, blocking) = (&surface.name.display, &constraint.name.display);
    let law = surface.law.name();
    let at = resolver.spec.location(constraint.item);
    let text =
        format!("`{blocking}` leaves nothing to `{law}`: it determines the gap rate of `{name}`");
    let help = "leave it out; `impact_plastic` stops the motion across a surface";
    resolver.refuse::<()>(at, text, help);
}
