//! The equations of motion at a point by dense linear algebra, from the expressions of a model:
//!
//! ```text
//! [ g  -eta^T ] [ qddot  ]   [ f - drift  ]
//! [ eta   0   ] [ lambda ] = [ -curvature ]
//! ```
//!
//! Nothing of the program stage is used: no factorisation, no sparsity, no elimination of the constraints.

use dalembert::math::larger;
use dalembert_codegen::Compiled;
use dalembert_expr::{ExprId, SymbolId};
use dalembert_tests::linear::solve;
use dalembert_tests::numeric::moved;

/// A point of the tangent bundle.
#[derive(Debug, Clone)]
pub struct Point {
    pub t: f64,
    pub q: Vec<f64>,
    pub qdot: Vec<f64>,
}

impl Point {
    /// The point moved by `h` along a direction of positions and by `h dt` in time.
    pub fn shifted(&self, h: f64, direction: &[f64], dt: f64) -> Self {
        Self {
            t: self.t + h * dt,
            q: moved(&self.q, h, direction),
            qdot: self.qdot.clone(),
        }
    }

    /// The point with velocity `k` changed by `h`.
    pub fn kicked(&self, h: f64, k: usize) -> Self {
        Self {
            qdot: moved(&self.qdot, h, &unit(self.q.len(), k)),
            ..self.clone()
        }
    }
}

/// A model with the values of its parameters.
pub struct Dense<'a> {
    compiled: &'a Compiled,
    pub parameters: Vec<f64>,
}

/// Quantities of a model at a point.
pub struct Evaluated {
    pub metric: Vec<Vec<f64>>,
    /// `A`, the momenta at zero velocity.
    pub linear: Vec<f64>,
    pub p: Vec<f64>,
    pub force: Vec<f64>,
    pub energy: f64,
    pub forms: Vec<Vec<f64>>,
    pub affine: Vec<f64>,
    inertial: Vec<f64>,
    curvature: Vec<f64>,
}

impl<'a> Dense<'a> {
    /// A model with its default parameters.
    pub fn new(compiled: &'a Compiled) -> Self {
        let pool = &compiled.model.pool;
        let parameters = compiled.model.parameters.iter();
        let parameters = parameters.map(|parameter| {
            let default = parameter.default.expect("a default");
            pool.eval(&[default], &|_| f64::NAN)[0]
        });
        Self {
            compiled,
            parameters: parameters.collect(),
        }
    }

    /// The values of expressions at a point.
    pub fn values(&self, expressions: &[ExprId], at: &Point) -> Vec<f64> {
        let model = &self.compiled.model;
        let value = |symbol: SymbolId| {
            let coordinate = model
                .coordinates
                .iter()
                .position(|candidate| candidate.q == symbol);
            let velocity = model
                .coordinates
                .iter()
                .position(|candidate| candidate.qdot == symbol);
            let parameter = model
                .parameters
                .iter()
                .position(|candidate| candidate.symbol == symbol);
            match (coordinate, velocity, parameter) {
                (Some(i), _, _) => at.q[i],
                (_, Some(i), _) => at.qdot[i],
                (_, _, Some(k)) => self.parameters[k],
                _ if symbol == model.time => at.t,
                _ => f64::NAN,
            }
        };
        model.pool.eval(expressions, &value)
    }

    /// The value of one expression.
    pub fn value(&self, expression: ExprId, at: &Point) -> f64 {
        self.values(&[expression], at)[0]
    }

    /// Evaluates all quantities at a point.
    pub fn evaluate(&self, at: &Point) -> Evaluated {
        let (model, derivation) = (&self.compiled.model, &self.compiled.derivation);
        let rows = model.lagrangian.metric.iter();
        let metric: Vec<_> = rows.map(|row| self.values(row, at)).collect();
        let linear = self.values(&model.lagrangian.linear, at);
        let kinetic = times(&metric, &at.qdot);
        let potential = self.value(model.lagrangian.potential, at);
        let force = self.values(&derivation.field.force, at);
        let drift = self.values(&derivation.field.drift, at);
        let constraints = derivation.constraints.iter();
        let curvature: Vec<_> = constraints.map(|constraint| constraint.curvature).collect();
        Evaluated {
            p: moved(&kinetic, 1.0, &linear),
            energy: dot(&kinetic, &at.qdot) / 2.0 + potential,
            inertial: force.iter().zip(&drift).map(|(f, d)| f - d).collect(),
            forms: model
                .constraints
                .iter()
                .map(|constraint| self.values(&constraint.form, at))
                .collect(),
            affine: model
                .constraints
                .iter()
                .map(|constraint| self.value(constraint.affine, at))
                .collect(),
            curvature: self.values(&curvature, at),
            metric,
            linear,
            force,
        }
    }

    /// The rate of `(q, p)` at these positions and momenta.
    pub fn rate(&self, t: f64, q: &[f64], p: &[f64]) -> Vec<f64> {
        let mut at = Point {
            t,
            q: q.to_vec(),
            qdot: vec![0.0; q.len()],
        };
        let resting = self.evaluate(&at);
        let kinetic: Vec<f64> = p.iter().zip(&resting.linear).map(|(p, a)| p - a).collect();
        at.qdot = solve(&resting.metric, &kinetic);
        let moving = self.evaluate(&at);
        [at.qdot, moving.momentum_rate()].concat()
    }
}

impl Evaluated {
    /// Accelerations, then multipliers.
    pub fn motion(&self) -> (Vec<f64>, Vec<f64>) {
        let right: Vec<f64> = self.curvature.iter().map(|c| -c).collect();
        self.saddle(&self.inertial, &right)
    }

    /// `pdot = f + lambda_a eta^a`
    pub fn momentum_rate(&self) -> Vec<f64> {
        let (_, multipliers) = self.motion();
        let mut rate = self.force.clone();
        for (lambda, form) in multipliers.iter().zip(&self.forms) {
            rate = moved(&rate, *lambda, form);
        }
        rate
    }

    /// Solves `g x - eta^T y = upper` and `eta x = lower` for `x` and `y`.
    pub fn saddle(&self, upper: &[f64], lower: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let solution = solve(&self.saddle_matrix(), &[upper, lower].concat());
        let (x, y) = solution.split_at(upper.len());
        (x.to_vec(), y.to_vec())
    }

    fn saddle_matrix(&self) -> Vec<Vec<f64>> {
        let (n, m) = (self.metric.len(), self.forms.len());
        let upper = (0..n).map(|i| {
            let forces = self.forms.iter().map(|form| -form[i]);
            self.metric[i].iter().copied().chain(forces).collect()
        });
        let lower = self
            .forms
            .iter()
            .map(|form| [form.clone(), vec![0.0; m]].concat());
        upper.chain(lower).collect()
    }

    /// The velocities on the constraints that are nearest in the metric.
    pub fn projected(&self, qdot: &[f64]) -> Vec<f64> {
        let right: Vec<f64> = self.affine.iter().map(|affine| -affine).collect();
        self.saddle(&times(&self.metric, qdot), &right).0
    }

    /// `pi_D` of a vector.
    pub fn project(&self, vector: &[f64]) -> Vec<f64> {
        self.saddle(&times(&self.metric, vector), &vec![0.0; self.forms.len()])
            .0
    }

    /// `g^{-1}` of a covector.
    pub fn raised(&self, covector: &[f64]) -> Vec<f64> {
        solve(&self.metric, covector)
    }

    /// The condition number of the saddle matrix in the maximum row-sum norm. It bounds the growth of relative
    /// errors from the entries to a solution.
    pub fn condition(&self) -> f64 {
        let matrix = self.saddle_matrix();
        let columns: Vec<Vec<f64>> = (0..matrix.len())
            .map(|k| solve(&matrix, &unit(matrix.len(), k)))
            .collect();
        let inverse: Vec<Vec<f64>> = (0..matrix.len())
            .map(|i| columns.iter().map(|column| column[i]).collect())
            .collect();
        norm(&matrix) * norm(&inverse)
    }
}

/// The basis vector with 1 at `k`.
pub fn unit(n: usize, k: usize) -> Vec<f64> {
    (0..n).map(|i| f64::from(u8::from(i == k))).collect()
}

/// The product of a matrix and a vector.
pub fn times(matrix: &[Vec<f64>], vector: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| dot(row, vector)).collect()
}

/// The inner product.
pub fn dot(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(a, b)| a * b).sum()
}

fn norm(matrix: &[Vec<f64>]) -> f64 {
    let sizes = matrix
        .iter()
        .map(|row| row.iter().map(|entry| entry.abs()).sum());
    sizes.fold(0.0, larger)
}
