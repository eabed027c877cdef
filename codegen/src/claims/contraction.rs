//! Contribution of forces to the divergence of the motion on D,
//!
//! ```text
//! P(qdot) = K^{ij} dF_i/dqdot^j,   K = g^{-1} - W^a m_ab W^b   (see frame.rs)
//! ```
//!
//! Along the motion, the derivative of a function of the configuration is linear in the velocities. A density that
//! depends on q alone can therefore balance `P` only if `P` is linear, too.

use dalembert_expr::{
    Arithmetic, Assumption, ExpansionPoint, ExprId, JetSpace, Jets, RealPoint, SymbolId,
};

use super::dynamics::{Dynamics, Number};
use super::evidence::{Evidence, Vanishing, evidence};
use super::frame::projected_cometric;
use super::problem::Problem;
use super::sample::{Sample, state_on_d};
use crate::model::Model;

/// `dF_i/dqdot^j` with its indices.
pub(super) type ForceSlope = ([usize; 2], ExprId);

/// `P` at a state; `None` where metric or constraints are singular, or a force has no derivative.
pub(super) fn contraction<P: ExpansionPoint>(
    model: &Model,
    problem: &Problem,
    point: &mut P,
) -> Option<Number<P>> {
    let field = point.field();
    let Some(friction) = &problem.friction else {
        return Some(field.integer(0));
    };
    let slopes: Vec<ExprId> = problem.force_slopes().collect();
    let values = point.values(&model.pool, &model.pool.reachable(&slopes))?;
    let space = JetSpace::new(0, 0, 1)?;
    let jets = Jets::new(field, &space);
    let cometric = projected_cometric(&model.pool, problem, &jets, point)?;
    let mut sum = field.integer(0);
    for ([i, j], slope) in &friction.entries {
        let part = field.mul(jets.value(&cometric[*i][*j]), values[slope.index()]);
        sum = field.add(sum, part);
    }
    Some(sum)
}

/// The dependence of `P` on the velocities of D.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Dependence {
    /// Linear in the velocities, plus a constant.
    Linear,
    /// Not linear. Holds a state, and the values of `P` there and one and two steps further, which are not equidistant.
    Curved(Sample, Vec<(String, f64)>),
    /// Neither is shown.
    Unknown,
}

/// Dependence of `P` on velocities, from its values at three equidistant states.
pub(super) fn dependence(
    model: &mut Model,
    problem: &Problem,
    dynamics: &Dynamics,
    seed: u64,
) -> Dependence {
    let steps = (0..problem.coordinates).map(|i| {
        let name = format!("step {}", i + 1);
        model.pool.symbol(&name, &name, Assumption::None)
    });
    let row = Row {
        steps: steps.collect(),
        problem,
        dynamics,
    };
    let Evidence {
        vanishes,
        witness,
        is_real,
        ..
    } = evidence(model, &row, seed);
    match witness {
        Some((sample, values)) => Dependence::Curved(sample, values),
        None if vanishes == Some(true) && is_real => Dependence::Linear,
        None => Dependence::Unknown,
    }
}

/// The second difference `P(v) - 2 P(v + w) + P(v + 2 w)`.
struct Row<'r> {
    /// Changes `w` of the independent velocities, with arbitrary values.
    steps: Vec<SymbolId>,
    problem: &'r Problem,
    dynamics: &'r Dynamics,
}

impl Vanishing for Row<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let mut roots = self.dynamics.roots();
        roots.extend(self.problem.metric.iter().flatten());
        roots.extend(self.problem.forms.iter().flatten());
        roots.extend(self.problem.force_slopes());
        roots
    }

    fn dynamics(&self) -> Option<&Dynamics> {
        Some(self.dynamics)
    }

    fn sample(&self, model: &Model, attempt: usize) -> Option<(Sample, RealPoint)> {
        let (sample, mut point) = state_on_d(model, self.dynamics, &self.roots(), attempt)?;
        for (k, step) in self.steps.iter().enumerate() {
            point.set(*step, real_step(k));
        }
        Some((sample, point))
    }

    fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let (pool, field) = (&model.pool, point.field());
        let velocities: Vec<SymbolId> = model
            .coordinates
            .iter()
            .map(|coordinate| coordinate.qdot)
            .collect();
        let first: Vec<_> = velocities
            .iter()
            .map(|velocity| point.symbol(pool, *velocity))
            .collect();
        let start = contraction(model, self.problem, point)?;
        for (velocity, (start, step)) in velocities.iter().zip(first.iter().zip(&self.steps)) {
            let step = point.symbol(pool, *step);
            point.set_symbol(*velocity, field.add(*start, step));
        }
        let second = self.dynamics.motion(pool, point, None)?.qdot;
        let middle = contraction(model, self.problem, point)?;
        for ((velocity, start), next) in velocities.iter().zip(&first).zip(&second) {
            let third = field.sub(field.add(*next, *next), *start);
            point.set_symbol(*velocity, third);
        }
        let end = contraction(model, self.problem, point)?;
        for (velocity, start) in velocities.iter().zip(&first) {
            point.set_symbol(*velocity, *start);
        }
        let twice = field.mul(field.integer(-2), middle);
        Some(vec![start, twice, end])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let terms = self.terms(model, point)?;
        Some(terms.iter().map(|term| term.abs()).sum())
    }

    fn shown(&self, _: &Model, terms: &[f64], _: f64) -> Vec<(String, f64)> {
        let names = ["rate", "rate one step on", "rate two steps on"].map(str::to_owned);
        let values = [terms[0], terms[1] / -2.0, terms[2]];
        names.into_iter().zip(values).collect()
    }
}

/// Change of the velocity of a coordinate between two real states.
pub(super) fn real_step(coordinate: usize) -> f64 {
    let size = coordinate as f64 + 1.0;
    if coordinate.is_multiple_of(2) {
        size
    } else {
        -size
    }
}
