//! A frame of the constraint distribution as series at a point, with the conditions on an invariant density.
//!
//! `exp(G) mu_C` is invariant iff `X_i(G) = c_i` for a frame `X_i` of D, and `X_0(G) = c_0` for the drift:
//!
//! ```text
//! W^a = g^{-1} eta^a        m^{ab} = eta^a(W^b)
//! theta_k = m_ab ( W^{a,j} d_j eta^b_k + eta^b_j d_k W^{a,j} )                  = (m_ab L_{W^a} eta^b)_k
//! X_i = e_i - A_dep^{-1} A e_i                                                  for independent velocities i
//! X_0 = -A_dep^{-1} eta_0 + d_t                                                 the motion with u = 0
//! c_i = theta(X_i) - sigma(X_i)
//! c_0 = theta(X_0) + m_ab [ W^b(eta_0^a) + (d_t eta^a)(W^b) - (d_t g)(W^a, W^b) ] - tau - sigma(X_0)
//! K = g^{-1} - W^a m_ab W^b,   tau = (dF_i/dqdot^j) K^{ij} at rest,   sigma its derivative by the velocity
//! ```
//!
//! Clark and Bloch, Theorem 2.8; W. Clark, thesis, Definition V.23, without its factor n.

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, Jets, Pool, Series};

use super::linear::{Matrix, Solution, dot, largest, solve, transpose};
use super::problem::{Friction, Problem};

/// A vector field `X`, followed by the demand: the derivative of G along `X` that an invariant density needs.
pub(super) type Demand<A> = Vec<Series<A>>;

/// The geometry at a point.
#[derive(Debug)]
pub(super) struct Frame<A: Arithmetic> {
    /// The drift first, if there is one, then `X_i` for each independent velocity.
    pub(super) demands: Vec<Demand<A>>,
    /// The dependent velocities, one for each constraint.
    pub(super) dependent: Vec<usize>,
    /// `det g`
    pub(super) metric_determinant: Series<A>,
    /// `det m^{ab}`
    pub(super) mass_determinant: Series<A>,
    /// `det A_dep`
    pub(super) dependent_determinant: Series<A>,
    /// `theta`, N components.
    pub(super) theta: Vec<Series<A>>,
}

/// `tau` and the N components of `sigma`.
struct Dissipation<A: Arithmetic> {
    rest: Series<A>,
    slope: Vec<Series<A>>,
}

/// Expansions of the expressions of a problem at a point.
struct Expanded<A: Arithmetic> {
    metric: Matrix<A>,
    forms: Matrix<A>,
    affine: Vec<Series<A>>,
    friction: Option<(Matrix<A>, Vec<Matrix<A>>)>,
}

/// The frame with series of the order of `jets`, the demands one order less; `None` if the point is singular or an
/// expression has no value there. `dependent`: indices of the dependent velocities; `None` chooses them.
pub(super) fn frame<P: ExpansionPoint>(
    pool: &Pool,
    problem: &Problem,
    jets: &Jets<'_, P::Field>,
    point: &mut P,
    dependent: Option<&[usize]>,
) -> Option<Frame<P::Field>> {
    let expanded = expand(pool, problem, jets, point)?;
    let calculus = Calculus {
        jets: *jets,
        problem,
    };
    let columns = (0..problem.coordinates)
        .map(|j| column(&expanded.forms, j))
        .collect();
    let raised = solve(jets, expanded.metric.clone(), columns)?;
    // W^{a,j} as rows; without constraints there are none.
    let duals = transpose(&raised.unknowns);
    let inverse = inverse_mass(jets, &expanded.forms, &duals)?;
    let theta = calculus.theta(&expanded.forms, &duals, &inverse.unknowns);
    let dependent = match dependent {
        Some(given) => given.to_vec(),
        None => choose_dependent(jets, &expanded.forms)?,
    };
    let solved = calculus.solved_forms(&expanded, &dependent)?;
    let geometry = Geometry {
        calculus,
        expanded: &expanded,
        duals: &duals,
        inverse_mass: &inverse.unknowns,
    };
    let mut demands = Vec::new();
    let friction = geometry.friction()?;
    if problem.has_drift(pool) {
        let drift = calculus.drift(&solved.unknowns, &dependent);
        demands.push(geometry.drift_demand(drift, &theta, &friction));
    }
    for i in (0..problem.coordinates).filter(|i| !dependent.contains(i)) {
        let field = calculus.field(i, &solved.unknowns, &dependent);
        let along = |form: &[Series<P::Field>]| dot(jets, form, &field[..problem.coordinates]);
        let demand = jets.sub(&along(&theta), &along(&friction.slope));
        demands.push(extended::<P::Field>(field, demand));
    }
    Some(Frame {
        demands,
        dependent,
        metric_determinant: raised.determinant,
        mass_determinant: inverse.determinant,
        dependent_determinant: solved.determinant,
        theta,
    })
}

fn expand<P: ExpansionPoint>(
    pool: &Pool,
    problem: &Problem,
    jets: &Jets<'_, P::Field>,
    point: &mut P,
) -> Option<Expanded<P::Field>> {
    let roots = problem.roots();
    let series = pool.taylor(&roots, &problem.variable_symbols(), jets, point)?;
    let (n, m) = (problem.coordinates, problem.forms.len());
    let mut series = series.into_iter();
    let mut matrix = |rows: usize| -> Matrix<P::Field> {
        (0..rows)
            .map(|_| series.by_ref().take(n).collect())
            .collect()
    };
    let (metric, forms) = (matrix(n), matrix(m));
    let affine = series.by_ref().take(m).collect();
    let mut matrix =
        || -> Matrix<P::Field> { (0..n).map(|_| series.by_ref().take(n).collect()).collect() };
    let friction = problem
        .friction
        .as_ref()
        .map(|_: &Friction| (matrix(), (0..n).map(|_| matrix()).collect()));
    Some(Expanded {
        metric,
        forms,
        affine,
        friction,
    })
}

fn identity<A: Arithmetic>(jets: &Jets<'_, A>, size: usize) -> Matrix<A> {
    let entry = |i, j| jets.constant(jets.field.integer(i64::from(i == j)));
    (0..size)
        .map(|i| (0..size).map(|j| entry(i, j)).collect())
        .collect()
}

/// Fraction of the largest entry below which a pivot may be a rounding error.
const PIVOT: f64 = 1e-9;

/// Greedy choice of columns with an invertible minor, from the last column to the first.
///
/// NOTE: every choice with an invertible minor is valid; the documentation of the invariant volume names this one. It
/// tends to keep the coordinates that place a body independent, because these are mostly declared first. It may take
/// a wheel angle, although its coefficients are often not constant.
pub(super) fn choose_dependent<A: Arithmetic>(
    jets: &Jets<'_, A>,
    forms: &Matrix<A>,
) -> Option<Vec<usize>> {
    let field = jets.field;
    let mut rows: Vec<Vec<A::Scalar>> = forms
        .iter()
        .map(|form| form.iter().map(|entry| jets.value(entry)).collect())
        .collect();
    let columns = forms.first().map_or(0, Vec::len);
    let entries = rows.iter().flatten();
    let least = PIVOT * entries.fold(0.0, |size: f64, entry| size.max(field.size(*entry)));
    let mut chosen = Vec::new();
    for column in (0..columns).rev() {
        let free = chosen.len()..rows.len();
        let Some(pivot) = largest(free, |row| field.size(rows[*row][column])) else {
            continue;
        };
        if field.size(rows[pivot][column]) < least {
            continue;
        }
        rows.swap(chosen.len(), pivot);
        let pivot_row = rows[chosen.len()].clone();
        let inverse = field.inv(pivot_row[column])?;
        for row in &mut rows[chosen.len() + 1..] {
            let factor = field.mul(row[column], inverse);
            for (entry, pivot) in row.iter_mut().zip(&pivot_row) {
                *entry = field.sub(*entry, field.mul(factor, *pivot));
            }
        }
        chosen.push(column);
    }
    chosen.sort_unstable();
    (chosen.len() == rows.len()).then_some(chosen)
}

fn extended<A: Arithmetic>(mut field: Vec<Series<A>>, demand: Series<A>) -> Demand<A> {
    field.push(demand);
    field
}

/// Derivatives of series with respect to components: coordinates and time. The derivative with respect to a component
/// without variable is 0.
struct Calculus<'c, 's, A> {
    jets: Jets<'s, A>,
    problem: &'c Problem,
}

impl<A> Clone for Calculus<'_, '_, A>
where
    A: Copy,
{
    fn clone(&self) -> Self {
        *self
    }
}

impl<A> Copy for Calculus<'_, '_, A> where A: Copy {}

impl<A: Arithmetic> Calculus<'_, '_, A> {
    /// `d a / d component k`
    fn derivative(&self, a: &[A::Scalar], k: usize) -> Series<A> {
        match self.problem.variables.binary_search(&k) {
            Ok(v) => self.jets.derivative(a, v),
            Err(_) => Vec::new(),
        }
    }

    /// `theta`
    fn theta(&self, forms: &Matrix<A>, duals: &Matrix<A>, inverse: &Matrix<A>) -> Vec<Series<A>> {
        let jets = &self.jets.lower();
        let n = self.problem.coordinates;
        let contracted: Matrix<A> = (0..duals.len())
            .map(|a| {
                let row: Vec<_> = (0..n)
                    .map(|j| dot(jets, &inverse[a], &column(forms, j)))
                    .collect();
                row
            })
            .collect();
        (0..n)
            .map(|k| {
                let mut sum = Vec::new();
                for (a, dual) in duals.iter().enumerate() {
                    let slopes: Vec<_> = dual.iter().map(|w| self.derivative(w, k)).collect();
                    sum = jets.add(&sum, &dot(jets, &contracted[a], &slopes));
                    for (b, form) in forms.iter().enumerate() {
                        let slopes: Vec<_> = (0..n).map(|j| self.derivative(&form[k], j)).collect();
                        let along = dot(jets, dual, &slopes);
                        sum = jets.add(&sum, &jets.mul(&inverse[a][b], &along));
                    }
                }
                sum
            })
            .collect()
    }

    /// `A_dep^{-1} (A | eta_0)`
    fn solved_forms(&self, expanded: &Expanded<A>, dependent: &[usize]) -> Option<Solution<A>> {
        let minor = expanded
            .forms
            .iter()
            .map(|form| dependent.iter().map(|j| form[*j].clone()).collect())
            .collect();
        let right = expanded
            .forms
            .iter()
            .zip(&expanded.affine)
            .map(|(form, affine)| extended::<A>(form.clone(), affine.clone()))
            .collect();
        solve(&self.jets, minor, right)
    }

    /// `X_i`
    fn field(&self, i: usize, solved: &Matrix<A>, dependent: &[usize]) -> Vec<Series<A>> {
        let mut field = vec![Vec::new(); self.problem.components()];
        field[i] = self.jets.constant(self.jets.field.integer(1));
        self.follow(&mut field, i, solved, dependent);
        field
    }

    /// `X_0`
    fn drift(&self, solved: &Matrix<A>, dependent: &[usize]) -> Vec<Series<A>> {
        let n = self.problem.coordinates;
        let mut field = vec![Vec::new(); self.problem.components()];
        if self.problem.is_time_dependent() {
            field[n] = self.jets.constant(self.jets.field.integer(1));
        }
        self.follow(&mut field, n, solved, dependent);
        field
    }

    /// Sets the dependent velocities that follow from a unit velocity in `column`.
    fn follow(
        &self,
        field: &mut [Series<A>],
        column: usize,
        solved: &Matrix<A>,
        dependent: &[usize],
    ) {
        let minus = self.jets.field.integer(-1);
        for (row, j) in solved.iter().zip(dependent) {
            field[*j] = self.jets.scale(minus, &row[column]);
        }
    }
}

/// Column `j` of a matrix.
pub(super) fn column<T: Clone>(rows: &[Vec<T>], j: usize) -> Vec<T> {
    rows.iter().map(|row| row[j].clone()).collect()
}

/// `K = g^{-1} - W^a m_ab W^b`, given the dual fields and the inverse of the constraint mass matrix; `None` if the
/// metric is singular.
fn projected<A: Arithmetic>(
    jets: &Jets<'_, A>,
    metric: &Matrix<A>,
    (duals, inverse_mass): (&Matrix<A>, &Matrix<A>),
) -> Option<Matrix<A>> {
    let mut projected = solve(jets, metric.clone(), identity(jets, metric.len()))?.unknowns;
    for (a, dual) in duals.iter().enumerate() {
        for (b, other) in duals.iter().enumerate() {
            for (i, row) in projected.iter_mut().enumerate() {
                let factor = jets.mul(&inverse_mass[a][b], &dual[i]);
                for (entry, w) in row.iter_mut().zip(other) {
                    *entry = jets.sub(entry, &jets.mul(&factor, w));
                }
            }
        }
    }
    Some(projected)
}

/// `K` at a point; `None` if metric or constraints are singular there.
pub(super) fn projected_cometric<P: ExpansionPoint>(
    pool: &Pool,
    problem: &Problem,
    jets: &Jets<'_, P::Field>,
    point: &mut P,
) -> Option<Matrix<P::Field>> {
    let rows = [&problem.metric, &problem.forms].map(|rows| rows.iter().flatten().copied());
    let roots: Vec<ExprId> = rows.into_iter().flatten().collect();
    let values = point.values(pool, &pool.reachable(&roots))?;
    let constant = |id: &ExprId| jets.constant(values[id.index()]);
    let matrix = |rows: &[Vec<ExprId>]| -> Matrix<P::Field> {
        let rows = rows.iter();
        rows.map(|row| row.iter().map(constant).collect()).collect()
    };
    let (metric, forms) = (matrix(&problem.metric), matrix(&problem.forms));
    let columns = (0..problem.coordinates).map(|j| column(&forms, j));
    let duals = transpose(&solve(jets, metric.clone(), columns.collect())?.unknowns);
    let inverse = inverse_mass(jets, &forms, &duals)?;
    projected(jets, &metric, (&duals, &inverse.unknowns))
}

/// The inverse of `m^{ab} = eta^a(W^b)`, and its determinant; `None` if it is singular.
fn inverse_mass<A: Arithmetic>(
    jets: &Jets<'_, A>,
    forms: &Matrix<A>,
    duals: &Matrix<A>,
) -> Option<Solution<A>> {
    let along = |form: &Vec<Series<A>>| duals.iter().map(|dual| dot(jets, form, dual)).collect();
    let mass = forms.iter().map(along).collect();
    solve(jets, mass, identity(jets, duals.len()))
}

/// Ingredients of the demand of the drift.
struct Geometry<'g, 's, A: Arithmetic> {
    calculus: Calculus<'g, 's, A>,
    expanded: &'g Expanded<A>,
    duals: &'g Matrix<A>,
    inverse_mass: &'g Matrix<A>,
}

impl<A: Arithmetic> Geometry<'_, '_, A> {
    fn drift_demand(
        &self,
        drift: Vec<Series<A>>,
        theta: &[Series<A>],
        friction: &Dissipation<A>,
    ) -> Demand<A> {
        let jets = &self.calculus.jets.lower();
        let n = self.calculus.problem.coordinates;
        let mut demand = dot(jets, theta, &drift[..n]);
        for (a, dual) in self.duals.iter().enumerate() {
            for (b, inverse) in self.inverse_mass[a].iter().enumerate() {
                let rate = self.rate(a, b, dual);
                demand = jets.add(&demand, &jets.mul(inverse, &rate));
            }
        }
        demand = jets.sub(&demand, &friction.rest);
        demand = jets.sub(&demand, &dot(jets, &friction.slope, &drift[..n]));
        extended::<A>(drift, demand)
    }

    /// `W^a(eta_0^b) + (d_t eta^b)(W^a) - (d_t g)(W^a, W^b)`
    fn rate(&self, a: usize, b: usize, dual: &[Series<A>]) -> Series<A> {
        let jets = &self.calculus.jets.lower();
        let n = self.calculus.problem.coordinates;
        let slopes: Vec<_> = (0..n)
            .map(|j| self.calculus.derivative(&self.expanded.affine[b], j))
            .collect();
        let mut rate = dot(jets, dual, &slopes);
        if self.calculus.problem.is_time_dependent() {
            let by_time = |a: &Series<A>| self.calculus.derivative(a, n);
            let form: Vec<_> = self.expanded.forms[b].iter().map(by_time).collect();
            rate = jets.add(&rate, &dot(jets, &form, &self.duals[a]));
            for (i, row) in self.expanded.metric.iter().enumerate() {
                let row: Vec<_> = row.iter().map(by_time).collect();
                let lowered = dot(jets, &row, &self.duals[b]);
                rate = jets.sub(&rate, &jets.mul(&dual[i], &lowered));
            }
        }
        rate
    }

    /// `tau` and `sigma`, 0 if no force depends on velocities; `None` if the metric is singular.
    fn friction(&self) -> Option<Dissipation<A>> {
        let n = self.calculus.problem.coordinates;
        let Some((at_rest, slope)) = &self.expanded.friction else {
            return Some(Dissipation {
                rest: Vec::new(),
                slope: vec![Vec::new(); n],
            });
        };
        let jets = &self.calculus.jets;
        let raised = (self.duals, self.inverse_mass);
        let projected = projected(jets, &self.expanded.metric, raised)?;
        let trace = |matrix: &dyn Fn(usize, usize) -> Series<A>| {
            let mut sum = Vec::new();
            for (i, row) in projected.iter().enumerate() {
                for (j, entry) in row.iter().enumerate() {
                    sum = jets.add(&sum, &jets.mul(entry, &matrix(i, j)));
                }
            }
            sum
        };
        let rest = trace(&|i, j| at_rest[i][j].clone());
        let slope = (0..n)
            .map(|k| trace(&|i, j| slope[i][j][k].clone()))
            .collect();
        Some(Dissipation { rest, slope })
    }
}
