//! Total time derivatives: a flow that changes the Lagrangian by such a derivative keeps the equations of motion.
//!
//! Near every configuration, `R(q, qdot, t)` is `df/dt` for a function `f(q, t)` iff its Euler-Lagrange expressions
//! vanish at all positions, velocities and accelerations:
//!
//! ```text
//! d^2R/dqdot^i dqdot^j = 0
//! (qdot^j d_j + d_t) dR/dqdot^i - dR/dq^i = 0
//! ```

use dalembert_expr::{ExprId, Node, Pool, Rational, SymbolId, Verdict as Zero};

use crate::model::Model;

/// Expressions, each with its name. All of them vanish iff `rate` is a total derivative.
pub(super) fn conditions(model: &mut Model, rate: ExprId) -> Vec<(String, ExprId)> {
    let coordinates: Vec<(String, SymbolId, SymbolId)> = model
        .coordinates
        .iter()
        .map(|coordinate| {
            (
                coordinate.name.display.clone(),
                coordinate.q,
                coordinate.qdot,
            )
        })
        .collect();
    let motion = motion(model);
    let pool = &mut model.pool;
    let mut conditions = Vec::new();
    for (i, (first, q, qdot)) in coordinates.iter().enumerate() {
        let slope = pool.diff(rate, *qdot);
        for (second, _, other) in &coordinates[i..] {
            let name = format!("second derivative of this rate in dot({first}) and dot({second})");
            conditions.push((name, pool.diff(slope, *other)));
        }
        let along = pool.derivative_along(slope, &motion);
        let gradient = pool.diff(rate, *q);
        let name = format!("Euler-Lagrange expression of this rate for {first}");
        conditions.push((name, pool.sub(along, gradient)));
    }
    conditions.retain(|(_, value)| !pool.is_syntactic_zero(*value));
    conditions
}

/// Expressions, each with its name, that vanish at all states that satisfy the position equations if `rate` is a total
/// derivative along these states. With the parts of `rate` of degree 0 and 1 in the velocities, `R0 + R1_i qdot^i`:
///
/// ```text
/// rate - R0 - R1_i qdot^i = 0
/// (dR1_i/dt - dR0/dq^i) qdot^i = 0
/// ```
///
/// Empty if an equation depends on time: the velocities of a motion are then no linear space.
pub(super) fn conditions_along_equations(
    model: &mut Model,
    rate: ExprId,
) -> Vec<(&'static str, ExprId)> {
    let mut levels = model.constraints.iter().filter_map(|it| it.level);
    if levels.any(|level| model.pool.depends_on(level, model.time)) {
        return Vec::new();
    }
    let pool = &mut model.pool;
    let zero = pool.zero();
    let symbols = model.coordinates.iter().map(|it| (it.q, it.qdot));
    let symbols: Vec<(SymbolId, SymbolId)> = symbols.collect();
    let at_rest: Vec<(SymbolId, ExprId)> = symbols.iter().map(|(_, qdot)| (*qdot, zero)).collect();
    let constant = pool.substitute(rate, &at_rest);
    let (mut affine, mut curl) = (vec![constant], Vec::new());
    for (q, qdot) in symbols {
        let velocity = pool.variable(qdot);
        let slope = pool.diff(rate, qdot);
        let slope = pool.substitute(slope, &at_rest);
        affine.push(pool.mul(slope, velocity));
        let (of_time, of_position) = (pool.diff(slope, model.time), pool.diff(constant, q));
        let difference = pool.sub(of_time, of_position);
        curl.push(pool.mul(difference, velocity));
    }
    let affine = pool.sum(&affine);
    vec![
        (
            "part of this rate that is not linear in the velocities",
            pool.sub(rate, affine),
        ),
        (
            "Euler-Lagrange expression of this rate along the velocity",
            pool.sum(&curl),
        ),
    ]
}

/// The function of positions and time with this total derivative, if it is a polynomial.
pub(super) fn antiderivative(model: &mut Model, rate: ExprId) -> Option<ExprId> {
    let mut variables = vec![model.time];
    let mut rest = rate;
    let mut terms = Vec::new();
    let pool = &mut model.pool;
    for coordinate in &model.coordinates {
        variables.push(coordinate.q);
        let slope = pool.diff(rate, coordinate.qdot);
        let [q, qdot] = [coordinate.q, coordinate.qdot].map(|symbol| pool.variable(symbol));
        let part = pool.mul(slope, qdot);
        rest = pool.sub(rest, part);
        terms.push(pool.mul(slope, q));
    }
    let rest = pool.multiply_out(rest);
    let time = pool.variable(model.time);
    terms.push(pool.mul(rest, time));
    let radial = pool.sum(&terms);
    let radial = pool.multiply_out(radial);
    // The homotopy operator: a monomial is divided by its degree.
    let (number, parts) = pool.linear_form(radial);
    if !number.is_zero() {
        return None;
    }
    let mut terms = Vec::new();
    for (coefficient, part) in parts {
        let degree = degree(pool, part, &variables)?;
        let share = coefficient.checked_div(&Rational::from(degree))?;
        terms.push(pool.scale(&share, part));
    }
    let found = pool.sum(&terms);
    let along = motion(model);
    let back = model.pool.derivative_along(found, &along);
    let error = model.pool.sub(back, rate);
    (model.pool.zero_test(error) == Zero::Proved).then_some(found)
}

/// Rates along a motion: `qdot` for q, 1 for t.
pub(super) fn motion(model: &mut Model) -> Vec<(SymbolId, ExprId)> {
    let mut motion = Vec::new();
    for coordinate in &model.coordinates {
        motion.push((coordinate.q, model.pool.variable(coordinate.qdot)));
    }
    motion.push((model.time, model.pool.one()));
    motion
}

/// Degree of a monomial in variables; `None` if it is not a monomial, or if the degree is 0.
fn degree(pool: &Pool, monomial: ExprId, variables: &[SymbolId]) -> Option<i64> {
    let one = Rational::ONE;
    let factors = match pool.node(monomial) {
        Node::Product(factors) => factors.to_vec(),
        _ => vec![(monomial, one)],
    };
    let mut degree = 0;
    for (base, exponent) in factors {
        if !pool.depends_on_any(base, variables) {
            continue;
        }
        let Node::Symbol(_) = pool.node(base) else {
            return None;
        };
        degree += exponent.to_i64().filter(|power| *power > 0)?;
    }
    (degree > 0).then_some(degree)
}
