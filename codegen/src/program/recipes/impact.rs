//! Functions of the surfaces: gaps, gap rates, conditions, contacts.
//!
//! Let `y = L^{-1} dh`, and `y'` the remainder of `y` after projection orthogonal to the constraint columns. Then
//! `dh(grad h) = <y, y>`, `dh(pi_D grad h) = <y', y'>` and `pi_D^* dh = L y'`. These are sums of squares, without
//! cancellation for surfaces that are almost tangent to the constraints. On D, with `z = L_D^{-1} X^T dh` in the
//! factors of `G_D`, `dh(pi_D grad h) = <z, z>`, and an impulse changes the quasi-velocities along `G_D^{-1} X^T dh`.
//! The gap rate of a contact is computed from `dh`, because the other results need `dh` as well.

use dalembert_expr::ExprId;

use crate::mechanics::Derivation;
use crate::model::Model;
use crate::program::kernel::{Arguments, Kernel};
use crate::program::recipes::blow::blow;
use crate::program::recipes::declared::position_function;
use crate::program::recipes::instantaneous;
use crate::program::{Form, Function, Guard, Impacting, Input, Value};

/// All functions of the surfaces; `None` without surfaces.
pub fn impacting(model: &Model, derivation: &Derivation, form: Form) -> Option<Impacting> {
    if derivation.surfaces.is_empty() {
        return None;
    }
    let surfaces = 0..derivation.surfaces.len();
    let gaps = evaluate(model, derivation, Arguments::Position, |surface| {
        vec![surface.gap]
    });
    Some(Impacting {
        gaps,
        gap_alone: derivation
            .surfaces
            .iter()
            .map(|surface| position_function(model, derivation, &[surface.gap]))
            .collect(),
        gap_rates: evaluate(model, derivation, form.state(), |surface| {
            vec![surface.gap_rate]
        }),
        gap_accelerations: accelerations(model, derivation, form),
        gap_responses: responses(model, derivation, form),
        conditions: surfaces
            .clone()
            .map(|s| conditions(model, derivation, s))
            .collect(),
        contacts: match form {
            Form::FirstOrder => Vec::new(),
            _ if model.is_nonlinear() => Vec::new(),
            _ => {
                let contacts = surfaces.clone();
                let contacts = contacts.map(|s| contact(model, derivation, form, s));
                contacts.collect()
            }
        },
        blows: surfaces
            .map(|s| blow(model, derivation, form, s).filter(|_| !model.is_nonlinear()))
            .collect(),
        coefficients: model
            .surfaces
            .iter()
            .map(|surface| {
                let coefficient = surface.law.coefficient()?;
                Some(position_function(model, derivation, &[coefficient]))
            })
            .collect(),
        resets: (0..model.surfaces.len())
            .map(|s| reset(model, derivation, form, s))
            .collect(),
        entries: (0..model.surfaces.len())
            .map(|s| entry(model, derivation, form, s))
            .collect(),
        focuses: (0..model.surfaces.len())
            .map(|s| instantaneous::focus(model, derivation, form, s))
            .collect(),
        traces: (0..model.surfaces.len())
            .map(|s| instantaneous::trace(model, derivation, form, s))
            .collect(),
    })
}

/// The declared state in the mode that is entered; `None` if no state is declared.
fn entry(model: &Model, derivation: &Derivation, form: Form, s: usize) -> Option<Function> {
    let map = model.surfaces[s].transition.as_ref()?.map.as_ref()?;
    let mut kernel = Kernel::new(model, derivation, form.state());
    kernel.velocity();
    let expressions: Vec<ExprId> = map.expressions().collect();
    let outputs = kernel.values(&expressions);
    Some(kernel.finish(outputs))
}

fn reset(model: &Model, derivation: &Derivation, form: Form, s: usize) -> Option<Function> {
    let mut kernel = Kernel::new(model, derivation, form.state());
    let [q, qdot] = reset_values(&mut kernel, s)?;
    Some(kernel.finish([q, qdot].concat()))
}

/// Positions and velocities after the reset of a surface; `None` without a reset.
pub(super) fn reset_values(kernel: &mut Kernel<'_>, s: usize) -> Option<[Vec<Value>; 2]> {
    let model = kernel.model;
    let reset = model.surfaces[s].reset.as_ref()?;
    let symbols = model.coordinates.iter().map(|coordinate| coordinate.q);
    let before: Vec<Value> = symbols.map(|symbol| kernel.symbol(symbol)).collect();
    let velocities = kernel.velocity();
    let mut after = |values: &[Option<ExprId>], before: Vec<Value>| -> Vec<Value> {
        let pairs = values.iter().zip(before);
        pairs
            .map(|(value, before)| value.map_or(before, |value| kernel.value(value)))
            .collect()
    };
    Some([after(&reset.q, before), after(&reset.qdot, velocities)])
}

/// A function of the expressions `of` each surface.
fn evaluate(
    model: &Model,
    derivation: &Derivation,
    arguments: Arguments,
    of: impl Fn(&crate::mechanics::SurfaceForm) -> Vec<ExprId>,
) -> Function {
    let mut kernel = Kernel::new(model, derivation, arguments);
    let expressions: Vec<ExprId> = derivation.surfaces.iter().flat_map(of).collect();
    let outputs = kernel.values(&expressions);
    kernel.finish(outputs)
}

/// `d^2h/dt^2 = dh(qddot) + curvature`, with `qddot = X w + Xdot u + Xdot_0` or `qddot = g^{-1}(w - drift)`
fn accelerations(model: &Model, derivation: &Derivation, form: Form) -> Function {
    let mut kernel = Kernel::new(model, derivation, form.state());
    if form == Form::FirstOrder {
        return kernel.finish(Vec::new());
    }
    let motion = motion_rates(&mut kernel, form);
    let acceleration = acceleration(&mut kernel, form, &motion);
    let outputs = derivation
        .surfaces
        .iter()
        .map(|surface| {
            let form = kernel.values(&surface.form);
            let along = kernel.dot(&form, &acceleration);
            let curvature = kernel.value(surface.curvature);
            kernel.builder.add(along, curvature)
        })
        .collect();
    kernel.finish(outputs)
}

/// `qddot` for the rates `motion` of momenta or quasi-velocities
pub(super) fn acceleration(kernel: &mut Kernel<'_>, form: Form, motion: &[Value]) -> Vec<Value> {
    match form {
        Form::Global => {
            let drift = kernel.drift();
            let inertial: Vec<Value> = motion
                .iter()
                .zip(drift)
                .map(|(&w, d)| kernel.builder.sub(w, d))
                .collect();
            kernel.raise(&inertial)
        }
        Form::Reduced | Form::FirstOrder => {
            let steady = kernel.frame_acceleration();
            let changing = kernel.along_frame(motion);
            let pairs = steady.iter().zip(changing);
            pairs.map(|(&a, b)| kernel.builder.add(a, b)).collect()
        }
    }
}

/// `dh(X w)`, or `dh(g^{-1} w)`
fn responses(model: &Model, derivation: &Derivation, form: Form) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    if form == Form::FirstOrder {
        return kernel.finish(Vec::new());
    }
    let motion = motion_rates(&mut kernel, form);
    let velocity = match form {
        Form::Global => kernel.raise(&motion),
        Form::Reduced | Form::FirstOrder => kernel.along_frame(&motion),
    };
    let outputs = derivation
        .surfaces
        .iter()
        .map(|surface| {
            let form = kernel.values(&surface.form);
            kernel.dot(&form, &velocity)
        })
        .collect();
    kernel.finish(outputs)
}

pub(super) fn motion_rates(kernel: &mut Kernel<'_>, form: Form) -> Vec<Value> {
    let count = match form {
        Form::Global => kernel.dimension(),
        Form::Reduced => kernel.quasi_velocities(),
        Form::FirstOrder => 0,
    };
    (0..count)
        .map(|i| kernel.builder.input(Input::MotionRate(i)))
        .collect()
}

fn conditions(model: &Model, derivation: &Derivation, s: usize) -> Option<Function> {
    let surface = &derivation.surfaces[s];
    let signs = [&*surface.margins, &surface.kinks].concat();
    (!signs.is_empty()).then(|| position_function(model, derivation, &signs))
}

fn contact(model: &Model, derivation: &Derivation, form: Form, s: usize) -> Function {
    let mut kernel = Kernel::new(model, derivation, form.state());
    let contact = match form {
        Form::Global => contact_values(&mut kernel, s),
        Form::Reduced | Form::FirstOrder => reduced_contact_values(&mut kernel, s),
    };
    let [_, _, _, squared, _] = contact.scalars;
    kernel.builder.guard(Guard::Surface {
        surface: s,
        squared,
        reference: None,
    });
    kernel.finish([contact.scalars.to_vec(), contact.direction].concat())
}

/// Results of a contact.
pub(super) struct ContactValues {
    /// The numbers named by [`SCALARS`], in their order.
    pub scalars: [Value; 5],
    /// `pi_D^* dh`, or `G_D^{-1} X^T dh`
    pub direction: Vec<Value>,
}

/// Names of the numbers of a contact.
pub(super) const SCALARS: [&str; 5] = [
    "gap_rate",
    "constrained_rate",
    "surface_rate",
    "constrained_compliance",
    "free_compliance",
];

/// The contact of a surface in global form.
pub(super) fn contact_values(kernel: &mut Kernel<'_>, s: usize) -> ContactValues {
    let surface = &kernel.derivation.surfaces[s];
    let qdot = kernel.velocity();
    let form = kernel.values(&surface.form);
    let along = kernel.dot(&form, &qdot);
    let surface_rate = kernel.value(surface.rate);
    let gap_rate = kernel.builder.add(along, surface_rate);
    let free = kernel.forward(&form);
    let rest = kernel.without_constraints(free.clone());
    let rest = kernel.within_instantaneous(Form::Global, s, rest);
    let (compliances, direction) = kernel.with_ldlt(|builder, ldlt| {
        let compliances = [&rest, &free].map(|y| ldlt.inner(builder, y, y));
        (compliances, ldlt.lower_times(builder, &rest))
    });
    let constrained_rate = kernel.dot(&direction, &qdot);
    let [constrained, free] = compliances;
    kernel.name_by_coordinate(&direction, "direction_", "");
    let scalars = [gap_rate, constrained_rate, surface_rate, constrained, free];
    named(kernel, scalars, direction)
}

/// The contact of a surface in reduced form.
pub(super) fn reduced_contact_values(kernel: &mut Kernel<'_>, s: usize) -> ContactValues {
    let surface = &kernel.derivation.surfaces[s];
    let form = kernel.values(&surface.form);
    let restricted = kernel.restrict(&form);
    let surface_rate = kernel.value(surface.rate);
    let rest = kernel.with_reduced_ldlt(|builder, ldlt| ldlt.forward(builder, &restricted));
    let rest = kernel.within_instantaneous(Form::Reduced, s, rest);
    let (constrained, direction) = kernel.with_reduced_ldlt(|builder, ldlt| {
        let compliance = ldlt.inner(builder, &rest, &rest);
        (compliance, ldlt.backward(builder, &rest))
    });
    let free = kernel.forward(&form);
    let free = kernel.with_ldlt(|builder, ldlt| ldlt.inner(builder, &free, &free));
    let is_within_more = !surface.instantaneous.is_empty();
    let (along, constrained_rate) = if kernel.has_affine_constraints() || is_within_more {
        let qdot = kernel.velocity();
        let momenta = kernel.lower_vector(&qdot);
        let momenta = kernel.restrict(&momenta);
        (kernel.dot(&form, &qdot), kernel.dot(&direction, &momenta))
    } else {
        let u = kernel.quasi_inputs();
        let along = kernel.dot(&restricted, &u);
        (along, along)
    };
    let gap_rate = kernel.builder.add(along, surface_rate);
    let scalars = [gap_rate, constrained_rate, surface_rate, constrained, free];
    named(kernel, scalars, direction)
}

fn named(kernel: &mut Kernel<'_>, scalars: [Value; 5], direction: Vec<Value>) -> ContactValues {
    for (&value, name) in scalars.iter().zip(SCALARS) {
        kernel.builder.name(value, name);
    }
    ContactValues { scalars, direction }
}
