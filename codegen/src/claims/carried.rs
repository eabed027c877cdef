//! Invariance of a differential form at a surface: its values before and after, on vectors that the motion carries
//! through the surface.
//!
//! ```text
//! v+ = dDelta(v) + (X+ - dDelta(X)) dh(v)/dh(X)      w+(v+_1, .., v+_k) = w(v_1, .., v_k)
//! ```
//!
//! `dDelta` is the derivative of the impact map; X and X+ are the motions before and after, w and w+ the form. X has
//! time rate 1, the vectors have time rate 0. On vectors tangent to the surface, the condition is that w is the pullback
//! of w+ by the map. With X as one of the vectors it is the specular condition (W. Clark, thesis, VII.3). At a
//! transition X+ and w+ belong to the entered mode.

use std::cmp::Ordering;

use dalembert_expr::{
    Arithmetic, Ball, BallPoint, ExpansionPoint, ExprId, JetSpace, Jets, RealPoint, Series,
    SymbolId,
};

use super::collision::{AtImpact, with_difference};
use super::contact::Contact;
use super::dynamics::{Dynamics, Number};
use super::expansion::{
    CHANCE, Expansions, Part, Products, Tangents, accelerations, constants, explicit_form, inner,
    weight, with_rates, written_out,
};
use super::hybrid::Surroundings;
use super::invariant::Stated;
use super::passage::{Passage, Velocities, positions};
use super::side::{imported, named_in, velocities_of};
use super::sliding::may_slide;
use super::symplectic::symplectic_form;
use super::wall::Wall;
use crate::mechanics::derive;
use crate::model::{ExteriorForm, Model};

/// The motion and the form behind a surface, as expressions of the state there.
#[derive(Debug)]
struct Behind {
    /// Rates of a first-order system.
    rates: Option<Vec<ExprId>>,
    /// Equations of motion: constraints, and equations of the accelerations.
    equations: [Vec<Vec<ExprId>>; 2],
    /// Coefficients of the form's terms, each with the derivatives of the term's functions with respect to positions
    /// and velocities.
    terms: Vec<(ExprId, Vec<Vec<ExprId>>)>,
}

/// The form as a sum of products, after and before the surface.
type Sides<S> = [Products<S>; 2];

/// Tangent vectors before a surface and their images, with the values of all expressions on both sides.
struct Carry<S> {
    values: Vec<S>,
    vectors: Vec<Vec<S>>,
    behind: Vec<S>,
    carried: Vec<Vec<S>>,
    outgoing: Vec<S>,
    /// Gap rate behind the surface, and its derivative along the free motion.
    gap_rates: Option<[S; 2]>,
}

/// A form at a surface.
pub(super) struct Carried<'c> {
    wall: &'c Wall,
    tangents: &'c Tangents,
    form: &'c ExteriorForm,
    /// All expressions before the surface, with their expansions.
    expansions: Expansions,
    /// Motion before the surface.
    dynamics: Dynamics,
    rates: Option<Vec<ExprId>>,
    positions: Vec<ExprId>,
    behind: Behind,
    /// Motion behind the surface, if the law admits two motions.
    contact: Option<Contact>,
    /// Seed of random weights. Present if the question is about leaves behind the surface instead of the form.
    leaves: Option<u64>,
    pub(super) part: Part,
    pub(super) shown: String,
}

impl<'c> Carried<'c> {
    /// A form at a wall. `entered` is the entered mode of a transition.
    ///
    /// # Errors
    /// The reason why the form is unknown behind the wall.
    pub(super) fn of(
        model: &mut Model,
        around: &Surroundings<'_>,
        (form, stated): (&'c ExteriorForm, Stated<'_>),
        tangents: &'c Tangents,
        (wall, entered): (&'c Wall, Option<&Model>),
    ) -> Result<Self, String> {
        let behind = Behind::of(model, around, stated, wall, entered)
            .ok_or("the form is not known after it")?;
        let positions = positions_behind(model, wall);
        let mut expansions = Expansions::of(model);
        let mut before: Vec<ExprId> = form.expressions().collect();
        before.extend(&positions);
        before.extend(&tangents.residuals);
        before.push(wall.gap);
        before.extend(match &wall.passage {
            Some(passage) => passage.velocity_roots(),
            None => wall.roots.clone(),
        });
        before.extend(model.field.iter().flatten());
        expansions.add(&mut model.pool, before);
        let mut found = Self {
            wall,
            tangents,
            form,
            expansions,
            dynamics: around.dynamics.clone(),
            rates: model.field.clone(),
            positions,
            behind,
            contact: None,
            leaves: None,
            part: Part::All(0),
            shown: String::new(),
        };
        if let Some(solution) = wall.solution() {
            found.restrict(model, solution);
        }
        Ok(found)
    }

    /// Substitutes the solution of the gap for a coordinate in all expressions.
    fn restrict(&mut self, model: &mut Model, solution: (SymbolId, ExprId)) {
        let pool = &mut model.pool;
        self.expansions.restrict(pool, solution);
        self.dynamics = self.dynamics.substituted(pool, &[solution]);
        let mut on_surface = |row: &mut Vec<ExprId>| *row = pool.substitute_all(row, &[solution]);
        let behind = &mut self.behind;
        behind.rates.iter_mut().for_each(&mut on_surface);
        behind
            .equations
            .iter_mut()
            .flatten()
            .for_each(&mut on_surface);
        for (coefficient, slopes) in &mut behind.terms {
            let mut single = vec![*coefficient];
            on_surface(&mut single);
            *coefficient = single[0];
            slopes.iter_mut().for_each(&mut on_surface);
        }
    }

    /// True if the velocities behind the wall are computed at a point. Otherwise they are expressions.
    fn computes_velocities(&self) -> bool {
        let passage = self.wall.passage.as_ref();
        passage.is_none_or(Passage::computes_velocities)
    }

    /// Positions and velocities behind the wall, as series in the variables before it.
    fn map<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &P,
        jets: &Jets<'_, P::Field>,
        values: &[Number<P>],
    ) -> Option<[Vec<Series<P::Field>>; 2]> {
        let n = model.coordinates.len();
        let series = |id: ExprId| self.expansions.series(jets, values, id);
        let positions = self.positions.iter().map(|id| series(*id)).collect();
        if self.rates.is_some() {
            return Some([positions, Vec::new()]);
        }
        let velocity: Vec<_> = (model.coordinates.iter().enumerate())
            .map(|(i, coordinate)| jets.variable(n + i, point.symbol(&model.pool, coordinate.qdot)))
            .collect();
        let velocities = match &self.wall.passage {
            Some(passage) => passage.velocities_along(jets, point, &series, &velocity)?,
            None => self.wall.struck(jets, &series, &velocity)?,
        };
        Some([positions, velocities])
    }

    /// Motion before the surface: rates of positions, velocities and time. Sets the dependent velocities of the point;
    /// they satisfy the constraints on the surface if a coordinate was replaced by its value there.
    fn motion_before<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
    ) -> Option<Vec<Number<P>>> {
        let field = point.field();
        let found = self.dynamics.motion(&model.pool, point, None)?;
        let mut motion = found.qdot;
        match self.rates {
            Some(_) => motion.resize(2 * motion.len(), field.integer(0)),
            None => motion.extend(found.qddot),
        }
        motion.push(field.integer(1));
        Some(motion)
    }

    /// Values of the expressions behind the surface. `velocities` are set first if they are computed.
    fn values_behind<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        velocities: &[Number<P>],
    ) -> Option<Vec<Number<P>>> {
        let mut roots = self.behind.roots();
        roots.extend(self.contact.iter().flat_map(Contact::roots));
        let order = model.pool.reachable(&roots);
        if !self.computes_velocities() || self.rates.is_some() {
            return point.values(&model.pool, &order);
        }
        let symbols: Vec<SymbolId> = model
            .coordinates
            .iter()
            .map(|coordinate| coordinate.qdot)
            .collect();
        let before: Vec<_> = (symbols.iter())
            .map(|symbol| point.symbol(&model.pool, *symbol))
            .collect();
        for (symbol, velocity) in symbols.iter().zip(velocities) {
            point.set_symbol(*symbol, *velocity);
        }
        let values = point.values(&model.pool, &order);
        for (symbol, velocity) in symbols.iter().zip(before) {
            point.set_symbol(*symbol, velocity);
        }
        values
    }

    /// The tangent vectors and their images behind the surface.
    fn carry<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Carry<Number<P>>> {
        let field = point.field();
        let incoming = self.motion_before(model, point)?;
        let roots: Vec<ExprId> = self.expansions.roots().collect();
        let values = point.values(&model.pool, &model.pool.reachable(&roots))?;
        let vectors = self.tangents.vectors(field, &self.expansions, &values)?;
        let space = JetSpace::new(self.expansions.size(), 1, usize::MAX)?;
        let jets = Jets::new(field, &space);
        let [positions, velocities] = self.map(model, point, &jets, &values)?;
        let numbers = |series: &[Series<P::Field>]| -> Vec<Number<P>> {
            series.iter().map(|entry| jets.value(entry)).collect()
        };
        let behind = self.values_behind(model, point, &numbers(&velocities))?;
        let velocities_behind = numbers(&velocities);
        let mut outgoing = self
            .behind
            .motion::<P>(field, &velocities_behind, &behind)?;
        let gap = |vector: &Vec<_>| self.expansions.along(field, &values, self.wall.gap, vector);
        let lost = gap(&incoming);
        let gap_rates = (self.contact.as_ref()).map(|it| it.rates(field, &behind, &outgoing));
        if let (Some(contact), Some([_, along])) = (&self.contact, gap_rates)
            && contact.is_held
        {
            let velocities = [&incoming[..velocities_behind.len()], &velocities_behind];
            contact.hold(field, &mut outgoing, velocities, (along, lost))?;
        }
        let push = |vector: &Vec<Number<P>>| -> Vec<Number<P>> {
            let along =
                |series: &Series<P::Field>| inner(field, series.iter().skip(1).copied(), vector);
            positions.iter().chain(&velocities).map(along).collect()
        };
        let share = field.inv(lost)?;
        let image = push(&incoming);
        let carried = vectors.iter().map(|vector| {
            let share = field.mul(gap(vector), share);
            let ends = push(vector).into_iter().zip(outgoing.iter().zip(&image));
            let turned = ends
                .map(|(pushed, (to, by))| field.add(pushed, field.mul(share, field.sub(*to, *by))));
            turned.collect()
        });
        let carried = carried.collect();
        Some(Carry {
            values,
            vectors,
            behind,
            carried,
            outgoing,
            gap_rates,
        })
    }

    /// The form as a sum of products, after and before the surface.
    fn products<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
    ) -> Option<Sides<Number<P>>> {
        let field = point.field();
        let Carry {
            values,
            vectors,
            behind,
            carried,
            ..
        } = self.carry(model, point)?;
        let mut after = Products::new();
        for (coefficient, differentials) in &self.behind.terms {
            let row = |slopes: &Vec<ExprId>| {
                let along = |vector: &Vec<Number<P>>| {
                    inner(field, slopes.iter().map(|id| behind[id.index()]), vector)
                };
                carried.iter().map(along).collect()
            };
            let rows = differentials.iter().map(row).collect();
            after.push(behind[coefficient.index()], rows);
        }
        let mut before = Products::new();
        for term in &self.form.terms {
            let row = |id: &ExprId| {
                let along = |vector: &Vec<_>| self.expansions.along(field, &values, *id, vector);
                vectors.iter().map(along).collect()
            };
            let coefficient = self.expansions.value(&values, term.coefficient);
            before.push(coefficient, term.differentials.iter().map(row).collect());
        }
        Some([after, before])
    }

    /// `eta^a(v+)` of the constraints behind the surface, with random weights. It is 0 for vectors along their leaves.
    fn crossings<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        seed: u64,
    ) -> Option<Vec<Number<P>>> {
        let field = point.field();
        let carry = self.carry(model, point)?;
        let n = carry.carried.first()?.len() / 2;
        let mut found = Vec::new();
        for vector in &carry.carried {
            for row in &self.behind.equations[0] {
                let row = row.iter().map(|id| carry.behind[id.index()]);
                let weight = field.integer(weight(seed, found.len() as u64));
                found.push(field.mul(weight, inner(field, row, &vector[..n])));
            }
        }
        Some(found)
    }

    /// The same question for one of the possible motions behind the surface.
    pub(super) fn with_contact(mut self, model: &mut Model, mut contact: Contact) -> Self {
        if let Some(solution) = self.wall.solution() {
            contact.restrict(&mut model.pool, solution);
        }
        self.contact = Some(contact);
        self
    }

    /// True if the motion that this question assumes is certain to follow the impact.
    fn is_followed(&self, signs: impl FnOnce() -> Option<[Option<Ordering>; 2]>) -> bool {
        match &self.contact {
            None => true,
            Some(contact) => signs().is_some_and(|signs| contact.is_it(signs)),
        }
    }

    /// The question whether vectors leave the leaves of the constraints behind the surface. `seed` gives the weights.
    pub(super) fn across_leaves(self, seed: u64) -> Self {
        Self {
            leaves: Some(seed),
            ..self
        }
    }

    fn sizes(&self) -> (usize, usize) {
        (self.tangents.dimension(), self.form.degree)
    }

    /// Components of the change of the form at a real state, and the size of their terms.
    pub(super) fn components(
        &self,
        model: &Model,
        point: &mut RealPoint,
    ) -> Option<(Vec<f64>, f64)> {
        let field = point.field();
        let sides = self.products(model, point)?;
        let (dimension, degree) = self.sizes();
        let each = super::expansion::choices(dimension, degree);
        let change = |places: &Vec<usize>| {
            let [after, before] = sides.each_ref().map(|side| side.component(field, places));
            Some(after? - before?)
        };
        let changes: Option<Vec<f64>> = each.iter().map(change).collect();
        Some((changes?, sides[0].size() + sides[1].size()))
    }

    /// Rate of the gap along a first-order motion behind the surface. The motion slides along the surface unless this
    /// rate is negative. `Some(None)` for motions that cannot slide.
    fn sliding<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
    ) -> Option<Option<Number<P>>> {
        if !may_slide(self.wall) {
            return Some(None);
        }
        let field = point.field();
        let carry = self.carry(model, point)?;
        let mut vector = carry.outgoing;
        vector.resize(2 * model.coordinates.len(), field.integer(0));
        vector.push(field.integer(1));
        let gap = self.wall.gap;
        Some(Some(self.expansions.along(
            field,
            &carry.values,
            gap,
            &vector,
        )))
    }
}

impl Behind {
    fn of(
        model: &mut Model,
        around: &Surroundings<'_>,
        stated: Stated<'_>,
        wall: &Wall,
        entered: Option<&Model>,
    ) -> Option<Self> {
        let mut there = entered.unwrap_or(model).clone();
        let derivation = match entered {
            Some(_) => &derive(&mut there),
            None => around.derivation,
        };
        let dynamics = Dynamics::of(&mut there, derivation);
        let mut form = match stated.is_symplectic {
            true => {
                let (form, _) = symplectic_form(&mut there);
                explicit_form(&mut there, &form)
            }
            false => written_out(stated.form, |id| named_in(model, &mut there, id))?,
        };
        if let Some(rates) = there.field.clone() {
            form = with_rates(&mut there, form, &rates);
        }
        let mut symbols: Vec<SymbolId> = there
            .coordinates
            .iter()
            .map(|coordinate| coordinate.q)
            .collect();
        symbols.extend(there.coordinates.iter().map(|coordinate| coordinate.qdot));
        let qdot = match wall.passage.as_ref().map(|passage| &passage.velocities) {
            Some(Velocities::Declared(values, _)) => values.clone(),
            _ => velocities_of(model),
        };
        let after = (positions_behind(model, wall), qdot);
        let mut here = |expressions: &[ExprId], there: &Model| {
            imported(model, there, (&after.0, &after.1), expressions)
        };
        let mut terms = Vec::new();
        for term in &form.terms {
            let mut slopes = Vec::new();
            for id in &term.differentials {
                let row: Vec<ExprId> = (symbols.iter())
                    .map(|by| there.pool.diff(*id, *by))
                    .collect();
                slopes.push(here(&row, &there)?);
            }
            terms.push((here(&[term.coefficient], &there)?[0], slopes));
        }
        let rates = match there.field.clone() {
            Some(rates) => Some(here(&rates, &there)?),
            None => None,
        };
        let mut rows = |rows: &[Vec<ExprId>]| -> Option<Vec<Vec<ExprId>>> {
            rows.iter().map(|row| here(row, &there)).collect()
        };
        let equations = match &rates {
            Some(_) => [Vec::new(), Vec::new()],
            None => {
                let [forms, motion] = dynamics.equations();
                [rows(forms)?, rows(motion)?]
            }
        };
        Some(Self {
            rates,
            equations,
            terms,
        })
    }

    fn roots(&self) -> Vec<ExprId> {
        let rows = self.equations.iter().flatten().flatten();
        let slopes = self.terms.iter().flat_map(|(_, slopes)| slopes).flatten();
        let coefficients = self.terms.iter().map(|(coefficient, _)| coefficient);
        let all = rows.chain(slopes).chain(coefficients);
        all.chain(self.rates.iter().flatten()).copied().collect()
    }

    /// Rates of positions and velocities behind the surface.
    fn motion<P: ExpansionPoint>(
        &self,
        field: P::Field,
        velocities: &[Number<P>],
        values: &[Number<P>],
    ) -> Option<Vec<Number<P>>> {
        if let Some(rates) = &self.rates {
            return Some(rates.iter().map(|id| values[id.index()]).collect());
        }
        let space = JetSpace::new(0, 0, 1)?;
        let jets = Jets::new(field, &space);
        let series = constants::<P>(&jets, values);
        let equations = [self.equations[0].as_slice(), self.equations[1].as_slice()];
        let found = accelerations(&jets, equations, &series)?;
        let mut motion = velocities.to_vec();
        motion.extend(found.iter().map(|entry| jets.value(entry)));
        Some(motion)
    }
}

/// Expressions of the positions behind a wall.
fn positions_behind(model: &mut Model, wall: &Wall) -> Vec<ExprId> {
    match &wall.passage {
        Some(passage) => passage.positions.clone(),
        None => positions(model),
    }
}

impl AtImpact for Carried<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let mut roots: Vec<ExprId> = self.expansions.roots().collect();
        roots.extend(self.dynamics.roots());
        roots.extend(self.behind.roots());
        roots.extend(self.contact.iter().flat_map(Contact::roots));
        roots
    }

    fn is_certain(&self, model: &Model, point: &mut BallPoint) -> bool {
        let goes_on = match self.sliding(model, point) {
            Some(rate) => rate.is_none_or(|rate| rate.sign() == Some(Ordering::Less)),
            None => false,
        };
        goes_on
            && self.is_followed(|| {
                let rates = self.carry(model, point)?.gap_rates?;
                Some(rates.map(Ball::sign))
            })
    }

    fn terms<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        _: &[Number<P>],
    ) -> Option<Vec<Number<P>>> {
        let field = point.field();
        if let Some(seed) = self.leaves {
            return self.crossings(model, point, seed);
        }
        let [after, before] = self.products(model, point)?;
        let after = after.total(field, &self.part, self.sizes())?;
        let before = before.total(field, &self.part, self.sizes())?;
        Some(vec![after, field.neg(before)])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint, _: &[f64]) -> Option<f64> {
        if self.leaves.is_some() {
            let carry = self.carry(model, point)?;
            let size = |vector: &Vec<f64>| vector.iter().map(|entry| entry.abs()).sum::<f64>();
            return Some(carry.carried.iter().map(size).sum::<f64>() / CHANCE);
        }
        let [after, before] = self.products(model, point)?;
        let is_followed = self.is_followed(|| {
            let rates = self.carry(model, point)?.gap_rates?;
            Some(rates.map(|rate| rate.partial_cmp(&0.0)))
        });
        let goes_on = self.sliding(model, point)?.is_none_or(|rate| rate < 0.0);
        if !is_followed || !goes_on {
            return None;
        }
        let size = after.size() + before.size();
        Some(match self.part {
            Part::One(_) => size,
            Part::All(_) => size / CHANCE,
        })
    }

    fn shown(&self, terms: &[f64], sum: f64) -> Vec<(String, f64)> {
        if self.leaves.is_some() {
            return vec![(self.shown.clone(), sum)];
        }
        let names = ["after", "before"].map(|when| format!("{} {when}", self.shown));
        with_difference(names, [terms[0], -terms[1]], sum)
    }
}
