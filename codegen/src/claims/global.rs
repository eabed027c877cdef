//! Global existence of a density from local existence: decides whether the local density is single-valued on the
//! declared circles.

use std::f64::consts::TAU;

use dalembert_expr::{Domain, ExprId, Interval, JetSpace, Jets, Modulus, Pool};

use super::closure::{Until, close};
use super::exactness::{Local, sample_points};
use super::frame::{Demand, frame};
use super::growth::{Loop, Uncertain};
use super::potential::{Potential, Term};
use super::problem::Problem;
use super::reflection;
use super::regularity::LEAVES;
use super::sample::{Sample, sample, uses};
use crate::model::{Model, Topology};

/// Answer on the existence of a density on all of Q.
#[derive(Debug, Clone, PartialEq)]
pub enum Global {
    /// A single-valued density exists.
    Exists,
    /// Every density is multiplied by `exp(period)` along a loop.
    Many {
        /// The circles of the loop: coordinate, and number of turns.
        turns: Vec<(usize, i64)>,
        /// Growth of `G` along the loop.
        period: f64,
        /// Values of parameters and of the other coordinates at which the period was computed.
        sample: Sample,
    },
    /// Neither was proved; with the reason.
    Undecided(&'static str),
}

/// Number of points on a loop in a first test.
const PROBES: usize = 12;
/// Fraction of the integral of the absolute value below which a sum over these points counts as small.
const SMALL: f64 = 5e-2;
/// Additional rounding error that is allowed, an absolute bound for loops along which all terms vanish.
const ROUNDING: f64 = 1e-12;
/// Reason why a period was not found.
const OPEN: &str = "a circle leaves the domain where the constraints are regular, or G varies too fast on it for its period to converge";
/// Reason why a period that is not 0 in double precision leaves the question open.
const GROWS: &str = "G seems to grow along a circle, but so little compared with its variation that no enclosure of the period excludes 0";
/// Seed of the points at which symmetries are tested.
const PERIODS: u64 = 7;
/// Reason why a period that seems to be 0 leaves the question open.
const NUMERIC: &str = "no closed form of G was found, and periods that are 0 to rounding prove nothing: declare the angles of these circles as lines, or as intervals";
/// Smallest period that counts as different from 0, relative to the integral of the absolute value.
const PERIOD: f64 = 1e-12;
/// Samples at which periods are computed: the declared defaults, which may hide the effect of a parameter, and another
/// one.
const ATTEMPTS: [usize; 2] = [0, 9];

/// The answer for a density that was found in closed form and contains multiples of angles.
pub(super) fn from_angles(
    model: &Model,
    problem: &Problem,
    local: &Local,
    found: &Potential,
) -> Global {
    let slopes: Vec<(usize, ExprId)> = found
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
    let coefficients: Vec<_> = slopes.iter().map(|(_, k)| *k).collect();
    let order = model.pool.reachable(&coefficients);
    let samples = ATTEMPTS.map(|attempt| {
        let sample = sample(model, attempt, uses(&model.pool, &coefficients));
        let ranges = model.pool.enclose(&order, &sample.ranges());
        let range = |id: &ExprId| ranges[id.index()].unwrap_or(Interval::WHOLE);
        let values: Vec<Interval> = coefficients.iter().map(range).collect();
        (sample, values)
    });
    let is_whole = local.rank == problem.components();
    let leaves = (!is_whole)
        .then(|| Leaves::of(&model.pool, problem))
        .flatten();
    let holds = |turns: &[(usize, i64)]| {
        let leaves = leaves.as_ref();
        is_whole || leaves.is_some_and(|leaves| leaves.hold(problem, turns))
    };
    let mut uncertain = None;
    for turns in loops(&angles(model, problem)) {
        let grown = samples.iter().find_map(|(sample, values)| {
            let weight = |((i, _), value): (&(usize, _), &Interval)| {
                let turn = turns.iter().find(|(turn, _)| turn == i);
                turn.map_or(Interval::ZERO, |(_, count)| {
                    *value * Interval::point(*count as f64)
                })
            };
            let weights = slopes.iter().zip(values).map(weight);
            let sum = weights.fold(Interval::ZERO, |a, b| a + b);
            let period = TAU * f64::midpoint(sum.lo, sum.hi);
            (period.is_finite() && sum.excludes_zero()).then_some((period, sample))
        });
        let Some((period, sample)) = grown.filter(|_| holds(&turns)) else {
            continue;
        };
        match certify(model, problem, local, &turns) {
            Err(reason) => uncertain = Some(reason_of(reason)),
            Ok(()) => {
                return Global::Many {
                    turns,
                    period,
                    sample: sample.clone(),
                };
            }
        }
    }
    if let Some(reason) = uncertain {
        return Global::Undecided(reason);
    }
    Global::Undecided(
        "the density found is not single-valued; another density, which differs from it by a function that is constant along D, may be single-valued",
    )
}

/// Certifies at one of the samples that `G` grows along a loop. The loop then lies in the domain of the declaration.
fn certify(
    model: &Model,
    problem: &Problem,
    local: &Local,
    turns: &[(usize, i64)],
) -> Result<(), Uncertain> {
    let roots = problem.roots();
    let certified = |attempt| {
        let place = sample(model, attempt, uses(&model.pool, &roots));
        Loop::new(model, problem, local, turns).certified(&place, &Domain::new())
    };
    let [first, second] = ATTEMPTS;
    certified(first).or_else(|_| certified(second)).map(|_| ())
}

/// The text of a reason.
fn reason_of(uncertain: Uncertain) -> &'static str {
    match uncertain {
        Uncertain::Leaves => LEAVES,
        Uncertain::Small => GROWS,
    }
}

/// The coordinates on circles.
fn angles(model: &Model, problem: &Problem) -> Vec<usize> {
    (0..problem.coordinates)
        .filter(|i| model.coordinates[*i].topology == Topology::Angle)
        .collect()
}

/// Combinations of turns of up to six circles, those with few turns first, the first turn positive. Each circle has up
/// to 4 turns for one or two circles, 2 for three, 1 for more.
fn loops(angles: &[usize]) -> Vec<Vec<(usize, i64)>> {
    let most = match angles.len() {
        0..=2 => 4,
        3 => 2,
        _ => 1,
    };
    let mut all: Vec<Vec<(usize, i64)>> = vec![Vec::new()];
    for angle in angles.iter().take(6) {
        let mut longer = Vec::new();
        for turns in &all {
            for count in -most..=most {
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
    all.sort_by_key(|turns| turns.iter().map(|(_, count)| count.abs()).sum::<i64>());
    all
}

/// The involutive hull of D at a random point. It decides which loops lie in leaves of the hull.
struct Leaves {
    field: Modulus,
    space: JetSpace,
    demands: Vec<Demand<Modulus>>,
    rank: usize,
}

impl Leaves {
    /// The hull of D; `None` if it is not closed within the order tried.
    fn of(pool: &Pool, problem: &Problem) -> Option<Self> {
        let roots = problem.roots();
        let profile = pool.profile_of(&roots);
        let mut points = sample_points(pool, &roots, &profile, 3).ok()?;
        points.find(pool, |point| {
            let field = point.modulus();
            let order = problem.forms.len() + 2;
            let space = JetSpace::new(problem.variables.len(), order, 1 << 14)?;
            let jets: Jets<'_, Modulus> = Jets::new(field, &space);
            let mut demands = frame(pool, problem, &jets, point, None)?.demands;
            // Only the vector parts matter here, so the demands are cleared.
            demands.iter_mut().for_each(|demand| {
                if let Some(last) = demand.last_mut() {
                    last.clear();
                }
            });
            let closed = close(jets.lower(), &problem.variables, &demands, Until::Closed);
            closed.is_closed.then_some(())?;
            Some(Self {
                field,
                demands,
                rank: closed.rank,
                space,
            })
        })
    }

    /// True if the constant vector field `turns` lies in the hull.
    fn hold(&self, problem: &Problem, turns: &[(usize, i64)]) -> bool {
        let jets = Jets::new(self.field, &self.space);
        let mut turn = vec![Vec::new(); problem.components() + 1];
        for (i, count) in turns {
            turn[*i] = jets.constant(self.field.integer(*count));
        }
        let mut demands = self.demands.clone();
        demands.push(turn);
        let closed = close(jets.lower(), &problem.variables, &demands, Until::Closed);
        closed.is_closed && closed.rank == self.rank
    }
}

/// The answer from the growth of `G` along loops, certified by enclosures. If the hull of D contains all components,
/// the loops are the single circles. Otherwise they are the combinations of circles that lie in leaves.
pub(super) fn from_periods(
    model: &Model,
    problem: &Problem,
    local: &Local,
    cuts: Option<&[usize]>,
) -> Global {
    let is_whole = local.rank == problem.components();
    let angles = angles(model, problem);
    let loops = match is_whole {
        true => angles.iter().map(|i| vec![(*i, 1)]).collect(),
        false => loops(&angles),
    };
    let leaves = (!is_whole)
        .then(|| Leaves::of(&model.pool, problem))
        .flatten();
    let roots = problem.roots();
    let cuts = cuts.unwrap_or_default();
    let has_no_period =
        |angle| reflection::has_no_period(model, problem, local, (angle, cuts), PERIODS);
    let (mut is_open, mut uncertain) = (false, None);
    // Circles along which the growth is proved to be 0 by symmetry, and circles where this is open.
    let (mut proved, mut left) = (0, Vec::new());
    for turns in loops {
        if !is_whole
            && !leaves
                .as_ref()
                .is_some_and(|leaves| leaves.hold(problem, &turns))
        {
            continue;
        }
        if let [(angle, _)] = turns[..]
            && is_whole
        {
            // The proof takes less work than a sum that converges to 0.
            if seems_closed(model, problem, local, &turns) && has_no_period(angle) {
                proved += 1;
                continue;
            }
            left.push(angle);
        }
        let mut is_known = false;
        for attempt in ATTEMPTS {
            let sample = sample(model, attempt, uses(&model.pool, &roots));
            let mut path = Loop::new(model, problem, local, &turns);
            let Some((period, size)) = path.converged(&sample) else {
                continue;
            };
            is_known = true;
            if period.abs() <= PERIOD * size + ROUNDING {
                continue;
            }
            match path.certified(&sample, &Domain::new()) {
                Ok(period) => {
                    return Global::Many {
                        turns,
                        period,
                        sample,
                    };
                }
                Err(reason) => uncertain.get_or_insert(reason_of(reason)),
            };
        }
        is_open |= !is_known;
    }
    if let Some(reason) = uncertain {
        return Global::Undecided(reason);
    }
    match (is_whole, is_open) {
        (true, _) if proved + left.len() == angles.len() && left.into_iter().all(has_no_period) => {
            Global::Exists
        }
        (true, false) => Global::Undecided(NUMERIC),
        (true, true) => Global::Undecided(OPEN),
        (false, _) => {
            Global::Undecided("no density was found, and D does not connect all configurations")
        }
    }
}

/// True if the sum over a few points of a loop is small. Then a search for a proof that `G` does not grow along the
/// loop is worthwhile.
fn seems_closed(model: &Model, problem: &Problem, local: &Local, turns: &[(usize, i64)]) -> bool {
    let sample = sample(model, ATTEMPTS[0], uses(&model.pool, &problem.roots()));
    Loop::new(model, problem, local, turns)
        .sum(&sample, PROBES)
        .is_none_or(|(sum, size)| sum.abs() <= SMALL * size + ROUNDING)
}
