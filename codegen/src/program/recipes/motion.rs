//! The motion: rate, velocity, momentum, energy.

use crate::mechanics::Derivation;
use crate::model::Model;
use crate::program::kernel::{Arguments, Kernel};
use crate::program::{Function, Value};

/// `(t, q, p) -> (qdot, pdot)`: `qdot = g^{-1}(p - A)`, `pdot = f + lambda_a eta^a`.
pub fn rate(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Momenta);
    let mut outputs = kernel.velocity();
    outputs.extend(momentum_rate(&mut kernel));
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

/// `(t, q) -> g_ii`
pub fn scale(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let diagonal: Vec<_> = (0..kernel.dimension())
        .map(|i| model.lagrangian.metric[i][i])
        .collect();
    let outputs = kernel.values(&diagonal);
    kernel.finish(outputs)
}

/// `(t, q, p) -> qdot`
pub fn velocity(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Momenta);
    let outputs = kernel.velocity();
    kernel.finish(outputs)
}

/// `(t, q, qdot) -> p = g qdot + A`
pub fn momentum(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Velocities);
    let kinetic = kernel.lowered_velocity();
    let linear = kernel.values(&model.lagrangian.linear);
    let outputs: Vec<Value> = kinetic
        .iter()
        .zip(linear)
        .map(|(&p, a)| kernel.builder.add(p, a))
        .collect();
    kernel.name_by_coordinate(&outputs, "p_", "");
    kernel.finish(outputs)
}

/// `(t, q, p) -> 1/2 (p - A).qdot + V`
pub fn energy(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Both);
    let energy = energy_value(&mut kernel);
    kernel.finish(vec![energy])
}

/// Kinetic plus potential energy.
pub(super) fn energy_value(kernel: &mut Kernel<'_>) -> Value {
    let qdot = kernel.velocity();
    let momenta = kernel.lowered_velocity();
    let doubled = kernel.dot(&momenta, &qdot);
    let half = kernel.builder.number(dalembert_expr::Rational::new(1, 2));
    let kinetic = kernel.builder.mul(half, doubled);
    kernel.builder.name(kinetic, "kinetic");
    let potential = kernel.value(kernel.model.lagrangian.potential);
    kernel.builder.add(kinetic, potential)
}
