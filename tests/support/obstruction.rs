//! Brackets of the frame of D, with their demands. The demand of a field is the derivative along it that an invariant
//! density requires of its logarithm `G`. A model reports its metric and forms; every derivative is a central
//! difference in double precision.
//!
//! ```text
//! X_i = e_i - A_dep^{-1} A e_i          theta_k = m_ab (W^{a,j} d_j eta_bk + eta_bj d_k W^{a,j})
//! [(X, c), (Y, d)] = ([X, Y], X(d) - Y(c)),  c_i = theta(X_i)
//! ```

use crate::linear::solve_regular;
use crate::numeric::{Numeric, moved, slopes};

/// Components of a vector field, then its demand.
type Element = Vec<f64>;

/// The criterion for a density of a model with linear constraints that do not depend on time.
pub struct Criterion<'c> {
    system: &'c dyn Numeric,
    dependent: Vec<usize>,
}

/// Metric and forms at a position.
struct Geometry {
    forms: Vec<Vec<f64>>,
    duals: Vec<Vec<f64>>,
}

impl<'c> Criterion<'c> {
    /// The criterion with the dependent velocities for which the frame at `q` is `frame`; `None` if no choice gives it.
    pub fn new(system: &'c dyn Numeric, q: &[f64], frame: &[Vec<f64>]) -> Option<Self> {
        let (n, m) = (q.len(), q.len() - frame.len());
        let choices = (0..1_usize << n).filter(|bits| bits.count_ones() as usize == m);
        choices
            .map(|bits| Self {
                system,
                dependent: (0..n).filter(|i| bits >> i & 1 == 1).collect(),
            })
            .find(|criterion| {
                let differs = |(x, y): (&f64, &f64)| (x - y).abs() > 1e-9 * (1.0 + y.abs());
                let fields = criterion.frame(q);
                let close = |(x, y): (&Vec<f64>, &Vec<f64>)| !x.iter().zip(y).any(differs);
                fields.is_some_and(|fields| fields.iter().zip(frame).all(close))
            })
    }

    /// The criterion with the first choice of dependent velocities that is regular at `q`; `None` if all are singular.
    pub fn regular(system: &'c dyn Numeric, q: &[f64]) -> Option<Self> {
        let (n, m) = (q.len(), system.description().constraints.len());
        let choices = (0..1_usize << n).filter(|bits| bits.count_ones() as usize == m);
        choices
            .map(|bits| Self {
                system,
                dependent: (0..n).filter(|i| bits >> i & 1 == 1).collect(),
            })
            .find(|criterion| criterion.frame(q).is_some())
    }

    /// The derivatives of G with respect to all coordinates; `None` unless the first N fields among the frame and the
    /// brackets of its pairs are independent.
    pub fn differential(&self, q: &[f64]) -> Option<Vec<f64>> {
        let free = q.len() - self.dependent.len();
        let fields = (1..=free).map(|i| format!("X{i}"));
        let brackets = (1..free).flat_map(|i| (i + 1..=free).map(move |j| format!("[X{i},X{j}]")));
        let elements: Vec<Element> = fields
            .chain(brackets)
            .take(q.len())
            .map(|name| self.element(&name, q))
            .collect();
        let demands: Vec<f64> = elements.iter().map(|element| element[q.len()]).collect();
        (elements.len() == q.len()).then_some(())?;
        solve(&elements, &demands)
    }

    /// `eta^a = g W^a`
    fn geometry(&self, q: &[f64]) -> Geometry {
        let n = q.len();
        let state = self.system.state(0.0, q, &vec![0.0; n]);
        let report = self.system.report(0.0, &state);
        let (metric, duals) = (&report.0["metric"], &report.0["W"]);
        let duals: Vec<Vec<f64>> = duals.chunks(n).map(<[f64]>::to_vec).collect();
        let lower = |dual: &Vec<f64>| metric.chunks(n).map(|row| dot(row, dual)).collect();
        Geometry {
            forms: duals.iter().map(lower).collect(),
            duals,
        }
    }

    fn frame(&self, q: &[f64]) -> Option<Vec<Vec<f64>>> {
        let forms = self.geometry(q).forms;
        let column = |j: usize| -> Vec<f64> { forms.iter().map(|form| form[j]).collect() };
        let minor: Vec<Vec<f64>> = forms
            .iter()
            .map(|form| self.dependent.iter().map(|j| form[*j]).collect())
            .collect();
        let free = (0..q.len()).filter(|i| !self.dependent.contains(i));
        free.map(|i| {
            let mut field = vec![0.0; q.len()];
            field[i] = 1.0;
            for (j, value) in self.dependent.iter().zip(solve(&minor, &column(i))?) {
                field[*j] = -value;
            }
            Some(field)
        })
        .collect()
    }

    /// `theta` at a position.
    pub fn theta(&self, q: &[f64]) -> Vec<f64> {
        let n = q.len();
        let geometry = self.geometry(q);
        // Derivatives along a direction: of the forms, then of the duals.
        let along = |direction: &[f64]| {
            slopes(&|s| {
                let there = self.geometry(&moved(q, s, direction));
                there
                    .forms
                    .into_iter()
                    .chain(there.duals)
                    .flatten()
                    .collect()
            })
        };
        let axis = |k: usize| -> Vec<f64> { (0..n).map(|i| f64::from(u8::from(i == k))).collect() };
        let by_axis: Vec<Vec<f64>> = (0..n).map(|k| along(&axis(k))).collect();
        let by_dual: Vec<Vec<f64>> = geometry.duals.iter().map(|dual| along(dual)).collect();
        let mass: Vec<Vec<f64>> = geometry
            .forms
            .iter()
            .map(|form| geometry.duals.iter().map(|dual| dot(form, dual)).collect())
            .collect();
        let m = mass.len();
        let lie = |a: usize, b: usize, k: usize| {
            let dual = &by_axis[k][(m + a) * n..(m + a + 1) * n];
            by_dual[a][b * n + k] + dot(&geometry.forms[b], dual)
        };
        (0..n)
            .map(|k| {
                let columns = (0..m).map(|b| {
                    let column: Vec<f64> = (0..m).map(|a| lie(a, b, k)).collect();
                    // m_ab as the b-th row of the inverse.
                    solve(&mass, &column).expect("independent forms")[b]
                });
                columns.sum()
            })
            .collect()
    }

    /// The element with a name such as `X1` or `[X2,[X1,X2]]`.
    pub fn element(&self, name: &str, q: &[f64]) -> Element {
        if let Some(inner) = name.strip_prefix('[') {
            let (first, second) = inner
                .strip_suffix(']')
                .and_then(|inner| inner.split_once(','))
                .expect("a bracket of a field of the frame");
            return self.bracket(first, second, q);
        }
        let index: usize = name[1..].parse().expect("a field of the frame");
        let mut field = self.frame(q).expect("a regular position")[index - 1].clone();
        field.push(dot(&self.theta(q), &field));
        field
    }

    fn bracket(&self, first: &str, second: &str, q: &[f64]) -> Element {
        let n = q.len();
        let (x, y) = (self.element(first, q), self.element(second, q));
        let along = |direction: &[f64], name: &str| {
            slopes(&|s| self.element(name, &moved(q, s, &direction[..n])))
        };
        moved(&along(&x, second), -1.0, &along(&y, first))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Solves a small system; `None` if it is singular.
fn solve(matrix: &[Vec<f64>], right: &[f64]) -> Option<Vec<f64>> {
    solve_regular(matrix, right, 1e-12)
}
