//! The motion: rate, velocity, momentum, energy.

use dalembert_expr::{ExprId, Rational};

use crate::mechanics::Derivation;
use crate::model::Model;
use crate::program::kernel::{Arguments, Kernel};
use crate::program::{Form, Function, Op, Value};

/// `(t, q, p) -> (qdot, pdot)`: `qdot = g^{-1}(p - A)`, `pdot = f + lambda_a eta^a`; or `(t, q, u) -> (qdot, udot)`; or
/// `(t, q) -> qdot`.
pub fn rate(model: &Model, derivation: &Derivation, form: Form) -> Function {
    let kernel = || Kernel::new(model, derivation, form.state()).without_multipliers();
    let solved = rate_of(kernel(), form);
    match form {
        Form::Global | Form::FirstOrder => solved,
        Form::Reduced => shorter(solved, rate_of(kernel().written_out(), form)),
    }
}

fn rate_of(mut kernel: Kernel<'_>, form: Form) -> Function {
    let mut outputs = kernel.velocity();
    outputs.extend(match form {
        Form::Global => momentum_rate(&mut kernel),
        Form::Reduced => kernel.quasi_rate(),
        Form::FirstOrder => Vec::new(),
    });
    kernel.finish(outputs)
}

/// The function with fewer operations.
fn shorter(first: Function, second: Function) -> Function {
    match second.cost.total() < first.cost.total() {
        true => second,
        false => first,
    }
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

/// `(t, q) -> 1, .., g_ii`, or the units of positions and quasi-velocities in reduced form, or ones in first-order
/// form.
pub fn scale(model: &Model, derivation: &Derivation, form: Form) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let n = kernel.dimension();
    let units: Vec<ExprId> = match (form, &derivation.frame) {
        (Form::Reduced, Ok(frame)) => {
            let norms = frame.quasi.iter().map(|quasi| quasi.norm);
            frame.position_units.iter().copied().chain(norms).collect()
        }
        (Form::FirstOrder, _) => vec![model.pool.one(); n],
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
    let of = |mut kernel: Kernel<'_>| {
        let outputs = kernel.velocity();
        kernel.finish(outputs)
    };
    let solved = of(Kernel::new(model, derivation, form.state()));
    match form {
        Form::Global | Form::FirstOrder => solved,
        Form::Reduced => {
            let kernel = Kernel::new(model, derivation, form.state());
            shorter(solved, of(kernel.written_out()))
        }
    }
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

/// Number of operations below which the energy may be computed from the momenta, without a call of the function of the
/// velocities.
const REPEATED: usize = 100;

/// `(t, q, p) -> 1/2 (p - A).qdot + V`, or `(t, q, u) -> 1/2 g(qdot, qdot) + V`, by the formula with the fewest
/// operations. Often `G_D` depends on fewer coordinates than the velocities do.
pub fn energy(model: &Model, derivation: &Derivation, form: Form) -> Function {
    let mut kernel = Kernel::new(model, derivation, form.state_with_velocity());
    let energy = energy_value(&mut kernel);
    let whole = kernel.finish(vec![energy]);
    let by_formula = |way: fn(&mut Kernel<'_>) -> Option<Value>| {
        let mut kernel = Kernel::new(model, derivation, form.state());
        let doubled = way(&mut kernel)?;
        let energy = total_energy(&mut kernel, doubled);
        Some(kernel.finish(vec![energy]))
    };
    let (called, others) = match form {
        Form::Global => {
            let short =
                by_formula(from_momenta).filter(|function| function.cost.total() < REPEATED);
            let called = velocity(model, derivation, form).cost.total();
            (called, [short, None])
        }
        Form::FirstOrder => (0, [None, None]),
        Form::Reduced => (
            0,
            [
                by_formula(|kernel| kernel.known_doubled_kinetic()),
                by_formula(on_d),
            ],
        ),
    };
    let fewest = others
        .into_iter()
        .flatten()
        .min_by_key(|function| function.cost.total());
    match fewest {
        Some(function) if function.cost.total() < whole.cost.total() + called => function,
        _ => whole,
    }
}

/// `y^T D^{-1} y` with `y = L^{-1} (p - A)`
fn from_momenta(kernel: &mut Kernel<'_>) -> Option<Value> {
    let momenta = kernel.lowered_velocity();
    let y = kernel.forward(&momenta);
    Some(kernel.with_ldlt(|builder, ldlt| ldlt.weighted_square(builder, &y)))
}

/// `u^T G_D u`; `None` if a constraint has an affine part.
fn on_d(kernel: &mut Kernel<'_>) -> Option<Value> {
    if kernel.has_affine_constraints() {
        return None;
    }
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
    Some(doubled)
}

/// Half of `doubled` plus the potential energy. A factor of one half that both have is applied once.
fn total_energy(kernel: &mut Kernel<'_>, doubled: Value) -> Value {
    let potential = kernel.value(kernel.model.lagrangian.potential);
    let half = kernel.builder.number(Rational::HALF);
    if let Op::Mul(a, b) = *kernel.builder.op(potential)
        && (a == half || b == half)
    {
        let rest = if a == half { b } else { a };
        let sum = kernel.builder.add(doubled, rest);
        return kernel.builder.mul(half, sum);
    }
    let kinetic = kernel.builder.mul(half, doubled);
    kernel.builder.name(kinetic, "kinetic");
    kernel.builder.add(kinetic, potential)
}

/// Kinetic plus potential energy.
pub(super) fn energy_value(kernel: &mut Kernel<'_>) -> Value {
    let doubled = doubled_kinetic(kernel);
    total_energy(kernel, doubled)
}

/// `(p - A).qdot`
fn doubled_kinetic(kernel: &mut Kernel<'_>) -> Value {
    let qdot = kernel.velocity();
    let momenta = kernel.lowered_velocity();
    kernel.dot(&momenta, &qdot)
}
