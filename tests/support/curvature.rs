//! The criterion for an invariant density, computed independently: the mean curvature of the orthogonal complement of
//! D, and brackets, by finite differences.
//!
//! For an orthonormal frame `w_a` of the complement, `theta(X) = sum_a g(nabla_{w_a} w_a, X) + 1/2 X(ln det m)` for X
//! in D. All derivatives are five-point stencils in double precision. The only values shared with the program are the
//! entries of the metric and of the forms.

use dalembert::math::larger;
use dalembert_codegen::mechanics::Derivation;
use dalembert_codegen::model::Model;
use dalembert_expr::{ExprId, SymbolId};

use crate::linear::solve;

/// Step `h` of the stencils. Their error `h^4` is near the rounding error `1e-16/h^3` of three nested stencils.
const STEP: f64 = 0.004;

/// A model with linear constraints that do not depend on time, at fixed parameters.
#[derive(Debug)]
pub struct Curved<'m> {
    model: &'m Model,
    roots: Vec<ExprId>,
    forms: usize,
    parameters: Vec<(SymbolId, f64)>,
    /// The indices of the dependent velocities.
    pub dependent: Vec<usize>,
}

type Matrix = Vec<Vec<f64>>;

impl<'m> Curved<'m> {
    /// A model with the values of its parameters.
    pub fn new(
        model: &'m Model,
        derivation: &Derivation,
        parameters: &[(SymbolId, f64)],
        dependent: &[usize],
    ) -> Self {
        let mut roots: Vec<_> = model.lagrangian.metric.iter().flatten().copied().collect();
        let forms = derivation.constraints.iter();
        roots.extend(forms.flat_map(|constraint| constraint.form.clone()));
        Self {
            model,
            roots,
            forms: derivation.constraints.len(),
            parameters: parameters.to_vec(),
            dependent: dependent.to_vec(),
        }
    }

    /// Metric and forms.
    fn tensors(&self, q: &[f64]) -> (Matrix, Matrix) {
        let coordinates = self.model.coordinates.iter().map(|coordinate| coordinate.q);
        let known: Vec<_> = coordinates
            .zip(q.iter().copied())
            .chain(self.parameters.iter().copied())
            .collect();
        let value = |symbol: SymbolId| {
            let found = known.iter().find(|(known, _)| *known == symbol);
            found.map_or(f64::NAN, |(_, value)| *value)
        };
        let values = self.model.pool.eval(&self.roots, &value);
        let n = q.len();
        let mut rows: Matrix = values.chunks(n).map(<[f64]>::to_vec).collect();
        let forms = rows.split_off(rows.len() - self.forms);
        (rows, forms)
    }

    /// `X_i` for each independent velocity.
    pub fn frame(&self, q: &[f64]) -> Matrix {
        let (_, forms) = self.tensors(q);
        let minor: Matrix = forms
            .iter()
            .map(|form| self.dependent.iter().map(|j| form[*j]).collect())
            .collect();
        let independent = (0..q.len()).filter(|i| !self.dependent.contains(i));
        independent
            .map(|i| {
                let mut field = vec![0.0; q.len()];
                field[i] = 1.0;
                let column: Vec<_> = forms.iter().map(|form| -form[i]).collect();
                for (j, value) in self.dependent.iter().zip(solve(&minor, &column)) {
                    field[*j] = value;
                }
                field
            })
            .collect()
    }

    /// An orthonormal frame of the complement of D, by Gram and Schmidt, and half the logarithm of `det m^{ab}`.
    fn normals(&self, q: &[f64]) -> (Matrix, f64) {
        let (metric, forms) = self.tensors(q);
        let mut normals: Matrix = Vec::new();
        let mut logarithm = 0.0;
        for form in &forms {
            let mut normal = solve(&metric, form);
            for other in &normals {
                let part = inner(&metric, &normal, other);
                normal
                    .iter_mut()
                    .zip(other)
                    .for_each(|(entry, other)| *entry -= part * other);
            }
            let length = inner(&metric, &normal, &normal).sqrt();
            logarithm += length.ln();
            normals.push(normal.iter().map(|component| component / length).collect());
        }
        (normals, logarithm)
    }

    /// `theta(X)` for a field X of D.
    pub fn theta(&self, q: &[f64], x: &[f64]) -> f64 {
        let (normals, _) = self.normals(q);
        let (metric, _) = self.tensors(q);
        let mut sum = along(q, x, |q| vec![self.normals(q).1])[0];
        for (a, w) in normals.iter().enumerate() {
            // `nabla_w w = w(w) + Gamma(w, w)`, lowered and applied to X.
            let rate = along(q, w, |q| self.normals(q).0[a].clone());
            sum += inner(&metric, &rate, x);
            let slope = |v: &[f64]| along(q, v, |q| self.tensors(q).0.concat());
            let by_w = unflatten(&slope(w), q.len());
            let by_x = unflatten(&slope(x), q.len());
            sum += inner(&by_w, w, x) - inner(&by_x, w, w) / 2.0;
        }
        sum
    }

    /// A nested bracket such as `[X1,[X1,X2]]`: its components, then the value it demands for the derivative of G.
    ///
    /// # Panics
    /// If the text is not a bracket.
    pub fn bracket(&self, q: &[f64], text: &str) -> Vec<f64> {
        let Some(inside) = text.strip_prefix('[') else {
            let position: usize = text[1..].parse().expect("a number");
            let mut pair = self.frame(q).swap_remove(position - 1);
            pair.push(self.theta(q, &pair));
            return pair;
        };
        let (x, rest) = inside.split_once(',').expect("a bracket");
        let y = rest.strip_suffix(']').expect("a bracket");
        let n = q.len();
        let (at_x, at_y) = (self.bracket(q, x), self.bracket(q, y));
        let forth = along(q, &at_x[..n], |q| self.bracket(q, y));
        let back = along(q, &at_y[..n], |q| self.bracket(q, x));
        forth.iter().zip(back).map(|(a, b)| a - b).collect()
    }
}

/// The derivative of a function along a vector.
fn along(q: &[f64], v: &[f64], f: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let size = v
        .iter()
        .fold(0.0_f64, |size, value| larger(size, value.abs()));
    if size == 0.0 {
        return vec![0.0; f(q).len()];
    }
    let step = STEP / size;
    let at = |k: f64| {
        let moved: Vec<_> = q.iter().zip(v).map(|(q, v)| q + k * step * v).collect();
        f(&moved)
    };
    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(at);
    (0..a.len())
        .map(|i| (a[i] - d[i] + 8.0 * (c[i] - b[i])) / (12.0 * step))
        .collect()
}

fn unflatten(values: &[f64], n: usize) -> Matrix {
    values.chunks(n).map(<[f64]>::to_vec).collect()
}

fn inner(metric: &[Vec<f64>], a: &[f64], b: &[f64]) -> f64 {
    let row = |(row, a): (&Vec<f64>, &f64)| a * row.iter().zip(b).map(|(g, b)| g * b).sum::<f64>();
    metric.iter().zip(a).map(row).sum()
}
