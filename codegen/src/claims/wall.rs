//! The map of an impact on velocities, and points on its surface.
//!
//! ```text
//! qdot+ = qdot + eps pi_D grad h,   rho = dh(pi_D grad h)/dh(grad h),   G = dh(qdot) + d_t h
//! elastic, restitution e   eps = -(1 + e) (g(qdot, pi_D grad h) + d_t h)/dh(pi_D grad h)
//! newton e                 eps = -(1 + e) G/dh(pi_D grad h)
//! nonholonomic plastic     eps = -2 rho G/dh(pi_D grad h)
//! impact plastic           eps = -G/dh(pi_D grad h)
//! totally plastic          eps = -rho G/dh(pi_D grad h)
//! ```
//!
//! `pi_D` is the projection onto the velocities that the constraints allow, orthogonal in the metric; `G` is the gap
//! rate before the impact. Resets and transitions ([`super::passage`]) have maps of their own. Instantaneous
//! constraints are imposed before the law is applied ([`super::focusing`]).
//!
//! The Jacobian with respect to `mu_C` is the determinant of the map in a fibre of D* times the ratio of the fluxes
//! through the surface, `-G+/G-`, where `G-` and `G+` are the gap rates before and after the impact. The determinant is
//! `-G+/G-` too, except for `elastic` and `restitution e` with affine constraints, where it is e (1 for `elastic`).

use std::cmp::Ordering;

use dalembert_expr::{
    Arithmetic, BallPoint, ExpansionPoint, ExprId, JetSpace, Jets, RealPoint, Series, SymbolId,
};

use super::dynamics::{Dynamics, Number};
use super::impulse::Parts;
use super::locus::{self, Locus};
use super::passage::Passage;
use super::sample::{Sample, sample, uses, with_velocities};
use crate::mechanics::Derivation;
use crate::model::{Beside, Law, Model, Surface};

/// An impact surface with the expressions of its map.
#[derive(Debug)]
pub(super) struct Wall {
    /// Expressions of the map, with N coordinates, M constraints and K instantaneous constraints: metric (`N N`), forms
    /// of all constraints (`(M + K) N`), dh (N), affine terms of the instantaneous constraints (K), d_t h, coefficient.
    pub(super) roots: Vec<ExprId>,
    law: Law,
    /// The map of a reset or of a transition.
    pub(super) passage: Option<Passage>,
    is_affine: bool,
    pub(super) gap: ExprId,
    pub(super) gap_rate: ExprId,
    slope: Vec<ExprId>,
    /// `d_t h`
    rate: ExprId,
    coordinates: Vec<SymbolId>,
    velocities: Vec<SymbolId>,
    /// Numbers of constraints and of instantaneous constraints, M and K.
    constraints: [usize; 2],
    /// Margins of the conditions of this surface, then of the surfaces that must not count. A condition holds where its
    /// margin is positive.
    margins: Vec<ExprId>,
    /// Number of margins of the wall, and the number for each other surface that must not count.
    lists: (usize, Vec<usize>),
    /// Positions on the surface.
    locus: Locus,
    /// A coordinate that follows from the others on the surface, and its solution.
    solution: Option<(SymbolId, ExprId)>,
}

/// Number of margins of the surface itself, and the number for each other surface that must not count.
fn lists(surface: &Surface) -> (usize, Vec<usize>) {
    let others = match &surface.beside {
        Beside::Otherwise(others) => others.iter().map(Vec::len).collect(),
        // The last of several transitions counts by its own conditions.
        Beside::Last(_) | Beside::Independent => Vec::new(),
    };
    (surface.conditions.len(), others)
}

impl Wall {
    /// The surface of index `surface`. `others` are the modes of the model, in order; a transition leads into one of
    /// them.
    pub(super) fn of(
        model: &mut Model,
        derivation: &Derivation,
        surface: usize,
        others: &[&Model],
    ) -> Self {
        let derived = &derivation.surfaces[surface];
        let law = model.surfaces[surface].law;
        let coefficient = match law {
            Law::Restitution(e) | Law::Newton(e) => e,
            Law::Elastic => model.pool.one(),
            _ => model.pool.zero(),
        };
        let mut roots: Vec<ExprId> = model.lagrangian.metric.iter().flatten().copied().collect();
        roots.extend(
            derivation
                .constraints
                .iter()
                .flat_map(|constraint| &constraint.form),
        );
        let added = &derived.instantaneous;
        roots.extend(added.iter().flat_map(|constraint| &constraint.form));
        roots.extend(&derived.form);
        roots.extend(added.iter().map(|constraint| constraint.affine));
        roots.extend([derived.rate, coefficient]);
        let coordinates: Vec<_> = model
            .coordinates
            .iter()
            .map(|coordinate| coordinate.q)
            .collect();
        Self {
            passage: Passage::of(model, derivation, surface, others),
            roots,
            law,
            is_affine: derivation
                .constraints
                .iter()
                .any(|constraint| !model.pool.is_syntactic_zero(constraint.affine)),
            gap: derived.gap,
            gap_rate: derived.gap_rate,
            slope: derived.form.clone(),
            rate: derived.rate,
            margins: derived.margins.clone(),
            lists: lists(&model.surfaces[surface]),
            locus: Locus::on_surface(model, derived.gap),
            solution: locus::solution(model, derived.gap),
            coordinates,
            velocities: model
                .coordinates
                .iter()
                .map(|coordinate| coordinate.qdot)
                .collect(),
            constraints: [derivation.constraints.len(), added.len()],
        }
    }

    /// The same surface with the law `elastic`.
    pub(super) fn reflecting(model: &mut Model, derivation: &Derivation, surface: usize) -> Self {
        let mut wall = Self::of(model, derivation, surface, &[]);
        wall.law = Law::Elastic;
        if let Some(coefficient) = wall.roots.last_mut() {
            *coefficient = model.pool.one();
        }
        wall
    }

    /// The velocities after an impact. The velocities before it are those of the point. `None` at a singular point.
    pub(super) fn after<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
    ) -> Option<Vec<Number<P>>> {
        if let Some(passage) = &self.passage {
            return passage.velocities_after(model, point);
        }
        self.at_point(model, point, |jets, series, velocity| {
            self.struck(jets, series, velocity)
        })
    }

    /// The gap rate before an impact, and the gap rate after the projection onto instantaneous constraints.
    pub(super) fn gap_rates<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
    ) -> Option<[Number<P>; 2]> {
        let found = self.at_point(model, point, |jets, series, velocity| {
            let parts = self.parts(series)?;
            let focused = parts.focused(jets, velocity)?;
            let rates = [velocity, &focused].map(|velocity| parts.gap_rate(jets, velocity));
            Some(rates.to_vec())
        })?;
        found.try_into().ok()
    }

    /// Values of the series that `made` builds from the series of expressions and velocities at a point.
    fn at_point<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        made: impl FnOnce(
            &Jets<'_, P::Field>,
            &dyn Fn(ExprId) -> Series<P::Field>,
            &[Series<P::Field>],
        ) -> Option<Vec<Series<P::Field>>>,
    ) -> Option<Vec<Number<P>>> {
        let values = point.values(&model.pool, &model.pool.reachable(&self.roots))?;
        let space = JetSpace::new(0, 0, 1)?;
        let jets = Jets::new(point.field(), &space);
        let velocity: Vec<_> = self
            .velocities
            .iter()
            .map(|velocity| jets.constant(point.symbol(&model.pool, *velocity)))
            .collect();
        let found = made(&jets, &|id| jets.constant(values[id.index()]), &velocity)?;
        Some(found.iter().map(|entry| jets.value(entry)).collect())
    }

    /// Series of the roots.
    fn parts<A: Arithmetic>(&self, series: &dyn Fn(ExprId) -> Series<A>) -> Option<Parts<A>> {
        let (n, [m, k]) = (self.coordinates.len(), self.constraints);
        let mut entries = self.roots.iter().map(|root| series(*root));
        let mut rows = |count: usize| -> Vec<Vec<_>> {
            (0..count)
                .map(|_| entries.by_ref().take(n).collect())
                .collect()
        };
        let (metric, forms, slope) = (rows(n), rows(m + k), rows(1).pop()?);
        let affine = entries.by_ref().take(k).collect();
        Some(Parts {
            metric,
            forms,
            slope,
            affine,
            rate: entries.next()?,
            coefficient: entries.next()?,
        })
    }

    /// The velocities after an impulse as series, given the series of expressions and of the velocities before it.
    pub(super) fn struck<A: Arithmetic>(
        &self,
        jets: &Jets<'_, A>,
        series: &dyn Fn(ExprId) -> Series<A>,
        velocity: &[Series<A>],
    ) -> Option<Vec<Series<A>>> {
        self.parts(series)?.struck(jets, self.law, velocity)
    }

    /// Factor by which the map and the flux through the surface multiply `mu_C`, given the velocities after the impact.
    pub(super) fn jacobian<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        after: &[Number<P>],
    ) -> Option<Number<P>> {
        if let Some(passage) = &self.passage {
            return passage.jacobian(model, point);
        }
        let field = point.field();
        let values = point.values(&model.pool, &model.pool.reachable(&self.roots))?;
        let value = |id: ExprId| values[id.index()];
        let (coefficient, moving) = (value(*self.roots.last()?), value(self.rate));
        let slope: Vec<_> = self.slope.iter().map(|entry| value(*entry)).collect();
        let mut gap_rate = |velocity: &dyn Fn(usize, &mut P) -> Number<P>| {
            let along = |sum, (i, slope): (usize, &Number<P>)| {
                field.add(sum, field.mul(*slope, velocity(i, point)))
            };
            slope.iter().enumerate().fold(moving, along)
        };
        let outgoing = gap_rate(&|i, _| after[i]);
        let incoming = gap_rate(&|i, point| point.symbol(&model.pool, self.velocities[i]));
        let ratio = field.mul(outgoing, field.inv(incoming)?);
        let determinant = match self.law {
            Law::Elastic | Law::Restitution(_) if self.is_affine => coefficient,
            _ => field.neg(ratio),
        };
        Some(field.mul(determinant, field.neg(ratio)))
    }

    /// A real state that approaches the surface where it counts, and its point. The sample holds the symbols of
    /// `roots`.
    pub(super) fn incoming(
        &self,
        model: &Model,
        dynamics: &Dynamics,
        attempt: usize,
        mut roots: Vec<ExprId>,
    ) -> Option<(Sample, RealPoint)> {
        roots.extend(&self.margins);
        roots.extend(self.locus.roots());
        let mut sample = sample(model, attempt, uses(&model.pool, &roots));
        self.locus.settle_sample(model, &mut sample)?;
        let (sample, point) = with_velocities(model, dynamics, sample, attempt)?;
        let rate = model.pool.eval(&[self.gap_rate], &|s| point.value(s))[0];
        let margins = model.pool.eval(&self.margins, &|s| point.value(s));
        let side = |value: &f64| value.partial_cmp(&0.0);
        let margins: Vec<_> = margins.iter().map(side).collect();
        (rate < 0.0 && self.counts(&margins)).then_some((sample, point))
    }

    /// True if the surface counts where its margins compare with 0 in this way; `None` if the comparison is unknown.
    fn counts(&self, margins: &[Option<Ordering>]) -> bool {
        let (listed, mut rest) = margins.split_at(self.lists.0);
        listed.iter().all(|side| *side == Some(Ordering::Greater))
            && self.lists.1.iter().all(|&length| {
                let (other, behind) = rest.split_at(length);
                rest = behind;
                other.contains(&Some(Ordering::Less))
            })
    }

    /// A coordinate that follows from the others on the surface, and its solution.
    pub(super) fn solution(&self) -> Option<(SymbolId, ExprId)> {
        self.solution
    }

    /// Positions on the surface.
    pub(super) fn locus(&self) -> &Locus {
        &self.locus
    }

    /// True if all states in the ranges of the point approach the surface, and it counts at all of them.
    pub(super) fn is_met(&self, model: &Model, point: &mut BallPoint) -> bool {
        let mut roots = vec![self.gap_rate];
        roots.extend(&self.margins);
        let Some(values) = point.values(&model.pool, &model.pool.reachable(&roots)) else {
            return false;
        };
        let sign = |id: &ExprId| values[id.index()].sign();
        let margins: Vec<_> = self.margins.iter().map(sign).collect();
        sign(&self.gap_rate) == Some(Ordering::Less) && self.counts(&margins)
    }
}
