//! Differentials of the impact surfaces: `dh`, `d_t h` and the gap rate `dh(qdot) + d_t h`.
//!
//! Every law but `reset`, `stop` and transitions is an impulse along `pi_D^* dh`, plus impulses of instantaneous
//! constraints. Its effect on the state is the same for every multiple of `dh`. For a wall at rest, only the direction
//! of `dh` matters: its *ray*, without factors that are never zero.

use dalembert_expr::{ExprId, Node, Pool, Rational, Singularity};

use super::common_factor::{factored, without_regular_factor};
use super::constraint::derive_residual;
use super::{Coordinates, Frame};
use crate::model::{Constraint, Model};

/// Largest number of distinct subexpressions of a ray on D that is written out.
const PARTS: usize = 400;

/// A constraint `psi(qdot) + psi_0 = 0` that holds during an impact, and while the motion stays in contact with the
/// surface.
#[derive(Debug)]
pub struct InstantaneousForm {
    /// `psi_j`, N entries.
    pub form: Vec<ExprId>,
    /// `psi_0`
    pub affine: ExprId,
    /// `psi(qdot) + psi_0`
    pub residual: ExprId,
    /// Time derivative of `residual` at fixed velocity.
    pub curvature: ExprId,
}

/// One surface, differentiated.
#[derive(Debug)]
pub struct SurfaceForm {
    /// `h(t, q)`.
    pub gap: ExprId,
    /// `dh`, N entries.
    pub form: Vec<ExprId>,
    /// `d_t h`.
    pub rate: ExprId,
    /// `dh(qdot) + d_t h`.
    pub gap_rate: ExprId,
    /// Time derivative of `gap_rate` at fixed velocity: `d^2h/dt^2` without `dh(qddot)`.
    pub curvature: ExprId,
    /// Functions whose signs decide where the surface counts, see [`Surface::margins`](crate::model::Surface::margins).
    pub margins: Vec<ExprId>,
    /// Arguments of the absolute values in the gap, see [`kinks`].
    pub kinks: Vec<ExprId>,
    /// The instantaneous constraints of the surface.
    pub instantaneous: Vec<InstantaneousForm>,
    /// Direction of `dh` without common factors that are never zero; `None` for a moving wall.
    pub ray: Option<Vec<ExprId>>,
    /// The ray of `X^T dh`, with the frame `X` of D as columns; `None` for a moving wall, or if it is not written out.
    pub ray_on_d: Option<Vec<ExprId>>,
}

/// Arguments of the absolute values in a gap, and bases of squares below a root, in order of their expressions. Where one
/// of them changes sign, the gap has a kink.
pub fn kinks(pool: &Pool, gap: ExprId) -> Vec<ExprId> {
    let parts = pool.reachable(&[gap]).into_iter();
    parts
        .flat_map(|id| match pool.node(id) {
            Node::Call(function, argument) if function.singularity() == Singularity::Kink => {
                vec![*argument]
            }
            Node::Product(factors) => {
                let roots = factors.iter().filter(|(_, power)| !power.is_integer());
                roots.flat_map(|(base, _)| squared(pool, *base)).collect()
            }
            _ => Vec::new(),
        })
        .collect()
}

/// The bases of even powers among the factors of a product.
fn squared(pool: &Pool, product: ExprId) -> Vec<ExprId> {
    let Node::Product(factors) = pool.node(product) else {
        return Vec::new();
    };
    let is_even = |power: &Rational| (power * &Rational::HALF).is_integer();
    let even = factors.iter().filter(|(_, power)| is_even(power));
    even.map(|(base, _)| *base).collect()
}

/// Differentiates every surface.
pub(super) fn derive_surfaces(
    model: &mut Model,
    coordinates: &Coordinates,
    frame: Option<&Frame>,
) -> Vec<SurfaceForm> {
    let motion = coordinates.motion(model);
    (0..model.surfaces.len())
        .map(|s| {
            let gap = model.surfaces[s].gap;
            let gap_rate = model.pool.derivative_along(gap, &motion);
            let differentials = coordinates.q.iter();
            let form: Vec<ExprId> = differentials.map(|&q| model.pool.diff(gap, q)).collect();
            let rate = model.pool.diff(gap, coordinates.time);
            let stands = model.pool.is_syntactic_zero(rate);
            let on_d = frame.and_then(|frame| restricted(&mut model.pool, frame, &form));
            SurfaceForm {
                ray: stands.then(|| ray(&mut model.pool, &form)),
                ray_on_d: on_d
                    .filter(|_| stands)
                    .map(|covector| ray(&mut model.pool, &covector)),
                gap,
                form,
                rate,
                curvature: model.pool.derivative_along(gap_rate, &motion),
                gap_rate,
                margins: model.surfaces[s].margins().collect(),
                kinks: kinks(&model.pool, gap),
                instantaneous: derive_instantaneous(model, coordinates, s),
            }
        })
        .collect()
}

fn derive_instantaneous(
    model: &mut Model,
    coordinates: &Coordinates,
    s: usize,
) -> Vec<InstantaneousForm> {
    let motion = coordinates.motion(model);
    let declared = model.surfaces[s].instantaneous.clone();
    let derive = |constraint: Constraint| {
        let residual = derive_residual(model, coordinates, &constraint.form, constraint.affine);
        InstantaneousForm {
            curvature: model.pool.derivative_along(residual, &motion),
            form: constraint.form,
            affine: constraint.affine,
            residual,
        }
    };
    declared.into_iter().map(derive).collect()
}

/// `X^T dh`; `None` if a component of `X` that it contains is not written out, or if the result is too long.
fn restricted(pool: &mut Pool, frame: &Frame, form: &[ExprId]) -> Option<Vec<ExprId>> {
    let fields = &frame.invariant.as_ref()?.written;
    let mut entries = Vec::with_capacity(fields.len());
    for field in fields {
        let mut terms = Vec::new();
        for (&entry, component) in form.iter().zip(field) {
            if !pool.is_syntactic_zero(entry) {
                terms.push(pool.mul(entry, (*component)?));
            }
        }
        let sum = pool.sum(&terms);
        entries.push(pool.simplify(sum));
    }
    (pool.reachable(&entries).len() <= PARTS).then_some(entries)
}

/// A covector without common factors that are never zero.
fn ray(pool: &mut Pool, covector: &[ExprId]) -> Vec<ExprId> {
    let entries: Vec<ExprId> = covector
        .iter()
        .map(|&entry| factored(pool, entry))
        .collect();
    without_regular_factor(pool, &entries)
}
