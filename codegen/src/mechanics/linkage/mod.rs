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
//! definition names it any more; a velocity `qdot^i` that no definition names any more is eliminated by its pivot. The
//! pivots are those of `g = L D L^T` in this order of the coordinates. With the adjoint velocities
//!
//! ```text
//! y_p = c_p x_p + sum_w a_wp y_w          (w: the derived velocities whose definition names p)
//! ```
//!
//! the momenta are `g qdot = y` at the velocities `qdot^i`, the force of T is
//! `d_k T = sum_wp y_w x_p d_k a_wp + 1/2 sum_s x_s^2 d_k c_s`, and the drift `gdot qdot` is the derivative of `y` by time
//! at fixed `qdot`.
//!
//! A derived velocity with constant coefficients is the rate of a sum of coordinates, such as the angle of a rod that the joints
//! before it add up to. Such a sum is a position of its own: coefficients are differentiated with respect to it, and its force is
//! handed on to the positions in its definition.
//!
//! A linkage is used where it takes clearly fewer operations than the metric.

mod positions;
mod read;
mod work;

use dalembert_expr::{ExprId, SymbolId};

use self::positions::{Position, name_positions};
use super::Coordinates;
use crate::model::Model;

/// Number of coordinates below which a linkage is not sought.
const LEAST: usize = 5;

/// Number of squares for each coordinate up to which a linkage is sought. The time of the search grows with the square of it.
const SQUARES: usize = 8;

/// A velocity: index of a coordinate, or N plus the index of a derived velocity.
pub type Part = usize;

/// A kinetic energy as squares of velocities and derived velocities.
#[derive(Debug)]
pub struct Linkage {
    /// The derived velocities, each after those that its definition names.
    pub derived: Vec<Derived>,
    /// `1/2 c x^2`, summed; each velocity occurs once.
    pub squares: Vec<Square>,
    /// The order of elimination: every velocity and every derived velocity once.
    pub order: Vec<Part>,
    /// The derivatives of `L - T` with respect to the positions.
    pub gradient: Vec<(Part, ExprId)>,
    /// `F_k`, every named force added.
    pub force: Vec<ExprId>,
    /// `d/dt` of `d(L - T)/dqdot^k` at fixed velocity.
    pub drift: Vec<ExprId>,
}

/// A derived velocity.
#[derive(Debug)]
pub struct Derived {
    /// The summands of its definition.
    pub terms: Vec<Term>,
    /// The symbol of the position whose rate it is, if its coefficients are constant. The same definition gives the position.
    pub position: Option<SymbolId>,
}

/// A summand `a x` of a derived velocity.
#[derive(Debug)]
pub struct Term {
    /// The velocity `x`.
    pub part: Part,
    /// `a`
    pub factor: Coefficient,
}

/// A summand `1/2 c x^2` of the kinetic energy.
#[derive(Debug)]
pub struct Square {
    /// The velocity `x`.
    pub part: Part,
    /// `c`
    pub weight: Coefficient,
}

/// A function of positions and time.
#[derive(Debug)]
pub struct Coefficient {
    /// Its value.
    pub value: ExprId,
    /// The derivatives with respect to the positions, by the velocities that are their rates.
    pub gradient: Vec<(Part, ExprId)>,
    /// The derivative with respect to time.
    pub by_time: ExprId,
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
    let whole = model.lagrangian.whole;
    let written = read::read(&mut model.pool, &coordinates.qdot, whole, SQUARES * n)?;
    let drift = super::field::drift(model, coordinates, written.rest);
    let definitions = written.derived.iter().map(|(_, terms)| &terms[..]);
    let order = order(n, &definitions.collect::<Vec<_>>());
    let places = Places::of(model, coordinates, &written);
    let derived = written
        .derived
        .into_iter()
        .enumerate()
        .map(|(w, (_, terms))| Derived {
            terms: terms
                .into_iter()
                .map(|(part, factor)| Term {
                    part,
                    factor: places.coefficient(model, factor),
                })
                .collect(),
            position: places.of_derived[w],
        });
    let derived = derived.collect();
    let squares = written.squares.into_iter().map(|(part, weight)| Square {
        part,
        weight: places.coefficient(model, weight),
    });
    let squares = squares.collect();
    let rest = places.coefficient(model, written.rest);
    let force_of = |k: usize| {
        let named: Vec<ExprId> = model.forces.iter().map(|named| named.form[k]).collect();
        let total = model.pool.sum(&named);
        places.named(model, total)
    };
    let linkage = Linkage {
        derived,
        squares,
        order,
        gradient: rest.gradient,
        force: (0..n).map(force_of).collect(),
        drift,
    };
    work::is_shorter(model, &linkage, force).then_some(linkage)
}

/// The positions of a linkage.
struct Places<'a> {
    coordinates: &'a Coordinates,
    positions: Vec<Position>,
    /// The symbols of the positions of the derived velocities.
    of_derived: Vec<Option<SymbolId>>,
    /// Every symbol of a position with the velocity that is its rate.
    symbols: Vec<(Part, SymbolId)>,
}

impl<'a> Places<'a> {
    fn of(model: &mut Model, coordinates: &'a Coordinates, written: &read::Written) -> Self {
        let q = &coordinates.q;
        let mut places = Self {
            coordinates,
            positions: Vec::new(),
            of_derived: Vec::new(),
            symbols: q.iter().copied().enumerate().collect(),
        };
        for (w, (form, terms)) in written.derived.iter().enumerate() {
            // The definition has to give the position, too.
            let is_position = terms.iter().all(|&(part, factor)| {
                let is_known = part < q.len() || places.of_derived[part - q.len()].is_some();
                is_known && model.pool.as_number(factor).is_some()
            });
            let position = match is_position {
                true => Position::of(&mut model.pool, q, form, w),
                false => None,
            };
            let symbol = position.as_ref().map(|position| position.symbol);
            places.of_derived.push(symbol);
            places
                .symbols
                .extend(symbol.map(|symbol| (q.len() + w, symbol)));
            places.positions.extend(position);
        }
        places
    }

    /// An expression of coordinates as one of positions.
    fn named(&self, model: &mut Model, value: ExprId) -> ExprId {
        name_positions(
            &mut model.pool,
            &self.coordinates.q,
            &self.positions,
            &[value],
        )[0]
    }

    fn coefficient(&self, model: &mut Model, value: ExprId) -> Coefficient {
        let value = self.named(model, value);
        let pool = &mut model.pool;
        let mut gradient = Vec::new();
        for &(part, symbol) in &self.symbols {
            if pool.depends_on(value, symbol) {
                gradient.push((part, pool.diff(value, symbol)));
            }
        }
        gradient.retain(|(_, derivative)| !pool.is_syntactic_zero(*derivative));
        Coefficient {
            value,
            gradient,
            by_time: pool.diff(value, self.coordinates.time),
        }
    }
}

/// The order of elimination: the last derived velocity first, each velocity as soon as no definition names it.
fn order(n: usize, derived: &[&[(Part, ExprId)]]) -> Vec<Part> {
    let mut named = vec![0; n + derived.len()];
    for &(part, _) in derived.iter().copied().flatten() {
        named[part] += 1;
    }
    let mut order: Vec<Part> = (0..n).rev().filter(|&i| named[i] == 0).collect();
    for (w, terms) in derived.iter().enumerate().rev() {
        order.push(n + w);
        for &(part, _) in *terms {
            named[part] -= 1;
            if part < n && named[part] == 0 {
                order.push(part);
            }
        }
    }
    order
}
