//! `density = e`: `e mu_C` is invariant. With `qdot = X_0 + u^i X_i`, the rate of `ln e` along the motion must be
//! `c_0 + u^i c_i` (see [`super::frame`]), which is minus the divergence of the motion with respect to `mu_C`.
//!
//! A factor `abs(l)^s` counts as `l^s` where `l` is not 0: its logarithmic derivative is the same.

use dalembert_expr::{
    Arithmetic, ExpansionPoint, ExprId, JetSpace, Jets, Node, Pool, RealPoint, SymbolId,
};

use super::conserved::{Quantity, jump, magnitude, rate_scale};
use super::contraction::contraction;
use super::dynamics::{Dynamics, Motion, Number};
use super::evidence::{Vanishing, Wording, evidence};
use super::finding::Verdict;
use super::frame::frame;
use super::problem::Problem;
use crate::model::Model;

/// Relative size of the sum of rate and divergence below which a message also shows the sum.
const ALIKE: f64 = 1e-9;

/// The verdict on `density = value`; `written` is the value as written.
pub(super) fn check_density(
    model: &mut Model,
    problem: &Problem,
    dynamics: &Dynamics,
    stated: (ExprId, &str),
    seed: u64,
) -> Verdict {
    let verdict = check_balance(model, problem, dynamics, stated, seed);
    continuous(model, dynamics, stated.0, verdict, seed)
}

/// The bases of the factors of a density. Where one of them is 0, nothing is claimed.
pub(super) fn factors(pool: &Pool, value: ExprId) -> Vec<ExprId> {
    match pool.node(value) {
        Node::Product(factors) => factors.iter().map(|(base, _)| *base).collect(),
        _ => vec![value],
    }
}

/// The verdict on the rate of a density, left open if its factors may jump.
fn continuous(
    model: &mut Model,
    dynamics: &Dynamics,
    value: ExprId,
    verdict: Verdict,
    seed: u64,
) -> Verdict {
    if !matches!(verdict, Verdict::Proved(_)) {
        return verdict;
    }
    let place = factors(&model.pool, value)
        .into_iter()
        .find_map(|factor| jump(model, dynamics, factor, seed));
    match place {
        Some(place) => Verdict::Undecided(format!(
            "the balance holds wherever it can be written down, but the density may jump {place}"
        )),
        None => verdict,
    }
}

/// The verdict on the balance of rate and divergence, at states where the density has a rate.
pub(super) fn check_balance(
    model: &mut Model,
    problem: &Problem,
    dynamics: &Dynamics,
    (value, written): (ExprId, &str),
    seed: u64,
) -> Verdict {
    let balance = Balance {
        quantity: Quantity::of(model, value),
        without_forces: problem.without_forces(),
        problem,
        dynamics,
        written,
    };
    let wording = Wording {
        vanishes: format!("{written} times mu_C is invariant on D* where it is not 0"),
        differs: format!(
            "{written} times mu_C is not invariant: the rate of its logarithm and the divergence do not add up to 0"
        ),
        help: [
            "the density is relative to mu_C = det g/|det A_dep| dq dv; `density: exact;` looks for one".to_owned(),
            String::new(),
        ],
    };
    evidence(model, &balance, seed).verdict(true, wording, seed)
}

/// The verdict on `density = value` of a first-order system, whose divergence is `d_i f^i`.
pub(super) fn check_rates(
    model: &mut Model,
    dynamics: &Dynamics,
    rates: &[ExprId],
    (value, written): (ExprId, &str),
    seed: u64,
) -> Verdict {
    let symbols: Vec<SymbolId> = model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.q)
        .collect();
    let slopes = rates
        .iter()
        .zip(symbols)
        .map(|(rate, by)| model.pool.diff(*rate, by));
    let slopes: Vec<ExprId> = slopes.collect();
    let balance = RateBalance {
        divergence: model.pool.sum(&slopes),
        quantity: Quantity::of(model, value),
        dynamics,
        written,
    };
    let wording = Wording {
        vanishes: format!("{written} times dq is invariant where it is not 0"),
        differs: format!(
            "{written} times dq is not invariant: the rate of its logarithm and the divergence do not add up to 0"
        ),
        help: [
            "the density is relative to the volume of the coordinates".to_owned(),
            String::new(),
        ],
    };
    let verdict = evidence(model, &balance, seed).verdict(true, wording, seed);
    continuous(model, dynamics, value, verdict, seed)
}

/// `d ln(e)/dt` along a motion.
fn rate_of_logarithm<P: ExpansionPoint>(
    quantity: &Quantity,
    model: &Model,
    motion: &Motion<Number<P>>,
    point: &mut P,
) -> Option<Number<P>> {
    let field = point.field();
    let (value, terms) = quantity.terms(model, motion, point)?;
    let add = |sum, term: &Number<P>| field.add(sum, *term);
    let rate = terms.iter().fold(field.integer(0), add);
    Some(field.mul(rate, field.inv(value)?))
}

/// `d ln(e)/dt + div` of a first-order system.
struct RateBalance<'b> {
    quantity: Quantity,
    divergence: ExprId,
    dynamics: &'b Dynamics,
    written: &'b str,
}

impl Vanishing for RateBalance<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let mut roots = self.dynamics.roots();
        roots.extend(self.quantity.roots());
        roots.push(self.divergence);
        roots
    }

    fn dynamics(&self) -> Option<&Dynamics> {
        Some(self.dynamics)
    }

    fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let motion = self.dynamics.motion(&model.pool, point, None)?;
        let rate = rate_of_logarithm(&self.quantity, model, &motion, point)?;
        let values = point.values(&model.pool, &model.pool.reachable(&[self.divergence]))?;
        let divergence = values[self.divergence.index()];
        Some(vec![rate, divergence])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let motion = self.dynamics.motion(&model.pool, point, None)?;
        let (value, _) = self.quantity.terms(model, &motion, point)?;
        let rate = rate_scale(&self.quantity, model, &motion, point) / value.abs();
        Some(rate + magnitude(model, point, self.divergence))
    }

    fn shown(&self, _: &Model, terms: &[f64], sum: f64) -> Vec<(String, f64)> {
        shown(self.written, terms, sum)
    }
}

/// `d ln(e)/dt + div`
struct Balance<'b> {
    quantity: Quantity,
    problem: &'b Problem,
    without_forces: Problem,
    dynamics: &'b Dynamics,
    written: &'b str,
}

impl Vanishing for Balance<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let mut roots = self.dynamics.roots();
        roots.extend(self.quantity.roots());
        roots.extend(self.without_forces.roots());
        roots.extend(self.problem.force_slopes());
        roots
    }

    fn dynamics(&self) -> Option<&Dynamics> {
        Some(self.dynamics)
    }

    /// The rate of `ln e`, then the divergence.
    fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let field = point.field();
        let motion = self.dynamics.motion(&model.pool, point, None)?;
        let rate = rate_of_logarithm(&self.quantity, model, &motion, point)?;
        let mut balance = vec![rate];
        let space = JetSpace::new(self.problem.variables.len(), 1, usize::MAX)?;
        let jets = Jets::new(field, &space);
        let frame = frame(&model.pool, &self.without_forces, &jets, point, None)?;
        // Independent velocities are the coefficients of the frame's fields; the drift, if any, comes first.
        let independent: Vec<_> = (0..self.problem.coordinates)
            .filter(|i| !frame.dependent.contains(i))
            .map(|i| motion.qdot[i])
            .collect();
        let drifts = frame.demands.len() - independent.len();
        let mut divergence = contraction(model, self.problem, point)?;
        for (i, demand) in frame.demands.iter().enumerate() {
            let weight = match i.checked_sub(drifts) {
                Some(i) => independent[i],
                None => field.integer(1),
            };
            let demand = demand.last().map_or(field.integer(0), |c| jets.value(c));
            divergence = field.sub(divergence, field.mul(weight, demand));
        }
        balance.push(divergence);
        Some(balance)
    }

    fn scale(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let motion = self.dynamics.motion(&model.pool, point, None)?;
        let (value, _) = self.quantity.terms(model, &motion, point)?;
        let rate = rate_scale(&self.quantity, model, &motion, point) / value.abs();
        // The coefficients of the velocities in the divergence may have cancelled: they count as numbers of size 1.
        let velocity = motion
            .qdot
            .iter()
            .map(|component| component.abs())
            .sum::<f64>();
        Some(rate + velocity)
    }

    fn shown(&self, _: &Model, terms: &[f64], sum: f64) -> Vec<(String, f64)> {
        shown(self.written, terms, sum)
    }
}

/// Names and values of the rate of a density and of the divergence.
fn shown(written: &str, terms: &[f64], sum: f64) -> Vec<(String, f64)> {
    let names = [format!("d/dt(ln({written}))"), "divergence".to_owned()];
    let mut shown: Vec<_> = names.into_iter().zip(terms.iter().copied()).collect();
    if sum.abs() < ALIKE * terms[0].abs() {
        shown.push(("their sum".to_owned(), sum));
    }
    shown
}
