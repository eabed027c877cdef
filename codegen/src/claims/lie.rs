//! Lie derivative of a form along the motion, on vectors of constant time:
//! `L_X (c df_1 ^ .. ^ df_k) = X(c) df_1 ^ .. ^ df_k + c d(X f_1) ^ .. ^ df_k + ..`
//!
//! The motion is defined on the whole space. It keeps `eta^a(qdot) + eta^a_0`, so the derivative and the restriction to
//! D commute.

use dalembert_expr::{
    Arithmetic, ExpansionPoint, ExprId, JetSpace, Jets, RealPoint, Reals, Series, SymbolId,
};

use super::dynamics::{Dynamics, Number};
use super::evidence::{Vanishing, in_arguments};
use super::expansion::{Expansions, Part, Products, Tangents, accelerations, inner};
use crate::model::{ExteriorForm, Model, Wedge};

/// The question whether a form, or its derivative along the motion, vanishes at all states.
pub(super) struct Lie<'l> {
    dynamics: &'l Dynamics,
    tangents: &'l Tangents,
    form: &'l ExteriorForm,
    expansions: Expansions,
    rates: Option<Vec<ExprId>>,
    /// True for a question about the form itself, false for its derivative.
    is_form: bool,
    pub(super) part: Part,
    pub(super) shown: String,
}

impl<'l> Lie<'l> {
    /// The question about the derivative of a form, in which energy, momenta and rates are written out.
    pub(super) fn of(
        model: &mut Model,
        dynamics: &'l Dynamics,
        tangents: &'l Tangents,
        form: &'l ExteriorForm,
    ) -> Self {
        let mut expansions = Expansions::of(model);
        let pool = &mut model.pool;
        expansions.add(pool, form.expressions());
        let differentials = form.terms.iter().flat_map(|term| &term.differentials);
        for id in differentials {
            let slopes = expansions.slopes(*id).to_vec();
            expansions.add(pool, slopes);
        }
        expansions.add(pool, tangents.residuals.iter().copied());
        match &model.field {
            Some(rates) => expansions.add(pool, rates.iter().copied()),
            None => expansions.add(
                pool,
                dynamics
                    .equations()
                    .into_iter()
                    .flatten()
                    .flatten()
                    .copied(),
            ),
        }
        Self {
            dynamics,
            tangents,
            form,
            expansions,
            rates: model.field.clone(),
            is_form: false,
            part: Part::All(0),
            shown: String::new(),
        }
    }

    /// The same question about the form itself.
    pub(super) fn of_form(self) -> Self {
        Self {
            is_form: true,
            ..self
        }
    }

    /// The motion as series in the variables of a state: rates of positions, velocities and time.
    fn motion<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &P,
        jets: &Jets<'_, P::Field>,
        values: &[Number<P>],
    ) -> Option<Vec<Series<P::Field>>> {
        let n = model.coordinates.len();
        let series = |id: ExprId| self.expansions.series(jets, values, id);
        let mut motion: Vec<Series<P::Field>>;
        match &self.rates {
            Some(rates) => {
                motion = rates.iter().map(|rate| series(*rate)).collect();
                motion.resize(2 * n, Vec::new());
            }
            None => {
                let symbols = model.coordinates.iter().enumerate();
                let velocities = symbols.map(|(i, coordinate)| {
                    jets.variable(n + i, point.symbol(&model.pool, coordinate.qdot))
                });
                motion = velocities.collect();
                motion.extend(accelerations(jets, self.dynamics.equations(), &series)?);
            }
        }
        motion.push(jets.constant(jets.field.integer(1)));
        Some(motion)
    }

    /// The products whose sum is the form or its derivative.
    pub(super) fn products<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
    ) -> Option<Products<Number<P>>> {
        let field = point.field();
        let values = point.values(&model.pool, &model.pool.reachable(&self.roots()))?;
        let expansions = &self.expansions;
        let vectors = self.tangents.vectors(field, expansions, &values)?;
        let space = JetSpace::new(expansions.size(), 1, usize::MAX)?;
        let jets = Jets::new(field, &space);
        let motion = match self.is_form {
            true => Vec::new(),
            false => self.motion(model, point, &jets, &values)?,
        };
        let speeds: Vec<Number<P>> = motion.iter().map(|entry| jets.value(entry)).collect();
        let row = |id: ExprId| -> Vec<Number<P>> {
            let along = |vector: &Vec<_>| expansions.along(field, &values, id, vector);
            vectors.iter().map(along).collect()
        };
        let carried = |id: ExprId| -> Vec<Number<P>> {
            let slopes = expansions.slopes(id).iter();
            let slopes: Vec<_> = slopes
                .map(|slope| expansions.series(&jets, &values, *slope))
                .collect();
            let pairs = slopes.iter().zip(&motion);
            let rate = jets.dot(pairs.map(|(a, b)| (a.as_slice(), b.as_slice())));
            let along = |vector: &Vec<_>| inner(field, rate.iter().skip(1).copied(), vector);
            vectors.iter().map(along).collect()
        };
        let mut products = Products::new();
        for term in &self.form.terms {
            let coefficient = expansions.value(&values, term.coefficient);
            let rows: Vec<Vec<_>> = term.differentials.iter().map(|id| row(*id)).collect();
            if self.is_form {
                products.push(coefficient, rows);
                continue;
            }
            for (place, id) in term.differentials.iter().enumerate() {
                let mut rows = rows.clone();
                rows[place] = carried(*id);
                products.push(coefficient, rows);
            }
            let rate = expansions.along(field, &values, term.coefficient, &speeds);
            products.push(rate, rows);
        }
        Some(products)
    }

    /// Size of the terms of the derivative at a real state: rates of large functions may cancel.
    fn ingredients(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let values = RealPoint::values(point, &model.pool, &model.pool.reachable(&self.roots()))?;
        let expansions = &self.expansions;
        let space = JetSpace::new(expansions.size(), 1, usize::MAX)?;
        let jets = Jets::new(Reals, &space);
        let motion = self.motion(model, point, &jets, &values)?;
        let vectors = self.tangents.vectors(Reals, expansions, &values)?;
        let length = |row: &[f64]| row.iter().map(|entry| entry.abs()).sum::<f64>();
        let longest = vectors.iter().map(|vector| length(vector));
        let longest = longest.fold(1.0, f64::max);
        let slopes = |id: ExprId| expansions.slopes(id).iter();
        let rate = |id: ExprId| -> f64 {
            let pairs = slopes(id).zip(&motion);
            let pairs =
                pairs.map(|(slope, speed)| values[slope.index()].abs() * jets.value(speed).abs());
            pairs.sum()
        };
        let turned = |id: ExprId| -> f64 {
            let pairs = slopes(id).zip(&motion);
            let pairs = pairs.map(|(slope, speed)| {
                let slope = expansions.series(&jets, &values, *slope);
                jets.value(&slope).abs() * length(speed) + length(&slope) * jets.value(speed).abs()
            });
            pairs.sum()
        };
        let row = |id: &ExprId| {
            let along = slopes(*id).map(|slope| values[slope.index()].abs());
            (along.sum::<f64>() * longest).max(1.0)
        };
        let term = |term: &Wedge| {
            let rows: Vec<f64> = term.differentials.iter().map(row).collect();
            let whole: f64 = rows.iter().product();
            let places = term.differentials.iter().zip(&rows);
            let carried: f64 = places.map(|(id, row)| turned(*id) * longest / row).sum();
            let coefficient = expansions.value(&values, term.coefficient).abs();
            whole * (coefficient * carried + rate(term.coefficient))
        };
        Some(self.form.terms.iter().map(term).sum())
    }

    /// The dimension of the states and the degree.
    pub(super) fn sizes(&self) -> (usize, usize) {
        (self.tangents.dimension(), self.form.degree)
    }
}

impl Vanishing for Lie<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let mut roots: Vec<ExprId> = self.expansions.roots().collect();
        roots.extend(self.dynamics.roots());
        roots
    }

    fn hides_relations(&self, model: &Model) -> bool {
        let solved: Vec<SymbolId> = self.dynamics.roots_of_branches().collect();
        in_arguments(&model.pool, &self.roots(), &solved)
    }

    fn dynamics(&self) -> Option<&Dynamics> {
        Some(self.dynamics)
    }

    fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let products = self.products(model, point)?;
        let total = products.total(point.field(), &self.part, self.sizes())?;
        Some(vec![total])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let mut size = self.products(model, point)?.size();
        if !self.is_form {
            size = size.max(self.ingredients(model, point)?);
        }
        Some(match self.part {
            Part::One(_) => size,
            Part::All(_) => size / super::expansion::CHANCE,
        })
    }

    fn shown(&self, _: &Model, _: &[f64], sum: f64) -> Vec<(String, f64)> {
        vec![(self.shown.clone(), sum)]
    }
}
