//! Expressions of the frame that do not depend on the configuration.
//!
//! On groups and similar spaces, the velocities along some coordinates, the metric on D and the inertial forces depend
//! only on quasi-velocities and parameters. Examples are balls and disks that roll on a plane; on a rotating plane they
//! also depend on the position. Computed in the frame, such quantities are sums that cancel only up to rounding, and
//! that lose digits near the poles of Euler angles. If a zero test proves that an expression is independent of some
//! coordinates, the expression at fixed values of these coordinates is emitted.

use dalembert_expr::{Assumption, ExprId, Pool, Rational, Sign, SymbolId, Verdict};

use super::{Axis, Block, QuasiVelocity, Row, Solve};
use crate::mechanics::common_factor::factored;
use crate::mechanics::{ConstraintForm, Coordinates, FieldTerms};
use crate::model::{Model, Topology};

/// Expressions without the coordinates on which they do not depend. `None` if an expression depends on all coordinates
/// that occur in it, or if its independence was not proved.
#[derive(Debug)]
pub struct Invariant {
    /// Symbols of the quasi-velocities.
    pub u: Vec<SymbolId>,
    /// `X_i`, N - M rows of N.
    pub fields: Vec<Vec<Option<ExprId>>>,
    /// `X_i` as expressions, where these need no guard.
    pub written: Vec<Vec<Option<ExprId>>>,
    /// `qdot`, N entries.
    pub velocity: Vec<Option<ExprId>>,
    /// `qdot` as expressions, where these need no guard.
    pub written_velocity: Vec<Option<ExprId>>,
    /// `G_D`, lower triangle.
    pub metric: Vec<Vec<Option<ExprId>>>,
    /// `X^T (f - gdot qdot - Adot - g a)`
    pub right: Vec<Option<ExprId>>,
    /// `udot_i`, if row `i` of `G_D` is 0 except for a positive diagonal entry.
    pub rate: Vec<Option<ExprId>>,
    /// `g(qdot, qdot)`
    pub doubled_kinetic: Option<ExprId>,
}

/// Largest number of coordinates for which invariants are sought, because all expressions are written out.
const COORDINATES: usize = 8;

/// Largest number of distinct subexpressions of a tested expression.
const PARTS: usize = 4000;

/// A value at a real point counts as different from 0 if it exceeds this multiple of its magnitude before cancellation.
const CLEAR: f64 = 1e-9;

/// Number of points at which an expression is evaluated before its zero test.
const SAMPLES: u32 = 3;

/// Seeks expressions that do not depend on the configuration. `None` if the frame is not solved by formulas, or if
/// there are too many coordinates.
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
        .map(|velocity| {
            model
                .pool
                .symbol(&velocity.name, &velocity.name, Assumption::None)
        })
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
    let lowered = search.lowered(&velocity);
    let doubled_kinetic = search.product(&velocity, &lowered);
    let doubled_kinetic = search.fixed(doubled_kinetic);
    let mut fixed = |values: Vec<ExprId>| -> Vec<Option<ExprId>> {
        values
            .into_iter()
            .map(|value| search.fixed(value))
            .collect()
    };
    let metric: Vec<Vec<Option<ExprId>>> = metric.into_iter().map(&mut fixed).collect();
    let right = fixed(right);
    let known: Vec<Vec<Option<ExprId>>> = fields.iter().cloned().map(&mut fixed).collect();
    let raw_velocity = velocity.clone();
    let velocity = fixed(velocity);
    let is_regular = blocks.iter().all(Block::is_regular);
    let written = |known: &[Option<ExprId>], raw: Vec<ExprId>| -> Vec<Option<ExprId>> {
        let pairs = known.iter().zip(raw);
        pairs
            .map(|(known, raw)| known.or(is_regular.then_some(raw)))
            .collect()
    };
    let pairs = known.iter().zip(fields);
    Some(Invariant {
        written: pairs.map(|(known, raw)| written(known, raw)).collect(),
        fields: known,
        written_velocity: written(&velocity, raw_velocity),
        velocity,
        rate: rates(&mut model.pool, &metric, &right),
        metric,
        right,
        doubled_kinetic,
        u,
    })
}

/// The rates that are quotients of a right-hand side and a diagonal entry.
fn rates(
    pool: &mut Pool,
    metric: &[Vec<Option<ExprId>>],
    right: &[Option<ExprId>],
) -> Vec<Option<ExprId>> {
    let entry = |i: usize, j: usize| metric[i.max(j)][i.min(j)];
    (0..right.len())
        .map(|i| {
            let (right, diagonal) = (right[i]?, entry(i, i)?);
            let is_zero = |j| entry(i, j).is_some_and(|entry| pool.is_syntactic_zero(entry));
            let is_alone = (0..metric.len()).all(|j| j == i || is_zero(j));
            let is_solved = is_alone && pool.sign(diagonal) == Sign::Positive;
            is_solved.then(|| {
                let right = factored(pool, right);
                pool.div(right, diagonal)
            })
        })
        .collect()
}

/// Configuration at which expressions are evaluated symbolically: 0, or the middle of an interval.
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

    /// The vector `x` with the given values of `alpha^i(x)` and `eta^a(x)`; `None` if a block has no formula.
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

    /// Component `k` of the solution of a block.
    fn solved(&mut self, block: &Block, rest: &[ExprId], k: usize) -> Option<ExprId> {
        Some(match &block.solve {
            Solve::Entry => {
                let entry = self.form(block.rows[0])[block.columns[0]];
                self.model.pool.div(rest[0], entry)
            }
            Solve::Rows(axes) => {
                let column: Vec<ExprId> = axes.iter().map(|axis| axis.entries[k]).collect();
                let weights = rest.iter().zip(axes);
                let weights: Vec<ExprId> =
                    weights.map(|(&rest, axis)| self.over(rest, axis)).collect();
                self.product(&column, &weights)
            }
            Solve::Columns(axes) => {
                let sum = self.product(&axes[k].entries, rest);
                self.over(sum, &axes[k])
            }
            Solve::General => return None,
        })
    }

    /// `sum / (factor * squared)` of an axis: the coefficient of a vector along the axis, where `sum` is the product of
    /// the vector with the entries of the axis.
    fn over(&mut self, sum: ExprId, axis: &Axis) -> ExprId {
        let powers = [(sum, 1), (axis.factor, -1), (axis.squared, -1)];
        let powers = powers.map(|(base, exponent)| (base, Rational::from(exponent)));
        self.model.pool.power_product(&powers)
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

    /// `f - gdot qdot - Adot - g a` at the velocities `motion` of the frame.
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

    /// Sets the coordinates on which the expression does not depend to their values at the base configuration. `None`
    /// if it depends on all coordinates that occur in it, or if its independence was not proved.
    fn fixed(&mut self, expression: ExprId) -> Option<ExprId> {
        let pool = &self.model.pool;
        let occurs = |(symbol, _): &&(SymbolId, ExprId)| pool.depends_on(expression, *symbol);
        if !self.base.iter().any(|pair| occurs(&pair)) {
            return Some(expression);
        }
        if pool.reachable(&[expression]).len() > PARTS {
            return None;
        }
        let occurring = self.base.iter().filter(occurs);
        let idle = occurring.filter(|(symbol, _)| self.may_be_idle(expression, *symbol));
        let idle: Vec<(SymbolId, ExprId)> = idle.copied().collect();
        if idle.is_empty() {
            return None;
        }
        let pool = &mut self.model.pool;
        let fixed = pool.substitute(expression, &idle);
        let fixed = pool.simplify(fixed);
        let difference = pool.sub(expression, fixed);
        let may_vanish = !pool.is_undefined_constant(fixed) && self.may_vanish(difference);
        let vanishes = may_vanish && self.model.pool.zero_test(difference) == Verdict::Proved;
        vanishes.then_some(fixed)
    }

    /// True if the expression is nearly 0 at all sample points. This cheap test excludes most expressions that do not
    /// vanish.
    fn may_vanish(&self, expression: ExprId) -> bool {
        (0..SAMPLES).all(|sample| {
            let (value, size) = self.at(expression, |symbol| self.sample(symbol, sample));
            value.abs() <= CLEAR * size || !size.is_finite()
        })
    }

    /// True if, at all sample points, the expression nearly keeps its value when `coordinate` changes.
    fn may_be_idle(&self, expression: ExprId, coordinate: SymbolId) -> bool {
        (0..SAMPLES).all(|sample| {
            let moved = |symbol| match symbol == coordinate {
                true => self.sample(symbol, sample + SAMPLES),
                false => self.sample(symbol, sample),
            };
            let (here, size) = self.at(expression, |symbol| self.sample(symbol, sample));
            let (there, other) = self.at(expression, moved);
            let size = size.max(other);
            (here - there).abs() <= CLEAR * size || !size.is_finite()
        })
    }

    fn at(&self, expression: ExprId, symbol: impl Fn(SymbolId) -> f64) -> (f64, f64) {
        self.model.pool.eval_magnitude(expression, &symbol)
    }

    /// A sample value of a symbol, inside its interval.
    fn sample(&self, symbol: SymbolId, sample: u32) -> f64 {
        let number = symbol.index() as f64 + 17.0 * f64::from(sample);
        let share = (0.618_033_988_749_895 * number).fract();
        let coordinate = self
            .model
            .coordinates
            .iter()
            .find(|coordinate| coordinate.q == symbol);
        match coordinate.map(|coordinate| coordinate.topology) {
            Some(Topology::Interval { low, high }) => {
                let ends = self.model.pool.eval(&[low, high], &|_| f64::NAN);
                ends[0] + (0.1 + 0.8 * share) * (ends[1] - ends[0])
            }
            _ => 0.3 + share,
        }
    }
}
