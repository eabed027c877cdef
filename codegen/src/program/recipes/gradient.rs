//! The gradient of `ln` of a density without a closed form, from its linear system.

use crate::claims::{Integral, Operation, Trace};
use crate::mechanics::Derivation;
use crate::model::Model;
use crate::program::expression::positive_power;
use crate::program::kernel::{Arguments, Kernel};
use crate::program::linear::{Ldlt, Orthogonal};
use crate::program::{Function, Guard, Value};

/// `(t, q) -> beta`: the covector with `beta(Z_b) = c_b` for vectors `Z_b` that span the tangent space. The vectors are
/// orthogonalised, as no choice of pivots is good everywhere.
pub fn gradient(model: &Model, derivation: &Derivation, integral: &Integral) -> Function {
    let system = &integral.gradient;
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let steps = carry_out(&mut kernel, &system.trace);
    let vectors: Vec<Vec<Value>> = system
        .vectors
        .iter()
        .map(|vector| vector.iter().map(|step| steps[step.index()]).collect())
        .collect();
    let builder = &mut kernel.builder;
    let shifts: Vec<Value> = system
        .demands
        .iter()
        .map(|step| builder.neg(steps[step.index()]))
        .collect();
    let n = vectors.len();
    let flat = Ldlt::identity(builder, n);
    // A guard that fails names the first constraint, because the vectors become dependent only where the constraint
    // forms or their frame do.
    let guard = |_, squared, reference| Guard::Constraint {
        constraint: 0,
        squared,
        reference,
    };
    let factors = Orthogonal::factor(builder, &flat, vectors.clone(), guard);
    let nothing = vec![builder.zero(); n];
    let weights = factors.solve(builder, &flat, nothing, &shifts);
    let mut beta = vec![builder.zero(); n];
    for (weight, vector) in weights.iter().zip(&vectors) {
        for (entry, component) in beta.iter_mut().zip(vector) {
            *entry = builder.add_product(*entry, *weight, *component);
        }
    }
    kernel.finish(beta)
}

/// The values of all steps.
fn carry_out(kernel: &mut Kernel<'_>, trace: &Trace) -> Vec<Value> {
    let mut values: Vec<Value> = Vec::with_capacity(trace.operations.len());
    for operation in &trace.operations {
        let value = match operation {
            Operation::Number(number) => kernel.builder.number(number.clone()),
            Operation::Symbol(symbol) => kernel.symbol(*symbol),
            Operation::Expression(id) => kernel.value(*id),
            Operation::Call(function, argument) => {
                let argument = kernel.value(*argument);
                kernel.builder.call(*function, argument)
            }
            Operation::Power(a, exponent) => {
                let (builder, base) = (&mut kernel.builder, values[a.index()]);
                let power = positive_power(builder, base, &exponent.abs());
                match exponent.is_negative() {
                    true => builder.reciprocal(power),
                    false => power,
                }
            }
            Operation::Add(a, b) => kernel.builder.add(values[a.index()], values[b.index()]),
            Operation::Sub(a, b) => kernel.builder.sub(values[a.index()], values[b.index()]),
            Operation::Mul(a, b) => kernel.builder.mul(values[a.index()], values[b.index()]),
            Operation::Inverse(a) => kernel.builder.reciprocal(values[a.index()]),
        };
        values.push(value);
    }
    values
}
