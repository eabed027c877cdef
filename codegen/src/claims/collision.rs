//! Questions about states before an impact, answered on every component of the surface.

use dalembert_expr::{BallPoint, ExpansionPoint, ExprId, RangePoint, RealPoint};

use super::conserved::magnitude;
use super::dynamics::{Dynamics, Number};
use super::evidence::{Evidence, Vanishing, evidence};
use super::locus::Locus;
use super::passage::Passage;
use super::sample::Sample;
use super::wall::Wall;
use crate::model::Model;

/// Relative difference below which two numbers look alike in a message.
const ALIKE: f64 = 1e-9;

/// Name of a difference in messages.
const DIFFERENCE: &str = "difference";

/// A sum of terms that may vanish at all states before an impact; see [`Vanishing`].
pub(super) trait AtImpact {
    /// Expressions evaluated in addition to the impact map.
    fn roots(&self) -> Vec<ExprId>;

    /// The terms at a state, given the velocities after the impact.
    fn terms<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        after: &[Number<P>],
    ) -> Option<Vec<Number<P>>>;

    /// True if a real state with these terms belongs to the question.
    fn wants(&self, terms: &[f64]) -> bool {
        let _ = terms;
        true
    }

    /// True if every state in the given ranges belongs to the question.
    fn is_certain(&self, model: &Model, point: &mut BallPoint) -> bool {
        let _ = (model, point);
        true
    }

    /// Size of the quantities from which the terms are computed.
    fn scale(&self, model: &Model, point: &mut RealPoint, after: &[f64]) -> Option<f64>;

    /// Names and values for a message, given the terms and their sum.
    fn shown(&self, terms: &[f64], sum: f64) -> Vec<(String, f64)>;
}

/// Evidence on a sum at the states before an impact at a wall.
pub(super) fn evidence_at_impact(
    model: &Model,
    wall: &Wall,
    dynamics: &Dynamics,
    question: &impl AtImpact,
    seed: u64,
) -> Evidence {
    let collision = Collision {
        wall,
        dynamics,
        question,
    };
    evidence(model, &collision, seed)
}

/// Two values with their names, and their difference where they look alike.
pub(super) fn with_difference(
    names: [String; 2],
    values: [f64; 2],
    difference: f64,
) -> Vec<(String, f64)> {
    let mut shown: Vec<(String, f64)> = names.into_iter().zip(values).collect();
    if difference.abs() < ALIKE * values[0].abs() {
        shown.push((DIFFERENCE.to_owned(), difference));
    }
    shown
}

/// Value of an expression at a point with other velocities. The point keeps these velocities.
pub(super) fn value_with<P: ExpansionPoint>(
    model: &Model,
    point: &mut P,
    velocities: &[Number<P>],
    value: ExprId,
) -> Option<Number<P>> {
    for (coordinate, velocity) in model.coordinates.iter().zip(velocities) {
        point.set_symbol(coordinate.qdot, *velocity);
    }
    let values = point.values(&model.pool, &model.pool.reachable(&[value]))?;
    Some(values[value.index()])
}

/// Values of two expressions, the first after and the second before an impact. The point keeps the velocities before
/// it.
pub(super) fn after_and_before<P: ExpansionPoint>(
    model: &Model,
    point: &mut P,
    after: &[Number<P>],
    (later, earlier): (ExprId, ExprId),
) -> Option<[Number<P>; 2]> {
    let symbols = model.coordinates.iter().map(|coordinate| coordinate.qdot);
    let before: Vec<_> = symbols
        .map(|symbol| point.symbol(&model.pool, symbol))
        .collect();
    let new = value_with(model, point, after, later)?;
    let old = value_with(model, point, &before, earlier)?;
    Some([new, old])
}

/// A question at the surface.
struct Collision<'c, Q> {
    wall: &'c Wall,
    dynamics: &'c Dynamics,
    question: &'c Q,
}

impl<Q: AtImpact> Vanishing for Collision<'_, Q> {
    fn roots(&self) -> Vec<ExprId> {
        let mut roots = self.dynamics.roots();
        roots.extend(&self.wall.roots);
        roots.extend(self.wall.passage.iter().flat_map(Passage::velocity_roots));
        roots.extend([self.wall.gap, self.wall.gap_rate]);
        roots.extend(self.question.roots());
        roots
    }

    fn dynamics(&self) -> Option<&Dynamics> {
        Some(self.dynamics)
    }

    fn positions(&self) -> Option<&Locus> {
        Some(self.wall.locus())
    }

    fn sample(&self, model: &Model, attempt: usize) -> Option<(Sample, RealPoint)> {
        (self.wall).incoming(model, self.dynamics, attempt, self.roots())
    }

    fn wants(&self, terms: &[f64]) -> bool {
        self.question.wants(terms)
    }

    fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let after = self.wall.after(model, point)?;
        self.question.terms(model, point, &after)
    }

    fn scale(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let after = self.wall.after(model, point)?;
        self.question.scale(model, point, &after)
    }

    fn enclosed(&self, model: &Model, point: &RealPoint) -> Option<BallPoint> {
        let mut point = BallPoint::of(point);
        self.wall.locus().enclose(model, &mut point)?;
        self.dynamics.motion(&model.pool, &mut point, None)?;
        let is_met = self.wall.is_met(model, &mut point);
        (is_met && self.question.is_certain(model, &mut point.clone())).then_some(point)
    }

    fn balance(&self, _: &Model, terms: &[f64]) -> Vec<(String, f64)> {
        // The difference of equal values is only rounding error.
        let mut shown = self.question.shown(terms, terms.iter().sum());
        shown.retain(|(name, _)| name != DIFFERENCE);
        shown
    }

    fn shown(&self, _: &Model, terms: &[f64], sum: f64) -> Vec<(String, f64)> {
        self.question.shown(terms, sum)
    }
}

/// An expression of the state before an impact that may vanish, with its name in messages.
pub(super) struct Vanished {
    pub(super) change: ExprId,
    pub(super) shown: String,
}

impl AtImpact for Vanished {
    fn roots(&self) -> Vec<ExprId> {
        vec![self.change]
    }

    fn terms<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        _: &[Number<P>],
    ) -> Option<Vec<Number<P>>> {
        let values = point.values(&model.pool, &model.pool.reachable(&[self.change]))?;
        Some(vec![values[self.change.index()]])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint, after: &[f64]) -> Option<f64> {
        let largest = after
            .iter()
            .fold(0.0, |size: f64, component| size.max(component.abs()));
        Some(magnitude(model, point, self.change) + largest)
    }

    fn shown(&self, terms: &[f64], _: f64) -> Vec<(String, f64)> {
        vec![(self.shown.clone(), terms[0])]
    }
}
