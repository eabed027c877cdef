//! Closed leaves on which no density is single-valued.
//!
//! Let a density in closed form be 0 or infinite where a function `f` vanishes. Then `X(f) = 0` there for all fields X
//! of D, so the surface `f = 0` consists of leaves of the hull of D. If the rank of the hull is one less than the
//! dimension of Q, the surface is a single leaf. Along a loop in it every density, regular or not, grows by the same
//! factor, because the growth is the integral of regular demands. The circle of an angle that does not occur in `f` is
//! such a loop. Enclosures of `f` and of its derivative prove that `f` has a simple zero. An enclosure of the growth
//! over all possible positions of the zero proves that the growth is not 0.

use dalembert_expr::{Domain, ExprId, Interval, JetSpace, Jets, Reals, SymbolId, Zeros};

use super::exactness::{Local, decide_local_in};
use super::frame::frame;
use super::global::Global;
use super::growth::Loop;
use super::potential::Potential;
use super::problem::Problem;
use super::regularity::{domain, factors_with_zeros};
use super::sample::{Sample, sample, uses};
use crate::model::{Model, Topology};

/// Largest number of bisections of a segment on which a function changes sign. It suffices for all digits of a double.
const BISECTIONS: usize = 200;
/// Relative size of the neighbourhood of a zero in which the derivative must have constant sign.
const AROUND: f64 = 1e-7;

/// Growth along a loop of a closed leaf on which a density in closed form is singular, if one is found.
pub(super) fn grown_on_leaf(
    model: &mut Model,
    problem: &Problem,
    local: &Local,
    singular: &Potential,
    seed: u64,
) -> Option<Global> {
    let is_surface = local.rank + 1 == problem.components();
    if !is_surface || problem.is_time_dependent() {
        return None;
    }
    let factors = factors_with_zeros(model, problem, local, singular);
    factors.into_iter().find_map(|factor| {
        let (sample, zero) = zero_of(model, problem, factor)?;
        let local = regular_there(model, problem, &sample, seed)?;
        let is_loop = |i: &usize| {
            let coordinate = &model.coordinates[*i];
            coordinate.topology == Topology::Angle && !model.pool.depends_on(factor, coordinate.q)
        };
        let angles = (0..problem.coordinates).filter(is_loop);
        let mut loops = angles.map(|i| vec![(i, 1)]);
        loops.find_map(|turns| {
            let period = Loop::new(model, problem, &local, &turns)
                .certified(&sample, &zero)
                .ok()?;
            Some(Global::Many {
                turns,
                period,
                sample: sample.clone(),
            })
        })
    })
}

/// The hull in a frame that is regular at a configuration.
fn regular_there(model: &Model, problem: &Problem, sample: &Sample, seed: u64) -> Option<Local> {
    let space = JetSpace::new(problem.variables.len(), 1, usize::MAX)?;
    let jets = Jets::new(Reals, &space);
    let frame = frame(&model.pool, problem, &jets, &mut sample.point(), None)?;
    decide_local_in(&model.pool, problem, &frame.dependent, seed).ok()
}

/// A configuration near a simple zero of a function, and an interval of one coordinate. The interval contains the zero
/// if all other coordinates have the values of the configuration.
fn zero_of(model: &mut Model, problem: &Problem, id: ExprId) -> Option<(Sample, Domain)> {
    let domain = domain(model, id);
    let slopes: Vec<ExprId> = domain
        .iter()
        .map(|(symbol, _)| model.pool.diff(id, *symbol))
        .collect();
    let Zeros::Between(above, below) = model.pool.zeros_on(id, &slopes, &domain) else {
        return None;
    };
    let place = bisected(model, id, above, below);
    let place = shortened(model, id, place);
    let around = |x: f64| {
        let room = AROUND * x.abs().max(AROUND);
        Interval::new(x - room, x + room)
    };
    let pool = &model.pool;
    let all: Domain = place.iter().map(|(s, x)| (*s, around(*x))).collect();
    let ranges = pool.enclose(&pool.reachable(&slopes), &all);
    let order = pool.reachable(&[id]);
    // The function changes sign along one direction, with all other symbols at their values.
    let zero = (0..place.len()).find_map(|i| {
        ranges[slopes[i].index()].filter(|slope| slope.excludes_zero())?;
        let (symbol, range) = all[i];
        let mut line: Domain = place
            .iter()
            .map(|(s, x)| (*s, Interval::point(*x)))
            .collect();
        let [low, high] = [range.lo, range.hi].map(|end| {
            line[i].1 = Interval::point(end);
            pool.enclose(&order, &line)[id.index()].unwrap_or(Interval::WHOLE)
        });
        let changes = (low.hi < 0.0 && high.lo > 0.0) || (low.lo > 0.0 && high.hi < 0.0);
        changes.then_some((symbol, range))
    })?;
    let roots = problem.roots();
    let mut sample = sample(model, 0, uses(&model.pool, &roots));
    for (symbol, x) in place {
        sample.set(symbol, x);
    }
    Some((sample, vec![zero]))
}

/// The zero rounded to nine decimals, if that is a zero as well.
fn shortened(model: &Model, id: ExprId, place: Vec<(SymbolId, f64)>) -> Vec<(SymbolId, f64)> {
    // Adding 0 turns -0 into 0.
    let short = |x: f64| (x * 1e9).round() / 1e9 + 0.0;
    let rounded: Vec<_> = place
        .iter()
        .map(|(symbol, x)| (*symbol, short(*x)))
        .collect();
    match value(model, id, &rounded) == 0.0 {
        true => rounded,
        false => place,
    }
}

fn value(model: &Model, id: ExprId, place: &[(SymbolId, f64)]) -> f64 {
    let value = |symbol: SymbolId| {
        let found = place.iter().find(|(known, _)| *known == symbol);
        found.map_or(0.0, |(_, x)| *x)
    };
    model.pool.eval(&[id], &value)[0]
}

/// The point on the segment between `above` and `below` at which the function changes sign.
fn bisected(
    model: &Model,
    id: ExprId,
    mut above: Vec<(SymbolId, f64)>,
    mut below: Vec<(SymbolId, f64)>,
) -> Vec<(SymbolId, f64)> {
    let middle = |above: &[(SymbolId, f64)], below: &[(SymbolId, f64)]| -> Vec<(SymbolId, f64)> {
        let pairs = above.iter().zip(below);
        pairs
            .map(|((symbol, a), (_, b))| (*symbol, f64::midpoint(*a, *b)))
            .collect()
    };
    for _ in 0..BISECTIONS {
        let place = middle(&above, &below);
        if place == above || place == below {
            break;
        }
        match value(model, id, &place) > 0.0 {
            true => above = place,
            false => below = place,
        }
    }
    middle(&above, &below)
}
