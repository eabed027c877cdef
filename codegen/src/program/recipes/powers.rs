//! Powers that change the energy, by cause: named forces, constraints that do work, and the explicit dependence of the
//! Lagrangian on time.
//!
//! Along the motion `d/dt (1/2 g(qdot, qdot) + V) = sum_a F_a(qdot) + lambda_a eta^a(qdot) - d_t L`, where `d_t` is
//! taken at fixed position and velocity. Only constraints that are affine or nonlinear in the velocities may do work.

use crate::mechanics::Derivation;
use crate::model::Model;
use crate::program::kernel::Kernel;
use crate::program::{Form, Powers, Value};

/// The powers by cause; `None` without named forces.
pub fn powers(model: &Model, derivation: &Derivation, form: Form) -> Option<Powers> {
    if model.forces.is_empty() || form == Form::FirstOrder {
        return None;
    }
    let mut kernel = Kernel::new(model, derivation, form.state());
    let qdot = kernel.velocity();
    let mut names: Vec<String> = Vec::new();
    let mut values: Vec<Value> = Vec::new();
    for force in &model.forces {
        let covector = kernel.values(&force.form);
        names.push(force.name.display.clone());
        values.push(kernel.dot(&covector, &qdot));
    }
    if kernel.has_affine_constraints() {
        let multipliers = kernel.multipliers();
        let nothing = vec![kernel.builder.zero(); kernel.dimension()];
        let reaction = kernel.add_constraint_force(&nothing, &multipliers);
        names.push("constraints".to_owned());
        values.push(kernel.dot(&reaction, &qdot));
    }
    let by_time = derivation.field.by_time;
    if !model.pool.is_syntactic_zero(by_time) {
        let value = kernel.value(by_time);
        names.push("time".to_owned());
        values.push(kernel.builder.neg(value));
    }
    Some(Powers {
        names,
        function: kernel.finish(values),
    })
}
