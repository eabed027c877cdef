//! The criterion `X_i(G) = theta(X_i)` as expressions, by Cramer's rule. Only the final zero test uses series and
//! residues modulo primes.

use dalembert_codegen::mechanics::Derivation;
use dalembert_codegen::model::Model;
use dalembert_expr::{ExprId, Pool, SymbolId};

/// Metric, forms and the quantities derived from them, for linear constraints that do not depend on time.
#[derive(Debug)]
pub struct Geometry {
    symbols: Vec<SymbolId>,
    /// `W^a = g^{-1} eta^a`, M rows.
    duals: Vec<Vec<ExprId>>,
    forms: Vec<Vec<ExprId>>,
    metric: Vec<Vec<ExprId>>,
    /// `m^{ab}`
    mass: Vec<Vec<ExprId>>,
}

impl Geometry {
    /// The geometry of a model.
    pub fn of(model: &mut Model, derivation: &Derivation) -> Self {
        let metric = model.lagrangian.metric.clone();
        let forms: Vec<_> = derivation
            .constraints
            .iter()
            .map(|constraint| constraint.form.clone())
            .collect();
        let pool = &mut model.pool;
        let duals: Vec<_> = forms
            .iter()
            .map(|form| solve(pool, &metric, form))
            .collect();
        let mass = forms
            .iter()
            .map(|form| duals.iter().map(|dual| dot(pool, form, dual)).collect())
            .collect();
        Self {
            symbols: model
                .coordinates
                .iter()
                .map(|coordinate| coordinate.q)
                .collect(),
            duals,
            forms,
            metric,
            mass,
        }
    }

    /// `det m^{ab}`
    pub fn mass_determinant(&self, pool: &mut Pool) -> ExprId {
        determinant(pool, &self.mass)
    }

    /// `det g`
    pub fn metric_determinant(&self, pool: &mut Pool) -> ExprId {
        determinant(pool, &self.metric)
    }

    /// `det A_dep`
    pub fn dependent_determinant(&self, pool: &mut Pool, dependent: &[usize]) -> ExprId {
        determinant(pool, &self.minor(dependent))
    }

    fn minor(&self, columns: &[usize]) -> Vec<Vec<ExprId>> {
        let row = |form: &Vec<ExprId>| columns.iter().map(|j| form[*j]).collect();
        self.forms.iter().map(row).collect()
    }

    /// `X_i` for each independent velocity.
    pub fn frame(&self, pool: &mut Pool, dependent: &[usize]) -> Vec<Vec<ExprId>> {
        let minor = self.minor(dependent);
        let independent = (0..self.symbols.len()).filter(|i| !dependent.contains(i));
        independent
            .map(|i| {
                let mut field = vec![pool.zero(); self.symbols.len()];
                field[i] = pool.one();
                let column: Vec<_> = self.forms.iter().map(|form| pool.neg(form[i])).collect();
                for (j, value) in dependent.iter().zip(solve(pool, &minor, &column)) {
                    field[*j] = value;
                }
                field
            })
            .collect()
    }

    /// `theta = m_ab L_{W^a} eta^b`
    pub fn theta(&self, pool: &mut Pool) -> Vec<ExprId> {
        let n = self.symbols.len();
        (0..n)
            .map(|k| {
                let mut terms = Vec::new();
                for (a, dual) in self.duals.iter().enumerate() {
                    // L_W eta^b for each b, then m_ab by Cramer's rule.
                    let derivatives: Vec<_> = self
                        .forms
                        .iter()
                        .map(|form| self.lie_derivative(pool, dual, form, k))
                        .collect();
                    terms.push(solve(pool, &self.mass, &derivatives)[a]);
                }
                pool.sum(&terms)
            })
            .collect()
    }

    /// `(L_W eta)_k = W^j d_j eta_k + eta_j d_k W^j`
    fn lie_derivative(&self, pool: &mut Pool, w: &[ExprId], eta: &[ExprId], k: usize) -> ExprId {
        let along = self.along(pool, w, eta[k]);
        let slopes: Vec<_> = w.iter().map(|w| pool.diff(*w, self.symbols[k])).collect();
        let rest = dot(pool, eta, &slopes);
        pool.add(along, rest)
    }

    /// `X(f)`
    pub fn along(&self, pool: &mut Pool, x: &[ExprId], f: ExprId) -> ExprId {
        let slopes: Vec<_> = self.symbols.iter().map(|q| pool.diff(f, *q)).collect();
        dot(pool, x, &slopes)
    }

    /// `X_i(G) - theta(X_i)` for each independent velocity.
    pub fn residuals(&self, pool: &mut Pool, dependent: &[usize], g: ExprId) -> Vec<ExprId> {
        let theta = self.theta(pool);
        let frame = self.frame(pool, dependent);
        frame
            .iter()
            .map(|field| {
                let rate = self.along(pool, field, g);
                let demand = dot(pool, &theta, field);
                pool.sub(rate, demand)
            })
            .collect()
    }
}

fn dot(pool: &mut Pool, a: &[ExprId], b: &[ExprId]) -> ExprId {
    let products: Vec<_> = a.iter().zip(b).map(|(a, b)| pool.mul(*a, *b)).collect();
    pool.sum(&products)
}

/// Laplace expansion along the first row.
fn determinant(pool: &mut Pool, rows: &[Vec<ExprId>]) -> ExprId {
    let Some((first, rest)) = rows.split_first() else {
        return pool.one();
    };
    let mut terms = Vec::new();
    for (column, entry) in first.iter().enumerate() {
        if pool.is_syntactic_zero(*entry) {
            continue;
        }
        let without = |row: &Vec<ExprId>| {
            let mut row = row.clone();
            row.remove(column);
            row
        };
        let minor: Vec<_> = rest.iter().map(without).collect();
        let cofactor = determinant(pool, &minor);
        let term = pool.mul(*entry, cofactor);
        terms.push(if column % 2 == 0 {
            term
        } else {
            pool.neg(term)
        });
    }
    pool.sum(&terms)
}

/// Solves a linear system by Cramer's rule.
fn solve(pool: &mut Pool, rows: &[Vec<ExprId>], right: &[ExprId]) -> Vec<ExprId> {
    let whole = determinant(pool, rows);
    (0..rows.len())
        .map(|column| {
            let mut replaced = rows.to_vec();
            for (row, value) in replaced.iter_mut().zip(right) {
                row[column] = *value;
            }
            let part = determinant(pool, &replaced);
            pool.div(part, whole)
        })
        .collect()
}
