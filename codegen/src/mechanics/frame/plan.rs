//! Order in which the coframe `(alpha, eta)` is solved for the velocities, block by block.
//!
//! A row with one column left is solved first, and a column with one row left is solved last, if their entry is never
//! zero. The remaining rows and columns fall into connected blocks. A block with orthogonal rows or columns is solved
//! by products, any other by orthogonalisation in the emitted code.

use dalembert_expr::{ExprId, Pool};

use super::QuasiVelocity;
use super::axis::{Axis, orthogonal};
use crate::mechanics::ConstraintForm;

/// A row of the coframe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Row {
    /// `alpha^i`
    Quasi(usize),
    /// `eta^a`
    Constraint(usize),
}

/// A block with as many rows as columns, solved together once the columns of earlier blocks are known.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Block {
    /// The rows.
    pub rows: Vec<Row>,
    /// The coordinates whose velocities they give.
    pub columns: Vec<usize>,
    /// Method of solution.
    pub solve: Solve,
}

impl Block {
    /// True if it can be solved at every state.
    pub(super) fn is_regular(&self) -> bool {
        match &self.solve {
            Solve::Entry => true,
            Solve::Rows(axes) | Solve::Columns(axes) => {
                axes.iter().all(|axis| axis.bound.is_none())
            }
            Solve::General => false,
        }
    }
}

/// Method by which a block is solved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Solve {
    /// Division: one row, one column, an entry that is never zero.
    Entry,
    /// Products: the rows are orthogonal. Guarded where a factor may vanish.
    Rows(Vec<Axis>),
    /// Products: the columns are orthogonal. Guarded where a factor may vanish.
    Columns(Vec<Axis>),
    /// Orthogonalisation, guarded.
    General,
}

/// The blocks in the order in which they are solved.
pub(super) fn plan(
    pool: &mut Pool,
    quasi: &[QuasiVelocity],
    constraints: &[ConstraintForm],
) -> Vec<Block> {
    let mut matrix = Matrix::new(quasi, constraints);
    let (mut first, mut last) = (Vec::new(), Vec::new());
    loop {
        if let Some(block) = matrix.lone_column_in_row(pool) {
            first.push(block);
        } else if let Some(block) = matrix.lone_row_in_column(pool) {
            last.push(block);
        } else {
            break;
        }
    }
    while let Some((rows, columns)) = matrix.component(pool) {
        let solve = matrix.solve(pool, &rows, &columns);
        let rows = rows.into_iter().map(|row| matrix.rows[row].0).collect();
        first.push(Block {
            rows,
            columns,
            solve,
        });
    }
    last.reverse();
    first.extend(last);
    first
}

/// The rows and columns that are in no block yet.
struct Matrix<'a> {
    rows: Vec<(Row, &'a [ExprId])>,
    free_rows: Vec<usize>,
    free_columns: Vec<usize>,
}

impl<'a> Matrix<'a> {
    fn new(quasi: &'a [QuasiVelocity], constraints: &'a [ConstraintForm]) -> Self {
        let quasi = quasi.iter().enumerate();
        let constraints = constraints.iter().enumerate();
        let rows: Vec<(Row, &[ExprId])> = quasi
            .map(|(i, velocity)| (Row::Quasi(i), velocity.form.as_slice()))
            .chain(
                constraints.map(|(a, constraint)| (Row::Constraint(a), constraint.form.as_slice())),
            )
            .collect();
        Self {
            free_rows: (0..rows.len()).collect(),
            free_columns: (0..rows.len()).collect(),
            rows,
        }
    }

    fn holds(&self, pool: &Pool, row: usize, column: usize) -> bool {
        !pool.is_syntactic_zero(self.rows[row].1[column])
    }

    /// A row with one column left and an entry that is never zero. It is solved next.
    fn lone_column_in_row(&mut self, pool: &Pool) -> Option<Block> {
        let entry = self.free_rows.iter().find_map(|&row| {
            let mut columns = self.free_columns.iter();
            let column = *columns.find(|&&column| self.holds(pool, row, column))?;
            let is_lone = !columns.any(|&other| self.holds(pool, row, other));
            (is_lone && self.is_regular(pool, row, column)).then_some((row, column))
        });
        self.take_entry(entry?)
    }

    /// A column with one row left and an entry that is never zero. It is solved last.
    fn lone_row_in_column(&mut self, pool: &Pool) -> Option<Block> {
        let entry = self.free_columns.iter().find_map(|&column| {
            let mut rows = self.free_rows.iter();
            let row = *rows.find(|&&row| self.holds(pool, row, column))?;
            let is_lone = !rows.any(|&other| self.holds(pool, other, column));
            (is_lone && self.is_regular(pool, row, column)).then_some((row, column))
        });
        self.take_entry(entry?)
    }

    fn is_regular(&self, pool: &Pool, row: usize, column: usize) -> bool {
        pool.sign(self.rows[row].1[column]).is_nonzero()
    }

    fn take_entry(&mut self, (row, column): (usize, usize)) -> Option<Block> {
        self.free_rows.retain(|&free| free != row);
        self.free_columns.retain(|&free| free != column);
        Some(Block {
            rows: vec![self.rows[row].0],
            columns: vec![column],
            solve: Solve::Entry,
        })
    }

    /// Removes and returns the rows and columns connected with the first remaining row.
    fn component(&mut self, pool: &Pool) -> Option<(Vec<usize>, Vec<usize>)> {
        let mut rows = vec![*self.free_rows.first()?];
        let mut columns: Vec<usize> = Vec::new();
        loop {
            let is_met = |column: &usize| rows.iter().any(|&row| self.holds(pool, row, *column));
            let met: Vec<usize> = self.free_columns.iter().copied().filter(is_met).collect();
            let hangs = |row: &usize| met.iter().any(|&column| self.holds(pool, *row, column));
            let next: Vec<usize> = self.free_rows.iter().copied().filter(hangs).collect();
            let is_done = met == columns && next == rows;
            (rows, columns) = (next, met);
            if is_done || rows.is_empty() {
                break;
            }
        }
        // A component that is not square belongs to a coframe that is singular everywhere, which was refused. It takes
        // all remaining rows and columns, so that the block is square.
        if rows.is_empty() || rows.len() != columns.len() {
            (rows, columns) = (self.free_rows.clone(), self.free_columns.clone());
        }
        self.free_rows.retain(|row| !rows.contains(row));
        self.free_columns.retain(|column| !columns.contains(column));
        Some((rows, columns))
    }

    fn solve(&self, pool: &mut Pool, rows: &[usize], columns: &[usize]) -> Solve {
        let entries: Vec<Vec<ExprId>> = rows
            .iter()
            .map(|&row| {
                columns
                    .iter()
                    .map(|&column| self.rows[row].1[column])
                    .collect()
            })
            .collect();
        if let Some(axes) = orthogonal(pool, &entries) {
            return Solve::Rows(axes);
        }
        let transposed: Vec<Vec<ExprId>> = (0..columns.len())
            .map(|column| entries.iter().map(|row| row[column]).collect())
            .collect();
        match orthogonal(pool, &transposed) {
            Some(axes) => Solve::Columns(axes),
            None => Solve::General,
        }
    }
}
