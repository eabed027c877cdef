//! What in the frame does not depend on the configuration.
//!
//! On groups and the like the velocities along some coordinates, the metric on D and the forces of inertia are functions of
//! the quasi-velocities and parameters alone, as for balls and disks that roll on a plane. Solved for in the frame they
//! would be sums that cancel, to rounding and with lost digits near the poles of Euler angles. Where a zero test proves
//! that an expression is the one at a single configuration, that one is emitted.

use dalembert_expr::{Assumption, ExprId, Rational, SymbolId, Verdict};

use super::{Block, QuasiVelocity, Row, Solve};
use crate::mechanics::{ConstraintForm, Coordinates, FieldTerms};
use crate::model::{Model, Topology};

/// Expressions of quasi-velocities, parameters and time; `None` where the configuration matters, or was not shown not to.
#[derive(Debug)]
pub struct Invariant {
    /// The symbols of the quasi-velocities.
    pub u: Vec<SymbolId>,
    /// `qdot`, N entries.
    pub velocity: Vec<Option<ExprId>>,
    /// `G_D`, the lower triangle.
    pub metric: Vec<Vec<Option<ExprId>>>,
    /// `X^T (f - gdot qdot - Adot - g a)`
    pub right: Vec<Option<ExprId>>,
}

/// Coordinates beyond which nothing is looked for: the expressions are written out.
const COORDINATES: usize = 8;

/// Distinct parts beyond which an expression is not tested.
const PARTS: usize = 4000;

/// What is not zero at a real point by more than this part of its terms is not zero.
const CLEAR: f64 = 1e-9;

/// Looks for what does not depend on the configuration. `None` where the frame is not solved by formulas.
pub(super) fn invariant(
    model: &mut Model,
    coordinates: &Coordinates,
    constraints: &[ConstraintForm],
    field: &FieldTerms,
    (quasi, blocks): (&[QuasiVelocity], &[Block]),
) -> Option<Invariant> {
    if coordinates.q.len() > COORDINATES {
        return None;
    }
    let u: Vec<SymbolId> = quasi
        .iter()
        .map(|own| model.pool.symbol(&own.name, &own.name, Assumption::None))
        .collect();
    let mut search = Search {
        base: base(model),
        model,
        constraints,
        quasi,
        blocks,
    };
    let fields: Option<Vec<Vec<ExprId>>> = (0..quasi.len()).map(|i| search.field(i)).collect();
    let fields = fields?;
    let velocity = search.velocity(&u)?;
    let motion: Vec<(SymbolId, ExprId)> = coordinates
        .qdot
        .iter()
        .copied()
        .zip(velocity.iter().copied())
        .collect();
    let forces = search.forces(field, &motion)?;
    let metric = (0..fields.len())
        .map(|i| {
            let lowered = search.lowered(&fields[i]);
            let row = (0..=i).map(|j| search.product(&fields[j], &lowered));
            row.collect::<Vec<ExprId>>()
        })
        .collect::<Vec<_>>();
    let right: Vec<ExprId> = fields
        .iter()
        .map(|field| search.product(field, &forces))
        .collect();
    let mut fixed = |values: Vec<ExprId>| -> Vec<Option<ExprId>> {
        values
            .into_iter()
            .map(|value| search.fixed(value))
            .collect()
    };
    Some(Invariant {
        velocity: fixed(velocity),
        metric: metric.into_iter().map(&mut fixed).collect(),
        right: fixed(right),
        u,
    })
}

/// A configuration at which expressions are written out: 0, or the middle of an interval.
fn base(model: &mut Model) -> Vec<(SymbolId, ExprId)> {
    let half = Rational::HALF;
    (0..model.coordinates.len())
        .map(|i| {
            let coordinate = &model.coordinates[i];
            let symbol = coordinate.q;
            let value = match coordinate.topology {
                Topology::Interval { low, high } => {
                    let sum = model.pool.add(low, high);
                    model.pool.scale(&half, sum)
                }
                Topology::Line | Topology::Angle => model.pool.zero(),
            };
            (symbol, value)
        })
        .collect()
}

struct Search<'a> {
    model: &'a mut Model,
    base: Vec<(SymbolId, ExprId)>,
    constraints: &'a [ConstraintForm],
    quasi: &'a [QuasiVelocity],
    blocks: &'a [Block],
}

impl<'a> Search<'a> {
    fn form(&self, row: Row) -> &'a [ExprId] {
        match row {
            Row::Quasi(i) => &self.quasi[i].form,
            Row::Constraint(a) => &self.constraints[a].form,
        }
    }

    /// The velocities `x` with `alpha^i(x)` and `eta^a(x)` as given; `None` where a block has no formula.
    fn solve(&mut self, right: &dyn Fn(&mut Model, Row) -> ExprId) -> Option<Vec<ExprId>> {
        let zero = self.model.pool.zero();
        let mut x = vec![zero; self.model.coordinates.len()];
        for block in self.blocks {
            let mut rest = Vec::with_capacity(block.rows.len());
            for &row in &block.rows {
                let (wanted, known) = (right(self.model, row), self.product(self.form(row), &x));
                rest.push(self.model.pool.sub(wanted, known));
            }
            for k in 0..block.columns.len() {
                x[block.columns[k]] = self.solved(block, &rest, k)?;
            }
        }
        Some(x)
    }

    /// Column `k` of a block.
    fn solved(&mut self, block: &Block, rest: &[ExprId], k: usize) -> Option<ExprId> {
        let column = block
            .rows
            .iter()
            .map(|&row| self.form(row)[block.columns[k]]);
        let column: Vec<ExprId> = column.collect();
        Some(match &block.solve {
            Solve::Entry => self.model.pool.div(rest[0], column[0]),
            Solve::Rows(squares) => {
                let weights = rest.iter().zip(squares);
                let weights: Vec<ExprId> = weights
                    .map(|(&rest, &square)| self.model.pool.div(rest, square))
                    .collect();
                self.product(&column, &weights)
            }
            Solve::Columns(squares) => {
                let sum = self.product(&column, rest);
                self.model.pool.div(sum, squares[k])
            }
            Solve::General => return None,
        })
    }

    /// `X_i`
    fn field(&mut self, i: usize) -> Option<Vec<ExprId>> {
        self.solve(&|model, row| match row == Row::Quasi(i) {
            true => model.pool.one(),
            false => model.pool.zero(),
        })
    }

    /// `X_0 + X u`
    fn velocity(&mut self, u: &[SymbolId]) -> Option<Vec<ExprId>> {
        let constraints = self.constraints;
        self.solve(&|model, row| match row {
            Row::Quasi(i) => model.pool.variable(u[i]),
            Row::Constraint(a) => model.pool.neg(constraints[a].affine),
        })
    }

    /// `f - gdot qdot - Adot - g a` at the velocities of the motion.
    fn forces(&mut self, field: &FieldTerms, motion: &[(SymbolId, ExprId)]) -> Option<Vec<ExprId>> {
        let (constraints, quasi) = (self.constraints, self.quasi);
        let steady = self.solve(&|model, row| {
            let curvature = match row {
                Row::Quasi(i) => quasi[i].curvature,
                Row::Constraint(a) => constraints[a].curvature,
            };
            model.pool.neg(curvature)
        })?;
        let inertial = self.lowered(&steady);
        let mut forces = Vec::with_capacity(inertial.len());
        for (k, &inertial) in inertial.iter().enumerate() {
            let pool = &mut self.model.pool;
            let free = pool.sub(field.force[k], field.drift[k]);
            forces.push(pool.sub(free, inertial));
        }
        Some(self.model.pool.substitute_all(&forces, motion))
    }

    /// `g v`
    fn lowered(&mut self, v: &[ExprId]) -> Vec<ExprId> {
        let metric = self.model.lagrangian.metric.clone();
        metric.iter().map(|row| self.product(row, v)).collect()
    }

    fn product(&mut self, a: &[ExprId], b: &[ExprId]) -> ExprId {
        let pool = &mut self.model.pool;
        let terms = a.iter().zip(b);
        let terms: Vec<ExprId> = terms.map(|(&a, &b)| pool.mul(a, b)).collect();
        pool.sum(&terms)
    }

    /// The expression at the base configuration, if it is the same everywhere.
    fn fixed(&mut self, expression: ExprId) -> Option<ExprId> {
        let pool = &mut self.model.pool;
        let positions: Vec<SymbolId> = self.base.iter().map(|(symbol, _)| *symbol).collect();
        if !pool.depends_on_any(expression, &positions) {
            return Some(expression);
        }
        if pool.reachable(&[expression]).len() > PARTS {
            return None;
        }
        let fixed = pool.substitute(expression, &self.base);
        let fixed = pool.simplify(fixed);
        let difference = pool.sub(expression, fixed);
        let may_vanish = !pool.is_undefined_constant(fixed) && self.may_vanish(difference);
        let vanishes = may_vanish && self.model.pool.zero_test(difference) == Verdict::Proved;
        vanishes.then_some(fixed)
    }

    /// Whether the expression is about 0 at some points, which tells most of those that are not at little cost.
    fn may_vanish(&self, expression: ExprId) -> bool {
        (0..3).all(|sample| {
            let (value, size) = self
                .model
                .pool
                .eval_magnitude(expression, &|symbol| self.sample(symbol, sample));
            value.abs() <= CLEAR * size || !size.is_finite()
        })
    }

    /// A value of a symbol, within its interval.
    fn sample(&self, symbol: SymbolId, sample: u32) -> f64 {
        let number = symbol.index() as f64 + 17.0 * f64::from(sample);
        let share = (0.618_033_988_749_895 * number).fract();
        let coordinate = self.model.coordinates.iter().find(|own| own.q == symbol);
        match coordinate.map(|own| own.topology) {
            Some(Topology::Interval { low, high }) => {
                let ends = self.model.pool.eval(&[low, high], &|_| f64::NAN);
                ends[0] + (0.1 + 0.8 * share) * (ends[1] - ends[0])
            }
            _ => 0.3 + share,
        }
    }
}
