//! From local to global: is the density single-valued on the declared circles?

use std::f64::consts::TAU;

use dalembert_expr::{JetSpace, Jets, Modulus, Pool};

use super::closure::close;
use super::exactness::{Local, sample_points};
use super::frame::frame;
use super::obstruction::{combine, elements_at};
use super::potential::{Potential, Term};
use super::problem::Problem;
use super::regularity::LEAVES;
use super::sample::{Sample, sample, uses};
use crate::model::{Model, Topology};

/// Whether the density exists on all of Q.
#[derive(Debug, Clone, PartialEq)]
pub enum Global {
    /// It does.
    Exists,
    /// It is multiplied by `exp(period)` along a loop.
    Many {
        /// The coordinates that run around their circles, with the number of turns.
        turns: Vec<(usize, i64)>,
        /// How much `G` grows.
        period: f64,
        /// The values of parameters (and of the other coordinates) at which it was computed.
        sample: Sample,
    },
    /// Neither was shown.
    Undecided(&'static str),
}

/// Points on a circle for the trapezoidal rule, which converges geometrically for periodic functions.
const POINTS: usize = 48;
/// A period counts from here on: well above the rounding of a sum of [`POINTS`] values of order 1.
const PERIOD: f64 = 1e-8;
/// Points at which parameters are tried.
const ATTEMPTS: usize = 6;

/// What a density that was found in closed form with multiples of angles says.
pub(super) fn from_angles(
    model: &Model,
    problem: &Problem,
    local: &Local,
    found: &Potential,
) -> Global {
    let slopes: Vec<(usize, dalembert_expr::ExprId)> = found
        .terms
        .iter()
        .filter_map(|(coefficient, term)| {
            let Term::Plain(expression) = term else {
                return None;
            };
            let is_own = |i: &usize| {
                model.coordinates[*i].topology == Topology::Angle
                    && matches!(model.pool.node(*expression), dalembert_expr::Node::Symbol(s) if *s == model.coordinates[*i].q)
            };
            (0..problem.coordinates).find(is_own).map(|i| (i, *coefficient))
        })
        .collect();
    if slopes.is_empty() {
        return Global::Exists;
    }
    let angles: Vec<usize> = slopes.iter().map(|(i, _)| *i).collect();
    for turns in loops(&angles) {
        if local.rank < problem.components() && !is_in_hull(&model.pool, problem, &turns) {
            continue;
        }
        let coefficients: Vec<_> = slopes.iter().map(|(_, k)| *k).collect();
        for attempt in 0..ATTEMPTS {
            let sample = sample(model, attempt, uses(&model.pool, &coefficients));
            let values = model
                .pool
                .eval(&coefficients, &|s| sample.value(s).unwrap_or(0.0));
            let weigh = |(i, count): &(usize, i64)| {
                let position = angles.iter().position(|own| own == i);
                position.map_or(0.0, |position| values[position] * *count as f64)
            };
            let period = TAU * turns.iter().map(weigh).sum::<f64>();
            if period.is_finite() && period.abs() > PERIOD {
                return Global::Many {
                    turns,
                    period,
                    sample,
                };
            }
        }
    }
    Global::Undecided(
        "the density found is not single-valued, and another one, which differs by a function that D does not see, may be",
    )
}

/// One turn of one circle, then combinations of turns `-1, 0, 1`, the first one positive.
fn loops(angles: &[usize]) -> Vec<Vec<(usize, i64)>> {
    let mut all: Vec<Vec<(usize, i64)>> = vec![Vec::new()];
    for angle in angles.iter().take(6) {
        let mut longer = Vec::new();
        for turns in &all {
            for count in [0, 1, -1] {
                let mut turns = turns.clone();
                if count != 0 {
                    turns.push((*angle, count));
                }
                if turns.first().is_none_or(|(_, first)| *first > 0) {
                    longer.push(turns);
                }
            }
        }
        all = longer;
    }
    all.retain(|turns| !turns.is_empty());
    all.sort_by_key(Vec::len);
    all
}

/// Whether the field with constant components `turns` lies in the hull of D.
fn is_in_hull(pool: &Pool, problem: &Problem, turns: &[(usize, i64)]) -> bool {
    let roots = problem.roots();
    let profile = pool.profile_of(&roots);
    let Ok(mut points) = sample_points(pool, &roots, &profile, 3) else {
        return false;
    };
    let verdict = points.find(|point| {
        let rank = |with: bool, point: &mut dalembert_expr::ModularPoint| {
            let order = problem.forms.len() + 2;
            let space = JetSpace::new(problem.variables.len(), order, 1 << 14)?;
            let jets: Jets<'_, Modulus> = Jets::new(point.modulus(), &space);
            let mut demands = frame(pool, problem, &jets, point, None)?.demands;
            // Only the vector parts matter here.
            demands.iter_mut().for_each(|demand| {
                if let Some(last) = demand.last_mut() {
                    last.clear();
                }
            });
            let closed = close(jets.lower(), &problem.variables, &demands);
            if !closed.is_closed {
                return None;
            }
            if !with {
                return Some(closed.rank);
            }
            let mut turn = vec![Vec::new(); problem.components() + 1];
            for (i, count) in turns {
                turn[*i] = jets.constant(jets.field.integer(*count));
            }
            demands.push(turn);
            let closed = close(jets.lower(), &problem.variables, &demands);
            closed.is_closed.then_some(closed.rank)
        };
        Some(rank(false, point)? == rank(true, point)?)
    });
    verdict.unwrap_or(false)
}

/// The periods of `beta`, the unique closed one-form with `beta(X_i) = c_i`, along each circle, in double precision.
/// For hulls of full rank only.
pub(super) fn from_periods(model: &Model, problem: &Problem, local: &Local) -> Global {
    if local.rank < problem.components() {
        return Global::Undecided(
            "no density was found, and D does not connect all configurations",
        );
    }
    let roots = problem.roots();
    for (i, coordinate) in model.coordinates.iter().enumerate() {
        if coordinate.topology != Topology::Angle {
            continue;
        }
        let mut found = None;
        for attempt in 0..ATTEMPTS {
            let sample = sample(model, attempt, uses(&model.pool, &roots));
            if let Some(period) = period(model, problem, local, &sample, i) {
                found = Some((period, sample));
                break;
            }
        }
        match found {
            None => {
                return Global::Undecided(LEAVES);
            }
            Some((period, sample)) if period.abs() > PERIOD => {
                return Global::Many {
                    turns: vec![(i, 1)],
                    period,
                    sample,
                };
            }
            Some(_) => {}
        }
    }
    Global::Exists
}

fn period(
    model: &Model,
    problem: &Problem,
    local: &Local,
    sample: &Sample,
    i: usize,
) -> Option<f64> {
    let mut sum = 0.0;
    for k in 0..POINTS {
        let mut point = sample.point();
        // NOTE: between the multiples of pi/24, where frames of D often have poles that the density does not have.
        let turn = (k as f64 + 0.5) / POINTS as f64;
        point.set(model.coordinates[i].q, TAU * turn);
        let elements = elements_at(
            &model.pool,
            problem,
            &local.hull,
            Some(&local.dependent),
            &mut point,
        )?;
        let width = problem.components();
        // beta in terms of components: elements^T beta = demands.
        let columns: Vec<Vec<f64>> = (0..width)
            .map(|j| local.hull.basis.iter().map(|e| elements[*e][j]).collect())
            .collect();
        let demands: Vec<f64> = local
            .hull
            .basis
            .iter()
            .map(|e| elements[*e][width])
            .collect();
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        sum += combine(&columns, &demands)?[i];
    }
    Some(sum * TAU / POINTS as f64).filter(|period| period.is_finite())
}
