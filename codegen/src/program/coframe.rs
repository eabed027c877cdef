//! The coframe of D as operations: velocities from the values of its forms, block after block in the order of
//! [`crate::mechanics::frame::plan`].

use dalembert_expr::{ExprId, Function as Elementary, Sign};

use super::builder::Builder;
use super::kernel::Kernel;
use super::linear::{Ldlt, Orthogonal};
use super::{Guard, Value};
use crate::mechanics::frame::{Axis, Block, Row, Solve};

/// Velocities that a solve must give, and those already known.
pub(super) struct Asked<'e> {
    /// The velocities that are asked for.
    pub velocities: Vec<bool>,
    /// Expressions of velocities that are known without the solve.
    pub known: &'e [Option<ExprId>],
}

impl Asked<'_> {
    fn known(&self, column: usize) -> Option<ExprId> {
        self.known.get(column).copied().flatten()
    }

    /// True if a velocity is needed and only the solve gives it.
    fn is_solved(&self, needed: &[bool], column: usize) -> bool {
        needed[column] && self.known(column).is_none()
    }
}

impl<'a> Kernel<'a> {
    /// The velocities `x` with `alpha^i(x)` and `eta^a(x)` as given. Velocities that are not asked for are 0, unless a
    /// requested velocity depends on them.
    pub(super) fn solve_frame(
        &mut self,
        asked: &Asked<'_>,
        mut right: impl FnMut(&mut Builder, Row) -> Value,
    ) -> Vec<Value> {
        let zero = self.builder.zero();
        let mut x = vec![zero; self.dimension()];
        let Some(frame) = self.frame() else { return x };
        let needed = self.needed(&frame.blocks, asked);
        for block in &frame.blocks {
            if block
                .columns
                .iter()
                .any(|&column| asked.is_solved(&needed, column))
            {
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
            for &column in block.columns.iter().filter(|&&column| needed[column]) {
                if let Some(known) = asked.known(column) {
                    x[column] = self.value(known);
                }
            }
        }
        x
    }

    /// The requested velocities, and the velocities from which they follow.
    fn needed(&self, blocks: &[Block], asked: &Asked<'_>) -> Vec<bool> {
        let mut needed = asked.velocities.clone();
        for block in blocks.iter().rev() {
            if block
                .columns
                .iter()
                .any(|&column| asked.is_solved(&needed, column))
            {
                for &row in &block.rows {
                    for (needed, &entry) in needed.iter_mut().zip(self.coframe_row(row)) {
                        *needed |= !self.model.pool.is_syntactic_zero(entry);
                    }
                }
            }
        }
        needed
    }

    /// A right-hand side minus the terms of the velocities known so far; unknown velocities count as 0.
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
        match &block.solve {
            Solve::Entry => {
                let entry = self.coframe_row(block.rows[0])[block.columns[0]];
                let entry = self.value(entry);
                vec![self.builder.div(right[0], entry)]
            }
            Solve::Rows(axes) => self.solve_rows(block, axes, &right),
            Solve::Columns(axes) => self.solve_columns(block, axes, &right),
            Solve::General => {
                let entries = self.block_entries(block);
                self.orthogonal_block(block, entries)
                    .least_norm(&mut self.builder, &right)
            }
        }
    }

    /// `sum_a r_a d_a / (f_a d_a . d_a)` over the rows `f_a d_a`.
    fn solve_rows(&mut self, block: &Block, axes: &[Axis], right: &[Value]) -> Vec<Value> {
        let mut total = vec![self.builder.zero(); axes.len()];
        for ((axis, &row), &right) in axes.iter().zip(&block.rows).zip(right) {
            let entries = self.values(&axis.entries);
            let weight = self.over_axis(right, axis, row);
            for (entry, component) in total.iter_mut().zip(entries) {
                *entry = self.builder.add_product(*entry, weight, component);
            }
        }
        total
    }

    /// `d_k . r / (f_k d_k . d_k)` for each column `f_k d_k`.
    fn solve_columns(&mut self, block: &Block, axes: &[Axis], right: &[Value]) -> Vec<Value> {
        let row = named_row(block);
        axes.iter()
            .map(|axis| {
                let entries = self.values(&axis.entries);
                let sum = self.dot(&entries, right);
                self.over_axis(sum, axis, row)
            })
            .collect()
    }

    /// A value divided by the factor of an axis and by the sum of the squares of its entries.
    fn over_axis(&mut self, value: Value, axis: &Axis, row: Row) -> Value {
        let factor = self.axis_factor(axis, row);
        let square = self.value(axis.squared);
        let denominator = self.builder.mul(factor, square);
        self.builder.div(value, denominator)
    }

    /// The factor of an axis; where it may vanish a guard names the row.
    fn axis_factor(&mut self, axis: &Axis, row: Row) -> Value {
        let factor = self.value(axis.factor);
        if let Some(bound) = axis.bound {
            let bound = self.value(bound);
            let squared = self.builder.mul(factor, factor);
            let reference = self.builder.mul(bound, bound);
            self.builder.guard(row_guard(row, squared, Some(reference)));
        }
        factor
    }

    /// The rows of a block orthogonalised, with guards: a declared frame may be singular somewhere.
    fn orthogonal_block(&mut self, block: &Block, entries: Vec<Vec<Value>>) -> Orthogonal {
        let flat = Ldlt::identity(&mut self.builder, block.columns.len());
        Orthogonal::factor(
            &mut self.builder,
            &flat,
            entries,
            |index, squared, reference| row_guard(block.rows[index], squared, reference),
        )
    }

    /// `|det|` of a block: the absolute value of its only entry, or the root of the product of squared norms.
    pub(super) fn block_determinant(&mut self, block: &Block) -> Value {
        match &block.solve {
            Solve::Entry => {
                let entry = self.coframe_row(block.rows[0])[block.columns[0]];
                let value = self.value(entry);
                match self.model.pool.sign(entry) {
                    Sign::Positive => value,
                    _ => self.builder.call(Elementary::Abs, value),
                }
            }
            Solve::Rows(axes) => {
                let named: Vec<(&Axis, Row)> =
                    axes.iter().zip(block.rows.iter().copied()).collect();
                self.axes_determinant(&named)
            }
            Solve::Columns(axes) => {
                let row = named_row(block);
                let named: Vec<(&Axis, Row)> = axes.iter().map(|axis| (axis, row)).collect();
                self.axes_determinant(&named)
            }
            Solve::General => {
                let entries = self.block_entries(block);
                let squares = self.orthogonal_block(block, entries).squares;
                self.root_of_product(&squares)
            }
        }
    }

    /// `prod |f_k| |d_k|`
    fn axes_determinant(&mut self, axes: &[(&Axis, Row)]) -> Value {
        let squares: Vec<ExprId> = axes.iter().map(|(axis, _)| axis.squared).collect();
        let squares = self.values(&squares);
        let mut size = self.root_of_product(&squares);
        for &(axis, row) in axes {
            let mut factor = self.axis_factor(axis, row);
            if self.model.pool.sign(axis.factor) != Sign::Positive {
                factor = self.builder.call(Elementary::Abs, factor);
            }
            size = self.builder.mul(size, factor);
        }
        size
    }

    fn root_of_product(&mut self, squares: &[Value]) -> Value {
        let mut product = self.builder.integer(1);
        for &square in squares {
            product = self.builder.mul(product, square);
        }
        match self.builder.as_number(product) {
            Some(number) if number.is_one() => product,
            _ => self.builder.sqrt(product),
        }
    }
}

/// The row that a guard of columns names: the last quasi-velocity of the block.
fn named_row(block: &Block) -> Row {
    let last = block.rows.iter().rev();
    let row = last.copied().find(|row| matches!(row, Row::Quasi(_)));
    row.unwrap_or(block.rows[0])
}

/// The guard for a row: the row depends on the others where `squared` is negligible against `reference`.
fn row_guard(row: Row, squared: Value, reference: Option<Value>) -> Guard {
    match row {
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
    }
}
