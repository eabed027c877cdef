//! Functions of declared expressions: outputs, view, initial condition.

use dalembert_expr::ExprId;

use crate::mechanics::Derivation;
use crate::model::Model;
use crate::program::kernel::{Arguments, Kernel};
use crate::program::recipes::motion::energy_value;
use crate::program::{Form, Function, Value};

/// The declared outputs; `None` if there are none.
pub fn outputs(model: &Model, derivation: &Derivation, form: Form) -> Option<Function> {
    if model.outputs.is_empty() {
        return None;
    }
    let mut kernel = Kernel::new(model, derivation, form.state());
    let expressions: Vec<ExprId> = model.outputs.iter().map(|output| output.value).collect();
    bind_derived(&mut kernel, &expressions);
    let values = kernel.values(&expressions);
    Some(kernel.finish(values))
}

/// Binds the derived quantities that occur in the expressions.
fn bind_derived(kernel: &mut Kernel<'_>, expressions: &[ExprId]) {
    let model = kernel.model;
    let named = |symbol| {
        expressions
            .iter()
            .any(|&expression| model.pool.depends_on(expression, symbol))
    };
    if named(model.derived.energy) {
        let energy = energy_value(kernel);
        kernel.bind_value(model.derived.energy, energy);
    }
    if model.derived.momenta.iter().any(|&symbol| named(symbol)) {
        let momenta = kernel.momenta();
        for (&symbol, value) in model.derived.momenta.iter().zip(momenta) {
            kernel.bind_value(symbol, value);
        }
    }
    if model
        .derived
        .multipliers
        .iter()
        .any(|&symbol| named(symbol))
    {
        let multipliers = kernel.multipliers();
        for (&symbol, value) in model.derived.multipliers.iter().zip(multipliers) {
            kernel.bind_value(symbol, value);
        }
    }
}

/// A function of time and position with these results.
pub fn position_function(
    model: &Model,
    derivation: &Derivation,
    expressions: &[ExprId],
) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let values = kernel.values(expressions);
    kernel.finish(values)
}

/// The declared initial positions, then velocities. Undeclared values are 0.
pub fn initial(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let declared = model.initial.q.iter().chain(&model.initial.qdot);
    let values: Vec<Value> = declared
        .map(|value| match value {
            Some(expression) => kernel.value(*expression),
            None => kernel.builder.zero(),
        })
        .collect();
    kernel.finish(values)
}
