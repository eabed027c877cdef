//! The motion reduced to D as operations: velocities from quasi-velocities, the metric on D, the rates of the
//! quasi-velocities. Formulas: [`crate::mechanics::frame`].

use dalembert_expr::{ExprId, Function as Elementary, Sign};

use super::builder::Builder;
use super::kernel::Kernel;
use super::linear::{Ldlt, Orthogonal};
use super::{Guard, Input, Value};
use crate::mechanics::Frame;
use crate::mechanics::frame::{Block, Invariant, Row, Solve};

impl<'a> Kernel<'a> {
    /// The frame. A function in reduced form is made only where there is one.
    fn frame(&self) -> Option<&'a Frame> {
        self.derivation.frame.as_ref().ok()
    }

    /// Number of quasi-velocities.
    pub fn quasi_velocities(&self) -> usize {
        self.frame().map_or(0, |frame| frame.quasi.len())
    }

    /// `u`
    pub fn quasi_inputs(&mut self) -> Vec<Value> {
        let inputs = 0..self.quasi_velocities();
        inputs
            .map(|i| self.builder.input(Input::Quasi(i)))
            .collect()
    }

    /// `X_0 + X_i u^i` at the given quasi-velocities.
    pub(super) fn velocity_from_quasi(&mut self) -> Vec<Value> {
        let u = self.quasi_inputs();
        let affine = self.minus_affine();
        let mut velocity = self.solve_frame(|_, row| match row {
            Row::Quasi(i) => u[i],
            Row::Constraint(a) => affine[a],
        });
        let Some(invariant) = self.invariant() else {
            return velocity;
        };
        for (&symbol, &value) in invariant.u.iter().zip(&u) {
            self.bind_value(symbol, value);
        }
        for (entry, &fixed) in velocity.iter_mut().zip(&invariant.velocity) {
            if let Some(fixed) = fixed {
                *entry = self.value(fixed);
            }
        }
        velocity
    }

    /// What does not depend on the configuration.
    fn invariant(&self) -> Option<&'a Invariant> {
        self.frame()?.invariant.as_ref()
    }

    /// `-eta_0`
    fn minus_affine(&mut self) -> Vec<Value> {
        let constraints = self.derivation.constraints.iter();
        let affine: Vec<ExprId> = constraints.map(|constraint| constraint.affine).collect();
        let affine = self.values(&affine);
        affine
            .iter()
            .map(|&value| self.builder.neg(value))
            .collect()
    }

    /// The velocities `x` with `alpha^i(x)` and `eta^a(x)` as given.
    fn solve_frame(&mut self, mut right: impl FnMut(&mut Builder, Row) -> Value) -> Vec<Value> {
        let zero = self.builder.zero();
        let mut x = vec![zero; self.dimension()];
        let Some(frame) = self.frame() else { return x };
        for block in &frame.blocks {
            let rest: Vec<Value> = block
                .rows
                .iter()
                .map(|&row| {
                    let wanted = right(&mut self.builder, row);
                    self.without_known(row, wanted, &x)
                })
                .collect();
            let solved = self.solve_block(block, rest);
            for (&column, value) in block.columns.iter().zip(solved) {
                x[column] = value;
            }
        }
        x
    }

    /// What is left of a right-hand side without the columns known so far; those that are not are 0.
    fn without_known(&mut self, row: Row, wanted: Value, known: &[Value]) -> Value {
        let form = self.coframe_row(row);
        let mut rest = wanted;
        for (&entry, &value) in form.iter().zip(known) {
            if !self.builder.is_zero(value) && !self.model.pool.is_syntactic_zero(entry) {
                let entry = self.value(entry);
                rest = self.builder.sub_product(rest, entry, value);
            }
        }
        rest
    }

    fn coframe_row(&self, row: Row) -> &'a [ExprId] {
        match (row, self.frame()) {
            (Row::Quasi(i), Some(frame)) => &frame.quasi[i].form,
            (Row::Quasi(_), None) => &[],
            (Row::Constraint(a), _) => &self.derivation.constraints[a].form,
        }
    }

    /// The entries of a block, row after row.
    fn block_entries(&mut self, block: &Block) -> Vec<Vec<Value>> {
        let rows = block.rows.iter();
        rows.map(|&row| {
            let form = self.coframe_row(row);
            let entries: Vec<ExprId> = block.columns.iter().map(|&j| form[j]).collect();
            self.values(&entries)
        })
        .collect()
    }

    fn solve_block(&mut self, block: &Block, right: Vec<Value>) -> Vec<Value> {
        if right.iter().all(|&value| self.builder.is_zero(value)) {
            return right;
        }
        let entries = self.block_entries(block);
        match &block.solve {
            Solve::Entry => vec![self.builder.div(right[0], entries[0][0])],
            Solve::Rows(squares) => {
                let squares = self.values(squares);
                let weights: Vec<Value> = right
                    .iter()
                    .zip(squares)
                    .map(|(&value, square)| self.builder.div(value, square))
                    .collect();
                self.combine(&entries, &weights)
            }
            Solve::Columns(squares) => {
                let sums = self.combine(&entries, &right);
                let squares = self.values(squares);
                sums.iter()
                    .zip(squares)
                    .map(|(&sum, square)| self.builder.div(sum, square))
                    .collect()
            }
            Solve::General => self
                .orthogonal_block(block, entries)
                .least_norm(&mut self.builder, &right),
        }
    }

    /// `weights` times the rows.
    fn combine(&mut self, rows: &[Vec<Value>], weights: &[Value]) -> Vec<Value> {
        let columns = rows.first().map_or(0, Vec::len);
        let mut total = vec![self.builder.zero(); columns];
        for (row, &weight) in rows.iter().zip(weights) {
            for (entry, &component) in total.iter_mut().zip(row) {
                *entry = self.builder.add_product(*entry, weight, component);
            }
        }
        total
    }

    /// The rows of a block orthogonalised, with guards: a declared frame may be singular somewhere.
    fn orthogonal_block(&mut self, block: &Block, entries: Vec<Vec<Value>>) -> Orthogonal {
        let flat = Ldlt::identity(&mut self.builder, block.columns.len());
        Orthogonal::factor(
            &mut self.builder,
            &flat,
            entries,
            |index, squared, reference| match block.rows[index] {
                Row::Quasi(quasi) => Guard::Frame {
                    quasi,
                    squared,
                    reference,
                },
                Row::Constraint(constraint) => Guard::Constraint {
                    constraint,
                    squared,
                    reference,
                },
            },
        )
    }

    /// `X_i`, N - M rows of N.
    pub fn frame_fields(&mut self) -> Vec<Vec<Value>> {
        if let Some(fields) = &self.frame_fields {
            return fields.clone();
        }
        let fields: Vec<Vec<Value>> = (0..self.quasi_velocities())
            .map(|i| {
                self.solve_frame(|builder, row| builder.integer(i64::from(row == Row::Quasi(i))))
            })
            .collect();
        self.frame_fields = Some(fields.clone());
        fields
    }

    /// `X_0`
    pub fn affine_field(&mut self) -> Vec<Value> {
        let affine = self.minus_affine();
        self.solve_frame(|builder, row| match row {
            Row::Quasi(_) => builder.zero(),
            Row::Constraint(a) => affine[a],
        })
    }

    /// `g v`
    pub fn lower_vector(&mut self, v: &[Value]) -> Vec<Value> {
        (0..self.dimension())
            .map(|i| {
                let row = self.model.lagrangian.metric[i].clone();
                let mut total = self.builder.zero();
                for (&entry, &component) in row.iter().zip(v) {
                    if !self.builder.is_zero(component) && !self.model.pool.is_syntactic_zero(entry)
                    {
                        let entry = self.value(entry);
                        total = self.builder.add_product(total, entry, component);
                    }
                }
                total
            })
            .collect()
    }

    /// `X^T b`
    pub fn restrict(&mut self, b: &[Value]) -> Vec<Value> {
        let fields = self.frame_fields();
        fields.iter().map(|field| self.dot(field, b)).collect()
    }

    /// `G_D = X^T g X`, the lower triangle.
    pub fn reduced_metric(&mut self) -> Vec<Vec<Value>> {
        let fields = self.frame_fields();
        let lowered: Vec<Vec<Value>> = fields
            .iter()
            .map(|field| self.lower_vector(field))
            .collect();
        let fixed = self.invariant().map(|invariant| &invariant.metric);
        (0..fields.len())
            .map(|i| {
                let entry = |j: usize| match fixed.and_then(|metric| metric[i][j]) {
                    Some(fixed) => self.value(fixed),
                    None => self.dot(&fields[i], &lowered[j]),
                };
                (0..=i).map(entry).collect()
            })
            .collect()
    }

    /// Runs `work` with the factors of `G_D`.
    pub fn with_reduced_ldlt<T>(&mut self, work: impl FnOnce(&mut Builder, &Ldlt) -> T) -> T {
        let ldlt = match self.reduced_ldlt.take() {
            Some(ldlt) => ldlt,
            None => {
                let metric = self.reduced_metric();
                let all_positive = self.metric_is_positive();
                let positive: Vec<bool> = (0..metric.len())
                    .map(|i| all_positive || self.is_positive_entry(i))
                    .collect();
                Ldlt::factor(&mut self.builder, &metric, &positive)
            }
        };
        let result = work(&mut self.builder, &ldlt);
        self.reduced_ldlt = Some(ldlt);
        result
    }

    /// Whether the metric is diagonal with entries known to be positive: then so are the entries on the diagonal of
    /// `G_D`, as no `X_i` vanishes.
    fn metric_is_positive(&self) -> bool {
        let (pool, metric) = (&self.model.pool, &self.model.lagrangian.metric);
        metric.iter().enumerate().all(|(i, row)| {
            pool.sign(row[i]) == Sign::Positive
                && row[..i].iter().all(|&entry| pool.is_syntactic_zero(entry))
        })
    }

    /// Whether an entry on the diagonal of `G_D` does not depend on the configuration and is known to be positive.
    fn is_positive_entry(&self, i: usize) -> bool {
        let fixed = self.invariant().and_then(|own| own.metric[i][i]);
        fixed.is_some_and(|fixed| self.model.pool.sign(fixed) == Sign::Positive)
    }

    /// `G_D^{-1} b`
    pub fn raise_reduced(&mut self, b: &[Value]) -> Vec<Value> {
        self.with_reduced_ldlt(|builder, ldlt| ldlt.solve(builder, b))
    }

    /// `a = Xdot u + Xdot_0`, the acceleration at quasi-velocities that do not change.
    pub fn frame_acceleration(&mut self) -> Vec<Value> {
        let Some(frame) = self.frame() else {
            return Vec::new();
        };
        let quasi: Vec<ExprId> = frame.quasi.iter().map(|own| own.curvature).collect();
        let constraints = self.derivation.constraints.iter();
        let constraints: Vec<ExprId> = constraints.map(|own| own.curvature).collect();
        let (quasi, constraints) = (self.values(&quasi), self.values(&constraints));
        self.solve_frame(|builder, row| match row {
            Row::Quasi(i) => builder.neg(quasi[i]),
            Row::Constraint(a) => builder.neg(constraints[a]),
        })
    }

    /// `X w`
    pub fn along_frame(&mut self, w: &[Value]) -> Vec<Value> {
        let fields = self.frame_fields();
        let mut total = vec![self.builder.zero(); self.dimension()];
        for (field, &weight) in fields.iter().zip(w) {
            for (entry, &component) in total.iter_mut().zip(field) {
                *entry = self.builder.add_product(*entry, weight, component);
            }
        }
        total
    }

    /// `udot`
    pub fn quasi_rate(&mut self) -> Vec<Value> {
        self.velocity();
        let free = self.force_without_drift();
        let acceleration = self.frame_acceleration();
        let inertial = self.lower_vector(&acceleration);
        let rest: Vec<Value> = free
            .iter()
            .zip(&inertial)
            .map(|(&f, &b)| self.builder.sub(f, b))
            .collect();
        let mut right = self.restrict(&rest);
        let fixed = self.invariant().map(|invariant| &invariant.right);
        for (entry, fixed) in right.iter_mut().zip(fixed.into_iter().flatten()) {
            if let &Some(fixed) = fixed {
                *entry = self.value(fixed);
            }
        }
        let rate = self.raise_reduced(&right);
        if let Some(frame) = self.frame() {
            for (quasi, &value) in frame.quasi.iter().zip(&rate) {
                self.builder.name(value, format!("{}_rate", quasi.name));
            }
        }
        rate
    }

    /// `det g / |det (alpha, eta)|`, the density of `mu_C` in positions and quasi-velocities.
    pub fn density_in_frame(&mut self) -> Value {
        let pivots = self.with_ldlt(|_, ldlt| ldlt.pivots.clone());
        let mut density = self.builder.integer(1);
        for pivot in pivots {
            density = self.builder.mul(density, pivot);
        }
        let blocks = self.frame().map_or(&[][..], |frame| &frame.blocks);
        for block in blocks {
            let size = self.block_determinant(block);
            density = self.builder.div(density, size);
        }
        density
    }

    /// `|det|` of a block: the entry, or the root of the product of squared norms.
    fn block_determinant(&mut self, block: &Block) -> Value {
        let squares = match &block.solve {
            Solve::Entry => {
                let entry = self.coframe_row(block.rows[0])[block.columns[0]];
                let value = self.value(entry);
                return match self.model.pool.sign(entry) {
                    Sign::Positive => value,
                    _ => self.builder.call(Elementary::Abs, value),
                };
            }
            Solve::Rows(squares) | Solve::Columns(squares) => self.values(squares),
            Solve::General => {
                let entries = self.block_entries(block);
                self.orthogonal_block(block, entries).squares
            }
        };
        let mut product = self.builder.integer(1);
        for square in squares {
            product = self.builder.mul(product, square);
        }
        match self.builder.as_number(product) {
            Some(number) if number.is_one() => product,
            _ => self.builder.sqrt(product),
        }
    }

    /// The quasi-velocities with `G_D u = X^T (b - g X_0)`: those of the allowed velocity nearest to `g^{-1} b`.
    pub fn nearest_quasi(&mut self, b: &[Value]) -> Vec<Value> {
        let affine = self.affine_field();
        let shift = self.lower_vector(&affine);
        let rest: Vec<Value> = b
            .iter()
            .zip(&shift)
            .map(|(&b, &shift)| self.builder.sub(b, shift))
            .collect();
        let right = self.restrict(&rest);
        self.raise_reduced(&right)
    }
}
