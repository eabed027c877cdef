//! Linear algebra as operations: sparse `L D L^T` of the metric, and solution for the multipliers by orthogonalisation.
//!
//! **Metric.** `g = L D L^T` with unit lower triangular `L`, in coordinate order. Structural zeros cost no operations.
//! A pivot that is not known to be positive has a guard. Where the velocities of the kinetic energy follow from one another, `L` is
//! the elimination along them instead: see [`super::linked`].
//!
//! **Constraints.** Let `C = L^{-1} eta^T` (N rows, M columns), and let `<u, v> = u^T D^{-1} v` be the inner product,
//! so that `m^{ab} = <C_a, C_b>`. Modified Gram-Schmidt without square roots gives `C = Q U` with unit upper triangular
//! `U` and `<Q_a, Q_b> = n_a delta_ab`. Hence `m = U^T diag(n) U`, although `m` is never formed. Forming it would
//! square the condition number, and lose all digits for nearly dependent forms. The right-hand side is orthogonalised
//! as a further column, which makes the solution backward stable (Bjorck, BIT 7 (1967)). Many constraints, each coupled
//! with few others, are an exception: see [`super::mass`].

use super::builder::Builder;
use super::linked::Elimination;
use super::{Guard, Value};

/// The factorisation `g = L D L^T`.
#[derive(Debug)]
pub struct Ldlt {
    lower: Lower,
    /// `D_i`, N entries. Their product is `det g`.
    pub pivots: Vec<Value>,
    /// `1 / D_i`
    inverse_pivots: Vec<Value>,
}

/// The factor `L`.
#[derive(Debug)]
enum Lower {
    /// Entries below the diagonal: `rows[i][j]`, `j < i`.
    Rows(Vec<Vec<Value>>),
    /// A product of the steps of an elimination. `L` is lower triangular in the order of the pivots.
    Linked(Elimination),
}

impl Ldlt {
    /// The factors that an elimination along a linkage gives.
    pub fn of_elimination(
        builder: &mut Builder,
        elimination: Elimination,
        pivots: Vec<Value>,
    ) -> Self {
        let inverse_pivots = pivots
            .iter()
            .map(|&pivot| builder.reciprocal(pivot))
            .collect();
        Self {
            lower: Lower::Linked(elimination),
            pivots,
            inverse_pivots,
        }
    }

    /// Factorises a metric, given by `metric[i][j]` for `j <= i`. `positive[i]` is true if `metric[i][i]` is known to
    /// be positive.
    pub fn factor(builder: &mut Builder, metric: &[Vec<Value>], positive: &[bool]) -> Self {
        Self::factor_guarded(builder, metric, &[], |builder, i, value| {
            if !(positive[i] && value == metric[i][i]) {
                builder.guard(Guard::Pivot { pivot: i, value });
            }
        })
    }

    /// Factorises a metric whose rows may be partly `known`. `guard` is called for each pivot before any division by
    /// it.
    pub fn factor_guarded(
        builder: &mut Builder,
        metric: &[Vec<Value>],
        known: &[Option<KnownRow>],
        guard: impl Fn(&mut Builder, usize, Value),
    ) -> Self {
        let n = metric.len();
        let mut below: Vec<Vec<Value>> = Vec::with_capacity(n);
        let mut pivots: Vec<Value> = Vec::with_capacity(n);
        let mut inverse_pivots: Vec<Value> = Vec::with_capacity(n);
        for i in 0..n {
            let (row, pivot) = match known.get(i) {
                Some(Some(known)) => (known.below.clone(), known.pivot),
                _ => eliminate(builder, &metric[i], &below, &inverse_pivots),
            };
            guard(builder, i, pivot);
            inverse_pivots.push(builder.reciprocal(pivot));
            pivots.push(pivot);
            below.push(row);
        }
        Self {
            lower: Lower::Rows(below),
            pivots,
            inverse_pivots,
        }
    }

    /// `y^T D^{-1} y`, with one division per distinct pivot.
    pub fn weighted_square(&self, builder: &mut Builder, y: &[Value]) -> Value {
        let mut sums: Vec<(Value, Value)> = Vec::new();
        for (&component, &pivot) in y.iter().zip(&self.pivots) {
            let square = builder.mul(component, component);
            match sums.iter_mut().find(|(known, _)| *known == pivot) {
                Some((_, sum)) => *sum = builder.add(*sum, square),
                None => sums.push((pivot, square)),
            }
        }
        let mut total = builder.zero();
        for (pivot, sum) in sums {
            let quotient = builder.div(sum, pivot);
            total = builder.add(total, quotient);
        }
        total
    }

    /// The factors of the identity matrix. Their inner product is the ordinary one.
    pub fn identity(builder: &mut Builder, n: usize) -> Self {
        let (zero, one) = (builder.zero(), builder.integer(1));
        Self {
            lower: Lower::Rows((0..n).map(|i| vec![zero; i]).collect()),
            pivots: vec![one; n],
            inverse_pivots: vec![one; n],
        }
    }

    /// `L^{-1} b`
    pub fn forward(&self, builder: &mut Builder, b: &[Value]) -> Vec<Value> {
        let below = match &self.lower {
            Lower::Rows(below) => below,
            Lower::Linked(elimination) => return elimination.forward(builder, b),
        };
        let mut y: Vec<Value> = Vec::with_capacity(b.len());
        for (i, &right) in b.iter().enumerate() {
            let mut entry = right;
            for (j, &known) in y.iter().enumerate() {
                entry = builder.sub_product(entry, below[i][j], known);
            }
            y.push(entry);
        }
        y
    }

    /// `L^{-T} D^{-1} y`, the second half of a solution.
    pub fn backward(&self, builder: &mut Builder, y: &[Value]) -> Vec<Value> {
        let mut x: Vec<Value> = (0..y.len())
            .map(|i| builder.mul(y[i], self.inverse_pivots[i]))
            .collect();
        let below = match &self.lower {
            Lower::Rows(below) => below,
            Lower::Linked(elimination) => return elimination.backward(builder, &x),
        };
        for i in (0..y.len()).rev() {
            for j in i + 1..y.len() {
                x[i] = builder.sub_product(x[i], below[j][i], x[j]);
            }
        }
        x
    }

    /// `g^{-1} b`
    pub fn solve(&self, builder: &mut Builder, b: &[Value]) -> Vec<Value> {
        let y = self.forward(builder, b);
        self.backward(builder, &y)
    }

    /// `L y`
    pub fn lower_times(&self, builder: &mut Builder, y: &[Value]) -> Vec<Value> {
        let below = match &self.lower {
            Lower::Rows(below) => below,
            Lower::Linked(elimination) => return elimination.lower_times(builder, y),
        };
        (0..y.len())
            .map(|i| {
                let mut entry = y[i];
                for j in 0..i {
                    entry = builder.add_product(entry, below[i][j], y[j]);
                }
                entry
            })
            .collect()
    }

    /// `<u, v> = u^T D^{-1} v`
    pub fn inner(&self, builder: &mut Builder, u: &[Value], v: &[Value]) -> Value {
        let mut total = builder.zero();
        for i in 0..u.len() {
            if builder.is_zero(u[i]) || builder.is_zero(v[i]) {
                continue;
            }
            let weighted = builder.mul(u[i], self.inverse_pivots[i]);
            total = builder.add_product(total, weighted, v[i]);
        }
        total
    }
}

/// A row of the factors that is known in advance.
#[derive(Debug)]
pub struct KnownRow {
    /// `L_ij`, `j < i`.
    pub below: Vec<Value>,
    /// `D_i`
    pub pivot: Value,
}

/// Row of `L` and pivot, by elimination from a row of the metric.
fn eliminate(
    builder: &mut Builder,
    metric: &[Value],
    below: &[Vec<Value>],
    inverse_pivots: &[Value],
) -> (Vec<Value>, Value) {
    let i = below.len();
    // Row i of the unscaled factor: `scaled[j] = L_ij D_j`.
    let mut scaled: Vec<Value> = Vec::with_capacity(i);
    for j in 0..i {
        let mut entry = metric[j];
        for k in 0..j {
            entry = builder.sub_product(entry, scaled[k], below[j][k]);
        }
        scaled.push(entry);
    }
    let row: Vec<Value> = (0..i)
        .map(|j| builder.mul(scaled[j], inverse_pivots[j]))
        .collect();
    let mut pivot = metric[i];
    for j in 0..i {
        pivot = builder.sub_product(pivot, scaled[j], row[j]);
    }
    (row, pivot)
}

/// The factorisation `L^{-1} eta^T = Q U` with `<Q_a, Q_b> = n_a delta_ab`.
#[derive(Debug)]
pub struct Orthogonal {
    /// Columns of `Q`.
    columns: Vec<Vec<Value>>,
    /// Entries of `U` above the diagonal: `above[a][b] = U_ba`, `b < a`.
    above: Vec<Vec<Value>>,
    /// `n_a`, M entries. Their product is `det m^{ab}`.
    pub squares: Vec<Value>,
    /// `1 / n_a`
    inverse_squares: Vec<Value>,
}

impl Orthogonal {
    /// Orthogonalises columns. `guard` makes the guard of a column, if it needs one. Its arguments are the index of the
    /// column, and its squared norms after and before the earlier columns were projected out. The norm before is `None`
    /// for the first column.
    pub fn factor<G: Into<Option<Guard>>>(
        builder: &mut Builder,
        ldlt: &Ldlt,
        columns: Vec<Vec<Value>>,
        guard: impl Fn(usize, Value, Option<Value>) -> G,
    ) -> Self {
        let mut factors = Self {
            columns: Vec::new(),
            above: Vec::new(),
            squares: Vec::new(),
            inverse_squares: Vec::new(),
        };
        for (index, column) in columns.into_iter().enumerate() {
            let reference = (index > 0).then(|| ldlt.inner(builder, &column, &column));
            let (coefficients, rest) = factors.reduce(builder, ldlt, column);
            let squared = ldlt.inner(builder, &rest, &rest);
            if let Some(guard) = guard(index, squared, reference).into() {
                builder.guard(guard);
            }
            factors.inverse_squares.push(builder.reciprocal(squared));
            factors.squares.push(squared);
            factors.above.push(coefficients);
            factors.columns.push(rest);
        }
        factors
    }

    /// Removes the components of `y` along the columns, one after the other. Returns the components and the remainder.
    pub fn reduce(
        &self,
        builder: &mut Builder,
        ldlt: &Ldlt,
        mut y: Vec<Value>,
    ) -> (Vec<Value>, Vec<Value>) {
        let mut coefficients = Vec::with_capacity(self.columns.len());
        for (column, &inverse) in self.columns.iter().zip(&self.inverse_squares) {
            let product = ldlt.inner(builder, column, &y);
            let coefficient = builder.mul(product, inverse);
            for (entry, &direction) in y.iter_mut().zip(column) {
                *entry = builder.sub_product(*entry, coefficient, direction);
            }
            coefficients.push(coefficient);
        }
        (coefficients, y)
    }

    /// The multipliers `lambda` with `m lambda = -(C^T D^{-1} y + s)`.
    pub fn solve(
        &self,
        builder: &mut Builder,
        ldlt: &Ldlt,
        y: Vec<Value>,
        s: &[Value],
    ) -> Vec<Value> {
        let (components, _) = self.reduce(builder, ldlt, y);
        let shifts = self.transposed_solve(builder, s);
        let right = (0..s.len())
            .map(|a| {
                let shift = builder.mul(shifts[a], self.inverse_squares[a]);
                let sum = builder.add(components[a], shift);
                builder.neg(sum)
            })
            .collect();
        self.upper_solve(builder, right)
    }

    /// `U^{-T} s`
    fn transposed_solve(&self, builder: &mut Builder, s: &[Value]) -> Vec<Value> {
        let mut solution: Vec<Value> = Vec::with_capacity(s.len());
        for (a, &right) in s.iter().enumerate() {
            let mut entry = right;
            for (b, &known) in solution.iter().enumerate() {
                entry = builder.sub_product(entry, self.above[a][b], known);
            }
            solution.push(entry);
        }
        solution
    }

    /// `U^{-1} x`
    fn upper_solve(&self, builder: &mut Builder, mut x: Vec<Value>) -> Vec<Value> {
        for a in (0..x.len()).rev() {
            for b in a + 1..x.len() {
                x[a] = builder.sub_product(x[a], self.above[b][a], x[b]);
            }
        }
        x
    }

    /// The vector `x` of least norm with `<C_a, x> = r_a`.
    pub fn least_norm(&self, builder: &mut Builder, r: &[Value]) -> Vec<Value> {
        let coefficients = self.transposed_solve(builder, r);
        let size = self.columns.first().map_or(0, Vec::len);
        let mut x = vec![builder.zero(); size];
        for ((column, &inverse), coefficient) in self
            .columns
            .iter()
            .zip(&self.inverse_squares)
            .zip(coefficients)
        {
            let weight = builder.mul(coefficient, inverse);
            for (entry, &component) in x.iter_mut().zip(column) {
                *entry = builder.add_product(*entry, weight, component);
            }
        }
        x
    }

    /// `m_ab`, the inverse of the constraint mass matrix: `U^{-1} diag(1/n) U^{-T}`.
    pub fn inverse_mass(&self, builder: &mut Builder) -> Vec<Vec<Value>> {
        let m = self.columns.len();
        let inverse: Vec<Vec<Value>> = (0..m)
            .map(|c| {
                let unit = (0..m).map(|a| builder.integer(i64::from(a == c))).collect();
                self.upper_solve(builder, unit)
            })
            .collect();
        (0..m)
            .map(|a| {
                (0..m)
                    .map(|b| {
                        let mut entry = builder.zero();
                        for c in a.max(b)..m {
                            let scaled = builder.mul(inverse[c][a], self.inverse_squares[c]);
                            entry = builder.add_product(entry, scaled, inverse[c][b]);
                        }
                        entry
                    })
                    .collect()
            })
            .collect()
    }
}
