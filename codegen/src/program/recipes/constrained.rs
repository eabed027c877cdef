//! Functions of the constraints: multipliers, residuals, forms, projections on momenta and positions.

use crate::mechanics::Derivation;
use crate::model::Model;
use crate::program::kernel::{Arguments, Kernel};
use crate::program::{Constrained, Form, Function, Input, Return, Value};

/// All functions of the constraints; `None` without constraints.
pub fn constrained(model: &Model, derivation: &Derivation, form: Form) -> Option<Constrained> {
    if derivation.constraints.is_empty() {
        return None;
    }
    Some(Constrained {
        can_lose_rank: derivation.can_lose_rank,
        multipliers: multipliers(model, derivation, form),
        residuals: residuals(model, derivation),
        forms: forms(model, derivation),
        return_to_constraints: (form == Form::Global).then(|| Return {
            nearest: project(model, derivation, Arguments::Velocities),
            restore: restore(model, derivation),
        }),
        levels: levels(model, derivation),
        level_scales: level_scales(model, derivation),
        level_correction: level_correction(model, derivation),
        reaction_force: reaction_force(model, derivation),
        constrained_velocity: constrained_velocity(model, derivation),
    })
}

fn multipliers(model: &Model, derivation: &Derivation, form: Form) -> Function {
    let mut kernel = Kernel::new(model, derivation, form.state());
    let outputs = kernel.multipliers();
    kernel.finish(outputs)
}

/// `eta^a(qdot) + eta^a_0` for all `a`, then the natural scale of each.
fn residuals(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Velocities);
    let residuals = derivation
        .constraints
        .iter()
        .map(|constraint| constraint.residual);
    let scales = derivation
        .constraints
        .iter()
        .map(|constraint| constraint.scale);
    let expressions: Vec<_> = residuals.chain(scales).collect();
    let outputs = kernel.values(&expressions);
    kernel.finish(outputs)
}

/// `eta` row by row, then `eta_0`. Constraints that are not linear in the velocities have forms that depend on the
/// given velocities.
fn forms(model: &Model, derivation: &Derivation) -> Function {
    let arguments = match model.is_nonlinear() {
        true => Arguments::Velocities,
        false => Arguments::Position,
    };
    let mut kernel = Kernel::new(model, derivation, arguments);
    let mut outputs = kernel.forms().concat();
    let affine: Vec<_> = derivation
        .constraints
        .iter()
        .map(|constraint| constraint.affine)
        .collect();
    outputs.extend(kernel.values(&affine));
    kernel.finish(outputs)
}

/// The `mu` of `m mu = -(eta(qdot) + eta_0)`: multipliers that lead to the nearest momenta on D*.
fn shift(kernel: &mut Kernel<'_>, kinetic: &[Value]) -> Vec<Value> {
    let affine: Vec<_> = kernel
        .derivation
        .constraints
        .iter()
        .map(|constraint| constraint.affine)
        .collect();
    let affine = kernel.values(&affine);
    kernel.constraint_solve(kinetic, &affine)
}

/// `lambda_a eta^a`
fn reaction_force(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let multipliers: Vec<Value> = (0..kernel.constraints())
        .map(|a| kernel.builder.input(Input::Multiplier(a)))
        .collect();
    let nothing = vec![kernel.builder.zero(); kernel.dimension()];
    let outputs = kernel.add_constraint_force(&nothing, &multipliers);
    kernel.finish(outputs)
}

/// `g^{-1} (p - A + mu_a eta^a)`, then `mu`.
fn constrained_velocity(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Momenta);
    let kinetic = kernel.lowered_velocity();
    let shift = shift(&mut kernel, &kinetic);
    let momenta = kernel.add_constraint_force(&kinetic, &shift);
    let mut outputs = kernel.raise(&momenta);
    outputs.extend(shift);
    kernel.finish(outputs)
}

/// `p + mu_a eta^a` with `m mu = -(eta(qdot) + eta_0)`: the nearest momenta on D*, in the metric. `arguments` are
/// momenta or velocities.
fn project(model: &Model, derivation: &Derivation, arguments: Arguments) -> Function {
    let mut kernel = Kernel::new(model, derivation, arguments);
    let kinetic = kernel.lowered_velocity();
    let shift = shift(&mut kernel, &kinetic);
    let momenta = kernel.momenta();
    let outputs = kernel.add_constraint_force(&momenta, &shift);
    kernel.finish(outputs)
}

/// The momenta with the dependent velocities computed from the independent ones, if the constraints are affine in the
/// velocities and a minor of the forms is regular everywhere; the nearest momenta otherwise.
///
/// The independent velocities, which integration computes accurately, are unchanged. An orthogonal projection would
/// carry the errors of the dependent velocities into the independent ones, and into the energy.
fn restore(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Momenta);
    let pairs = kernel.regular_minor().filter(|_| !model.is_nonlinear());
    let Some(pairs) = pairs else {
        return project(model, derivation, Arguments::Momenta);
    };
    let before = kernel.velocity();
    let mut qdot = before.clone();
    let forms = kernel.forms();
    for &(a, j) in &pairs {
        let mut rest = kernel.value(derivation.constraints[a].affine);
        for (i, &component) in forms[a].iter().enumerate().filter(|(i, _)| *i != j) {
            rest = kernel.builder.add_product(rest, component, qdot[i]);
        }
        let solved = kernel.builder.div(rest, forms[a][j]);
        qdot[j] = kernel.builder.neg(solved);
    }
    let changes: Vec<(usize, Value)> = pairs
        .iter()
        .map(|&(_, j)| (j, kernel.builder.sub(qdot[j], before[j])))
        .collect();
    let outputs = (0..kernel.dimension())
        .map(|i| {
            let momentum = kernel.builder.input(Input::Momentum(i));
            changes.iter().fold(momentum, |momentum, &(j, change)| {
                let weight = kernel.value(model.lagrangian.metric[i][j]);
                kernel.builder.add_product(momentum, weight, change)
            })
        })
        .collect();
    kernel.finish(outputs)
}

fn levels(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let levels: Vec<_> = derivation
        .constraints
        .iter()
        .filter_map(|constraint| constraint.level)
        .collect();
    let outputs = kernel.values(&levels);
    kernel.finish(outputs)
}

/// The natural scales of levels that are declared to be 0, and 0 for other levels; `None` if no level has a scale.
fn level_scales(model: &Model, derivation: &Derivation) -> Option<Function> {
    let mut levelled = derivation
        .constraints
        .iter()
        .filter(|constraint| constraint.level.is_some());
    levelled
        .clone()
        .find_map(|constraint| constraint.level_scale)?;
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let zero = kernel.builder.zero();
    let outputs = levelled
        .by_ref()
        .map(|constraint| {
            constraint
                .level_scale
                .map_or(zero, |scale| kernel.value(scale))
        })
        .collect();
    Some(kernel.finish(outputs))
}

/// `g^{-1} nu_k eta^k` with `m nu = -excess`, over the integrable constraints with a known level.
fn level_correction(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let n = kernel.dimension();
    let which: Vec<usize> = derivation.levelled().collect();
    let zero = kernel.builder.zero();
    let mut covector = vec![zero; n];
    if !which.is_empty() {
        let excess: Vec<Value> = (0..which.len())
            .map(|k| kernel.builder.input(Input::Excess(k)))
            .collect();
        let weights = kernel.partial_solve(&which, &excess);
        for (&a, &weight) in which.iter().zip(&weights) {
            let form = kernel.values(&derivation.constraints[a].form);
            for (entry, &component) in covector.iter_mut().zip(&form) {
                *entry = kernel.builder.add_product(*entry, weight, component);
            }
        }
        covector = kernel.raise(&covector);
    }
    kernel.finish(covector)
}
