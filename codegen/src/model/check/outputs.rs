//! The declared view and outputs.

use super::super::resolve::{DerivedNames, Resolver, Scope};
use super::super::{Output, View};
use super::names::Names;
use crate::spec::{INTEGRAL, Scalar, ScalarKind};

/// The declared view, if it has a path.
pub(super) fn view(resolver: &mut Resolver<'_>) -> Option<View> {
    let written = &resolver.spec.view;
    let mut scope = Scope::default();
    let region = written.region.as_ref();
    let region = region.map(|region| resolver.difference(region, &mut scope, "regions"));
    let Some([first, second]) = &written.path else {
        if let Some(region) = &written.region {
            resolver.refuse::<()>(
                region.at,
                "a `view` needs a `path`",
                "write `path: (x, y);`",
            );
        }
        return None;
    };
    let path = [first, second]
        .map(|component| resolver.position_expression(component, &mut scope, "views"));
    let [Some(x), Some(y)] = path else {
        return None;
    };
    let plane = match [x, y].map(|component| resolver.coordinate_index(component)) {
        [Some(x), Some(y)] => Some([x, y]),
        _ => None,
    };
    Some(View {
        path: [x, y],
        labels: [first.to_string(), second.to_string()],
        plane,
        region: region.flatten(),
    })
}

/// All outputs, families expanded. They may name derived quantities.
pub(super) fn resolve(resolver: &mut Resolver<'_>) -> Vec<Output> {
    let spec = resolver.spec;
    let mut outputs = Vec::new();
    let mut names = Names::new(resolver, "output");
    resolver.derived_names = DerivedNames::Outputs;
    for output in &spec.outputs {
        for (name, mut scope) in resolver.members(&output.declared) {
            names.add(resolver, &name, &output.declared.name);
            let (written, is_integral) = match integrand(&output.value) {
                Some(integrand) => (integrand, true),
                None => (&output.value, false),
            };
            let Some(value) = resolver.expression(written, &mut scope) else {
                break;
            };
            let differentials = resolver.symbols.all_differentials();
            let text = "an output contains no differentials";
            let kept = resolver.forbid(
                written,
                &scope,
                value,
                &differentials,
                text,
                "velocities are written `dot(x)`",
            );
            if kept.is_some() {
                outputs.push(Output {
                    name,
                    documentation: output.documentation.clone(),
                    value,
                    is_integral,
                    item: output.item,
                });
            }
        }
    }
    names.check_families(resolver);
    outputs
}

/// The expression of an output that is an integral: `e` of `integral(e)`.
fn integrand(written: &Scalar) -> Option<&Scalar> {
    match &written.kind {
        ScalarKind::Call(function, arguments) if function.text == INTEGRAL => {
            match &arguments[..] {
                [integrand] => Some(integrand),
                _ => None,
            }
        }
        _ => None,
    }
}
