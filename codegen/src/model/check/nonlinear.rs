//! Constraints that are not linear in the velocities, whose forces follow Chetaev's rule.
//!
//! Declarations that are supported for linear constraints only are refused beside them: frames, impact laws, volumes,
//! and claims other than conserved quantities and invariant forms.

use super::super::Constraint;
use super::super::resolve::Resolver;
use crate::spec::{Declared, RESET, STOP, Statement};

/// Refuses declarations that are supported for linear constraints only.
pub(super) fn check_alone(resolver: &mut Resolver<'_>, constraints: &[Constraint]) {
    let Some(first) = constraints
        .iter()
        .find(|constraint| constraint.nonlinear.is_some())
    else {
        return;
    };
    let (spec, name) = (resolver.spec, &first.name.display);
    let because = format!("`{name}` is not linear in the velocities");
    if let Some(Declared { name: at, .. }) = spec.frame.first().map(|entry| &entry.declared) {
        let text = format!("{because}: no frame reduces it");
        resolver.refuse::<()>(at.at, text, "leave the frame out");
    }
    for surface in &spec.surfaces {
        let law = surface.law.as_ref();
        if law.is_some_and(|law| [RESET, STOP].contains(&law.name.text.as_str())) {
            continue;
        }
        let at = law.map_or(surface.declared.name.at, |law| law.name.at);
        let surface = &surface.declared.name.text;
        let text = format!("{because}: no impact law is defined at `{surface}`");
        let help = "write `=> reset { dot(x) = ..; }` with velocities that satisfy it";
        resolver.refuse::<()>(at, text, help);
    }
    for part in spec.scenes.iter().flat_map(|scene| &scene.parts) {
        if part.name.text == "volume" {
            let text = format!("{because}: no volume is known for it");
            resolver.refuse::<()>(part.name.at, text, "leave it out");
        }
    }
    for claim in &spec.claims {
        let is_examined = matches!(
            claim.statement,
            Statement::Conserved { .. } | Statement::Symplectic | Statement::Invariant(_)
        );
        if !is_examined {
            let text =
                format!("{because}: only conserved quantities and invariant forms can be claimed");
            let at = spec.location(claim.item);
            let help = "claim `conserved: ..;`, `invariant: ..;` or nothing";
            resolver.refuse::<()>(at, text, help);
        }
    }
}

/// Remarks on the forces of such constraints.
pub(super) fn notes(constraints: &[Constraint]) -> impl Iterator<Item = String> + '_ {
    let nonlinear = constraints
        .iter()
        .filter(|constraint| constraint.nonlinear.is_some());
    nonlinear.map(|constraint| {
        let name = &constraint.name.display;
        format!(
            "`{name}` is not linear in the velocities: its force is a multiple of the derivative of the constraint with respect to the velocities (Chetaev's rule)"
        )
    })
}
