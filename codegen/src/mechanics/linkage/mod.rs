//! Kinetic energies whose velocities follow from one another.
//!
//! The places of the links of a chain, `X[i] = X[i-1] + l sin(theta[i])`, have velocities that differ by one term from link
//! to link. A kinetic energy with the squares of these velocities is
//!
//! ```text
//! T = 1/2 sum_s c_s x_s^2,    x_s = qdot^i, or a derived velocity x_w = sum_p a_wp x_p  (p: qdot^i, or derived before w)
//! ```
//!
//! Elimination along these definitions, the last one first, takes a number of operations in proportion to the number of links,
//! where the metric `g` has N^2 entries. For rigid bodies it is the method of articulated bodies (Featherstone, Rigid Body
//! Dynamics Algorithms, 2008). A derived velocity is replaced by its definition in the quadratic form when no other
//! definition names it any more; a velocity `qdot^i` that no definition names any more is eliminated by its pivot. The pivots are those
//! of `g = L D L^T` in this order of the coordinates. With the adjoint velocities
//!
//! ```text
//! y_p = c_p x_p + sum_w a_wp y_w          (w: the derived velocities whose definition names p)
//! ```
//!
//! the momenta are `g qdot = y` at the velocities `qdot^i`, the force of T is
//! `d_k T = sum_wp y_w x_p d_k a_wp + 1/2 sum_s x_s^2 d_k c_s`, and the drift `gdot qdot` is the derivative of `y` by time at fixed `qdot`.
//!
//! A linkage is used where it takes clearly fewer operations than the metric.

mod read;
mod work;

use dalembert_expr::{ExprId, SymbolId};

use super::{Coordinates, Entry, gradient};
use crate::model::Model;

/// Number of coordinates below which a linkage is not sought.
const LEAST: usize = 5;

/// A velocity: index of a coordinate, or N plus the index of a derived velocity.
pub type Part = usize;

/// A kinetic energy as squares of velocities and derived velocities.
#[derive(Debug)]
pub struct Linkage {
    /// The derived velocities, each after those that its definition names.
    pub derived: Vec<Vec<Term>>,
    /// `1/2 c x^2`, summed; each velocity occurs once.
    pub squares: Vec<Square>,
    /// The order of elimination: every velocity and every derived velocity once.
    pub order: Vec<Part>,
    /// `d_k (L - T) + F_k`
    pub force: Vec<ExprId>,
    /// `d/dt` of `d(L - T)/dqdot^k` at fixed velocity.
    pub drift: Vec<ExprId>,
}

/// A summand `a x` of a derived velocity.
#[derive(Debug)]
pub struct Term {
    /// The velocity `x`.
    pub part: Part,
    /// `a`, independent of velocities, with its derivatives.
    pub factor: Coefficient,
}

/// A summand `1/2 c x^2` of the kinetic energy.
#[derive(Debug)]
pub struct Square {
    /// The velocity `x`.
    pub part: Part,
    /// `c`, independent of velocities, with its derivatives.
    pub weight: Coefficient,
}

/// A function of positions and time.
#[derive(Debug)]
pub struct Coefficient {
    /// Its value.
    pub value: ExprId,
    /// The derivatives with respect to the coordinates.
    pub gradient: Vec<Entry<1>>,
    /// The derivative along the motion.
    pub rate: ExprId,
}

/// The linkage of the kinetic energy as written; `None` if it is not written as squares, or if the metric takes fewer
/// operations. `force` is that of the whole Lagrangian.
pub(super) fn derive_linkage(
    model: &mut Model,
    coordinates: &Coordinates,
    force: &[ExprId],
) -> Option<Linkage> {
    let n = coordinates.q.len();
    if n < LEAST || !model.constraints.is_empty() || model.field.is_some() {
        return None;
    }
    let written = read::read(&mut model.pool, &coordinates.qdot, model.lagrangian.whole)?;
    let motion = coordinates.motion(model);
    let order = order(n, &written.derived);
    let coefficient = |model: &mut Model, value| Coefficient {
        value,
        gradient: gradient(model, value, &coordinates.q),
        rate: model.pool.derivative_along(value, &motion),
    };
    let derived = written.derived.into_iter().map(|terms| {
        let terms = terms.into_iter();
        terms
            .map(|(part, factor)| Term {
                part,
                factor: coefficient(model, factor),
            })
            .collect()
    });
    let derived = derived.collect();
    let squares = written.squares.into_iter().map(|(part, weight)| Square {
        part,
        weight: coefficient(model, weight),
    });
    let squares = squares.collect();
    let rest = written.rest;
    let force_of_rest = (0..n).map(|k| rest_force(model, coordinates.q[k], rest, k));
    let force_of_rest = force_of_rest.collect();
    let drift = coordinates.qdot.iter().map(|&velocity| {
        let momentum = model.pool.diff(rest, velocity);
        model.pool.derivative_along(momentum, &motion)
    });
    let drift = drift.collect();
    let linkage = Linkage {
        derived,
        squares,
        order,
        force: force_of_rest,
        drift,
    };
    work::is_shorter(model, &linkage, force).then_some(linkage)
}

/// `d_k (L - T) + F_k`
fn rest_force(model: &mut Model, q: SymbolId, rest: ExprId, k: usize) -> ExprId {
    let mut terms = vec![model.pool.diff(rest, q)];
    terms.extend(model.forces.iter().map(|named| named.form[k]));
    model.pool.sum(&terms)
}

/// The order of elimination: the last derived velocity first, each velocity as soon as no definition names it.
fn order(n: usize, derived: &[Vec<(Part, ExprId)>]) -> Vec<Part> {
    let mut named = vec![0; n + derived.len()];
    for &(part, _) in derived.iter().flatten() {
        named[part] += 1;
    }
    let mut order: Vec<Part> = (0..n).rev().filter(|&i| named[i] == 0).collect();
    for (w, terms) in derived.iter().enumerate().rev() {
        order.push(n + w);
        for &(part, _) in terms {
            named[part] -= 1;
            if part < n && named[part] == 0 {
                order.push(part);
            }
        }
    }
    order
}
