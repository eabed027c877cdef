//! The map of a reset or of a transition, and its effect on volumes.
//!
//! ```text
//! q+ = psi(t, q)   qdot+ = w(t, q, qdot)      mu_C = rho dq du, rho = det g/|det A_dep|, u the independent velocities
//! J = rho+/rho- det(du+/du) det[dpsi + (qdot+ - d_t psi - dpsi qdot) dh/G],   G = dh(qdot) + d_t h
//! ```
//!
//! J is the determinant of the augmented differential (W. Clark, thesis, chapter VII), which takes tangent vectors of
//! the surface to their images and the motion before to the motion after. A first-order system has the volume `dq` and
//! `det(du+/du) = 1`.
//!
//! A refraction `p+ = p + c dh` without constraints has `J = det(dp+/dp) G+/G- = 1`: the conservation of energy gives
//! `(1 + dc(dh)) G+ = G-`, and `det(dp+/dp) = 1 + dc(dh)`.

use dalembert_expr::{
    Arithmetic, ExpansionPoint, ExprId, JetSpace, Jets, Node, Pool, Series, SymbolId,
};

use super::dynamics::Number;
use super::examine::explicit;
use super::linear::dot;
use super::minors::{LARGEST, determinant};
use super::refraction::refracted;
use super::side::{AffineRow, Side, quantity_of_mode, velocities_of};
use super::sliding::{Return, returns};
use crate::mechanics::Derivation;
use crate::model::Model;

/// A map from the states on a surface to states of the same mode or of another one.
#[derive(Debug)]
pub(super) struct Passage {
    /// The mode that is left.
    pub(super) before: Side,
    /// The mode that is entered, at the positions after the passage. Its expressions contain the velocities after the
    /// passage if these are declared, otherwise the velocities of the point.
    pub(super) after: Side,
    /// Positions after the passage.
    pub(super) positions: Vec<ExprId>,
    /// Velocities after the passage.
    pub(super) velocities: Velocities,
    /// The derivatives of the positions with respect to the coordinates.
    slopes: Vec<Vec<ExprId>>,
    /// The derivatives of the positions with respect to time.
    rates: Vec<ExprId>,
    /// `dh` and `d_t h`.
    gap: (Vec<ExprId>, ExprId),
    qdot: Vec<SymbolId>,
    /// True if another mode is entered.
    leads_to_another_mode: bool,
    /// Whether the mode that is entered leads back to the surface.
    returns: Return,
    /// Reason for which the change of volumes is not known, if it is not known.
    pub(super) open: Option<Open>,
}

/// The velocities after a passage.
#[derive(Debug)]
pub(super) enum Velocities {
    /// Declared velocities, with their derivatives with respect to the velocities before.
    Declared(Vec<ExprId>, Vec<Vec<ExprId>>),
    /// The velocities of a first-order system, which follow from the positions.
    Rates,
    /// The nearest velocities that satisfy the constraints of the mode.
    Nearest,
    /// The velocities after a refraction, or after a reflection where there is no refraction.
    Refracted,
}

/// Reasons why the change of a volume is not known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Open {
    /// The states before and after the passage have different dimensions, and therefore no common volume.
    Dimensions(usize, usize),
    /// Positions after the passage depend on velocities.
    Positions,
    /// The dimensions agree, but the numbers of coordinates differ.
    Coordinates,
    /// A refraction within constraints.
    Refraction,
    /// There are more coordinates than an expanded determinant may have rows.
    Size,
}

impl Open {
    pub(super) fn text(self) -> String {
        match self {
            Self::Dimensions(before, after) => {
                format!("it leads from states of {before} dimensions to states of {after}")
            }
            Self::Positions => "positions after it depend on velocities".to_owned(),
            Self::Coordinates => "the modes have different numbers of coordinates".to_owned(),
            Self::Refraction => "refraction within constraints is not examined; declare the state behind it by `reset { .. }` if it is known".to_owned(),
            Self::Size => format!("more than {} coordinates are not examined", LARGEST - 1),
        }
    }
}

impl Passage {
    /// The reset of a surface, or its transition into one of the modes `others`. `None` if it has neither, or the mode
    /// is not in `others`.
    pub(super) fn of(
        model: &mut Model,
        derivation: &Derivation,
        surface: usize,
        others: &[&Model],
    ) -> Option<Self> {
        let before = Side::of(model);
        let crossed = &model.surfaces[surface];
        let reset = crossed.reset.clone();
        let (transition, q) = (crossed.transition.clone(), positions(model));
        let leads_to_another_mode = transition.is_some();
        let returns = returns(model, surface, others);
        let (after, positions, velocities) = match (reset, transition) {
            (Some(reset), _) => {
                let replacements = reset.replacements(&model.coordinates);
                let kept = |given: &[Option<ExprId>], all: Vec<ExprId>| -> Vec<ExprId> {
                    let pairs = given.iter().zip(all);
                    pairs
                        .map(|(given, before)| given.unwrap_or(before))
                        .collect()
                };
                let qdot = kept(&reset.qdot, velocities_of(model));
                let q = kept(&reset.q, q);
                let after = before.substituted(&mut model.pool, &replacements);
                (after, q, declared(model, &before, qdot))
            }
            (None, Some(transition)) => {
                let entered = *others.get(transition.enters)?;
                match transition.map {
                    Some(map) => {
                        let after = Side::of_mode(model, entered, (&map.q, &map.qdot))?;
                        let velocities = declared(model, &after, map.qdot);
                        (after, map.q, velocities)
                    }
                    None => {
                        let qdot = velocities_of(model);
                        let after = Side::of_mode(model, entered, (&q, &qdot))?;
                        let velocities = match (&after.rates, transition.keeps_lagrangian) {
                            (Some(_), _) => Velocities::Rates,
                            (None, true) => Velocities::Nearest,
                            (None, false) => Velocities::Refracted,
                        };
                        (after, q, velocities)
                    }
                }
            }
            (None, None) => return None,
        };
        let form = &derivation.surfaces[surface];
        let gap = (form.form.clone(), form.rate);
        Some(Self {
            leads_to_another_mode,
            returns,
            ..Self::between(model, (before, after), positions, velocities, gap)
        })
    }

    fn between(
        model: &mut Model,
        (before, after): (Side, Side),
        positions: Vec<ExprId>,
        velocities: Velocities,
        gap: (Vec<ExprId>, ExprId),
    ) -> Self {
        let symbols: Vec<SymbolId> = model
            .coordinates
            .iter()
            .map(|coordinate| coordinate.q)
            .collect();
        let positions = match before.rates.clone() {
            Some(rates) => {
                let motion = model
                    .coordinates
                    .iter()
                    .map(|coordinate| coordinate.qdot)
                    .zip(rates);
                let motion: Vec<_> = motion.collect();
                model.pool.substitute_all(&positions, &motion)
            }
            None => positions,
        };
        let qdot: Vec<SymbolId> = model
            .coordinates
            .iter()
            .map(|coordinate| coordinate.qdot)
            .collect();
        let time = model.time;
        let slopes = derivatives(&mut model.pool, &positions, &symbols);
        let rates = positions
            .iter()
            .map(|position| model.pool.diff(*position, time))
            .collect();
        let moves = |position: &ExprId| model.pool.depends_on_any(*position, &qdot);
        let is_refracted = matches!(velocities, Velocities::Refracted);
        let sides = [&before, &after];
        let [from, to] = sides.map(Side::dimension);
        let open = if from != to {
            Some(Open::Dimensions(from, to))
        } else if before.metric.len() != after.metric.len() {
            Some(Open::Coordinates)
        } else if before.rates.is_none() && positions.iter().any(moves) {
            Some(Open::Positions)
        } else if is_refracted && sides.iter().any(|side| !side.forms.is_empty()) {
            Some(Open::Refraction)
        } else if before.metric.len() >= LARGEST {
            Some(Open::Size)
        } else {
            None
        };
        Self {
            before,
            after,
            positions,
            velocities,
            slopes,
            rates,
            gap,
            qdot,
            leads_to_another_mode: false,
            returns: Return::Never,
            open,
        }
    }

    /// Sets the density of the mode that is left, and of the mode that is entered if both are the same mode.
    pub(super) fn weigh(&mut self, model: &mut Model, density: ExprId) {
        self.before.density = density;
        if self.leads_to_another_mode {
            return;
        }
        let q = model
            .coordinates
            .iter()
            .map(|coordinate| coordinate.q)
            .zip(&self.positions);
        let mut replacements: Vec<_> = q.map(|(symbol, after)| (symbol, *after)).collect();
        if let Velocities::Declared(values, _) = &self.velocities {
            replacements.extend(self.qdot.iter().copied().zip(values.iter().copied()));
        }
        self.after.density = model.pool.substitute(density, &replacements);
    }

    /// Replaces a coordinate by its value on the surface, in all expressions.
    pub(super) fn restrict(&mut self, pool: &mut Pool, solution: (SymbolId, ExprId)) {
        let solution = [solution];
        for side in [&mut self.before, &mut self.after] {
            *side = side.substituted(pool, &solution);
        }
        let mut on_surface = |row: &mut Vec<ExprId>| *row = pool.substitute_all(row, &solution);
        self.slopes.iter_mut().for_each(&mut on_surface);
        [&mut self.positions, &mut self.rates, &mut self.gap.0]
            .into_iter()
            .for_each(&mut on_surface);
        if let Velocities::Declared(values, slopes) = &mut self.velocities {
            on_surface(values);
            slopes.iter_mut().for_each(&mut on_surface);
        }
        self.gap.1 = pool.substitute(self.gap.1, &solution);
    }

    /// A quantity, which may name `energy` and momenta, in the mode that is entered, at the state after the passage. If
    /// the velocities after the passage are computed, the result is a function of the velocities of the point. `None` if
    /// the entered mode lacks the quantity.
    pub(super) fn quantity_after(
        &self,
        model: &mut Model,
        entered: Option<&Model>,
        quantity: ExprId,
    ) -> Option<ExprId> {
        let qdot = match &self.velocities {
            Velocities::Declared(values, _) => values.clone(),
            Velocities::Rates => self.after.rates.clone()?,
            Velocities::Nearest | Velocities::Refracted => velocities_of(model),
        };
        match entered {
            Some(entered) => quantity_of_mode(model, entered, quantity, (&self.positions, &qdot)),
            None => {
                let value = explicit(model, quantity);
                let q = model
                    .coordinates
                    .iter()
                    .map(|coordinate| coordinate.q)
                    .zip(&self.positions);
                let mut replacements: Vec<_> = q.map(|(symbol, after)| (symbol, *after)).collect();
                replacements.extend(self.qdot.iter().copied().zip(qdot));
                Some(model.pool.substitute(value, &replacements))
            }
        }
    }

    /// `dh` and `d_t h`.
    pub(super) fn gap_form(&self) -> (Vec<ExprId>, ExprId) {
        self.gap.clone()
    }

    /// True if the Lagrangian changes and the law of refraction gives the velocities.
    pub(super) fn is_refracted(&self) -> bool {
        matches!(self.velocities, Velocities::Refracted)
    }

    /// True if the velocities after the passage are computed at a point, not written out as expressions.
    pub(super) fn computes_velocities(&self) -> bool {
        matches!(self.velocities, Velocities::Nearest | Velocities::Refracted)
    }

    /// True if no position changes.
    pub(super) fn keeps_positions(&self, model: &Model) -> bool {
        let mut pairs = self.positions.iter().zip(&model.coordinates);
        pairs.all(|(after, coordinate)| matches!(model.pool.node(*after), Node::Symbol(symbol) if *symbol == coordinate.q))
    }

    /// Whether the mode that is entered leads back to the surface. Where the motion then comes back, it slides.
    pub(super) fn returns(&self) -> Return {
        self.returns
    }

    /// The expressions on which the velocities after the passage depend.
    pub(super) fn velocity_roots(&self) -> Vec<ExprId> {
        let of_metric = |side: &Side| side.metric.iter().flatten().copied().collect::<Vec<_>>();
        match &self.velocities {
            Velocities::Declared(values, _) => values.clone(),
            Velocities::Rates => self.after.rates.clone().unwrap_or_default(),
            Velocities::Nearest => {
                let forms = self.after.forms.iter().flatten().copied();
                of_metric(&self.after).into_iter().chain(forms).collect()
            }
            Velocities::Refracted => {
                let sides = [&self.before, &self.after];
                let forces = sides.iter().flat_map(|side| side.forces());
                let metrics = sides.iter().flat_map(|side| of_metric(side));
                let gap = self.gap.0.iter().copied().chain([self.gap.1]);
                let forms = sides
                    .iter()
                    .flat_map(|side| side.forms.iter().flatten().copied());
                metrics.chain(forces).chain(gap).chain(forms).collect()
            }
        }
    }

    /// The expressions on which the change of volumes depends.
    pub(super) fn roots(&self) -> Vec<ExprId> {
        let mut roots = self.velocity_roots();
        roots.extend(self.before.roots().chain(self.after.roots()));
        roots.extend(
            self.slopes
                .iter()
                .flatten()
                .chain(&self.rates)
                .chain(&self.positions),
        );
        roots.extend(self.gap.0.iter().copied().chain([self.gap.1]));
        if let Velocities::Declared(_, slopes) = &self.velocities {
            roots.extend(slopes.iter().flatten());
        }
        roots
    }

    /// The velocities after the passage; `None` at a singular point.
    pub(super) fn velocities_after<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
    ) -> Option<Vec<Number<P>>> {
        let order = model.pool.reachable(&self.velocity_roots());
        let values = point.values(&model.pool, &order)?;
        self.velocities_at(model, point, &values)
    }

    fn velocities_at<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &P,
        values: &[Number<P>],
    ) -> Option<Vec<Number<P>>> {
        let space = JetSpace::new(0, 0, 1)?;
        let jets = Jets::new(point.field(), &space);
        let before = |velocity: &SymbolId| jets.constant(point.symbol(&model.pool, *velocity));
        let velocity: Vec<_> = self.qdot.iter().map(before).collect();
        let series = |id: ExprId| jets.constant(values[id.index()]);
        let after = self.velocities_along(&jets, point, &series, &velocity)?;
        Some(after.iter().map(|series| jets.value(series)).collect())
    }

    /// The velocities after the passage as series, given the series of expressions and of the velocities before it.
    pub(super) fn velocities_along<P: ExpansionPoint>(
        &self,
        jets: &Jets<'_, P::Field>,
        point: &P,
        series: &dyn Fn(ExprId) -> Series<P::Field>,
        velocity: &[Series<P::Field>],
    ) -> Option<Vec<Series<P::Field>>> {
        let given = |ids: &[ExprId]| ids.iter().map(|id| series(*id)).collect();
        match &self.velocities {
            Velocities::Declared(velocities, _) => Some(given(velocities)),
            Velocities::Rates => Some(given(self.after.rates.as_ref()?)),
            Velocities::Nearest => self.focused(jets, series, velocity),
            Velocities::Refracted => {
                let sides = (&self.before, &self.after);
                let velocity = refracted(jets, point, series, sides, &self.gap, velocity)?;
                self.focused(jets, series, &velocity)
            }
        }
    }

    /// The nearest velocities that satisfy the constraints of the mode that is entered.
    fn focused<A: Arithmetic>(
        &self,
        jets: &Jets<'_, A>,
        series: &dyn Fn(ExprId) -> Series<A>,
        velocity: &[Series<A>],
    ) -> Option<Vec<Series<A>>> {
        if self.after.forms.is_empty() {
            return Some(velocity.to_vec());
        }
        let shifted = |(row, shift): AffineRow<A>| jets.add(&dot(jets, &row, velocity), &shift);
        let projection = self.after.projection(jets, series)?;
        Some(projection.into_iter().map(shifted).collect())
    }

    /// The factor of `mu_C`; `None` at a singular point, or if the change is not known. Where the state stays, the sign
    /// is the sign of the ratio of the gap rates. Otherwise it has no meaning.
    pub(super) fn jacobian<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
    ) -> Option<Number<P>> {
        if self.open.is_some() {
            return None;
        }
        let field = point.field();
        if matches!(self.velocities, Velocities::Refracted) {
            return Some(field.integer(1));
        }
        let values = point.values(&model.pool, &model.pool.reachable(&self.roots()))?;
        let [before, after] = [&self.before, &self.after].map(|side| side.chart(point, &values));
        let (before, after) = (before?, after?);
        let fibre = match &self.velocities {
            Velocities::Declared(_, slopes) => {
                let row = |i: &usize| slopes[*i].iter().map(|id| values[id.index()]).collect();
                after.independent.iter().map(row).collect()
            }
            Velocities::Nearest => {
                let space = JetSpace::new(0, 0, 1)?;
                let jets = Jets::new(field, &space);
                let rows = self
                    .after
                    .projection(&jets, &|id| jets.constant(values[id.index()]))?;
                let row = |i: &usize| rows[*i].0.iter().map(|series| jets.value(series)).collect();
                after.independent.iter().map(row).collect()
            }
            Velocities::Rates | Velocities::Refracted => Vec::new(),
        };
        let fibre = determinant(field, &product(field, &fibre, &before.basis))?;
        let outgoing = self.velocities_at(model, point, &values)?;
        let flux = self.flux(model, point, &values, &outgoing)?;
        let ratio = field.mul(after.density, field.inv(before.density)?);
        Some(field.mul(ratio, field.mul(fibre, flux)))
    }

    /// The rows of the determinant of [`Passage::flux`] as expressions, and the gap rate G before.
    pub(super) fn bordered(&self, model: &mut Model) -> (Vec<Vec<ExprId>>, ExprId) {
        let incoming = self.before.velocities(model);
        let outgoing = match &self.velocities {
            Velocities::Declared(velocities, _) => velocities.clone(),
            _ => self.after.rates.clone().unwrap_or_else(|| incoming.clone()),
        };
        let pool = &mut model.pool;
        let mut along = |row: &[ExprId], start: ExprId| {
            let mut terms = vec![start];
            for (slope, velocity) in row.iter().zip(&incoming) {
                terms.push(pool.mul(*slope, *velocity));
            }
            pool.sum(&terms)
        };
        let gap_rate = along(&self.gap.0, self.gap.1);
        let carried: Vec<ExprId> = (self.slopes.iter().zip(&self.rates))
            .map(|(slopes, rate)| along(slopes, *rate))
            .collect();
        let mut first = vec![gap_rate];
        first.extend(self.gap.0.iter().map(|slope| pool.neg(*slope)));
        let mut rows = vec![first];
        for ((velocity, carried), slopes) in outgoing.iter().zip(carried).zip(&self.slopes) {
            let mut row = vec![pool.sub(*velocity, carried)];
            row.extend(slopes);
            rows.push(row);
        }
        (rows, gap_rate)
    }

    /// `det[dpsi + (qdot+ - d_t psi - dpsi qdot) dh/G]`, as a determinant with one row and one column more.
    fn flux<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &P,
        values: &[Number<P>],
        outgoing: &[Number<P>],
    ) -> Option<Number<P>> {
        let field = point.field();
        let value = |id: &ExprId| values[id.index()];
        let incoming: Vec<_> = (self.qdot.iter())
            .map(|velocity| point.symbol(&model.pool, *velocity))
            .collect();
        let along = |row: &[ExprId], start: Number<P>| {
            let terms = row.iter().zip(&incoming);
            terms.fold(start, |sum, (a, b)| field.add(sum, field.mul(value(a), *b)))
        };
        let gap_rate = along(&self.gap.0, value(&self.gap.1));
        let mut first = vec![gap_rate];
        first.extend(self.gap.0.iter().map(|slope| field.neg(value(slope))));
        let mut rows = vec![first];
        for ((slopes, rate), velocity) in self.slopes.iter().zip(&self.rates).zip(outgoing) {
            let mut row = vec![field.sub(*velocity, along(slopes, value(rate)))];
            row.extend(slopes.iter().map(value));
            rows.push(row);
        }
        Some(field.mul(determinant(field, &rows)?, field.inv(gap_rate)?))
    }
}

/// The positions as expressions.
pub(super) fn positions(model: &mut Model) -> Vec<ExprId> {
    let symbols: Vec<SymbolId> = model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.q)
        .collect();
    symbols
        .into_iter()
        .map(|symbol| model.pool.variable(symbol))
        .collect()
}

/// Derivatives of expressions by symbols, one row per expression.
fn derivatives(pool: &mut Pool, values: &[ExprId], symbols: &[SymbolId]) -> Vec<Vec<ExprId>> {
    let mut row = |value: &ExprId| symbols.iter().map(|by| pool.diff(*value, *by)).collect();
    values.iter().map(&mut row).collect()
}

/// Declared velocities with their derivatives; [`Velocities::Rates`] for a first-order system.
fn declared(model: &mut Model, after: &Side, velocities: Vec<ExprId>) -> Velocities {
    if after.rates.is_some() {
        return Velocities::Rates;
    }
    let symbols: Vec<SymbolId> = model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.qdot)
        .collect();
    let slopes = derivatives(&mut model.pool, &velocities, &symbols);
    Velocities::Declared(velocities, slopes)
}

fn product<A: Arithmetic>(
    field: A,
    left: &[Vec<A::Scalar>],
    right: &[Vec<A::Scalar>],
) -> Vec<Vec<A::Scalar>> {
    let columns = right.first().map_or(0, Vec::len);
    let entry = |row: &Vec<A::Scalar>, j: usize| {
        let terms = row.iter().zip(right);
        terms.fold(field.integer(0), |sum, (a, b)| {
            field.add(sum, field.mul(*a, b[j]))
        })
    };
    left.iter()
        .map(|row| (0..columns).map(|j| entry(row, j)).collect())
        .collect()
}
