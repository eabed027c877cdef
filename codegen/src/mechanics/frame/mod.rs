//! The motion reduced to D: quasi-velocities, and the solve for velocities from them.
//!
//! N - M one-forms `alpha^i` that complete the constraint forms to a coframe give quasi-velocities
//! `u^i = alpha^i(qdot)`. The fields `X_i` are dual to the coframe:
//!
//! ```text
//! qdot = X_0 + X_i u^i        alpha^j(X_i) = delta, eta(X_i) = 0;  alpha(X_0) = 0, eta(X_0) = -eta_0
//! G_D udot = X^T (f - gdot qdot - Adot - g a),        G_D = X^T g X
//! a = Xdot u + Xdot_0:  alpha(a) = -alphadot(qdot),  eta(a) = -curvature
//! ```
//!
//! `f`, `gdot qdot + Adot` and `curvature` are those of the global form, so that the reduced form covers the same
//! systems: affine constraints, dependence on time, forces, velocity-linear terms. The system of `alpha` and `eta` is
//! never inverted symbolically: [`plan`] gives the order in which it is solved.

mod axis;
mod choice;
pub mod invariant;
pub mod plan;
mod scale;

use dalembert_expr::ExprId;

use super::{ConstraintForm, Coordinates, FieldTerms};
use crate::model::Model;

pub use axis::Axis;
pub use invariant::Invariant;
pub use plan::{Block, Row, Solve};

/// Quasi-velocities and the order in which velocities follow from them.
#[derive(Debug)]
pub struct Frame {
    /// The quasi-velocities, N - M.
    pub quasi: Vec<QuasiVelocity>,
    /// The blocks of the coframe, in the order in which they are solved.
    pub blocks: Vec<Block>,
    /// Bound of each velocity at unit quasi-velocities: a function of the parameters, or 1 if no such bound is known.
    pub position_units: Vec<ExprId>,
    /// Expressions that do not depend on the configuration.
    pub invariant: Option<Invariant>,
}

/// `u = alpha(qdot)`
#[derive(Debug)]
pub struct QuasiVelocity {
    /// Name: as declared, `x_dot` for the velocity of `x`, or `along_k` for a velocity along the constraint `k`.
    pub name: String,
    /// The coordinate whose velocity was chosen; `None` for a declared one-form and for a velocity along a constraint.
    pub coordinate: Option<usize>,
    /// `alpha_j`, N entries.
    pub form: Vec<ExprId>,
    /// The Euclidean norm of `alpha`: the largest quasi-velocity of a unit velocity.
    pub norm: ExprId,
    /// `alphadot(qdot) = (d_i alpha_j) qdot^i qdot^j + (d_t alpha_j) qdot^j`
    pub curvature: ExprId,
}

/// Reason why the motion is left in its global form.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Unreduced {
    /// There are no constraints and no frame was declared.
    Free,
    /// The constraints for which no choice of dependent velocities is regular at every configuration.
    NoRegularFrame(Vec<usize>),
    /// Constraints that are not linear in the velocities.
    Nonlinear(Vec<usize>),
}

/// The declared frame, or one that is regular at every configuration.
pub(super) fn derive_frame(
    model: &mut Model,
    coordinates: &Coordinates,
    constraints: &[ConstraintForm],
    field: &FieldTerms,
) -> Result<Frame, Unreduced> {
    let declared_ones = model.constraints.iter().enumerate();
    let nonlinear: Vec<usize> = declared_ones
        .filter(|(_, constraint)| constraint.nonlinear.is_some())
        .map(|(a, _)| a)
        .collect();
    if !nonlinear.is_empty() {
        return Err(Unreduced::Nonlinear(nonlinear));
    }
    let forms = if model.frame.is_empty() {
        if constraints.is_empty() {
            return Err(Unreduced::Free);
        }
        choice::choose(model, constraints)?
    } else {
        declared(model)
    };
    let motion = coordinates.motion(model);
    let quasi: Vec<QuasiVelocity> = forms
        .into_iter()
        .map(|chosen| {
            let velocity = contract(model, coordinates, &chosen.form);
            let squared = choice::squared_norm(&mut model.pool, &chosen.form);
            QuasiVelocity {
                norm: model.pool.sqrt(squared),
                curvature: model.pool.derivative_along(velocity, &motion),
                name: chosen.name,
                coordinate: chosen.coordinate,
                form: chosen.form,
            }
        })
        .collect();
    let blocks = plan::plan(&mut model.pool, &quasi, constraints);
    let position_units = scale::position_units(model, &quasi, constraints, &blocks);
    let parts = (quasi.as_slice(), blocks.as_slice());
    let invariant = invariant::invariant(model, coordinates, constraints, field, parts);
    Ok(Frame {
        quasi,
        blocks,
        position_units,
        invariant,
    })
}

/// A one-form that was chosen or declared.
struct Chosen {
    name: String,
    coordinate: Option<usize>,
    form: Vec<ExprId>,
}

fn declared(model: &Model) -> Vec<Chosen> {
    let entries = model.frame.iter();
    entries
        .map(|entry| Chosen {
            name: entry.name.display.clone(),
            coordinate: None,
            form: entry.form.clone(),
        })
        .collect()
}

/// `alpha(qdot)`
fn contract(model: &mut Model, coordinates: &Coordinates, form: &[ExprId]) -> ExprId {
    let terms: Vec<ExprId> = form
        .iter()
        .zip(&coordinates.qdot)
        .map(|(&component, &qdot)| {
            let velocity = model.pool.variable(qdot);
            model.pool.mul(component, velocity)
        })
        .collect();
    model.pool.sum(&terms)
}
