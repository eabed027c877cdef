//! The motion: rate, velocity, momentum, energy.

use dalembert_expr::ExprId;

use crate::mechanics::Derivation;
use crate::model::Model;
use crate::program::kernel::{Arguments, Kernel};
use crate::program::{Form, Function, Value};

/// `(t, q, p) -> (qdot, pdot)`: `qdot = g^{-1}(p - A)`, `pdot = f + lambda_a eta^a`; or `(t, q, u) -> (qdot, udot)`.
pub fn rate(model: &Model, derivation: &Derivation, form: Form) -> Function {
    let mut kernel = Kernel::new(model, derivation, form.state());
    let mut outputs = kernel.velocity();
    outputs.extend(match form {
        Form::Global => momentum_rate(&mut kernel),
        Form::Reduced => kernel.quasi_rate(),
    });
    kernel.finish(outputs)
}

/// `pdot`
pub(super) fn momentum_rate(kernel: &mut Kernel<'_>) -> Vec<Value> {
    let force = kernel.force();
    let rate = if kernel.constraints() == 0 {
        force
    } else {
        let multipliers = kernel.multipliers();
        kernel.add_constraint_force(&force, &multipliers)
    };
    kernel.name_by_coordinate(&rate, "p_", "_dot");
    rate
}

/// `(t, q) -> 1, .., g_ii`, or the units of positions and quasi-velocities in reduced form.
pub fn scale(model: &Model, derivation: &Derivation, form: Form) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let n = kernel.dimension();
    let units: Vec<ExprId> = match (form, &derivation.frame) {
        (Form::Reduced, Ok(frame)) => {
            let norms = frame.quasi.iter().map(|quasi| quasi.norm);
            frame.position_units.iter().copied().chain(norms).collect()
        }
        _ => {
            let one = model.pool.one();
            let diagonal = (0..n).map(|i| model.lagrangian.metric[i][i]);
            std::iter::repeat_n(one, n).chain(diagonal).collect()
        }
    };
    let outputs = kernel.values(&units);
    kernel.finish(outputs)
}

/// `(t, q, p) -> qdot`, or `(t, q, u) -> qdot`
pub fn velocity(model: &Model, derivation: &Derivation, form: Form) -> Function {
    let mut kernel = Kernel::new(model, derivation, form.state());
    let outputs = kernel.velocity();
    kernel.finish(outputs)
}

/// `(t, q, qdot) -> p = g qdot + A`
pub fn momentum(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Velocities);
    let outputs = kernel.momenta();
    kernel.finish(outputs)
}

/// `(t, q, qdot) -> dL/dq + F`
pub fn force(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Velocities);
    let outputs = kernel.force();
    kernel.finish(outputs)
}

/// `(t, q, p) -> 1/2 (p - A).qdot + V`, or `(t, q, u) -> 1/2 g(qdot, qdot) + V`
pub fn energy(model: &Model, derivation: &Derivation, form: Form) -> Function {
    let mut kernel = Kernel::new(model, derivation, form.state_with_velocity());
    let is_metric_enough = form == Form::Reduced && !kernel.has_affine_constraints();
    let energy = energy_value(&mut kernel);
    let whole = kernel.finish(vec![energy]);
    if !is_metric_enough {
        return whole;
    }
    // Of the two ways the one that takes fewer operations: often `G_D` depends on less than the velocities do.
    let mut kernel = Kernel::new(model, derivation, Arguments::Quasi);
    let energy = energy_on_d(&mut kernel);
    let reduced = kernel.finish(vec![energy]);
    match reduced.cost.total() < whole.cost.total() {
        true => reduced,
        false => whole,
    }
}

/// `u^T G_D u/2 + V`, where no constraint has an affine part.
fn energy_on_d(kernel: &mut Kernel<'_>) -> Value {
    let u = kernel.quasi_inputs();
    let metric = kernel.reduced_metric();
    let builder = &mut kernel.builder;
    let two = builder.integer(2);
    let mut doubled = builder.zero();
    for (i, row) in metric.iter().enumerate() {
        let mut beside = builder.zero();
        for (&entry, &other) in row[..i].iter().zip(&u) {
            beside = builder.add_product(beside, entry, other);
        }
        let beside = builder.mul(two, beside);
        let row_sum = builder.add_product(beside, row[i], u[i]);
        doubled = builder.add_product(doubled, row_sum, u[i]);
    }
    total_energy(kernel, doubled)
}

/// Half of this plus the potential energy.
fn total_energy(kernel: &mut Kernel<'_>, doubled: Value) -> Value {
    let half = kernel.builder.number(dalembert_expr::Rational::new(1, 2));
    let kinetic = kernel.builder.mul(half, doubled);
    kernel.builder.name(kinetic, "kinetic");
    let potential = kernel.value(kernel.model.lagrangian.potential);
    kernel.builder.add(kinetic, potential)
}

/// Kinetic plus potential energy.
pub(super) fn energy_value(kernel: &mut Kernel<'_>) -> Value {
    let qdot = kernel.velocity();
    let momenta = kernel.lowered_velocity();
    let doubled = kernel.dot(&momenta, &qdot);
    total_energy(kernel, doubled)
}
