//! The impulse of a surface by its declared law: `size * direction`, added to the state's momenta or quasi-velocities,
//! and the share of the gap rate that it removes.
//!
//! Let `z` be any multiple of `X^T dh`, and `d = G_D^{-1} z`. For laws with a constant share, the impulse of a wall at
//! rest is `-share (z . u)/(z . d) d`. Without constraints, `z` is a multiple of `dh` and also the direction. If the
//! metric is a multiple of the identity along `z`, that multiple cancels. In all other cases (other laws, constraints
//! without a frame, affine or instantaneous constraints, moving walls) the impulse is computed from all values of the
//! [contact](super::impact).

use dalembert_expr::{ExprId, Rational, Sign};

use super::impact::{ContactValues, contact_values, reduced_contact_values};
use crate::mechanics::Derivation;
use crate::model::{Law, Model};
use crate::program::kernel::Kernel;
use crate::program::{Form, Function, Guard, Value};

/// `(t, state) -> size, share, direction` of surface `s`; `None` if its law is no impulse. Of several formulas, the one
/// with the fewest operations is used.
pub(super) fn blow(
    model: &Model,
    derivation: &Derivation,
    form: Form,
    s: usize,
) -> Option<Function> {
    let new = || Kernel::new(model, derivation, form.state());
    let (mut of_ray, mut of_contact) = (new(), new());
    let ways = [
        along_ray(&mut of_ray, form, s).map(|blow| finished(of_ray, form, s, blow)),
        from_contact(&mut of_contact, form, s).map(|blow| finished(of_contact, form, s, blow)),
    ];
    let made = ways.into_iter().flatten();
    made.min_by_key(|function| function.cost.total())
}

fn finished(mut kernel: Kernel<'_>, form: Form, s: usize, blow: Blow) -> Function {
    kernel.builder.guard(Guard::Surface {
        surface: s,
        squared: blow.squared,
        reference: None,
    });
    kernel.builder.name(blow.size, "size");
    kernel.name_direction(form, "direction_", &blow.direction);
    kernel.finish([vec![blow.size, blow.share], blow.direction].concat())
}

/// The values of a blow.
struct Blow {
    size: Value,
    share: Value,
    /// Quantity that is positive where the surface is regular.
    squared: Value,
    direction: Vec<Value>,
}

/// Share of the gap rate that a law removes; `None` if it depends on the state.
fn constant_share(kernel: &mut Kernel<'_>, law: Law) -> Option<Value> {
    match law {
        Law::Elastic => Some(kernel.builder.integer(2)),
        Law::Restitution(e) | Law::Newton(e) => {
            let (one, e) = (kernel.builder.integer(1), kernel.value(e));
            Some(kernel.builder.add(one, e))
        }
        Law::ImpactPlastic => Some(kernel.builder.integer(1)),
        Law::NonholonomicPlastic
        | Law::TotallyPlastic
        | Law::Reset
        | Law::Stop
        | Law::Transition => None,
    }
}

/// True if a law is stated for the momentum along the projected gradient instead of the gap rate. The two differ off
/// the constraints.
fn takes_momentum(law: Law) -> bool {
    matches!(law, Law::Elastic | Law::Restitution(_))
}

fn along_ray(kernel: &mut Kernel<'_>, form: Form, s: usize) -> Option<Blow> {
    let surface = &kernel.derivation.surfaces[s];
    let law = kernel.model.surfaces[s].law;
    if kernel.has_affine_constraints() || !surface.instantaneous.is_empty() {
        return None;
    }
    let share = constant_share(kernel, law)?;
    // `dh` is computed first: the ray contains the same quotients.
    kernel.values(&surface.form);
    let (rate, squared, direction) = match (form, kernel.constraints()) {
        (Form::Global, 0) => free(kernel, surface.ray.as_deref()?),
        (Form::Global, _) if takes_momentum(law) => {
            on_momenta(kernel, surface.ray_on_d.as_deref()?)
        }
        (Form::Global, _) => return None,
        (Form::Reduced, _) => on_d(kernel, surface.ray_on_d.as_deref()?),
        (Form::FirstOrder, _) => return None,
    };
    let given = kernel.builder.neg(share);
    let taken = kernel.builder.mul(given, rate);
    Some(Blow {
        size: kernel.builder.div(taken, squared),
        share,
        squared,
        direction,
    })
}

/// `z . g^{-1} (p - A)`, `z . g^{-1} z` and `z`, the first two up to a common factor.
fn free(kernel: &mut Kernel<'_>, ray: &[ExprId]) -> (Value, Value, Vec<Value>) {
    let z = kernel.values(ray);
    let metric = &kernel.model.lagrangian.metric;
    let entry = |i: usize, j: usize| Some(metric[i][j]);
    if kernel.is_round(ray, entry) {
        let momenta = kernel.lowered_velocity();
        return (kernel.dot(&z, &momenta), kernel.dot(&z, &z), z);
    }
    let qdot = kernel.velocity();
    let y = kernel.forward(&z);
    let squared = kernel.with_ldlt(|builder, ldlt| ldlt.inner(builder, &y, &y));
    (kernel.dot(&z, &qdot), squared, z)
}

/// `z . u`, `z . G_D^{-1} z` and `G_D^{-1} z`, the last two up to a common factor.
fn on_d(kernel: &mut Kernel<'_>, ray: &[ExprId]) -> (Value, Value, Vec<Value>) {
    let u = kernel.quasi_inputs();
    let (z, squared, direction) = raised(kernel, ray);
    (kernel.dot(&z, &u), squared, direction)
}

/// `d . X^T (p - A)`, `z . d` and `g X d` with `d = G_D^{-1} z`.
fn on_momenta(kernel: &mut Kernel<'_>, ray: &[ExprId]) -> (Value, Value, Vec<Value>) {
    let (z, squared, along) = raised_fully(kernel, ray);
    let velocity = kernel.along_frame(&along);
    let momenta = kernel.lowered_velocity();
    let rate = kernel.dot(&velocity, &momenta);
    let mut direction = kernel.lower_vector(&velocity);
    // `X^T (g X d) = z`: along the field of a coordinate, the component is known.
    for (field, &z) in kernel.frame_fields().iter().zip(&z) {
        if let Some(coordinate) = kernel.only_unit(field) {
            direction[coordinate] = z;
        }
    }
    (rate, squared, direction)
}

/// `z`, `z . G_D^{-1} z` and `G_D^{-1} z`, the last two up to a common factor.
fn raised(kernel: &mut Kernel<'_>, ray: &[ExprId]) -> (Vec<Value>, Value, Vec<Value>) {
    let known = kernel.known_metric();
    let entry = |i: usize, j: usize| known.and_then(|metric| metric[i.max(j)][i.min(j)]);
    if kernel.is_round(ray, entry) {
        let z = kernel.values(ray);
        return (z.clone(), kernel.dot(&z, &z), z);
    }
    raised_fully(kernel, ray)
}

/// `z`, `z . G_D^{-1} z` and `G_D^{-1} z`.
fn raised_fully(kernel: &mut Kernel<'_>, ray: &[ExprId]) -> (Vec<Value>, Value, Vec<Value>) {
    let z = kernel.values(ray);
    let (squared, direction) = kernel.with_reduced_ldlt(|builder, ldlt| {
        let rest = ldlt.forward(builder, &z);
        let squared = ldlt.inner(builder, &rest, &rest);
        (squared, ldlt.backward(builder, &rest))
    });
    (z, squared, direction)
}

/// The impulse from the values of the contact.
fn from_contact(kernel: &mut Kernel<'_>, form: Form, s: usize) -> Option<Blow> {
    let law = kernel.model.surfaces[s].law;
    let ContactValues { scalars, direction } = match form {
        Form::Global => contact_values(kernel, s),
        Form::Reduced => reduced_contact_values(kernel, s),
        Form::FirstOrder => return None,
    };
    let [gap_rate, constrained_rate, surface_rate, constrained, free] = scalars;
    let constant = constant_share(kernel, law);
    let builder = &mut kernel.builder;
    let elastic = builder.add(constrained_rate, surface_rate);
    let (share, of) = match (law, constant) {
        (Law::Reset | Law::Stop | Law::Transition, _) => return None,
        (Law::Elastic | Law::Restitution(_), Some(share)) => (share, elastic),
        (_, Some(share)) => (share, gap_rate),
        (_, None) => {
            let rho = builder.div(constrained, free);
            let factor = builder.integer(1 + i64::from(law == Law::NonholonomicPlastic));
            (builder.mul(factor, rho), gap_rate)
        }
    };
    let taken = builder.mul(share, of);
    let negative = builder.neg(taken);
    let size = builder.div(negative, constrained);
    // With affine constraints the momentum along the projected gradient differs from the gap rate.
    let share = match of == gap_rate || !kernel.is_affine_at(s) {
        true => share,
        false => kernel.builder.div(taken, gap_rate),
    };
    Some(Blow {
        size,
        share,
        squared: constrained,
        direction,
    })
}

impl Kernel<'_> {
    /// True if all coordinates along which `z` has components have the same positive weight in a metric, and are
    /// coupled to no others.
    fn is_round(&self, z: &[ExprId], entry: impl Fn(usize, usize) -> Option<ExprId>) -> bool {
        let pool = &self.model.pool;
        let met = |i: &usize| !pool.is_syntactic_zero(z[*i]);
        let Some(first) = (0..z.len()).find(met) else {
            return false;
        };
        let weight = entry(first, first);
        let is_zero =
            |entry: Option<ExprId>| entry.is_some_and(|entry| pool.is_syntactic_zero(entry));
        weight.is_some_and(|weight| pool.sign(weight) == Sign::Positive)
            && (0..z.len()).filter(met).all(|i| {
                entry(i, i) == weight && (0..z.len()).all(|j| j == i || is_zero(entry(i, j)))
            })
    }

    /// The coordinate along which a field is 1; `None` unless it is 0 along all others.
    fn only_unit(&self, field: &[Value]) -> Option<usize> {
        let mut met = (0..field.len()).filter(|&k| !self.builder.is_zero(field[k]));
        let only = met.next().filter(|_| met.next().is_none())?;
        let number = self.builder.as_number(field[only]);
        number.is_some_and(Rational::is_one).then_some(only)
    }

    /// Names the components of an impulse.
    pub(super) fn name_direction(&mut self, form: Form, prefix: &str, direction: &[Value]) {
        match form {
            Form::Global => self.name_by_coordinate(direction, prefix, ""),
            Form::FirstOrder => {}
            Form::Reduced => {
                let Some(frame) = self.frame() else { return };
                for (quasi, &value) in frame.quasi.iter().zip(direction) {
                    self.builder.name(value, format!("{prefix}{}", quasi.name));
                }
            }
        }
    }
}
