//! One side of an impact: metric, constraints and rates of a mode, as expressions of the state before the impact.

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, JetSpace, Jets, Pool, Series, SymbolId};

use super::dynamics::Number;
use super::examine::explicit;
use super::frame::choose_dependent;
use super::linear::{Matrix, dot, solve};
use super::minors::determinant;
use crate::model::{Model, Statement};

/// A mode at a state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Side {
    /// `g`
    pub(super) metric: Vec<Vec<ExprId>>,
    /// `eta^a` by rows, each with `eta^a_0` as its last entry.
    pub(super) forms: Vec<Vec<ExprId>>,
    /// The rates of a first-order system.
    pub(super) rates: Option<Vec<ExprId>>,
    /// `A`
    pub(super) linear: Vec<ExprId>,
    /// `V`
    pub(super) potential: ExprId,
    /// The density of the examined volume, 1 if there is none.
    pub(super) density: ExprId,
}

/// Coordinates of the states over a position: independent velocities, and all velocities as functions of them.
pub(super) struct Chart<A: Arithmetic> {
    /// The velocities that are coordinates.
    pub(super) independent: Vec<usize>,
    /// The derivatives of all velocities with respect to these, N rows.
    pub(super) basis: Vec<Vec<A::Scalar>>,
    /// `det g/det A_dep`, the density of `mu_C` up to its sign.
    pub(super) density: A::Scalar,
}

/// A row of a matrix with its affine part.
pub(super) type AffineRow<A> = (Vec<Series<A>>, Series<A>);

impl Side {
    /// The mode of a model, with the density that its claims state.
    pub(super) fn of(model: &mut Model) -> Self {
        let forms = model.constraints.iter().map(|constraint| {
            let mut row = constraint.form.clone();
            row.push(constraint.affine);
            row
        });
        let forms = forms.collect();
        Self {
            metric: model.lagrangian.metric.clone(),
            forms,
            rates: model.field.clone(),
            linear: model.lagrangian.linear.clone(),
            potential: model.lagrangian.potential,
            density: stated_density(model).map_or_else(|| model.pool.one(), |(density, _)| density),
        }
    }

    /// The projection on the constraints: rows of a matrix, each with its affine part.
    pub(super) fn projection<A: Arithmetic>(
        &self,
        jets: &Jets<'_, A>,
        series: &dyn Fn(ExprId) -> Series<A>,
    ) -> Option<Vec<AffineRow<A>>> {
        let rows = |rows: &[Vec<ExprId>]| -> Vec<Vec<Series<A>>> {
            let row = |row: &Vec<ExprId>| row.iter().map(|id| series(*id)).collect();
            rows.iter().map(row).collect()
        };
        let (metric, forms) = (rows(&self.metric), rows(&self.forms));
        let n = metric.len();
        let column = |i: usize| forms.iter().map(|form| form[i].clone()).collect();
        // W^a, N rows of M.
        let duals = solve(jets, metric, (0..n).map(column).collect())?.unknowns;
        let mass = forms.iter().map(|form| {
            let dual = |a: usize| duals.iter().map(|row| row[a].clone()).collect::<Vec<_>>();
            (0..forms.len())
                .map(|a| dot(jets, &form[..n], &dual(a)))
                .collect()
        });
        // m_ab (eta^b | eta^b_0), M rows of N + 1.
        let share = solve(jets, mass.collect(), forms.clone())?.unknowns;
        let one = jets.constant(jets.field.integer(1));
        let entry = |i: usize, j: usize| {
            let terms = duals[i].iter().zip(&share);
            let sum = jets.dot(terms.map(|(w, row)| (w.as_slice(), row[j].as_slice())));
            match i == j {
                true => jets.sub(&one, &sum),
                false => jets.scale(jets.field.integer(-1), &sum),
            }
        };
        let row = |i: usize| ((0..n).map(|j| entry(i, j)).collect(), entry(i, n));
        Some((0..n).map(row).collect())
    }

    /// All expressions, in a fixed order.
    fn expressions(&self) -> Vec<ExprId> {
        let rows = self.metric.iter().chain(&self.forms).flatten();
        let rates = self.rates.iter().flatten();
        let rest = rates.chain(&self.linear).copied();
        rows.copied()
            .chain(rest)
            .chain([self.potential, self.density])
            .collect()
    }

    /// The same side with other expressions, in the order of [`Side::expressions`].
    fn with(&self, expressions: Vec<ExprId>) -> Self {
        let mut expressions = expressions.into_iter();
        let mut take = |row: &Vec<ExprId>| expressions.by_ref().take(row.len()).collect::<Vec<_>>();
        let metric = self.metric.iter().map(&mut take).collect();
        let forms = self.forms.iter().map(&mut take).collect();
        let rates = self.rates.as_ref().map(&mut take);
        let linear = take(&self.linear);
        let [potential, density] = [0, 1].map(|_| expressions.next().unwrap_or(self.potential));
        Self {
            metric,
            forms,
            rates,
            linear,
            potential,
            density,
        }
    }

    /// The mode at the state that a map leads to.
    pub(super) fn substituted(&self, pool: &mut Pool, replacements: &[(SymbolId, ExprId)]) -> Self {
        let replaced = pool.substitute_all(&self.expressions(), replacements);
        self.with(replaced)
    }

    /// Another mode at the state with these positions and velocities; `None` if it has a symbol that this mode lacks.
    pub(super) fn of_mode(
        model: &mut Model,
        entered: &Model,
        (q, qdot): (&[ExprId], &[ExprId]),
    ) -> Option<Self> {
        let mut entered = entered.clone();
        let side = Self::of(&mut entered);
        let expressions = imported(model, &entered, (q, qdot), &side.expressions())?;
        Some(side.with(expressions))
    }

    /// Metric, constraints, rates and density.
    pub(super) fn roots(&self) -> impl Iterator<Item = ExprId> + '_ {
        let rows = self.metric.iter().chain(&self.forms).flatten();
        let rates = self.rates.iter().flatten();
        rows.chain(rates).copied().chain([self.density])
    }

    /// `A` and `V`.
    pub(super) fn forces(&self) -> impl Iterator<Item = ExprId> + '_ {
        self.linear.iter().copied().chain([self.potential])
    }

    /// The dimension of the states.
    pub(super) fn dimension(&self) -> usize {
        match self.rates {
            Some(_) => self.metric.len(),
            None => 2 * self.metric.len() - self.forms.len(),
        }
    }

    /// The coordinates of the states at a point; `None` where the constraints are dependent.
    pub(super) fn chart<P: ExpansionPoint>(
        &self,
        point: &P,
        values: &[Number<P>],
    ) -> Option<Chart<P::Field>> {
        let field = point.field();
        let n = self.metric.len();
        if self.rates.is_some() {
            return Some(Chart {
                independent: Vec::new(),
                basis: vec![Vec::new(); n],
                density: field.integer(1),
            });
        }
        let space = JetSpace::new(0, 0, 1)?;
        let jets = Jets::new(field, &space);
        let number = |id: &ExprId| values[id.index()];
        let rows = |rows: &[Vec<ExprId>]| -> Vec<Vec<Number<P>>> {
            let row = |row: &Vec<ExprId>| row.iter().take(n).map(number).collect();
            rows.iter().map(row).collect()
        };
        let forms: Matrix<P::Field> = (rows(&self.forms).into_iter())
            .map(|row| row.into_iter().map(|value| jets.constant(value)).collect())
            .collect();
        let dependent = choose_dependent(&jets, &forms)?;
        let independent: Vec<usize> = (0..n).filter(|i| !dependent.contains(i)).collect();
        let columns = |columns: &[usize]| -> Matrix<P::Field> {
            let row = |row: &Vec<_>| columns.iter().map(|j| Vec::clone(&row[*j])).collect();
            forms.iter().map(row).collect()
        };
        let solved = solve(&jets, columns(&dependent), columns(&independent))?;
        let mut basis = vec![vec![field.integer(0); independent.len()]; n];
        for (k, i) in independent.iter().enumerate() {
            basis[*i][k] = field.integer(1);
        }
        for (j, row) in dependent.iter().zip(&solved.unknowns) {
            for (component, entry) in basis[*j].iter_mut().zip(row) {
                *component = field.neg(jets.value(entry));
            }
        }
        let minor = field.inv(jets.value(&solved.determinant))?;
        let metric = determinant(field, &rows(&self.metric))?;
        Some(Chart {
            independent,
            basis,
            density: field.mul(metric, minor),
        })
    }

    /// The velocities of the motion at the state before a passage.
    pub(super) fn velocities(&self, model: &mut Model) -> Vec<ExprId> {
        match &self.rates {
            Some(rates) => rates.clone(),
            None => velocities_of(model),
        }
    }
}

/// A quantity, which may name `energy` and momenta, in another mode at the state with these positions and velocities.
/// `None` if it is not known in that mode.
pub(super) fn quantity_of_mode(
    model: &mut Model,
    entered: &Model,
    quantity: ExprId,
    (q, qdot): (&[ExprId], &[ExprId]),
) -> Option<ExprId> {
    let mut entered = entered.clone();
    let there = named_in(model, &mut entered, quantity)?;
    Some(imported(model, &entered, (q, qdot), &[there])?[0])
}

/// The quantity with the same names in another mode, written out; `None` if that mode lacks one of the names.
pub(super) fn named_in(model: &Model, entered: &mut Model, quantity: ExprId) -> Option<ExprId> {
    let mut known = vec![
        (model.time, entered.time),
        (model.derived.energy, entered.derived.energy),
    ];
    for (i, here) in model.coordinates.iter().enumerate() {
        let mut others = entered.coordinates.iter().enumerate();
        if let Some((j, other)) = others.find(|(_, other)| other.name == here.name) {
            let momenta = (model.derived.momenta[i], entered.derived.momenta[j]);
            known.extend([(here.q, other.q), (here.qdot, other.qdot), momenta]);
        }
    }
    for here in &model.parameters {
        let other = entered
            .parameters
            .iter()
            .find(|other| other.name == here.name)?;
        known.push((here.symbol, other.symbol));
    }
    let known: Vec<_> = known
        .into_iter()
        .map(|(here, other)| (here, entered.pool.variable(other)))
        .collect();
    let there = entered.pool.import(&model.pool, &[quantity], &known)?[0];
    Some(explicit(entered, there))
}

/// Expressions of another mode, at the state with these positions and velocities, as expressions of this mode. `None`
/// if the other mode has a parameter that this mode lacks, or if an expression contains another unknown symbol.
pub(super) fn imported(
    model: &mut Model,
    entered: &Model,
    after: (&[ExprId], &[ExprId]),
    expressions: &[ExprId],
) -> Option<Vec<ExprId>> {
    let replacements = replacements(model, entered, after)?;
    model.pool.import(&entered.pool, expressions, &replacements)
}

/// The symbols of a mode at the state with these positions and velocities, with the expressions of this model that
/// replace them. `None` if this model lacks a parameter of the mode.
fn replacements(
    model: &mut Model,
    entered: &Model,
    (q, qdot): (&[ExprId], &[ExprId]),
) -> Option<Vec<(SymbolId, ExprId)>> {
    let mut replacements = vec![(entered.time, model.pool.variable(model.time))];
    for (coordinate, after) in entered.coordinates.iter().zip(q) {
        replacements.push((coordinate.q, *after));
    }
    for (coordinate, after) in entered.coordinates.iter().zip(qdot) {
        replacements.push((coordinate.qdot, *after));
    }
    for parameter in &entered.parameters {
        let here = model
            .parameters
            .iter()
            .find(|here| here.name == parameter.name)?;
        replacements.push((parameter.symbol, model.pool.variable(here.symbol)));
    }
    Some(replacements)
}

/// The density that the claims of a model state, written out, and its text.
pub(super) fn stated_density(model: &mut Model) -> Option<(ExprId, String)> {
    let claims = model.claims.iter().filter(|claim| claim.scene.is_none());
    let found = claims.clone().find_map(|claim| match &claim.statement {
        Statement::Density(value) => Some((*value, claim.text.clone())),
        _ => None,
    });
    let (value, text) = found?;
    let written = text.trim_start_matches("density = ").to_owned();
    Some((explicit(model, value), written))
}

/// The velocities of a model, as variables.
pub(super) fn velocities_of(model: &mut Model) -> Vec<ExprId> {
    let symbols: Vec<SymbolId> = model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.qdot)
        .collect();
    symbols
        .into_iter()
        .map(|symbol| model.pool.variable(symbol))
        .collect()
}
