//! Functions of instantaneous constraints. An impact establishes them, and they hold while the surface holds the
//! motion.
//!
//! Let `C_b` be `L^{-1} psi^b` without its components along the constraint columns, or `L_D^{-1} X^T psi^b` on D. The
//! impulse `x = C nu` of least norm with `<C_b, x> = r_b` changes `psi^b(qdot)` by `r_b` and preserves every
//! constraint. Such an impulse brings the state to `D' = ker(eta, psi)`, and such a force keeps it in `D'`. Within `D'`
//! a law acts as within D, along `dh` without its components along `C`.

use dalembert_expr::ExprId;

use super::impact::{acceleration, motion_rates};
use crate::mechanics::Derivation;
use crate::mechanics::impact::InstantaneousForm;
use crate::model::Model;
use crate::program::kernel::Kernel;
use crate::program::linear::Orthogonal;
use crate::program::{Form, Function, Guard, Value};

/// `(t, state) ->` the impulse that establishes the instantaneous constraints of surface `s`; `None` without these.
pub(super) fn focus(
    model: &Model,
    derivation: &Derivation,
    form: Form,
    s: usize,
) -> Option<Function> {
    let mut kernel = Kernel::new(model, derivation, form.state());
    let impulse = focus_values(&mut kernel, form, s)?;
    Some(kernel.finish(impulse))
}

/// The impulse of [`focus`].
pub(super) fn focus_values(kernel: &mut Kernel<'_>, form: Form, s: usize) -> Option<Vec<Value>> {
    let instantaneous = constraints(kernel, s)?;
    kernel.velocity();
    let residuals: Vec<ExprId> = instantaneous
        .iter()
        .map(|constraint| constraint.residual)
        .collect();
    let residuals = kernel.values(&residuals);
    Some(against(kernel, form, s, &residuals))
}

/// `(t, state, w) ->` the addition to the rates `w` that maintains the instantaneous constraints of surface `s`; `None`
/// without these.
pub(super) fn trace(
    model: &Model,
    derivation: &Derivation,
    form: Form,
    s: usize,
) -> Option<Function> {
    let mut kernel = Kernel::new(model, derivation, form.state());
    let instantaneous = constraints(&kernel, s)?;
    let motion = motion_rates(&mut kernel, form);
    let acceleration = acceleration(&mut kernel, form, &motion);
    let rates: Vec<Value> = instantaneous
        .iter()
        .map(|constraint| {
            let form = kernel.values(&constraint.form);
            let along = kernel.dot(&form, &acceleration);
            let curvature = kernel.value(constraint.curvature);
            kernel.builder.add(along, curvature)
        })
        .collect();
    let force = against(&mut kernel, form, s, &rates);
    Some(kernel.finish(force))
}

/// The instantaneous constraints of a surface; `None` if there are none.
fn constraints<'d>(kernel: &Kernel<'d>, s: usize) -> Option<&'d [InstantaneousForm]> {
    let instantaneous = &kernel.derivation.surfaces[s].instantaneous;
    (!instantaneous.is_empty()).then_some(instantaneous)
}

/// The impulse that preserves the constraints and changes each `psi^b(qdot)` by `-rates[b]`.
fn against(kernel: &mut Kernel<'_>, form: Form, s: usize, rates: &[Value]) -> Vec<Value> {
    let factors = kernel.factor_instantaneous(form, s);
    let wanted: Vec<Value> = rates.iter().map(|&rate| kernel.builder.neg(rate)).collect();
    let x = factors.least_norm(&mut kernel.builder, &wanted);
    let impulse = match form {
        Form::Reduced => kernel.with_reduced_ldlt(|builder, ldlt| ldlt.backward(builder, &x)),
        Form::Global | Form::FirstOrder => {
            kernel.with_ldlt(|builder, ldlt| ldlt.lower_times(builder, &x))
        }
    };
    kernel.name_direction(form, "impulse_", &impulse);
    impulse
}

impl Kernel<'_> {
    /// Removes from a column `L^{-1} b`, or `L_D^{-1} X^T b`, its components along the instantaneous constraints of a
    /// surface.
    pub(super) fn within_instantaneous(
        &mut self,
        form: Form,
        s: usize,
        column: Vec<Value>,
    ) -> Vec<Value> {
        if self.derivation.surfaces[s].instantaneous.is_empty() {
            return column;
        }
        let factors = self.factor_instantaneous(form, s);
        self.with_state_ldlt(form, |builder, ldlt| {
            factors.reduce(builder, ldlt, column).1
        })
    }

    /// True if a constraint, or an instantaneous constraint of a surface, has an affine part.
    pub(super) fn is_affine_at(&self, s: usize) -> bool {
        let mut instantaneous = self.derivation.surfaces[s].instantaneous.iter();
        let pool = &self.model.pool;
        self.has_affine_constraints()
            || instantaneous.any(|constraint| !pool.is_syntactic_zero(constraint.affine))
    }

    /// The columns `C_b`, orthogonalised.
    fn factor_instantaneous(&mut self, form: Form, s: usize) -> Orthogonal {
        let derivation = self.derivation;
        let mut columns = Vec::new();
        let mut references = Vec::new();
        for constraint in &derivation.surfaces[s].instantaneous {
            let psi = self.values(&constraint.form);
            let free = self.forward(&psi);
            references.push(self.with_ldlt(|builder, ldlt| ldlt.inner(builder, &free, &free)));
            columns.push(match form {
                Form::Reduced => {
                    let restricted = self.restrict(&psi);
                    self.with_reduced_ldlt(|builder, ldlt| ldlt.forward(builder, &restricted))
                }
                Form::Global | Form::FirstOrder => self.without_constraints(free),
            });
        }
        let guarded = self.guards_surfaces;
        let guard = |index: usize, squared, _| {
            guarded.then_some(Guard::Surface {
                surface: s,
                squared,
                reference: Some(references[index]),
            })
        };
        self.with_state_ldlt(form, |builder, ldlt| {
            Orthogonal::factor(builder, ldlt, columns, guard)
        })
    }
}
