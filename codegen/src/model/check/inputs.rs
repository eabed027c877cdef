//! Inputs act in forces and rates only: what is differentiated, or decides where motion is allowed, has to be known.

use dalembert_expr::ExprId;

use super::super::resolve::{Resolver, Scope};
use crate::spec::{Scalar, Statement};

impl Resolver<'_> {
    /// Refuses inputs in an expression.
    pub(in crate::model) fn forbid_inputs(
        &mut self,
        written: &Scalar,
        scope: &Scope,
        expr: ExprId,
    ) -> Option<()> {
        let inputs = self.symbols.inputs();
        let text = "an input acts in `forces`, and in the rates of a `field`";
        let help = "write a force: `push: u*d(x);`";
        self.forbid(written, scope, expr, &inputs, text, help)
    }
}

/// Refuses what holds for inputs that are held, and need not for those that depend on the state.
pub(super) fn check_claims(resolver: &mut Resolver<'_>) {
    let spec = resolver.spec;
    let Some(first) = spec.inputs.first() else {
        return;
    };
    let because = format!("`{}` may depend on the state", first.declared.name.text);
    for claim in &spec.claims {
        if !matches!(claim.statement, Statement::Conserved { .. }) {
            let text = format!("{because}: only conserved quantities are claimed beside inputs");
            let at = spec.location(claim.item);
            resolver.refuse::<()>(at, text, "write `conserved: ..;`");
        }
    }
    for part in spec.scenes.iter().flat_map(|scene| &scene.parts) {
        if part.name.text == "volume" {
            let text = format!("{because}: no volume is known beside inputs");
            resolver.refuse::<()>(part.name.at, text, "leave it out");
        }
    }
}
