//! Functions that convert between the state reduced to D and velocities or momenta.

use dalembert_expr::ExprId;

use crate::mechanics::{Derivation, Frame};
use crate::model::Model;
use crate::program::kernel::{Arguments, Kernel};
use crate::program::{Function, Reduced, Value};

/// All functions of the reduced state; `None` without a frame.
pub fn reduced(model: &Model, derivation: &Derivation) -> Option<Reduced> {
    let frame = derivation.frame.as_ref().ok()?;
    Some(Reduced {
        momentum: momentum(model, derivation),
        quasi: quasi(model, derivation, frame),
        nearest_momenta: nearest(model, derivation, Arguments::Momenta),
        nearest_velocities: nearest(model, derivation, Arguments::Velocities),
    })
}

/// `(t, q, u) -> p = g (X_0 + X u) + A`
fn momentum(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Quasi);
    let outputs = kernel.momenta();
    kernel.finish(outputs)
}

/// `(t, q, qdot) -> alpha(qdot)`
fn quasi(model: &Model, derivation: &Derivation, frame: &Frame) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Velocities);
    let qdot = kernel.velocity();
    let outputs: Vec<Value> = frame
        .quasi
        .iter()
        .map(|quasi| {
            let form: &[ExprId] = &quasi.form;
            let form = kernel.values(form);
            kernel.dot(&form, &qdot)
        })
        .collect();
    kernel.finish(outputs)
}

/// The `u` of `G_D u = X^T (p - A - g X_0)`, from momenta, or from velocities with `p - A = g qdot`.
fn nearest(model: &Model, derivation: &Derivation, arguments: Arguments) -> Function {
    let mut kernel = Kernel::new(model, derivation, arguments);
    let kinetic = kernel.lowered_velocity();
    let outputs = kernel.nearest_quasi(&kinetic);
    kernel.finish(outputs)
}
