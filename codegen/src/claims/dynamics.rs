//! The motion on D at a point: velocities that satisfy the constraints, and their rates.
//!
//! ```text
//! eta^a(qdot) + eta^a_0 = 0                       solved for the dependent velocities
//! g qddot = f - drift + lambda_a eta^a            eta^a(qddot) = -curvature_a
//! m^{ab} lambda_b = -[ W^a.(f - drift) + curvature_a ]
//! ```
//!
//! The terms are those of the emitted field (see [`crate::mechanics`]): metric, velocity-linear part, potential and
//! forces may depend on time, forces on velocities, and constraints may be affine.

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, JetSpace, Jets, Pool, Series, SymbolId};

use super::branches::{Branch, branches};
use super::frame::{choose_dependent, column};
use super::linear::{Matrix, dot, solve, transpose};
use super::locus::Locus;
use crate::mechanics::{ConstraintForm, Derivation};
use crate::model::Model;

/// A number at a point.
pub(super) type Number<P> = <<P as ExpansionPoint>::Field as Arithmetic>::Scalar;

/// The equations of motion of a model, to be evaluated at points.
#[derive(Debug, Clone)]
pub struct Dynamics {
    /// M rows of N + 1 entries, `eta^a` and then `eta^a_0`, with their evaluation order.
    forms: Rows,
    /// Indices of the rows of constraints that are linear in the velocities.
    linear: Vec<usize>,
    /// Constraints that are not linear, see [`Dynamics::on_branches`].
    branches: Vec<Branch>,
    /// N rows of N + 1 entries, `g` and then `f - drift`, followed by one row of the M curvatures.
    motion: Rows,
    /// Positions that satisfy the position equations.
    positions: Locus,
    q: Vec<SymbolId>,
    qdot: Vec<SymbolId>,
    time: SymbolId,
}

/// The motion at a state on D.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion<S> {
    /// The velocities.
    pub qdot: Vec<S>,
    /// The accelerations.
    pub qddot: Vec<S>,
    /// The multipliers of the constraints.
    pub multipliers: Vec<S>,
}

/// Rows of expressions, with an order in which to evaluate them.
#[derive(Debug, Clone)]
struct Rows {
    rows: Vec<Vec<ExprId>>,
    order: Vec<ExprId>,
}

impl Rows {
    fn new(pool: &Pool, rows: Vec<Vec<ExprId>>) -> Self {
        let roots: Vec<_> = rows.iter().flatten().copied().collect();
        let order = pool.reachable(&roots);
        Self { rows, order }
    }

    fn at<P: ExpansionPoint>(&self, pool: &Pool, point: &mut P) -> Option<Vec<Vec<Number<P>>>> {
        let values = point.values(pool, &self.order)?;
        let of = |row: &Vec<ExprId>| row.iter().map(|id| values[id.index()]).collect();
        Some(self.rows.iter().map(of).collect())
    }
}

/// A first-order system as constraints on all velocities: `dq^i - f^i dt = 0`, with the curvatures
/// `-(d_j f^i) qdot^j - d_t f^i`.
fn prescribed(model: &mut Model, rates: &[ExprId]) -> (Vec<Vec<ExprId>>, Vec<ExprId>) {
    let mut motion: Vec<(SymbolId, ExprId)> = Vec::new();
    for coordinate in &model.coordinates {
        let qdot = model.pool.variable(coordinate.qdot);
        motion.push((coordinate.q, qdot));
    }
    motion.push((model.time, model.pool.one()));
    let (zero, one) = (model.pool.zero(), model.pool.one());
    let rows = rates.iter().enumerate().map(|(i, &rate)| {
        let mut row = vec![zero; rates.len()];
        row[i] = one;
        row.push(model.pool.neg(rate));
        row
    });
    let rows = rows.collect();
    let curvatures = rates.iter().map(|&rate| {
        let along = model.pool.derivative_along(rate, &motion);
        model.pool.neg(along)
    });
    (rows, curvatures.collect())
}

impl Dynamics {
    /// The equations of a model.
    pub fn of(model: &mut Model, derivation: &Derivation) -> Self {
        let curvature = |constraint: &ConstraintForm| constraint.curvature;
        let mut forms = Vec::new();
        for constraint in &derivation.constraints {
            let mut row = constraint.form.clone();
            row.push(constraint.affine);
            forms.push(row);
        }
        let mut curvatures: Vec<ExprId> = derivation.constraints.iter().map(curvature).collect();
        if let Some(rates) = model.field.clone() {
            (forms, curvatures) = prescribed(model, &rates);
        }
        let field = &derivation.field;
        let mut motion = model.lagrangian.metric.clone();
        for ((row, force), drift) in motion.iter_mut().zip(&field.force).zip(&field.drift) {
            row.push(model.pool.sub(*force, *drift));
        }
        motion.push(curvatures);
        let is_linear = |index: &usize| match model.constraints.get(*index) {
            Some(constraint) => constraint.nonlinear.is_none(),
            None => true,
        };
        Self {
            linear: (0..forms.len()).filter(is_linear).collect(),
            branches: Vec::new(),
            forms: Rows::new(&model.pool, forms),
            motion: Rows::new(&model.pool, motion),
            positions: Locus::of_model(model),
            q: model
                .coordinates
                .iter()
                .map(|coordinate| coordinate.q)
                .collect(),
            qdot: model
                .coordinates
                .iter()
                .map(|coordinate| coordinate.qdot)
                .collect(),
            time: model.time,
        }
    }

    /// The equations on each part of D. Every choice of roots of the nonlinear constraints gives a part. `None` if one
    /// of these constraints cannot be solved, see [`branches()`].
    pub(super) fn on_branches(
        self,
        model: &mut Model,
        derivation: &Derivation,
    ) -> Option<Vec<Self>> {
        let branches = branches(model, derivation)?;
        let with = |choice: usize| {
            let mut chosen = branches.clone();
            for (a, branch) in chosen.iter_mut().enumerate() {
                branch.is_second = choice >> a & 1 == 1;
            }
            Self {
                branches: chosen,
                ..self.clone()
            }
        };
        Some((0..1 << branches.len()).map(with).collect())
    }

    /// Velocities for which nonlinear constraints are solved.
    pub(super) fn roots_of_branches(&self) -> impl Iterator<Item = SymbolId> {
        self.branches.iter().map(|branch| branch.velocity)
    }

    /// The equations with parameters replaced.
    pub(super) fn substituted(&self, pool: &mut Pool, replacements: &[(SymbolId, ExprId)]) -> Self {
        let branches: Vec<Branch> = self
            .branches
            .iter()
            .map(|branch| branch.substituted(pool, replacements))
            .collect();
        let mut replaced = |block: &Rows| {
            let rows = block.rows.iter();
            let rows = rows.map(|row| pool.substitute_all(row, replacements));
            let rows = rows.collect();
            Rows::new(pool, rows)
        };
        Self {
            forms: replaced(&self.forms),
            motion: replaced(&self.motion),
            positions: self.positions.substituted(pool, replacements),
            branches,
            ..self.clone()
        }
    }

    /// Positions that satisfy the position equations.
    pub(super) fn positions(&self) -> &Locus {
        &self.positions
    }

    /// `eta^a` and `eta^a_0` by rows; `g` and `f - drift` by rows, then the row of the curvatures.
    pub(super) fn equations(&self) -> [&[Vec<ExprId>]; 2] {
        [&self.forms.rows, &self.motion.rows]
    }

    /// All expressions to be evaluated.
    pub(super) fn roots(&self) -> Vec<ExprId> {
        let rows = self.forms.rows.iter().chain(&self.motion.rows);
        let roots = rows.flatten().copied();
        roots
            .chain(self.branches.iter().flat_map(Branch::roots))
            .collect()
    }

    /// The motion at the state on D with the coordinates and independent velocities of `point`. Sets the dependent
    /// velocities in `point`. `dependent` gives their indices; `None` chooses them as in `frame.rs`. Returns `None` at
    /// a singular point.
    pub fn motion<P: ExpansionPoint>(
        &self,
        pool: &Pool,
        point: &mut P,
        dependent: Option<&[usize]>,
    ) -> Option<Motion<Number<P>>> {
        let space = JetSpace::new(0, 0, 1)?;
        let jets = Jets::new(point.field(), &space);
        let constants = |rows: Vec<Vec<Number<P>>>| -> Matrix<P::Field> {
            let row = |row: Vec<_>| {
                row.into_iter()
                    .map(|number| jets.constant(number))
                    .collect()
            };
            rows.into_iter().map(row).collect()
        };
        let mut forms = constants(self.forms.at(pool, point)?);
        let linear: Matrix<P::Field> = self.linear.iter().map(|a| forms[*a].clone()).collect();
        self.settle(pool, point, &jets, &linear, dependent)?;
        for branch in &self.branches {
            branch.settle(pool, point)?;
        }
        if !self.branches.is_empty() {
            // The forms of nonlinear constraints depend on the velocities just set.
            forms = constants(self.forms.at(pool, point)?);
        }
        let qdot = self
            .qdot
            .iter()
            .map(|symbol| point.symbol(pool, *symbol))
            .collect();
        let mut rows = self.motion.at(pool, point)?;
        let curvature = constants(vec![rows.pop()?]).pop()?;
        let rows = constants(rows);
        let [qddot, multipliers] = accelerate(&jets, rows, &forms, &curvature)?;
        let numbers = |series: Vec<Vec<_>>| {
            series
                .iter()
                .map(|entry| jets.value(entry))
                .collect::<Vec<_>>()
        };
        Some(Motion {
            qdot,
            qddot: numbers(qddot),
            multipliers: numbers(multipliers),
        })
    }

    /// Sets the dependent velocities of linear constraints.
    fn settle<P: ExpansionPoint>(
        &self,
        pool: &Pool,
        point: &mut P,
        jets: &Jets<'_, P::Field>,
        forms: &Matrix<P::Field>,
        dependent: Option<&[usize]>,
    ) -> Option<()> {
        let n = self.q.len();
        let dependent = match dependent {
            Some(given) => given.to_vec(),
            None => {
                let linear: Vec<_> = forms.iter().map(|row| row[..n].to_vec()).collect();
                choose_dependent(jets, &linear)?
            }
        };
        let field = jets.field;
        let mut right = Vec::new();
        for row in forms {
            let mut sum = jets.value(&row[n]);
            for i in (0..n).filter(|i| !dependent.contains(i)) {
                let velocity = point.symbol(pool, self.qdot[i]);
                sum = field.add(sum, field.mul(jets.value(&row[i]), velocity));
            }
            right.push(vec![jets.constant(field.neg(sum))]);
        }
        let minor = forms
            .iter()
            .map(|row| dependent.iter().map(|j| row[*j].clone()).collect())
            .collect();
        let solved = solve(jets, minor, right)?.unknowns;
        for (j, row) in dependent.iter().zip(&solved) {
            point.set_symbol(self.qdot[*j], jets.value(&row[0]));
        }
        Some(())
    }

    /// Time derivatives of expressions of coordinates, velocities and time along `motion`. `point` is the state of the
    /// motion.
    pub fn rates<P: ExpansionPoint>(
        &self,
        pool: &Pool,
        expressions: &[ExprId],
        motion: &Motion<Number<P>>,
        point: &mut P,
    ) -> Option<Vec<Number<P>>> {
        let pairs = self.values_and_rates(pool, expressions, motion, point)?;
        Some(pairs.into_iter().map(|[_, rate]| rate).collect())
    }

    /// Each expression's value and its rate along `motion`; see [`Dynamics::rates`].
    pub fn values_and_rates<P: ExpansionPoint>(
        &self,
        pool: &Pool,
        expressions: &[ExprId],
        motion: &Motion<Number<P>>,
        point: &mut P,
    ) -> Option<Vec<[Number<P>; 2]>> {
        let mut variables = self.q.clone();
        variables.extend(&self.qdot);
        variables.push(self.time);
        let field = point.field();
        let mut direction = motion.qdot.clone();
        direction.extend(&motion.qddot);
        direction.push(field.integer(1));
        let space = JetSpace::new(variables.len(), 1, usize::MAX)?;
        let jets = Jets::new(field, &space);
        let series = pool.taylor(expressions, &variables, &jets, point)?;
        let along = |series: &Vec<Number<P>>| {
            let mut sum = field.integer(0);
            for (slope, rate) in series.iter().skip(1).zip(&direction) {
                sum = field.add(sum, field.mul(*slope, *rate));
            }
            [jets.value(series), sum]
        };
        Some(series.iter().map(along).collect())
    }
}

/// Accelerations and multipliers as series; `None` if metric or constraint mass matrix is singular. `rows` are
/// `(g | f - drift)`, `forms` are `(eta | eta_0)`.
pub(super) fn accelerate<A: Arithmetic>(
    jets: &Jets<'_, A>,
    rows: Matrix<A>,
    forms: &Matrix<A>,
    curvature: &[Series<A>],
) -> Option<[Vec<Series<A>>; 2]> {
    let n = rows.len();
    let force = column(&rows, n);
    let metric = rows.iter().map(|row| row[..n].to_vec()).collect();
    // g^{-1} (eta^1 .. eta^M | f - drift)
    let right = (0..n)
        .map(|i| {
            let mut row = column(forms, i);
            row.push(force[i].clone());
            row
        })
        .collect();
    let mut raised = transpose(&solve(jets, metric, right)?.unknowns);
    let mut qddot = raised.pop()?;
    let mass = forms
        .iter()
        .map(|form| {
            raised
                .iter()
                .map(|dual| dot(jets, &form[..n], dual))
                .collect()
        })
        .collect();
    let lacking = forms.iter().zip(curvature).map(|(form, curvature)| {
        let missing = jets.add(&dot(jets, &form[..n], &qddot), curvature);
        vec![jets.scale(jets.field.integer(-1), &missing)]
    });
    let multipliers = column(&solve(jets, mass, lacking.collect())?.unknowns, 0);
    for (multiplier, dual) in multipliers.iter().zip(&raised) {
        for (acceleration, w) in qddot.iter_mut().zip(dual) {
            *acceleration = jets.add(acceleration, &jets.mul(multiplier, w));
        }
    }
    Some([qddot, multipliers])
}
