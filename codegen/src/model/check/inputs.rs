//! Inputs may act in forces, rates and the running cost only. Expressions that are differentiated, or that decide where
//! motion is allowed, must be known.

use dalembert_expr::ExprId;

use super::super::resolve::{Resolver, Scope};
use super::super::{Force, Parameter, Parts, Scene};
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

/// Functions in which inputs may act.
pub(super) struct Acted<'a> {
    /// The forces, of which a scene uses some.
    pub forces: &'a [Force],
    /// The rates of a `field`, which belong to every scene.
    pub field: &'a [ExprId],
}

/// Refuses claims that hold for constant inputs but may fail for inputs that depend on the state: in the model, and in
/// scenes with a force or a rate in which an input acts.
pub(super) fn check_claims(resolver: &mut Resolver<'_>, acted: &Acted<'_>, scenes: &[Scene]) {
    let spec = resolver.spec;
    let Some(first) = spec.inputs.first() else {
        return;
    };
    let may_depend = |name: &str| format!("`{name}` may depend on the state");
    for claim in &spec.claims {
        if matches!(claim.statement, Statement::Conserved { .. }) {
            continue;
        }
        let input = match &claim.scene {
            None => Some(first.declared.name.text.clone()),
            Some(name) => scenes
                .iter()
                .find(|scene| scene.name == name.text)
                .and_then(|scene| resolver.acting_input(acted, &scene.parts)),
        };
        if let Some(input) = input {
            let because = may_depend(&input);
            let text =
                format!("{because}: only claims of conserved quantities are allowed with inputs");
            resolver.refuse::<()>(spec.location(claim.item), text, "write `conserved: ..;`");
        }
    }
    for scene in scenes.iter().filter(|scene| scene.parts.extras.volume) {
        let Some(input) = resolver.acting_input(acted, &scene.parts) else {
            continue;
        };
        let declared = spec
            .scenes
            .iter()
            .find(|declared| declared.name.text == scene.name);
        let volume = declared.map(|declared| {
            let mut parts = declared.parts.iter();
            let part = parts.find(|part| part.name.text == "volume");
            part.map_or(declared.name.at, |part| part.name.at)
        });
        if let Some(at) = volume {
            let text = format!("{}: no volume is known with inputs", may_depend(&input));
            resolver.refuse::<()>(at, text, "leave it out");
        }
    }
}

impl Resolver<'_> {
    /// The first input that acts in a scene.
    fn acting_input(&self, acted: &Acted<'_>, parts: &Parts) -> Option<String> {
        let inputs = self
            .symbols
            .parameters
            .iter()
            .filter(|parameter| parameter.is_input);
        let acts = |input: &&Parameter| {
            let used = parts
                .forces
                .iter()
                .filter_map(|&force| acted.forces.get(force));
            let mut functions = used.flat_map(|force| &force.form).chain(acted.field);
            functions.any(|expr| self.pool.depends_on(*expr, input.symbol))
        };
        let mut acting = inputs.filter(acts);
        acting.next().map(|input| input.name.display.clone())
    }
}
